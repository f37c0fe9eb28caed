"""The gap outside the contact of a profile, from the pressure by quadrature."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from math import pi
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.polynomial.legendre import leggauss
from numpy.typing import ArrayLike
from scipy.special import ellipkm1

from spectral_contact.errors import SceneError
from spectral_contact.fields import Array
from spectral_contact.io.checks import exactly_one, reals

if TYPE_CHECKING:
    from spectral_contact.solution import Solution

#: Panels that shrink by this factor towards edge, breaks and centre; so many, with so many points:
#: the last point next to a break is as far off as its rounding.
_RATIO, _PANELS, _POINTS = 0.3, 24, 16


@dataclass(frozen=True, slots=True)
class OutsideRadii:
    """Radii outside the contact, as distances from its edge, and how they were given."""

    name: str
    given: Array
    beyond: Array


def outside_radii(s: ArrayLike | None, beyond: ArrayLike | None) -> OutsideRadii:
    """Return radii of at least 1, or distances of at least 0, whichever was given."""
    exactly_one("s", s, "beyond", beyond)
    name, given, least = ("s", s, 1.0) if beyond is None else ("beyond", beyond, 0.0)
    allowed = f"finite and at least {least:.0f}"
    values = np.asarray(reals(name, given, allowed, low=least), dtype=float)
    wrong = ~((values >= least) & np.isfinite(values))
    if wrong.any():
        raise SceneError(name, float(values[wrong][0]), allowed)
    return OutsideRadii(name, values, values - least)


def gap_outside(solution: Solution, places: OutsideRadii) -> Any:
    """Return the gap of `Solution.gap`."""
    past = places.beyond.ravel()
    profile, a = solution.scene.profile, solution.contact_radius
    assert profile is not None
    most = profile.reach / a
    if (1.0 + past > most).any():
        worst = float(places.given.ravel()[past.argmax()])
        raise SceneError(places.name, worst, f"such that the radius is in [1, {most:.6g}]")
    moved = np.zeros(len(past))
    field = solution.pressure_field
    assert field is not None
    breaks = [b / a for b in profile.breaks if b < a]
    for half in _halves(breaks):
        eta, inward = half.eta, half.inward
        strength = eta * half.weights * field(eta, inward)
        m1 = (past[:, None] + inward) * (1.0 + past[:, None] + eta) / (1.0 + past[:, None]) ** 2
        moved += ellipkm1(m1) @ strength
    moved /= pi * (1.0 + past)
    gap = profile.height(a * (1.0 + past)) - solution.approach + a * moved
    return gap.reshape(places.given.shape)[()]


@dataclass(frozen=True, slots=True)
class _HalfRule:
    """Points of half an interval, their distances from 1, and weights."""

    eta: Array
    inward: Array
    weights: Array


def _halves(breaks: list[float]) -> Iterator[_HalfRule]:
    """Yield rules on the halves of the intervals between breaks, graded to these."""
    g, w = leggauss(_POINTS)
    ends = np.append(_RATIO ** np.arange(_PANELS), 0.0)
    low, width = ends[1:, None], -np.diff(ends)[:, None]
    graded = (low + width * (1.0 + g) / 2.0).ravel()
    weights = (width * w / 2.0).ravel()
    for inner, outer in pairwise([0.0, *breaks, 1.0]):
        half = (outer - inner) / 2.0
        above, below = inner + half * graded, (1.0 - outer) + half * graded
        yield _HalfRule(above, 1.0 - above, half * weights)
        yield _HalfRule(1.0 - below, below, half * weights)
