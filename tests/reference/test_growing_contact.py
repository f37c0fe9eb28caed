"""Friction under a growing contact: an incremental march, closed forms, the law, identities."""

import functools
import math
from dataclasses import replace

import numpy as np
import pytest
from oracles.growing_rings import march
from scipy.integrate import quad

from spectral_contact import NotComputedError, Scene, Solution, plan, profiles, solve
from spectral_contact.solving.stages import Stages

NU = 0.3
KAPPA = Scene(NU).kappa
PARABOLA, CONE = profiles.Parabola(1.0), profiles.Cone(1.0)
ROUNDED = profiles.RoundedFlat(0.5, 1.0)
TABLE = profiles.Sampled.from_points((0.0, 0.3, 0.6, 1.3), (0.0, 0.04, 0.2, 1.2))


@functools.cache
def solved(profile, alpha, beta, friction, rtol=1e-4, radius=1.0):
    scene = Scene(NU, alpha, beta, friction, profile=profile, contact_radius=radius)
    return solve(scene, rtol)


CASES = [(0.2, 0.2, math.inf), (0.2, 0.2, 0.05), (0.2, 0.1, 0.1)]


TWO_POWERS = profiles.Sum(profiles.Cone(1.56), PARABOLA)


@pytest.mark.parametrize("compliance", [100.0, 1e6])
@pytest.mark.parametrize(
    ("profile", "radius"), [(TWO_POWERS, 1.0), (profiles.Sphere(1.0), 0.99)], ids=["sum", "sphere"]
)
def test_a_thick_layer_takes_all_of_the_displacement(profile, radius, compliance):
    """Then p = (h(a) - h)/alpha, and q is kappa r/(2 beta) times that, as all sticks (G.9)."""
    scene = Scene(NU, compliance, compliance, math.inf, profile=profile, contact_radius=radius)
    solution = solve(scene, 1e-8)
    assert solution.converged
    for found, power, factor in (
        (solution.load, 1, 2.0 * math.pi),
        (solution.total_shear, 2, math.pi * KAPPA / compliance),
    ):
        integral, _ = quad(
            lambda r, power=power: r**power * (profile.height(radius) - profile.height(r)),
            0.0,
            radius,
            epsrel=1e-10,
        )
        # the elastic body yields a little, in proportion to 1/alpha
        assert found == pytest.approx(factor * integral / compliance, rel=5.0 / compliance)


@pytest.mark.parametrize(("alpha", "beta", "friction"), CASES)
def test_an_incremental_march_converges_to_it_at_first_order(alpha, beta, friction):
    """Which knows no superposition: rings that enter, stick where they are, and slip by the law."""
    solution = solved(PARABOLA, alpha, beta, friction)
    steps = [march(PARABOLA.height, alpha, beta, KAPPA, friction, n) for n in (40, 80, 160)]
    off = np.array([one.shear / solution.total_shear - 1.0 for one in steps])
    assert off[1] / off[2] == pytest.approx(2.0, abs=0.07)
    # without the error of first order, and without the next one
    assert abs(2.0 * off[2] - off[1]) < 1e-3
    if friction == math.inf:
        assert abs(8.0 * off[2] - 6.0 * off[1] + off[0]) / 3.0 < 1e-4
    assert steps[2].stick_radius == pytest.approx(solution.stick_radius, abs=1.01 / 160)
    # one ring in ten, but for those at the edges of zones and of the contact
    some = np.arange(5, 150, 10)
    found = solution.traction(steps[2].middles[some])
    extrapolated = 1.5 * np.abs(found).max() * np.abs(off[2])
    assert np.abs(steps[2].traction[some] - found).max() < 4.0 * extrapolated


@pytest.mark.parametrize(
    ("profile", "friction"),
    [(PARABOLA, 0.2), (CONE, math.inf), (profiles.PowerLaw(0.4, 3.0), math.inf)],
)
def test_a_smooth_surface_keeps_the_stick_radius_of_the_flat_punch(profile, friction):
    """Spence: c/a is the same for every profile, and so is the shear over the load."""
    flat = solve(Scene(NU, friction=friction), 1e-12)
    solution = solved(profile, 0.0, 0.0, friction)
    assert solution.stick_radius == pytest.approx(flat.stick_radius, rel=1e-10)
    assert solution.total_shear == pytest.approx(flat.total_shear * solution.load, rel=1e-7)
    off = abs(solution.total_shear / (flat.total_shear * solution.load) - 1.0)
    assert off <= solution.error.total_shear


def test_the_traction_under_a_smooth_parabola_is_an_integral_of_elementary_functions():
    """Full stick: int q*(r/b) dP/b^2 with q* = -kappa ln(1 - s^2)/(pi^2 s sqrt(1 - s^2))."""
    solution = solved(PARABOLA, 0.0, 0.0, math.inf)
    x, w = np.polynomial.legendre.leggauss(200)
    for s in (0.2, 0.6, 0.95):
        # b = s/sqrt(1 - y), y = top v^8, so that the root is gone and the logarithm is weak
        top = 1.0 - s**2
        v = (1.0 + x) / 2.0
        y = top * v**8
        inside, b = np.sqrt(1.0 - y), s / np.sqrt(1.0 - y)
        flat = -KAPPA / math.pi**2 * np.log(y) / (inside * np.sqrt(y))
        growth = 16.0 * b**2 / b**2 * s / (2.0 * (1.0 - y) ** 1.5) * 8.0 * top * v**7
        truth = float(w @ (flat * growth)) / 2.0
        found = float(solution.traction(s))
        assert found == pytest.approx(truth, rel=1e-6)
        # relative to the largest
        assert abs(found - truth) <= solution.error.traction * solution.traction(0.7)


@pytest.mark.parametrize(
    ("alpha", "beta", "friction", "profile"),
    [(*CASES[1], PARABOLA), (*CASES[2], PARABOLA), (*CASES[1], CONE)],
)
def test_the_law_holds_everywhere_and_the_shear_is_the_integral(alpha, beta, friction, profile):
    solution = solved(profile, alpha, beta, friction)
    c = solution.stick_radius
    assert [zone.kind for zone in solution.zones] == ["stick", "slip"]
    s = np.concatenate([np.linspace(0.0, 1.0, 201), c * (1.0 - 10.0 ** -np.arange(2.0, 9.0))])
    q, limit = solution.traction(s), friction * solution.pressure(s)
    size = float(q.max())
    assert (np.abs(q) <= limit + solution.error.traction * size).all()
    assert np.abs(q - limit)[s > c].max() <= 1e-15
    assert np.abs(solution.traction(c * (1 - 1e-9)) - solution.traction(c * (1 + 1e-9))) < 1e-7
    x, w = np.polynomial.legendre.leggauss(300)
    total = 0.0
    for low, high in ((0.0, c), (c, 1.0)):  # Gauss's rule, denser at the ends
        phi = math.pi / 4.0 * (1.0 + x)
        at, share = low + (high - low) * np.sin(phi) ** 2, np.sin(2.0 * phi) * math.pi / 4.0
        total += 2.0 * math.pi * (high - low) * float(w @ (share * at * solution.traction(at)))
    assert solution.total_shear == pytest.approx(total, rel=1e-6)


def test_true_errors_are_within_their_estimates():
    s = np.linspace(0.0, 1.0, 101)
    for case in CASES[:1]:
        best, rough = (solved(PARABOLA, *case, rtol) for rtol in (1e-5, 1e-3))
        truth = best.traction(s)
        off = np.abs(rough.traction(s) - truth).max() / truth.max()
        assert off <= rough.error.traction + best.error.traction
        off = abs(rough.total_shear / best.total_shear - 1.0)
        assert off <= rough.error.total_shear + best.error.total_shear
        assert rough.error.total_shear <= 1e-3


def test_solutions_with_friction_round_trip():
    solution = solved(PARABOLA, 0.2, 0.2, 0.05)
    assert Solution.from_json(solution.to_json()) == solution


def test_where_superposition_fails_it_says_at_which_radius():
    scene = Scene(NU, 0.0, 0.2, 0.1, profile=PARABOLA, contact_radius=1.0)
    with pytest.raises(NotComputedError, match=r"at the contact radius 0\.\d+ slip does not"):
        solve(scene, 1e-3)


def test_what_slides_freely_has_no_traction():
    sliding = solve(Scene(NU, 0.2, friction=0.0, profile=ROUNDED, load=1.0), 1e-6)
    assert sliding.total_shear == 0.0
    assert [zone.kind for zone in sliding.zones] == ["slip"]
    with pytest.raises(NotComputedError, match="not computed at friction 0 under a profile"):
        sliding.slip(0.5)


def test_the_march_converges_past_a_flat_part():
    solution = solved(ROUNDED, 0.2, 0.2, math.inf)
    steps = [march(ROUNDED.height, 0.2, 0.2, KAPPA, math.inf, n) for n in (50, 100, 200)]
    off = np.array([one.shear / solution.total_shear - 1.0 for one in steps])
    assert off[1] / off[2] == pytest.approx(2.0, abs=0.2)
    assert abs(8.0 * off[2] - 6.0 * off[1] + off[0]) / 3.0 < 2e-4
    some = np.array([10, 50, 80, 95, 105, 120, 150, 180])
    found = solution.traction(steps[2].middles[some])
    assert np.abs(steps[2].traction[some] - found).max() < 0.015 * found.max()


def sunk(profile, b):
    """Return ``d delta/db`` of a smooth surface: half the derivative of H."""
    return float(profile._rate(np.array([b]), np.array([b**2 - profile.flat_part**2]))[0]) / 2.0


@pytest.mark.parametrize(
    "profile", [profiles.RoundedFlat(0.5, 1.0), profiles.TruncatedCone(0.5, 1.0)]
)
def test_the_traction_past_a_corner_is_an_integral_of_elementary_functions(profile):
    """Full stick on a smooth surface: int q*(r/b) 8 ddelta/b over all radii past the flat part."""
    solution = solved(profile, 0.0, 0.0, math.inf)
    x, w = np.polynomial.legendre.leggauss(400)
    for r in (0.2, 0.45, 0.55, 0.8):
        # b goes like a high power of v where the flat punch's traction is infinite at its edge
        start = max(r, 0.5)
        v = (1.0 + x) / 2.0
        b = start + (1.0 - start) * v**6
        past = (1.0 - start) * v**6 * (start + b) + (start - r) * (start + r)
        y = past / b**2
        flat = -KAPPA / math.pi**2 * np.log(y) / (r / b * np.sqrt(y))
        rates = np.array([sunk(profile, one) for one in b])
        truth = float(w @ (flat * 8.0 * rates / b * 6.0 * (1.0 - start) * v**5)) / 2.0
        assert float(solution.traction(r)) == pytest.approx(truth, rel=2e-5)
    flat_shear = solve(Scene(NU, friction=math.inf), 1e-10, ["total_shear"]).total_shear
    off = abs(solution.total_shear / (flat_shear * solution.load) - 1.0)
    assert off <= min(solution.error.total_shear, 1e-6)


def test_a_traction_is_not_known_better_than_those_of_the_flat_punches_in_it(monkeypatch):
    """It is linear in them: if all are wrong by a factor, it is wrong by that factor."""
    scene = Scene(NU, 0.2, 0.1, math.inf, profile=PARABOLA, contact_radius=1.0)
    quantities, s, off = ("traction",), np.linspace(0.05, 1.0, 20), 1e-3
    true = solve(scene, 1e-4, quantities)
    original = Stages.flat

    def wrong(stages, radius):
        flat = original(stages, radius)
        field = flat.traction_field.times(1.0 + off)
        return replace(flat, traction_field=field, error=replace(flat.error, traction=off))

    monkeypatch.setattr(Stages, "flat", wrong)
    found = solve(scene, 1e-4, quantities, strict=False)
    apart = np.abs(found.traction(s) - true.traction(s)).max() / np.abs(true.traction(s)).max()
    assert apart == pytest.approx(off, rel=1e-6)
    assert apart <= found.error.traction
    assert true.error.traction < 0.1 * off


def test_a_table_has_the_shear_of_every_profile():
    scene = Scene(NU, friction=0.2, profile=TABLE, contact_radius=1.0)
    solution = solve(scene, 1e-4, ["total_shear", "load", "stick_radius"])
    flat = solve(Scene(NU, friction=0.2), 1e-10)
    assert solution.stick_radius == pytest.approx(flat.stick_radius, rel=1e-9)
    off = abs(solution.total_shear / (flat.total_shear * solution.load) - 1.0)
    assert off <= min(solution.error.total_shear, 1e-6)


def test_the_law_holds_around_what_stuck_when_a_break_was_passed():
    solution = solved(ROUNDED, 0.0, 0.0, 0.2)
    flat = solve(Scene(NU, friction=0.2), 1e-10)
    c = solution.stick_radius
    assert c == pytest.approx(flat.stick_radius, rel=1e-9)
    off = abs(solution.total_shear / (flat.total_shear * solution.load) - 1.0)
    assert off <= min(solution.error.total_shear, 1e-5)
    s = np.unique([*np.linspace(0.01, 0.99, 99), 0.5, 0.5 * c - 1e-6, 0.5 * c + 1e-6])
    q, limit = solution.traction(s), 0.2 * solution.pressure(s)
    assert (np.abs(q) <= limit + 1e-5 * q.max()).all()
    assert np.abs(q - limit)[s > c].max() <= 1e-14
    assert np.abs(solution.slip(np.linspace(0.0, 0.4999 * c, 9))).max() == 0.0
    for r in (0.45, 0.55, 0.8, 0.95):  # int u*(r/b) 8 ddelta, from first contact to stick
        x, w = np.polynomial.legendre.leggauss(200)
        start, end = max(r, 0.5), min(r / c, 1.0)
        b = start + (end - start) * (1.0 + x) ** 4 / 16.0
        rates = np.array([sunk(ROUNDED, one) for one in b]) * (1.0 + x) ** 3 / 4.0
        truth = 8.0 * (end - start) * float(w @ (flat.slip(r / b) * rates))
        assert float(solution.slip(r)) == pytest.approx(truth, rel=1e-6)
    for one in (0.5, 0.5 * c):
        if one < c:
            jump = solution.traction(one * (1.0 + 1e-9)) - solution.traction(one * (1.0 - 1e-9))
            assert abs(jump) < 1e-5 * q.max()


def test_an_incompressible_body_has_no_traction():
    solution = solve(Scene(0.5, 0.2, 0.2, 0.1, profile=PARABOLA, contact_radius=1.0), 1e-6)
    assert solution.total_shear == 0.0
    assert solution.traction(0.5) == 0.0


def test_the_plan_runs_the_history_for_what_needs_it_only():
    scene = Scene(NU, 0.2, 0.2, 0.05, profile=PARABOLA, contact_radius=1.0)
    states = {step.name: step.state.value for step in plan(scene, ["load"]).steps}
    assert states == {"normal contact": "run", "growing contact": "skipped"}
    assert plan(scene, ["zones"]).steps[1].state.value == "run"
    assert solve(scene, 1e-6, ["load"]).load > 0.0


@pytest.mark.parametrize("short", [1e-2, 1e-7])
def test_a_smooth_sphere_next_to_its_equator_shears_like_every_profile(short):
    """Where the load has a pole as a function of the radius."""
    flat = solve(Scene(0.3, friction=0.5), 1e-10)
    scene = Scene(0.3, friction=0.5, profile=profiles.Sphere(1.3), contact_radius=1.3 * (1 - short))
    solution = solve(scene, 1e-6, ("load", "total_shear", "stick_radius"))
    shear = solution.load * flat.total_shear
    assert abs(solution.total_shear / shear - 1.0) <= solution.error.total_shear + 1e-9
    assert solution.stick_radius == pytest.approx(flat.stick_radius, rel=1e-9)


@pytest.mark.parametrize("coupling", [False, True])
@pytest.mark.parametrize(
    ("profile", "radius", "rtol"),
    [
        (profiles.RoundedFlat(0.5, 1.0), 0.5 * (1.0 + 1e-11), 1e-4),
        (profiles.RoundedFlat(0.5, 1.0), 0.5 * (1.0 + 1e-9), 1e-9),
        (profiles.Sphere(1.0), 1.0 - 1e-12, 1e-4),
    ],
)
def test_a_radius_that_has_too_few_digits_is_refused(profile, radius, rtol, coupling):
    """At the end of a flat part, and at the equator of a sphere."""
    scene = Scene(0.2, 0.1, 0.1, 0.1, coupling=coupling, profile=profile, contact_radius=radius)
    with pytest.raises(NotComputedError, match=r"contact radius is within .* too close for rtol"):
        solve(scene, rtol)


def test_a_high_power_in_a_small_unit_of_length_has_its_shear():
    """The radius to the power 33 is not a double, and the shear was none."""
    shears = []
    for unit in (1.0, 1e-9):
        profile = profiles.PowerLaw(0.1 * unit**-32, 33.0)
        found = solved(profile, 1e-3 * unit, 1e-3 * unit, 0.3, 1e-5, unit)
        assert found.converged
        shears.append(found.total_shear / unit**2)
    assert shears[1] == pytest.approx(shears[0], rel=1e-12)


def test_pressure_and_traction_have_the_same_breaks_in_any_unit_of_length():
    """Those of the traction came from logarithms of radii, and differed by their rounding."""
    for unit in (1.0, 1e-6):
        found = solved(
            profiles.RoundedFlat(unit, unit), 0.01 * unit, 0.01 * unit, math.inf, 1e-3, 1.05 * unit
        )
        breaks = [
            {piece.outer for piece in field.pieces}
            for field in (found.pressure_field, found.traction_field)
        ]
        assert len(breaks[0]) == 2
        assert breaks[0] == breaks[1]
