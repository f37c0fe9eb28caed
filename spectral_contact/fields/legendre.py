"""Legendre (and Chebyshev) series, evaluated fast: the innermost loop of every evaluation."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def legendre_sums_between(values: Array, low: Array, high: Array, degree: int) -> Array:
    """Return sums of values times the Legendre polynomials up to a degree.

    They are as accurate as the distances `low` and `high`. Next to either end the polynomials vary
    like ``degree**2`` times the distance: if the argument were rounded, they would lose
    ``degree**2`` eps.

    Parameters
    ----------
    values : ndarray, shape (n, q)
        Factors at q points, n times.
    low, high : ndarray, shape (n, q)
        Distances of the points from -1 and from 1: the arguments are ``-1 + low = 1 - high``.
    degree : int

    Returns
    -------
    ndarray, shape (n, degree + 1)
        Sums over the points of the values times P_0 ... P_degree.
    """
    near = np.minimum(low, high)
    chebyshev = np.empty((degree + 1, *near.shape))  # T_n(1 - near)
    chebyshev[0] = 1.0
    # at 1 - near: step is T_(n+1) - T_n, and T_(n+2) - T_(n+1) is step - 2 near T_(n+1)
    twice_near = 2.0 * near
    step = -near
    product = np.empty(near.shape)
    for n in range(degree):
        next_row = np.add(chebyshev[n], step, out=chebyshev[n + 1])
        step -= np.multiply(twice_near, next_row, out=product)
    sums = np.empty((len(near), degree + 1))
    sums[:, ::2] = (values[:, None, :] @ chebyshev[::2].transpose(1, 2, 0))[:, 0]
    # polynomials of odd degree change sign where the nearer end is -1
    signed = np.where(low < high, -values, values)
    sums[:, 1::2] = (signed[:, None, :] @ chebyshev[1::2].transpose(1, 2, 0))[:, 0]
    return np.asarray(sums @ _to_chebyshev(degree + 1))


def legendre_sums(
    x: Array, coefficients: Array, series_of_point: NDArray[np.int_] | None = None
) -> Array:
    """Return values of Legendre series by Clenshaw's recurrence.

    Parameters
    ----------
    x : ndarray, shape (n,)
    coefficients : ndarray, shape (series, terms)
    own : ndarray of int, shape (k, n), optional
        Numbers of the k series that are evaluated at each point; by default all are.

    Returns
    -------
    ndarray, shape (k, n) or (series, n)
    """
    # as Chebyshev series, whose recurrence has no factors that depend on the degree
    table = _to_chebyshev(coefficients.shape[1]) @ coefficients.T
    return chebyshev_sums(
        x, table[:, :, None] if series_of_point is None else table.take(series_of_point, axis=1)
    )


def chebyshev_sums(x: Array, table: Array) -> Array:
    """Return values of Chebyshev series by Clenshaw's recurrence.

    Parameters
    ----------
    x : ndarray, shape (n,)
    table : ndarray, shape (terms, k, n) or (terms, k, 1)
        Coefficients of the k series at each point, or of k series that all points have.

    Returns
    -------
    ndarray, shape (k, n)
    """
    rows = list(table)
    shape = (table.shape[1], len(x))
    # arrays of one shape are faster than those that broadcast
    x = np.concatenate([x] * shape[0]).reshape(shape)
    twice_x = 2.0 * x
    product = np.empty(shape)
    # b_j = 2 x b_(j+1) - b_(j+2) + a_j: newer is b_(j+1), and older is b_(j+2), overwritten by b_j
    newer = np.empty(shape)
    older = np.zeros(shape)
    newer[...] = rows[-1]
    for row in rows[-2:0:-1]:
        np.subtract(np.multiply(twice_x, newer, out=product), older, out=older)
        older += row
        older, newer = newer, older
    if len(rows) == 1:
        return newer
    return np.asarray(np.multiply(x, newer, out=product) - older + rows[0])


def _chebyshev_from_legendre(terms: int) -> Array:
    """Return the matrix from Legendre to Chebyshev coefficients, (terms, terms)."""
    # P_n = sum_j w_j w_(n-j) cos((n - 2 j) t), where sum_j w_j r^j = 1/sqrt(1 - r)
    w = np.cumprod(np.concatenate([[1.0], 1.0 - 0.5 / np.arange(1.0, terms)]))
    matrix = np.zeros((terms, terms))
    for n in range(terms):
        np.add.at(matrix[:, n], np.abs(n - 2 * np.arange(n + 1)), w[: n + 1] * w[n::-1])
    return matrix


#: The matrix for 48 terms; a panel has 41 at most (`contact.tuning.MAX_DEGREE` and one). The matrix
#: for fewer terms is its leading block, and one for more is made when it is needed.
_CHEBYSHEV = _chebyshev_from_legendre(48)


def _to_chebyshev(terms: int) -> Array:
    """Return the matrix for a number of terms; it is made anew only if there are many."""
    stored = terms <= len(_CHEBYSHEV)
    return _CHEBYSHEV[:terms, :terms] if stored else _chebyshev_from_legendre(terms)


def legendre_sum(x: float, coefficients: list[float]) -> float:
    """Return one value of a Legendre series by Clenshaw's recurrence, without arrays."""
    older = newer = 0.0
    for n in range(len(coefficients) - 1, 0, -1):
        by_newer = (2 * n + 1) / (n + 1) * x * newer
        by_older = ((n + 1) / (n + 2)) * older
        older = newer
        newer = coefficients[n] + by_newer - by_older
    return coefficients[0] + x * newer - 0.5 * older if len(coefficients) > 1 else coefficients[0]
