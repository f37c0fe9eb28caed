"""Coordinates for a search: toroidal ones, and polar ones around where loads are not smooth.

Towards the edge, or such a place, one coordinate of either kind grows like minus the logarithm of
the distance, so that the place itself is infinitely far away. In a plane through the axis the edge
is two points. With the distances d1 from the one and d2 from the other, the toroidal coordinates
are tau = ln(d2/d1), which counts e-folds towards the edge, and sigma, the angle between the
directions to the two: pi on the contact, 0 on the free surface.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from spectral_contact.equations.interior.mesh import BodyPoints
from spectral_contact.fields import Array
from spectral_contact.fields.series import CENTRE, Radius

#: Nodes along a line of the toroidal coordinates, and of a net over the quarter plane, for tau and
#: for sigma (chosen).
_LINE = 241
_NET = (61, 41)
#: Smallest tau of a line along the surface, and smallest sigma of that along the axis: either is
#: 2000 radii away. On the contact this tau is 5e-4 from the centre. Largest tau, 1e-15 from the
#: edge.
_FARTHEST = 1e-3
_CLOSEST = 35.0
#: The same of polar coordinates, for the e-folds towards the place and for the angle (chosen).
_POLAR_LINE = 89
_POLAR_NET = (35, 17)
#: E-folds towards the place: on lines down to 3e-10 of the first distance, where the place is as
#: good as reached; on nets to 1e-6, where the rounding of the place does not show.
_FOLDS = 22.0
_NET_FOLDS = 14.0


@dataclass(frozen=True)
class CoordinateLine:
    """A line along one of the two coordinates.

    Attributes
    ----------
    axis : int
        Which of them varies, 0 or 1.
    fixed : float
        Value of the other.
    grid : ndarray
        Values of the first at which the search begins.
    on_surface : bool
        Whether the line lies on the surface of the body.
    """

    axis: int
    fixed: float
    grid: Array = field(repr=False)
    on_surface: bool = True

    def both(self, x: Array) -> tuple[Array, Array]:
        """Return both coordinates where the one that varies is x."""
        other = np.full_like(x, self.fixed)
        return (x, other) if self.axis == 0 else (other, x)


def from_toroidal(tau: Array, sigma: Array) -> BodyPoints:
    """Return the points of toroidal coordinates.

    On the axis tau is 0, at infinity tau and sigma are.
    """
    # with the point as the complex number w = r + i z, (w - 1)/(w + 1) is exp(q)
    q = -tau + 1j * sigma
    from_edge = 2.0 * np.exp(q) / np.expm1(q)  # 1 - w
    d = from_edge.real
    z = np.abs(from_edge.imag)
    z = np.where((sigma == 0.0) | (sigma == np.pi), 0.0, z)
    return BodyPoints(np.maximum(1.0 - d, 1e-30), np.minimum(d, 1.0), z)


class Toroidal:
    """The chart of the toroidal coordinates tau and sigma.

    Parameters
    ----------
    centre : bool
        Whether the loads are not smooth at the centre of the contact. Then another chart has the
        centre, and the line along the axis ends just below it.

    Attributes
    ----------
    lines : tuple of CoordinateLine
        The boundaries of the chart: the free surface, the contact and the axis.
    net : tuple of ndarray
        Values of the two coordinates inside.
    """

    def __init__(self, centre: bool) -> None:
        along_surface = np.geomspace(_FARTHEST, _CLOSEST, _LINE)
        along_axis = np.linspace(_FARTHEST, np.pi - (_FARTHEST if centre else 0.0), _LINE)
        self.lines: tuple[CoordinateLine, ...] = (
            CoordinateLine(0, 0.0, along_surface),
            CoordinateLine(0, np.pi, along_surface),
            CoordinateLine(1, 0.0, along_axis, on_surface=False),
        )
        taus = np.linspace(0.0, _CLOSEST, _NET[0])
        taus = np.concatenate([np.linspace(0.0, 3.0, _NET[0]), taus[taus > 3.0]])
        self.net = taus, np.linspace(0.0, np.pi, _NET[1])[1:-1]

    def points(self, u: Array, v: Array) -> BodyPoints:
        """Return the points of the body with these coordinates."""
        return from_toroidal(u, v)

    def reflected(self, u: float, v: float) -> tuple[float, float]:
        """Return coordinates in range: reflected at axis and surface, with u at most `_CLOSEST`."""
        return min(abs(u), _CLOSEST), float(np.abs(np.mod(v + np.pi, 2.0 * np.pi) - np.pi))

    def inside(self, u: float, v: float) -> bool:
        """Return whether coordinates lie inside the chart; u may be negative, beyond the axis."""
        return 0.0 < v < np.pi and abs(u) < _CLOSEST

    def scale(self, u: float, v: float) -> float:
        """Return a bound of the length of a unit of either coordinate, over that from the edge.

        A unit is as long as d1 d2/2, so over the distance d1 it is d2/2. Where that is below 1 the
        bound is 1.
        """
        return max(1.0, float(1.0 / np.abs(np.expm1(-u + 1j * v))))


class Polar:
    """The chart of polar coordinates around a place on the surface.

    They are the e-folds towards the place, and the angle from the outward direction.

    Parameters
    ----------
    place : Radius
    reach : float
        Distance from the place up to which the chart goes, at most half of that to the edge.

    Attributes
    ----------
    lines : tuple of CoordinateLine
        Outward along the surface, and inward along it, or down the axis at the centre.
    net : tuple of ndarray
        Values of the two coordinates inside.
    """

    def __init__(self, place: Radius, reach: float) -> None:
        self._place = place
        self._reach = reach
        self._largest_angle = np.pi / 2.0 if place is CENTRE else np.pi
        along = np.linspace(0.0, _FOLDS, _POLAR_LINE)
        last = CoordinateLine(0, self._largest_angle, along, on_surface=place is not CENTRE)
        self.lines: tuple[CoordinateLine, ...] = (CoordinateLine(0, 0.0, along), last)
        angles = np.linspace(0.0, self._largest_angle, _POLAR_NET[1])[1:-1]
        self.net = np.linspace(0.0, _NET_FOLDS, _POLAR_NET[0]), angles

    def points(self, u: Array, v: Array) -> BodyPoints:
        """Return the points of the body with these coordinates."""
        distance = self._reach * np.exp(-u)
        outward = np.where(v == np.pi / 2.0, 0.0, distance * np.cos(v))
        depth = np.where(v == np.pi, 0.0, distance * np.sin(v))
        radius = np.maximum(self._place.value + outward, 1e-30)
        return BodyPoints(radius, self._place.from_edge - outward, depth)

    def reflected(self, u: float, v: float) -> tuple[float, float]:
        """Return coordinates in range: the angle reflected, the e-folds cut off."""
        largest = self._largest_angle
        angle = float(np.abs(np.mod(v + largest, 2.0 * largest) - largest))
        return min(max(u, 0.0), _FOLDS), angle

    def inside(self, u: float, v: float) -> bool:
        """Return whether coordinates lie inside the chart, and not on its boundaries."""
        return 0.0 < v < self._largest_angle and 0.0 < u < _FOLDS

    def scale(self, u: float, _v: float) -> float:
        """Return a bound of the length of a unit of either coordinate, over that from the edge.

        A unit is as long as the distance from the place, by which a point can be closer to the edge
        than the place is. The bound is 1 at most, as `reach` goes half way to the edge at most.
        """
        length = self._reach * np.exp(-u)
        return float(length / (self._place.from_edge - length))


#: Two coordinates of the quarter plane.
Chart = Toroidal | Polar


def around(boundaries: list[Radius], *, centre: bool) -> list[Chart]:
    """Return the charts of a contact.

    Parameters
    ----------
    boundaries : list of Radius
        Where the loads are not smooth, from the centre to the edge, both included.
    centre : bool
        Whether they are not smooth at the centre, either.
    """
    charts: list[Chart] = [Toroidal(centre)]
    # half of each distance between neighbours
    halves = [
        (a.from_edge - b.from_edge if a.value > 0.5 else b.value - a.value) / 2.0
        for a, b in pairwise(boundaries)
    ]
    if centre:
        charts.append(Polar(CENTRE, halves[0]))
    for before, place, after in zip(halves, boundaries[1:-1], halves[1:], strict=False):
        charts.append(Polar(place, min(before, after)))
    return charts
