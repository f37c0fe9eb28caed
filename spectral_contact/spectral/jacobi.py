"""Of the Jacobi family those at 0 and -1/2: Legendre and Chebyshev polynomials, and Gauss rules.

Panels carry Legendre polynomials, as many as they need, and their tails a few; sampled functions
are expanded from Gauss nodes.
"""

from __future__ import annotations

import cmath
from functools import cache
from math import ceil, log, pi

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import lapack
from scipy.special import roots_jacobi

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
        # x P + (1 - 1/n) (x P - P'), which rounds the factor in the smaller part alone
        np.multiply(x, values[n - 1, ...], out=product)
        current = np.subtract(product, values[n - 2, ...], out=values[n, ...])
        current *= (n - 1) / n
        current += product
    return values


def legendre_values(x: ArrayLike, degree: int) -> Array:
    """Evaluate the Legendre polynomials up to a degree, shape ``x.shape + (degree + 1,)``."""
    x = np.asarray(x, dtype=float)
    return legendre_rows(x, degree).transpose(*range(1, x.ndim + 1), 0)


def tail_values(d: Array, end: float, terms: int, root: bool) -> Array:
    """Evaluate the tail polynomials at ``0 <= d <= end``, shape ``d.shape + (terms,)``.

    Legendre polynomials in ``d / end``, or with `root` in its square root.
    """
    ratio = d / end
    return legendre_values(2.0 * (np.sqrt(ratio) if root else ratio) - 1.0, terms - 1)


@cache
def gauss_rule(points: int) -> tuple[Array, Array]:
    """Return nodes and weights of the Gauss-Legendre rule on [-1, 1], right to the last digit.

    The weights of ``numpy.polynomial.legendre.leggauss`` are off by up to 8e-13 near the ends
    (they are evaluated at rounded nodes), which costs an order of magnitude in the pressure. One
    Newton step in extended precision from the eigenvalues of the Jacobi matrix (Golub and Welsch)
    gives both to the last digit.

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
        return _frozen(np.zeros(1), np.full(1, 2.0))
    # the upper half: the square of the Jacobi matrix couples rows of one parity alone
    order = np.arange(1.0, points) ** 2
    squares = np.zeros(points + points % 2)
    squares[1:points] = order / (4 * order - 1.0)
    diagonal = squares[::2] + squares[1::2]
    beside = np.sqrt(squares[1:-1:2] * squares[2::2])
    # LAPACK takes no empty array
    eigenvalues = lapack.dsterf(diagonal, beside)[0] if points > 2 else diagonal
    start = np.sqrt(np.maximum(eigenvalues, 0.0)).astype(np.longdouble)
    if points % 2:
        start[0] = 0.0
    # polynomials whose leading coefficient is 1, which take the fewest steps
    k = np.arange(2, points + 1, dtype=np.longdouble)
    before = np.ones_like(start)
    value = start.copy()
    product = np.empty_like(start)
    for factor in (k - 1) ** 2 / ((2 * k - 1) * (2 * k - 3)):
        before *= factor
        np.multiply(start, value, out=product)
        before, value = value, np.subtract(product, before, out=before)
    rest = (1 - start) * (1 + start)
    slope = (k[-1] ** 2 / (2 * k[-1] - 1) * before - points * start * value) / rest
    curvature = (2 * start * slope - points * (points + 1) * value) / rest
    step = -value / slope
    nodes = start + step
    slope = np.prod((2 * k - 1) / k) * (slope + step * curvature)
    weights = 2 / ((1 - nodes) * (1 + nodes) * slope**2)
    lower = slice(None, None if points % 2 == 0 else 0, -1)
    upper_nodes = nodes.astype(float)
    upper_weights = weights.astype(float)
    return _frozen(
        np.concatenate([-upper_nodes[lower], upper_nodes]),
        np.concatenate([upper_weights[lower], upper_weights]),
    )


@cache
def power_rule(points: int, power: float) -> tuple[Array, Array]:
    """Return nodes and weights of ``int_0^1 v**power f(v) dv``, with ``power > -1``.

    The rule is that of Gauss and Jacobi. For a whole power it is that of Gauss and Legendre, whose
    nodes are right to the last digit: ``v**power`` is then part of the polynomial it integrates.
    """
    if power == round(power):
        g, w = gauss_rule(points)
        nodes = (1.0 + g) / 2.0
        return _frozen(nodes, w / 2.0 * nodes**power)
    g, w = roots_jacobi(points, 0.0, power)
    return _frozen((1.0 + g) / 2.0, w / 2.0 ** (1.0 + power))


def graded_rule(points: int, panels: int, ratio: float) -> tuple[Array, Array]:
    """Return nodes and weights on (0, 1), ``(panels * points,)`` each, of panels that shrink to 0.

    Every panel has as many Gauss-Legendre nodes, and the `ratio` of its length to that of its
    neighbour, below 1; the last one ends at 0.
    """
    g, w = gauss_rule(points)
    ends = np.append(ratio ** np.arange(panels), 0.0)
    low = ends[1:, None]
    width = -np.diff(ends)[:, None]
    return (low + width * (1.0 + g) / 2.0).ravel(), (width * w / 2.0).ravel()


def _frozen(nodes: Array, weights: Array) -> tuple[Array, Array]:
    nodes.setflags(write=False)
    weights.setflags(write=False)
    return nodes, weights


@cache
def legendre_expansion_matrix(points: int, degree: int) -> Array:
    """Return the matrix from values at Gauss-Legendre nodes to Legendre coefficients.

    It is the discrete orthogonal projection, shape ``(degree + 1, points)``, of more points than
    the highest degree. Without the rounding of the nodes, as in `legendre_projection_matrix`: at
    the ends of a panel interpolants were off by 40 roundings with it, and q at the centre by 1e-12.
    """
    scale = np.arange(degree + 1) + 0.5
    matrix = scale[:, None] * legendre_projection_matrix(points, degree).T
    matrix.setflags(write=False)
    return np.asarray(matrix)


def legendre_interpolation_matrix(x: ArrayLike, points: int) -> Array:
    """Return the matrix from values at Gauss-Legendre nodes to those at places `x` in [-1, 1].

    Its shape is (n, points), of n places.
    """
    values = legendre_values(x, points - 1)
    return np.asarray(values @ legendre_expansion_matrix(points, points - 1))


@cache
def legendre_projection_matrix(points: int, degree: int) -> Array:
    """Return the matrix from values at Gauss-Legendre nodes to integrals against P_0 ... P_degree.

    Its shape is ``(points, degree + 1)``, of more points than the degree. The rounding of the nodes
    is taken out of it: what is nearly constant would have the same spurious integral against a high
    degree everywhere, and in a Gram matrix that adds up.
    """
    nodes, weights = gauss_rule(points)
    values = legendre_values(nodes, degree)
    matrix = values * weights[:, None]
    scale = np.arange(degree + 1) + 0.5
    defect = matrix.T @ values - np.diag(1.0 / scale)
    # a few roundings, whose square is nothing
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
