"""Legendre and Chebyshev polynomials, Gauss rules, and matrices from samples to coefficients.

The unknown fields are Legendre series on panels and their tails. A function that is not an unknown
is sampled at Gauss nodes, and expanded from these values.
"""

from __future__ import annotations

import cmath
from math import ceil, log, pi

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import roots_jacobi, roots_legendre

from spectral_contact.spectral.cache import bounded_cache

Array = NDArray[np.float64]


def interpolation_points(singularity: complex) -> int:
    """Return how many points in [-1, 1] represent an analytic function to rounding.

    On the largest ellipse with the foci -1 and 1 in which the function is analytic, let r be the
    sum of the half axes. Interpolation in n Chebyshev or Gauss points has an error of ``r**-n``
    (Trefethen, Approximation Theory and Approximation Practice, 2013, theorem 8.2).

    Parameters
    ----------
    singularity : complex
        The singularity of the function that is nearest to the interval.
    """
    root = cmath.sqrt(singularity**2 - 1.0)
    half_axes = max(abs(singularity + root), abs(singularity - root))
    return ceil(-log(np.finfo(float).eps) / log(half_axes))


#: Number of Gauss points that represent a function on an interval of length 2 which is analytic up
#: to an imaginary part of pi. Functions of ``exp(-x) + e`` in x are, on a panel of width 2.
PANEL_SAMPLES = interpolation_points(pi * 1j)


def legendre_rows(x: Array, degree: int) -> Array:
    """Return P_0 ... P_degree at `x` as rows, shape ``(degree + 1, *x.shape)``."""
    values = np.empty((degree + 1, *x.shape))
    values[0] = 1.0
    if degree > 0:
        values[1] = x
    product = np.empty(x.shape)
    for n in range(2, degree + 1):
        # P_n = x P_(n-1) + (1 - 1/n) (x P_(n-1) - P_(n-2)): the rounded factor 1 - 1/n multiplies
        # only the difference, which is the smaller term
        np.multiply(x, values[n - 1, ...], out=product)
        current = np.subtract(product, values[n - 2, ...], out=values[n, ...])
        current *= (n - 1) / n
        current += product
    return values


def legendre_values(x: ArrayLike, degree: int) -> Array:
    """Evaluate the Legendre polynomials up to a degree, shape ``x.shape + (degree + 1,)``."""
    x = np.asarray(x, dtype=float)
    return legendre_rows(x, degree).transpose(*range(1, x.ndim + 1), 0)


def tail_values(d: Array, end: float, terms: int, in_root: bool) -> Array:
    """Evaluate the tail polynomials at ``0 <= d <= end``, shape ``d.shape + (terms,)``.

    They are Legendre polynomials, shifted to [0, 1], in ``d / end``, or with `in_root` in its
    square root.
    """
    ratio = d / end
    return legendre_values(2.0 * (np.sqrt(ratio) if in_root else ratio) - 1.0, terms - 1)


@bounded_cache("Gauss rules")
def gauss_rule(points: int) -> tuple[Array, Array]:
    """Return nodes and weights of the Gauss-Legendre rule on [-1, 1], right to the last digit.

    The weights of ``scipy.special.roots_legendre`` are off by up to 1e-12 near the ends (they are
    evaluated at rounded nodes), which costs an order of magnitude in the pressure. One Newton step
    in extended precision from its nodes gives both to the last digit.

    Parameters
    ----------
    points : int
        Number of nodes, at least 1; exact for polynomials of degree ``2*points - 1``.

    Returns
    -------
    nodes, weights : ndarray
        Shape ``(points,)`` each, read-only; nodes increase.
    """
    if points < 1:
        raise ValueError(f"points = {points}: must be at least 1")
    if points == 1:
        return _read_only(np.zeros(1), np.full(1, 2.0))
    # the nodes that are not negative
    start = roots_legendre(points)[0][points // 2 :].astype(np.longdouble)
    # Legendre polynomials scaled to leading coefficient 1, whose recurrence has one factor a step
    k = np.arange(2, points + 1, dtype=np.longdouble)
    previous = np.ones_like(start)
    current = start.copy()
    product = np.empty_like(start)
    for factor in (k - 1) ** 2 / ((2 * k - 1) * (2 * k - 3)):
        previous *= factor
        np.multiply(start, current, out=product)
        previous, current = current, np.subtract(product, previous, out=previous)
    # 1 - x**2 without cancellation
    complement = (1 - start) * (1 + start)
    slope = k[-1] ** 2 / (2 * k[-1] - 1) * previous - points * start * current
    slope /= complement
    # Legendre's differential equation
    curvature = (2 * start * slope - points * (points + 1) * current) / complement
    step = -current / slope
    nodes = start + step
    # the slope of P_points at the nodes, no longer scaled
    slope = np.prod((2 * k - 1) / k) * (slope + step * curvature)
    weights = 2 / ((1 - nodes) * (1 + nodes) * slope**2)
    lower = slice(None, None if points % 2 == 0 else 0, -1)
    upper_nodes = nodes.astype(float)
    upper_weights = weights.astype(float)
    return _read_only(
        np.concatenate([-upper_nodes[lower], upper_nodes]),
        np.concatenate([upper_weights[lower], upper_weights]),
    )


@bounded_cache("Gauss rules")
def power_rule(points: int, power: float) -> tuple[Array, Array]:
    """Return nodes and weights of ``int_0^1 v**power f(v) dv``, with ``power > -1``.

    If the power is a whole number, this is the Gauss-Legendre rule with the power in its weights:
    exact where ``v**power f(v)`` is a polynomial of degree ``2*points - 1``. Else it is the
    Gauss-Jacobi rule, exact where f is one.
    """
    if power == round(power):
        g, w = gauss_rule(points)
        nodes = (1.0 + g) / 2.0
        return _read_only(nodes, w / 2.0 * nodes**power)
    g, w = roots_jacobi(points, 0.0, power)
    return _read_only((1.0 + g) / 2.0, w / 2.0 ** (1.0 + power))


def graded_rule(points: int, panels: int, ratio: float) -> tuple[Array, Array]:
    """Return nodes and weights on (0, 1), ``(panels * points,)`` each, of panels that shrink to 0.

    Every panel has `points` Gauss-Legendre nodes. The panels end at 1, `ratio`, ``ratio**2``, ...
    with a ratio below 1, and the last of them reaches 0.
    """
    g, w = gauss_rule(points)
    ends = np.append(ratio ** np.arange(panels), 0.0)
    low = ends[1:, None]
    width = -np.diff(ends)[:, None]
    return (low + width * (1.0 + g) / 2.0).ravel(), (width * w / 2.0).ravel()


def _read_only(nodes: Array, weights: Array) -> tuple[Array, Array]:
    """Return nodes and weights, which nobody can change any more: they are in a cache."""
    nodes.setflags(write=False)
    weights.setflags(write=False)
    return nodes, weights


@bounded_cache("Legendre matrices")
def legendre_expansion_matrix(points: int, degree: int) -> Array:
    """Return the matrix from values at Gauss-Legendre nodes to Legendre coefficients.

    It is the discrete orthogonal projection, shape ``(degree + 1, points)``, with more points than
    the highest degree. As in `legendre_projection_matrix` the rounding of the nodes is corrected:
    without the correction an interpolant is off by 40 roundings at the ends of a panel, and q at
    the centre by 1e-12.
    """
    scale = np.arange(degree + 1) + 0.5
    matrix = scale[:, None] * legendre_projection_matrix(points, degree).T
    matrix.setflags(write=False)
    return np.asarray(matrix)


def legendre_interpolation_matrix(x: ArrayLike, points: int) -> Array:
    """Return the matrix from values at Gauss-Legendre nodes to those at n places `x` in [-1, 1].

    Its shape is (n, points).
    """
    values = legendre_values(x, points - 1)
    return np.asarray(values @ legendre_expansion_matrix(points, points - 1))


@bounded_cache("Legendre matrices")
def legendre_projection_matrix(points: int, degree: int) -> Array:
    """Return the matrix from values at Gauss-Legendre nodes to integrals against P_0 ... P_degree.

    Its shape is ``(points, degree + 1)``, with more points than the degree. At rounded nodes the
    Legendre polynomials are not orthogonal to the last digit, and a constant would have a spurious
    integral against a high degree. It is the same at every node of a kernel that is nearly
    constant, and adds up in a Gram matrix. So it is corrected here to first order.
    """
    nodes, weights = gauss_rule(points)
    values = legendre_values(nodes, degree)
    matrix = values * weights[:, None]
    scale = np.arange(degree + 1) + 0.5
    defect = matrix.T @ values - np.diag(1.0 / scale)
    # the defect is a few roundings, and its square is negligible
    matrix -= matrix @ (scale[:, None] * defect)
    matrix.setflags(write=False)
    return matrix


def chebyshev_interpolation(points: int) -> tuple[Array, Array]:
    """Return Chebyshev points on [-1, 1] and the matrix from values there to coefficients.

    The points are the zeros of ``T_points``; row n of the matrix, (points, points), gives the
    coefficient of T_n in the interpolant.
    """
    angle = np.pi * (np.arange(points) + 0.5) / points
    matrix = np.cos(np.outer(np.arange(points), angle)) * (2.0 / points)
    matrix[0] /= 2.0
    return np.cos(angle), matrix
