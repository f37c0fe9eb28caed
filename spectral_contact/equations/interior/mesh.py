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

from spectral_contact.equations.interior.tails import Panelled, Tails
from spectral_contact.fields import Array
from spectral_contact.fields.series import Radius

Evaluator = Callable[[Array, Array], Array]

#: What stands for the axis, where ``u_r / r`` is the limit.
AXIS = 1e-30
#: A panel closer than this many times its length is cut.
_NEAR = 1.0
#: How many e-folds the panels go towards a zone boundary, beyond which radii cannot be told apart.
_FOLDS = 34
#: Depths below are none. Next to an infinite pressure stress varies over the distance from it,
#: which is at least 1e-16, and like a power of it down to -3/2. Fourth powers of depths must not
#: underflow.
_SHALLOWEST = 1e-40
#: Points served at a time, for the memory; on the surface each has many nodes: for the cache.
_BLOCK, _SURFACE_BLOCK = 512, 32


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


#: The rule that is used and the one that it is compared with: for all digits, for 10, and for 8.
TIGHT = Rule(16, 20, 1.0, 2.0), Rule(12, 16, 1.0, 2.0)
MEDIUM = Rule(12, 16, 1.25, 1.75), Rule(10, 14, 1.25, 1.75)
FAST = Rule(10, 14, 1.5, 1.5), Rule(8, 12, 1.5, 1.5)


@dataclass(frozen=True, slots=True)
class BodyPoints:
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

    def beyond(self, place: Radius) -> Array:
        """Return how far outward of a radius they are, exact next to it."""
        outward = place.from_edge - self.from_edge
        return np.asarray(np.where(self.r > 0.5, outward, self.r - place.value))

    @property
    def on_surface(self) -> NDArray[np.bool_]:
        """Whether a point is as good as on the surface, for all loads and at any tip or corner."""
        return np.asarray(self.z <= np.minimum(1e-16 * self.to_edge, _SHALLOWEST))

    def __getitem__(self, which: slice | NDArray[Any]) -> BodyPoints:
        return BodyPoints(self.r[which], self.from_edge[which], self.z[which])


class MeshNodes(NamedTuple):
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
    """Ends of all panels, each as an offset from a boundary, and the runs that shrink.

    Attributes
    ----------
    places : sequence of Radius
        The boundaries, the centre and the edge.
    at : ndarray of int, shape (panels + 1,)
        Which of them an end is counted from.
    offset : ndarray, shape (panels + 1,)
        How far outward of it the end is; next to it this is known to relative accuracy, and the
        radius is not.
    runs : list of Shrinking
    """

    places: Sequence[Radius]
    at: NDArray[np.intp]
    offset: Array
    runs: list[Shrinking]

    def radii(self, at: NDArray[np.intp], offset: Array) -> tuple[Array, Array]:
        """Return what is so far outward of boundaries, from the centre and from the edge."""
        value, from_edge = np.array([[one.value, one.from_edge] for one in self.places]).T
        return value[at] + offset, from_edge[at] - offset

    def outward(self, points: BodyPoints) -> Array:
        """Return how far outward of the boundaries points are, shape (points, boundaries)."""
        return np.stack([points.beyond(place) for place in self.places], axis=1)

    @property
    def lengths(self) -> Array:
        """Lengths of the panels."""
        gaps = np.array([*(_between(*both) for both in pairwise(self.places)), 0.0])
        return np.asarray(np.diff(self.offset) + gaps[self.at[:-1]] * np.diff(self.at))


def _between(inner: Radius, outer: Radius) -> float:
    high = outer.value > 0.5
    return inner.from_edge - outer.from_edge if high else outer.value - inner.value


def _halves(inner: Radius, outer: Radius, below: int, above: int) -> tuple[Array, Array]:
    """Return the ends of the panels of an interval, as offsets from its own two ends.

    They are graded to these by so many e-folds; what is in the middle is counted from the outer.
    """
    middle = float(np.sqrt((inner.square + outer.square) / 2.0))
    rest = (inner.rest + outer.rest) / 2.0 / (1.0 + middle)
    reach = rest - outer.from_edge if outer.value > 0.5 else outer.value - middle
    last = -reach * np.exp(-np.arange(float(above + 1)))
    reach = _between(inner, outer) - reach  # the two are all of it
    first = np.array([0.5]) if below == 0 else np.exp(np.arange(-float(below), 0.0))
    return np.concatenate([[0.0], reach * first]), last


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
    places = list(boundaries[:1])
    places += [outer for inner, outer in pairwise(boundaries) if _between(inner, outer) > 0.0]
    offsets, at, runs, count = [], [], [], 0
    for k, (inner, outer) in enumerate(pairwise(places)):
        below = centre_folds if inner.value == 0.0 else _FOLDS
        above = edge_folds if outer.from_edge == 0.0 else _FOLDS
        for side, steps in enumerate(_halves(inner, outer, below, above)):
            stop = count + len(steps)
            if side == 1 or below > 0:
                runs.append(Shrinking(count, stop, outward=side == 1))
            offsets.append(steps)
            at.append(np.full(len(steps), k + side))
            count = stop
    ends = [*offsets, np.zeros(1)], [*at, np.array([len(places) - 1])]
    return Grading(places, np.concatenate(ends[1]), np.concatenate(ends[0]), runs)


class BodyMesh:
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
        self._lengths = ends.lengths
        gauss = [np.polynomial.legendre.leggauss(rule.panel) for rule in rules]
        self._fractions = np.concatenate([(1.0 + nodes) / 2.0 for nodes, _ in gauss])
        self._weights = np.concatenate([weights / 2.0 for _, weights in gauss])
        lengths = self._lengths[:, None]
        self._own = ends.at[:-1]
        self._away = ends.offset[:-1, None] + lengths * self._fractions
        self._s, self._d = ends.radii(self._own[:, None], self._away)
        self._rings = self._measured(self._s, self._d, lengths * self._weights)
        self._panel, self._tailed = [one.panel for one in rules], [one.tail for one in rules]
        self._tails = [self._tails_of(run) for run in ends.runs]

    def _tails_of(self, run: Shrinking) -> Tails:
        own = slice(run.start, run.stop)
        begin = self._ends.offset[own]
        far = -begin if run.outward else begin + self._lengths[own]
        cuts = np.cumsum(self._panel)[:-1]
        nodes = np.abs(self._away[own]), self._rings[:, own]
        split = zip(self._tailed, *(np.split(one, cuts, axis=-1) for one in nodes), strict=True)
        rules = [Panelled(*one) for one in split]
        return Tails(far, run.outward, rules)

    def _measured(self, s: Array, d: Array, weight: Array) -> Array:
        """Return what rings carry of pressure and of traction, and their areas, stacked."""
        area = s * weight
        return np.asarray([*(np.asarray(load(s, d)) * area for load in self._loads), area])

    @property
    def rules(self) -> int:
        """How many rules there are."""
        return len(self._panel)

    @property
    def surface(self) -> tuple[BodyPoints, Array]:
        """All nodes, as points of the surface, and what their rings carry, (3, nodes)."""
        s, d = self._s.ravel(), self._d.ravel()
        return BodyPoints(s, d, np.zeros_like(s)), self._rings.reshape(3, -1)

    def carried(self) -> Array:
        """Return what all rings within each node carry of pressure, ``int_0^s p s ds``."""
        shares = self._fractions[:, None] * self._fractions
        lengths = self._lengths[:, None, None]
        away = self._ends.offset[:-1, None, None] + lengths * shares
        s, d = self._ends.radii(self._own[:, None, None], away)
        weights = lengths * self._fractions[:, None] * self._weights
        own = self._measured(s, d, weights)[0].sum(axis=2)
        before = np.cumsum(self._rings[0].sum(axis=1)) - self._rings[0].sum(axis=1)
        return np.asarray((before[:, None] + own).ravel())

    def rows(self, points: BodyPoints) -> Iterator[tuple[slice, list[MeshNodes]]]:
        """Yield blocks of points, each with all of its rows of nodes, of several lengths."""
        shallow = np.all(points.z <= 1e-16 * points.to_edge)
        size = _SURFACE_BLOCK if shallow else _BLOCK
        for start in range(0, len(points.r), size):
            some = points[block := slice(start, start + size)]
            outward = self._ends.outward(some)
            ends = self._ends.offset - outward[:, self._ends.at]  # beyond the point's radius
            low, high = ends[:, :-1], ends[:, 1:]
            apart = np.hypot(np.maximum(np.maximum(low, -high), 0.0), some.z[:, None])
            left = np.ones(apart.shape, dtype=bool)
            tails = [self._tail(outward, some.z, at, left) for at in range(len(self._tails))]
            near = left & (apart < _NEAR * self._lengths)
            rows = [*tails, self._whole(outward, left & ~near)]
            if near.any():
                rows.append(self._cut(some, near, low, high))
            yield block, rows

    def _tail(self, outward: Array, z: Array, at: int, left: NDArray[np.bool_]) -> MeshNodes:
        """Return the rows of tails of a run, and strike the panels that they stand for."""
        run, tails = self._ends.runs[at], self._tails[at]
        place = self._ends.at[run.start]
        beyond = outward[:, place]
        far = tails.distance(beyond, z) >= self._rule.apart * tails.lengths
        owner = np.nonzero(far.any(axis=1))[0]
        longest = far.argmax(axis=1)[owner]
        covered = np.zeros((len(z), run.stop - run.start), dtype=bool)
        covered[owner] = np.arange(run.stop - run.start) >= longest[:, None]
        left[:, run.start : run.stop] = ~(covered if run.outward else covered[:, ::-1])
        away = tails.away[longest]
        s, _ = self._ends.radii(place, away)
        return MeshNodes(
            self._tailed, owner, s, beyond[owner, None] - away, *tails.rings[:, longest]
        )

    def _whole(self, outward: Array, chosen: NDArray[np.bool_]) -> MeshNodes:
        owner, panel = np.nonzero(chosen)
        ahead = outward[owner, self._own[panel], None] - self._away[panel]
        return MeshNodes(self._panel, owner, self._s[panel], ahead, *self._rings[:, panel])

    def _cut(
        self, points: BodyPoints, chosen: NDArray[np.bool_], low: Array, high: Array
    ) -> MeshNodes:
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
        self, points: BodyPoints, sign: Array, owner: NDArray[np.intp], scale: Array, phases: Array
    ) -> MeshNodes:
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
        return MeshNodes(self._panel, owner, s, -away, *self._measured(s, d, weight))
