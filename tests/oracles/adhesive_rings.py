"""Adhesive contact by rings and differences of energies, which shares nothing with the library.

The pressure is constant on rings of equal width, a layer of compliance alpha is under each, and the
surface follows the punch at their middles. For a contact radius a and an approach the elastic
energy is a quadratic function of the approach. The energy release rate is its difference between
two radii, over that of the areas; where it is the work of adhesion is the state.
"""

from dataclasses import dataclass

import numpy as np
from scipy.special import ellipe, ellipk

#: Step of the differences in the radius, relative.
STEP = 1e-3


@dataclass(frozen=True)
class RingState:
    """Approach and load of a contact radius, and the elastic energy stored."""

    approach: float
    load: float
    energy: float


def displacement(r, b):
    """Return the displacement at r under a unit pressure on a disk of radius b, in units of E'."""
    inside = r <= b
    lo = np.minimum(r, b)
    hi = np.maximum(r, b)
    m = (lo / hi) ** 2
    outside = hi * (ellipe(m) - (1.0 - m) * ellipk(np.minimum(m, 1.0 - 1e-16)))
    return np.where(inside, b * ellipe(m), outside) / np.pi


class Rings:
    """Contact of a profile by a number of rings.

    Parameters
    ----------
    height : callable
    compliance : float
        Of the layer.
    count : int
    """

    def __init__(self, height, compliance, count):
        self.height, self.compliance = height, compliance
        self.edges = np.linspace(0.0, 1.0, count + 1)
        self.middles = (self.edges[1:] + self.edges[:-1]) / 2.0
        self.areas = np.pi * np.diff(self.edges**2)
        disks = displacement(self.middles[:, None], np.maximum(self.edges[None, :], 1e-12))
        self.unit = disks[:, 1:] - disks[:, :-1]

    def quadratic(self, a):
        """Return s, m, q with the load ``s d - m`` and the energy ``(s d**2 - 2 m d + q)/2``."""
        matrix = a * self.unit + self.compliance * np.eye(len(self.middles))
        h, areas = self.height(a * self.middles), a**2 * self.areas
        one, under = np.linalg.solve(matrix, np.stack([np.ones_like(h), h], axis=1)).T
        return areas @ one, areas @ under, areas @ (under * h)

    def state(self, a, adhesion):
        """Return the state of a radius: the approach at which the energy release rate is w."""
        low, high = a * (1.0 - STEP), a * (1.0 + STEP)
        areas = np.pi * (high**2 - low**2)
        below, above = np.array(self.quadratic(low)), np.array(self.quadratic(high))
        s, m, q = (above - below) / areas
        # the lower root: tension at the edge
        approach = (m - np.sqrt(m**2 - s * (q - 2.0 * adhesion))) / s
        s, m, q = self.quadratic(a)
        energy = (s * approach**2 - 2.0 * m * approach + q) / 2.0
        return RingState(float(approach), float(s * approach - m), float(energy))
