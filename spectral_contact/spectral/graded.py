"""Galerkin nodes that follow the degrees: as many on a panel as its own functions need.

Degrees differ by a factor of ten between panels. What is smooth on a panel is sampled at fewer
points still.
"""

from __future__ import annotations

from itertools import groupby
from math import ceil
from typing import TYPE_CHECKING

import numpy as np
from numpy.polynomial.chebyshev import chebvander
from numpy.typing import NDArray

from spectral_contact.spectral.cache import bounded_cache
from spectral_contact.spectral.jacobi import (
    TAIL_TERMS,
    chebyshev_interpolation,
    gauss_rule,
    legendre_interpolation_matrix,
)
from spectral_contact.threads import cached_property

if TYPE_CHECKING:
    from spectral_contact.spectral.panels import LogPanels

Array = NDArray[np.float64]

#: Gauss points that represent on a panel what is analytic in ``x`` up to an imaginary part of pi,
#: as functions of ``d + e`` are: the error is 6.4**-20 for panels of width 2.
SAMPLES = 20
#: Places, in [-1, 1], that stand for a function on an interval with a singularity as far off as it
#: is wide: the error is 5.8**-24, which is rounding.
FAR_NODES, FAR_FIT = chebyshev_interpolation(24)
#: Nodes on the tail, as many as some panel has: what is there is seen from any distance.
_TAIL_POINTS = 48


class GradedNodes:
    """Galerkin nodes on panels of these degrees, then on the tail, clustered at both ends of each.

    The far end of a part is like the centre of a disk.

    Parameters
    ----------
    panels : LogPanels
    degrees : tuple of int
        Highest degrees on the panels.

    Attributes
    ----------
    d, rest : ndarray
        Distances in (0, 1], and ``1 - d`` to full relative accuracy.
    weights : ndarray
        Weights of ``int_0^1 . dd``.
    start : list of ndarray
        Distances in ``x`` to the shallow end of their panel, of the nodes of every panel.
    """

    def __init__(self, panels: LogPanels, degrees: tuple[int, ...]) -> None:
        self.panels, self.degrees, h = panels, degrees, panels.width
        # integrals of functions on both neighbours have square roots at the ends of a panel
        around = [degrees[0] + 1, *degrees, TAIL_TERMS]  # at the centre the measure has one, too
        counts = [_node_count(max(around[j : j + 3])) for j in range(panels.panels)]
        rules = [clustered_rule(count, h) for count in counts]
        self.start: list[Array] = [start for start, _ in rules]
        weights = np.concatenate([own for _, own in rules])
        x = np.concatenate([np.minimum(j * h + a, (j + 1) * h) for j, a in enumerate(self.start)])
        self.tail, on_tail = _tail_rule(panels)
        d = np.exp(-x)
        self.d: Array = np.concatenate([d, self.tail])
        self.rest: Array = np.concatenate([-np.expm1(-x), 1.0 - self.tail])
        self.weights: Array = np.concatenate([d * weights, on_tail])
        # the centre's panel is sampled at its nodes: what they share would not average
        self._direct = counts[0]

    @cached_property
    def samples(self) -> Array:
        """Distances at which a function is sampled that is analytic in ``x``, falling.

        As functions of ``d + e`` are: few on every panel, and the nodes of the tail.
        """
        sampled = np.exp(-self.panels.sampling(SAMPLES)[1:]).ravel()
        return np.concatenate([self.d[: self._direct], sampled, self.tail])

    @cached_property
    def from_places(self) -> Array:
        """The matrix to the samples from values at the few places that see what is far off."""
        return far_values(self.samples)

    @cached_property
    def _from_samples(self) -> list[tuple[int, Array]]:
        """How many panels in a row have as many nodes, and the matrix from samples to these."""
        runs = [(len(list(run)), n) for n, run in groupby(map(len, self.start[1:]))]
        return [(count, from_samples(n, self.panels.width)) for count, n in runs]

    def spread(self, values: Array) -> Array:
        """Return what has values at the samples, as columns, at the nodes."""
        return self._mapped(values, self._from_samples)

    def gathered(self, values: Array) -> Array:
        """Return the transpose of `spread`, of values at the nodes as columns."""
        return self._mapped(values, [(count, one.T) for count, one in self._from_samples])

    def _mapped(self, values: Array, matrices: list[tuple[int, Array]]) -> Array:
        start, columns = self._direct, values.shape[1]
        parts = [values[:start]]
        for count, matrix in matrices:
            stop = start + count * matrix.shape[1]
            one = matrix.astype(values.dtype, copy=False)
            own = one @ values[start:stop].reshape(count, matrix.shape[1], columns)
            parts.append(own.reshape(count * len(matrix), columns))
            start = stop
        return np.concatenate([*parts, values[start:]])


graded_nodes = bounded_cache("graded nodes", 128)(GradedNodes)


class PlainNodes:
    """Points at which everything is evaluated as it is: they are their own samples."""

    def __init__(self, d: Array) -> None:
        self.d = self.samples = d

    @property
    def from_places(self) -> Array:
        """The matrix from values at the few places that see what is far off."""
        return far_values(self.d)


@bounded_cache("clustered rules", 24)
def clustered_rule(points: int, width: float) -> tuple[Array, Array]:
    """Return a rule on (0, width) for functions with square roots at both ends (cached)."""
    g, w = gauss_rule(points)
    phi = np.pi / 4 * (1.0 + g)
    sine, cosine = np.sin(phi), np.cos(phi)
    return width * sine**2, width * (w * np.pi / 2.0 * sine * cosine)


@bounded_cache("from samples", 24)
def from_samples(points: int, width: float) -> Array:
    """Return the matrix from the samples of a panel to so many nodes (cached)."""
    places = 2.0 * clustered_rule(points, width)[0] / width - 1.0
    return legendre_interpolation_matrix(places, SAMPLES)


def _tail_rule(panels: LogPanels) -> tuple[Array, Array]:
    """Return nodes on the tail, falling, and weights of ``dd``.

    They are seen from past the boundary, from as near as may be: next to it they are dense.
    """
    g, w = gauss_rule(_TAIL_POINTS)
    phi = np.pi / 4 * (1.0 - g)
    sine, end = np.sin(phi), panels.end
    return end * sine**4, w * np.pi * end * sine**3 * np.cos(phi)


def far_values(d: Array) -> Array:
    """Return the matrix from values at `FAR_NODES`, as distances, to those at other distances."""
    return np.asarray(chebvander(2.0 * d - 1.0, len(FAR_NODES) - 1) @ FAR_FIT)


def _node_count(degree: int) -> int:
    """Return a count that leaves but rounding of products of integrals of this degree.

    With 16 more than twice the degree entries of the Gram matrix are right to 1.5e-14 (with 10 up
    to 3e-9 of low degrees are lost); at the centre it takes 18. Few distinct counts share blocks.
    """
    return 16 * ceil(degree / 8 + 1)


def highest_degree(count: int) -> int:
    """Return the highest degree that so many nodes are for."""
    return count // 2 - 8


#: Entries of a kernel that are evaluated at a time: they stay in the cache.
_STRIP = 32768


def root_sums(near: Array, far: Array, values: Array, offset: Array | None = None) -> Array:
    """Return ``sum_j values_j / sqrt(near_i + far_j)``, shape (n,) or (n, k).

    It takes strips that fit the cache; several columns of values, (m, k), share the square roots.
    With `offset`, (m,), each term is divided by ``sqrt(near_i + far_j) + offset_j`` as well.
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
