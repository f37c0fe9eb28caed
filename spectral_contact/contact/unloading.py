"""The first unloading: zones and fields at a load below the largest one, without coupling.

Where the surface has slipped under growing load and sticks now, it keeps the displacement u_r that
slip has left it with; where it has not slipped, u_r is zero. So the state at the load ratio lambda
solves the same equations as that at the largest load, with a known displacement in what sticks
(`spectral.contact_system`). All is divided by lambda, so that the pressure is that of unit load and
the displacement is ``1/lambda`` times that at the largest load.

From the centre outward the surface sticks, slips on (forward, q = +f p), sticks with memory and,
below the *reverse ratio* of loads, slips back (q = -f p). Such a state does not depend on the way
from the largest load as long as no slip zone has become narrower on the way: then every point that
slips has slipped since, and every point that sticks has not. The largest load ratio at which a
boundary of a slip zone turns is the *turning ratio*; below it the history counts.

Symbols are those of docs/theory.md: p and q are pressure and traction, f is friction, all for
kappa = 1; the logit of a radius s is ``ln(s**2/(1 - s**2))``.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from math import exp, inf, log, sqrt
from time import perf_counter
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from scipy.optimize import brentq

from spectral_contact.contact.friction_law import DISTANCES
from spectral_contact.contact.layout import Layout, NoBoundariesError, logit_at
from spectral_contact.contact.refine import Refinement, refine
from spectral_contact.contact.resolution import NormalContact
from spectral_contact.contact.slip_outcome import PartialSlip, zones_outcome
from spectral_contact.contact.stick_radius import JACOBIAN_FIELD_TOL
from spectral_contact.contact.tuning import (
    COARSE_TOL,
    MAX_STEPS,
    SAMPLES,
    SLIP_ROUNDING,
)
from spectral_contact.contact.zone_problem import FreeBoundaryProblem
from spectral_contact.contact.zone_search import Candidate, NoZonesError, ZoneSearch
from spectral_contact.fields.series import Array
from spectral_contact.records import UNLOADING
from spectral_contact.spectral.contact_fields import KnownDisplacement
from spectral_contact.spectral.factored import factored
from spectral_contact.threads import cached_property

if TYPE_CHECKING:
    from spectral_contact.contact.error_estimate import ZoneSolution
    from spectral_contact.contact.zone_search import Record, UncoupledSearch


class ZoneGrowth(NamedTuple):
    """Whether slip zones grow as the load falls.

    Attributes
    ----------
    changes : ndarray, shape (boundaries,)
        Of ``|q|/f`` less p on the sides that stick, per ``-d ln(load)`` with zones held fixed:
        positive where slip grows.
    least : float
        The least of them.
    error : float
        Estimate of its error.
    """

    changes: Array
    least: float
    error: float


class LoadRatio(NamedTuple):
    """A threshold of the load ratio, with an estimate of its relative error."""

    value: float
    error: float


@dataclass(eq=False)
class UnloadedSearch(ZoneSearch):
    """The search for the zones at one load ratio.

    Parameters
    ----------
    contact : NormalContact
        Normal contact, whose pressure is known.
    before : KnownDisplacement
        The displacement at the largest load, times one over the load ratio.
    load_ratio : float
        Below 1.
    reversing : bool
        Whether zones may slip back. If not, the friction law may be broken at the edge.
    """

    contact: NormalContact
    before: KnownDisplacement
    load_ratio: float
    reversing: bool = True
    #: the latest solution
    solved: ZoneSolution | None = field(default=None, init=False)

    def _candidates(self) -> Iterator[Candidate]:
        """Yield candidates: the zones at a like load, and those that rings show."""
        if self.warm_start is not None:
            yield Candidate(self.warm_start, "the zones at like loads", predicted=True)
        from spectral_contact.contact.active_set import ring_layout

        for more in range(1, 5):
            # next to a boundary at the largest load slip may be narrower than rings
            splits = 2 * more + 1
            rings = ring_layout(
                self.parameters, coupled=False, splits=splits, unloaded_to=self.load_ratio
            )
            logits = tuple(radius.logit for radius in rings.boundaries)
            zones = Layout(logits, rings.states)
            if self.reversing:
                yield Candidate(zones, "the zones of an active set on rings")
                missing = self.solved and _with_missing_slip(self.solved)
                if missing:
                    yield Candidate(missing, "the zones before, with the slip missing there")
            forward = _without_reverse_slip(zones)
            if forward.states != zones.states or not self.reversing:
                yield Candidate(forward, "the zones on rings, without slip back")

    def _is_possible(self, zones: Layout) -> bool:
        """Return whether there may be such zones: stick at the centre, and memory further out."""
        return zones.states[0] == 0 and len(zones.states) >= 3

    def problem(self, zones: Layout, tolerance: float) -> FreeBoundaryProblem:
        """Return the equations on these zones."""
        return FreeBoundaryProblem(
            self.parameters, zones, tolerance, known=self.contact, displacement=self.before
        )

    def _solve(self, candidate: Candidate) -> PartialSlip:
        begin = perf_counter()
        refinement = refine(
            self.problem(candidate.zones, self.tolerance), self.tolerance, self.max_unknowns
        )
        if candidate.predicted and refinement.best.error > self.tolerance:
            raise NoBoundariesError("the tolerance is not met from these boundaries")
        solved: ZoneSolution = self.record(UNLOADING, refinement, begin)
        self.solved = solved
        return zones_outcome(solved, self.parameters, self.contact)

    def solve_zones(self, zones: Layout | None) -> ZoneSolution:
        """Return the solution on zones near these, or on the first candidate that has one.

        The friction law is not asked.

        Raises
        ------
        NoZonesError
            If no candidate has a solution.
        """
        starts = [zones] if zones else (candidate.zones for candidate in self._candidates())
        with np.errstate(all="ignore"):
            for start in starts:
                with suppress(np.linalg.LinAlgError, ArithmeticError):
                    problem = self.problem(start, self.tolerance)
                    return refine(problem, self.tolerance, self.max_unknowns).best.value
        raise NoZonesError("no zones have a solution")

    def _least_wrong(self, outcomes: list[PartialSlip]) -> PartialSlip:
        raise NoZonesError("; ".join(trial.text for trial in self._trials))

    def growth(self, zones: Layout) -> ZoneGrowth:
        """Return whether the slip zones grow at their ends as the load falls.

        While the zones are held fixed, the traction beside an end begins to exceed friction, or to
        fall below it. Inside of what sticks it is below, so that the end moves into what sticks if
        it exceeds friction, and only then: by that excess over the slope of ``q - f p`` there.
        The displacement that what sticks keeps goes like one over the load, and the traction is
        continuous with it. So the excess is the jump without it, with opposite sign.
        """
        logits = np.array(zones.logits)
        undisplaced = FreeBoundaryProblem(self.parameters, zones, COARSE_TOL, known=self.contact)
        system = undisplaced.system(undisplaced.spaces(COARSE_TOL, logits), logits)
        factors = factored(system)
        values = factors.unit_solutions[:, 0]
        coarse_difference = factors.coarse_differences(values, system)[0]
        states = np.array(zones.states)
        # one of the two zones at a boundary sticks, and its state is 0
        jumps = (states[1:] + states[:-1])[:, None] * system.jump_rows / self.parameters.friction
        changes = -jumps @ values
        i = int(np.argmin(changes))
        by_boundaries = self.tolerance * float(np.abs(changes).max())
        error = abs(float(jumps[i] @ coarse_difference)) + by_boundaries
        return ZoneGrowth(changes, float(changes[i]), error)


def _with_missing_slip(solved: ZoneSolution) -> Layout | None:
    """Return the zones with slip where what sticks with memory exceeds friction; None if nowhere.

    The slip is next to the largest ``|q|/(f p)``, as far as that is above 1.
    """
    system = solved.system
    logits = [radius.logit for radius in system.radii]
    states = list(system.states)
    for zone in range(len(states) - 1, 0, -1):
        if 2 * zone not in system.known_displacement:
            continue
        halves = (2 * zone - 1, 2 * zone)
        y = np.concatenate([system.parts[k].mesh.points(DISTANCES).y for k in halves])
        outward = np.argsort(-y)
        y = y[outward]
        ratio = np.concatenate([_friction_ratio(solved, k, DISTANCES) for k in halves])[outward]
        largest = int(np.argmax(np.abs(ratio)))
        within = np.flatnonzero(np.abs(ratio) <= 1.0)
        if abs(ratio[largest]) <= 1.0 + SLIP_ROUNDING or not len(within):
            continue
        before = within[within < largest]
        after = within[within > largest]
        ends = [float(y[side]) for side in (*before[-1:], *after[:1])]
        slip = int(np.sign(ratio[largest]))
        new_states = [0] * len(before[-1:]) + [slip] + [0] * len(after[:1])
        states[zone : zone + 1] = new_states
        logits[zone:zone] = [logit_at(-log(end)) for end in ends]
        return Layout(tuple(logits), tuple(states))
    return None


def _without_reverse_slip(zones: Layout) -> Layout:
    """Return the zones with stick in place of slip back, and no boundary between stick zones."""
    logits: list[float] = []
    states = [zones.states[0]]
    for logit, state in zip(zones.logits, zones.states[1:], strict=True):
        forward = max(state, 0)
        if forward != states[-1]:
            logits.append(logit)
            states.append(forward)
    return Layout(tuple(logits), tuple(states))


class HistoryError(ArithmeticError):
    """The load is below the turning ratio, so that the state depends on the way to it.

    Attributes
    ----------
    turning : LoadRatio
    """

    def __init__(self, turning: LoadRatio) -> None:
        super().__init__(
            f"below the turning ratio {turning.value:.7g} it depends on the loads in between"
        )
        self.turning = turning


class Unloading:
    """The first unloading from one loaded state.

    Parameters
    ----------
    search : UncoupledSearch
        That for the zones at the largest load.
    loaded : PartialSlip
        Its outcome, on zones that were solved for.
    tolerance : float
        Bound on the relative errors of states; that of the search is tighter, and bounds those of
        the thresholds.
    """

    def __init__(self, search: UncoupledSearch, loaded: PartialSlip, tolerance: float) -> None:
        self._parameters = search.parameters
        self._contact = search.contact
        self._stick = search.stick
        self._loaded = loaded
        self._tolerance = search.tolerance
        self._state_tolerance = tolerance
        self._max_unknowns = search.max_unknowns
        samples = loaded.slip.evaluate(np.concatenate([DISTANCES, 1.0 - DISTANCES]))
        self._slip_error = loaded.slip_error * float(np.abs(samples).max())

    def state(self, load_ratio: float, record: Record, start: Layout | None = None) -> PartialSlip:
        """Return the state at a load ratio below 1, for unit load.

        Parameters
        ----------
        load_ratio : float
        record : callable
            As of `ZoneSearch`.
        start : Layout, optional
            Zones that are predicted from those at other loads.

        Raises
        ------
        HistoryError
            If the load ratio is below the turning ratio.
        NoZonesError
            If the friction law holds on no zones that are tried.
        """
        search = self._search(load_ratio, record, start=start, tolerance=self._state_tolerance)
        outcome = search.outcome()
        assert outcome.layout is not None
        if not search.growth(outcome.layout).least > 0.0:
            turning = self.turning_ratio
            if turning.value > load_ratio:
                raise HistoryError(turning)
        return outcome

    def _search(
        self,
        load_ratio: float,
        record: Record | None = None,
        *,
        start: Layout | None = None,
        reversing: bool = True,
        tolerance: float | None = None,
    ) -> UnloadedSearch:
        """Return the search at a load ratio."""
        before = KnownDisplacement(
            self._loaded.slip, 1.0 / load_ratio, self._slip_error / load_ratio
        )
        return UnloadedSearch(
            self._parameters,
            self._stick,
            tolerance or self._tolerance,
            self._max_unknowns,
            record or _unrecorded,
            self._contact,
            before,
            load_ratio,
            reversing,
            warm_start=start,
        )

    @property
    def reverse_ratio(self) -> LoadRatio:
        """The load ratio below which the surface slips back somewhere.

        That is where q in a zone with memory, solved for without slip back, reaches -f p.
        """
        return self._onset_of_reverse_slip[0]

    @cached_property
    def _onset_of_reverse_slip(self) -> tuple[LoadRatio, Layout]:
        """The reverse ratio, and the zones there.

        The secant method begins where cycles shake down, ``(f_crit - f)/(f_crit + f)``.
        """
        zones: Layout | None = None
        logs = list[float]()
        margins = list[float]()
        critical, friction = self._stick.critical, self._parameters.friction
        log_load = log((critical - friction) / (critical + friction))
        step = -COARSE_TOL
        for _ in range(MAX_STEPS):
            solved = self._search(exp(log_load), reversing=False).solve_zones(zones)
            zones = solved.layout
            logs.append(log_load)
            margins.append(_reverse_margin(solved))
            if len(logs) > 1:
                slope = (margins[-1] - margins[-2]) / (logs[-1] - logs[-2])
                step = -margins[-1] / slope
            if abs(step) < self._tolerance:
                error = 2.0 * (solved.traction_error + solved.pressure_error)
                slope = (margins[1] - margins[0]) / (logs[1] - logs[0])
                return LoadRatio(exp(log_load), error / abs(slope) + self._tolerance), zones
            log_load += step
        raise NoZonesError("the load at which slip back begins was not found")

    @cached_property
    def turning_ratio(self) -> LoadRatio:
        """The load ratio at which a slip zone ceases to grow at one of its boundaries.

        Below the reverse ratio the width of the slip back grows like the distance ``x`` of ln(load)
        from there, or like ``sqrt(x)``, and the growth of other zones changes as it does. So the
        turning ratio is found as a zero over ``sqrt(x)``.
        """
        reverse, zones = self._onset_of_reverse_slip
        top = log(reverse.value)
        tolerance = max(self._tolerance, JACOBIAN_FIELD_TOL)
        start: Layout | None = None

        def growth(root_x: float) -> ZoneGrowth:
            nonlocal start
            if root_x == 0.0:
                return self._search(reverse.value).growth(zones)
            load = exp(top - root_x**2)
            search = self._search(load, start=start, tolerance=tolerance)
            start = search.outcome().layout
            assert start is not None
            return search.growth(start)

        below = sqrt(COARSE_TOL)
        while growth(below).least > 0.0:
            below *= 2.0
        zero = brentq(lambda root_x: growth(root_x).least, 0.0, below, xtol=tolerance)
        # of the growth by x
        slope = growth(zero / 2.0).least / (3.0 * zero**2 / 4.0)
        error = 2.0 * zero * tolerance + 4.0 * growth(zero).error / slope
        return LoadRatio(exp(top - zero**2), error + reverse.error)


def _unrecorded(name: str, result: Any, begin: float) -> Any:
    """Return the value of a result, of which no work is noted."""
    return result.best.value if isinstance(result, Refinement) else result


def _friction_ratio(solved: ZoneSolution, part: int, distances: Array) -> Array:
    """Return ``q/(f p)`` at distances from the boundary of a part, over its extent."""
    s = np.sqrt(solved.system.parts[part].mesh.points(distances).z)
    bound = solved.system.parameters.friction * solved.pressures[part](distances)
    return np.asarray(s * solved.shears[part](distances) / bound)


def _reverse_margin(solved: ZoneSolution) -> float:
    """Return the least ``q/(f p) + 1`` in the zones that stick with memory."""
    depths = -np.log(DISTANCES)
    least = inf
    for k in solved.system.known_displacement:
        values = _friction_ratio(solved, k, DISTANCES)
        i = int(np.argmin(values))
        ends = depths[[max(i - 1, 0), min(i + 1, len(depths) - 1)]]
        around = np.linspace(ends[0], ends[1], SAMPLES)
        least = min(least, float(_friction_ratio(solved, k, np.exp(-around)).min()))
    return least + 1.0
