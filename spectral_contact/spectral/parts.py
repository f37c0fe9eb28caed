"""Where functions live: panels graded to a boundary, their points, and the parts of a disk."""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from spectral_contact.fields.radius import CENTRE, EDGE, Radius
from spectral_contact.spectral.jacobi import legendre_expansion_matrix

if TYPE_CHECKING:
    from spectral_contact.fields.series import LogSeries
    from spectral_contact.spectral.panels import LogPanels

Array = NDArray[np.float64]


def gap(a: Radius, b: Radius) -> float:
    """Return ``b**2 - a**2`` without cancellation."""
    difference = a.from_edge - b.from_edge if a.value >= 0.5 else b.value - a.value
    return difference * (a.value + b.value)


class OffsetRadii(NamedTuple):
    """Radii given by ``s**2 = anchor**2 + offset``, so that differences keep their digits."""

    anchor: Radius
    offset: Array

    def before(self, boundary: Radius) -> Array:
        """Return ``boundary**2 - s**2``."""
        return gap(self.anchor, boundary) - self.offset

    @property
    def z(self) -> Array:
        """Return ``s**2``."""
        return self.anchor.square + self.offset

    @property
    def y(self) -> Array:
        """Return ``1 - s**2``."""
        return self.anchor.rest - self.offset


class GradedMesh(NamedTuple):
    """Panels in the logarithm of the distance to one end of an annulus.

    Attributes
    ----------
    boundary : Radius
        The end.
    sign : int
        +1 if the annulus lies above (outside) the boundary, -1 if below.
    reach : float
        Extent in ``s**2``.
    panels : LogPanels
        With an endpoint weight only below the boundary.
    """

    boundary: Radius
    sign: int
    reach: float
    panels: LogPanels

    def points(self, d: Array) -> OffsetRadii:
        """Return the points at scaled distances `d` in [0, 1]."""
        return OffsetRadii(self.boundary, self.sign * self.reach * d)

    def mass(self, degrees: tuple[int, ...], values: Array | None = None, *, shear: bool) -> Array:
        """Return ``int phi psi s ds`` of pressures, or ``int phi psi s**3 ds`` of q/s.

        Or that times values, if there are any: coefficients of the functions as columns.
        """
        half = self.reach / 2.0
        rising = self.sign * self.reach
        density = (half * self.boundary.square, half * rising) if shear else (half, 0.0)
        if values is None:
            return self.panels.mass(degrees, *density)
        return self.panels.mass_times(degrees, values, *density)

    def sampling(self) -> OffsetRadii:
        """Return the sampling points: panels, then tail."""
        return self.points(self.panels.distances)

    def unresolved(self, series: LogSeries) -> float:
        """Return the largest of the last coefficients of any panel or of the tail."""
        return float(max(np.abs(series.coefficients[:, -3:]).max(), np.abs(series.tail[-2:]).max()))

    def truncated(self, values: Array, power: float) -> float:
        """Return the largest that `expand` drops of any panel or tail, times ``d**power``."""
        table, tail = sampled_coefficients(self.panels, values)
        p = self.panels
        dropped = np.abs(table[:, p.degree + 1 :]).max(axis=1)
        in_panels = dropped * np.exp(-power * p.width * np.arange(p.panels))
        return float(max(in_panels.max(), np.abs(tail[p.tail_terms :]).max() * p.end**power))

    def expand(self, values: Array) -> Array:
        """Return coefficients, (..., size), through values at the sampling points, (..., n)."""
        table, tail = sampled_coefficients(self.panels, values)
        p = self.panels
        shape = values.shape[:-1]
        inner = table[..., : p.degree + 1].reshape(*shape, -1)
        return np.concatenate([inner, tail[..., : p.tail_terms]], axis=-1)


@dataclass(frozen=True, slots=True)
class DiskPartition:
    """How a disk is cut: radii of the breaks, and whether panels are graded to the centre, too.

    Parameters
    ----------
    breaks : tuple of Radius
        From the centre outward.
    pointed : bool
    turns : tuple of Radius
        Those of the breaks at which the profile itself is smooth.
    """

    breaks: tuple[Radius, ...]
    pointed: bool
    turns: tuple[Radius, ...] = ()
    #: boundary, side of it that the part is on, and extent in s**2, of every part
    ends: list[tuple[Radius, int, float]] = field(init=False, compare=False, default_factory=list)
    #: the last break of the profile before every part, or the centre
    inner: list[Radius] = field(init=False, compare=False, default_factory=list)

    def __post_init__(self) -> None:
        last = CENTRE
        for inner, outer in pairwise((CENTRE, *self.breaks, EDGE)):
            is_disk = inner is CENTRE and not self.pointed
            sides = [(outer, -1)] if is_disk else [(inner, 1), (outer, -1)]
            extent = gap(inner, outer) / len(sides)
            self.ends.extend((boundary, sign, extent) for boundary, sign in sides)
            last = last if inner in self.turns else inner
            self.inner.extend([last] * len(sides))


def sampled_coefficients(panels: LogPanels, values: Array) -> tuple[Array, Array]:
    """Return coefficients on panels and tail through samples at the sampling points of both.

    Samples are (..., n), and coefficients (..., panels, points) and (..., points of the tail).
    """
    tail_points = panels.tail_points
    inner = values[..., :-tail_points].reshape(*values.shape[:-1], panels.panels, -1)
    points = inner.shape[-1]
    expand = legendre_expansion_matrix(points, points - 1)
    expand_tail = legendre_expansion_matrix(tail_points, tail_points - 1)
    return inner @ expand.T, values[..., -tail_points:] @ expand_tail.T
