r"""How far the surface outside a flat punch goes down with it.

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

#: Number of panels in ``-ln Y``, their width, and the points on each. Nearer to the edge than the
#: last panel the surface goes down as at the edge.
_PANELS, _WIDTH, _POINTS = 36, 2.0, 16
#: Quadrature of the pressure towards the boundary of a zone, where it is almost smooth: points on a
#: panel, panels, and the ratio of the widths of two neighbours. Towards the edge the rule has the
#: panels above, in ``-ln y``.
_BOUNDARY = 12, 16, 0.15


def outside_displacement(flat: Solution) -> LogSeries:
    """Return ``omega / xi`` as a series in ``Y``.

    Parameters
    ----------
    flat : Solution
        Of a flat punch, with zones and pressure.
    """
    field = flat.pressure_field
    assert field is not None
    inner = [Radius(zone.outer, zone.outer_from_edge) for zone in flat.zones[:-1]]
    y, weights = _quadrature(inner)
    s = np.sqrt(1.0 - y)
    strength = weights * field(s, y / (1.0 + s)) / (2.0 * math.pi * flat.approach)
    kernel = _kernel(y) if inner else _kernel_of_one_zone()
    values = (kernel @ strength).reshape(_PANELS, _POINTS)
    table = values @ legendre_expansion_matrix(_POINTS, _POINTS - 1).T
    return LogSeries(table, np.array([table[-1].sum()]), _WIDTH)


def reached(series: list[LogSeries], ahead: Array) -> Array:
    """Return ``omega`` of several punches at radii outside of them, (punches, n).

    ``ahead`` is the logarithm of the radius over that of the punch.
    """
    distance = -np.expm1(-2.0 * ahead)
    return LogSeries.several(series, distance) * np.exp(-ahead)


@bounded_cache("outside a flat punch", 1)
def _kernel_of_one_zone() -> Array:
    """Return `_kernel` without boundaries of zones inside (cached)."""
    return _kernel(_quadrature([])[0])


def _kernel(y: Array) -> Array:
    """Return ``K(m)`` at all points of the panels, for pressures at `y`."""
    outside = _toward_edge()[0][:, None]
    return np.asarray(ellipkm1(y + outside * (1.0 - y)))


def _quadrature(inner: list[Radius]) -> tuple[Array, Array]:
    """Return ``y`` and weights on zones with these boundaries, graded to them and to the edge."""
    d, w = _toward_edge()
    if not inner:
        return d, w
    g, v = graded_rule(*_BOUNDARY)
    rests = [0.0, *(one.rest for one in inner[::-1]), 1.0]
    middle = rests[1] / 2.0
    points, weights = [middle * d], [middle * w]
    for k, (low, high) in enumerate(pairwise(rests)):
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
    """Return distances and weights of a rule on (0, 1) for what is singular at 0.

    What is nearer to 0 than the last panel is left out: of the integral of an inverse root 2e-16.
    """
    g, w = gauss_rule(_POINTS)
    d = np.exp(-_WIDTH * (np.arange(_PANELS)[:, None] + (1.0 + g) / 2.0))
    return d.ravel(), (d * w * _WIDTH / 2.0).ravel()
