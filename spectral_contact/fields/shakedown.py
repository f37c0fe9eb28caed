"""The shakedown ratio: the least lowest load of a cycle, over the largest, at which slip stops.

It holds for a flat punch without elastic coupling (docs/cycles).
"""

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
        Of the shape of the input. If the lowest load of a cycle over the largest one is the ratio
        or more, slip stops after some cycles. With the error of the critical friction a positive
        ratio may be 0 after all, and its error is then infinite; a ratio of 0 may be positive after
        all, and its error is then 1.
    """

    ratio: Any
    error: Any


def shakedown(critical: ArrayLike, critical_error: ArrayLike, friction: ArrayLike) -> Shakedown:
    """Return ``lambda* = (R - f)/(R + f)``, which is 0 where f is not below R (docs/cycles).

    Parameters
    ----------
    critical, critical_error : array_like
        Critical friction R, the largest q/p of full stick, and the estimate of its relative error.
        With this friction and with more nothing slips under a rising load. R is infinite without
        tangential compliance.
    friction : array_like
        Coefficient f.
    """
    inputs = np.broadcast_arrays(critical, critical_error, friction)
    critical, critical_error, friction = (np.asarray(array, dtype=float) for array in inputs)
    slips = friction < critical
    is_one = np.isinf(critical) | (friction == 0.0)
    with np.errstate(all="ignore"):  # where a division fails, np.where takes another value below
        fraction = friction / critical
        # 1 - f/R; where f is close to R, R - f is exact
        difference = (critical - friction) / critical
        ratio_in_slip = difference / (1.0 + fraction)
        # R d(lambda*)/dR = 2 f R/(R + f)**2, over the least lambda* that the error of R allows
        smallest_difference = difference - critical_error
        change = 2.0 * fraction * critical_error / ((1.0 + fraction) * smallest_difference)
        error_in_slip = np.where(smallest_difference > 0.0, change, np.inf)
        error_in_stick = np.where(critical > friction * (1.0 - critical_error), 1.0, 0.0)
    ratio = np.where(slips, np.where(is_one, 1.0, ratio_in_slip), 0.0)
    error = np.where(slips, np.where(is_one, 0.0, error_in_slip), error_in_stick)
    return Shakedown(ratio[()], error[()])
