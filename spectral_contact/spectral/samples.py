"""Few points on the panels that represent what is smooth in ``x`` at the many Galerkin nodes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from spectral_contact.spectral.jacobi import (
    legendre_expansion_matrix,
    legendre_interpolation_matrix,
)
from spectral_contact.spectral.panels import SAMPLES, LogPanels

__all__ = ["Samples", "root_sums"]

Array = NDArray[np.float64]

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
