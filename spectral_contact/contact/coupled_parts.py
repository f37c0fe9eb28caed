"""Panels of the parts of a coupled contact: how deep they go, and all of them as one space."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import accumulate, pairwise
from math import atanh, ceil, log, pi

import numpy as np
from numpy.typing import NDArray

from spectral_contact.contact.refine import Resolution
from spectral_contact.fields.series import LogSeries, Radius
from spectral_contact.spectral.panels import LogPanels
from spectral_contact.spectral.parameters import Parameters

__all__ = [
    "LEADING",
    "ended",
    "joined",
    "leading_depth",
    "parted",
    "root_error",
    "rounding_depth",
    "thinnest_layer",
    "without_rounding",
]

Array = NDArray[np.float64]

#: Depth in ``-ln y``, past the layer, from which a singular field is its leading term, to 1e-13.
LEADING = 30.0
#: Rounding of a radius next to it, closer to which nothing can be asked; panels go deeper by this
#: in ``-ln d``, as where they end is felt for a while.
_CLOSEST, _DEEPER = 2.2e-16, 10.0
#: Error at an end with a root there, relative to the change of the tail: 1.9, measured.
_ROOT = 2.5


def leading_depth(alpha: float, beta: float, extent: float) -> float:
    """Return the depth toward the edge past which a singular field is its leading term."""
    return LEADING + thinnest_layer(alpha, beta, extent)


def thinnest_layer(alpha: float, beta: float, extent: float) -> float:
    """Return ``-ln`` of the width of the thinnest layer in units of an extent in ``s**2``, or 0."""
    return -log(min([1.0, *(c / extent for c in (alpha, beta) if c > 0.0)]))


def ended(
    pressure: LogSeries, shear: LogSeries, parameters: Parameters, extent: float
) -> list[LogSeries]:
    """Return p and q/s toward an edge that sticks; what is singular ends in its leading term.

    Where both are, on smooth surfaces, they oscillate: ``sqrt(y) (p + i q)`` goes over into
    ``exp(-i theta ln y)`` with ``theta = ln(3 - 4 nu)/(2 pi)``.
    """
    alpha, beta, kappa, _ = parameters
    both = [pressure, shear]
    count = ceil(leading_depth(alpha, beta, extent) / pressure.width)
    if count > len(pressure.coefficients):
        return both
    a, b = (float(one.coefficients[count - 1].sum()) for one in both)
    smooth = alpha == 0.0 == beta
    theta, tails = (atanh(2.0 * kappa) / pi, [(a, -b), (b, a)]) if smooth else (0.0, [(a,), (b,)])
    return [
        replace(one, coefficients=one.coefficients[:count], tail=np.array(tail), oscillation=theta)
        if one.power
        else one
        for one, tail in zip(both, tails, strict=True)
    ]


def rounding_depth(end: Radius, extent: float) -> float:
    """Return ``-ln`` of the rounding of a boundary in units of an extent in ``s**2``."""
    return -log(_CLOSEST * min(end.square, end.rest) / extent)


def without_rounding(space: Resolution, end: Radius, extent: float) -> Resolution:
    """Return a space toward a boundary without the panels that only rounding could tell of."""
    most = ceil((_DEEPER + rounding_depth(end, extent)) / space.panels.width)
    degrees = space.degrees[:most]
    return Resolution(replace(space.panels, panels=len(degrees)), degrees)


def root_error(panels: LogPanels, change: Array, at_end: float) -> float:
    """Return the error of a field at an end where it has a root: no degree of a panel helps."""
    return _ROOT * float(np.abs(change[-panels.tail_terms :]).sum() / abs(at_end))


def joined(spaces: Sequence[Resolution]) -> Resolution:
    """Return the spaces of all parts as one, for `refine`."""
    capacity = max(one.panels.degree for one in spaces)
    degrees = tuple(n for one in spaces for n in one.degrees)
    return Resolution(replace(spaces[0].panels, degree=capacity), degrees)


def parted(resolution: Resolution, counts: Sequence[int], alpha: float) -> list[Resolution]:
    """Return the spaces of all parts; the pressure under a smooth edge has its singularity.

    Parameters
    ----------
    resolution : Resolution
        As `joined` returns it.
    counts : sequence of int
        Numbers of panels.
    alpha : float
        ``alpha*``.
    """
    spaces, bounds = [], list(accumulate(counts, initial=0))
    for a, b in pairwise(bounds):
        power = -0.5 if alpha == 0.0 and b == bounds[-1] else 0.0
        panels = replace(resolution.panels, panels=b - a, power=power)
        spaces.append(Resolution(panels, resolution.degrees[a:b]))
    return spaces
