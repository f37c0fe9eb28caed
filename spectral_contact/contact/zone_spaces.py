"""First spaces of both fields on any zones.

Every part of the disk has a mesh that is graded to one of its ends (depth ``x = -ln d``, with the
distance d in units of the extent of the part). The first space of a part follows from the kind of
that end. With ``l = -ln`` of the width of a layer in units of the extent, r the ratio of the extent
to that of the part across the end, and both widths of layers alpha and beta (where it sticks):

========================  ====================  ====  ============================  ==========
kind of end               settles from depth    rate  bends at depths               power of d
========================  ====================  ====  ============================  ==========
edge, full stick          deepest l             1     every l - BEND_LEAD           0
... with one compliance   l                     1/2   l - BEND_LEAD                 0 or -1/2
edge, smooth, full stick  LEADING_TERM_DEPTH    1     none                          -1/2
edge, alpha > 0           l + EDGE_LAYER_REACH  1     l - EDGE_LAYER_REACH          0
edge, alpha = 0 < beta    l                     1/2   l                             -1/2
edge, alpha = beta = 0    0 or the leading      1     none                          theta - 1/2
                          term
boundary                  l, l/2 + BEND_LEAD,   1 or  l - 1 where it sticks, ln r   0
                          or ln r               1/2
rim, beta = 0             ln r                  0     ln r, end of the layer of p   0
========================  ====================  ====  ============================  ==========

A field settles like ``exp(-rate (x - depth))``. The rate 0 stands for square roots, which end in a
tail of powers of ``sqrt(d)``. Measured costs of other choices are in `tuning` and docs/coupling.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import accumulate, pairwise
from math import atan, atanh, ceil, log, pi
from typing import NamedTuple

import numpy as np

from spectral_contact.contact.resolution import bend_weight, slip_degree
from spectral_contact.contact.tuning import (
    ANNULUS_START_DEGREES,
    BEND_DEGREES,
    BEND_LEAD,
    COARSE_TOL,
    DISK_START_DEGREES,
    EDGE_LAYER_REACH,
    EDGE_START_DEGREES,
    EXTRA_BOUNDARY_DEPTH,
    KNOWN_PRESSURE_SPARE_DEGREES,
    LEADING_TERM_DEPTH,
    MAX_SLIP_TOL,
    PANEL_WIDTH,
    ROOT_TAIL_DEPTH,
    SLIP_TOL_FACTOR,
    STICK_SPARE_DEGREES,
    WEAK_BEND_DEGREES,
    ZONE_DEGREES,
)
from spectral_contact.fields.series import CENTRE, EDGE, LogSeries, Radius
from spectral_contact.spectral.cache import bounded_cache
from spectral_contact.spectral.panels import LEAST_DEGREE, DiscreteSpace, LogPanels
from spectral_contact.spectral.parameters import Parameters
from spectral_contact.spectral.parts import gap

#: Rounding of a radius relative to its distance from the centre or the edge.
_EPS = float(np.finfo(float).eps)


# depths, and what fields are deep down


def leading_depth(alpha: float, beta: float, extent: float) -> float:
    """Return the depth toward the edge past which a singular field is its leading term."""
    return LEADING_TERM_DEPTH + layer_depth(alpha, beta, extent)


def layer_depth(alpha: float, beta: float, extent: float) -> float:
    """Return ``-ln(w/extent)`` with the width w of the thinnest layer in ``s**2``; at least 0."""
    return -log(min([1.0, *(c / extent for c in (alpha, beta) if c > 0.0)]))


def with_asymptotic_tail(
    pressure: LogSeries, shear: LogSeries, parameters: Parameters, extent: float
) -> list[LogSeries]:
    """Return p and q/s toward an edge that sticks, with leading terms in place of deep panels.

    A singular field is ``sqrt(y) p = a`` past `leading_depth`, and is evaluated so there. On smooth
    surfaces p and q are singular both and oscillate: ``sqrt(y) (p + i q)`` is a constant times
    ``exp(-i theta ln y)``, with ``theta = ln(3 - 4 nu)/(2 pi)``.
    """
    alpha, beta, kappa, _ = parameters
    fields = [pressure, shear]
    count = ceil(leading_depth(alpha, beta, extent) / pressure.width)
    if count > len(pressure.coefficients):
        return fields
    p_end, q_end = (float(field.coefficients[count - 1].sum()) for field in fields)
    tails: list[tuple[float, ...]]
    if alpha == 0.0 == beta:
        theta = atanh(2.0 * kappa) / pi
        tails = [(p_end, -q_end), (q_end, p_end)]
    else:
        theta = 0.0
        tails = [(p_end,), (q_end,)]
    return [
        replace(
            field,
            coefficients=field.coefficients[:count],
            tail=np.array(tail),
            oscillation=theta,
        )
        if field.power
        else field
        for field, tail in zip(fields, tails, strict=True)
    ]


def rounding_depth(end: Radius, extent: float) -> float:
    """Return ``-ln`` of the rounding of a boundary in units of an extent in ``s**2``."""
    return -log(_EPS * min(end.square, end.rest) / extent)


def without_rounding(space: DiscreteSpace, end: Radius, extent: float) -> DiscreteSpace:
    """Return a space toward a boundary without panels far deeper than the rounding of it."""
    most = ceil((EXTRA_BOUNDARY_DEPTH + rounding_depth(end, extent)) / space.panels.width)
    degrees = space.degrees[:most]
    return DiscreteSpace(replace(space.panels, panels=len(degrees)), degrees)


def edge_power(parameters: Parameters, states: tuple[int, ...]) -> float:
    """Return the power of ``y`` that the pressure is next to the edge, for the endpoint weight.

    Under a smooth edge that slips it is ``theta - 1/2`` with ``tan(pi theta) = 2 kappa f``
    (docs/coupling.md). With the weight ``y**(-1/2)`` instead the series fall like ``y**theta``,
    while their rounding does not: at kappa f = 0.66 the pressure had six digits less at
    ``y = exp(-30)`` than at the boundary of slip.
    """
    alpha, _, kappa, friction = parameters
    if alpha > 0.0:
        return 0.0
    return atan(2.0 * kappa * friction) / pi - 0.5 if states[-1] > 0 else -0.5


def split_spaces(
    resolution: DiscreteSpace, counts: Sequence[int], power: float
) -> list[DiscreteSpace]:
    """Return the spaces of all parts from what `concatenate_spaces` made of them.

    Parameters
    ----------
    resolution : DiscreteSpace
    counts : sequence of int
        Numbers of panels of the parts.
    power : float
        Endpoint weight of the pressure on the last part, see `edge_power`. A tail of roots is that
        of the disk.
    """
    spaces = []
    bounds = list(accumulate(counts, initial=0))
    for first, end in pairwise(bounds):
        panels = replace(
            resolution.panels,
            panels=end - first,
            power=power if end == bounds[-1] else 0.0,
            root_tail=resolution.panels.root_tail and first == 0,
        )
        spaces.append(DiscreteSpace(panels, resolution.degrees[first:end]))
    return spaces


# the first spaces of all parts


def first_spaces(
    alpha: float,
    beta: float,
    radii: tuple[Radius, ...],
    states: tuple[int, ...],
    tolerance: float,
    power: float = -0.5,
) -> list[DiscreteSpace]:
    """Return the first spaces on the disk, and toward both ends of every zone around it.

    Parameters
    ----------
    alpha, beta : float
        ``alpha*`` and ``beta*``, 0 or positive.
    radii : tuple of Radius
        Boundaries between zones, outward.
    states : tuple of int
        0 for stick; in slip the traction has no layer of its own.
    tolerance : float
        Relative accuracy that is wanted.
    power : float
        Endpoint weight of the pressure under a smooth edge with slip around the disk.
    """
    if not radii:
        # with one compliance only its field has a square root at the edge
        has_root = (alpha == 0.0) != (beta == 0.0)
        end = _full_stick_edge(alpha, beta, has_root, STICK_SPARE_DEGREES, WEAK_BEND_DEGREES)
        return [_space(end, tolerance)]
    bounds = CENTRE, *radii, EDGE
    extents = [gap(*pair) / 2.0 for pair in pairwise(bounds)]
    extents[0] *= 2.0  # the disk is one part, other zones are two
    spaces = []
    for k, (state, extent) in enumerate(zip(states, extents, strict=True)):
        layer_of_shear = 0.0 if state else beta
        # the disk has a mesh toward its rim only
        for bound in (k, k + 1)[k == 0 :]:
            if bounds[bound].from_edge == 0.0:
                spaces.append(_space(_edge(alpha, layer_of_shear, extent, power), tolerance))
                continue
            extent_across = extents[k - 1] if bound == k else extents[k + 1]
            rate = 1.0 if alpha > 0.0 and (state or beta > 0.0) else 0.5
            if alpha == 0.0 == beta:
                rate = _smooth_boundary_rate(power, tolerance)
            layer = layer_depth(alpha, layer_of_shear, extent)
            end = _boundary(layer, extent / extent_across, rate, k, state)
            space = _space(end, tolerance)
            if alpha > 0.0 or len(radii) > 1:
                space = without_rounding(space, bounds[bound], extent)
            spaces.append(space)
    return spaces


def known_pressure_spaces(
    alpha: float, beta: float, radii: tuple[Radius, ...], states: tuple[int, ...], tolerance: float
) -> list[DiscreteSpace]:
    """Return first spaces under a known pressure, which has the same degree on all panels in slip.

    Parameters are those of `first_spaces`.
    """
    if not radii:
        end = _full_stick_edge(alpha, beta, alpha == 0.0, KNOWN_PRESSURE_SPARE_DEGREES)
        return [_space(end, tolerance)]
    spaces = first_spaces(alpha, beta, radii, states, tolerance)
    if beta == 0.0 and states == (0, 1):
        spaces[0] = _space(_rigid_rim(alpha, radii[0]), tolerance)
    # a coarse space, in which boundaries are located, has a coarse pressure, too
    slip_tol = (
        min(SLIP_TOL_FACTOR * tolerance, MAX_SLIP_TOL) if tolerance < COARSE_TOL else tolerance
    )
    degree = slip_degree(slip_tol)
    return [
        DiscreteSpace(replace(space.panels, degree=degree), (degree,) * space.panels.panels)
        if states[(part + 1) // 2]
        else space
        for part, space in enumerate(spaces)
    ]


def _smooth_boundary_rate(power: float, tolerance: float) -> float:
    """Return the rate at which fields settle next to the boundary of slip on a smooth surface.

    They go like ``d**(1/2 - theta)``, with theta of `edge_power`. The rate is not so small that the
    mesh would be deeper than the rounding of the boundary.
    """
    deepest = EXTRA_BOUNDARY_DEPTH - log(_EPS)
    return max(-power, min(0.5, (2.0 - log(tolerance)) / deepest))


# the table: a row for every kind of end


class _End(NamedTuple):
    """An end of a part, as far as the first space toward it depends on it.

    Attributes
    ----------
    settling_depth : float
        Depth past which the fields settle.
    rate : float
        They settle like ``exp(-rate x)``; 0 for a tail of roots.
    bends : list of (float, float)
        Depths at which the fields bend, with the slopes of degrees that this takes.
    start_degrees : float
        Slope of degrees in addition on the first panel.
    power : float
        Of the endpoint weight.
    spare_degrees : float
        Degrees in addition on every panel.
    """

    settling_depth: float
    rate: float
    bends: list[tuple[float, float]]
    start_degrees: float = 0.0
    power: float = 0.0
    spare_degrees: float = 0.0


def _full_stick_edge(
    alpha: float, beta: float, has_root: bool, spare_degrees: float, start_degrees: float = 0.0
) -> _End:
    """Return the edge of a disk that sticks: both layers bend both fields.

    With one compliance the field of the other one is singular, and its own has a square root.
    """
    layers = [-log(min(c, 1.0)) for c in (alpha, beta) if c > 0.0]
    return _End(
        settling_depth=max(layers, default=LEADING_TERM_DEPTH),
        rate=0.5 if has_root else 1.0,
        bends=[(layer - BEND_LEAD, BEND_DEGREES) for layer in layers],
        start_degrees=start_degrees,
        power=-0.5 if alpha == 0.0 else 0.0,
        spare_degrees=spare_degrees,
    )


def _edge(alpha: float, beta: float, extent: float, power: float) -> _End:
    """Return the edge of a zone around the disk; beta is 0 where it slips."""
    layer = layer_depth(alpha, beta, extent)
    if alpha > 0.0:
        bends = [(layer - EDGE_LAYER_REACH, BEND_DEGREES)]
        return _End(layer + EDGE_LAYER_REACH, 1.0, bends, EDGE_START_DEGREES)
    if beta == 0.0:
        # with the power of slip the pressure settles to its endpoint weight at once
        settling_depth = LEADING_TERM_DEPTH if power == -0.5 else 0.0
        return _End(settling_depth, 1.0, [], EDGE_START_DEGREES, power)
    return _End(layer, 0.5, [(layer, BEND_DEGREES)], EDGE_START_DEGREES, -0.5)


def _boundary(layer: float, ratio: float, rate: float, zone: int, state: int) -> _End:
    """Return a boundary between zones; the part is `ratio` times as large as the one across it."""
    bends = [(layer - 1.0, WEAK_BEND_DEGREES)] if state == 0 and layer > 1.0 else []
    # next to a boundary the fields settle at half the depth of the layer, or soon after it
    settling_depth = min(layer, 0.5 * layer + BEND_LEAD)
    if ratio > 1.0:
        bends.append((log(ratio), WEAK_BEND_DEGREES if state else BEND_DEGREES))
        settling_depth = max(settling_depth, log(ratio))
    start_degrees = ANNULUS_START_DEGREES if zone else DISK_START_DEGREES
    return _End(settling_depth, rate, bends, start_degrees)


def _rigid_rim(alpha: float, rim: Radius) -> _End:
    """Return the rim of a stick disk without tangential compliance under a known pressure.

    The traction has a root at the rim. It bends where the annulus around it ends, and where the
    pressure ceases to rise toward the edge.
    """
    annulus = -log(min(rim.rest / rim.square, 1.0))
    pressure_layer = -log(min(max(alpha, rim.rest) / rim.square, 1.0))
    bends = [(annulus, WEAK_BEND_DEGREES), (pressure_layer, WEAK_BEND_DEGREES)]
    return _End(annulus, 0.0, bends, spare_degrees=KNOWN_PRESSURE_SPARE_DEGREES)


# a space from a row of the table


def _space(end: _End, tolerance: float) -> DiscreteSpace:
    """Return the first space toward an end."""
    # depths are rounded up, so that scenes that are much alike have the same space
    settling_depth = ceil(2.0 * end.settling_depth) / 2.0
    bends = tuple((ceil(2.0 * depth) / 2.0, slope) for depth, slope in end.bends)
    return _graded_space(
        PANEL_WIDTH,
        -log(tolerance),
        settling_depth,
        end.rate,
        bends,
        end.start_degrees,
        end.power,
        end.spare_degrees,
    )


@bounded_cache("first spaces on zones")
def _graded_space(
    width: float,
    digits: float,
    settling_depth: float,
    rate: float,
    bends: tuple[tuple[float, float], ...],
    start_degrees: float,
    power: float,
    spare_degrees: float,
) -> DiscreteSpace:
    """Return a space whose degrees are ``1 + spare + digits * slope`` (cached).

    The slope is ZONE_DEGREES times the share of the digits that have not settled at the depth of a
    panel, and what bends and the start add.
    """
    depth = settling_depth + ((digits + 2.0) / rate if rate else ROOT_TAIL_DEPTH)
    panels = 2 * ceil(depth / width / 2.0)
    x = width * np.arange(panels)
    unsettled = np.clip(1.0 - rate * (x - settling_depth) / (digits + 2.0), 0.0, 1.0)
    added = np.zeros(panels)
    for bend, slope in bends:
        added = np.maximum(added, slope * bend_weight(panels, bend))
    if start_degrees:
        added[:2] = np.maximum(added[:2], (start_degrees, WEAK_BEND_DEGREES))
    degrees_per_digit = ZONE_DEGREES * unsettled + added
    degrees = np.ceil(1.0 + spare_degrees + digits * degrees_per_digit).astype(int)
    degrees = np.maximum(degrees, LEAST_DEGREE)
    capacity = 4 * ceil((int(degrees.max()) + 4) / 4)
    mesh = LogPanels(panels, width, capacity, power, root_tail=rate == 0.0)
    return DiscreteSpace(mesh, tuple(degrees.tolist()))
