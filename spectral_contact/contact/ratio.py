"""The ratio of traction to pressure in full stick: at the edge, and at its largest."""

from __future__ import annotations

from math import inf
from typing import NamedTuple

import numpy as np
from numpy.polynomial.legendre import legder
from numpy.typing import NDArray

from spectral_contact.fields.legendre import legendre_sum
from spectral_contact.fields.series import DiskSeries, PressureField
from spectral_contact.spectral.jacobi import gauss_rule, legendre_expansion_matrix

__all__ = ["AT_ONE_PLACE", "LargestRatio", "largest_ratio"]

Array = NDArray[np.float64]

#: A share bounds the change on its whole panel by moduli of coefficients. At the place of the
#: largest q/p that is too much by far: without this factor the estimate was 34 times the error at
#: the least, over 45 random scenes whose error exceeds rounding.
AT_ONE_PLACE = 1.0 / 6.0
#: Places of the first look, and the nodes of a polynomial between two of these: as q/p is analytic
#: in ``x`` up to an imaginary part of pi or so, that is right to rounding.
_GRID, _POINTS = 129, 16
_NODES, _ = gauss_rule(_POINTS)
#: From values at the nodes to the Legendre coefficients of the slope.
_SLOPE = legder(legendre_expansion_matrix(_POINTS, _POINTS - 1))


class LargestRatio(NamedTuple):
    """q/p at the edge, its largest modulus, and ``y = 1 - s**2`` where that is reached."""

    edge: float
    largest: float
    y: float


def largest_ratio(pressure: PressureField, traction: DiskSeries, depth: float) -> LargestRatio:
    """Return q/p at the edge and at its largest.

    Parameters
    ----------
    pressure : PressureField
        Positive.
    traction : DiskSeries
        On the whole contact.
    depth : float
        ``-ln y`` down to which the maximum is looked for.
    """
    alike = pressure.series is not None and pressure.series.on_panels_of(traction.series)

    def ratio(x: Array) -> Array:
        y = np.exp(-x)
        s = np.sqrt(-np.expm1(-x))
        assert traction.series is not None
        if not alike:
            return np.abs(s * traction.series(y) / pressure.at(y))
        above, below = PressureField.several([PressureField(None, traction.series), pressure], y)
        return np.asarray(np.abs(s * above / below))

    at_edge = pressure.value(0.0)
    if at_edge == inf:
        edge = 0.0
    else:
        assert traction.series is not None
        edge = traction.series.limit / at_edge
        if edge == inf:
            return LargestRatio(inf, inf, 0.0)
    x = np.linspace(1e-3, depth, _GRID)
    values = ratio(x)
    i = int(np.argmax(values))
    if values[i] <= abs(edge) * (1.0 + 4e-16):
        return LargestRatio(edge, abs(edge), 0.0)
    low, high = float(x[max(i - 1, 0)]), float(x[min(i + 1, _GRID - 1)])
    middle, half = (low + high) / 2.0, (high - low) / 2.0
    near = middle + half * _NODES
    around = ratio(near)
    top = middle + half * _stationary((_SLOPE @ around).tolist(), int(np.argmax(around)))
    # of what was seen the largest counts, so that a jump between panels does no harm
    seen = np.concatenate([values, around, ratio(np.array([top]))])
    i = int(np.argmax(seen))
    where = [*x, *near, top][i]
    return LargestRatio(edge, float(seen[i]), float(np.exp(-where)))


def _stationary(slope: list[float], nearest: int) -> float:
    """Return the zero of a Legendre series on [-1, 1] next to a node, by secants."""
    before, x = (float(_NODES[min(max(nearest + k, 0), _POINTS - 1)]) for k in (-1, 1))
    value_before, value = legendre_sum(before, slope), legendre_sum(x, slope)
    for _ in range(8):
        if value == value_before:
            break
        step = -value * (x - before) / (value - value_before)
        before, value_before, x = x, value, min(max(x + step, -1.0), 1.0)
        if abs(x - before) < 1e-9:
            break
        value = legendre_sum(x, slope)
    return x
