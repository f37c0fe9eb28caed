"""The traction that a growing contact leaves, at every radius and as a field.

What has stuck since the contact was as large as ``b_r`` has the increments of all later flat
punches and, if it slipped before, friction times the pressure of that time. ``b_r`` is where the
stick radius was ``r``; without slip, where the contact was.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from spectral_contact.fields.series import (
    CENTRE,
    EDGE,
    AnnulusSeries,
    LogSeries,
    PressureField,
    Radius,
    ZonalField,
    ZonePiece,
)
from spectral_contact.solving.growth import Growth, Panel
from spectral_contact.spectral.annulus import Family, gap, sampled_series
from spectral_contact.spectral.jacobi import graded_rule
from spectral_contact.spectral.panels import LogPanels
from spectral_contact.spectral.transforms import transforms

__all__ = ["GrownTraction", "grown_traction"]

Array = NDArray[np.float64]

#: Panels towards the ends of a part, their width and degree; those to the centre go to where the
#: history begins.
_PANELS, _WIDTH, _DEGREE = 11, 2.0, 23
#: Panels where there are square roots, as a smooth surface has them.
_ROOT_PANELS = 26
#: Quadrature over the history, graded to where it begins: points, panels, and their ratio; the
#: same where there are square roots; what is smooth takes few points.
_GRADED, _ROOT_GRADED, _SMOOTH = (10, 16, 0.2), (10, 36, 0.2), (16, 1, 0.0)
#: Bisections that find when a radius stuck.
_BISECTIONS = 60


@dataclass(frozen=True, slots=True)
class GrownTraction:
    """The field, and what its series leave out, relative to the largest traction."""

    field: ZonalField
    error: float


def grown_traction(
    growth: Growth,
    stick: Radius,
    friction: float,
    pressure: PressureField | ZonalField,
    *,
    smooth: bool,
) -> GrownTraction:
    """Return the traction over ``s = r/a``.

    Parameters
    ----------
    growth : Growth
    stick : Radius
        Today's stick radius over the contact radius.
    friction : float
        Infinite for full stick.
    pressure : PressureField or ZonalField
        Today's, of a profile without breaks.
    smooth : bool
        Whether one of the compliances is zero, so that there are square roots.
    """
    history = _History(growth, friction, graded_rule(*(_ROOT_GRADED if smooth else _GRADED)))
    inner: list[Radius] = []
    if growth.onset and growth.onset < growth.radius * stick.value * (1.0 - 1e-6):
        share = growth.onset / growth.radius
        inner = [Radius(share, 1.0 - share)]
    pieces, lost, largest = [], 0.0, 0.0
    for low, high in pairwise([CENTRE, *inner, stick]):
        halves = []
        for boundary, sign in ((low, 1), (high, -1)):
            panels = history.panels(boundary, _ROOT_PANELS if smooth else _PANELS)
            family = Family(boundary, sign, gap(low, high) / 2.0, panels)
            series = history.series(family)
            halves.append(series)
            size = _largest_radii(family)
            last = np.abs(series.coefficients[:, -2:]).max(axis=1)
            lost = max(lost, float((size * last).max()))
            largest = max(largest, float((size * np.abs(series.at_ends()[:-1])).max()))
        pieces.append(ZonePiece(high, AnnulusSeries(low, high, halves[0], halves[1], power=1)))
    if stick.from_edge > 0.0:
        field = pressure.pieces[-1].field if isinstance(pressure, ZonalField) else pressure
        pieces.append(ZonePiece(EDGE, field, friction))
    return GrownTraction(ZonalField(tuple(pieces)), lost / largest if largest else 0.0)


def _largest_radii(family: Family) -> Array:
    """Return the largest radius of every panel."""
    d = np.exp(-_WIDTH * np.arange(family.panels.panels))
    squares = family.boundary.square + family.reach * (d if family.sign > 0 else 0.0 * d)
    return np.asarray(np.sqrt(squares))


class _History:
    """A growth, and what it adds up to."""

    def __init__(self, growth: Growth, friction: float, rule: tuple[Array, Array]) -> None:
        self.growth, self.friction, self.rule = growth, friction, rule

    def panels(self, boundary: Radius, count: int) -> LogPanels:
        """Return the panels towards an end of a part."""
        depth = 2.0 * (math.log(self.growth.radius) - self.growth.panels[0].low)
        panels = math.ceil(depth / _WIDTH) if boundary is CENTRE else count
        return LogPanels(panels, _WIDTH, _DEGREE)

    def series(self, family: Family) -> LogSeries:
        """Return q/s on a half of a part."""
        points = family.points(transforms(family.panels).distances)
        near_edge = points.y < 0.5
        outer, inner = np.where(near_edge, points.y, 0.0), np.where(near_edge, 1.0, points.z)
        shift = (np.log1p(-outer) + np.log(inner)) / 2.0
        values = self.traction(math.log(self.growth.radius) + shift) / np.exp(shift)
        return sampled_series(family.panels, values)

    def traction(self, log_r: Array) -> Array:
        """Return the traction at radii."""
        stuck = self.when_stuck(log_r)
        total = np.zeros(len(log_r))
        for panel in self.growth.panels:
            # what stuck long before has a smooth integrand
            near = panel.low - stuck < panel.high - panel.low
            for rows, rule in (
                (near & (stuck < panel.high), self.rule),
                (~near, graded_rule(*_SMOOTH)),
            ):
                if rows.any():
                    total[rows] += self.while_stuck(panel, log_r[rows], stuck[rows], rule)
            if panel.slips:
                begin, end = np.maximum(log_r, panel.low), np.minimum(stuck, panel.high)
                slid = begin < end
                if slid.any():
                    moved = self.while_slipping(panel, log_r[slid], begin[slid], end[slid])
                    total[slid] += self.friction * moved
        return total

    def when_stuck(self, log_r: Array) -> Array:
        """Return the logarithm of the contact radius at which these radii stuck."""
        stuck = np.array(log_r)
        for panel in self.growth.panels:
            if panel.slips:
                ends = panel.log_stick(np.array([-1.0, 1.0]))
                here = (log_r > panel.low + ends[0]) & (log_r <= panel.high + ends[1])
                stuck[here] = _crossed(panel, log_r[here])
        last = self.growth.panels[-1]
        if last.slips:
            beyond = log_r > last.high + last.log_stick(np.ones(1))[0]
            stuck[beyond] = last.high
        return stuck

    def while_stuck(
        self, panel: Panel, log_r: Array, stuck: Array, rule: tuple[Array, Array]
    ) -> Array:
        """Return what the increments of one panel add to radii that stick."""
        begin = np.maximum(stuck, panel.low)
        extent = (panel.high - begin)[:, None]
        points, weights = rule
        ahead = extent * points
        u = begin[:, None] + ahead
        t = panel.local(u).ravel()
        start = panel.log_stick(panel.local(begin))
        # how far inside the stick radius: exactly at it when they stuck
        since = np.where(stuck < panel.low, begin + start - log_r, 0.0)
        grown = panel.log_stick(t).reshape(u.shape) - start[:, None]
        d = np.clip(-np.expm1(-2.0 * (since[:, None] + ahead + grown)), 0.0, 1.0)
        values = panel.traction(t, d.ravel()) * panel.increment(t) * np.exp(-2.0 * u.ravel())
        return np.asarray(extent[:, 0] * (values.reshape(u.shape) @ weights))

    def while_slipping(self, panel: Panel, log_r: Array, begin: Array, end: Array) -> Array:
        """Return by how much the pressure grew while these radii slipped."""
        extent = (end - begin)[:, None]
        points, weights = self.rule
        ahead = extent * points
        u = begin[:, None] + ahead
        depth = ((begin - log_r)[:, None] + ahead).ravel()
        t = panel.local(u).ravel()
        values = panel.pressure(t, np.exp(-depth), -np.expm1(-depth))
        values *= panel.increment(t) * np.exp(-2.0 * u.ravel())
        return np.asarray(extent[:, 0] * (values.reshape(u.shape) @ weights))


def _crossed(panel: Panel, log_r: Array) -> Array:
    """Return where the stick radius is these radii."""
    low, high = np.full(len(log_r), panel.low), np.full(len(log_r), panel.high)
    for _ in range(_BISECTIONS):
        middle = (low + high) / 2.0
        below = middle + panel.log_stick(panel.local(middle)) < log_r
        low, high = np.where(below, middle, low), np.where(below, high, middle)
    return np.asarray((low + high) / 2.0)
