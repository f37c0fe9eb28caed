"""Partial slip with one stick disk of a given radius: what is found is the friction.

For a given radius the equation is linear in the friction, too, and continuity of the traction gives
the one friction that has this disk. So there is no search.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from spectral_contact.contact.drive import Drive
from spectral_contact.contact.one_disk import OneDisk, OneDiskProblem
from spectral_contact.contact.refine import Attempt, Refinement, Resolution, refine
from spectral_contact.contact.stick_radius import NoStickDiskError
from spectral_contact.fields.series import Radius

__all__ = ["solve_given_radius"]

Array = NDArray[np.float64]


class _GivenRadius(OneDiskProblem):
    """Spaces for a stick disk of a given radius; in the friction, which is found, all is linear."""

    def __init__(self, drive: Drive, beta: float, tolerance: float, logit: float) -> None:
        self.begin(drive, beta, 1.0, tolerance)
        self.logit = logit

    def attempt(self, resolution: Resolution) -> Attempt[OneDisk]:
        """Solve in a space."""
        radius = Radius.from_logit(self.logit)
        factored, drives = self.factored(resolution, radius), [self.drive] * 2
        frictions: Array = np.array([0.0, 1.0])
        none, full = self.at(drives, resolution, radius, factored, self.quadrature, frictions)
        rise = none.mismatch - full.mismatch
        if not (none.mismatch > 0.0 and rise > 0.0):
            raise NoStickDiskError(at_centre=False)
        self.friction, self.slope = none.mismatch / rise, none.mismatch
        share = self.friction
        final = replace(
            none,
            mismatch=0.0,
            coefficients=none.coefficients + share * (full.coefficients - none.coefficients),
            target=none.target + share * (full.target - none.target),
            slipping=share * full.slipping,
        )
        return self.assess(resolution, final)


def solve_given_radius(
    drive: Drive, beta: float, logit: float, tolerance: float, max_unknowns: int
) -> Refinement[OneDisk]:
    """Solve partial slip with one central stick disk of a given radius, for kappa = 1.

    Parameters
    ----------
    drive, beta, tolerance, max_unknowns
        As of `solve_one_disk`.
    logit : float
        ``ln(c**2/(1 - c**2))``.

    Returns
    -------
    Refinement
        Its ``shift`` is the error of ``ln f``, and its slope that by this.

    Raises
    ------
    NoStickDiskError
        If no friction has this disk.
    """
    return refine(_GivenRadius(drive, beta, tolerance, logit), tolerance, max_unknowns)
