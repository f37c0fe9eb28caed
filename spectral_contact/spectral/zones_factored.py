"""Coupled contact with any zones in one space, factored."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lu_factor, lu_solve

from spectral_contact.spectral.parameters import Parameters
from spectral_contact.spectral.sliding_factor import shed_changes
from spectral_contact.spectral.sliding_zones import SlidingZones
from spectral_contact.threads import cached_property

__all__ = ["ZonesFactored"]

Array = NDArray[np.float64]


class ZonesFactored:
    """Coupled zones in one space, factored.

    Parameters
    ----------
    zones : SlidingZones
    parameters : Parameters
        Of which beta is positive.
    """

    def __init__(self, zones: SlidingZones, parameters: Parameters) -> None:
        self.zones, self.parameters = zones, parameters
        matrix = zones.matrix(parameters)
        self.scale = 1.0 / np.sqrt(np.abs(matrix.diagonal()))
        matrix *= self.scale
        matrix *= self.scale[:, None]
        self._factor = lu_factor(matrix, overwrite_a=True, check_finite=False)

    def step(self, right: Array) -> Array:
        """Return the solution as factored, of right-hand sides as columns."""
        scale = self.scale[:, None]
        return np.asarray(lu_solve(self._factor, right * scale, check_finite=False) * scale)

    @cached_property
    def responses(self) -> Array:
        """The solutions for a unit lift at every boundary, without approach, as columns."""
        lifts = np.eye(len(self.zones.radii))
        values = np.zeros((self.zones.unknowns, len(lifts)))
        for _ in range(2):
            values += self.correction(values, np.zeros(len(lifts)), lifts, self.zones)
        return values

    def correction(
        self, values: Array, approach: Array, lifts: Array, zones: SlidingZones
    ) -> Array:
        """Return by how much solutions are off.

        Parameters
        ----------
        values : ndarray, shape (unknowns, k)
        approach : ndarray, shape (k,)
        lifts : ndarray, shape (boundaries, k)
        zones : SlidingZones
            Those of the factors or like ones, whose solutions they are.
        """
        return self.step(zones.residual(values, self.parameters, approach, lifts))

    def change(self, values: Array, zones: SlidingZones) -> list[Array]:
        """Return what the top two degrees of every panel, and the top one, contribute.

        They are the differences to the solution without them, at the same approach and lifts.
        """
        nothing = np.zeros(2), np.zeros((len(zones.radii), 2))

        def residual(changes: Array) -> Array:
            return zones.residual(changes, self.parameters, *nothing)

        changes = shed_changes(self.step, self.scale, zones.shed, values[:, None], residual)
        return [one[:, 0] for one in changes]
