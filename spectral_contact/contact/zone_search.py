"""Which zones stick and which slip: an active set on fine cells.

The cells are equal in ``x = -ln(1 - s**2)``, so that layers of any width are seen; the friction law
is imposed at their centres. The result only starts the solution on fitted zones.
"""

from __future__ import annotations

from collections.abc import Callable
from math import log

import numpy as np
from numpy.typing import NDArray
from scipy import linalg

from spectral_contact.contact.drive import Drive
from spectral_contact.contact.full_stick import FullStick
from spectral_contact.contact.layout import Layout, logit_at
from spectral_contact.fields.series import Radius
from spectral_contact.spectral.galerkin import disk_operators
from spectral_contact.spectral.panels import LogPanels

__all__ = ["depth_of", "full_stick_violations", "search_zones"]

Array = NDArray[np.float64]

_CELLS = 480
_MAX_ROUNDS = 60


def search_zones(
    drive: Drive, stick: FullStick, beta: float, friction: float, radius: float | None
) -> Layout:
    """Guess the zones.

    Parameters
    ----------
    drive : Drive
    stick : FullStick
        The full-stick solution, which shows slip zones narrower than a cell.
    beta, friction : float
        ``beta*`` and ``f / kappa``.
    radius : float, optional
        The stick radius under the assumption of one disk, for disks smaller than a cell.
    """
    depth = depth_of(drive.contact.compliance, beta, friction)
    cells = LogPanels(_CELLS, depth / _CELLS, 0)
    x = cells.width * (np.arange(_CELLS) + 0.5)
    violated = full_stick_violations(drive, stick, friction, depth)
    if violated and all(high - low < 4.0 * cells.width for low, high, _ in violated):
        return _layout([(low, high, sign) for low, high, sign in violated])
    bound = friction * drive.pressure.at(np.exp(-x)) / np.sqrt(-np.expm1(-x))
    states = _active_set(drive, cells, beta, bound)
    edges = [i for i in range(1, _CELLS) if states[i] != states[i - 1]]
    slips = []
    for start, end in zip([0, *edges], [*edges, _CELLS], strict=True):
        if states[start] != 0 and end > start:
            high = float("inf") if end == _CELLS else end * cells.width
            slips.append((max(start, 1) * cells.width, high, int(states[start])))
    layout = _layout(slips)
    if layout.logits and Radius.from_logit(layout.logits[0]).square < 4.0 * cells.width:
        # the disk is smaller than a few cells: c = 2 beta f / kappa as f -> 0
        first = _logit_of(2.0 * beta * friction if radius is None else radius)
        return Layout((first, *layout.logits[1:]), layout.states)
    return layout


def depth_of(alpha: float, beta: float, friction: float) -> float:
    """Return the ``x`` below which nothing changes any more."""
    if alpha == 0.0:
        # the edge sticks for y below (f beta / kappa)^2: there p exceeds what q can be
        return 2.0 * max(-log(min(friction, 1.0) * min(beta, 1.0)), 0.0) + 12.0
    return max(-log(min(alpha, beta, 1.0)), 0.0) + 30.0


def full_stick_violations(
    drive: Drive, stick: FullStick, friction: float, depth: float
) -> list[tuple[float, float, int]]:
    """Return the intervals of ``x`` where full stick breaks |q| <= f p, with the sign of q."""

    def excess(x: Array) -> Array:
        y, s = np.exp(-x), np.sqrt(-np.expm1(-x))
        q = stick.traction(s, y / (1.0 + s))
        return np.asarray(np.abs(q) / drive.pressure.at(y) - friction)

    x = np.linspace(1e-3, depth, 4001)
    peak = -log(stick.critical_at) if stick.critical_at > 0.0 else depth
    near = peak + np.concatenate(
        [-np.geomspace(1e-10, 1.0, 200), [0.0], np.geomspace(1e-10, 1.0, 200)]
    )
    x = np.unique(np.concatenate([x, near[(near > 0.0) & (near < depth)]]))
    above = excess(x) > 0.0
    intervals: list[tuple[float, float, int]] = []
    start: float | None = None
    for i in range(len(x)):
        if above[i] and start is None:
            start = float(x[0]) if i == 0 else _crossing(excess, x[i - 1], x[i])
        if start is not None and not above[i]:
            end = _crossing(excess, x[i - 1], x[i])
            intervals.append((start, end, 1))
            start = None
    if start is not None:
        intervals.append((start, float("inf"), 1))
    return intervals


def _crossing(function: Callable[[Array], Array], a: float, b: float) -> float:
    from scipy.optimize import brentq

    def one(x: float) -> float:
        return float(function(np.array([x]))[0])

    if one(a) * one(b) >= 0.0:  # one by one they have the same sign: rounding is all there is
        return float(b)
    return float(brentq(one, a, b, xtol=1e-14))


def _layout(slips: list[tuple[float, float, int]]) -> Layout:
    """Turn slip intervals in ``x`` into boundaries and states."""
    logits: list[float] = []
    states = [0]
    for low, high, sign in slips:
        if logits and low <= -log(Radius.from_logit(logits[-1]).rest) + 1e-12:
            raise ArithmeticError("adjacent slip zones of opposite sense")
        logits.append(logit_at(low))
        states.append(sign)
        if high != float("inf"):
            logits.append(logit_at(high))
            states.append(0)
    return Layout(tuple(logits), tuple(states))


def _logit_of(radius: float) -> float:
    """Return the logit of a small radius."""
    return 2.0 * log(radius) - float(np.log1p(-(radius**2)))


def _active_set(drive: Drive, cells: LogPanels, beta: float, bound: Array) -> Array:
    """Return 0, +1 or -1 for every cell by a primal-dual active set."""
    disk = disk_operators(cells)
    operator = disk.tangential
    n = len(bound)
    target = drive.target(disk.nodes.d)
    right = ((operator.weights * target) @ disk.half_integral)[:n]
    matrix = (operator.gram + beta * operator.mass)[:n, :n]
    diagonal = matrix.diagonal()
    states = np.zeros(n, dtype=int)
    values = np.zeros(n)
    for _ in range(_MAX_ROUNDS):
        free = states == 0
        values[~free] = states[~free] * bound[~free]
        rest = right[free] - matrix[np.ix_(free, ~free)] @ values[~free]
        scale = 1.0 / np.sqrt(diagonal[free])
        scaled = matrix[np.ix_(free, free)] * scale * scale[:, None]
        values[free] = scale * linalg.solve(scaled, rest * scale, assume_a="pos")
        multiplier = (right - matrix @ values) / diagonal
        trial = values + np.where(free, 0.0, multiplier)
        fresh = np.where(trial > bound, 1, np.where(trial < -bound, -1, 0))
        fresh[0] = 0  # the centre sticks: g and T q vanish there while p does not
        if np.array_equal(fresh, states):
            break
        states = fresh
    return states
