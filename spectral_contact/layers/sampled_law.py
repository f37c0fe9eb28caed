"""Laws made of points or of functions: a polynomial on every piece of the overclosure."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache
from itertools import pairwise, product
from math import frexp, inf, ldexp
from typing import Any, NamedTuple, Self

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import ArrayLike

from spectral_contact.errors import SceneError, SolutionFileError
from spectral_contact.fields import Array
from spectral_contact.io.checks import finite, flag, real, values_at
from spectral_contact.io.choices import function, instance, listed
from spectral_contact.io.columns import Expected, read_columns
from spectral_contact.layers.layer_base import LawErrors, Layer

Rows = tuple[tuple[float, ...], ...]

#: Degrees of a fit, which are tried in turn.
_DEGREES = (15, 31, 63, 127)
#: A fit is accepted if its last coefficients are at most this, relative to the largest pressure on
#: the piece.
_FIT_ACCURACY = 2e-14
#: Estimated ratio of the sum of all terms that a series omits to the largest of its last
#: coefficients.
_OMITTED_FACTOR = 8.0
#: Largest pressure at the start, in units of _FIT_ACCURACY times the largest pressure.
_ZERO_TOLERANCE = 10.0
#: Largest jump of the pressure at a knot, in the same units.
_JUMP_TOLERANCE = 1e3
#: Tolerance on a given derivative, relative to the largest derivative of the fit.
_DERIVATIVE_TOLERANCE = 1e-9
#: Number of points of every piece at which a law is checked, and of the whole law at which the
#: derivative is.
_SAMPLES = 257
#: Relative difference below which the cubics on both sides of a point count as the same.
_SAME_CUBIC = 1e-12
#: Least points of a table.
_LEAST_POINTS = 4


def _checked(name: str, values: Any) -> tuple[float, ...]:
    numbers = finite(name, values)
    if not (np.diff(numbers) > 0.0).all():
        raise SceneError(name, values, "numbers that increase")
    return tuple(numbers.tolist())


class _Pieces(Layer):
    """A law that is a polynomial on every piece, and zero before the first."""

    __slots__ = ()

    @property
    def start(self) -> float:
        """Overclosure at which the pressure begins."""
        return self._edges[0]

    @property
    def limit(self) -> float:
        """Overclosure at which the law ends; beyond it, it goes on as its tangent."""
        return self._edges[-1]

    @property
    def knots(self) -> tuple[float, ...]:
        """Where a piece ends and the next begins."""
        return self._edges[1:-1]

    @property
    def _edges(self) -> tuple[float, ...]:
        raise NotImplementedError

    def _piecewise(self, name: str, w: Array) -> Array:
        """Return the "pressure", "slope" or "energy"; beyond the limit, its value at the limit."""
        raise NotImplementedError

    @property
    def _size(self) -> float:
        return (self.limit - self.start) / len(self._edges)

    def _pressure(self, w: Array) -> Array:
        w = np.asarray(w, dtype=float)
        past = np.maximum(w - self.limit, 0.0)
        return self._piecewise("pressure", w) + past * self._piecewise(
            "slope", np.array(self.limit)
        )

    def _slope(self, w: Array) -> Array:
        return self._piecewise("slope", np.asarray(w, dtype=float))

    def _energy(self, w: Array) -> Array:
        w = np.asarray(w, dtype=float)
        past = np.maximum(w - self.limit, 0.0)
        end = np.array(self.limit)
        energy_beyond = past * self._piecewise("pressure", end) + past**2 / 2.0 * self._piecewise(
            "slope", end
        )
        return self._piecewise("energy", w) + energy_beyond

    def _law_errors(self, w: float, pressure: float, slope: float) -> LawErrors:
        """Return the errors of values up to an overclosure, of pressure and slope as given.

        That of the energy is the integral of the pressure's.
        """
        stiffness = float(self._slope(np.array(w)))
        stiffness_error = slope / stiffness if stiffness > 0.0 else inf
        return LawErrors(pressure, stiffness_error, (w - self.start) * pressure)


@dataclass(frozen=True, slots=True)
class Table(_Pieces):
    """A law through points, with SciPy's shape-preserving cubics (PCHIP) between them.

    A point is a knot unless the cubics on both sides of it are the same. Panels are graded towards
    the radii at which the overclosure equals a knot; these radii are part of the solution.

    Parameters
    ----------
    overclosures : sequence of float
        At least four, in L, increasing. Below the first there is no pressure.
    pressures : sequence of float
        As many, in E', increasing from 0. Beyond the last, a scene is refused.

    Raises
    ------
    SceneError
        If they are not.
    """

    overclosures: tuple[float, ...]
    pressures: tuple[float, ...]

    def __post_init__(self) -> None:
        w = _checked("overclosures", self.overclosures)
        if len(w) < _LEAST_POINTS:
            raise SceneError("overclosures", self.overclosures, "four numbers or more")
        p = _checked("pressures", self.pressures)
        if len(p) != len(w) or p[0] != 0.0:
            allowed = f"{len(w)} numbers that increase from 0, one for each overclosure"
            raise SceneError("pressures", self.pressures, allowed)
        object.__setattr__(self, "overclosures", w)
        object.__setattr__(self, "pressures", p)

    @classmethod
    def from_file(
        cls,
        path: str | os.PathLike[str],
        columns: str | None = None,
        *,
        si_units: bool = False,
        option: str = "columns",
    ) -> Self:
        """Read a law from a text file with a column of overclosures and one of pressures.

        Parameters
        ----------
        path : path-like
        columns : str, optional
            Which column is which, as in ``"overclosure=2, pressure=1"`` (docs/files); by default
            the headings tell, or the order.
        si_units : bool
            Whether the numbers are in m and Pa, or in the units of the headings, as a scene in SI
            units has them; by default they have no units.
        option : str
            Name of the argument or option by which the user gave `columns`, for errors.

        Raises
        ------
        SolutionFileError
            If the file cannot be read, or its numbers are no such law.
        """
        units = {"overclosure": "m", "pressure": "Pa"}
        si_units = flag("si_units", si_units)
        option = instance("option", option, str)
        expected = [Expected(name, unit if si_units else "") for name, unit in units.items()]
        table = read_columns(path, expected, columns=columns, option=option)
        for name, values in table.values.items():
            falls = np.flatnonzero(np.diff(values) <= 0.0)
            if falls.size:
                line = table.lines[falls[0] + 1]
                before = table.lines[falls[0]]
                complaint = f"line {line}: {name} does not increase from line {before}"
                raise SolutionFileError(
                    table.path, f"{complaint} ({name} from {table.sources[name]})"
                )
        try:
            return cls(*(tuple(table.values[name].tolist()) for name in units))
        except SceneError as error:
            raise SolutionFileError(table.path, str(error)) from error

    def _over(self, unit: float) -> Self:
        return replace(self, pressures=tuple(p / unit for p in self.pressures))

    @property
    def knots(self) -> tuple[float, ...]:
        """Points between the first and the last at which a derivative of the cubics jumps."""
        return _bends(self.overclosures, self.pressures)

    @property
    def _edges(self) -> tuple[float, ...]:
        return self.overclosures

    def _piecewise(self, name: str, w: Array) -> Array:
        cubics = _cubics(self.overclosures, self.pressures)
        x = np.clip(w, self.start, self.limit) / cubics.unit
        factor = {"pressure": 1.0, "slope": 1.0 / cubics.unit, "energy": cubics.unit}[name]
        return np.where(w < self.start, 0.0, factor * getattr(cubics, name)(x))

    def _errors(self, w: float) -> LawErrors:
        # A cubic of the length h between two points, through which the line has the slope s_k, has
        # slopes in [0, 3 s_k] at the points. If all summands in its coefficients of (w - w_k)^3, ^2
        # and ^1 are taken positive, these are at most 8 s_k/h^2, 12 s_k/h and 3 s_k. So rounding
        # acts on terms of the pressure whose sum is p_k + 23 s_k (w - w_k) at most, and on terms
        # of the slope whose sum is 51 s_k.
        pieces = max(int(np.searchsorted(self.overclosures, w)), 1)
        points = np.array(self.overclosures)
        pressures = np.array(self.pressures)
        lines = (np.diff(pressures) / np.diff(points))[:pieces]
        extents = np.minimum(w, points[1:][:pieces]) - points[:-1][:pieces]
        rounding = float(np.finfo(float).eps)
        pressure = rounding * float((pressures[:-1][:pieces] + 23.0 * lines * extents).max())
        slope = rounding * 51.0 * float(lines.max())
        return self._law_errors(w, pressure, slope)


class _Cubics(NamedTuple):
    """The cubics of a table, their derivatives and their integrals: SciPy's `PPoly`.

    Their variable is the overclosure over a unit of the size of the table, as the third power of a
    very small or large overclosure is not a double. The unit is a power of two, so that nothing is
    rounded.
    """

    unit: float
    pressure: Any
    slope: Any
    energy: Any


@cache
def _cubics(w: tuple[float, ...], p: tuple[float, ...]) -> _Cubics:
    from scipy.interpolate import PchipInterpolator

    unit = ldexp(1.0, frexp(w[-1] - w[0])[1] - 1)
    pressure = PchipInterpolator(np.array(w) / unit, np.array(p))
    return _Cubics(unit, pressure, pressure.derivative(), pressure.antiderivative())


@cache
def _bends(w: tuple[float, ...], p: tuple[float, ...]) -> tuple[float, ...]:
    """Return the inner points of a table at which the cubics on both sides differ."""
    law = _cubics(w, p).pressure
    derivatives = [law.derivative(order) for order in (1, 2, 3)]
    lengths = np.diff(law.x)
    bends = []
    for k in range(1, len(w) - 1):
        shorter_half = min(lengths[k - 1], lengths[k]) / 2.0
        jumps = []
        for order, derivative in enumerate(derivatives, start=1):
            # the polynomial of the piece before, continued to the point
            before = np.polyval(derivative.c[:, k - 1], lengths[k - 1])
            jumps.append(abs(derivative.c[-1, k] - before) * shorter_half**order)
        if max(jumps) > _SAME_CUBIC * p[k]:
            bends.append(w[k])
    return tuple(bends)


@dataclass(frozen=True, slots=True)
class Sampled(_Pieces):
    """A law whose pressure is a Chebyshev series on every piece; made by `from_functions`.

    Parameters
    ----------
    edges : tuple of float
        Overclosures at which the pieces begin and end, in L, increasing.
    series : tuple of tuple of float
        Chebyshev coefficients of the pressure, in E', on each piece.

    Raises
    ------
    SceneError
        If a parameter is not of this form, or the pressure does not increase from 0.
    """

    edges: tuple[float, ...]
    series: Rows

    def __post_init__(self) -> None:
        edges = _checked("edges", self.edges)
        given = listed("series", self.series, "lists of numbers, one for each piece")
        rows = tuple(tuple(finite("series", row).tolist()) for row in given)
        if len(edges) < 2 or len(rows) != len(edges) - 1 or not all(rows):
            allowed = "one list of numbers for each piece between two edges"
            raise SceneError("series", self.series, allowed)
        object.__setattr__(self, "edges", edges)
        object.__setattr__(self, "series", rows)
        self._check()

    @classmethod
    def from_functions(
        cls,
        pressure: Callable[[Array], ArrayLike],
        derivative: Callable[[Array], ArrayLike],
        *,
        start: float,
        limit: float,
        knots: Sequence[float] = (),
    ) -> Self:
        """Make a law of two functions of the overclosure, which are sampled now.

        Parameters
        ----------
        pressure, derivative : callable
            The pressure in E' and its derivative in E'/L, at an array of overclosures in L.
        start, limit : float
            Overclosures at which the pressure begins, and up to which the functions are used.
        knots : sequence of float
            Overclosures in between at which a derivative jumps: the law has to be smooth elsewhere.

        Raises
        ------
        SceneError
            If the pressure is not smooth between the knots, to 2e-14 of its largest value; does
            not increase from 0 at the start; or the derivative is not its derivative.
        """
        function("pressure", pressure, "overclosures")
        function("derivative", derivative, "overclosures")
        inner_knots = finite("knots", listed("knots", knots, "overclosures")).tolist()
        first = real("start", start, allowed="finite")
        last = real("limit", limit, allowed="finite")
        edges = _checked("start, knots, limit", (first, *inner_knots, last))
        largest = float(np.abs(values_at("pressure", pressure, np.array([edges[-1]])))[0])
        rows = tuple(
            _fitted(pressure, low, high, at_high=largest if high == last else 0.0, largest=largest)
            for low, high in pairwise(edges)
        )
        law = cls(edges, rows)
        w = np.linspace(edges[0], edges[-1], _SAMPLES)[1:-1]
        w = w[~np.isin(w, edges)]
        given = values_at("derivative", derivative, w)
        derived = law._slope(w)
        wrong = ~(np.abs(given - derived) <= _DERIVATIVE_TOLERANCE * float(np.abs(derived).max()))
        if wrong.any():
            allowed = (
                f"{derived[wrong][0]:.10g} at {w[wrong][0]:.6g}, the derivative of the pressure"
            )
            raise SceneError("derivative", float(given[wrong][0]), allowed)
        return law

    def _over(self, unit: float) -> Self:
        return replace(self, series=tuple(tuple(c / unit for c in row) for row in self.series))

    @property
    def _edges(self) -> tuple[float, ...]:
        return self.edges

    def _piecewise(self, name: str, w: Array) -> Array:
        edges = np.array(self.edges)
        rows = getattr(_integrated(self.edges, self.series), name)
        pieces = np.clip(np.searchsorted(edges, w, side="right") - 1, 0, len(rows) - 1)
        values = np.zeros(np.shape(w))
        for k, row in enumerate(rows):
            here = pieces == k
            local = 2.0 * (w[here] - edges[k]) / (edges[k + 1] - edges[k]) - 1.0
            values[here] = chebyshev.chebval(np.clip(local, -1.0, 1.0), row)
        return np.where(w < edges[0], 0.0, values)

    def _errors(self, w: float) -> LawErrors:
        pieces = max(int(np.searchsorted(self.edges, w)), 1)
        series = _integrated(self.edges, self.series)
        omitted = [_omitted(row) for row in series.pressure[:pieces]]
        # A fit is accepted if its last coefficients are _FIT_ACCURACY of its largest value. The sum
        # of the moduli of its coefficients bounds that value.
        pressure = max(
            _FIT_ACCURACY * float(np.abs(row).sum()) + omitted_part
            for row, omitted_part in zip(series.pressure, omitted, strict=False)
        )
        slope = max(
            _FIT_ACCURACY * float(np.abs(row).sum())
            + omitted_part * len(row) ** 2 * 2.0 / (high - low)
            for row, omitted_part, (low, high) in zip(
                series.slope, omitted, pairwise(self.edges), strict=False
            )
        )
        # the energy has the integral of the pressure's error, and the rounding of its own series
        sums = [float(np.abs(row).sum()) for row in series.energy[:pieces]]
        rounding = float(np.finfo(float).eps) * max(sums)
        errors = self._law_errors(w, pressure, slope)
        return errors._replace(energy=errors.energy + rounding)

    def _check(self) -> None:
        w = np.concatenate([np.linspace(*ends, _SAMPLES) for ends in pairwise(self.edges)])
        local = np.linspace(-1.0, 1.0, _SAMPLES)
        p = np.concatenate([chebyshev.chebval(local, row) for row in self.series])
        slack = _FIT_ACCURACY * float(np.abs(p).max())
        if not abs(p[0]) <= _ZERO_TOLERANCE * slack:
            raise SceneError("pressure", float(p[0]), f"0 at the start, {w[0]:.6g}")
        if not p[-1] > 0.0:
            raise SceneError("pressure", float(p[-1]), f"positive at the limit, {w[-1]:.6g}")
        falls = np.diff(p) < -slack
        if falls.any():
            worst = int(np.flatnonzero(falls)[0])
            allowed = f"increasing with the overclosure, which it is not at {w[worst]:.6g}"
            raise SceneError("pressure", float(p[worst + 1]), allowed)
        jumps = (
            np.abs(p[_SAMPLES::_SAMPLES] - p[_SAMPLES - 1 : -1 : _SAMPLES])
            > _JUMP_TOLERANCE * slack
        )
        if jumps.any():
            knot = self.edges[1 + int(np.flatnonzero(jumps)[0])]
            raise SceneError("pressure", "a jump", f"continuous, also at {knot:.6g}")


def _omitted(row: Sequence[float]) -> float:
    """Return an estimate of the terms that a series of `Sampled.from_functions` omits.

    A polynomial of degree n that is bounded by 1 on [-1, 1] has derivatives of up to n^2.
    """
    if len(row) - 1 not in _DEGREES:
        return 0.0
    sizes = np.abs(row)
    last = float(sizes[-3:].max())
    accepted = _FIT_ACCURACY * float(sizes.sum())
    if len(row) <= _DEGREES[-1]:
        last = min(last, accepted)
    if last > accepted:  # it is not resolved
        return 2.0 * float(sizes[len(sizes) // 2 :].sum())
    return _OMITTED_FACTOR * last


class _Series(NamedTuple):
    """Chebyshev series on every piece: of the pressure, its derivative, and its integral."""

    pressure: Rows
    slope: Rows
    energy: Rows


@cache
def _integrated(edges: tuple[float, ...], rows: Rows) -> _Series:
    slopes = []
    energies = []
    total = 0.0
    for (low, high), row in zip(pairwise(edges), rows, strict=True):
        half = (high - low) / 2.0
        slopes.append(tuple((chebyshev.chebder(row) / half).tolist()))
        energy = chebyshev.chebint(row, lbnd=-1.0) * half
        energy[0] += total
        energies.append(tuple(energy.tolist()))
        total = float(chebyshev.chebval(1.0, energy))
    return _Series(rows, tuple(slopes), tuple(energies))


def _fitted(
    pressure: Callable[[Array], ArrayLike],
    low: float,
    high: float,
    *,
    at_high: float,
    largest: float,
) -> tuple[float, ...]:
    """Return the series of the pressure on a piece, accurate relative to its largest value there.

    Parameters
    ----------
    pressure : callable
    low, high : float
    at_high : float
        The pressure at the end of the piece, 0 if it is not known.
    largest : float
        The largest pressure of the law. On a piece where the pressure is far below it, values may
        consist of rounding, which no polynomial fits: then the series of the largest degree is
        taken, if its last coefficients are small beside the largest pressure.
    """
    # At first the estimate of the omitted terms has to be within _FIT_ACCURACY. Where rounding
    # prevents that, only the last coefficients have to be.
    for accuracy, degree in product((_FIT_ACCURACY / _OMITTED_FACTOR, _FIT_ACCURACY), _DEGREES):
        nodes = chebyshev.chebpts1(degree + 1)
        values = values_at("pressure", pressure, low + (high - low) * (1.0 + nodes) / 2.0)
        if not np.isfinite(values).all():
            raise SceneError("pressure", float(values[~np.isfinite(values)][0]), "finite")
        row = chebyshev.chebfit(nodes, values, degree)
        tail = float(np.abs(row[-3:]).max())
        if tail <= accuracy * max(at_high, float(np.abs(values).max())):
            return tuple(row.tolist())
    if tail <= _FIT_ACCURACY * largest:
        return tuple(row.tolist())
    allowed = f"smooth between its knots: on [{low:.6g}, {high:.6g}] a polynomial does not fit it"
    raise SceneError("pressure", "a function", allowed)
