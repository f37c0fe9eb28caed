"""Fields on the contact: immutable data that can be evaluated, compared and stored.

A field is written in the distance to a boundary, never in the radius alone, so that it keeps
relative accuracy at the edge and at both ends of every zone.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from spectral_contact.fields import Array
from spectral_contact.fields.legendre import legendre_sum, legendre_sums
from spectral_contact.fields.radius import CENTRE, EDGE, Radius

__all__ = [
    "CENTRE",
    "EDGE",
    "AnnulusSeries",
    "Array",
    "DiskSeries",
    "EdgeWeight",
    "LogSeries",
    "PressureField",
    "Radius",
    "ZonalField",
    "ZonePiece",
    "central_value",
]


#: Legendre polynomials at -1, of more degrees than a panel has (`contact.tuning.MAX_DEGREE`).
_AT_START: Array = np.where(np.arange(128) % 2, -1.0, 1.0)


@dataclass(frozen=True, slots=True, eq=False)
class LogSeries:
    """``d**power`` times a Legendre series in ``x = -ln d``, with a tail polynomial in ``d``.

    Here d is the distance from an end at which the function may be singular. It is divided into
    panels of equal length in x, which shrink geometrically in d; the tail is what is left next to
    the end.

    Attributes
    ----------
    coefficients : ndarray, shape (panels, degree + 1)
        Legendre coefficients on the panels ``[j h, (j+1) h]`` in ``x``.
    tail : ndarray, shape (terms,)
        Legendre coefficients in ``d`` on ``[0, exp(-panels h)]``; see `oscillation`, too.
    width : float
        Panel width ``h``.
    power : float
        Exponent of the factor ``d**power``, on panels and tail.
    root_tail : bool
        The tail is a series in ``sqrt(d)``.
    oscillation : float
        If not zero, the tail is ``a cos(oscillation u) + b sin(oscillation u)`` instead, where u
        is ``x - panels h``, and `tail` is ``(a, b)``. It has no limit at ``d = 0``; NaN there.
    logarithm : float
        If not zero, ``logarithm u`` is added to the tail, which is infinite at ``d = 0``.
    """

    coefficients: Array
    tail: Array
    width: float
    power: float = 0.0
    root_tail: bool = False
    oscillation: float = 0.0
    logarithm: float = 0.0

    def __call__(self, d: Array) -> Array:
        """Evaluate at distances `d` in [0, 1], any shape."""
        shape = np.shape(d)
        d = np.ravel(d)
        if d.size == 0:
            return np.empty(shape)
        if d.size == 1:
            return np.full(shape, self.value(float(d[0])))
        return np.asarray(self.values_of([self], d)[0].reshape(shape))

    @staticmethod
    def values_of(series: Sequence[LogSeries | None], d: Array) -> Array:
        """Return the values of several series at distances (n,), a row for each, in one pass.

        Parameters
        ----------
        series : sequence of LogSeries or None
            All with the same panels, numbers of terms, power and kind of tail; or all None, which
            stands for the function 0.
        d : ndarray, shape (n,)
        """
        present = [one for one in series if one is not None]
        if not present:
            return np.zeros((len(series), len(d)))
        first = present[0]
        panels = len(first.coefficients)
        end = math.exp(-panels * first.width)
        # x in panel widths, then the place in [-1, 1] on the panel; on the tail x may be infinite:
        # it is bounded here, and these values are replaced below
        local = np.log(np.maximum(d, end * 1e-2))
        local /= -first.width
        panel = np.minimum(local.astype(int), panels - 1)
        local -= panel + 0.5
        local *= 2.0
        np.minimum(np.maximum(local, -1.0, out=local), 1.0, out=local)
        table = np.concatenate([one.coefficients for one in present])
        row_of_point = panel + panels * np.arange(len(present))[:, None]
        result = legendre_sums(local, table, row_of_point)
        on_tail = d < end
        if on_tail.any():
            result[:, on_tail] = LogSeries._on_tails(present, d[on_tail], end)
        if first.power != 0.0:
            with np.errstate(divide="ignore"):
                result *= d**first.power
        return result

    @staticmethod
    def _on_tails(series: Sequence[LogSeries], d: Array, end: float) -> Array:
        """Return the values of tails on ``[0, end]``, a row for each, without ``d**power``."""
        first = series[0]
        tails = np.array([one.tail for one in series])
        if first.oscillation == 0.0:
            ratio = np.sqrt(d / end) if first.root_tail else d / end
            sums = legendre_sums(2.0 * ratio - 1.0, tails)
            for row, one in zip(sums, series, strict=True):
                if one.logarithm != 0.0:
                    with np.errstate(divide="ignore"):
                        row -= one.logarithm * np.log(d / end)
            return sums
        positive = d > 0.0
        phase = -first.oscillation * np.log(np.where(positive, d, end) / end)
        wave = tails @ np.array([np.cos(phase), np.sin(phase)])
        return np.where(positive, wave, np.nan)

    def value(self, d: float) -> float:
        """Evaluate at one distance, without arrays."""
        panels = len(self.coefficients)
        end = math.exp(-panels * self.width)
        if d < end and (self.oscillation != 0.0 or self.logarithm != 0.0):
            value = float(self._on_tails([self], np.array([d]), end)[0, 0])
        elif d < end:
            ratio = math.sqrt(d / end) if self.root_tail else d / end
            value = legendre_sum(2.0 * ratio - 1.0, self.tail.tolist())
        else:
            x = -math.log(d) / self.width
            panel = min(max(int(x), 0), panels - 1)
            local = min(max(2.0 * (x - panel) - 1.0, -1.0), 1.0)
            value = legendre_sum(local, self.coefficients[panel].tolist())
        if self.power == 0.0 or math.isnan(value):
            return value
        if self.power > 0.0:
            return float(value * d**self.power)
        return value * d**self.power if d > 0.0 else math.copysign(math.inf, value)

    @property
    def limit(self) -> float:
        """Value at ``d = 0``: NaN where the tail oscillates, +inf where it is singular.

        It is +inf whatever the sign of the tail, unlike ``value(0.0)``.
        """
        if self.oscillation != 0.0:
            return np.nan
        if self.power > 0.0:
            return 0.0
        if self.power < 0.0 or self.logarithm != 0.0:
            return np.inf
        return legendre_sum(-1.0, self.tail.tolist())

    def at_ends(self) -> Array:
        """Return the values at `ends`."""
        terms = self.coefficients.shape[1]
        values = np.empty(len(self.coefficients) + 1)
        values[:-1] = self.coefficients @ _AT_START[:terms]
        values[-1] = self.coefficients[-1].sum()
        if self.power != 0.0:
            values *= self.ends**self.power
        return values

    @property
    def ends(self) -> Array:
        """Where the panels end: ``d = exp(-j width)``, (panels + 1,)."""
        return np.asarray(np.exp(-self.width * np.arange(len(self.coefficients) + 1)))

    def times(self, factor: float) -> LogSeries:
        """Return the series multiplied by a number."""
        return replace(
            self,
            coefficients=self.coefficients * factor,
            tail=self.tail * factor,
            logarithm=self.logarithm * factor if self.logarithm else 0.0,  # not -0.0
        )


@dataclass(frozen=True, slots=True)
class EdgeWeight:
    """The endpoint weight ``amplitude / sqrt(y + shift)`` with ``y = 1 - s**2``.

    With ``logarithmic`` it is ``amplitude * (-ln y) / (s**2 sqrt(y))``: ``q/s`` of full stick on a
    smooth surface without tangential compliance.
    """

    amplitude: float
    shift: float
    logarithmic: bool = False

    def __call__(self, y: Array) -> Array:
        """Evaluate at `y` in [0, 1]; infinite at y = 0 if the shift is 0 and the amplitude not."""
        if self.amplitude == 0.0:
            return np.zeros(np.shape(y))
        if self.shift > 0.0:  # no division by zero; the logarithmic weight has no shift
            return np.asarray(self.amplitude / np.sqrt(y + self.shift))
        with np.errstate(divide="ignore"):
            value = self.amplitude / np.sqrt(y)
        if self.logarithmic:
            z = 1.0 - y
            safe = np.where(z > 0.0, z, 1.0)
            with np.errstate(divide="ignore", invalid="ignore"):
                value = value * np.where(z > 0.0, -np.log(y) / safe, 1.0)
        return np.asarray(value)

    def deficit(self, d: Array) -> Array:
        """Return ``amplitude pi/2`` less the half-integral of the weight at t.

        The half-integral (docs/theory, Symbols) is ``amplitude arctan sqrt(d / shift)``. The
        difference is ``amplitude arctan sqrt(shift / d)``, and is not taken by a subtraction.

        Parameters
        ----------
        d : ndarray
            ``1 - t**2``, positive.
        """
        return np.asarray(self.amplitude * np.arctan(np.sqrt(self.shift / d)))

    def times(self, factor: float) -> EdgeWeight:
        """Return the weight multiplied by a number."""
        return EdgeWeight(self.amplitude * factor, self.shift, self.logarithmic)


@dataclass(frozen=True, slots=True)
class PressureField:
    """Pressure as an endpoint weight plus a series in ``y``; either may be absent."""

    weight: EdgeWeight | None
    series: LogSeries | None

    def evaluate(self, y: Array) -> Array:
        """Evaluate at ``y = 1 - s**2``."""
        value = np.zeros(np.shape(y))
        if self.weight is not None:
            value = value + self.weight(y)
        if self.series is not None:
            value = value + self.series(y)
        return value

    def value(self, y: float) -> float:
        """Evaluate at one ``y``."""
        weight_value = 0.0 if self.weight is None else float(self.weight(np.array(y)))
        return weight_value if self.series is None else weight_value + self.series.value(y)

    @staticmethod
    def values_of(fields: Sequence[PressureField], y: Array) -> Array:
        """Return the values of fields whose series have the same panels at ``y``, (n,), as rows."""
        values = LogSeries.values_of([field.series for field in fields], y)
        for row, field in zip(values, fields, strict=True):
            if field.weight is not None:
                row += field.weight(y)
        return values

    def times(self, factor: float) -> PressureField:
        """Return the field multiplied by a number."""
        series = None if self.series is None else self.series.times(factor)
        weight = None if self.weight is None else self.weight.times(factor)
        return PressureField(weight, series)

    def at_ends(self) -> Array:
        """Return the values at the `ends` of the series."""
        assert self.series is not None
        values = self.series.at_ends()
        return values if self.weight is None else values + self.weight(self.series.ends)

    def __call__(self, s: Array, from_edge: Array) -> Array:
        """Evaluate at radii `s` whose distances to the edge are `from_edge`."""
        return self.evaluate(from_edge * (1.0 + s))


@dataclass(frozen=True, slots=True)
class DiskSeries:
    """``(s/outer)**(power + exponent) (weight + series)`` on a disk of radius `outer`.

    Weight and series are functions of ``d = 1 - (s/outer)**2``. The `power` is 1 for a traction in
    the central stick zone and 0 for a pressure. The `exponent` is 0 but in one case: if slip goes
    to the centre of a smooth surface with elastic coupling, the pressure varies there like a power
    of s.
    """

    outer: Radius
    series: LogSeries | None
    weight: EdgeWeight | None = None
    power: int = 1
    exponent: float = 0.0

    def __call__(self, s: Array, from_edge: Array) -> Array:
        """Evaluate inside the disk."""
        scaled = s / self.outer.value
        d = np.clip(self.outer.below(s, from_edge) / self.outer.square, 0.0, 1.0)
        value = self.over_power(d)
        if self.exponent != 0.0:
            value = value * np.maximum(scaled, np.finfo(float).tiny) ** self.exponent
        return np.asarray(scaled**self.power * value)

    def over_power(self, d: Array) -> Array:
        """Return the field over ``(s/outer)**power`` at ``d = 1 - (s/outer)**2``.

        It is the weight plus the series, without the factor of the `exponent`.
        """
        value = np.zeros(np.shape(d))
        if self.series is not None:
            value = value + self.series(d)
        if self.weight is not None:
            value = value + self.weight(d)
        return value

    def times(self, factor: float) -> DiskSeries:
        """Return the field multiplied by a number."""
        series = None if self.series is None else self.series.times(factor)
        weight = None if self.weight is None else self.weight.times(factor)
        return replace(self, series=series, weight=weight)


@dataclass(frozen=True, slots=True)
class AnnulusSeries:
    """``s**power`` times two series, one on either half of an annulus.

    Each is a function of a distance from its end of the annulus, in [0, 1]: the difference of
    ``s**2`` there and at the end, over half that of both ends.
    """

    inner: Radius
    outer: Radius
    toward_inner: LogSeries
    toward_outer: LogSeries
    power: int = 1

    def __call__(self, s: Array, from_edge: Array) -> Array:
        """Evaluate inside the annulus."""
        above = np.maximum(-self.inner.below(s, from_edge), 0.0)
        below = np.maximum(self.outer.below(s, from_edge), 0.0)
        half = (above + below) / 2.0
        half = np.where(half > 0.0, half, 1.0)  # an annulus may have no width
        return np.asarray(s**self.power * self.over_power(above / half, below / half))

    def over_power(self, above: Array, below: Array) -> Array:
        """Return the field over ``s**power``.

        Parameters
        ----------
        above, below : ndarray
            Distances in ``s**2`` from the inner and the outer end, over half the width.
        """
        return np.where(
            above <= below,
            self.toward_inner(np.clip(above, 0.0, 1.0)),
            self.toward_outer(np.clip(below, 0.0, 1.0)),
        )


@dataclass(frozen=True, slots=True)
class ZonePiece:
    """One zone of a field: ``factor * field`` up to `outer`; no field means zero."""

    outer: Radius
    field: DiskSeries | AnnulusSeries | PressureField | None
    factor: float = 1.0


@dataclass(frozen=True, slots=True)
class ZonalField:
    """A field that has its own expression in every zone, ordered from the centre to the edge.

    A `weight` is added to it on the whole contact.
    """

    pieces: tuple[ZonePiece, ...]
    weight: EdgeWeight | None = None

    @classmethod
    def on_parts(
        cls, bounds: Sequence[Radius], series: Iterable[LogSeries], *, pointed: bool = False
    ) -> ZonalField:
        """Return the pressure on a contact that is divided at some radii.

        Parameters
        ----------
        bounds : sequence of Radius
            Ends of the intervals, from the centre to the edge.
        series : iterable of LogSeries
            From the centre outward: one of a disk, and two of an annulus, those of its inner and
            of its outer half.
        pointed : bool
            Whether the pressure is not smooth at the centre, so that the innermost interval is an
            annulus, too.
        """
        remaining = iter(series)
        pieces = []
        for inner, outer in pairwise(bounds):
            field: DiskSeries | AnnulusSeries
            if inner is CENTRE and not pointed:
                field = DiskSeries(outer, next(remaining), power=0)
            else:
                field = AnnulusSeries(inner, outer, next(remaining), next(remaining), power=0)
            pieces.append(ZonePiece(outer, field))
        return cls(tuple(pieces))

    def __call__(self, s: Array, from_edge: Array) -> Array:
        """Evaluate at radii `s` whose distances to the edge are `from_edge`, any shape."""
        result = np.zeros(np.shape(s))
        farther_out = np.ones(np.shape(s), dtype=bool)  # than the pieces evaluated so far
        for piece in self.pieces:
            inside = farther_out & (piece.outer.below(s, from_edge) >= 0.0)
            farther_out &= ~inside
            if piece.field is not None and piece.factor != 0.0 and inside.any():
                result[inside] = piece.factor * piece.field(s[inside], from_edge[inside])
        if self.weight is not None:
            result = result + self.weight(from_edge * (1.0 + s))
        return result

    def evaluate(self, y: Array) -> Array:
        """Evaluate at ``y = 1 - s**2``."""
        s = np.sqrt(np.maximum(1.0 - y, 0.0))
        return self(s, y / (1.0 + s))

    def times(self, factor: float) -> ZonalField:
        """Return the field multiplied by a number."""
        weight = None if self.weight is None else self.weight.times(factor)
        return ZonalField(tuple(replace(p, factor=p.factor * factor) for p in self.pieces), weight)


def central_value(field: PressureField | ZonalField) -> float:
    """Return the value of a field at the centre."""
    return float(field(np.zeros(1), np.ones(1))[0])
