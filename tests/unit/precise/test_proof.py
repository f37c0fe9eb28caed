"""Intervals that are proved: they hold numbers of other methods, whatever doubles they come from.

Oracles: gold tables, which were computed in fixed point by panels; the elliptic kernel.
"""

import pickle
import sys
from fractions import Fraction
from math import pi, sqrt

import flint
import numpy as np
import pytest
from scipy.special import eval_legendre, roots_legendre

import spectral_contact as sc
from spectral_contact import (
    ConvergenceError,
    MissingDependencyError,
    NotComputedError,
    Scene,
    gold,
    layers,
    profiles,
    proof,
)
from spectral_contact.equations.residuals import normal_displacement

#: Of both functions, some digits for each compliance, so that it takes few polynomials.
DIGITS = {1e-4: 10, 0.01: 14, 0.2: 16, 0.5: 16, 1.0: 18, 10.0: 20, 1e3: 23}
FLAT = [
    one
    for table in gold.tables()
    for one in table.solutions
    if one.scene.profile is None and not one.scene.couples and one.scene.unloaded_to == 1.0
]


def entry(compliance):
    return next(one for one in FLAT if one.scene.normal_compliance == compliance)


@pytest.mark.parametrize(("compliance", "digits"), DIGITS.items())
def test_they_hold_the_numbers_of_the_gold_tables(compliance, digits):
    known = entry(compliance)
    [edge] = [point.pressure for point in known.points if point.from_edge == 0.0]
    for enclose, value in (
        (proof.enclose_approach, known.approach),
        (proof.enclose_edge_pressure, edge),
    ):
        found = enclose(known.scene, digits)
        assert value in found
        assert found.width <= 10.0**-digits
        assert found.digits >= digits


def test_the_approach_of_one_half_to_nineteen_digits():
    found = proof.enclose_approach(Scene(0.3, 0.5), 19)
    first, last = "0.29295979691047814139856", "0.29295979691047814152130"
    assert Fraction(first) <= Fraction(str(found)[1:-1].split(", ")[0])
    assert Fraction(str(found)[1:-1].split(", ")[1]) <= Fraction(last)
    # a double is not exact enough to be in it
    assert abs(float(found.lower) - sc.solve(Scene(0.3, 0.5), 1e-12).approach) < 1e-15


def test_gold_tables_have_bounds_wherever_there_are_any():
    for table in gold.tables():
        for one in table.solutions:
            assert (one.approach_bounds is not None) == (one in FLAT)
    for one in FLAT:
        lower, upper = one.approach_bounds
        assert lower <= one.approach <= upper
    widths = [float((b - a) / b) for a, b in (one.approach_bounds for one in FLAT)]
    assert sum(width <= 2e-20 for width in widths) >= 70
    assert max(widths) < 1e-8


@pytest.mark.parametrize("compliance", [0.05, 0.5, 1e6])
def test_bounds_of_the_gold_tables_are_those_of_today(compliance):
    known = entry(compliance)
    found = proof.enclose_approach(known.scene)
    # both hold the same number, so they overlap
    assert found.lower <= known.approach_bounds[1]
    assert known.approach_bounds[0] <= found.upper


def expansion(compliance=0.2, terms=12):
    return proof._Expansion(flint, compliance, terms, 20)


def test_residuals_are_those_of_the_elliptic_kernel():
    with flint.ctx.workprec(proof._BITS):
        series = expansion(0.2, 4)
        trial = np.array([0.4, -0.3, 0.2, 0.1])
        found = series._residual(np.array([1.0, 0.0, 0.0, 0.0]), trial)

    def pressure(d):
        s = 1.0 - d
        return sum(a * eval_legendre(n, 2.0 * s * s - 1.0) for n, a in enumerate(trial))

    # y = 1 - s**2 at nodes that crowd at the edge, where the residual has y ln y
    nodes, weights = roots_legendre(40)
    t = (1.0 + nodes) / 2.0
    y = t**4
    measure = weights * t**3  # dy/2, of which s ds is one half
    depths = y / (1.0 + np.sqrt(1.0 - y))
    deflection = np.array([normal_displacement(pressure, d, []) for d in depths.tolist()])
    residual = 1.0 - 0.2 * pressure(depths) - deflection
    for k, product in enumerate(found.products):
        expected = measure @ (residual * eval_legendre(k, 1.0 - 2.0 * y))
        assert float(product) == pytest.approx(expected, rel=1e-10, abs=1e-12)
    assert float(found.squared.mid()) == pytest.approx(measure @ residual**2, rel=1e-6)


@pytest.mark.parametrize("terms", [4, 64])
def test_the_tail_is_inside_its_bound(terms, monkeypatch):
    unit = np.eye(1, terms)[0]
    with flint.ctx.workprec(proof._BITS):
        series = expansion(0.2, terms)
        few = series._residual(unit, series.trial).squared
        monkeypatch.setattr(proof, "_EXPANDED", 64)
        many = series._residual(unit, series.trial).squared
        assert few.lower() < many.lower()  # some of it is in the tail
        assert many.upper() < few.upper()


@pytest.mark.parametrize("size", [1e-3, 1e-5])
def test_wrong_coefficients_widen_it_by_their_square(size, monkeypatch):
    solve = proof._galerkin
    rng = np.random.default_rng(1)

    def wrong(compliance, source, digits):
        found = solve(compliance, source, digits)
        return found * (1.0 + size * rng.uniform(-1.0, 1.0, found.shape))

    monkeypatch.setattr(proof, "_galerkin", wrong)
    monkeypatch.setattr(proof, "_MOST_TERMS", proof._FEWEST_TERMS)
    known = entry(0.5)
    [edge] = [point.pressure for point in known.points if point.from_edge == 0.0]
    for enclose, value in (
        (proof.enclose_approach, known.approach),
        (proof.enclose_edge_pressure, edge),
    ):
        with pytest.raises(ConvergenceError) as caught:
            enclose(known.scene)
        found = caught.value.solution
        assert value in found
        assert 1e-3 * size**2 < found.width < 10.0 * size**2


def test_what_is_not_narrow_enough_is_said_and_kept(monkeypatch):
    monkeypatch.setattr(proof, "_MOST_TERMS", 512)
    with pytest.raises(ConvergenceError, match=r"^\d+ of 20 digits are proved with 512") as caught:
        proof.enclose_approach(Scene(0.3, 0.01))
    assert entry(0.01).approach in caught.value.solution


def test_smooth_contact_is_the_closed_form():
    found = proof.enclose_approach(Scene(0.3))
    assert (found.lower, found.upper, found.terms, found.digits) == (0.125, 0.125, 0, None)
    assert str(found) == "[0.125, 0.125]"
    with pytest.raises(NotComputedError, match="infinite"):
        proof.enclose_edge_pressure(Scene(0.3))


def test_below_the_largest_load_they_are_in_its_units():
    """As `Solution` is: both fall in proportion to the load."""
    largest = Scene(0.3, 0.5, 0.5, 0.05)
    unloaded = largest.replace(unloaded_to=0.75)
    for enclose in (proof.enclose_approach, proof.enclose_edge_pressure):
        full, less = enclose(largest, 12), enclose(unloaded, 12)
        assert less.lower <= 0.75 * full.upper
        assert 0.75 * full.lower <= less.upper
    smooth = proof.enclose_approach(Scene(0.3, 0.0, 0.5, 0.05, unloaded_to=0.75))
    assert smooth.lower == smooth.upper == 0.09375


@pytest.mark.parametrize("compliance", [1e-11, 1e-14])
def test_of_the_thinnest_layers_few_digits_are_proved(compliance, monkeypatch):
    monkeypatch.setattr(proof, "_MOST_TERMS", 1024)
    scene = Scene(0.3, compliance)
    with pytest.raises(ConvergenceError, match="of 20 digits are proved with 1024") as caught:
        proof.enclose_edge_pressure(scene)
    found = caught.value.solution
    # within a part in 1e9 of the limit of small compliances (docs/theory)
    assert found.lower * (1.0 + 1e-9) <= 0.25 / sqrt(pi * compliance)
    assert 0.25 / sqrt(pi * compliance) <= found.upper * (1.0 + 1e-9)
    assert 0.0 < found.lower < found.upper < 16.0 * found.lower


def test_friction_and_poissons_ratio_do_not_matter():
    bare = proof.enclose_approach(Scene(0.3, 1.0), 12)
    assert proof.enclose_approach(Scene(0.1, 1.0, 0.5, 0.2), 12) == bare
    assert proof.enclose_approach(Scene(0.5, 1.0, 0.5, 0.2, coupling=True), 12) == bare


@pytest.mark.parametrize(
    ("scene", "reason"),
    [
        (Scene(0.3, 0.5, profile=profiles.Parabola(1.0), load=1.0), "a profile"),
        (Scene(0.3, 0.5, 0.5, 0.2, coupling=True), "elastic coupling"),
        (
            Scene(0.3, layer=layers.Linear(0.5), profile=profiles.Flat(1.0), load=1.0),
            "a profile",
        ),
    ],
)
def test_other_scenes_are_refused(scene, reason):
    for enclose in (proof.enclose_approach, proof.enclose_edge_pressure):
        with pytest.raises(NotComputedError, match=reason):
            enclose(scene)


@pytest.mark.parametrize("digits", [0, 31, 2.5, "20"])
def test_digits_are_checked(digits):
    with pytest.raises(sc.SceneError, match="digits"):
        proof.enclose_approach(Scene(0.3, 0.5), digits)


def test_no_scene_is_refused():
    with pytest.raises(sc.SceneError, match="a Scene"):
        proof.enclose_approach(0.5)


def test_without_flint_it_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "flint", None)
    with pytest.raises(MissingDependencyError, match=r"\[proof\]"):
        proof.enclose_approach(Scene(0.3, 0.5))


def test_the_precision_of_others_is_left_alone():
    before = flint.ctx.prec
    proof.enclose_approach(Scene(0.3, 1e3), 10)
    assert flint.ctx.prec == before


def test_ends_are_rounded_outward():
    found = proof.enclose_approach(Scene(0.3, 1.0), 12)
    lower, upper = map(Fraction, str(found)[1:-1].split(", "))
    exact = [Fraction(int(end.man)) * Fraction(2) ** end.exp for end in (found.lower, found.upper)]
    assert lower <= exact[0] < exact[1] <= upper
    assert upper - lower <= Fraction(102, 100) * (exact[1] - exact[0])


def test_pickles_keep_every_bit():
    found = proof.enclose_approach(Scene(0.3, 1.0), 12)
    again = pickle.loads(pickle.dumps(found))
    assert again == found
    assert str(again) == str(found)
    assert again.lower.man_exp == found.lower.man_exp


def test_the_identity_of_the_edge_pressure():
    """2 pi alpha p(1)**2 = delta + alpha d delta/d alpha, by differences of enclosures."""
    alpha, step = 0.5, 2.0**-14
    ends = [proof.enclose_approach(Scene(0.3, alpha + sign * step), 17) for sign in (-1, 1)]
    middle = proof.enclose_approach(Scene(0.3, alpha), 17)
    slope = float(ends[1].lower - ends[0].lower) / (2.0 * step)
    edge = float(proof.enclose_edge_pressure(Scene(0.3, alpha), 12).lower)
    # the error of the difference is step**2/6 times the third derivative
    assert 2.0 * pi * alpha * edge**2 == pytest.approx(
        float(middle.lower) + alpha * slope, rel=1e-8
    )
