r"""The displacement of the surface outside a flat punch.

Outside the contact the shear does not move the surface normally (docs/theory: the term
``kappa int_s^1 q`` ends at the edge), so for unit approach, at ``x = 1/xi`` radii,

    omega = (1/(pi delta*)) int_0^1 p* K1(eta, x) d eta = (xi/(2 pi delta*)) int_0^1 p* K(m) dy

with ``1 - m = y + Y - y Y`` in the distances ``y = 1 - eta**2`` and ``Y = 1 - xi**2``.
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from scipy.special import ellipkm1

from spectral_contact.fields import Array
from spectral_contact.fields.series import LogSeries, Radius
from spectral_contact.spectral.cache import bounded_cache
from spectral_contact.spectral.jacobi import gauss_rule, graded_rule, legendre_expansion_matrix

if TYPE_CHECKING:
    from spectral_contact.solution import Solution

#: Number of panels in ``-ln Y``. Nearer to the edge than the last panel the displacement is taken
#: to be that at the edge.
_PANELS = 36
#: Width of a panel.
_WIDTH = 2.0
#: Number of points on a panel.
_POINTS = 16
#: Arguments of `graded_rule` for the pressure towards the boundary of a zone, where it is almost
#: smooth: points on a panel, panels, and the ratio of the widths of two neighbours. Towards the
#: edge the rule has the panels above, in ``-ln y``.
_BOUNDARY_RULE = 12, 16, 0.15


def outside_displacement(flat: Solution) -> LogSeries:
    """Return ``omega / xi`` as a series in ``Y``.

    Parameters
    ----------
    flat : Solution
        Of a flat punch, with zones and pressure.
    """
    field = flat.pressure_field
    assert field is not None
    boundaries = [Radius(zone.outer, zone.outer_from_edge) for zone in flat.zones[:-1]]
    y, weights = _quadrature(boundaries)
    s = np.sqrt(1.0 - y)
    weighted_pressure = weights * field(s, y / (1.0 + s)) / (2.0 * math.pi * flat.approach)
    kernel = _kernel(y) if boundaries else _kernel_of_one_zone()
    values = (kernel @ weighted_pressure).reshape(_PANELS, _POINTS)
    table = values @ legendre_expansion_matrix(_POINTS, _POINTS - 1).T
    return LogSeries(table, np.array([table[-1].sum()]), _WIDTH)


def outside_values(series: list[LogSeries], log_ratio: Array) -> Array:
    """Return ``omega`` of several punches at radii outside of them, (punches, n).

    ``log_ratio`` is the logarithm of the radius over that of the punch.
    """
    distance = -np.expm1(-2.0 * log_ratio)
    return LogSeries.values_of(series, distance) * np.exp(-log_ratio)


@bounded_cache("outside a flat punch", 1)
def _kernel_of_one_zone() -> Array:
    """Return `_kernel` without boundaries of zones inside (cached)."""
    return _kernel(_quadrature([])[0])


def _kernel(y: Array) -> Array:
    """Return ``K(m)`` at all points of the panels, for pressures at `y`."""
    outside = _toward_edge()[0][:, None]
    return np.asarray(ellipkm1(y + outside * (1.0 - y)))


def _quadrature(boundaries: list[Radius]) -> tuple[Array, Array]:
    """Return ``y`` and weights on zones with these boundaries, graded to them and to the edge.

    Each zone is cut in the middle, as it is singular at both ends. The outer half of the outermost
    zone has the rule for the edge.
    """
    d, w = _toward_edge()
    if not boundaries:
        return d, w
    g, v = graded_rule(*_BOUNDARY_RULE)
    y_of_boundaries = [0.0, *(boundary.rest for boundary in boundaries[::-1]), 1.0]
    middle = y_of_boundaries[1] / 2.0
    points = [middle * d]
    weights = [middle * w]
    for k, (low, high) in enumerate(pairwise(y_of_boundaries)):
        start = middle if k == 0 else low
        if k > 0:
            half = (high - start) / 2.0
            points.append(start + half * g)
            weights.append(half * v)
            start += half
        points.append(high - (high - start) * g)
        weights.append((high - start) * v)
    return np.concatenate(points), np.concatenate(weights)


def _toward_edge() -> tuple[Array, Array]:
    """Return distances and weights of a rule on (0, 1) for integrands that are singular at 0.

    The part nearer to 0 than the last panel is left out. In the integral of an inverse square root
    that is 2e-16.
    """
    g, w = gauss_rule(_POINTS)
    d = np.exp(-_WIDTH * (np.arange(_PANELS)[:, None] + (1.0 + g) / 2.0))
    return d.ravel(), (d * w * _WIDTH / 2.0).ravel()
