"""Slip about to start, which cannot be told from full stick."""

from __future__ import annotations

from collections.abc import Callable
from math import exp, inf, log, sqrt
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from spectral_contact.contact.drive import Drive
from spectral_contact.contact.full_stick import FullStick
from spectral_contact.fields.series import PressureField

if TYPE_CHECKING:
    from spectral_contact.contact.coupled_stick import CoupledStick

__all__ = ["UNRESOLVED_SLIP", "depth_of", "full_stick_violations", "unresolved_slip"]

Array = NDArray[np.float64]

#: Relative error of a stick radius of 1 when slip is about to start: an annulus opens like the
#: square root of what the friction lacks, 1e-13 at best.
UNRESOLVED_SLIP = 1e-6
#: Slip is wider than the place where full stick breaks the law: less than twice where that widens
#: like a square root of what the friction lacks, and less than four times where like that itself.
_WIDENED = 4.0


def unresolved_slip(drive: Drive, stick: FullStick, beta: float, friction: float) -> float:
    """Return the relative error of a stick radius of 1 where slip is about to start.

    The friction is so close to critical that the errors decide: there may be slip wherever full
    stick uses up all friction but for some of them.
    """
    if stick.critical == inf:
        return UNRESOLVED_SLIP
    lack = max(1.0 - friction / stick.critical, 0.0) + 2.0 * stick.critical_error
    depth = depth_of(drive.contact.compliance, beta, friction)
    least = stick.critical * (1.0 - min(_WIDENED * lack, 1.0))
    intervals = full_stick_violations(drive.pressure, stick, least, depth)
    if not intervals:
        return UNRESOLVED_SLIP
    y = exp(-intervals[0][0])
    radius = sqrt(1.0 - y)
    return max(UNRESOLVED_SLIP, y / (1.0 + radius) / radius)


def depth_of(alpha: float, beta: float, friction: float) -> float:
    """Return the ``x`` below which nothing changes any more."""
    if alpha == 0.0:
        # the edge sticks for y below (f beta / kappa)^2: there p exceeds what q can be
        return 2.0 * max(-log(min(friction, 1.0) * min(beta, 1.0)), 0.0) + 12.0
    return max(-log(min(alpha, beta, 1.0)), 0.0) + 30.0


def full_stick_violations(
    pressure: PressureField, stick: FullStick | CoupledStick, friction: float, depth: float
) -> list[tuple[float, float]]:
    """Return the intervals of ``x = -ln y`` where full stick breaks |q| <= f p, as (low, high)."""
    traction = stick.traction
    assert traction is not None

    def excess(x: Array) -> Array:
        y, s = np.exp(-x), np.sqrt(-np.expm1(-x))
        q = traction(s, y / (1.0 + s))
        p = pressure.at(y)
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = np.where(p > 0.0, np.abs(q) / p, np.inf)  # the contact would open
        return np.asarray(np.minimum(ratio, 2.0 * friction) - friction)

    x = np.linspace(1e-3, depth, 4001)
    peak = -log(stick.critical_at) if stick.critical_at > 0.0 else depth
    near = peak + np.concatenate(
        [-np.geomspace(1e-10, 1.0, 200), [0.0], np.geomspace(1e-10, 1.0, 200)]
    )
    x = np.unique(np.concatenate([x, near[(near > 0.0) & (near < depth)]]))
    above = excess(x) > 0.0
    intervals: list[tuple[float, float]] = []
    start: float | None = None
    for i in range(len(x)):
        if above[i] and start is None:
            start = float(x[0]) if i == 0 else _crossing(excess, x[i - 1], x[i])
        if start is not None and not above[i]:
            end = _crossing(excess, x[i - 1], x[i])
            intervals.append((start, end))
            start = None
    if start is not None:
        intervals.append((start, inf))
    return intervals


def _crossing(function: Callable[[Array], Array], a: float, b: float) -> float:
    from scipy.optimize import brentq

    def one(x: float) -> float:
        return float(function(np.array([x]))[0])

    if one(a) * one(b) >= 0.0:  # one by one they have the same sign: rounding is all there is
        return float(b)
    return float(brentq(one, a, b, xtol=1e-14))
