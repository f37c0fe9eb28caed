"""The fields that a growing contact leaves, at every radius and as series.

A point at radius ``r`` comes into contact when the contact radius ``b`` is ``r``. It sticks from
``b_r`` on, when the stick radius is ``r``; without slip that is at once. Its traction is that of
all later flat punches and, if it slipped before, friction times the pressure of that time. Its
pressure grows at both times, its slip only before it sticks. Radii are logarithms:
``log_r`` of points, and ``u = ln b``; t in [-1, 1] is the place in a panel of the history.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from scipy.optimize import brentq
from scipy.special import expit

from spectral_contact.fields import Array
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
from spectral_contact.solving.growth_panel import TINY, Panel
from spectral_contact.spectral.jacobi import graded_rule
from spectral_contact.spectral.panels import LogPanels
from spectral_contact.spectral.parts import GradedMesh, gap
from spectral_contact.spectral.transforms import sampled_series

#: Values of fields at some radii, by name.
Fields = dict[str, Array]

#: Width in a logarithm of the panels towards the ends of a part, and the factor by which each
#: degree of their Legendre series divides the error: the nearest singularity is at the other end.
_WIDTH, _GAIN = 2.0, 3.05
#: The least number of panels towards the centre.
_AT_CENTRE = 4
#: The fewest panels, and how many where there are square roots, as a smooth surface has them.
_FEWEST, _ROOT_PANELS = 11, 26
#: How far into the edge, as a power of the tolerance in shares of the layer, panels go, where
#: fields are bounded.
_DEEP = 0.75
#: Tolerance of the quadrature over the history, relative to that of the fields: estimates may be a
#: fiftieth of the tolerance that is asked for.
_QUADRATURE = 1e-3
#: Gauss points for a smooth part of the history.
_SMOOTH = 16
#: A history is smooth if it begins so far from a singularity, in lengths of the panel.
_NEAR = 0.3
#: What series leave out, over their last terms: 1.3 for a traction with square roots.
_SAFETY = 3.0
#: Radii at which a field is not smooth count as one if their logarithms are closer.
_APART = 1e-6
#: Range of minus the logarithm of the distance from the edge in which the pressure is sampled for a
#: change of sign, and the number of samples.
_SEEN, _LOOKS = (0.1, 45.0), 300
#: A field of a flat punch is of the order of its load over this power of the contact radius.
_POWERS = {"pressure": 2, "traction": 2, "slip": 1}
#: Bisections that find when a radius stuck.
_BISECTIONS = 60


@dataclass(frozen=True, slots=True)
class GrownField:
    """A field, an estimate of what series and quadrature leave out, and its largest value."""

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
    layer : float
        The least compliance, in radii; where it is zero there are square roots.
    tolerance : float
    names : collection of str
        The fields that are wanted, of "pressure", "traction" and "slip". They are sampled at the
        same radii, and computed together there.
    """

    def __init__(
        self,
        growth: Growth,
        stick: Radius,
        layer: float,
        tolerance: float,
        names: Collection[str],
    ) -> None:
        digits = -math.log(tolerance)
        # on a smooth surface roots go on to the edge
        edge = -math.log(min(max(layer, TINY), 1.0))
        count = max(2 + int((2.0 * edge + _DEEP * digits) / _WIDTH), _FEWEST)
        self._quadrature_error = _QUADRATURE * tolerance
        exact = -math.log(self._quadrature_error)
        # A field goes like ln(x)/sqrt(x) at the edge, and nodes from x = exp(-2 half_depth) on
        # leave out -2 sqrt(x) ln(x). Within the layer it is bounded.
        half_depth = exact + math.log(4.0 * exact)
        self.history = _History(
            growth,
            rule=tanh_rule(exact, depth=half_depth + min(edge, half_depth)),
            degree=math.ceil((digits + _WIDTH) / math.log(_GAIN)),
        )
        self._while_stuck = [name for name in ("pressure", "traction") if name in names]
        self._while_slipping = ["pressure"] if self._while_stuck else []
        if "slip" in names:
            self._while_slipping.append("slip")
        self._increments: dict[bytes, tuple[Fields, Fields]] = {}
        self.stick, self._count = stick, min(count, _ROOT_PANELS)
        self._inner = self._cuts(-math.inf, stick.log)
        self._outer = self._cuts(stick.log, 0.0)

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
            stuck, slipping = self._increments_at(log_r)
            if self.stick.from_edge == 0.0:
                return stuck["traction"]
            return stuck["traction"] + friction * slipping["pressure"]

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
            stuck, slipping = self._increments_at(log_r)
            return stuck["pressure"] + slipping["pressure"]

        return self._sampled(values, [CENTRE, *self._inner, *self._ends()], power=0)

    def slip(self) -> GrownField:
        """Return by how far points have slipped since they came into contact."""

        def values(log_r: Array) -> Array:
            return self._increments_at(log_r)[1]["slip"]

        return self._sampled(values, [CENTRE, *self._inner, *self._ends()], power=1)

    def _increments_at(self, log_r: Array) -> tuple[Fields, Fields]:
        """Return by how much fields grew at radii since they stuck, and before; computed once."""
        key = log_r.tobytes()
        if key not in self._increments:
            when = self.history.when_stuck(log_r)
            self._increments[key] = (
                self.history.while_stuck(self._while_stuck, log_r, when),
                self.history.while_slipping(self._while_slipping, log_r, when),
            )
        return self._increments[key]

    def _ends(self) -> list[Radius]:
        """Return the stick radius, unless it is the edge, and what is outside."""
        return [EDGE] if self.stick.from_edge == 0.0 else [self.stick, *self._outer, EDGE]

    def _sampled(
        self, values: Callable[[Array], Array], ends: list[Radius], *, power: int
    ) -> GrownField:
        pieces, lost, largest = [], 0.0, 0.0
        for low, high in pairwise(ends):
            halves = []
            for boundary, sign in ((low, 1), (high, -1)):
                reach = gap(low, high) / 2.0
                panels = self.history.panels(boundary, reach, self._count)
                mesh = GradedMesh(boundary, sign, reach, panels)
                series = self._series(values, mesh, power)
                if boundary is CENTRE and power == 0 and self.history.growth.log_beginning:
                    series = _logarithmic(series)
                halves.append(series)
                size = _largest_radii(mesh) ** power
                last = _SAFETY * np.abs(series.coefficients[:, -2:]).max(axis=1)
                lost = max(lost, float((size * last).max()))
                largest = max(largest, float((size * np.abs(series.at_ends()[:-1])).max()))
            pieces.append(ZonePiece(high, AnnulusSeries(low, high, halves[0], halves[1], power)))
        lost += self._quadrature_error * largest
        return GrownField(ZonalField(tuple(pieces)), lost, largest)

    def _series(self, values: Callable[[Array], Array], mesh: GradedMesh, power: int) -> LogSeries:
        """Return a field over ``s**power`` on a half of a part."""
        points = mesh.points(mesh.panels.sampling_distances)
        near_edge = points.y < 0.5
        outer, inner = np.where(near_edge, points.y, 0.0), np.where(near_edge, 1.0, points.z)
        shift = (np.log1p(-outer) + np.log(inner)) / 2.0
        found = values(self.history.growth.log_radius + shift) / np.exp(power * shift)
        return sampled_series(mesh.panels, found)


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


def _largest_radii(mesh: GradedMesh) -> Array:
    d = np.exp(-_WIDTH * np.arange(mesh.panels.count))
    squares = mesh.boundary.square + mesh.extent * (d if mesh.sign > 0 else 0.0 * d)
    return np.asarray(np.sqrt(squares))


class _History:
    """A growth, and what it adds up to.

    `rule` is the quadrature over a part of the history at whose ends fields may be singular: the
    pressure of a flat punch has a root at the edge and, with coupling, one at its stick radius.
    `smooth_rule`, of Gauss, is that over any other part. `degree` is that of the series.
    """

    def __init__(self, growth: Growth, rule: tuple[Array, Array], degree: int) -> None:
        self.growth = growth
        self.rule = rule
        self.smooth_rule = graded_rule(_SMOOTH, 1, 0.0)
        self.degree = degree

    def panels(self, boundary: Radius, reach: float, count: int) -> LogPanels:
        """Return the panels towards an end of a part that extends so far in ``s**2``."""
        depth = 2.0 * (self.growth.log_radius - self.growth.all_panels[0].low) + math.log(reach)
        # The panels next to the centre have what continues the history below its first radius.
        # Without that there is nothing in the last two of them.
        short = 0 if len(self.growth.all_panels) == len(self.growth.panels) else 2
        at_centre = max(math.ceil(depth / _WIDTH) - short, _AT_CENTRE)
        panels = at_centre if boundary is CENTRE else count
        return LogPanels(panels, _WIDTH, self.degree)

    def while_stuck(self, names: Sequence[str], log_r: Array, stuck: Array) -> Fields:
        """Return by how much fields grew at radii since they stuck."""
        total = np.zeros((len(names), len(log_r)))
        for panel in self.growth.all_panels:
            # what stuck long before has a smooth integrand
            near = panel.stretch.before(stuck) < _NEAR * panel.stretch.extent
            for rows, rule in (
                (near & (stuck < panel.high), self.rule),
                (~near, self.smooth_rule),
            ):
                if names and rows.any():
                    total[:, rows] += _while_stuck(names, panel, log_r[rows], stuck[rows], rule)
        return dict(zip(names, total, strict=True))

    def while_slipping(self, names: Sequence[str], log_r: Array, stuck: Array) -> Fields:
        """Return by how much fields grew at radii before they stuck."""
        total = np.zeros((len(names), len(log_r)))
        for panel in self.growth.all_panels:
            begin, end = np.maximum(log_r, panel.low), np.minimum(stuck, panel.high)
            # far from where radii began to slip and stuck the integrand is smooth
            room = _NEAR * panel.stretch.extent
            near = (panel.stretch.before(log_r) < room) | (stuck - end < panel.high - panel.low)
            slipped = (begin < end) & panel.slips
            for rows, rule in (
                (slipped & near, self.rule),
                (slipped & ~near, self.smooth_rule),
            ):
                if names and rows.any():
                    span = begin[rows], end[rows]
                    total[:, rows] += _while_slipping(names, panel, log_r[rows], span, rule)
        return dict(zip(names, total, strict=True))

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
    names: Sequence[str], panel: Panel, log_r: Array, stuck: Array, rule: tuple[Array, Array]
) -> Array:
    """Return what the increments of one panel add to radii that stick, (names, radii)."""
    stretch, begin = panel.stretch, np.maximum(stuck, panel.low)
    points, weights = rule
    depth = stretch.depth_of(begin)[:, None]
    extent = stretch.step(depth, (panel.high - begin)[:, None])
    t, ahead = stretch.place(depth + extent * points), stretch.ahead(depth, extent * points)
    # how far inside the stick radius: exactly at it when they stuck
    if panel.slips:
        start = panel.log_stick(stretch.place(depth))
        inside = ahead + panel.log_stick(t) - start
        inside += np.where(stuck < panel.low, begin - log_r, 0.0)[:, None]
        inside += np.where(stuck[:, None] < panel.low, start, 0.0)
        inside = np.maximum(inside, 0.0)
    else:
        inside = ahead + (begin - log_r)[:, None]
    t = t.ravel()
    values = panel.where_stuck(names, t, inside.ravel()) * panel.increment(t)
    values = values.reshape(-1, *ahead.shape) * np.exp(-2.0 * (begin[:, None] + ahead))
    return np.asarray(extent[:, 0] * (values @ weights))


def _while_slipping(
    names: Sequence[str],
    panel: Panel,
    log_r: Array,
    span: tuple[Array, Array],
    rule: tuple[Array, Array],
) -> Array:
    """Return what the increments of one panel add to radii while they slip, (names, radii)."""
    stretch, (begin, end) = panel.stretch, span
    points, weights = rule
    depth = stretch.depth_of(begin)[:, None]
    extent = stretch.step(depth, (end - begin)[:, None])
    t = stretch.place(depth + extent * points).ravel()
    ahead = stretch.ahead(depth, extent * points)
    values = panel.where_slipping(names, t, ((begin - log_r)[:, None] + ahead).ravel())
    values = (values * panel.increment(t)).reshape(-1, *ahead.shape)
    for name, of_field in zip(names, values, strict=True):
        of_field *= np.exp(-_POWERS[name] * (begin[:, None] + ahead))
    return np.asarray(extent[:, 0] * (values @ weights))


def tanh_rule(digits: float, depth: float) -> tuple[Array, Array]:
    """Return nodes and weights on (0, 1) for what is singular at one end or both.

    It is the trapezoidal rule in ``y``, ``x = 1/(1 + exp(-y))`` (Trefethen and Weideman 2014,
    section 14): what is analytic in a strip of half width ``pi/2``, which is the disk over (0, 1),
    has an error of ``exp(-pi**2/step)``.

    Parameters
    ----------
    digits : float
        Minus the natural logarithm of the error.
    depth : float
        Minus the natural logarithm of the distance of the outermost nodes from the ends.
    """
    step = math.pi**2 / digits
    count = math.ceil(depth / step)
    y = step * np.arange(-count, count + 1)
    nodes = expit(y)
    return nodes, step * nodes * expit(-y)


def _crossed(panel: Panel, log_r: Array) -> Array:
    """Return where the stick radius is these radii."""
    if panel.alike:
        return np.asarray(log_r - panel.stick[0])
    low, high = -np.ones(len(log_r)), np.ones(len(log_r))
    for _ in range(_BISECTIONS):
        middle = (low + high) / 2.0
        below = panel.stretch.log_radius_at(middle) < log_r - panel.log_stick(middle)
        low, high = np.where(below, middle, low), np.where(below, high, middle)
    return panel.stretch.log_radius_at((low + high) / 2.0)
