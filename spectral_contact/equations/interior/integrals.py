"""Integrals of ring loads over the contact, with estimates of their errors.

The sums of the moduli of all terms say what errors of the loads, and rounding, do to an integral;
the difference of two rules is the error of quadrature.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from spectral_contact.equations.interior.mesh import BodyMesh, BodyPoints, MeshNodes
from spectral_contact.equations.interior.ring_loads import Geometry, geometry
from spectral_contact.fields import Array

#: The fields of rings of unit load at points, such as `ring_loads.normal_stress`.
Kernel = Callable[[Geometry, float], tuple[Array, ...]]
Kernels = tuple[Kernel, ...]

#: Rounding of a term, relative (chosen).
_ROUNDING = 4.0 * float(np.finfo(float).eps)


@dataclass(frozen=True, slots=True)
class Integrals:
    """Integrals over the contact, each (components, points).

    Attributes
    ----------
    values : ndarray
    of_pressure, of_traction : ndarray
        Sums of the absolute values of the terms of either load: a relative error of the load,
        times this, bounds the error of the integral. In them the load counts for at least its floor
        of `integrate`.
    quadrature : ndarray
        Estimated error of quadrature and rounding.
    """

    values: Array
    of_pressure: Array
    of_traction: Array
    quadrature: Array

    @classmethod
    def empty(cls, count: int) -> Integrals:
        """Return arrays for the integrals at so many points, to be filled with `put`."""
        return cls(*np.zeros((4, 4, count)))

    def put(self, which: NDArray[np.bool_], other: Integrals) -> None:
        """Fill in the integrals at some of the points."""
        self.values[:, which] = other.values
        self.of_pressure[:, which] = other.of_pressure
        self.of_traction[:, which] = other.of_traction
        self.quadrature[:, which] = other.quadrature


def _sums(
    mesh: BodyMesh, points: BodyPoints, kernels: Kernels, nu: float, floors: tuple[float, float]
) -> tuple[Array, Array]:
    """Return the integrals by each rule, and the sums of absolute values of their terms.

    The latter are by the first rule, for each load. The shapes are (rules, components, points) and
    (loads, components, points).
    """
    depth = np.where(points.on_surface, 0.0, points.z)
    values = np.zeros((mesh.rules, 4, len(depth)))
    moduli = np.zeros((2, 4, len(depth)))
    for block, parts in mesh.rows(points):
        block_points = points[block]
        # numbers of nodes: those of each rule in the first row, in the second row, and so on
        lengths = np.concatenate([_lengths(part) for part in parts])
        owner = np.concatenate([part.owner for part in parts])
        s = _joined([part.s for part in parts])
        ahead = _joined([part.ahead for part in parts])
        loads = [
            _joined([part.pressure for part in parts]),
            _joined([part.traction for part in parts]),
        ]
        area = _joined([part.area for part in parts]) if any(floors) else None
        point_of_node = np.repeat(owner, lengths.reshape(-1, mesh.rules).sum(axis=1))
        rings = geometry(block_points.r[point_of_node], depth[block][point_of_node], s, ahead)
        add = _Adder(owner, np.cumsum(lengths) - lengths, len(block_points.r), mesh.rules)
        for j, (kernel, load, floor) in enumerate(zip(kernels, loads, floors, strict=False)):
            for k, field in enumerate(kernel(rings, nu)):
                terms = field * load
                values[:, k, block] += add.of_each_rule(terms)
                terms = np.abs(terms, out=terms)
                if area is not None and floor > 0.0:
                    terms = np.maximum(terms, floor * np.abs(field * area))
                moduli[j, k, block] += add.of_the_first(terms)
    return values, moduli


def _joined(arrays: list[Array]) -> Array:
    """Return all numbers of some arrays."""
    return np.concatenate([np.ravel(array) for array in arrays])


class _Adder(NamedTuple):
    """Sums over the nodes of rows, and over the rows of a point.

    Attributes
    ----------
    owner : ndarray of int
        The point of each row.
    starts : ndarray of int
        Where the nodes of each rule begin in each row, as an index of all nodes.
    points, rules : int
        Numbers of points and of rules.
    """

    owner: NDArray[np.intp]
    starts: NDArray[np.intp]
    points: int
    rules: int

    def of_each_rule(self, terms: Array) -> Array:
        """Return the sums at the points by each rule, (rules, points)."""
        row_sums = np.add.reduceat(terms, self.starts)
        rows = [row_sums[k :: self.rules] for k in range(self.rules)]
        return np.array([np.bincount(self.owner, row, minlength=self.points) for row in rows])

    def of_the_first(self, terms: Array) -> Array:
        """Return the sums at the points by the first rule."""
        row_sums = np.add.reduceat(terms, self.starts)[:: self.rules]
        return np.bincount(self.owner, row_sums, minlength=self.points).astype(float, copy=False)


def _lengths(rows: MeshNodes) -> NDArray[np.intp]:
    """Return the number of nodes of each rule in each row, row after row."""
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
        Its first rule gives the values, and its last the difference that is taken for the error of
        quadrature. If there is only one rule, `quadrature` is the rounding alone.
    points : BodyPoints
    kernels : tuple of callable
        For rings of pressure and of traction; only the first for a contact without traction.
    nu : float
        Poisson's ratio.
    floors : tuple of float
        Least absolute values of pressure and of traction in `of_pressure` and `of_traction`.
    """
    values, moduli = _sums(mesh, points, kernels, nu, floors)
    quadrature = np.abs(values[0] - values[-1]) + _ROUNDING * (moduli[0] + moduli[1])
    return Integrals(values[0], moduli[0], moduli[1], quadrature)
