"""The onset of slip: where full stick violates the friction law, and unresolved slip.

Full stick has the traction q and the pressure p; slip begins where ``|q|/p`` is largest, at the
critical friction. Radii are looked at through ``x = -ln y`` with ``y = 1 - s**2``.
"""

from __future__ import annotations

from math import inf, log

import numpy as np

from spectral_contact.contact.friction_law import UNRESOLVED_SLIP
from spectral_contact.contact.layout import Layout, logit_at
from spectral_contact.contact.ratio import FullStick
from spectral_contact.contact.resolution import (
    EPSILON_DEPTH,
    first_sign_change,
    sample_depths,
)
from spectral_contact.contact.tuning import MAX_RING_WIDTH, ONSET_SAMPLES, RINGS_PER_SPLIT, SAMPLES
from spectral_contact.fields.series import Array, Radius
from spectral_contact.spectral.parameters import Parameters

#: Slip is wider than the set where full stick violates ``|q| <= f p``; the set for ``1 - f/f_crit``
#: enlarged by this factor contains the slip. The slip is less than twice as wide where the width of
#: the set goes like ``sqrt(1 - f/f_crit)``, less than four times where like ``1 - f/f_crit``.
SLIP_WIDENING = 4.0


def unresolved_slip(stick: FullStick, parameters: Parameters) -> float:
    """Return the relative error of a stick radius of 1 where slip is about to start.

    The friction is critical to within the errors, so that there may be slip. It is as wide as the
    set where full stick violates the law at most, for a friction that lacks somewhat more.
    """
    if stick.critical == inf:
        return UNRESOLVED_SLIP
    onset_distance = max(1.0 - parameters.friction / stick.critical, 0.0)
    onset_distance += 2.0 * stick.critical_error
    friction = stick.critical * (1.0 - min(SLIP_WIDENING * onset_distance, 1.0))
    logits = slip_where_exceeded(stick, parameters, friction).logits
    if not logits:
        return UNRESOLVED_SLIP
    radius = Radius.from_logit(logits[0])
    return max(UNRESOLVED_SLIP, radius.from_edge / radius.value)


def slip_where_exceeded(
    stick: FullStick, parameters: Parameters, friction: float | None = None
) -> Layout:
    """Return zones that slip where full stick has ``|q| > f p``, and stick elsewhere.

    Parameters
    ----------
    stick : FullStick
        Full stick, with its fields.
    parameters : Parameters
    friction : float, optional
        In place of the friction f of the parameters.
    """
    pressure = stick.pressure
    traction = stick.traction
    assert pressure is not None
    assert traction is not None
    limit = parameters.friction if friction is None else friction
    depth = _depth(parameters)

    def traction_at(x: Array) -> Array:
        s = np.sqrt(-np.expm1(-x))
        return traction(s, np.exp(-x) / (1.0 + s))

    def excess(x: Array) -> Array:
        """Return ``|q|/p - f``, at most f."""
        q = traction_at(x)
        p = pressure.evaluate(np.exp(-x))
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = np.where(p > 0.0, np.abs(q) / p, np.inf)  # the contact would open
        return np.asarray(np.minimum(ratio, 2.0 * limit) - limit)

    # the set may be tiny: the grid is fine around the radius where it begins
    peak = -log(stick.critical_y) if stick.critical_y > 0.0 else depth
    offsets = np.exp(-sample_depths(EPSILON_DEPTH, SAMPLES))
    around_peak = peak + np.concatenate([-offsets, [0.0], offsets])
    around_peak = around_peak[(around_peak > 0.0) & (around_peak < depth)]
    x = np.unique(np.concatenate([sample_depths(depth, ONSET_SAMPLES), around_peak]))

    exceeds = excess(x) > 0.0
    changes = np.flatnonzero(exceeds[1:] != exceeds[:-1]).tolist()
    boundaries = [first_sign_change(excess, x[i], x[i + 1]) for i in changes]
    if exceeds[0]:  # the first boundary is that of a stick disk around the centre, always there
        boundaries = [float(x[0]), *boundaries]
    slip_ends = [*boundaries, depth] if exceeds[-1] else boundaries
    middles = (np.array(slip_ends[::2]) + np.array(slip_ends[1::2])) / 2.0
    states: list[int] = []
    for sign in np.sign(traction_at(middles)).astype(int).tolist():
        states += [0, sign]
    if not exceeds[-1]:
        states.append(0)
    return Layout(tuple(logit_at(boundary) for boundary in boundaries), tuple(states))


def is_narrow(zones: Layout) -> bool:
    """Return whether no slip reaches the edge, and all of it is narrower than a split ring.

    Such slip may fall between rings.
    """
    widths = np.diff(zones.logits)[::2]
    all_inside = len(zones.logits) == 2 * len(widths)
    return all_inside and max(widths, default=inf) < MAX_RING_WIDTH / RINGS_PER_SPLIT


def _depth(parameters: Parameters) -> float:
    """Return the x beyond which the ratio ``|q|/p`` of full stick is that of the edge."""
    alpha, beta, kappa, friction = parameters
    if alpha == 0.0 < beta:
        # the edge sticks for y below (f beta / kappa)^2: there f p exceeds what q can be
        return max(-2.0 * log(min(friction / kappa, 1.0) * min(beta, 1.0)), 0.0) + EPSILON_DEPTH
    layers = [-log(compliance) for compliance in (alpha, beta) if compliance > 0.0]
    return max([0.0, *layers]) + EPSILON_DEPTH
