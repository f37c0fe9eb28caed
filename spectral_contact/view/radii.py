"""Radii at which a solution is drawn or tabulated: they resolve its edge layer and its zones."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from spectral_contact.errors import SceneError
from spectral_contact.fields import Array
from spectral_contact.io.checks import values_at, whole
from spectral_contact.io.choices import function, instance
from spectral_contact.solution import Solution, Zone

#: Most radii that may be asked for.
_MOST: Final = 10_000_000


@dataclass(frozen=True, slots=True, eq=False)
class Radii:
    """Radii from the centre to the edge: the outer ones as distances from the edge.

    Places next to the edge that round to the same radius have different distances from it.

    Attributes
    ----------
    inner : ndarray
        Radii ``s < 1/2``, increasing, dimensionless.
    outer : ndarray
        Distances ``1 - s <= 1/2`` of all others, decreasing.
    """

    inner: Array
    outer: Array

    @property
    def s(self) -> Array:
        """All radii."""
        return np.concatenate([self.inner, 1.0 - self.outer])

    @property
    def from_edge(self) -> Array:
        """All distances from the edge."""
        return np.concatenate([1.0 - self.inner, self.outer])

    def evaluate(self, field: Callable[..., Any]) -> Array:
        """Evaluate `Solution.pressure`, `traction` or `slip` at all radii.

        Raises
        ------
        SceneError
            If the field is no function, or its values are not a real number for each radius.
        """
        function("field", field, "radii, or distances from_edge")
        inner = values_at("field", field, self.inner)
        outer = values_at("field", lambda places: field(from_edge=places), self.outer)
        return np.concatenate([inner, outer])


def graded_radii(solution: Solution, count: int = 200) -> Radii:
    """Return radii that resolve the edge layer and every zone of a solution.

    Parameters
    ----------
    solution : Solution
    count : int
        About how many: half of them evenly to s = 0.9, half graded into the edge layer, and up to
        eleven more in every zone.

    Returns
    -------
    Radii
        From s = 0 to s = 1, both included, with every zone boundary.

    Raises
    ------
    SceneError
        If it is no Solution, or the count is not a whole number in [1, 1e7].
    """
    instance("solution", solution, Solution)
    if whole("count", count, 1) > _MOST:
        raise SceneError("count", count, f"at most {_MOST:,}")
    even = max(count // 4, 2)
    inner = [np.linspace(0.0, 0.5, even, endpoint=False)]
    layer = np.geomspace(layer_depth(solution), 0.1, max(count // 2, 2))
    outer = [np.zeros(1), layer, np.linspace(0.5, 0.1, even, endpoint=False)]
    for zone in known_zones(solution):
        if zone.outer < 0.5:
            inner.append(np.linspace(zone.inner, zone.outer, 11))
        elif zone.inner >= 0.5:
            outer.append(np.linspace(zone.outer_from_edge, zone.inner_from_edge, 11))
        else:  # resolved by the even radii, save for its boundaries
            inner.append(np.array([zone.inner]))
            outer.append(np.array([zone.outer_from_edge]))
    s, depth = np.unique(np.concatenate(inner)), np.unique(np.concatenate(outer))[::-1]
    return Radii(s[s < 0.5], depth[depth <= 0.5])


def known_zones(solution: Solution) -> tuple[Zone, ...]:
    """Return the zones of a solution; none if they were not asked for."""
    return solution.zones if "zones" in solution.plan.quantities else ()


def layer_depth(solution: Solution) -> float:
    """Return a distance from the edge far below all lengths of a solution, over the radius.

    These lengths are the compliances and the widths of zones at the edge.
    """
    scene = solution.scene
    # under a profile compliances are in L; a radius that is not known is taken to be L
    radius = 1.0 if scene.profile is None else known_radius(solution) or 1.0
    compliances = scene.normal_compliance, scene.tangential_compliance
    scales = [1e-3, *(one / radius for one in compliances)]
    scales += [zone.outer_from_edge for zone in known_zones(solution)]
    return 1e-3 * min(scale for scale in scales if scale > 0.0)


def known_radius(solution: Solution) -> float | None:
    """Return the radius at s = 1 under a profile, in L; None if it is not known."""
    values = solution.values
    known = solution.scene.contact_radius, values.get("domain_radius"), values.get("contact_radius")
    return next((float(one) for one in known if one is not None), None)


def bulk_limits(radii: Radii, curves: Iterable[Array]) -> tuple[float, float]:
    """Return the limits of an axis for curves over radii.

    Values next to the edge are cut off if they are infinite, or more than 2.5 times the largest or
    least value elsewhere.
    """
    values = np.concatenate([np.where(np.isnan(one), 0.0, one) for one in curves])
    bulk = values[np.tile(radii.from_edge >= 0.02, len(values) // len(radii.s))]
    bulk = bulk[np.isfinite(bulk)]  # at the tip of a cone the pressure is infinite, too
    low = values.min()
    high = values.max()
    return from_zero(
        bulk.min() if low < 2.5 * bulk.min() else low,
        bulk.max() if high > 2.5 * bulk.max() else high,
    )


def from_zero(low: float, high: float) -> tuple[float, float]:
    """Return limits that contain zero and the values, with a margin so that both are seen."""
    low, high = min(low, 0.0), max(high, 0.0)
    margin = 0.05 * (high - low) or 1.0
    return float(low - margin), float(high + 2.0 * margin)
