"""One stick disk of a given radius: the friction that it has, and how the radius changes with that.

At a given radius the equation and the condition of continuity are linear in the friction, and in
the pressure, too. So the friction is found without a search, and what continuity rises by with a
parameter takes no more than a solve: by the compliance it is one more solution. `zone_derivatives`
has the derivatives of any zones, and of the fields.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from spectral_contact.contact.drive import Drive
from spectral_contact.contact.normal import by_compliance, solve_normal
from spectral_contact.contact.one_disk import OneDisk, OneDiskProblem
from spectral_contact.contact.refine import Attempt, Refinement, refine
from spectral_contact.contact.resolution import ROUNDING, series_of
from spectral_contact.contact.stick_radius import NoStickDiskError
from spectral_contact.fields.series import Radius
from spectral_contact.spectral.panels import Resolution

Array = NDArray[np.float64]

#: Half the logit over which the slope of continuity is taken: it errs by the square, relative.
_STEP = 1e-3


class _GivenRadius(OneDiskProblem):
    """Spaces for a stick disk of a given radius, whose friction is found if it is not given."""

    def __init__(
        self, drive: Drive, beta: float, tolerance: float, logit: float, friction: float = 1.0
    ) -> None:
        super().__init__(drive, beta, friction, tolerance)
        self.logit = logit

    def attempt(self, resolution: Resolution) -> Attempt[OneDisk]:
        """Solve in a space."""
        radius = Radius.from_logit(self.logit)
        factored, drives = self.factored(resolution, radius), [self.drive] * 2
        frictions: Array = np.array([0.0, 1.0])
        none, full = self.at(drives, resolution, radius, factored, ROUNDING, frictions)
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

    def slopes(self, change: Drive | None) -> tuple[Array, float]:
        """Return by how much continuity rises with the parameters, and with the logit.

        `change` is the drive of the pressure's derivative by its compliance.
        """
        space, friction = self._resolution(self.logit, self.tolerance), self.friction
        radius = Radius.from_logit(self.logit)
        factors = self.factored(space, radius)
        drives, frictions = [self.drive, self.drive], [friction, 0.0]
        if change is not None:
            drives, frictions = [*drives, change], [*frictions, friction]
        own, none, *moved = self.at(drives, space, radius, factors, ROUNDING, np.array(frictions))
        rise = [one.mismatch for one in moved] or [np.nan]
        rise += [np.nan, (own.mismatch - none.mismatch) / friction]
        if self.beta > 0.0:
            index, load = factors.space.index, np.zeros(len(own.coefficients))
            load[index] = factors.space.mass @ own.coefficients[index] / self.beta
            by_beta = factors.solve(0.0, load)
            rise[1] = series_of(space.panels, by_beta).limit / own.unit
        ends = [
            self._trial(space, self.logit + step, ROUNDING).mismatch for step in (-_STEP, _STEP)
        ]
        return np.array(rise), (ends[1] - ends[0]) / (2.0 * _STEP)


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


def radius_slopes(
    alpha: float, beta: float, friction: float, logit: float, tolerance: float, max_unknowns: int
) -> Array:
    """Return the derivatives of ``ln(c**2/(1 - c**2))`` by alpha, beta and ``f/kappa``.

    Parameters
    ----------
    alpha, beta, friction : float
        ``alpha*``, ``beta*`` and ``f / kappa``.
    logit : float
        Of the radius that they have.
    tolerance : float
        Of the spaces.
    max_unknowns : int
        Most unknowns of one.

    Returns
    -------
    ndarray, shape (3,)
        NaN where a compliance is 0. Good to 1e-6, or the tolerance, relative.
    """
    solved = solve_normal(alpha, tolerance, max_unknowns)
    contact, change = solved, None
    if isinstance(solved, Refinement):
        contact, change = solved.best.value, Drive(by_compliance(solved))
    assert not isinstance(contact, Refinement)
    rise, slope = _GivenRadius(Drive(contact), beta, tolerance, logit, friction).slopes(change)
    return -rise / slope
