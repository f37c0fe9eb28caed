r"""A stretch of the history of a contact, in a logarithm that knows where something began.

Flat solutions are smooth functions of the radius ``b`` but for poles at negative radii, beyond
some compliance ``c`` of the layer, and for the radii at which slip begins or a profile bends. In
``x = ln(b - origin)``, with the origin at ``-c`` or next to such a radius, the nearest singularity
is ``pi`` away wherever the stretch is, and few Chebyshev points serve many decades of ``b``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from spectral_contact.solving.nodes import chebyshev_nodes
from spectral_contact.threads import cached_property

__all__ = ["RadiusStretch"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class RadiusStretch:
    """Contact radii between two, at Chebyshev points in ``x = ln(b - origin)``.

    Depths are ``x`` from the lower end.

    Attributes
    ----------
    low, high : float
        Logarithms ``u`` of the radii.
    bend : float
        ``dx/du = b/(b - origin)`` at the lower end; 1 where ``x`` is ``u``.
    count : int
        Of the points.
    """

    low: float
    high: float
    bend: float = 1.0
    count: int = 0

    @cached_property
    def extent(self) -> float:
        """Its length in ``x``."""
        return math.log1p(self.bend * math.expm1(self.high - self.low))

    @cached_property
    def logs(self) -> Array:
        """``u`` of the points."""
        return self.log_radius_at(chebyshev_nodes(self.count))

    def depth(self, t: Array) -> Array:
        """Return the depths of places in [-1, 1]."""
        return np.asarray(self.extent * (1.0 + t) / 2.0)

    def place(self, depth: Array) -> Array:
        """Return the places in [-1, 1]."""
        return np.asarray(np.clip(2.0 * depth / self.extent - 1.0, -1.0, 1.0))

    def depth_of(self, u: Array) -> Array:
        """Return the depths of radii that are not below the stretch."""
        return np.asarray(np.log1p(self.bend * np.expm1(np.maximum(u - self.low, 0.0))))

    def place_of(self, u: Array) -> Array:
        """Return the places in [-1, 1] of radii."""
        return self.place(self.depth_of(u))

    def before(self, u: Array) -> Array:
        """Return how far in ``x`` radii are below the stretch; infinite below the origin."""
        left = 1.0 + self.bend * np.expm1(np.minimum(u - self.low, 0.0))
        with np.errstate(divide="ignore"):
            return np.asarray(-np.log(np.maximum(left, 0.0)))

    def log_radius(self, depth: Array) -> Array:
        """Return ``u``."""
        return np.asarray(self.low + self.ahead(np.zeros(1), depth))

    def log_radius_at(self, t: Array) -> Array:
        """Return ``u`` at places in [-1, 1]."""
        return self.log_radius(self.depth(t))

    def bends(self, depth: Array) -> Array:
        """Return ``dx/du``."""
        return np.asarray(self.bend * np.exp(-depth) - np.expm1(-depth))

    def bends_at(self, t: Array) -> Array:
        """Return ``dx/du`` at places in [-1, 1]."""
        return self.bends(self.depth(t))

    def ahead(self, depth: Array, step: Array) -> Array:
        """Return by how much ``u`` grows with ``x`` from there, to rounding of the step."""
        return np.asarray(np.log1p(np.expm1(step) / self.bends(depth)))

    def step(self, depth: Array, ahead: Array) -> Array:
        """Return by how much ``x`` grows with ``u`` from there."""
        return np.asarray(np.log1p(np.expm1(ahead) * self.bends(depth)))

    def cut(self, pieces: int) -> list[RadiusStretch]:
        """Return pieces that are as long as each other."""
        return self.cut_at(self.extent * np.arange(pieces) / pieces)

    def cut_at(self, depths: Array) -> list[RadiusStretch]:
        """Return the pieces that begin at these depths, the first of which is 0."""
        ends = [*self.log_radius(depths).tolist(), self.high]
        bends = self.bends(depths).tolist()
        return [RadiusStretch(*one) for one in zip(ends[:-1], ends[1:], bends, strict=True)]
