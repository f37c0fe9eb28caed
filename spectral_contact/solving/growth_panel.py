"""A stretch of the history of a growing contact: flat punches, and what is between them.

A panel interpolates over the radius ``b`` of the contact: ``u = ln b``, ``x`` is the coordinate of
its `RadiusStretch`, and t in [-1, 1] is the place in it. A stage is the flat punch at a node of the
panel, in units of its radius; ``c*`` and ``Q*`` are its stick radius and its shear, for unit load.
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
_LOOKS: Array = np.array([0.1, 0.5, 0.8, 0.95, 0.999])
#: The same where it slips, over ``1 - s**2`` from the edge to the stick radius.
_SLIPPING_LOOKS: Array = np.array([0.01, 0.2, 0.5, 0.8])
#: Panels of a `FieldTable`, each 2 wide in a logarithm of the distance from the edge or from the
#: stick radius: at their end, ``exp(-60)``, an inverse root has 13 digits. At the stick radius the
#: fields of slip are bounded, and half as many panels are enough.
_DEEP = 30
#: In place of a divisor of 0.
TINY = 1e-300
#: The error of ``dP/dx``, to which fields are proportional, over that of ``ln P``: up to 2.4 in 50
#: random scenes.
_OF_RATE = 4.0


@dataclass(frozen=True)
class PowerCurve:
    """The load or the approach, which is a power of the radius at first, between the stages.

    It is interpolated as its logarithm less that of the power.

    Attributes
    ----------
    stretch : RadiusStretch
    values : ndarray
        At its points.
    power : float
        What the logarithm has as its slope in ``u`` at a tip; another one costs points only.
    """

    stretch: RadiusStretch
    values: Array
    power: float

    @cached_property
    def _rest(self) -> Array:
        return np.log(self.values / np.exp(self.stretch.logs) ** self.power)

    @property
    def left_out(self) -> float:
        """What is left out between the points, relative."""
        return left_out(self._rest)

    def at(self, t: Array) -> Array:
        """Return the logarithm at places in [-1, 1]."""
        u = self.stretch.log_radius_at(t)
        return chebyshev_value(self._rest, t) + self.power * u

    def rate(self, t: Array) -> Array:
        """Return the derivative of the logarithm in ``x``."""
        bends = self.stretch.bends_at(t)
        return slope(self._rest, t) * 2.0 / self.stretch.extent + self.power / bends


@dataclass(frozen=True)
class Panel:
    """Stages at Chebyshev points between two radii.

    Attributes
    ----------
    stretch : RadiusStretch
        The radii.
    weights : Weights
        Loads and approaches at the nodes; increments of the load weigh the stages.
    flats : tuple of Solution
        The stages, in the order of their radii.
    fields : tuple of str
        Those that are superposed.
    powers : tuple of float
        Of the radius, that load and approach go like at the tip of a profile.
    """

    stretch: RadiusStretch
    weights: Weights
    flats: tuple[Solution, ...]
    fields: tuple[str, ...]
    powers: tuple[float, float]

    @property
    def low(self) -> float:
        """Logarithm of the radius it begins at."""
        return self.stretch.low

    @property
    def high(self) -> float:
        """Logarithm of the radius it ends at."""
        return self.stretch.high

    @cached_property
    def loads(self) -> PowerCurve:
        """``P``."""
        return PowerCurve(self.stretch, self.weights.loads, self.powers[0])

    @cached_property
    def approaches(self) -> PowerCurve:
        """``delta``."""
        return PowerCurve(self.stretch, self.weights.approaches, self.powers[1])

    @cached_property
    def slips(self) -> bool:
        """Whether there is slip; next to its onset it may be too narrow to be found."""
        return any(len(one.zones) > 1 for one in self.flats)

    @cached_property
    def alike(self) -> bool:
        """Whether all stages are the same, as on a smooth surface."""
        return all(one is self.flats[0] for one in self.flats)

    @cached_property
    def stick(self) -> Array:
        """``ln c*`` of the stages."""
        return np.array([stick_radius(one).log for one in self.flats])

    @cached_property
    def shears(self) -> Array:
        """``Q*`` of the stages."""
        return np.array([one.total_shear for one in self.flats])

    def load(self, t: Array) -> Array:
        """Return ``P``."""
        return np.asarray(np.exp(self.loads.at(t)))

    def increment(self, t: Array) -> Array:
        """Return ``dP/dx``."""
        return self.load(t) * self.loads.rate(t)

    def rate_today(self, curve: PowerCurve) -> float:
        """Return the derivative in ``u`` of a logarithm at the end of the panel."""
        end = np.ones(1)
        return float((curve.rate(end) * self.stretch.bends_at(end))[0])

    def log_stick(self, t: Array) -> Array:
        """Return ``ln c*``."""
        if self.alike:
            return np.full_like(t, self.stick[0])
        return chebyshev_value(self.stick, t)

    def integral(self, rates: Callable[[Array], Array]) -> float:
        """Return an integral over ``x`` of what is given at places in [-1, 1]."""
        g, w = gauss_rule(2 * self.stretch.count)
        return self.stretch.extent / 2.0 * float(w @ rates(g))

    def where_stuck(self, names: Sequence[str], t: Array, depth: Array) -> Array:
        """Return fields of a flat punch where it sticks, at ``ln(c*/s) = depth``.

        Parameters
        ----------
        names : sequence of str
            Of "pressure" and "traction".
        t, depth : ndarray, shape (n,)
            Places on the panel, in [-1, 1], and depths.

        Returns
        -------
        ndarray, shape (names, n)
        """
        with np.errstate(divide="ignore"):
            x = -np.log(-np.expm1(-2.0 * depth))
        fields = FieldTable.several([self._stuck(name) for name in names], t, x)
        for name, values in zip(names, fields, strict=True):
            if name == "traction":
                values *= np.exp(-depth)  # the table has the traction over s/c*
        return fields

    def where_slipping(self, names: Sequence[str], t: Array, depth: Array) -> Array:
        """Return fields of a flat punch where it slips, at ``ln(1/s) = depth``.

        As `where_stuck`; the names are of "pressure" and "slip".
        """
        y, width = -np.expm1(-2.0 * depth), -np.expm1(2.0 * self.log_stick(t))
        return self._at_share(names, t, y / np.maximum(width, np.maximum(y, TINY)))

    def _stuck(self, name: str) -> FieldTable:
        """Return a field in the stuck disk over ``-ln d``, ``d = 1 - (s/c*)**2``.

        The traction is odd in ``s``.
        """

        def values(one: Solution, x: Array) -> Array:
            return _in_stick_disk(one, name, np.exp(-x))

        return self._table(name, values, 0.0, _DEEP)

    def _at_share(self, names: Sequence[str], t: Array, share: Array) -> Array:
        """Return fields where they slip: share is 0 at the edge and 1 at the stick radius.

        It is ``1 - s**2`` over what that is at the stick radius.

        All stages are seen in their slip zones, in which fields are smooth but for the ends.
        """
        with np.errstate(divide="ignore"):
            x = np.log1p(-share) - np.log(share)
        return FieldTable.several([self._slipping(name) for name in names], t, x)

    def _slipping(self, name: str) -> FieldTable:
        """Return a field in the slip zone over the logarithm of the ratio of `_in_slip_zone`."""

        def values(one: Solution, x: Array) -> Array:
            return _in_slip_zone(one, name, np.exp(x))

        return self._table(name, values, -_DEEP, _DEEP + _DEEP // 2)

    def _table(
        self, name: str, values: Callable[[Solution, Array], Array], low: float, panels: int
    ) -> FieldTable:
        """Return the table of a field, whose panels begin at the logarithm `low`; made once."""
        key = name, low
        if key not in self._tables:
            flats = self.flats[:1] if self.alike else self.flats
            self._tables[key] = FieldTable(
                lambda x: np.array([values(one, x) for one in flats]), low, panels
            )
        return self._tables[key]

    @cached_property
    def _tables(self) -> dict[tuple[str, float], FieldTable]:
        return {}

    @cached_property
    def shear_error(self) -> float:
        """What the interpolants of load and shear leave out, each relative to its largest value."""
        size = max(float(np.abs(self.shears).max()), TINY)
        of_loads = max(self.weights.error, self.loads.left_out)
        return float(max(of_loads, left_out(self.shears) / size))

    @cached_property
    def error(self) -> float:
        """The same of everything, relative to the largest of what is interpolated.

        `lost` is not in it.
        """
        of_stick = left_out(self.stick) if self.slips else 0.0
        of_rate = _OF_RATE * max(self.loads.left_out, self.weights.error)
        return max(of_rate, self.shear_error, of_stick, *map(self._field_error, self.fields))

    @property
    def lost(self) -> float:
        """What the tables used so far leave out, of their largest values: series in the distance.

        It says how well the flat punches are known, which shorter panels do not change.
        """
        tables = [one for (name, _), one in self._tables.items() if name != "slip"]
        return max((one.lost for one in tables), default=0.0)

    @cached_property
    def slips_by(self) -> Array:
        """The slip of the stages at some places, (stages, places)."""
        return self._at_nodes(lambda t, d: self._at_share(["slip"], t, d)[0], _SLIPPING_LOOKS)

    @cached_property
    def slip_error(self) -> float:
        """Estimate of the error of what the panel adds to the slip, in its own unit."""
        if not self.slips:
            return 0.0
        largest = np.abs(self.slips_by).max(axis=1)
        known = np.array([one.error.slip or 0.0 for one in self.flats])
        # just past the onset no digit is known of slip that is small on its panel
        of_flats = np.where(known <= 1.0, largest * known, largest.max())
        # places move with the stick radius
        moved = left_out(self.stick) * 2.0 / np.maximum(np.expm1(-2.0 * self.stick), TINY)
        left = max(left_out(column) for column in self.slips_by.T)
        gained = self.integral(
            lambda t: self.increment(t) * np.exp(self.low - self.stretch.log_radius_at(t))
        )
        # by parts: what the load lacks counts against all of it
        lacking = 2.0 * self.loads.left_out * float(self.load(np.ones(1))[0])
        of_fields = gained * (left + (of_flats + largest * moved).max())
        return float(of_fields + lacking * largest.max()) * math.exp(-self.low)

    def _field_error(self, name: str) -> float:
        table = self._stuck(name)
        values = self._at_nodes(table, -np.log1p(-(_LOOKS**2)))
        size = max(float(np.abs(values).max()), TINY)
        return max(left_out(column) / size for column in values.T)

    def _at_nodes(self, field: Callable[[Array, Array], Array], places: Array) -> Array:
        """Return the field of the stages at some places, (stages, places)."""
        nodes = chebyshev_nodes(self.stretch.count)
        t = np.repeat(nodes, len(places))
        return field(t, np.tile(places, len(nodes))).reshape(-1, len(places))


def stick_radius(flat: Solution) -> Radius:
    """Return where the central zone of a flat punch ends, its stick disk."""
    zone = flat.zones[0]
    return Radius(zone.outer, zone.outer_from_edge)


def _in_stick_disk(flat: Solution, name: str, d: Array) -> Array:
    """Return a field of a flat punch at ``d = 1 - (s/c)**2``; the traction over ``s/c``.

    A series in d is evaluated there. To subtract a radius from c would cost its square roots half
    of their digits.
    """
    piece = _zone_piece(flat, name, 0)
    if piece is not None and isinstance(piece.field, DiskSeries):
        return piece.factor * piece.field.over_power(d)
    stick, scaled = stick_radius(flat), np.sqrt(1.0 - d)
    from_edge = stick.from_edge + stick.value * d / (1.0 + scaled)
    values = _field(flat, name, stick.value * scaled, from_edge)
    return values / scaled if name == "traction" else values


def _in_slip_zone(flat: Solution, name: str, ratio: Array) -> Array:
    """Return a field of a flat punch between the stick radius and the edge.

    `ratio` is the distance in ``s**2`` from the stick radius over that from the edge. Over half of
    the width of the zone these distances are ``ratio * below`` and `below`.
    """
    below = 2.0 / (1.0 + ratio)
    y = stick_radius(flat).rest * below / 2.0
    s = np.sqrt(1.0 - y)
    piece = _zone_piece(flat, name, 1)
    if piece is not None and isinstance(piece.field, AnnulusSeries):
        return np.asarray(
            piece.factor * s**piece.field.power * piece.field.over_power(ratio * below, below)
        )
    return _field(flat, name, s, y / (1.0 + s))


def _zone_piece(flat: Solution, name: str, zone: int) -> ZonePiece | None:
    """Return a field of a flat punch in one of its zones, if it has an expression for each."""
    field = getattr(flat, f"{name}_field")
    if not isinstance(field, ZonalField) or not zone < len(field.pieces) == len(flat.zones):
        return None
    return field.pieces[zone]


def _field(flat: Solution, name: str, s: Array, from_edge: Array) -> Array:
    """Return a field of a flat punch at radii; zero if there is none."""
    field = getattr(flat, f"{name}_field")
    return np.zeros(len(s)) if field is None else np.asarray(field(s, from_edge))
