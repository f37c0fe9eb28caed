"""The first slip of a contact in full stick: at the edge or inside."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import exp, expm1, inf
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from spectral_contact.scene import Scene
from spectral_contact.solving.solver import solve

#: What has to be known of full stick.
_ASKED = ("pressure", "traction", "edge_ratio", "critical_friction")
_EPS = 2.0**-52
#: Relative error of a distance from which on it is not taken for known.
_KNOWN = 0.1


@dataclass(frozen=True, slots=True)
class SlipOnset:
    """The first slip under falling friction, and where the paper's criterion sees it.

    Attributes
    ----------
    critical_friction, critical_error : float
        Smallest friction coefficient without slip; estimate of its relative error.
    edge_ratio, edge_error : float
        ``q/p`` of full stick at the edge, which the paper takes for it; its relative error.
    from_edge : float
        Distance ``1 - s`` of the first slip from the edge, in punch radii.
    from_edge_error : float
        Estimate of its relative error. Infinite where the slip starts inside (``beta* > alpha*``)
        but so close to the edge that rounding hides it; `from_edge` is 0 then.
    """

    critical_friction: float
    critical_error: float
    edge_ratio: float
    edge_error: float
    from_edge: float
    from_edge_error: float


def slip_onset(scene: Scene, rtol: float = 1e-9) -> SlipOnset:
    """Return where slip starts in a scene as its friction falls.

    With ``y = 1 - s**2``, full stick has next to the edge ``q/p = (q/p at the edge) (1 +
    y ln y (1/beta* - 1/alpha*)/(4 pi) + ...)``: the largest ``q/p`` is inside if and only if
    ``beta* > alpha*``, unless there were a larger one far from the edge, which is looked for.

    Parameters
    ----------
    scene : Scene
        Its friction does not matter; nu < 1/2, and beta* > 0: the critical friction is finite.
    rtol : float
        Relative tolerance of the solve.

    Returns
    -------
    SlipOnset
    """
    solution = solve(scene.replace(friction=inf), rtol, _ASKED)
    critical, edge = solution.critical_friction, solution.edge_ratio
    critical_error, edge_error = solution.error.critical_friction, solution.error.edge_ratio
    assert critical_error is not None
    assert edge_error is not None
    inside = scene.tangential_compliance > scene.normal_compliance
    place = 0.0, inf if inside else 0.0
    if critical > edge * (1.0 + critical_error + edge_error):

        def ratio(x: ArrayLike) -> Any:
            depth = np.exp(-np.asarray(x))
            return solution.traction(from_edge=depth) / solution.pressure(from_edge=depth)

        found = _place_of_maximum(ratio, critical * (1.0 - critical_error))
        if found[1] < _KNOWN:
            place = found
    return SlipOnset(critical, critical_error, edge, edge_error, *place)


def _place_of_maximum(ratio: Callable[[ArrayLike], Any], level: float) -> tuple[float, float]:
    """Return ``exp(-x)`` at the maximum of a function of x > 0, and its relative error.

    The maximum lies between the places next to it where the function is at the level.
    """
    from scipy.optimize import brentq  # slow to import, and seldom needed

    grid = np.concatenate([-np.log1p(-np.linspace(0.0, 0.9, 45)), np.linspace(2.4, 40.0, 95)])
    values = ratio(grid)
    top = int(values.argmax())
    x, found = grid[top - 1 : top + 2], grid[top]
    for _ in range(8):  # between panels a field jumps by its error: no derivatives, no parabolas
        x = np.linspace(x[0], x[-1], 33)
        best = int(np.clip(ratio(x).argmax(), 1, 31))
        found, x = x[best], x[best - 1 : best + 2]
    level = min(level, float(ratio(found)) * (1.0 - 4.0 * _EPS))
    below = np.flatnonzero(values < level)
    far, near = below[below < top].max(), below[below > top].min()
    ends = (
        brentq(lambda x: float(ratio(x)) - level, *ends)
        for ends in ((grid[far], found), (found, grid[near]))
    )
    return exp(-found), expm1(max(abs(end - found) for end in ends))
