"""Where functions live: panels graded to a boundary, their points, and the parts of a disk.

Next to the boundary a mesh ends in a *tail*, a panel of polynomials in the distance (`LogPanels`).
"""

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
    from spectral_contact.spectral.blockwise import Blockwise
    from spectral_contact.spectral.panels import LogPanels

Array = NDArray[np.float64]


def z_difference(a: Radius, b: Radius) -> float:
    """Return the difference of ``z = s**2`` from a to b, of either sign, without cancellation."""
    difference = a.from_edge - b.from_edge if a.value >= 0.5 else b.value - a.value
    return difference * (a.value + b.value)


class OffsetRadii(NamedTuple):
    """Radii given by ``s**2 = anchor**2 + offset``, so that differences keep their digits."""

    anchor: Radius
    offset: Array

    def before(self, boundary: Radius) -> Array:
        """Return ``boundary**2 - s**2``."""
        return z_difference(self.anchor, boundary) - self.offset

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
    extent : float
        Of the part, in ``s**2``.
    panels : LogPanels
        With an endpoint weight only at the edge of the contact.
    """

    boundary: Radius
    sign: int
    extent: float
    panels: LogPanels

    def points(self, d: Array) -> OffsetRadii:
        """Return the points at scaled distances `d` in [0, 1]."""
        return OffsetRadii(self.boundary, self.sign * self.extent * d)

    def mass(self, degrees: tuple[int, ...], factor: float = 1.0, *, shear: bool) -> Blockwise:
        """Return ``int phi psi s ds`` of functions p, or ``int phi psi s**3 ds`` of functions q/s.

        They are multiplied by a factor, such as a compliance.
        """
        half = factor * self.extent / 2.0
        if not shear:
            return self.panels.mass(degrees, half)
        return self.panels.mass(
            degrees, half * self.boundary.square, half * self.sign * self.extent
        )

    def sampling(self) -> OffsetRadii:
        """Return the sampling points: panels, then tail."""
        return self.points(self.panels.sampling_distances)

    def unresolved(self, series: LogSeries) -> float:
        """Return the largest of the last three coefficients of a panel, and two of the tail."""
        return float(max(np.abs(series.coefficients[:, -3:]).max(), np.abs(series.tail[-2:]).max()))

    def truncated(self, values: Array, power: float) -> float:
        """Return the largest coefficient that `expand` drops anywhere, times ``d**power``.

        The power is that by which the effect of an error falls toward the boundary: 1/2 for Abel
        integrals.
        """
        table, tail = sampled_coefficients(self.panels, values)
        p = self.panels
        dropped = np.abs(table[:, p.degree + 1 :]).max(axis=1)
        effects = dropped * np.exp(-power * p.width * np.arange(p.count))
        return float(max(effects.max(), np.abs(tail[p.tail_terms :]).max() * p.end**power))

    def expand(self, values: Array) -> Array:
        """Return coefficients, (..., size), through values at the sampling points, (..., n).

        The tail is expanded in polynomials of d.
        """
        table, tail = sampled_coefficients(self.panels, values)
        p = self.panels
        shape = values.shape[:-1]
        on_panels = table[..., : p.degree + 1].reshape(*shape, -1)
        return np.concatenate([on_panels, tail[..., : p.tail_terms]], axis=-1)


@dataclass(frozen=True, slots=True)
class DiskPartition:
    """The parts of a disk: a central disk or annulus, and annuli around it, of two halves each.

    Parameters
    ----------
    breaks : tuple of Radius
        Ends of parts between the centre and the edge, outward: boundaries between zones, or radii
        at which a derivative of the profile or of the pressure jumps.
    pointed : bool
        Whether the punch has a tip, so that panels are graded to the centre, too.
    smooth_breaks : tuple of Radius
        Breaks at which the profile is smooth: `profile_breaks` passes over them.
    """

    breaks: tuple[Radius, ...]
    pointed: bool
    smooth_breaks: tuple[Radius, ...] = ()
    #: of every part: its boundary, +1 if it lies outside of that or -1, and its extent in s**2
    ends: list[tuple[Radius, int, float]] = field(init=False, compare=False, default_factory=list)
    #: for every part the last break of the profile inside of it, or the centre
    profile_breaks: list[Radius] = field(init=False, compare=False, default_factory=list)

    def __post_init__(self) -> None:
        profile_break = CENTRE
        for inner, outer in pairwise((CENTRE, *self.breaks, EDGE)):
            is_disk = inner is CENTRE and not self.pointed
            sides = [(outer, -1)] if is_disk else [(inner, 1), (outer, -1)]
            extent = z_difference(inner, outer) / len(sides)
            self.ends.extend((boundary, sign, extent) for boundary, sign in sides)
            profile_break = profile_break if inner in self.smooth_breaks else inner
            self.profile_breaks.extend([profile_break] * len(sides))


def sampled_coefficients(panels: LogPanels, values: Array) -> tuple[Array, Array]:
    """Return coefficients on panels and tail through samples at the sampling points of both.

    Samples are (..., n), and coefficients (..., panels, points) and (..., points of the tail).
    """
    tail_points = panels.tail_points
    on_panels = values[..., :-tail_points].reshape(*values.shape[:-1], panels.count, -1)
    points = on_panels.shape[-1]
    expansion = legendre_expansion_matrix(points, points - 1)
    tail_expansion = legendre_expansion_matrix(tail_points, tail_points - 1)
    return on_panels @ expansion.T, values[..., -tail_points:] @ tail_expansion.T
