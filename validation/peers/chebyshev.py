"""Collocation with one Chebyshev polynomial over the whole radius, without a weight.

The spectral method one would try first (J. P. Boyd, Chebyshev and Fourier Spectral Methods, 2001,
chapter 19): unknowns and equations at the points s = cos^2(theta/2) with equal steps of theta.

Traps: it is spectral for smooth fields only. The terms y log y of the edge hold it to an algebraic
order, and a thin layer is resolved only when the points at the edge, 1/n^2 apart, reach into it.
The integrals are taken far more accurately than that, so that nothing but the basis is to blame.

Solver: ``chebyshev:solver``; the resolution is the degree.
"""

from __future__ import annotations

import numpy as np
from contact import Contact, Disk
from elements import Array, Kernel, Places, gauss
from numpy.polynomial import chebyshev

from spectral_contact import Scene

#: Points of the rule on either side of a node beyond twice the degree, and the power grading it.
POINTS, POWER = 16, 3


class Polynomial(Disk):
    """One polynomial by its values at Chebyshev-Lobatto points."""

    def __init__(self, degree: int) -> None:
        self._angles = np.linspace(0.0, np.pi, degree + 1)
        self.nodes = _places(self._angles, np.pi - self._angles)
        self._series = np.linalg.inv(chebyshev.chebvander(np.cos(self._angles), degree))

    def matrix(self, kernel: Kernel) -> Array:
        """Integrate the kernel on either side of every node."""
        degree = len(self._angles) - 1
        v, w = gauss(2 * degree + POINTS)
        w, v = w * POWER * v ** (POWER - 1), v**POWER
        rows = []
        for node, own in enumerate(self._angles):
            reach = np.array([r for r in (-own, np.pi - own) if r])[:, None]
            angles, rest = own + reach * v, (np.pi - own) - reach * v
            values = kernel(_places(angles, rest), self.nodes[node])
            values[np.isinf(values)] = 0.0  # points that round to the node weigh nothing
            values *= w * np.abs(reach) * np.sin(rest) / 2.0
            rows.append(values.ravel() @ chebyshev.chebvander(np.cos(angles.ravel()), degree))
        return np.array(rows) @ self._series / np.pi

    def at(self, values: Array, y: Array) -> Array:
        """Evaluate the polynomial."""
        return chebyshev.chebval(1.0 - 2.0 * y, self._series @ values)

    def moment(self, values: Array, y: Array) -> Array:
        """Integrate the polynomial."""
        product = chebyshev.chebmul([0.25, 0.25], self._series @ values)
        return chebyshev.chebval(1.0 - 2.0 * y, chebyshev.chebint(product, lbnd=-1.0))


def _places(angles: Array, rest: Array) -> Places:
    """Return points by their angles from the edge and from the centre."""
    return Places(np.sin(rest / 2.0) ** 2, np.sin(angles / 2.0) ** 2)


def solver(scene: Scene, degree: int) -> Contact:
    """Solve with a polynomial of that degree."""
    return Contact(Polynomial(degree), scene)
