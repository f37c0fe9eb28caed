r"""Galerkin projections of K1 and K2 on a disk.

With ``z = s**2`` the half-integral ``F(t) = 1/2 int_{t^2}^1 phi dz / sqrt(z - t^2)`` factors both
kernels (docs/theory, Abel factorisation):

    <phi, N psi> = (1/pi) int F_phi F_psi dt           (normal, phi in p)
    <s phi, T s psi> = (1/pi) int t^2 F_phi F_psi dt   (tangential, q = s u, phi in u)

so each matrix is a Gram matrix: symmetric and positive definite by construction, with no logarithm
left to integrate. Spaces know nothing of compliance, friction or Poisson's ratio; by homogeneity
they also serve a stick disk of any radius c, with ``compliance / c``.

A disk is one part, with panels in the logarithm of the distance to its edge, or several, with
panels graded to the breaks of a profile. Each is a disk, or one half of an annulus (`GradedMesh`);
the centre is an end of one where a punch has a tip. Half-integrals between parts are those of
`blocks`.
"""

from __future__ import annotations

from itertools import pairwise
from math import pi

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag, eigh

from spectral_contact.fields.series import CENTRE
from spectral_contact.spectral.blocks import block, disk_gram
from spectral_contact.spectral.cache import bounded_cache
from spectral_contact.spectral.graded import graded_nodes
from spectral_contact.spectral.panels import DiscreteSpace, LogPanels
from spectral_contact.spectral.parts import DiskPartition, GradedMesh
from spectral_contact.spectral.regularised import NodalSpace
from spectral_contact.spectral.seen import Seen
from spectral_contact.threads import cached_property

Array = NDArray[np.float64]

#: A disk in one part.
WHOLE = DiskPartition((), pointed=False)


class Space(NodalSpace):
    """Functions on a disk, in one part or in several, with the inner products of K1 or K2.

    Parameters
    ----------
    parts : DiskPartition
    used : tuple of DiscreteSpace
        Of every part.
    shear : bool
        Those of K2, with the mass ``int u v s**3 ds`` instead of ``int phi psi s ds``.
    """

    def __init__(
        self, parts: DiskPartition, used: tuple[DiscreteSpace, ...], *, shear: bool = False
    ) -> None:
        pairs = zip(parts.ends, used, strict=True)
        self._families = families = [GradedMesh(*end, panels) for end, (panels, _) in pairs]
        self._used, self.shear = used, shear
        self._order = order = _order(used)
        self.size, self.panels = order.size, order.panels
        self.index, self.panel = order.places
        #: where the unknowns are among the functions in use, part by part
        self.place = order.place
        self.kept, self.kept_but_one = order.kept
        self._nodes = nodes = [graded_nodes(*one) for one in used]
        points = [f.points(n.d) for f, n in zip(families, nodes, strict=True)]
        # a disk's own nodes know how far they are from its centre
        squares = [
            f.reach * n.rest if f.sign < 0 and f.reach == f.boundary.square else p.z
            for f, n, p in zip(families, nodes, points, strict=True)
        ]
        self.t = np.sqrt(np.concatenate(squares))
        self.y = np.concatenate([p.y for p in points])
        self.past = np.concatenate(
            [
                np.zeros(len(p.offset)) if inner is CENTRE else -p.before(inner)
                for p, inner in zip(points, parts.inner, strict=True)
            ]
        )
        extents = [f.reach * n.weights for f, n in zip(families, nodes, strict=True)]
        self.weights = np.concatenate(extents) / (2.0 * self.t)
        self.measure = self.weights / pi * (self.t**2 if shear else 1.0)
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
        """Gram matrix of the half-integrals, in the order of `index`."""
        if len(self._used) == 1:
            return self._order.of(disk_gram(*self._used[0], shear=self.shear))
        gram = np.zeros((self.unknowns,) * 2)
        columns = self._order.columns
        for seen, own in zip(self._seen, np.split(self.measure, self._ends), strict=True):
            for k, j, sums in seen.products(seen, own, whole=True):
                gram[columns[k], columns[j]] += sums
        return self._order.of(gram)

    @cached_property
    def mass(self) -> Array:
        """Mass matrix, in the order of `index`."""
        pairs = zip(self._families, self._used, strict=True)
        each = [family.mass(degrees, shear=self.shear) for family, (_, degrees) in pairs]
        return self._order.of(block_diag(*each) if len(each) > 1 else each[0])

    def tested(self, weighted: Array) -> Array:
        """Return the sums of the half-integrals times weighted values, in order of `index`."""
        rows = np.atleast_2d(weighted).T
        sums = np.zeros((self.unknowns, rows.shape[1]))
        for seen, each in zip(self._seen, np.split(rows, self._ends), strict=True):
            for k, one in seen.tested(each):
                sums[self._order.columns[k]] += one
        return np.asarray(sums[self._order.place].T.reshape(*weighted.shape[:-1], -1))

    def half_integral(self, coefficients: Array) -> Array:
        """Return the half-integral at the nodes."""
        values = np.empty((self.unknowns, 1))
        values[self._order.place, 0] = coefficients[self.index]
        each = [values[one] for one in self._order.columns]
        return np.concatenate([seen.more(each, whole=True)[:, 0] for seen in self._seen])

    def spectrum(self) -> tuple[Array, Array]:
        """Return eigenvalues and modes: ``gram v = value mass v``, normalised by the mass.

        They solve the problem for every compliance at once (docs/maps).

        Returns
        -------
        values : ndarray, shape (unknowns,)
            At least 0, increasing.
        modes : ndarray, shape (size, unknowns)
            Coefficients, zero outside the space.
        """
        # the mass of a panel falls like its width: with unit diagonal it is well conditioned
        scale = 1.0 / np.sqrt(self.mass.diagonal())
        square = np.outer(scale, scale)
        values, vectors = eigh(self.gram * square, self.mass * square)
        modes = np.zeros((self.size, len(values)))
        modes[self.index] = vectors * scale[:, None]
        return np.maximum(values, 0.0), modes


class _Order:
    """The functions on all parts, those of the coarser spaces first.

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
    """

    def __init__(self, used: tuple[DiscreteSpace, ...]) -> None:
        self.size = sum(panels.size for panels, _ in used)
        self.panels = sum(panels.panels for panels, _ in used)
        place, panel, starts, shed = [], [], [0], list[NDArray[np.int_]]()
        start = first = 0
        for panels, degrees in used:
            functions, count = panels.functions(degrees), panels.panels
            place.append(start + functions)
            # of one part the tail counts by itself
            own = functions // (panels.degree + 1)
            panel.append(first + np.minimum(own, count - (len(used) > 1)))
            shed.extend(starts[-1] + panels.top(degrees, n) for n in (2, 1))
            starts.append(starts[-1] + len(functions))
            start, first = start + panels.size, first + count
        lacking = np.bincount(np.concatenate(shed), minlength=starts[-1])
        self.place = np.argsort(lacking, kind="stable")
        self.kept = int((lacking < 1).sum()), int((lacking < 2).sum())
        self.columns = [slice(*ends) for ends in pairwise(starts)]
        self.places = np.concatenate(place)[self.place], np.concatenate(panel)[self.place]

    def of(self, matrix: Array) -> Array:
        """Return a matrix of functions part by part in this order."""
        return matrix[np.ix_(self.place, self.place)]


_order = bounded_cache("orders of functions", 96)(_Order)
_space = bounded_cache("spaces", 96)(Space)


def disk_space(
    parts: DiskPartition, used: tuple[DiscreteSpace, ...], *, shear: bool = False
) -> Space:
    """Return the space on these parts (cached where there are no breaks).

    Those of breaks are seldom the same, and what is kept of them are their blocks.
    """
    return (Space if parts.breaks else _space)(parts, used, shear=shear)


def unit_space(panels: LogPanels, degrees: tuple[int, ...], *, shear: bool = False) -> Space:
    """Return the space on a disk in one part (cached)."""
    return disk_space(WHOLE, (DiscreteSpace(panels, degrees),), shear=shear)
