"""Partial slip, (5.8) in its true form: one stick disk if that satisfies the friction law, else
the zones that do.

The problem is a strictly convex minimisation under |q| <= f p, so a traction that satisfies all
conditions is the solution; how it was guessed does not matter.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from time import perf_counter
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from spectral_contact.contact.drive import EDGE, Drive
from spectral_contact.contact.full_stick import FullStick
from spectral_contact.contact.one_disk import NoStickDiskError, OneDisk, solve_one_disk
from spectral_contact.contact.resolution import ROUNDING
from spectral_contact.contact.slip_displacement import (
    Slipping,
    Stuck,
    annulus_between,
    slip_displacement,
    slip_misfit,
)
from spectral_contact.fields import Radius, ZonalField, ZonePiece
from spectral_contact.solution import PARTIAL_SLIP, SLIP_FIELD, ZONE_SEARCH, Zone

if TYPE_CHECKING:
    from spectral_contact.contact.zones import ZonesSolution

__all__ = ["PartialSlip", "solve_partial_slip"]

Array = NDArray[np.float64]
Record = Callable[[str, Any, float], Any]

_CENTRE = Radius(0.0, 1.0)


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


def solve_partial_slip(
    drive: Drive,
    stick: FullStick,
    beta: float,
    friction: float,
    tolerance: float,
    max_unknowns: int,
    *,
    record: Record,
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

    Returns
    -------
    PartialSlip
    """
    begin, guess = perf_counter(), None
    result: PartialSlip | None = None
    # on a smooth surface with tangential compliance p is infinite at the edge and q is not
    if drive.contact.compliance > 0.0 or beta == 0.0:
        try:
            refinement = solve_one_disk(drive, beta, friction, tolerance, max_unknowns)
        except NoStickDiskError:
            pass
        else:
            disk: OneDisk = record(PARTIAL_SLIP, refinement, begin)
            guess, begin = disk.radius, perf_counter()
            outcome = _one_disk_outcome(drive, disk, beta, friction, tolerance)
            result = record(SLIP_FIELD, outcome, begin)
            if outcome.consistent:
                return outcome
    from spectral_contact.contact.zone_search import search_zones
    from spectral_contact.contact.zones import solve_zones

    begin = perf_counter()
    layout = search_zones(drive, stick, beta, friction, guess)
    if result is not None and layout.states == (0, 1):
        return result  # nothing better was found: the violation stands, flagged
    zones: ZonesSolution = record(
        ZONE_SEARCH, solve_zones(drive, beta, friction, layout, tolerance, max_unknowns), begin
    )
    return _zones_outcome(drive, zones, beta, friction)


def _one_disk_outcome(
    drive: Drive, disk: OneDisk, beta: float, friction: float, tolerance: float
) -> PartialSlip:
    """Add zones, displacement and checks to the one-disk solution."""
    alpha = drive.contact.compliance
    radius = disk.radius
    rate = 0.5 if alpha == 0.0 else 1.0
    annulus = annulus_between(
        radius, EDGE, (min(beta or 1.0, radius.rest), alpha or radius.rest), tolerance, rate
    )
    pressure = drive.pressure
    misfit = slip_misfit(drive, [annulus], [1], friction, [])
    slipping = Slipping(annulus, 1, misfit[0])
    stuck = Stuck(radius, disk.parts)
    fields, samples, largest, unresolved = slip_displacement([stuck], [slipping], pressure, beta, friction)
    traction = ZonalField(
        (ZonePiece(radius, disk.traction), ZonePiece(EDGE, pressure, friction))
    )
    slip = ZonalField((ZonePiece(radius, None), ZonePiece(EDGE, fields[0])))
    excess = stick_excess(disk.traction, pressure, friction, _CENTRE, radius, disk.depth)
    error = max(disk.traction_error, drive.contact.pressure_error)
    slip_error = displacement_error(drive, EDGE, disk.stray + 4.0 * unresolved, beta, friction, largest)
    violation = max(excess, float(samples[0].max()) / largest, 0.0)
    consistent = excess <= 10.0 * error and float(samples[0].max()) <= slip_error * largest
    return PartialSlip(
        (Zone.between("stick", _CENTRE, radius), Zone.between("slip", radius, EDGE)),
        traction,
        slip,
        disk.total_shear,
        error,
        disk.shear_error,
        disk.radius_error,
        max(disk.radius_error, disk.edge_error),
        slip_error,
        violation,
        consistent,
        False,
    )


def displacement_error(
    drive: Drive, outermost: Radius, stray: float, beta: float, friction: float, largest: float
) -> float:
    """Return the error of the displacement relative to its largest modulus.

    An error e of E moves it by at most ``(e/(pi s)) int t^2 dt/sqrt(s^2 - t^2) = e s/4``, one of
    the pressure by beta f p times its own; 1/(2 pi) bounds every term for the rounding.
    """
    direct = 0.0
    if beta > 0.0:  # p is largest at the outermost slip end, bounded by its layer at the edge
        y = max(outermost.rest, drive.contact.compliance)
        largest_p = float(drive.pressure.at(np.array(min(y, 1.0))))
        direct = beta * friction * largest_p * drive.contact.pressure_error
    return (stray / 4.0 + direct + 20.0 * ROUNDING / (2.0 * np.pi)) / max(largest, 1e-300)


def stick_excess(
    traction: Any, pressure: Any, friction: float, inner: Radius, outer: Radius, depth: float
) -> float:
    """Return the largest ``|q|/(f p) - 1`` inside a stick zone, or 0."""
    x = np.linspace(1e-3, depth, 400)
    width = outer.square - inner.square if outer.square < 0.5 else inner.rest - outer.rest
    offset = width * np.exp(-x)
    s = np.sqrt(outer.square - offset)
    y = outer.rest + offset
    edge = y / (1.0 + s)
    ratio = np.abs(traction(s, edge)) / (friction * pressure.at(y))
    return max(float(ratio.max()) - 1.0, 0.0)


def _zones_outcome(
    drive: Drive, solved: ZonesSolution, beta: float, friction: float
) -> PartialSlip:
    """Add displacement and checks to the solution on any zones."""
    pressure = drive.pressure
    fields, samples, largest, unresolved = slip_displacement(
        solved.stuck, solved.slipping, pressure, beta, friction
    )
    bounds = (_CENTRE, *solved.radii, EDGE)
    sticks, slips = iter((solved.disk, *solved.annuli)), iter(fields)
    traction, displacement, zones, excess = [], [], [], 0.0
    for state, inner, outer in zip(solved.states, bounds[:-1], bounds[1:], strict=True):
        zones.append(Zone.between("stick" if state == 0 else "slip", inner, outer))
        if state == 0:
            field = next(sticks)
            traction.append(ZonePiece(outer, field))
            displacement.append(ZonePiece(outer, None))
            excess = max(excess, stick_excess(field, pressure, friction, inner, outer, solved.depth))
        else:
            traction.append(ZonePiece(outer, pressure, state * friction))
            displacement.append(ZonePiece(outer, next(slips)))
    error = max(solved.traction_error, drive.contact.pressure_error)
    outermost = max(
        (o for s, o in zip(solved.states, bounds[1:], strict=True) if s != 0), key=lambda r: r.value
    )
    slip_error = displacement_error(drive, outermost, solved.stray + 4.0 * unresolved, beta, friction, largest)
    wrong = max(float(v.max()) for v in samples)
    return PartialSlip(
        tuple(zones),
        ZonalField(tuple(traction)),
        ZonalField(tuple(displacement)),
        solved.total_shear,
        error,
        solved.shear_error,
        solved.boundary_errors[0][0],
        max(max(pair) for pair in solved.boundary_errors),
        slip_error,
        max(excess, wrong / largest, 0.0),
        excess <= 10.0 * error and wrong <= slip_error * largest,
        True,
    )
