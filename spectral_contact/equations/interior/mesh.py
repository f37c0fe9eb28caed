"""Panels over the radius of the contact, graded to its edge and to every zone boundary.

Where a point of the body is close to a panel, the panel is cut into pieces that are equally long in
``asinh(distance / depth)``, of which the field of a ring is a smooth function. Where the point is
far from all panels next to a boundary, a *tail* of a few rings replaces them (`tails`).

So every point has rings of its own. They are returned as rows: a row has the nodes of one panel,
piece or tail for one point.
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

#: Radius of points on the axis, at which ``u_r / r`` is the limit.
AXIS = 1e-30
#: A panel is cut if the point is closer to it than this many times its length (chosen).
_NEAR = 1.0
#: E-folds of the panels towards a zone boundary, down to 2e-15 of the first: closer, doubles do not
#: resolve radii.
_FOLDS = 34
#: A depth counts as none if it is below this and 1e-16 of the distance from the edge: fourth powers
#: of depths must not underflow. Nothing is lost by that, as stress varies over the distance from an
#: infinite pressure, which is at least 1e-16.
_SHALLOWEST = 1e-40
#: Number of points that are evaluated together, which bounds the memory.
_BLOCK = 512
#: The same on the surface, where each point has many nodes, which are to stay in the cache.
_SURFACE_BLOCK = 32


class Rule(NamedTuple):
    """Fineness of the quadrature.

    Attributes
    ----------
    panel, tail : int
        Nodes of a panel and of a tail.
    width : float
        Largest length of a piece of a panel that is cut, in ``asinh(distance / depth)``.
    apart : float
        A tail replaces its panels for points that are at least this many lengths of it away.
    """

    panel: int
    tail: int
    width: float
    apart: float


#: The rule that is used, and the one that it is compared with: for all digits, for tolerances of
#: 1e-11 and more, and for those of 1e-9 and more (`sampling`).
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
        """Return the distances of points outward from a radius, accurate to rounding next to it."""
        outward = place.from_edge - self.from_edge
        return np.asarray(np.where(self.r > 0.5, outward, self.r - place.value))

    @property
    def on_surface(self) -> NDArray[np.bool_]:
        """Whether depths are so small that the points count as on the surface (`_SHALLOWEST`)."""
        return np.asarray(self.z <= np.minimum(1e-16 * self.to_edge, _SHALLOWEST))

    def __getitem__(self, which: slice | NDArray[Any]) -> BodyPoints:
        return BodyPoints(self.r[which], self.from_edge[which], self.z[which])


class MeshNodes(NamedTuple):
    """Rows of nodes, each row on one panel, piece or tail for one point.

    Attributes
    ----------
    counts : list of int
        Nodes of each rule, which are side by side in a row.
    owner : ndarray of int, shape (rows,)
        Index of the point that a row is for.
    s, ahead : ndarray, shape (rows, nodes)
        Radius of the ring, and radius of the point minus that of the ring.
    pressure, traction, area : ndarray, shape (rows, nodes)
        The loads of the rings, ``p s ds`` and ``q s ds``, and ``s ds``.
    """

    counts: list[int]
    owner: NDArray[np.intp]
    s: Array
    ahead: Array
    pressure: Array
    traction: Array
    area: Array


class Shrinking(NamedTuple):
    """A run of panels, from `start` to before `stop`, that shrink outward or inward."""

    start: int
    stop: int
    outward: bool


class Grading(NamedTuple):
    """Ends of all panels, each as an offset from a boundary, and the runs that shrink.

    Attributes
    ----------
    places : sequence of Radius
        The boundaries, with the centre and the edge.
    at : ndarray of int, shape (panels + 1,)
        Index of the boundary that an end is counted from.
    offset : ndarray, shape (panels + 1,)
        How far outward of it the end is. Next to the boundary this has all of its digits, while the
        difference of two radii would have few.
    runs : list of Shrinking
    """

    places: Sequence[Radius]
    at: NDArray[np.intp]
    offset: Array
    runs: list[Shrinking]

    def radii(self, at: NDArray[np.intp], offset: Array) -> tuple[Array, Array]:
        """Return radii at offsets outward from boundaries, and their distances from the edge."""
        value, from_edge = np.array([[place.value, place.from_edge] for place in self.places]).T
        return value[at] + offset, from_edge[at] - offset

    def outward(self, points: BodyPoints) -> Array:
        """Return how far outward of the boundaries points are, shape (points, boundaries)."""
        return np.stack([points.beyond(place) for place in self.places], axis=1)

    @property
    def lengths(self) -> Array:
        """Lengths of the panels."""
        # if the ends of a panel are counted from two boundaries, the distance of these is added
        gaps = np.array([*(between(*both) for both in pairwise(self.places)), 0.0])
        return np.asarray(np.diff(self.offset) + gaps[self.at[:-1]] * np.diff(self.at))


def between(inner: Radius, outer: Radius) -> float:
    """Return the distance of two radii, accurate to rounding also next to the edge."""
    high = outer.value > 0.5
    return inner.from_edge - outer.from_edge if high else outer.value - inner.value


def _halves(inner: Radius, outer: Radius, below: int, above: int) -> tuple[Array, Array]:
    """Return the ends of the panels of an interval between two boundaries.

    Parameters
    ----------
    inner, outer : Radius
        The interval, which is halved by area.
    below, above : int
        E-folds of the grading towards the inner and towards the outer boundary.

    Returns
    -------
    tuple of ndarray
        Ends in the inner half, as offsets from the inner boundary, and ends in the outer half with
        the middle, as offsets from the outer boundary.
    """
    middle = float(np.sqrt((inner.square + outer.square) / 2.0))
    middle_from_edge = (inner.rest + outer.rest) / 2.0 / (1.0 + middle)
    high = outer.value > 0.5
    outer_half = middle_from_edge - outer.from_edge if high else outer.value - middle
    in_outer_half = -outer_half * np.exp(-np.arange(float(above + 1)))
    inner_half = between(inner, outer) - outer_half
    # without grading two panels of one length
    fractions = np.array([0.5]) if below == 0 else np.exp(np.arange(-float(below), 0.0))
    return np.concatenate([[0.0], inner_half * fractions]), in_outer_half


def graded(boundaries: Sequence[Radius], edge_folds: int, centre_folds: int = 0) -> Grading:
    """Return the ends of all panels from the centre to the edge.

    Parameters
    ----------
    boundaries : sequence of Radius
        From the centre to the edge, both included; none coincide.
    edge_folds : int
        How many e-folds the panels go towards the edge.
    centre_folds : int
        The same towards the centre; 0 where the loads are smooth.
    """
    offsets = []
    at = []
    runs = []
    count = 0
    for k, (inner, outer) in enumerate(pairwise(boundaries)):
        below = centre_folds if inner.value == 0.0 else _FOLDS
        above = edge_folds if outer.from_edge == 0.0 else _FOLDS
        for side, steps in enumerate(_halves(inner, outer, below, above)):
            stop = count + len(steps)
            if side == 1 or below > 0:
                runs.append(Shrinking(count, stop, outward=side == 1))
            offsets.append(steps)
            at.append(np.full(len(steps), k + side))
            count = stop
    # the last end is the edge
    offsets.append(np.zeros(1))
    at.append(np.array([len(boundaries) - 1]))
    return Grading(boundaries, np.concatenate(at), np.concatenate(offsets), runs)


class BodyMesh:
    """Panels with the loads at their nodes, those of all rules side by side.

    Parameters
    ----------
    ends : Grading
        What `graded` returns.
    pressure, traction : callable
        The loads at radii and distances from the edge.
    rules : sequence of Rule
        They differ only in their numbers of nodes.
    """

    def __init__(
        self, ends: Grading, pressure: Evaluator, traction: Evaluator, rules: Sequence[Rule]
    ) -> None:
        self._ends = ends
        self._rule = rules[0]
        self._loads = pressure, traction
        self._lengths = ends.lengths
        gauss = [np.polynomial.legendre.leggauss(rule.panel) for rule in rules]
        self._fractions = np.concatenate([(1.0 + nodes) / 2.0 for nodes, _ in gauss])
        self._weights = np.concatenate([weights / 2.0 for _, weights in gauss])
        lengths = self._lengths[:, None]
        # the boundary from which the places of a panel are counted, and the offsets of its nodes
        self._boundary = ends.at[:-1]
        self._offsets = ends.offset[:-1, None] + lengths * self._fractions
        self._s, self._d = ends.radii(self._boundary[:, None], self._offsets)
        self._rings = self._loads_of(self._s, self._d, lengths * self._weights)
        # numbers of nodes of each rule
        self._panel_nodes = [rule.panel for rule in rules]
        self._tail_nodes = [rule.tail for rule in rules]
        self._tails = [self._tails_of(run) for run in ends.runs]

    def _tails_of(self, run: Shrinking) -> Tails:
        """Return the tails of a run of panels."""
        panels = slice(run.start, run.stop)
        begin = self._ends.offset[panels]
        lengths = -begin if run.outward else begin + self._lengths[panels]
        next_rules = np.cumsum(self._panel_nodes)[:-1]
        distances = np.split(np.abs(self._offsets[panels]), next_rules, axis=-1)
        rings = np.split(self._rings[:, panels], next_rules, axis=-1)
        of_rules = zip(self._tail_nodes, distances, rings, strict=True)
        return Tails(lengths, run.outward, [Panelled(*of_rule) for of_rule in of_rules])

    def _loads_of(self, s: Array, d: Array, weight: Array) -> Array:
        """Return the loads of rings, ``p s ds`` and ``q s ds``, and their ``s ds``, stacked."""
        area = s * weight
        return np.asarray([*(np.asarray(load(s, d)) * area for load in self._loads), area])

    @property
    def rules(self) -> int:
        """Number of rules."""
        return len(self._panel_nodes)

    @property
    def surface(self) -> tuple[BodyPoints, Array]:
        """All nodes of the panels, as points of the surface, and their loads, (3, nodes)."""
        s = self._s.ravel()
        d = self._d.ravel()
        return BodyPoints(s, d, np.zeros_like(s)), self._rings.reshape(3, -1)

    def carried(self) -> Array:
        """Return the load of the pressure within each node, ``int_0^s p s ds``.

        It is the sum over all panels before that of the node, and the integral from the beginning
        of the panel to the node by the same rule.
        """
        fractions = self._fractions[:, None] * self._fractions
        lengths = self._lengths[:, None, None]
        offsets = self._ends.offset[:-1, None, None] + lengths * fractions
        s, d = self._ends.radii(self._boundary[:, None, None], offsets)
        weights = lengths * self._fractions[:, None] * self._weights
        on_panel = self._loads_of(s, d, weights)[0].sum(axis=2)
        before = np.cumsum(self._rings[0].sum(axis=1)) - self._rings[0].sum(axis=1)
        return np.asarray((before[:, None] + on_panel).ravel())

    def rows(self, points: BodyPoints) -> Iterator[tuple[slice, list[MeshNodes]]]:
        """Yield blocks of points as slices, each with all of its rows of nodes."""
        shallow = np.all(points.z <= 1e-16 * points.to_edge)
        size = _SURFACE_BLOCK if shallow else _BLOCK
        for start in range(0, len(points.r), size):
            block = slice(start, start + size)
            block_points = points[block]
            outward = self._ends.outward(block_points)
            # ends of the panels, counted outward from the radius of each point
            ends = self._ends.offset - outward[:, self._ends.at]
            low = ends[:, :-1]
            high = ends[:, 1:]
            in_radius = np.maximum(np.maximum(low, -high), 0.0)
            distance = np.hypot(in_radius, block_points.z[:, None])
            not_replaced = np.ones(distance.shape, dtype=bool)  # panels that no tail replaces
            rows = [
                self._tail_rows(outward, block_points.z, run, not_replaced)
                for run in range(len(self._tails))
            ]
            near = not_replaced & (distance < _NEAR * self._lengths)
            rows.append(self._panel_rows(outward, not_replaced & ~near))
            if near.any():
                rows.append(self._cut_rows(block_points, near, low, high))
            yield block, rows

    def _tail_rows(
        self, outward: Array, z: Array, index: int, not_replaced: NDArray[np.bool_]
    ) -> MeshNodes:
        """Return the rows of the tails of a run.

        The panels that they replace are set to false in `not_replaced`.

        Each point has the longest tail from which it is far enough away, if any.
        """
        run = self._ends.runs[index]
        tails = self._tails[index]
        place = self._ends.at[run.start]
        beyond = outward[:, place]
        far = tails.distance(beyond, z) >= self._rule.apart * tails.lengths
        owner = np.nonzero(far.any(axis=1))[0]
        longest = far.argmax(axis=1)[owner]
        replaced = np.zeros((len(z), run.stop - run.start), dtype=bool)
        replaced[owner] = np.arange(run.stop - run.start) >= longest[:, None]
        not_replaced[:, run.start : run.stop] = ~(replaced if run.outward else replaced[:, ::-1])
        offsets = tails.offsets[longest]
        s, _ = self._ends.radii(place, offsets)
        ahead = beyond[owner, None] - offsets
        return MeshNodes(self._tail_nodes, owner, s, ahead, *tails.rings[:, longest])

    def _panel_rows(self, outward: Array, chosen: NDArray[np.bool_]) -> MeshNodes:
        """Return the rows of whole panels, chosen for each point."""
        owner, panel = np.nonzero(chosen)
        ahead = outward[owner, self._boundary[panel], None] - self._offsets[panel]
        return MeshNodes(self._panel_nodes, owner, self._s[panel], ahead, *self._rings[:, panel])

    def _cut_rows(
        self, points: BodyPoints, chosen: NDArray[np.bool_], low: Array, high: Array
    ) -> MeshNodes:
        """Return the rows of panels that are cut, on either side of the point's radius."""
        unit = 1e-18 * np.maximum(np.minimum(points.to_edge, points.r), 1e-32)
        scale = np.where(points.on_surface, unit, points.z)
        # on the surface it is a principal value: the pieces on both sides end equally close to it
        least = np.where(points.on_surface, 3.0 * unit, 0.0)
        sides = []
        for first, last in ((low, high), (-high, -low)):  # outward of the point, and inward
            owner, panel = np.nonzero(chosen & (last > least[:, None]))
            begin = np.maximum(first[owner, panel], least[owner]) / scale[owner]
            sides.append((owner, begin, last[owner, panel] / scale[owner]))
        owner, begin, end = (np.concatenate(both) for both in zip(*sides, strict=True))
        sign = np.repeat([1.0, -1.0], [len(side[0]) for side in sides])
        return self._pieces(points, sign, owner, scale, np.arcsinh([begin, end]))

    def _pieces(
        self, points: BodyPoints, sign: Array, owner: NDArray[np.intp], scale: Array, phases: Array
    ) -> MeshNodes:
        """Return the rows of pieces that are about equally long in ``asinh(distance / scale)``.

        Parameters
        ----------
        points : BodyPoints
        sign : ndarray, shape (panels,)
            1 for a panel outward of its point, -1 for one inward.
        owner : ndarray of int, shape (panels,)
            Index of the point of each panel.
        scale : ndarray, shape (points,)
        phases : ndarray, shape (2, panels)
            Begin and end of each panel, in ``asinh(distance / scale)``.
        """
        begin, end = phases
        count = np.ceil((end - begin) / self._rule.width).astype(int)
        count = np.maximum(count, 1)
        # from here on a number for each piece
        width = np.repeat((end - begin) / count, count)
        number = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
        begin = np.repeat(begin, count) + number * width
        unit = np.repeat(sign * scale[owner], count)[:, None]
        owner = np.repeat(owner, count)
        phase = begin[:, None] + width[:, None] * self._fractions
        outward = unit * np.sinh(phase)
        weight = np.abs(unit) * np.cosh(phase) * width[:, None] * self._weights
        s = np.clip(points.r[owner, None] + outward, 0.0, 1.0)
        d = np.clip(points.from_edge[owner, None] - outward, 0.0, 1.0)
        return MeshNodes(self._panel_nodes, owner, s, -outward, *self._loads_of(s, d, weight))
