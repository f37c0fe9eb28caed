"""The gap outside the contact of a profile, from the pressure by quadrature."""

from __future__ import annotations

from dataclasses import replace
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
#: Farther out profiles have no height.
_FARTHEST = 1e100


def gap_outside(solution: Solution, s: ArrayLike | None, beyond: ArrayLike | None) -> Any:
    """Return the gap of `Solution.gap`."""
    exactly_one("s", s, "beyond", beyond)
    name, given, least = ("s", s, 1.0) if beyond is None else ("beyond", beyond, 0.0)
    allowed = f"finite and at least {least:.0f}"
    places = np.asarray(reals(name, given, allowed, low=least), dtype=float)
    wrong = ~((places >= least) & np.isfinite(places))
    if wrong.any():
        raise SceneError(name, float(places[wrong][0]), allowed)
    solution._require("contact_radius")
    solution._require("pressure")
    past = (places - least).ravel()
    profile, a = solution.scene.profile, solution.contact_radius
    assert profile is not None
    most = min(profile.reach, _FARTHEST) / a
    if (1.0 + past > most).any():
        worst = float(places.ravel()[past.argmax()])
        raise SceneError(name, worst, f"such that the radius is in [1, {most:.6g}]")
    moved = np.zeros(len(past))
    field = solution.pressure_field
    assert field is not None
    weight = field.weight
    apart = weight if weight is not None and weight.shift == 0.0 else None  # infinite at the edge
    if apart is not None:
        field = replace(field, weight=None)
    graded, weights = _graded()
    outside = 1.0 + past[:, None]
    for inner, outer in pairwise([0.0, *(b / a for b in profile.breaks if b < a), 1.0]):
        half = (outer - inner) / 2.0
        above, below = inner + half * graded, (1.0 - outer) + half * graded
        for eta, inward in ((above, 1.0 - above), (1.0 - below, below)):
            strength = eta * (half * weights) * field(eta, inward)
            m1 = (past[:, None] + inward) / outside * ((outside + eta) / outside)
            moved += ellipkm1(m1) @ strength
    moved /= pi * (1.0 + past)
    if apart is not None:
        # a pressure A/sqrt(1 - s**2) moves the surface by A arcsin(1/s)/2 of the radius
        moved += apart.amplitude / 2.0 * np.arctan2(1.0, np.sqrt(past) * np.sqrt(2.0 + past))
    gap = profile.height(a * (1.0 + past)) - solution.approach + a * moved
    return gap.reshape(places.shape)[()]


def _graded() -> tuple[Array, Array]:
    """Return a rule on (0, 1) that is graded to 0."""
    g, w = leggauss(_POINTS)
    ends = np.append(_RATIO ** np.arange(_PANELS), 0.0)
    low, width = ends[1:, None], -np.diff(ends)[:, None]
    return (low + width * (1.0 + g) / 2.0).ravel(), (width * w / 2.0).ravel()
