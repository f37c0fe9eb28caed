"""Where zones stick and slip: what searches find and like scenes hand on."""

from __future__ import annotations

from bisect import bisect
from dataclasses import dataclass
from math import log

import numpy as np
from numpy.typing import NDArray

__all__ = ["Layout", "logit_at"]


def logit_at(x: float) -> float:
    """Return the logit ``ln(z/y)`` of the radius with ``y = exp(-x)``."""
    return float(np.log(-np.expm1(-x)) + x)


@dataclass(frozen=True, slots=True)
class Layout:
    """Boundaries between zones, and what every zone does: 0 stick, +1 or -1 slip with that sign.

    Attributes
    ----------
    logits : tuple of float
        ``ln(b**2/(1 - b**2))`` of the boundaries, outward.
    states : tuple of int
        One more than boundaries; the first is 0.
    slopes : ndarray, shape (boundaries, boundaries), optional
        By what the conditions at the boundaries rise with the logits, if known.
    """

    logits: tuple[float, ...]
    states: tuple[int, ...]
    slopes: NDArray[np.float64] | None = None

    def mended(self, missing: tuple[tuple[float, float], ...]) -> Layout | None:
        """Return the layout with stick where it is missing, or None if that makes no zone."""
        layout = self.with_stick(missing)
        return layout if len(layout.states) > len(self.states) else None

    def with_stick(self, intervals: tuple[tuple[float, float], ...]) -> Layout:
        """Return the layout with further stick in intervals of slip.

        Parameters
        ----------
        intervals : tuple of (float, float)
            In ``y = 1 - s**2``, inside of slip zones; one that ends at 0 reaches the edge.
        """
        layout = Layout(self.logits, self.states)
        for high, low in intervals:
            if low < high < 1.0:
                ends = [logit_at(-log(y)) for y in (high, low) if y > 0.0]
                layout = layout._with_zone(ends)
        return layout

    def _with_zone(self, ends: list[float]) -> Layout:
        """Return the layout with stick between two boundaries, or from one to the edge."""
        zone = bisect(self.logits, ends[0])
        if self.states[zone] == 0 or bisect(self.logits, ends[-1]) != zone:
            return self
        logits = [*self.logits[:zone], *ends, *self.logits[zone:]]
        further = [0, self.states[zone]][: len(ends)]
        states = [*self.states[: zone + 1], *further, *self.states[zone + 1 :]]
        return Layout(tuple(logits), tuple(states))
