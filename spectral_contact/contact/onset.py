"""Slip about to start, which cannot be told from full stick."""

from __future__ import annotations

from math import exp, inf, sqrt

from spectral_contact.contact.drive import Drive
from spectral_contact.contact.full_stick import FullStick
from spectral_contact.contact.zone_search import depth_of, full_stick_violations

__all__ = ["UNRESOLVED_SLIP", "unresolved_slip"]

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
    intervals = full_stick_violations(drive, stick, least, depth)
    if not intervals:
        return UNRESOLVED_SLIP
    y = exp(-intervals[0][0])
    radius = sqrt(1.0 - y)
    return max(UNRESOLVED_SLIP, y / (1.0 + radius) / radius)
