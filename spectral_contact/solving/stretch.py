r"""Stretches of the history of a contact: intervals of its radius, and interpolation on them.

Flat solutions are smooth functions of the radius ``b`` but for poles at negative radii, beyond
some compliance ``c`` of the layer, and for the radii at which slip begins or a profile bends. In
``x = ln(b - origin)``, with the origin at ``-c`` or next to such a radius, the nearest singularity
other than that radius itself, which is the lower end, is ``pi`` away, and few Chebyshev points
serve many decades of ``b``.
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

#: Factor of `left_out`. Without it, errors of loads under spheres were up to 1.5 times the estimate
#: in 19 random contacts.
_SAFETY = 3.0
#: Width of the panels and their terms: singularities are ``pi`` away, so that every term gains a
#: factor of 6.
_WIDTH, _TERMS = 2.0, 16


@dataclass(frozen=True)
class RadiusStretch:
    """An interval of contact radii ``b``, with Chebyshev points in ``x = ln(b - origin)``.

    Places are t in [-1, 1], depths ``x`` from the lower end, and ``u = ln b``.

    Attributes
    ----------
    low, high : float
        ``u`` at its ends.
    bend : float
        ``dx/du = b/(b - origin)`` at the lower end; 1 where ``x`` is ``u``.
    count : int
        Number of points; 0 for a piece of another stretch, until it is chosen.
    """

    low: float
    high: float
    bend: float = 1.0
    count: int = 0

    @cached_property
    def extent(self) -> float:
        """Its length in ``x``."""
        return math.log1p(self.bend * math.expm1(self.high - self.low))

    @cached_property
    def logs(self) -> Array:
        """``u`` of the points."""
        return self.log_radius_at(chebyshev_nodes(self.count))

    def depth(self, t: Array) -> Array:
        """Return the depths of places in [-1, 1]."""
        return np.asarray(self.extent * (1.0 + t) / 2.0)

    def place(self, depth: Array) -> Array:
        """Return the places in [-1, 1]."""
        return np.asarray(np.clip(2.0 * depth / self.extent - 1.0, -1.0, 1.0))

    def depth_of(self, u: Array) -> Array:
        """Return the depths of radii that are not below the stretch."""
        return np.asarray(np.log1p(self.bend * np.expm1(np.maximum(u - self.low, 0.0))))

    def place_of(self, u: Array) -> Array:
        """Return the places in [-1, 1] of radii."""
        return self.place(self.depth_of(u))

    def before(self, u: Array) -> Array:
        """Return the distance in ``x`` of radii below the stretch; infinite below the origin.

        Beyond 30 it has no digits.
        """
        left = 1.0 + self.bend * np.expm1(np.minimum(u - self.low, 0.0))
        with np.errstate(divide="ignore"):
            return np.asarray(-np.log(np.maximum(left, 0.0)))

    def log_radius(self, depth: Array) -> Array:
        """Return ``u``."""
        return np.asarray(self.low + self.ahead(np.zeros(1), depth))

    def log_radius_at(self, t: Array) -> Array:
        """Return ``u`` at places in [-1, 1]."""
        return self.log_radius(self.depth(t))

    def bends(self, depth: Array) -> Array:
        """Return ``dx/du``."""
        return np.asarray(self.bend * np.exp(-depth) - np.expm1(-depth))

    def bends_at(self, t: Array) -> Array:
        """Return ``dx/du`` at places in [-1, 1]."""
        return self.bends(self.depth(t))

    def ahead(self, depth: Array, step: Array) -> Array:
        """Return by how much ``u`` grows in a step of ``x`` from a depth, however short it is."""
        return np.asarray(np.log1p(np.expm1(step) / self.bends(depth)))

    def step(self, depth: Array, ahead: Array) -> Array:
        """Return the step of ``x`` in which ``u`` grows by so much from a depth."""
        return np.asarray(np.log1p(np.expm1(ahead) * self.bends(depth)))

    def cut(self, pieces: int) -> list[RadiusStretch]:
        """Return pieces that are as long as each other."""
        return self.cut_at(self.extent * np.arange(pieces) / pieces)

    def cut_at(self, depths: Array) -> list[RadiusStretch]:
        """Return the pieces that begin at these depths, the first of which is 0."""
        ends = [*self.log_radius(depths).tolist(), self.high]
        bends = self.bends(depths).tolist()
        return [RadiusStretch(*one) for one in zip(ends[:-1], ends[1:], bends, strict=True)]


@cache
def _points(count: int) -> tuple[Array, Array]:
    """Return the nodes, ascending, and the matrix from values there to Chebyshev coefficients."""
    nodes, fit = chebyshev_interpolation(count)
    found = np.ascontiguousarray(nodes[::-1]), np.ascontiguousarray(fit[:, ::-1])
    for one in found:
        one.setflags(write=False)
    return found


def chebyshev_nodes(count: int) -> Array:
    """Return Chebyshev points of the first kind, which leave the ends out, ascending."""
    return _points(count)[0]


def chebyshev_series(values: Array) -> Array:
    """Return the Chebyshev coefficients of what passes through values at the nodes."""
    return np.asarray(_points(len(values))[1] @ values)


def chebyshev_value(values: Array, t: Array) -> Array:
    """Return what passes through values at the nodes, at places in [-1, 1]."""
    return np.asarray(chebyshev.chebval(t, chebyshev_series(values)))


def slope(values: Array, t: Array) -> Array:
    """Return the derivative in t of what passes through values at the nodes."""
    return np.asarray(chebyshev.chebval(t, chebyshev.chebder(chebyshev_series(values))))


def interpolation_weights(t: Array, count: int) -> Array:
    """Return the weights of the values in the interpolant, (places, nodes)."""
    away = t[:, None] - chebyshev_nodes(count)
    away[away == 0.0] = 1e-300
    weights = _barycentric(count) / away
    return np.asarray(weights / weights.sum(axis=1, keepdims=True))


@cache
def _barycentric(count: int) -> Array:
    """Return the weights of the nodes in the barycentric formula."""
    odd = np.arange(1, 2 * count, 2)
    return np.asarray(np.sin(math.pi * odd / (2 * count)) * (-1.0) ** np.arange(count))


def left_out(values: Array) -> float:
    """Return the estimate of what an interpolant through four values or more leaves out.

    It is the next term, as the last two pairs of terms decay, times the number of terms that count:
    1 if they decay fast, half of all next to something singular, where they hardly decay.
    """
    terms = np.abs(chebyshev_series(values))
    last, before = float(terms[-2:].max()), float(terms[-4:-2].max())
    rate = min(last / before, 1.0) if before > 0.0 else 1.0
    return _SAFETY * last * math.sqrt(rate) * (1.0 + rate * len(values) / 2.0)


class FieldTable:
    """A field between the stages of a history, over the contact radius and a place in the contact.

    It is a Chebyshev series in the place of the radius on its stretch, and one on each of the
    panels in a logarithm of the distance from the edge or from the stick radius.

    Parameters
    ----------
    values : callable
        Of logarithms (n,): the fields of all stages there, (stages, n).
    low : float
        Logarithm at which the panels begin; beyond them fields are what they are at their ends.
    panels : int
    """

    def __init__(self, values: Callable[[Array], Array], low: float, panels: int) -> None:
        self._low, self._panels = low, panels
        x = np.arange(panels)[:, None] + (1.0 + chebyshev_nodes(_TERMS)) / 2.0
        found = values(low + _WIDTH * x.ravel())
        table = np.tensordot(_points(len(found))[1], found.reshape(-1, panels, _TERMS), (1, 0))
        #: Coefficients: (panels, degrees in the radius, degrees in the logarithm).
        self._table = np.swapaxes(table @ _points(_TERMS)[1].T, 0, 1)
        #: What the series in the distance leave out, relative to the largest value.
        self.lost = float(np.abs(self._table[..., -2:]).max() / max(np.abs(found).max(), 1e-300))

    def __call__(self, t: Array, x: Array) -> Array:
        """Return the field at places t of radii in [-1, 1] and logarithms x, both (n,)."""
        return np.asarray(self.several([self], t, x)[0])

    @staticmethod
    def several(tables: Sequence[FieldTable], t: Array, x: Array) -> Array:
        """Return the fields of tables with the same panels at the same places, (tables, n)."""
        first = tables[0]
        count = first._panels
        degrees = first._table.shape[1]
        x = np.clip((x - first._low) / _WIDTH, 0.0, count)
        panels = np.minimum(x.astype(np.intp), count - 1)
        local = np.clip(2.0 * (x - panels) - 1.0, -1.0, 1.0)
        order = np.argsort(panels, kind="stable")
        ends = np.searchsorted(panels[order], np.arange(count + 1))
        sums = np.empty((len(tables), len(x)))
        for k in np.flatnonzero(np.diff(ends)):
            here = order[ends[k] : ends[k + 1]]
            in_logarithm = _rows(local[here], _TERMS)
            in_radius = _rows(t[here], degrees)
            for table, row in zip(tables, sums, strict=True):
                row[here] = np.einsum("ij,ij->j", table._table[k] @ in_logarithm, in_radius)
        return sums


def _rows(t: Array, count: int) -> Array:
    """Return the first Chebyshev polynomials as rows."""
    rows, twice = np.empty((count, len(t))), 2.0 * t
    rows[0], rows[1:2] = 1.0, t
    for n in range(2, count):
        np.multiply(twice, rows[n - 1], out=rows[n])
        rows[n] -= rows[n - 2]
    return rows
