r"""Stretches of the history of a contact: intervals of its radius, and interpolation on them.

The solution under a flat punch depends smoothly on the radius ``b`` of the punch. Its singularities
are poles at negative radii, at ``-c`` or below where ``c`` is of the order of the compliance of the
layer, and the radii at which slip begins or the profile has a break. On a stretch functions are
interpolated in ``x = ln(b - origin)``. The origin is ``-c``, or just below the radius at which slip
begins or the break is, which is then the lower end of the stretch. In ``x`` all other singularities
are at least ``pi`` away, so that few Chebyshev points serve many decades of ``b``.
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

#: Safety factor of the estimate `left_out`. Without it, errors of loads under spheres were up to
#: 1.5 times the estimate in 19 random contacts.
_SAFETY = 3.0
#: Width of the panels of a `FieldTable` in the logarithm of the distance, and the number of
#: Chebyshev terms on each. Singularities are ``pi`` away from a panel, so that every term divides
#: the error by 6.
_WIDTH, _TERMS = 2.0, 16


@dataclass(frozen=True)
class RadiusStretch:
    """An interval of contact radii ``b``, with Chebyshev points in ``x = ln(b - origin)``.

    A radius is given in one of three ways: by its logarithm ``u = ln b``, by its place ``t`` in
    [-1, 1], or by its depth, which is the distance in ``x`` from the lower end. Place and depth are
    proportional to each other.

    Attributes
    ----------
    low, high : float
        ``u`` at the two ends.
    bend : float
        The derivative ``dx/du = b/(b - origin)`` at the lower end. It says where the origin is, and
        is 1 for the origin 0, where ``x`` is ``u``.
    count : int
        Number of Chebyshev points; 0 for a piece of another stretch, until the number is chosen.
    """

    low: float
    high: float
    bend: float = 1.0
    count: int = 0

    @cached_property
    def extent(self) -> float:
        """Length of the stretch in ``x``."""
        return math.log1p(self.bend * math.expm1(self.high - self.low))

    @cached_property
    def logs(self) -> Array:
        """The Chebyshev points as ``u``, ascending."""
        return self.log_radius_at(chebyshev_nodes(self.count))

    def depth(self, t: Array) -> Array:
        """Return the depths of places in [-1, 1]."""
        return np.asarray(self.extent * (1.0 + t) / 2.0)

    def place(self, depth: Array) -> Array:
        """Return the places in [-1, 1] of depths; those off the stretch move to its nearer end."""
        return np.asarray(np.clip(2.0 * depth / self.extent - 1.0, -1.0, 1.0))

    def depth_of(self, u: Array) -> Array:
        """Return the depths of radii ``u``; 0 for radii below the stretch."""
        return np.asarray(np.log1p(self.bend * np.expm1(np.maximum(u - self.low, 0.0))))

    def place_of(self, u: Array) -> Array:
        """Return the places in [-1, 1] of radii ``u``."""
        return self.place(self.depth_of(u))

    def before(self, u: Array) -> Array:
        """Return how far below the stretch radii are, in ``x``.

        It is 0 for radii that are not below, and infinite for those at or below the origin.
        Distances above 30 are rounding errors: they are the logarithm of a difference near 0.
        """
        # (b - origin) over what that is at the lower end
        ratio = 1.0 + self.bend * np.expm1(np.minimum(u - self.low, 0.0))
        with np.errstate(divide="ignore"):
            return np.asarray(-np.log(np.maximum(ratio, 0.0)))

    def log_radius(self, depth: Array) -> Array:
        """Return ``u`` at depths."""
        return np.asarray(self.low + self.ahead(np.zeros(1), depth))

    def log_radius_at(self, t: Array) -> Array:
        """Return ``u`` at places in [-1, 1]."""
        return self.log_radius(self.depth(t))

    def bends(self, depth: Array) -> Array:
        """Return the derivative ``dx/du`` at depths."""
        return np.asarray(self.bend * np.exp(-depth) - np.expm1(-depth))

    def bends_at(self, t: Array) -> Array:
        """Return the derivative ``dx/du`` at places in [-1, 1]."""
        return self.bends(self.depth(t))

    def ahead(self, depth: Array, step: Array) -> Array:
        """Return by how much ``u`` grows in a step of ``x`` that starts at a depth.

        It is accurate relative to itself, for short steps too.
        """
        return np.asarray(np.log1p(np.expm1(step) / self.bends(depth)))

    def step(self, depth: Array, ahead: Array) -> Array:
        """Return the step of ``x`` from a depth in which ``u`` grows by `ahead`."""
        return np.asarray(np.log1p(np.expm1(ahead) * self.bends(depth)))

    def cut(self, pieces: int) -> list[RadiusStretch]:
        """Return pieces of equal length in ``x``; their numbers of points are not chosen yet."""
        return self.cut_at(self.extent * np.arange(pieces) / pieces)

    def cut_at(self, depths: Array) -> list[RadiusStretch]:
        """Return the pieces that begin at these ascending depths, the first of which is 0."""
        ends = [*self.log_radius(depths).tolist(), self.high]
        bends = self.bends(depths).tolist()
        return [RadiusStretch(*piece) for piece in zip(ends[:-1], ends[1:], bends, strict=True)]


@cache
def _nodes_and_matrix(count: int) -> tuple[Array, Array]:
    """Return the nodes, ascending, and the matrix from values there to Chebyshev coefficients."""
    descending, fit = chebyshev_interpolation(count)
    nodes = np.ascontiguousarray(descending[::-1])
    matrix = np.ascontiguousarray(fit[:, ::-1])
    nodes.setflags(write=False)
    matrix.setflags(write=False)
    return nodes, matrix


def chebyshev_nodes(count: int) -> Array:
    """Return the Chebyshev points of the first kind, ascending; -1 and 1 are not among them."""
    return _nodes_and_matrix(count)[0]


def chebyshev_series(values: Array) -> Array:
    """Return the Chebyshev coefficients of the interpolant of values at the nodes."""
    return np.asarray(_nodes_and_matrix(len(values))[1] @ values)


def chebyshev_value(values: Array, t: Array) -> Array:
    """Evaluate the interpolant of values at the nodes, at places in [-1, 1]."""
    return np.asarray(chebyshev.chebval(t, chebyshev_series(values)))


def slope(values: Array, t: Array) -> Array:
    """Evaluate the derivative in t of the interpolant of values at the nodes."""
    return np.asarray(chebyshev.chebval(t, chebyshev.chebder(chebyshev_series(values))))


def interpolation_weights(t: Array, count: int) -> Array:
    """Return the factors of the values at the nodes in the interpolant, (places, nodes)."""
    differences = t[:, None] - chebyshev_nodes(count)
    differences[differences == 0.0] = 1e-300
    terms = _barycentric_weights(count) / differences
    return np.asarray(terms / terms.sum(axis=1, keepdims=True))


@cache
def _barycentric_weights(count: int) -> Array:
    """Return the weights of the nodes in the barycentric formula (Berrut and Trefethen 2004)."""
    odd = np.arange(1, 2 * count, 2)
    return np.asarray(np.sin(math.pi * odd / (2 * count)) * (-1.0) ** np.arange(count))


def left_out(values: Array) -> float:
    """Estimate the error of the interpolant of four values or more at the nodes.

    The first coefficient that is left out is extrapolated from the decay between the last two pairs
    of coefficients. It is multiplied by how many such coefficients add up: 1 if they decay fast,
    and half the number of values if they hardly decay, as they do next to a singularity.
    """
    sizes = np.abs(chebyshev_series(values))
    last = float(sizes[-2:].max())
    before = float(sizes[-4:-2].max())
    decay = min(last / before, 1.0) if before > 0.0 else 1.0  # over two degrees
    return _SAFETY * last * math.sqrt(decay) * (1.0 + decay * len(values) / 2.0)


class FieldTable:
    """A field interpolated over the contact radius and over the place in the contact.

    It is a double Chebyshev series on each panel: in the place ``t`` of the contact radius on its
    stretch, and in a logarithm ``x`` of the distance from the edge or from the stick radius.

    Parameters
    ----------
    values : callable
        Takes logarithms ``x``, (n,), and returns the field of every stage there, (stages, n).
    low : float
        The ``x`` at which the panels begin. Below the first panel and above the last one the field
        is constant in ``x``.
    panels : int
        Number of panels.

    Attributes
    ----------
    lost : float
        What the series in ``x`` leave out, relative to the largest value of the field.
    """

    def __init__(self, values: Callable[[Array], Array], low: float, panels: int) -> None:
        self._low = low
        self._panel_count = panels
        # in widths of a panel from the lower end
        scaled = np.arange(panels)[:, None] + (1.0 + chebyshev_nodes(_TERMS)) / 2.0
        samples = values(low + _WIDTH * scaled.ravel())
        _, over_radius = _nodes_and_matrix(len(samples))
        _, over_logarithm = _nodes_and_matrix(_TERMS)
        series = np.tensordot(over_radius, samples.reshape(-1, panels, _TERMS), (1, 0))
        #: Coefficients: (panels, degrees in t, degrees in x).
        self._coefficients = np.swapaxes(series @ over_logarithm.T, 0, 1)
        last = np.abs(self._coefficients[..., -2:]).max()
        self.lost = float(last / max(np.abs(samples).max(), 1e-300))

    def __call__(self, t: Array, x: Array) -> Array:
        """Return the field at places t of contact radii and at logarithms x, both (n,)."""
        return np.asarray(self.several([self], t, x)[0])

    @staticmethod
    def several(tables: Sequence[FieldTable], t: Array, x: Array) -> Array:
        """Return the fields of tables with equal panels at the same ``t`` and ``x``, (tables, n).

        The points are sorted by panel, so that each panel is evaluated once, for all its points.
        """
        first = tables[0]
        count = first._panel_count
        degrees = first._coefficients.shape[1]
        scaled = np.clip((x - first._low) / _WIDTH, 0.0, count)
        panel_of_point = np.minimum(scaled.astype(np.intp), count - 1)
        local = np.clip(2.0 * (scaled - panel_of_point) - 1.0, -1.0, 1.0)
        order = np.argsort(panel_of_point, kind="stable")
        bounds = np.searchsorted(panel_of_point[order], np.arange(count + 1))
        fields = np.empty((len(tables), len(x)))
        for k in np.flatnonzero(np.diff(bounds)):
            points = order[bounds[k] : bounds[k + 1]]
            in_logarithm = _chebyshev_rows(local[points], _TERMS)
            in_radius = _chebyshev_rows(t[points], degrees)
            for table, row in zip(tables, fields, strict=True):
                over_radius = table._coefficients[k] @ in_logarithm
                row[points] = np.einsum("ij,ij->j", over_radius, in_radius)
        return fields


def _chebyshev_rows(t: Array, count: int) -> Array:
    """Return the first `count` Chebyshev polynomials at t as rows, by their recurrence."""
    rows = np.empty((count, len(t)))
    rows[0] = 1.0
    rows[1:2] = t  # if there is a second row
    twice = 2.0 * t
    for n in range(2, count):
        np.multiply(twice, rows[n - 1], out=rows[n])
        rows[n] -= rows[n - 2]
    return rows
