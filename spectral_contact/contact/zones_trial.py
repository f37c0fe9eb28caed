"""The coupled contact with its zones at given boundaries, and a continuous traction."""

from __future__ import annotations

from functools import cached_property
from math import pi

import numpy as np
from numpy.typing import NDArray

from spectral_contact.spectral.sliding_zones import SlidingZones, ZonesFactored

__all__ = ["ZonesTrial"]

Array = NDArray[np.float64]


class ZonesTrial:
    """Solutions for unit approach and for a unit lift at every boundary, combined.

    Parameters
    ----------
    zones : SlidingZones
    factored : ZonesFactored
        Of these zones or like ones.
    values : ndarray, shape (unknowns, 1 + boundaries)
        The solutions.
    left : float
        Estimate of what rounding leaves of the fields' error.
    """

    def __init__(
        self, zones: SlidingZones, factored: ZonesFactored, values: Array, left: float
    ) -> None:
        self.zones, self.factored, self.values, self.left = zones, factored, values, left
        _, _, self.kappa, self.friction = factored.parameters

    def jump(self, values: Array) -> Array:
        """Return what ``q`` exceeds friction by in stick at the boundaries, for columns."""
        traction, pressure = self.zones.jumps
        slipping = self.zones.senses[:, None] * self.friction
        return np.asarray(traction @ values - slipping * (pressure @ values))

    @cached_property
    def _jumps(self) -> Array:
        return self.jump(self.values)

    @cached_property
    def lifts(self) -> Array:
        """The lifts that make the traction continuous, for unit approach."""
        return -np.linalg.solve(self._jumps[:, 1:], self._jumps[:, 0])

    def combined(self, values: Array) -> Array:
        """Return the columns with the lifts."""
        return np.asarray(values[:, 0] + values[:, 1:] @ self.lifts)

    @cached_property
    def solution(self) -> Array:
        """The solution for unit approach with a continuous traction."""
        return self.combined(self.values)

    def bearing(self, values: Array) -> float:
        """Return ``int p s ds``."""
        return float(self.zones.load @ values[: self.zones.count])

    @cached_property
    def approach(self) -> float:
        """The approach of unit load."""
        return 1.0 / (2.0 * pi * self.bearing(self.solution))

    @cached_property
    def _balances(self) -> tuple[Array, Array]:
        drive, balance = self.zones.balances(self.kappa, self.friction)
        return drive @ self.solution, balance

    @cached_property
    def mismatch(self) -> Array:
        """What the conditions of the boundaries miss, relative to ``kappa R`` there."""
        drive, balance = self._balances
        return np.asarray((balance @ self.solution - self.lifts) / drive)

    def shear(self, values: Array) -> float:
        """Return ``2 pi int q s ds`` of a vector."""
        return self.zones.shear(values, self.friction)

    def moved(self, change: Array) -> tuple[Array, Array, float]:
        """Return what changes of all solutions do to the combined one, with unit load.

        Returns
        -------
        change : ndarray
            Of the combined solution.
        mismatch : ndarray
        approach : float
            Changes of the mismatch, and relative ones of the approach.
        """
        combined = self.combined(change)
        lifted = -np.linalg.solve(self._jumps[:, 1:], self.jump(combined[:, None])[:, 0])
        combined = combined + self.values[:, 1:] @ lifted
        drive, balance = self._balances
        mismatch = (balance @ combined - lifted) / drive
        raised = -self.bearing(combined) / self.bearing(self.solution)
        return combined + raised * self.solution, mismatch, raised

    def lacking(self, values: Array, approach: float) -> list[Array]:
        """Return E at the nodes of every part, of a vector that has an approach and its lifts."""
        scale = np.array([approach])
        lifts = self.lifts[:, None] * approach
        misfit = self.zones.misfit(values[:, None], self.kappa, self.friction, scale, lifts)
        return [one[:, 0] for one in misfit[1]]

    def toward(self, other: ZonesTrial, share: float) -> Array:
        """Return the solutions, extrapolated from another trial's by a share of the way."""
        return self.values + share * (self.values - other.values)
