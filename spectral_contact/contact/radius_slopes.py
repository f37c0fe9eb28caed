"""How the radius of one stick disk changes with the parameters: for fits, at the price of a solve.

At a given radius the condition of continuity is linear in the pressure and in the friction, and by
the compliance it changes as one more solution says. `zone_derivatives` has those of any zones, and
of the fields.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from spectral_contact.contact.drive import Drive
from spectral_contact.contact.normal import by_compliance, solve_normal
from spectral_contact.contact.one_disk import OneDiskProblem
from spectral_contact.contact.refine import Refinement
from spectral_contact.contact.resolution import series_of
from spectral_contact.fields.series import Radius

__all__ = ["radius_slopes"]

Array = NDArray[np.float64]

#: Half the logit over which the slope of continuity is taken: it errs by the square, relative.
_STEP = 1e-3


class _AtRadius(OneDiskProblem):
    """A stick disk of a given radius."""

    def __init__(self, drive: Drive, beta: float, friction: float, tolerance: float) -> None:
        self.begin(drive, beta, friction, tolerance)

    def slopes(self, change: Drive | None, logit: float) -> tuple[Array, float]:
        """Return by how much continuity rises with the parameters, and with the logit.

        `change` is the drive of the pressure's derivative by its compliance.
        """
        space, friction = self._resolution(logit, self.tolerance), self.friction
        radius = Radius.from_logit(logit)
        factors = self.factored(space, radius)
        drives, frictions = [self.drive, self.drive], [friction, 0.0]
        if change is not None:
            drives, frictions = [*drives, change], [*frictions, friction]
        own, none, *moved = self.at(
            drives, space, radius, factors, self.quadrature, np.array(frictions)
        )
        rise = [one.mismatch for one in moved] or [np.nan]
        rise += [np.nan, (own.mismatch - none.mismatch) / friction]
        if self.beta > 0.0:
            index, load = factors.space.index, np.zeros(len(own.coefficients))
            load[index] = factors.space.mass @ own.coefficients[index] / self.beta
            by_beta = factors.solve(0.0, load)
            rise[1] = series_of(space.panels, by_beta).limit / own.unit
        ends = [
            self._trial(space, logit + step, self.quadrature).mismatch for step in (-_STEP, _STEP)
        ]
        return np.array(rise), (ends[1] - ends[0]) / (2.0 * _STEP)


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
    disk = _AtRadius(Drive(contact), beta, friction, tolerance)
    rise, slope = disk.slopes(change, logit)
    return -rise / slope
