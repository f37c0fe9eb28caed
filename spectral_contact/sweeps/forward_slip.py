"""Whether the surface goes on to slip forward while the load of a steady loop falls.

The largest load is 1 and the lowest one lambda. While the load falls to l, the traction changes by
``(1 - l) q*(f (1 + l)/(1 - l))``, where q*(f) is that of unit load under the friction f. Nothing
slips forward if and only if there is a traction q at the largest load with which

    ``|q - (1 - l) q*(f (1 + l)/(1 - l))| <= f l p``

at every load l from 1 to lambda (docs/cycles). This is checked at the loads of solved frictions.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

import numpy as np

from spectral_contact.fields import Array
from spectral_contact.solution import Solution
from spectral_contact.sweeps.mean_slip import annulus_nodes

#: Points on each panel of `annulus_nodes` at which it is checked, a number that was chosen.
_NODES_OF_PANEL: Final = 2
#: Error of the slack over the sum of those of traction and pressure, a number that was chosen.
_ERROR_FACTOR: Final = 10.0


def admissible_tractions(
    states: Sequence[Solution], friction: float, limit: Array, from_edge: Array
) -> tuple[Array, Array]:
    """Return a lower and an upper bound of the tractions with which nothing slips forward.

    They are tractions at the largest load. Each state bounds them at one load l, at which
    ``f (1 + l)/(1 - l)`` is the friction of the state. From the largest load down to that of the
    critical friction all sticks, and the traction changes in proportion to the load: if it is
    within the bounds at both of these loads, it is so between them.

    Parameters
    ----------
    states : sequence of Solution
        As of `SteadyCycle`.
    friction : float
        The coefficient of friction f.
    limit : ndarray
        The friction bound ``f p`` of the largest load at some places.
    from_edge : ndarray
        The distances of these places from the edge.
    """
    loop_friction = float(states[0].scene.friction or 0.0)
    low = -limit
    high = limit
    # at the edge of a smooth surface and under infinite friction there is no bound
    bounded = limit < math.inf
    for state in states:
        state_friction = float(state.scene.friction or 0.0)
        if state_friction == math.inf:
            state_friction = state.critical_friction
            if not loop_friction < state_friction < math.inf:
                continue
        if state_friction == 0.0:  # without friction, and the load would be 0/0
            continue
        load = (state_friction - friction) / (state_friction + friction)
        change = (1.0 - load) * np.asarray(state.traction(from_edge=from_edge))
        with np.errstate(invalid="ignore"):
            low = np.where(bounded, np.maximum(low, change - load * limit), low)
            high = np.where(bounded, np.minimum(high, change + load * limit), high)
    return low, high


def forward_slack(states: Sequence[Solution], friction: float) -> float:
    """Return the slack: the distance between the bounds of `admissible_tractions`, over f p.

    It is the least value over all zones. Where the surface slips back the bounds are equal, which
    gives 0; it is negative if at some radius no traction is within the bounds.

    Parameters
    ----------
    states : sequence of Solution
        As of `SteadyCycle`.
    friction : float
    """
    if friction == 0.0:
        return 0.0
    if friction == math.inf:
        return 2.0  # the bounds are -f p and f p
    loop = states[0]
    nodes = [
        annulus_nodes(zone.inner_from_edge, zone.outer_from_edge, _NODES_OF_PANEL)[0]
        for zone in loop.zones
    ]
    from_edge = np.concatenate(nodes)
    limit = friction * loop.pressure(from_edge=from_edge)
    low, high = admissible_tractions(states, friction, limit, from_edge)
    return float(((high - low) / limit).min())


def slack_rounding(states: Sequence[Solution]) -> float:
    """Return the error of the slack by those of tractions and pressures."""
    errors = [(one.error.traction or 0.0) + (one.error.pressure or 0.0) for one in states]
    return _ERROR_FACTOR * (max(errors) + float(np.finfo(float).eps))
