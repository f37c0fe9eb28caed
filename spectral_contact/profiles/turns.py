"""Radii at which the curve of an adhesive contact may turn more than once."""

from __future__ import annotations

from itertools import pairwise
from typing import Final

import numpy as np

from spectral_contact.fields import Array
from spectral_contact.profiles.profile_base import Profile

#: Radii of a piece, between two breaks, at which the rate is taken: so many in even steps, and so
#: many in even steps of the logarithm of the distance from the break before it.
_EVEN = 40
_GRADED = 40
#: Least distance of a radius from the break before it, or the centre: as a fraction of the distance
#: to the next break, and of the radius of the break itself.
_LEAST_DISTANCE: Final = 1e-9
#: A change of the rate that is smaller than this, relative, is taken for rounding.
_ROUNDED: Final = 1e-9
#: Where, between two turns, there are more radii: fractions of the way from the inner to the outer.
_BETWEEN: Final = (0.03, 0.1, 0.25, 0.5)


def turning_radii(profile: Profile, radius: float) -> list[float]:
    r"""Return radii below a radius, decreasing, near which an adhesive contact may have folds.

    On a smooth surface load and approach of an adhesive contact turn where ``sqrt(a) H'(a)`` has
    some value that follows from the work of adhesion (docs/theory, adhesion). Where this function
    grows with the radius, as under a sphere or a cone, there is one such place. It falls next to a
    corner of the profile, and where the slope rises steeply over a short way: then there may be
    several places, with a turn of the function between each and the next. The radii are those of
    its turns, and some between them. They are empty where the function grows all over.

    Parameters
    ----------
    profile : Profile
        Not flat.
    radius : float
        Inside its reach.
    """
    flat_part = profile.flat_part
    ends = [flat_part, *(b for b in profile.breaks if flat_part < b < radius), radius]
    sampled = [_on_piece(profile, low, high) for low, high in pairwise(ends)]
    radii = np.concatenate([piece_radii for piece_radii, _ in sampled])
    values = np.concatenate([piece_values for _, piece_values in sampled])
    turns = radii[_turns(values)].tolist()
    found = set(turns)
    for inner, outer in pairwise(turns):
        found.update(inner + share * (outer - inner) for share in _BETWEEN)
    return sorted(found, reverse=True)


def _on_piece(profile: Profile, low: float, high: float) -> tuple[Array, Array]:
    """Return radii beyond a break, up to the next one, and the function at them."""
    size = high - low
    even = np.linspace(0.0, 1.0, _EVEN + 1)[1:]
    distance = size * np.union1d(even, np.geomspace(_LEAST_DISTANCE, 1.0, _GRADED))
    distance = distance[distance >= _LEAST_DISTANCE * low]
    radii = low + distance
    # the square of the radius less that of the break, 0 if there is none
    past_break = distance * (low + radii) if low > 0.0 else np.zeros(len(radii))
    return radii, np.sqrt(radii) * profile._rate(radii, past_break)


def _turns(values: Array) -> list[int]:
    """Return where numbers have a maximum or a minimum, but for changes that are rounding."""
    found: list[int] = []
    extreme = 0
    rises = True
    for k in range(1, len(values)):
        # from the last extreme on, positive in the sense in which the values go
        change = values[k] - values[extreme] if rises else values[extreme] - values[k]
        if change >= 0.0:
            extreme = k
        elif -change > _ROUNDED * abs(values[extreme]):
            found.append(extreme)
            extreme = k
            rises = not rises
    return found
