"""What the solution on any zones is worth: the one assessment, with elastic coupling or without."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise, starmap
from math import inf, pi
from typing import TYPE_CHECKING, NamedTuple, cast

import numpy as np

from spectral_contact.contact.free_boundary import (
    LEAST_CONTRACTION,
    FieldSolution,
    Iterate,
    Perturbation,
)
from spectral_contact.contact.layout import Layout, NoBoundariesError, ZoneNumbers
from spectral_contact.contact.refine import Attempt
from spectral_contact.contact.resolution import (
    CENTRE_ROUNDS,
    FIELD_ROUNDING,
    LEAST_RATE,
    MOST_ROUNDS,
    ROUNDING,
    SAFETY,
    TRACTION_ROUNDING,
    boundary_error,
    decay_rates,
    expected_error,
    share_of_change,
)
from spectral_contact.contact.slip_displacement import Slipping, Stuck, largest_displacement
from spectral_contact.contact.zone_spaces import leading_depth, rounding_depth
from spectral_contact.fields.series import Array, LogSeries, Radius
from spectral_contact.spectral.contact_system import ContactSystem
from spectral_contact.spectral.panels import DiscreteSpace
from spectral_contact.spectral.parts import OffsetRadii, gap
from spectral_contact.spectral.transforms import series_of
from spectral_contact.spectral.tuning import UNCORRECTED_COMPLIANCE
from spectral_contact.threads import cached_property

if TYPE_CHECKING:
    from spectral_contact.spectral.factored import Symmetric


class FieldErrors(NamedTuple):
    """Estimates of the relative errors of p and of q/s, pointwise.

    Attributes
    ----------
    pressure, traction : float
    indicators, rates : ndarray
        What every panel of every part contributes, and by what factor one more degree lowers it.
    """

    pressure: float
    traction: float
    indicators: Array
    rates: Array


def _field_errors(
    spaces: list[DiscreteSpace], system: ContactSystem, values: Array, change: Array
) -> FieldErrors:
    """Return the errors of the fields, from the change that a coarser space makes."""
    alpha, beta, _, _ = system.parameters
    last = len(system.parts) - 1
    # at an edge that sticks the field of the only compliance has a root
    rooted = system.parts[last].sticks and (alpha > 0.0) != (beta > 0.0)
    largest = [0.0, 0.0]
    indicators = [np.zeros(len(space.degrees)) for space in spaces]
    slowest = [np.full(len(space.degrees), LEAST_RATE) for space in spaces]
    shares = relative_changes(system, change, sizes_of(system, values))
    for field, share in zip(system.fields, shares, strict=True):
        k, panels = field.part, field.panels
        if rooted and k == last and field.is_shear == (beta > 0.0):
            at_end = abs(series_of(panels, field.coefficients(values)).at_ends()[-1])
            lost = np.abs(field.coefficients(change)[-panels.tail_terms :]).sum()
            # no degree of a panel helps
            largest[field.is_shear] = max(_ROOT * float(lost / at_end), largest[field.is_shear])
        rates = decay_rates(spaces[k], field.coefficients(values))
        if system.pressure_known and not system.radii:
            rates[-1] = max(rates[-1], _EDGE_RATE)
        errors = expected_error(share, rates)
        largest[field.is_shear] = max(largest[field.is_shear], float(errors.max()))
        np.maximum(indicators[k], errors, out=indicators[k])
        np.maximum(slowest[k], rates, out=slowest[k])
    return FieldErrors(largest[0], largest[1], np.concatenate(indicators), np.concatenate(slowest))


def sizes_of(system: ContactSystem, values: Array) -> list[Array]:
    """Return what changes of the unknown fields are relative to, at the ends of the panels.

    Where p or q/s changes sign in full stick it is the root of the sum of both squares.
    """
    ends = [
        series_of(field.panels, field.coefficients(values)).at_ends() for field in system.fields
    ]
    full_stick = not (system.pressure_known or system.radii)
    if full_stick and any((end * end[0] <= 0.0).any() for end in ends):
        pressure, shear = ends
        kappa = system.parameters.kappa
        ends = [np.hypot(pressure, shear), np.hypot(shear, kappa * pressure)]
    return ends


def relative_changes(system: ContactSystem, change: Array, sizes: list[Array]) -> list[Array]:
    """Return a change of the unknown fields on every panel, relative to their sizes there."""
    alpha, beta, _, _ = system.parameters
    # in a part where one field is singular at the edge, both are their leading terms deep down
    singular = {field.part for field in system.fields if field.panels.power}
    shares = []
    for field, size in zip(system.fields, sizes, strict=True):
        part = system.parts[field.part]
        reach = part.family.reach
        leading = inf
        if field.part in singular:
            leading = leading_depth(alpha, beta, reach)
        known = inf
        if part.boundary >= 0:
            known = rounding_depth(part.family.boundary, reach)
        coefficients = field.coefficients(change)
        shares.append(
            share_of_change(field.panels, coefficients, size, leading=leading, known=known)
        )
    return shares


def relative_size(fields: FieldSolution, change: Array) -> float:
    """Return the largest relative change of the fields on any panel."""
    sizes = sizes_of(fields.system, fields.values)
    shares = relative_changes(fields.system, change, sizes)
    return max(float(share.max()) for share in shares)


#: Error at an end with a root there, relative to the change of the tail: 1.9, measured.
_ROOT = 2.5
#: At the edge q has terms ``y ln y``, which fall like a power of the degree in the last panel:
#: rates seen are too fast. Errors are 0.75 of estimates at most, of 870 scenes and tolerances.
_EDGE_RATE = 0.5
#: By how much of itself the Jacobian changes over the width of a zone.
JACOBIAN_CURVATURE = 8.0
#: What rounding leaves of approach and shear, with boundaries, under a pressure that is given, and
#: without boundaries. Of 60 random scenes solved as one disk and as zones at 1e-12 the shears
#: differ by 9.6 ROUNDING or less, half of them by 0.1.
_NOISE, _KNOWN_NOISE, _STUCK_NOISE = 2.0 * FIELD_ROUNDING, 12.0 * ROUNDING, 2.0 * ROUNDING


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ZoneSolution(ZoneNumbers):
    """The solution on any zones, before it is held against the friction law.

    Attributes
    ----------
    stuck : list of Stuck
        Quadrature of ``t^2 E dt`` over the stick zones, for the displacement outside them.
    loose : float
        By what share of a slip zone its ends may be off, at the most.
    stray : float
        Estimate of the largest error of E.
    jacobian : ndarray
        Derivatives of the boundary residual by the logits.
    pressures, shears : list of LogSeries, dict of LogSeries
        p on the disk and toward both ends of every zone around it, and q/s where they stick.
    system : ContactSystem
    solution : ndarray, shape (unknowns, 3)
        The vector of the system, and what the top two degrees and the top one contribute to it.
    shifts : ndarray, shape (boundaries,)
        How far the boundaries may be off, as logits.
    """

    stuck: list[Stuck]
    loose: float
    stray: float
    jacobian: Array
    pressures: list[LogSeries]
    shears: dict[int, LogSeries]
    system: ContactSystem
    solution: Array
    shifts: Array

    @property
    def layout(self) -> Layout:
        """The zones, as a like scene may begin with them."""
        return Layout(
            tuple(one.logit for one in self.system.radii), self.system.states, self.jacobian
        )

    @property
    def slipping(self) -> tuple[list[Slipping], float]:
        """The slip zones with E at their sampling points, and the largest change of E there.

        The displacement changes by a quarter of that at most; E is seen at these points alone.
        """
        found, lost = [], 0.0
        for zone, state in enumerate(self.system.states):
            if state:
                annulus = self.system.slip_annulus(zone)
                each = self.system.residual_in_slip(self.solution[:, :2], annulus)
                found.append(Slipping(annulus, state, [one[:, 0] for one in each]))
                lost = max(lost, *(float(np.abs(one[:, 1]).max()) for one in each))
        return found, lost


class ZoneEstimate:
    """The errors of a solution.

    Parameters
    ----------
    iterate : Iterate
        Boundaries, fields and Jacobian.
    spaces : list of DiscreteSpace
    pointwise : bool
        Whether the fields are wanted, else approach and shear alone.

    Raises
    ------
    NoBoundariesError
        If the solution is not finite.
    """

    def __init__(self, iterate: Iterate, spaces: list[DiscreteSpace], *, pointwise: bool) -> None:
        fields = iterate.fields
        if not np.isfinite(fields.values).all():
            raise NoBoundariesError("the system has no solution that is finite")
        self.iterate, self.pointwise = iterate, pointwise
        self.solution, self.remaining = fields, iterate.remaining
        self.system, self.effects = fields.system, fields.coarse_differences()
        self.whole = fields.values * fields.approach
        self.moved = [fields.approach * effect.change for effect in self.effects]
        self.fields = _field_errors(spaces, self.system, self.whole, self.moved[0])
        self.noise = _STUCK_NOISE
        if self.system.radii:
            self.noise = _KNOWN_NOISE if self.system.pressure_known else _NOISE
        self.noise += LEAST_CONTRACTION * self.remaining

    @cached_property
    def end_perturbation(self) -> Perturbation:
        """Twice the first-order change of the fields by the boundary residual.

        Zero without tangential compliance, where E(b) is zero whatever the boundaries.
        """
        share = 2.0 if self.system.parameters.beta > 0.0 else 0.0
        return self.solution.boundary_perturbation(share)

    @cached_property
    def inverse(self) -> Array:
        """Moduli of the inverse Jacobian: how far a residual moves the boundaries."""
        return np.asarray(np.abs(np.linalg.inv(self.iterate.jacobian)))

    @cached_property
    def boundary_error(self) -> float:
        """The relative error of the fields by where the boundaries are."""
        residual = np.abs(self.solution.boundary_residual)
        step = float((self.inverse @ residual).max(initial=0.0))
        if step > ROUNDING and self.system.parameters.beta > 0.0:
            return min(relative_size(self.solution, self.end_perturbation.change), 2.0 * step)
        # q/s of one disk changes by half of that or, of 120 scenes, by 16 times the residual: at a
        # small disk the first is twice the error, else both are rounding
        one_disk = self.system.pressure_known and len(self.system.radii) == 1
        return step * (1.0 if one_disk else 2.0)

    @cached_property
    def second_order(self) -> float:
        """The square of the error: quantities of second order are hardly better than that."""
        error = float(self.fields.indicators.max()) + self.remaining
        return (error + self.boundary_error + TRACTION_ROUNDING) ** 2

    @cached_property
    def residual_bound(self) -> Array:
        """Bounds of the errors of the boundary residual."""
        changes = np.max([np.abs(effect.boundary_residual) for effect in self.effects], axis=0)
        bound = 2.0 * SAFETY * LEAST_RATE * changes
        bound += self.second_order + self.noise + self.remaining
        return np.asarray(bound + 2.0 * np.abs(self.solution.boundary_residual))

    @cached_property
    def shifts(self) -> Array:
        """How far the boundaries may be off, as logits."""
        logits = self.iterate.logits
        if not len(logits):
            return np.zeros(0)
        shifts = self.inverse @ self.residual_bound + float(np.finfo(float).eps) * np.abs(logits)
        # the Jacobian changes within the width of a zone, that of a narrow one next to the onset
        widths = np.concatenate([[inf], np.diff(logits), [inf]])
        narrower = np.minimum(widths[1:], widths[:-1])
        return np.asarray(shifts * (1.0 + JACOBIAN_CURVATURE * shifts / narrower))

    def attempt(self) -> Attempt[ZoneSolution]:
        """Return the solution with its errors."""
        system, fields = self.system, self.fields
        known = self.second_order + self.noise
        if not system.pressure_known:
            known += self.boundary_error
        left = self.remaining + self.boundary_error
        rounding = TRACTION_ROUNDING * self._rounds
        errors = fields.pressure + left + FIELD_ROUNDING, fields.traction + left + rounding
        boundary_errors = tuple(
            boundary_error(float(d), r) for d, r in zip(self.shifts, system.radii, strict=True)
        )
        stuck, stray = self._displacements()
        pressures, shears = system.series(self.whole)
        value = ZoneSolution(
            approach=self.solution.approach,
            total_shear=system.total_shear(self.whole),
            stuck=stuck,
            approach_error=max(abs(one.approach) for one in self.effects) + known,
            shear_error=self._sheared() + known,
            pressure_error=errors[0],
            traction_error=errors[1],
            radius_error=max((one[0] for one in boundary_errors[:1]), default=0.0),
            zones_error=zones_error(system.radii, boundary_errors),
            loose=_loosest(system, boundary_errors),
            stray=stray,
            jacobian=self.iterate.jacobian,
            pressures=pressures,
            shears=shears,
            system=system,
            solution=np.column_stack([self.whole, *self.moved]),
            shifts=self.shifts,
        )
        # no degree lowers what rounding leaves
        fields.indicators[fields.indicators <= self.remaining] = 0.0
        attempt = Attempt(value, max(errors), fields.indicators, fields.rates, system.unknowns)
        return (
            self._by_energies(attempt)
            if system.symmetric and not system.pressure_known
            else attempt
        )

    @property
    def _rounds(self) -> float:
        """By how much more q/s rounds at the centre than elsewhere."""
        (alpha, beta, _, _), radii = self.system.parameters, self.system.radii
        share = beta / radii[0].value if radii else beta
        if share < UNCORRECTED_COMPLIANCE and len(radii) == int(self.system.pressure_known):
            # under still less compliance a disk loses less
            return MOST_ROUNDS if share > UNCORRECTED_COMPLIANCE**4 or not radii else CENTRE_ROUNDS
        return 1.0 if radii or (self.system.pressure_known and alpha > 0.0) else CENTRE_ROUNDS

    def _sheared(self) -> float:
        """Return the relative error of the shear by changes, and by how far boundaries are off."""
        shear, solution = self.system.total_shear, self.solution
        changes = max(abs(shear(one)) for one in self.moved)
        if self.system.pressure_known:
            bound = self.residual_bound
            response = self.system.shear_row @ solution.factors.responses
            if self.system.parameters.beta == 0.0:  # nothing responds: what all inside would bear
                changed = [np.abs(effect.boundary_residual) for effect in self.effects]
                bound = np.max(changed, axis=0) + 2.0 * np.abs(solution.boundary_residual)
                response = pi * np.array([radius.square for radius in self.system.radii])
            defects = solution.approach * np.abs(solution.drive) * bound
            return (changes + float(np.abs(response) @ defects)) / abs(shear(self.whole))
        rest = np.array([one.rest for one in self.system.radii])
        bend = 2.0 * float((self.shifts**2 * rest).max(initial=0.0))
        return changes / abs(shear(self.whole)) + bend

    def _by_energies(self, attempt: Attempt[ZoneSolution]) -> Attempt[ZoneSolution]:
        """Return full stick with the errors of approach and shear as energies of changes.

        That of the shear is a product with its dual: no accident makes either small.
        """
        solution, system, rates = self.solution, self.system, attempt.rates**2
        factors = cast("Symmetric", solution.factors)
        energies = factors.energies(solution.values)
        dual = factors.energies(factors.step(system.shear_row))
        raised = energies.sum(axis=0) / solution.load_integral(solution.values)
        products = np.sqrt(energies * dual).sum(axis=0)
        sheared = products / abs(system.total_shear(solution.values))
        errors = [float(one[:-1] @ rates + one[-1]) + self.noise for one in (raised, sheared)]
        value = replace(
            attempt.value, approach_error=errors[0], shear_error=sum(errors) + _STUCK_NOISE
        )
        attempt = replace(attempt, value=value)
        if self.pointwise:
            return attempt
        error, indicators = max(value.approach_error, value.shear_error), raised + sheared
        return replace(attempt, error=error, indicators=indicators[:-1], rates=rates)

    def _displacements(self) -> tuple[list[Stuck], float]:
        """Return what the slip zones see of E in stick, and the most that errors make there."""
        system, solution = self.system, self.solution
        if not any(system.states):
            return [], 0.0
        scale = solution.approach
        defects = scale * np.column_stack([solution.defects, self.effects[0].defects])
        values, approach = np.column_stack([self.whole, self.moved[0]]), np.array([scale, 0.0])
        residual = system.pointwise_residual(values, approach, defects).tangential
        whole, lost = (_stuck(system, [values[:, k] for values in residual]) for k in (0, 1))
        # at the boundaries E and q have steps
        jumps = np.abs(system.jump_rows @ self.end_perturbation.change)
        steps = np.abs(self.end_perturbation.defects) + system.parameters.beta * jumps
        largest = max(
            largest_displacement(lost, *ends)
            for state, ends in zip(system.states[1:], pairwise(system.bounds[1:]), strict=True)
            if state
        )
        if system.pressure_known and len(system.radii) == 1:  # measured of one disk alone
            largest *= float(self.fields.rates[np.argmax(self.fields.indicators)])
        stray = largest + scale * float(steps.max(initial=0.0))
        return whole, SAFETY * stray


def _loosest(system: ContactSystem, errors: Sequence[tuple[float, float]]) -> float:
    """Return by what share of a slip zone errors of its ends may move them, at the most."""
    bounds, loosest = system.bounds, 0.0
    shifts = [0.0, *_unsure(system.radii, errors), 0.0]
    for i in np.flatnonzero(system.states).tolist():
        width = gap(*bounds[i : i + 2])
        loosest = max(loosest, (shifts[i] + shifts[i + 1]) / width if width > 0.0 else inf)
    return loosest


def _unsure(radii: Sequence[Radius], errors: Sequence[tuple[float, float]]) -> list[float]:
    """Return how far boundaries may be off in ``s**2``, from errors as `zones_error` has them."""
    each = zip(radii, errors, strict=True)
    return [min(2.0 * at.square * own, at.rest * edge) for at, (own, edge) in each]


def _stuck(system: ContactSystem, misfit: Sequence[Array]) -> list[Stuck]:
    """Return the quadrature of ``t^2 E dt`` over the stick zones."""
    parts: dict[int, list[tuple[OffsetRadii, Array]]] = {}
    # farther out than the last that sticks E is not known
    each = zip(
        system.parts, system.operators.nodes, system.operators.shear_weights, misfit, strict=False
    )
    for part, nodes, weights, missed in each:
        if part.state == 0:
            # as seen from outside what is smooth is gathered at the samples
            weighted = nodes.interpolate_transpose((pi * weights * missed)[:, None])[:, 0]
            parts.setdefault(part.zone, []).append((part.family.points(nodes.samples), weighted))
    return [Stuck(system.bounds[zone + 1], tuple(own)) for zone, own in parts.items()]


def zones_error(radii: tuple[Radius, ...], errors: tuple[tuple[float, float], ...]) -> float:
    """Return the largest of the boundaries' errors; infinite if a zone may not be there.

    They are relative, from the centre and from the edge.
    """
    unsure = _unsure(radii, errors)
    widths = starmap(gap, pairwise(radii))
    if any(width <= sum(off) for width, off in zip(widths, pairwise(unsure), strict=True)):
        return inf
    return max(map(max, errors), default=0.0)
