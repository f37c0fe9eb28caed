"""Corrections of a solution with factors that serve for a while, and steps of its boundaries."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["LEFT", "Move", "Pace"]

Array = NDArray[np.float64]

#: The share of its step that a correction leaves at least, and from which share on it is the factor
#: or rounding that is not good enough.
LEFT, _SLOW = 1e-2, 0.2
#: Corrections of a solution from nothing, which do not tell how good the factors are; and what is
#: left by those of other boundaries, over their distance.
_FIRST, _DRIFT = 2, 3.0


@dataclass(frozen=True, slots=True)
class Move:
    """A step of the boundaries, and what their conditions missed before it."""

    step: Array
    length: float
    mismatch: Array


@dataclass(slots=True)
class Pace:
    """What corrections with the same factors at the same boundaries come to.

    Attributes
    ----------
    thinnest : float
        The least compliance, or 1.
    size, before : float
        Of the last correction and the one before, as the largest share.
    alike : int
        How many there were, but for those from nothing.
    drift : float
        How far the boundaries of the factors are, of the narrowest zone.
    """

    thinnest: float
    size: float = 1.0
    before: float = 1.0
    alike: int = -_FIRST
    drift: float = 0.0

    def add(self, size: float, drift: float) -> None:
        """Count another one."""
        self.before, self.size, self.drift = self.size, size, drift
        self.alike += 1

    @property
    def _astray(self) -> bool:
        """Whether the factors are those of other boundaries.

        They are off by about the distance of these, in units of a layer: they make an error next
        to the boundaries first, which the next correction takes back.
        """
        return self.drift > LEFT / _DRIFT * self.thinnest

    @property
    def _telling(self) -> bool:
        return self.alike > 1 + self._astray

    @property
    def slow(self) -> bool:
        """Whether corrections do not shrink as they should."""
        return self._telling and self.size > _SLOW * self.before

    @property
    def left(self) -> float:
        """What the last one leaves."""
        if self._astray and self.alike < 2:
            return self.size
        expected = self.size / self.before if self._telling else 0.0
        return self.size * min(max(LEFT, _DRIFT * self.drift, expected), 1.0)
