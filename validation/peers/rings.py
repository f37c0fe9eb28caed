"""Collocation on rings of constant pressure: what a user would write first for equation (3.5).

Solvers as `spectral_contact.studies` takes them, of the frictionless problem: ``rings:uniform`` and
``rings:graded``, whose resolution is the number of rings.
"""

from __future__ import annotations

from functools import partial

import numpy as np

from spectral_contact import Scene
from spectral_contact.kernels import normal_kernel

#: Gauss points on either half of a ring.
POINTS = 16


class Rings:
    """Pressure constant on rings, equation met at their middles; graded to the edge by a power."""

    def __init__(self, scene: Scene, count: int, power: float) -> None:
        from_edge = np.linspace(1.0, 0.0, count + 1) ** power
        self.ends = 1.0 - from_edge
        middle = (self.ends[1:] + self.ends[:-1]) / 2.0
        half = np.diff(self.ends) / 2.0
        v, w = np.polynomial.legendre.leggauss(POINTS)
        v, w = (1.0 + v) / 2.0, w / 2.0
        matrix = scene.normal_compliance * np.eye(count)
        for side in (
            -1.0,
            1.0,
        ):  # eta = middle -+ half v^2 blunts the logarithm of a ring on itself
            eta = middle[:, None] + side * half[:, None] * v**2
            kernel = normal_kernel(eta, middle[:, None, None])
            matrix += kernel @ (2.0 * v * w) * half / np.pi
        unit = np.linalg.solve(matrix, np.ones(count))
        self.approach = 1.0 / (np.pi * np.sum(unit * np.diff(self.ends**2)))
        self.pressures = unit * self.approach

    def pressure(self, s: np.ndarray) -> np.ndarray:
        """Return the pressure of the ring at each radius."""
        ring = np.searchsorted(self.ends, s) - 1
        return self.pressures[np.clip(ring, 0, len(self.pressures) - 1)]


uniform = partial(Rings, power=1.0)
graded = partial(Rings, power=3.0)
