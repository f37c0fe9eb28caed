"""Lines of many frictions: few are solved, and all have the numbers of `solve`."""

import math

import mpmath
import numpy as np
import pytest

from spectral_contact import Scene, solve
from spectral_contact.contact.normal import solve_normal
from spectral_contact.contact.zone_problem import _GivenRadius, solve_given_radius
from spectral_contact.fields.curves import InvertedCurves
from spectral_contact.fields.series import Radius
from spectral_contact.quantities import FULL_STICK_RATIOS
from spectral_contact.solving.solver import Continuation
from spectral_contact.spectral.parameters import Parameters
from spectral_contact.sweeps import sweep
from spectral_contact.sweeps.lines import LEAST, _disks, interpolate_line, lines
from spectral_contact.sweeps.request import requested
from spectral_contact.sweeps.sweep_parameters import listed

pytest.importorskip("xarray", reason="part of the extra: sweep")

NUMBERS = ["stick_radius", "total_shear"]


@pytest.fixture
def work(monkeypatch):
    """Return a list that grows with every friction that is solved, or radius."""
    done = []
    for name in ("solve", "given_radius"):
        original = getattr(Continuation, name)

        def counted(self, *arguments, original=original):
            done.append(arguments)
            return original(self, *arguments)

        monkeypatch.setattr(Continuation, name, counted)
    return done


@pytest.mark.parametrize(
    ("scene", "frictions", "solved"),
    [
        (Scene(0.3, 0.5, 0.5), np.linspace(0.01, 0.09, 80), 35),
        (Scene(0.1, 0.5, 0.0), np.geomspace(0.1, 0.6, 40), 30),  # no compliance
        (Scene(0.2), np.geomspace(0.1, 0.6, 60), 40),
        (Scene(0.3, 0.05, 1.0), np.geomspace(0.01, 0.04, 60), 50),  # then slip inside, then stick
    ],
    ids=["both", "alpha", "smooth", "zones"],
)
def test_a_line_has_the_numbers_of_solve_within_its_estimates(work, scene, frictions, solved):
    found = sweep(scene, friction=frictions, quantities=NUMBERS)
    assert len(work) < solved
    assert (found.ending == "converged").all()
    for i in range(0, len(frictions), 13):
        truth = solve(scene.replace(friction=float(frictions[i])), 1e-12, NUMBERS)
        for name in NUMBERS:
            own = float(found[f"{name}_error"][i])
            error = abs(float(found[name][i]) / getattr(truth, name) - 1.0)
            assert error <= own + getattr(truth.error, name) + 1e-15
            assert own <= 1e-8


def test_a_line_with_slip_inside_is_given_up_after_three_scenes():
    asked = []

    class Solver:
        def at_scene(self, i, more):
            asked.append(i)
            return solve(Scene(0.3, 0.05, 1.0, 0.01 if i == 0 else 0.0295), 1e-3)

    columns = listed([Scene(0.3, 0.05, 1.0, 0.01)] * 100).columns(np.arange(100))
    assert not interpolate_line(
        columns, requested(NUMBERS, 1e-8, 100, None, None), Solver()
    ).mask.any()
    assert asked == [0, 99, LEAST - 1]


@pytest.mark.parametrize("logit", [-20.0, -2.0, 0.0, 2.0, 20.0])
def test_a_stick_radius_has_the_error_that_its_logit_makes(logit):
    """From a small stick disk to a narrow slip annulus: c**2 = 1/(1 + exp(-logit))."""
    moved = 1e-4
    nothing = np.zeros((1, 1))
    placed = InvertedCurves(np.array([logit]), np.array([moved]), nothing, nothing, nothing)
    values, errors = _disks(placed)
    with mpmath.workdps(40):
        low, centre, high = (
            1 / mpmath.sqrt(1 + mpmath.exp(-mpmath.mpf(logit) - step))
            for step in (-moved, 0, moved)
        )
        assert float(values["stick_radius"][0]) == pytest.approx(float(centre), rel=1e-15)
        exact = float((high - low) / centre) / 2.0
    assert errors["stick_radius"][0] == pytest.approx(exact, rel=1e-6, abs=1e-14)


def test_what_friction_does_not_change_is_that_of_solve():
    frictions = np.linspace(0.01, 0.09, 40)
    found = sweep(Scene(0.3, 0.5, 0.5), friction=frictions)
    truth = solve(Scene(0.3, 0.5, 0.5, 0.05), 1e-8)
    for name in ("approach", "edge_ratio", "critical_friction"):
        assert (found[name] == getattr(truth, name)).all()
        assert (found[f"{name}_error"] == getattr(truth.error, name)).all()


def test_other_poisson_ratios_are_on_the_same_line(work):
    axes = {"poisson_ratio": [0.1, 0.2, 0.3], "friction": np.linspace(0.01, 0.09, 12)}
    found = sweep(Scene(0.3, 0.5, 0.5), **axes)
    assert len(work) < 30
    assert (found.ending == "converged").all()
    for nu, f in ((0.1, 3), (0.2, 7), (0.3, 10), (0.3, 11)):
        own = found.sel(poisson_ratio=nu).isel(friction=f)
        truth = solve(Scene(nu, 0.5, 0.5, float(own.friction)), 1e-12)
        for name in (*NUMBERS, "approach", *sorted(FULL_STICK_RATIOS)):
            error = abs(float(own[name]) / getattr(truth, name) - 1.0)
            assert error <= float(own[f"{name}_error"]) + getattr(truth.error, name) + 1e-15
            assert own[f"{name}_error"] <= 1e-8


def test_next_to_the_critical_friction_the_line_is_known_as_well(work):
    critical = solve(Scene(0.3, 0.5, 0.5, 1.0), 1e-12, ("critical_friction",)).critical_friction
    frictions = critical * np.linspace(0.3, 0.9995, 100)
    found = sweep(Scene(0.3, 0.5, 0.5), friction=frictions, quantities=["shakedown_ratio"])
    assert len(work) < 60
    assert found.shakedown_ratio_error.max() > 1e-8
    exact = (critical - frictions) / (critical + frictions)
    off = np.abs(found.shakedown_ratio.values / exact - 1.0)
    assert (off <= found.shakedown_ratio_error.values + 1e-11).all()


def test_where_a_node_fails_the_scenes_are_solved_one_by_one(monkeypatch):
    def broken(self, scene, logit):
        raise FloatingPointError

    monkeypatch.setattr(Continuation, "given_radius", broken)
    frictions = np.linspace(0.02, 0.09, LEAST)
    found = sweep(Scene(0.3, 0.5, 0.5), friction=frictions, quantities=NUMBERS)
    assert (found.ending == "converged").all()
    truth = solve(Scene(0.3, 0.5, 0.5, 0.02), 1e-8, NUMBERS)
    assert float(found.stick_radius[0]) == pytest.approx(truth.stick_radius, rel=1e-12)


def test_lines_are_of_one_material_and_have_slip():
    frictions = [*np.linspace(0.09, 0.01, LEAST), 0.01, 0.0, math.inf, None]
    scenes = [Scene(0.3, alpha, 0.5, f) for f in frictions for alpha in (0.5, 0.1)]
    columns = listed([*scenes, Scene(0.5, 0.1, 0.5, 0.2)]).columns(np.arange(len(scenes) + 1))
    todo = np.arange(len(columns))
    found = list(lines(columns, todo, requested(NUMBERS, 1e-8, 100, None, None)))
    assert [set(columns.values[1, line]) for line in found] == [{0.1}, {0.5}]
    for line in found:
        np.testing.assert_allclose(columns.values[3, line], sorted(frictions[: LEAST + 1]))
    assert not list(lines(columns, todo[:LEAST], requested(NUMBERS, 1e-8, 100, None, None)))
    for asked in (["zones"], ["traction"]):
        request = requested(asked, 1e-8, 100, None, [0.5] if asked == ["traction"] else None)
        assert not list(lines(columns, todo, request))


@pytest.mark.parametrize("logit", [-20.0, -2.0, 3.0, 20.0])
def test_the_friction_of_a_radius_on_a_smooth_surface(logit):
    contact = solve_normal(0.0, 1e-12, 1000, goal="traction")
    form = Parameters(0.0, 0.0, 1.0, 1.0), Radius.from_logit(logit)
    solved, friction = solve_given_radius(contact, *form, 1e-10, 1000)
    with mpmath.workdps(40):
        c = mpmath.sqrt(1 / (1 + mpmath.exp(-logit)))
        true = 2 * mpmath.atanh(c) / c / mpmath.ellipk(1 - c**2)
    assert abs(friction / float(true) - 1.0) <= solved.best.value.logit_errors[0] < 1e-11


def test_the_friction_of_a_radius_is_that_of_the_best_space_and_not_of_the_last(monkeypatch):
    """Where rounding ends the refinement, the last two spaces are worse than the best."""
    frictions = []
    estimate = _GivenRadius.estimate

    def kept(problem, iterate):
        frictions.append(iterate.fields.system.parameters.friction)
        return estimate(problem, iterate)

    monkeypatch.setattr(_GivenRadius, "estimate", kept)
    contact = solve_normal(0.05, 1e-12, 1000, goal="traction").best.value
    form = Parameters(0.05, 0.3, 1.0, 1.0), Radius.from_logit(1.0)
    solved, friction = solve_given_radius(contact, *form, 1e-16, 20_000)
    errors = [step.error for step in solved.history]
    best = errors.index(min(errors))
    assert best < len(errors) - 1
    assert friction == frictions[best]
    assert any(one != friction for one in frictions)
