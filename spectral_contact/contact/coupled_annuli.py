"""Partial slip with elastic coupling: the displacement, and what is checked."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from spectral_contact.contact.coupled_assessment import CoupledZones
from spectral_contact.contact.coupled_outcome import DISTANCES, CoupledSlip, checked
from spectral_contact.contact.resolution import ROUNDING
from spectral_contact.fields.series import CENTRE, EDGE, ZonalField
from spectral_contact.records import Zone
from spectral_contact.spectral.parameters import Parameters

__all__ = ["slip_everywhere", "slip_in_annuli"]


def slip_in_annuli(solved: CoupledZones, parameters: Parameters) -> CoupledSlip:
    """Return fields and displacement of a solution on any zones.

    Raises
    ------
    NoCoupledSlipError
        If they break the friction law.
    """
    parts = solved.system.parts
    sticking = [
        (np.sqrt(np.maximum(part.family.points(DISTANCES).z, 0.0)), p, u)
        for part, p, u in zip(parts, solved.pressure, solved.shear, strict=True)
        if u is not None
    ]
    return checked(solved, parameters, solved.slipping, sticking)


def slip_everywhere(solved: CoupledZones, parameters: Parameters) -> CoupledSlip:
    """Return a solution whose stick disk is too small to be felt as one that slips everywhere.

    Raises
    ------
    NoCoupledSlipError
        If the surface slips with the traction anywhere.
    """
    outcome = checked(solved, parameters, solved.slipping, ())
    pieces = tuple(replace(one, factor=parameters.friction) for one in outcome.pressure.pieces)
    solved = replace(
        solved,
        total_shear=parameters.friction,
        shear_error=2.0 * ROUNDING,
        traction_error=solved.pressure_error,
        radius_error=1.0,
        zones_error=1.0,
    )
    zones = (Zone.between("slip", CENTRE, EDGE),)
    return replace(outcome, solved=solved, zones=zones, traction=ZonalField(pieces))
