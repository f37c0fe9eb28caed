"""Tails: what all panels next to a boundary carry, at a few nodes, for points that are far away."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre

from spectral_contact.fields import Array


class Panelled(NamedTuple):
    """Panels with the nodes of one rule, and how many nodes a tail has with it.

    Attributes
    ----------
    order : int
    away : ndarray, shape (panels, nodes)
        How far the nodes are from the boundary.
    rings : ndarray, shape (loads, panels, nodes)
        What their rings carry.
    """

    order: int
    away: Array
    rings: Array

    def turned(self) -> Panelled:
        """Return the panels in reverse order."""
        return Panelled(self.order, self.away[::-1], self.rings[:, ::-1])


class Tails:
    """For each panel of a run, it and all panels beyond, up to the boundary, as one row of rings.

    What rings do at a point that is far away is smooth over the tail. So it is replaced by the
    polynomial through its values at Gauss's nodes of the tail, and what the rings of the panels
    carry is handed to these nodes, from the boundary outward. Tails are ordered from the longest.

    Parameters
    ----------
    lengths : ndarray, shape (panels,)
        How far the far end of each panel is from the boundary.
    outward : bool
        Whether the panels shrink outward, towards the last; else towards the first.
    rules : sequence of Panelled
        The same panels with the nodes of each rule.

    Attributes
    ----------
    lengths : ndarray, shape (panels,)
    away : ndarray, shape (panels, nodes)
        How far outward of the boundary the nodes of the tails are, those of all rules side by side.
    rings : ndarray, shape (loads, panels, nodes)
        What the rings there carry.
    """

    def __init__(self, lengths: Array, outward: bool, rules: Sequence[Panelled]) -> None:
        if not outward:
            lengths, rules = lengths[::-1], [one.turned() for one in rules]
        self.lengths, self._sign = lengths, 1.0 if outward else -1.0
        tails = [self._handed(one) for one in rules]
        self.away = -self._sign * np.hstack([one.away for one in tails])
        self.rings = np.concatenate([one.rings for one in tails], axis=-1)

    def _handed(self, rule: Panelled) -> Panelled:
        """Return the nodes of the tails with one rule, and what is handed to them."""
        nodes, weights = legendre.leggauss(rule.order)
        size = self.lengths[:, None]
        away = size * (1.0 + nodes) / 2.0
        own = rule.away / size
        inner = np.concatenate([away[1:], away[-1:]]) / size
        project = (np.arange(rule.order) + 0.5)[:, None] * legendre.legvander(
            nodes, rule.order - 1
        ).T
        project = project * weights
        hand = [legendre.legvander(2.0 * x - 1.0, rule.order - 1) @ project for x in (own, inner)]
        rings = np.einsum("lpn,pnj->lpj", rule.rings, hand[0])
        for at in range(len(self.lengths) - 2, -1, -1):
            rings[:, at] += rings[:, at + 1] @ hand[1][at]
        return Panelled(rule.order, away, rings)

    def distance(self, beyond: Array, z: Array) -> Array:
        """Return how far points so far outward of the boundary are, shape (points, panels)."""
        before = -self._sign * beyond[:, None]
        gap = np.maximum(np.maximum(before - self.lengths, -before), 0.0)
        return np.asarray(np.hypot(gap, z[:, None]))
