"""Refinement of spaces until the estimate of the error meets the tolerance.

It takes the errors of all panels from the problem, and raises degrees; it does not depend on the
equations.
"""

from __future__ import annotations

import logging
from dataclasses import dataclass, replace
from time import perf_counter
from typing import Generic, Protocol, TypeVar

import numpy as np

from spectral_contact.contact.tuning import MAX_DEGREE, REFINEMENT_MARGIN
from spectral_contact.fields.series import Array
from spectral_contact.records import Ending, RefinementStep
from spectral_contact.spectral.panels import LEAST_DEGREE, DiscreteSpace

T = TypeVar("T")

_LOG = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class SpaceSolution(Generic[T]):
    """The solution in one space, with the errors by which the next space is chosen.

    Attributes
    ----------
    value : object
        The solution, of the type of the problem.
    error : float
        Estimate of the relative error that is compared with the tolerance.
    indicators : ndarray, shape (panels,)
        Contribution of every panel to `error`.
    unknowns : int
        Size of the linear system.
    """

    value: T
    error: float
    indicators: Array
    unknowns: int


class Problem(Protocol[T]):
    """A problem that `refine` can solve."""

    def start(self) -> DiscreteSpace:
        """Return the first space to try."""

    def attempt(self, space: DiscreteSpace) -> SpaceSolution[T]:
        """Solve in a space."""


@dataclass(frozen=True, slots=True)
class Refinement(Generic[T]):
    """The outcome of a refinement.

    Attributes
    ----------
    best : SpaceSolution
        The solution with the least error.
    space : DiscreteSpace
        Its space.
    ending : Ending
        Why the refinement ended.
    history : tuple of RefinementStep
        One step for every space.
    """

    best: SpaceSolution[T]
    space: DiscreteSpace
    ending: Ending
    history: tuple[RefinementStep, ...]


def refine(problem: Problem[T], tolerance: float, max_unknowns: int) -> Refinement[T]:
    """Solve in growing spaces until the estimate meets the tolerance.

    No space of more than `max_unknowns` coefficients on its panels is tried, unless even the lowest
    degrees exceed that. The refinement ends in `Ending.ROUNDING` if two spaces in a row do not
    lower the estimate, or if no degree can be raised: MAX_DEGREE may be too low for a field that is
    not smooth inside a panel, and no panel is split. It also ends so if the problem has a solution
    in one space and none is found in a finer one, as where rounding hides its boundaries.

    Raises
    ------
    ArithmeticError, LinAlgError
        If the problem has no solution in the first space.
    """
    space = within_budget(problem.start(), max_unknowns)
    history: list[RefinementStep] = []
    best: SpaceSolution[T] | None = None
    best_space = space
    stalled = 0  # spaces since the estimate was lowest
    while True:
        begin = perf_counter()
        try:
            solution = problem.attempt(space)
        except (ArithmeticError, np.linalg.LinAlgError):
            if best is None:
                raise
            return Refinement(best, best_space, Ending.ROUNDING, tuple(history))
        step = RefinementStep(
            solution.unknowns, max(space.degrees), solution.error, perf_counter() - begin
        )
        history.append(step)
        _LOG.debug("%d unknowns: estimate %.1e", step.unknowns, step.error)
        stalled += 1
        if best is None or solution.error < best.error:
            stalled = 0
            best = solution
            best_space = space
        if best.error <= tolerance:
            ending = Ending.CONVERGED
        elif stalled >= 2 or (finer := _finer(space, solution, tolerance, stalled)) == space:
            ending = Ending.ROUNDING
        elif _size(finer) > max_unknowns:
            ending = Ending.UNKNOWNS
        else:
            space = finer
            continue
        return Refinement(best, best_space, ending, tuple(history))


def _size(space: DiscreteSpace) -> int:
    """Return the number of coefficients on the panels, without those of tails."""
    return sum(space.degrees) + len(space.degrees)


def within_budget(space: DiscreteSpace, max_unknowns: int) -> DiscreteSpace:
    """Return a space with its highest degrees lowered until it is small enough.

    Its panels have at most `max_unknowns` coefficients then, unless even the lowest degrees have
    more; then it is the space of the lowest degrees.
    """
    while _size(space) > max_unknowns and (highest := max(space.degrees)) > LEAST_DEGREE:
        degrees = tuple(min(n, highest - 1) for n in space.degrees)
        space = space._replace(degrees=degrees)
    return space


def _finer(
    space: DiscreteSpace, solution: SpaceSolution[T], tolerance: float, stalled: int
) -> DiscreteSpace:
    """Return the next space, whose panels are expected to have errors below a target.

    An error e on a panel of degree n is taken for that of a geometric series: every degree lowers
    it by the factor ``e**(1/n)``. No degree is more than doubled. If the last space did not lower
    the error, every degree is raised by two at least: errors of panels outside a thin layer change
    the field in the layer, and do not appear in the indicators of these panels.
    """
    target = REFINEMENT_MARGIN * tolerance
    errors = np.clip(solution.indicators, target, 0.5)
    before = np.array(space.degrees)
    needed = before * np.log(errors / target) / -np.log(errors)
    added = np.clip(np.ceil(needed), 2 * stalled, before).astype(int)
    degrees = np.minimum(before + added, MAX_DEGREE)
    highest = int(degrees.max())
    panels = space.panels
    if highest > panels.degree:
        panels = replace(panels, degree=min(highest + 4, MAX_DEGREE))
    return DiscreteSpace(panels, tuple(degrees.tolist()))
