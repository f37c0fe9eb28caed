"""Estimates of the errors of a solution on any zones, with elastic coupling or without.

The *changes* of a solution are the contributions of the top two degrees of every panel, and of the
top degree alone (`FieldSolution.coarse_differences`). From them follow

- the errors of the fields, panel by panel: the change itself (`resolution`);
- bounds r of the error of the boundary residual, and by them those of the boundaries,
  ``|J^-1| r`` with J its Jacobian by the logits;
- the errors of approach and shear: their changes, and the effect of misplaced boundaries. In full
  stick with an unknown pressure they are energies of the changes.

Second-order terms, rounding, and the error that corrections with the factors of nearby boundaries
leave in the fields (`free_boundary.correct_to`) are added to all.

E is the residual of the tangential equation before the compliance is subtracted, and its *defect*
at a boundary b is the number that has to be added to E(b) for the traction to be continuous there
(`spectral.contact_system`). The *boundary residual* is minus the defect over ``kappa R`` there, the
value that stick prescribes for the half-integral G of the traction: a number without unit.
With tangential compliance the defects make the traction continuous; without it they are what makes
E(b) zero, so that the residual is ``E(b)/(kappa R)``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise, starmap
from math import inf, pi
from typing import TYPE_CHECKING, NamedTuple, cast

import numpy as np

from spectral_contact.contact.free_boundary import Iterate
from spectral_contact.contact.layout import NoBoundariesError, min_zone_width
from spectral_contact.contact.refine import SpaceSolution
from spectral_contact.contact.relative_changes import pressure_cancellation, relative_changes
from spectral_contact.contact.resolution import radius_errors
from spectral_contact.contact.slip_displacement import StickZone, largest_displacement
from spectral_contact.contact.tuning import (
    FIELD_ROUNDING,
    JACOBIAN_RANGE,
    NEGLIGIBLE_FRACTION,
    RIGID_TRACTION_ROUNDING,
    ROOT_EDGE_SAFETY,
    ROUNDING,
    TRACTION_ROUNDING,
)
from spectral_contact.contact.zone_solution import ZoneSolution
from spectral_contact.fields.series import Array, Radius
from spectral_contact.spectral.contact_system import ContactSystem
from spectral_contact.spectral.parts import OffsetRadii, z_difference
from spectral_contact.spectral.transforms import series_of
from spectral_contact.spectral.tuning import UNCORRECTED_COMPLIANCE
from spectral_contact.threads import cached_property

if TYPE_CHECKING:
    from spectral_contact.spectral.factored import CholeskyFactoredSystem


class FieldErrors(NamedTuple):
    """Estimates of the relative errors of p and of q/s, pointwise.

    Attributes
    ----------
    pressure, traction : float
        The largest ones on any panel.
    indicators : ndarray
        For every panel of every part the larger one of both errors.
    """

    pressure: float
    traction: float
    indicators: Array


def _field_errors(system: ContactSystem, values: Array, change: Array) -> FieldErrors:
    """Return the errors of the fields, from the change of the top two degrees."""
    root_is_shear = system.parameters.beta > 0.0
    last = len(system.parts) - 1
    # at an edge that sticks one field has a square root if only its equation has a compliance:
    # p if that is alpha, the traction if it is beta
    has_root = system.parts[last].sticks and (system.parameters.alpha > 0.0) != root_is_shear
    largest = [0.0, 0.0]  # of p and of q/s
    indicators = [np.zeros(len(part.degrees)) for part in system.parts]
    panel_changes = relative_changes(system, values, change)
    for field, relative in zip(system.fields, panel_changes, strict=True):
        panels = field.panels
        if has_root and field.part == last and field.is_shear == root_is_shear:
            # the mesh ends in a tail, polynomial in the distance: its error is lowered by no degree
            # of a panel, and is no indicator
            at_edge = abs(series_of(panels, field.coefficients(values)).at_ends()[-1])
            tail_change = np.abs(field.coefficients(change)[-panels.tail_terms :]).sum()
            root_error = ROOT_EDGE_SAFETY * float(tail_change / at_edge)
            largest[field.is_shear] = max(root_error, largest[field.is_shear])
        largest[field.is_shear] = max(largest[field.is_shear], float(relative.max()))
        indicator = indicators[field.part]
        np.maximum(indicator, relative, out=indicator)
    return FieldErrors(largest[0], largest[1], np.concatenate(indicators))


class ZoneEstimate:
    """The errors of a solution.

    Parameters
    ----------
    iterate : Iterate
        Boundaries, fields and Jacobian.
    pointwise : bool
        Whether the tolerance bounds the fields; else, in full stick with an unknown pressure, it
        bounds approach and shear.

    Attributes
    ----------
    values : ndarray
        The vector of the system for unit load.
    effects : list of Perturbation
        Effects of the top two degrees, and of the top one.
    changes : list of ndarray
        The changes of `values` by these effects, for unit load.
    field_errors : FieldErrors
        Estimates for p and q/s, from the changes alone.
    remaining : float
        Estimate of the relative error that corrections left of the fields.
    noise : float
        Error of integral quantities by rounding, and by corrections: NEGLIGIBLE_FRACTION of what
        these left of the fields.

    Raises
    ------
    NoBoundariesError
        If the solution is not finite.
    """

    def __init__(self, iterate: Iterate, *, pointwise: bool) -> None:
        solution = iterate.fields
        if not np.isfinite(solution.values).all():
            raise NoBoundariesError("the system has no solution that is finite")
        self.iterate = iterate
        self.pointwise = pointwise
        self.solution = solution
        self.remaining = iterate.remaining
        self.system = solution.system
        self.effects = solution.coarse_differences()
        self.values = solution.values * solution.approach
        self.changes = [solution.approach * effect.change for effect in self.effects]
        self.field_errors = _field_errors(self.system, self.values, self.changes[0])
        rounding = FIELD_ROUNDING if self.system.radii else ROUNDING
        if not (self.system.radii and self.system.pressure_known):
            rounding *= 2.0
        self.noise = rounding + NEGLIGIBLE_FRACTION * self.remaining

    @cached_property
    def inverse_moduli(self) -> Array:
        """Moduli of the inverse Jacobian, ``|d logit / d residual|``."""
        return np.asarray(np.abs(np.linalg.inv(self.iterate.jacobian)))

    @cached_property
    def boundary_error(self) -> float:
        """The relative error of the fields by the errors of the boundaries.

        It is twice the Newton step of the logits. With the step above rounding and beta > 0 it is
        twice the step over the width of the narrowest zone, in which the fields may change by their
        own size, or the size of `FieldSolution.boundary_perturbation` if that is smaller.
        """
        residual = np.abs(self.solution.boundary_residual)
        bound = 2.0 * float((self.inverse_moduli @ residual).max(initial=0.0))
        if bound > 2.0 * ROUNDING and self.system.parameters.beta > 0.0:
            perturbation = self.solution.boundary_perturbation
            size = self.solution.relative_size(perturbation.change)
            return min(size, bound / min_zone_width(self.iterate.logits))
        return bound

    @cached_property
    def second_order(self) -> float:
        """The square of the error of the fields.

        Quantities whose error is of second order are given no smaller estimate, even if their
        changes cancel.
        """
        error = float(self.field_errors.indicators.max()) + self.remaining + TRACTION_ROUNDING
        return error * error  # a power would overflow where the traction nearly vanishes

    @cached_property
    def residual_bound(self) -> Array:
        """Bounds of the errors of the boundary residual."""
        changes = np.max([np.abs(effect.boundary_residual) for effect in self.effects], axis=0)
        changes += np.abs(self.solution.boundary_residual)
        return np.asarray(2.0 * changes + self.second_order + self.noise + self.remaining)

    @cached_property
    def logit_errors(self) -> Array:
        """Estimates of the errors of the logits, ``|J^-1| r`` and a term of second order.

        The Jacobian changes by its own size over JACOBIAN_RANGE of the width of the narrower zone
        at a boundary.
        """
        logits = self.iterate.logits
        if not len(logits):
            return np.zeros(0)
        errors = self.inverse_moduli @ self.residual_bound
        errors += float(np.finfo(float).eps) * np.abs(logits)
        widths = np.concatenate([[inf], np.diff(logits), [inf]])
        narrower = np.minimum(widths[1:], widths[:-1])
        return np.asarray(errors * (1.0 + errors / (JACOBIAN_RANGE * narrower)))

    def with_errors(self) -> SpaceSolution[ZoneSolution]:
        """Return the solution with its errors, as `refine` wants it."""
        system = self.system
        fields = self.field_errors
        integral_floor = self.second_order + self.noise
        if not system.pressure_known:
            integral_floor += self.boundary_error
        field_floor = self.remaining + self.boundary_error
        pressure_rounding = FIELD_ROUNDING + ROUNDING * pressure_cancellation(system, self.values)
        pressure_error = fields.pressure + field_floor + pressure_rounding
        traction_error = max(fields.traction, self._traction_rounding) + field_floor
        boundary_errors = tuple(
            radius_errors(float(error), radius)
            for error, radius in zip(self.logit_errors, system.radii, strict=True)
        )
        stick_zones, residual_error = self._displacement_source()
        pressures, shears = system.series(self.values)
        value = ZoneSolution(
            approach=self.solution.approach,
            total_shear=system.total_shear(self.values),
            stick_zones=stick_zones,
            approach_error=max(abs(effect.approach) for effect in self.effects) + integral_floor,
            shear_error=self._shear_change() + integral_floor * self._shear_cancellation,
            pressure_error=pressure_error,
            traction_error=traction_error,
            radius_error=boundary_errors[0][0] if boundary_errors else 0.0,
            zones_error=largest_boundary_error(system.radii, boundary_errors),
            slip_width_error=_slip_width_error(system, boundary_errors),
            residual_error=residual_error,
            jacobian=self.iterate.jacobian,
            pressures=pressures,
            shears=shears,
            system=system,
            solution=np.column_stack([self.values, *self.changes]),
            logit_errors=self.logit_errors,
        )
        # no degree lowers the error of the corrections
        indicators = np.where(fields.indicators <= self.remaining, 0.0, fields.indicators)
        error = max(pressure_error, traction_error)
        solution = SpaceSolution(value, error, indicators, system.unknowns)
        if system.symmetric and not system.pressure_known:
            return self._with_energies(solution)
        return solution

    @property
    def _traction_rounding(self) -> float:
        """The rounding of q/s at the centre, where it is largest.

        It is larger where a small compliance hardly regularises the traction of a disk: in full
        stick, or under a known pressure on the one stick disk.
        """
        radii = self.system.radii
        compliance = self.system.parameters.beta
        if radii:
            compliance /= radii[0].value
        is_disk = len(radii) <= (1 if self.system.pressure_known else 0)
        rigid = is_disk and compliance < UNCORRECTED_COMPLIANCE
        return RIGID_TRACTION_ROUNDING if rigid else TRACTION_ROUNDING

    @property
    def _shear_cancellation(self) -> float:
        """By how much more of the shear rounding is where it may vanish, as q changes sign."""
        if not self.system.displacement_coefficients:
            return 1.0
        bound = self.system.parameters.friction  # of the shear under unit load
        return max(bound / abs(self.system.total_shear(self.values)), 1.0)

    def _shear_change(self) -> float:
        """Return the relative error of the shear by the changes and by the boundaries.

        Under a known pressure the error of its load in slip is added. The errors of the boundary
        residual, as defects, change the shear by its response to them. Without tangential
        compliance the fields do not respond; their error is then bounded by the traction that a
        defect on all of the disk inside b would cause. With an unknown pressure the shear is
        stationary in the boundaries, and their error enters squared.
        """
        total_shear = self.system.total_shear
        solution = self.solution
        changes = max(abs(total_shear(change)) for change in self.changes)
        if self.system.pressure_known:
            bound = self.residual_bound
            response = self.system.shear_row @ solution.factors.defect_responses
            if self.system.parameters.beta == 0.0:
                residuals = [np.abs(effect.boundary_residual) for effect in self.effects]
                bound = np.max(residuals, axis=0) + 2.0 * np.abs(solution.boundary_residual)
                response = pi * np.array([radius.square for radius in self.system.radii])
            defects = solution.approach * np.abs(solution.stick_target) * bound
            changes += self.system.slip_shear_error
            return (changes + float(np.abs(response) @ defects)) / abs(total_shear(self.values))
        distances = np.array([radius.rest for radius in self.system.radii])
        curvature = 2.0 * float((self.logit_errors**2 * distances).max(initial=0.0))
        return changes / abs(total_shear(self.values)) + curvature

    def _with_energies(self, solution: SpaceSolution[ZoneSolution]) -> SpaceSolution[ZoneSolution]:
        """Return full stick with the errors of approach and shear as energies of the changes.

        The error of the approach is the energy of that of the fields; the error of the shear is the
        product of it with that of the dual solution. Neither is small by cancellation.
        """
        system = self.system
        fields = self.solution
        factors = cast("CholeskyFactoredSystem", fields.factors)
        energies = factors.energies(fields.values)
        dual_energies = factors.energies(factors.step(system.shear_row))
        # by panels, the tail last
        of_approach = energies.sum(axis=0) / fields.load_integral(fields.values)
        products = np.sqrt(energies * dual_energies).sum(axis=0)
        of_shear = products / abs(system.total_shear(fields.values))
        approach_error, field_shear_error = (
            float(panels.sum()) + self.noise for panels in (of_approach, of_shear)
        )
        # the shear is that for unit load, and has the error of the approach, too
        shear_error = approach_error + field_shear_error + 2.0 * ROUNDING
        value = replace(solution.value, approach_error=approach_error, shear_error=shear_error)
        solution = replace(solution, value=value)
        if self.pointwise:
            return solution
        # of all panels but the tail, which no degree refines
        indicators = (of_approach + of_shear)[:-1]
        return replace(solution, error=max(approach_error, shear_error), indicators=indicators)

    def _displacement_source(self) -> tuple[list[StickZone], float]:
        """Return the integrals of E over the stick zones, and the largest error of E by them.

        E in stick drives the displacement in slip. Its error is estimated by the displacement that
        its change makes at the ends of slip zones, and by the steps of E and of ``beta q`` at the
        boundaries.
        """
        system = self.system
        solution = self.solution
        if not any(system.states):
            return [], 0.0
        scale = solution.approach
        defects = scale * np.column_stack([solution.defects, self.effects[0].defects])
        columns = np.column_stack([self.values, self.changes[0]])
        residual = system.pointwise_residual(columns, np.array([scale, 0.0]), defects).tangential
        stick_zones = stick_zone_sources(system, [values[:, 0] for values in residual])
        changes = stick_zone_sources(system, [values[:, 1] for values in residual])
        perturbation = solution.boundary_perturbation
        jump_sizes = np.abs(system.jump_rows @ perturbation.change)
        steps = np.abs(perturbation.defects) + system.parameters.beta * jump_sizes
        largest = max(
            largest_displacement(changes, *ends)
            for state, ends in zip(system.states[1:], pairwise(system.bounds[1:]), strict=True)
            if state
        )
        return stick_zones, largest + scale * float(steps.max(initial=0.0))


def _slip_width_error(system: ContactSystem, errors: Sequence[tuple[float, float]]) -> float:
    """Return the largest relative error of ``b^2 - a^2`` for a slip zone between a and b."""
    largest = 0.0
    end_errors = [0.0, *_errors_of_squares(system.radii, errors), 0.0]
    for i in np.flatnonzero(system.states).tolist():
        width = z_difference(*system.bounds[i : i + 2])
        largest = max(largest, sum(end_errors[i : i + 2]) / width if width > 0.0 else inf)
    return largest


def _errors_of_squares(
    radii: Sequence[Radius], errors: Sequence[tuple[float, float]]
) -> list[float]:
    """Return the errors of ``b**2`` for boundaries b, from those of b and of ``1 - b``.

    The lesser one of both: which is more accurate depends on the end that b is next to.
    """
    return [
        2.0 * radius.value * min(radius.value * radius_error, radius.from_edge * distance_error)
        for radius, (radius_error, distance_error) in zip(radii, errors, strict=True)
    ]


def stick_zone_sources(system: ContactSystem, residual: Sequence[Array]) -> list[StickZone]:
    """Return the quadrature of ``t^2 E dt`` over the stick zones, from E at the nodes."""
    parts: dict[int, list[tuple[OffsetRadii, Array]]] = {}
    # E is given up to the outermost part that sticks
    operators = system.operators
    by_part = zip(system.parts, operators.nodes, operators.shear_weights, residual, strict=False)
    for part, nodes, weights, values in by_part:
        if part.state == 0:
            # `shear_weights` are those of t^2 dt / pi. Outside the zone the kernel is smooth: the
            # sum over the nodes becomes a sum over the samples, which are fewer
            weighted = nodes.interpolate_transpose((pi * weights * values)[:, None])[:, 0]
            parts.setdefault(part.zone, []).append((part.mesh.points(nodes.samples), weighted))
    return [StickZone(system.bounds[zone + 1], tuple(pieces)) for zone, pieces in parts.items()]


def largest_boundary_error(
    radii: tuple[Radius, ...], errors: tuple[tuple[float, float], ...]
) -> float:
    """Return the largest relative error of a boundary b or of its distance ``1 - b``.

    Infinite where the errors of its ends exceed the width of a zone between boundaries.
    """
    square_errors = _errors_of_squares(radii, errors)
    widths = starmap(z_difference, pairwise(radii))
    if any(width <= sum(ends) for width, ends in zip(widths, pairwise(square_errors), strict=True)):
        return inf
    return max(map(max, errors), default=0.0)
