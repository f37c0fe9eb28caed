"""Which zones stick and which slip without coupling: an active set on rings, and full stick.

Full stick shows slip narrower than a ring. The result only starts the solution on fitted zones.
"""

from __future__ import annotations

from collections.abc import Iterator

from spectral_contact.contact.active_set import ring_layout
from spectral_contact.contact.layout import Layout
from spectral_contact.contact.onset import exceeded, is_narrow
from spectral_contact.contact.ratio import FullStick
from spectral_contact.fields.series import Radius
from spectral_contact.spectral.parameters import Parameters

__all__ = ["search_zones"]

#: How often rings at boundaries are split into four.
_SPLITS = 3


def search_zones(
    stick: FullStick, parameters: Parameters, radius: float | None
) -> Iterator[Layout]:
    """Guess the zones: those on rings, and those where full stick breaks the law.

    The latter come first if they are too narrow for rings.

    Parameters
    ----------
    stick : FullStick
        The full-stick solution.
    parameters : Parameters
        Those for kappa = 1.
    radius : float, optional
        The stick radius under the assumption of one disk, for disks smaller than a ring.
    """
    alpha, beta, _, friction = parameters
    slips = exceeded(stick, parameters)
    if is_narrow(slips):
        yield slips
    found = ring_layout(alpha, beta, friction, 1.0, False, splits=_SPLITS)
    logits = tuple(one.logit for one in found.boundaries)
    if found.centre_unseen:  # c = 2 beta f / kappa as f -> 0
        centre = 2.0 * beta * friction if radius is None else radius
        yield Layout((Radius(centre, 1.0 - centre).logit, *logits), (0, *found.states))
    elif found.states[-1] == 0 or not alpha == 0.0 < beta:  # a smooth edge sticks, if below rings
        yield Layout(logits, found.states)
    yield slips
