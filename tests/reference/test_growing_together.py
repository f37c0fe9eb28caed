"""A growing contact with elastic coupling: a march in increments, Spence, the whole equations."""

import functools
import math

import numpy as np
import pytest
from oracles.growing_rings import march
from oracles.self_similar import superposed
from oracles.spence import Collocation

from spectral_contact import NotComputedError, Scene, plan, profiles, solve
from spectral_contact.equations import residuals
from spectral_contact.solving.outside import outside_displacement, outside_values

PARABOLA, CONE = profiles.Parabola(1.0), profiles.Cone(1.0)
TABLE = profiles.Sampled.from_points((0.0, 0.3, 0.6, 1.3), (0.0, 0.04, 0.2, 1.2))


@functools.cache
def solved(profile, alpha, beta, friction, rtol=1e-4, nu=0.0, **given):
    scene = Scene(
        nu,
        alpha,
        beta,
        friction,
        profile=profile,
        coupling=True,
        **(given or {"contact_radius": 1.0}),
    )
    return solve(scene, rtol)


def test_an_incremental_march_converges_to_full_stick_at_first_order():
    """Which knows neither superposition nor the Volterra equation."""
    solution = solved(PARABOLA, 0.2, 0.2, math.inf)
    counts = (40, 80, 160)
    steps = [march(PARABOLA.height, 0.2, 0.2, 0.25, math.inf, n, coupled=True) for n in counts]
    for name, its in (("load", "load"), ("total_shear", "shear"), ("approach", "approach")):
        truth = getattr(solution, name)
        off = np.array([getattr(one, its) / truth - 1.0 for one in steps])
        assert off[1] / off[2] == pytest.approx(2.0, abs=0.07), name
        assert abs(2.0 * off[2] - off[1]) < 1e-3, name
        # without the error of first order, and without the next one
        assert abs(8.0 * off[2] - 6.0 * off[1] + off[0]) / 3.0 < 1e-4, name
    last, some = steps[-1], np.arange(5, 150, 10)
    far = some < 145
    for found, rings in (
        (solution.pressure(last.middles[some]), last.pressure[some]),
        (solution.traction(last.middles[some]), last.traction[some]),
    ):
        assert np.abs(rings - found)[far].max() < 0.02 * np.abs(found).max()
    # what "u_r = 0 and p(1) = 0" would give instead is 2.3218 and 0.695
    assert solution.load == pytest.approx(2.2276, abs=5e-5)
    assert solution.total_shear == pytest.approx(0.392, abs=5e-4)


@pytest.mark.parametrize(
    ("profile", "compliance"), [(PARABOLA, 0.2), (profiles.PowerLaw(1.0, 1.5), 0.8)]
)
def test_normal_displacement_is_that_of_the_profile_all_over_the_contact(profile, compliance):
    """Pressure and traction of the whole history, in the normal equation of the final contact."""
    solution = solved(profile, compliance, 0.2, math.inf, 1e-6)
    scene = solution.scene
    for from_edge in (0.9, 0.5, 0.1, 1e-3):
        s = 1.0 - from_edge
        sunk = residuals.normal_displacement(lambda d: solution.pressure(from_edge=d), from_edge)
        pulled = _pull(solution, s) * scene.kappa
        found = scene.normal_compliance * solution.pressure(s) + sunk - pulled
        assert found == pytest.approx(solution.approach - profile.height(s), abs=1e-6)


def _pull(solution, s):
    """Return ``int_s^1 q``."""
    x, w = np.polynomial.legendre.leggauss(200)
    at = s + (1.0 - s) * np.sin(math.pi / 4.0 * (1.0 + x)) ** 2
    share = (1.0 - s) * np.sin(math.pi / 2.0 * (1.0 + x)) * math.pi / 4.0
    return float(w @ (share * solution.traction(at)))


def test_spence_on_a_smooth_surface():
    """The same c/a for every profile, the flat punch's; the paraboloid's is found directly, too."""
    oracle = Collocation(0.0, 0.5)
    friction = oracle.flat().friction
    assert oracle.paraboloid() == pytest.approx(friction, rel=1e-5)
    for profile in (PARABOLA, CONE):
        scene = Scene(0.0, friction=0.298714615962, profile=profile, coupling=True, load=2.0)
        solution = solve(scene, 1e-4, ["stick_radius"])
        assert solution.stick_radius == pytest.approx(0.5, rel=1e-10)
    ball = solved(PARABOLA, 0.0, 0.0, friction)
    hertz = 1.5 * ball.load / math.pi / (ball.load * 3.0 / 16.0) ** (2.0 / 3.0)
    assert float(ball.pressure(0.0)) / hertz == pytest.approx(1.31403, abs=1e-5)
    assert ball.opening is None


def test_full_stick_on_a_smooth_surface():
    solution = solved(PARABOLA, 0.0, 0.0, math.inf)
    assert solution.stiffness == pytest.approx(8.0 * math.log(3.0), rel=1e-12)
    hertz = 1.5 * solution.load / math.pi / (solution.load * 3.0 / 16.0) ** (2.0 / 3.0)
    assert float(solution.pressure(0.0)) / hertz == pytest.approx(1.30111, abs=1e-5)
    # homogeneous: delta goes like a**2, P like a**3
    assert solution.load == pytest.approx(
        2.0 / 3.0 * solution.stiffness * solution.approach, rel=1e-9
    )
    assert solution.indentation_work == pytest.approx(
        0.4 * solution.load * solution.approach, rel=1e-8
    )
    opens = solution.opening
    assert opens == pytest.approx(4.6e-4, rel=0.01)
    assert (
        float(solution.pressure(from_edge=0.9 * opens))
        < 0.0
        < float(solution.pressure(from_edge=1.1 * opens))
    )


@pytest.mark.parametrize("name", ["load", "approach"])
def test_what_is_given_is_what_comes_out(name):
    by_radius = solved(PARABOLA, 0.2, 0.2, math.inf, 1e-6)
    given = {name: getattr(by_radius, name)}
    found = solved(PARABOLA, 0.2, 0.2, math.inf, 1e-6, **given)
    assert getattr(found, name) == given[name]
    for other in ("contact_radius", "load", "approach", "total_shear", "stiffness"):
        off = abs(getattr(found, other) / getattr(by_radius, other) - 1.0)
        assert off <= getattr(found.error, other) + getattr(by_radius.error, other), other
        assert off < 1e-8, other


def test_without_a_shear_to_speak_of_it_is_normal_contact():
    given = {"profile": PARABOLA, "load": 1.0}
    almost = solve(Scene(0.4999, 0.2, 0.2, math.inf, coupling=True, **given), 1e-7)
    plain = solve(Scene(0.4999, 0.2, **given), 1e-10)
    for name in ("contact_radius", "approach", "stiffness", "indentation_work"):
        assert getattr(almost, name) == pytest.approx(getattr(plain, name), rel=1e-7), name


@pytest.mark.parametrize(
    ("profile", "compliance", "tolerances"),
    [(PARABOLA, 0.2, (1e-4, 1e-2)), (profiles.PowerLaw(1.0, 1.5), 0.8, (1e-8, 2e-3))],
)
def test_true_errors_are_within_their_estimates(profile, compliance, tolerances):
    s = np.linspace(0.0, 1.0, 101)
    best, rough = (solved(profile, compliance, 0.2, math.inf, rtol) for rtol in tolerances)
    mean = best.load / math.pi
    for name in ("load", "approach", "total_shear", "indentation_work"):
        off = abs(getattr(rough, name) / getattr(best, name) - 1.0)
        assert off <= getattr(rough.error, name) + getattr(best.error, name), name
    p, q = best.pressure(s), best.traction(s)
    off = (np.abs(rough.pressure(s) - p) / np.maximum(p, mean)).max()
    assert off <= rough.error.pressure + best.error.pressure
    assert (
        np.abs(rough.traction(s) - q).max() / q.max() <= rough.error.traction + best.error.traction
    )
    assert best.converged
    assert rough.converged


def test_slip_inside_an_annulus_is_refused_by_its_radius():
    scene = Scene(0.0, 0.05, 1.0, 0.06, profile=PARABOLA, contact_radius=1.0, coupling=True)
    with pytest.raises(NotComputedError, match=r"at the contact radius 0\.\d+ slip does not"):
        solve(scene, 1e-2, ["load"])


def test_the_plan_says_that_it_is_one_history():
    scene = Scene(0.3, 0.2, 0.2, 0.05, profile=PARABOLA, contact_radius=1.0, coupling=True)
    states = {step.name: step.state.value for step in plan(scene, ["load"]).steps}
    assert states == {
        "elastic coupling": "run",
        "normal contact": "skipped",
        "growing contact": "run",
    }
    idle = plan(scene.replace(friction=None), ["load"])
    assert [step.state.value for step in idle.steps] == ["skipped", "run", "skipped"]


def test_a_march_past_a_flat_part():
    """A flat part bears nothing before the contact grows, so that no first load has to be added."""
    cone = profiles.TruncatedCone(0.5, math.pi / 4.0)
    scene = Scene(0.2, 0.2, 0.2, math.inf, profile=cone, coupling=True, contact_radius=1.0)
    names = {"load": "load", "total_shear": "shear", "approach": "approach"}
    solution = solve(scene, 1e-2, names)
    steps = [
        march(cone.height, 0.2, 0.2, scene.kappa, math.inf, n, coupled=True) for n in (40, 80, 160)
    ]
    for name, its in names.items():
        off = np.array([getattr(one, its) / getattr(solution, name) - 1.0 for one in steps])
        assert off[1] / off[2] == pytest.approx(2.0, abs=0.07), name
        assert abs(8.0 * off[2] - 6.0 * off[1] + off[0]) / 3.0 < 3e-5, name
        assert getattr(solution.error, name) < 1e-3, name


@pytest.mark.parametrize("profile", [profiles.TruncatedCone(0.5, 1.0), TABLE])
def test_on_a_smooth_surface_every_profile_has_the_shear_over_the_load_of_the_flat_punch(profile):
    names = ("load", "total_shear", "stick_radius", "stiffness")
    scene = Scene(0.2, friction=0.3, coupling=True)
    flat = solve(scene, 1e-10, ["total_shear", "approach", "stick_radius"])
    solution = solve(scene.replace(profile=profile, contact_radius=1.0), 1e-3, names)
    assert solution.stick_radius == pytest.approx(flat.stick_radius, rel=1e-6)
    assert solution.stiffness == pytest.approx(1.0 / flat.approach, rel=1e-6)
    off = abs(solution.total_shear / (flat.total_shear * solution.load) - 1.0)
    assert off <= min(solution.error.total_shear + solution.error.load, 1e-5)


@pytest.mark.parametrize("profile", [profiles.RoundedFlat(0.5, 1.0), TABLE])
def test_corners_and_breaks_bear_what_they_do_without_coupling_where_it_does_nothing(profile):
    names = ("load", "approach", "indentation_work")
    scene = Scene(0.49999, friction=math.inf, profile=profile, contact_radius=1.0)
    plain = solve(scene.replace(friction=None), 1e-10, names)
    together = solve(scene.replace(coupling=True), 1e-3, names)
    for name in names:
        off = abs(getattr(together, name) / getattr(plain, name) - 1.0)
        assert off <= min(getattr(together.error, name), 1e-5), name


def test_in_full_stick_on_a_smooth_surface_a_contact_cannot_grow_from_a_flat_part():
    """Where the flat punch pulls next to its edge there is no gap to close."""
    rounded = profiles.RoundedFlat(0.5, 1.0)
    scene = Scene(0.2, friction=math.inf, coupling=True, profile=rounded, load=1.0)
    with pytest.raises(NotComputedError, match=r"at the contact radius 0\.5.* would not grow"):
        solve(scene, 1e-3, ["load"])


def test_next_to_an_equator_a_contact_is_refused_where_the_flat_punch_pulls():
    sphere = profiles.Sphere(1.3)
    with pytest.raises(NotComputedError, match=r"at the contact radius 1\.287 .* would sink more"):
        solved(sphere, 0.0, 0.0, math.inf, contact_radius=1.287)
    # in a layer it does not pull
    near = solved(sphere, 0.2, 0.2, math.inf, contact_radius=1.3 * (1.0 - 1e-4))
    better = solved(sphere, 0.2, 0.2, math.inf, 1e-6, contact_radius=1.3 * (1.0 - 1e-4))
    for name in ("load", "approach", "total_shear"):
        error = abs(getattr(near, name) / getattr(better, name) - 1.0)
        assert error <= getattr(near.error, name) + getattr(better.error, name)


def test_a_history_under_a_cone_does_not_begin_where_no_flat_punch_is_a_scene():
    """Its flat punch had a compliance of 3e18, and the error named that of the scene."""
    scene = Scene(0.0, 1e-8, 0.03, math.inf, profile=CONE, approach=0.5, coupling=True)
    found, closer = (solve(scene, rtol, strict=False) for rtol in (1e-2, 1e-3))
    assert scene.tangential_compliance / found.history.radii[0] < 1e14
    for name in ("load", "total_shear"):
        error = abs(getattr(found, name) / getattr(closer, name) - 1.0)
        assert error <= getattr(found.error, name) + getattr(closer.error, name) < 0.1


@pytest.mark.parametrize(("profile", "power"), [(PARABOLA, 2), (profiles.Cone(1.2), 1)])
@pytest.mark.parametrize("rtol", [1e-6, 1e-9])
def test_fields_on_a_smooth_surface_are_superposed_to_the_stick_radius(profile, power, rtol):
    """The pressure has a root there, from the side that slips; it was off by 1e-5."""
    friction = 0.298714615962  # of Spence's c/a = 1/2
    found = solved(profile, 0.0, 0.0, friction, rtol)
    flat = solve(Scene(0.0, 0.0, 0.0, friction, coupling=True), 1e-11)
    for name in ("pressure", "traction"):
        for r in (1e-3, 0.1, 0.3, 0.49):
            truth = found.load * superposed(flat, name, power, r)
            # a pressure's estimate is relative to itself, a traction's to its largest value
            size = truth if name == "pressure" else float(found.traction(found.stick_radius))
            off = abs(float(getattr(found, name)(r)) - truth) / size
            assert off <= getattr(found.error, name), (name, r)


SPENCE = pytest.mark.parametrize(("profile", "power"), [(PARABOLA, 2), (profiles.Cone(1.2), 1)])


@SPENCE
def test_the_problem_of_spence_is_solved_to_ten_digits(profile, power):
    found = solved(profile, 0.0, 0.0, 0.298714615962, 1e-10)
    assert found.converged
    assert max(found.error.pressure, found.error.traction) < 1e-10
    assert found.stick_radius == pytest.approx(0.5, abs=1e-11)


@pytest.mark.parametrize("unit", [3.0, 1e-40])
def test_the_digits_of_spence_do_not_depend_on_the_unit_of_length(unit):
    """Next to the edge those of the logarithm of a radius that is not 1 were rounded away."""
    friction = 0.298714615962
    one = solved(PARABOLA, 0.0, 0.0, friction, 1e-10)
    found = solved(profiles.Parabola(unit), 0.0, 0.0, friction, 1e-10, contact_radius=unit)
    assert found.converged
    places = {"from_edge": np.array([0.99, 0.5, 1e-2, 1e-9, 1e-20])}
    for name in ("pressure", "traction"):
        ratio = getattr(found, name)(**places) / getattr(one, name)(**places)
        assert np.abs(ratio - 1.0).max() < 1e-10, name


@SPENCE
def test_load_and_approach_of_spence_are_within_their_estimates(profile, power):
    """All radii are alike: the approach grows like ``b**n``, so one linear equation gives it.

    It is ``h(1) = delta int_0^1 (1 - omega(x)) d(x**n)`` and ``P = n/(n + 1) delta/delta*``. The
    integral is taken by the trapezoidal rule in ``ln(x/(1 - x))``, on which the square root at
    ``x = 1`` is no singularity; only omega, the surface around the punch, is the library's.
    """
    friction = 0.298714615962
    flat = solve(Scene(0.0, friction=friction, coupling=True), 1e-12)
    t, step = np.linspace(-60.0, 60.0, 601, retstep=True)
    ahead = np.log1p(np.exp(-t))
    growth = step * power * np.exp(-power * ahead) / (1.0 + np.exp(t))
    around = 1.0 - outside_values([outside_displacement(flat)], ahead)[0]
    approach = float(profile.height(1.0)) / float(growth @ around)
    load = power / (power + 1.0) * approach / flat.approach
    found = solved(profile, 0.0, 0.0, friction, 1e-10)
    for name, truth in (("load", load), ("approach", approach)):
        off = abs(getattr(found, name) / truth - 1.0)
        assert off <= min(getattr(found.error, name), 1e-12), name


@pytest.mark.parametrize("past", [5e-5, 1e-9])
def test_a_load_just_past_a_break_has_the_whole_history(past):
    """The history ends in a short panel, and none of the panels before the break is left out."""
    profile = profiles.Sum(PARABOLA, profiles.TruncatedCone(0.5, 0.7))
    radius = 0.5 * (1.0 + past)
    given = {"coupling": True, "profile": profile}
    asked = ("load", "total_shear", "contact_radius")
    scene = Scene(0.2, 0.05, 0.05, math.inf, contact_radius=radius, **given)
    truth = solve(scene, 1e-4, asked, strict=False)
    scene = Scene(0.2, 0.05, 0.05, math.inf, load=truth.load, **given)
    found = solve(scene, 1e-4, asked, strict=False)
    room = truth.error.total_shear + found.error.total_shear
    assert found.contact_radius == pytest.approx(radius, rel=found.error.contact_radius)
    assert found.total_shear == pytest.approx(truth.total_shear, rel=room)
    assert room < 1e-3
