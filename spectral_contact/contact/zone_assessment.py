"""What the solution on any zones is worth: the one assessment, with elastic coupling or without."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise, starmap
from math import inf, pi
from typing import TYPE_CHECKING, NamedTuple, cast

import numpy as np

from spectral_contact.contact.layout import Layout, NoBoundariesError, ZoneNumbers
from spectral_contact.contact.refine import Attempt
from spectral_contact.contact.resolution import (
    CENTRE_ROUNDS,
    FIELD_ROUNDING,
    LEAST_RATE,
    LEFT,
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
from spectral_contact.spectral.panels import Resolution
from spectral_contact.spectral.parts import Points, gap
from spectral_contact.spectral.regularised import HARMLESS
from spectral_contact.spectral.transforms import series_of
from spectral_contact.threads import cached_property

if TYPE_CHECKING:
    from spectral_contact.contact.zone_newton import Effect, ZoneState
    from spectral_contact.contact.zone_problem import FreeBoundaryProblem
    from spectral_contact.spectral.factored import Symmetric


class FieldErrors(NamedTuple):
    """Estimates for p and for q/s; what every panel adds, and its fall with one more degree."""

    pressure: float
    traction: float
    indicators: Array
    rates: Array


def _field_errors(
    spaces: list[Resolution], system: ContactSystem, whole: Array, change: Array
) -> FieldErrors:
    """Return what the change of a solution tells of the errors of its fields."""
    (alpha, beta, _, _), last = system.parameters, len(system.parts) - 1
    # at an edge that sticks the field of the only compliance has a root
    rooted = system.parts[last].state == 0 and (alpha > 0.0) != (beta > 0.0)
    largest = [0.0, 0.0]
    indicators = [np.zeros(len(one.degrees)) for one in spaces]
    slowest = [np.full(len(one.degrees), LEAST_RATE) for one in spaces]
    shares = shares_of(system, change, sizes_of(system, whole))
    for one, share in zip(system.fields, shares, strict=True):
        k, shear = one.part, one.is_shear
        if rooted and k == last and shear == (beta > 0.0):
            at_end = abs(series_of(one.panels, one.coefficients(whole)).at_ends()[-1])
            lost = np.abs(one.coefficients(change)[-one.panels.tail_terms :]).sum()
            # no degree of a panel helps
            largest[shear] = max(_ROOT * float(lost / at_end), largest[shear])
        rates = decay_rates(spaces[k], one.coefficients(whole))
        if system.pressure_known and not system.radii:
            rates[-1] = max(rates[-1], _EDGE_RATE)
        errors = expected_error(share, rates)
        largest[shear] = max(largest[shear], float(errors.max()))
        np.maximum(indicators[k], errors, out=indicators[k])
        np.maximum(slowest[k], rates, out=slowest[k])
    return FieldErrors(largest[0], largest[1], np.concatenate(indicators), np.concatenate(slowest))


def sizes_of(system: ContactSystem, values: Array) -> list[Array]:
    """Return what changes of the fields are relative to, at the ends of the panels.

    Where p or q/s changes sign in full stick it is the root of the sum of both squares.
    """
    ends = [series_of(one.panels, one.coefficients(values)).at_ends() for one in system.fields]
    if not (system.pressure_known or system.radii) and any(
        (one * one[0] <= 0.0).any() for one in ends
    ):
        ends = [np.hypot(*ends), np.hypot(ends[1], system.parameters.kappa * ends[0])]
    return ends


def shares_of(system: ContactSystem, change: Array, sizes: list[Array]) -> list[Array]:
    """Return a change of the fields on every panel, relative to their sizes there."""
    alpha, beta, _, _ = system.parameters
    singular = {one.part for one in system.fields if one.panels.power}
    shares = []
    for one, size in zip(system.fields, sizes, strict=True):
        part = system.parts[one.part]
        reach = part.family.reach
        leading = leading_depth(alpha, beta, reach) if one.part in singular else inf
        known = inf if part.boundary < 0 else rounding_depth(part.family.boundary, reach)
        shares.append(
            share_of_change(
                one.panels, one.coefficients(change), size, leading=leading, known=known
            )
        )
    return shares


#: Error at an end with a root there, relative to the change of the tail: 1.9, measured.
_ROOT = 2.5
#: At the edge q has terms ``y ln y``, which fall like a power of the degree in the last panel:
#: rates seen are too fast. Errors are 0.75 of estimates at most, of 870 scenes and tolerances.
_EDGE_RATE = 0.5
#: What slopes change by over the width of a zone, of themselves.
BENT = 8.0
#: What rounding leaves of approach and shear, with boundaries, under a pressure that is given, and
#: without boundaries. Of 60 random scenes solved as one disk and as zones at 1e-12 the shears
#: differ by 9.6 ROUNDING or less, half of them by 0.1.
_NOISE, _GIVEN_NOISE, _STUCK_NOISE = 2.0 * FIELD_ROUNDING, 12.0 * ROUNDING, 2.0 * ROUNDING


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
    slopes : ndarray
        By how much the conditions of the boundaries rise with their logits.
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
    slopes: Array
    pressures: list[LogSeries]
    shears: dict[int, LogSeries]
    system: ContactSystem
    solution: Array
    shifts: Array

    @property
    def layout(self) -> Layout:
        """The zones, as a like scene may begin with them."""
        return Layout(
            tuple(one.logit for one in self.system.radii), self.system.states, self.slopes
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


class Assessment:
    """The errors of a solution.

    Parameters
    ----------
    problem : FreeBoundaryProblem
        Whose boundaries and slopes these are.
    spaces : list of Resolution
    state : ZoneState
    left : float
        What corrections leave of the fields.

    Raises
    ------
    NoBoundariesError
        If the solution is not finite.
    """

    def __init__(
        self, problem: FreeBoundaryProblem, spaces: list[Resolution], state: ZoneState, left: float
    ) -> None:
        if not np.isfinite(state.solution).all():
            raise NoBoundariesError("the system has no solution that is finite")
        self.problem, self.state, self.left = problem, state, left
        self.system, self.effects = state.system, state.effects()
        self.whole = state.solution * state.approach
        self.moved = [state.approach * one.change for one in self.effects]
        self.fields = _field_errors(spaces, self.system, self.whole, self.moved[0])
        self.noise = _STUCK_NOISE
        if self.system.radii:
            self.noise = _GIVEN_NOISE if self.system.pressure_known else _NOISE
        self.noise += LEFT * left

    @cached_property
    def loose(self) -> Effect:
        """What would meet the conditions of the boundaries, twice; none does without a layer."""
        return self.state.unbalanced(2.0 if self.system.parameters.beta > 0.0 else 0.0)

    @cached_property
    def inverse(self) -> Array:
        """How far what a condition misses moves the boundaries."""
        return np.asarray(np.abs(np.linalg.inv(self.problem.slopes)))

    @cached_property
    def off(self) -> float:
        """What the fields are off as the boundaries still are."""
        step = float((self.inverse @ np.abs(self.state.mismatch)).max(initial=0.0))
        if step > ROUNDING and self.system.parameters.beta > 0.0:
            return min(self.problem.size(self.state, self.loose.change), 2.0 * step)
        # q/s of one disk changes by half of that, or, measured in 120 scenes, by 16 times what is
        # missed: at a small disk the first is twice what counts, else both are rounding
        return step * (1.0 if self.system.pressure_known and len(self.system.radii) == 1 else 2.0)

    @cached_property
    def squared(self) -> float:
        """The square of the error: what superconverges may change less by accident, but hardly."""
        error = float(self.fields.indicators.max()) + self.left + self.off + TRACTION_ROUNDING
        return error**2

    @cached_property
    def missed(self) -> Array:
        """What the conditions of the boundaries may miss."""
        kept, mismatch = 2.0 * SAFETY * LEAST_RATE, self.state.mismatch
        missed = kept * np.max([np.abs(one.mismatch) for one in self.effects], axis=0)
        missed += self.squared + self.noise + self.left + 2.0 * np.abs(mismatch)
        return np.asarray(missed)

    @cached_property
    def shifts(self) -> Array:
        """How far the boundaries may be off, as logits."""
        logits = self.problem.logits
        if not len(logits):
            return np.zeros(0)
        shifts = self.inverse @ self.missed + float(np.finfo(float).eps) * np.abs(logits)
        # slopes change within the width of a zone, that of a narrow one next to the onset of slip
        gaps = np.concatenate([[inf], np.diff(logits), [inf]])
        return np.asarray(shifts * (1.0 + BENT * shifts / np.minimum(gaps[1:], gaps[:-1])))

    def attempt(self) -> Attempt[ZoneSolution]:
        """Return the solution with its errors."""
        state, system, fields = self.state, self.system, self.fields
        known = self.squared + self.noise + (0.0 if system.pressure_known else self.off)
        left = self.left + self.off
        rounding = TRACTION_ROUNDING * self._rounds
        errors = fields.pressure + left + FIELD_ROUNDING, fields.traction + left + rounding
        boundary_errors = tuple(
            boundary_error(float(d), r) for d, r in zip(self.shifts, system.radii, strict=True)
        )
        stuck, stray = self._displacements()
        pressures, shears = system.series(self.whole)
        value = ZoneSolution(
            approach=state.approach,
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
            slopes=self.problem.slopes,
            pressures=pressures,
            shears=shears,
            system=system,
            solution=np.column_stack([self.whole, *self.moved]),
            shifts=self.shifts,
        )
        # no degree lowers what rounding leaves
        fields.indicators[fields.indicators <= self.left] = 0.0
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
        if share < HARMLESS and len(radii) == int(self.system.pressure_known):
            # under still less compliance a disk loses less
            return MOST_ROUNDS if share > HARMLESS**4 or not radii else CENTRE_ROUNDS
        return 1.0 if radii or (self.system.pressure_known and alpha > 0.0) else CENTRE_ROUNDS

    def _sheared(self) -> float:
        """Return the relative error of the shear by changes, and by how far boundaries are off."""
        shear, state = self.system.total_shear, self.state
        changes = max(abs(shear(one)) for one in self.moved)
        if self.system.pressure_known:
            missed, felt = self.missed, self.system.shear_row @ state.factored.responses
            if self.system.parameters.beta == 0.0:  # nothing responds: what all inside would bear
                missed = np.max([np.abs(one.mismatch) for one in self.effects], axis=0)
                missed += 2.0 * np.abs(state.mismatch)
                felt = pi * np.array([one.square for one in self.system.radii])
            imbalance = (
                state.approach * np.abs(self.system.boundary_rows.drive @ state.solution) * missed
            )
            return (changes + float(np.abs(felt) @ imbalance)) / abs(shear(self.whole))
        rest = np.array([one.rest for one in self.system.radii])
        bend = 2.0 * float((self.shifts**2 * rest).max(initial=0.0))
        return changes / abs(shear(self.whole)) + bend

    def _by_energies(self, attempt: Attempt[ZoneSolution]) -> Attempt[ZoneSolution]:
        """Return full stick with the errors of approach and shear as energies of changes.

        That of the shear is a product with its dual: no accident makes either small.
        """
        state, system, rates = self.state, self.system, attempt.rates**2
        factors = cast("Symmetric", state.factored)
        own = factors.energies(state.solution)
        dual = factors.energies(factors.step(system.shear_row))
        raised = own.sum(axis=0) / state.bearing(state.solution)
        products = np.sqrt(own * dual).sum(axis=0)
        sheared = products / abs(system.total_shear(state.solution))
        errors = [float(one[:-1] @ rates + one[-1]) + self.noise for one in (raised, sheared)]
        value = replace(
            attempt.value, approach_error=errors[0], shear_error=sum(errors) + _STUCK_NOISE
        )
        attempt = replace(attempt, value=value)
        if self.problem.pointwise:
            return attempt
        error, indicators = max(value.approach_error, value.shear_error), raised + sheared
        return replace(attempt, error=error, indicators=indicators[:-1], rates=rates)

    def _displacements(self) -> tuple[list[Stuck], float]:
        """Return what the slip zones see of E in stick, and the most that errors make there."""
        system, state = self.system, self.state
        if not any(system.states):
            return [], 0.0
        scale = state.approach
        imbalance = scale * np.column_stack([state.imbalance, self.effects[0].imbalance])
        values, approach = np.column_stack([self.whole, self.moved[0]]), np.array([scale, 0.0])
        misfit = system.pointwise_residual(values, approach, imbalance).tangential
        whole, lost = (_stuck(system, [one[:, k] for one in misfit]) for k in (0, 1))
        # at the boundaries E and q have steps
        jumps = np.abs(system.jump_rows @ self.loose.change)
        steps = np.abs(self.loose.imbalance) + system.parameters.beta * jumps
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
    parts: dict[int, list[tuple[Points, Array]]] = {}
    # farther out than the last that sticks E is not known
    each = zip(system.parts, system.nodes, system.shear_weights, misfit, strict=False)
    for part, nodes, weights, missed in each:
        if part.state == 0:
            # as seen from outside what is smooth is gathered at the samples
            weighted = nodes.gathered((pi * weights * missed)[:, None])[:, 0]
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
