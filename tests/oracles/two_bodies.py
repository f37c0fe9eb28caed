"""Two elastic half-spaces pressed together on a disk that sticks: the operators of both, added up.

The pressure is ``sum a_n P_n(x)`` and the traction ``s sum b_n P_n(x)`` with ``x = 2 s^2 - 1``.
All matrices in these are closed forms, so that nothing is integrated, and nothing of the library
is used. Each body has its own modulus and Poisson's ratio: the first one bears p and q, the second
one p and -q, and the disk's surfaces meet,

    u_z1 + u_z2 + alpha p = delta,        u_r1 - u_r2 + beta q = 0.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Body:
    """An elastic half-space."""

    youngs_modulus: float
    poisson_ratio: float

    @property
    def compliance(self) -> float:
        """4 (1 - nu^2) / E, the factor of the kernels K1 / pi and K2 / pi."""
        return 4.0 * (1.0 - self.poisson_ratio**2) / self.youngs_modulus

    @property
    def cross(self) -> float:
        """(1 - 2 nu) (1 + nu) / E, the factor of what p moves sideways and q moves down."""
        nu = self.poisson_ratio
        return (1.0 - 2.0 * nu) * (1.0 + nu) / self.youngs_modulus


@dataclass(frozen=True)
class Pressed:
    """Two bodies under unit load on the unit disk.

    Attributes
    ----------
    approach, total_shear : float
    pressure, traction : ndarray
        Coefficients of p and of q/s.
    """

    approach: float
    total_shear: float
    pressure: Array
    traction: Array

    def at(self, s: Array) -> tuple[Array, Array]:
        """Return p and q at radii."""
        x = 2.0 * s**2 - 1.0
        legendre = np.polynomial.legendre.legval
        return legendre(x, self.pressure), s * legendre(x, self.traction)


def _normal(count: int) -> Array:
    """<P_m, N P_k> in the measure s ds, N = (1/pi) int . K1."""
    m, k = np.meshgrid(np.arange(count), np.arange(count), indexing="ij")
    product = (4.0 * (m - k) ** 2 - 1.0) * (4.0 * (m + k + 1) ** 2 - 1.0)
    return np.asarray(-2.0 / np.pi / product)


def _tangential(count: int) -> Array:
    """<s P_m, T s P_k>, T = (1/pi) int . K2."""

    def term(j: Array) -> Array:
        return np.asarray(1.0 / (1.0 - 4.0 * j**2) + 3.0 / (9.0 - 4.0 * j**2))

    m, k = np.meshgrid(np.arange(float(count)), np.arange(float(count)), indexing="ij")
    return (term(m - k) - term(m + k + 1.0)) / (8.0 * np.pi * (2.0 * m + 1.0) * (2.0 * k + 1.0))


def _sideways(count: int) -> Array:
    """<s P_m, g[P_k]>, g = (1/s) int_0^s eta p deta; transposed, what q moves down."""
    found = np.zeros((count, count))
    for k in range(count):
        # int_0^s eta P_k deta = (P_{k+1} - P_{k-1}) / (4 (2k + 1)), of P_{-1} = -P_0
        for row, sign in ((k + 1, 1.0), (max(k - 1, 0), 1.0 if k == 0 else -1.0)):
            if row < count:
                found[row, k] += sign / (4.0 * (2 * k + 1)) / (2.0 * (2 * row + 1))
    return found


def _masses(count: int) -> tuple[Array, Array]:
    """<P_m, P_k> and <s P_m, s P_k>."""
    n = np.arange(float(count))
    plain = np.diag(1.0 / (2.0 * (2.0 * n + 1.0)))
    times_x = np.diag((n[:-1] + 1.0) / (2.0 * n[:-1] + 1.0), -1)
    times_x += np.diag(n[1:] / (2.0 * n[1:] + 1.0), 1)
    return plain, (plain + plain @ times_x) / 2.0


def stuck(
    first: Body, second: Body, alpha: float, beta: float, *, coupled: bool, count: int = 250
) -> Pressed:
    """Press two bodies together without slip.

    Parameters
    ----------
    first, second : Body
        The traction is that on the first one.
    alpha, beta : float
        Compliances of the layer between them, displacement per stress.
    coupled : bool
        Whether the traction moves the surfaces down.
    count : int
        Polynomials of either field.
    """
    plain, weighted = _masses(count)
    sideways = _sideways(count)
    down = alpha * plain + (first.compliance + second.compliance) * _normal(count)
    out = beta * weighted + (first.compliance + second.compliance) * _tangential(count)
    # p moves either surface inward; q moves the first outward and -q the second inward
    by_pressure = -(first.cross - second.cross) * sideways
    by_traction = -(first.cross - second.cross) * sideways.T if coupled else 0.0 * sideways
    matrix = np.block([[down, by_traction], [by_pressure, out]])
    load = np.zeros(2 * count)
    load[0] = 0.5  # <P_m, 1>
    solved = np.linalg.solve(matrix, load)
    approach = 1.0 / (2.0 * np.pi * solved[0] * 0.5)
    p, q = np.split(approach * solved, 2)
    # 2 pi int q s ds = 2 pi int s^2 u ds, of 1/s times the weighted mass: by quadrature in s
    nodes, weights = np.polynomial.legendre.leggauss(2 * count)
    s = (1.0 + nodes) / 2.0
    u = np.polynomial.legendre.legval(2.0 * s**2 - 1.0, q)
    return Pressed(float(approach), float(np.pi * (weights @ (s**2 * u))), p, q)
