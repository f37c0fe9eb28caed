"""What partial slip ends in: zones and fields that are held against the friction law."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import inf
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from spectral_contact.contact.drive import Drive
from spectral_contact.contact.friction_law import (
    Interval,
    displacement_error,
    known_share,
    loose_slip,
    missing_stick,
    obeys,
    stick_excess,
)
from spectral_contact.contact.full_stick import FullStick
from spectral_contact.contact.layout import Layout
from spectral_contact.contact.one_disk import OneDisk
from spectral_contact.contact.resolution import ROUNDING
from spectral_contact.contact.slip_displacement import (
    Slipping,
    annulus_between,
    slip_displacement,
    slip_misfit,
)
from spectral_contact.fields.series import (
    CENTRE,
    EDGE,
    Radius,
    ZonalField,
    ZonePiece,
)
from spectral_contact.records import Zone
from spectral_contact.spectral.annulus import Annulus

if TYPE_CHECKING:
    from spectral_contact.contact.coupled_assessment import CoupledZones

__all__ = ["PartialSlip", "all_slip", "no_slip", "one_disk_outcome", "zones_outcome"]

Array = NDArray[np.float64]

#: By how much the law may be broken where no digit of the slip is known: a missing zone breaks it
#: by 1, and zones that follow from less are made of noise.
_DOUBTFUL = 0.5
#: A relative error of slip from which on it may be as wrong as its zone is wide: at the onset of
#: slip inside, where an ulp of friction moves the ends by 1e-4 of the width, both fail together.
_HARDLY_KNOWN = 0.1


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

    @property
    def mended(self) -> Layout | None:
        """The zones with the stick that is missing, if any is."""
        return None if self.layout is None else self.layout.mended(self.missing)


def no_slip(drive: Drive, stick: FullStick, beta: float, friction: float) -> PartialSlip:
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


def all_slip(drive: Drive, beta: float, friction: float, tolerance: float) -> PartialSlip:
    """Return slip everywhere: the stick disk is smaller than 1e-65."""
    centre = Radius.from_logit(-74.0)
    annulus = _edge_annulus(drive, centre, beta, tolerance)
    slipping = Slipping(annulus, 1, slip_misfit(drive, annulus, friction))
    fields, samples, largest, unresolved = slip_displacement(
        [], [slipping], drive.pressure, beta, friction
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


def one_disk_outcome(
    drive: Drive, disk: OneDisk, beta: float, friction: float, tolerance: float
) -> PartialSlip:
    """Add zones, displacement and checks to the one-disk solution."""
    radius = disk.radius
    annulus = _edge_annulus(drive, radius, beta, tolerance)
    pressure = drive.pressure
    slipping = Slipping(annulus, 1, slip_misfit(drive, annulus, friction))
    fields, samples, largest, unresolved = slip_displacement(
        [disk.stuck], [slipping], pressure, beta, friction
    )
    traction = ZonalField((ZonePiece(radius, disk.traction), ZonePiece(EDGE, pressure, friction)))
    slip = ZonalField((ZonePiece(radius, None), ZonePiece(EDGE, fields[0])))
    excess = stick_excess(disk.traction, pressure, friction, CENTRE, radius, disk.depth)
    error = max(disk.traction_error, drive.contact.pressure_error)
    slip_error = displacement_error(drive, EDGE, disk.stray + unresolved, beta, friction, largest)
    wrong, loose = float(samples[0].max()) / largest, loose_slip(disk.edge_error)
    allowed = slip_error + min(loose, 0.5)
    return PartialSlip(
        (Zone.between("stick", CENTRE, radius), Zone.between("slip", radius, EDGE)),
        traction,
        slip,
        disk.total_shear,
        error,
        disk.shear_error,
        disk.radius_error,
        max(disk.radius_error, disk.edge_error),
        known_share(slip_error + loose),
        max(excess, wrong, 0.0),
        obeys(excess, error, wrong, allowed),
        False,
        missing_stick(annulus, samples[0], largest, fields[0].toward_outer.limit, allowed),
        Layout((radius.logit,), (0, 1), np.array([[disk.slope]])),
    )


def _unknown_width(slip_error: float, zones: list[Zone]) -> float:
    """Return the relative error of the ends of zones inside whose slip has hardly a digit."""
    if slip_error < _HARDLY_KNOWN:
        return 0.0
    inside = (z for z in zones if z.kind == "slip" and z.outer_from_edge > 0.0)
    widths = ((z.inner_from_edge - z.outer_from_edge) / z.outer_from_edge for z in inside)
    return min(slip_error, 1.0) * max(widths, default=0.0)


def zones_outcome(drive: Drive, solved: CoupledZones, beta: float, friction: float) -> PartialSlip:
    """Add displacement and checks to the solution on any zones."""
    from spectral_contact.contact.coupled_outcome import stick_series, with_misfits

    pressure = drive.pressure
    slipping, lost = with_misfits(solved, solved.slipping)
    fields, samples, largest, unresolved = slip_displacement(
        solved.stuck, slipping, pressure, beta, friction
    )
    slips, sticks, bounds = iter(fields), dict(stick_series(solved)), solved.bounds
    traction, displacement, zones, excess = [], [], [], 0.0
    for k, (state, inner, outer) in enumerate(zip(solved.states, bounds, bounds[1:], strict=False)):
        zones.append(Zone.between("stick" if state == 0 else "slip", inner, outer))
        if state == 0:
            traction.append(ZonePiece(outer, sticks[k]))
            displacement.append(ZonePiece(outer, None))
            beyond = stick_excess(sticks[k], pressure, friction, inner, outer, solved.depth)
            excess = max(excess, beyond)
        else:
            traction.append(ZonePiece(outer, pressure, state * friction))
            displacement.append(ZonePiece(outer, next(slips)))
    error = max(solved.traction_error, drive.contact.pressure_error)
    outermost = [o for s, o in zip(solved.states, bounds[1:], strict=True) if s != 0][-1]
    stray, loose = solved.stray + lost + unresolved, solved.loose_ends
    slip_error = displacement_error(drive, outermost, stray, beta, friction, largest)
    wrong, allowed = max(float(v.max()) for v in samples) / largest, slip_error + min(loose, 0.5)
    slip_share = known_share(slip_error + loose)
    return PartialSlip(
        tuple(zones),
        ZonalField(tuple(traction)),
        ZonalField(tuple(displacement)),
        solved.total_shear,
        error,
        solved.shear_error,
        solved.radius_error,
        max(solved.zones_error, _unknown_width(slip_share, zones)),
        slip_share,
        max(excess, wrong, 0.0),
        # zones whose ends say nothing of the sense are not taken for granted
        obeys(excess, error, wrong, allowed),
        True,
        tuple(
            interval
            for zone, field, sample in zip(slipping, fields, samples, strict=True)
            for interval in missing_stick(
                zone.annulus,
                sample,
                largest,
                zone.sign * field.toward_outer.limit,
                allowed,
            )
        ),
        replace(solved.layout, slopes=solved.slopes),
    )
