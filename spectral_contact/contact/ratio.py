"""The ratio of traction to pressure in full stick: at the edge, and at its largest."""

from __future__ import annotations

from math import inf

import numpy as np
from numpy.typing import NDArray

from spectral_contact.fields import DiskSeries, PressureField

__all__ = ["AT_ONE_PLACE", "largest_ratio"]

Array = NDArray[np.float64]

#: A share bounds the change on its whole panel by moduli of coefficients. At the place of the
#: largest q/p that is too much by far: without this factor the estimate was 34 times the error at
#: the least, over 45 random scenes whose error exceeds rounding.
AT_ONE_PLACE = 1.0 / 6.0


def largest_ratio(
    pressure: PressureField, traction: DiskSeries, depth: float
) -> tuple[float, float, float]:
    """Return q/p at the edge, its largest modulus, and ``y`` where that is reached.

    Parameters
    ----------
    pressure : PressureField
        Positive.
    traction : DiskSeries
        On the whole contact.
    depth : float
        ``-ln y`` down to which the maximum is looked for.
    """

    def ratio(x: Array) -> Array:
        y = np.exp(-x)
        s = np.sqrt(-np.expm1(-x))
        assert traction.series is not None
        return np.abs(s * traction.series(y) / pressure.at(y))

    if pressure.at(np.array(0.0)) == inf:
        edge = 0.0
    else:
        assert traction.series is not None
        edge = traction.series.limit / float(pressure.at(np.array(0.0)))
        if edge == inf:
            return inf, inf, 0.0
    low, high = 1e-3, depth
    best, where = abs(edge), inf
    for _ in range(6):  # zoom on the maximum; its value is right to the square of the spacing
        x = np.linspace(low, high, 33 if low > 1e-3 else 129)
        values = ratio(x)
        i = int(np.argmax(values))
        if values[i] <= best * (1.0 + 4e-16) and where == inf:
            return edge, abs(edge), 0.0
        if values[i] >= best:
            best, where = float(values[i]), float(x[i])
        low, high = float(x[max(i - 1, 0)]), float(x[min(i + 1, len(x) - 1)])
    return edge, best, float(np.exp(-where))
