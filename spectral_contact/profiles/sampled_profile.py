"""Profiles made of functions or of points: the slope as a polynomial on every piece."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import pairwise, product
from typing import Self

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import ArrayLike

from spectral_contact.errors import SceneError
from spectral_contact.fields import Array
from spectral_contact.io.checks import finite, flag, positive, values_at
from spectral_contact.io.choices import function, listed
from spectral_contact.profiles.convex import convex_pieces
from spectral_contact.profiles.hull import checked_points, hull_of_points, increasing
from spectral_contact.profiles.profile_base import Profile

Rows = tuple[tuple[float, ...], ...]

#: Degrees of a fit, which are tried in turn.
_DEGREES = (15, 31, 63, 127)
#: A fit is accepted if its last coefficients are at most this, relative to the largest slope on the
#: piece.
_FIT_ACCURACY = 2e-14
#: If the slope on the first piece of a rounded tip has at most this many coefficients, the disk
#: resolves it without panels to the centre. With more it varies over less than half of the piece.
_MOST_GENTLE_TERMS = 32
#: Estimated ratio of the sum of all terms that a fit omits to its last coefficients.
_OMITTED_FACTOR = 8.0
#: Fraction of the largest slope by which the slope may fall.
_SLOPE_SLACK = 1e-11
#: Fraction of the largest height by which a height may differ from the integral of the slope.
_HEIGHT_TOLERANCE = 1e-9
#: Number of points at which the slope of a piece is checked.
_CHECKED_POINTS = 257
#: Number of radii that are evaluated at once, so that intermediate arrays stay in a cache.
_BLOCK = 2048


@dataclass(frozen=True, slots=True)
class Sampled(Profile):
    """A profile whose slope is a Chebyshev series on every piece.

    Made by `from_functions` or `from_points`.

    Parameters
    ----------
    edges : tuple of float
        Radii at which the pieces begin and end: from 0, increasing.
    slopes : tuple of tuple of float
        Chebyshev coefficients of the slope ``h'`` on each piece.
    rounded : bool
        Whether the height is a smooth function of ``r**2`` at the centre, as a sphere's is and a
        cone's is not. If it is not known, False is always right, and takes more time.

    Raises
    ------
    SceneError
        If a parameter is not of this form, or the slope is negative or falls anywhere.
    """

    edges: tuple[float, ...]
    slopes: Rows
    rounded: bool = False

    def __post_init__(self) -> None:
        edges = increasing("edges", self.edges)
        if len(edges) < 2 or edges[0] != 0.0:
            raise SceneError("edges", self.edges, "two or more radii that begin with 0")
        allowed = f"{len(edges) - 1} lists of numbers, one for each piece"
        given = listed("slopes", self.slopes, "lists of numbers, one for each piece")
        rows = tuple(tuple(finite("slopes", row).tolist()) for row in given)
        if len(rows) != len(edges) - 1 or not all(rows):
            raise SceneError("slopes", self.slopes, allowed)
        object.__setattr__(self, "edges", edges)
        object.__setattr__(self, "slopes", rows)
        object.__setattr__(self, "rounded", flag("rounded", self.rounded))
        self._check_convex()

    @classmethod
    def from_functions(
        cls,
        height: Callable[[Array], ArrayLike],
        slope: Callable[[Array], ArrayLike],
        *,
        reach: float,
        breaks: Sequence[float] = (),
        rounded: bool = False,
    ) -> Self:
        """Make a profile of two functions of the radius, which are sampled now.

        Parameters
        ----------
        height, slope : callable
            ``h`` and ``h'`` at an array of radii, in the reference length.
        reach : float
            Radius at which the profile ends; the contact has to stay below it. Finite and > 0.
        breaks : sequence of float
            Radii in between at which a derivative jumps: the slope has to be smooth elsewhere.
        rounded : bool
            Whether the height is a smooth function of ``r**2`` at the centre.

        Raises
        ------
        SceneError
            If the slope is not smooth between the breaks, to 2e-14 of its largest value; is not the
            derivative of the height; or the profile is not convex, or not 0 at the centre.
        """
        function("height", height, "radii")
        function("slope", slope, "radii")
        reach = positive("reach", reach)
        edges = increasing(
            "breaks", (0.0, *finite("breaks", listed("breaks", breaks, "radii")).tolist(), reach)
        )
        ends = np.array([edges[0], edges[-1]])
        largest = float(np.abs(values_at("slope", slope, ends)).max())
        rows = tuple(
            _fitted(slope, low, high, at_high=largest if high == reach else 0.0, largest=largest)
            for low, high in pairwise(edges)
        )
        profile = cls(edges, rows, rounded)
        r = np.linspace(0.0, reach, _CHECKED_POINTS)
        given = values_at("height", height, r)
        integrated = profile._height(r)
        scale = max(float(np.abs(integrated).max()), float(np.abs(given).max()))
        if not abs(given[0]) <= _HEIGHT_TOLERANCE * scale:
            raise SceneError("height", float(given[0]), "0 at the centre")
        wrong = ~(np.abs(given - integrated) <= _HEIGHT_TOLERANCE * scale)
        if wrong.any():
            integral = f"{integrated[wrong][0]:.10g}"
            allowed = f"{integral} at the radius {r[wrong][0]:.6g}, the integral of the slope"
            raise SceneError("height", float(given[wrong][0]), allowed)
        return profile

    @classmethod
    def from_points(
        cls, radii: ArrayLike, heights: ArrayLike, *, convex_hull: bool = False
    ) -> Self:
        """Make a convex profile through points that are convex.

        Between them are cubics, or two parabolas where a cubic would not be convex; the slope is
        continuous except at corners of the points. Points of a parabola give that parabola, and
        points on a line that line. Of a smooth function whose curvature is positive the heights are
        right to the fourth order of the distance of the points, the slopes to the third. Every
        point is a break, to which panels are graded: some tens are practical.

        Parameters
        ----------
        radii, heights : array_like, shape (n,)
            At least three of each; both begin with 0, and the radii increase.
        convex_hull : bool
            For measured points, which noise has made not convex: take their convex hull from
            below, with negative heights as 0. `hull_of_points` says how far it lies from them.

        Raises
        ------
        SceneError
            If they do not, or a point lies above the line through its neighbours.
        """
        if flag("convex_hull", convex_hull):
            hull = hull_of_points(radii, heights)
            return cls(*convex_pieces(hull.radii, np.array(hull.heights)))
        return cls(*convex_pieces(*checked_points(radii, heights)))

    @property
    def flat_part(self) -> float:
        """Radius up to which the slope is zero."""
        flat = 0.0
        for end, row in zip(self.edges[1:], self.slopes, strict=True):
            if any(row):
                return flat
            flat = end
        return flat

    @property
    def reach(self) -> float:
        """Radius up to which it is known."""
        return self.edges[-1]

    @property
    def pointed(self) -> bool:
        """Whether panels are graded to the centre, as for a tip that is sharp or hardly rounded."""
        graded = not self.rounded or len(self.slopes[0]) > _MOST_GENTLE_TERMS
        return graded and self.flat_part == 0.0

    @property
    def breaks(self) -> tuple[float, ...]:
        """Where the pieces meet."""
        return self.edges[1:-1]

    @property
    def brief(self) -> str:
        """Its kind, pieces and reach."""
        return f"Sampled(pieces={len(self.slopes)}, reach={self.reach!r})"

    def _height(self, r: Array) -> Array:
        """Return the height at radii; NaN beyond the reach."""
        r = np.asarray(r, dtype=float)
        total = np.where(r <= self.reach, 0.0, np.nan)
        for (low, high), row in self._pieces():
            # the mean slope times the extent: next to the beginning of a piece a difference of
            # integrals would have no digit
            g, w = _gauss(len(row) // 2 + 1)
            extent = np.clip(r, low, high) - low
            local = extent[..., None] * (1.0 + g) / (high - low) - 1.0
            total = total + extent * (chebyshev.chebval(local, row) @ (w / 2.0))
        return np.asarray(total)

    def _transform(self, t: Array) -> Array:
        t = np.asarray(t, dtype=float)
        return np.asarray(2.0 * t * self._means(t, False)[0])

    def _fall(self, radius: float, t: Array, y: Array, past: Array) -> Array:
        last = max((b for b in self.edges[:-1] if b < radius), default=0.0)
        inward = radius * y / (1.0 + t)
        # next to the edge it is the integral of the derivative
        near = inward < 0.25 * (radius - last)
        g, w = _gauss(24)
        points = radius - inward[near][:, None] * (1.0 + g) / 2.0
        # `past` of the argument is that of the radii t, this one that of the points of the rule
        past_at_points = (points - last) * (points + last) * (last > 0.0)
        fallen = np.empty(np.shape(t))
        fallen[near] = inward[near] * (self._rate(points, past_at_points) @ (w / 2.0))
        whole = self._transform(np.asarray(radius))
        fallen[~near] = whole - self._transform(radius * t[~near])
        return fallen

    def _rate(self, t: Array, past: Array) -> Array:
        t = np.asarray(t, dtype=float)
        mean, second_mean = self._means(t)
        rate = 2.0 * mean + 2.0 * t * second_mean
        rows = [row for _, row in self._pieces()]
        edges = self.edges
        for k in range(1, len(rows)):
            jump = float(chebyshev.chebval(-1.0, rows[k]) - chebyshev.chebval(1.0, rows[k - 1]))
            # from the last break below t the distance is given, without the cancellation of t
            last = (t > edges[k]) & (t <= edges[k + 1])
            beyond = np.where(last, past, np.maximum(t - edges[k], 0.0) * (t + edges[k]))
            outside = beyond > 0.0
            root = np.sqrt(np.where(outside, beyond, 1.0))
            rate += np.where(outside, 2.0 * jump * edges[k] / root, 0.0)
        return np.asarray(rate)

    def _means(self, t: Array, both: bool = True) -> tuple[Array, Array]:
        """Return ``int_0^(pi/2) h' (t sin phi) dphi``, and if wanted that of h'' sin phi."""
        shape = np.shape(t)
        t = np.ravel(t)
        total = np.zeros(len(t))
        second_mean = np.zeros(len(t))
        for start in range(0, len(t), _BLOCK):
            block = slice(start, start + _BLOCK)
            self._add_means(t[block], total[block], second_mean[block] if both else None)
        return total.reshape(shape), second_mean.reshape(shape)

    def _add_means(self, t: Array, total: Array, second_mean: Array | None) -> None:
        for (low, high), row in self._pieces():
            inside = np.flatnonzero((t > low) | (low == 0.0))
            at = t[inside]
            safe = np.where(at > 0.0, at, 1.0)
            # a polynomial of the sine, over a quarter of a turn at most
            g, w = _gauss(len(row) + min(len(row) + 6, 16))
            begin = np.arcsin(np.minimum(low / safe, 1.0))
            end = np.where(at > 0.0, np.arcsin(np.minimum(high / safe, 1.0)), np.pi / 2.0)
            half = (end - begin) / 2.0
            sine = np.sin(begin + half * (1.0 + g)[:, None])
            local = np.clip(2.0 * (at * sine - low) / (high - low) - 1.0, -1.0, 1.0)
            total[inside] += half * (w @ chebyshev.chebval(local, row))
            if second_mean is not None:
                slopes = 2.0 / (high - low) * chebyshev.chebder(row)
                second_mean[inside] += half * (w @ (chebyshev.chebval(local, slopes) * sine))

    def _slope_error(self, radius: float) -> float:
        rows = [row for (low, _), row in self._pieces() if low < radius]
        return max(map(_series_error, rows))

    def _pieces(self) -> list[tuple[tuple[float, float], Array]]:
        ends = pairwise(self.edges)
        return [(pair, np.array(row)) for pair, row in zip(ends, self.slopes, strict=True)]

    def _check_convex(self) -> None:
        nodes = np.cos(np.pi * np.linspace(1.0, 0.0, _CHECKED_POINTS))
        r = []
        slope = []
        for (low, high), row in self._pieces():
            r.append(low + (high - low) * (1.0 + nodes) / 2.0)
            slope.append(chebyshev.chebval(nodes, row))
        at = np.concatenate(r)
        values = np.concatenate(slope)
        slack = _SLOPE_SLACK * float(np.abs(values).max())
        if values[-1] <= 0.0:
            raise SceneError("slope", float(values[-1]), "positive where the profile ends")
        if values.min() < -slack:
            worst = int(values.argmin())
            allowed = f"at least 0, also at the radius {at[worst]:.6g}"
            raise SceneError("slope", float(values[worst]), allowed)
        falls = np.diff(values) < -slack
        if falls.any():
            worst = int(np.flatnonzero(falls)[0])
            allowed = f"convex: the slope may not fall, as it does at the radius {at[worst]:.6g}"
            raise SceneError("profile", f"a slope of {values[worst + 1]:.6g}", allowed)


@cache
def _gauss(points: int) -> tuple[Array, Array]:
    """Return a Gauss-Legendre rule on [-1, 1]."""
    return np.polynomial.legendre.leggauss(points)


def _series_error(row: Array) -> float:
    """Return a bound on the error of a series that `_fitted` made."""
    # A fit is accepted if its last coefficients are _FIT_ACCURACY of its largest value. The sum of
    # the moduli of its coefficients bounds that value.
    error = _FIT_ACCURACY * float(np.abs(row).sum())
    if len(row) <= _DEGREES[-1]:
        return error
    last = float(np.abs(row[-2:]).max())
    if last > _FIT_ACCURACY * float(np.abs(row).sum()):  # it is not resolved
        return error + 2.0 * float(np.abs(row[len(row) // 2 :]).sum())
    return error + _OMITTED_FACTOR * last


def _fitted(
    slope: Callable[[Array], ArrayLike],
    low: float,
    high: float,
    *,
    at_high: float,
    largest: float,
) -> tuple[float, ...]:
    """Return the series of the slope on a piece, accurate relative to its largest value there.

    Parameters
    ----------
    slope : callable
    low, high : float
    at_high : float
        The slope at the end of the piece, 0 if it is not known.
    largest : float
        The largest slope of the profile. On a piece where the slope is far below it, as next to a
        flat part, values may consist of rounding, which no polynomial fits: then the series of the
        largest degree is taken whole, if its last coefficients are small beside the largest slope.
    """
    # At first the estimate of the omitted terms has to be within _FIT_ACCURACY. Where rounding
    # prevents that, only the last coefficients have to be.
    for accuracy, degree in product((_FIT_ACCURACY / _OMITTED_FACTOR, _FIT_ACCURACY), _DEGREES):
        nodes = chebyshev.chebpts1(degree + 1)
        values = values_at("slope", slope, low + (high - low) * (1.0 + nodes) / 2.0)
        if not np.isfinite(values).all():
            raise SceneError("slope", values[~np.isfinite(values)][0], "finite")
        # at the zeros of a Chebyshev polynomial the coefficients are sums
        matrix = chebyshev.chebvander(nodes, degree).T * (2.0 / (degree + 1))
        matrix[0] /= 2.0
        row = matrix @ values
        scale = max(float(np.abs(values).max()), at_high)
        tail = float(np.abs(row[-2:]).max())
        if tail <= accuracy * scale:
            significant = np.flatnonzero(np.abs(row) > 1e-16 * scale)
            return tuple(row[: significant[-1] + 1].tolist()) if len(significant) else (0.0,)
    if tail <= _FIT_ACCURACY * largest:
        return tuple(row.tolist())
    allowed = f"smooth between {low:.6g} and {high:.6g}, or to have its breaks named"
    raise SceneError("slope", "a function that no polynomial fits", allowed)
