"""A panel of the history of a growing contact: flat punches, interpolated over their radius.

Pressure and traction of a growing contact are sums of those of flat punches of all radii ``b`` up
to the contact radius (docs/theory, G.4). A panel is an interval of ``b``, its `RadiusStretch`. Flat
punches are solved at the nodes, which are its Chebyshev points, and interpolated between them.

Radii are given by ``u = ln b``, by the coordinate ``v = ln(b - b_0)`` of the interpolation (G.10),
or by the place ``t``, a linear function of ``v``, from -1 to 1 on the panel. The solution of a flat
punch is for unit load and in units of its radius: ``s`` is the distance from the centre, ``c*`` the
stick radius, ``Q*`` the total shear. ``x`` is the logarithm of a distance from the stick radius or
from the edge (G.12).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from spectral_contact.fields import Array
from spectral_contact.fields.series import (
    AnnulusSeries,
    DiskSeries,
    Radius,
    ZonalField,
    ZonePiece,
)
from spectral_contact.solving.stretch import (
    FieldTable,
    RadiusStretch,
    chebyshev_nodes,
    chebyshev_value,
    interpolation_error,
    slope,
)
from spectral_contact.spectral.jacobi import gauss_rule
from spectral_contact.threads import cached_property

if TYPE_CHECKING:
    from spectral_contact.solution import Solution
    from spectral_contact.solving.weights import PanelLoads

#: Radii ``s/c*`` in the stick disk at which the error of the interpolation over ``b`` is estimated.
_STICK_SAMPLES: Array = np.array([0.1, 0.5, 0.8, 0.95, 0.999])
#: The same in the slip zone: distances from the edge in ``s**2``, as fractions of its width.
_SLIP_SAMPLES: Array = np.array([0.01, 0.2, 0.5, 0.8])
#: Number of panels of a `FieldTable` in ``x``, towards the edge or the stick radius. Each is 2
#: long, so that the last one ends at the distance ``exp(-60)``. If an inverse square root is
#: replaced by a constant at smaller distances, its integral is right to 1e-13. In the slip zone
#: half as many are enough towards the stick radius, where fields are bounded.
_TABLE_PANELS = 30
#: Least divisor, in place of 0.
TINY = 1e-300
#: Error of ``dP/dv``, to which the fields are proportional, over that of ``ln P``. It was 2.4 or
#: less in 50 random scenes.
_RATE_FACTOR = 4.0


@dataclass(frozen=True)
class PowerCurve:
    """A positive function of the contact radius, such as the load, interpolated on a stretch.

    What is interpolated is ``ln(values/b**power)``, because next to the first touch load and
    approach are powers of the radius (docs/theory, G.8 and G.9). Values and radii are taken over
    those at the last node and at the upper end, so that powers do not overflow, and logarithms of
    large numbers lose no digits.

    Attributes
    ----------
    stretch : RadiusStretch
    values : ndarray
        Values at the nodes.
    power : float
        The exponent next to the first touch. It does not change the function beyond the error of
        interpolation; with another exponent more nodes are needed.
    """

    stretch: RadiusStretch
    values: Array
    power: float

    @cached_property
    def _reduced_log(self) -> Array:
        """``ln(values/b**power)`` at the nodes, scaled as in the docstring of the class."""
        power_part = self.power * (self.stretch.u_nodes - self.stretch.high)
        return np.asarray(np.log(self.values / self.values[-1]) - power_part)

    @property
    def interpolation_error(self) -> float:
        """Estimate of the relative error of the interpolant."""
        return interpolation_error(self._reduced_log)

    def at(self, t: Array) -> Array:
        """Return the logarithm of the function at places."""
        power_part = self.power * (self.stretch.u_at(t) - self.stretch.high)
        return chebyshev_value(self._reduced_log, t) + power_part + math.log(self.values[-1])

    def rate(self, t: Array) -> Array:
        """Return the derivative of that logarithm by ``v``, at places."""
        reduced_rate = slope(self._reduced_log, t) * 2.0 / self.stretch.extent
        return reduced_rate + self.power / self.stretch.dv_du_at(t)


@dataclass(frozen=True)
class Panel:
    """Flat punches at the nodes of a stretch, and the interpolants through them.

    Attributes
    ----------
    stretch : RadiusStretch
        The interval of radii.
    node_loads : PanelLoads
        Load and approach of the growing contact when its radius was that of each node.
    flats : tuple of Solution
        The flat punches at the nodes, in ascending order of their radii.
    fields : tuple of str
        Names of the fields whose interpolation counts in `error`.
    powers : tuple of float
        The exponents of load and approach next to the first touch, as of `PowerCurve`.
    tables : dict
        The tables of fields made so far, by the name of the field and by the first ``x`` of the
        table. They depend on places alone, so that the same panel in another unit of length shares
        them.
    """

    stretch: RadiusStretch
    node_loads: PanelLoads
    flats: tuple[Solution, ...]
    fields: tuple[str, ...]
    powers: tuple[float, float]
    tables: dict[tuple[str, float], FieldTable] = field(default_factory=dict)

    @property
    def low(self) -> float:
        """``u`` at the lower end of the panel."""
        return self.stretch.low

    @property
    def high(self) -> float:
        """``u`` at the upper end of the panel."""
        return self.stretch.high

    @cached_property
    def loads(self) -> PowerCurve:
        """The load ``P`` of the growing contact over the panel."""
        return PowerCurve(self.stretch, self.node_loads.loads, self.powers[0])

    @cached_property
    def approaches(self) -> PowerCurve:
        """The approach ``delta`` of the growing contact over the panel."""
        return PowerCurve(self.stretch, self.node_loads.approaches, self.powers[1])

    @cached_property
    def slips(self) -> bool:
        """Whether a flat punch of the panel has a slip zone.

        Just past the onset of slip the zone may be too narrow for the solver to find, so that some
        punches of the panel have none.
        """
        return any(len(flat.zones) > 1 for flat in self.flats)

    @cached_property
    def punches_alike(self) -> bool:
        """Whether all flat punches are the same, as on a smooth surface."""
        return all(flat is self.flats[0] for flat in self.flats)

    @cached_property
    def stick(self) -> Array:
        """``ln c*`` of the flat punches."""
        return np.array([stick_radius(flat).log for flat in self.flats])

    @cached_property
    def shears(self) -> Array:
        """``Q*`` of the flat punches."""
        return np.array([flat.total_shear for flat in self.flats])

    def load(self, t: Array) -> Array:
        """Return the load ``P`` at places."""
        return np.asarray(np.exp(self.loads.at(t)))

    def dload_dv(self, t: Array) -> Array:
        """Return the derivative ``dP/dv`` at places."""
        return self.load(t) * self.loads.rate(t)

    def rate_today(self, curve: PowerCurve) -> float:
        """Return the derivative of the logarithm of a curve by ``u`` at the upper end."""
        end = np.ones(1)
        return float((curve.rate(end) * self.stretch.dv_du_at(end))[0])

    def log_stick(self, t: Array) -> Array:
        """Return ``ln c*`` at places."""
        if self.punches_alike:
            return np.full_like(t, self.stick[0])
        return chebyshev_value(self.stick, t)

    def integral(self, integrand: Callable[[Array], Array]) -> float:
        """Return the integral over ``v``, along the panel, of a function of the place."""
        nodes, weights = gauss_rule(2 * self.stretch.count)
        return self.stretch.extent / 2.0 * float(weights @ integrand(nodes))

    def fields_in_stick(self, names: Sequence[str], t: Array, log_ratio: Array) -> Array:
        """Return fields of flat punches in their stick disks.

        Parameters
        ----------
        names : sequence of str
            Of "pressure" and "traction".
        t : ndarray, shape (n,)
            Places of the punches on the panel.
        log_ratio : ndarray, shape (n,)
            ``ln(c*/s)``.

        Returns
        -------
        ndarray, shape (names, n)
        """
        with np.errstate(divide="ignore"):
            x = -np.log(-np.expm1(-2.0 * log_ratio))
        fields = FieldTable.evaluate([self._stick_table(name) for name in names], t, x)
        for name, values in zip(names, fields, strict=True):
            if name == "traction":
                values *= np.exp(-log_ratio)  # the table is of the traction over s/c*
        return fields

    def fields_in_slip(self, names: Sequence[str], t: Array, log_ratio: Array) -> Array:
        """Return fields of flat punches in their slip zones.

        The parameters are those of `fields_in_stick`, except that `log_ratio` is ``ln(1/s)``, and
        that `names` are of "pressure" and "slip".
        """
        y = -np.expm1(-2.0 * log_ratio)  # 1 - s**2
        width = -np.expm1(2.0 * self.log_stick(t))
        # rounding may put a point inside the stick radius: then the fraction is 1
        fraction = y / np.maximum(width, np.maximum(y, TINY))
        return self._in_slip_zones(names, t, fraction)

    def _stick_table(self, name: str) -> FieldTable:
        """Return the table of a field in the stick disk; ``x`` is ``-ln(1 - (s/c*)**2)``.

        For the traction, which is odd in ``s``, the table is of the traction over ``s/c*``.
        """

        def values(flat: Solution, x: Array) -> Array:
            return _in_stick_disk(flat, name, np.exp(-x))

        return self._table(name, values, 0.0, _TABLE_PANELS)

    def _in_slip_zones(self, names: Sequence[str], t: Array, fraction: Array) -> Array:
        """Return fields in slip zones, at distances from the edge as fractions of their widths.

        Distances and widths are in ``s**2``, so that the fraction is ``(1 - s**2)/(1 - (c*)**2)``:
        0 at the edge and 1 at the stick radius of every flat punch.
        """
        with np.errstate(divide="ignore"):
            x = np.log1p(-fraction) - np.log(fraction)
        return FieldTable.evaluate([self._slip_table(name) for name in names], t, x)

    def _slip_table(self, name: str) -> FieldTable:
        """Return the table of a field in the slip zone; ``x = ln(ratio)`` of `_in_slip_zone`."""

        def values(flat: Solution, x: Array) -> Array:
            return _in_slip_zone(flat, name, np.exp(x))

        # Panels have the length 2 in x. Below x = 0, towards the stick radius, are half of
        # _TABLE_PANELS, so that they begin at minus this number; above, towards the edge, are all.
        return self._table(name, values, -_TABLE_PANELS, _TABLE_PANELS + _TABLE_PANELS // 2)

    def _table(
        self, name: str, values: Callable[[Solution, Array], Array], low: float, panels: int
    ) -> FieldTable:
        """Return the table of a field, with panels from ``x = low`` on; it is made once."""
        key = name, low
        if key not in self.tables:
            flats = self.flats[:1] if self.punches_alike else self.flats
            self.tables[key] = FieldTable(
                lambda x: np.array([values(flat, x) for flat in flats]), low, panels
            )
        return self.tables[key]

    @cached_property
    def shear_error(self) -> float:
        """Estimate of the error of the interpolants of load and ``Q*``, relative to the largest."""
        largest = max(float(np.abs(self.shears).max()), TINY)
        load_error = max(self.node_loads.error, self.loads.interpolation_error)
        return float(max(load_error, interpolation_error(self.shears) / largest))

    @cached_property
    def error(self) -> float:
        """Estimate of the largest error of the interpolants over ``b``.

        These are those of ``dP/dv``, ``Q*``, ``c*`` and the fields, each relative to its largest
        value. The error of the series in ``x``, `series_error`, is not in it.
        """
        stick_error = interpolation_error(self.stick) if self.slips else 0.0
        rate_error = _RATE_FACTOR * max(self.loads.interpolation_error, self.node_loads.error)
        field_errors = map(self._field_error, self.fields)
        return max(rate_error, self.shear_error, stick_error, *field_errors)

    @property
    def series_error(self) -> float:
        """Largest relative error of the series in ``x``, of all tables made so far but the slip's.

        Shorter panels do not reduce it, as each flat punch has this error.
        """
        tables = [table for (name, _), table in self.tables.items() if name != "slip"]
        return max((table.series_error for table in tables), default=0.0)

    @cached_property
    def slip_samples(self) -> Array:
        """The slip of the flat punches at `_SLIP_SAMPLES`, (punches, samples)."""
        return self._at_nodes(
            lambda t, fraction: self._in_slip_zones(["slip"], t, fraction)[0], _SLIP_SAMPLES
        )

    @cached_property
    def slip_error(self) -> float:
        """Estimate of the error of what the panel adds to the slip, as a length."""
        if not self.slips:
            return 0.0
        largest = np.abs(self.slip_samples).max(axis=1)
        relative = np.array([flat.error.slip or 0.0 for flat in self.flats])
        # Just past the onset the slip of a flat punch may have no correct digit. It is small, so
        # that the largest slip of the panel bounds its error.
        flat_errors = np.where(relative <= 1.0, largest * relative, largest.max())
        # an error of c* moves points in the slip zone, by this fraction of its width
        shift = (
            interpolation_error(self.stick) * 2.0 / np.maximum(np.expm1(-2.0 * self.stick), TINY)
        )
        slip_interpolation_error = max(
            interpolation_error(values) for values in self.slip_samples.T
        )
        # the slip by (docs/theory, G.4) if that of all flat punches were 1, times b at the lower
        # end of the panel
        weight = self.integral(lambda t: self.dload_dv(t) * np.exp(self.low - self.stretch.u_at(t)))
        # The error of dP is integrated by parts: it gives the error of P at the two ends, and that
        # of P times the changes of the slip between, which count as one end.
        load_error = 2.0 * self.loads.interpolation_error * float(self.load(np.ones(1))[0])
        field_error = weight * (slip_interpolation_error + (flat_errors + largest * shift).max())
        return float(field_error + load_error * largest.max()) * math.exp(-self.low)

    def _field_error(self, name: str) -> float:
        """Return the error of a field in the stick disk by the interpolation over ``b``.

        It is the largest one at `_STICK_SAMPLES`, relative to the largest value there.
        """
        table = self._stick_table(name)
        samples = self._at_nodes(table, -np.log1p(-(_STICK_SAMPLES**2)))
        largest = max(float(np.abs(samples).max()), TINY)
        return max(interpolation_error(values) / largest for values in samples.T)

    def _at_nodes(self, field: Callable[[Array, Array], Array], positions: Array) -> Array:
        """Return a field of ``t`` and a position at all nodes and positions, (nodes, positions)."""
        nodes = chebyshev_nodes(self.stretch.count)
        t = np.repeat(nodes, len(positions))
        return field(t, np.tile(positions, len(nodes))).reshape(-1, len(positions))


def stick_radius(flat: Solution) -> Radius:
    """Return the outer radius of the central zone of a flat punch, which is its stick disk."""
    zone = flat.zones[0]
    return Radius(zone.outer, zone.outer_from_edge)


def _in_stick_disk(flat: Solution, name: str, d: Array) -> Array:
    """Return a field of a flat punch at ``d = 1 - (s/c*)**2``; of the traction, that over ``s/c*``.

    If the field has a series in `d`, the series is evaluated at this number. If `d` were computed
    from ``s`` and ``c*``, square roots of it would lose half of their digits.
    """
    piece = _zone_piece(flat, name, 0)
    if piece is not None and isinstance(piece.field, DiskSeries):
        return piece.factor * piece.field.over_power(d)
    stick = stick_radius(flat)
    scaled = np.sqrt(1.0 - d)  # s/c*
    from_edge = stick.from_edge + stick.value * d / (1.0 + scaled)
    values = _field(flat, name, stick.value * scaled, from_edge)
    return values / scaled if name == "traction" else values


def _in_slip_zone(flat: Solution, name: str, ratio: Array) -> Array:
    """Return a field of a flat punch between the stick radius and the edge.

    `ratio` is the distance in ``s**2`` from the stick radius over the distance from the edge.
    """
    # Series take the distances from both ends in units of half the width of the zone, so that they
    # add up to 2. The distance from the stick radius is `ratio * edge_distance`.
    edge_distance = 2.0 / (1.0 + ratio)
    y = stick_radius(flat).rest * edge_distance / 2.0  # 1 - s**2
    s = np.sqrt(1.0 - y)
    piece = _zone_piece(flat, name, 1)
    if piece is not None and isinstance(piece.field, AnnulusSeries):
        return np.asarray(
            piece.factor
            * s**piece.field.power
            * piece.field.over_power(ratio * edge_distance, edge_distance)
        )
    return _field(flat, name, s, y / (1.0 + s))


def _zone_piece(flat: Solution, name: str, zone: int) -> ZonePiece | None:
    """Return the series of a field in one zone; None unless the field has one for each zone."""
    field = getattr(flat, f"{name}_field")
    if not isinstance(field, ZonalField) or not zone < len(field.pieces) == len(flat.zones):
        return None
    return field.pieces[zone]


def _field(flat: Solution, name: str, s: Array, from_edge: Array) -> Array:
    """Return a field of a flat punch at radii; zero if the solution has no such field."""
    field = getattr(flat, f"{name}_field")
    return np.zeros(len(s)) if field is None else np.asarray(field(s, from_edge))
