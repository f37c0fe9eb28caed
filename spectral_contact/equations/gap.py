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
from spectral_contact.fields.series import CENTRE, EDGE, ZonalField
from spectral_contact.io.checks import exactly_one, reals

if TYPE_CHECKING:
    from spectral_contact.solution import Solution

#: Panels shrink by this factor towards the centre, the edge and the places between at which the
#: pressure is not smooth (chosen).
_RATIO = 0.3
#: Number of these panels. The first point is at 5e-15 of half the interval from such a place. For a
#: closer point the radius would have too few digits of the distance.
_PANELS = 24
#: Gauss points of each panel (chosen).
_POINTS = 16
#: Heights of profiles are not evaluated beyond this radius, as powers of it would overflow.
_FARTHEST = 1e100


def gap_outside(solution: Solution, s: ArrayLike | None, beyond: ArrayLike | None) -> Any:
    """Return the gap of `Solution.gap`, whose arguments these are."""
    exactly_one("s", s, "beyond", beyond)
    name, given, least = ("s", s, 1.0) if beyond is None else ("beyond", beyond, 0.0)
    allowed = f"finite and at least {least:.0f}"
    places = np.asarray(reals(name, given, allowed, low=least), dtype=float)
    outside_range = ~((places >= least) & np.isfinite(places))
    if outside_range.any():
        raise SceneError(name, float(places[outside_range][0]), allowed)
    solution._require("contact_radius")
    solution._require("pressure")
    past_edge = (places - least).ravel()
    profile = solution.scene.profile
    a = solution.contact_radius
    assert profile is not None
    farthest = min(profile.reach, _FARTHEST) / a
    if (1.0 + past_edge > farthest).any():
        worst = float(places.ravel()[past_edge.argmax()])
        raise SceneError(name, worst, f"such that the radius is in [1, {farthest:.6g}]")
    field = solution.pressure_field
    assert field is not None
    weight = field.weight
    # the endpoint weight of the pressure is 1/sqrt(1 - s**2 + shift) times its amplitude; without
    # shift it is infinite at the edge, but its displacement is known in closed form
    singular = weight if weight is not None and weight.shift == 0.0 else None
    if singular is not None:
        field = replace(field, weight=None)
    displacement = np.zeros(len(past_edge))
    nodes, weights = _graded_rule()
    radius = 1.0 + past_edge[:, None]
    ends = [piece.outer for piece in field.pieces] if isinstance(field, ZonalField) else [EDGE]
    for inner, outer in pairwise([CENTRE, *ends]):
        half = (inner.from_edge - outer.from_edge) / 2.0
        step = half * nodes
        from_inner = inner.value + step, inner.from_edge - step
        from_outer = outer.value - step, outer.from_edge + step
        for eta, from_edge in (from_inner, from_outer):
            # loads of rings, over 2 pi a**2
            ring_loads = eta * (half * weights) * field(eta, from_edge)
            # 1 - m of the parameter m = (eta/radius)**2, without cancellation
            complement = (past_edge[:, None] + from_edge) / radius * ((radius + eta) / radius)
            displacement += ellipkm1(complement) @ ring_loads
    displacement /= pi * (1.0 + past_edge)
    if singular is not None:
        # a pressure A/sqrt(1 - s**2) moves the surface at s > 1 by (A/2) arcsin(1/s) contact radii
        tangent = np.sqrt(past_edge) * np.sqrt(2.0 + past_edge)
        displacement += singular.amplitude / 2.0 * np.arctan2(1.0, tangent)
    gap = profile.height(a * (1.0 + past_edge)) - solution.approach + a * displacement
    return gap.reshape(places.shape)[()]


def _graded_rule() -> tuple[Array, Array]:
    """Return nodes and weights of a rule on (0, 1) that is graded to 0."""
    g, w = leggauss(_POINTS)
    ends = np.append(_RATIO ** np.arange(_PANELS), 0.0)
    low = ends[1:, None]
    width = -np.diff(ends)[:, None]
    return (low + width * (1.0 + g) / 2.0).ravel(), (width * w / 2.0).ravel()
