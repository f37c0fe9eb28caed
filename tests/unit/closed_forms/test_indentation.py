"""Digits of the closed forms where contacts are small, and next to corners."""

import math

import mpmath as mp
import pytest

from spectral_contact import closed_forms as cf


@pytest.fixture(autouse=True)
def _many_digits():
    with mp.workdps(120):
        yield


def near(value):
    return pytest.approx(float(value), rel=3e-15, abs=0.0)


@pytest.mark.parametrize("a", [1e-25, 1e-9, 1e-3, 0.5, 0.999999])
def test_a_sphere_that_is_large_against_the_contact(a):
    x = mp.mpf(a)
    found = cf.sphere_contact(2.0 * a, 2.0)
    assert found.approach == near(2 * x * mp.atanh(x))
    assert found.load == near(16 * ((1 + x**2) * mp.atanh(x) - x))


@pytest.mark.parametrize("past", [1e-12, 1e-6, 1e-3, 1.0])
def test_contacts_that_just_exceed_their_flat_part(past):
    a = 1.0 + past
    x = mp.mpf(a)
    angle, slope = mp.acos(1 / x), 1 / mp.tan(mp.mpf(0.8))
    cone, rounded = cf.truncated_cone_contact(a, 1.0, 0.8), cf.rounded_flat_contact(a, 1.0, 1.0)
    sine, cosine = mp.sin(angle), mp.cos(angle)
    assert cone.approach == near(slope * x * angle)
    assert cone.load == near(4 * slope * x**2 * (angle + sine * cosine))
    assert rounded.approach == near(x**2 * (sine - angle * cosine))
    assert rounded.load == near(4 * x**3 / 3 * (sine * (4 - cosine**2) - 3 * angle * cosine))
    assert float(cf.cone_pressure(a, 0.8, 1.0)) == near(2 * slope * mp.acosh(x))


def test_large_exponents():
    ratio = mp.sqrt(mp.pi) * mp.gamma(51) / mp.gamma(mp.mpf(101) / 2)
    assert cf.power_law_contact(1.0, 1.0, 100.0).approach == near(ratio)
    assert math.isinf(cf.cone_pressure(1.0, 0.8, 0.0))


@pytest.mark.parametrize("exponent", [0.5001, 0.51])
def test_a_pull_off_beyond_all_radii_is_refused_by_name(exponent):
    with pytest.raises(ValueError, match=r"coefficient, exponent, work_of_adhesion = .*radius"):
        cf.power_law_pull_off(1.0, exponent, 1e10)


def test_arguments_of_another_kind_give_the_numbers_of_floats():
    pint = pytest.importorskip("pint")
    percent = pint.UnitRegistry().Quantity(200, "percent")
    assert cf.rounded_flat_contact(percent, 1.0, 0.3) == cf.rounded_flat_contact(2.0, 1.0, 0.3)
    assert cf.truncated_cone_contact(percent, 1.0, 0.3) == cf.truncated_cone_contact(2.0, 1.0, 0.3)
    assert isinstance(cf.parabola_pressure(1.0, 1.0, 0.5), float)


def test_next_to_the_tip_of_a_cone_the_pressure_is_finite():
    truth = 2 / mp.tan(mp.mpf(0.8)) * mp.acosh(mp.mpf(1e30) / mp.mpf(1e-290))
    assert cf.cone_pressure(1e30, 0.8, 1e-290) == near(truth)
