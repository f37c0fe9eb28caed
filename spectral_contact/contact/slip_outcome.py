"""Partial slip on given zones: fields, displacement, and the verdict of the friction law.

`zones_outcome` takes the solution for boundaries and fields (`ZoneSolution`), computes the radial
displacement in slip, and verifies the friction law everywhere: ``|q| <= f p`` in stick, slip
against the traction, ``p > 0``. `full_stick_outcome` and `as_full_slip` make the same record for a
contact that sticks or slips everywhere.

Symbols (docs/theory): p and q are pressure and traction, f is friction, beta the tangential
compliance, kappa the coupling, Q the total shear, ``E = kappa R - G`` the residual of full stick in
slip. s is the radius over that of the contact, and ``y = 1 - s**2``. *Slip* is sampled as the
radial displacement times the sign of the traction, which is negative where the friction law holds.

The load is 1. Without elastic coupling, which is where the normal contact is given, kappa is 1,
too: the friction of the parameters is f/kappa, and traction, shear and slip are over kappa.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from dataclasses import fields as fields_of
from itertools import pairwise
from math import inf, pi

import numpy as np

from spectral_contact.contact import zone_fields
from spectral_contact.contact.friction_law import (
    UNRESOLVED_SLIP,
    Interval,
    edge_sense_unknown,
    inf_if_unresolved,
    missing_stick,
    named_violation,
    slip_error_from_boundaries,
    stick_violation,
)
from spectral_contact.contact.layout import Layout, Trial
from spectral_contact.contact.normal import NormalContact
from spectral_contact.contact.ratio import FullStick
from spectral_contact.contact.resolution import TINY
from spectral_contact.contact.slip_displacement import SlipZone, slip_displacement
from spectral_contact.contact.tuning import FIELD_ROUNDING, ROUNDING, UNCERTAIN_SLIP_ERROR
from spectral_contact.contact.zone_solution import ScalarResults, ZoneSolution
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

#: Violation of the friction law at which zones are refuted if no digit of the slip is known: a
#: missing zone violates it by 1, and zones that follow from less than a half are noise.
DOUBTFUL_VIOLATION = 0.5


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PartialSlip(ScalarResults):
    """Fields, zones and displacement, verified against the friction law.

    Attributes
    ----------
    zones : tuple of Zone
    pressure : PressureField or ZonalField
    traction, slip : ZonalField
        q, in slip the field p times the number ``+-f``; and the radial displacement u_r, zero in
        stick.
    slip_error : float
        Estimate of the error of the displacement, relative to its largest value; infinite if no
        digit of it is known.
    violation : float
        The largest ``|q|/(f p) - 1`` in stick or, if larger, `wrong_slip`; infinite if the pressure
        is not positive everywhere.
    wrong_slip : float
        The largest displacement in the direction of the traction, relative to the largest of all.
        It is part of the violation only if the slip error is finite; otherwise it is noise.
    violation_text : str
        The name of a violation beyond the errors, by which the zones are wrong; empty if there is
        none.
    missing : tuple of (float, float)
        Where stick is missing: intervals of y, outward, in which slip has the direction of the
        traction.
    layout : Layout or None
        The zones with which Newton's method can begin in a similar scene; None in full stick and
        full slip, whose boundaries were not solved for.
    trials : tuple of Trial
        The zones that were tried, in order, with the verdict on each.
    """

    zones: tuple[Zone, ...]
    pressure: PressureField | ZonalField
    traction: ZonalField
    slip: ZonalField
    slip_error: float
    violation: float = 0.0
    wrong_slip: float = 0.0
    violation_text: str = ""
    missing: tuple[Interval, ...] = ()
    layout: Layout | None = None
    trials: tuple[Trial, ...] = ()

    @property
    def consistent(self) -> bool:
        """Whether no violation of the friction law exceeds the errors."""
        return not self.violation_text

    @property
    def verified(self) -> bool:
        """Whether the friction law is known to hold, so that no other zones need be tried."""
        return self.consistent and self._sense_is_known and not self.missing

    @property
    def verdict(self) -> str:
        """One line: that the friction law holds, or what is against it."""
        if self.violation_text:
            return self.violation_text
        if not self._sense_is_known:
            return "the sense of the slip is not known"
        if self.missing:
            return f"stick is missing in {len(self.missing)} intervals of slip"
        return "the friction law holds"

    @property
    def _sense_is_known(self) -> bool:
        """Whether the sense of the slip is known, or at least not in doubt.

        Where no digit of the slip is known, its sense is in doubt if the friction law is violated
        by more than DOUBTFUL_VIOLATION, as far as can be seen (`apparent_violation`).
        """
        return self.slip_error < inf or self.apparent_violation <= DOUBTFUL_VIOLATION

    @property
    def apparent_violation(self) -> float:
        """The larger one of `violation` and `wrong_slip`, even if no digit of the slip is known."""
        return max(self.violation, self.wrong_slip)

    @property
    def with_missing_stick(self) -> Layout | None:
        """These zones with stick added in the intervals `missing`; None if that adds no zone."""
        if self.layout is None:
            return None
        enlarged = self.layout.with_stick(self.missing)
        return enlarged if len(enlarged.states) > len(self.layout.states) else None


def full_stick_outcome(stick: FullStick, parameters: Parameters) -> PartialSlip:
    """Return full stick as the outcome of partial slip if its slip is too narrow to be resolved.

    If f is below the critical friction f_crit, the traction of full stick exceeds f p by a relative
    ``f_crit/f - 1`` at most. This is added to the errors of traction and shear.
    """
    from spectral_contact.contact.onset import unresolved_slip

    assert stick.pressure is not None
    radius_error = unresolved_slip(stick, parameters)
    excess = 0.0
    if stick.critical < inf:
        excess = max(stick.critical / parameters.friction - 1.0, 0.0)
    return PartialSlip(
        zones=(Zone.from_radii("stick", CENTRE, EDGE),),
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
        # `named_violation` excuses twice an error, and so UNRESOLVED_SLIP
        violation_text=named_violation(
            excess, max(UNRESOLVED_SLIP / 2.0, stick.critical_error), 0.0, 0.0
        ),
    )


def as_full_slip(outcome: PartialSlip, friction: float) -> PartialSlip:
    """Return slip around a point-like stick disk as slip from the centre.

    Then ``q = f p``, and ``Q = f`` as the load is 1. A stick zone at the edge, if the outcome has
    one, stays; the difference that it makes to Q is within the error of the outcome.
    """
    pressure = outcome.pressure
    pieces = pressure.pieces if isinstance(pressure, ZonalField) else (ZonePiece(EDGE, pressure),)
    slip_zone, *edge_stick = outcome.zones[1:]
    traction = [replace(piece, factor=friction) for piece in pieces]
    if edge_stick:
        traction[-1] = outcome.traction.pieces[-1]
    return replace(
        outcome,
        zones=(replace(slip_zone, inner=0.0, inner_from_edge=1.0), *edge_stick),
        traction=ZonalField(tuple(traction)),
        total_shear=friction,
        shear_error=outcome.shear_error if edge_stick else 2.0 * ROUNDING,
        traction_error=outcome.pressure_error,
        radius_error=1.0,
        zones_error=1.0,
        missing=(),
        layout=None,
    )


def zones_outcome(
    solved: ZoneSolution,
    parameters: Parameters,
    contact: NormalContact | None = None,
    *,
    point_disk: bool = False,
) -> PartialSlip:
    """Return the solution on zones with its displacement and the verdict of the friction law.

    Parameters
    ----------
    solved : ZoneSolution
        Boundaries and fields.
    parameters : Parameters
        Of the contact. Those of `solved.system` differ where its disk is regularised
        (`little_friction`). With beta = 0 in their place the displacement is that of the body alone
        (`edge_stick`).
    contact : NormalContact, optional
        Normal contact, if the pressure was known; without it the pressure is part of `solved`.
    point_disk : bool
        Whether the stick disk is so small that it counts as a point: it contributes neither to
        the displacement nor to its error, and the friction law is not checked in it.
    """
    # E in slip, and a bound of the error of the displacement by its error
    slip_zones, slip_residual_error = solved.slip_samples
    if point_disk:  # neither the disk nor its boundary has an error
        solved = replace(solved, stick_zones=[], residual_error=0.0, slip_width_error=0.0)
    normal = solved if contact is None else contact
    solved = replace(
        solved,
        residual_error=solved.residual_error + slip_residual_error,
        approach=normal.approach,
        approach_error=normal.approach_error,
        pressure_error=normal.pressure_error,
    )
    if point_disk:
        stick_tractions: dict[int, DiskSeries | AnnulusSeries] = {}
        excess = 0.0
    else:
        system = solved.system
        stick_tractions = zone_fields.stick_tractions(system.states, system.bounds, solved.shears)
        in_stick = zone_fields.fields_in_stick(system, solved.pressures, solved.shears)
        excess = stick_violation(parameters.friction, in_stick)
    pressure: PressureField | ZonalField = (
        zone_fields.pressure_field(solved, parameters) if contact is None else contact.pressure
    )
    outcome = _checked_outcome(solved, pressure, stick_tractions, excess, slip_zones, parameters)
    if contact is None and not zone_fields.all_positive(solved.pressures):
        return replace(outcome, violation=inf, violation_text="the pressure is not positive")
    return outcome


def _checked_outcome(
    solved: ZoneSolution,
    pressure: PressureField | ZonalField,
    stick_tractions: dict[int, DiskSeries | AnnulusSeries],
    excess: float,
    slip_zones: list[SlipZone],
    parameters: Parameters,
) -> PartialSlip:
    """Return zones, fields and displacement, with errors and the verdict of the friction law.

    An error e of E changes the displacement by at most
    ``(e/(pi s)) int t^2 dt/sqrt(s^2 - t^2) = e s/4``; the factor 1 is taken in place of 1/4,
    because e is known at nodes only. An error of the pressure changes the displacement by
    ``beta f p`` times the relative error of p. Rounding is `FIELD_ROUNDING` times ``1/(2 pi) =
    int p s ds``, which bounds every term of the displacement.

    Parameters
    ----------
    solved : ZoneSolution
        With the approach and the error of the pressure of the normal contact, if that was known.
    pressure : PressureField or ZonalField
    stick_tractions : dict
        The traction of every zone that sticks, by the number of the zone.
    excess : float
        The largest ``|q|/(f p) - 1`` in stick, or 0.
    slip_zones : list of SlipZone
        The zones that slip, outward, with E.
    parameters : Parameters
    """
    beta = parameters.beta
    friction = parameters.friction
    states = solved.system.states
    bounds = solved.system.bounds
    displacement = slip_displacement(solved.stick_zones, slip_zones, pressure, beta, friction)
    # what slip that is over has left where the surface sticks now
    memory = solved.system.displacement
    slip_of_now = displacement if memory is None else displacement.since(memory, slip_zones)

    zones: list[Zone] = []
    traction_pieces: list[ZonePiece] = []
    slip_pieces: list[ZonePiece] = []
    displacement_fields = iter(displacement.fields)
    for k, (state, (inner, outer)) in enumerate(zip(states, pairwise(bounds), strict=True)):
        # part 2 k is the disk, or the outer half of zone k
        has_memory = 2 * k in solved.system.displacement_coefficients
        kind = "slip" if state else "stick"
        zones.append(Zone.from_radii(kind, inner, outer, sense=state or 1, memory=has_memory))
        if state:
            zone_pressure = (
                pressure.pieces[k].field if isinstance(pressure, ZonalField) else pressure
            )
            traction_pieces.append(ZonePiece(outer, zone_pressure, state * friction))
            slip_pieces.append(ZonePiece(outer, next(displacement_fields)))
        else:
            traction_pieces.append(ZonePiece(outer, stick_tractions.get(k)))
            piece = memory.on_zone(outer) if memory and has_memory else ZonePiece(outer, None)
            slip_pieces.append(piece)

    absolute_error = solved.residual_error + displacement.unresolved + FIELD_ROUNDING / (2.0 * pi)
    if beta > 0.0:  # in slip p is largest at the outer end of the last zone that slips
        outer_end = slip_zones[-1].annulus.outer
        max_pressure = float(pressure.evaluate(np.array(outer_end.rest)))
        absolute_error += beta * friction * max_pressure * solved.pressure_error
    if memory is not None:
        absolute_error += memory.error
    largest = max(slip_of_now.largest, TINY)
    field_error = inf_if_unresolved(absolute_error / largest)
    boundary_error = slip_error_from_boundaries(solved.slip_width_error)
    slip_error = inf_if_unresolved(field_error + boundary_error)

    # slip in the wrong sense is excused up to the error of the slip, of which that by the
    # boundaries counts for a half at most
    excused = field_error + min(boundary_error, 0.5)
    wrong = max(0.0, *(float(sample.max()) for sample in slip_of_now.samples)) / largest
    missing = tuple(
        interval
        for zone, at_end, sample in zip(
            slip_zones, slip_of_now.at_outer_ends, slip_of_now.samples, strict=True
        )
        for interval in missing_stick(zone.annulus, sample, largest, at_end, excused)
    )
    # the slip at the edge, if the edge slips and a layer keeps it finite
    at_edge = slip_of_now.at_outer_ends[-1] / largest if beta * states[-1] else inf

    # slip that is noise, nearly all of it in the wrong sense, leaves the zones no digit
    uncertain = max(
        float(slip_error == inf and wrong > DOUBTFUL_VIOLATION),
        _uncertain_zone_error(slip_error, zones),
    )
    traction_error = max(solved.traction_error, solved.pressure_error)
    scalars = {item.name: getattr(solved, item.name) for item in fields_of(ScalarResults)}
    scalars["traction_error"] = traction_error
    scalars["zones_error"] = max(
        solved.zones_error, uncertain, edge_sense_unknown(at_edge, excused)
    )
    # the stick radius may be off by as much as its distance from the edge
    disk = zones[0]
    scalars["radius_error"] = max(
        solved.radius_error, uncertain * disk.outer_from_edge / disk.outer
    )
    return PartialSlip(
        zones=tuple(zones),
        pressure=pressure,
        traction=ZonalField(tuple(traction_pieces)),
        slip=ZonalField(tuple(slip_pieces)),
        # no true slip has the wrong sense, so that what is found of it is an error
        slip_error=max(slip_error, wrong) * min(largest / max(displacement.largest, TINY), 1.0),
        violation=max(excess, wrong) if slip_error < inf else excess,
        wrong_slip=wrong,
        violation_text=named_violation(excess, traction_error, wrong, excused),
        missing=missing,
        layout=solved.layout,
        **scalars,
    )


def _uncertain_zone_error(slip_error: float, zones: list[Zone]) -> float:
    """Return the relative error of the boundaries of slip zones if slip has hardly a digit, else 0.

    Only zones that do not reach the edge count. The error of a boundary is taken to be that of the
    slip, 1 at most, times the width of the zone; it is relative to the distance from the edge.
    """
    if slip_error < UNCERTAIN_SLIP_ERROR:
        return 0.0
    # over the distance of the outer end from the edge
    widths = [
        zone.inner_from_edge / zone.outer_from_edge - 1.0
        for zone in zones
        if zone.kind == "slip" and zone.outer_from_edge > 0.0
    ]
    return min(slip_error, 1.0) * max(widths, default=0.0)
