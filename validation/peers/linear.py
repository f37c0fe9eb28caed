"""Collocation with piecewise-linear fields, on equal elements or on elements graded to the edge.

The textbook boundary element method of contact mechanics (K. L. Johnson, Contact Mechanics, 1985,
section 5.9, has overlapping triangles; graded meshes for singular ends are those of C. Schneider,
Math. Comp. 36, 1981). Nodes are the ends of the elements, and the equations are met there.

Traps: equal elements miss a layer of width alpha. The grading must be stronger where the layer is
thinner, and distances from the edge must not be differences of radii then.

Solvers: ``linear:uniform`` and ``linear:graded``; the resolution is the number of elements.
"""

from __future__ import annotations

import math

import numpy as np
from contact import Contact, Disk
from elements import Array, Kernel, Places, integrals

from spectral_contact import Scene


class Linear(Disk):
    """Hat functions on elements whose ends are graded to the edge by a power."""

    def __init__(self, count: int, power: float) -> None:
        self.nodes = Places.at(np.linspace(1.0, 0.0, count + 1) ** power)

    def matrix(self, kernel: Kernel) -> Array:
        """Integrate the kernel, element by element."""
        inner, outer = integrals(kernel, self.nodes, self.nodes)
        found = np.zeros((len(inner), len(inner)))
        found[:, :-1] = inner
        found[:, 1:] += outer
        return found

    def at(self, values: Array, y: Array) -> Array:
        """Interpolate linearly."""
        return np.interp(y, self.nodes.y[::-1], values[::-1])

    def moment(self, values: Array, y: Array) -> Array:
        """Integrate exactly."""
        s, ends = self.nodes.s, self.nodes.y
        whole = np.diff(-ends) * _simpson(s[:-1], s[1:], values[:-1], values[1:])
        element = np.clip(np.searchsorted(-ends, -y, side="right") - 1, 0, len(whole) - 1)
        rest = (ends[element] - y) * _simpson(
            s[element], 1.0 - y, values[element], self.at(values, y)
        )
        return np.concatenate([[0.0], np.cumsum(whole)])[element] + rest


def _simpson(s: Array, s_end: Array, u: Array, u_end: Array) -> Array:
    """Return the mean of s u between points, s and u linear."""
    return (s * u + (s + s_end) * (u + u_end) + s_end * u_end) / 6.0


def uniform(scene: Scene, count: int) -> Contact:
    """Solve on equal elements."""
    return Contact(Linear(count, 1.0), scene)


def graded(scene: Scene, count: int) -> Contact:
    """Solve on graded elements."""
    return Contact(Linear(count, best_power(scene)), scene)


def best_power(scene: Scene) -> float:
    """Return the power that was found best by trial: larger for a thinner layer.

    The search for a stick radius puts the same mesh on the stick disk, where such grading only
    coarsens the rest.
    """
    if scene.friction is not None and math.isfinite(scene.friction):
        return 2.0
    return 2.0 - math.log10(2.0 * min(scene.normal_compliance, 0.5))
