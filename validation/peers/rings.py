"""Collocation on rings of constant traction: what the paper's author will have done.

The first thing one would write (K. L. Johnson, Contact Mechanics, 1985, section 5.9), equations met
at the middles of the rings. A ring of pressure is the difference of two disks, in closed form.

Traps: the value of the last ring is that of a point half a ring inside, and the approach, an
integral, hides it. So fields are interpolated between the middles, and extrapolated to the edge:
four times better there than the value of the ring.

Solvers: ``rings:uniform`` and ``rings:graded``, ends at the third power of equal steps from the
edge, which no other beats by much on thick and thin layers; the resolution is the number of rings.
"""

from __future__ import annotations

from functools import partial

import numpy as np
from contact import Contact, Disk
from elements import Array, Kernel, Places, integrals, normal, uniform_pressure

from spectral_contact import Scene


class Rings(Disk):
    """Constant on rings whose ends are graded to the edge by a power."""

    def __init__(self, count: int, power: float) -> None:
        self.ends = Places.at(np.linspace(1.0, 0.0, count + 1) ** power)
        self.nodes = Places.at((self.ends.y[1:] + self.ends.y[:-1]) / 2.0)

    def matrix(self, kernel: Kernel) -> Array:
        """Integrate the kernel; that of a pressure on a disk has a closed form."""
        if kernel is normal:
            return np.diff(uniform_pressure(self.ends, self.nodes[:, None]), axis=1) / np.pi
        return integrals(kernel, self.ends, self.nodes).sum(axis=0)

    def at(self, values: Array, y: Array) -> Array:
        """Interpolate linearly, and beyond the first and the last middle extrapolate."""
        nodes = self.nodes.y
        i = np.clip(np.searchsorted(-nodes, -y) - 1, 0, len(nodes) - 2)
        x = (nodes[i] - y) / (nodes[i] - nodes[i + 1])
        return values[i] + x * (values[i + 1] - values[i])

    def moment(self, values: Array, y: Array) -> Array:
        """Integrate exactly."""
        squares = self.ends.s**2
        whole = np.concatenate([[0.0], np.cumsum(values * np.diff(squares))])
        ring = np.searchsorted(-self.ends.y, -y, side="right") - 1
        ring = np.clip(ring, 0, len(values) - 1)
        return (whole[ring] + values[ring] * ((1.0 - y) ** 2 - squares[ring])) / 2.0


def _solved(scene: Scene, count: int, power: float) -> Contact:
    return Contact(Rings(count, power), scene)


uniform = partial(_solved, power=1.0)
graded = partial(_solved, power=3.0)
