"""Kernels and element integrals that the peers of one dimension share.

Fast forms of the kernels: Carlson's R_D, which the library's tangential kernel takes, is thirty
times slower than complete elliptic integrals, and no peer should be slow for that.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from scipy import special

Array = NDArray[np.float64]
Kernel = Callable[["Places", "Places"], Array]

#: Gauss points on an element where the kernel is smooth. With more of them no error is smaller,
#: nor with a wider neighbourhood.
FAR: Final = 3
#: So many elements on either side of a point are integrated by the graded rule.
NEAR: Final = 2
#: Gauss points of the graded rule on either side of a point, and the power that grades them.
GRADED: Final = 6
POWER: Final = 4
#: Rows that are integrated at a time, so that their arrays stay in the cache of the processor.
ROWS: Final = 16
#: Squared ratios of radii below which K - E is summed as a series.
SMALL: Final = 0.02
_SERIES: Final = np.cumprod(
    [np.pi / 4.0, *((k - 0.5) * (k + 0.5) / (k * (k + 1.0)) for k in range(1, 9))]
)


@dataclass(frozen=True, slots=True)
class Places:
    """Points by radius and by distance from the edge, each to relative accuracy."""

    s: Array
    y: Array

    @classmethod
    def at(cls, from_edge: Any) -> Places:
        """Return the points at these distances from the edge."""
        y = np.asarray(from_edge, dtype=float)
        return cls(1.0 - y, y)

    def __getitem__(self, index: Any) -> Places:
        return Places(self.s[index], self.y[index])


@cache
def gauss(count: int) -> tuple[Array, Array]:
    """Return Gauss's rule on [0, 1]: to find it would take small problems longer than the rest."""
    v, w = np.polynomial.legendre.leggauss(count)
    return (1.0 + v) / 2.0, w / 2.0


def normal(source: Places, target: Places) -> Array:
    """Return K1(eta, s) = (eta/hi) K(rho)."""
    _, hi, m1 = _pair(source, target)
    return np.asarray(source.s / hi * special.ellipkm1(m1))


def tangential(source: Places, target: Places) -> Array:
    """Return K2(eta, s) = (eta/lo) [K(rho) - E(rho)], by a series where the two are close."""
    lo, hi, m1 = _pair(source, target)
    rho = lo / hi
    m = rho * rho
    small = m < SMALL
    safe = np.where(small, 0.5, m)
    difference = (special.ellipkm1(np.where(small, 0.5, m1)) - special.ellipe(safe)) / safe
    difference[small] = np.polynomial.polynomial.polyval(m[small], _SERIES)
    return np.asarray(source.s / hi * rho * difference)


def uniform_pressure(radius: Places, target: Places) -> Array:
    """Return the integral of K1 over a disk, by which a constant pressure on it displaces."""
    lo, hi, m1 = _pair(radius, target)
    beyond = np.where(target.s > radius.s, m1 * special.ellipkm1(m1), 0.0)
    return np.asarray(hi * (special.ellipe((lo / hi) ** 2) - beyond))


def _pair(source: Places, target: Places) -> tuple[Array, Array, Array]:
    """Return lo, hi and 1 - rho**2, in which nothing cancels."""
    lo, hi = np.minimum(source.s, target.s), np.maximum(source.s, target.s)
    gap = np.where(hi > 0.5, np.abs(source.y - target.y), hi - lo)
    return lo, hi, gap / hi * ((hi + lo) / hi)


def integrals(kernel: Kernel, ends: Places, targets: Places) -> Array:
    """Return the integrals of a kernel over all elements, for all targets.

    Parameters
    ----------
    kernel : callable
        `normal` or `tangential`.
    ends : Places, shape (n + 1,)
        Ends of the elements, the radii rising.
    targets : Places, shape (m,)
        Target i lies in element i, or at its inner end.

    Returns
    -------
    ndarray, shape (2, m, n)
        Of the kernel times 1 - x and times x, with x from 0 to 1 on every element; over pi.
    """
    found = np.empty((2, len(targets.s), len(ends.s) - 1))
    v, w = gauss(FAR)
    width = ends.y[:-1] - ends.y[1:]
    source = _inside(ends, np.arange(len(width)), v[:, None])
    for first in range(0, len(targets.s), ROWS):
        rows = slice(first, first + ROWS)
        values = kernel(source, targets[rows, None, None])
        found[0, rows] = np.einsum("iqj,q->ij", values, w * (1.0 - v))
        found[1, rows] = np.einsum("iqj,q->ij", values, w * v)
    _graded(kernel, ends, targets, found)
    found *= width / np.pi
    return found


def _graded(kernel: Kernel, ends: Places, targets: Places, found: Array) -> None:
    """Put in the integrals over the elements around each target."""
    count = len(ends.s) - 1
    i, j = np.divmod(np.arange(len(targets.s) * (2 * NEAR + 1)), 2 * NEAR + 1)
    j += i - NEAR
    i, j = i[(j >= 0) & (j < count)], j[(j >= 0) & (j < count)]
    own = np.clip((ends.y[j] - targets.y[i]) / (ends.y[j] - ends.y[j + 1]), 0.0, 1.0)
    v, w = gauss(GRADED)
    w, v = w * POWER * v ** (POWER - 1), v**POWER
    found[:, i, j] = 0.0
    for reach in (-own, 1.0 - own):
        some = reach != 0.0
        rows, columns, length = i[some], j[some], reach[some]
        x = own[some] + length * v[:, None]
        values = kernel(_inside(ends, columns, x), targets[rows]) * (w[:, None] * np.abs(length))
        found[0, rows, columns] += (values * (1.0 - x)).sum(axis=0)
        found[1, rows, columns] += (values * x).sum(axis=0)


def _inside(ends: Places, element: Array, x: Array) -> Places:
    """Return the points x of elements."""
    inner, outer = ends[element], ends[element + 1]
    return Places(inner.s + (outer.s - inner.s) * x, inner.y + (outer.y - inner.y) * x)
