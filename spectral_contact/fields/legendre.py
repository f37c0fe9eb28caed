"""Legendre (and Chebyshev) series, evaluated fast: the innermost loop of every evaluation."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def legendre_sums_between(values: Array, low: Array, high: Array, degree: int) -> Array:
    """Return sums of values times P_0 ... P_degree at ``-1 + low = 1 - high``, in their last axis.

    The shapes are (n, q), of what it returns (n, degree + 1). They are as accurate as the
    distances: next to either end the polynomials vary like ``degree**2`` times the distance, and
    rounding the argument itself would cost that many eps.
    """
    near = np.minimum(low, high)
    rows = np.empty((degree + 1, *near.shape))
    rows[0] = 1.0
    twice, step, product = 2.0 * near, -near, np.empty(near.shape)
    for n in range(degree):  # T_n, and T_(n+1) - T_n at 1 - near
        following = np.add(rows[n], step, out=rows[n + 1])
        step -= np.multiply(twice, following, out=product)
    sums = np.empty((len(near), degree + 1))
    sums[:, ::2] = (values[:, None, :] @ rows[::2].transpose(1, 2, 0))[:, 0]
    signed = np.where(low < high, -values, values)
    sums[:, 1::2] = (signed[:, None, :] @ rows[1::2].transpose(1, 2, 0))[:, 0]
    return np.asarray(sums @ _to_chebyshev(degree + 1))


def legendre_sums(x: Array, coefficients: Array, own: NDArray[np.int_] | None = None) -> Array:
    """Return values of Legendre series by Clenshaw's recurrence.

    Parameters
    ----------
    x : ndarray, shape (n,)
    coefficients : ndarray, shape (series, terms)
    own : ndarray of int, shape (k, n), optional
        Which series each point has, k times; by default it has all of them.

    Returns
    -------
    ndarray, shape (k, n) or (series, n)
    """
    # as Chebyshev series: their recurrence has no factors that depend on the degree
    table = _to_chebyshev(coefficients.shape[1]) @ coefficients.T
    return chebyshev_sums(x, table[:, :, None] if own is None else table.take(own, axis=1))


def chebyshev_sums(x: Array, table: Array) -> Array:
    """Return values of Chebyshev series by Clenshaw's recurrence.

    Parameters
    ----------
    x : ndarray, shape (n,)
    table : ndarray, shape (terms, k, n) or (terms, k, 1)
        Coefficients of the k series that each point has, or of those that all have.

    Returns
    -------
    ndarray, shape (k, n)
    """
    rows, shape = list(table), (table.shape[1], len(x))
    # of one shape, which is faster
    x = np.concatenate([x] * shape[0]).reshape(shape)
    doubled, product, later, last = 2.0 * x, np.empty(shape), np.zeros(shape), np.empty(shape)
    last[...] = rows[-1]
    for row in rows[-2:0:-1]:
        np.subtract(np.multiply(doubled, last, out=product), later, out=later)
        later += row
        later, last = last, later
    if len(rows) == 1:
        return last
    return np.asarray(np.multiply(x, last, out=product) - later + rows[0])


def _chebyshev_from_legendre(terms: int) -> Array:
    """Return the matrix from Legendre to Chebyshev coefficients, (terms, terms)."""
    # P_n = sum_j w_j w_(n-j) cos((n - 2 j) t), where sum_j w_j r^j = 1/sqrt(1 - r)
    w = np.cumprod(np.concatenate([[1.0], 1.0 - 0.5 / np.arange(1.0, terms)]))
    matrix = np.zeros((terms, terms))
    for n in range(terms):
        np.add.at(matrix[:, n], np.abs(n - 2 * np.arange(n + 1)), w[: n + 1] * w[n::-1])
    return matrix


#: Of as many terms as any panel has; the matrix of fewer is its leading block.
_CHEBYSHEV = _chebyshev_from_legendre(48)


def _to_chebyshev(terms: int) -> Array:
    known = terms <= len(_CHEBYSHEV)
    return _CHEBYSHEV[:terms, :terms] if known else _chebyshev_from_legendre(terms)


def legendre_sum(x: float, coefficients: list[float]) -> float:
    """Return one value of a Legendre series by Clenshaw's recurrence, without arrays."""
    later = last = 0.0
    for n in range(len(coefficients) - 1, 0, -1):
        later, last = (
            last,
            coefficients[n] + (2 * n + 1) / (n + 1) * x * last - ((n + 1) / (n + 2)) * later,
        )
    return coefficients[0] + x * last - 0.5 * later if len(coefficients) > 1 else coefficients[0]
