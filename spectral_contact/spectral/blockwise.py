"""Matrices of blocks along the diagonal."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Blockwise:
    """A matrix of blocks along its diagonal."""

    def __init__(self, blocks: Sequence[Array]) -> None:
        #: blocks of one shape in a row, of which the products are taken at once
        self._runs: list[tuple[slice, slice, Array]] = []
        row = column = 0
        for (height, width), run in groupby(blocks, np.shape):
            alike = np.stack(list(run))
            rows = slice(row, row + len(alike) * height)
            columns = slice(column, column + len(alike) * width)
            self._runs.append((rows, columns, alike))
            row, column = rows.stop, columns.stop
        self.shape = row, column

    def blocks(self) -> list[Array]:
        """Return the blocks."""
        return [one for *_, alike in self._runs for one in alike]

    def of(self, columns: Array) -> Array:
        """Return this matrix times another, or times a vector."""
        result = np.empty((self.shape[0], *columns.shape[1:]))
        for rows, own, alike in self._runs:
            number, height, width = alike.shape
            each = columns[own].reshape(number, width, -1)
            np.matmul(alike, each, out=result[rows].reshape(number, height, -1))
        return result

    def after(self, rows: Array) -> Array:
        """Return the product of another matrix, in whose precision, with this one."""
        result = np.empty((len(rows), self.shape[1]), rows.dtype)
        for own, columns, alike in self._runs:
            number, height, width = alike.shape
            each = rows[:, own].reshape(-1, number, height).swapaxes(0, 1)
            out = result[:, columns].reshape(-1, number, width).swapaxes(0, 1)
            np.matmul(each, alike.astype(rows.dtype, copy=False), out=out)
        return result
