"""Partial slip with elastic coupling and one stick disk: its displacement, and what is checked."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from spectral_contact.contact.coupled_disk import CoupledDisk
from spectral_contact.contact.coupled_outcome import DISTANCES, CoupledSlip, checked, slip_annulus
from spectral_contact.contact.resolution import series_of
from spectral_contact.fields import EDGE
from spectral_contact.spectral.annulus import Annulus
from spectral_contact.spectral.parameters import Parameters
from spectral_contact.spectral.sliding import SlidingDisk
from spectral_contact.spectral.transforms import transforms

__all__ = ["slip_around_disk"]

Array = NDArray[np.float64]


def slip_around_disk(solved: CoupledDisk, parameters: Parameters) -> CoupledSlip:
    """Return fields and displacement of a solution with one stick disk.

    Raises
    ------
    NoCoupledSlipError
        If they break the friction law: there are other zones.
    """
    [rim], own, shear = solved.radii, solved.pressure[0], solved.shear[0]
    assert shear is not None
    annulus = slip_annulus(rim, EDGE, solved.disk.panels[1:])
    misfit = _misfit(solved, annulus, parameters.kappa, parameters.friction)
    sticking = [(rim.value * np.sqrt(1.0 - DISTANCES), own, shear)]
    return checked(solved, parameters, [(annulus, misfit)], sticking)


def _misfit(solved: CoupledDisk, annulus: Annulus, kappa: float, friction: float) -> list[Array]:
    """Return E at the sampling points of both halves of the annulus, and its change."""
    disk = solved.disk
    own, *around, _ = (
        np.column_stack(pair) for pair in zip(solved.parts, solved.change, strict=True)
    )
    first, second = (one.panels for one in annulus.families)
    misfit = []
    integrals = _integrals(disk, annulus, around)
    inside = disk.from_disk(own, (first, second))
    for family, (inner, halves), seen in zip(annulus.families, integrals, inside, strict=True):
        driven = (seen + inner) / np.sqrt(family.sampling().z)[:, None]
        misfit.append(2.0 * kappa * driven - friction * halves)
    return misfit


def _integrals(
    disk: SlidingDisk, annulus: Annulus, around: list[Array]
) -> list[tuple[Array, Array]]:
    """Return both integrals of the annulus's pressure, see `SlidingDisk.from_annulus`.

    They are taken at the sampling points of its halves, of pressures as columns.
    """
    if disk.panels[2].power != 0.0:  # for which there are matrices alone
        whole = np.concatenate(around)
        return [disk.from_annulus(one.sampling(), whole) for one in annulus.families]
    inner, halves = [], []
    for pressure in zip(*(np.ascontiguousarray(one.T) for one in around), strict=True):
        values, over = [], []
        for family, panels, own in zip(annulus.families, disk.panels[1:], pressure, strict=True):
            values.append(series_of(panels, own)(transforms(family.panels).distances))
            over.append(values[-1] / np.sqrt(family.sampling().z))
        inner.append(annulus.own_inner_integral(annulus.expand(values)))
        halves.append(annulus.own_half_integral(annulus.expand(over)))
    split = [annulus.sampling_split]
    pairs = (np.split(np.column_stack(one), split) for one in (inner, halves))
    return list(zip(*pairs, strict=True))
