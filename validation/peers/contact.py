"""The three contact problems, for any method that has matrices of both kernels on the unit disk.

All of them are posed at nodes: (3.5), (4.2) and (5.8) of the paper, kappa from the scene. The
kernels are homogeneous of degree 0, so the stick condition on a disk of radius c is that of the
unit disk with beta/c. One matrix of each kernel serves all radii that the search for c tries.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from functools import cached_property
from typing import Any

import numpy as np
from elements import Array, Kernel, Places, normal, tangential
from scipy.optimize import brentq

from spectral_contact import Scene


class Disk(ABC):
    """A method on the unit disk: nodes, functions by their values there, and matrices.

    Attributes
    ----------
    nodes : Places
    """

    nodes: Places

    @cached_property
    def normal(self) -> Array:
        """The matrix of N = (1/pi) int K1, from values at nodes to values at nodes."""
        return self.matrix(normal)

    @cached_property
    def tangential(self) -> Array:
        """The matrix of T = (1/pi) int K2."""
        return self.matrix(tangential)

    @abstractmethod
    def matrix(self, kernel: Kernel) -> Array:
        """Return the matrix of the integral of a kernel, over pi."""

    @abstractmethod
    def at(self, values: Array, y: Array) -> Array:
        """Return the function of these values at distances from the edge."""

    @abstractmethod
    def moment(self, values: Array, y: Array) -> Array:
        """Return the integral of eta times the function, from the centre."""


class Contact:
    """What a method makes of a scene; a solution as studies take it.

    It takes for granted that slip is outside of one stick disk, which this library finds out.

    Attributes
    ----------
    approach, total_shear, stick_radius : float
        The second one with friction, the last one with slip.
    unknowns : int
    """

    def __init__(self, disk: Disk, scene: Scene) -> None:
        self._disk, self._scene = disk, scene
        self.unknowns = len(disk.nodes.s)
        equations = disk.normal + scene.normal_compliance * np.eye(self.unknowns)
        unit = np.linalg.solve(equations, np.ones(self.unknowns))
        self.approach = 1.0 / (2.0 * np.pi * float(disk.moment(unit, np.zeros(1))[0]))
        self._p = unit * self.approach
        if scene.friction is not None:
            self._radius = 1.0
            if np.isfinite(scene.friction):
                self._radius = self.stick_radius = self._searched()
            self._q = self._stick(self._radius)
            inner = float(disk.moment(self._q, np.zeros(1))[0]) * self._radius**2
            self.total_shear = 2.0 * np.pi * inner
            if self._radius < 1.0:
                within = float(disk.moment(self._p, np.array([1.0 - self._radius]))[0])
                self.total_shear += scene.friction * (1.0 - 2.0 * np.pi * within)

    def pressure(self, *, from_edge: Any) -> Array:
        """Return the pressure at distances from the edge."""
        return self._disk.at(self._p, np.asarray(from_edge, dtype=float))

    def traction(self, *, from_edge: Any) -> Array:
        """Return the radial traction at distances from the edge."""
        y = np.asarray(from_edge, dtype=float)
        c = self._radius
        if c == 1.0:
            return self._disk.at(self._q, y)
        inside = self._disk.at(self._q, np.maximum(y - (1.0 - c), 0.0) / c)
        return np.where(y >= 1.0 - c, inside, self._scene.friction * self.pressure(from_edge=y))

    @cached_property
    def _displaced(self) -> Array:
        """What the whole pressure, taken for a traction, would displace at the nodes."""
        return self._disk.tangential @ self._p

    def _stick(self, c: float) -> Array:
        """Return the traction on a stick disk of radius c, at the nodes scaled to it."""
        disk, friction = self._disk, self._scene.friction
        y = (1.0 - c) + c * disk.nodes.y
        s = c * disk.nodes.s
        moment = disk.moment(self._p, y)
        right = self._scene.kappa * np.divide(moment, s, out=np.zeros_like(s), where=s > 0.0)
        if c < 1.0:  # what slips outside displaces, and that is the whole less what is inside
            inside = c * (disk.tangential @ disk.at(self._p, y))
            right -= friction * (disk.at(self._displaced, y) - inside)
        equations = c * disk.tangential
        equations[np.diag_indices_from(equations)] += self._scene.tangential_compliance
        return np.linalg.solve(equations, right)

    def _searched(self) -> float:
        """Return the radius of a stick disk at the rim of which the traction is continuous."""
        edge, friction = np.zeros(1), self._scene.friction

        def jump(logit: float) -> float:
            c = 1.0 / (1.0 + np.exp(-logit))
            rim = self._disk.at(self._p, np.array([1.0 - c]))
            return float((self._disk.at(self._stick(c), edge) / rim)[0]) - friction

        logit = brentq(jump, -6.0, 6.0, xtol=1e-12, rtol=1e-12)
        return float(1.0 / (1.0 + np.exp(-logit)))
