"""Quadrature that follows the degrees: as many nodes and sources as a panel's functions need.

Degrees differ by a factor of ten between panels. Galerkin nodes, samples of what is smooth on a
panel, and the points that stand for its functions seen from beyond the boundary cost as much as
all of them together, and not as the highest degree times their number.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from spectral_contact.spectral.abel import TAIL_TERMS, beyond_tail, fall_of_tail
from spectral_contact.spectral.jacobi import (
    gauss_rule,
    legendre_interpolation_matrix,
    legendre_projection_matrix,
    legendre_values,
)
from spectral_contact.spectral.panels import SAMPLES, LogPanels

__all__ = ["GradedNodes", "Sources"]

Array = NDArray[np.float64]

#: Gauss points beyond the degree, so that the analytic factors are integrated to rounding.
_EXTRA = 12


class GradedNodes:
    """Galerkin nodes on panels of these degrees, then on the tail; see `LogPanels.nodes`.

    Parameters
    ----------
    panels : LogPanels
    degrees : tuple of int
        Highest degrees on the panels.
    mirrored : bool
        Cluster at the shallow ends of the panels instead of the deep ones.
    centred : bool
        The first panel begins at the centre of a disk, where the measure has a square root.

    Attributes
    ----------
    d, rest : ndarray
        Distances in (0, 1], and ``1 - d`` to full relative accuracy.
    weights : ndarray
        Weights of ``int_0^1 . dd``.
    start, end : list of ndarray
        Distances in ``x`` to both ends of their panel, of the nodes of every panel.
    samples : ndarray
        Distances at which a function is sampled that is analytic in ``x``, as functions of
        ``d + e`` are: few on every panel, and the nodes of the tail.
    """

    def __init__(
        self,
        panels: LogPanels,
        degrees: tuple[int, ...],
        *,
        mirrored: bool = False,
        centred: bool = False,
    ) -> None:
        h = panels.width
        # half-integrals of functions on both neighbours have square roots at the ends
        around = [degrees[0], *degrees, TAIL_TERMS]
        self.start: list[Array] = []
        self.end: list[Array] = []
        weights: list[Array] = []
        for j in range(panels.panels):
            count = _node_count(max(around[j : j + 3]))
            if centred and j == 0:
                g, w = gauss_rule(count + 8)
                phi = np.pi / 4.0 * (1.0 + g)
                near, far = h * np.sin(phi) ** 2, h * np.cos(phi) ** 2
                weights.append(w * np.pi / 2.0 * h * np.sin(phi) * np.cos(phi))
            else:
                g, w = gauss_rule(count)
                v = (1.0 + g) / 2.0
                near, far = h * v**2, h * (1.0 - g) / 2.0 * (1.0 + v)
                weights.append(w * h * v)
            ends = (near, far) if mirrored or (centred and j == 0) else (far, near)
            self.start.append(ends[0])
            self.end.append(ends[1])
        x = np.concatenate([np.minimum(j * h + a, (j + 1) * h) for j, a in enumerate(self.start)])
        g, w = gauss_rule(_node_count(TAIL_TERMS))
        v = (1.0 + g) / 2.0
        tail = panels.end * (1.0 - v**2 if mirrored else v**2)
        self.d: Array = np.concatenate([np.exp(-x), tail])
        self.rest: Array = np.concatenate([-np.expm1(-x), 1.0 - tail])
        self.weights: Array = np.concatenate(
            [np.exp(-x) * np.concatenate(weights), w * v * panels.end]
        )
        # next to the centre errors that neighbours share are felt most: it is sampled at its nodes
        direct = 1 if centred else 0
        self._direct = len(self.start[0]) if centred else 0
        sampled = np.exp(-panels.sampling(SAMPLES)[direct:]).ravel()
        self.samples: Array = np.concatenate([self.d[: self._direct], sampled, tail])
        self._from_samples = [
            legendre_interpolation_matrix(2.0 * one / h - 1.0, SAMPLES)
            for one in self.start[direct:]
        ]

    def spread(self, values: Array) -> Array:
        """Return what has values at the samples, as columns, at the nodes."""
        start = self._direct
        parts = [values[:start]]
        for block in self._from_samples:
            parts.append(block @ values[start : start + SAMPLES])
            start += SAMPLES
        return np.concatenate([*parts, values[start:]])

    def gathered(self, values: Array) -> Array:
        """Return the transpose of `spread`, of values at the nodes as columns."""
        start = self._direct
        parts = [values[:start]]
        for block in self._from_samples:
            parts.append(block.T @ values[start : start + len(block)])
            start += len(block)
        return np.concatenate([*parts, values[start:]])


def _node_count(degree: int) -> int:
    """Return a count that leaves but rounding of products of half-integrals of this degree."""
    return 2 * degree + max(10, 22 - degree)


class Sources:
    """Functions on panels as charges at points, for what is seen of them beyond the boundary.

    Parameters
    ----------
    panels : LogPanels
        Without root tail.
    degrees : tuple of int
        Highest degrees on the panels; matrices have columns for these functions and the tail.
    """

    def __init__(self, panels: LogPanels, degrees: tuple[int, ...]) -> None:
        h, self._panels = panels.width, panels
        rules = [gauss_rule(n + _EXTRA)[0] for n in degrees]
        #: distances of the points
        self.d: Array = np.concatenate(
            [np.exp(-h * (j + (1.0 + g) / 2.0)) for j, g in enumerate(rules)]
        )
        self._projections = [legendre_projection_matrix(n + _EXTRA, n) for n in degrees]
        self.size = sum(degrees) + len(degrees)

    def _onto(self, values: Array) -> Array:
        """Return integrals ``1/2 dx`` of kernels at the points, as rows, times the functions."""
        result, point, column = np.empty((len(values), self.size)), 0, 0
        scaled = (0.25 * self._panels.width) * values
        for block in self._projections:
            points, columns = block.shape
            np.matmul(
                scaled[:, point : point + points], block, out=result[:, column : column + columns]
            )
            point, column = point + points, column + columns
        return result

    def beyond(self, e: Array) -> Array:
        """Return `abel.beyond` at distances past the boundary, shape (points, functions)."""
        values = self.d / np.sqrt(self.d + e[:, None])
        return np.hstack([self._onto(values), beyond_tail(e, self._panels.end)])

    def fall(self, e: Array) -> tuple[Array, Array]:
        """Return `beyond`, and how much less it is than at the boundary, with nothing cancelling."""
        near, far, end = np.sqrt(self.d), np.sqrt(self.d + e[:, None]), self._panels.end
        plain = np.hstack([self._onto(self.d / far), beyond_tail(e, end)])
        tail = beyond_tail(np.zeros(1), end) - plain[:, -TAIL_TERMS:]
        small = (e > 0.0) & (e < 1e-3 * end)
        tail[small] = fall_of_tail(e[small], end)
        falls = self._onto(near * (e[:, None] / (far * (near + far))))
        return plain, np.hstack([falls, tail])

    def far_fall(self, e: Array) -> Array:
        """Return how ``1/2 int d**power psi dd / sqrt(2 + e - d)`` falls from e = 0, ``e > -1``."""
        power, end = self._panels.power, self._panels.end

        def kernel(source: Array) -> Array:
            near, far = np.sqrt(2.0 - source), np.sqrt(2.0 - source + e[:, None])
            return np.asarray(e[:, None] / (near * far * (near + far)))

        panels = self._onto(self.d ** (1.0 + power) * kernel(self.d))
        g, w = gauss_rule(TAIL_TERMS + 9)
        v = (1.0 + g) / 2.0
        source = end * v**2
        values = w / 2.0 * v * end * source**power * kernel(source)
        return np.hstack([panels, values @ legendre_values(2.0 * v**2 - 1.0, TAIL_TERMS - 1)])
