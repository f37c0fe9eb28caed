"""First spaces for coupled zones: panels toward both ends of every one."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from math import ceil, inf, log

from spectral_contact.adaptive import Resolution
from spectral_contact.contact.coupled_parts import thinnest_layer, without_rounding
from spectral_contact.contact.resolution import starting_resolution
from spectral_contact.fields import CENTRE, EDGE, Radius
from spectral_contact.spectral.annulus import gap

__all__ = ["first_spaces"]

#: Degrees that the first panels have more, over ``-ln`` of the tolerance: of the disk, and of a
#: half of an annulus, whose far end is a singularity ln 2 before them.
_FIRST_INSIDE, _FIRST_AROUND = (0.2, 0.08), (0.4, 0.08)


def first_spaces(
    alpha: float, beta: float, radii: tuple[Radius, ...], tolerance: float
) -> list[Resolution]:
    """Return the first spaces on the disk, and toward both ends of every zone around it.

    Parameters
    ----------
    alpha, beta : float
        ``alpha*``, 0 or positive, and ``beta*`` > 0.
    radii : tuple of Radius
        Boundaries between zones, outward.
    tolerance : float
        Relative accuracy.
    """
    bounds = CENTRE, *radii, EDGE
    extents = [gap(*pair) / 2.0 for pair in pairwise(bounds)]
    extents[0] *= 2.0
    form = alpha, beta, tolerance
    spaces = [_toward(bounds[1], extents[0], extents[1], *form)]
    for k in range(1, len(extents)):
        spaces.append(_toward(bounds[k], extents[k], extents[k - 1], *form))
        other = extents[k + 1] if k + 1 < len(extents) else inf
        spaces.append(_toward(bounds[k + 1], extents[k], other, *form))
    digits = -log(tolerance)
    for k, space in enumerate(spaces):
        shares = _FIRST_AROUND if k else _FIRST_INSIDE
        first = zip(shares, space.degrees, strict=False)
        degrees = [n + ceil(share * digits) for share, n in first]
        spaces[k] = replace(space, degrees=(*degrees, *space.degrees[len(degrees) :]))
    # in slip p over s has some degrees more
    capacity = 4 * ceil((max(max(one.degrees) for one in spaces) + 4) / 4)
    return [replace(one, panels=replace(one.panels, degree=capacity)) for one in spaces]


def _toward(
    end: Radius, extent: float, other: float, alpha: float, beta: float, tolerance: float
) -> Resolution:
    """Return the space of a part toward an end, past which a part of another extent lies."""
    layer = thinnest_layer(alpha, beta, extent)
    if end.from_edge == 0.0 < alpha:
        return starting_resolution(layer, tolerance)
    if end.from_edge == 0.0:
        return starting_resolution(layer, tolerance, rate=0.5, power=-0.5, bends=(layer,))
    rate = 1.0 if alpha > 0.0 else 0.5
    space = starting_resolution(max(layer, log(extent / other)), tolerance, rate=rate)
    return without_rounding(space, end, extent)
