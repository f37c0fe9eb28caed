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
from dataclasses import dataclass, field
from math import copysign, exp, log, pi, sqrt
from time import perf_counter
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from spectral_contact.contact.friction_law import DISTANCES, excused_excess
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
    """

    contact: NormalContact
    before: KnownDisplacement
    load_ratio: float
    #: the latest solution
    solved: ZoneSolution | None = field(default=None, init=False)

    @cached_property
    def _zones_on_rings(self) -> Layout:
        """The zones by an active set on rings, at this load ratio or at 3/4 if that is less.

        At ratios close to 1, what slips on is next to a boundary at the largest load, and narrower
        than rings.
        """
        from spectral_contact.contact.active_set import ring_layout

        load_ratio = min(self.load_ratio, 3.0 / 4.0)
        rings = ring_layout(self.parameters, coupled=False, splits=3, unloaded_to=load_ratio)
        return Layout(tuple(radius.logit for radius in rings.boundaries), rings.states)

    def _candidates(self) -> Iterator[Candidate]:
        """Yield candidates: the zones at a like load, and those that rings show."""
        if self.warm_start is not None:
            yield Candidate(self.warm_start, "the zones at like loads", predicted=True)
        for zones, reason in (
            (self._zones_on_rings, "the zones of an active set on rings"),
            (self.forward_zones, "the zones on rings, without slip back"),
        ):
            yield Candidate(zones, reason)
            if self.solved and (missing := _with_missing_slip(self.solved)):
                yield Candidate(missing, "the zones before, with the slip missing there")

    @property
    def forward_zones(self) -> Layout:
        """The zones on rings without slip back, to begin with."""
        return _without_reverse_slip(self._zones_on_rings)

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
        outcome = zones_outcome(solved, self.parameters, self.contact)
        if _reverse_margin(solved) < -excused_excess(outcome.traction_error):
            raise NoBoundariesError("the surface would slip back in what sticks")
        return outcome

    def solve_zones(self, zones: Layout) -> ZoneSolution:
        """Return the solution on zones near these. The friction law is not asked.

        Raises
        ------
        NoZonesError
            If there is none.
        """
        try:
            with np.errstate(all="ignore"):
                problem = self.problem(zones, self.tolerance)
                return refine(problem, self.tolerance, self.max_unknowns).best.value
        except (np.linalg.LinAlgError, ArithmeticError) as error:
            raise NoZonesError(str(error)) from None

    def _least_wrong(self, outcomes: list[PartialSlip]) -> PartialSlip:
        raise NoZonesError("; ".join(trial.text for trial in self._trials))

    def growth(self, solved: ZoneSolution) -> ZoneGrowth:
        """Return whether the slip zones grow at their ends as the load falls.

        While the zones are held fixed, the traction beside an end begins to exceed friction, or to
        fall below it. Inside of what sticks it is below, so that the end moves into what sticks if
        it exceeds friction, and only then: by that excess over the slope of ``q - f p`` there.
        The displacement that what sticks keeps goes like one over the load, and the traction is
        continuous with it. So the excess is the jump without it, with opposite sign.
        """
        zones = solved.layout
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
        # the slope of q/f - p by a logit is of the size of the mean pressure
        by_boundaries = float(solved.logit_errors.max()) / pi
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
        halves = [_friction_ratios(solved, k) for k in (2 * zone - 1, 2 * zone)]
        y, ratio = np.concatenate(halves, axis=1)
        outward = np.argsort(-y)
        y = y[outward]
        ratio = ratio[outward]
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
    """The load is below the turning ratio, so that the state depends on the way to it."""


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
        # slip back in a narrow zone at the edge is below the errors of looser tolerances
        self._state_tolerance = min(tolerance, COARSE_TOL**2)
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
        assert search.solved is not None
        growth = search.growth(search.solved)
        if growth.least < -growth.error:
            turning = self.turning_ratio.value
            raise HistoryError(
                f"below the turning ratio {turning:.7g} it depends on the loads in between"
            )
        return outcome

    def _search(
        self,
        load_ratio: float,
        record: Record | None = None,
        *,
        start: Layout | None = None,
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
            warm_start=start,
        )

    @property
    def reverse_ratio(self) -> LoadRatio:
        """The load ratio below which the surface slips back somewhere.

        That is where q in a zone with memory, solved for without slip back, reaches -f p.
        """
        return self._onset_of_reverse_slip[0]

    @cached_property
    def _onset_of_reverse_slip(self) -> tuple[LoadRatio, ZoneSolution]:
        """The reverse ratio, and the solution there.

        The secant method begins where cycles shake down, ``(f_crit - f)/(f_crit + f)``.
        """
        logs = list[float]()
        margins = list[float]()
        critical, friction = self._stick.critical, self._parameters.friction
        log_load = log((critical - friction) / (critical + friction))
        step = -COARSE_TOL
        zones = self._search(exp(log_load)).forward_zones
        for _ in range(MAX_STEPS):
            solved = self._search(exp(log_load)).solve_zones(zones)
            zones = solved.layout
            logs.append(log_load)
            margins.append(_reverse_margin(solved))
            if len(logs) > 1:
                slope = (margins[-1] - margins[-2]) / (logs[-1] - logs[-2])
                step = -margins[-1] / slope
            if abs(step) < self._tolerance:
                error = 2.0 * (solved.traction_error + solved.pressure_error)
                slope = (margins[1] - margins[0]) / (logs[1] - logs[0])
                return LoadRatio(exp(log_load), error / abs(slope) + self._tolerance), solved
            log_load += step
        raise NoZonesError("the load at which slip back begins was not found")

    @cached_property
    def turning_ratio(self) -> LoadRatio:
        """The load ratio at which a slip zone ceases to grow at one of its boundaries.

        Below the reverse ratio the width of the slip back grows like the distance ``x`` of ln(load)
        from there, or like ``sqrt(x)``, and the growth of other zones changes as it does: it is a
        parabola over ``sqrt(x)``. The zero is found by Muller's method.
        """
        reverse, solved = self._onset_of_reverse_slip
        tolerance = max(self._tolerance, JACOBIAN_FIELD_TOL)
        growth = self._search(reverse.value).growth(solved)
        places = [0.0]
        leasts = [growth.least]
        place = sqrt(COARSE_TOL)
        load = reverse.value * exp(-(place**2))
        search = self._search(load, tolerance=tolerance)
        search.outcome()
        assert search.solved is not None
        solved = search.solved
        for _ in range(MAX_STEPS):
            growth = search.growth(solved)
            places.append(place)
            leasts.append(growth.least)
            step, slope = _step_to_zero(places, leasts)
            if abs(step) < tolerance:
                error = 2.0 * place * (tolerance + 2.0 * growth.error / abs(slope))
                return LoadRatio(load, error + reverse.error)
            place = min(max(place + step, place / 2.0), 2.0 * place)
            load = reverse.value * exp(-(place**2))
            search = self._search(load, tolerance=tolerance)
            solved = search.solve_zones(solved.layout)
        raise NoZonesError("the load at which a slip zone turns was not found")


def _step_to_zero(places: list[float], values: list[float]) -> tuple[float, float]:
    """Return the step from the last place to a zero, and the slope there.

    They are those of the parabola through the last three values, or of the line through two.
    """
    slopes = np.diff(values[-3:]) / np.diff(places[-3:])
    curvature = (slopes[-1] - slopes[0]) / (places[-1] - places[-len(slopes) - 1])
    slope = slopes[-1] + curvature * (places[-1] - places[-2])
    root = sqrt(max(slope**2 - 4.0 * values[-1] * curvature, 0.0))
    return float(-2.0 * values[-1] / (slope + copysign(root, slope))), float(slope)


def _unrecorded(name: str, result: Any, begin: float) -> Any:
    """Return the value of a result, of which no work is noted."""
    return result.best.value if isinstance(result, Refinement) else result


def _friction_ratios(solved: ZoneSolution, part: int) -> Array:
    """Return ``y = 1 - s**2`` at places in a part, and ``q/(f p)`` there.

    The places are denser around the least value: where the surface begins to slip back inside of
    what sticks, it does so between two of `DISTANCES`.
    """
    depths = -np.log(DISTANCES)
    for _ in range(3):
        i = int(np.argmin(_friction_ratios_at(solved, part, depths)[1]))
        around = depths[[max(i - 1, 0), min(i + 1, len(depths) - 1)]]
        depths = np.union1d(depths, np.linspace(around[0], around[1], SAMPLES))
    return _friction_ratios_at(solved, part, depths)


def _friction_ratios_at(solved: ZoneSolution, part: int, depths: Array) -> Array:
    """Return ``1 - s**2`` and ``q/(f p)`` at depths ``x = -ln d`` in a part."""
    distances = np.exp(-depths)
    points = solved.system.parts[part].mesh.points(distances)
    bound = solved.system.parameters.friction * solved.pressures[part](distances)
    return np.array([points.y, np.sqrt(points.z) * solved.shears[part](distances) / bound])


def _reverse_margin(solved: ZoneSolution) -> float:
    """Return the least ``q/(f p) + 1`` in the zones that stick with memory."""
    ratios = [_friction_ratios(solved, k)[1] for k in solved.system.known_displacement]
    return float(np.concatenate(ratios).min()) + 1.0
