"""Partial slip, (5.8) in its true form: the zones that satisfy the friction law.

One stick disk is tried first.

The problem is a strictly convex minimisation under |q| <= f p, so a traction that satisfies all
conditions is the solution; how it was guessed does not matter.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from math import inf
from time import perf_counter
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from spectral_contact.contact.drive import Drive
from spectral_contact.contact.layout import Layout
from spectral_contact.contact.one_disk import OneDisk, solve_one_disk
from spectral_contact.contact.ratio import FullStick
from spectral_contact.contact.refine import Refinement, refine
from spectral_contact.contact.slip_outcome import (
    PartialSlip,
    all_slip,
    no_slip,
    one_disk_outcome,
    zones_outcome,
)
from spectral_contact.contact.stick_radius import NoStickDiskError
from spectral_contact.fields.series import Radius
from spectral_contact.records import PARTIAL_SLIP, SLIP_FIELD, ZONE_SEARCH
from spectral_contact.spectral.parameters import Parameters

if TYPE_CHECKING:
    from spectral_contact.contact.coupled_assessment import CoupledZones

__all__ = ["solve_partial_slip"]

Array = NDArray[np.float64]
Record = Callable[[str, Any, float], Any]

#: What tolerance of the traction one of shear and stick radius takes, as a power of it: of 216
#: scenes of sweeps at 1e-8 and 1e-12 none is solved again, 43 are with 0.5.
_SUPERCONVERGENCE = 0.52
#: Narrower zones than this, in logits, are not handed on: their slopes change within their width.
_NARROWEST = 1e-3
#: Where the edge of a smooth surface sticks over less than this, in ``y``, it is one disk.
_NO_EDGE = 1e-80
#: No scene is known to have more than four zones; at the onset of slip noise looks like many more.
_MOST_ZONES = 6
#: How often rings at boundaries are split into four.
_SPLITS = 3


def solve_partial_slip(
    drive: Drive,
    stick: FullStick,
    beta: float,
    friction: float,
    tolerance: float,
    max_unknowns: int,
    *,
    record: Record,
    near: Layout | None = None,
    pointwise: bool = True,
) -> PartialSlip:
    """Find traction and zones below the critical friction.

    Parameters
    ----------
    drive : Drive
        Right-hand side, from the normal problem.
    stick : FullStick
        The full-stick solution.
    beta : float
        ``beta*``.
    friction : float
        ``f / kappa``, below the critical value.
    tolerance : float
        Bound on the relative error of q/s.
    max_unknowns : int
        Most unknowns of a space.
    record : callable
        Takes the name of a step, its outcome and its beginning, returns the value.
    near : Layout, optional
        Where the search begins, as `PartialSlip.layout` of a like scene has it.
    pointwise : bool
        Whether the tolerance bounds q/s. If not, and slip is inside, it bounds the total shear
        and the stick radius, which need less.

    Returns
    -------
    PartialSlip
    """
    run = _Search(drive, stick, beta, friction, tolerance, max_unknowns, record, near, pointwise)
    return run.outcome()


@dataclass(slots=True)
class _Search:
    """One stick disk first; then what the active set finds; the least violation wins."""

    drive: Drive
    stick: FullStick
    beta: float
    friction: float
    tolerance: float
    max_unknowns: int
    record: Record
    near: Layout | None
    pointwise: bool

    def outcome(self) -> PartialSlip:
        """Return the best outcome; full stick where it fails and the errors decide on slip."""
        best = self._best()
        error = max(best.traction_error if self.pointwise else 0.0, best.shear_error)
        failed = not best.consistent or error > self.tolerance
        critical = self.stick.critical * (1.0 - self.stick.critical_error)
        if failed and self.friction > critical:
            return no_slip(self.stick, self._parameters)
        return best

    def _best(self) -> PartialSlip:
        """Return the first outcome that satisfies the friction law.

        Zones of a like scene come first, then one stick disk, then a search.
        """
        handed = self._handed_on()
        if handed is not None:
            return handed
        first = self._first()
        if first is not None:
            alone = first.layout is None or self.beta == 0.0 or self._smooth
            if alone or first.settled:
                return first
        return self._least_wrong(first, self._searched(first))

    @property
    def _smooth(self) -> bool:
        """Whether p is infinite at the edge and q is not.

        It sticks there for ``y < (f beta/kappa)**2``, as long as that is a number.
        """
        return self.drive.contact.compliance == 0.0 and self.beta > 0.0

    @property
    def _parameters(self) -> Parameters:
        return Parameters(self.drive.contact.compliance, self.beta, 1.0, self.friction)

    def _first(self) -> PartialSlip | None:
        """Return one stick disk, or what is known to be there instead."""
        if self._smooth and (self.friction * self.beta) ** 2 >= _NO_EDGE:
            return None
        near = None
        if self.near is not None and self.near.states == (0, 1) and self.near.slopes is not None:
            near = self.near.logits[0], float(self.near.slopes[0, 0])
        try:
            return self._one_disk(None, near)
        except NoStickDiskError as missing:
            if missing.at_centre:
                return all_slip(self.drive, self.beta, self.friction, self.tolerance)
            if self.beta == 0.0:
                return no_slip(self.stick, self._parameters)
            return None

    def _least_wrong(self, first: PartialSlip | None, searched: list[PartialSlip]) -> PartialSlip:
        """Return the outcome that violates the law least."""
        found = [] if first is None else [first]
        if first is not None and first.consistent:
            # but for the sense of slip, of which no digit is known
            searched = [one for one in searched if one.consistent and one.slip_error < inf]
        found += searched
        if not found:  # slip about to start, thinner than its own conditioning
            return no_slip(self.stick, self._parameters)
        best = min(found, key=lambda outcome: outcome.violation)
        if best.missing:  # a zone may be missing, of which the errors of its neighbours say nothing
            best = replace(best, zones_error=max(best.zones_error, 1.0))
        return best

    def _one_disk(
        self, guess: float | None, near: tuple[float, float] | None = None
    ) -> PartialSlip:
        begin = perf_counter()
        refinement = solve_one_disk(
            self.drive,
            self.beta,
            self.friction,
            self.tolerance,
            self.max_unknowns,
            guess=guess,
            near=near,
        )
        disk: OneDisk = self.record(PARTIAL_SLIP, refinement, begin)
        begin = perf_counter()
        outcome = one_disk_outcome(self.drive, disk, self.beta, self.friction, self.tolerance)
        result: PartialSlip = self.record(SLIP_FIELD, outcome, begin)
        return result

    def _searched(self, first: PartialSlip | None) -> list[PartialSlip]:
        """Solve on further zones, until the friction law holds on some."""
        outcomes: list[PartialSlip] = []
        for layout in self._layouts(first):
            while layout is not None:
                outcome = self._on(layout)
                layout = None
                if outcome is not None:
                    outcomes.append(outcome)
                    if outcome.settled:
                        return outcomes
                    layout = outcome.mended
        return outcomes

    def _layouts(self, first: PartialSlip | None) -> Iterator[Layout | None]:
        """Guess zones: where one disk lacks stick, then others, of every kind once."""
        seen: set[tuple[int, ...]] = set()
        if first is not None:
            seen.add((0, 1))
            yield first.mended
        for layout in self._guesses(None if first is None else first.zones[0].outer):
            if layout.states not in seen:
                seen.add(layout.states)
                yield layout

    def _guesses(self, radius: float | None) -> Iterator[Layout]:
        """Yield zones on rings, and those where full stick breaks the law, which rings may miss.

        The radius of one disk is for disks smaller than a ring.
        """
        from spectral_contact.contact.active_set import ring_layout
        from spectral_contact.contact.onset import exceeded, is_narrow

        alpha, beta, _, friction = self._parameters
        slips = exceeded(self.stick, self._parameters)
        if is_narrow(slips):
            yield slips
        found = ring_layout(alpha, beta, friction, 1.0, False, splits=_SPLITS)
        logits = tuple(one.logit for one in found.boundaries)
        if found.centre_unseen:  # c = 2 beta f / kappa as f -> 0
            centre = 2.0 * beta * friction if radius is None else radius
            yield Layout((Radius(centre, 1.0 - centre).logit, *logits), (0, *found.states))
        elif found.states[-1] == 0 or not self._smooth:  # a smooth edge sticks, if below rings
            yield Layout(logits, found.states)
        yield slips

    def _on(self, layout: Layout) -> PartialSlip | None:
        """Return the solution on zones like these, if there is one."""
        begin = perf_counter()
        if layout.states == (0, 1):
            try:
                return self._one_disk(layout.logits[0])
            except NoStickDiskError:
                return None
        if layout.states == (0,) or len(layout.states) > _MOST_ZONES:
            return None
        try:
            refinement = self._zones(layout)
        except (
            np.linalg.LinAlgError,
            ArithmeticError,
        ):  # a zone about to vanish: its ends coincide
            return None
        zones: CoupledZones = self.record(ZONE_SEARCH, refinement, begin)
        return zones_outcome(zones, self._parameters, self.drive)

    def _zones(self, layout: Layout) -> Refinement[CoupledZones]:
        """Solve on zones like these."""
        from spectral_contact.contact.boundaries import NoBoundariesError

        if self.pointwise:
            return self._solved(layout, self.tolerance)
        loose = self._solved(layout, self.tolerance**_SUPERCONVERGENCE)
        solved = loose.best.value
        if max(solved.shear_error, solved.radius_error) <= self.tolerance:
            return loose
        try:
            return self._solved(solved.layout, self.tolerance)
        except NoBoundariesError:  # nothing better is found near by
            return loose

    def _solved(self, layout: Layout, tolerance: float) -> Refinement[CoupledZones]:
        """Solve on zones like these, with fields to a tolerance."""
        from spectral_contact.contact.coupled_problem import CoupledProblem

        # the search for boundaries that are not there ends at the edge, past rounding
        with np.errstate(all="ignore"):
            problem = CoupledProblem(
                self._parameters, layout, tolerance, drive=self.drive, goal=self.tolerance
            )
            return refine(problem, tolerance, self.max_unknowns)

    def _handed_on(self) -> PartialSlip | None:
        """Solve on the zones of a like scene, and return it if the friction law holds on them.

        There is one solution, so that it does not matter where these zones are from.
        """
        layout = self.near
        if layout is None or min(np.diff(layout.logits), default=0.0) <= _NARROWEST:
            return None
        begin = perf_counter()
        try:
            refinement = self._zones(layout)
        except (np.linalg.LinAlgError, ArithmeticError):  # they have other zones
            return None
        zones = refinement.best.value
        outcome = zones_outcome(zones, self._parameters, self.drive)
        error = max(zones.traction_error if self.pointwise else 0.0, zones.shear_error)
        if not outcome.settled or outcome.slip_error == inf or error > self.tolerance:
            return None
        self.record(ZONE_SEARCH, refinement, begin)
        return outcome
