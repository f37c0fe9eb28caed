"""Galerkin nodes that follow the degrees: as many on a panel as its own functions need.

Degrees differ by a factor of ten between panels. What is smooth on a panel is sampled at fewer
points still.
"""

from __future__ import annotations

from itertools import groupby
from typing import TYPE_CHECKING

import numpy as np
from numpy.polynomial.chebyshev import chebvander
from numpy.typing import NDArray

from spectral_contact.spectral.cache import BoundedCache
from spectral_contact.spectral.jacobi import (
    TAIL_TERMS,
    chebyshev_interpolation,
    gauss_rule,
    legendre_expansion_matrix,
    legendre_interpolation_matrix,
)
from spectral_contact.threads import cached_property

if TYPE_CHECKING:
    from spectral_contact.spectral.panels import LogPanels

__all__ = [
    "FAR_FIT",
    "FAR_NODES",
    "SAMPLES",
    "GradedNodes",
    "PlainNodes",
    "Samples",
    "SmoothNodes",
    "far_values",
    "graded_nodes",
    "root_sums",
]

Array = NDArray[np.float64]

#: Gauss points that represent on a panel what is analytic in ``x`` up to an imaginary part of pi,
#: as functions of ``d + e`` are: the error is 6.4**-20 for panels of width 2.
SAMPLES = 20
#: Places, in [-1, 1], that stand for a function on an interval with a singularity as far off as it
#: is wide: the error is 5.8**-24, which is rounding.
FAR_NODES, FAR_FIT = chebyshev_interpolation(24)
#: Nodes on the tail: what is there is seen from any distance to the boundary.
_TAIL_POINTS = 36
#: Further nodes on the panel next to the centre of a disk.
_CENTRAL = 40


_NODES: BoundedCache[tuple[LogPanels, tuple[int, ...]], GradedNodes | SmoothNodes] = BoundedCache(
    "graded nodes", 128
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
            phi = np.pi / 4 * (1.0 + g)
            self.start.append(h * np.sin(phi) ** 2)
            self.end.append(h * np.cos(phi) ** 2)
            weights.append(w * np.pi / 2.0 * h * np.sin(phi) * np.cos(phi))
        x = np.concatenate([np.minimum(j * h + a, (j + 1) * h) for j, a in enumerate(self.start)])
        tail, on_tail = _tail_rule(panels)
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
    def _from_samples(self) -> list[tuple[int, Array]]:
        """How many panels in a row have as many nodes, and the matrix from samples to these."""
        runs = [(len(list(run)), n) for n, run in groupby(map(len, self._spread))]
        each = {len(one): legendre_interpolation_matrix(one, SAMPLES) for one in self._spread}
        return [(count, each[n]) for count, n in runs]

    def spread(self, values: Array) -> Array:
        """Return what has values at the samples, as columns, at the nodes."""
        start, columns = self._direct, values.shape[1]
        parts = [values[:start]]
        for count, block in self._from_samples:
            stop = start + count * SAMPLES
            one = block.astype(values.dtype, copy=False)
            own = one @ values[start:stop].reshape(count, SAMPLES, columns)
            parts.append(own.reshape(count * len(block), columns))
            start = stop
        return np.concatenate([*parts, values[start:]])

    def gathered(self, values: Array) -> Array:
        """Return the transpose of `spread`, of values at the nodes as columns."""
        start, columns = self._direct, values.shape[1]
        parts = [values[:start]]
        for count, block in self._from_samples:
            stop = start + count * len(block)
            one = block.T.astype(values.dtype, copy=False)
            own = one @ values[start:stop].reshape(count, len(block), columns)
            parts.append(own.reshape(count * SAMPLES, columns))
            start = stop
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


class SmoothNodes(PlainNodes):
    """Nodes for what is analytic in ``x``, and on the tail: they are their own samples.

    Attributes are those of `GradedNodes`.
    """

    def __init__(self, panels: LogPanels) -> None:
        _, w = gauss_rule(SAMPLES)
        x, (tail, on_tail) = panels.sampling(SAMPLES).ravel(), _tail_rule(panels)
        super().__init__(np.concatenate([np.exp(-x), tail]))
        self.rest: Array = np.concatenate([-np.expm1(-x), 1.0 - tail])
        on_panels = np.exp(-x) * np.tile(w * panels.width / 2.0, panels.panels)
        self.weights: Array = np.concatenate([on_panels, on_tail])


def _tail_rule(panels: LogPanels) -> tuple[Array, Array]:
    """Return nodes on the tail, clustered at both ends, and weights of ``dd``."""
    g, w = gauss_rule(_TAIL_POINTS)
    phi = np.pi / 4 * (1.0 + g)
    weights = w * np.pi / 2.0 * panels.end * np.sin(phi) * np.cos(phi)
    return panels.end * np.sin(phi) ** 2, weights


def far_values(d: Array) -> Array:
    """Return the matrix from values at `FAR_NODES`, as distances, to those at other distances."""
    return np.asarray(chebvander(2.0 * d - 1.0, len(FAR_NODES) - 1) @ FAR_FIT)


def graded_nodes(panels: LogPanels, degrees: tuple[int, ...]) -> GradedNodes | SmoothNodes:
    """Return the nodes of a part (cached), without degrees for what is smooth.

    The far end of a part is like the centre of a disk.
    """

    def made() -> GradedNodes | SmoothNodes:
        return GradedNodes(panels, degrees, centred=True) if degrees else SmoothNodes(panels)

    return _NODES.get((panels, degrees), made)


def _node_count(degree: int) -> int:
    """Return a count that leaves but rounding of products of integrals of this degree."""
    return 2 * degree + max(10, 16 - degree)


#: Entries of a kernel that are evaluated at a time: they stay in the cache.
_STRIP = 32768


class Samples:
    """`SAMPLES` points on every panel, and the nodes of the tail.

    On every panel a function has to be analytic in ``x`` up to an imaginary part of pi.

    Parameters
    ----------
    panels : LogPanels
    nodes : ndarray
        Distances of the Galerkin nodes.
    offsets : tuple of ndarray
        ``x`` of the nodes on the first panel, and on any other from its shallow end on.
    """

    def __init__(self, panels: LogPanels, nodes: Array, offsets: tuple[Array, Array]) -> None:
        self.panels = panels
        self._first, self._other = (
            legendre_interpolation_matrix(2.0 * x / panels.width - 1.0, SAMPLES) for x in offsets
        )
        tail = nodes[-panels.node_counts[1] :]
        #: distances of the points, falling
        self.distances: Array = np.concatenate(
            [np.exp(-panels.sampling(SAMPLES)).ravel(), tail[::-1]]
        )

    def interpolate(self, values: Array) -> Array:
        """Return a function at the nodes from its values at the points, (nodes, ...)."""
        count = self.panels.panels
        # any trailing axis of the values (several functions at once) is carried along
        trailing = values.shape[1:]
        samples = values[: count * SAMPLES].reshape(count, SAMPLES, -1)
        first, others = self._first @ samples[0], self._other @ samples[1:]
        tail = values[count * SAMPLES :][::-1]
        parts = [first.reshape(-1, *trailing), others.reshape(-1, *trailing), tail]
        return np.concatenate(parts)

    def gather(self, weights: Array) -> Array:
        """Return weights of the points that make the same sums as these of the nodes."""
        start = len(self._first)
        stop = start + (self.panels.panels - 1) * len(self._other)
        others = weights[start:stop].reshape(-1, len(self._other)) @ self._other
        return np.concatenate([weights[:start] @ self._first, others.ravel(), weights[stop:][::-1]])

    def unresolved(self, values: Array) -> float:
        """Return the last two coefficients at their largest: what is left out is less."""
        count = self.panels.panels
        samples = values[: count * SAMPLES].reshape(count, SAMPLES, -1)
        last = legendre_expansion_matrix(SAMPLES, SAMPLES - 1)[-2:]
        return float(np.abs(last @ samples).sum(axis=1).max())


def root_sums(near: Array, far: Array, values: Array, offset: Array | None = None) -> Array:
    """Return ``sum_j values_j / sqrt(near_i + far_j)``, in strips that fit the cache.

    Several columns of values share the square roots.

    With `offset` each term is divided by ``sqrt(near_i + far_j) + offset_j`` as well.

    Parameters
    ----------
    near : ndarray, shape (n,)
    far : ndarray, shape (m,)
    values : ndarray, shape (m,) or (m, k)
    offset : ndarray, shape (m,), optional

    Returns
    -------
    ndarray, shape (n,) or (n, k)
    """
    sums = np.empty((len(near), *values.shape[1:]))
    strip = max(_STRIP // max(len(far), 1), 1)
    work = np.empty((min(strip, len(near)), len(far)))
    spare = np.empty_like(work)
    for start in range(0, len(near), strip):
        part = near[start : start + strip, None]
        roots = np.add(part, far, out=work[: len(part)])
        np.sqrt(roots, out=roots)
        if offset is not None:
            roots *= np.add(roots, offset, out=spare[: len(part)])
        np.matmul(np.reciprocal(roots, out=roots), values, out=sums[start : start + strip])
    return sums
