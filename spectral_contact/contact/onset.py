"""Slip about to start, which cannot be told from full stick."""

from __future__ import annotations

from math import inf, log

import numpy as np

from spectral_contact.contact.layout import Layout, logit_at
from spectral_contact.contact.ratio import FullStick
from spectral_contact.contact.resolution import EPSILON_DEPTH, first_sign_change, sample_depths
from spectral_contact.contact.tuning import LEADING_TERM_DEPTH
from spectral_contact.fields.series import Array, Radius
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
    depth, limit = _depth(parameters), parameters.friction if friction is None else friction

    def sheared(x: Array) -> Array:
        s = np.sqrt(-np.expm1(-x))
        return traction(s, np.exp(-x) / (1.0 + s))

    def excess(x: Array) -> Array:
        q, p = sheared(x), pressure.at(np.exp(-x))
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = np.where(p > 0.0, np.abs(q) / p, np.inf)  # the contact would open
        return np.asarray(np.minimum(ratio, 2.0 * limit) - limit)

    peak = -log(stick.critical_y) if stick.critical_y > 0.0 else depth
    aside = np.exp(-sample_depths(EPSILON_DEPTH, 200))
    near = peak + np.concatenate([-aside, [0.0], aside])
    x = np.unique(np.concatenate([sample_depths(depth, 4001), near[(near > 0.0) & (near < depth)]]))
    above = excess(x) > 0.0
    turns = np.flatnonzero(above[1:] != above[:-1]).tolist()
    ends = [float(x[0])] * bool(above[0]) + [
        first_sign_change(excess, x[i], x[i + 1]) for i in turns
    ]
    beyond = [*ends, depth] if above[-1] else ends
    middles = (np.array(beyond[::2]) + np.array(beyond[1::2])) / 2.0
    signs = np.sign(sheared(middles)).astype(int).tolist()
    states = [one for sign in signs for one in (0, sign)] + [0] * (not above[-1])
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
        return (
            max(-2.0 * log(min(friction / kappa, 1.0) * min(beta, 1.0)), 0.0) + LEADING_TERM_DEPTH
        )
    return max([0.0, *(-log(c) for c in (alpha, beta) if c > 0.0)]) + LEADING_TERM_DEPTH
