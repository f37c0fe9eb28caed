r"""Spaces for a pressure on a disk in several parts: panels graded to the breaks of a profile.

A part is a disk, or one half of an annulus, with panels in the logarithm of the distance to one of
its ends (`Family`); the centre is such an end where a punch has a tip. Half-integrals between parts
are those of `blocks`. A disk in one part is `galerkin`'s own space.
"""

from __future__ import annotations

from itertools import pairwise
from math import pi
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag

from spectral_contact.fields.series import CENTRE
from spectral_contact.spectral.blocks import block
from spectral_contact.spectral.cache import BoundedCache
from spectral_contact.spectral.galerkin import disk_operators
from spectral_contact.spectral.graded import graded_nodes
from spectral_contact.spectral.moments import unit_masses
from spectral_contact.spectral.panels import LogPanels, Used
from spectral_contact.spectral.parts import Family, Parts
from spectral_contact.spectral.regularised import Factorable, NodalSpace, Regularised
from spectral_contact.spectral.seen import Seen
from spectral_contact.threads import cached_property

__all__ = ["DiskSpace", "PartedSpace", "PressureSpace", "pressure_space"]

Array = NDArray[np.float64]

_SPACES: BoundedCache[tuple[Parts, tuple[Used, ...]], PressureSpace] = BoundedCache(
    "spaces in parts", 8
)
_ORDERS: BoundedCache[tuple[Used, ...], _Order] = BoundedCache("orders of functions", 16)


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


class PartedSpace(NodalSpace):
    """A disk in several parts.

    Parameters
    ----------
    parts : Parts
    used : tuple of (LogPanels, tuple of int)
        Panels of every part, and the degrees on them.
    """

    def __init__(self, parts: Parts, used: tuple[Used, ...]) -> None:
        pairs = zip(parts.ends, used, strict=True)
        self._families = families = [Family(*end, panels) for end, (panels, _) in pairs]
        self._used = used
        self._order = order = _ORDERS.get(used, lambda: _Order(used))
        self.size, self.panels = order.size, order.panels
        self.index, self.panel = order.places
        self.kept, self.kept_but_one = order.kept
        self._nodes = nodes = [graded_nodes(*one) for one in used]
        points = [f.points(n.d) for f, n in zip(families, nodes, strict=True)]
        # a disk's own nodes know how far they are from its centre
        squares = [
            f.reach * n.rest if f.sign < 0 and f.reach == f.boundary.square else p.z
            for f, n, p in zip(families, nodes, points, strict=True)
        ]
        self.t: Array = np.sqrt(np.concatenate(squares))
        self.y: Array = np.concatenate([p.y for p in points])
        self.past: Array = np.concatenate(
            [
                np.zeros(len(p.offset)) if inner is CENTRE else -p.before(inner)
                for p, inner in zip(points, parts.inner, strict=True)
            ]
        )
        extents = [f.reach * n.weights for f, n in zip(families, nodes, strict=True)]
        self.weights: Array = np.concatenate(extents) / (2.0 * self.t)
        self._ends = np.cumsum([len(n.d) for n in nodes])[:-1]

    @cached_property
    def _seen(self) -> list[Seen]:
        """Half-integrals of the parts at the nodes of each."""
        each = list(zip(self._families, self._used, strict=True))
        found = []
        for (target, (_, used)), nodes in zip(each, self._nodes, strict=True):
            blocks = {
                k: block(source, degrees, target, used, 1, differences=False)
                for k, (source, (_, degrees)) in enumerate(each)
            }
            outside = {k: one for k, one in blocks.items() if one is not None}
            found.append(Seen(nodes, outside))
        return found

    @cached_property
    def gram(self) -> Array:
        """Gram matrix of the half-integrals."""
        gram = np.zeros((self.unknowns,) * 2)
        columns = self._order.columns
        weights = np.split(self.weights / pi, self._ends)
        for seen, own in zip(self._seen, weights, strict=True):
            for k, j, sums in seen.products(seen, own, whole=True):
                gram[columns[k], columns[j]] += sums
        place = self._order.place
        return gram.take(place, axis=0).take(place, axis=1)

    @cached_property
    def mass(self) -> Array:
        """Mass matrix ``int phi psi s ds``."""
        halves = np.array([f.reach / 2.0 for f in self._families])
        return np.asarray(halves[self._order.part][:, None] * self._order.masses)

    def moments(self, density: Array) -> Array:
        """Return the inner products of the half-integrals with a density, in order of `index`."""
        sums = np.zeros((self.unknowns, len(np.atleast_2d(density))))
        weighted = np.atleast_2d(self.weights / pi * density).T
        for seen, own in zip(self._seen, np.split(weighted, self._ends), strict=True):
            for k, one in seen.tested(own):
                sums[self._order.columns[k]] += one
        return np.asarray(sums[self._order.place].T.reshape(*density.shape[:-1], -1))

    def half_integral(self, coefficients: Array) -> Array:
        """Return the half-integral at the nodes."""
        values = np.empty((self.unknowns, 1))
        values[self._order.place, 0] = coefficients[self.index]
        each = [values[one] for one in self._order.columns]
        return np.concatenate([seen.whole(each)[:, 0] for seen in self._seen])


class _Order:
    """The functions on several parts, those of the coarser spaces first, as `galerkin.Space` does.

    Attributes
    ----------
    size, panels : int
        Of all parts.
    places : tuple of ndarray of int
        Among the coefficients, and the panels.
    kept : tuple of int
        How many there are with two degrees less on every panel, and with one less.
    columns : list of slice
        Those of every part, one part after the other.
    place : ndarray of int
        Where they are in that order.
    part : ndarray of int
        Whose they are.
    masses : ndarray
        ``int phi psi dd`` for parts of unit extent.
    """

    def __init__(self, used: tuple[Used, ...]) -> None:
        self.size = sum(panels.size for panels, _ in used)
        self.panels = sum(panels.panels for panels, _ in used)
        place, left, panel, part, starts = [], [], [], [], [0]
        start = first = 0
        for k, (panels, degrees) in enumerate(used):
            functions, count = panels.functions(degrees), panels.panels
            own = np.minimum(functions // (panels.degree + 1), count)
            degree = functions - own * (panels.degree + 1)
            highest = np.append(np.array(degrees), panels.tail_terms - 1)
            # of the tail only the last is shed; the constant of a panel is not
            shed = np.where(own < count, highest[own] - degree, 2 * (degree < highest[-1]))
            left.append(np.where((own < count) & (degree == 0), 2, np.minimum(shed, 2)))
            place.append(start + functions)
            panel.append(first + np.minimum(own, count - 1))
            part.append(np.full(len(functions), k))
            starts.append(starts[-1] + len(functions))
            start, first = start + panels.size, first + count
        ahead = np.concatenate(left)
        self.place = np.argsort(-ahead, kind="stable")
        self.kept = int((ahead > 1).sum()), int((ahead > 0).sum())
        self.columns = [slice(*ends) for ends in pairwise(starts)]
        self.places = np.concatenate(place)[self.place], np.concatenate(panel)[self.place]
        self.part = np.concatenate(part)[self.place]
        masses = block_diag(*(unit_masses(*one)[0] for one in used))
        self.masses: Array = masses.take(self.place, axis=0).take(self.place, axis=1)


def pressure_space(parts: Parts, used: tuple[Used, ...]) -> PressureSpace:
    """Return the space on these parts (cached where there are no breaks).

    Those of breaks are seldom the same, and what is kept of them are their blocks.
    """

    def made() -> PressureSpace:
        return DiskSpace(*used[0]) if len(used) == 1 else PartedSpace(parts, used)

    return made() if parts.breaks else _SPACES.get((parts, used), made)
