"""Where zones stick and slip: what searches find and like scenes hand on."""

from __future__ import annotations

from dataclasses import dataclass
from math import log

import numpy as np
from numpy.typing import NDArray

from spectral_contact.adaptive import Resolution

__all__ = ["Layout", "ZonesSpace", "logit_at"]


def logit_at(x: float) -> float:
    """Return the logit ``ln(z/y)`` of the radius with ``y = exp(-x)``."""
    return float(np.log(-np.expm1(-x)) + x)


@dataclass(frozen=True, slots=True)
class ZonesSpace:
    """A space that was enough for a tolerance.

    Attributes
    ----------
    tolerance : float
    counts : tuple of (int, int)
        Panels of either half of the stick annuli.
    resolution : Resolution
        The disk's panels, with its degrees and then those of the annuli.
    """

    tolerance: float
    counts: tuple[tuple[int, int], ...]
    resolution: Resolution


@dataclass(frozen=True, slots=True)
class Layout:
    """Boundaries between zones, and what every zone does: 0 stick, +1 or -1 slip with that sign.

    Attributes
    ----------
    logits : tuple of float
        ``ln(b**2/(1 - b**2))`` of the boundaries, outward.
    states : tuple of int
        One more than boundaries; the first is 0.
    slopes : ndarray, shape (values, boundaries), optional
        By what the conditions at the boundaries rise with the logits, if known; with slip inside
        the shear is the last of the values.
    slopes_at : tuple of float
        The logits for which they were last known in every direction.
    good : bool
        Whether the slopes have been seen to be good at these boundaries.
    space : ZonesSpace, optional
        What to begin with.
    """

    logits: tuple[float, ...]
    states: tuple[int, ...]
    slopes: NDArray[np.float64] | None = None
    slopes_at: tuple[float, ...] = ()
    good: bool = False
    space: ZonesSpace | None = None

    def with_stick(self, intervals: tuple[tuple[float, float], ...]) -> Layout:
        """Return the layout of one stick disk with further stick in intervals of slip.

        Parameters
        ----------
        intervals : tuple of (float, float)
            In ``y = 1 - s**2``, outward; one that ends at 0 reaches the edge.
        """
        [rim] = self.logits
        logits, states = [rim], [*self.states]
        for high, low in intervals:
            if low < high < 1.0 and logit_at(-log(high)) > rim:
                logits += [logit_at(-log(y)) for y in (high, low) if y > 0.0]
                states += [0, 1] if low > 0.0 else [0]
        return Layout(tuple(logits), tuple(states))
