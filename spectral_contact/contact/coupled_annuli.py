"""Partial slip with elastic coupling: the displacement, and what is checked."""

from __future__ import annotations

import numpy as np

from spectral_contact.contact.coupled_outcome import DISTANCES, CoupledSlip, checked, slip_annulus
from spectral_contact.contact.coupled_zones import CoupledZones
from spectral_contact.spectral.parameters import Parameters

__all__ = ["slip_in_annuli"]


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
    misfits = []
    for zone, state in enumerate(solved.states):
        if state != 0:
            halves = [part.family.panels for part in parts if part.zone == zone]
            annulus = slip_annulus(solved.bounds[zone], solved.bounds[zone + 1], halves)
            each = [
                solved.system.slip_misfit(solved.solution, family) for family in annulus.families
            ]
            misfits.append((annulus, each))
    return checked(solved, parameters, misfits, sticking)
