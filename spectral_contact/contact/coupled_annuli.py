"""Partial slip with elastic coupling: the displacement, and what is checked."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from spectral_contact.contact.coupled_outcome import DISTANCES, CoupledSlip, checked, slip_annulus
from spectral_contact.contact.coupled_problem import CoupledZones
from spectral_contact.contact.resolution import ROUNDING
from spectral_contact.fields.series import CENTRE, EDGE, ZonalField
from spectral_contact.solution import Zone
from spectral_contact.spectral.annulus import Annulus
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
    return checked(solved, parameters, _misfits(solved), sticking)


def slip_everywhere(solved: CoupledZones, parameters: Parameters) -> CoupledSlip:
    """Return a solution whose stick disk is too small to be felt as one that slips everywhere.

    Raises
    ------
    NoCoupledSlipError
        If the surface slips with the traction anywhere.
    """
    outcome = checked(solved, parameters, _misfits(solved), ())
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


def _misfits(solved: CoupledZones) -> list[tuple[Annulus, list[NDArray[np.float64]]]]:
    """Return the slip zones, and E at the sampling points of their halves."""
    parts, misfits = solved.system.parts, []
    for zone, state in enumerate(solved.states):
        if state != 0:
            halves = [part.family.panels for part in parts if part.zone == zone]
            annulus = slip_annulus(solved.bounds[zone], solved.bounds[zone + 1], halves)
            each = [
                solved.system.slip_misfit(solved.solution[:, :2], family)
                for family in annulus.families
            ]
            misfits.append((annulus, each))
    return misfits
