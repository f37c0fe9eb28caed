"""The onset of slip: where full stick violates the friction law, and unresolved slip.

Full stick has the traction q and the pressure p. Slip begins at the radius where ``|q|/p`` is
largest, if the friction f is less than this ratio, the critical friction. s is the radius over that
of the contact, ``y = 1 - s**2``, and the coordinate here is the depth ``x = -ln y``. alpha, beta
and kappa are the normal and the tangential compliance and the coupling of docs/theory.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
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
from spectral_contact.contact.tuning import ONSET_SAMPLES, SAMPLES
from spectral_contact.contact.zone_spaces import leading_depth
from spectral_contact.fields.series import Array, Radius
from spectral_contact.spectral.parameters import Parameters

#: Slip is wider than the set where full stick violates ``|q| <= f p``. With ``1 - f/f_crit``
#: enlarged by this factor the set contains the slip: slip is less than twice as wide as the set
#: where the width of the set is proportional to ``sqrt(1 - f/f_crit)``, and less than four times as
#: wide where it is proportional to ``1 - f/f_crit``.
SLIP_WIDENING = 4.0


def unresolved_slip(full_stick: FullStick, parameters: Parameters) -> float:
    """Return the relative error of the stick radius 1 if full stick stands for narrow slip.

    It does if the friction is critical to within the errors. Then the slip is no wider than the set
    where full stick violates the law under a lower friction, which is SLIP_WIDENING times as far
    below the critical one. The error is the distance of the inner boundary of this set from the
    edge, relative to its radius.
    """
    if full_stick.critical == inf:
        return UNRESOLVED_SLIP
    onset_distance = max(1.0 - parameters.friction / full_stick.critical, 0.0)
    onset_distance += 2.0 * full_stick.critical_error
    friction = full_stick.critical * (1.0 - min(SLIP_WIDENING * onset_distance, 1.0))
    logits = slip_where_exceeded(full_stick, parameters, friction).logits
    if not logits:
        return UNRESOLVED_SLIP
    radius = Radius.from_logit(logits[0])
    return max(UNRESOLVED_SLIP, radius.from_edge / radius.value)


def slip_where_exceeded(
    full_stick: FullStick,
    parameters: Parameters,
    friction: float | None = None,
    traction: Callable[[Array, Array], Array] | None = None,
    depths: Sequence[float] = (),
) -> Layout:
    """Return zones that slip where full stick has ``|q| > f p``, and stick elsewhere.

    Parameters
    ----------
    full_stick : FullStick
        Full stick, with pressure and traction.
    parameters : Parameters
    friction : float, optional
        The friction f, if not that of the parameters.
    traction : callable, optional
        The traction as a function of s and ``1 - s``, if not that of full stick.
    depths : sequence of float
        Depths x around which slip may be narrow, besides that of the largest ``|q|/p`` of full
        stick.
    """
    pressure = full_stick.pressure
    traction = traction or full_stick.traction
    assert pressure is not None
    assert traction is not None
    f = parameters.friction if friction is None else friction
    edge_depth = _edge_depth(parameters)

    def traction_at(x: Array) -> Array:
        s = np.sqrt(-np.expm1(-x))
        from_edge = np.exp(-x) / (1.0 + s)
        return traction(s, from_edge)

    def excess(x: Array) -> Array:
        """Return ``|q|/p - f``, cut off at f, so that it is finite for the search of its zeros."""
        q = traction_at(x)
        p = pressure.evaluate(np.exp(-x))
        with np.errstate(divide="ignore", invalid="ignore"):
            # without pressure the contact would open
            ratio = np.where(p > 0.0, np.abs(q) / p, np.inf)
        return np.asarray(np.minimum(ratio, 2.0 * f) - f)

    # the set may be tiny: the grid of depths is fine around that of the largest ratio
    peak = -log(full_stick.critical_y) if full_stick.critical_y > 0.0 else edge_depth
    distances = np.exp(-sample_depths(EPSILON_DEPTH, SAMPLES))
    offsets = np.concatenate([-distances, [0.0], distances])
    fine = np.add.outer([peak, *depths], offsets).ravel()
    fine = fine[(fine > 0.0) & (fine < edge_depth)]
    x = np.unique(np.concatenate([sample_depths(edge_depth, ONSET_SAMPLES), fine]))

    exceeds = excess(x) > 0.0
    brackets = np.flatnonzero(exceeds[1:] != exceeds[:-1]).tolist()
    boundaries = [first_sign_change(excess, x[i], x[i + 1]) for i in brackets]
    if exceeds[0]:  # within the first x there is a stick disk: the centre sticks under any friction
        boundaries = [float(x[0]), *boundaries]
    # depths of the inner and the outer boundary of every slip zone in turn
    slip_boundaries = [*boundaries, edge_depth] if exceeds[-1] else boundaries
    middles = (np.array(slip_boundaries[::2]) + np.array(slip_boundaries[1::2])) / 2.0
    states: list[int] = []
    for traction_sign in np.sign(traction_at(middles)).astype(int).tolist():
        states += [0, traction_sign]
    if not exceeds[-1]:
        states.append(0)
    return Layout(tuple(logit_at(boundary) for boundary in boundaries), tuple(states))


def _edge_depth(parameters: Parameters) -> float:
    """Return the x beyond which the ratio ``|q|/p`` of full stick is that of the edge."""
    beta = parameters.beta
    if parameters.alpha == 0.0 < beta:
        # On a smooth surface p grows like 1/sqrt(y), while q is at most about kappa/beta. So f p
        # exceeds q for y below (f beta/kappa)**2, and the edge sticks.
        ratio = min(parameters.friction / parameters.kappa, 1.0)
        return max(-2.0 * log(ratio * min(beta, 1.0)), 0.0) + EPSILON_DEPTH
    return leading_depth(parameters, 1.0)
