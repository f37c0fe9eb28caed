"""The coupled contact at one radius of its stick disk, with a continuous traction."""

from __future__ import annotations

from math import pi

import numpy as np
from numpy.typing import NDArray

from spectral_contact.contact.resolution import series_of
from spectral_contact.spectral.sliding import SlidingDisk
from spectral_contact.spectral.sliding_factor import SlidingFactored
from spectral_contact.threads import cached_property

__all__ = ["CoupledTrial"]

Array = NDArray[np.float64]


class CoupledTrial:
    """The contact at one radius: solutions for unit approach and for a unit lift, combined.

    Parameters
    ----------
    disk : SlidingDisk
    factored : SlidingFactored
        Of this disk or a like one.
    values : ndarray, shape (unknowns, 1 or 2)
        The solutions; without compliance the lift is zero.
    left : float
        Estimate of what rounding leaves of the fields' error.
    """

    def __init__(
        self, disk: SlidingDisk, factored: SlidingFactored, values: Array, left: float
    ) -> None:
        self.disk, self.factored, self.values, self.left = disk, factored, values, left
        self.parameters = factored.parameters

    @cached_property
    def _jumps(self) -> Array:
        """Jump of ``q - f p`` at the rim, of both solutions."""
        return self.jump(self.values)

    def jump(self, values: Array) -> Array:
        """Return ``q - f p`` inside the rim, for columns."""
        disk = self.disk
        parts = disk.split(values)
        own = disk.panels[0]
        p, u = (
            np.array([series_of(own, column).limit for column in np.ascontiguousarray(one.T)])
            for one in (parts[0], parts[3])
        )
        return np.asarray(disk.radius.value * u - self.parameters.friction * p)

    @cached_property
    def lift(self) -> float:
        """The lift that makes the traction continuous, for unit approach."""
        return float(-self._jumps[0] / self._jumps[1]) if len(self._jumps) > 1 else 0.0

    def combined(self, values: Array, lift: float) -> Array:
        """Return the solution with a lift."""
        return np.asarray(values @ np.array([1.0, lift])[: values.shape[1]])

    @cached_property
    def solution(self) -> Array:
        """The solution for unit approach with a continuous traction."""
        return self.combined(self.values, self.lift)

    @cached_property
    def approach(self) -> float:
        """The approach of unit load."""
        return float(1.0 / (2.0 * pi * (self.disk.load @ self.solution[: self.disk.count])))

    @cached_property
    def balance(self) -> Array:
        """The functional ``kappa R(c) - f P(c)``."""
        return self.disk.balance(self.parameters)

    @cached_property
    def at_rim(self) -> float:
        """``kappa R(c)``, which mismatches are relative to."""
        n = self.disk.inside
        return float(self.balance[:n] @ self.solution[:n])

    @property
    def mismatch(self) -> float:
        """What the condition of the radius misses."""
        return (float(self.balance @ self.solution) - self.lift) / self.at_rim

    def shear(self, values: Array) -> float:
        """Return ``2 pi int q s ds`` of a vector."""
        disk, n = self.disk, self.disk.inside
        slip = 2.0 * pi * self.parameters.friction * float(disk.load[n:] @ values[n : disk.count])
        return float(disk.shear_moments @ values[disk.count :]) + slip

    def moved(self, change: Array) -> tuple[Array, float, float]:
        """Return what a change of both solutions does to the combined one, with unit load.

        Returns
        -------
        change : ndarray
            Of the combined solution.
        mismatch, approach : float
            Changes of the mismatch, and relative ones of the approach.
        """
        combined = self.combined(change, self.lift)
        lifted = 0.0
        if self.lift:
            lifted = -float(self.jump(combined[:, None])[0] / self._jumps[1])
            combined = combined + lifted * self.values[:, 1]
        mismatch = (float(self.balance @ combined) - lifted) / self.at_rim
        load = self.disk.load @ self.solution[: self.disk.count]
        raised = -float(self.disk.load @ combined[: self.disk.count] / load)
        return combined + raised * self.solution, mismatch, raised

    def lacking(self, values: Array, approach: float) -> Array:
        """Return E at the disk's nodes, of a vector that has an approach and its lift."""
        scale = np.array([approach])
        vector = values[:, None]
        misfit = self.disk.misfit(vector, self.parameters, scale, self.lift * scale)
        return misfit[3][:, 0]
