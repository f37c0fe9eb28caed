"""How a solve ends, and why: the worst ending of its steps, and reasons that name the friction."""

import math

import pytest

from spectral_contact import Ending, Scene, StepState, plan, solve
from spectral_contact.solving.run import Run
from spectral_contact.solving.sharing import StepCache


@pytest.mark.parametrize(
    ("endings", "expected"),
    [
        ([Ending.UNKNOWNS, Ending.ROUNDING], Ending.ROUNDING),
        ([Ending.ROUNDING, Ending.UNKNOWNS], Ending.ROUNDING),
        ([Ending.UNKNOWNS, Ending.ZONES, Ending.ROUNDING], Ending.ZONES),
        ([Ending.CONVERGED, Ending.UNKNOWNS], Ending.UNKNOWNS),
        ([], Ending.ROUNDING),
    ],
)
def test_the_worst_ending_of_the_steps_is_told(endings, expected):
    class Ended(Run):
        def tangential(self, states, contact):
            super().tangential(states, contact)
            self.errors["approach"] = 1.0
            self.endings[:] = endings

    scene = Scene(0.3)
    solution = Ended(scene, plan(scene, ("approach",)), 1e-8, 1000, StepCache()).solution()
    assert not solution.converged
    assert solution.ending is expected


def test_zones_that_break_the_law_are_no_convergence_however_small_the_errors():
    class Broken(Run):
        def tangential(self, states, contact):
            super().tangential(states, contact)
            self.endings.append(Ending.ZONES)

    scene = Scene(0.3)
    solution = Broken(scene, plan(scene), 1e-8, 1000, StepCache()).solution()
    assert not solution.converged
    assert solution.ending is Ending.ZONES


def test_more_unknowns_than_allowed_are_told_even_if_the_tolerance_is_met():
    # the least space there is has more than one
    solution = solve(Scene(0.1, 0.5), 1e-2, ("approach",), max_unknowns=1, strict=False)
    assert solution.error.approach <= 1e-2
    assert solution.work.unknowns > 1
    assert not solution.converged
    assert solution.ending is Ending.UNKNOWNS


@pytest.mark.parametrize("coupling", [False, True])
def test_reasons_compare_the_friction_with_the_critical_one(coupling):
    for share, state, words in (
        (1.1, StepState.SKIPPED, "friction is not below the critical {:.6g}"),
        (0.9, StepState.RUN, "friction is below the critical {:.6g}"),
    ):
        stick = solve(Scene(0.3, 0.5, 0.2, math.inf, coupling=coupling), 1e-4)
        friction = share * stick.critical_friction
        solution = solve(Scene(0.3, 0.5, 0.2, friction, coupling=coupling), 1e-4)
        [step] = [one for one in solution.plan.steps if one.name == "partial slip"]
        assert step.state is state
        assert step.reason == words.format(solution.critical_friction)
