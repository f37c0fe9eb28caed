"""Refinement of a problem whose errors are known: those of a geometric series."""

import numpy as np
import pytest

from spectral_contact.contact.layout import NoBoundariesError
from spectral_contact.contact.refine import SpaceSolution, refine
from spectral_contact.records import Ending
from spectral_contact.spectral.panels import DiscreteSpace, LogPanels


class Geometric:
    """A problem whose error on a panel of degree n is ``exp(-rate n)``, down to a floor.

    From the space number `fails_from` on it has no solution.
    """

    def __init__(self, rates, floor=0.0, fails_from=None):
        self.rates = np.array(rates)
        self.floor = floor
        self.fails_from = fails_from
        self.spaces = 0

    def start(self):
        degrees = (4,) * len(self.rates)
        return DiscreteSpace(LogPanels(len(degrees), 2.0, 8), degrees)

    def attempt(self, space):
        if self.spaces == self.fails_from:
            raise NoBoundariesError("no boundaries near by")
        self.spaces += 1
        errors = np.maximum(np.exp(-self.rates * space.degrees), self.floor)
        return SpaceSolution(self.spaces, float(errors.max()), errors, sum(space.degrees))


def test_degrees_rise_until_the_tolerance_is_met_where_they_are_needed():
    refinement = refine(Geometric([1.0, 2.0]), 1e-8, 1000)
    assert refinement.ending is Ending.CONVERGED
    assert refinement.best.error <= 1e-8
    slow, fast = refinement.space.degrees
    assert slow > fast


def test_an_estimate_that_does_not_fall_ends_the_refinement():
    refinement = refine(Geometric([1.0], floor=1e-6), 1e-8, 1000)
    assert refinement.ending is Ending.ROUNDING
    assert refinement.best.error == 1e-6
    # of equal spaces the first one is kept
    assert refinement.best.value < len(refinement.history)


def test_no_space_exceeds_the_most_unknowns():
    refinement = refine(Geometric([0.5]), 1e-12, 12)
    assert refinement.ending is Ending.UNKNOWNS
    assert sum(refinement.space.degrees) + 1 <= 12


@pytest.mark.parametrize("fails_from", [1, 2])
def test_a_finer_space_without_a_solution_leaves_the_best_one_before(fails_from):
    problem = Geometric([0.3], fails_from=fails_from)
    refinement = refine(problem, 1e-8, 1000)
    assert refinement.ending is Ending.ROUNDING
    assert refinement.best.value == fails_from
    assert len(refinement.history) == fails_from


def test_a_problem_without_any_solution_has_no_refinement():
    with pytest.raises(NoBoundariesError):
        refine(Geometric([1.0], fails_from=0), 1e-8, 1000)
