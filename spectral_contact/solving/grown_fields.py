"""The fields that a growing contact leaves, at every radius and as series.

What has stuck since the contact was as large as ``b_r`` has the increments of all later flat
punches and, if it slipped before, friction times the pressure of that time. The pressure has the
increments of both times. ``b_r`` is where the stick radius was ``r``; without slip, where the
contact was. By what a point has slipped it has slipped before.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

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
from spectral_contact.solving.growth import Growth
from spectral_contact.solving.growth_panel import Panel
from spectral_contact.spectral.annulus import Family, gap, sampled_series, transforms
from spectral_contact.spectral.jacobi import graded_rule
from spectral_contact.spectral.panels import LogPanels

__all__ = ["GrownField", "GrownFields", "opening"]

Array = NDArray[np.float64]

#: Panels towards the ends of a part, their width and degree; those to the centre go to where the
#: history begins.
_PANELS, _WIDTH, _DEGREE = 11, 2.0, 23
#: The least number of those to the centre.
_AT_CENTRE = 4
#: Panels where there are square roots, as a smooth surface has them.
_ROOT_PANELS = 26
#: Quadrature over the history, graded to where it begins: points, panels, and their ratio; the
#: same where there are square roots; what is smooth takes few points.
_GRADED, _ROOT_GRADED, _SMOOTH = (10, 16, 0.2), (10, 36, 0.2), (16, 1, 0.0)
#: The same for slip, which is bounded at the edge; graded to where a radius sticks, too.
_SLIP_GRADED, _ROOT_SLIP_GRADED = (10, 6, 0.2), (10, 12, 0.2)
#: How far apart, in a logarithm, the onset of slip and the stick radius are told apart.
_APART = 1e-6
#: Where the sign of the pressure is looked at, in the logarithm of the distance from the edge.
_SEEN, _LOOKS = (0.1, 45.0), 300
#: Bisections that find when a radius stuck.
_BISECTIONS = 60


@dataclass(frozen=True, slots=True)
class GrownField:
    """A field, what its series leave out, and its largest value."""

    field: ZonalField
    lost: float
    largest: float

    @property
    def share_lost(self) -> float:
        """What the series leave out, relative to the largest value."""
        return self.lost / self.largest if self.largest else 0.0


class GrownFields:
    """Fields over ``s = r/a`` that a history has left.

    Parameters
    ----------
    growth : Growth
    stick : Radius
        Today's stick radius over the contact radius.
    smooth : bool
        Whether one of the compliances is zero, so that there are square roots.
    """

    def __init__(self, growth: Growth, stick: Radius, *, smooth: bool) -> None:
        self.history = _History(growth, graded_rule(*(_ROOT_GRADED if smooth else _GRADED)))
        self._slip_rule = _both_ends(*(_ROOT_SLIP_GRADED if smooth else _SLIP_GRADED))
        self.stick, self._count = stick, _ROOT_PANELS if smooth else _PANELS
        self._inner = self._cuts(-math.inf, math.log(stick.value))
        self._outer = self._cuts(math.log(stick.value), 0.0)

    def _cuts(self, lowest: float, highest: float) -> list[Radius]:
        """Return where fields are not smooth: where something began, and what stuck then."""
        growth, found = self.history.growth, [lowest]
        begun = [*growth.breaks, *([growth.onset] if growth.onset else [])]
        logs = [math.log(one) for one in begun]
        places = logs + [u + stick for u in logs for stick in growth.log_stick(u)]
        for place in sorted(places):
            if found[-1] + _APART < place - growth.log_radius < highest - _APART:
                found.append(place - growth.log_radius)
        return [Radius(math.exp(x), -math.expm1(x)) for x in found[1:]]

    def traction(self, friction: float, pressure: PressureField | ZonalField) -> GrownField:
        """Return the traction.

        Parameters
        ----------
        friction : float
            Infinite for full stick.
        pressure : PressureField or ZonalField
            Today's.
        """

        def values(log_r: Array) -> Array:
            when = self.history.when_stuck(log_r)
            total = self.history.while_stuck("traction", log_r, when)
            if self.stick.from_edge > 0.0:
                total += friction * self.history.while_slipping("pressure", log_r, when)
            return total

        found = self._sampled(values, [CENTRE, *self._inner, self.stick], power=1)
        if self.stick.from_edge == 0.0:
            return found
        whole = pressure.pieces if isinstance(pressure, ZonalField) else [ZonePiece(EDGE, pressure)]
        slipping = [
            replace(one, factor=friction)
            for one in whole
            if one.outer.from_edge < self.stick.from_edge
        ]
        return GrownField(ZonalField((*found.field.pieces, *slipping)), found.lost, found.largest)

    def pressure(self) -> GrownField:
        """Return the pressure."""

        def values(log_r: Array) -> Array:
            when = self.history.when_stuck(log_r)
            total = self.history.while_stuck("pressure", log_r, when)
            return total + self.history.while_slipping("pressure", log_r, when)

        return self._sampled(values, [CENTRE, *self._inner, *self._ends()], power=0)

    def slip(self) -> GrownField:
        """Return by how far points have slipped since they came into contact."""

        def values(log_r: Array) -> Array:
            when = self.history.when_stuck(log_r)
            return self.history.while_slipping("slip", log_r, when, self._slip_rule, power=1)

        return self._sampled(values, [CENTRE, *self._inner, *self._ends()], power=1)

    def _ends(self) -> list[Radius]:
        """Return the stick radius, unless it is the edge, and what is outside."""
        return [EDGE] if self.stick.from_edge == 0.0 else [self.stick, *self._outer, EDGE]

    def _sampled(
        self, values: Callable[[Array], Array], ends: list[Radius], *, power: int
    ) -> GrownField:
        """Return the field with these values at logarithms of radii."""
        pieces, lost, largest = [], 0.0, 0.0
        for low, high in pairwise(ends):
            halves = []
            for boundary, sign in ((low, 1), (high, -1)):
                reach = gap(low, high) / 2.0
                panels = self.history.panels(boundary, reach, self._count)
                family = Family(boundary, sign, reach, panels)
                series = self._series(values, family, power)
                if boundary is CENTRE and power == 0 and self.history.growth.log_beginning:
                    series = _logarithmic(series)
                halves.append(series)
                size = _largest_radii(family) ** power
                last = np.abs(series.coefficients[:, -2:]).max(axis=1)
                lost = max(lost, float((size * last).max()))
                largest = max(largest, float((size * np.abs(series.at_ends()[:-1])).max()))
            pieces.append(ZonePiece(high, AnnulusSeries(low, high, halves[0], halves[1], power)))
        return GrownField(ZonalField(tuple(pieces)), lost, largest)

    def _series(self, values: Callable[[Array], Array], family: Family, power: int) -> LogSeries:
        """Return a field over ``s**power`` on a half of a part."""
        points = family.points(transforms(family.panels).distances)
        near_edge = points.y < 0.5
        outer, inner = np.where(near_edge, points.y, 0.0), np.where(near_edge, 1.0, points.z)
        shift = (np.log1p(-outer) + np.log(inner)) / 2.0
        found = values(self.history.growth.log_radius + shift) / np.exp(power * shift)
        return sampled_series(family.panels, found)


def opening(pressure: ZonalField) -> float | None:
    """Return the distance from the edge at which the pressure first changes sign, if it does."""

    def at(x: float | Array) -> Array:
        from_edge = np.exp(-np.atleast_1d(x))
        return pressure(1.0 - from_edge, from_edge)

    x = np.linspace(_SEEN[0], _SEEN[1], _LOOKS)
    negative = np.flatnonzero(at(x) < 0.0)
    if not len(negative) or negative[0] == 0:
        return None
    i = int(negative[0])
    return math.exp(-float(brentq(lambda x: float(at(x)[0]), x[i - 1], x[i])))


def _logarithmic(series: LogSeries) -> LogSeries:
    """Return a series that goes on as a logarithm beyond its panels."""
    last = series.coefficients[-1]
    n = np.arange(len(last))
    slope = float(last @ (n * (n + 1.0))) / series.width
    return replace(series, tail=np.array([last.sum()]), logarithm=slope)


def _largest_radii(family: Family) -> Array:
    """Return the largest radius of every panel."""
    d = np.exp(-_WIDTH * np.arange(family.panels.panels))
    squares = family.boundary.square + family.reach * (d if family.sign > 0 else 0.0 * d)
    return np.asarray(np.sqrt(squares))


class _History:
    """A growth, and what it adds up to."""

    def __init__(self, growth: Growth, rule: tuple[Array, Array]) -> None:
        self.growth, self.rule = growth, rule

    def panels(self, boundary: Radius, reach: float, count: int) -> LogPanels:
        """Return the panels towards an end of a part that extends so far in ``s**2``."""
        depth = 2.0 * (self.growth.log_radius - self.growth.all_panels[0].low) + math.log(reach)
        # what goes on to the centre is a series as far as there is something of it
        short = 0 if len(self.growth.all_panels) == len(self.growth.panels) else 2
        at_centre = max(math.ceil(depth / _WIDTH) - short, _AT_CENTRE)
        panels = at_centre if boundary is CENTRE else count
        return LogPanels(panels, _WIDTH, _DEGREE)

    def while_stuck(self, name: str, log_r: Array, stuck: Array) -> Array:
        """Return by how much a field grew at radii since they stuck."""
        total = np.zeros(len(log_r))
        for panel in self.growth.all_panels:
            # what stuck long before has a smooth integrand
            near = panel.low - stuck < panel.high - panel.low
            for rows, rule in (
                (near & (stuck < panel.high), self.rule),
                (~near, graded_rule(*_SMOOTH)),
            ):
                if rows.any():
                    total[rows] += _while_stuck(name, panel, log_r[rows], stuck[rows], rule)
        return total

    def while_slipping(
        self,
        name: str,
        log_r: Array,
        stuck: Array,
        rule: tuple[Array, Array] | None = None,
        power: int = 2,
    ) -> Array:
        """Return by how much a field, that of flat punches over ``b**power``, grew before."""
        total = np.zeros(len(log_r))
        for panel in self.growth.all_panels:
            begin, end = np.maximum(log_r, panel.low), np.minimum(stuck, panel.high)
            # far from where radii began to slip and stuck the integrand is smooth
            near = np.minimum(begin - log_r, stuck - end) < panel.high - panel.low
            slipped = (begin < end) & panel.slips
            for rows, by in (
                (slipped & near, rule or self.rule),
                (slipped & ~near, graded_rule(*_SMOOTH)),
            ):
                if rows.any():
                    span = begin[rows], end[rows]
                    total[rows] += _while_slipping(name, panel, log_r[rows], span, by, power)
        return total

    def when_stuck(self, log_r: Array) -> Array:
        """Return the logarithm of the contact radius at which these radii stuck."""
        stuck = np.array(log_r)
        for panel in self.growth.all_panels:
            if panel.slips:
                ends = panel.log_stick(np.array([-1.0, 1.0]))
                here = (log_r > panel.low + ends[0]) & (log_r <= panel.high + ends[1])
                stuck[here] = _crossed(panel, log_r[here])
        last = self.growth.panels[-1]
        if last.slips:
            beyond = log_r > last.high + last.log_stick(np.ones(1))[0]
            stuck[beyond] = last.high
        return stuck


def _while_stuck(
    name: str, panel: Panel, log_r: Array, stuck: Array, rule: tuple[Array, Array]
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
    values = panel.where_stuck(name, t, d.ravel()) * panel.increment(t) * np.exp(-2.0 * u.ravel())
    return np.asarray(extent[:, 0] * (values.reshape(u.shape) @ weights))


def _while_slipping(
    name: str,
    panel: Panel,
    log_r: Array,
    span: tuple[Array, Array],
    rule: tuple[Array, Array],
    power: int,
) -> Array:
    """Return what the increments of one panel add to radii while they slip."""
    begin, end = span
    extent = (end - begin)[:, None]
    points, weights = rule
    ahead = extent * points
    u = begin[:, None] + ahead
    depth = ((begin - log_r)[:, None] + ahead).ravel()
    t = panel.local(u).ravel()
    values = panel.where_slipping(name, t, -np.expm1(-2.0 * depth))
    values *= panel.increment(t) * np.exp(-power * u.ravel())
    return np.asarray(extent[:, 0] * (values.reshape(u.shape) @ weights))


def _both_ends(points: int, panels: int, ratio: float) -> tuple[Array, Array]:
    """Return a rule on (0, 1) whose panels shrink towards both ends."""
    nodes, weights = graded_rule(points, panels, ratio)
    halves = np.concatenate([nodes / 2.0, 1.0 - nodes / 2.0])
    return halves, np.concatenate([weights, weights]) / 2.0


def _crossed(panel: Panel, log_r: Array) -> Array:
    """Return where the stick radius is these radii."""
    low, high = np.full(len(log_r), panel.low), np.full(len(log_r), panel.high)
    for _ in range(_BISECTIONS):
        middle = (low + high) / 2.0
        below = middle + panel.log_stick(panel.local(middle)) < log_r
        low, high = np.where(below, middle, low), np.where(below, high, middle)
    return np.asarray((low + high) / 2.0)
