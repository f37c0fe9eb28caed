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

from spectral_contact.adaptive import Refinement
from spectral_contact.contact.drive import Drive
from spectral_contact.contact.friction_law import (
    Interval,
    displacement_error,
    known_share,
    missing_stick,
    obeys,
    stick_excess,
    unknown_slip,
)
from spectral_contact.contact.full_stick import FullStick
from spectral_contact.contact.layout import Layout
from spectral_contact.contact.one_disk import OneDisk, solve_one_disk
from spectral_contact.contact.resolution import ROUNDING
from spectral_contact.contact.slip_displacement import (
    Slipping,
    annulus_between,
    slip_displacement,
    slip_misfit,
)
from spectral_contact.contact.stick_radius import NoStickDiskError
from spectral_contact.fields import (
    CENTRE,
    EDGE,
    AnnulusSeries,
    DiskSeries,
    Radius,
    ZonalField,
    ZonePiece,
)
from spectral_contact.solution import PARTIAL_SLIP, SLIP_FIELD, ZONE_SEARCH, Zone
from spectral_contact.spectral.annulus import Annulus

if TYPE_CHECKING:
    from spectral_contact.contact.zones import ZonesSolution

__all__ = ["PartialSlip", "solve_partial_slip"]

Array = NDArray[np.float64]
Record = Callable[[str, Any, float], Any]

#: By how much the law may be broken where no digit of the slip is known: a missing zone breaks it
#: by 1, and zones that follow from less are made of noise.
_DOUBTFUL = 0.5
#: What tolerance of the traction one of shear and stick radius takes, as a power of it.
_SUPERCONVERGENCE = 0.8
#: Narrower zones than this, in logits, are not handed on: their slopes change within their width.
_NARROWEST = 1e-3
#: No scene is known to have more than four zones; at the onset of slip noise looks like many more.
_MOST_ZONES = 6


@dataclass(frozen=True, slots=True)
class PartialSlip:
    """Traction, zones and displacement for kappa = 1, with estimates of relative errors.

    Attributes
    ----------
    zones : tuple of Zone
    traction, slip : ZonalField
    total_shear : float
    traction_error, shear_error, radius_error, zones_error, slip_error : float
    violation : float
        By how much the friction law is broken, see `ErrorEstimates`.
    consistent : bool
        Whether the violation is within the errors.
    searched : bool
        Whether one stick disk was not enough.
    missing : tuple of (float, float)
        Intervals of ``y = 1 - s**2``, outward, in which slip has the wrong sense: stick is missing.
    layout : Layout or None
        Where a like scene may begin, if these zones were solved for.
    """

    zones: tuple[Zone, ...]
    traction: ZonalField
    slip: ZonalField
    total_shear: float
    traction_error: float
    shear_error: float
    radius_error: float
    zones_error: float
    slip_error: float
    violation: float
    consistent: bool
    searched: bool
    missing: tuple[Interval, ...] = ()
    layout: Layout | None = None

    @property
    def settled(self) -> bool:
        """Whether there is nothing to search for: the friction law holds, and that is known."""
        known = self.slip_error < inf or self.violation <= _DOUBTFUL
        return self.consistent and known and not self.missing


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
            return _no_slip(self.drive, self.stick, self.beta, self.friction)
        return best

    def _best(self) -> PartialSlip:
        """Return the first outcome that satisfies the friction law."""
        if self.near is not None and min(np.diff(self.near.logits), default=0.0) > _NARROWEST:
            handed = self._handed_on(self.near)
            if handed is not None:
                return handed
        found: list[PartialSlip] = []
        # on a smooth surface with tangential compliance p is infinite at the edge and q is not:
        # it sticks for y < (f beta/kappa)^2, as long as that is a number
        smooth = self.drive.contact.compliance == 0.0 and self.beta > 0.0
        near = None
        if self.near is not None and self.near.states == (0, 1) and self.near.slopes is not None:
            near = self.near.logits[0], float(self.near.slopes[0, 0])
        if not smooth or (self.friction * self.beta) ** 2 < 1e-80:
            try:
                found.append(self._one_disk(None, near))
            except NoStickDiskError as missing:
                if missing.at_centre:
                    return _all_slip(self.drive, self.beta, self.friction, self.tolerance)
                if self.beta == 0.0:
                    return _no_slip(self.drive, self.stick, self.beta, self.friction)
            if found and (found[0].settled or self.beta == 0.0 or smooth):
                return found[0]
        searched = self._searched(found[0] if found else None)
        if found and found[0].consistent:  # but for the sense of slip, of which no digit is known
            searched = [one for one in searched if one.consistent and one.slip_error < inf]
        found += searched
        if not found:  # slip about to start, thinner than its own conditioning
            return _no_slip(self.drive, self.stick, self.beta, self.friction)
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
        outcome = _one_disk_outcome(self.drive, disk, self.beta, self.friction, self.tolerance)
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
                    layout = _mended(outcome)
        return outcomes

    def _layouts(self, first: PartialSlip | None) -> Iterator[Layout | None]:
        """Guess zones: where one disk lacks stick, then what the active set finds."""
        if first is not None:
            yield _mended(first)
        from spectral_contact.contact.zone_search import search_zones

        radius = None if first is None else first.zones[0].outer
        layout = search_zones(self.drive, self.stick, self.beta, self.friction, radius)
        if first is None or layout.states != (0, 1):
            yield layout

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
        zones: ZonesSolution = self.record(ZONE_SEARCH, refinement, begin)
        return _zones_outcome(self.drive, zones, self.beta, self.friction)

    def _zones(self, layout: Layout) -> Refinement[ZonesSolution]:
        """Solve on zones like these."""
        from spectral_contact.contact.boundaries import NoBoundariesError
        from spectral_contact.contact.zones import solve_zones

        problem = self.drive, self.beta, self.friction
        limits = self.tolerance, self.max_unknowns
        if self.pointwise:
            return solve_zones(*problem, layout, *limits)
        looser = self.tolerance**_SUPERCONVERGENCE
        loose = solve_zones(*problem, layout, looser, self.max_unknowns, self.tolerance)
        solved = loose.best.value
        if max(solved.shear_error, solved.boundary_errors[0][0]) <= self.tolerance:
            return loose
        try:
            return solve_zones(*problem, solved.layout, *limits, self.tolerance)
        except NoBoundariesError:  # nothing better is found near by
            return loose

    def _handed_on(self, layout: Layout) -> PartialSlip | None:
        """Solve on the zones of a like scene, and return it if the friction law holds on them.

        There is one solution, so that it does not matter where these zones are from.
        """
        begin = perf_counter()
        try:
            refinement = self._zones(layout)
        except (np.linalg.LinAlgError, ArithmeticError):  # they have other zones
            return None
        zones = refinement.best.value
        outcome = _zones_outcome(self.drive, zones, self.beta, self.friction)
        error = max(zones.traction_error if self.pointwise else 0.0, zones.shear_error)
        if not outcome.settled or outcome.slip_error == inf or error > self.tolerance:
            return None
        self.record(ZONE_SEARCH, refinement, begin)
        return outcome


def _mended(outcome: PartialSlip) -> Layout | None:
    """Return the zones of a solution with the stick that is missing, if any is."""
    if outcome.layout is None or not outcome.missing:
        return None
    layout = outcome.layout.with_stick(outcome.missing)
    return layout if len(layout.states) > len(outcome.layout.states) else None


def _no_slip(drive: Drive, stick: FullStick, beta: float, friction: float) -> PartialSlip:
    """Return full stick: the slip there is is narrower than what can be resolved."""
    from spectral_contact.contact.onset import unresolved_slip

    radius_error = unresolved_slip(drive, stick, beta, friction)
    error = max(stick.traction_error, drive.contact.pressure_error)
    return PartialSlip(
        (Zone.between("stick", CENTRE, EDGE),),
        ZonalField((ZonePiece(EDGE, stick.traction),)),
        ZonalField((ZonePiece(EDGE, None),)),
        stick.total_shear,
        error,
        stick.shear_error,
        radius_error,
        max(radius_error, 1.0),
        1.0,
        0.0,
        True,
        False,
    )


def _all_slip(drive: Drive, beta: float, friction: float, tolerance: float) -> PartialSlip:
    """Return slip everywhere: the stick disk is smaller than 1e-65."""
    centre = Radius.from_logit(-74.0)
    annulus = _edge_annulus(drive, centre, beta, tolerance)
    misfit = slip_misfit(drive, [annulus], [1], friction, [])
    fields, samples, largest, unresolved = slip_displacement(
        [], [Slipping(annulus, 1, misfit[0])], drive.pressure, beta, friction
    )
    error = drive.contact.pressure_error
    stray = unresolved + 4.0 * error + tolerance * 1e-3
    slip_error = displacement_error(drive, EDGE, stray, beta, friction, largest)
    wrong = float(samples[0].max()) / largest
    return PartialSlip(
        (Zone.between("slip", CENTRE, EDGE),),
        ZonalField((ZonePiece(EDGE, drive.pressure, friction),)),
        ZonalField((ZonePiece(centre, None), ZonePiece(EDGE, fields[0]))),
        friction,
        error,
        2.0 * ROUNDING,
        1.0,
        1.0,
        slip_error,
        max(wrong, 0.0),
        obeys(0.0, error, wrong, slip_error),
        False,
    )


def _edge_annulus(drive: Drive, inner: Radius, beta: float, tolerance: float) -> Annulus:
    """Return the panels of a slip zone that reaches the edge."""
    alpha = drive.contact.compliance
    layers = (min(beta or 1.0, inner.rest, inner.square), alpha or inner.rest)
    return annulus_between(inner, EDGE, layers, tolerance, 0.5 if alpha == 0.0 else 1.0)


def _one_disk_outcome(
    drive: Drive, disk: OneDisk, beta: float, friction: float, tolerance: float
) -> PartialSlip:
    """Add zones, displacement and checks to the one-disk solution."""
    radius = disk.radius
    annulus = _edge_annulus(drive, radius, beta, tolerance)
    pressure = drive.pressure
    misfit = slip_misfit(drive, [annulus], [1], friction, [])
    slipping = Slipping(annulus, 1, misfit[0])
    fields, samples, largest, unresolved = slip_displacement(
        [disk.stuck], [slipping], pressure, beta, friction
    )
    traction = ZonalField((ZonePiece(radius, disk.traction), ZonePiece(EDGE, pressure, friction)))
    slip = ZonalField((ZonePiece(radius, None), ZonePiece(EDGE, fields[0])))
    excess = stick_excess(disk.traction, pressure, friction, CENTRE, radius, disk.depth)
    error = max(disk.traction_error, drive.contact.pressure_error)
    slip_error = displacement_error(drive, EDGE, disk.stray + unresolved, beta, friction, largest)
    violation = max(excess, float(samples[0].max()) / largest, 0.0)
    consistent = obeys(excess, error, float(samples[0].max()) / largest, slip_error)
    return PartialSlip(
        (Zone.between("stick", CENTRE, radius), Zone.between("slip", radius, EDGE)),
        traction,
        slip,
        disk.total_shear,
        error,
        disk.shear_error,
        disk.radius_error,
        max(disk.radius_error, disk.edge_error),
        max(slip_error, unknown_slip(disk.edge_error)),
        violation,
        consistent,
        False,
        missing_stick(annulus, samples[0], largest, fields[0].toward_outer.limit, slip_error),
        Layout((radius.logit,), (0, 1), np.array([[disk.slope]])),
    )


def _zones_outcome(
    drive: Drive, solved: ZonesSolution, beta: float, friction: float
) -> PartialSlip:
    """Add displacement and checks to the solution on any zones."""
    pressure = drive.pressure
    fields, samples, largest, unresolved = slip_displacement(
        solved.stuck, solved.slipping, pressure, beta, friction
    )
    bounds = solved.bounds
    sticks: Iterator[DiskSeries | AnnulusSeries] = iter((solved.disk, *solved.annuli))
    slips = iter(fields)
    traction, displacement, zones, excess = [], [], [], 0.0
    for state, inner, outer in zip(solved.states, bounds[:-1], bounds[1:], strict=True):
        zones.append(Zone.between("stick" if state == 0 else "slip", inner, outer))
        if state == 0:
            stuck = next(sticks)
            traction.append(ZonePiece(outer, stuck))
            displacement.append(ZonePiece(outer, None))
            beyond = stick_excess(stuck, pressure, friction, inner, outer, solved.depth)
            excess = max(excess, beyond)
        else:
            traction.append(ZonePiece(outer, pressure, state * friction))
            displacement.append(ZonePiece(outer, next(slips)))
    error = max(solved.traction_error, drive.contact.pressure_error)
    outermost = max(
        (o for s, o in zip(solved.states, bounds[1:], strict=True) if s != 0), key=lambda r: r.value
    )
    stray, loose = solved.stray + unresolved, solved.loose_ends
    slip_error = displacement_error(drive, outermost, stray, beta, friction, largest)
    wrong = max(float(v.max()) for v in samples)
    zones_error = solved.zones_error
    return PartialSlip(
        tuple(zones),
        ZonalField(tuple(traction)),
        ZonalField(tuple(displacement)),
        solved.total_shear,
        error,
        solved.shear_error,
        solved.boundary_errors[0][0],
        zones_error,
        max(known_share(slip_error + loose), unknown_slip(zones_error)),
        max(excess, wrong / largest, 0.0),
        # zones whose ends say nothing of the sense are not taken for granted
        obeys(excess, error, wrong / largest, slip_error + min(loose, 0.5)),
        True,
        tuple(
            interval
            for zone, field, sample in zip(solved.slipping, fields, samples, strict=True)
            for interval in missing_stick(
                zone.annulus,
                sample,
                largest,
                zone.sign * field.toward_outer.limit,
                slip_error + min(loose, 0.5),
            )
        ),
        solved.layout,
    )
