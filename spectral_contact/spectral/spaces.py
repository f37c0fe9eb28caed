r"""Galerkin matrices of the normal operator N and the tangential operator T on a disk.

N and T are the operators of docs/theory, with the elliptic kernels K1 and K2; s is the radius over
that of the disk and ``z = s**2``. The half-integral ``F_phi(t) = 1/2 int_{t^2}^1 phi dz / sqrt(z -
t^2)`` of a function phi factors both kernels (docs/theory, Abel factorisation):

    <phi, N psi> = (1/pi) int F_phi F_psi dt           (phi and psi stand for pressures p)
    <s phi, T s psi> = (1/pi) int t^2 F_phi F_psi dt   (phi and psi stand for shears q/s)

so each matrix is a Gram matrix: symmetric and positive definite by construction, with no logarithm
left to integrate. Spaces do not depend on compliance, friction or Poisson's ratio. The kernels are
homogeneous, so that a space also serves a stick disk of any radius c, with ``compliance / c``.

A disk is one part, with panels in the logarithm of the distance to its edge, or it is divided into
several parts at the breaks of the punch's profile, where a derivative of its height jumps. A part
of several is a disk or one half of an annulus, with panels graded to one of its ends
(`GradedMesh`). Where the punch has a tip, the centre is such an end. Half-integrals between parts
are those of `blocks`.

There are three numberings. *Coefficients* are all up to the highest degree, on every panel.
*Functions* are those coefficients that are in use, since each panel has its own degree, part after
part. *Unknowns* are the functions in another order: those of the coarser spaces come first.
"""

from __future__ import annotations

from itertools import pairwise
from math import pi

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag, eigh

from spectral_contact.fields.series import CENTRE
from spectral_contact.spectral.blocks import Block, block, disk_gram
from spectral_contact.spectral.cache import bounded_cache
from spectral_contact.spectral.graded import graded_nodes
from spectral_contact.spectral.node_operators import NodeOperators
from spectral_contact.spectral.panels import DiscreteSpace, LogPanels
from spectral_contact.spectral.parts import DiskPartition, GradedMesh
from spectral_contact.spectral.regularised import NodalSpace
from spectral_contact.threads import cached_property

Array = NDArray[np.float64]

#: The partition of a disk that is one part.
UNCUT_DISK = DiskPartition((), pointed=False)


class Space(NodalSpace):
    """Functions on a disk, in one part or in several, with the inner products of N or T.

    Parameters
    ----------
    parts : DiskPartition
    spaces : tuple of DiscreteSpace
        Panels and degrees of every part.
    shear : bool
        Whether functions stand for shears q/s: the inner products are those of T, and the mass is
        ``int phi psi s**3 ds``. Otherwise they stand for pressures, with N and ``int phi psi s
        ds``.

    Attributes
    ----------
    function : ndarray of int, shape (unknowns,)
        The function that each unknown is. The coefficient that it is is `index`.

    The other attributes are those of `NodalSpace`.
    """

    def __init__(
        self, parts: DiskPartition, spaces: tuple[DiscreteSpace, ...], *, shear: bool = False
    ) -> None:
        self._meshes = meshes = [
            GradedMesh(*end, panels) for end, (panels, _) in zip(parts.ends, spaces, strict=True)
        ]
        self._spaces = spaces
        self.shear = shear
        self._order_unknowns()
        self._nodes = nodes = [graded_nodes(*space) for space in spaces]
        points = [mesh.points(n.d) for mesh, n in zip(meshes, nodes, strict=True)]
        # t**2 of the nodes. On a disk graded to its rim it is taken from the distance 1 - d from
        # the centre, which the nodes have to full relative accuracy: next to the centre the
        # distance d from the rim has lost t**2.
        squares = [
            mesh.extent * n.rest if mesh.sign < 0 and mesh.extent == mesh.boundary.square else p.z
            for mesh, n, p in zip(meshes, nodes, points, strict=True)
        ]
        self.t = np.sqrt(np.concatenate(squares))
        self.y = np.concatenate([p.y for p in points])
        self.past_break = np.concatenate(
            [
                np.zeros(len(p.offset)) if last is CENTRE else -p.before(last)
                for p, last in zip(points, parts.profile_breaks, strict=True)
            ]
        )
        # weights of dz, and dt = dz / (2 t)
        z_weights = [mesh.extent * n.weights for mesh, n in zip(meshes, nodes, strict=True)]
        self.weights = np.concatenate(z_weights) / (2.0 * self.t)
        self.measure = self.weights / pi * (self.t**2 if shear else 1.0)
        #: where an array over all nodes is split into those of the parts
        self._cuts = np.cumsum([len(n.d) for n in nodes])[:-1]

    def _order_unknowns(self) -> None:
        """Order the functions on all parts: those of the coarser spaces come first."""
        index = []
        panel = []
        starts = [0]
        top_degrees = list[NDArray[np.int_]]()
        self.size = 0
        self.panels = 0
        for panels, degrees in self._spaces:
            functions = panels.functions(degrees)
            index.append(self.size + functions)
            # The tail has a number of its own if there is one part. Of several parts it shares that
            # of the last panel, so that the panels of all parts are numbered without gaps.
            last_panel = panels.count - (len(self._spaces) > 1)
            panel_of_function = functions // (panels.degree + 1)
            panel.append(self.panels + np.minimum(panel_of_function, last_panel))
            top_degrees.extend(starts[-1] + panels.top(degrees, n) for n in (2, 1))
            starts.append(starts[-1] + len(functions))
            self.size += panels.size
            self.panels += panels.count
        # the number of the coarser spaces, of two, that lack a function
        lacking = np.bincount(np.concatenate(top_degrees), minlength=starts[-1])
        self.function = np.argsort(lacking, kind="stable")
        self.coarsest_unknowns = int((lacking < 1).sum())
        self.coarse_unknowns = int((lacking < 2).sum())
        #: the functions of every part
        self._columns = [slice(start, stop) for start, stop in pairwise(starts)]
        self.index = np.concatenate(index)[self.function]
        self.panel = np.concatenate(panel)[self.function]

    def _ordered(self, matrix: Array) -> Array:
        """Return a matrix of the functions in the order of the unknowns."""
        return matrix[np.ix_(self.function, self.function)]

    @cached_property
    def _operators(self) -> list[NodeOperators]:
        """For every part the half-integrals at its nodes.

        They are those of the functions on all parts that reach farther out than these nodes.
        """
        sources = list(zip(self._meshes, self._spaces, strict=True))
        operators = []
        for (target, (_, node_degrees)), nodes in zip(sources, self._nodes, strict=True):
            blocks: dict[int, Block] = {}
            for k, (source, (_, degrees)) in enumerate(sources):
                integrals = block(source, degrees, target, node_degrees, side=1)
                if integrals is not None:
                    blocks[k] = integrals
            operators.append(NodeOperators(nodes, blocks))
        return operators

    @cached_property
    def gram(self) -> Array:
        """Gram matrix of the half-integrals, in the order of `index`."""
        if len(self._spaces) == 1:
            return self._ordered(disk_gram(*self._spaces[0], shear=self.shear))
        gram = np.zeros((self.unknowns,) * 2)
        columns = self._columns
        measures = np.split(self.measure, self._cuts)
        for operators, measure in zip(self._operators, measures, strict=True):
            for k, j, sums in operators.products(operators, measure, other_values=True):
                gram[columns[k], columns[j]] += sums
        return self._ordered(gram)

    @cached_property
    def mass(self) -> Array:
        """Mass matrix, in the order of `index`."""
        blocks = list[Array]()
        for mesh, (_, degrees) in zip(self._meshes, self._spaces, strict=True):
            blocks += mesh.mass(degrees, shear=self.shear).blocks()
        return self._ordered(block_diag(*blocks))

    def project(self, weighted: Array) -> Array:
        """Return the sums of the half-integrals times weighted values, in the order of `index`."""
        rows = np.atleast_2d(weighted).T
        sums = np.zeros((self.unknowns, rows.shape[1]))
        for operators, on_part in zip(self._operators, np.split(rows, self._cuts), strict=True):
            for k, projected in operators.project(on_part):
                sums[self._columns[k]] += projected
        return np.asarray(sums[self.function].T.reshape(*weighted.shape[:-1], -1))

    def half_integral(self, coefficients: Array) -> Array:
        """Return the half-integral at the nodes."""
        values = np.empty((self.unknowns, 1))
        values[self.function, 0] = coefficients[self.index]
        fields = [values[columns] for columns in self._columns]
        return np.concatenate([operators.values(fields)[:, 0] for operators in self._operators])

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
        # The mass of a panel falls like its extent. Scaled to unit diagonal it is well conditioned.
        scale = 1.0 / np.sqrt(self.mass.diagonal())
        scaling = np.outer(scale, scale)
        values, vectors = eigh(self.gram * scaling, self.mass * scaling)
        modes = np.zeros((self.size, len(values)))
        modes[self.index] = vectors * scale[:, None]
        return np.maximum(values, 0.0), modes


_space = bounded_cache("spaces", 96)(Space)


def disk_space(
    parts: DiskPartition, spaces: tuple[DiscreteSpace, ...], *, shear: bool = False
) -> Space:
    """Return the space on these parts (cached where there are no breaks).

    Breaks lie at other radii in every scene. So of a space with breaks only the blocks are cached.
    """
    return (Space if parts.breaks else _space)(parts, spaces, shear=shear)


def unit_space(panels: LogPanels, degrees: tuple[int, ...], *, shear: bool = False) -> Space:
    """Return the space on a disk in one part (cached)."""
    return disk_space(UNCUT_DISK, (DiscreteSpace(panels, degrees),), shear=shear)
