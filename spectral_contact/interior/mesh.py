"""Panels over the radius of the contact, graded to its edge and to every zone boundary.

Where a point of the body is close to a panel, the panel is cut into pieces that are equal in
``asinh(distance / depth)``, in which the load of a ring is smooth. Where it is far from all panels
next to a boundary, one tail stands for them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from spectral_contact.fields.series import Radius
from spectral_contact.interior.tails import Panelled, Tails

__all__ = [
    "AXIS",
    "FAST",
    "TIGHT",
    "Evaluator",
    "Grading",
    "Mesh",
    "Nodes",
    "Points",
    "Rule",
    "Shrinking",
    "graded",
]

Array = NDArray[np.float64]
Evaluator = Callable[[Array, Array], Array]

#: What stands for the axis, where ``u_r / r`` is the limit.
AXIS = 1e-30
#: A panel closer than this many times its length is cut.
_NEAR = 1.0
#: How many e-folds the panels go towards a zone boundary, beyond which radii cannot be told apart.
_FOLDS = 34
#: Points that are served at a time, which bounds the memory.
_BLOCK = 512


class Rule(NamedTuple):
    """How finely loads are integrated.

    Attributes
    ----------
    panel, tail : int
        Nodes of a panel and of a tail.
    width : float
        Largest length of a piece of a panel that is cut.
    apart : float
        A tail stands for its panels at points that are this many times its length away.
    """

    panel: int
    tail: int
    width: float
    apart: float


#: The rule that is used and the one that it is compared with: for all digits, and for 8.
TIGHT = Rule(16, 20, 1.0, 2.0), Rule(12, 16, 1.0, 2.0)
FAST = Rule(10, 14, 1.5, 1.5), Rule(8, 12, 1.5, 1.5)


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
    """Rows of nodes, each row on one panel for one point; arrays but `owner` are (rows, nodes).

    Attributes
    ----------
    counts : list of int
        Nodes of each rule, which are side by side in a row.
    owner : ndarray of int, shape (rows,)
        Which point a row is for.
    s, ahead : ndarray
        Radius of the ring, and radius of the point minus it.
    pressure, traction, area : ndarray
        The loads of the rings: ``p s ds`` and ``q s ds``, and their ``s ds``.
    """

    counts: list[int]
    owner: NDArray[np.intp]
    s: Array
    ahead: Array
    pressure: Array
    traction: Array
    area: Array


class Shrinking(NamedTuple):
    """Panels from `start` to before `stop` that shrink towards one end of theirs."""

    start: int
    stop: int
    outward: bool


class Grading(NamedTuple):
    """Ends of all panels, from the centre and from the edge, and the runs that shrink."""

    s: Array
    d: Array
    runs: list[Shrinking]


def _halves(inner: Radius, outer: Radius, below: int, above: int) -> list[Grading]:
    """Return the ends of the panels of an interval, graded to its ends by so many e-folds."""
    square = (inner.square + outer.square) / 2.0
    middle = float(np.sqrt(square))
    rest = (inner.rest + outer.rest) / 2.0 / (1.0 + middle)
    sides = []
    if below == 0:
        s = middle * np.array([0.0, 0.5])
        sides.append(Grading(s, 1.0 - s, []))
    else:
        reach = (square - inner.square) / (middle + inner.value)
        if inner.value > 0.5:
            reach = inner.from_edge - rest
        steps = np.concatenate([[0.0], reach * np.exp(np.arange(-float(below), 0.0))])
        run = Shrinking(0, len(steps), outward=False)
        sides.append(Grading(inner.value + steps, inner.from_edge - steps, [run]))
    reach = rest - outer.from_edge if outer.value > 0.5 else outer.value - middle
    steps = reach * np.exp(-np.arange(float(above + 1)))
    run = Shrinking(0, len(steps), outward=True)
    sides.append(Grading(outer.value - steps, outer.from_edge + steps, [run]))
    return sides


def graded(boundaries: Sequence[Radius], edge_folds: int, centre_folds: int = 0) -> Grading:
    """Return the ends of all panels from the centre to the edge.

    Parameters
    ----------
    boundaries : sequence of Radius
        From the centre to the edge, both included.
    edge_folds : int
        How many e-folds the panels go towards the edge.
    centre_folds : int
        The same towards the centre; 0 where the loads are smooth.
    """
    sides: list[Grading] = []
    for inner, outer in pairwise(boundaries):
        below = centre_folds if inner.value == 0.0 else _FOLDS
        sides += _halves(inner, outer, below, edge_folds if outer.from_edge == 0.0 else _FOLDS)
    s = np.concatenate([side.s for side in sides] + [[1.0]])
    d = np.concatenate([side.d for side in sides] + [[0.0]])
    kept = np.concatenate([[True], (np.diff(s) > 0.0) | (np.diff(d) < 0.0)])
    number = np.concatenate([[0], np.cumsum(kept)])  # of the ends that are kept before each
    runs, first = [], 0
    for side in sides:
        for run in side.runs:
            start, stop = number[first + run.start], number[first + run.stop + 1] - 1
            runs.append(Shrinking(int(start), int(stop), run.outward))
        first += len(side.s)
    return Grading(s[kept], d[kept], runs)


class Mesh:
    """Panels with the loads at their nodes, those of all rules side by side.

    Parameters
    ----------
    ends : Grading
        What `graded` returns.
    pressure, traction : callable
        The loads at radii and distances from the edge.
    rules : sequence of Rule
        Which differ in their nodes alone.
    """

    def __init__(
        self, ends: Grading, pressure: Evaluator, traction: Evaluator, rules: Sequence[Rule]
    ) -> None:
        self._ends, self._rule = ends, rules[0]
        self._loads = pressure, traction
        lengths = np.where(ends.s[:-1] > 0.5, -np.diff(ends.d), np.diff(ends.s))
        self._lengths = np.asarray(lengths)
        gauss = [np.polynomial.legendre.leggauss(rule.panel) for rule in rules]
        self._fractions = np.concatenate([(1.0 + nodes) / 2.0 for nodes, _ in gauss])
        self._weights = np.concatenate([weights / 2.0 for _, weights in gauss])
        step = lengths[:, None] * self._fractions
        back = lengths[:, None] * (1.0 - self._fractions)
        high = ends.s[:-1, None] > 0.5
        self._d = np.where(high, ends.d[1:, None] + back, 1.0 - (ends.s[:-1, None] + step))
        self._s = np.where(high, 1.0 - self._d, ends.s[:-1, None] + step)
        self._rings = self._measured(self._s, self._d, lengths[:, None] * self._weights)
        self._panel, self._tailed = [one.panel for one in rules], [one.tail for one in rules]
        self._tails = [self._tails_of(run) for run in ends.runs]

    def _tails_of(self, run: Shrinking) -> Tails:
        own, ends = slice(run.start, run.stop), slice(run.start, run.stop + 1)
        cuts = np.cumsum(self._panel)[:-1]
        nodes = self._s[own], self._d[own], self._rings[:, own]
        split = zip(self._tailed, *(np.split(one, cuts, axis=-1) for one in nodes), strict=True)
        rules = [Panelled(*one) for one in split]
        return Tails(self._ends.s[ends], self._ends.d[ends], run.outward, rules)

    def _measured(self, s: Array, d: Array, weight: Array) -> Array:
        """Return what rings carry of pressure and of traction, and their areas, stacked."""
        area = s * weight
        return np.asarray([*(np.asarray(load(s, d)) * area for load in self._loads), area])

    @property
    def rules(self) -> int:
        """How many rules there are."""
        return len(self._panel)

    @property
    def surface(self) -> tuple[Points, Array]:
        """All nodes, as points of the surface, and what their rings carry, (3, nodes)."""
        s, d = self._s.ravel(), self._d.ravel()
        return Points(s, d, np.zeros_like(s)), self._rings.reshape(3, -1)

    def carried(self) -> Array:
        """Return what all rings within each node carry of pressure, ``int_0^s p s ds``."""
        shares = self._fractions[:, None] * self._fractions
        lengths = self._lengths[:, None, None]
        d = self._ends.d[:-1, None, None] - lengths * shares
        s = self._ends.s[:-1, None, None] + lengths * shares
        weights = lengths * self._fractions[:, None] * self._weights
        own = self._measured(s, d, weights)[0].sum(axis=2)
        before = np.cumsum(self._rings[0].sum(axis=1)) - self._rings[0].sum(axis=1)
        return np.asarray((before[:, None] + own).ravel())

    def rows(self, points: Points) -> Iterator[tuple[slice, list[Nodes]]]:
        """Yield blocks of points, each with all of its rows of nodes, of several lengths."""
        for start in range(0, len(points.r), _BLOCK):
            block = slice(start, start + _BLOCK)
            some = points[block]
            low, high = self._offsets(some)
            apart = np.hypot(np.maximum(np.maximum(low, -high), 0.0), some.z[:, None])
            left = np.ones(apart.shape, dtype=bool)
            tails = [self._tail(some, at, left) for at in range(len(self._tails))]
            near = left & (apart < _NEAR * self._lengths)
            rows = [*tails, self._whole(some, left & ~near)]
            if near.any():
                rows.append(self._cut(some, near, low, high))
            yield block, rows

    def _tail(self, points: Points, at: int, left: NDArray[np.bool_]) -> Nodes:
        """Return the rows of tails of a run, and strike the panels that they stand for."""
        run, tails = self._ends.runs[at], self._tails[at]
        apart = tails.distance(points.r, points.from_edge, points.z)
        far = apart >= self._rule.apart * tails.lengths
        owner = np.nonzero(far.any(axis=1))[0]
        longest = far.argmax(axis=1)[owner]
        covered = np.zeros((len(points.r), run.stop - run.start), dtype=bool)
        covered[owner] = np.arange(run.stop - run.start) >= longest[:, None]
        left[:, run.start : run.stop] = ~(covered if run.outward else covered[:, ::-1])
        s, d = tails.s[longest], tails.d[longest]
        ahead = _ahead(points, owner, s, d)
        return Nodes(self._tailed, owner, s, ahead, *tails.rings[:, longest])

    def _offsets(self, points: Points) -> tuple[Array, Array]:
        """Return how far beyond a point's radius the panels begin and end, (points, panels)."""
        r, d, ends = points.r[:, None], points.from_edge[:, None], self._ends
        offset = np.where(ends.s > 0.5, d - ends.d, ends.s - r)
        return offset[:, :-1], offset[:, 1:]

    def _whole(self, points: Points, chosen: NDArray[np.bool_]) -> Nodes:
        """Return the rows of panels that are taken whole."""
        owner, panel = np.nonzero(chosen)
        s, d = self._s[panel], self._d[panel]
        ahead = _ahead(points, owner, s, d)
        return Nodes(self._panel, owner, s, ahead, *self._rings[:, panel])

    def _cut(self, points: Points, chosen: NDArray[np.bool_], low: Array, high: Array) -> Nodes:
        """Return the rows of panels that are cut, on either side of the point's radius."""
        unit = 1e-18 * np.maximum(np.minimum(points.to_edge, points.r), 1e-32)
        scale = np.where(points.on_surface, unit, points.z)
        # on the surface a principal value is meant: both sides end at the same small distance
        floor = np.where(points.on_surface, 3.0 * unit, 0.0)
        pairs = []
        for first, last in ((low, high), (-high, -low)):
            owner, panel = np.nonzero(chosen & (last > floor[:, None]))
            begin = np.maximum(first[owner, panel], floor[owner]) / scale[owner]
            pairs.append((owner, begin, last[owner, panel] / scale[owner]))
        owner, begin, end = (np.concatenate(both) for both in zip(*pairs, strict=True))
        sign = np.repeat([1.0, -1.0], [len(one[0]) for one in pairs])
        return self._pieces(points, sign, owner, scale, np.arcsinh([begin, end]))

    def _pieces(
        self,
        points: Points,
        sign: Array,
        owner: NDArray[np.intp],
        scale: Array,
        phases: Array,
    ) -> Nodes:
        """Return rows of pieces of about one width in ``asinh(distance / scale)``."""
        begin, end = phases
        count = np.ceil((end - begin) / self._rule.width).astype(int)
        count = np.maximum(count, 1)
        width = np.repeat((end - begin) / count, count)
        number = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
        begin = np.repeat(begin, count) + number * width
        unit, owner = np.repeat(sign * scale[owner], count)[:, None], np.repeat(owner, count)
        phase = begin[:, None] + width[:, None] * self._fractions
        away = unit * np.sinh(phase)
        weight = np.abs(unit) * np.cosh(phase) * width[:, None] * self._weights
        s = np.clip(points.r[owner, None] + away, 0.0, 1.0)
        d = np.clip(points.from_edge[owner, None] - away, 0.0, 1.0)
        return Nodes(self._panel, owner, s, -away, *self._measured(s, d, weight))


def _ahead(points: Points, owner: NDArray[np.intp], s: Array, d: Array) -> Array:
    """Return the radii of the points that own rows, minus those of the nodes."""
    r, from_edge = points.r[owner, None], points.from_edge[owner, None]
    return np.asarray(np.where(s > 0.5, d - from_edge, r - s))
