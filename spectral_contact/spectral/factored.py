"""The factors of the matrix of a contact system, and solutions by them.

Solutions by the factors are corrected with the residual, in which nothing cancels
(`contact.free_boundary`). So factors of a system whose boundaries are close by serve, too.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lu_factor, lu_solve

from spectral_contact.spectral.contact_matrix import system_matrix
from spectral_contact.spectral.regularised import Cholesky
from spectral_contact.spectral.spaces import unit_space
from spectral_contact.threads import cached_property

if TYPE_CHECKING:
    from spectral_contact.spectral.contact_system import ContactSystem

Array = NDArray[np.float64]


def factored(system: ContactSystem) -> Factored:
    """Return a system factored: by Cholesky if it is symmetric, else by LU."""
    return Symmetric(system) if system.symmetric else Factored(system)


class Factored:
    """A system with the LU factors of its matrix.

    Double precision throughout: in single precision entries next to a boundary are subnormal
    numbers, and on a processor that is slow with these coupled partial slip takes 1.3 times as
    long, on another 0.92 times (``python validation/cost/bench_coupled.py``).

    Parameters
    ----------
    system : ContactSystem

    Attributes
    ----------
    system : ContactSystem
    scale : ndarray, shape (unknowns,)
        What rows and columns are multiplied by for a unit diagonal.
    """

    def __init__(self, system: ContactSystem) -> None:
        self.system = system
        matrix = system_matrix(system)
        self.scale: Array = 1.0 / np.sqrt(np.abs(matrix.diagonal()))
        matrix *= self.scale
        matrix *= self.scale[:, None]
        # in columns of the pressure the tangential equations are scaled to at most 1/2, so that LU
        # takes its pivots there from the normal equations
        tangential_rows = matrix[system.pressure_terms :]
        coupling = tangential_rows[:, : system.pressure_terms]
        reduction = 0.5 / max(float(np.abs(coupling).max(initial=0.0)), 0.5)
        tangential_rows *= reduction
        self._row_scale = self.scale.copy()
        self._row_scale[system.pressure_terms :] *= reduction
        self._factor = lu_factor(matrix, overwrite_a=True, check_finite=False)

    def step(self, right: Array) -> Array:
        """Return the solutions by the factors, uncorrected, of right-hand sides as columns."""
        scaled = right * self._row_scale[:, None]
        size = np.maximum(np.abs(scaled).max(axis=0), np.finfo(float).tiny)
        scaled /= size
        step = lu_solve(self._factor, scaled, overwrite_b=True, check_finite=False)
        return np.asarray(step * self.scale[:, None] * size)

    @cached_property
    def unit_solutions(self) -> Array:
        """Solutions of unit loads as columns, shape (unknowns, loads).

        The first is that for unit approach or, if the pressure is known, for this pressure. Then
        comes one for a unit defect (`contact_system`) at every boundary, and one for each
        contribution of the top degrees of a known pressure, if there are any.
        """
        system = self.system
        count = 1 + len(system.radii)
        changes = system.pressure_terms - 1 if system.pressure_known else 0
        values = np.zeros((system.unknowns, count + changes))
        if system.symmetric and not system.pressure_known:
            values[: system.pressure_terms, 0] = system.load_row
            return self.step(values)
        values[0, 0] = system.pressure_known
        values[1 : 1 + changes, count:] = np.eye(changes)
        units = np.eye(count, values.shape[1])
        values += self.step(system.residual(values, units[0], units[1:]))
        if not system.symmetric:
            # next to a narrow edge that sticks the factors lose digits of the responses to defects
            no_approach = np.zeros(count - 1)
            values[:, 1:] += self.step(system.residual(values[:, 1:], no_approach, units[1:, 1:]))
        return values

    @property
    def defect_responses(self) -> Array:
        """What a unit defect at every boundary adds to the solution, as columns."""
        return self.unit_solutions[:, 1 : 1 + len(self.system.radii)]

    def coarse_differences(self, values: Array, system: ContactSystem) -> list[Array]:
        """Return a solution less the solutions in two coarser spaces.

        The spaces lack the top two degrees of every panel, and the top one; a known pressure lacks
        them, too. Approach and defects are the same.

        Parameters
        ----------
        values : ndarray, shape (unknowns,)
            The solution.
        system : ContactSystem
            The system of the solution: that of the factors, or one with boundaries close by.
        """
        top_degrees = system.top_degree_indices[0]
        count = len(values)
        right = np.zeros((count, len(top_degrees)))
        right[top_degrees, np.arange(len(top_degrees))] = 1.0 / self.scale[top_degrees]
        response = self.step(right)
        # right-hand sides at the missing unknowns with which these vanish in the coarser solution
        forced = np.zeros((count, 2))
        changes = np.empty((count, 2))
        for i, missing in enumerate(system.top_degree_indices):
            columns = response[:, np.isin(top_degrees, missing)]
            scale = self.scale[missing]
            forces = np.linalg.solve(columns[missing] / scale[:, None], values[missing] / scale)
            forced[missing, i] = forces / scale
            changes[:, i] = columns @ forces
        no_approach = np.zeros(2)
        no_defects = np.zeros((len(system.radii), 2))
        residual = system.residual(changes, no_approach, no_defects)
        return [*(changes + self.step(residual + forced)).T]


class Symmetric(Factored):
    """A symmetric positive definite system with its Cholesky factor.

    Vectors begin with the factors of a known pressure, and the matrix does not. The functions that
    coarser spaces lack come last, so that the leading parts of the factor are those of the coarser
    spaces. If one disk of radius c sticks under a known pressure, its matrix is ``c**5`` times that
    of the unit disk with the compliance ``beta / c``, because the kernels are homogeneous
    (docs/theory, Abel factorisation); that of the unit disk is cached.
    """

    def __init__(self, system: ContactSystem) -> None:
        self.system = system
        #: factor of the matrix beside the one that is factored
        self._matrix_scale = 1.0
        known = system.pressure_terms if system.pressure_known else 0
        if system.pressure_known and len(system.stick_parts) == 1:
            [field] = system.fields
            radius = system.parts[0].mesh.boundary.value
            space = unit_space(field.panels, field.degrees, shear=True)
            self._matrix_scale = radius**5
            self._coarse_unknowns = (space.coarsest_unknowns, space.coarse_unknowns)
            self._order = known + space.place
            self._cholesky = space.factor(system.parameters.beta / radius).cholesky
            return
        top_degrees = np.concatenate(system.top_degree_indices)
        # in how many of the two coarser spaces an unknown is missing
        missing = np.bincount(top_degrees, minlength=system.unknowns)[known:]
        self._order = known + np.argsort(missing, kind="stable")
        self._coarse_unknowns = (int((missing < 1).sum()), int((missing < 2).sum()))
        self._cholesky = Cholesky(system_matrix(system)[np.ix_(self._order, self._order)])

    def step(self, right: Array) -> Array:
        """Return the solutions by the factors, uncorrected, of right-hand sides as columns."""
        step = right.copy()
        step[self._order] = self._cholesky.solve(right[self._order].T).T / self._matrix_scale
        return step

    def coarse_differences(self, values: Array, system: ContactSystem) -> list[Array]:
        """Return a solution less the solutions in two coarser spaces.

        As `Factored.coarse_differences`; of the system only the zones and the known pressure count.
        """
        changes = np.zeros((len(values), 2))
        for column, coarse_unknowns in zip(changes.T, self._coarse_unknowns, strict=True):
            difference = self._cholesky.coarse_change(values[self._order], coarse_unknowns)
            column[self._order] = -difference
        if system.pressure_known and system.pressure_terms > 1:
            # the known pressure loses as many degrees
            changes += self.unit_solutions[:, 1 + len(system.radii) :]
        return [*changes.T]

    def energies(self, values: Array) -> Array:
        """Return the energy of the difference to the solution without the top two degrees.

        Of full stick with an unknown pressure: the diagonal part of the energy for p (first row)
        and for ``q/s`` (second row) on every panel and on the tail, (2, panels + 1). Values are a
        vector (unknowns,).
        """
        difference = self._cholesky.coarse_change(values[self._order], self._coarse_unknowns[0])
        energies = np.empty_like(values)
        energies[self._order] = difference**2 * self._cholesky.diagonal
        [part] = self.system.parts
        terms = [*(n + 1 for n in part.degrees), part.mesh.panels.tail_terms]
        starts = np.cumsum([0, *terms[:-1]])
        return np.asarray(np.add.reduceat(energies.reshape(2, -1), starts, axis=1))
