"""Integrals of ring loads over the contact, with the size of their terms and two rules compared."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from spectral_contact.equations.interior.mesh import BodyMesh, BodyPoints, MeshNodes
from spectral_contact.equations.interior.ring_loads import Geometry, geometry
from spectral_contact.fields import Array

Kernel = Callable[[Geometry, float], tuple[Array, ...]]
Kernels = tuple[Kernel, ...]

_ROUNDING = 4.0 * float(np.finfo(float).eps)


@dataclass(frozen=True, slots=True)
class Integrals:
    """Integrals over the contact, each (components, points).

    Attributes
    ----------
    values : ndarray
    of_pressure, of_traction : ndarray
        The same with the moduli of all terms, for each load by itself; and with a load that is at
        least what `floors` says.
    quadrature : ndarray
        Estimated error of quadrature and rounding.
    """

    values: Array
    of_pressure: Array
    of_traction: Array
    quadrature: Array

    @classmethod
    def empty(cls, count: int) -> Integrals:
        """Return places for the integrals at so many points."""
        return cls(*np.zeros((4, 4, count)))

    def put(self, which: NDArray[np.bool_], those: Integrals) -> None:
        """Fill in the integrals of some points."""
        self.values[:, which] = those.values
        self.of_pressure[:, which] = those.of_pressure
        self.of_traction[:, which] = those.of_traction
        self.quadrature[:, which] = those.quadrature


def _sums(
    mesh: BodyMesh, points: BodyPoints, kernels: Kernels, nu: float, floors: tuple[float, float]
) -> tuple[Array, Array]:
    """Return the integrals by each rule, and for each load those of the moduli by the first."""
    depth = np.where(points.on_surface, 0.0, points.z)
    values, sizes = np.zeros((mesh.rules, 4, len(depth))), np.zeros((2, 4, len(depth)))
    for block, parts in mesh.rows(points):
        some, lengths = points[block], np.concatenate([_lengths(part) for part in parts])
        owner = np.concatenate([part.owner for part in parts])
        wanted = range(2, 7 if any(floors) else 6)
        s, ahead, *loads = (np.concatenate([np.ravel(p[k]) for p in parts]) for k in wanted)
        nodes = np.repeat(owner, lengths.reshape(-1, mesh.rules).sum(axis=1))
        rings = geometry(some.r[nodes], depth[block][nodes], s, ahead)
        add = _Adder(owner, np.cumsum(lengths) - lengths, len(some.r), mesh.rules)
        for kernel, load, moduli, floor in zip(kernels, loads, sizes, floors, strict=False):
            for k, share in enumerate(kernel(rings, nu)):
                terms = share * load
                values[:, k, block] += add.of_each_rule(terms)
                terms = np.abs(terms, out=terms)
                if floor > 0.0:
                    terms = np.maximum(terms, floor * np.abs(share * loads[2]))
                moduli[k, block] += add.of_the_first(terms)
    return values, sizes


class _Adder(NamedTuple):
    """Sums over the nodes of rows, and over the rows of a point.

    Attributes
    ----------
    owner : ndarray of int
        The point of each row.
    starts : ndarray of int
        Where the nodes of each rule begin in each row.
    points, rules : int
        How many there are.
    """

    owner: NDArray[np.intp]
    starts: NDArray[np.intp]
    points: int
    rules: int

    def of_each_rule(self, terms: Array) -> Array:
        """Return the sums of the points, by rule."""
        each = np.add.reduceat(terms, self.starts)
        rows = [each[k :: self.rules] for k in range(self.rules)]
        return np.array([np.bincount(self.owner, row, minlength=self.points) for row in rows])

    def of_the_first(self, terms: Array) -> Array:
        """Return the sums of the points by the first rule."""
        each = np.add.reduceat(terms, self.starts)[:: self.rules]
        return np.bincount(self.owner, each, minlength=self.points).astype(float, copy=False)


def _lengths(rows: MeshNodes) -> NDArray[np.intp]:
    """Return how many nodes each row has of each rule."""
    return np.tile(rows.counts, len(rows.owner))


def integrate(
    mesh: BodyMesh,
    points: BodyPoints,
    kernels: Kernels,
    nu: float,
    floors: tuple[float, float] = (0.0, 0.0),
) -> Integrals:
    """Integrate ring loads of pressure and of traction over the contact.

    Parameters
    ----------
    mesh : BodyMesh
        With the rule that is used, and one that it is compared with; without, `quadrature` is
        rounding alone.
    points : BodyPoints
    kernels : tuple of callable
        Of rings of pressure and of traction; the first alone for a contact without traction.
    nu : float
        Poisson's ratio.
    floors : tuple of float
        What pressure and traction count for at least, where their moduli are summed.
    """
    values, sizes = _sums(mesh, points, kernels, nu, floors)
    quadrature = np.abs(values[0] - values[-1]) + _ROUNDING * (sizes[0] + sizes[1])
    return Integrals(values[0], sizes[0], sizes[1], quadrature)
