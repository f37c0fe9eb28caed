"""Whether the surface goes on to slip forward while the load of a steady loop falls.

Nothing does if and only if a traction q of the largest load exists with ``|q - (1 - l) q*(f (1 +
l)/(1 - l))| <= f l p`` at every load l from 1 to lambda, with q* of unit load (docs/cycles).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

import numpy as np

from spectral_contact.fields import Array
from spectral_contact.solution import Solution
from spectral_contact.sweeps.mean_slip import annulus_nodes

#: Nodes on each panel of a zone where it is checked.
_NODES: Final = 2
#: What errors of tractions and pressures may make of the room, over their sum.
_ROUNDING: Final = 10.0


def admissible_tractions(
    states: Sequence[Solution], friction: float, limit: Array, from_edge: Array
) -> tuple[Array, Array]:
    """Return the bounds of a traction at the largest load with which nothing slips forward.

    ``|q - (1 - l) q*(f (1 + l)/(1 - l))| <= f l p`` at every load l, which the states are for. In
    full stick the change is in proportion to that of the load: it is enough to look where slip
    begins, at the critical friction.

    Parameters
    ----------
    states : sequence of Solution
        As of `SteadyCycle`.
    friction : float
    limit : ndarray
        ``f p`` of the largest load at places.
    from_edge : ndarray
        The places.
    """
    of_loop = float(states[0].scene.friction or 0.0)
    low = -limit
    high = limit
    bounded = limit < math.inf  # not at the edge of a smooth surface, nor where nothing slips
    for one in states:
        of_state = float(one.scene.friction or 0.0)
        if of_state == math.inf:
            of_state = one.critical_friction
            if not of_loop < of_state < math.inf:
                continue
        if of_state == 0.0:
            continue
        load = (of_state - friction) / (of_state + friction)
        change = (1.0 - load) * np.asarray(one.traction(from_edge=from_edge))
        with np.errstate(invalid="ignore"):
            low = np.where(bounded, np.maximum(low, change - load * limit), low)
            high = np.where(bounded, np.minimum(high, change + load * limit), high)
    return low, high


def forward_slack(states: Sequence[Solution], friction: float) -> float:
    """Return how much room there is for a traction at the largest load, relative to f p.

    It is how far the bounds of `admissible_tractions` are apart where they are closest: 0 where the
    surface slips back, and negative where no traction is admissible.

    Parameters
    ----------
    states : sequence of Solution
        As of `SteadyCycle`.
    friction : float
    """
    if friction == 0.0:
        return 0.0
    if friction == math.inf:
        return 2.0
    loop = states[0]
    nodes = [
        annulus_nodes(zone.inner_from_edge, zone.outer_from_edge, _NODES)[0] for zone in loop.zones
    ]
    from_edge = np.concatenate(nodes)
    limit = friction * loop.pressure(from_edge=from_edge)
    low, high = admissible_tractions(states, friction, limit, from_edge)
    return float(((high - low) / limit).min())


def slack_rounding(states: Sequence[Solution]) -> float:
    """Return what errors of tractions and pressures may make of the room."""
    errors = [(one.error.traction or 0.0) + (one.error.pressure or 0.0) for one in states]
    return _ROUNDING * (max(errors) + float(np.finfo(float).eps))
