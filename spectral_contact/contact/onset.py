"""Slip about to start, which cannot be told from full stick."""

from __future__ import annotations

from math import inf, log

import numpy as np

from spectral_contact.contact.layout import Layout, logit_at
from spectral_contact.contact.ratio import FullStick
from spectral_contact.contact.resolution import DEEPEST, LEADING, crossing, places
from spectral_contact.fields.series import Array, DiskSeries, PressureField, Radius
from spectral_contact.spectral.parameters import Parameters

#: Relative error of a stick radius of 1 when slip is about to start: an annulus opens like the
#: square root of what the friction lacks, 1e-13 at best.
UNRESOLVED_SLIP = 1e-6
#: Slip is wider than the place where full stick breaks the law: less than twice where that widens
#: like a square root of what the friction lacks, and less than four times where like that itself.
_WIDENED = 4.0
#: Slip narrower than this, as a logit, may fall between rings; full stick has its place then.
_NARROW = 0.25


def unresolved_slip(stick: FullStick, parameters: Parameters) -> float:
    """Return the relative error of a stick radius of 1 where slip is about to start.

    The friction is so close to critical that the errors decide: there may be slip wherever full
    stick uses up all friction but for some of them.
    """
    if stick.critical == inf:
        return UNRESOLVED_SLIP
    lack = max(1.0 - parameters.friction / stick.critical, 0.0) + 2.0 * stick.critical_error
    first = exceeded(stick, parameters, stick.critical * (1.0 - min(_WIDENED * lack, 1.0))).logits
    if not first:
        return UNRESOLVED_SLIP
    radius = Radius.from_logit(first[0])
    return max(UNRESOLVED_SLIP, radius.from_edge / radius.value)


def exceeded(stick: FullStick, parameters: Parameters, friction: float | None = None) -> Layout:
    """Return slip where full stick exceeds friction, or another one, and stick elsewhere."""
    pressure, traction = stick.pressure, stick.traction
    assert pressure is not None
    assert traction is not None
    depth, friction = _depth(parameters), parameters.friction if friction is None else friction
    found = _violations(pressure, traction, friction, depth, stick.critical_at)
    ends = [x for interval in found for x in interval if x < inf]
    middles = np.array([(low + min(high, depth)) / 2.0 for low, high in found])
    s = np.sqrt(-np.expm1(-middles))
    signs = np.sign(traction(s, np.exp(-middles) / (1.0 + s))).astype(int).tolist()
    states = [one for sign in signs for one in (0, sign)] + [0] * (len(ends) == 2 * len(found))
    return Layout(tuple(logit_at(one) for one in ends), tuple(states))


def is_narrow(layout: Layout) -> bool:
    """Return whether all slip is inside, and so narrow that it may fall between rings."""
    widths = np.diff(layout.logits)[::2]
    return len(layout.logits) == 2 * len(widths) and max(widths, default=inf) < _NARROW


def _depth(parameters: Parameters) -> float:
    """Return the ``x`` below which nothing changes any more."""
    alpha, beta, kappa, friction = parameters
    if alpha == 0.0 < beta:
        # the edge sticks for y below (f beta / kappa)^2: there p exceeds what q can be
        return max(-2.0 * log(min(friction / kappa, 1.0) * min(beta, 1.0)), 0.0) + LEADING
    return max([0.0, *(-log(c) for c in (alpha, beta) if c > 0.0)]) + LEADING


def _violations(
    pressure: PressureField, traction: DiskSeries, friction: float, depth: float, worst: float
) -> list[tuple[float, float]]:
    """Return the intervals of ``x = -ln y`` where full stick breaks |q| <= f p, as (low, high)."""

    def excess(x: Array) -> Array:
        y, s = np.exp(-x), np.sqrt(-np.expm1(-x))
        q = traction(s, y / (1.0 + s))
        p = pressure.at(y)
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = np.where(p > 0.0, np.abs(q) / p, np.inf)  # the contact would open
        return np.asarray(np.minimum(ratio, 2.0 * friction) - friction)

    x = places(depth, 4001)
    peak = -log(worst) if worst > 0.0 else depth
    aside = np.exp(-places(DEEPEST, 200))
    near = peak + np.concatenate([-aside, [0.0], aside])
    x = np.unique(np.concatenate([x, near[(near > 0.0) & (near < depth)]]))
    above = excess(x) > 0.0
    turns = np.flatnonzero(above[1:] != above[:-1]).tolist()
    ends = [float(x[0])] * bool(above[0]) + [crossing(excess, x[i], x[i + 1]) for i in turns]
    ends += [inf] * bool(above[-1])
    return list(zip(ends[::2], ends[1::2], strict=True))
