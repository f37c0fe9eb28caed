"""Tails: what all panels next to a boundary carry, at a few nodes, for points that are far away."""

from __future__ import annotations

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

__all__ = ["Tails"]

Array = NDArray[np.float64]


class Tails:
    """For each panel of a run, it and all panels beyond, up to the boundary, as one row of rings.

    What rings do at a point that is far away is smooth over the tail. So it is replaced by the
    polynomial through its values at Gauss's nodes of the tail, and what the rings of the panels
    carry is handed to these nodes, from the boundary outward. Tails are ordered from the longest.

    Parameters
    ----------
    s, d : ndarray, shape (panels + 1,)
        Ends of the panels, from the centre and from the edge.
    outward : bool
        Whether the panels shrink towards the last of the ends; else towards the first.
    order : int
        Nodes of a tail.
    panel_s, panel_d : ndarray, shape (panels, nodes)
        Nodes of the panels.
    rings : ndarray, shape (2, panels, nodes)
        What their rings carry.

    Attributes
    ----------
    lengths : ndarray, shape (panels,)
    s, d : ndarray, shape (panels, order)
        Nodes of the tails.
    rings : ndarray, shape (2, panels, order)
        What the rings there carry.
    """

    def __init__(
        self,
        s: Array,
        d: Array,
        outward: bool,
        order: int,
        panel_s: Array,
        panel_d: Array,
        rings: Array,
    ) -> None:
        if not outward:
            s, d = s[::-1], d[::-1]
            panel_s, panel_d, rings = panel_s[::-1], panel_d[::-1], rings[:, ::-1]
        self._sign = 1.0 if outward else -1.0
        self._s, self._d = s[-1], d[-1]
        self.lengths = self._sign * self._before(s[:-1], d[:-1])
        nodes, weights = legendre.leggauss(order)
        away = self.lengths[:, None] * (1.0 + nodes) / 2.0
        self.s, self.d = self._s - self._sign * away, self._d + self._sign * away
        size = self.lengths[:, None]
        own = self._sign * self._before(panel_s, panel_d) / size
        inner = np.concatenate([away[1:], away[-1:]]) / size
        project = (np.arange(order) + 0.5)[:, None] * legendre.legvander(nodes, order - 1).T
        project = project * weights
        hand = [legendre.legvander(2.0 * x - 1.0, order - 1) @ project for x in (own, inner)]
        self.rings = np.einsum("lpn,pnj->lpj", rings, hand[0])
        for at in range(len(self.lengths) - 2, -1, -1):
            self.rings[:, at] += self.rings[:, at + 1] @ hand[1][at]

    def _before(self, s: Array, d: Array) -> Array:
        """Return how far radii are before the boundary; negative beyond."""
        return np.asarray(np.where(s > 0.5, d - self._d, self._s - s))

    def distance(self, r: Array, from_edge: Array, z: Array) -> Array:
        """Return how far points are from the tails, shape (points, panels)."""
        before = self._sign * self._before(r, from_edge)[:, None]
        gap = np.maximum(np.maximum(before - self.lengths, -before), 0.0)
        return np.asarray(np.hypot(gap, z[:, None]))
