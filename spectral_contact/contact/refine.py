"""Refine until the estimate meets the tolerance. Knows spaces and decay, and no physics."""

from __future__ import annotations

import logging
from dataclasses import dataclass, replace
from time import perf_counter
from typing import Generic, Protocol, TypeVar

import numpy as np

from spectral_contact.fields.series import Array
from spectral_contact.records import Ending, RefinementStep
from spectral_contact.spectral.panels import LEAST_DEGREE, DiscreteSpace

T = TypeVar("T")

_LOG = logging.getLogger(__name__)

#: Aim below the tolerance, so that one more solve is rarely needed.
_MARGIN = 0.15
#: Most degrees that one refinement adds to a panel.
_LEAP = 8
#: Highest degree a panel may reach; beyond it rounding grows and nothing converges further.
_DEGREE_LIMIT = 40
_MAX_ATTEMPTS = 12


@dataclass(frozen=True, slots=True)
class Attempt(Generic[T]):
    """The outcome of one space.

    Attributes
    ----------
    value : object
        What the problem computed.
    error : float
        Estimate of the relative error of what was asked.
    indicators : ndarray, shape (panels,)
        Share of every panel in the estimate, in the same unit as `error`.
    rates : ndarray, shape (panels,)
        Factor, below 1, by which one more degree lowers the indicator.
    unknowns : int
    """

    value: T
    error: float
    indicators: Array
    rates: Array
    unknowns: int


class Problem(Protocol[T]):
    """What `refine` needs of a problem."""

    def start(self) -> DiscreteSpace:
        """Return the first space to try."""

    def attempt(self, resolution: DiscreteSpace) -> Attempt[T]:
        """Solve in a space."""


@dataclass(frozen=True, slots=True)
class Refinement(Generic[T]):
    """The best attempt, why it is the last one, and the history."""

    best: Attempt[T]
    resolution: DiscreteSpace
    ending: Ending
    history: tuple[RefinementStep, ...]


def refine(problem: Problem[T], tolerance: float, max_unknowns: int) -> Refinement[T]:
    """Solve in growing spaces until the estimate meets the tolerance.

    No space of more than `max_unknowns` is tried, unless even the lowest degrees exceed that.
    """
    resolution = fitted(problem.start(), max_unknowns)
    history: list[RefinementStep] = []
    best: Attempt[T] | None = None
    stalled = 0
    while True:
        begin = perf_counter()
        attempt = problem.attempt(resolution)
        step = RefinementStep(
            attempt.unknowns, max(resolution.degrees), attempt.error, perf_counter() - begin
        )
        history.append(step)
        _LOG.debug("%d unknowns: estimate %.1e", step.unknowns, step.error)
        stalled += 1
        if best is None or attempt.error < best.error:
            stalled, best, space = 0, attempt, resolution
        spent = stalled >= 2 or len(history) >= _MAX_ATTEMPTS
        if best.error <= tolerance:
            ending = Ending.CONVERGED
        elif spent or (finer := _finer(resolution, attempt, tolerance, stalled)) == resolution:
            ending = Ending.ROUNDING
        elif _size(finer) > max_unknowns:
            ending = Ending.UNKNOWNS
        else:
            resolution = finer
            continue
        return Refinement(best, space, ending, tuple(history))


def _size(resolution: DiscreteSpace) -> int:
    """Return the number of unknowns on the panels, tails aside."""
    return sum(resolution.degrees) + len(resolution.degrees)


def fitted(resolution: DiscreteSpace, max_unknowns: int) -> DiscreteSpace:
    """Lower the highest degrees until the space fits."""
    # the caller sees where even the least is too large
    while _size(resolution) > max_unknowns and (top := max(resolution.degrees)) > LEAST_DEGREE:
        degrees = tuple(min(n, top - 1) for n in resolution.degrees)
        resolution = resolution._replace(degrees=degrees)
    return resolution


def _finer(
    resolution: DiscreteSpace, attempt: Attempt[T], tolerance: float, stalled: int
) -> DiscreteSpace:
    """Raise the degree where the indicator asks for it, by what the decay predicts.

    Where that did not help the error comes from elsewhere: what panels above a thin layer leave is
    felt in it.
    """
    aim = _MARGIN * tolerance
    need = np.log(np.maximum(attempt.indicators / aim, 1.0)) / -np.log(attempt.rates)
    extra = np.clip(np.ceil(need), 2 * stalled, _LEAP).astype(int)
    degrees = np.minimum(np.array(resolution.degrees) + extra, _DEGREE_LIMIT)
    highest = int(degrees.max())
    panels = resolution.panels
    if highest > panels.degree:
        panels = replace(panels, degree=min(highest + 4, _DEGREE_LIMIT))
    return DiscreteSpace(panels, tuple(degrees.tolist()))
