"""The closed forms against the integral equations, evaluated independently in mpmath.

The kernels are written here once more, in distance form and in 20 digits, and integrated by
tanh-sinh; the fields under test enter as functions of s or of the distance from the edge.
"""

import ast
import inspect
import itertools
import math
import sys
from pathlib import Path

import mpmath as mp
import numpy as np
import pytest

from spectral_contact import closed_forms as cf

NU = 0.3
KAPPA = (1 - 2 * NU) / (4 * (1 - NU))
EPS = 2.0**-52


@pytest.fixture(autouse=True)
def _twenty_digits():
    with mp.workdps(20):
        yield


def near(value, *, rel):
    """Approximately equal in the relative sense alone: approx would allow 1e-12 besides."""
    return pytest.approx(value, rel=rel, abs=0)


def normal_kernel(eta, s, gap):
    hi = max(eta, s)
    return eta / hi * mp.elliprf(0, gap * (eta + s) / hi**2, 1)


def tangential_kernel(eta, s, gap):
    lo, hi = min(eta, s), max(eta, s)
    return eta * lo / (3 * hi**2) * mp.elliprd(0, gap * (eta + s) / hi**2, 1)


def integrate(integrand, s, breaks=(), start=0):
    """Integral over (start, 1) of integrand(η, d, |η − s|), where d = 1 − η and s ≥ start."""
    s = mp.mpf(s)
    inner = [mp.mpf(start), *[mp.mpf(b) for b in breaks if start < b < s], s]
    outer = [s, *[mp.mpf(b) for b in breaks if b > s]]
    outer.append((outer[-1] + 1) / 2)
    pieces = [
        mp.quad(lambda r: integrand(s - r, 1 - s + r, r), [s - b, s - a], maxdegree=6)
        for a, b in itertools.pairwise(inner)
        if b > a
    ]
    pieces += [
        mp.quad(lambda r: integrand(s + r, 1 - s - r, r), [a - s, b - s], maxdegree=6)
        for a, b in itertools.pairwise(outer)
    ]
    # d = u² removes the inverse root that the fields have at the edge
    end = mp.sqrt(1 - outer[-1])
    pieces.append(
        mp.quad(lambda u: 2 * u * integrand(1 - u * u, u * u, 1 - s - u * u), [0, end], maxdegree=6)
    )
    return mp.fsum(pieces)


def at(field, eta, d):
    """The field at η, from whichever coordinate is the smaller."""
    return field(s=float(eta)) if eta < 0.5 else field(from_edge=float(d))


def operator(kernel, field, s, breaks=()):
    """(1/π)∫ field(η) K(η, s) dη: N or T of the field."""
    s = mp.mpf(s)
    total = integrate(lambda e, d, r: at(field, e, d) * kernel(e, s, r), s, breaks)
    return float(total / mp.pi)


def moment(field, breaks=()):
    """2π∫ field(s) s ds."""
    return float(2 * mp.pi * integrate(lambda e, d, r: at(field, e, d) * e, 0.5, breaks))


def smooth_g(s):
    """(1/s)∫₀ˢ η p dη for p = 1/(2π√(1 − η²))."""
    s = mp.mpf(s)
    return float(s / (2 * mp.pi * (1 + mp.sqrt(1 - s * s))))


def full_stick(**where):
    return cf.full_stick_traction(NU, **where)


def slipping(ratio):
    return lambda **where: cf.partial_slip_traction(NU, ratio * KAPPA, **where)


# -- smooth, full stick ----------------------------------------------------------------------------


@pytest.mark.parametrize("s", [0.2, 0.95])
def test_smooth_pressure_solves_the_normal_equation(s):
    assert operator(normal_kernel, cf.smooth_pressure, s) == near(cf.smooth_approach(), rel=1e-14)


@pytest.mark.parametrize("s", [0.2, 0.95])
def test_full_stick_traction_solves_the_tangential_equation(s):
    assert operator(tangential_kernel, full_stick, s) == near(KAPPA * smooth_g(s), rel=1e-14)


def test_load_and_shear_are_the_moments_of_the_fields():
    assert moment(cf.smooth_pressure) == near(1.0, rel=1e-14)
    assert moment(full_stick) == near(cf.full_stick_shear(NU), rel=1e-14)


@pytest.mark.parametrize("s", [1e-300, 1e-160, 1e-9, 0.99e-8, 1.01e-8, 1e-3, 0.499, 0.501, 0.9])
def test_full_stick_traction_keeps_its_digits_near_the_centre(s):
    with mp.workdps(700):
        x = mp.mpf(s)
        exact = float(-KAPPA * mp.log1p(-x * x) / (mp.pi**2 * x * mp.sqrt(1 - x * x)))
    assert cf.full_stick_traction(NU, s) == pytest.approx(exact, rel=1e-15, abs=0)


@pytest.mark.parametrize("d", [5e-324, 1e-300, 1e-30, 1e-17, 1e-5, 0.3, 0.7])
def test_smooth_fields_keep_their_digits_near_the_edge(d):
    with mp.workdps(400):
        y = mp.mpf(d) * (2 - mp.mpf(d))
        q = float(-KAPPA * mp.log(y) / (mp.pi**2 * (1 - mp.mpf(d)) * mp.sqrt(y)))
        p = float(1 / (2 * mp.pi * mp.sqrt(y)))
    assert cf.full_stick_traction(NU, from_edge=d) == near(q, rel=1e-15)
    assert cf.smooth_pressure(from_edge=d) == near(p, rel=1e-15)


# -- smooth, partial slip: c and Q -----------------------------------------------------------------

RATIOS = [0.02, 0.0799, 0.0801, 0.3, 0.9999, 1.0001, 1.2, 2.0, 5.0, 20.0, 29.9, 30.1, 60.0, 400.0]


def exact_stick(ratio, near):
    """c and 1 − c for f/κ = ratio: the root of Spence's condition next to a StickRadius."""
    inner = near.radius < 0.5

    def split(x):
        small = mp.exp(x)
        return (small, 1 - small) if inner else (1 - small, small)

    def condition(x):
        c, e = split(x)
        return mp.log((1 + c) / e) / (c * mp.ellipk(e * (1 + c))) - ratio

    start = mp.mpf(near.log_radius if inner else near.log_from_edge)
    return split(mp.findroot(condition, (start, start * (1 + mp.mpf(10) ** -12))))


@pytest.mark.parametrize("ratio", RATIOS)
def test_stick_radius_its_complement_and_shear(ratio):
    f = ratio * KAPPA
    stick = cf.stick_radius(NU, f)
    # What an input wrong in its last bit does: d ln c = (2κ/f) d ln f, d ln(1−c) = −(πf/2κ) d ln f
    bound_c, bound_e = 2 * EPS * max(1, 2 / ratio), 2 * EPS * max(1, math.pi * ratio / 2)
    with mp.workdps(600):
        c, e = exact_stick(mp.mpf(f) / mp.mpf(KAPPA), stick)
        shear = float(f * mp.ellipe(e * (1 + c)) + KAPPA * mp.log(e * (1 + c)))
        error_c, error_e = float(stick.radius / c - 1), float(stick.from_edge / e - 1)
        assert stick.log_radius == near(float(mp.log(c)), rel=6 * EPS if c < e else bound_e)
        assert stick.log_from_edge == near(float(mp.log(e)), rel=6 * EPS if e < c else bound_c)
    assert abs(error_c) < bound_c
    assert abs(error_e) < bound_e
    assert cf.partial_slip_shear(NU, f) == near(shear, rel=5 * EPS)


@pytest.mark.parametrize(
    ("ratio", "c", "shear"),
    [
        (0.5, 0.0730344191397954571, 0.499330942093621617),
        (2.0, 0.903753964279260882, 1.2953010511890055),
    ],
)
def test_stick_radius_and_shear_of_the_theory_notes(ratio, c, shear):
    assert cf.stick_radius(NU, ratio * KAPPA).radius == near(c, rel=1e-15)
    assert cf.partial_slip_shear(NU, ratio * KAPPA) / KAPPA == near(shear, rel=1e-15)


def test_stick_radius_beyond_the_range_of_doubles():
    nearly_frictionless = cf.stick_radius(NU, 0.001 * KAPPA)
    assert nearly_frictionless.radius == 0.0
    assert nearly_frictionless.log_radius == near(math.log(4) - 2000, rel=1e-15)
    nearly_stuck = cf.stick_radius(NU, 1000 * KAPPA)
    assert nearly_stuck.from_edge == 0.0
    assert nearly_stuck.log_from_edge == near(math.log(2) - 500 * math.pi, rel=1e-15)
    assert cf.partial_slip_shear(NU, 1e300) == cf.full_stick_shear(NU)
    assert cf.partial_slip_shear(NU, 1e-300) == pytest.approx(1e-300, rel=1e-15, abs=0)


def test_conventions_of_no_friction_no_shear_and_full_stick():
    without = cf.stick_radius(NU, 0.0)
    assert without == cf.StickRadius(0.0, 1.0, -math.inf, 0.0)
    assert cf.partial_slip_shear(NU, 0.0) == 0.0
    for stuck in (cf.stick_radius(NU, math.inf), cf.stick_radius(0.5, 0.0)):
        assert stuck == cf.StickRadius(1.0, 0.0, 0.0, -math.inf)
    assert cf.partial_slip_shear(NU, math.inf) == cf.full_stick_shear(NU)
    assert cf.partial_slip_shear(0.5, 0.3) == 0.0
    assert cf.partial_slip_traction(0.5, 0.3, 0.9) == 0.0
    assert cf.partial_slip_traction(NU, 0.0, 1.0) == 0.0
    assert cf.slip_displacement(0.5, 0.3, 0.9) == 0.0


# -- smooth, partial slip: fields ------------------------------------------------------------------


@pytest.mark.parametrize(("ratio", "s"), [(2.0, 0.1), (2.0, 0.8), (2.0, 0.97), (0.5, 0.05)])
def test_partial_slip_fields_solve_the_tangential_equation(ratio, s):
    f = ratio * KAPPA
    c = cf.stick_radius(NU, f).radius
    displacement = operator(tangential_kernel, slipping(ratio), s, [c]) - KAPPA * smooth_g(s)
    # T q and κ g are of this size, and their difference is what the test can see.
    scale = KAPPA * smooth_g(s)
    assert displacement == pytest.approx(cf.slip_displacement(NU, f, s), abs=3e-14 * scale)


def test_partial_slip_shear_is_the_moment_of_the_traction():
    f = 2 * KAPPA
    c = cf.stick_radius(NU, f).radius
    assert moment(slipping(2.0), [c]) == near(cf.partial_slip_shear(NU, f), rel=1e-14)


def exact_stick_traction(ratio, c, s):
    """The inverse Abel transform of κ artanh(t)/(πt) and (f/2π)K'(t), not yet combined."""
    y, m, w = 1 - s * s, 1 - c * c, mp.sqrt(c * c - s * s)
    integral = mp.ellipk(m) + s * s / y * mp.ellippi(m / y, m)
    elementary = 2 * mp.atanh(w / mp.sqrt(y)) / mp.sqrt(y)
    return KAPPA * (ratio * w * integral - elementary) / (mp.pi**2 * s)


@pytest.mark.parametrize("ratio", [0.02, 0.0799, 0.3, 0.9, 2.0, 5.0, 20.0, 60.0, 400.0])
def test_stick_traction_keeps_its_digits_everywhere(ratio):
    f = ratio * KAPPA
    stick = cf.stick_radius(NU, f)
    from_centre = [stick.radius * part for part in (1e-12, 0.01, 0.5, 0.9, 0.99)]
    from_edge = [stick.from_edge * part for part in (1.01, 1.1, 2.0, 100.0)]
    with mp.workdps(700 if ratio > 100 or ratio < 0.05 else 130):
        exact_ratio = mp.mpf(f) / mp.mpf(KAPPA)
        c, _ = exact_stick(exact_ratio, stick)
        points = [({"s": v}, mp.mpf(v)) for v in from_centre if v < 0.5]
        points += [({"from_edge": d}, 1 - mp.mpf(d)) for d in from_edge if d < 0.5]
        exact = [float(exact_stick_traction(exact_ratio, c, s)) for _, s in points]
    for (where, _), value in zip(points, exact, strict=True):
        assert cf.partial_slip_traction(NU, f, **where) == pytest.approx(
            value, rel=1e-14 * max(1, 0.2 / ratio), abs=0
        )


def test_stick_traction_meets_friction_at_the_stick_radius():
    f = 2 * KAPPA
    stick = cf.stick_radius(NU, f)
    for step in (1e-6, 1e-8, 1e-10):
        inside, outside = stick.from_edge + step, stick.from_edge - step
        at_limit = f * cf.smooth_pressure(from_edge=inside)
        gap = at_limit - cf.partial_slip_traction(NU, f, from_edge=inside)
        assert 0 < gap < 3 * math.sqrt(step)
        assert cf.partial_slip_traction(NU, f, from_edge=outside) == near(
            f * cf.smooth_pressure(from_edge=outside), rel=1e-15
        )


def test_traction_is_bounded_by_friction_and_by_full_stick_at_its_limits():
    s = np.linspace(0, 0.999, 200)
    for ratio in (0.02, 0.3, 1.0, 3.0, 30.0):
        q = cf.partial_slip_traction(NU, ratio * KAPPA, s)
        assert np.all(q >= 0)
        assert np.all(q <= ratio * KAPPA * cf.smooth_pressure(s) * (1 + 4 * EPS))
    stuck = cf.partial_slip_traction(NU, 1000 * KAPPA, s)
    np.testing.assert_array_equal(stuck, cf.full_stick_traction(NU, s))
    almost = cf.partial_slip_traction(NU, 40 * KAPPA, s)
    np.testing.assert_allclose(almost, cf.full_stick_traction(NU, s), rtol=1e-14, atol=0)
    # f → 0 at fixed s/c: a stick disk in a uniform traction f/(2π)
    tiny = cf.stick_radius(NU, 0.03 * KAPPA).radius
    sigma = np.array([0.0, 0.3, 0.9])
    np.testing.assert_allclose(
        cf.partial_slip_traction(NU, 0.03 * KAPPA, tiny * sigma),
        0.03 * KAPPA * np.arcsin(sigma) / math.pi**2,
        rtol=1e-14,
    )


def exact_slip(ratio, c, w2):
    """−(1/π²s)∫ t² [κ artanh(t)/t − (f/2)K'(t)] dt/√(s² − t²) at s² = c² + w2, t² = s² − w²."""
    s2 = c * c + w2
    y = 1 - s2

    def integrand(w):
        m = y + w * w
        t = mp.sqrt(1 - m)
        return t * (mp.log((1 + t) / mp.sqrt(m)) / t - ratio / 2 * mp.ellipk(m))

    end = mp.sqrt(w2)
    first = mp.sqrt(y) if 0 < y < w2 else end * mp.mpf(10) ** -10 if y == 0 else end / 8
    cuts = [first * 16**i for i in range(60) if first * 16**i < end]
    cuts += [mp.sqrt(s2 - (c * 8**i) ** 2) for i in range(1, 40) if 2 * c * 8**i < mp.sqrt(s2)]
    return -KAPPA * mp.quad(integrand, [0, *sorted(cuts), end]) / (mp.pi**2 * mp.sqrt(s2))


@pytest.mark.parametrize(
    ("ratio", "where"),
    [
        (0.05, {"s": 0.3}),
        (0.1, {"s": 2e-8}),
        (0.1, {"s": 0.5}),
        (0.9, {"s": 0.45}),
        (0.9, {"s": 0.9}),
        (2.0, {"from_edge": 0.05}),
        (2.0, {"from_edge": 1e-9}),
        (2.0, {"from_edge": 0.0}),
        (20.0, {"from_edge": 2e-14}),
        (20.0, {"from_edge": 0.0}),
    ],
)
def test_slip_displacement_against_its_abel_form(ratio, where):
    f = ratio * KAPPA
    with mp.workdps(50):
        c, _ = exact_stick(mp.mpf(f) / mp.mpf(KAPPA), cf.stick_radius(NU, f))
        s = mp.mpf(where["s"]) if "s" in where else 1 - mp.mpf(where["from_edge"])
        exact = float(exact_slip(mp.mpf(f) / mp.mpf(KAPPA), c, (s - c) * (s + c)))
    assert cf.slip_displacement(NU, f, **where) == pytest.approx(exact, rel=2e-14, abs=0)


def test_slip_is_inward_vanishes_in_stick_and_is_free_without_friction():
    s = np.linspace(0, 1, 41)
    for ratio in (0.3, 2.0):
        f = ratio * KAPPA
        u = cf.slip_displacement(NU, f, s)
        sticks = s <= cf.stick_radius(NU, f).radius
        assert np.all(u[sticks] == 0)
        assert np.all(u[~sticks] < 0)
    free = -KAPPA * s / (2 * math.pi * (1 + np.sqrt(1 - s * s)))
    np.testing.assert_allclose(cf.slip_displacement(NU, 0.0, s), free, rtol=1e-14, atol=0)
    np.testing.assert_allclose(cf.slip_displacement(NU, 1e-300, s), free, rtol=1e-14, atol=0)


# -- eigenpairs ------------------------------------------------------------------------------------


def test_lowest_eigenvalues():
    assert cf.eigenvalue(0, 0) == near(math.pi / 4, rel=1e-15)
    assert cf.eigenvalue(1, 1) == near(math.pi / 8, rel=1e-15)


@pytest.mark.parametrize(("degree", "order"), [(2, 0), (1, 1), (6, 0), (7, 1)])
def test_eigenpairs_of_the_integral_operators(degree, order):
    kernel = tangential_kernel if order else normal_kernel
    image = operator(kernel, lambda **where: cf.eigenfunction(degree, order, **where), 0.7)
    assert image == near(cf.eigenfunction_image(degree, order, 0.7), rel=1e-13)
    assert image == near(
        cf.eigenvalue(degree, order) * cf.eigenfunction(degree, order, 0.7) * math.sqrt(0.51),
        rel=1e-13,
    )


@pytest.mark.parametrize(("degree", "order"), [(0, 0), (1, 1), (8, 0), (9, 1), (40, 0), (41, 1)])
def test_eigenfunctions_are_associated_legendre_functions(degree, order):
    for s in (1e-6, 0.3, 0.8, 0.999):
        with mp.workdps(40):
            x = mp.sqrt(1 - mp.mpf(s) ** 2)
            p = mp.legendre(degree, x)
            if order == 1:
                p = s * degree * (mp.legendre(degree - 1, x) - x * p) / (1 - x * x)
            exact = float(p / x)
            wave = mp.sqrt(2 / (mp.pi * max(degree, 1) * s))  # the amplitude away from the centre
            amplitude = float(min(1, wave) * min(1, degree * s) ** order * degree**order / x)
        assert cf.eigenfunction(degree, order, s) == pytest.approx(
            exact, rel=0, abs=(2e-15 if degree < 10 else 3e-14) * amplitude
        )


def test_eigenvalues_of_high_degree_obey_their_recurrence():
    # λ(l+2)/λ(l) from Γ(x + 1) = xΓ(x), for either order
    for degree, order in [(10, 0), (11, 1), (10**6, 0), (10**9 + 1, 1)]:
        l, m = degree, order  # noqa: E741
        ratio = (l + m + 1) * (l - m + 1) / ((l + m + 2) * (l - m + 2))
        assert cf.eigenvalue(l + 2, m) / cf.eigenvalue(l, m) == near(ratio, rel=4e-16)
        assert cf.eigenvalue(l, m) == near(1 / (2 * l + 1), rel=1 / l**2)


def test_edge_of_the_eigenfunctions():
    assert cf.eigenfunction(2, 0, 1.0) == -math.inf
    assert cf.eigenfunction(1, 1, 1.0) == math.inf
    assert cf.eigenfunction(2, 0, from_edge=1e-300) == near(-0.5 / math.sqrt(2e-300), rel=1e-15)


# -- series ----------------------------------------------------------------------------------------


def moments_of_n():
    """⟨1, Nᵏ1⟩ for k = 1, 2, 3 from N 1 = E(s)/π and the Abel form of N."""
    first = mp.quad(lambda s: mp.ellipe(s * s) * s, [0, 1]) / mp.pi
    second = mp.quad(lambda s: mp.ellipe(s * s) ** 2 * s, [0, 1]) / mp.pi**2

    def transform(t):  # ∫ₜ¹ (E(s)/π) s ds/√(s² − t²), with s² = t² + w²
        end = mp.sqrt(1 - t * t)
        return mp.quad(lambda w: mp.ellipe(min(t * t + w * w, 1)), [0, end], maxdegree=5) / mp.pi

    third = mp.quad(lambda t: transform(t) ** 2, [0, 1], maxdegree=4) / mp.pi
    return first, second, third


def test_large_compliance_series_is_the_neumann_series():
    with mp.workdps(15):
        first, second, third = moments_of_n()
        quadratic = (4 * first**2 - 2 * second) / mp.pi
        cubic = float((8 * first**3 - 8 * first * second + 2 * third) / mp.pi)
    exact = 10 / math.pi + float(2 * first / mp.pi) + float(quadratic) / 10
    assert cf.approach_large_compliance(10.0) == near(exact, rel=1e-15)
    assert cubic == near(7.9327e-5, rel=1e-5)  # as documented
    # the first neglected term of p(1) follows from 2πα p(1)² = d(αδ)/dα
    assert (2 / (27 * math.pi**4) - cubic) / 4 == near(1.7028e-4, rel=1e-5)


@pytest.mark.parametrize("alpha", [0.3, 1.0, 30.0])
def test_large_compliance_series_obeys_the_edge_identity(alpha):
    # 2πα p(1)² = d(αδ)/dα = 2α/π + 4/(3π²) + O(α⁻²), where the square of the three terms of p
    # leaves just the two products that are of the order of neglected ones
    p = cf.edge_pressure_large_compliance(alpha)
    rest = -2 / (27 * math.pi**4 * alpha**2) + 1 / (162 * math.pi**5 * alpha**3)
    expected = 2 * alpha / math.pi + 4 / (3 * math.pi**2) + rest
    assert 2 * math.pi * alpha * p * p == near(expected, rel=1e-15)


def test_large_compliance_series_errs_by_its_first_neglected_term():
    # δ and p(1) at α = 1 from the table of the theory notes
    assert 0.452701390869753 - cf.approach_large_compliance(1.0) == near(7.9327e-5, rel=0.15)
    assert 0.35044541816021 - cf.edge_pressure_large_compliance(1.0) == near(1.7028e-4, rel=0.15)


def test_small_compliance_series_against_the_theory_notes():
    assert cf.approach_small_compliance(1e-12) == near(0.125000000002324, rel=5e-15)
    assert cf.edge_pressure_small_compliance(1e-12) == near(141047.39588952, rel=5e-14)
    # the documented first neglected terms, at α = 0.01
    x = math.log(100) + float(np.euler_gamma)
    missing = 0.130089824705226 - cf.approach_small_compliance(0.01)
    assert missing == near(1e-4 * (2 * x * x + 2 * x + 1) / (4 * math.pi**2), rel=0.05)
    ratio = 1.463083969544 / cf.edge_pressure_small_compliance(0.01) - 1
    assert ratio == near(1e-4 * (6 * x * x + 2 * x + 1) / math.pi**2, rel=0.05)


@pytest.mark.parametrize("alpha", [1e-12, 1e-6, 1e-3, 1.0])
def test_small_compliance_series_obeys_the_edge_identity(alpha):
    # 2πα p(1)² = d(αδ)/dα, with the derivative of α²(ln(1/α) + γ + 1)/(4π) taken by mpmath
    def added(a):
        return a * a / (4 * mp.pi) * (mp.log(1 / a) + mp.euler + 1)

    with mp.workdps(40):
        expected = float(mp.mpf(1) / 8 + mp.diff(added, mp.mpf(alpha), h=mp.mpf(10) ** -25))
    p = cf.edge_pressure_small_compliance(alpha)
    assert 2 * math.pi * alpha * p * p == near(expected, rel=1e-14)


def test_small_compliance_limits():
    assert cf.approach_small_compliance(1.0) == near(
        1 / 8 + (1 + float(mp.euler)) / (4 * math.pi), rel=1e-15
    )
    assert cf.approach_small_compliance(1e-300) == 0.125
    p = cf.edge_pressure_small_compliance(1e-300)
    assert p == near(1 / (4 * math.sqrt(math.pi * 1e-300)), rel=1e-15)


# -- coupled ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("nu", "approach", "shear"),
    [
        (0.0, 0.1137799033283546742, 0.38478430961069996),
        (0.3, 0.12152125200129548574, 0.20432627873136887),
    ],
)
def test_coupled_approach_and_shear_of_the_theory_notes(nu, approach, shear):
    assert cf.coupled_approach(nu) == near(approach, rel=5e-16)
    assert cf.coupled_shear(nu) == near(shear, rel=1e-15)


@pytest.mark.parametrize("nu", [0.0, 0.3])
def test_coupled_fields_solve_the_coupled_equations(nu):
    kappa = (1 - 2 * nu) / (4 * (1 - nu))

    def p(**where):
        return cf.coupled_pressure(nu, **where)

    def q(**where):
        return cf.coupled_traction(nu, **where)

    s = 0.6
    beyond = integrate(lambda e, d, r: at(q, e, d), s, start=s)
    load_beyond = integrate(lambda e, d, r: at(p, e, d) * e, s, start=s)
    approach = operator(normal_kernel, p, s) - kappa * float(beyond)
    assert approach == near(cf.coupled_approach(nu), rel=1e-13)
    g = (1 / (2 * math.pi) - float(load_beyond)) / s
    assert operator(tangential_kernel, q, s) == near(kappa * g, rel=1e-13)
    assert moment(p) == near(1.0, rel=1e-13)
    assert moment(q) == near(cf.coupled_shear(nu), rel=1e-13)


@pytest.mark.parametrize(
    "where", [{"s": 1e-3}, {"s": 0.4}, {"s": 0.9}, {"from_edge": 1e-9}, {"from_edge": 1e-300}]
)
def test_coupled_fields_are_integrated_to_rounding(where):
    theta = mp.mpf(cf.oscillation_exponent(0.0))
    with mp.workdps(40):
        d = mp.mpf(where.get("from_edge", 0)) or 1 - mp.mpf(where["s"])
        s, y = 1 - d, d * (2 - d)

        def nodes(x):
            t = mp.sqrt(s * s + y * mp.tanh(x) ** 2)
            return t, 2 * theta * (mp.log1p(t) - mp.log(y) / 2 + mp.log(mp.cosh(x)))

        def of_pressure(x):
            t, angle = nodes(x)
            return (mp.cos(angle) + 2 * theta * mp.sin(angle) / t) / mp.cosh(x) ** 2

        def of_traction(x):
            t, angle = nodes(x)
            return s * (mp.sin(angle) - 2 * theta * t * mp.cos(angle)) / t**3 / mp.cosh(x) ** 2

        amplitude = mp.sinh(mp.pi * theta) / (2 * mp.pi**2 * theta * mp.sqrt(y))
        cuts = [mp.mpf(1) / 1000, mp.mpf(1) / 100, mp.mpf(1) / 10, 1, 2, 4, 8, 16, 32, 60]
        p, q = (float(amplitude * mp.quad(g, [0, *cuts])) for g in (of_pressure, of_traction))
        size = float(amplitude)
    assert cf.coupled_pressure(0.0, **where) == pytest.approx(p, rel=1e-14, abs=1e-14 * size)
    assert cf.coupled_traction(0.0, **where) == pytest.approx(
        q, rel=1e-14, abs=1e-14 * size * min(1.0, float(s))
    )


def test_coupled_traction_is_proportional_to_the_radius_at_the_centre():
    assert cf.coupled_traction(0.0, 0.0) == 0.0
    slope = cf.coupled_traction(0.0, 1e-9) / 1e-9
    assert cf.coupled_traction(0.0, 1e-200) / 1e-200 == near(slope, rel=1e-15)


def test_coupled_fields_tend_to_the_uncoupled_as_the_solid_becomes_incompressible():
    s = np.array([0.0, 0.3, 0.9, 0.999])
    nu = 0.5 - 1e-9
    np.testing.assert_allclose(cf.coupled_pressure(nu, s), cf.smooth_pressure(s), rtol=1e-14)
    np.testing.assert_allclose(cf.coupled_traction(nu, s), cf.full_stick_traction(nu, s), rtol=1e-8)
    assert cf.coupled_shear(nu) == near(cf.full_stick_shear(nu), rel=1e-8)
    assert cf.coupled_approach(0.5) == cf.smooth_approach()
    assert cf.coupled_shear(0.5) == 0.0
    np.testing.assert_array_equal(cf.coupled_pressure(0.5, s), cf.smooth_pressure(s))
    np.testing.assert_array_equal(cf.coupled_traction(0.5, s), np.zeros(4))


def test_coupled_fields_change_sign_and_have_no_limit_at_the_edge():
    d = np.logspace(-40, -1, 400)
    assert np.min(cf.coupled_pressure(0.0, from_edge=d)) < 0
    assert np.min(cf.coupled_traction(0.0, from_edge=d)) < 0
    assert math.isnan(cf.coupled_pressure(0.0, 1.0))
    assert math.isnan(cf.coupled_traction(0.0, 1.0))


def test_oscillation_exponent():
    assert cf.oscillation_exponent(0.0) == near(math.log(3) / (2 * math.pi), rel=1e-15)
    assert cf.oscillation_exponent(0.5) == 0.0


# -- the subpackage as a whole ---------------------------------------------------------------------

FIELDS = {
    "smooth_pressure": cf.smooth_pressure,
    "full_stick_traction": full_stick,
    "partial_slip_traction": slipping(2.0),
    "slip_displacement": lambda **where: cf.slip_displacement(NU, 2 * KAPPA, **where),
    "eigenfunction": lambda **where: cf.eigenfunction(3, 1, **where),
    "eigenfunction_image": lambda **where: cf.eigenfunction_image(3, 1, **where),
    "coupled_pressure": lambda **where: cf.coupled_pressure(NU, **where),
    "coupled_traction": lambda **where: cf.coupled_traction(NU, **where),
}


@pytest.mark.parametrize("field", FIELDS.values(), ids=FIELDS)
def test_fields_keep_the_shape_of_their_argument(field):
    s = np.array([[0.0, 1e-3, 0.25], [0.5, 0.75, 0.96875]])
    values = field(s=s)
    assert values.shape == s.shape
    # Coordinates are exact here, bar one; the two ways to give a point must agree.
    np.testing.assert_allclose(field(from_edge=1 - s), values, rtol=1e-12, atol=0)
    assert type(field(s=0.25)) is float
    assert field(s=0.25) == near(values[0, 2], rel=4 * EPS)
    assert field(s=[0.25]).shape == (1,)
    assert field(s=np.empty(0)).shape == (0,)
    assert field(s=np.array(0)) == pytest.approx(values[0, 0], rel=4 * EPS, abs=0)


@pytest.mark.parametrize("field", FIELDS.values(), ids=FIELDS)
def test_fields_refuse_points_off_the_disk(field):
    with pytest.raises(ValueError, match=r"s = 1\.5: must be in \[0, 1\]"):
        field(s=[0.5, 1.5])
    with pytest.raises(ValueError, match=r"from_edge = nan: must be in \[0, 1\]"):
        field(from_edge=math.nan)
    with pytest.raises(ValueError, match="either"):
        field(s=0.1, from_edge=0.9)
    with pytest.raises(ValueError, match="either"):
        field()
    with pytest.raises(ValueError, match=r"s = .*must be real numbers"):
        field(s="0.5")
    with pytest.raises(ValueError, match=r"s = .*must be real numbers .* of one shape"):
        field(s=[[0.1], [0.2, 0.3]])
    for hidden in ([0.5, True], np.ma.masked_array([0.1, 0.2], mask=[False, True])):
        with pytest.raises(ValueError, match=r"from_edge = .*neither masked nor boolean"):
            field(from_edge=hidden)


@pytest.mark.parametrize(
    "nu",
    [-1.0, 0.6, math.nan, "0.3", True, 10**400, 10**5000, np.timedelta64(0, "s"), np.zeros((9, 9))],
    ids=type,
)
@pytest.mark.parametrize(
    "function",
    [
        cf.full_stick_shear,
        lambda nu: cf.full_stick_traction(nu, 0.5),
        lambda nu: cf.stick_radius(nu, 0.1),
        lambda nu: cf.partial_slip_shear(nu, 0.1),
        lambda nu: cf.partial_slip_traction(nu, 0.1, 0.5),
        lambda nu: cf.slip_displacement(nu, 0.1, 0.5),
        cf.oscillation_exponent,
        cf.coupled_approach,
        cf.coupled_shear,
        lambda nu: cf.coupled_pressure(nu, 0.5),
        lambda nu: cf.coupled_traction(nu, 0.5),
    ],
)
def test_poisson_ratio_is_checked(function, nu):
    with pytest.raises(ValueError, match=r"poisson_ratio = .*in \(-1, 0\.5\]"):
        function(nu)


@pytest.mark.parametrize("friction", [-0.1, math.nan, None])
def test_friction_is_checked(friction):
    for function in (cf.stick_radius, cf.partial_slip_shear):
        with pytest.raises(ValueError, match=r"friction = .*>= 0"):
            function(NU, friction)
    for function in (cf.partial_slip_traction, cf.slip_displacement):
        with pytest.raises(ValueError, match=r"friction = .*>= 0"):
            function(NU, friction, 0.5)


@pytest.mark.parametrize("alpha", [0.0, -1.0, math.inf, math.nan, "1"])
def test_compliance_is_checked(alpha):
    for name in ("approach", "edge_pressure"):
        for end in ("large", "small"):
            with pytest.raises(ValueError, match=r"normal_compliance = .*> 0"):
                getattr(cf, f"{name}_{end}_compliance")(alpha)


@pytest.mark.parametrize("name", ["approach", "edge_pressure"])
def test_series_are_refused_where_they_make_no_sense(name):
    for end, alpha in [("large", 1e-3), ("large", 5e-324), ("small", 1e3), ("small", 1e308)]:
        with pytest.raises(ValueError, match=f"must be {end}"):
            getattr(cf, f"{name}_{end}_compliance")(alpha)


EXTREMES = [0.0, 5e-324, 1e-310, 1e-200, 1e-155, 1e-20, 1e-9, 0.3, 0.5, 0.9, 1 - EPS / 2, 1.0]


@pytest.mark.parametrize("friction", [0, 5e-324, 1e-300, 1e-4, 0.01, 0.3, 5, 1e17, 1.7e308])
@pytest.mark.parametrize("nu", [-0.999, 0.3, 0.5 - 2**-53, 0.5])
def test_nothing_overflows_or_warns_anywhere(nu, friction):
    stick = cf.stick_radius(nu, friction)
    assert 0 <= cf.partial_slip_shear(nu, friction) <= cf.full_stick_shear(nu) * (1 + EPS)
    for where in (
        {"s": np.array([*EXTREMES, stick.radius])},
        {"from_edge": np.array([*EXTREMES, stick.from_edge])},
    ):
        traction = cf.partial_slip_traction(nu, friction, **where)
        displacement = cf.slip_displacement(nu, friction, **where)
        assert np.all(traction >= 0)
        assert np.all(displacement <= 0)
        assert np.all(displacement > -1)


@pytest.mark.parametrize(
    ("degree", "order", "message"),
    [
        (1, 0, "even"),
        (2, 1, "odd"),
        (-2, 0, ">= 0"),
        (2, 2, "order = 2"),
        (2.0, 0, "degree = 2.0: must be an integer"),
        (1, True, "order = True: must be an integer"),
    ],
)
def test_degree_and_order_are_checked(degree, order, message):
    for function in (cf.eigenvalue, cf.eigenfunction, cf.eigenfunction_image):
        with pytest.raises(ValueError, match=message):
            function(degree, order, *([] if function is cf.eigenvalue else [0.5]))


def test_closed_forms_import_nothing_of_the_solver():
    allowed = {"numpy", "scipy", "mpmath"} | set(sys.stdlib_module_names)
    for path in Path(cf.__file__).parent.glob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and node.level:
                assert node.level == 1, path
            elif isinstance(node, ast.ImportFrom):
                assert node.module.split(".")[0] in allowed, path
            elif isinstance(node, ast.Import):
                assert all(alias.name.split(".")[0] in allowed for alias in node.names), path


def test_all_is_complete():
    public = {
        name
        for name, value in vars(cf).items()
        if not name.startswith("_") and not inspect.ismodule(value)
    }
    assert sorted(cf.__all__) == sorted(public)
    assert all(getattr(cf, name).__doc__ for name in public)
