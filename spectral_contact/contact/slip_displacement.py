r"""Radial displacement in slip, and the checks of the friction law.

With ``E = kappa R - G``, what the half-integral lacks to satisfy full stick, the displacement is

    -u(s) = kappa g - T q - beta q = (1/(pi s)) int_0^s t^2 E dt / sqrt(s^2 - t^2) - beta q,

zero in stick by the tangential equation. Everything is for kappa = 1.
"""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from spectral_contact.contact.pressure_loads import load_outside, mean_inside
from spectral_contact.contact.resolution import DEEPEST, FIELD_ROUNDING, SAFETY, starting_resolution
from spectral_contact.fields.legendre import chebyshev_sums
from spectral_contact.fields.series import (
    EDGE,
    AnnulusSeries,
    Array,
    DiskSeries,
    LogSeries,
    PressureField,
    Radius,
    ZonalField,
)
from spectral_contact.spectral.blocks import abel_integral_on
from spectral_contact.spectral.graded import FAR_EXPANSION, FAR_NODES, inverse_root_sums
from spectral_contact.spectral.parts import GradedMesh, OffsetRadii, gap
from spectral_contact.spectral.transforms import sampled_series

if TYPE_CHECKING:
    from spectral_contact.contact.resolution import NormalContact
    from spectral_contact.spectral.annulus import Annulus

#: By how much less the displacement is off than E, through an integral over 1/sqrt(d) of it.
#: Without it estimates of slip are 4 times as large; with it none of 300 errors is larger.
_SMOOTHED = 16.0


class Stuck(NamedTuple):
    """A stick zone: quadrature of ``t^2 E dt`` over it, point sets with their weighted values."""

    outer: Radius
    parts: tuple[tuple[OffsetRadii, Array], ...]


class Slipping(NamedTuple):
    """A slip zone: the annulus, the sign of its traction, and E at its sampling points."""

    annulus: Annulus
    sign: int
    misfit: list[Array]

    @property
    def weighted_misfit(self) -> list[Array]:
        """``t E`` at the sampling points."""
        each = zip(self.annulus.families, self.misfit, strict=True)
        return [np.sqrt(family.sampling().z) * one for family, one in each]


class SlipFields(NamedTuple):
    """The displacement on every slip zone.

    Attributes
    ----------
    fields : list of AnnulusSeries
        ``u / kappa``, a field for every slip zone.
    samples : list of ndarray
        Its values times the sign of the traction: negative where slip opposes traction.
    largest : float
        Largest modulus.
    unresolved : float
        What the last coefficients of the sampled series leave out, nine times it to be safe.
    """

    fields: list[AnnulusSeries]
    samples: list[Array]
    largest: float
    unresolved: float


def slip_displacement(
    stuck: list[Stuck],
    zones: list[Slipping],
    pressure: PressureField | ZonalField,
    beta: float,
    friction: float,
) -> SlipFields:
    """Return the displacement on every slip zone.

    Zones of both kinds are ordered outward; friction is ``f / kappa``.
    """
    fields, samples, unresolved = list[AnnulusSeries](), list[Array](), 0.0
    for zone in zones:
        annulus, weighted = zone.annulus, zone.weighted_misfit
        halves, own = list[LogSeries](), list[Array]()
        p = pressure.at(annulus.y) if beta > 0.0 else np.zeros(annulus.y.shape)
        resisted = annulus.halves(beta * zone.sign * friction * p)
        integrals = annulus.integrals(weighted, -1)
        each = zip(annulus.families, weighted, integrals, resisted, strict=True)
        for family, e, total, q in each:
            for inner in _inside(stuck, annulus.inner):
                total += _from_stuck_at_samples(inner, family)
            for inner_zone in zones[: len(fields)]:
                halves_inside = zip(
                    inner_zone.annulus.families, inner_zone.weighted_misfit, strict=True
                )
                for one, values in halves_inside:
                    total += abel_integral_on(family, one, one.expand(values), -1)
            points = family.sampling()
            values = q - total / (pi * np.sqrt(points.z))
            halves.append(sampled_series(family.panels, values))
            inner_error = family.truncated(e, 0.5) / _SMOOTHED
            unresolved = max(unresolved, inner_error + family.unresolved(halves[-1]))
            own.append(zone.sign * values)
        fields.append(AnnulusSeries(annulus.inner, annulus.outer, halves[0], halves[1], power=0))
        samples.append(np.concatenate(own))
    largest = max(float(np.abs(v).max()) for v in samples)
    return SlipFields(fields, samples, largest, 2.0 * SAFETY * unresolved)


def _inside(stuck: list[Stuck], radius: Radius) -> list[Stuck]:
    """Return the zones that lie inside a radius."""
    return [zone for zone in stuck if zone.outer.rest >= radius.rest]


def _from_stuck_at_samples(zone: Stuck, family: GradedMesh) -> Array:
    """Integrate over a stick zone inside, at the sampling points of half a slip zone.

    The outer half is farther from the zone than it is wide: there a polynomial in ``s**2`` through
    few points is right to rounding.
    """
    points = family.sampling()
    if family.sign > 0:
        return _from_stuck(zone, points)
    reach = -family.reach
    fit = FAR_EXPANSION @ _from_stuck(
        zone, OffsetRadii(family.boundary, reach * (1.0 + FAR_NODES) / 2.0)
    )
    return np.asarray(chebyshev_sums(2.0 * points.offset / reach - 1.0, fit[:, None, None])[0])


def _from_stuck(zone: Stuck, points: OffsetRadii) -> Array:
    """Integrate over a stick zone that lies inside `points`."""
    total = np.zeros(len(points.offset))
    for sources, values in zone.parts:
        # s^2 - t^2 through the anchor they share or the gap between anchors
        distance = points.before(sources.anchor)
        total += inverse_root_sums(-distance, -sources.offset, values)
    return total


def largest_displacement(stuck: list[Stuck], inner: Radius, outer: Radius) -> float:
    """Return the largest displacement on an annulus that E in the stick zones inside makes.

    Seen at points graded to the inner end, where it is largest.
    """
    points = OffsetRadii(inner, gap(inner, outer) * np.exp(-np.linspace(0.0, DEEPEST, 41)))
    total = np.zeros(len(points.offset))
    for zone in _inside(stuck, inner):
        total += _from_stuck(zone, points)
    return float(np.abs(total / (pi * np.sqrt(points.z))).max())


def free_displacement(
    contact: NormalContact, kappa: float, tolerance: float
) -> tuple[DiskSeries, float]:
    """Return ``-kappa g``, the displacement without any traction, and its relative error.

    ``g = (1/s) int_0^s eta p deta`` is ``s`` times a function of ``y``, sampled here.
    """
    rate = 0.5 if contact.compliance == 0.0 else 1.0
    layer = -np.log(contact.compliance or 1.0)
    resolution = starting_resolution(max(layer, 0.0), tolerance, rate=rate)
    panels = resolution.panels
    d = panels.distances
    inside = 1.0 / (2.0 * pi) - load_outside(contact.pressure, d)
    # near the centre the difference cancels: there g/s is the mean of p over [0, s], over 2
    values = np.where(d < 0.5, inside / (1.0 - d), mean_inside(contact.pressure, d) / 2.0)
    series = sampled_series(panels, values)
    last = np.abs(series.coefficients[:, -3:]).sum(axis=1).max() + np.abs(series.tail[1:]).sum()
    missing = float(last / np.abs(values).max())
    error = contact.pressure_error + 2.0 * missing + FIELD_ROUNDING
    return DiskSeries(EDGE, series.times(-kappa)), error
