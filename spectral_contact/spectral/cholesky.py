"""A positive definite system, factored once for many right-hand sides."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lapack

Array = NDArray[np.float64]


class Cholesky:
    """The Cholesky factor of a matrix, which is overwritten.

    The factor is as accurate as that of the matrix scaled to unit diagonal: rounding errors are
    relative to the diagonal, whatever its range.

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
        #: of the matrix
        self.diagonal: Array = matrix.diagonal().copy()
        # The transposed view is Fortran-ordered, which LAPACK takes without a copy. The factor
        # replaces the lower triangle; the upper one stays as it is, and `shed` needs it.
        self._factor, info = lapack.dpotrf(matrix.T, lower=1, clean=0, overwrite_a=1)
        if info != 0:
            raise ArithmeticError(f"Galerkin matrix not positive definite at pivot {info}")

    def solve(self, right: Array) -> Array:
        """Return the solution of a right-hand side (n,), or of several as rows (k, n)."""
        if right.ndim == 1:
            step, _ = lapack.dtrtrs(self._factor, right, lower=1)
            step, _ = lapack.dtrtrs(self._factor, step, lower=1, trans=1, overwrite_b=1)
        else:
            step, _ = lapack.dpotrs(self._factor, right.T, lower=1)
        return np.asarray(step.T)

    def shed(self, solution: Array, kept: int) -> Array:
        """Return the difference of a solution to that of the first `kept` unknowns alone.

        It takes no other factorisation, and nothing cancels.
        """
        last = solution[kept:]
        # with the whole factor, as the leading block would have to be copied
        step = np.zeros(len(solution))
        step[:kept] = self._factor[:kept, kept:] @ last
        step, _ = lapack.dtrtrs(self._factor, step, lower=1, overwrite_b=1)
        step[kept:] = 0.0
        step, _ = lapack.dtrtrs(self._factor, step, lower=1, trans=1, overwrite_b=1)
        step[kept:] = -last
        return np.asarray(step)
