"""Block-diagonal matrices, multiplied from either side without their zeros.

A matrix that maps Legendre coefficients to values at Gauss points, or back, has a block for each
panel of a mesh.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Blockwise:
    """A matrix of blocks along its diagonal.

    Parameters
    ----------
    blocks : sequence of ndarray
        From the first row and column on; they need not be square.

    Attributes
    ----------
    shape : tuple of int
    """

    def __init__(self, blocks: Sequence[Array]) -> None:
        #: runs of neighbours of one shape, whose products are one batch: their rows, their columns
        #: and the blocks, (number, height, width)
        self._runs: list[tuple[slice, slice, Array]] = []
        row = 0
        column = 0
        for (height, width), run in groupby(blocks, np.shape):
            stacked = np.stack(list(run))
            rows = slice(row, row + len(stacked) * height)
            columns = slice(column, column + len(stacked) * width)
            self._runs.append((rows, columns, stacked))
            row = rows.stop
            column = columns.stop
        self.shape = (row, column)

    def blocks(self) -> list[Array]:
        """Return the blocks."""
        return [block for _, _, stacked in self._runs for block in stacked]

    def times(self, matrix: Array) -> Array:
        """Return this matrix times another one, or times a vector."""
        result = np.empty((self.shape[0], *matrix.shape[1:]))
        for rows, columns, stacked in self._runs:
            number, height, width = stacked.shape
            factors = matrix[columns].reshape(number, width, -1)
            np.matmul(stacked, factors, out=result[rows].reshape(number, height, -1))
        return result

    def left_times(self, matrix: Array) -> Array:
        """Return another matrix times this one."""
        result = np.empty((len(matrix), self.shape[1]))
        for rows, columns, stacked in self._runs:
            number, height, width = stacked.shape
            factors = matrix[:, rows].reshape(-1, number, height).swapaxes(0, 1)
            out = result[:, columns].reshape(-1, number, width).swapaxes(0, 1)
            np.matmul(factors, stacked, out=out)
        return result
