"""The first unloading: zones and fields at a load below the largest one, without coupling.

The punch is flat, so the contact radius is the same at all loads, and the pressure is proportional
to the load. The surface slips by a radial displacement u_r relative to the punch. Where it has
slipped under growing load and sticks now, it keeps the u_r that slip has left it with; where it has
not slipped, u_r is zero. So the state at the load ratio lambda (the load over the largest one)
solves the same equations as that at the largest load, with a known displacement in what sticks
(`spectral.contact_system`). Fields are divided by lambda: the pressure is that of unit load, and
the displacement that is kept is ``1/lambda`` times that at the largest load.

From the centre outward there are these zones:

- stick, where the surface has never slipped, and q follows the load;
- *forward* slip in the sense of loading, q = +f p. In the slip at the largest load q equals f p. If
  the surface stuck everywhere as the load falls, q would fall by the traction of full stick; where
  that is less than f p, f p falls faster, and the surface slips on. So this zone reaches from the
  boundary of slip at the largest load, or a little inside of it, to somewhat beyond the radius at
  which the traction of full stick is f p;
- stick with memory, where the surface has slipped under growing load;
- below the *reverse ratio* of loads, slip back, q = -f p: at the edge, or in an annulus with stick
  on both sides.

Where the edge sticks at the largest load, too, there is forward slip around both boundaries of the
slip that was, and the outermost zone has never slipped.

The state does not depend on the loads in between as long as all slip zones have only grown: then no
point that slips now has stuck in between, and no point that sticks has slipped in between. The
largest load ratio at which a boundary of a slip zone reverses its motion is the *turning ratio*,
which is below the reverse ratio. At smaller loads the state depends on the loads in between.

Symbols are those of docs/theory.md: p and q are pressure and traction, f is friction, and f_crit
the least friction under which the largest load sticks everywhere. Tractions are divided by kappa,
the factor by which pressure drives radial displacement, so that kappa is 1 here. The logit of a
radius s, in contact radii, is ``ln(s**2/(1 - s**2))``. A zone is meshed in parts, each graded to
one boundary: zone k has the parts ``2k - 1``, graded to its inner boundary, and ``2k``, graded to
its outer one; zone 0, around the centre, has the latter alone.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from itertools import pairwise
from math import copysign, exp, inf, log, pi, sqrt
from time import perf_counter
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from spectral_contact.contact.free_boundary import JACOBIAN_FIELD_TOL
from spectral_contact.contact.friction_law import DISTANCES, excused_excess
from spectral_contact.contact.layout import Layout, NoBoundariesError, logit_at
from spectral_contact.contact.normal import NormalContact
from spectral_contact.contact.onset import slip_where_exceeded
from spectral_contact.contact.refine import Refinement, refine
from spectral_contact.contact.slip_outcome import PartialSlip, zones_outcome
from spectral_contact.contact.tuning import (
    COARSE_TOL,
    MAX_STEPS,
    SAMPLES,
    SLIP_ROUNDING,
    TRACTION_ROUNDING,
)
from spectral_contact.contact.zone_problem import FreeBoundaryProblem
from spectral_contact.contact.zone_search import Candidate, NoZonesError, ZoneSearch
from spectral_contact.fields.series import Array
from spectral_contact.fields.shakedown import shakedown
from spectral_contact.records import UNLOADING
from spectral_contact.spectral.contact_fields import KnownDisplacement
from spectral_contact.spectral.factored import factored
from spectral_contact.threads import cached_property

if TYPE_CHECKING:
    from spectral_contact.contact.zone_search import Record, UncoupledSearch
    from spectral_contact.contact.zone_solution import ZoneSolution


class ZoneGrowth(NamedTuple):
    """Whether slip zones grow as the load falls.

    Attributes
    ----------
    changes : ndarray, shape (boundaries,)
        The derivative of ``|q|/f - p`` by ``-ln(load)`` at every boundary, on the side that sticks,
        for unit load and with zones held fixed. It is positive where slip grows.
    least : float
        The least of the changes.
    error : float
        Estimate of the error of `least`.
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
    loaded : PartialSlip
        The state at the largest load.
    before : KnownDisplacement
        The slip displacement at the largest load, divided by the load ratio. It counts
        where the surface sticks with memory.
    load_ratio : float
        Below 1. It determines which zones are tried first; in the equations it is in `before`.
    """

    contact: NormalContact
    loaded: PartialSlip
    before: KnownDisplacement
    load_ratio: float
    #: the latest solution, refuted or not: `_candidates` goes on from it, after `_solve` has set it
    solved: ZoneSolution | None = field(default=None, init=False)

    @cached_property
    def _slip_where_stick_violates(self) -> Layout:
        """Slip where the law would be violated if the surface stuck everywhere as the load falls.

        Then the traction falls by that of full stick, in proportion to the load.
        """
        stick_traction = self.stick.traction
        assert stick_traction is not None

        def traction(s: Array, from_edge: Array) -> Array:
            change = (self.load_ratio - 1.0) * stick_traction(s, from_edge)
            return (self.loaded.traction(s, from_edge) + change) / self.load_ratio

        # forward slip begins at the boundaries of the slip at the largest load
        assert self.loaded.layout is not None
        depths = np.logaddexp(0.0, self.loaded.layout.logits).tolist()
        return slip_where_exceeded(self.stick, self.parameters, traction=traction, depths=depths)

    @property
    def forward_zones(self) -> Layout:
        """The zones of `_slip_where_stick_violates`, with stick in place of slip back."""
        return _without_reverse_slip(self._slip_where_stick_violates)

    def _candidates(self) -> Iterator[Candidate]:
        """Yield candidates: the zones at a similar load, and slip where stick violates the law."""
        if self.warm_start is not None:
            yield Candidate(self.warm_start, "the zones at similar loads", predicted=True)
        for zones, reason in (
            (self._slip_where_stick_violates, "slip where sticking would exceed the friction"),
            (self.forward_zones, "the same without slip back"),
        ):
            yield Candidate(zones, reason)
            if self.solved and (missing := _with_missing_slip(self.solved)):
                yield Candidate(
                    missing, "the zones solved last, with slip where friction is exceeded"
                )

    def _is_possible(self, zones: Layout) -> bool:
        """Return whether there may be such zones: at least three, with stick at the centre.

        The zone that has not slipped is surrounded by forward slip and by stick with memory. At
        least one of two neighbours sticks.
        """
        states = zones.states
        return states[0] == 0 and len(states) >= 3 and all(0 in pair for pair in pairwise(states))

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
        solved = refinement.best.value
        outcome = zones_outcome(solved, self.parameters, self.contact)
        # In Newton's method a slip zone may shrink to no width. The traction in its place then
        # exceeds friction by less than its error, so that the law seems to hold. But Q lacks the
        # slip there, and no digit of the zones is known.
        if refinement.best.error > self.tolerance and (
            candidate.predicted or outcome.zones_error >= 1.0
        ):
            raise NoBoundariesError("the tolerance is not met from these boundaries")
        self.record(UNLOADING, refinement, begin)
        self.solved = solved
        if _reverse_margin(solved) < -excused_excess(outcome.traction_error):
            raise NoBoundariesError("the surface would slip back in what sticks")
        return outcome

    def solve_zones(self, zones: Layout) -> ZoneSolution:
        """Return the solution on zones of these states; Newton's method begins with these zones.

        The friction law is not checked.

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

    def followed(self, zones: Layout | None) -> ZoneSolution:
        """Return the solution that `solve_zones` finds from zones, or else that of the search.

        Only the search checks the friction law.

        Parameters
        ----------
        zones : Layout or None
            Those at a similar load; without any the search is made.

        Raises
        ------
        NoZonesError
            If the friction law holds on no zones that are tried.
        """
        if zones is not None:
            with suppress(NoZonesError):
                return self.solve_zones(zones)
        self.outcome()
        assert self.solved is not None
        return self.solved

    def _least_wrong(self, outcomes: list[PartialSlip]) -> PartialSlip:
        """Refuse: there are no zones that could stand for those on which the law holds.

        Raises
        ------
        NoZonesError
        """
        verdicts = "; ".join(trial.text for trial in self._trials)
        raise NoZonesError(
            f"no zones were found that obey the friction law ({verdicts or 'slip is too narrow'})"
        )

    def growth(self, solved: ZoneSolution) -> ZoneGrowth:
        """Return whether the slip zones grow at their ends as the load falls.

        Suppose that the zones stay fixed while the load falls. At an end of a slip zone
        ``|q| - f p`` is zero, and negative beyond, in what sticks. On that side it begins to rise
        or to fall. If it rises, the end moves into what sticks, by the rise over the slope of
        ``|q| - f p``, which is finite as q is continuous there.

        With zones fixed and unit load, the jump of q at an end is ``J0 + J1/lambda``: J0 comes from
        the pressure and is the same at all loads, J1 from the displacement that is kept. The
        derivative by ``-ln(lambda)`` is ``J1/lambda``. At this load, where the jump is zero, that
        is ``-J0``, which is found by solving without the displacement.

        Raises
        ------
        NoZonesError
            If that has no solution.
        """
        zones = solved.layout
        logits = np.array(zones.logits)
        # under the pressure alone the traction jumps by J0 at the ends
        without_memory = FreeBoundaryProblem(self.parameters, zones, COARSE_TOL, known=self.contact)
        try:
            system = without_memory.system(without_memory.spaces(COARSE_TOL, logits), logits)
            factors = factored(system)
        except (np.linalg.LinAlgError, ArithmeticError) as error:
            raise NoZonesError(str(error)) from None
        values = factors.unit_solutions[:, 0]
        coarse_difference = factors.coarse_differences(values, system)[0]
        states = np.array(zones.states)
        # one of the two zones at a boundary sticks, and its state is 0
        senses = states[1:] + states[:-1]
        # |q|/f in what sticks less p, where `jump_rows` are q in what sticks less +-f p
        jumps = senses[:, None] * system.jump_rows / self.parameters.friction
        changes = -jumps @ values
        i = int(np.argmin(changes))
        # the slope of |q|/f - p by a logit is of the size of the mean pressure, 1/pi for unit load
        boundary_error = float(solved.logit_errors.max()) / pi
        least_error = abs(float(jumps[i] @ coarse_difference)) + boundary_error
        return ZoneGrowth(changes, float(changes[i]), least_error)


def _with_missing_slip(solved: ZoneSolution) -> Layout | None:
    """Return the zones with one more slip zone, where ``|q| > f p`` in what sticks with memory.

    The outermost zone with memory in which the traction exceeds friction is divided. The slip zone
    reaches from the largest ``|q|/(f p)`` to the next sampled places where it is at most 1, or to
    the edge. None if the traction exceeds friction nowhere, or only next to a zone that slips.
    """
    system = solved.system
    logits = [radius.logit for radius in system.radii]
    states = list(system.states)
    for zone in range(len(states) - 1, 0, -1):
        # both parts of a zone with memory have a known displacement
        if 2 * zone not in system.displacement_coefficients:
            continue
        of_parts = [_friction_ratios(solved, k) for k in (2 * zone - 1, 2 * zone)]
        y, ratio = np.concatenate(of_parts, axis=1)
        outward = np.argsort(-y)
        y = y[outward]
        ratio = ratio[outward]
        largest = int(np.argmax(np.abs(ratio)))
        obeying = np.flatnonzero(np.abs(ratio) <= 1.0)
        if abs(ratio[largest]) <= 1.0 + SLIP_ROUNDING or not len(obeying):
            continue
        # each is an array of one index, or of none
        inner_end = obeying[obeying < largest][-1:]
        outer_end = obeying[obeying > largest][:1]
        # at the edge the slip has no outer end
        if not len(inner_end) or not (len(outer_end) or zone == len(states) - 1):
            continue
        ends = y[[*inner_end, *outer_end]]
        slip_state = int(np.sign(ratio[largest]))
        # one zone becomes three, or two where the slip reaches to the edge
        states[zone : zone + 1] = [0, slip_state] + [0] * len(outer_end)
        logits[zone:zone] = [logit_at(-log(end)) for end in ends.tolist()]
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
    loaded_search : UncoupledSearch
        The search for the zones at the largest load.
    loaded : PartialSlip
        Its outcome, on zones that were solved for.
    tolerance : float
        Bound on the relative errors of states. The tolerance of `loaded_search` is tighter, and is
        that of the reverse ratio.
    """

    def __init__(
        self, loaded_search: UncoupledSearch, loaded: PartialSlip, tolerance: float
    ) -> None:
        self._parameters = loaded_search.parameters
        self._contact = loaded_search.contact
        self._stick = loaded_search.stick
        self._loaded = loaded
        self._tolerance = loaded_search.tolerance
        self._state_tolerance = tolerance
        self._max_unknowns = loaded_search.max_unknowns
        # the error of the displacement itself, not a relative one
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
        if 1.0 - load_ratio < TRACTION_ROUNDING:  # so is the change of the traction
            raise NoZonesError("the load is the largest one up to rounding")
        search = self._search(load_ratio, record, start=start, tolerance=self._state_tolerance)
        try:
            outcome = search.outcome()
        except NoZonesError:
            with suppress(NoZonesError):
                self._refuse_history(load_ratio)
            raise
        assert search.solved is not None
        growth = search.growth(search.solved)
        if growth.least >= -growth.error:
            return outcome
        try:
            self._refuse_history(load_ratio)
        except NoZonesError:
            raise HistoryError(
                "below the turning ratio, which was not found, it depends on the loads in between"
            ) from None
        raise NoZonesError(
            "forward slip is too narrow to say whether it grows; a tighter rtol may do"
        )

    def _refuse_history(self, load_ratio: float) -> None:
        """Raise an error if a load ratio is below the turning ratio.

        Raises
        ------
        HistoryError
            If it is.
        NoZonesError
            If the turning ratio is not found.
        """
        ratio = self.turning_ratio
        if load_ratio <= ratio.value * (1.0 + ratio.error):
            raise HistoryError(
                f"below the turning ratio {ratio.value:.7g} it depends on the loads in between"
            )

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
            self._loaded,
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

        It is found by the secant method, from the load at which cycles shake down, ``(f_crit -
        f)/(f_crit + f)``: there q would first reach -f p if the surface did not slip while the load
        falls.
        """
        log_ratios = list[float]()
        margins = list[float]()
        critical, friction = self._stick.critical, self._parameters.friction
        log_ratio = log(shakedown(critical, 0.0, friction).ratio)
        zones = self._search(exp(log_ratio)).forward_zones
        for _ in range(MAX_STEPS):
            solved = self._search(exp(log_ratio)).solve_zones(zones)
            zones = solved.layout
            log_ratios.append(log_ratio)
            margins.append(_reverse_margin(solved))
            if len(log_ratios) == 1:
                log_ratio -= COARSE_TOL
                continue
            decrement = margins[-2] - margins[-1]
            if not abs(decrement) > 0.0:
                raise NoZonesError("the least traction in what sticks does not follow the load")
            step = margins[-1] * (log_ratios[-1] - log_ratios[-2]) / decrement
            if abs(step) < self._tolerance:
                error = 2.0 * (solved.traction_error + solved.pressure_error)
                # the slope of the first two points: the last ones are too close together
                slope = (margins[1] - margins[0]) / (log_ratios[1] - log_ratios[0])
                return LoadRatio(exp(log_ratio), error / abs(slope) + self._tolerance), solved
            log_ratio += step
        raise NoZonesError("the load at which slip back begins was not found")

    @cached_property
    def turning_ratio(self) -> LoadRatio:
        """The load ratio below which a slip zone shrinks at one of its boundaries.

        It is looked for below the reverse ratio, since above that the forward slip grows, in all
        cases that were tried. With ``x = ln(reverse ratio/load)``, the width of the slip back is
        proportional to x where it begins at the edge, and to ``sqrt(x)`` where it begins inside.
        The change of `ZoneGrowth.least` is proportional to that width, so that `least` is nearly a
        parabola in ``sqrt(x)``. Its zero is found by Muller's method.
        """
        reverse, solved = self._onset_of_reverse_slip
        tolerance = max(self._tolerance, JACOBIAN_FIELD_TOL)
        growth = self._search(reverse.value).growth(solved)
        sqrt_xs = [0.0]
        leasts = [growth.least]
        sqrt_x = sqrt(COARSE_TOL)
        zones: Layout | None = None
        for _ in range(MAX_STEPS):
            load_ratio = reverse.value * exp(-(sqrt_x**2))
            search = self._search(load_ratio, tolerance=tolerance)
            solved = search.followed(zones)
            zones = solved.layout
            growth = search.growth(solved)
            sqrt_xs.append(sqrt_x)
            leasts.append(growth.least)
            step, slope = _step_to_zero(sqrt_xs, leasts)
            if abs(step) < tolerance:
                # ln(load) changes by 2 sqrt(x) d(sqrt(x))
                error = 2.0 * sqrt_x * (tolerance + 2.0 * growth.error / abs(slope))
                return LoadRatio(load_ratio, error + reverse.error)
            sqrt_x = min(max(sqrt_x + step, sqrt_x / 2.0), 2.0 * sqrt_x)
        raise NoZonesError("the load at which a slip zone turns was not found")


def _step_to_zero(arguments: list[float], values: list[float]) -> tuple[float, float]:
    """Return the step from the last argument to a zero, and the slope at the last argument.

    They are those of the parabola through the last three values, or, of two values, of the line.
    """
    slopes = np.diff(values[-3:]) / np.diff(arguments[-3:])
    # there is one slope of two values, and the curvature is 0
    curvature = (slopes[-1] - slopes[0]) / (arguments[-1] - arguments[-len(slopes) - 1])
    slope = slopes[-1] + curvature * (arguments[-1] - arguments[-2])
    root = sqrt(max(slope**2 - 4.0 * values[-1] * curvature, 0.0))
    return float(-2.0 * values[-1] / (slope + copysign(root, slope))), float(slope)


def _unrecorded(name: str, result: Any, begin: float) -> Any:
    """Return the value of a result; keep no record of the work that it took (see `ZoneSearch`)."""
    return result.best.value if isinstance(result, Refinement) else result


def _friction_ratios(solved: ZoneSolution, part: int) -> Array:
    """Return two rows: ``y = 1 - s**2`` at places in a part, and ``q/(f p)`` there.

    The places are `DISTANCES`, and more that three passes add around the least ratio, as slip back
    may begin between two of `DISTANCES`. Where q exceeds +f p, it does so next to a boundary, to
    which the places are graded.
    """
    depths = -np.log(DISTANCES)
    for _ in range(3):
        i = int(np.argmin(_friction_ratios_at(solved, part, depths)[1]))
        around = depths[[max(i - 1, 0), min(i + 1, len(depths) - 1)]]
        depths = np.union1d(depths, np.linspace(around[0], around[1], SAMPLES))
    return _friction_ratios_at(solved, part, depths)


def _friction_ratios_at(solved: ZoneSolution, part: int, depths: Array) -> Array:
    """Return two rows, ``1 - s**2`` and ``q/(f p)``, at depths ``x = -ln d`` in a part.

    d is the distance from the boundary of the part, over its extent (`contact.resolution`).
    """
    distances = np.exp(-depths)
    points = solved.system.parts[part].mesh.points(distances)
    bound = solved.system.parameters.friction * solved.pressures[part](distances)
    return np.array([points.y, np.sqrt(points.z) * solved.shears[part](distances) / bound])


def _reverse_margin(solved: ZoneSolution) -> float:
    """Return the least ``q/(f p) + 1`` in zones that stick with memory; infinity without any."""
    # the parts with memory are those with a known displacement
    parts = solved.system.displacement_coefficients
    return min((float(_friction_ratios(solved, k)[1].min()) for k in parts), default=inf) + 1.0
