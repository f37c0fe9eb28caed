"""Sequences of zones that stick or slip.

s is the radius over that of the contact, and ``y = 1 - s**2``. Pressure p, traction q and friction
f are those of docs/theory.
"""

from __future__ import annotations

from bisect import bisect
from dataclasses import dataclass
from math import inf, log
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from spectral_contact.contact.resolution import TINY


class NoBoundariesError(ArithmeticError):
    """Newton's method finds no boundaries of zones from its starting values."""


def logit_at(x: float) -> float:
    """Return the logit ``ln(s**2/(1 - s**2))`` of the radius s with ``1 - s**2 = exp(-x)``."""
    return float(np.log(-np.expm1(-x)) + x)


class Layout(NamedTuple):
    """Zones of the contact from the centre outward: the boundaries between them, and their states.

    Attributes
    ----------
    logits : tuple of float
        ``ln(b**2/(1 - b**2))`` of the boundaries b, outward.
    states : tuple of int
        Of every zone, one more than boundaries: 0 for stick, +1 or -1 for slip with ``q = +f p`` or
        ``q = -f p``. The first is 0.
    jacobian : ndarray, shape (boundaries, boundaries), optional
        Derivatives by the logits of the boundary residual, which is zero where the boundaries are
        right (`free_boundary`). Newton's method begins with it, and with these boundaries. None if
        no solution on such zones is at hand: then boundaries are looked for first, in a small
        space.
    """

    logits: tuple[float, ...]
    states: tuple[int, ...]
    jacobian: NDArray[np.float64] | None = None

    def with_stick(self, intervals: tuple[tuple[float, float], ...]) -> Layout:
        """Return the zones with further stick zones inside slip zones, and without a Jacobian.

        An interval that is empty, or not inside one slip zone, is left out.

        Parameters
        ----------
        intervals : tuple of (float, float)
            The stick zones to add, as y at their inner and outer boundary. One whose outer y is 0
            reaches the edge.
        """
        logits = self.logits
        states = self.states
        for inner_y, outer_y in intervals:
            if not outer_y < inner_y < 1.0:
                continue
            boundaries = [logit_at(-log(y)) for y in (inner_y, outer_y) if y > 0.0]
            end = boundaries[-1] if outer_y > 0.0 else inf
            zone = bisect(logits, boundaries[0])
            if states[zone] != 0 and bisect(logits, end) == zone:
                # stick, and slip beyond it unless the stick reaches the edge
                new_states = (0, states[zone])[: len(boundaries)]
                logits = (*logits[:zone], *boundaries, *logits[zone:])
                states = (*states[: zone + 1], *new_states, *states[zone + 1 :])
        return Layout(logits, states)


@dataclass(frozen=True, slots=True, eq=False)
class Trial:
    """Zones that a search tried, and its verdict.

    Attributes
    ----------
    zones : Layout
        The zones with which Newton's method began; a solution has other boundaries.
    reason : str
        The reason why they were tried.
    verdict : str
        "the friction law holds", or the reason why the zones are wrong.
    """

    zones: Layout
    reason: str
    verdict: str

    @property
    def text(self) -> str:
        """One line: number of zones, reason and verdict."""
        return f"{len(self.zones.states)} zones ({self.reason}): {self.verdict}"


def fixed_disk(logit: float) -> Layout:
    """Return one stick disk whose radius is given: Newton's method does not move its boundary.

    The derivative in its Jacobian is so large that every step of the boundary rounds to 0.
    """
    return Layout((logit,), (0, 1), np.array([[1.0 / TINY]]))


def min_zone_width(logits: NDArray[np.float64]) -> float:
    """Return the width of the narrowest zone between boundaries, in logits; at most 1."""
    return float(min([1.0, *np.diff(logits)]))
