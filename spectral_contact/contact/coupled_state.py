"""The coupled contact with its zones at given boundaries, and a continuous traction."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from spectral_contact.threads import cached_property

if TYPE_CHECKING:
    from spectral_contact.spectral.factored import Factored
    from spectral_contact.spectral.tangential import Tangential

__all__ = ["CoupledState", "Effect"]

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

    def times(self, factor: float) -> Effect:
        """Return so much of it."""
        return Effect(
            factor * self.change,
            factor * self.lifts,
            factor * self.mismatch,
            factor * self.approach,
        )


class CoupledState:
    """The solution for unit approach with a continuous traction.

    Parameters
    ----------
    system : System
    factored : Factored
        Of this system or a like one.
    solution : ndarray, shape (unknowns,)
    lifts : ndarray, shape (boundaries,)
        They make the traction continuous; without tangential compliance they are zero.
    """

    def __init__(
        self, system: Tangential, factored: Factored, solution: Array, lifts: Array
    ) -> None:
        self.system, self.factored = system, factored
        self.solution, self.lifts = solution, lifts

    @classmethod
    def begin(cls, system: Tangential, factored: Factored) -> CoupledState:
        """Return a first solution: that of a symmetric matrix, or nothing, to be corrected."""
        solution, lifts = np.zeros(system.unknowns), np.zeros(len(system.radii))
        if system.given:
            solution[0] = 1.0
        elif system.symmetric:
            solution[: system.count] = system.load
            solution = factored.step(solution)
        return cls(system, factored, solution, lifts)

    def at(self, system: Tangential) -> CoupledState:
        """Return the same coefficients with other boundaries."""
        return CoupledState(system, self.factored, self.solution, self.lifts)

    def by(self, factored: Factored) -> CoupledState:
        """Return the same, to be corrected with other factors."""
        return CoupledState(self.system, factored, self.solution, self.lifts)

    def _continuous(self, values: Array) -> tuple[Array, Array]:
        """Return the lifts that take the jumps out of a vector, and what they make of it."""
        jumps = self.system.jumps
        if self.system.parameters.beta == 0.0 or not len(jumps):
            return np.zeros(len(jumps)), values
        responses = self.factored.responses
        lifts = -np.linalg.solve(jumps @ responses, jumps @ values)
        return np.asarray(lifts), np.asarray(values + responses @ lifts)

    def corrected(self) -> tuple[CoupledState, Array]:
        """Return a better solution, and by how much it is changed."""
        missed = self.system.residual(self.solution[:, None], np.ones(1), self.lifts[:, None])
        lifts, solution = self._continuous(self.solution + self.factored.step(missed)[:, 0])
        better = CoupledState(self.system, self.factored, solution, self.lifts + lifts)
        return better, solution - self.solution

    def bearing(self, values: Array) -> float:
        """Return ``int p s ds``."""
        return float(self.system.load @ values[: self.system.count])

    @cached_property
    def approach(self) -> float:
        """The approach of unit load."""
        return 1.0 / (2.0 * pi * self.bearing(self.solution))

    @cached_property
    def mismatch(self) -> Array:
        """What the conditions of the boundaries miss, relative to ``kappa R`` there."""
        drive, balance = self.system.balances
        return np.asarray((balance @ self.solution - self.lifts) / (drive @ self.solution))

    @property
    def unbalanced(self) -> Effect:
        """What would meet the conditions of the boundaries, with a jump of the traction there.

        But for the square of what the boundaries are off it is the error of the fields.
        """
        drive, _ = self.system.balances
        lifts = self.mismatch * (drive @ self.solution)
        return self._at_unit_load(self.factored.responses @ lifts, lifts)

    def effects(self) -> list[Effect]:
        """Return what the top two degrees of every panel contribute, and what the top one does."""
        return [self._moved(one) for one in self.factored.change(self.solution, self.system)]

    def _moved(self, change: Array) -> Effect:
        """Return what a change at given lifts becomes with a continuous traction and unit load."""
        lifts, change = self._continuous(change)
        return self._at_unit_load(change, lifts)

    def _at_unit_load(self, change: Array, lifts: Array) -> Effect:
        drive, balance = self.system.balances
        raised = -self.bearing(change) / self.bearing(self.solution)
        return Effect(
            change + raised * self.solution,
            lifts + raised * self.lifts,
            (balance @ change - lifts) / (drive @ self.solution),
            raised,
        )

    def lacking(self, values: Array, approach: float, lifts: Array) -> list[Array]:
        """Return E at the nodes of the parts, of a vector that has an approach and lifts."""
        misfit = self.system.misfit(values[:, None], np.array([approach]), lifts[:, None])
        return [one[:, 0] for one in misfit.tangential]
