"""The pressure over s: what the traction of a slip zone, ``q = f p``, is as ``q/s``."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from spectral_contact.spectral.annulus import Family
from spectral_contact.spectral.jacobi import gauss_rule, legendre_expansion_matrix, legendre_values
from spectral_contact.spectral.panels import LogPanels

__all__ = ["OverRadius", "finer"]

Array = NDArray[np.float64]
Degrees = tuple[int, ...]

#: Degrees that ``p / s`` has more than p.
_SPARE = 4


def finer(degrees: Degrees, panels: LogPanels) -> Degrees:
    """Return the degrees of a function over s."""
    return tuple(min(n + _SPARE, panels.degree) for n in degrees)


class OverRadius:
    """The map from the coefficients of a pressure on an annulus to those of it over s.

    It takes the functions in use to those of some degrees more, panel by panel.
    """

    def __init__(self, families: Sequence[Family], degrees: Sequence[Degrees]) -> None:
        self._blocks: list[tuple[slice, slice, Array]] = []
        row = column = 0
        for family, used in zip(families, degrees, strict=True):
            panels = family.panels
            points = panels.degree + 11
            expand = legendre_expansion_matrix(points, panels.degree)
            values = legendre_values(gauss_rule(points)[0], panels.degree)
            s = np.sqrt(family.points(np.exp(-panels.sampling(points))).z)
            blocks = [
                expand[: more + 1] @ (values[:, : n + 1] / one[:, None])
                for one, n, more in zip(s, used, finer(used, panels), strict=True)
            ]
            # on the tail s is the same to rounding
            at_end = float(np.sqrt(family.points(np.array([panels.end / 2.0])).z[0]))
            blocks.append(np.eye(panels.tail_terms) / at_end)
            for block in blocks:
                rows, columns = block.shape
                self._blocks.append(
                    (slice(row, row + rows), slice(column, column + columns), block)
                )
                row, column = row + rows, column + columns
        self.shape = row, column

    def of(self, values: Array) -> Array:
        """Return the coefficients of functions over s."""
        result = np.empty((self.shape[0], *values.shape[1:]))
        for rows, columns, block in self._blocks:
            result[rows] = block @ values[columns]
        return result

    def after(self, matrix: Array) -> Array:
        """Return the product of a matrix with this map, of which it may have the first rows."""
        result = np.zeros((len(matrix), self.shape[1]))
        for rows, columns, block in self._blocks:
            if rows.stop <= matrix.shape[1]:
                result[:, columns] = matrix[:, rows] @ block
        return result
