"""The quadrature of the equations at the ends of its ranges."""

import numpy as np
import pytest

from spectral_contact.equations.residuals import (
    approach_slope,
    edge_layer_breaks,
    load,
    normal_displacement,
    outer_displacement,
)


def uniform(d):
    return np.ones_like(d)


def test_next_to_the_edge_a_uniform_pressure_moves_the_surface_as_at_it():
    """By 1/pi of the radius (Johnson 1985, section 3.4)."""
    for from_edge in (1e-300, 1e-120, 1e-40):
        assert normal_displacement(uniform, from_edge) == pytest.approx(1.0 / np.pi, rel=1e-15)


@pytest.mark.parametrize("radius", [2.0**-53, 2.0**-30, 0.5])
def test_the_load_of_a_disk_is_that_of_its_area(radius):
    assert load(uniform, inside=1.0 - radius) == pytest.approx(radius**2 / 2.0, rel=1e-14)


def test_far_outside_a_load_is_a_point_force():
    assert outer_displacement(uniform, 1e200) == pytest.approx(0.25e-200, rel=1e-14)


@pytest.mark.parametrize("c", [1e-14, 1e-10, 1e-2, 20.0])
def test_the_square_of_a_pressure_on_a_thin_layer_is_resolved(c):
    slope = approach_slope(lambda d: 1.0 / np.sqrt(d + c), edge_layer_breaks(c))
    assert slope == pytest.approx(2.0 * np.pi * ((1.0 + c) * np.log1p(1.0 / c) - 1.0), rel=1e-14)


def test_users_may_have_numpy_raise():
    with np.errstate(all="raise"):  # weights next to the ends of intervals underflow
        assert approach_slope(uniform, edge_layer_breaks(0.5)) == pytest.approx(np.pi, rel=1e-14)
