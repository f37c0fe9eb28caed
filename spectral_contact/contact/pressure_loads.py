"""The load of a pressure outside of a radius, and its mean inside of one.

Radii s are over the radius of the contact, and ``y = 1 - s**2``. Loads are over 2 pi.
"""

from __future__ import annotations

from math import sqrt

import numpy as np

from spectral_contact.fields.series import Array, LogSeries, PressureField
from spectral_contact.spectral.graded import FAR_NODES
from spectral_contact.spectral.jacobi import gauss_rule


def load_outside(pressure: PressureField, y: Array) -> Array:
    """Return ``int_s^1 p s ds = 1/2 int_0^y p dy``, the load outside of s over 2 pi.

    The endpoint weight ``amplitude / sqrt(y + shift)`` is integrated in closed form.
    """
    load = np.zeros(len(y))
    if pressure.series is not None:
        load += 0.5 * _integral_to_edge(pressure.series, y)
    weight = pressure.weight
    if weight is not None:
        root_sum = np.sqrt(y + weight.shift) + sqrt(weight.shift)
        load += weight.amplitude * y / np.where(root_sum > 0.0, root_sum, 1.0)
    return load


def mean_inside(pressure: PressureField, y: Array) -> Array:
    """Return the mean of the pressure over the disk ``s**2 <= 1 - y``, for ``y >= 1/2``."""
    # the nearest singularity is the edge y = 0; it is at least half the length of the interval away
    nodes, weights = gauss_rule(len(FAR_NODES))
    points = 1.0 - (1.0 - y)[..., None] * (1.0 + nodes) / 2.0
    return np.asarray(pressure.evaluate(points) @ (weights / 2.0))


def _integral_to_edge(series: LogSeries, y: Array) -> Array:
    """Return ``int_0^y`` of a series in y, panel by panel.

    Panel k covers depths ``x = -ln y`` from ``k width`` to ``(k + 1) width``; the tail is all
    beyond the last panel, and counts as one more panel. Gauss's rule is used in x on panels, and in
    y on the tail.
    """
    panels, terms = series.coefficients.shape
    width = series.width
    x = -np.log(y)
    # one row per whole panel, then one per y: that part of its panel which is nearer to the edge
    panel = np.concatenate([np.arange(panels + 1), np.clip(x / width, 0.0, panels).astype(int)])
    start = np.concatenate([width * np.arange(panels + 1), x])
    distance = np.concatenate([series.ends, y])
    gauss_nodes, gauss_weights = gauss_rule(terms)
    nodes = (1.0 + gauss_nodes) / 2.0
    length = (panel + 1) * width - start
    points = np.exp(-start[:, None] - length[:, None] * nodes)
    weights = length[:, None] * points
    in_tail = panel == panels
    points[in_tail] = distance[in_tail, None] * nodes
    weights[in_tail] = distance[in_tail, None]
    values = series(points.ravel()).reshape(points.shape)
    integrals = (values * weights) @ (gauss_weights / 2.0)
    # of all panels nearer to the edge than panel k
    remainder = np.append(np.cumsum(integrals[panels:0:-1])[::-1], 0.0)
    return np.asarray(integrals[panels + 1 :] + remainder[panel[panels + 1 :]])
