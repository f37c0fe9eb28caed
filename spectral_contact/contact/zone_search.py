"""Which zones partial slip has: a list of candidates, each judged by the friction law.

A candidate is a sequence of zones (`Layout`: boundaries, and whether each zone sticks or slips)
with the reason why it is tried. `ZoneSearch.outcome` takes the candidates in order, solves for the
boundaries and fields of each, and has the friction law decide (`slip_outcome`). The first candidate
on which the law holds is the solution. If it holds on none, `_least_wrong` returns what may stand
for the solution, such as the outcome that violates the law least or full stick, or it raises
`NoZonesError`. The outcome tells which candidates were tried, and what refuted them
(`PartialSlip.trials`).

Where candidates come from does not matter for the result. Without elastic coupling the problem is a
strictly convex minimisation under ``|q| <= f p``: fields that satisfy all conditions are the
solution. With coupling uniqueness is not proved, and no search is known to be sure.

Symbols are those of docs/theory.md: p and q are pressure and traction, f is friction, kappa the
coupling, alpha and beta the normal and tangential compliance; ``y = 1 - s**2`` at the radius s, and
the logit of a radius is ``ln(s**2/y)``. States of zones are 0 for stick and +1 or -1 for slip with
that sign of the traction. Next to the edge of a smooth surface (alpha = 0) with beta > 0 the
pressure is infinite and the traction is not, so that the edge sticks over some width.

What is said of a solved candidate (`slip_outcome.PartialSlip`): it is *consistent* if no violation
of the law exceeds the errors, and refuted if one does (its `violation_text`). It is *verified* if,
besides, the sense of slip is known and no stick is missing.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass, field, replace
from math import exp, inf, log
from time import perf_counter
from typing import Any

import numpy as np

from spectral_contact.contact.layout import Layout, NoBoundariesError, Trial, fixed_disk
from spectral_contact.contact.normal import NormalContact
from spectral_contact.contact.ratio import FullStick
from spectral_contact.contact.refine import Refinement, refine
from spectral_contact.contact.resolution import EPSILON_DEPTH
from spectral_contact.contact.slip_outcome import (
    PartialSlip,
    as_full_slip,
    full_stick_outcome,
    zones_outcome,
)
from spectral_contact.contact.stick_radius import (
    MAX_LOGIT,
    NoStickDiskError,
    limiting_logit,
    min_search_logit,
)
from spectral_contact.contact.tuning import (
    CENTRAL_ASYMPTOTE_ERROR,
    CENTRAL_CLEARANCE,
    REFINEMENT_MARGIN,
)
from spectral_contact.contact.zone_fields import (
    estimated_edge_stick_width,
    with_central_asymptote,
)
from spectral_contact.contact.zone_problem import FreeBoundaryProblem, solve_coupled_zones
from spectral_contact.contact.zone_solution import ZoneSolution
from spectral_contact.contact.zone_spaces import edge_exponent
from spectral_contact.fields.series import Radius, ZonalField
from spectral_contact.records import PARTIAL_SLIP, SLIP_FIELD, ZONE_SEARCH
from spectral_contact.spectral.parameters import Parameters

Record = Callable[[str, Any, float], Any]

#: States of a stick disk in a slip annulus.
_DISK_STATES = (0, 1)
#: The closed form of the stick at a smooth edge is tried if its expected relative error
#: (`edge_stick.expected_error`) is at most this: half of the digits. Panels leave an error of 1e-9
#: at a width of 1e-20 in ``y``, and of 4e-7 at 1e-24 (`python validation/physics/edge_stick.py`).
EDGE_MATCHING_ERROR = float(np.sqrt(np.finfo(float).eps))
#: The logit of a stick disk so small that its radius is rounding: the slip around it is that of
#: full slip.
_POINT_LOGIT = -2.0 * EPSILON_DEPTH


@dataclass(frozen=True, slots=True, eq=False)
class Candidate:
    """Zones to solve for.

    Attributes
    ----------
    zones : Layout
        States of the zones, and boundaries to begin with.
    reason : str
        Why they are tried.
    predicted : bool
        Whether boundaries and Jacobian are predicted from scenes that were solved before
        (`solving.sharing`). Newton's method begins with them. The candidate is dropped unless its
        solution is verified and meets the tolerance.
    closed_form_edge : bool
        Whether narrow stick at a smooth edge is added to the zones in closed form.
    """

    zones: Layout
    reason: str
    predicted: bool = False
    closed_form_edge: bool = False


class NoZonesError(ArithmeticError):
    """The friction law holds on no candidate; the text says what refuted each.

    Attributes
    ----------
    least_wrong : PartialSlip or None
        The outcome that violates the law least, if one was solved for. `solving.coupled_run` may
        store it with its violation as its error.
    """

    least_wrong: PartialSlip | None = None


@dataclass(eq=False)
class ZoneSearch(ABC):
    """Solves for one candidate after the other until the friction law holds.

    Parameters
    ----------
    parameters : Parameters
    stick : FullStick
        Full stick in the same contact: its fields, and the critical friction at which slip begins
        (`critical`).
    tolerance : float
        Bound on the relative errors of the fields.
    max_unknowns : int
        Most coefficients on the panels of a space (`refine`).
    record : callable
        Keeps a record of a step of the plan. It takes the name of the step
        (`records.PARTIAL_SLIP`, `SLIP_FIELD` or `ZONE_SEARCH`), its result, and the time at which
        it began. It returns the result; if that is a `Refinement`, the value of its best solution.
    warm_start : Layout, optional
        The first candidate: zones that are predicted from scenes like this one.
    """

    parameters: Parameters
    stick: FullStick
    tolerance: float
    max_unknowns: int
    record: Record
    warm_start: Layout | None = field(default=None, kw_only=True)
    _trials: list[Trial] = field(default_factory=list, init=False)

    def outcome(self) -> PartialSlip:
        """Return the first outcome that obeys the friction law, or the best that will do.

        Its `trials` are all candidates that were tried, with or without a solution.
        """
        # Newton's method for boundaries that do not exist ends at the edge, in overflow
        with np.errstate(all="ignore"):
            outcome = self._best()
        return replace(outcome, trials=tuple(self._trials))

    def _best(self) -> PartialSlip:
        """Return the outcome of the search, whose `trials` are not set yet.

        If a solution lacks stick, the next candidate is its zones with the missing stick added.
        This goes on until no stick is missing or there is no solution. Zones whose states were
        solved for are not tried again from other boundaries.
        """
        outcomes: list[PartialSlip] = []
        solved_states: set[tuple[int, ...]] = set()
        for first_candidate in self._candidates():
            candidate = first_candidate
            while candidate.predicted or (
                candidate.zones.states not in solved_states and self._is_possible(candidate.zones)
            ):
                outcome = self._try(candidate)
                if outcome is None:
                    break
                if outcome.verified:
                    return outcome
                outcomes.append(outcome)
                solved_states.add(candidate.zones.states)
                enlarged = outcome.with_missing_stick
                if enlarged is None:
                    break
                candidate = Candidate(enlarged, "the zones before, with the stick missing there")
        return self._least_wrong(outcomes)

    def _try(self, candidate: Candidate) -> PartialSlip | None:
        """Return the solution on a candidate, if there is one, and note the verdict on it.

        On predicted zones a solution counts only if it is verified and meets the tolerance, because
        a fresh start may give a better one.
        """
        accepted = None
        try:
            outcome = self._solve(candidate)
            verdict = outcome.verdict
            if not candidate.predicted:
                accepted = outcome
            elif outcome.verified:
                if outcome.slip_error < inf and self.bounded_error(outcome) <= self.tolerance:
                    accepted = outcome
                else:
                    verdict = "the tolerance is not met from these boundaries"
        # LinAlgError: a zone has no width, its boundaries coincide
        except (np.linalg.LinAlgError, ArithmeticError) as error:
            verdict = str(error)
        self._trials.append(Trial(candidate.zones, candidate.reason, verdict))
        return accepted

    def bounded_error(self, outcome: PartialSlip) -> float:
        """Return the largest of the error estimates that the tolerance bounds."""
        return max(
            outcome.approach_error,
            outcome.shear_error,
            outcome.pressure_error,
            outcome.traction_error,
        )

    @property
    def _slip_where_full_stick_violates(self) -> Candidate:
        """Slip where full stick violates ``|q| <= f p``, stick elsewhere."""
        from spectral_contact.contact.onset import slip_where_exceeded

        zones = slip_where_exceeded(self.stick, self.parameters)
        return Candidate(zones, "slip where full stick exceeds the friction")

    @property
    def _smooth_edge_sticks(self) -> bool:
        """Whether the edge must stick: p is infinite there and q is not, as alpha = 0 < beta."""
        return self.parameters.alpha == 0.0 < self.parameters.beta

    @property
    def _edge_stick_width(self) -> float:
        """The width in ``y`` over which a smooth edge sticks, to an order of magnitude."""
        return estimated_edge_stick_width(self.parameters, 0.0)

    @property
    def _edge_stick_is_resolvable(self) -> bool:
        """Whether the stick zone at a smooth edge is wide enough to be represented."""
        return self._smooth_edge_sticks and self._edge_stick_width >= exp(-MAX_LOGIT)

    @property
    def _disk_logit(self) -> float:
        """The logit of a first stick radius, from the limits of little and of much friction."""
        ratio = self.parameters.friction / self.parameters.kappa
        return limiting_logit(self.parameters._replace(friction=ratio))

    def _disk(self, logit: float) -> Candidate:
        """Return one stick disk with slip around it, and with stick at a smooth edge.

        The stick at the edge is as wide as is estimated, and is added if it can be represented.
        """
        if not self._edge_stick_is_resolvable:
            return Candidate(Layout((logit,), _DISK_STATES), "one stick disk")
        # Next to the edge the logit is -ln y. The estimate of the width is not made for much
        # friction, under which the stick at the edge may reach into the disk.
        edge_logit = -log(self._edge_stick_width)
        zones = Layout((min(logit, edge_logit - 1.0), edge_logit), (*_DISK_STATES, 0))
        return Candidate(zones, "one stick disk, and stick at the edge")

    @abstractmethod
    def _candidates(self) -> Iterator[Candidate]:
        """Yield candidates, the likeliest first."""

    @abstractmethod
    def _is_possible(self, zones: Layout) -> bool:
        """Return whether a contact may have zones of these states."""

    @abstractmethod
    def _solve(self, candidate: Candidate) -> PartialSlip:
        """Return the solution on a candidate, with the verdict on it, which may be against it.

        Raises
        ------
        ArithmeticError, LinAlgError
            If there is none; the text is the verdict.
        """

    @abstractmethod
    def _least_wrong(self, outcomes: list[PartialSlip]) -> PartialSlip:
        """Return what stands for the solution if none of the outcomes is verified."""


@dataclass(eq=False)
class UncoupledSearch(ZoneSearch):
    """The search under a known pressure, for kappa = 1.

    Parameters
    ----------
    contact : NormalContact
        Normal contact, whose pressure is known.
    pointwise : bool
        Whether the tolerance bounds the error of q/s at every radius. If not, it bounds those of
        total shear and stick radius, for which less accurate fields suffice.
    """

    contact: NormalContact
    pointwise: bool = True

    def _best(self) -> PartialSlip:
        """Return the best outcome, or full stick where slip cannot be told from it.

        It cannot if f exceeds the lower bound of the critical friction, and the outcome breaks the
        friction law or misses the tolerance.
        """
        best = super()._best()
        failed = not best.consistent or self.bounded_error(best) > self.tolerance
        least_critical = self.stick.critical * (1.0 - self.stick.critical_error)
        if failed and self.parameters.friction > least_critical:
            return full_stick_outcome(self.stick, self.parameters)
        return best

    def _candidates(self) -> Iterator[Candidate]:
        """Yield candidates: a like scene's zones, one disk, what full stick shows."""
        if self.warm_start is not None:
            yield Candidate(self.warm_start, "the zones of a like scene", predicted=True)
        yield self._disk(self._disk_logit)
        if self.parameters.beta > 0.0:  # without a layer q has no other zones
            yield self._slip_where_full_stick_violates

    def _is_possible(self, zones: Layout) -> bool:
        """Return whether there may be such zones.

        Without tangential compliance only one stick disk is possible. The same holds where the
        stick at a smooth edge is left out, because it is too narrow to be represented.
        """
        if self.parameters.beta == 0.0 or (
            self._smooth_edge_sticks and not self._edge_stick_is_resolvable
        ):
            return zones.states == _DISK_STATES
        return len(zones.states) > 1

    def _least_wrong(self, outcomes: list[PartialSlip]) -> PartialSlip:
        if not outcomes:  # slip is about to start, and too narrow to be solved for
            return full_stick_outcome(self.stick, self.parameters)
        consistent = [outcome for outcome in outcomes if outcome.consistent]
        best = min(consistent or outcomes, key=lambda outcome: outcome.apparent_violation)
        if best.missing:  # a zone may be missing, which no estimate of its neighbours includes
            best = replace(best, zones_error=max(best.zones_error, 1.0))
        return best

    def _solve(self, candidate: Candidate) -> PartialSlip:
        zones = candidate.zones
        is_disk = zones.states == _DISK_STATES
        begin = perf_counter()
        try:
            refinement = self._refine(zones)
        except NoStickDiskError as error:
            if error.at_centre:
                return self._full_slip()
            raise
        solved: ZoneSolution = self.record(
            PARTIAL_SLIP if is_disk else ZONE_SEARCH, refinement, begin
        )
        begin = perf_counter()
        outcome = zones_outcome(solved, self.parameters, self.contact)
        if is_disk:
            self.record(SLIP_FIELD, outcome, begin)
        return outcome

    def bounded_error(self, outcome: PartialSlip) -> float:
        """Return the error of the shear or, where the tolerance bounds both, the larger one."""
        return max(outcome.traction_error if self.pointwise else 0.0, outcome.shear_error)

    def _full_slip(self) -> PartialSlip:
        """Return full slip, for a stick disk whose logit is below `stick_radius.MIN_LOGIT`."""
        # one space is enough: nothing depends on the fields in the disk
        problem = FreeBoundaryProblem(
            self.parameters, fixed_disk(_POINT_LOGIT), self.tolerance, known=self.contact
        )
        solved = problem.attempt(problem.start()).value
        outcome = zones_outcome(solved, self.parameters, self.contact, point_disk=True)
        return as_full_slip(outcome, self.parameters.friction)

    def _refine(self, zones: Layout) -> Refinement[ZoneSolution]:
        """Solve for boundaries and fields, to what the tolerance bounds."""
        if self.pointwise:
            return self._refine_fields(self.tolerance, zones)
        refinement = self._refine_fields(np.sqrt(REFINEMENT_MARGIN * self.tolerance), zones)
        solved = refinement.best.value
        if max(solved.shear_error, solved.radius_error) <= self.tolerance:
            return refinement
        try:
            return self._refine_fields(self.tolerance, solved.layout)
        except NoBoundariesError:  # from there Newton's method finds nothing better
            return refinement

    def _refine_fields(self, tolerance: float, zones: Layout) -> Refinement[ZoneSolution]:
        """Solve for boundaries and fields, the fields to a tolerance.

        The tolerance of the search bounds the error of the boundaries.
        """
        problem = FreeBoundaryProblem(
            self.parameters,
            zones,
            tolerance,
            known=self.contact,
            boundary_tolerance=self.tolerance,
        )
        return refine(problem, tolerance, self.max_unknowns)


class CoupledSearch(ZoneSearch):
    """The search with elastic coupling, where pressure and traction are one system.

    In each of 138 random scenes and 45 at thresholds the law held on one of the candidates.
    """

    def _best(self) -> PartialSlip:
        """Return the first outcome that obeys the friction law, or the best that will do.

        Where stick at a smooth edge is so narrow that a closed form is more accurate than panels,
        the closed form comes first; the candidates follow if it misses the tolerance.
        """
        closed_form = self._disk_with_edge_stick()
        if closed_form is not None and self.bounded_error(closed_form) <= self.tolerance:
            return closed_form
        try:
            best = super()._best()
        except NoZonesError:
            if closed_form is None:
                raise
            return closed_form
        if closed_form is not None and self.bounded_error(closed_form) < self.bounded_error(best):
            return closed_form
        return best

    def _candidates(self) -> Iterator[Candidate]:
        """Yield candidates: a like scene's zones, one disk and what full stick shows.

        If the edge must stick, the disk comes first, since full stick oscillates. Else the disk
        comes last, and reaches to the radius from which full stick exceeds the friction.
        """
        if self.warm_start is not None:
            yield Candidate(self.warm_start, "the zones of a like scene", predicted=True)
        if self._disk_is_below_range:
            return
        if self._smooth_edge_sticks:
            yield self._disk(self._disk_logit)
        violated = self._slip_where_full_stick_violates
        yield violated
        if not self._smooth_edge_sticks:
            yield self._disk(next(iter(violated.zones.logits), self._disk_logit))

    @property
    def _edge_stick_width(self) -> float:
        return estimated_edge_stick_width(self.parameters, edge_exponent(self.parameters))

    def _is_possible(self, zones: Layout) -> bool:
        """Return whether zones of these states are possible.

        A stick disk with slip around it is possible unless the edge must stick. More than two zones
        are possible if there is tangential compliance.
        """
        if len(zones.states) == 2:
            return not self._smooth_edge_sticks
        return len(zones.states) > 2 and self.parameters.beta > 0.0

    @property
    def _disk_is_below_range(self) -> bool:
        """Whether the edge must stick, and the stick disk is smaller than any that is solved for.

        Where the edge need not stick, the search for the boundary of one disk finds that out
        (`NoStickDiskError`).
        """
        return self._smooth_edge_sticks and self._disk_logit < min_search_logit(self.parameters)

    def _least_wrong(self, outcomes: list[PartialSlip]) -> PartialSlip:
        consistent = [outcome for outcome in outcomes if outcome.consistent]
        if consistent:
            return min(consistent, key=lambda outcome: outcome.apparent_violation)
        if self._disk_is_below_range:
            with suppress(ArithmeticError):  # the stick at the edge may not be narrow
                return self._full_slip()
        unresolved = (
            f"the edge sticks over some {self._edge_stick_width:.0e}, too little to resolve"
        )
        error = NoZonesError("; ".join(trial.text for trial in self._trials) or unresolved)
        error.least_wrong = min(
            outcomes, key=lambda outcome: outcome.apparent_violation, default=None
        )
        raise error

    def _solve(self, candidate: Candidate) -> PartialSlip:
        zones = candidate.zones
        begin = perf_counter()
        try:
            if not candidate.predicted:
                # first boundaries, from a small space
                zones = FreeBoundaryProblem(self.parameters, zones, self.tolerance).current_layout()
        except NoStickDiskError as error:
            if error.at_centre and not candidate.closed_form_edge:
                return self._full_slip()
            raise
        refinement = solve_coupled_zones(self.parameters, zones, self.tolerance, self.max_unknowns)
        if not refinement.best.error < 0.5:
            raise NoZonesError("no digit of the fields is known")
        solve_end = perf_counter()
        with_verdict: Callable[..., PartialSlip] = zones_outcome
        if candidate.closed_form_edge:
            from spectral_contact.contact.edge_stick import with_edge_stick

            with_verdict = with_edge_stick
        outcome = with_verdict(refinement.best.value, self.parameters)
        if outcome.consistent:
            # `record` counts the time from the given beginning until now. So that of the solve is
            # moved later by the time that the verdict took.
            self.record(PARTIAL_SLIP, refinement, begin + perf_counter() - solve_end)
            self.record(SLIP_FIELD, outcome, solve_end)
        return outcome

    def _disk_with_edge_stick(self) -> PartialSlip | None:
        """Return one stick disk with stick at the edge in closed form, if the law holds on it.

        It is tried only where the closed form is expected to be accurate.
        """
        from spectral_contact.contact.edge_stick import expected_error

        if (
            not self._smooth_edge_sticks
            or self._disk_is_below_range
            or expected_error(self.parameters) > EDGE_MATCHING_ERROR
        ):
            return None
        outcome = self._try(
            Candidate(
                Layout((self._disk_logit,), _DISK_STATES),
                "one stick disk, with narrow stick at the edge in closed form",
                closed_form_edge=True,
            )
        )
        return outcome if outcome is not None and outcome.verified else None

    def _full_slip(self) -> PartialSlip:
        """Return full slip: the stick disk is too small to change the fields around it.

        What sticks at a smooth edge is added in closed form.
        """
        from spectral_contact.contact.edge_stick import with_edge_stick
        from spectral_contact.contact.little_friction import full_slip_problem

        begin = perf_counter()
        refinement = solve_coupled_zones(
            *full_slip_problem(self.parameters), self.tolerance, self.max_unknowns
        )
        self.record(PARTIAL_SLIP, refinement, begin)
        begin = perf_counter()
        with_verdict = with_edge_stick if self._smooth_edge_sticks else zones_outcome
        outcome = with_verdict(refinement.best.value, self.parameters, point_disk=True)
        if self.parameters.alpha == 0.0:
            outcome = self._with_central_asymptote(outcome)
        outcome = as_full_slip(outcome, self.parameters.friction)
        self.record(SLIP_FIELD, outcome, begin)
        return outcome

    def _with_central_asymptote(self, outcome: PartialSlip) -> PartialSlip:
        """Return full slip on a smooth surface with p next to the centre in closed form.

        The regularising disk makes p wrong up to some of its radii from the centre. There p is
        replaced by ``p ~ s**-e/sqrt(1 - s**2)``.
        """
        from spectral_contact.contact.little_friction import regularising_radius

        assert isinstance(outcome.pressure, ZonalField)
        radius = CENTRAL_CLEARANCE * regularising_radius(self.parameters).value
        pressure = with_central_asymptote(
            outcome.pressure, Radius(radius, 1.0 - radius), self.parameters
        )
        kappa_f = self.parameters.kappa * self.parameters.friction
        error = kappa_f * (CENTRAL_ASYMPTOTE_ERROR * radius**2 + CENTRAL_CLEARANCE**-3)
        return replace(outcome, pressure=pressure, pressure_error=outcome.pressure_error + error)
