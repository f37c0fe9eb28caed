"""Functions on panels as charges at points, for what is seen of them beyond a boundary."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from spectral_contact.spectral.cache import BoundedCache
from spectral_contact.spectral.jacobi import gauss_rule, legendre_projection_matrix

__all__ = ["EXTRA", "Charges", "charges_on"]

Array = NDArray[np.float64]

#: Gauss points beyond the degree, so that the analytic factors are integrated to rounding.
EXTRA = 12


class Charges:
    """Functions on panels as charges at points, for what is seen of them beyond a boundary."""

    def __init__(self, width: float, degrees: tuple[int, ...]) -> None:
        rules = [gauss_rule(n + EXTRA)[0] for n in degrees]
        parts = [np.exp(-width * (j + (1.0 + g) / 2.0)) for j, g in enumerate(rules)]
        #: distances of the points
        self.d: Array = np.concatenate(parts)
        self._blocks = [(width / 4) * legendre_projection_matrix(n + EXTRA, n) for n in degrees]

    def back(self, coefficients: Array) -> Array:
        """Return what functions have at the points, (points, k): the transpose of `onto`."""
        result = np.empty((len(self.d), coefficients.shape[1]))
        point = column = 0
        for block in self._blocks:
            stop, end = point + block.shape[0], column + block.shape[1]
            np.matmul(block, coefficients[column:end], out=result[point:stop])
            point, column = stop, end
        return result

    def onto(self, values: Array) -> Array:
        """Return integrals over ``1/2 dx`` of kernels at the points, as rows, with functions."""
        result = np.empty((len(values), sum(block.shape[1] for block in self._blocks)))
        point = column = 0
        for block in self._blocks:
            stop, end = point + block.shape[0], column + block.shape[1]
            np.matmul(values[:, point:stop], block, out=result[:, column:end])
            point, column = stop, end
        return result


_CHARGES: BoundedCache[tuple[float, tuple[int, ...]], Charges] = BoundedCache(
    "charges on panels", 32
)


def charges_on(width: float, degrees: int | tuple[int, ...], panels: int = 0) -> Charges:
    """Return functions of these degrees on panels, or of one on so many, as charges (cached)."""
    degrees = (degrees,) * panels if isinstance(degrees, int) else degrees
    return _CHARGES.get((width, degrees), lambda: Charges(width, degrees))
