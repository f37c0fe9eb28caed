r"""Pressure under a profile on a smooth surface: Abel's integral inverted, without a system.

There the half-integral is known, ``F = H(1) - H(t)``, and ``p(s) = (2/pi) int_s^1 H'(t) dt /
sqrt(t^2 - s^2)``. With ``w^2 = t^2 - s^2`` the integrand is ``H'(t)/t dw``: smooth but where t
meets a break of the profile or the tip, to which panels of the quadrature are graded.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import pi

import numpy as np
from numpy.typing import NDArray

from spectral_contact.contact.resolution import PANEL_WIDTH, ROUNDING
from spectral_contact.fields.series import CENTRE, EDGE, LogSeries
from spectral_contact.profiles import Profile
from spectral_contact.spectral.annulus import Family, sampled_series, transforms
from spectral_contact.spectral.jacobi import graded_rule
from spectral_contact.spectral.panels import LogPanels
from spectral_contact.spectral.parted import Parts

__all__ = ["SmoothPressure", "smooth_pressure"]

Array = NDArray[np.float64]

#: Quadrature towards a break or tip, and where there is none: points, panels, and their ratio.
_GRADED, _PLAIN = (20, 44, 0.3), (60, 1, 0.0)
#: What a pressure grows over a panel in the logarithm of the distance is rounding if it is less;
#: and a logarithm if it is no smaller a share of what it grew over the one before.
_ROUNDED, _LOGARITHM = 1e-13, 1.0 - 1e-6
#: Degree on a panel; panels to the edge, where what is over the weight is smooth, and to a break:
#: there they end at 4e-18 of the square of the radius.
_DEGREE, _TO_EDGE, _TO_BREAK = 24, 8, 40


@dataclass(frozen=True, slots=True)
class SmoothPressure:
    """Series on every part, and an estimate of their relative error."""

    series: list[LogSeries]
    error: float


def smooth_pressure(profile: Profile, radius: float, parts: Parts) -> SmoothPressure:
    """Return the pressure on a smooth surface; next to the edge with the weight ``sqrt(d)``.

    Parameters
    ----------
    profile : Profile
    radius : float
        Of the contact.
    parts : Parts
        Graded to the profile's breaks.
    """
    found, worst = [], 0.0
    for end in parts.ends:
        at_edge = end[0] is EDGE
        panels = LogPanels(_TO_EDGE if at_edge else _TO_BREAK, PANEL_WIDTH, _DEGREE)
        family = Family(*end, panels)
        series = sampled_series(panels, _values(profile, radius, parts, family))
        size = np.abs(series.at_ends())
        last = np.abs(series.coefficients[:, -2:]).max(axis=1)
        worst = max(worst, float((last / np.maximum(size[:-1], size[1:])).max()))
        if at_edge:
            found.append(replace(series, power=0.5))
            continue
        continued, lost = _to_the_break(series)
        found.append(continued)
        worst = max(worst, lost)
    return SmoothPressure(found, worst)


def _to_the_break(series: LogSeries) -> tuple[LogSeries, float]:
    """Return a series with the limit at a break or tip, or a tail that goes on as a logarithm.

    Next to the tip of a power law the pressure settles like a power of the distance, which may be
    a slow one: its limit follows from how it grows over the last two panels, and is the less
    certain the slower it is. That is the other number, relative to the limit.
    """
    before, middle, end = series.at_ends()[-3:].tolist()
    grown = end - middle
    if abs(grown) <= _ROUNDED * abs(end):
        return series, 0.0
    ratio = grown / (middle - before) if middle != before else 1.0
    if ratio < _LOGARITHM:
        limit = end + grown * ratio / (1.0 - ratio)
        return replace(series, tail=np.array([limit])), 2.0 * ROUNDING / (1.0 - ratio) ** 2
    slope = 2.0 / series.width * float(series.coefficients[-1, 1])
    return replace(series, tail=np.array([end]), logarithm=slope), 0.0


def _values(profile: Profile, radius: float, parts: Parts, family: Family) -> Array:
    """Return the pressure at the sampling points of a part, at the edge over ``sqrt(d)``."""
    at_edge = family.boundary is EDGE
    points = family.points(transforms(family.panels).distances)
    bounds = (*parts.breaks, EDGE)
    rule, weights = graded_rule(*(_GRADED if len(parts.ends) > 1 else _PLAIN))
    total = np.zeros(len(points.offset))
    for k, outer in enumerate(bounds):
        inner = CENTRE if k == 0 else bounds[k - 1]
        room = np.maximum(points.before(outer), 0.0)
        if not room.any():
            continue
        below = points.before(inner)  # of the square of the inner break, negative if that is inside
        inside = below > 0.0
        # over w from the point itself, or over v with v^2 = t^2 - inner^2 from the break on
        start = np.where(inside, below, 0.0)
        extent = np.where(inside, room - start, room)
        v = np.sqrt(extent)[:, None] * rule
        past = v**2 - np.where(inside, 0.0, below)[:, None]
        w = np.sqrt(v**2 + start[:, None])
        t = np.sqrt(v**2 + np.where(inside, inner.square, points.z)[:, None])
        rates = profile._rate(radius * t, radius**2 * past if k else np.zeros(t.shape))
        along = np.where(inside[:, None], v / np.where(w > 0.0, w, 1.0), 1.0)
        sums = (rates / t * along) @ weights
        # the last interval has the factor sqrt(d), which the weight stands for
        total += sums * (np.sqrt(family.reach) if at_edge else np.sqrt(extent))
    return np.asarray(2.0 / pi * total)
