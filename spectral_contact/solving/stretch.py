r"""Interpolation over the contact radius: the intervals and their Chebyshev points.

The solution under a flat punch is a smooth function of its radius ``b``. It is singular at negative
radii, at distances of the order of the compliance of the layer, and at the radii where slip begins
or the profile has a break. A stretch is an interval of ``b`` on which functions are interpolated in

    v = ln(b - b_0)                                                      (docs/theory, G.10)

From the first touch on the origin ``b_0`` is negative, and nearer to 0 than all poles. At the onset
of slip and at breaks a stretch begins, with ``b_0`` just below its lower end. In ``v`` all other
singularities, except a pole of the load (G.11), are some ``pi`` away, so that few points are enough
for many decades of ``b``.

The module also has the Chebyshev interpolation itself, the estimate of its error, and a table of
fields, which interpolates over the place in the contact as well.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.polynomial import chebyshev

from spectral_contact.fields import Array
from spectral_contact.spectral.jacobi import chebyshev_interpolation
from spectral_contact.threads import cached_property

#: Safety factor of the error estimate `interpolation_error`. Without it, errors of loads under
#: spheres were up to 1.5 times the estimate in 19 random contacts.
_SAFETY = 3.0
#: Ratio of the last pair of coefficients to the one before, below which it may be small by chance.
#: With 1 or more the rounding of the Volterra equation would be taken for a slow decay, and the
#: cone of Spence would not converge at 1e-10.
_FAST_DECAY = 0.1
#: Width of the panels of a `FieldTable` in the logarithm of the distance.
_PANEL_WIDTH = 2.0
#: Number of Chebyshev terms in that logarithm on each panel. Singularities are ``pi`` away from a
#: panel, so that every term divides the error by 6.
_TERMS_IN_X = 16


@dataclass(frozen=True)
class RadiusStretch:
    """An interval of contact radii ``b``, with Chebyshev points in ``v = ln(b - b_0)``.

    A radius in it is given in one of three ways: by its logarithm ``u = ln b``; by its depth, which
    is the distance in ``v`` from the lower end; or by its place ``t``, a linear function of the
    depth, -1 at the lower end and 1 at the upper one.

    Attributes
    ----------
    low, high : float
        ``u`` at the two ends.
    low_dv_du : float
        The derivative ``dv/du = b/(b - b_0)`` at the lower end. It stands for the origin ``b_0``:
        it is 1 if ``b_0 = 0``, less if ``b_0 < 0``, and large if ``b_0`` is just below the end.
    count : int
        Number of Chebyshev points; 0 until it is chosen.
    """

    low: float
    high: float
    low_dv_du: float = 1.0
    count: int = 0

    @cached_property
    def extent(self) -> float:
        """Length of the stretch in ``v``."""
        return math.log1p(self.low_dv_du * math.expm1(self.high - self.low))

    @cached_property
    def u_nodes(self) -> Array:
        """``u`` at the Chebyshev points, ascending."""
        return self.u_at(chebyshev_nodes(self.count))

    def depth(self, t: Array) -> Array:
        """Return the depths of places."""
        return np.asarray(self.extent * (1.0 + t) / 2.0)

    def place(self, depth: Array) -> Array:
        """Return the places of depths; a depth off the stretch gets the nearer end."""
        return np.asarray(np.clip(2.0 * depth / self.extent - 1.0, -1.0, 1.0))

    def depth_of(self, u: Array) -> Array:
        """Return the depths of radii given by ``u``; 0 for radii below the stretch."""
        return np.asarray(np.log1p(self.low_dv_du * np.expm1(np.maximum(u - self.low, 0.0))))

    def place_of(self, u: Array) -> Array:
        """Return the places of radii given by ``u``."""
        return self.place(self.depth_of(u))

    def distance_below(self, u: Array) -> Array:
        """Return the distances in ``v`` of radii, given by ``u``, from the lower end.

        They are 0 for radii on or above the stretch, and infinite at or below ``b_0``. Distances
        above 30 have no correct digits: there ``b - b_0`` is a difference of nearly equal numbers.
        """
        # (b - b_0) over its value at the lower end
        ratio = 1.0 + self.low_dv_du * np.expm1(np.minimum(u - self.low, 0.0))
        with np.errstate(divide="ignore"):
            return np.asarray(-np.log(np.maximum(ratio, 0.0)))

    def u_at_depth(self, depth: Array) -> Array:
        """Return ``u`` at depths."""
        return np.asarray(self.low + self.u_increment(np.zeros(1), depth))

    def u_at(self, t: Array) -> Array:
        """Return ``u`` at places."""
        return self.u_at_depth(self.depth(t))

    def dv_du_at_depth(self, depth: Array) -> Array:
        """Return the derivative ``dv/du`` at depths."""
        return np.asarray(self.low_dv_du * np.exp(-depth) - np.expm1(-depth))

    def dv_du_at(self, t: Array) -> Array:
        """Return the derivative ``dv/du`` at places."""
        return self.dv_du_at_depth(self.depth(t))

    def u_increment(self, depth: Array, v_step: Array) -> Array:
        """Return the increment of ``u`` if ``v`` grows by `v_step` from a depth on.

        Its relative error is a rounding error for short steps, too.
        """
        return np.asarray(np.log1p(np.expm1(v_step) / self.dv_du_at_depth(depth)))

    def v_increment(self, depth: Array, u_step: Array) -> Array:
        """Return the increment of ``v`` if ``u`` grows by `u_step` from a depth on."""
        return np.asarray(np.log1p(np.expm1(u_step) * self.dv_du_at_depth(depth)))

    def cut(self, pieces: int) -> list[RadiusStretch]:
        """Return pieces of equal length in ``v``, with the same ``b_0`` and no points yet."""
        return self.cut_at(self.extent * np.arange(pieces) / pieces)

    def cut_at(self, depths: Array) -> list[RadiusStretch]:
        """Return the pieces that begin at ascending depths, of which the first is 0."""
        ends = [*self.u_at_depth(depths).tolist(), self.high]
        dv_du = self.dv_du_at_depth(depths).tolist()
        return [RadiusStretch(*piece) for piece in zip(ends[:-1], ends[1:], dv_du, strict=True)]


@cache
def _nodes_and_matrix(count: int) -> tuple[Array, Array]:
    """Return the Chebyshev points, ascending, and the matrix from values there to coefficients."""
    descending, fit = chebyshev_interpolation(count)
    nodes = np.ascontiguousarray(descending[::-1])
    matrix = np.ascontiguousarray(fit[:, ::-1])
    nodes.setflags(write=False)
    matrix.setflags(write=False)
    return nodes, matrix


def chebyshev_nodes(count: int) -> Array:
    """Return the Chebyshev points of the first kind, ascending; the ends are not among them."""
    return _nodes_and_matrix(count)[0]


def chebyshev_series(values: Array) -> Array:
    """Return the Chebyshev coefficients of the interpolant, from values at the points."""
    return np.asarray(_nodes_and_matrix(len(values))[1] @ values)


def chebyshev_value(values: Array, t: Array) -> Array:
    """Return the interpolant at places, from values at the points."""
    return np.asarray(chebyshev.chebval(t, chebyshev_series(values)))


def slope(values: Array, t: Array) -> Array:
    """Return the derivative of the interpolant by the place, from values at the points."""
    return np.asarray(chebyshev.chebval(t, chebyshev.chebder(chebyshev_series(values))))


def interpolation_weights(t: Array, count: int) -> Array:
    """Return the factors of the values at the points in the interpolant, (places, points)."""
    differences = t[:, None] - chebyshev_nodes(count)
    differences[differences == 0.0] = 1e-300
    terms = _barycentric_weights(count) / differences
    return np.asarray(terms / terms.sum(axis=1, keepdims=True))


@cache
def _barycentric_weights(count: int) -> Array:
    """Return the weights of the points in the barycentric formula (Berrut and Trefethen 2004)."""
    odd = np.arange(1, 2 * count, 2)
    return np.asarray(np.sin(math.pi * odd / (2 * count)) * (-1.0) ** np.arange(count))


def interpolation_error(values: Array) -> float:
    """Return an estimate of the error of the interpolant, from six or more values at the points.

    The first coefficient that the series leaves out is extrapolated from the last two pairs of
    coefficients. Where coefficients change their signs, a pair may be small by chance. So if the
    last pair is less than `_FAST_DECAY` of the one before, the mean decay over the last three pairs
    is taken if it is slower; the constant is not among them. The estimate is a multiple of the
    extrapolated coefficient, as further ones are left out, too: the factor is 1 if coefficients
    decay fast, and one plus half their number if they do not decay.
    """
    sizes = np.abs(chebyshev_series(values))
    last = float(sizes[-2:].max())
    before = float(sizes[-4:-2].max())
    decay = min(last / before, 1.0) if before > 0.0 else 1.0  # over two degrees
    if decay < _FAST_DECAY:
        earlier = float(sizes[1:][-6:-4].max(initial=before))
        decay = max(decay, math.sqrt(last / earlier))
    return _SAFETY * last * math.sqrt(decay) * (1.0 + decay * len(values) / 2.0)


class FieldTable:
    """A field of flat punches, interpolated over their radius and over the place under them.

    One coordinate is the place ``t`` of the radius on its stretch. The other one is ``x``, a
    logarithm of the distance from the edge or from the stick radius (docs/theory, G.12), which is
    divided into panels. The field is a double Chebyshev series on each panel.

    Parameters
    ----------
    values : callable
        Takes values of ``x``, (n,), and returns the field there under the flat punches at all
        Chebyshev points of the stretch, (punches, n).
    low : float
        The ``x`` at which the panels begin. Below the first panel and above the last one the field
        is constant in ``x``.
    panels : int
        Number of panels.

    Attributes
    ----------
    series_error : float
        Error of the series in ``x``, relative to the largest value of the field.
    """

    def __init__(self, values: Callable[[Array], Array], low: float, panels: int) -> None:
        self._low = low
        self._panel_count = panels
        # distances of the samples from `low`, in widths of a panel
        scaled = np.arange(panels)[:, None] + (1.0 + chebyshev_nodes(_TERMS_IN_X)) / 2.0
        samples = values(low + _PANEL_WIDTH * scaled.ravel())
        _, to_degrees_in_t = _nodes_and_matrix(len(samples))
        _, to_degrees_in_x = _nodes_and_matrix(_TERMS_IN_X)
        series = np.tensordot(to_degrees_in_t, samples.reshape(-1, panels, _TERMS_IN_X), (1, 0))
        #: Coefficients: (panels, degrees in t, degrees in x).
        self._coefficients = np.swapaxes(series @ to_degrees_in_x.T, 0, 1)
        last = np.abs(self._coefficients[..., -2:]).max()
        self.series_error = float(last / max(np.abs(samples).max(), 1e-300))

    def __call__(self, t: Array, x: Array) -> Array:
        """Return the field at places ``t`` of radii and at ``x``, both (n,)."""
        return np.asarray(self.evaluate([self], t, x)[0])

    @staticmethod
    def evaluate(tables: Sequence[FieldTable], t: Array, x: Array) -> Array:
        """Return fields of tables with the same panels, at the same ``t`` and ``x``, (tables, n).

        The points are sorted by panel, so that each panel is evaluated once, for all its points.
        """
        first = tables[0]
        count = first._panel_count
        degrees = first._coefficients.shape[1]
        scaled = np.clip((x - first._low) / _PANEL_WIDTH, 0.0, count)
        panel_of_point = np.minimum(scaled.astype(np.intp), count - 1)
        local = np.clip(2.0 * (scaled - panel_of_point) - 1.0, -1.0, 1.0)
        order = np.argsort(panel_of_point, kind="stable")
        bounds = np.searchsorted(panel_of_point[order], np.arange(count + 1))
        fields = np.empty((len(tables), len(x)))
        for k in np.flatnonzero(np.diff(bounds)):
            points = order[bounds[k] : bounds[k + 1]]
            polynomials_in_x = _chebyshev_rows(local[points], _TERMS_IN_X)
            polynomials_in_t = _chebyshev_rows(t[points], degrees)
            for table, row in zip(tables, fields, strict=True):
                series_in_t = table._coefficients[k] @ polynomials_in_x
                row[points] = np.einsum("ij,ij->j", series_in_t, polynomials_in_t)
        return fields


def _chebyshev_rows(t: Array, count: int) -> Array:
    """Return the first `count` Chebyshev polynomials at ``t``, by recurrence, (count, points)."""
    rows = np.empty((count, len(t)))
    rows[0] = 1.0
    rows[1:2] = t  # if there is a second row
    twice = 2.0 * t
    for n in range(2, count):
        np.multiply(twice, rows[n - 1], out=rows[n])
        rows[n] -= rows[n - 2]
    return rows
