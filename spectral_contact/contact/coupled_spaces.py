"""First spaces for pressure and traction together, on any zones.

What they need was measured (docs/coupling): fewer degrees than a pressure alone is given. Thin
layers are felt at the edge, to which the pressure rises. At the rim they are felt half as deep.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from math import ceil, log

import numpy as np

from spectral_contact.contact.coupled_parts import LEADING, thinnest_layer, without_rounding
from spectral_contact.contact.refine import Resolution
from spectral_contact.contact.resolution import PANEL_WIDTH, nearness
from spectral_contact.fields.series import CENTRE, EDGE, Radius
from spectral_contact.spectral.annulus import gap
from spectral_contact.spectral.panels import LogPanels

__all__ = ["first_spaces", "with_known_slip"]

#: Degrees per ``-ln`` of the tolerance: on any panel, at a bend, at a lesser one, and on the first
#: two panels, on the disk, above its rim, where the far end is a singularity ln 2 before them, and
#: at the edge.
_ALL, _BEND, _TURN = 0.43, 0.15, 0.08
_INSIDE, _AROUND, _AT_EDGE = (0.28, 0.1), (0.54, 0.1), (0.42, 0.08)
#: How far before the layer a bend is where all sticks; and further degrees there: of 300 scenes and
#: tolerances one needs a second space.
_BEFORE, _STUCK_SPARE = 3.0, 1
#: How far in ``-ln y`` a layer of the pressure is felt at the edge.
_FELT = 4.0
#: Accuracy of a pressure that is given, of the tolerance and at least, and tolerances of spaces in
#: which boundaries are only looked for, where it is the tolerance.
_QUADRATURE, _FINEST, _ROUGHLY = 0.01, 1e-11, 1e-3
#: Least degree on a panel: the estimate sheds two degrees and must keep one.
_LEAST = 2


def first_spaces(
    alpha: float, beta: float, radii: tuple[Radius, ...], states: tuple[int, ...], tolerance: float
) -> list[Resolution]:
    """Return the first spaces on the disk, and toward both ends of every zone around it.

    Parameters
    ----------
    alpha, beta : float
        ``alpha*`` and ``beta*``, 0 or positive.
    radii : tuple of Radius
        Boundaries between zones, outward.
    states : tuple of int
        0 for stick; in slip no layer of the traction is felt.
    tolerance : float
        Relative accuracy asked.
    """
    if not radii:
        return [_all_sticks(alpha, beta, tolerance)]
    bounds = CENTRE, *radii, EDGE
    extents = [gap(*pair) / 2.0 for pair in pairwise(bounds)]
    extents[0] *= 2.0
    spaces = []
    for k, (state, extent) in enumerate(zip(states, extents, strict=True)):
        felt = 0.0 if state else beta
        for end in (k, k + 1)[k == 0 :]:
            if bounds[end].from_edge == 0.0:
                spaces.append(_to_the_edge(alpha, felt, extent, tolerance))
                continue
            other = extents[k - 1] if end == k else extents[k + 1]
            rate = 1.0 if alpha > 0.0 and (state or beta > 0.0) else 0.5
            layer = thinnest_layer(alpha, felt, extent)
            space = _to_a_boundary(layer, extent / other, rate, k, state, tolerance)
            if alpha > 0.0 or len(radii) > 1:
                space = without_rounding(space, bounds[end], extent)
            spaces.append(space)
    return spaces


def with_known_slip(
    spaces: list[Resolution], states: tuple[int, ...], tolerance: float
) -> list[Resolution]:
    """Return first spaces with the degrees with which a pressure that is given is right in slip."""
    accuracy = min(_QUADRATURE * tolerance, _FINEST) if tolerance < _ROUGHLY else tolerance
    # the far end of a part is a singularity ln 2 before the first panel
    degree = 4 * ceil((4.0 - 0.7 * log(accuracy)) / 4.0)
    return [
        Resolution(replace(one.panels, degree=degree), (degree,) * one.panels.panels)
        if states[(k + 1) // 2]
        else one
        for k, one in enumerate(spaces)
    ]


def _to_a_boundary(
    layer: float, ratio: float, rate: float, zone: int, state: int, tolerance: float
) -> Resolution:
    """Return the space of a part toward a boundary, so much larger than the one across it."""
    bends = [(layer - 1.0, _TURN)] if state == 0 and layer > 1.0 else []
    begin = min(layer, 0.5 * layer + _BEFORE)
    if ratio > 1.0:
        bends.append((log(ratio), _TURN if state else _BEND))
        begin = max(begin, log(ratio))
    return _space(begin, bends, tolerance, rate, _AROUND if zone else _INSIDE)


def _to_the_edge(alpha: float, beta: float, extent: float, tolerance: float) -> Resolution:
    layer = thinnest_layer(alpha, beta, extent)
    if alpha > 0.0:
        return _space(layer + _FELT, [(layer - _FELT, _BEND)], tolerance, 1.0, _AT_EDGE)
    if beta == 0.0:
        return _space(LEADING, [], tolerance, 1.0, _AT_EDGE, power=-0.5)
    return _space(layer, [(layer, _BEND)], tolerance, 0.5, _AT_EDGE, power=-0.5)


def _all_sticks(alpha: float, beta: float, tolerance: float) -> Resolution:
    """Return the space of a disk that sticks to the edge: both layers bend both fields."""
    layers = [-log(min(c, 1.0)) for c in (alpha, beta) if c > 0.0]
    begin = max(layers, default=LEADING)
    bends = [(layer - _BEFORE, _BEND) for layer in layers]
    # under one compliance alone a field has a square root at the edge
    rate, power = 0.5 if len(layers) == 1 else 1.0, -0.5 if alpha == 0.0 else 0.0
    return _space(begin, bends, tolerance, rate, power=power, spare=_STUCK_SPARE)


def _space(
    begin: float,
    bends: list[tuple[float, float]],
    tolerance: float,
    rate: float,
    first: tuple[float, float] = (0.0, 0.0),
    *,
    power: float = 0.0,
    spare: int = 0,
) -> Resolution:
    """Return a space whose solution settles like ``exp(-rate x)`` past `begin`."""
    # like scenes share their spaces
    begin = ceil(2.0 * begin) / 2.0
    digits = -log(tolerance)
    panels = 2 * ceil((begin + (digits + 2.0) / rate) / PANEL_WIDTH / 2.0)
    x = PANEL_WIDTH * np.arange(panels)
    missing = np.clip(1.0 - rate * (x - begin) / (digits + 2.0), 0.0, 1.0)
    more = np.zeros(panels)
    for place, share in bends:
        more = np.maximum(more, share * nearness(panels, ceil(2.0 * place) / 2.0))
    more[:2] = np.maximum(more[:2], first)
    degrees = np.ceil(1.0 + spare + digits * (_ALL * missing + more)).astype(int)
    degrees = np.maximum(degrees, _LEAST)
    capacity = 4 * ceil((int(degrees.max()) + 4) / 4)
    return Resolution(LogPanels(panels, PANEL_WIDTH, capacity, power), tuple(degrees.tolist()))
