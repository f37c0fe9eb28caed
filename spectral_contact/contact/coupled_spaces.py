"""First spaces for a stick disk with slip around it, pressure and traction together.

What they need was measured (docs/coupling): fewer degrees than a pressure alone is given. Thin
layers are felt at the edge, to which the pressure rises. At the rim they are felt half as deep.
"""

from __future__ import annotations

from math import ceil, log

import numpy as np

from spectral_contact.adaptive import Resolution
from spectral_contact.contact.coupled_parts import LEADING, thinnest_layer, without_rounding
from spectral_contact.contact.resolution import PANEL_WIDTH
from spectral_contact.fields import EDGE, Radius
from spectral_contact.spectral.annulus import gap
from spectral_contact.spectral.panels import LogPanels

__all__ = ["first_spaces"]

#: Degrees per ``-ln`` of the tolerance: on any panel, at a bend, at a lesser one, and on the first
#: two panels, on the disk, above its rim, where the far end is a singularity ln 2 before them, and
#: at the edge.
_ALL, _BEND, _TURN = 0.43, 0.15, 0.08
_FIRST = (0.28, 0.1), (0.54, 0.1), (0.42, 0.08)
#: Least degree on a panel: the estimate sheds two degrees and must keep one.
_LEAST = 2


def first_spaces(
    alpha: float, beta: float, radius: Radius, tolerance: float
) -> tuple[Resolution, Resolution, Resolution]:
    """Return the first spaces on the disk, above its rim, and below the edge.

    Parameters
    ----------
    alpha, beta : float
        ``alpha*`` and ``beta*``, 0 or positive.
    radius : Radius
        Rim of the disk.
    tolerance : float
        Relative accuracy asked.
    """
    half = gap(radius, EDGE) / 2.0
    apart = abs(log(half / radius.square))
    spaces = []
    for k, (extent, other) in enumerate(((radius.square, half), (half, radius.square))):
        # above the rim no layer of the traction is felt
        layer = thinnest_layer(alpha, 0.0 if k else beta, extent)
        bends = [(layer - 1.0, _TURN)] if k == 0 and layer > 1.0 else []
        if extent > other:
            bends.append((apart, (_BEND, _TURN)[k]))
        space = _space(
            max(min(layer, 0.5 * layer + 3.0), apart if extent > other else 0.0),
            bends,
            tolerance,
            1.0 if alpha > 0.0 and (k or beta > 0.0) else 0.5,
            _FIRST[k],
        )
        if alpha > 0.0:
            space = without_rounding(space, radius, extent)
        spaces.append(space)
    if alpha == 0.0:
        edge = _space(LEADING, [], tolerance, 1.0, _FIRST[2], power=-0.5)
    else:
        layer = thinnest_layer(alpha, 0.0, half)
        edge = _space(layer + 4.0, [(layer - 4.0, _BEND)], tolerance, 1.0, _FIRST[2])
    return spaces[0], spaces[1], edge


def _space(
    begin: float,
    bends: list[tuple[float, float]],
    tolerance: float,
    rate: float,
    first: tuple[float, float],
    *,
    power: float = 0.0,
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
        distance = np.abs(x + PANEL_WIDTH / 2.0 - ceil(2.0 * place) / 2.0) / (1.2 * PANEL_WIDTH)
        more = np.maximum(more, share * np.clip(2.6 - distance, 0.0, 1.0))
    more[:2] = np.maximum(more[:2], first)
    degrees = np.ceil(1.0 + digits * (_ALL * missing + more)).astype(int)
    degrees = np.maximum(degrees, _LEAST)
    capacity = 4 * ceil((int(degrees.max()) + 4) / 4)
    return Resolution(LogPanels(panels, PANEL_WIDTH, capacity, power), tuple(degrees.tolist()))
