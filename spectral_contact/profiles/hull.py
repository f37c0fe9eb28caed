"""The convex hull, from below, of points of a measured profile."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike

from spectral_contact.errors import SceneError
from spectral_contact.fields import Array
from spectral_contact.io.checks import finite

#: Least distance of two radii, over the larger one. A panel between closer ones would be as narrow
#: as rounding.
LEAST_STEP: Final = 1e-14


@dataclass(frozen=True, slots=True)
class PointHull:
    """The convex hull of points from below; made by `hull_of_points`.

    Attributes
    ----------
    radii, heights : tuple of float
        The points that are its corners.
    largest : float
        The largest distance in height of a point from it.
    rms : float
        Root mean square of these distances.
    """

    radii: tuple[float, ...]
    heights: tuple[float, ...]
    largest: float
    rms: float


def hull_of_points(radii: ArrayLike, heights: ArrayLike) -> PointHull:
    """Return the convex hull, from below, of points of a profile.

    Heights below 0 count as 0, as the profile touches at the centre first. The hull of noisy
    points lies on the low side of them, about as far as the noise.

    Parameters
    ----------
    radii, heights : array_like, shape (n,)
        As of `Sampled.from_points`, convex or not.

    Raises
    ------
    SceneError
        If they are not at least three, do not begin with 0, or the radii do not increase; or if
        the hull does not rise.

    Examples
    --------
    >>> from spectral_contact.profiles import hull_of_points
    >>> hull = hull_of_points([0, 1, 2, 3], [0, 0.6, 1.0, 2.0])
    >>> print(hull.radii, f"{hull.largest:.2f}")
    (0.0, 2.0, 3.0) 0.10
    """
    r, given = checked_points(radii, heights)
    values = np.maximum(given, 0.0)
    corners: list[int] = []
    for i in range(len(r)):
        while len(corners) > 1:
            before, last = corners[-2:]
            first = (values[last] - values[before]) * (r[i] - r[before])
            if first < (values[i] - values[before]) * (r[last] - r[before]):
                break
            corners.pop()
        corners.append(i)
    if not values[corners[-1]] > 0.0:
        raise SceneError("heights", float(given[-1]), "above 0 where the profile ends")
    hull = np.interp(r, np.array(r)[corners], values[corners])
    # the hull is a line, and profiles take three points: another one of the line is added
    if len(corners) == 2:
        corners.insert(1, len(r) // 2)
    off = np.abs(given - hull)
    return PointHull(
        tuple(r[k] for k in corners),
        tuple(hull[corners].tolist()),
        float(off.max()),
        float(np.sqrt(np.mean(off**2))),
    )


def checked_points(radii: ArrayLike, heights: ArrayLike) -> tuple[tuple[float, ...], Array]:
    """Return points of a profile, at least three, that begin with 0 at increasing radii."""
    r = increasing("radii", radii)
    values = finite("heights", heights)
    if len(r) < 3 or r[0] != 0.0:
        raise SceneError("radii", radii, "three or more that begin with 0")
    if len(values) != len(r) or values[0] != 0.0:
        raise SceneError("heights", heights, f"{len(r)} numbers that begin with 0")
    return r, values


def increasing(name: str, values: Any) -> tuple[float, ...]:
    """Return radii that increase."""
    radii = finite(name, list(values) if isinstance(values, tuple) else values)
    if not (np.diff(radii) > LEAST_STEP * np.abs(radii[1:])).all():
        told = f"radii that increase, by more than {LEAST_STEP:g} of themselves"
        raise SceneError(name, values, told)
    return tuple(radii.tolist())
