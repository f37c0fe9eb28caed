"""The coupled contact with its zones at given boundaries, and a continuous traction."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np
from numpy.typing import NDArray

from spectral_contact.spectral.sliding_zones import SlidingZones
from spectral_contact.spectral.zones_factored import ZonesFactored
from spectral_contact.threads import cached_property

__all__ = ["Effect", "ZonesTrial"]

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Effect:
    """What a change of the space does at unit load.

    Attributes
    ----------
    change, lifts : ndarray
        Of the solution and of its lifts.
    mismatch : ndarray
        Of the conditions of the boundaries.
    approach : float
        Of the approach, relative.
    """

    change: Array
    lifts: Array
    mismatch: Array
    approach: float


class ZonesTrial:
    """The solution for unit approach with a continuous traction.

    Parameters
    ----------
    zones : SlidingZones
    factored : ZonesFactored
        Of these zones or like ones.
    solution : ndarray, shape (unknowns,)
    lifts : ndarray, shape (boundaries,)
        They make the traction continuous.
    left : float
        Estimate of what rounding leaves of the fields' error.
    """

    def __init__(
        self,
        zones: SlidingZones,
        factored: ZonesFactored,
        solution: Array,
        lifts: Array,
        left: float,
    ) -> None:
        self.zones, self.factored, self.left = zones, factored, left
        self.solution, self.lifts = solution, lifts
        self.parameters = factored.parameters

    def jump(self, values: Array) -> Array:
        """Return what ``q`` exceeds friction by in stick at the boundaries."""
        traction, pressure = self.zones.jumps
        jump = traction @ values
        slipping = self.parameters.friction * (pressure @ values)
        return np.asarray((jump.T - self.zones.senses * slipping.T).T)

    def _continuous(self, values: Array) -> tuple[Array, Array]:
        """Return the lifts that take the jumps out of a vector, and what they make of it."""
        responses = self.factored.responses
        lifts = -np.linalg.solve(self.jump(responses), self.jump(values))
        return np.asarray(lifts), np.asarray(values + responses @ lifts)

    def corrected(self) -> tuple[ZonesTrial, Array]:
        """Return a better solution, and by how much it is changed."""
        missed = self.factored.correction(
            self.solution[:, None], np.ones(1), self.lifts[:, None], self.zones
        )[:, 0]
        lifts, solution = self._continuous(self.solution + missed)
        better = ZonesTrial(self.zones, self.factored, solution, self.lifts + lifts, self.left)
        return better, solution - self.solution

    def bearing(self, values: Array) -> float:
        """Return ``int p s ds``."""
        return float(self.zones.load @ values[: self.zones.count])

    @cached_property
    def approach(self) -> float:
        """The approach of unit load."""
        return 1.0 / (2.0 * pi * self.bearing(self.solution))

    @cached_property
    def _balances(self) -> tuple[Array, Array]:
        drive, balance = self.zones.balances(self.parameters)
        return drive @ self.solution, balance

    @cached_property
    def mismatch(self) -> Array:
        """What the conditions of the boundaries miss, relative to ``kappa R`` there."""
        drive, balance = self._balances
        return np.asarray((balance @ self.solution - self.lifts) / drive)

    def shear(self, values: Array) -> float:
        """Return ``2 pi int q s ds`` of a vector."""
        return self.zones.shear(values, self.parameters.friction)

    def effects(self) -> list[Effect]:
        """Return what the top two degrees of every panel contribute, and what the top one does."""
        return [self._moved(one) for one in self.factored.change(self.solution, self.zones)]

    def _moved(self, change: Array) -> Effect:
        """Return what a change at given lifts becomes with a continuous traction and unit load."""
        lifts, change = self._continuous(change)
        drive, balance = self._balances
        raised = -self.bearing(change) / self.bearing(self.solution)
        return Effect(
            change + raised * self.solution,
            lifts + raised * self.lifts,
            (balance @ change - lifts) / drive,
            raised,
        )

    def lacking(self, values: Array, approach: float, lifts: Array) -> list[Array]:
        """Return E at the nodes of every part, of a vector that has an approach and lifts."""
        approaches, columns = np.array([approach]), lifts[:, None]
        misfit = self.zones.misfit(values[:, None], self.parameters, approaches, columns)
        return [one[:, 0] for one in misfit[1]]
