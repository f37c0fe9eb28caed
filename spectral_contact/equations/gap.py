"""The gap outside the contact of a profile, from the pressure by quadrature."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from math import pi
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.polynomial.legendre import leggauss
from numpy.typing import ArrayLike, NDArray
from scipy.special import ellipkm1

from spectral_contact.errors import SceneError
from spectral_contact.inputs.checks import exactly_one, finite

if TYPE_CHECKING:
    from spectral_contact.solution import Solution

__all__ = ["gap_outside"]

Array = NDArray[np.float64]

#: Panels that shrink by this factor towards edge, breaks and centre; so many, with so many points:
#: the last point next to a break is as far off as its rounding.
_RATIO, _PANELS, _POINTS = 0.3, 24, 16


def gap_outside(solution: Solution, s: ArrayLike | None, beyond: ArrayLike | None) -> Any:
    """Return the gap of `Solution.gap`."""
    exactly_one("s", s, "beyond", beyond)
    name, given = ("s", s) if beyond is None else ("beyond", beyond)
    values = np.asarray(given, dtype=float)
    flat = finite(name, values.ravel())
    past = flat - 1.0 if beyond is None else flat
    profile, a = solution.scene.profile, solution.contact_radius
    assert profile is not None
    most = profile.reach / a
    outside = (past >= 0.0) & (1.0 + past <= most)
    if not outside.all():
        told = f"at least {1 if beyond is None else 0}, and the radius in [1, {most:.6g}]"
        raise SceneError(name, float(flat[~outside][0]), told)
    moved = np.zeros(len(flat))
    field = solution.pressure_field
    assert field is not None
    breaks = [b / a for b in profile.breaks if b < a]
    for eta, inward, weights in _rule(breaks):
        strength = eta * weights * field(eta, inward)
        m1 = (past[:, None] + inward) * (1.0 + past[:, None] + eta) / (1.0 + past[:, None]) ** 2
        moved += ellipkm1(m1) @ strength
    moved /= pi * (1.0 + past)
    gap = profile.height(a * (1.0 + past)) - solution.approach + a * moved
    return gap.reshape(values.shape)[()]


def _rule(breaks: list[float]) -> Iterator[tuple[Array, Array, Array]]:
    """Yield points of [0, 1], their distances from 1, and weights, graded to the breaks."""
    g, w = leggauss(_POINTS)
    ends = np.append(_RATIO ** np.arange(_PANELS), 0.0)
    low, width = ends[1:, None], -np.diff(ends)[:, None]
    graded = (low + width * (1.0 + g) / 2.0).ravel()
    weights = (width * w / 2.0).ravel()
    for inner, outer in pairwise([0.0, *breaks, 1.0]):
        half = (outer - inner) / 2.0
        above, below = inner + half * graded, (1.0 - outer) + half * graded
        yield above, 1.0 - above, half * weights
        yield 1.0 - below, below, half * weights
