"""The load that a pressure carries outside of a radius, and its mean inside of one."""

from __future__ import annotations

from math import sqrt

import numpy as np

from spectral_contact.fields.series import Array, LogSeries, PressureField
from spectral_contact.spectral.jacobi import gauss_rule

#: Points of a Gauss rule that is right to rounding for a pressure over ``1/2 <= y <= 1``, where it
#: is analytic up to the edge, at a distance of half the interval or more.
_CENTRAL_POINTS = 40


def load_outside(pressure: PressureField, y: Array) -> Array:
    """Return ``1/2 int_0^y p dy`` at ``y = 1 - s**2``: 1/(2 pi) of the load from s to the edge."""
    load = np.zeros(len(y))
    if pressure.series is not None:
        load += 0.5 * _integral(pressure.series, y)
    weight = pressure.weight
    if weight is not None:
        root = np.sqrt(y + weight.shift) + sqrt(weight.shift)
        load += weight.amplitude * y / np.where(root > 0.0, root, 1.0)
    return load


def mean_inside(pressure: PressureField, y: Array) -> Array:
    """Return the mean of the pressure over the disk ``s**2 <= 1 - y``, for ``y >= 1/2``."""
    g, w = gauss_rule(_CENTRAL_POINTS)
    points = 1.0 - (1.0 - y)[..., None] * (1.0 + g) / 2.0
    return np.asarray(pressure.at(points) @ (w / 2.0))


def _integral(series: LogSeries, y: Array) -> Array:
    """Return the integral of a series from 0 to distances, panel by panel."""
    panels, terms = series.coefficients.shape
    width = series.width
    x = -np.log(y)
    # whole panels first, then what is left of one panel up to each distance; the tail is the last
    panel = np.concatenate([np.arange(panels + 1), np.clip(x / width, 0.0, panels).astype(int)])
    start = np.concatenate([width * np.arange(panels + 1), x])
    distance = np.concatenate([series.ends, y])
    g, w = gauss_rule(terms)
    place = (1.0 + g) / 2.0
    rest = (panel + 1) * width - start
    points = np.exp(-start[:, None] - rest[:, None] * place)
    weights = rest[:, None] * points
    in_tail = panel == panels
    points[in_tail] = distance[in_tail, None] * place
    weights[in_tail] = distance[in_tail, None]
    values = series(points.ravel()).reshape(points.shape)
    integrals = (values * weights) @ (w / 2.0)
    beyond = np.zeros(panels + 1)
    beyond[:-1] = np.cumsum(integrals[panels:0:-1])[::-1]
    return np.asarray(integrals[panels + 1 :] + beyond[panel[panels + 1 :]])
