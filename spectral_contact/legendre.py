"""Legendre polynomials and series, evaluated fast: the innermost loop of every evaluation."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["legendre_rows", "legendre_rows_between", "legendre_sum", "legendre_sums"]

Array = NDArray[np.float64]


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


def legendre_rows_between(low: Array, high: Array, degree: int) -> Array:
    """Return P_0 ... P_degree at ``-1 + low = 1 - high`` as rows, as accurate as the distances.

    Next to either end the polynomials vary like ``degree**2`` times the distance, and rounding
    the argument itself would cost that many eps.
    """
    near = np.minimum(low, high)
    values = np.empty((degree + 1, *near.shape))
    values[0] = 1.0
    step = np.zeros(near.shape)  # P_n - P_(n-1) at 1 - near
    product = np.empty(near.shape)
    for n in range(degree):
        np.multiply(near, values[n, ...], out=product)
        product *= (2 * n + 1) / (n + 1)
        step *= n / (n + 1)
        step -= product
        np.add(values[n, ...], step, out=values[n + 1, ...])
    values[1::2] *= np.where(low < high, -1.0, 1.0)
    return values


def legendre_sums(x: Array, coefficients: Array) -> Array:
    """Return values of Legendre series by Clenshaw's recurrence.

    Parameters
    ----------
    x : ndarray, shape (n,)
    coefficients : ndarray, shape (terms, n) or (terms, 1)
        Every point has a series of its own, or all have the same.

    Returns
    -------
    ndarray, shape (n,)
    """
    # in monic polynomials, x p_n = p_(n+1) + n^2/(4 n^2 - 1) p_(n-1), one factor a step is saved
    n = np.arange(1.0, len(coefficients))
    leading = np.cumprod(np.concatenate([[1.0], 2.0 - 1.0 / n]))
    scaled = np.empty((len(coefficients), len(x)))
    rows = list(np.multiply(coefficients, leading[:, None], out=scaled))
    product = np.empty(x.shape)
    for k in range(len(rows) - 2, -1, -1):
        rows[k] += np.multiply(x, rows[k + 1], out=product)
        if k > 0:
            rows[k + 1] *= k * k / (4.0 * k * k - 1.0)
            rows[k - 1] -= rows[k + 1]
    return np.asarray(rows[0])


def legendre_sum(x: float, coefficients: list[float]) -> float:
    """Return one value of a Legendre series by Clenshaw's recurrence, without arrays."""
    later = last = 0.0
    for n in range(len(coefficients) - 1, 0, -1):
        later, last = (
            last,
            coefficients[n] + (2 * n + 1) / (n + 1) * x * last - ((n + 1) / (n + 2)) * later,
        )
    return coefficients[0] + x * last - 0.5 * later if len(coefficients) > 1 else coefficients[0]
