r"""Contact under a profile on a smooth surface, where the half-integral is known: no system.

It is ``F = H(1) - H(t)``, and ``p(s) = (2/pi) int_s^1 H'(t) dt / sqrt(t^2 - s^2)``: but for the
factor the half-integral of ``H'(t)/t``, a series on panels graded to the breaks of the profile and
to its tip. What panels make of it on their own part and on the other half of an annulus depends on
the panels alone and is kept; what lies farther out is integrated plainly.
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
from spectral_contact.spectral.parts import DiskPartition, GradedMesh, OffsetRadii, gap
from spectral_contact.spectral.transforms import sampled_series, transforms
from spectral_contact.threads import cached_property

Array = NDArray[np.float64]

#: What a pressure grows over a panel in the logarithm of the distance is rounding if it is less;
#: and a logarithm if it is no smaller a share of what it grew over the one before.
_ROUNDED, _LOGARITHM = 1e-13, 1.0 - 1e-6
#: Degree on a panel: the edge is a root ln 2 away from the other half's first panel. Panels to a
#: tip, up to 4e-18 of the radius, and to anything else, up to a rounding of its square.
_DEGREE, _TO_TIP, _PANELS = 24, 40, 20
#: So many panels farther ``H'(t)/t`` is known, which past a corner and at a tip is as 1/sqrt(d).
_FARTHER = 32
#: Gauss points on a panel for what is integrated plainly, and on one that begins at the centre.
_POINTS, _CENTRAL = 16, 24


class _PlainRule(NamedTuple):
    """Distances d in (0, 1], ``1 - d`` to full relative accuracy, weights of ``int_0^1 . dd``."""

    d: Array
    rest: Array
    weights: Array


@dataclass(frozen=True, slots=True)
class SmoothPressure:
    """Series on every part, and an estimate of their relative error."""

    series: list[LogSeries]
    error: float


@dataclass(frozen=True, slots=True)
class KnownContact:
    """Integrals over t, in units of the contact radius, and the pressure.

    Attributes
    ----------
    moment, energy : float
        ``int F dt`` and ``int F^2 dt``.
    pressure : SmoothPressure or None
        If it is wanted.
    """

    moment: float
    energy: float
    pressure: SmoothPressure | None


def smooth_contact(
    profile: Profile, radius: float, parts: DiskPartition, *, pointwise: bool
) -> KnownContact:
    """Return a contact of a given radius.

    Parameters
    ----------
    profile : Profile
    radius : float
    parts : DiskPartition
        Graded to the profile's breaks.
    pointwise : bool
        Whether the pressure is wanted; next to the edge it has the weight ``sqrt(d)``.
    """
    inner = zip(parts.ends, parts.profile_breaks, strict=True)
    pieces = [_KnownPart(profile, radius, end, one, k == 0) for k, (end, one) in enumerate(inner)]
    moment = energy = 0.0
    for one in pieces:
        known, weights = one.half_integral(), one.weights / (2.0 * one.t)
        moment += float(weights @ known)
        energy += float(weights @ known**2)
    return KnownContact(moment, energy, _pressure(pieces, moment) if pointwise else None)


class _KnownPart:
    """A part of the contact, with points at which it is integrated plainly.

    Attributes
    ----------
    mesh : GradedMesh
    points : OffsetRadii
    weights, t : ndarray
        Weights of ``dt^2``, and radii.
    """

    def __init__(
        self,
        profile: Profile,
        radius: float,
        end: tuple[Radius, int, float],
        inner: Radius,
        first: bool,
    ) -> None:
        self._profile, self._radius, self._inner = profile, radius, inner
        boundary, sign, extent = end
        count = _TO_TIP if boundary is CENTRE else _PANELS
        self.mesh = GradedMesh(*end, LogPanels(count, PANEL_WIDTH, _DEGREE))
        rule = _rule(self.mesh.panels, centred := first and sign < 0)
        self.points, self.weights = self.mesh.points(rule.d), extent * rule.weights
        # a disk's own points know how far they are from its centre
        self.t: Array = np.sqrt(extent * rule.rest if centred else self.points.z)

    def _past(self, points: OffsetRadii) -> Array:
        """Return ``t^2 - b^2`` for the break b before this part, 0 if there is none."""
        inside = self._inner is CENTRE
        return np.zeros(len(points.offset)) if inside else -points.before(self._inner)

    def _rates(self, t: Array, points: OffsetRadii) -> Array:
        return self._profile._rate(self._radius * t, self._radius**2 * self._past(points))

    def half_integral(self) -> Array:
        """Return ``F`` at the points."""
        past = self._radius**2 * self._past(self.points)
        fall = self._profile._fall(self._radius, self.t, self.points.y, past)
        return np.asarray(fall / self._radius)

    def density(self) -> _Density:
        """Return ``H'(t)/t`` as a series, on more panels if it lies above its boundary."""
        panels = self.mesh.panels
        if self.mesh.sign > 0:
            panels = replace(panels, panels=panels.panels + _FARTHER)
        mesh = self.mesh._replace(panels=panels)
        points = mesh.sampling()
        t = np.sqrt(points.z)
        values = self._rates(t, points) / t
        series = sampled_series(panels, values)
        last = np.abs(series.coefficients[:, -2:]).sum(axis=1)
        lost = last * np.sqrt(mesh.extent * series.ends[:-1])
        return _Density(panels, mesh.expand(values), lost)

    def seen_from(self, target: OffsetRadii) -> Array:
        """Return half of ``int H'(t)/t dt^2 / sqrt(t^2 - s^2)`` at points that are clear of it."""
        apart = gap(target.anchor, self.points.anchor) - target.offset
        kernel = apart[:, None] + self.points.offset
        np.sqrt(kernel, out=kernel)
        np.divide(1.0, kernel, out=kernel)
        return np.asarray(kernel @ self._charges)

    @cached_property
    def _charges(self) -> Array:
        """Half of ``H'(t)/t`` at the points, with their weights."""
        return self.weights * self._rates(self.t, self.points) / (2.0 * self.t)


@dataclass(frozen=True, slots=True)
class _Density:
    """A function on the panels of a part; and what half-integrals lack by each of them."""

    panels: LogPanels
    coefficients: Array
    lost: Array

    def on_its_own(self, sign: int) -> Array:
        """Return its half-integral at its own sampling points, in unit extent."""
        own = transforms(self.panels)
        return own.abel_right(self.coefficients) if sign < 0 else own.abel_left(self.coefficients)


def _pressure(pieces: list[_KnownPart], moment: float) -> SmoothPressure:
    """Return the pressure on every part."""
    densities = [piece.density() for piece in pieces]
    found, worst, mean = [], 0.0, 4.0 / pi * moment
    for k, (piece, density) in enumerate(zip(pieces, densities, strict=True)):
        mesh, panels = piece.mesh, piece.mesh.panels
        distances = panels.sampling_distances
        at_edge = mesh.boundary is EDGE
        values = np.sqrt(mesh.extent) * density.on_its_own(mesh.sign)
        if at_edge:
            series = sampled_series(panels, 2.0 / pi * values / np.sqrt(distances))
            found.append(replace(series, power=0.5))
            # what is deeper does not feel it
            felt = np.maximum(found[-1].at_ends()[1:], max(mean, TINY))
            worst = max(worst, _unresolved(series), 2.0 / pi * float((density.lost / felt).max()))
            continue
        clear = k + 1
        if mesh.sign > 0:  # the other half of an annulus
            values = values[: len(distances)]
            values += abel_integral_on(mesh, pieces[k + 1].mesh, densities[k + 1].coefficients, 1)
            clear = k + 2
        points = mesh.points(distances)
        for outer in pieces[clear:]:
            values += outer.seen_from(points)
        series, lost = _to_the_break(sampled_series(panels, 2.0 / pi * values))
        found.append(series)
        lost = max(lost, 2.0 / pi * float(density.lost.max()) / mean)
        worst = max(worst, _unresolved(series), lost)
    return SmoothPressure(found, worst)


def _unresolved(series: LogSeries) -> float:
    """Return the largest of the last coefficients of a panel, relative to the values there."""
    size = np.abs(series.at_ends())
    last = np.abs(series.coefficients[:, -2:]).max(axis=1)
    return float((last / np.maximum(np.maximum(size[:-1], size[1:]), TINY)).max())


def _to_the_break(series: LogSeries) -> tuple[LogSeries, float]:
    """Return a series with the limit at a break or tip, or a tail that goes on as a logarithm.

    Next to the tip of a power law the pressure settles like a power of the distance, which may be
    a slow one: its limit follows from how it grows over the last two panels, and is the less
    certain the slower it is. That is the other number, relative to the limit.
    """
    before, middle, end = series.at_ends()[-3:].tolist()
    series = replace(series, tail=np.array([end]))
    grown = end - middle
    if abs(grown) <= _ROUNDED * abs(end):
        return series, 0.0
    ratio = grown / (middle - before) if middle != before else 1.0
    if ratio < _LOGARITHM:
        limit = end + grown * ratio / (1.0 - ratio)
        return replace(series, tail=np.array([limit])), 2.0 * ROUNDING / (1.0 - ratio) ** 2
    slope = 2.0 / series.width * float(series.coefficients[-1, 1])
    return replace(series, logarithm=slope), 0.0


@bounded_cache("plain rules", 8)
def _rule(panels: LogPanels, centred: bool) -> _PlainRule:
    """Return a rule on these panels and the tail (cached).

    Next to the centre of a disk it is clustered, as for square roots of the distance from there.
    """
    h, (g, w) = panels.width, gauss_rule(_POINTS)
    x, dx = panels.sampling(_POINTS), np.tile(w * h / 2.0, (panels.panels, 1))
    own, on_own = x.ravel(), dx.ravel()
    if centred:
        g, w = gauss_rule(_CENTRAL)
        v = (1.0 + g) / 2.0
        own = np.concatenate([h * v**2, x[1:].ravel()])
        on_own = np.concatenate([w * h * v, dx[1:].ravel()])
    tail, on_tail, _ = panels.tail_rule()
    near = np.exp(-own)
    return _PlainRule(
        np.concatenate([near, tail]),
        np.concatenate([-np.expm1(-own), 1.0 - tail]),
        np.concatenate([near * on_own, on_tail]),
    )
