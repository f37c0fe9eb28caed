"""What the search for the boundaries of zones needs: slopes, steps, and what they are worth."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise, starmap
from math import inf

import numpy as np
from numpy.typing import NDArray

from spectral_contact.contact.resolution import TINY
from spectral_contact.fields.series import Radius
from spectral_contact.spectral.annulus import gap

__all__ = [
    "ROUNDED",
    "NoBoundariesError",
    "differences",
    "longest",
    "through_secants",
    "zones_error",
]

Array = NDArray[np.float64]

#: Steps point in different ways if their smallest singular value is so much of the largest one.
_LEAST_ANGLE = 0.1
#: Shares of a zone's width that differences are taken over, and rounding of the conditions.
_LEAST_SHARE, _MOST_SHARE, ROUNDED = 1e-3, 0.2, 2e-15


class NoBoundariesError(ArithmeticError):
    """There are no such boundaries near by."""


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


def through_secants(slopes: Array, secants: list[tuple[Array, Array]]) -> Array:
    """Return the slopes nearest to these that give the changes by steps: Broyden's update."""
    lengths = [np.linalg.norm(step) for step, _ in secants]
    ways = np.array([step / n for (step, _), n in zip(secants, lengths, strict=True)]).T
    found = np.array([change / n for (_, change), n in zip(secants, lengths, strict=True)]).T
    unseen = found - slopes @ ways
    return np.asarray(slopes + unseen @ np.linalg.pinv(ways, rcond=_LEAST_ANGLE))


def differences(conditions_at: Callable[[Array], Array], logits: Array) -> Array:
    """Return the slopes by central differences, a share of the narrowest zone apart.

    Next to a narrow zone they fall with its width, and a small share would show rounding.
    """
    slopes, spacing = [], np.diff(logits)
    for i in range(len(logits)):
        near = min([1.0, *(abs(spacing[j]) for j in (i - 1, i) if 0 <= j < len(spacing))])
        share = min(max(_LEAST_SHARE, float(np.cbrt(ROUNDED / near**2))), _MOST_SHARE)
        h = share * near * np.eye(len(logits))[i]
        slopes.append(
            (conditions_at(logits + h) - conditions_at(logits - h)) / (2.0 * share * near)
        )
    return np.array(slopes).T


def longest(x: Array, step: Array) -> float:
    """Return the factor that keeps the boundaries in order and the step moderate."""
    factor = 1.5 / max(float(np.abs(step).max()), TINY)
    for width, change in zip(np.diff(x), np.diff(step), strict=True):
        if change < 0.0:
            factor = min(factor, 0.6 * width / -change)
    return factor
