"""Integrals of ring loads over the contact, with the size of their terms and two rules compared."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from spectral_contact.interior.mesh import Mesh, Points
from spectral_contact.interior.rings import Geometry, geometry

__all__ = ["Integrals", "Kernel", "integrate"]

Array = NDArray[np.float64]
Kernel = Callable[[Geometry, float], tuple[Array, ...]]

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


def _sums(mesh: Mesh, points: Points, kernel: Kernel, ring: str, nu: float) -> tuple[Array, Array]:
    """Return the integrals for one load, and those of the moduli."""
    depth = np.where(points.on_surface, 0.0, points.z)
    values, sizes = np.zeros((4, len(depth))), np.zeros((4, len(depth)))
    for block, nodes in mesh.rows(points):
        owner, some = nodes.owner, points[block]
        load = nodes.pressure if ring == "pressure" else nodes.traction
        measure = load * nodes.s * nodes.weight
        shape = measure.shape
        r = np.broadcast_to(some.r[owner, None], shape)
        z = np.broadcast_to(depth[block][owner, None], shape)
        shares = kernel(geometry(r, z, nodes.s, nodes.ahead), nu)
        for row, size, share in zip(values, sizes, shares, strict=False):
            terms = share * measure
            count = len(some.r)
            row[block] += np.bincount(owner, terms.sum(axis=1), minlength=count)
            size[block] += np.bincount(owner, np.abs(terms).sum(axis=1), minlength=count)
    return values, sizes


def integrate(
    meshes: tuple[Mesh, Mesh],
    points: Points,
    kernels: tuple[Kernel, Kernel | None],
    nu: float,
) -> Integrals:
    """Integrate ring loads of pressure and of traction over the contact.

    Parameters
    ----------
    meshes : tuple of Mesh
        With the rule that is used and the one that it is compared with.
    points : Points
    kernels : tuple of callable
        Of rings of pressure and of traction; None for a contact without traction.
    nu : float
        Poisson's ratio.
    """
    fine, coarse = meshes
    values, of_pressure = _sums(fine, points, kernels[0], "pressure", nu)
    rough = _sums(coarse, points, kernels[0], "pressure", nu)[0]
    of_traction = np.zeros_like(values)
    if kernels[1] is not None:
        more, of_traction = _sums(fine, points, kernels[1], "traction", nu)
        values = values + more
        rough = rough + _sums(coarse, points, kernels[1], "traction", nu)[0]
    quadrature = np.abs(values - rough) + _ROUNDING * (of_pressure + of_traction)
    return Integrals(values, of_pressure, of_traction, quadrature)
