"""The Jacobi family: values and Gauss rules, Legendre and Chebyshev included.

Panels carry Legendre polynomials, the closed spectral solutions at zero compliance are Jacobi
polynomials with the weight (1 - z)^(-1/2), and sampled functions are expanded from Gauss nodes.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import special
from scipy.linalg import lapack

from spectral_contact.fields.legendre import legendre_rows
from spectral_contact.spectral.cache import BoundedCache

__all__ = [
    "chebyshev_interpolation",
    "chebyshev_values",
    "gauss_rule",
    "graded_rule",
    "jacobi_values",
    "legendre_expansion_matrix",
    "legendre_interpolation_matrix",
    "legendre_projection_matrix",
    "legendre_values",
]


_RULES: BoundedCache[tuple[int, float, float], tuple[NDArray[np.float64], NDArray[np.float64]]] = (
    BoundedCache("Gauss rules", 64)
)
_PROJECTIONS: BoundedCache[tuple[int, int], NDArray[np.float64]] = BoundedCache(
    "Legendre projections", 32
)
_EXPANSIONS: BoundedCache[tuple[int, int], NDArray[np.float64]] = BoundedCache(
    "Legendre expansions", 32
)


def jacobi_values(x: ArrayLike, degree: int, a: float, b: float) -> NDArray[np.float64]:
    """Evaluate the Jacobi polynomials P_0 ... P_degree with weight (1-x)^a (1+x)^b.

    Parameters
    ----------
    x : array_like
        Points, usually in [-1, 1]; any shape.
    degree : int
        Highest degree, at least 0.
    a, b : float
        Exponents of the weight, each greater than -1.

    Returns
    -------
    ndarray
        Shape ``x.shape + (degree + 1,)``, standard normalisation P_n(1) = C(n+a, n).

    Raises
    ------
    ValueError
        For a negative degree or an exponent of -1 or less.
    """
    if degree < 0:
        raise ValueError(f"degree = {degree}: must be at least 0")
    if not (a > -1 and b > -1):
        raise ValueError(f"a, b = {a}, {b}: both must be greater than -1")
    x = np.asarray(x, dtype=float)
    values = np.empty((*x.shape, degree + 1))
    values[..., 0] = 1.0
    if degree > 0:
        values[..., 1] = (a + 1) + (a + b + 2) * (x - 1) / 2
    for n in range(2, degree + 1):  # three-term recurrence, DLMF 18.9.1-2
        c = 2 * n + a + b
        lead = 2 * n * (n + a + b) * (c - 2)
        linear = (c - 1) * (c * (c - 2) * x + a * a - b * b)
        previous = 2 * (n + a - 1) * (n + b - 1) * c
        values[..., n] = (linear * values[..., n - 1] - previous * values[..., n - 2]) / lead
    return values


def legendre_values(x: ArrayLike, degree: int) -> NDArray[np.float64]:
    """Evaluate the Legendre polynomials (a = b = 0); see `jacobi_values`."""
    x = np.asarray(x, dtype=float)
    return legendre_rows(x, degree).transpose(*range(1, x.ndim + 1), 0)


def chebyshev_values(x: ArrayLike, degree: int) -> NDArray[np.float64]:
    """Evaluate the Chebyshev polynomials T_n, the Jacobi family at a = b = -1/2 with T_n(1) = 1."""
    x = np.asarray(x, dtype=float)
    values = np.polynomial.chebyshev.chebvander(x, degree)
    return np.asarray(values).reshape(*x.shape, degree + 1)


def gauss_rule(
    points: int, a: float = 0.0, b: float = 0.0
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return nodes and weights of the Gauss-Jacobi rule on [-1, 1].

    Parameters
    ----------
    points : int
        Number of nodes, at least 1; exact for polynomials of degree ``2*points - 1``.
    a, b : float
        Exponents of the weight (1-x)^a (1+x)^b. The default is Gauss-Legendre.

    Returns
    -------
    nodes, weights : ndarray
        Shape ``(points,)`` each, read-only; nodes increase.
    """
    return _RULES.get((points, a, b), lambda: _frozen_rule(points, a, b))


def graded_rule(
    points: int, panels: int, ratio: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return a rule on (0, 1) whose panels shrink towards 0.

    Parameters
    ----------
    points : int
        Gauss-Legendre nodes on each panel.
    panels : int
        Their number; the last one ends at 0.
    ratio : float
        Of the lengths of neighbours, below 1.

    Returns
    -------
    nodes, weights : ndarray
        Shape ``(panels * points,)`` each.
    """
    g, w = gauss_rule(points)
    ends = np.append(ratio ** np.arange(panels), 0.0)
    low, width = ends[1:, None], -np.diff(ends)[:, None]
    return (low + width * (1.0 + g) / 2.0).ravel(), (width * w / 2.0).ravel()


def _frozen_rule(
    points: int, a: float, b: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    if a == b == 0.0:
        nodes, weights = _gauss_legendre(points)
    else:
        nodes, weights = special.roots_jacobi(points, a, b)
    nodes.setflags(write=False)
    weights.setflags(write=False)
    return nodes, weights


def _gauss_legendre(points: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the Gauss-Legendre rule with weights right to the last digit.

    The weights of ``numpy.polynomial.legendre.leggauss`` are off by up to 8e-13 near the ends
    (they are evaluated at rounded nodes), which costs an order of magnitude in the pressure. One
    Newton step in extended precision from the eigenvalues of the Jacobi matrix (Golub and Welsch)
    gives both to the last digit.
    """
    if points < 1:
        raise ValueError(f"points = {points}: must be at least 1")
    if points == 1:  # LAPACK takes no empty array
        return np.zeros(1), np.full(1, 2.0)
    order = np.arange(1.0, points)
    eigenvalues, _ = lapack.dsterf(np.zeros(points), order / np.sqrt(4 * order * order - 1.0))
    # the upper half, of which the lower one is the mirror image
    start = eigenvalues[points // 2 :].astype(np.longdouble)
    if points % 2:
        start[0] = 0.0
    # polynomials whose leading coefficient is 1, which take the fewest steps
    k = np.arange(2, points + 1, dtype=np.longdouble)
    before, value, product = np.ones_like(start), start.copy(), np.empty_like(start)
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
    halves = nodes.astype(float), weights.astype(float)
    return (
        np.concatenate([-halves[0][lower], halves[0]]),
        np.concatenate([halves[1][lower], halves[1]]),
    )


def legendre_expansion_matrix(points: int, degree: int) -> NDArray[np.float64]:
    """Return the matrix from values at Gauss-Legendre nodes to Legendre coefficients.

    Parameters
    ----------
    points : int
        Number of Gauss nodes; must exceed `degree`.
    degree : int
        Highest degree of the expansion.

    Returns
    -------
    ndarray
        Shape ``(degree + 1, points)``; the discrete orthogonal projection.
    """
    return _EXPANSIONS.get((points, degree), lambda: _frozen_expansion(points, degree))


def legendre_interpolation_matrix(x: ArrayLike, points: int) -> NDArray[np.float64]:
    """Return the matrix from values at Gauss-Legendre nodes to those at other places.

    Parameters
    ----------
    x : array_like, shape (n,)
        Places in [-1, 1].
    points : int
        Number of Gauss nodes.

    Returns
    -------
    ndarray, shape (n, points)
    """
    values = legendre_values(x, points - 1)
    return np.asarray(values @ legendre_expansion_matrix(points, points - 1))


def legendre_projection_matrix(points: int, degree: int) -> NDArray[np.float64]:
    """Return the matrix from values at Gauss-Legendre nodes to integrals against P_0 ... P_degree.

    Parameters
    ----------
    points : int
        Number of Gauss nodes; must exceed `degree`.
    degree : int
        Highest degree.

    Returns
    -------
    ndarray
        Shape ``(points, degree + 1)``, read-only. The rounding of the nodes is taken out of it:
        what is nearly constant would have the same spurious integral against a high degree
        everywhere, and in a Gram matrix that adds up.
    """
    return _PROJECTIONS.get((points, degree), lambda: _frozen_projection(points, degree))


def chebyshev_interpolation(points: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return Chebyshev points on [-1, 1] and the matrix from values there to coefficients.

    Parameters
    ----------
    points : int
        Number of points, zeros of ``T_points``; at least 1.

    Returns
    -------
    nodes : ndarray, shape (points,)
    matrix : ndarray, shape (points, points)
        Row n gives the coefficient of T_n in the interpolant.
    """
    angle = np.pi * (np.arange(points) + 0.5) / points
    matrix = np.cos(np.outer(np.arange(points), angle)) * (2.0 / points)
    matrix[0] /= 2.0
    return np.cos(angle), matrix


def _frozen_expansion(points: int, degree: int) -> NDArray[np.float64]:
    nodes, weights = gauss_rule(points)
    scale = np.arange(degree + 1) + 0.5
    matrix = scale[:, None] * legendre_values(nodes, degree).T * weights
    matrix.setflags(write=False)
    return matrix


def _frozen_projection(points: int, degree: int) -> NDArray[np.float64]:
    nodes, weights = gauss_rule(points)
    values = legendre_values(nodes, degree)
    matrix = values * weights[:, None]
    scale = np.arange(degree + 1) + 0.5
    defect = matrix.T @ values - np.diag(1.0 / scale)
    # a few roundings, whose square is nothing
    matrix -= matrix @ (scale[:, None] * defect)
    matrix.setflags(write=False)
    return matrix
