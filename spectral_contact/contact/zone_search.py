"""Which zones stick and which slip without coupling: an active set on rings, and full stick.

Full stick shows slip narrower than a ring. The result only starts the solution on fitted zones.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import inf

from spectral_contact.contact.active_set import ring_layout
from spectral_contact.contact.drive import Drive
from spectral_contact.contact.full_stick import FullStick
from spectral_contact.contact.layout import Layout, logit_at
from spectral_contact.contact.onset import depth_of, full_stick_violations
from spectral_contact.fields.series import Radius

__all__ = ["search_zones"]

#: Slip narrower than this in ``-ln y`` may fall between rings; full stick has its place then.
_NARROW = 0.25
#: How often rings at boundaries are split into four.
_SPLITS = 3


def search_zones(
    drive: Drive, stick: FullStick, beta: float, friction: float, radius: float | None
) -> Iterator[Layout]:
    """Guess the zones: those on rings, and those where full stick breaks the law.

    The latter come first if they are too narrow for rings.

    Parameters
    ----------
    drive : Drive
    stick : FullStick
        The full-stick solution.
    beta, friction : float
        ``beta*`` and ``f / kappa``.
    radius : float, optional
        The stick radius under the assumption of one disk, for disks smaller than a ring.
    """
    alpha = drive.contact.compliance
    violated = full_stick_violations(
        drive.pressure, stick, friction, depth_of(alpha, beta, friction)
    )
    narrow = bool(violated) and all(high - low < _NARROW for low, high in violated)
    if narrow:
        yield _layout(violated)
    found = ring_layout(alpha, beta, friction, 1.0, False, splits=_SPLITS)
    logits = tuple(one.logit for one in found.boundaries)
    if found.centre_unseen:  # c = 2 beta f / kappa as f -> 0
        centre = 2.0 * beta * friction if radius is None else radius
        yield Layout((Radius(centre, 1.0 - centre).logit, *logits), (0, *found.states))
    elif found.states[-1] == 0 or not alpha == 0.0 < beta:  # a smooth edge sticks, if below rings
        yield Layout(logits, found.states)
    if not narrow:
        yield _layout(violated)


def _layout(slips: list[tuple[float, float]]) -> Layout:
    """Turn slip intervals in ``x`` into boundaries and states."""
    ends = [x for interval in slips for x in interval if x != inf]
    states = [k % 2 for k in range(len(ends) + 1)]
    return Layout(tuple(logit_at(x) for x in ends), tuple(states))
