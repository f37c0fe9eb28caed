"""Normal contact through any layer by collocation in the radius; shares no code with the library.

On panels in r the overclosure at Gauss points is ``w_i = delta - h(r_i) - sum_j N_ij F(w_j)``,
with the elliptic kernel ``(1/pi) eta/hi K(lo/hi)`` integrated against Lagrange polynomials by a
rule graded to the point where it is singular. With an edge, delta is what makes w the law's start
there.
"""

from dataclasses import dataclass

import numpy as np
from scipy.special import ellipkm1

#: Gauss points on a panel; those of a graded rule, its panels and their ratio.
POINTS, FINE, LEVELS, RATIO = 16, 14, 18, 0.15


@dataclass(frozen=True)
class Collocated:
    approach: float
    load: float
    r: np.ndarray
    pressure: np.ndarray


def kernel(s, eta, apart):
    """K1/pi with the distance of the two radii known to relative accuracy."""
    high = np.maximum(s, eta)
    return eta / high * ellipkm1(apart * (s + eta) / high**2) / np.pi


def lagrange(nodes, x):
    """Values of the Lagrange polynomials at x, (len(x), len(nodes))."""
    difference = nodes[:, None] - nodes
    np.fill_diagonal(difference, 1.0)
    weights = 1.0 / difference.prod(axis=1)
    away = x[:, None] - nodes
    exact = away == 0.0
    away[exact] = 1.0
    terms = weights / away
    values = terms / terms.sum(axis=1)[:, None]
    rows = exact.any(axis=1)
    values[rows] = exact[rows]
    return values


def graded(length):
    """Offsets from a singular point, and weights, up to a length."""
    g, w = np.polynomial.legendre.leggauss(FINE)
    ends = length * np.append(RATIO ** np.arange(LEVELS), 0.0)
    low, width = ends[1:, None], -np.diff(ends)[:, None]
    return (low + width * (1.0 + g) / 2.0).ravel(), (width * w / 2.0).ravel()


def row(s, edges, nodes):
    """Return N at s as weights of the values at the nodes of all panels."""
    _, plain = np.polynomial.legendre.leggauss(POINTS)
    weights = []
    for low, high, own in zip(edges[:-1], edges[1:], nodes, strict=True):
        inside = min(max(s, low), high)
        if abs(s - inside) > 3.0 * (high - low):
            weights.append((high - low) / 2.0 * plain * kernel(s, own, np.abs(own - s)))
            continue
        parts = []
        for length, sign in ((inside - low, -1.0), (high - inside, 1.0)):
            if length > 0.0:
                offset, w = graded(length)
                parts.append((inside + sign * offset, offset + abs(inside - s), w))
        eta, apart, w = (np.concatenate(one) for one in zip(*parts, strict=True))
        weights.append((w * kernel(s, eta, apart)) @ lagrange(own, eta))
    return np.concatenate(weights)


def collocated(pressure, slope, height, edges, *, approach=None, start=None):
    """Solve on panels between edges; of a given approach, or with the start at the last edge."""
    g, w = np.polynomial.legendre.leggauss(POINTS)
    edges = np.asarray(edges, dtype=float)
    nodes = edges[:-1, None] + np.diff(edges)[:, None] * (1.0 + g) / 2.0
    weights = (np.diff(edges)[:, None] * w / 2.0).ravel()
    r = nodes.ravel()
    matrix = np.array([row(s, edges, nodes) for s in r])
    last = row(edges[-1], edges, nodes)
    top = float(height(edges[-1]))
    delta = approach
    # what a point would do by itself
    u = np.full(len(r), 0.0 if start is None else start)
    for _ in range(200):
        p = pressure(u)
        if start is not None:
            delta = start + top + last @ p
        residual = u + matrix @ p + height(r) - delta
        jacobian = np.eye(len(r)) + matrix * slope(u)
        if start is not None:
            jacobian -= last * slope(u)
        step = np.linalg.solve(jacobian, -residual)
        size = np.abs(step).max()
        u = u + step * min(1.0, 0.5 / size if size > 0.0 else 1.0)
        if size < 1e-13 * (1.0 + np.abs(u).max()):
            break
    else:
        raise AssertionError("the oracle did not converge")
    p = pressure(u)
    if start is not None:
        delta = start + top + last @ p
    return Collocated(float(delta), float(2.0 * np.pi * weights @ (r * p)), r, p)


def to_edge(radius, levels=11):
    """Edges of panels graded to a contact's edge."""
    return radius * np.concatenate([[0.0], 1.0 - 0.2 ** np.arange(1, levels), [1.0]])
