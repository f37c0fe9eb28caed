"""The gap between two bodies neither of which is flat: the sum of their profiles."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from spectral_contact.errors import SceneError
from spectral_contact.fields import Array
from spectral_contact.profiles.hull import LEAST_STEP
from spectral_contact.profiles.profile_base import Profile
from spectral_contact.profiles.shapes import Flat


@dataclass(frozen=True, slots=True)
class Sum(Profile):
    """The sum of two profiles, the gap between two bodies that have them.

    In a scene two parabolas become one, ``1/radius = 1/first.radius + 1/second.radius``.

    Parameters
    ----------
    first, second : Profile
        Any but `Flat`, which adds nothing, and `Sum`.

    Raises
    ------
    SceneError
        If they are something else.

    Examples
    --------
    >>> from spectral_contact import profiles
    >>> gap = profiles.Sum(profiles.PowerLaw(0.5, 4.0), profiles.Parabola(2.0))
    >>> print(gap.height(1.0))
    0.75
    """

    first: Profile
    second: Profile

    def __post_init__(self) -> None:
        for name in ("first", "second"):
            one = getattr(self, name)
            if not isinstance(one, Profile) or isinstance(one, Flat | Sum):
                raise SceneError(name, one, "a Profile that is not flat and no sum")

    @property
    def _both(self) -> tuple[Profile, Profile]:
        return self.first, self.second

    @property
    def flat_part(self) -> float:
        """Radius up to which both are flat."""
        return min(one.flat_part for one in self._both)

    @property
    def reach(self) -> float:
        """Radius at which one of them ends."""
        return min(one.reach for one in self._both)

    @property
    def _pole(self) -> float:
        return min(one._pole for one in self._both)

    @property
    def pointed(self) -> bool:
        """Whether one of them is."""
        return any(one.pointed for one in self._both)

    @property
    def breaks(self) -> tuple[float, ...]:
        """Those of both below the reach; of two that differ by rounding alone, the larger one."""
        all_breaks = sorted({b for one in self._both for b in one.breaks if b < self.reach})
        distinct = [b for b, after in pairwise(all_breaks) if not _same_radius(b, after)]
        return (*distinct, *all_breaks[-1:])

    @property
    def brief(self) -> str:
        """Kinds and parameters of both."""
        return f"Sum({self.first.brief}, {self.second.brief})"

    def _height(self, r: Array) -> Array:
        return np.asarray(self.first._height(r) + self.second._height(r))

    def _transform(self, t: Array) -> Array:
        return np.asarray(self.first._transform(t) + self.second._transform(t))

    def _fall(self, radius: float, t: Array, y: Array, past: Array) -> Array:
        first, second = (self._past(one, radius * t, past) for one in self._both)
        return np.asarray(
            self.first._fall(radius, t, y, first) + self.second._fall(radius, t, y, second)
        )

    def _rate(self, t: Array, past: Array) -> Array:
        first, second = (self._past(one, t, past) for one in self._both)
        return np.asarray(self.first._rate(t, first) + self.second._rate(t, second))

    def _past(self, one: Profile, t: Array, past: Array) -> Array:
        """Return ``t**2 - b**2`` where b is the last break below t that is one of this profile.

        Parameters
        ----------
        one : Profile
            One of the two.
        t : ndarray
            Radii.
        past : ndarray
            The same where b is the last break below t of the sum, so a break of either profile.
        """
        breaks = np.array(self.breaks)
        if not len(breaks):
            return past
        t, past = np.broadcast_arrays(np.asarray(t, dtype=float), past)
        # which break of the sum it is follows from t**2 - past; next to a break a comparison of t
        # with it would be decided by rounding
        last = np.argmin(np.abs(np.subtract.outer(t**2 - past, breaks**2)), axis=-1)
        before_first_break = (past == 0.0) & (t <= breaks[0])
        result = np.zeros(t.shape)
        for b in one.breaks:  # ascending: the last of its own wins
            beyond = ((breaks[last] >= b) | _same_radius(breaks[last], b)) & ~before_first_break
            between = np.where(
                _same_radius(breaks[last], b), 0.0, (breaks[last] - b) * (breaks[last] + b)
            )
            result = np.where(beyond, past + between, result)
        return result

    def _slope_error(self, radius: float) -> float:
        return sum(one._slope_error(radius) for one in self._both)


def _same_radius(first: ArrayLike, second: ArrayLike) -> Any:
    """Return whether radii are the same but for rounding, as 0.1 + 0.2 and 0.3 are."""
    return np.isclose(first, second, rtol=LEAST_STEP, atol=0.0)
