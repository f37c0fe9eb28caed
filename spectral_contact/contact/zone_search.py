"""Which zones partial slip has: guesses are solved for until one obeys the friction law.

How zones were guessed does not matter then. Without elastic coupling the problem is a strictly
convex minimisation under |q| <= f p: a traction that satisfies all conditions is the solution. With
it uniqueness is not proved, and no search is known to be sure.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from math import exp, inf, log, sqrt
from time import perf_counter
from typing import TYPE_CHECKING, Any

import numpy as np

from spectral_contact.contact.layout import Layout, NoBoundariesError, unmoved
from spectral_contact.contact.ratio import FullStick
from spectral_contact.contact.refine import Refinement, refine
from spectral_contact.contact.resolution import EPSILON_DEPTH, NormalContact
from spectral_contact.contact.slip_outcome import (
    PartialSlip,
    everywhere,
    no_slip,
    zones_outcome,
)
from spectral_contact.contact.stick_radius import NoStickDiskError, limiting_logit
from spectral_contact.contact.tuning import MIN_SMOOTH_LOGIT, ONSET_BAND
from spectral_contact.contact.zone_fields import least_radius, to_the_centre
from spectral_contact.contact.zone_problem import (
    FreeBoundaryProblem,
    solve_zones,
)
from spectral_contact.fields.series import Radius, ZonalField
from spectral_contact.records import PARTIAL_SLIP, SLIP_FIELD, ZONE_SEARCH
from spectral_contact.spectral.parameters import Parameters
from spectral_contact.threads import cached_property

if TYPE_CHECKING:
    from spectral_contact.contact.error_estimate import ZoneSolution

Record = Callable[[str, Any, float], Any]

#: What tolerance of the traction one of shear and stick radius takes, as a power of it: of 216
#: scenes of sweeps at 1e-8 and 1e-12 none is solved again, 43 are with 0.5.
_SUPERCONVERGENCE = 0.52
#: Narrower zones than this, in logits, are not handed on: their slopes change within their width.
_NARROWEST = 1e-3
#: Where the edge of a smooth surface sticks over less than this, in ``y``, it is one disk.
_NO_EDGE = 1e-80
#: What a pressure ``s**-e / sqrt(1 - s**2)`` lacks, of ``kappa f s**2``: 2, measured.
_BESIDE = 5.0
#: Stick at a smooth edge is matched where that is expected to err by as many tolerances, or by so
#: little: panels leave 1e-9 of a width of 1e-20, and 4e-7 of 1e-24.
_ROUGHLY, _TOO_NARROW = 10.0, 1e-8
#: No scene is known to have more than four zones; at the onset of slip noise looks like many more.
_MOST_ZONES = 6
#: One stick disk of which nothing is known, and one with narrow slip.
_DISK, _WIDE_DISK = Layout((), (0, 1)), Layout((2.0,), (0, 1))
#: From where on another stick radius is looked for, and in which steps, as logits; on smooth
#: surfaces they are 10 apart and more, measured.
_CLEAR, _APART = 1.0, 4.0
#: Friction that lacks less than this lets no more slip than where full stick exceeds it: to 0.01 in
#: the logit, measured, where it lacks half as much. Rough spaces have slip to as much in the logit.
_ABOUT = 0.02


#: The logit of a stick disk whose radius is rounding: it has all the slip of a smaller one.
_POINT = -2.0 * EPSILON_DEPTH


class NoZonesError(ArithmeticError):
    """No guess of the zones obeys the friction law; the text says what is amiss with each.

    Attributes
    ----------
    best : PartialSlip or None
        The guess that breaks the law least, if one was solved for.
    """

    best: PartialSlip | None = None


def _worst(outcome: PartialSlip) -> float:
    """Return the largest error estimate that a tolerance bounds."""
    return max(
        outcome.approach_error, outcome.shear_error, outcome.pressure_error, outcome.traction_error
    )


@dataclass(eq=False)
class ZoneSearch(ABC):
    """Solves for guesses until the friction law holds.

    Parameters
    ----------
    parameters : Parameters
    stick : FullStick
        Full stick, with its fields.
    tolerance : float
        Bound on the relative errors of the fields.
    max_unknowns : int
        Most unknowns of a space.
    record : callable
        Takes the name of a step, its outcome and its beginning, returns the value.
    near : Layout, optional
        Zones that come first, as `PartialSlip.layout` of a like scene has them.
    """

    parameters: Parameters
    stick: FullStick
    tolerance: float
    max_unknowns: int
    record: Record
    near: Layout | None = field(default=None, kw_only=True)
    _reasons: list[str] = field(default_factory=list, init=False)

    def outcome(self) -> PartialSlip:
        """Return the first outcome that obeys the friction law, or the best that will do."""
        found = []
        # the search for boundaries that are not there ends at the edge, past rounding
        with np.errstate(all="ignore"):
            for one in self._tried():
                if one.settled:
                    return one
                found.append(one)
        return self._least_wrong(found)

    def _tried(self) -> Iterator[PartialSlip]:
        """Solve for guesses, of every kind once, and for what mends them."""
        seen: set[tuple[int, ...]] = set()
        for guess in self._guesses():
            layout: Layout | None = None if guess.states in seen else guess
            if guess is not _DISK:  # of which no radius is told: a better guess may be
                seen.add(guess.states)
            while layout is not None and self._possible(layout):
                outcome = self._attempted(layout)
                if outcome is None:
                    break
                seen.add(layout.states)
                yield outcome
                layout = outcome.mended

    @cached_property
    def _exceeded(self) -> Layout:
        """Slip where full stick exceeds friction, and stick elsewhere."""
        from spectral_contact.contact.onset import exceeded

        return exceeded(self.stick, self.parameters)

    @property
    def _smooth(self) -> bool:
        """Whether p is infinite at the edge and q is not."""
        return self.parameters.alpha == 0.0 < self.parameters.beta

    @property
    def _smooth_edge(self) -> float:
        """The width in ``y`` over which a smooth edge sticks, but for a factor of about 1."""
        return (self.parameters.friction * self.parameters.beta) ** 2

    @property
    def _edge_sticks(self) -> bool:
        """Whether a smooth edge does, over more than a point."""
        return self._smooth and self._smooth_edge >= _NO_EDGE

    def _to_the_edge(self, logits: list[float], states: tuple[int, ...]) -> Layout:
        """Return zones on rings, with the stick at a smooth edge if that is below all rings."""
        if self._edge_sticks and states[-1] != 0:
            logits, states = [*logits, -log(self._smooth_edge)], (*states, 0)
        return Layout(tuple(logits), states)

    def _attempted(self, layout: Layout) -> PartialSlip | None:
        """Return the solution on zones like these, if there is one."""
        try:
            return self._solved(layout)
        # one of them has no width: its ends coincide
        except (np.linalg.LinAlgError, ArithmeticError) as missing:
            self._reasons.append(f"{len(layout.states)} zones: {missing}")
            return None

    @abstractmethod
    def _guesses(self) -> Iterator[Layout]:
        """Yield zones, the likeliest first."""

    @abstractmethod
    def _possible(self, layout: Layout) -> bool:
        """Return whether there may be zones like these."""

    @abstractmethod
    def _solved(self, layout: Layout) -> PartialSlip:
        """Return the solution on zones like these."""

    @abstractmethod
    def _least_wrong(self, found: list[PartialSlip]) -> PartialSlip:
        """Return the best of those that do not obey the law, or whose sense of slip is unknown."""


@dataclass(eq=False)
class UncoupledSearch(ZoneSearch):
    """The search under a pressure that is given, for kappa = 1.

    Guesses are zones of a like scene, one stick disk and the stick that it lacks, narrow slip where
    full stick breaks the law, and what an active set finds on rings.

    Parameters
    ----------
    known : NormalContact
        The contact whose pressure is known.
    pointwise : bool
        Whether the tolerance bounds q/s. If not, and slip is inside, it bounds the total shear
        and the stick radius, which need less.
    """

    known: NormalContact
    pointwise: bool = True

    def outcome(self) -> PartialSlip:
        """Return the best outcome; full stick where it fails and the errors decide on slip."""
        best = self._handed_on() or super().outcome()
        error = max(best.traction_error if self.pointwise else 0.0, best.shear_error)
        failed = not best.consistent or error > self.tolerance
        critical = self.stick.critical * (1.0 - self.stick.critical_error)
        if failed and self.parameters.friction > critical:
            return no_slip(self.stick, self.parameters)
        return best

    def _handed_on(self) -> PartialSlip | None:
        """Return the solution on the zones of a like scene if the friction law holds on them."""
        layout = self.near
        if layout is None or min(np.diff(layout.logits), default=0.0) <= _NARROWEST:
            return None
        begin = perf_counter()
        try:
            refinement = self._refined(layout)
        except (np.linalg.LinAlgError, ArithmeticError):  # they have other zones
            return None
        zones = refinement.best.value
        outcome = zones_outcome(zones, self.parameters, self.known)
        error = max(zones.traction_error if self.pointwise else 0.0, zones.shear_error)
        if not outcome.settled or outcome.slip_error == inf or error > self.tolerance:
            return None
        self.record(ZONE_SEARCH, refinement, begin)
        return outcome

    def _guesses(self) -> Iterator[Layout]:
        """Yield one disk, and what full stick and rings tell."""
        if not self._edge_sticks:
            near = self.near or _DISK
            yield _DISK if near.jacobian is None or near.states != _DISK.states else near
        if self.parameters.beta == 0.0:
            return
        from spectral_contact.contact.onset import is_narrow

        violated = self._exceeded
        if is_narrow(violated):  # rings miss it
            yield violated
        from spectral_contact.contact.active_set import ring_layout

        found = ring_layout(self.parameters, coupled=False)
        logits, states = [one.logit for one in found.boundaries], found.states
        if found.centre_unseen:  # c = 2 beta f / kappa as f -> 0
            centre = 2.0 * self.parameters.beta * self.parameters.friction
            logits, states = [Radius(centre, 1.0 - centre).logit, *logits], (0, *states)
        yield self._to_the_edge(logits, states)
        yield violated  # rings have a pressure of their own

    def _possible(self, layout: Layout) -> bool:
        """Return whether there may be such zones: without a layer of q there is one stick disk."""
        if self.parameters.beta == 0.0 or (self._smooth and not self._edge_sticks):
            return layout.states == _DISK.states
        return 1 < len(layout.states) <= _MOST_ZONES

    def _least_wrong(self, found: list[PartialSlip]) -> PartialSlip:
        if not found:  # slip about to start, thinner than its own conditioning
            return no_slip(self.stick, self.parameters)
        lawful = [one for one in found if one.consistent]
        best = min(lawful or found, key=lambda outcome: outcome.apparent_violation)
        if best.missing:  # a zone may be missing, of which the errors of its neighbours say nothing
            best = replace(best, zones_error=max(best.zones_error, 1.0))
        return best

    def _solved(self, layout: Layout) -> PartialSlip:
        one_disk = layout.states == _DISK.states
        if one_disk and not layout.logits:
            layout = layout._replace(logits=(limiting_logit(self.parameters),))
        begin = perf_counter()
        try:
            refinement = self._refined(layout)
        except NoStickDiskError as missing:
            if missing.at_centre:
                return self._all_slip()
            raise
        zones: ZoneSolution = self.record(
            PARTIAL_SLIP if one_disk else ZONE_SEARCH, refinement, begin
        )
        begin = perf_counter()
        outcome = zones_outcome(zones, self.parameters, self.known)
        if one_disk:
            self.record(SLIP_FIELD, outcome, begin)
        return outcome

    def _all_slip(self) -> PartialSlip:
        """Return slip everywhere: the stick disk is smaller than 1e-54."""
        solved = self._refined(unmoved(_POINT)).best.value
        outcome = zones_outcome(solved, self.parameters, self.known, felt=False)
        return everywhere(outcome, self.parameters.friction)

    def _refined(self, layout: Layout) -> Refinement[ZoneSolution]:
        """Solve on zones like these."""
        if self.pointwise:
            return self._to(self.tolerance, layout)
        loose = self._to(self.tolerance**_SUPERCONVERGENCE, layout)
        solved = loose.best.value
        if max(solved.shear_error, solved.radius_error) <= self.tolerance:
            return loose
        try:
            return self._to(self.tolerance, solved.layout)
        except NoBoundariesError:  # nothing better is found near by
            return loose

    def _to(self, tolerance: float, layout: Layout) -> Refinement[ZoneSolution]:
        """Solve on zones like these, with fields to a tolerance."""
        with np.errstate(all="ignore"):
            problem = FreeBoundaryProblem(
                self.parameters,
                layout,
                tolerance,
                known=self.known,
                boundary_tolerance=self.tolerance,
            )
            return refine(problem, tolerance, self.max_unknowns)


class CoupledSearch(ZoneSearch):
    """The search with elastic coupling, where pressure and traction are one system.

    Guesses are narrow slip where full stick breaks the law, what an active set finds on rings, all
    slip there, and one stick disk. Of 600 random scenes, half of them at thresholds, none needed
    another one.
    """

    def _tried(self) -> Iterator[PartialSlip]:
        if self.near is not None:
            outcome = self._attempted(self.near)
            if outcome is not None:
                yield outcome
        yield from super()._tried()

    def outcome(self) -> PartialSlip:
        """Return the first outcome that obeys the friction law, or the best that will do.

        Where stick at a smooth edge is so narrow that it is better matched in closed form than
        resolved by panels, that comes first.
        """
        matched = self._matched()
        if matched is not None and matched.settled and _worst(matched) <= self.tolerance:
            return matched
        try:
            best = super().outcome()
        except NoZonesError:
            if matched is None or not matched.settled:
                raise
            return matched
        if matched is not None and matched.settled and _worst(matched) < _worst(best):
            return matched
        return best

    def _matched(self) -> PartialSlip | None:
        """Return one stick disk with stick at the edge in closed form, if that may be accurate."""
        from spectral_contact.contact.edge_stick import expected_error, with_edge_stick

        if not self._smooth or least_radius(self.parameters) ** 2 < exp(MIN_SMOOTH_LOGIT):
            return None
        expected = expected_error(self.parameters)
        if expected > max(_ROUGHLY * self.tolerance, _TOO_NARROW):
            return None
        begin, problem = perf_counter(), (self.parameters, _WIDE_DISK, self.tolerance)
        try:
            with np.errstate(all="ignore"):
                layout = FreeBoundaryProblem(*problem).initial_layout()
                zones = solve_zones(self.parameters, layout, self.tolerance, self.max_unknowns)
                solved = perf_counter()
                outcome = with_edge_stick(zones.best.value, self.parameters)
        except (np.linalg.LinAlgError, ArithmeticError) as missing:
            self._reasons.append(f"a narrow edge: {missing}")
            return None
        if outcome.settled and not outcome.amiss:
            self.record(PARTIAL_SLIP, zones, begin + perf_counter() - solved)
            self.record(SLIP_FIELD, outcome, solved)
            return outcome
        self._reasons.append(f"a narrow edge: {outcome.amiss or 'the friction law is broken'}")
        return None

    def others(self, logit: float) -> list[float]:
        """Return what other stick radii than that of a solution there may be, roughly.

        Where full stick slips at the edge there is an even number of them; none, as far as seen.
        So they are looked for where the edge sticks in full stick, or opens. Only larger ones are:
        from small disks on, which is where friction, or the load, begins, the first is reached.
        """
        from spectral_contact.contact.coupled_radii import scanned, stick_radii

        ratio = self.stick.edge_ratio
        if not self._possible(_DISK) or (ratio is not None and ratio >= self.parameters.friction):
            return []
        problem = FreeBoundaryProblem(self.parameters, _WIDE_DISK, self.tolerance)
        further = scanned(problem, logit + _CLEAR, _APART)
        found = stick_radii(problem, further, contacts=True)
        return [Radius.from_logit(one.logit).value for one in found if one.possible]

    def _guesses(self) -> Iterator[Layout]:
        """Yield slip by full stick where it is narrow, zones on rings, and one disk."""
        from spectral_contact.contact.active_set import ring_layout
        from spectral_contact.contact.onset import is_narrow

        violated = self._exceeded
        if is_narrow(violated):  # rings miss it, or its place
            yield violated
        found = ring_layout(self.parameters, coupled=True)
        told = (found.settled or self._smooth) and not found.centre_unseen
        if told and found.on_rings.positive:
            yield self._to_the_edge([one.logit for one in found.boundaries], found.states)
        if (
            1.0 - self.parameters.friction / self.stick.critical > ONSET_BAND
        ):  # else full stick will do
            yield violated
        yield _DISK._replace(logits=violated.logits[:1]) if violated.logits else _WIDE_DISK

    def _possible(self, layout: Layout) -> bool:
        """Return whether there is slip, and the edge may be as it is.

        That of a smooth surface sticks with tangential compliance.
        """
        if len(layout.states) == 2:
            return not self._smooth
        return len(layout.states) > 2 and self.parameters.beta > 0.0

    def _least_wrong(self, found: list[PartialSlip]) -> PartialSlip:
        lawful = [one for one in found if not one.amiss]
        if (
            not lawful
            and self._smooth
            and least_radius(self.parameters) ** 2 < exp(MIN_SMOOTH_LOGIT)
        ):
            return self._all_slip()
        if not lawful:
            unseen = f"the edge sticks over some {self._smooth_edge:.0e}, too little to resolve"
            reasons = [*self._reasons, *(one.amiss for one in found)]
            missing = NoZonesError("; ".join(reasons or [unseen]))
            missing.best = min(found, key=lambda outcome: outcome.apparent_violation, default=None)
            raise missing
        return min(lawful, key=lambda outcome: outcome.apparent_violation)

    def _solved(self, layout: Layout) -> PartialSlip:
        begin, problem = perf_counter(), (self.parameters, layout, self.tolerance)
        try:
            if layout is not self.near:
                layout = self._narrowed(FreeBoundaryProblem(*problem).initial_layout())
        except NoStickDiskError as missing:
            if missing.at_centre:
                return self._all_slip()
            raise
        zones = solve_zones(self.parameters, layout, self.tolerance, self.max_unknowns)
        if not zones.best.error < 0.5:
            raise NoZonesError("no digit of the fields is known")
        solved = perf_counter()
        outcome = zones_outcome(zones.best.value, self.parameters)
        if not outcome.amiss:
            self.record(PARTIAL_SLIP, zones, begin + perf_counter() - solved)
            self.record(SLIP_FIELD, outcome, solved)
        return outcome

    def _narrowed(self, layout: Layout) -> Layout:
        """Return a slip annulus that is narrower than rough spaces see, as full stick shows it.

        Next to the onset all slips where full stick exceeds friction, and hardly anything more.
        """
        lack = 1.0 - self.parameters.friction / self.stick.critical
        if layout.states != _DISK.states or lack >= _ABOUT:
            return layout
        near = self._exceeded
        if near.states != layout.states or near.logits[0] < layout.logits[0] + _ABOUT:
            return layout
        assert layout.jacobian is not None
        # conditions rise as the distance from the edge does
        narrower = exp(layout.logits[0] - near.logits[0])
        return layout._replace(logits=near.logits, jacobian=narrower * layout.jacobian)

    def _all_slip(self) -> PartialSlip:
        """Return slip everywhere but in a disk too small to be felt."""
        from spectral_contact.contact.little_friction import unfelt_disk

        begin = perf_counter()
        zones = solve_zones(*unfelt_disk(self.parameters), self.tolerance, self.max_unknowns)
        self.record(PARTIAL_SLIP, zones, begin)
        begin = perf_counter()
        point = zones_outcome(zones.best.value, self.parameters, felt=False)
        if self.parameters.alpha == 0.0:
            point = self._to_the_centre(point)
        outcome = everywhere(point, self.parameters.friction)
        if self._smooth:  # and the share of the load on an edge that sticks
            outcome = replace(outcome, shear_error=outcome.shear_error + sqrt(self._smooth_edge))
        self.record(SLIP_FIELD, outcome, begin)
        return outcome

    def _to_the_centre(self, outcome: PartialSlip) -> PartialSlip:
        """Return slip on a smooth surface with the pressure that it has next to the centre."""
        from spectral_contact.contact.little_friction import CLEAR, stand_in

        assert isinstance(outcome.pressure, ZonalField)
        clear = CLEAR * stand_in(self.parameters).value
        whole = to_the_centre(outcome.pressure, Radius(clear, 1.0 - clear), self.parameters)
        coupling = self.parameters.kappa * self.parameters.friction
        lost = coupling * (_BESIDE * clear**2 + CLEAR**-3)
        return replace(outcome, pressure=whole, pressure_error=outcome.pressure_error + lost)
