r"""Spaces for a pressure on a disk in several parts: panels graded to the breaks of a profile.

A part is a disk, or one half of an annulus, with panels in the logarithm of the distance to one of
its ends (`Family`); the centre is such an end where a punch has a tip. Half-integrals between parts
are those of `blocks`. A disk in one part is `galerkin`'s own space.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from itertools import pairwise
from math import pi
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag

from spectral_contact.fields.series import (
    CENTRE,
    EDGE,
    AnnulusSeries,
    DiskSeries,
    LogSeries,
    PressureField,
    Radius,
    ZonalField,
    ZonePiece,
)
from spectral_contact.spectral.annulus import Family, gap
from spectral_contact.spectral.blocks import block
from spectral_contact.spectral.cache import BoundedCache
from spectral_contact.spectral.galerkin import disk_operators
from spectral_contact.spectral.graded import graded_nodes
from spectral_contact.spectral.panels import LogPanels
from spectral_contact.spectral.regularised import Factorable, Regularised
from spectral_contact.threads import cached_property

__all__ = ["DiskSpace", "NodalSpace", "PartedSpace", "Parts", "PressureSpace", "pressure_space"]

Array = NDArray[np.float64]
Used = tuple[LogPanels, tuple[int, ...]]

_SPACES: BoundedCache[tuple[Parts, tuple[Used, ...]], PressureSpace] = BoundedCache(
    "spaces in parts", 8
)


class Parts:
    """How a disk is cut: radii of the breaks, and whether panels are graded to the centre, too.

    Parameters
    ----------
    breaks : tuple of Radius
        From the centre outward.
    pointed : bool
    turns : tuple of Radius
        Those of the breaks at which the profile itself is smooth.
    """

    def __init__(
        self, breaks: tuple[Radius, ...], pointed: bool, turns: tuple[Radius, ...] = ()
    ) -> None:
        self.breaks, self.pointed, self.turns = breaks, pointed, turns
        bounds = (CENTRE, *breaks, EDGE)
        #: boundary, side of it that the part is on, and extent in s**2, of every part
        self.ends: list[tuple[Radius, int, float]] = []
        #: the last break of the profile before every part, or the centre
        self.inner: list[Radius] = []
        last = CENTRE
        for inner, outer in pairwise(bounds):
            halves = [(outer, -1)] if inner is CENTRE and not pointed else [(inner, 1), (outer, -1)]
            extent = gap(inner, outer) / len(halves)
            self.ends += [(boundary, sign, extent) for boundary, sign in halves]
            last = last if inner in turns else inner
            self.inner += [last] * len(halves)

    def __hash__(self) -> int:
        return hash((self.breaks, self.pointed, self.turns))

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Parts):
            return NotImplemented
        own = self.breaks, self.pointed, self.turns
        return own == (other.breaks, other.pointed, other.turns)

    def field(self, series: Sequence[LogSeries]) -> PressureField | ZonalField:
        """Return the pressure with these series on the parts."""
        if len(self.ends) == 1:
            return PressureField(None, series[0])
        bounds, each = (CENTRE, *self.breaks, EDGE), iter(series)
        pieces = []
        for inner, outer in pairwise(bounds):
            if inner is CENTRE and not self.pointed:
                on_disk = DiskSeries(outer, next(each), power=0)
                pieces.append(ZonePiece(outer, on_disk))
            else:
                halves = next(each), next(each)
                pieces.append(ZonePiece(outer, AnnulusSeries(inner, outer, *halves, power=0)))
        return ZonalField(tuple(pieces))


class PressureSpace(Protocol):
    """What a problem for the pressure asks of a space.

    Attributes
    ----------
    t, y, weights : ndarray, shape (nodes,)
        Nodes of the half-integral, ``1 - t**2`` without cancellation, and weights of ``dt``.
    past : ndarray, shape (nodes,)
        ``t**2 - b**2`` without cancellation for the last break b before t, 0 if there is none.
    """

    t: Array
    y: Array
    past: Array
    weights: Array

    @property
    def unknowns(self) -> int:
        """Number of unknowns."""

    @property
    def functions(self) -> Factorable:
        """The functions with their matrices."""

    def factor(self, compliance: float) -> Regularised[Any]:
        """Factor the problem with a compliance."""

    def half_integral(self, coefficients: Array) -> Array:
        """Return the half-integral at the nodes."""


class DiskSpace:
    """A disk in one part.

    Parameters
    ----------
    panels : LogPanels
    degrees : tuple of int
    """

    def __init__(self, panels: LogPanels, degrees: tuple[int, ...]) -> None:
        disk = disk_operators(panels)
        self._space = disk.normal.space(degrees)
        self.t: Array = np.sqrt(disk.nodes.rest)
        self.y: Array = disk.nodes.d
        self.past: Array = np.zeros(len(self.y))
        self.weights: Array = disk.nodes.weights

    @property
    def unknowns(self) -> int:
        """Number of unknowns."""
        return self._space.unknowns

    @property
    def functions(self) -> Factorable:
        """The functions with their matrices."""
        return self._space

    def factor(self, compliance: float) -> Regularised[Any]:
        """Factor the problem with a compliance."""
        return self._space.factor(compliance)

    def half_integral(self, coefficients: Array) -> Array:
        """Return the half-integral at the nodes."""
        return self._space.half_integral(coefficients)


class NodalSpace(ABC):
    """Functions by the half-integrals that they have at nodes.

    Attributes are those of `PressureSpace` and `Factorable`.
    """

    t: Array
    y: Array
    past: Array
    weights: Array
    index: NDArray[np.int_]
    panel: NDArray[np.int_]
    size: int
    panels: int
    kept: int
    kept_but_one: int

    @property
    def unknowns(self) -> int:
        """Number of unknowns."""
        return len(self.index)

    @property
    def functions(self) -> Factorable:
        """The functions with their matrices."""
        return self

    @property
    @abstractmethod
    def _matrix(self) -> Array:
        """Half-integrals of the functions at the nodes, in the order of `index`."""

    @property
    @abstractmethod
    def mass(self) -> Array:
        """Mass matrix ``int phi psi s ds``."""

    @cached_property
    def gram(self) -> Array:
        """Gram matrix of the half-integrals."""
        weighted = self._matrix * np.sqrt(self.weights / pi)[:, None]
        return np.asarray(weighted.T @ weighted)

    @cached_property
    def constant_moments(self) -> Array:
        """Moments of the density 1."""
        return self.moments(np.ones(len(self.weights)))

    def moments(self, density: Array) -> Array:
        """Return the inner products of the half-integrals with a density, in order of `index`."""
        return np.asarray((self.weights / pi * density) @ self._matrix)

    def half_integral(self, coefficients: Array) -> Array:
        """Return the half-integral at the nodes."""
        return np.asarray(self._matrix @ coefficients[self.index])

    def factor(self, compliance: float) -> Regularised[Any]:
        """Factor the problem with a compliance."""
        return Regularised(self, compliance)


class PartedSpace(NodalSpace):
    """A disk in several parts.

    Parameters
    ----------
    parts : Parts
    used : tuple of (LogPanels, tuple of int)
        Panels of every part, and the degrees on them.
    """

    def __init__(self, parts: Parts, used: tuple[Used, ...]) -> None:
        self._families = _families(parts, used)
        self._degrees = [degrees for _, degrees in used]
        self.size = sum(panels.size for panels, _ in used)
        self.panels = sum(panels.panels for panels, _ in used)
        nodes = [graded_nodes(*one) for one in used]
        points = [f.points(n.d) for f, n in zip(self._families, nodes, strict=True)]
        # a disk's own nodes know how far they are from its centre
        squares = [
            f.reach * n.rest if f.sign < 0 and f.reach == f.boundary.square else p.z
            for f, n, p in zip(self._families, nodes, points, strict=True)
        ]
        self.t: Array = np.sqrt(np.concatenate(squares))
        self.y: Array = np.concatenate([p.y for p in points])
        self.past: Array = np.concatenate(
            [
                np.zeros(len(p.offset)) if inner is CENTRE else -p.before(inner)
                for p, inner in zip(points, parts.inner, strict=True)
            ]
        )
        extents = [f.reach * n.weights for f, n in zip(self._families, nodes, strict=True)]
        self.weights: Array = np.concatenate(extents) / (2.0 * self.t)
        self._arrange(used)

    def _arrange(self, used: tuple[Used, ...]) -> None:
        """Order the functions: those of the coarser spaces first, as `galerkin.Space` does."""
        keep, shed, top, panel = [], [], [], np.zeros(self.size, dtype=int)
        start = first = 0
        for panels, degrees in used:
            terms, tail = panels.degree + 1, start + panels.panels * (panels.degree + 1)
            for j, n in enumerate(degrees):
                own = start + j * terms + np.arange(n + 1)
                panel[own] = first + j
                split = max(n - 1, 1)
                keep.append(own[:split])
                shed.append(own[split:n])
                top.append(own[max(n, split) :])
            panel[tail : start + panels.size] = first + len(degrees) - 1
            keep.append(np.arange(tail, start + panels.size - 1))
            top.append(np.array([start + panels.size - 1]))
            start, first = start + panels.size, first + len(degrees)
        self.index = np.concatenate([*keep, *shed, *top])
        self.kept = sum(map(len, keep))
        self.kept_but_one = self.kept + sum(map(len, shed))
        self.panel = panel[self.index]

    @cached_property
    def _matrix(self) -> Array:
        """Half-integrals of the functions at the nodes, in the order of `index`."""
        rows, starts = [], np.cumsum([0, *(f.panels.size for f in self._families)])
        columns = np.concatenate(
            [
                start + f.panels.functions(n)
                for start, f, n in zip(starts, self._families, self._degrees, strict=False)
            ]
        )
        each = list(zip(self._families, self._degrees, strict=True))
        for target, used in each:
            rows.append(np.hstack([_seen(*source, target, used) for source in each]))
        place = np.empty(self.size, dtype=int)
        place[columns] = np.arange(len(columns))
        return np.ascontiguousarray(np.vstack(rows)[:, place[self.index]])

    @cached_property
    def mass(self) -> Array:
        """Mass matrix ``int phi psi s ds``."""
        blocks = [
            f.panels.mass(np.arange(f.panels.size), f.reach / 2.0, 0.0) for f in self._families
        ]
        return np.asarray(block_diag(*blocks)[np.ix_(self.index, self.index)])


def pressure_space(parts: Parts, used: tuple[Used, ...]) -> PressureSpace:
    """Return the space on these parts (cached)."""
    if len(used) == 1:
        return DiskSpace(*used[0])
    return _SPACES.get((parts, used), lambda: PartedSpace(parts, used))


def _families(parts: Parts, used: tuple[Used, ...]) -> list[Family]:
    pairs = zip(parts.ends, used, strict=True)
    return [Family(*end, panels) for end, (panels, _) in pairs]


def _seen(source: Family, degrees: tuple[int, ...], target: Family, used: tuple[int, ...]) -> Array:
    """Return the half-integrals of one part's functions at the nodes of another."""
    nodes = graded_nodes(target.panels, used)
    found = block(source, degrees, target, used, 1)
    if found is None:  # it lies inside
        return np.zeros((len(nodes.d), len(source.panels.functions(degrees))))
    whole = found.whole if found.gathered is None else found.whole @ found.gathered
    whole = found.scale * whole
    return nodes.spread(whole) if found.sampled else whole
