"""The closed forms against the integral equations, evaluated independently in mpmath.

The kernels are written here once more, in distance form and in 20 digits, and integrated by
tanh-sinh; the fields under test enter as functions of s or of the distance from the edge.
"""

import ast
import math
from pathlib import Path

import mpmath as mp
import numpy as np
import pytest

from spectral_contact import closed_forms as cf

NU = 0.3
KAPPA = (1 - 2 * NU) / (4 * (1 - NU))
POISSON_RATIOS = [-0.5, 0.0, 0.3, 0.49]


@pytest.fixture(autouse=True)
def _digits():
    with mp.workdps(20):
        yield


def normal_kernel(eta, s, gap):
    hi = max(eta, s)
    return eta / hi * mp.elliprf(0, gap * (eta + s) / hi**2, 1)


def tangential_kernel(eta, s, gap):
    lo, hi = min(eta, s), max(eta, s)
    return eta * lo / (3 * hi**2) * mp.elliprd(0, gap * (eta + s) / hi**2, 1)


def integrate(integrand, s, breaks=()):
    """Integral over (0, 1) of integrand(η, d, |η − s|), with η = 1 − d."""
    inner = [mp.mpf(0), *sorted(b for b in breaks if b < s), s]
    total = mp.mpf(0)
    for a, b in zip(inner[:-1], inner[1:], strict=True):
        total += mp.quad(lambda r: integrand(s - r, 1 - s + r, r), [s - b, s - a], maxdegree=6)
    outer = [s, *sorted(b for b in breaks if b > s), (s + max([s, *breaks]) * 0 + 1) / 2]
    outer = sorted(set(outer))
    for a, b in zip(outer[:-1], outer[1:], strict=True):
        total += mp.quad(lambda r: integrand(s + r, 1 - s - r, r), [a - s, b - s], maxdegree=6)
    # d = u² removes the inverse root that the fields have at the edge
    end = mp.sqrt(1 - outer[-1])
    return total + mp.quad(
        lambda u: 2 * u * integrand(1 - u * u, u * u, 1 - s - u * u), [0, end], maxdegree=6
    )


def at(field, eta, d):
    """The field at η, from whichever coordinate is the smaller."""
    return field(s=float(eta)) if eta < 0.5 else field(from_edge=float(d))


def apply(kernel, field, s, breaks=()):
    """(1/π)∫ field(η) K(η, s) dη."""
    s = mp.mpf(s)
    return float(integrate(lambda e, d, r: at(field, e, d) * kernel(e, s, r), s, breaks) / mp.pi)


def moment(field, breaks=()):
    """2π∫ field(s) s ds."""
    half = mp.mpf(1) / 2
    return float(2 * mp.pi * integrate(lambda e, d, r: at(field, e, d) * e, half, breaks))


def smooth_g(s):
    """(1/s)∫₀ˢ η p dη for the smooth punch."""
    s = mp.mpf(s)
    return float(s / (2 * mp.pi * (1 + mp.sqrt(1 - s * s))))


# -- smooth, full stick ---------------------------------------------------------------------------


@pytest.mark.parametrize("s", [0.2, 0.95])
def test_smooth_pressure_solves_the_normal_equation(s):
    assert apply(normal_kernel, cf.smooth_pressure, s) == pytest.approx(
        cf.smooth_approach(), rel=1e-14
    )


def test_smooth_pressure_carries_the_load():
    assert moment(cf.smooth_pressure) == pytest.approx(1.0, rel=1e-14)


@pytest.mark.parametrize("s", [0.2, 0.95])
def test_full_stick_traction_solves_the_tangential_equation(s):
    def traction(**where):
        return cf.full_stick_traction(NU, **where)

    assert apply(tangential_kernel, traction, s) == pytest.approx(KAPPA * smooth_g(s), rel=1e-14)


def test_full_stick_shear_is_the_moment_of_the_traction():
    moment_of_q = moment(lambda **where: cf.full_stick_traction(NU, **where))
    assert moment_of_q == pytest.approx(cf.full_stick_shear(NU), rel=1e-14)


@pytest.mark.parametrize("s", [0.0, 1e-300, 1e-160, 1e-9, 0.9e-8, 1.1e-8, 1e-3, 0.499, 0.501, 0.9])
def test_full_stick_traction_keeps_its_digits_from_the_centre(s):
    with mp.workdps(700):
        x = mp.mpf(s)
        exact = 0 if s == 0 else -KAPPA * mp.log1p(-x * x) / (mp.pi**2 * x * mp.sqrt(1 - x * x))
        assert cf.full_stick_traction(NU, s) == pytest.approx(float(exact), rel=1e-15, abs=0)


@pytest.mark.parametrize("d", [1e-300, 1e-30, 1e-17, 1e-5, 0.3, 0.7])
def test_fields_keep_their_digits_from_the_edge(d):
    with mp.workdps(400):
        y = mp.mpf(d) * (2 - mp.mpf(d))
        q = -KAPPA * mp.log(y) / (mp.pi**2 * (1 - mp.mpf(d)) * mp.sqrt(y))
        p = 1 / (2 * mp.pi * mp.sqrt(y))
        assert cf.full_stick_traction(NU, from_edge=d) == pytest.approx(float(q), rel=1e-15)
        assert cf.smooth_pressure(from_edge=d) == pytest.approx(float(p), rel=1e-15)


def test_edge_values_are_infinite_on_purpose():
    assert cf.smooth_pressure(1.0) == math.inf
    assert cf.full_stick_traction(NU, 1.0) == math.inf
    assert cf.partial_slip_traction(NU, 0.2, from_edge=0.0) == math.inf
    assert cf.full_stick_traction(0.5, 1.0) == 0.0


# -- smooth, partial slip -------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("ratio", "c", "shear"),
    [
        (0.5, "0.0730344191397954571", "0.499330942093621617"),
        (2.0, "0.903753964279260882", "1.2953010511890055"),
    ],
)
def test_stick_radius_and_shear_of_the_theory_notes(ratio, c, shear):
    stick = cf.stick_radius(NU, ratio * KAPPA)
    assert stick.radius == pytest.approx(float(c), rel=1e-15)
    assert stick.from_edge == pytest.approx(1 - float(c), rel=1e-14)
    assert cf.partial_slip_shear(NU, ratio * KAPPA) / KAPPA == pytest.approx(float(shear), rel=2e-15)


RATIOS = [0.02, 0.0799, 0.0801, 0.3, 0.9999, 1.0001, 2, 5, 20, 29.9, 30.1, 60, 400]


@pytest.mark.parametrize("ratio", RATIOS)
def test_stick_condition_holds_for_c_and_for_its_complement(ratio):
    f = ratio * KAPPA
    stick = cf.stick_radius(NU, f)
    with mp.workdps(600):
        exact_ratio = mp.mpf(f) / mp.mpf(KAPPA)

        def friction_for(c, e):
            return mp.log((1 + c) / e) / (c * mp.ellipk(e * (1 + c)))

        c, e = mp.mpf(stick.radius), mp.mpf(stick.from_edge)
        # d ln c = (2κ/f) d ln f and d ln(1 − c) = (πf/2κ) d ln f at the ends: so a relative error
        # of 2e-16 in c or 1 − c appears much smaller in f, which a wrong last digit would not.
        assert float(friction_for(c, 1 - c) / exact_ratio - 1) == pytest.approx(0, abs=6e-16)
        assert float(friction_for(1 - e, e) / exact_ratio - 1) == pytest.approx(0, abs=6e-16)
        exact_shear = f * mp.ellipe(e * (2 - e)) + KAPPA * mp.log(e * (2 - e))
        if stick.radius < 0.5:
            exact_shear = f * mp.ellipe(1 - c * c) + KAPPA * mp.log1p(-c * c)
    assert cf.partial_slip_shear(NU, f) == pytest.approx(float(exact_shear), rel=3e-15 + 2e-16 * ratio)
