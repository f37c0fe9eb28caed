"""Galerkin nodes that follow the degrees: as many on a panel as its own functions need.

Degrees differ by a factor of ten between panels. What is smooth on a panel is sampled at fewer
points still.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from spectral_contact.spectral.abel import TAIL_TERMS
from spectral_contact.spectral.cache import BoundedCache
from spectral_contact.spectral.jacobi import (
    chebyshev_interpolation,
    chebyshev_values,
    gauss_rule,
    legendre_interpolation_matrix,
)
from spectral_contact.spectral.panels import SAMPLES, LogPanels
from spectral_contact.threads import cached_property

__all__ = ["FAR_FIT", "FAR_NODES", "GradedNodes", "PlainNodes", "far_values", "graded_nodes"]

Array = NDArray[np.float64]

#: Places, in [-1, 1], that stand for a function on an interval with a singularity as far off as it
#: is wide: the error is 5.8**-24, which is rounding.
FAR_NODES, FAR_FIT = chebyshev_interpolation(24)
#: Nodes on the tail: what is there is seen from any distance to the boundary.
_TAIL_POINTS = 36
#: Further nodes on the panel next to the centre of a disk.
_CENTRAL = 40


_NODES: BoundedCache[tuple[LogPanels, tuple[int, ...]], GradedNodes] = BoundedCache(
    "graded nodes", 48
)


class GradedNodes:
    """Galerkin nodes on panels of these degrees, then on the tail, clustered at both ends of each.

    Parameters
    ----------
    panels : LogPanels
    degrees : tuple of int
        Highest degrees on the panels.
    centred : bool
        The first panel begins at the centre of a disk.

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
        centred: bool = False,
    ) -> None:
        h = panels.width
        # integrals of functions on both neighbours have square roots at the ends of a panel
        around = [degrees[0], *degrees, TAIL_TERMS]
        self.start: list[Array] = []
        self.end: list[Array] = []
        weights: list[Array] = []
        for j in range(panels.panels):
            # next to the centre rounding is felt most, and more nodes average it
            more = _CENTRAL if centred and j == 0 else 0
            g, w = gauss_rule(_node_count(max(around[j : j + 3])) + more)
            phi = np.pi / 4.0 * (1.0 + g)
            self.start.append(h * np.sin(phi) ** 2)
            self.end.append(h * np.cos(phi) ** 2)
            weights.append(w * np.pi / 2.0 * h * np.sin(phi) * np.cos(phi))
        x = np.concatenate([np.minimum(j * h + a, (j + 1) * h) for j, a in enumerate(self.start)])
        g, w = gauss_rule(_TAIL_POINTS)
        phi = np.pi / 4.0 * (1.0 + g)
        tail = panels.end * np.sin(phi) ** 2
        on_tail = w * np.pi / 2.0 * panels.end * np.sin(phi) * np.cos(phi)
        self.d: Array = np.concatenate([np.exp(-x), tail])
        self.rest: Array = np.concatenate([-np.expm1(-x), 1.0 - tail])
        self.weights: Array = np.concatenate([np.exp(-x) * np.concatenate(weights), on_tail])
        # and the centre's panel is sampled at its nodes: what they share would not average
        direct = 1 if centred else 0
        self._direct = len(self.start[0]) if centred else 0
        sampled = np.exp(-panels.sampling(SAMPLES)[direct:]).ravel()
        self.samples: Array = np.concatenate([self.d[: self._direct], sampled, tail])
        self._spread = [2.0 * one / h - 1.0 for one in self.start[direct:]]

    @cached_property
    def from_places(self) -> Array:
        """The matrix to the samples from values at the few places that see what is far off."""
        return far_values(self.samples)

    @cached_property
    def _from_samples(self) -> list[Array]:
        """The matrices from samples to nodes; panels with as many nodes share one."""
        each = {len(one): one for one in self._spread}
        known = {n: legendre_interpolation_matrix(one, SAMPLES) for n, one in each.items()}
        return [known[len(one)] for one in self._spread]

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


class PlainNodes:
    """Points at which everything is evaluated as it is: they are their own samples."""

    def __init__(self, d: Array) -> None:
        self.d = self.samples = d

    @property
    def from_places(self) -> Array:
        """The matrix from values at the few places that see what is far off."""
        return far_values(self.d)

    def spread(self, values: Array) -> Array:
        """Return the values."""
        return values

    def gathered(self, values: Array) -> Array:
        """Return the values."""
        return values


def far_values(d: Array) -> Array:
    """Return the matrix from values at `FAR_NODES`, as distances, to those at other distances."""
    return np.asarray(chebyshev_values(2.0 * d - 1.0, len(FAR_NODES) - 1) @ FAR_FIT)


def graded_nodes(panels: LogPanels, degrees: tuple[int, ...]) -> GradedNodes:
    """Return the nodes of a part (cached); its far end is like the centre of a disk."""
    return _NODES.get((panels, degrees), lambda: GradedNodes(panels, degrees, centred=True))


def _node_count(degree: int) -> int:
    """Return a count that leaves but rounding of products of integrals of this degree."""
    return 2 * degree + max(10, 16 - degree)
