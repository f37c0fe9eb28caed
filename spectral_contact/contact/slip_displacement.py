r"""Radial displacement u_r in slip.

With the traction q, the inward displacement kappa g by the pressure, and the operator T
(docs/theory),

    -u_r(s) = kappa g - T q - beta q = (1/(pi s)) int_0^s t^2 E dt / sqrt(s^2 - t^2) - beta q,
    E(t) = kappa R(t) - G(t),
    R(t) = (2/t) int_0^t s p ds / sqrt(t^2 - s^2),     G(t) = int_t^1 q ds / sqrt(s^2 - t^2).

E is known from pressure and traction, in stick as in slip. In stick u_r is zero, which is the
tangential equation, so that only u_r in slip is computed. It takes E of all zones inside. The term
``beta q``, the displacement of the layer, is here and in `ContactSystem.masses`, which is for
stick. kappa and f are those of the system: without elastic coupling kappa is 1 there and f stands
for ``f / kappa``, so that displacements are ``u_r / kappa``. (The letter u alone is ``q/s`` in
other modules.)

Each slip zone is an annulus with two halves, whose panels are graded toward its boundaries: a
`GradedMesh` is the panels of one half, and `OffsetRadii` are radii given by offsets of ``z = s**2``
from an anchor, so that radii next to a boundary keep their digits. ``y = 1 - s**2`` is the
attribute `rest` of a `Radius`.
"""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from spectral_contact.contact.pressure_loads import load_outside, mean_inside
from spectral_contact.contact.resolution import (
    EPSILON_DEPTH,
    graded_space,
)
from spectral_contact.contact.tuning import (
    DISPLACEMENT_SMOOTHING,
    FIELD_ROUNDING,
)
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
from spectral_contact.spectral.graded import FAR_EXPANSION, FAR_NODES
from spectral_contact.spectral.parts import GradedMesh, OffsetRadii, z_difference
from spectral_contact.spectral.transforms import sampled_series

if TYPE_CHECKING:
    from spectral_contact.contact.normal import NormalContact
    from spectral_contact.spectral.annulus import Annulus
    from spectral_contact.spectral.contact_fields import KnownDisplacement


class StickZone(NamedTuple):
    """A stick zone, as a source of the displacement outside it.

    Attributes
    ----------
    outer : Radius
        Its outer boundary.
    parts : tuple of (OffsetRadii, ndarray)
        Quadrature of ``t^2 E dt`` over its parts: radii t, and ``t^2 E`` there times the weights.
    """

    outer: Radius
    parts: tuple[tuple[OffsetRadii, Array], ...]


class SlipZone(NamedTuple):
    """A slip zone: the annulus, the sign of its traction, and E at the sampling points.

    Attributes
    ----------
    annulus : Annulus
    sign : int
        +1 or -1, with ``q = sign f p``.
    residual : list of ndarray
        E on each half of the annulus.
    """

    annulus: Annulus
    sign: int
    residual: list[Array]

    @property
    def weighted_residual(self) -> list[Array]:
        """``t E`` at the sampling points t of each half."""
        return [
            np.sqrt(mesh.sampling().z) * residual
            for mesh, residual in zip(self.annulus.meshes, self.residual, strict=True)
        ]


class SlipFields(NamedTuple):
    """The displacement on every slip zone.

    Attributes
    ----------
    fields : list of AnnulusSeries
        A field for every slip zone.
    samples : list of ndarray
        Its values times the sign of the traction: negative where slip opposes traction.
    at_outer_ends : list of float
        The same at the outer end of every zone.
    largest : float
        The largest modulus of all values.
    unresolved : float
        Estimate of the error that sampling on finitely many points leaves in u_r: twice the last
        coefficients of the series of E and of u_r, as `GradedMesh.truncated` and `unresolved`
        measure them.
    """

    fields: list[AnnulusSeries]
    samples: list[Array]
    at_outer_ends: list[float]
    largest: float
    unresolved: float

    def since(self, before: KnownDisplacement, slip_zones: list[SlipZone]) -> SlipFields:
        """Return the displacement less that of before at the same radii, with this one's fields.

        Parameters
        ----------
        before : KnownDisplacement
        slip_zones : list of SlipZone
            Those of the fields.
        """
        samples = [
            sample - zone.sign * before.evaluate(zone.annulus.y)
            for zone, sample in zip(slip_zones, self.samples, strict=True)
        ]
        at_outer_ends = [
            value - zone.sign * float(before.evaluate(np.array([zone.annulus.outer.rest]))[0])
            for zone, value in zip(slip_zones, self.at_outer_ends, strict=True)
        ]
        largest = max(float(np.abs(values).max()) for values in samples)
        return self._replace(samples=samples, at_outer_ends=at_outer_ends, largest=largest)


def slip_displacement(
    stick_zones: list[StickZone],
    slip_zones: list[SlipZone],
    pressure: PressureField | ZonalField,
    beta: float,
    friction: float,
) -> SlipFields:
    """Return the displacement on every slip zone.

    Parameters
    ----------
    stick_zones, slip_zones : list
        Ordered outward.
    pressure : PressureField or ZonalField
    beta, friction : float
        Tangential compliance, and the friction of the system.
    """
    fields: list[AnnulusSeries] = []
    samples: list[Array] = []
    unresolved = 0.0
    for number, zone in enumerate(slip_zones):
        annulus = zone.annulus
        weighted = zone.weighted_residual
        p = pressure.evaluate(annulus.y) if beta > 0.0 else np.zeros(annulus.y.shape)
        layer_displacements = annulus.split(beta * zone.sign * friction * p)
        integrals = annulus.integrals(weighted, -1)
        series: list[LogSeries] = []
        zone_samples: list[Array] = []
        for mesh, half_residual, integral, layer_displacement in zip(
            annulus.meshes, weighted, integrals, layer_displacements, strict=True
        ):
            total = integral.copy()
            for stick_zone in _zones_inside(stick_zones, annulus.inner):
                total += _integral_at_samples(stick_zone, mesh)
            for inner_zone in slip_zones[:number]:
                for inner_mesh, values in zip(
                    inner_zone.annulus.meshes, inner_zone.weighted_residual, strict=True
                ):
                    total += abel_integral_on(mesh, inner_mesh, inner_mesh.expand(values), -1)
            displacement = layer_displacement - total / (pi * np.sqrt(mesh.sampling().z))
            series.append(sampled_series(mesh.panels, displacement))
            residual_error = mesh.truncated(half_residual, 0.5) / DISPLACEMENT_SMOOTHING
            unresolved = max(unresolved, residual_error + mesh.unresolved(series[-1]))
            zone_samples.append(zone.sign * displacement)
        fields.append(AnnulusSeries(annulus.inner, annulus.outer, series[0], series[1], power=0))
        samples.append(np.concatenate(zone_samples))
    at_outer_ends = [
        zone.sign * field.toward_outer.limit for zone, field in zip(slip_zones, fields, strict=True)
    ]
    largest = max(float(np.abs(values).max()) for values in samples)
    return SlipFields(fields, samples, at_outer_ends, largest, 2.0 * unresolved)


def _zones_inside(stick_zones: list[StickZone], radius: Radius) -> list[StickZone]:
    """Return the stick zones that lie inside a radius."""
    return [zone for zone in stick_zones if zone.outer.rest >= radius.rest]


def _integral_at_samples(zone: StickZone, mesh: GradedMesh) -> Array:
    """Integrate ``t^2 E dt / sqrt(s^2 - t^2)`` over a stick zone, at samples s of half a slip zone.

    The stick zone lies inside the slip zone. The outer half of a slip zone is at least its own
    width away from there, so that a polynomial in ``s**2`` through few points is right to rounding.
    """
    points = mesh.sampling()
    if mesh.sign > 0:  # the inner half
        return _integral_at(zone, points)
    reach = -mesh.extent
    nodes = OffsetRadii(mesh.boundary, reach * (1.0 + FAR_NODES) / 2.0)
    coefficients = FAR_EXPANSION @ _integral_at(zone, nodes)
    return np.asarray(
        chebyshev_sums(2.0 * points.offset / reach - 1.0, coefficients[:, None, None])[0]
    )


def _integral_at(zone: StickZone, points: OffsetRadii) -> Array:
    """Integrate ``t^2 E dt / sqrt(s^2 - t^2)`` over a stick zone that lies inside all points s."""
    total = np.zeros(len(points.offset))
    for sources, values in zone.parts:
        # s^2 - t^2 without cancellation: the gap between the anchors, and the offsets from them
        difference = -points.before(sources.anchor)[:, None] - sources.offset
        total += (1.0 / np.sqrt(difference)) @ values
    return total


def largest_displacement(stick_zones: list[StickZone], inner: Radius, outer: Radius) -> float:
    """Return the largest modulus on an annulus of the part of u_r that stick zones inside cause.

    The points are graded toward the inner boundary, where it is largest.
    """
    points = OffsetRadii(
        inner, z_difference(inner, outer) * np.exp(-np.linspace(0.0, EPSILON_DEPTH, 41))
    )
    total = np.zeros(len(points.offset))
    for zone in _zones_inside(stick_zones, inner):
        total += _integral_at(zone, points)
    return float(np.abs(total / (pi * np.sqrt(points.z))).max())


def free_displacement(
    contact: NormalContact, kappa: float, tolerance: float
) -> tuple[DiskSeries, float]:
    """Return ``-kappa g``, the displacement without any traction, and its relative error.

    ``g = (1/s) int_0^s r p dr`` is ``s`` times a function of y, which is sampled.

    Parameters
    ----------
    contact : NormalContact
        Normal contact with the pressure p.
    kappa : float
    tolerance : float
        Bound on the relative error of the displacement.
    """
    rate = 0.5 if contact.compliance == 0.0 else 1.0
    depth = max(-np.log(contact.compliance or 1.0), 0.0)
    panels = graded_space(depth, tolerance, rate).panels
    y = panels.sampling_distances
    load_inside = 1.0 / (2.0 * pi) - load_outside(contact.pressure, y)
    # near the centre the difference cancels: there g/s is half the mean of p inside s
    values = np.where(y < 0.5, load_inside / (1.0 - y), mean_inside(contact.pressure, y) / 2.0)
    series = sampled_series(panels, values)
    last_terms = np.abs(series.coefficients[:, -3:]).sum(axis=1).max()
    last_terms += np.abs(series.tail[1:]).sum()
    truncation_error = float(last_terms / np.abs(values).max())
    error = contact.pressure_error + 2.0 * truncation_error + FIELD_ROUNDING
    return DiskSeries(EDGE, series.times(-kappa)), error
