"""Newton's method for the boundaries of the zones, with slopes kept up by secants."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise, starmap
from math import inf
from typing import Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from spectral_contact.fields.series import Radius
from spectral_contact.spectral.annulus import gap

__all__ = [
    "Boundaries",
    "NoBoundariesError",
    "differences",
    "find_boundaries",
    "longest",
    "zones_error",
]

Array = NDArray[np.float64]

#: Steps shorter than this show more of the noise than of the slopes.
_LEAST_STEP = 1e-9
#: Steps point in different ways if their smallest singular value is so much of the largest one.
_LEAST_ANGLE = 0.1
#: Slopes are good where a step is at most so much of the one before.
_GOOD = 1e-2
#: Where zones of a like scene fit, a step is at most so much of the one before.
_SHRINKS = 0.5
#: A step as short as this may be made of rounding, which does not shrink.
_NOISE = 1e-7
_MAX_STEPS = 25
#: Shares of a zone's width that differences are taken over, and rounding of the conditions.
_LEAST_SHARE, _MOST_SHARE, _ROUNDED = 1e-3, 0.2, 2e-15


T = TypeVar("T")


class NoBoundariesError(ArithmeticError):
    """There are no such boundaries near by."""


@dataclass(frozen=True, slots=True)
class Boundaries(Generic[T]):
    """Boundaries that satisfy the conditions.

    Attributes
    ----------
    logits : ndarray
        Where the last trial was.
    left : ndarray
        How far it was from the root.
    trial : object
        Everything there.
    slopes : ndarray
        By what the conditions, and what follows them, rise with the logits.
    known : bool
        Whether the steps have shown the slopes in every direction.
    good : bool
        Whether they have been seen to be good at least in that of the last step.
    """

    logits: Array
    left: Array
    trial: T
    slopes: Array
    known: bool
    good: bool


def find_boundaries(
    trial_at: Callable[[Array], T],
    conditions: Callable[[T], Array],
    logits: Array,
    slopes: Array,
    settle: float,
    enough: float,
    *,
    near: bool,
) -> Boundaries[T]:
    """Find the boundaries at which the conditions hold.

    Parameters
    ----------
    trial_at : callable
        Solves at given boundaries.
    conditions : callable
        What should vanish of a trial, one number for each boundary, and then what else the slopes
        are wanted of.
    logits, slopes : ndarray
        Where to begin, and the slopes there.
    settle : float
        After a step as short as this the search ends.
    enough : float
        A step as short as this is not taken.
    near : bool
        The beginning is near, or else there are no such boundaries.

    Raises
    ------
    NoBoundariesError
        If steps from near by do not become shorter.
    """
    x, before, trial, count = logits, inf, trial_at(logits), len(logits)
    values, left, shrinking = conditions(trial), np.zeros(count), inf
    steps: list[Array] = []
    changes: list[Array] = []
    for _ in range(_MAX_STEPS):
        step = -np.asarray(np.linalg.solve(slopes[:count], values[:count]), dtype=float)
        size = float(np.abs(step).max())
        if near and not size <= _SHRINKS * before:
            if size <= _NOISE:
                break
            raise NoBoundariesError("no boundaries near by")
        shrinking, before = size / before, size
        if size <= enough:
            left = step
            break
        step *= min(1.0, longest(x, step))
        x = x + step
        trial = trial_at(x)
        values, before_it = conditions(trial), values
        if float(np.abs(step).max()) >= _LEAST_STEP:
            slopes = _through_secants(slopes, [step], [values - before_it])
            steps, changes = [*steps, step][-count:], [*changes, values - before_it][-count:]
        if size <= settle:
            break
    if not steps:
        return Boundaries(x, left, trial, slopes, False, False)
    ways = np.array([step / np.linalg.norm(step) for step in steps])
    spread = np.linalg.svd(ways, compute_uv=False)
    span = len(steps) == count and bool(spread[-1] > _LEAST_ANGLE * spread[0])
    slopes = _through_secants(slopes, steps, changes)
    return Boundaries(x, left, trial, slopes, span, span or shrinking <= _GOOD)


def zones_error(radii: tuple[Radius, ...], errors: tuple[tuple[float, float], ...]) -> float:
    """Return the largest of the boundaries' errors; infinite if a zone may not be there.

    Parameters
    ----------
    radii : tuple of Radius
        Boundaries, outward.
    errors : tuple of (float, float)
        Their relative errors from the centre and from the edge.
    """
    unsure = [
        min(2.0 * at.square * own, at.rest * edge)
        for at, (own, edge) in zip(radii, errors, strict=True)
    ]
    widths = starmap(gap, pairwise(radii))
    if any(width <= sum(off) for width, off in zip(widths, pairwise(unsure), strict=True)):
        return inf
    return max(map(max, errors), default=0.0)


def _through_secants(slopes: Array, steps: list[Array], changes: list[Array]) -> Array:
    """Return the slopes nearest to these that give the changes; of one step: Broyden's update."""
    lengths = [np.linalg.norm(step) for step in steps]
    ways, found = (
        np.array([one / n for one, n in zip(each, lengths, strict=True)]).T
        for each in (steps, changes)
    )
    return np.asarray(slopes + (found - slopes @ ways) @ np.linalg.pinv(ways, rcond=_LEAST_ANGLE))


def differences(conditions_at: Callable[[Array], Array], logits: Array) -> Array:
    """Return the slopes by central differences, a share of the narrowest zone apart.

    Next to a narrow zone they fall with its width, and a small share would show rounding.
    """
    slopes, spacing = [], np.diff(logits)
    for i in range(len(logits)):
        near = min([1.0, *(abs(spacing[j]) for j in (i - 1, i) if 0 <= j < len(spacing))])
        share = min(max(_LEAST_SHARE, float(np.cbrt(_ROUNDED / near**2))), _MOST_SHARE)
        h = share * near * np.eye(len(logits))[i]
        slopes.append(
            (conditions_at(logits + h) - conditions_at(logits - h)) / (2.0 * share * near)
        )
    return np.array(slopes).T


def longest(x: Array, step: Array) -> float:
    """Return the factor that keeps the boundaries in order and the step moderate."""
    factor = 1.5 / max(float(np.abs(step).max()), 1e-300)
    for width, change in zip(np.diff(x), np.diff(step), strict=True):
        if change < 0.0:
            factor = min(factor, 0.6 * width / -change)
    return factor
