"""Nystrom's method with product integration, the logarithm of the kernels split off.

K = L log|eta - s| + M with smooth L and M, on Gauss-Legendre panels graded geometrically to the
edge and to the centre; polynomials times the logarithm are integrated exactly on a panel and its
neighbours, everything else by Gauss's rule (K. E. Atkinson, The Numerical Solution of Integral
Equations of the Second Kind, 1997, section 4.2; graded panels as in J. Helsing and R. Ojala,
J. Comput. Phys. 227, 2008).

Traps: a log-split on one global rule, or on equal panels, is held to low order by the edge, where
the pressure has terms y log y, and by the centre, where L is singular at eta = -s. So are the
coefficients of L for K2 far from the diagonal: split on neighbouring panels only.

Solver: ``nystrom:solver``; the resolution is the number of points of a panel.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Final

import numpy as np
from contact import Contact, Disk
from elements import Array, Kernel, Places, gauss, normal, tangential
from scipy import special

from spectral_contact import Scene

#: Each panel is so much narrower than its neighbour away from the centre or the edge.
RATIO: Final = 0.25
#: Panels to the edge for each point of a panel, and to the centre.
TO_EDGE, TO_CENTRE = 1.25, 0.3


def _normal_logarithm(source: Places, target: Places) -> Array:
    """Return the coefficient of log|eta - s| in K1."""
    total = source.s + target.s
    return -2.0 / np.pi * source.s / total * special.ellipk((_gap(source, target) / total) ** 2)


def _tangential_logarithm(source: Places, target: Places) -> Array:
    """Return the coefficient of log|eta - s| in K2."""
    total = source.s + target.s
    m1 = (_gap(source, target) / total) ** 2
    bracket = 2.0 / (1.0 - m1) * special.ellipe(m1) - special.ellipk(m1)
    return -2.0 / np.pi * source.s / total * bracket


def _gap(source: Places, target: Places) -> Array:
    return np.where(source.s > 0.5, np.abs(source.y - target.y), np.abs(source.s - target.s))


#: By kernel: the coefficient of the logarithm, and what its limit lacks of log 8s.
LOGARITHMS = {normal: (_normal_logarithm, 0.0), tangential: (_tangential_logarithm, 2.0)}


class Panels(Disk):
    """Values at the Gauss points of graded panels."""

    def __init__(self, count: int) -> None:
        edge = 0.5 * RATIO ** np.arange(round(TO_EDGE * count) + 1)
        centre = 0.5 * RATIO ** np.arange(1, round(TO_CENTRE * count) + 1)
        low = np.concatenate([[0.0], centre[::-1]])
        self.ends = Places(
            np.concatenate([low, 1.0 - edge, [1.0]]), np.concatenate([1.0 - low, edge, [0.0]])
        )
        x, self._w = gauss(count)
        x = x[:, None]
        inner, outer = self.ends[:-1], self.ends[1:]
        self._width = np.where(inner.s < 0.5, outer.s - inner.s, inner.y - outer.y)
        self.nodes = Places(
            (inner.s + self._width * x).T.ravel(), (outer.y + self._width * (1.0 - x)).T.ravel()
        )
        self._weights = (self._width[:, None] * self._w).ravel()
        self._legendre = np.linalg.inv(
            np.polynomial.legendre.legvander(2.0 * x[:, 0] - 1.0, count - 1)
        )

    def matrix(self, kernel: Kernel) -> Array:
        """Split off the logarithm; on the diagonal K + log|eta - s|/2 is (log 8s - less)/2."""
        logarithm, less = LOGARITHMS[kernel]
        nodes, count, width = self.nodes, len(self._w), self._width
        found = kernel(nodes, nodes[:, None])
        np.fill_diagonal(found, 0.0)
        found *= self._weights
        # on a panel itself Gauss's rule has the limit of M in place of K
        limit = (np.log(8.0 * nodes.s / np.repeat(width / 2.0, count)) - less) / 2.0
        found[np.diag_indices_from(found)] = limit * self._weights
        blocks = found.reshape(len(width), count, len(width), count)
        points = Places(nodes.s.reshape(-1, count), nodes.y.reshape(-1, count))
        for side in (-1, 0, 1):
            panel = np.arange(max(0, -side), len(width) - max(0, side))
            target = panel + side
            ratios = np.round(width[target] / width[panel], 12)
            change = np.array([log_weights(count, side, ratio) for ratio in ratios])
            change *= logarithm(points[panel, None], points[target, :, None])
            blocks[target, :, panel] += change * (width[panel, None, None] / 2.0)
        return found / np.pi

    def at(self, values: Array, y: Array) -> Array:
        """Evaluate the polynomials of the panels."""
        panel, x = self._located(y)
        rows = np.polynomial.legendre.legvander(x, len(self._w) - 1)
        series = values.reshape(-1, len(self._w)) @ self._legendre.T
        return np.einsum("ik,ik->i", rows, series[panel])

    def moment(self, values: Array, y: Array) -> Array:
        """Integrate the polynomials of the panels."""
        parts = (self.nodes.s * values).reshape(-1, len(self._w))
        whole = np.concatenate([[0.0], np.cumsum(parts @ self._w * self._width)])
        panel, x = self._located(y)
        series = np.polynomial.legendre.legint(self._legendre @ parts.T, lbnd=-1.0)
        rows = np.polynomial.legendre.legvander(x, len(self._w))
        return whole[panel] + np.einsum("ik,ki->i", rows, series[:, panel]) * (
            self._width[panel] / 2.0
        )

    def _located(self, y: Array) -> tuple[Array, Array]:
        """Return the panel of each point, and where in [-1, 1] of it."""
        panel = np.clip(
            np.searchsorted(-self.ends.y, -y, side="right") - 1, 0, len(self._width) - 1
        )
        return panel, 2.0 * (self.ends.y[panel] - y) / self._width[panel] - 1.0


@lru_cache(maxsize=64)
def log_weights(count: int, side: int, ratio: float) -> Array:
    """Return what Gauss's rule on [-1, 1] lacks for the logarithm of the distance to Gauss points.

    Parameters
    ----------
    count : int
        Gauss points, of the panel and of that where the targets are.
    side : int
        Where these are: 0 on the panel itself, -1 and 1 on the one before and after it.
    ratio : float
        Width of theirs over that of the panel.

    Returns
    -------
    ndarray, shape (count, count)
        Rows are targets: weights exact for polynomials times the logarithm, less Gauss's times the
        logarithm, which are zero where that is infinite.
    """
    x, w = gauss(count)
    g, w = 2.0 * x - 1.0, 2.0 * w
    targets = g if side == 0 else side * (1.0 + ratio * (1.0 + side * g))
    lagrange = np.linalg.inv(np.polynomial.legendre.legvander(g, count - 1))
    nearest = np.clip(targets, -1.0, 1.0)[:, None]
    reach, weights = _graded(nearest, count)
    logarithms = np.log(np.abs(targets[:, None] - nearest) + np.abs(reach)) * weights
    rows = np.polynomial.legendre.legvander(nearest + reach, count - 1)
    exact = np.einsum("iq,iqk->ik", logarithms, rows) @ lagrange
    gap = np.abs(targets[:, None] - g)
    return exact - w * np.log(gap, out=np.zeros_like(gap), where=gap > 0.0)


def _graded(towards: Array, count: int) -> tuple[Array, Array]:
    """Return a rule on [-1, 1] for each point in it, graded geometrically, by steps from there."""
    ends = np.concatenate([[0.0], 0.2 ** np.arange(24, -1.0, -1.0)])
    v, w = gauss(count // 2 + 8)
    v = (ends[:-1, None] + np.diff(ends)[:, None] * v).ravel()
    w = (np.diff(ends)[:, None] * w).ravel()
    below, above = 1.0 + towards, 1.0 - towards
    return np.hstack([-below * v, above * v]), np.hstack([below * w, above * w])


def solver(scene: Scene, count: int) -> Contact:
    """Solve with that many points on every panel, and the more panels the more points."""
    return Contact(Panels(count), scene)
