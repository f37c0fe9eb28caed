"""Tails: a few rings in place of all panels next to a boundary, for points that are far away."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre

from spectral_contact.fields import Array


class Panelled(NamedTuple):
    """A run of panels with the nodes of one rule, or the tail of each of these panels.

    Attributes
    ----------
    order : int
        Number of nodes of a tail.
    distances : ndarray, shape (panels, nodes)
        Distances of the nodes from the boundary.
    rings : ndarray, shape (loads, panels, nodes)
        Loads of the rings at the nodes.
    """

    order: int
    distances: Array
    rings: Array

    def reversed(self) -> Panelled:
        """Return the panels in reverse order."""
        return Panelled(self.order, self.distances[::-1], self.rings[:, ::-1])


class Tails:
    """The tails of a run of panels: from each panel on, all panels up to the boundary.

    The field of a ring at a point that is far away is a smooth function of the ring's place in the
    tail: to all digits, it is the polynomial through its values at Gauss's nodes of the tail. So
    the field of the whole tail is that of loads at these nodes, each of which is the sum of all
    rings' loads times the value of the node's Lagrange polynomial at the ring. The loads are
    computed from the shortest tail to the longest: each takes those of its first panel and of the
    next tail. Tails are ordered from the longest.

    Parameters
    ----------
    lengths : ndarray, shape (panels,)
        Distance from the boundary to the far end of each panel.
    outward : bool
        Whether the boundary is the outer end of the run, towards which its panels shrink; else it
        is the inner end.
    rules : sequence of Panelled
        The same panels with the nodes of each rule.

    Attributes
    ----------
    lengths : ndarray, shape (panels,)
    offsets : ndarray, shape (panels, nodes)
        Offsets of the nodes of the tails outward from the boundary, those of all rules side by
        side.
    rings : ndarray, shape (loads, panels, nodes)
        Loads of the rings there.
    """

    def __init__(self, lengths: Array, outward: bool, rules: Sequence[Panelled]) -> None:
        if not outward:
            lengths = lengths[::-1]
            rules = [panels.reversed() for panels in rules]
        self.lengths = lengths
        self._sign = 1.0 if outward else -1.0
        tails = [self._tails_of(panels) for panels in rules]
        self.offsets = -self._sign * np.hstack([tail.distances for tail in tails])
        self.rings = np.concatenate([tail.rings for tail in tails], axis=-1)

    def _tails_of(self, panels: Panelled) -> Panelled:
        """Return the tails with the nodes of one rule."""
        nodes, weights = legendre.leggauss(panels.order)
        length = self.lengths[:, None]
        distances = length * (1.0 + nodes) / 2.0
        # from values at the nodes of a tail to Legendre coefficients
        legendre_at_nodes = legendre.legvander(nodes, panels.order - 1).T
        to_coefficients = (np.arange(panels.order) + 0.5)[:, None] * legendre_at_nodes
        to_coefficients = to_coefficients * weights

        def interpolation(fractions: Array) -> Array:
            """Return the matrices from values at the nodes to those at fractions of tails."""
            return legendre.legvander(2.0 * fractions - 1.0, panels.order - 1) @ to_coefficients

        from_panel = interpolation(panels.distances / length)
        # the last tail has no next one: its matrix stands for none and is not used
        of_next_tail = np.concatenate([distances[1:], distances[-1:]])
        from_next_tail = interpolation(of_next_tail / length)
        rings = np.einsum("lpn,pnj->lpj", panels.rings, from_panel)
        for k in range(len(self.lengths) - 2, -1, -1):
            rings[:, k] += rings[:, k + 1] @ from_next_tail[k]
        return Panelled(panels.order, distances, rings)

    def distance(self, beyond: Array, z: Array) -> Array:
        """Return the distances of points from all tails, shape (points, panels).

        Parameters
        ----------
        beyond, z : ndarray, shape (points,)
            How far outward of the boundary the points are, and their depths.
        """
        # distance from the boundary, positive on the side on which the tails are
        toward_tail = -self._sign * beyond[:, None]
        gap = np.maximum(np.maximum(toward_tail - self.lengths, -toward_tail), 0.0)
        return np.asarray(np.hypot(gap, z[:, None]))
