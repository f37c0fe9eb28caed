"""Composite Gauss–Legendre rule: for integrands that a substitution has made smooth."""

import math
from functools import lru_cache

import numpy as np

from ._inputs import Array

_NODES_PER_PANEL = 24


@lru_cache(maxsize=1)
def _reference_rule() -> tuple[Array, Array]:
    nodes, weights = np.polynomial.legendre.leggauss(_NODES_PER_PANEL)
    return np.asarray(nodes, dtype=np.float64), np.asarray(weights, dtype=np.float64)


def panel_rule(lower: float, upper: float, width: float = 1.0) -> tuple[Array, Array]:
    """Return nodes and weights of the rule on panels of equal width, at most `width` each.

    Parameters
    ----------
    lower, upper : float
        Ends of the interval, lower ≤ upper.
    width : float
        Largest width of a panel: the length over which the integrand is smooth.

    Returns
    -------
    nodes, weights : ndarray
        In one dimension, ordered.
    """
    panels = max(1, math.ceil((upper - lower) / width))
    edges = np.linspace(lower, upper, panels + 1)
    half = 0.5 * np.diff(edges)
    nodes, weights = _reference_rule()
    points = edges[:-1, None] + half[:, None] * (1.0 + nodes)
    return points.ravel(), (half[:, None] * weights).ravel()
