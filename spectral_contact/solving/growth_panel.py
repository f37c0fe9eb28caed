"""A panel of the history of a growing contact: flat punches, interpolated over their radius.

A panel covers an interval of the contact radius ``b``, its `RadiusStretch`: ``u = ln b``, ``x`` is
the coordinate in which the panel interpolates, and ``t`` in [-1, 1] is the place in the panel. A
stage is the solution for the flat punch at a node of the panel, for unit load and in units of its
radius. ``s`` is the distance from the centre in these units; ``c*`` and ``Q*`` are the stick radius
and the total shear of a stage.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
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
    left_out,
    slope,
)
from spectral_contact.spectral.jacobi import gauss_rule
from spectral_contact.threads import cached_property

if TYPE_CHECKING:
    from spectral_contact.solution import Solution
    from spectral_contact.solving.weights import Weights

#: Places ``s/c*`` in the stick disk at which the error of interpolation over ``b`` is estimated.
_STICK_SAMPLES: Array = np.array([0.1, 0.5, 0.8, 0.95, 0.999])
#: The same in the slip zone: places as fractions of its width in ``s**2``, from the edge.
_SLIP_SAMPLES: Array = np.array([0.01, 0.2, 0.5, 0.8])
#: Number of panels of a `FieldTable` towards the edge or the stick radius. Each is 2 wide in the
#: logarithm of the distance, so that they end at the distance ``exp(-60)``. An inverse square root
#: that is constant from there on has an integral that is right to 1e-13. In the slip zone half as
#: many are enough towards the stick radius, where fields are bounded.
_TABLE_PANELS = 30
#: Least divisor, in place of 0.
TINY = 1e-300
#: Factor from the error of ``ln P`` to that of ``dP/dx``, to which fields are proportional. It was
#: 2.4 or less in 50 random scenes.
_RATE_FACTOR = 4.0


@dataclass(frozen=True)
class PowerCurve:
    """The load or the approach as a function of the radius, interpolated between the stages.

    Next to the first touch it is a power of the radius. What is interpolated is its logarithm less
    that of the power.

    Attributes
    ----------
    stretch : RadiusStretch
    values : ndarray
        Values at the points of the stretch.
    power : float
        The exponent at the tip of the profile. Any other exponent gives the same function; it only
        takes more points.
    """

    stretch: RadiusStretch
    values: Array
    power: float

    @cached_property
    def _reduced_log(self) -> Array:
        """Return the logarithm of the values over the power, at the points."""
        return np.log(self.values / np.exp(self.stretch.logs) ** self.power)

    @property
    def left_out(self) -> float:
        """Relative error of the interpolant."""
        return left_out(self._reduced_log)

    def at(self, t: Array) -> Array:
        """Return the logarithm of the load or approach, at places in [-1, 1]."""
        u = self.stretch.log_radius_at(t)
        return chebyshev_value(self._reduced_log, t) + self.power * u

    def rate(self, t: Array) -> Array:
        """Return the derivative of that logarithm in ``x``, at places in [-1, 1]."""
        bends = self.stretch.bends_at(t)
        return slope(self._reduced_log, t) * 2.0 / self.stretch.extent + self.power / bends


@dataclass(frozen=True)
class Panel:
    """Stages at the Chebyshev points of an interval of radii, and the interpolants through them.

    Attributes
    ----------
    stretch : RadiusStretch
        The interval of radii.
    weights : Weights
        Loads and approaches at the nodes. Increments of the load weigh the stages.
    flats : tuple of Solution
        The stages, in ascending order of their radii.
    fields : tuple of str
        Names of the fields whose interpolation counts in `error`.
    powers : tuple of float
        Powers of the radius to which load and approach are proportional at the tip of the profile.
    """

    stretch: RadiusStretch
    weights: Weights
    flats: tuple[Solution, ...]
    fields: tuple[str, ...]
    powers: tuple[float, float]

    @property
    def low(self) -> float:
        """Logarithm of the radius at which the panel begins."""
        return self.stretch.low

    @property
    def high(self) -> float:
        """Logarithm of the radius at which the panel ends."""
        return self.stretch.high

    @cached_property
    def loads(self) -> PowerCurve:
        """The load ``P`` over the panel."""
        return PowerCurve(self.stretch, self.weights.loads, self.powers[0])

    @cached_property
    def approaches(self) -> PowerCurve:
        """The approach ``delta`` over the panel."""
        return PowerCurve(self.stretch, self.weights.approaches, self.powers[1])

    @cached_property
    def slips(self) -> bool:
        """Whether a stage has a slip zone.

        Next to the onset of slip the zone may be too narrow for the solver to find.
        """
        return any(len(flat.zones) > 1 for flat in self.flats)

    @cached_property
    def alike(self) -> bool:
        """Whether all stages are the same, as on a smooth surface."""
        return all(flat is self.flats[0] for flat in self.flats)

    @cached_property
    def stick(self) -> Array:
        """``ln c*`` of the stages."""
        return np.array([stick_radius(flat).log for flat in self.flats])

    @cached_property
    def shears(self) -> Array:
        """``Q*`` of the stages."""
        return np.array([flat.total_shear for flat in self.flats])

    def load(self, t: Array) -> Array:
        """Return the load ``P`` at places in [-1, 1]."""
        return np.asarray(np.exp(self.loads.at(t)))

    def increment(self, t: Array) -> Array:
        """Return the derivative ``dP/dx`` at places in [-1, 1]."""
        return self.load(t) * self.loads.rate(t)

    def rate_today(self, curve: PowerCurve) -> float:
        """Return the derivative in ``u`` of the logarithm of a curve at the end of the panel."""
        end = np.ones(1)
        return float((curve.rate(end) * self.stretch.bends_at(end))[0])

    def log_stick(self, t: Array) -> Array:
        """Return ``ln c*`` at places in [-1, 1]."""
        if self.alike:
            return np.full_like(t, self.stick[0])
        return chebyshev_value(self.stick, t)

    def integral(self, integrand: Callable[[Array], Array]) -> float:
        """Return the integral over ``x`` of a function that takes places in [-1, 1]."""
        nodes, weights = gauss_rule(2 * self.stretch.count)
        return self.stretch.extent / 2.0 * float(weights @ integrand(nodes))

    def where_stuck(self, names: Sequence[str], t: Array, log_ratio: Array) -> Array:
        """Return fields of flat punches in their stick disks.

        Parameters
        ----------
        names : sequence of str
            Of "pressure" and "traction".
        t : ndarray, shape (n,)
            Places of the punches on the panel, in [-1, 1].
        log_ratio : ndarray, shape (n,)
            ``ln(c*/s)``.

        Returns
        -------
        ndarray, shape (names, n)
        """
        with np.errstate(divide="ignore"):
            x = -np.log(-np.expm1(-2.0 * log_ratio))
        fields = FieldTable.several([self._stick_table(name) for name in names], t, x)
        for name, values in zip(names, fields, strict=True):
            if name == "traction":
                values *= np.exp(-log_ratio)  # the table has the traction over s/c*
        return fields

    def where_slipping(self, names: Sequence[str], t: Array, log_ratio: Array) -> Array:
        """Return fields of flat punches in their slip zones.

        It takes what `where_stuck` does, but the ratio is ``ln(1/s)``, and the names are of
        "pressure" and "slip".
        """
        rest = -np.expm1(-2.0 * log_ratio)  # 1 - s**2
        width = -np.expm1(2.0 * self.log_stick(t))
        # rounding may put a point inside the stick radius: then the fraction is 1
        fraction = rest / np.maximum(width, np.maximum(rest, TINY))
        return self._in_slip_zones(names, t, fraction)

    def _stick_table(self, name: str) -> FieldTable:
        """Return the table of a field in the stick disk, over ``-ln d``, ``d = 1 - (s/c*)**2``.

        That of the traction is over ``s/c*``, since the traction is odd in ``s``.
        """

        def values(flat: Solution, x: Array) -> Array:
            return _in_stick_disk(flat, name, np.exp(-x))

        return self._table(name, values, 0.0, _TABLE_PANELS)

    def _in_slip_zones(self, names: Sequence[str], t: Array, fraction: Array) -> Array:
        """Return fields in slip zones, at fractions of their widths in ``s**2``.

        The fraction, of ``1 - s**2`` over what that is at the stick radius, is 0 at the edge and 1
        at the stick radius. So the same fraction is in the slip zone of every stage, and fields are
        smooth in it but at its ends.
        """
        with np.errstate(divide="ignore"):
            x = np.log1p(-fraction) - np.log(fraction)
        return FieldTable.several([self._slip_table(name) for name in names], t, x)

    def _slip_table(self, name: str) -> FieldTable:
        """Return the table of a field in the slip zone, over ``ln(ratio)`` of `_in_slip_zone`."""

        def values(flat: Solution, x: Array) -> Array:
            return _in_slip_zone(flat, name, np.exp(x))

        return self._table(name, values, -_TABLE_PANELS, _TABLE_PANELS + _TABLE_PANELS // 2)

    def _table(
        self, name: str, values: Callable[[Solution, Array], Array], low: float, panels: int
    ) -> FieldTable:
        """Return the table of a field, with panels from the logarithm `low` on; it is made once."""
        key = name, low
        if key not in self._tables:
            flats = self.flats[:1] if self.alike else self.flats
            self._tables[key] = FieldTable(
                lambda x: np.array([values(flat, x) for flat in flats]), low, panels
            )
        return self._tables[key]

    @cached_property
    def _tables(self) -> dict[tuple[str, float], FieldTable]:
        """The tables made so far, by the name of the field and the `low` of `_table`."""
        return {}

    @cached_property
    def shear_error(self) -> float:
        """Error of the interpolants of load and shear, each relative to its largest value."""
        largest = max(float(np.abs(self.shears).max()), TINY)
        load_error = max(self.weights.error, self.loads.left_out)
        return float(max(load_error, left_out(self.shears) / largest))

    @cached_property
    def error(self) -> float:
        """Largest error of the interpolants over the radius.

        They are those of load, shear, stick radius and fields; each error is relative to the
        largest value of what is interpolated. `lost` is not in it.
        """
        stick_error = left_out(self.stick) if self.slips else 0.0
        rate_error = _RATE_FACTOR * max(self.loads.left_out, self.weights.error)
        field_errors = map(self._field_error, self.fields)
        return max(rate_error, self.shear_error, stick_error, *field_errors)

    @property
    def lost(self) -> float:
        """Largest relative error of the series in the distance, over the tables made so far.

        Tables of the slip are not counted. Shorter panels do not reduce this error, as it is of the
        fields of the single flat punches.
        """
        tables = [table for (name, _), table in self._tables.items() if name != "slip"]
        return max((table.lost for table in tables), default=0.0)

    @cached_property
    def slips_by(self) -> Array:
        """The slip of the stages at `_SLIP_SAMPLES`, (stages, places)."""
        return self._at_nodes(
            lambda t, fraction: self._in_slip_zones(["slip"], t, fraction)[0], _SLIP_SAMPLES
        )

    @cached_property
    def slip_error(self) -> float:
        """Estimate of the error of what the panel adds to the slip, in its own unit."""
        if not self.slips:
            return 0.0
        largest = np.abs(self.slips_by).max(axis=1)
        relative = np.array([flat.error.slip or 0.0 for flat in self.flats])
        # Just past the onset the slip of a stage may have no correct digit. It is small, so that
        # the largest slip of the panel bounds its error.
        flat_errors = np.where(relative <= 1.0, largest * relative, largest.max())
        # an error of the stick radius moves the places in the slip zone, by this fraction of it
        shift = left_out(self.stick) * 2.0 / np.maximum(np.expm1(-2.0 * self.stick), TINY)
        interpolation_error = max(left_out(values) for values in self.slips_by.T)
        # the integral of dP/b, times b at the lower end
        weight = self.integral(
            lambda t: self.increment(t) * np.exp(self.low - self.stretch.log_radius_at(t))
        )
        # by parts: an error of dP counts as that of the load itself, against the largest slip
        load_error = 2.0 * self.loads.left_out * float(self.load(np.ones(1))[0])
        field_error = weight * (interpolation_error + (flat_errors + largest * shift).max())
        return float(field_error + load_error * largest.max()) * math.exp(-self.low)

    def _field_error(self, name: str) -> float:
        """Return the error of a field in the stick disk that interpolation over ``b`` makes.

        It is relative to the largest value at `_STICK_SAMPLES`.
        """
        table = self._stick_table(name)
        samples = self._at_nodes(table, -np.log1p(-(_STICK_SAMPLES**2)))
        largest = max(float(np.abs(samples).max()), TINY)
        return max(left_out(values) / largest for values in samples.T)

    def _at_nodes(self, field: Callable[[Array, Array], Array], places: Array) -> Array:
        """Return a field, a function of ``t`` and of places, at the nodes, (stages, places)."""
        nodes = chebyshev_nodes(self.stretch.count)
        t = np.repeat(nodes, len(places))
        return field(t, np.tile(places, len(nodes))).reshape(-1, len(places))


def stick_radius(flat: Solution) -> Radius:
    """Return the outer radius of the central zone of a flat punch, which is its stick disk."""
    zone = flat.zones[0]
    return Radius(zone.outer, zone.outer_from_edge)


def _in_stick_disk(flat: Solution, name: str, d: Array) -> Array:
    """Return a field of a flat punch at ``d = 1 - (s/c*)**2``; the traction over ``s/c*``.

    If the field has a series in d, the series is evaluated at d itself. With d from the difference
    of ``s`` and ``c*``, square roots of d would lose half of their digits.
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
    # The distances in units of half the width of the zone, as the series take them: they add up to
    # 2. The one from the stick radius is `ratio * edge_distance`.
    edge_distance = 2.0 / (1.0 + ratio)
    y = stick_radius(flat).rest * edge_distance / 2.0
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
    """Return a field of a flat punch in one of its zones; None if it has not one series a zone."""
    field = getattr(flat, f"{name}_field")
    if not isinstance(field, ZonalField) or not zone < len(field.pieces) == len(flat.zones):
        return None
    return field.pieces[zone]


def _field(flat: Solution, name: str, s: Array, from_edge: Array) -> Array:
    """Return a field of a flat punch at radii; zero if the solution does not have it."""
    field = getattr(flat, f"{name}_field")
    return np.zeros(len(s)) if field is None else np.asarray(field(s, from_edge))
