"""What partial slip ends in: zones and fields that are held against the friction law."""

from __future__ import annotations

from dataclasses import dataclass, replace
from dataclasses import fields as fields_of
from itertools import pairwise
from math import inf
from typing import TYPE_CHECKING

import numpy as np

from spectral_contact.contact.friction_law import (
    Interval,
    hidden_stick,
    known_share,
    loose_slip,
    missing_stick,
    obeys,
    stick_excess,
)
from spectral_contact.contact.layout import Layout, ZoneNumbers
from spectral_contact.contact.ratio import FullStick
from spectral_contact.contact.resolution import TINY, NormalContact
from spectral_contact.contact.slip_displacement import Slipping, slip_displacement
from spectral_contact.contact.tuning import FIELD_ROUNDING, ROUNDING
from spectral_contact.fields.series import (
    CENTRE,
    EDGE,
    AnnulusSeries,
    DiskSeries,
    PressureField,
    ZonalField,
    ZonePiece,
)
from spectral_contact.records import Zone
from spectral_contact.spectral.parameters import Parameters

if TYPE_CHECKING:
    from spectral_contact.contact.error_estimate import ZoneSolution

#: By how much the law may be broken where no digit of the slip is known: a missing zone breaks it
#: by 1, and zones that follow from less are made of noise.
_DOUBTFUL = 0.5
#: A relative error of slip from which on it may be as wrong as its zone is wide: at the onset of
#: slip inside, where an ulp of friction moves the ends by 1e-4 of the width, both fail together.
_HARDLY_KNOWN = 0.1
#: A violation of the friction law that other zones are to blame for, not rounding.
_BROKEN = 1e-6


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PartialSlip(ZoneNumbers):
    """Fields, zones and displacement, held against the friction law.

    Attributes
    ----------
    zones : tuple of Zone
    pressure : PressureField or ZonalField
    traction, slip : ZonalField
    slip_error : float
        Estimate of the error, relative to the largest.
    violation : float
        By how much the friction law is broken, see `ErrorEstimates`.
    wrong_slip : float
        The largest displacement with the traction, relative to the largest of all: noise where no
        digit of the displacement is known. It is part of the violation only where one is.
    consistent : bool
        Whether the violation is within the errors.
    amiss : str
        What is, so much that other zones are to blame; else nothing.
    missing : tuple of (float, float)
        Intervals of ``y = 1 - s**2``, outward, in which slip has the wrong sense: stick is missing.
    layout : Layout or None
        Where a like scene may begin, if these zones were solved for.
    """

    zones: tuple[Zone, ...]
    pressure: PressureField | ZonalField
    traction: ZonalField
    slip: ZonalField
    slip_error: float
    violation: float = 0.0
    wrong_slip: float = 0.0
    consistent: bool = True
    amiss: str = ""
    missing: tuple[Interval, ...] = ()
    layout: Layout | None = None

    @property
    def settled(self) -> bool:
        """Whether there is nothing to search for: the friction law holds, and that is known."""
        known = self.slip_error < inf or self.apparent_violation <= _DOUBTFUL
        return self.consistent and known and not self.missing

    @property
    def apparent_violation(self) -> float:
        """The violation, slip counted even where no digit of it is known."""
        return max(self.violation, self.wrong_slip)

    @property
    def mended(self) -> Layout | None:
        """The zones with the stick that is missing, if that makes any."""
        if self.layout is None:
            return None
        found = self.layout.with_stick(self.missing)
        return found if len(found.states) > len(self.layout.states) else None


def no_slip(stick: FullStick, parameters: Parameters) -> PartialSlip:
    """Return full stick: what slips is narrower than can be resolved, if friction nearly does."""
    from spectral_contact.contact.onset import UNRESOLVED_SLIP, unresolved_slip

    assert stick.pressure is not None
    radius_error = unresolved_slip(stick, parameters)
    excess = stick.critical / parameters.friction - 1.0 if stick.critical < inf else 0.0
    excess = max(excess, 0.0)  # the traction of full stick is off by no more where there is slip
    return PartialSlip(
        zones=(Zone.between("stick", CENTRE, EDGE),),
        pressure=stick.pressure,
        traction=ZonalField((ZonePiece(EDGE, stick.traction),)),
        slip=ZonalField((ZonePiece(EDGE, None),)),
        approach=stick.approach,
        total_shear=stick.total_shear,
        approach_error=stick.approach_error,
        pressure_error=stick.pressure_error,
        traction_error=max(stick.traction_error, stick.pressure_error) + excess,
        shear_error=stick.shear_error + excess,
        radius_error=radius_error,
        zones_error=max(radius_error, 1.0),
        slip_error=1.0,
        violation=excess,
        consistent=excess <= max(UNRESOLVED_SLIP, 2.0 * stick.critical_error),
    )


def everywhere(outcome: PartialSlip, friction: float) -> PartialSlip:
    """Return slip around a stick disk that is too small to be felt as slip everywhere."""
    pressure = outcome.pressure
    pieces = pressure.pieces if isinstance(pressure, ZonalField) else (ZonePiece(EDGE, pressure),)
    return replace(
        outcome,
        zones=(Zone.between("slip", CENTRE, EDGE),),
        traction=ZonalField(tuple(replace(one, factor=friction) for one in pieces)),
        total_shear=friction,
        shear_error=2.0 * ROUNDING,
        traction_error=outcome.pressure_error,
        radius_error=1.0,
        zones_error=1.0,
        missing=(),
        layout=None,
    )


def zones_outcome(
    solved: ZoneSolution,
    parameters: Parameters,
    known: NormalContact | None = None,
    *,
    felt: bool = True,
) -> PartialSlip:
    """Return the solution on any zones with its displacement, held against the friction law.

    Parameters
    ----------
    known : NormalContact, optional
        The contact whose pressure was known.
    felt : bool
        Whether what sticks is; if not, it is a point, moves nothing and is not looked at.
    """
    from spectral_contact.contact import zone_fields as fields

    slipping, lost = solved.slip_samples
    if not felt:
        solved = replace(solved, stuck=[], residual_error=0.0, zone_width_error=0.0)
    given, own = (None, solved) if known is None else (known.pressure, known)
    solved = replace(
        solved,
        residual_error=solved.residual_error + lost,
        approach=own.approach,
        approach_error=own.approach_error,
        pressure_error=own.pressure_error,
    )
    sticks = (
        fields.stick_series(solved.system.states, solved.system.bounds, solved.shears)
        if felt
        else {}
    )
    excess = stick_excess(parameters.friction, fields.in_stick(solved) if felt else ())
    pressure = given or fields.pressure_field(solved, parameters)
    found = _held(solved, pressure, sticks, excess, slipping, parameters)
    opens = given is None and not fields.positive(solved.pressures)
    return replace(found, amiss="the pressure is not positive") if opens else found


def _held(
    solved: ZoneSolution,
    pressure: PressureField | ZonalField,
    sticks: dict[int, DiskSeries | AnnulusSeries],
    excess: float,
    slipping: list[Slipping],
    parameters: Parameters,
) -> PartialSlip:
    """Return zones with displacement and checks; `excess` is that of the traction in stick.

    An error e of E moves the displacement by at most ``(e/(pi s)) int t^2 dt/sqrt(s^2 - t^2) =
    e s/4``, taken four times because E is seen at its nodes only; one of the pressure by beta f p
    times its own; 1/(2 pi) bounds every term for the rounding.
    """
    _, beta, _, friction = parameters
    fields, samples, largest, unresolved = slip_displacement(
        solved.stuck, slipping, pressure, beta, friction
    )
    slips, bounds = iter(fields), list(pairwise(solved.system.bounds))
    zones, traction, displacement = [], [], []
    for k, (state, (inner, outer)) in enumerate(zip(solved.system.states, bounds, strict=True)):
        zones.append(Zone.between("slip" if state else "stick", inner, outer))
        if state:
            own = pressure.pieces[k].field if isinstance(pressure, ZonalField) else pressure
            traction.append(ZonePiece(outer, own, state * friction))
        else:
            traction.append(ZonePiece(outer, sticks.get(k)))
        displacement.append(ZonePiece(outer, next(slips) if state else None))
    stray = solved.residual_error + unresolved + FIELD_ROUNDING / (2.0 * np.pi)
    if beta > 0.0:  # p is largest at the outermost slip end
        last = max(k for k, state in enumerate(solved.system.states) if state)
        highest = float(pressure.at(np.array(bounds[last][1].rest)))
        stray += beta * friction * highest * solved.pressure_error
    largest = max(largest, TINY)
    known, loose = known_share(stray / largest), loose_slip(solved.zone_width_error)
    wrong = max(0.0, *(float(one.max()) for one in samples)) / largest
    allowed = known + min(loose, 0.5)
    error = max(solved.traction_error, solved.pressure_error)
    slip_error = known_share(known + loose)
    at_ends = [
        zone.sign * field.toward_outer.limit for zone, field in zip(slipping, fields, strict=True)
    ]
    missing = tuple(
        interval
        for zone, at_end, sample in zip(slipping, at_ends, samples, strict=True)
        for interval in missing_stick(zone.annulus, sample, largest, at_end, allowed)
    )
    numbers = {one.name: getattr(solved, one.name) for one in fields_of(ZoneNumbers)}
    numbers["traction_error"] = error
    at_edge = at_ends[-1] / largest if beta * solved.system.states[-1] else inf
    unknown = _unknown_width(slip_error, zones), hidden_stick(at_edge, allowed)
    numbers["zones_error"] = max(solved.zones_error, _unknown_sense(slip_error, wrong), *unknown)
    return PartialSlip(
        zones=tuple(zones),
        pressure=pressure,
        traction=ZonalField(tuple(traction)),
        slip=ZonalField(tuple(displacement)),
        slip_error=slip_error,
        violation=_violation(excess, wrong, slip_error),
        wrong_slip=wrong,
        consistent=obeys(excess, error, wrong, allowed),
        amiss=_amiss(excess, wrong, allowed),
        missing=missing,
        layout=solved.layout,
        **numbers,
    )


def _amiss(excess: float, wrong: float, allowed: float) -> str:
    """Return what other zones are to blame for."""
    if not excess <= _BROKEN:
        return "the traction in stick exceeds friction"
    # where no digit of the slip is known its sense is not
    return "" if wrong <= max(_BROKEN, allowed) else "the surface slips with the traction"


def _violation(excess: float, wrong: float, slip_error: float) -> float:
    """Return by how much the law is broken: in slip, where a digit of the displacement is known."""
    return max(excess, wrong) if slip_error < inf else excess


def _unknown_sense(slip_error: float, wrong: float) -> float:
    """Return 1, zones of which nothing is known, where noise has most of the slip wrong."""
    return float(slip_error == inf and wrong > _DOUBTFUL)


def _unknown_width(slip_error: float, zones: list[Zone]) -> float:
    """Return the relative error of the ends of zones inside whose slip has hardly a digit."""
    if slip_error < _HARDLY_KNOWN:
        return 0.0
    inside = (z for z in zones if z.kind == "slip" and z.outer_from_edge > 0.0)
    widths = ((z.inner_from_edge - z.outer_from_edge) / z.outer_from_edge for z in inside)
    return min(slip_error, 1.0) * max(widths, default=0.0)
