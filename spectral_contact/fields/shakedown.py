"""Which cycles of the load stop slipping: the shakedown ratio of a flat punch, uncoupled."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

__all__ = ["Shakedown", "shakedown"]


class Shakedown(NamedTuple):
    """The shakedown ratio lambda*, and the estimate of its relative error.

    Attributes
    ----------
    ratio, error : float or ndarray
        Of the shape of the input. The error is infinite where the ratio may be 0, and 1 where it is
        0 and may be positive.
    """

    ratio: Any
    error: Any


def shakedown(critical: ArrayLike, critical_error: ArrayLike, friction: ArrayLike) -> Shakedown:
    """Return ``lambda* = (R - f)/(R + f)``, which is 0 where f is not below R (docs/cycles).

    Parameters
    ----------
    critical, critical_error : array_like
        Critical friction R of full stick, infinite without tangential compliance, and the estimate
        of its relative error.
    friction : array_like
        Coefficient f.
    """
    known = np.broadcast_arrays(critical, critical_error, friction)
    largest, lost, f = (np.asarray(one, dtype=float) for one in known)
    slips = f < largest
    exact = np.isinf(largest) | (f == 0.0)
    with np.errstate(all="ignore"):  # where the division fails the quotient is not chosen
        share = f / largest
        difference = (largest - f) / largest  # exact but for the division, where f is close to R
        below = difference / (1.0 + share)
        margin = difference - lost
        changed = np.where(margin > 0.0, 2.0 * share * lost / ((1.0 + share) * margin), np.inf)
        missed = np.where(largest > f * (1.0 - lost), 1.0, 0.0)
    ratio = np.where(slips, np.where(exact, 1.0, below), 0.0)
    error = np.where(slips, np.where(exact, 0.0, changed), missed)
    return Shakedown(ratio[()], error[()])
