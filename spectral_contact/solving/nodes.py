"""Chebyshev points on the panels of a history, and what passes through values there."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from spectral_contact.spectral.jacobi import chebyshev_interpolation

__all__ = [
    "chebyshev_nodes",
    "chebyshev_series",
    "chebyshev_value",
    "interpolation_weights",
    "left_out",
    "slope",
]

Array = NDArray[np.float64]

#: Of 19 random contacts the loads under spheres were up to 1.5 times farther off than this says.
_SAFETY = 3.0


@cache
def _points(count: int) -> tuple[Array, Array]:
    """Return the nodes, ascending, and the matrix from values there to Chebyshev coefficients."""
    nodes, fit = chebyshev_interpolation(count)
    found = np.ascontiguousarray(nodes[::-1]), np.ascontiguousarray(fit[:, ::-1])
    for one in found:
        one.setflags(write=False)
    return found


def chebyshev_nodes(count: int) -> Array:
    """Return as many Chebyshev points, ascending."""
    return _points(count)[0]


def chebyshev_series(values: Array) -> Array:
    """Return the Chebyshev coefficients of what passes through values at the nodes."""
    return np.asarray(_points(len(values))[1] @ values)


def chebyshev_value(values: Array, t: Array) -> Array:
    """Return what passes through values at the nodes, at places in [-1, 1]."""
    return np.asarray(chebyshev.chebval(t, chebyshev_series(values)))


def slope(values: Array, t: Array) -> Array:
    """Return its derivative."""
    return np.asarray(chebyshev.chebval(t, chebyshev.chebder(chebyshev_series(values))))


def interpolation_weights(t: Array, count: int) -> Array:
    """Return the weights of the values in the interpolant, (places, nodes)."""
    away = t[:, None] - chebyshev_nodes(count)
    away[away == 0.0] = 1e-300
    weights = _barycentric(count) / away
    return np.asarray(weights / weights.sum(axis=1, keepdims=True))


@cache
def _barycentric(count: int) -> Array:
    """Return the weights of the nodes in the barycentric formula."""
    odd = np.arange(1, 2 * count, 2)
    return np.asarray(np.sin(math.pi * odd / (2 * count)) * (-1.0) ** np.arange(count))


def left_out(values: Array) -> float:
    """Return the estimate of what an interpolant leaves out: its last term, decaying on.

    Next to something singular they hardly decay, and what they leave out adds up.
    """
    terms = np.abs(chebyshev_series(values))
    last, before = float(terms[-2:].max()), float(terms[-4:-2].max())
    rate = min(last / before, 1.0) if before > 0.0 else 1.0
    return _SAFETY * last * math.sqrt(rate) * (1.0 + rate * len(values) / 2.0)
