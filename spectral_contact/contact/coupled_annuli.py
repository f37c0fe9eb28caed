"""Partial slip with elastic coupling on any zones: the displacement, and what is checked."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from spectral_contact.contact.coupled_outcome import DISTANCES, CoupledSlip, checked, slip_annulus
from spectral_contact.contact.coupled_zones import CoupledZones
from spectral_contact.spectral.annulus import Family, Points
from spectral_contact.spectral.parameters import Parameters

__all__ = ["slip_in_annuli"]

Array = NDArray[np.float64]


def slip_in_annuli(solved: CoupledZones, parameters: Parameters) -> CoupledSlip:
    """Return fields and displacement of a solution on any zones.

    Raises
    ------
    NoCoupledSlipError
        If they break the friction law.
    """
    parts = solved.zones.parts
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
            each = [_misfit(solved, parameters.kappa, family) for family in annulus.families]
            misfits.append((annulus, each))
    return checked(solved, parameters, misfits, sticking)


def _misfit(solved: CoupledZones, kappa: float, family: Family) -> Array:
    """Return E at the sampling points of a family, and its change."""
    points: Points = family.sampling()
    total = np.zeros((len(points.offset), 2))
    for part, p, u in zip(solved.zones.parts, solved.driven, solved.sheared, strict=True):
        # a part lies inside or outside of the points, unless it is their own
        inner = 2.0 * kappa / np.sqrt(points.z)[:, None]
        total += inner * (part.family.inner_integral(points) @ p)
        total -= part.shear.half_integral(points) @ u
    return total
