"""Newton's method for contact through nonlinear layers, in one space."""

from dataclasses import dataclass, replace
from math import inf, pi

import numpy as np
import pytest

from spectral_contact import Scene, SceneError, layers, profiles, solve
from spectral_contact.contact import layered_newton
from spectral_contact.contact.layered_contact import CellProblem, LayeredProblem, solve_layered
from spectral_contact.contact.layered_newton import LayeredNewton, series_overclosure
from spectral_contact.contact.layered_setting import setting_at_approach, setting_at_radius

BALL = profiles.Parabola(1.0)
PUNCH = profiles.Flat(1.0)
SQUARE = layers.PowerLaw(5.0, 2.0)
#: A table, and the overclosure that it has at the centre under `Parabola(10)` at the radius 1.
TABLE = layers.Table((0.0, 0.01, 0.02, 0.5), (0.0, 0.001, 0.002, 0.1))
CENTRAL_OVERCLOSURE = 0.0489346


def problem_of(setting, tolerance=1e-6):
    """Return the problem of a setting."""
    kind = LayeredProblem if setting.cells is None else CellProblem
    return kind(setting, tolerance, pointwise=True)


def solved(setting):
    """Return a problem with its solver and the fields in its first space."""
    problem = problem_of(setting)
    return problem, *problem._solve(problem.start())


# the end of a law


def test_a_law_that_ends_below_the_overclosure_at_the_centre_is_refused():
    end = 0.998 * CENTRAL_OVERCLOSURE
    cut = layers.Table((0.0, 0.01, 0.02, end), (0.0, 0.001, 0.002, float(TABLE.pressure(end))))
    with pytest.raises(SceneError, match="below the end of the law"):
        solve(Scene(0.3, layer=cut, profile=profiles.Parabola(10.0), contact_radius=1.0), 1e-6)


@dataclass(frozen=True)
class Ended(layers.CalculixExponential):
    """A law with pressure at every gap and an end."""

    @property
    def limit(self):
        return 0.1


def test_a_separation_may_put_the_centre_at_the_end_of_the_law():
    scene = Scene(0.3, layer=Ended(0.1, 0.2), profile=BALL, separation=-0.1)
    assert solve(scene, 1e-4, ("load",)).converged


@pytest.mark.parametrize(
    ("setting", "place"),
    [
        (setting_at_radius(profiles.Parabola(10.0), layers.PowerLaw(1.0, 2.0), 1.0), 0.0),
        (setting_at_approach(BALL, layers.CalculixExponential(0.1, 0.2), 0.5), 0.0),
        (setting_at_approach(PUNCH, layers.PowerLaw(1e3, 2.0), 0.5), 1.0),
    ],
)
def test_the_largest_overclosure_is_that_at_the_centre_or_at_the_edge(setting, place):
    contact = solve_layered(setting, 1e-6, 4_000).best.value
    pressure = float(contact.pressure(np.array([place]), np.array([1.0 - place]))[0])
    assert contact.overclosure == pytest.approx(setting.layer.overclosure(pressure), rel=1e-5)


# damped steps, and steps with a spring


def test_shares_of_steps_are_not_halved_without_end(corrections):
    """With shares that fell without end 80 steps were lost: 96 corrections in all."""
    table = layers.Table((0.0, 0.06578, 0.2512, 0.2756), (0.0, 0.1423, 80.45, 81.8))
    scene = Scene(0.3, layer=table, profile=profiles.Parabola(0.5), contact_radius=0.6084)
    assert solve(scene, 1e-4).converged
    assert len(corrections) < 60


@pytest.mark.parametrize(
    ("layer", "approach"),
    [
        (layers.Exponential(1e-3, 1e-9), 100.0),
        (layers.CalculixExponential(1e-3, 1e-9), 100.0),
        (layers.CalculixExponential(1e-3, 1e-12), 0.1),
    ],
)
def test_a_layer_as_good_as_rigid_has_the_load_of_a_smooth_punch(corrections, layer, approach):
    """On these the continuation left the range of doubles, and never ended."""
    scene = Scene(0.3, layer=layer, profile=PUNCH, approach=approach)
    solution = solve(scene, 1e-3, ("load",), strict=False)
    assert solution.error.load < 1e-4
    assert abs(solution.load / (8.0 * approach) - 1.0) < solution.error.load + 1e-9


def test_a_continuation_out_of_the_range_of_doubles_ends(monkeypatch, corrections):
    linear_step = LayeredNewton._linear_step

    def overflown(self, *arguments):
        step = linear_step(self, *arguments)
        return replace(step, overclosure=np.full_like(step.overclosure, inf))

    setting = setting_at_approach(PUNCH, layers.Exponential(1e-3, 1e-3), 1.0)
    problem = problem_of(setting)
    solver = LayeredNewton(setting, problem._form(problem.start()))
    guess, _ = solver.first_guess()
    monkeypatch.setattr(LayeredNewton, "_linear_step", overflown)
    corrections.clear()
    pointwise, _ = solver.first_guess()
    assert 0 < len(corrections) < 20
    assert np.isfinite(pointwise).all()
    assert not np.allclose(pointwise, guess)


@pytest.mark.parametrize(
    ("layer", "total"),
    [
        (layers.Exponential(1e-3, 1e-9), 100.0),  # w is 4e-8
        (layers.CalculixExponential(1e-3, 1e-12), 0.1),
        (layers.PowerLaw(1.0, 10.0), 1e-3),  # F(w) is 1e-30
        (layers.PowerLaw(1.0, 10.0), 10.0),
    ],
)
def test_a_layer_and_a_spring_fill_the_total_overclosure(layer, total):
    setting = setting_at_approach(PUNCH, layer, total)
    start = np.zeros(1)
    w = series_overclosure(setting, start + total, start, 0.5)
    assert w + 0.5 * setting.pressure(w) == pytest.approx(total, rel=1e-9)


# pressures without digits


@pytest.mark.parametrize(
    ("layer", "profile", "given"),
    [
        (layers.CalculixExponential(1e-3, 0.01), PUNCH, {"load": 1e-305}),
        (layers.Exponential(1e-3, 0.01), profiles.Parabola(10.0), {"load": 1e-30}),
        (layers.PowerLaw(1.0, 10.0), BALL, {"contact_radius": 1e-16}),
    ],
)
def test_a_pressure_below_rounding_is_refused_by_the_name_of_what_is_given(layer, profile, given):
    with pytest.raises(SceneError, match="load, stiffness and work") as refused:
        solve(Scene(0.3, layer=layer, profile=profile, **given), 1e-6)
    [(name, value)] = given.items()
    assert (refused.value.parameter, refused.value.value) == (name, value)


# integrals and errors


@pytest.mark.parametrize(
    "setting",
    [
        setting_at_radius(BALL, SQUARE, 1.0),
        setting_at_radius(profiles.RoundedFlat(0.5, 1.0), SQUARE, 1.0),
        setting_at_approach(PUNCH, SQUARE, 0.5),
        setting_at_approach(BALL, layers.CalculixExponential(0.1, 0.2), 0.5),
    ],
)
def test_panels_share_the_stiffness(setting):
    _, solver, fields = solved(setting)
    by_panels = solver.stiffness_by_panels(fields.pressure_rate)
    assert len(by_panels) == solver.space.panels
    assert by_panels.sum() == pytest.approx(solver.integrals(fields).stiffness, rel=1e-12)


def test_an_error_of_the_iteration_is_relative_to_the_mean_pressure():
    problem, solver, fields = solved(setting_at_approach(PUNCH, layers.Linear(1e-4), 1.0))
    largest = float(problem.setting.pressure(solver.sampling.values(fields.overclosure)).max())
    exact, less_exact = (
        problem._with_errors(solver, replace(fields, iteration_error=error)).value
        for error in (0.0, 1e-3)
    )
    in_terms_of_mean = 1e-3 * largest / (exact.load / pi)
    assert in_terms_of_mean > 5e-3
    for name in ("load_error", "work_error", "stiffness_error", "pressure_error"):
        assert getattr(less_exact, name) - getattr(exact, name) >= in_terms_of_mean


def test_refinement_goes_on_from_a_solution_that_did_not_converge():
    problem, solver, fields = solved(setting_at_radius(BALL, TABLE, 1.0))
    solution = problem._with_errors(solver, replace(fields, iteration_error=inf))
    assert solution.error == inf
    assert np.isfinite(solution.indicators).all()


@dataclass(frozen=True, slots=True)
class Steep(layers.PowerLaw):
    """A law with a slope that is ten times too large, so that steps are ten times too small."""

    def _slope(self, w):
        return 10.0 * super(Steep, self)._slope(w)


@pytest.mark.parametrize("steps", [60, 80, 100])
def test_slow_convergence_leaves_all_further_changes_together(monkeypatch, steps):
    """Changes fall by a tenth only, and the sum of those to come is nine times the last one."""
    monkeypatch.setattr(layered_newton, "_MAX_STEPS", steps)
    setting = setting_at_approach(PUNCH, layers.PowerLaw(5.0, 2.0), 0.5)
    _, solver, exact = solved(setting)
    slow_setting = replace(setting, layer=Steep(5.0, 2.0))
    slow = LayeredNewton(slow_setting, solver.form)
    fields = slow.solve(*slow.first_guess())
    exact_pressure, pressure = map(solver.sampling.values, (exact.pressure, fields.pressure))
    error = np.abs(pressure - exact_pressure).max() / exact_pressure.max()
    assert 1e-12 < error < 2.0 * fields.iteration_error < 4.0 * error


def test_the_stiffness_is_as_uncertain_as_the_load_where_lengths_round():
    """The overclosure is a millionth of the clearance: its rounding is an error of both."""
    law = layers.Exponential(1e4, 1.0)
    scene = Scene(None, profile=BALL, layer=law, contact_radius=1e-4)
    found = solve(scene, 1e-9, ["load", "stiffness"], strict=False)
    assert found.error.load > 1e-11
    assert found.error.stiffness >= 0.9 * found.error.load
