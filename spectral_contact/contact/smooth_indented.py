r"""Contact under a profile on a smooth surface: the half-integral of the pressure is known.

s is the radius over that of the contact, and H the transform of the height (`indented`). The
half-integral of the pressure is ``F = H(1) - H(t)``, and ``p(s) = (2/pi) int_s^1 H'(t) dt /
sqrt(t^2 - s^2)``: a multiple of the half-integral of ``H'(t)/t``, so that no system is solved. This
*density* is expanded on panels graded to the breaks of the profile and to its tip. At points of a
part, the half-integral of the density on this part, or on the other half of the same annulus, is a
product of its coefficients with a matrix. The matrices depend on the panels alone and are cached.
The integral over parts farther out is regular and taken by a quadrature rule.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import pi
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from spectral_contact.contact.resolution import TINY
from spectral_contact.contact.tuning import PANEL_WIDTH, ROUNDING
from spectral_contact.fields.series import CENTRE, EDGE, LogSeries, Radius
from spectral_contact.profiles.profile_base import Profile
from spectral_contact.spectral.blocks import abel_integral_on
from spectral_contact.spectral.cache import bounded_cache
from spectral_contact.spectral.jacobi import gauss_rule
from spectral_contact.spectral.panels import LogPanels
from spectral_contact.spectral.parts import DiskPartition, GradedMesh, OffsetRadii, z_difference
from spectral_contact.spectral.transforms import sampled_series, transforms
from spectral_contact.threads import cached_property

Array = NDArray[np.float64]

#: An increment of the pressure over a panel in the logarithm of the distance is rounding if it is a
#: smaller fraction of the pressure than this.
_ROUNDED_INCREMENT = 1e-13
#: The pressure goes like a logarithm if the ratio of the increments of two panels is at least this.
_LOGARITHMIC_RATIO = 1.0 - 1e-6
#: Degree on a panel. The singularity at the far end of an annulus lies ln 2 in ``x`` outside the
#: first panel of the other half, which sets the rate of convergence.
_DEGREE = 24
#: Number of panels toward a tip: they end at 4e-18 of the contact radius, and nearer to the tip the
#: pressure is taken for a constant or a logarithm. And number of panels toward any other boundary:
#: they end where the distance in ``s**2`` is rounding.
_TIP_PANELS, _PANELS = 40, 20
#: Panels that the density has beyond those of the pressure, on a part that lies outside of the
#: corner or tip to which it is graded. There the density goes like 1/sqrt(d), so that the
#: half-integral needs it at smaller distances d than those at which the pressure is wanted.
_FURTHER_PANELS = 32
#: Gauss points of the quadrature rule on a panel, and on one that begins at the centre.
_POINTS, _CENTRAL_POINTS = 16, 24
#: Further points on a panel of the finer rule: integrals by it differ from those by the usual rule
#: by the error of the latter.
_MORE_POINTS = 8


class _QuadratureRule(NamedTuple):
    """Distances d in (0, 1], ``1 - d`` to full relative accuracy, weights of ``int_0^1 . dd``."""

    d: Array
    rest: Array
    weights: Array


@dataclass(frozen=True, slots=True)
class SmoothPressure:
    """The series of a pressure on every part, and an estimate of their relative error."""

    series: list[LogSeries]
    error: float


@dataclass(frozen=True, slots=True)
class KnownContact:
    """Integrals over t, in units of the contact radius a, and the pressure.

    Attributes
    ----------
    moment, energy : float
        ``int F dt`` and ``int F^2 dt``.
    moment_error, energy_error : float
        Estimates of their relative errors by the quadrature; 0 if they were not wanted.
    pressure : SmoothPressure or None
        None if it is not wanted.
    """

    moment: float
    energy: float
    moment_error: float
    energy_error: float
    pressure: SmoothPressure | None


def smooth_contact(
    profile: Profile, radius: float, parts: DiskPartition, *, pointwise: bool, estimated: bool
) -> KnownContact:
    """Return the contact of a given radius.

    Parameters
    ----------
    profile : Profile
    radius : float
    parts : DiskPartition
        The disk, divided at the breaks of the profile.
    pointwise : bool
        Whether the pressure is wanted; next to the edge it has the weight ``sqrt(d)``.
    estimated : bool
        Whether errors of the integrals are wanted. Then the integrals are those by the finer rule.
    """
    ends = list(zip(parts.ends, parts.profile_breaks, strict=True))

    def with_points(more_points: int) -> list[_KnownPart]:
        return [
            _KnownPart(profile, radius, end, last_break, innermost=k == 0, more_points=more_points)
            for k, (end, last_break) in enumerate(ends)
        ]

    def integrals(pieces: list[_KnownPart]) -> Array:
        return np.asarray(np.sum([piece.integrals() for piece in pieces], axis=0))

    pieces = with_points(0)
    usual = integrals(pieces)
    best = integrals(with_points(_MORE_POINTS)) if estimated else usual
    moment, energy = best.tolist()
    moment_error, energy_error = (np.abs(usual - best) / np.maximum(best, TINY)).tolist()
    pressure = _pressure(pieces, moment) if pointwise else None
    return KnownContact(moment, energy, moment_error, energy_error, pressure)


class _KnownPart:
    """A part of the contact, with the points of its quadrature rule.

    Parameters
    ----------
    profile, radius
        Those of `smooth_contact`.
    end : tuple of (Radius, int, float)
        Boundary, sign and extent of the mesh (`DiskPartition.ends`).
    last_break : Radius
        The largest break of the profile that is inside the part; the centre if there is none.
    innermost : bool
        Whether the part begins at the centre.
    more_points : int
        How many points a panel has beyond those of the usual rule.

    Attributes
    ----------
    mesh : GradedMesh
    points : OffsetRadii
    weights, t : ndarray
        Weights of ``d(t^2)``, and radii.
    """

    def __init__(
        self,
        profile: Profile,
        radius: float,
        end: tuple[Radius, int, float],
        last_break: Radius,
        *,
        innermost: bool,
        more_points: int,
    ) -> None:
        self._profile = profile
        self._radius = radius
        self._last_break = last_break
        boundary, sign, extent = end
        count = _TIP_PANELS if boundary is CENTRE else _PANELS
        self.mesh = GradedMesh(*end, LogPanels(count, PANEL_WIDTH, _DEGREE))
        # if the first panel begins at the centre, t is accurate there, too: it is taken from 1 - d
        reaches_centre = innermost and sign < 0
        rule = _quadrature_rule(self.mesh.panels, reaches_centre, more_points)
        self.points = self.mesh.points(rule.d)
        self.weights = extent * rule.weights
        self.t: Array = np.sqrt(extent * rule.rest if reaches_centre else self.points.z)

    def _past_break(self, points: OffsetRadii) -> Array:
        """Return ``t^2 - b^2`` for the break b inside this part, 0 if there is none."""
        no_break = self._last_break is CENTRE
        return np.zeros(len(points.offset)) if no_break else -points.before(self._last_break)

    def _rates(self, t: Array, points: OffsetRadii) -> Array:
        """Return ``H'`` at the points, whose radii are t."""
        return self._profile._rate(
            self._radius * t, self._radius * self._radius * self._past_break(points)
        )

    def integrals(self) -> Array:
        """Return ``int F dt`` and ``int F^2 dt`` over the part."""
        past_break = self._radius * self._radius * self._past_break(self.points)
        decrement = self._profile._fall(self._radius, self.t, self.points.y, past_break)
        half_integral = decrement / self._radius
        weights = self.weights / (2.0 * self.t)
        return np.array([weights @ half_integral, weights @ half_integral**2])

    def density(self) -> _Density:
        """Return ``H'(t)/t`` as a series; on a part outside its boundary it has further panels."""
        panels = self.mesh.panels
        if self.mesh.sign > 0:
            panels = replace(panels, count=panels.count + _FURTHER_PANELS)
        mesh = self.mesh._replace(panels=panels)
        points = mesh.sampling()
        t = np.sqrt(points.z)
        values = self._rates(t, points) / t
        series = sampled_series(panels, values)
        top_coefficients = np.abs(series.coefficients[:, -2:]).sum(axis=1)
        truncation = top_coefficients * np.sqrt(mesh.extent * series.ends[:-1])
        return _Density(panels, mesh.expand(values), truncation)

    def half_integral_of_density(self, target: OffsetRadii) -> Array:
        """Return ``1/2 int H'(t)/t d(t^2) / sqrt(t^2 - s^2)`` at points s of parts farther in."""
        distance = z_difference(target.anchor, self.points.anchor) - target.offset
        kernel = distance[:, None] + self.points.offset
        np.sqrt(kernel, out=kernel)
        np.divide(1.0, kernel, out=kernel)
        return np.asarray(kernel @ self._weighted_density)

    @cached_property
    def _weighted_density(self) -> Array:
        """Half of ``H'(t)/t`` at the points, times their weights."""
        return self.weights * self._rates(self.t, self.points) / (2.0 * self.t)


@dataclass(frozen=True, slots=True)
class _Density:
    """The function ``H'(t)/t`` on the panels of a part.

    Attributes
    ----------
    panels : LogPanels
    coefficients : ndarray, shape (size,)
    truncation : ndarray, shape (panels,)
        Estimate, by panels, of the error of a half-integral by the truncation of the series.
    """

    panels: LogPanels
    coefficients: Array
    truncation: Array

    def self_integral(self, sign: int) -> Array:
        """Return its half-integral at its own sampling points, in unit extent."""
        abel = transforms(self.panels)
        return abel.abel_right(self.coefficients) if sign < 0 else abel.abel_left(self.coefficients)


def _pressure(pieces: list[_KnownPart], moment: float) -> SmoothPressure:
    """Return the pressure on every part."""
    densities = [piece.density() for piece in pieces]
    pressures = []
    error = 0.0
    mean = 4.0 / pi * moment  # mean pressure: the load 4 int F dt over the area
    for k, (piece, density) in enumerate(zip(pieces, densities, strict=True)):
        mesh = piece.mesh
        panels = mesh.panels
        distances = panels.sampling_distances
        values = np.sqrt(mesh.extent) * density.self_integral(mesh.sign)
        if mesh.boundary is EDGE:
            series = sampled_series(panels, 2.0 / pi * values / np.sqrt(distances))
            pressure = replace(series, power=0.5)
            pressures.append(pressure)
            # the truncation on a panel is compared with p at its inner end, or with the mean
            least = np.maximum(pressure.at_ends()[1:], max(mean, TINY))
            truncation_error = 2.0 / pi * float((density.truncation / least).max())
            error = max(error, _unresolved(series), truncation_error)
            continue
        first_outer = k + 1
        if mesh.sign > 0:  # the other half of an annulus
            values = values[: len(distances)]
            values += abel_integral_on(mesh, pieces[k + 1].mesh, densities[k + 1].coefficients, 1)
            first_outer = k + 2
        points = mesh.points(distances)
        for outer in pieces[first_outer:]:
            values += outer.half_integral_of_density(points)
        pressure, limit_error = _with_limit(sampled_series(panels, 2.0 / pi * values))
        pressures.append(pressure)
        truncation_error = 2.0 / pi * float(density.truncation.max()) / mean
        error = max(error, _unresolved(pressure), limit_error, truncation_error)
    return SmoothPressure(pressures, error)


def _unresolved(series: LogSeries) -> float:
    """Return the largest of the last coefficients of a panel, relative to the values there."""
    size = np.abs(series.at_ends())
    last = np.abs(series.coefficients[:, -2:]).max(axis=1)
    return float((last / np.maximum(np.maximum(size[:-1], size[1:]), TINY)).max())


def _with_limit(series: LogSeries) -> tuple[LogSeries, float]:
    """Return a series with its limit at a break or tip as tail, and the error of the limit.

    Next to the tip of a power law the pressure approaches its limit like a small power of the
    distance. So the limit is extrapolated from the increments over the last two panels, as that of
    a geometric series; the closer their ratio is to 1, the larger is its relative error. From
    `_LOGARITHMIC_RATIO` on the tail is a logarithm of the distance.
    """
    before, middle, end = series.at_ends()[-3:].tolist()
    series = replace(series, tail=np.array([end]))
    increment = end - middle
    if abs(increment) <= _ROUNDED_INCREMENT * abs(end):
        return series, 0.0
    ratio = increment / (middle - before) if middle != before else 1.0
    if ratio < _LOGARITHMIC_RATIO:
        limit = end + increment * ratio / (1.0 - ratio)
        return replace(series, tail=np.array([limit])), 2.0 * ROUNDING / (1.0 - ratio) ** 2
    slope = 2.0 / series.width * float(series.coefficients[-1, 1])
    return replace(series, logarithm=slope), 0.0


@bounded_cache("quadrature rules", 8)
def _quadrature_rule(panels: LogPanels, reaches_centre: bool, more_points: int) -> _QuadratureRule:
    """Return a rule on these panels and the tail (cached).

    If the first panel reaches the centre of a disk, its points are clustered there, for square
    roots of the distance from the centre. Every panel has so many points more than usual.
    """
    h = panels.width
    points = _POINTS + more_points
    _, w = gauss_rule(points)
    by_panels = panels.sampling(points)
    weights_by_panels = np.tile(w * h / 2.0, (panels.count, 1))
    x = by_panels.ravel()
    x_weights = weights_by_panels.ravel()
    if reaches_centre:
        g, w = gauss_rule(_CENTRAL_POINTS + more_points)
        root = (1.0 + g) / 2.0
        x = np.concatenate([h * root**2, by_panels[1:].ravel()])
        x_weights = np.concatenate([w * h * root, weights_by_panels[1:].ravel()])
    tail, tail_weights, _ = panels.tail_rule()
    d = np.exp(-x)
    return _QuadratureRule(
        np.concatenate([d, tail]),
        np.concatenate([-np.expm1(-x), 1.0 - tail]),
        np.concatenate([d * x_weights, tail_weights]),
    )
