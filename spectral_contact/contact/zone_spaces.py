"""First spaces for pressure and traction together, on any zones.

What they need was measured (docs/coupling): fewer degrees than a pressure alone is given. Thin
layers are felt at the edge, to which the pressure rises. At the rim they are felt half as deep.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import accumulate, pairwise
from math import atanh, ceil, log, pi

import numpy as np

from spectral_contact.contact.resolution import (
    LEADING,
    PANEL_WIDTH,
    ROOT_DEPTH,
    ROUGH,
    nearness,
    slip_degree,
)
from spectral_contact.fields.series import CENTRE, EDGE, LogSeries, Radius
from spectral_contact.spectral.cache import bounded_cache
from spectral_contact.spectral.panels import LEAST_DEGREE, DiscreteSpace, LogPanels
from spectral_contact.spectral.parameters import Parameters
from spectral_contact.spectral.parts import gap

#: Rounding of a radius next to it, closer to which nothing can be asked; panels go deeper by this
#: in ``-ln d``, as where they end is felt for a while.
_CLOSEST, _DEEPER = float(np.finfo(float).eps), 10.0
#: Degrees per ``-ln`` of the tolerance: on any panel, at a bend, at a lesser one, as on the second
#: panel, and on the first one, on the disk, above its rim, where the far end is a singularity ln 2
#: before it, and at the edge.
_ALL, _BEND, _TURN = 0.43, 0.15, 0.08
_INSIDE, _AROUND, _AT_EDGE = 0.28, 0.54, _ALL
#: How far before the layer a bend is where all sticks, and further degrees there: with 1, and no
#: more at the centre, 32 of 820 scenes and tolerances need a second space, with these one. And
#: under a pressure that is given, in full stick, which decides on slip, and where it begins: with 1
#: that is not known; or with a root at the rim.
_BEFORE, _STUCK_SPARE, _KNOWN_SPARE = 3.0, 1.1, 3
#: How far in ``-ln y`` a layer of the pressure is felt at the edge.
_FELT = 4.0
#: Accuracy of a pressure that is given, of the tolerance and at least; where boundaries are only
#: looked for, it is the tolerance. Without the least slip over 4e-9 is known to 0.14 at rtol 2e-7,
#: else to 0.02.
_QUADRATURE, _FINEST = 0.01, 1e-11


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


def without_rounding(space: DiscreteSpace, end: Radius, extent: float) -> DiscreteSpace:
    """Return a space toward a boundary without the panels that only rounding could tell of."""
    most = ceil((_DEEPER + rounding_depth(end, extent)) / space.panels.width)
    degrees = space.degrees[:most]
    return DiscreteSpace(replace(space.panels, panels=len(degrees)), degrees)


def parted(resolution: DiscreteSpace, counts: Sequence[int], alpha: float) -> list[DiscreteSpace]:
    """Return the spaces of all parts, with their numbers of panels, from what `joined` returns.

    The pressure under a smooth edge has its singularity. A tail of roots is that of the disk.
    """
    spaces, bounds = [], list(accumulate(counts, initial=0))
    for a, b in pairwise(bounds):
        power = -0.5 if alpha == 0.0 and b == bounds[-1] else 0.0
        panels = replace(
            resolution.panels,
            panels=b - a,
            power=power,
            root_tail=resolution.panels.root_tail and a == 0,
        )
        spaces.append(DiscreteSpace(panels, resolution.degrees[a:b]))
    return spaces


def first_spaces(
    alpha: float, beta: float, radii: tuple[Radius, ...], states: tuple[int, ...], tolerance: float
) -> list[DiscreteSpace]:
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
        # under one compliance alone a field has a square root at the edge
        rooted = (alpha == 0.0) != (beta == 0.0)
        return [_all_sticks(alpha, beta, tolerance, rooted, _STUCK_SPARE, _TURN)]
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


def known_pressure_spaces(
    alpha: float, beta: float, radii: tuple[Radius, ...], states: tuple[int, ...], tolerance: float
) -> list[DiscreteSpace]:
    """Return first spaces under a pressure that is given, with the degrees that this has in slip.

    Parameters are those of `first_spaces`.
    """
    if not radii:
        return [_all_sticks(alpha, beta, tolerance, alpha == 0.0, _KNOWN_SPARE)]
    spaces = first_spaces(alpha, beta, radii, states, tolerance)
    if beta == 0.0 and states == (0, 1):
        spaces[0] = _rigid_disk(alpha, radii[0], tolerance)
    accuracy = min(_QUADRATURE * tolerance, _FINEST) if tolerance < ROUGH else tolerance
    degree = slip_degree(accuracy)
    return [
        DiscreteSpace(replace(one.panels, degree=degree), (degree,) * one.panels.panels)
        if states[(k + 1) // 2]
        else one
        for k, one in enumerate(spaces)
    ]


def _rigid_disk(alpha: float, rim: Radius, tolerance: float) -> DiscreteSpace:
    """Return the space of a stick disk without tangential compliance under a known pressure.

    The traction has a root at the rim, and bends where the annulus around it ends and where the
    pressure ceases to rise.
    """
    annulus = -log(min(rim.rest / rim.square, 1.0))
    risen = -log(min(max(alpha, rim.rest) / rim.square, 1.0))
    bends = [(annulus, _TURN), (risen, _TURN)]
    return _space(annulus, bends, tolerance, 0.0, spare=_KNOWN_SPARE)


def _to_a_boundary(
    layer: float,
    ratio: float,
    rate: float,
    zone: int,
    state: int,
    tolerance: float,
) -> DiscreteSpace:
    """Return the space of a part toward a boundary, so much larger than the one across it."""
    bends = [(layer - 1.0, _TURN)] if state == 0 and layer > 1.0 else []
    begin = min(layer, 0.5 * layer + _BEFORE)
    if ratio > 1.0:
        bends.append((log(ratio), _TURN if state else _BEND))
        begin = max(begin, log(ratio))
    return _space(begin, bends, tolerance, rate, _AROUND if zone else _INSIDE)


def _to_the_edge(alpha: float, beta: float, extent: float, tolerance: float) -> DiscreteSpace:
    layer = thinnest_layer(alpha, beta, extent)
    if alpha > 0.0:
        return _space(layer + _FELT, [(layer - _FELT, _BEND)], tolerance, 1.0, _AT_EDGE)
    if beta == 0.0:
        return _space(LEADING, [], tolerance, 1.0, _AT_EDGE, power=-0.5)
    return _space(layer, [(layer, _BEND)], tolerance, 0.5, _AT_EDGE, power=-0.5)


def _all_sticks(
    alpha: float, beta: float, tolerance: float, smooth: bool, spare: float, first: float = 0.0
) -> DiscreteSpace:
    """Return the space of a disk that sticks to the edge: both layers bend both fields.

    Next to the edge of a smooth surface they have square roots.
    """
    layers = [-log(min(c, 1.0)) for c in (alpha, beta) if c > 0.0]
    begin = max(layers, default=LEADING)
    bends = [(layer - _BEFORE, _BEND) for layer in layers]
    rate, power = 0.5 if smooth else 1.0, -0.5 if alpha == 0.0 else 0.0
    return _space(begin, bends, tolerance, rate, first, power=power, spare=spare)


def _space(
    begin: float,
    bends: list[tuple[float, float]],
    tolerance: float,
    rate: float,
    first: float = 0.0,
    *,
    power: float = 0.0,
    spare: float = 0.0,
) -> DiscreteSpace:
    """Return a space whose solution settles like ``exp(-rate x)`` past `begin`.

    With a rate of 0 it ends in a tail of half-integer powers, which fall too slowly to taper the
    few panels above.
    """
    # like scenes share their spaces
    begin = ceil(2.0 * begin) / 2.0
    turns = tuple((ceil(2.0 * place) / 2.0, share) for place, share in bends)
    return _settling(PANEL_WIDTH, begin, turns, -log(tolerance), rate, first, power, spare)


@bounded_cache("first spaces on zones", 128)
def _settling(
    width: float,
    begin: float,
    bends: tuple[tuple[float, float], ...],
    digits: float,
    rate: float,
    first: float,
    power: float,
    spare: float,
) -> DiscreteSpace:
    depth = begin + ((digits + 2.0) / rate if rate else ROOT_DEPTH)
    panels = 2 * ceil(depth / width / 2.0)
    x = width * np.arange(panels)
    missing = np.clip(1.0 - rate * (x - begin) / (digits + 2.0), 0.0, 1.0)
    more = np.zeros(panels)
    for place, share in bends:
        more = np.maximum(more, share * nearness(panels, place))
    if first:
        more[:2] = np.maximum(more[:2], (first, _TURN))
    degrees = np.ceil(1.0 + spare + digits * (_ALL * missing + more)).astype(int)
    degrees = np.maximum(degrees, LEAST_DEGREE)
    capacity = 4 * ceil((int(degrees.max()) + 4) / 4)
    mesh = LogPanels(panels, width, capacity, power, root_tail=rate == 0.0)
    return DiscreteSpace(mesh, tuple(degrees.tolist()))
