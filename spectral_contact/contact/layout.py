"""Where zones stick and slip: what searches find and like scenes hand on."""

from __future__ import annotations

from bisect import bisect
from dataclasses import dataclass
from math import log
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from spectral_contact.contact.resolution import TINY


class NoBoundariesError(ArithmeticError):
    """There are no such boundaries near by."""


def logit_at(x: float) -> float:
    """Return the logit ``ln(z/y)`` of the radius with ``y = exp(-x)``."""
    return float(np.log(-np.expm1(-x)) + x)


class Layout(NamedTuple):
    """Boundaries between zones, and what every zone does: 0 stick, +1 or -1 slip with that sign.

    Attributes
    ----------
    logits : tuple of float
        ``ln(b**2/(1 - b**2))`` of the boundaries, outward.
    states : tuple of int
        One more than boundaries; the first is 0.
    jacobian : ndarray, shape (boundaries, boundaries), optional
        Derivatives of the boundary residual by the logits, if known.
    """

    logits: tuple[float, ...]
    states: tuple[int, ...]
    jacobian: NDArray[np.float64] | None = None

    def with_stick(self, intervals: tuple[tuple[float, float], ...]) -> Layout:
        """Return the layout with further stick in intervals of slip.

        Parameters
        ----------
        intervals : tuple of (float, float)
            In ``y = 1 - s**2``, inside of slip zones; one that ends at 0 reaches the edge.
        """
        logits, states = self.logits, self.states
        for high, low in intervals:
            if not low < high < 1.0:
                continue
            ends = [logit_at(-log(y)) for y in (high, low) if y > 0.0]
            zone = bisect(logits, ends[0])
            if states[zone] != 0 and bisect(logits, ends[-1]) == zone:
                further = (0, states[zone])[: len(ends)]
                logits = (*logits[:zone], *ends, *logits[zone:])
                states = (*states[: zone + 1], *further, *states[zone + 1 :])
        return Layout(logits, states)


def unmoved(logit: float) -> Layout:
    """Return one stick disk whose boundary stays, so steep is its residual said to be."""
    return Layout((logit,), (0, 1), np.array([[1.0 / TINY]]))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ZoneNumbers:
    """What is said of zones for unit load; without elastic coupling for kappa = 1.

    Attributes
    ----------
    approach, total_shear : float
        ``delta*`` and ``Q*``.
    approach_error, shear_error, pressure_error, traction_error : float
        Estimates of relative errors; those of the fields, p and q/s, are pointwise.
    radius_error, zones_error : float
        Of ``c``, and the largest one of all boundaries, from the centre and from the edge;
        infinite if a zone may not be there.
    """

    approach: float
    total_shear: float
    approach_error: float
    shear_error: float
    pressure_error: float
    traction_error: float
    radius_error: float
    zones_error: float
