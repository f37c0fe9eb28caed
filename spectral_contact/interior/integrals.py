"""Integrals of ring loads over the contact, with the size of their terms and two rules compared."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from spectral_contact.interior.mesh import Mesh, Nodes, Points
from spectral_contact.interior.rings import Geometry, geometry

__all__ = ["Integrals", "Kernels", "integrate"]

Array = NDArray[np.float64]
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
        The same with the moduli of all terms, for each load by itself.
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


def _sums(mesh: Mesh, points: Points, kernels: Kernels, nu: float) -> tuple[Array, Array]:
    """Return the integrals by each rule, and for each load those of the moduli by the first."""
    depth = np.where(points.on_surface, 0.0, points.z)
    values, sizes = np.zeros((mesh.rules, 4, len(depth))), np.zeros((2, 4, len(depth)))
    for block, parts in mesh.rows(points):
        some, lengths = points[block], np.concatenate([_lengths(part) for part in parts])
        owner = np.concatenate([part.owner for part in parts])
        s, ahead, *loads = (np.concatenate([np.ravel(p[k]) for p in parts]) for k in range(2, 6))
        nodes = np.repeat(owner, lengths.reshape(-1, mesh.rules).sum(axis=1))
        starts, count = np.cumsum(lengths) - lengths, len(some.r)
        rings = geometry(some.r[nodes], depth[block][nodes], s, ahead)
        for kernel, load, moduli in zip(kernels, loads, sizes, strict=False):
            for k, (size, share) in enumerate(zip(moduli, kernel(rings, nu), strict=False)):
                terms = share * load
                each = np.add.reduceat(terms, starts).reshape(-1, mesh.rules).T
                for row, rule in zip(values, each, strict=True):
                    row[k, block] += np.bincount(owner, rule, minlength=count)
                each = np.add.reduceat(np.abs(terms), starts)[:: mesh.rules]
                size[block] += np.bincount(owner, each, minlength=count)
    return values, sizes


def _lengths(rows: Nodes) -> NDArray[np.intp]:
    """Return how many nodes each row has of each rule."""
    return np.tile(rows.counts, len(rows.owner))


def integrate(mesh: Mesh, points: Points, kernels: Kernels, nu: float) -> Integrals:
    """Integrate ring loads of pressure and of traction over the contact.

    Parameters
    ----------
    mesh : Mesh
        With the rule that is used, and one that it is compared with; without, `quadrature` is
        rounding alone.
    points : Points
    kernels : tuple of callable
        Of rings of pressure and of traction; the first alone for a contact without traction.
    nu : float
        Poisson's ratio.
    """
    values, sizes = _sums(mesh, points, kernels, nu)
    quadrature = np.abs(values[0] - values[-1]) + _ROUNDING * (sizes[0] + sizes[1])
    return Integrals(values[0], sizes[0], sizes[1], quadrature)
