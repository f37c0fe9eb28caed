"""Coordinates for a search: toroidal ones, and polar ones around where loads are not smooth.

In the first the edge is infinitely far away, in the others such a place. With the distances d1 from
the edge and d2 from the opposite one, tau = ln(d2/d1) counts e-folds towards the edge, and sigma is
the angle between the two directions: pi on the contact, 0 on the free surface.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from spectral_contact.equations.interior.mesh import BodyPoints
from spectral_contact.fields import Array
from spectral_contact.fields.series import CENTRE, Radius

#: Nets over tau and sigma, along a line and over the quarter plane; the edge is at tau = 35.
_LINE, _NET = 241, (61, 41)
_FARTHEST, _CLOSEST = 1e-3, 35.0
#: The same over the e-folds towards a place and the angle; lines go to where it is as good as
#: reached, the net to where the rounding of the place is not seen.
_FOLDS, _NET_FOLDS = 22.0, 14.0
_POLAR_LINE, _POLAR_NET = 89, (35, 17)


@dataclass(frozen=True)
class CoordinateLine:
    """A line along one of the two coordinates.

    Attributes
    ----------
    axis : int
        Which of them varies.
    fixed : float
        The other.
    grid : ndarray
        Where it is looked at first.
    on_surface : bool
    """

    axis: int
    fixed: float
    grid: Array = field(repr=False)
    on_surface: bool = True

    def both(self, x: Array) -> tuple[Array, Array]:
        """Return both coordinates."""
        other = np.full_like(x, self.fixed)
        return (x, other) if self.axis == 0 else (other, x)


def from_toroidal(tau: Array, sigma: Array) -> BodyPoints:
    """Return the points of coordinates; on the axis tau is 0, and at infinity both are."""
    q = -tau + 1j * sigma
    place = -2.0 * np.exp(q) / np.expm1(q)
    d, z = -place.real, np.abs(place.imag)
    z = np.where((sigma == 0.0) | (sigma == np.pi), 0.0, z)
    return BodyPoints(np.maximum(1.0 - d, 1e-30), np.minimum(d, 1.0), z)


class Toroidal:
    """E-folds towards the edge, and the angle between it and the opposite one.

    Its `lines` are its boundaries, and its `net` values of the two coordinates inside.

    Parameters
    ----------
    centre : bool
        Whether the centre of the contact is left to another chart.
    """

    def __init__(self, centre: bool) -> None:
        along = np.geomspace(_FARTHEST, _CLOSEST, _LINE)
        deep = np.linspace(_FARTHEST, np.pi - (_FARTHEST if centre else 0.0), _LINE)
        axis = CoordinateLine(1, 0.0, deep, on_surface=False)
        self.lines: tuple[CoordinateLine, ...] = (
            CoordinateLine(0, 0.0, along),
            CoordinateLine(0, np.pi, along),
            axis,
        )
        taus = np.linspace(0.0, _CLOSEST, _NET[0])
        taus = np.concatenate([np.linspace(0.0, 3.0, _NET[0]), taus[taus > 3.0]])
        self.net = taus, np.linspace(0.0, np.pi, _NET[1])[1:-1]

    def points(self, u: Array, v: Array) -> BodyPoints:
        """Return the points of coordinates."""
        return from_toroidal(u, v)

    def reflected(self, u: float, v: float) -> tuple[float, float]:
        """Return coordinates mirrored at axis and surface until they are in range."""
        return min(abs(u), _CLOSEST), float(np.abs(np.mod(v + np.pi, 2.0 * np.pi) - np.pi))

    def inside(self, u: float, v: float) -> bool:
        """Return whether a place is off the boundaries of the chart."""
        return 0.0 < v < np.pi and abs(u) < _CLOSEST

    def share(self, _u: float) -> float:
        """Return what a unit of a coordinate is at most, over the distance from the edge."""
        return 1.0


class Polar:
    """E-folds towards a place on the surface, and the angle from the direction outward.

    Parameters
    ----------
    place : Radius
    room : float
        How far from it the chart goes.
    """

    def __init__(self, place: Radius, room: float) -> None:
        self._place, self._room = place, room
        self._turn = np.pi / 2.0 if place is CENTRE else np.pi
        along = np.linspace(0.0, _FOLDS, _POLAR_LINE)
        inward = CoordinateLine(0, self._turn, along, on_surface=place is not CENTRE)
        self.lines: tuple[CoordinateLine, ...] = (CoordinateLine(0, 0.0, along), inward)
        angles = np.linspace(0.0, self._turn, _POLAR_NET[1])[1:-1]
        self.net = np.linspace(0.0, _NET_FOLDS, _POLAR_NET[0]), angles

    def points(self, u: Array, v: Array) -> BodyPoints:
        """Return the points of coordinates."""
        size = self._room * np.exp(-u)
        outward = np.where(v == np.pi / 2.0, 0.0, size * np.cos(v))
        depth = np.where(v == np.pi, 0.0, size * np.sin(v))
        radius = np.maximum(self._place.value + outward, 1e-30)
        return BodyPoints(radius, self._place.from_edge - outward, depth)

    def reflected(self, u: float, v: float) -> tuple[float, float]:
        """Return coordinates mirrored at axis and surface until they are in range."""
        return min(max(u, 0.0), _FOLDS), float(
            np.abs(np.mod(v + self._turn, 2.0 * self._turn) - self._turn)
        )

    def inside(self, u: float, v: float) -> bool:
        """Return whether a place is off the boundaries of the chart."""
        return 0.0 < v < self._turn and 0.0 < u < _FOLDS

    def share(self, u: float) -> float:
        """Return what a unit of a coordinate is at most, over the distance from the edge."""
        return float(min(self._room * np.exp(-u) / self._place.from_edge, 1.0))


#: Two coordinates of the quarter plane.
Chart = Toroidal | Polar


def around(boundaries: list[Radius], *, centre: bool) -> list[Chart]:
    """Return the charts of a contact.

    Parameters
    ----------
    boundaries : list of Radius
        Where the loads are not smooth, from the centre to the edge.
    centre : bool
        Whether they are not at the centre, either.
    """
    charts: list[Chart] = [Toroidal(centre)]
    halves = [
        (a.from_edge - b.from_edge if a.value > 0.5 else b.value - a.value) / 2.0
        for a, b in pairwise(boundaries)
    ]
    if centre:
        charts.append(Polar(CENTRE, halves[0]))
    for before, place, after in zip(halves, boundaries[1:-1], halves[1:], strict=False):
        charts.append(Polar(place, min(before, after)))
    return charts
