"""Pressure, traction and slip of a contact that has grown: integrals over its history.

A point at the radius ``r`` comes into contact when the contact radius ``b`` is ``r``. It slips
until the stick radius ``c(b)`` has grown to ``r``, at ``b = b_r``, and sticks from then on. Where
there is no slip it sticks at once. Each field at the point is an integral of the fields of flat
punches over the increments of the load (docs/theory, G.4):

- the pressure from ``b = r`` to today's contact radius ``a``,
- the slip from ``r`` to ``b_r``,
- the traction from ``b_r`` to ``a``, plus friction times the pressure gained from ``r`` to ``b_r``.

The fields are sampled, and given as series in ``s = r/a``.

Radii are over today's contact radius, and given by logarithms: ``log_r = ln(r/a)`` of points, ``u =
ln(b/a)`` of contacts, and `u_stick`, which is ``ln(b_r/a)``. The coordinate ``v``, the place ``t``
and the depth, which is the distance in ``v`` from the lower end of a panel, are those of its
`RadiusStretch`.
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
from spectral_contact.spectral.parts import GradedMesh, z_difference
from spectral_contact.spectral.transforms import sampled_series

#: Values of fields at some radii, by name.
Fields = dict[str, Array]

#: Width of the panels on which fields have series, in the logarithm of the distance from the end of
#: an annulus; the distance is a difference of ``s**2``.
_PANEL_WIDTH = 2.0
#: Factor by which each degree of the Legendre series on a panel divides the error. The nearest
#: singularity is at the other end of the annulus.
_GAIN_PER_DEGREE = 3.05
#: Least number of panels towards the centre.
_FEWEST_AT_CENTRE = 4
#: Least number of panels towards any other end of an annulus.
_FEWEST_PANELS = 11
#: Largest number of panels there; it is enough for square roots, which fields have on a smooth
#: surface.
_MOST_PANELS = 26
#: With a layer fields are bounded at the edge. Panels end at a distance that is the square of the
#: compliance times this power of the tolerance.
_EDGE_POWER = 0.75
#: Tolerance of the quadrature over the history, relative to that of the fields. It is so small
#: because the other errors together may be a fiftieth of the tolerance.
_QUADRATURE_FRACTION = 1e-3
#: Number of Gauss points for a smooth integrand over a part of the history.
_SMOOTH_POINTS = 16
#: An integrand over a part of a panel is smooth if this part begins farther than this from the
#: radius at which the integrand is singular, in extents of the panel.
_NEAR_SINGULARITY = 0.3
#: Error estimate of a series over its last coefficients. The error of a traction with square roots
#: was 1.3 times these.
_SERIES_ERROR_FACTOR = 3.0
#: A radius at which a field is not smooth is left out if its logarithm is closer than this to that
#: of the one before it, or to an end of the zone.
_KINK_SPACING = 1e-6
#: Range of minus the logarithm of the distance from the edge in which the pressure is sampled for a
#: change of sign.
_OPENING_RANGE = (0.1, 45.0)
#: Number of these samples.
_OPENING_SAMPLES = 300
#: Under the same load a flat punch of radius b has the fields of that of radius 1, divided by these
#: powers of b.
_RADIUS_POWERS = {"pressure": 2, "traction": 2, "slip": 1}
#: Number of bisections for the contact radius at which a point begins to stick.
_BISECTIONS = 60


@dataclass(frozen=True, slots=True)
class GrownField:
    """A field with the error of its series and quadrature.

    Attributes
    ----------
    field : ZonalField
    error : float
        Estimate of this error, in the unit of the field.
    largest : float
        Largest absolute value of the field at the ends of panels.
    """

    field: ZonalField
    error: float
    largest: float

    @property
    def relative_error(self) -> float:
        """The error over the largest value; 0 for a field that is zero."""
        return self.error / self.largest if self.largest else 0.0


class GrownFields:
    """Fields over ``s = r/a`` at the end of a history.

    Parameters
    ----------
    growth : Growth
        The history, up to today.
    radius : float
        Today's contact radius ``a``.
    stick : Radius
        Today's stick radius over the contact radius.
    layer : float
        The smaller of the two compliances of the layer, in contact radii. If it is zero, fields
        have square roots at the edge.
    tolerance : float
        Relative to the largest value of each field.
    names : collection of str
        The fields that are wanted, of "pressure", "traction" and "slip". They are sampled at the
        same radii, and computed together there.

    Attributes
    ----------
    growth, radius
        As given.
    history : _History
        Integrals over the same history, with today's contact radius as the unit of length.
    """

    def __init__(
        self,
        growth: Growth,
        radius: float,
        stick: Radius,
        layer: float,
        tolerance: float,
        names: Collection[str],
    ) -> None:
        # minus natural logarithms of tolerances, as of `tanh_rule`
        digits = -math.log(tolerance)
        # Fields are like square roots of the distance from the edge, or inverse ones, down to the
        # distance `layer`, and bounded closer to the edge. This is minus the logarithm of `layer`.
        edge_depth = -math.log(min(max(layer, TINY), 1.0))
        count = max(
            2 + int((2.0 * edge_depth + _EDGE_POWER * digits) / _PANEL_WIDTH), _FEWEST_PANELS
        )
        self._quadrature_error = _QUADRATURE_FRACTION * tolerance
        quadrature_digits = -math.log(self._quadrature_error)
        # Nodes begin at a distance z from the edge. If a field is like ln(z)/sqrt(z) they leave out
        # -2 sqrt(z) ln(z), which is the tolerated error if z = exp(-2 half_depth). With a layer the
        # field is bounded next to the edge, and they may begin farther away.
        half_depth = quadrature_digits + math.log(4.0 * quadrature_digits)
        self.growth = growth
        self.radius = radius
        self.history = _History(
            growth.in_contact_radii(),
            rule=tanh_rule(quadrature_digits, depth=half_depth + min(edge_depth, half_depth)),
            degree=math.ceil((digits + _PANEL_WIDTH) / math.log(_GAIN_PER_DEGREE)),
        )
        # the wanted fields that grow while a point sticks, and those that grow while it slips
        self._names_stuck = [name for name in ("pressure", "traction") if name in names]
        self._names_slipping = ["pressure"] if self._names_stuck else []
        if "slip" in names:
            self._names_slipping.append("slip")
        #: results of `_integrals_at`, by the bytes of the radii
        self._integrals: dict[bytes, tuple[Fields, Fields]] = {}
        self.stick = stick
        self._panel_count = min(count, _MOST_PANELS)
        self._kinks_inside = self._kinks(-math.inf, stick.log)
        self._kinks_outside = self._kinks(stick.log, 0.0)

    def _kinks(self, log_low: float, log_high: float) -> list[Radius]:
        """Return the radii between two, given by ``ln s``, at which fields are not smooth.

        The history is not smooth at the breaks of the profile and at the onset of slip. Fields are
        not smooth at these contact radii, nor at the stick radii that the contact had then.
        """
        a = self.radius
        onset = self.growth.onset
        radii = [*self.growth.breaks, *([onset] if onset else [])]
        events = [Radius(b / a, (a - b) / a) for b in radii if b < a]
        log_stick_radii = [
            event.log + log_stick
            for event in events
            for log_stick in self.history.growth.log_stick(event.log)
        ]
        candidates = events + [
            Radius(math.exp(log_s), -math.expm1(log_s)) for log_s in log_stick_radii
        ]
        kinks: list[Radius] = []
        for candidate in sorted(candidates, key=lambda radius: radius.log):
            if log_low + _KINK_SPACING < candidate.log < log_high - _KINK_SPACING:
                kinks.append(candidate)
                log_low = candidate.log
        return kinks

    def traction(self, friction: float, pressure: PressureField | ZonalField) -> GrownField:
        """Return the traction.

        Parameters
        ----------
        friction : float
            Infinite for full stick.
        pressure : PressureField or ZonalField
            Pressure today. In the slip zone of today the traction is friction times it.
        """

        def values(log_r: Array) -> Array:
            stuck, slipping = self._integrals_at(log_r)
            if self.stick.from_edge == 0.0:
                return stuck["traction"]
            return stuck["traction"] + friction * slipping["pressure"]

        stick_disk = self._sampled(values, [CENTRE, *self._kinks_inside, self.stick], power=1)
        if self.stick.from_edge == 0.0:
            return stick_disk
        pieces = (
            pressure.pieces if isinstance(pressure, ZonalField) else [ZonePiece(EDGE, pressure)]
        )
        slip_zone = [
            replace(piece, factor=friction)
            for piece in pieces
            if piece.outer.from_edge < self.stick.from_edge
        ]
        return replace(stick_disk, field=ZonalField((*stick_disk.field.pieces, *slip_zone)))

    def pressure(self) -> GrownField:
        """Return the pressure."""

        def values(log_r: Array) -> Array:
            stuck, slipping = self._integrals_at(log_r)
            return stuck["pressure"] + slipping["pressure"]

        return self._sampled(values, [CENTRE, *self._kinks_inside, *self._outer_ends()], power=0)

    def slip(self) -> GrownField:
        """Return the slip, the path of points since they came into contact."""

        def values(log_r: Array) -> Array:
            return self._integrals_at(log_r)[1]["slip"]

        return self._sampled(values, [CENTRE, *self._kinks_inside, *self._outer_ends()], power=1)

    def _integrals_at(self, log_r: Array) -> tuple[Fields, Fields]:
        """Return the growth of fields at points while they stuck, and that while they slipped.

        It is computed once for the same points, given by ``ln(r/a)``.
        """
        key = log_r.tobytes()
        if key not in self._integrals:
            u_stick = self.history.when_stuck(log_r)
            stuck = self.history.while_stuck(self._names_stuck, log_r, u_stick)
            slipping = self.history.while_slipping(self._names_slipping, log_r, u_stick)
            self._integrals[key] = (
                self._from_contact_radii(stuck),
                self._from_contact_radii(slipping),
            )
        return self._integrals[key]

    def _from_contact_radii(self, fields: Fields) -> Fields:
        """Convert fields from the unit of `history`, the contact radius, to that of `growth`."""
        return {
            name: values / self.radius ** _RADIUS_POWERS[name] for name, values in fields.items()
        }

    def _outer_ends(self) -> list[Radius]:
        """Return the ends of the annuli outside the stick disk; the edge alone if all sticks."""
        if self.stick.from_edge == 0.0:
            return [EDGE]
        return [self.stick, *self._kinks_outside, EDGE]

    def _sampled(
        self, values: Callable[[Array], Array], ends: list[Radius], *, power: int
    ) -> GrownField:
        """Return a field as two series on every annulus, one towards each of its ends.

        Parameters
        ----------
        values : callable
            The field at logarithms of radii.
        ends : list of Radius
            The ends of the annuli, from the centre on, in contact radii.
        power : int
            The series are of the field over ``s**power``: 1 for odd fields, 0 for even ones.
        """
        pieces = []
        error = 0.0
        largest = 0.0
        for low, high in pairwise(ends):
            halves = []
            for boundary, sign in ((low, 1), (high, -1)):
                reach = z_difference(low, high) / 2.0
                panels = self.history.panels(boundary, reach, self._panel_count)
                mesh = GradedMesh(boundary, sign, reach, panels)
                series = self._series(values, mesh, power)
                if boundary is CENTRE and power == 0 and self.history.growth.logarithm_at_centre:
                    series = _with_logarithm(series)
                halves.append(series)
                scale = _largest_radii(mesh) ** power
                errors = _SERIES_ERROR_FACTOR * np.abs(series.coefficients[:, -2:]).max(axis=1)
                error = max(error, float((scale * errors).max()))
                largest = max(largest, float((scale * np.abs(series.at_ends()[:-1])).max()))
            pieces.append(ZonePiece(high, AnnulusSeries(low, high, halves[0], halves[1], power)))
        error += self._quadrature_error * largest
        return GrownField(ZonalField(tuple(pieces)), error, largest)

    def _series(self, values: Callable[[Array], Array], mesh: GradedMesh, power: int) -> LogSeries:
        """Return the series of a field over ``s**power`` on one half of an annulus."""
        radii = mesh.points(mesh.panels.sampling_distances)
        # ln s from y = 1 - s**2 near the edge, and from z = s**2 elsewhere
        near_edge = radii.y < 0.5
        y_near_edge = np.where(near_edge, radii.y, 0.0)
        z_elsewhere = np.where(near_edge, 1.0, radii.z)
        log_s = (np.log1p(-y_near_edge) + np.log(z_elsewhere)) / 2.0
        samples = values(log_s) / np.exp(power * log_s)
        return sampled_series(mesh.panels, samples)


def opening(pressure: ZonalField) -> float | None:
    """Return the distance from the edge at which the pressure becomes negative, in contact radii.

    It is that of the first change of sign from the centre on. It is None if no sample is negative,
    or if the one next to the centre is: then there is no radius inside which the contact is closed.
    """

    def pressure_at(log_distance: float | Array) -> Array:
        from_edge = np.exp(-np.atleast_1d(log_distance))
        return pressure(1.0 - from_edge, from_edge)

    samples = np.linspace(_OPENING_RANGE[0], _OPENING_RANGE[1], _OPENING_SAMPLES)
    negative = np.flatnonzero(pressure_at(samples) < 0.0)
    if not len(negative) or negative[0] == 0:
        return None
    i = int(negative[0])
    root = brentq(lambda x: float(pressure_at(x)[0]), samples[i - 1], samples[i])
    return math.exp(-float(root))


def _with_logarithm(series: LogSeries) -> LogSeries:
    """Return a series that is continued beyond its panels, linearly in the logarithm of distance.

    Value and slope are those at the end of the last panel. There the derivative of the Legendre
    polynomial of degree n is ``n (n + 1)/2``.
    """
    last = series.coefficients[-1]
    n = np.arange(len(last))
    slope = float(last @ (n * (n + 1.0))) / series.width
    return replace(series, tail=np.array([last.sum()]), logarithm=slope)


def _largest_radii(mesh: GradedMesh) -> Array:
    """Return the largest ``s`` in every panel of a mesh, or a bound on it.

    Panels outside of their boundary (sign +1) have it at their far ends. Panels inside (sign -1)
    have the radius of the boundary as the bound.
    """
    # distances of the far ends of the panels from the boundary, over the extent of the mesh
    far_ends = np.exp(-_PANEL_WIDTH * np.arange(mesh.panels.count))
    largest_squares = mesh.boundary.square + mesh.extent * far_ends * (mesh.sign > 0)
    return np.asarray(np.sqrt(largest_squares))


class _History:
    """The history of a contact, and integrals over it.

    Parameters
    ----------
    growth : Growth
    rule : tuple of ndarray
        Nodes and weights on (0, 1) for a part of a panel at whose ends the integrand may be
        singular: the pressure of a flat punch is like an inverse square root at the edge and, with
        coupling, like a square root just outside the stick radius. Other parts have Gauss points,
        `smooth_rule`.
    degree : int
        Degree of the series of fields on each panel in ``s``.
    """

    def __init__(self, growth: Growth, rule: tuple[Array, Array], degree: int) -> None:
        self.growth = growth
        self.rule = rule
        self.smooth_rule = graded_rule(_SMOOTH_POINTS, 1, 0.0)
        self.degree = degree

    def panels(self, boundary: Radius, reach: float, count: int) -> LogPanels:
        """Return the panels in the logarithm of the distance from an end of an annulus.

        Towards the centre they go down to the radius at which the history begins. Towards any other
        end there are `count` of them.

        Parameters
        ----------
        boundary : Radius
            The end.
        reach : float
            Half the width of the annulus in ``s**2``, which the panels cover.
        count : int
        """
        depth = math.log(reach) - 2.0 * self.growth.all_panels[0].low
        # If there is a panel before the first one, the history is so long that the two innermost
        # panels are not needed.
        left_out = 0 if len(self.growth.all_panels) == len(self.growth.panels) else 2
        at_centre = max(math.ceil(depth / _PANEL_WIDTH) - left_out, _FEWEST_AT_CENTRE)
        panel_count = at_centre if boundary is CENTRE else count
        return LogPanels(panel_count, _PANEL_WIDTH, self.degree)

    def while_stuck(self, names: Sequence[str], log_r: Array, u_stick: Array) -> Fields:
        """Return the growth of fields at points since they began to stick, at `u_stick`."""
        total = np.zeros((len(names), len(log_r)))
        for panel in self.growth.all_panels:
            # the integrand is smooth for points that began to stick long before the panel
            near_singularity = (
                panel.stretch.distance_below(u_stick) < _NEAR_SINGULARITY * panel.stretch.extent
            )
            for selected, rule in (
                (near_singularity & (u_stick < panel.high), self.rule),
                (~near_singularity, self.smooth_rule),
            ):
                if names and selected.any():
                    total[:, selected] += _added_while_stuck(
                        names, panel, log_r[selected], u_stick[selected], rule
                    )
        return dict(zip(names, total, strict=True))

    def while_slipping(self, names: Sequence[str], log_r: Array, u_stick: Array) -> Fields:
        """Return the growth of fields at points before they began to stick, at `u_stick`."""
        total = np.zeros((len(names), len(log_r)))
        for panel in self.growth.all_panels:
            begin = np.maximum(log_r, panel.low)
            end = np.minimum(u_stick, panel.high)
            # The integrand is smooth far from where a point came into contact, by this distance in
            # v, and far from where it began to stick, by the length of the panel in u.
            near_distance = _NEAR_SINGULARITY * panel.stretch.extent
            near_singularity = (panel.stretch.distance_below(log_r) < near_distance) | (
                u_stick - end < panel.high - panel.low
            )
            slipped = (begin < end) & panel.slips
            for selected, rule in (
                (slipped & near_singularity, self.rule),
                (slipped & ~near_singularity, self.smooth_rule),
            ):
                if names and selected.any():
                    span = begin[selected], end[selected]
                    total[:, selected] += _added_while_slipping(
                        names, panel, log_r[selected], span, rule
                    )
        return dict(zip(names, total, strict=True))

    def when_stuck(self, log_r: Array) -> Array:
        """Return ``ln b_r`` of points: the contact radius at which they began to stick (G.3).

        For a point that slips today that is today's contact radius.
        """
        u_stick = np.array(log_r)
        last_radius_stuck = math.inf
        for panel in self.growth.all_panels:
            if panel.slips:
                ends = panel.log_stick(np.array([-1.0, 1.0]))
                begin = panel.low + ends[0]
                end = panel.high + ends[1]
                # the stick radii of two panels may differ by their errors where the panels meet
                u_stick[(log_r > last_radius_stuck) & (log_r <= begin)] = panel.low
                on_panel = (log_r > begin) & (log_r <= end)
                u_stick[on_panel] = _radii_of_sticking(panel, log_r[on_panel])
                last_radius_stuck = end
        last = self.growth.panels[-1]
        if last.slips:
            still_slipping = log_r > last.high + last.log_stick(np.ones(1))[0]
            u_stick[still_slipping] = last.high
        return u_stick


def _added_while_stuck(
    names: Sequence[str], panel: Panel, log_r: Array, u_stick: Array, rule: tuple[Array, Array]
) -> Array:
    """Return what one panel adds to fields at points while they stick, (names, points)."""
    stretch = panel.stretch
    begin = np.maximum(u_stick, panel.low)
    points, weights = rule
    depth = stretch.depth_of(begin)[:, None]
    extent = stretch.v_increment(depth, (panel.high - begin)[:, None])
    t = stretch.place(depth + extent * points)
    u_since_begin = stretch.u_increment(depth, extent * points)
    # ln(c(b)/r). Where a point begins to stick on this panel it is exactly 0, and grows from there.
    # For points that stuck before, its value at the lower end of the panel is added.
    if panel.slips:
        first_stick = panel.log_stick(stretch.place(depth))
        log_ratio = u_since_begin + panel.log_stick(t) - first_stick
        log_ratio += np.where(u_stick < panel.low, begin - log_r, 0.0)[:, None]
        log_ratio += np.where(u_stick[:, None] < panel.low, first_stick, 0.0)
        log_ratio = np.maximum(log_ratio, 0.0)
    else:
        log_ratio = u_since_begin + (begin - log_r)[:, None]
    places = t.ravel()
    values = panel.fields_in_stick(names, places, log_ratio.ravel()) * panel.dload_dv(places)
    values = values.reshape(-1, *u_since_begin.shape) * np.exp(
        -2.0 * (begin[:, None] + u_since_begin)
    )
    return np.asarray(extent[:, 0] * (values @ weights))


def _added_while_slipping(
    names: Sequence[str],
    panel: Panel,
    log_r: Array,
    span: tuple[Array, Array],
    rule: tuple[Array, Array],
) -> Array:
    """Return what one panel adds to fields at points while they slip, (names, points).

    `span` is the part of the panel, in ``u``, on which each point slips.
    """
    stretch = panel.stretch
    begin, end = span
    points, weights = rule
    depth = stretch.depth_of(begin)[:, None]
    extent = stretch.v_increment(depth, (end - begin)[:, None])
    t = stretch.place(depth + extent * points).ravel()
    u_since_begin = stretch.u_increment(depth, extent * points)
    log_ratio = (begin - log_r)[:, None] + u_since_begin  # ln(b/r)
    values = panel.fields_in_slip(names, t, log_ratio.ravel())
    values = (values * panel.dload_dv(t)).reshape(-1, *u_since_begin.shape)
    for name, field_values in zip(names, values, strict=True):
        field_values *= np.exp(-_RADIUS_POWERS[name] * (begin[:, None] + u_since_begin))
    return np.asarray(extent[:, 0] * (values @ weights))


def tanh_rule(digits: float, depth: float) -> tuple[Array, Array]:
    """Return nodes and weights on (0, 1) for integrands that are singular at one end or both.

    It is the trapezoidal rule in ``y``, where ``z = 1/(1 + exp(-y))`` is the variable on (0, 1)
    (Trefethen and Weideman 2014, section 14). Its error is ``exp(-pi**2/step)`` for an integrand
    that is analytic in the strip ``|Im y| < pi/2``: in ``z`` the disk that has (0, 1) as diameter.

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


def _radii_of_sticking(panel: Panel, log_r: Array) -> Array:
    """Return ``ln b_r`` of points that begin to stick on a panel, by bisection for ``c(b) = r``."""
    if panel.punches_alike:
        return np.asarray(log_r - panel.stick[0])
    low = -np.ones(len(log_r))
    high = np.ones(len(log_r))
    for _ in range(_BISECTIONS):
        middle = (low + high) / 2.0
        below = panel.stretch.u_at(middle) < log_r - panel.log_stick(middle)
        low = np.where(below, middle, low)
        high = np.where(below, high, middle)
    return panel.stretch.u_at((low + high) / 2.0)
