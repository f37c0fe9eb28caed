"""Radii and series: known from the centre and from the edge, one by one and in arrays."""

import mpmath
import numpy as np
import pytest

from spectral_contact import Scene, solve
from spectral_contact.fields.series import LogSeries, Radius
from spectral_contact.profiles import Flat


@pytest.mark.parametrize("logit", [-60.0, -1.0, 0.0, 2.0, 40.0, 600.0])
def test_radii_are_known_from_both_sides(logit):
    radius = Radius.from_logit(logit)
    with mpmath.workdps(400):
        b = 1 / mpmath.sqrt(1 + mpmath.exp(-logit))
        assert abs(radius.value / b - 1) <= 4e-16
        assert abs(radius.from_edge / (1 - b) - 1) <= 6e-16
        assert abs(radius.rest / (1 - b * b) - 1) <= 8e-16
    assert radius.logit == pytest.approx(logit, abs=1e-15 * max(abs(logit), 1.0))


def test_squares_inside_a_radius_keep_their_digits():
    near = Radius.from_logit(50.0)
    offset = 1e-25
    [gap] = near.below(np.array([1.0]), np.array([near.from_edge + offset]))
    assert gap == pytest.approx(2.0 * offset, rel=1e-3, abs=0)
    small = Radius.from_logit(-50.0)
    [gap] = small.below(np.array([small.value / 2.0]), np.array([1.0]))
    assert gap == pytest.approx(0.75 * small.square, rel=1e-14, abs=0)


@pytest.mark.parametrize("root_tail", [False, True])
@pytest.mark.parametrize("power", [0.0, -0.5])
def test_one_value_is_that_of_an_array(root_tail, power):
    random = np.random.default_rng(1)
    series = LogSeries(
        random.standard_normal((4, 7)), random.standard_normal(3), 2.0, power, root_tail
    )
    d = np.array([1.0, 0.7, 0.1, 2e-2, 1e-3, 3e-4, 1e-6, 1e-30])
    values = np.array([series.value(float(one)) for one in d])
    assert values == pytest.approx(series(d), rel=1e-12)
    scale = np.polynomial.legendre.legval(2.0 * (-np.log(0.1) / 2.0 - 1.0) - 1.0, np.eye(7))
    assert series.value(0.1) == pytest.approx(0.1**power * series.coefficients[1] @ scale)


def test_a_smooth_flat_punch_without_load_has_no_pressure_at_its_edge():
    scene = Scene(0.3, profile=Flat(1.0), work_of_adhesion=0.01, load=0.0)
    solution = solve(scene)
    assert solution.pressure(1.0) == 0.0
    assert solution.pressure([0.0, 0.5, 1.0]).tolist() == [0.0, 0.0, 0.0]


def test_a_multiple_of_a_series_has_that_multiple_of_its_logarithm():
    one = LogSeries(np.ones((2, 3)), np.array([1.0]), 2.0, logarithm=0.5)
    d = np.array([1.0, 1e-2, 1e-5, 1e-30])
    assert np.array_equal(one.times(-2.0)(d), -2.0 * one(d))
    assert one.times(-2.0)(np.zeros(1))[0] == -np.inf
