"""A positive definite system, scaled to unit diagonal and factored once."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lapack

__all__ = ["ScaledCholesky"]

Array = NDArray[np.float64]


class ScaledCholesky:
    """The Cholesky factor of a matrix, which is overwritten.

    Parameters
    ----------
    matrix : ndarray, shape (n, n)
        Symmetric and positive definite.

    Raises
    ------
    ArithmeticError
        If it is not positive definite.
    """

    def __init__(self, matrix: Array) -> None:
        #: one over the square roots of the diagonal
        self.scale = 1.0 / np.sqrt(matrix.diagonal())
        matrix *= self.scale
        matrix *= self.scale[:, None]
        # The transposed view is Fortran-ordered, which LAPACK takes without a copy. The factor
        # replaces the lower triangle; the upper one stays as it is, and `shed` needs it.
        self._factor, info = lapack.dpotrf(matrix.T, lower=1, clean=0, overwrite_a=1)
        if info != 0:
            raise ArithmeticError(f"Galerkin matrix not positive definite at pivot {info}")

    def solve(self, right: Array) -> Array:
        """Return the solution of a right-hand side (n,), or of several as rows (k, n)."""
        step, _ = lapack.dpotrs(self._factor, (right * self.scale).T, lower=1)
        return np.asarray(step.T * self.scale)

    def shed(self, solution: Array, kept: int) -> Array:
        """Return the difference of a solution to that of the first `kept` unknowns alone.

        It takes no other factorisation, and nothing cancels.
        """
        last = solution[kept:] / self.scale[kept:]
        # with the whole factor, as the leading block would have to be copied
        step = np.zeros(len(solution))
        step[:kept] = self._factor[:kept, kept:] @ last
        step, _ = lapack.dtrtrs(self._factor, step, lower=1)
        step[kept:] = 0.0
        step, _ = lapack.dtrtrs(self._factor, step, lower=1, trans=1)
        step[kept:] = -last
        return np.asarray(step * self.scale)
