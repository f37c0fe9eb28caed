"""Normal contact and full stick in closed-form matrices: no quadrature, no panels, no library code.

With ``p = sum a_n P_n(2 s^2 - 1)``, ``q = s sum b_n P_n(2 s^2 - 1)`` and ``t = cos(phi)`` the
half-integral ``int_t^1 P_n s ds / sqrt(s^2 - t^2)`` is ``sin((2 n + 1) phi) / (2 n + 1)``. So every
inner product of the kernels N and T (docs/theory) is an integral of sines. The coefficients fall
like a power of n: the approach and the shear have all digits for compliances of the order of 1, and
not for thin layers.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class LegendreSolution:
    """Coefficients of p and of q/s for unit load, with the approach and the total shear."""

    pressure: Array
    traction: Array
    approach: float
    total_shear: float


def _of_differences(n: int) -> tuple[Array, Array]:
    """Return ``m - k`` and ``m + k + 1`` of rows m and columns k."""
    m = np.arange(n)[:, None]
    return m - m.T, m + m.T + 1


def normal_matrix(n: int) -> Array:
    """Return ``<P_m, N P_k>``."""
    difference, total = _of_differences(n)
    return np.asarray(-(2.0 / np.pi) / ((4.0 * difference**2 - 1.0) * (4.0 * total**2 - 1.0)))


def tangential_matrix(n: int) -> Array:
    """Return ``<s P_m, T s P_k>``."""

    def cosines(j: Array) -> Array:
        """``int cos(2 j phi) sin(phi) cos(phi)^2``, to a factor."""
        return 1.0 / (1.0 - 4.0 * j**2) + 3.0 / (9.0 - 4.0 * j**2)

    difference, total = _of_differences(n)
    odd = 2.0 * np.arange(n) + 1.0
    return np.asarray((cosines(difference) - cosines(total)) / (8.0 * np.pi * np.outer(odd, odd)))


def pressure_mass(n: int) -> Array:
    """Return ``<P_m, P_k>`` in the measure ``s ds``."""
    return np.diag(0.5 / (2.0 * np.arange(n) + 1.0))


def traction_mass(n: int) -> Array:
    """Return ``<s P_m, s P_k>``: with ``x = 2 s^2 - 1`` the integral of ``(1 + x) P_m P_k / 8``."""
    k = np.arange(1, n)
    beside = 2.0 * k / ((2.0 * k - 1.0) * (2.0 * k + 1.0)) / 8.0
    return (
        np.diag(2.0 / (2.0 * np.arange(n) + 1.0) / 8.0) + np.diag(beside, 1) + np.diag(beside, -1)
    )


def drive_matrix(n: int) -> Array:
    """Return ``<s P_m, g[P_k]>``: ``s g`` is the integral of ``P_k / 4`` over x from -1."""
    k = np.arange(n)
    # int_-1^x P_k = (P_{k+1} - P_{k-1}) / (2 k + 1), and 1 + x = P_1 + P_0 for k = 0
    drive = np.zeros((n, n))
    above = k[:-1] + 1
    drive[above, k[:-1]] = 1.0 / (2.0 * k[:-1] + 1.0) * 2.0 / (2.0 * above + 1.0) / 16.0
    below = k[1:] - 1
    drive[below, k[1:]] = -1.0 / (2.0 * k[1:] + 1.0) * 2.0 / (2.0 * below + 1.0) / 16.0
    drive[0, 0] = 2.0 / 16.0
    return drive


def full_stick(alpha: float, beta: float, n: int) -> LegendreSolution:
    """Return normal contact and full stick for unit load and ``kappa = 1``."""
    unit = np.zeros(n)
    unit[0] = 0.5  # <P_k, 1>
    pressure = np.linalg.solve(alpha * pressure_mass(n) + normal_matrix(n), unit)
    approach = 1.0 / (2.0 * np.pi * float(unit @ pressure))
    pressure *= approach
    tangential = beta * traction_mass(n) + tangential_matrix(n)
    traction = np.linalg.solve(tangential, drive_matrix(n) @ pressure)
    return LegendreSolution(pressure, traction, approach, total_shear(traction))


def total_shear(traction: Array) -> float:
    """Return ``2 pi int q s ds``; with ``phi`` as above it is ``2 pi int t G dt``."""
    k = np.arange(len(traction))
    odd = 2.0 * k + 1.0
    # int_0^(pi/2) sin((2 k + 1) phi) sin(phi) cos(phi) dphi
    integral = np.where(k % 2, 1.0, -1.0) / (odd**2 - 4.0)
    return float(2.0 * np.pi * (traction * integral / odd).sum())
