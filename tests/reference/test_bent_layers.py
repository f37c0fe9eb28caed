"""Contact through layers whose law bends inside the contact, against collocation.

The oracle (`oracles.bent_collocation`) shares no code with the library, and finds the radii at
which the law bends itself.
"""

import math
from itertools import pairwise

import numpy as np
import pytest
from oracles.bent_collocation import Law, solved
from scipy.interpolate import PchipInterpolator

from spectral_contact import Scene, layers, profiles, solve
from spectral_contact.contact.layered_contact import BentProblem
from spectral_contact.contact.layered_setting import setting_at_approach, setting_at_radius
from spectral_contact.contact.refine import refine

BALL, FLAT = profiles.Parabola(1.0), profiles.Flat(1.0)
#: Both examples that once were wrong by 1e-6 and 1e-8, with claims of 1e-11.
SQUARES = layers.Table((0, 1, 2, 3), (0, 1, 4, 9))
UNEVEN = layers.Table((-1, 0, 1, 2, 3, 5), (0, 0.5, 1.2, 4, 9, 20))
#: Rounding of the oracle.
ROUNDING = 3e-14


def table_law(table):
    """Return SciPy's interpolant of a table."""
    w = table.overclosures
    inner = PchipInterpolator(w, table.pressures)
    derivative, integral = inner.derivative(), inner.antiderivative()

    def within(function, at):
        return np.where(at < w[0], 0.0, function(np.clip(at, w[0], w[-1])))

    def pressure(at):
        return within(inner, at) + np.maximum(at - w[-1], 0.0) * derivative(w[-1])

    return Law(
        pressure, lambda at: within(derivative, at), lambda at: within(integral, at), w[1:-1]
    )


def kinked(knot, slope=1.0, limit=4.0):
    """Return a law of slope 1 that has another one more from a knot on, for both sides."""

    def pressure(w):
        return np.maximum(w, 0.0) + slope * np.maximum(w - knot, 0.0)

    def stiffness(w):
        return np.where(w > 0.0, 1.0, 0.0) + slope * np.where(w > knot, 1.0, 0.0)

    def energy(w):
        return np.maximum(w, 0.0) ** 2 / 2.0 + slope * np.maximum(w - knot, 0.0) ** 2 / 2.0

    layer = layers.Sampled.from_functions(pressure, stiffness, start=0.0, limit=limit, knots=[knot])
    return layer, Law(pressure, stiffness, energy, (knot,))


def asperities():
    """Return exponential heights, whose law bends at 0, for both sides."""
    layer = layers.GreenwoodWilliamson(0.3, 0.5, 0.1, "exponential")
    return layer, Law(layer._pressure, layer._slope, layer._energy, (0.0,))


def assert_honest(solution, truth, *, pressure=True):
    for name, value in (
        ("approach", truth.approach),
        ("load", truth.load),
        ("indentation_work", truth.work),
        ("stiffness", truth.stiffness),
    ):
        known = truth.error[name.removeprefix("indentation_")] + ROUNDING
        assert abs(getattr(solution, name) / value - 1.0) <= getattr(solution.error, name) + known
    if pressure:
        radius = solution.contact_radius
        off = np.abs(solution.pressure(np.minimum(truth.r / radius, 1.0)) - truth.pressure)
        mean = truth.load / (math.pi * radius**2)
        size = np.maximum(truth.pressure, mean)
        known = (truth.error["pressure"] + 1e-12) * truth.pressure.max()
        assert (off <= solution.error.pressure * size + known).all()


@pytest.mark.parametrize("rtol", [1e-4, 1e-6, 1e-8])
def test_a_ball_on_a_table_has_the_load_of_collocation(rtol):
    solution = solve(Scene(0.3, layer=SQUARES, profile=BALL, approach=3.0), rtol)
    assert solution.converged
    assert solution.load == pytest.approx(14.062171047, rel=max(solution.error.load, 1e-10))
    truth = solved(table_law(SQUARES), BALL._height, solution.contact_radius, start=0.0)
    moved = solution.error.contact_radius * solution.contact_radius
    assert abs(truth.approach - 3.0) <= moved * 3.0 + 1e-12
    if rtol == 1e-8:
        assert abs(solution.load / truth.load - 1.0) <= solution.error.load + ROUNDING
        assert abs(solution.stiffness / truth.stiffness - 1.0) <= solution.error.stiffness + 1e-12


@pytest.mark.parametrize("control", ["approach", "load"])
def test_a_flat_punch_on_a_table_has_the_load_of_collocation(control):
    truth = solved(table_law(UNEVEN), FLAT._height, 1.0, approach=1.6)
    assert truth.load == pytest.approx(4.0302447125, abs=1e-10)
    assert len(truth.bends) == 1
    given = {control: {"approach": 1.6, "load": truth.load}[control]}
    solution = solve(Scene(0.3, layer=UNEVEN, profile=FLAT, **given), rtol=1e-8)
    assert solution.converged
    assert_honest(solution, truth, pressure=False)


@pytest.mark.parametrize(
    ("layer", "how"),
    [
        (SQUARES, {"profile": BALL, "approach": 2.5}),
        (UNEVEN, {"profile": FLAT, "load": 5.0}),
        (kinked(0.2)[0], {"profile": profiles.Cone(1.0), "load": 0.5}),
    ],
)
def test_tolerances_do_not_contradict_each_other(layer, how):
    found = [solve(Scene(0.3, layer=layer, **how), rtol) for rtol in (1e-4, 1e-7, 1e-10)]
    for name in ("load", "approach", "stiffness", "indentation_work"):
        for one, other in pairwise(found):
            allowed = getattr(one.error, name) + getattr(other.error, name)
            assert abs(getattr(one, name) / getattr(other, name) - 1.0) <= allowed, name


def test_bends_next_to_the_centre_and_next_to_the_edge():
    """The largest overclosure without a kink is 0.3416.."""
    smooth, _ = kinked(3.0)
    deepest = float(solve(Scene(0.3, layer=smooth, profile=BALL, contact_radius=1.0)).pressure(0.0))
    for knot in (deepest * (1.0 - 1e-8), deepest * (1.0 + 1e-8), deepest - 1e-3, 1e-7):
        layer, law = kinked(knot)
        truth = solved(law, BALL._height, 1.0, start=0.0)
        assert len(truth.bends) == (knot < deepest)
        solution = solve(Scene(0.3, layer=layer, profile=BALL, contact_radius=1.0), rtol=1e-8)
        assert solution.converged
        assert_honest(solution, truth)


def test_a_knot_may_be_met_at_two_radii():
    """Under a rounded flat the overclosure is largest inside, next to where it is met twice."""
    profile = profiles.RoundedFlat(0.5, 1.0)
    smooth, _ = kinked(3.0)
    plain = solve(Scene(0.3, layer=smooth, profile=profile, contact_radius=1.0))
    deepest = float(plain.pressure(np.linspace(0.0, 1.0, 4001)).max())
    assert deepest > plain.pressure(0.0)
    layer, law = kinked(deepest - 1e-5)
    truth = solved(law, profile._height, 1.0, start=0.0, breaks=profile.breaks)
    assert len(truth.bends) == 2
    solution = solve(Scene(0.3, layer=layer, profile=profile, contact_radius=1.0), rtol=1e-8)
    assert solution.converged
    assert_honest(solution, truth)


@pytest.mark.parametrize("control", ["approach", "separation"])
def test_exponential_heights_bend_where_the_surfaces_would_meet(control):
    layer, law = asperities()
    solution = solve(Scene(0.3, layer=layer, profile=BALL, approach=0.6), rtol=1e-8)
    cuts = (0.9, 1.7)
    truth = solved(law, BALL._height, solution.domain_radius, approach=0.6, breaks=cuts)
    assert len(truth.bends) == 1
    if control == "separation":
        at_centre = -layer.overclosure(float(solution.pressure(0.0)))
        solution = solve(Scene(0.3, layer=layer, profile=BALL, separation=at_centre), rtol=1e-6)
    assert solution.converged
    assert_honest(solution, truth, pressure=False)


@pytest.mark.parametrize(("profile", "given"), [(BALL, {"start": 0.0}), (FLAT, {"approach": 0.6})])
def test_bends_that_no_part_ends_at_are_in_the_estimate(profile, given):
    layer, law = kinked(0.2 if profile is BALL else 0.42)
    truth = solved(law, profile._height, 1.0, **given)
    assert truth.bends
    setting = (
        setting_at_approach(profile, layer, 0.6)
        if "approach" in given
        else setting_at_radius(profile, layer, 1.0)
    )
    problem = BentProblem(setting, 1e-8, pointwise=False, final=True)
    left = refine(problem, 1e-8, 4_000).best
    assert left.error > 1e-6
    for name in ("approach", "load", "work", "stiffness"):
        off = abs(getattr(left.value, name) / getattr(truth, name) - 1.0)
        assert off <= getattr(left.value, f"{name}_error") + ROUNDING, name


def test_full_stick_on_a_table_does_not_contradict_itself():
    how = {"layer": UNEVEN, "profile": FLAT, "approach": 1.6, "tangential_compliance": 0.2}
    found = [
        solve(Scene(0.3, friction=math.inf, **how), rtol, strict=False) for rtol in (1e-4, 1e-8)
    ]
    assert found[0].converged
    off = abs(found[0].total_shear / found[1].total_shear - 1.0)
    assert off <= found[0].error.total_shear + found[1].error.total_shear
    s = np.linspace(0.05, 1.0, 200)
    off = np.abs(found[0].traction(s) / found[1].traction(s) - 1.0)
    assert (off <= found[0].error.traction + found[1].error.traction).all()


@pytest.mark.parametrize("limit", [0.3, 4.0, 30.0])
def test_a_law_that_is_sampled_far_beyond_the_overclosure_has_room_for_it(limit):
    law = Law(
        lambda w: np.maximum(w, 0.0) + 1.6 * np.maximum(w, 0.0) ** 3,
        lambda w: np.where(w > 0.0, 1.0 + 4.8 * np.maximum(w, 0.0) ** 2, 0.0),
        lambda w: np.maximum(w, 0.0) ** 2 / 2.0 + 0.4 * np.maximum(w, 0.0) ** 4,
        (),
    )
    layer = layers.Sampled.from_functions(law.pressure, law.slope, start=0.0, limit=limit)
    solution = solve(Scene(0.3, layer=layer, profile=BALL, contact_radius=0.5), 1e-9, strict=False)
    assert solution.converged == (limit < 30.0)
    assert_honest(solution, solved(law, BALL._height, 0.5, start=0.0))


def test_steps_that_go_to_and_fro_are_halved():
    w = [-0.195, -0.18, -0.153, -0.126, -0.104, -0.0792, -0.0533, -0.0296, -0.0235, 0.779]
    p = [0.0, 1.47, 4.76, 7.58, 8.03, 14.1, 17.4, 18.7, 19.4, 272.0]
    table = layers.Table(w, p)
    cone = profiles.Cone(0.694)
    solution = solve(Scene(0.3, layer=table, profile=cone, contact_radius=0.54), 1e-6)
    assert solution.converged
    truth = solved(table_law(table), cone._height, 0.54, start=w[0], pointed=True)
    assert_honest(solution, truth)
