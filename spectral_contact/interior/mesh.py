"""Panels over the radius of the contact, graded to its edge and to every zone boundary.

Where a point of the body is close to a panel, the panel is cut into pieces that are equal in
``asinh(distance / depth)``, in which the load of a ring is smooth.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from spectral_contact.fields.series import Radius

__all__ = ["Evaluator", "Mesh", "Nodes", "Points", "graded"]

Array = NDArray[np.float64]
Evaluator = Callable[[Array, Array], Array]

#: A panel closer than this many times its length is cut.
_NEAR = 1.0
#: How many e-folds the panels go towards a zone boundary, beyond which radii cannot be told apart.
_FOLDS = 34
#: Points that are served at a time, which bounds the memory.
_BLOCK = 32


@dataclass(frozen=True, slots=True)
class Points:
    """Points of the body, one-dimensional arrays of one length.

    Attributes
    ----------
    r, from_edge, z : ndarray
        Radius, ``1 - r`` to relative accuracy (negative outside), and depth.
    """

    r: Array
    from_edge: Array
    z: Array

    @property
    def to_edge(self) -> Array:
        """Distance to the edge of the contact."""
        return np.asarray(np.hypot(self.from_edge, self.z))

    @property
    def on_surface(self) -> NDArray[np.bool_]:
        """Whether a point is as good as on the surface."""
        return np.asarray(self.z <= 1e-16 * self.to_edge)

    def __getitem__(self, which: slice | NDArray[Any]) -> Points:
        return Points(self.r[which], self.from_edge[which], self.z[which])


class Nodes(NamedTuple):
    """Rows of nodes, each row on one panel for one point; all but `owner` are (rows, nodes).

    Attributes
    ----------
    owner : ndarray of int, shape (rows,)
        Which point a row is for.
    s, ahead, weight : ndarray
        Radius of the ring, radius of the point minus it, and quadrature weight.
    pressure, traction : ndarray
        The loads there.
    """

    owner: NDArray[np.intp]
    s: Array
    ahead: Array
    weight: Array
    pressure: Array
    traction: Array


class _Ends(NamedTuple):
    """Ends of panels, from the centre and from the edge."""

    s: Array
    d: Array


def _halves(inner: Radius, outer: Radius, folds: int) -> list[_Ends]:
    """Return the ends of the panels of an interval, graded to its two ends unless to the centre."""
    square = (inner.square + outer.square) / 2.0
    middle = float(np.sqrt(square))
    rest = (inner.rest + outer.rest) / 2.0 / (1.0 + middle)
    sides = []
    if inner.value == 0.0:
        s = middle * np.array([0.0, 0.5])
        sides.append(_Ends(s, 1.0 - s))
    else:
        reach = (square - inner.square) / (middle + inner.value)
        if inner.value > 0.5:
            reach = inner.from_edge - rest
        steps = np.concatenate([[0.0], reach * np.exp(np.arange(-float(_FOLDS), 0.0))])
        sides.append(_Ends(inner.value + steps, inner.from_edge - steps))
    reach = rest - outer.from_edge if outer.value > 0.5 else outer.value - middle
    steps = reach * np.exp(-np.arange(float(folds + 1)))
    sides.append(_Ends(outer.value - steps, outer.from_edge + steps))
    return sides


def graded(boundaries: Sequence[Radius], edge_folds: int) -> _Ends:
    """Return the ends of all panels from the centre to the edge.

    Parameters
    ----------
    boundaries : sequence of Radius
        From the centre to the edge, both included.
    edge_folds : int
        How many e-folds the panels go towards the edge.
    """
    sides = []
    for inner, outer in pairwise(boundaries):
        sides += _halves(inner, outer, edge_folds if outer.from_edge == 0.0 else _FOLDS)
    s = np.concatenate([side.s for side in sides] + [[1.0]])
    d = np.concatenate([side.d for side in sides] + [[0.0]])
    kept = np.concatenate([[True], (np.diff(s) > 0.0) | (np.diff(d) < 0.0)])
    return _Ends(s[kept], d[kept])


class Mesh:
    """Panels with the loads at their nodes, for one quadrature rule.

    Parameters
    ----------
    ends : tuple of ndarray
        What `graded` returns.
    pressure, traction : callable
        The loads at radii and distances from the edge.
    order : int
        Nodes of a panel.
    """

    def __init__(self, ends: _Ends, pressure: Evaluator, traction: Evaluator, order: int) -> None:
        self._ends = ends
        self._loads = pressure, traction
        nodes, weights = np.polynomial.legendre.leggauss(order)
        self._fractions, self._weights = (1.0 + nodes) / 2.0, weights / 2.0
        lengths = np.where(ends.s[:-1] > 0.5, -np.diff(ends.d), np.diff(ends.s))
        self._lengths = np.asarray(lengths)
        step = lengths[:, None] * self._fractions
        back = lengths[:, None] * (1.0 - self._fractions)
        high = ends.s[:-1, None] > 0.5
        self._d = np.where(high, ends.d[1:, None] + back, 1.0 - (ends.s[:-1, None] + step))
        self._s = np.where(high, 1.0 - self._d, ends.s[:-1, None] + step)
        self._pressure = np.asarray(pressure(self._s, self._d))
        self._traction = np.asarray(traction(self._s, self._d))

    def rows(self, points: Points) -> Iterator[tuple[slice, Nodes]]:
        """Yield blocks of points, each with all of its rows of nodes."""
        for start in range(0, len(points.r), _BLOCK):
            block = slice(start, start + _BLOCK)
            some = points[block]
            low, high = self._offsets(some)
            near = self._near(some, low, high)
            yield block, self._whole(some, ~near)
            if near.any():
                yield block, self._cut(some, near, low, high)

    def _offsets(self, points: Points) -> tuple[Array, Array]:
        """Return how far beyond a point's radius the panels begin and end, (points, panels)."""
        r, d, ends = points.r[:, None], points.from_edge[:, None], self._ends
        offset = np.where(ends.s > 0.5, d - ends.d, ends.s - r)
        return offset[:, :-1], offset[:, 1:]

    def _near(self, points: Points, low: Array, high: Array) -> NDArray[np.bool_]:
        gap = np.maximum(np.maximum(low, -high), 0.0)
        return np.asarray(np.hypot(gap, points.z[:, None]) < _NEAR * self._lengths)

    def _whole(self, points: Points, chosen: NDArray[np.bool_]) -> Nodes:
        """Return the rows of panels that are taken whole."""
        owner, panel = np.nonzero(chosen)
        s, d = self._s[panel], self._d[panel]
        r, from_edge = points.r[owner, None], points.from_edge[owner, None]
        ahead = np.where(s > 0.5, d - from_edge, r - s)
        weight = self._lengths[panel, None] * self._weights
        return Nodes(owner, s, ahead, weight, self._pressure[panel], self._traction[panel])

    def _cut(self, points: Points, chosen: NDArray[np.bool_], low: Array, high: Array) -> Nodes:
        """Return the rows of panels that are cut, on either side of the point's radius."""
        unit = 1e-18 * np.maximum(np.minimum(points.to_edge, points.r), 1e-32)
        scale = np.where(points.on_surface, unit, points.z)
        # on the surface a principal value is meant: both sides end at the same small distance
        floor = np.where(points.on_surface, 3.0 * unit, 0.0)
        parts = []
        for sign in (1.0, -1.0):
            first, last = (low, high) if sign > 0.0 else (-high, -low)
            owner, panel = np.nonzero(chosen & (last > floor[:, None]))
            begin = np.maximum(first[owner, panel], floor[owner]) / scale[owner]
            end = last[owner, panel] / scale[owner]
            parts.append(self._pieces(points, sign, owner, scale, np.arcsinh([begin, end])))
        return Nodes(*(np.concatenate(two) for two in zip(*parts, strict=True)))

    def _pieces(
        self,
        points: Points,
        sign: float,
        owner: NDArray[np.intp],
        scale: Array,
        phases: Array,
    ) -> Nodes:
        """Return rows of pieces at most one wide in ``asinh(distance / scale)``."""
        begin, end = phases
        count = np.ceil(end - begin).astype(int)
        count = np.maximum(count, 1)
        width = np.repeat((end - begin) / count, count)
        number = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
        begin = np.repeat(begin, count) + number * width
        owner = np.repeat(owner, count)
        unit = scale[owner, None]
        phase = begin[:, None] + width[:, None] * self._fractions
        away = sign * unit * np.sinh(phase)
        weight = unit * np.cosh(phase) * width[:, None] * self._weights
        s = np.clip(points.r[owner, None] + away, 0.0, 1.0)
        d = np.clip(points.from_edge[owner, None] - away, 0.0, 1.0)
        pressure, traction = (np.asarray(load(s, d)) for load in self._loads)
        return Nodes(owner, s, -away, weight, pressure, traction)
