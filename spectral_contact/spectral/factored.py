"""The triangular factors of the matrix of a contact system, and solutions by them.

A vector holds the coefficients of the pressure p, or multipliers of known pressures, and then those
of q/s (docs/theory), s being the radius over that of the contact. Solutions by the factors are
corrected with the residual, in which nothing cancels (`contact.free_boundary`). So the factors also
serve for systems whose boundaries are slightly different.
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


def factored(system: ContactSystem) -> FactoredSystem:
    """Factor the matrix of a system: by Cholesky if it is symmetric, else by LU."""
    return CholeskyFactoredSystem(system) if system.symmetric else FactoredSystem(system)


class FactoredSystem:
    """A system with the LU factors of its matrix.

    Parameters
    ----------
    system : ContactSystem

    Attributes
    ----------
    system : ContactSystem
    scale : ndarray, shape (unknowns,)
        Factors of rows and columns with which the matrix has a unit diagonal.
    """

    def __init__(self, system: ContactSystem) -> None:
        self.system = system
        matrix = system_matrix(system)
        self.scale: Array = 1.0 / np.sqrt(np.abs(matrix.diagonal()))
        matrix *= self.scale
        matrix *= self.scale[:, None]
        # The tangential equations are scaled so that their entries in columns of the pressure are
        # at most 1/2. There LU then takes its pivots from the normal equations.
        tangential_rows = matrix[system.pressure_terms :]
        coupling = tangential_rows[:, : system.pressure_terms]
        reduction = 0.5 / max(float(np.abs(coupling).max(initial=0.0)), 0.5)
        tangential_rows *= reduction
        self._row_scale = self.scale.copy()
        self._row_scale[system.pressure_terms :] *= reduction
        self._factor = lu_factor(matrix, overwrite_a=True, check_finite=False)

    def step(self, right: Array) -> Array:
        """Return the solutions by the factors alone for right-hand sides as columns.

        With the residual as right-hand side this is a step of iterative refinement.
        """
        scaled = right * self._row_scale[:, None]
        column_sizes = np.maximum(np.abs(scaled).max(axis=0), np.finfo(float).tiny)
        scaled /= column_sizes
        solution = lu_solve(self._factor, scaled, overwrite_b=True, check_finite=False)
        return np.asarray(solution * self.scale[:, None] * column_sizes)

    @cached_property
    def unit_solutions(self) -> Array:
        """Responses to unit data as columns, shape (unknowns, k).

        The first is that to unit approach or, if the pressure is known, to this pressure. Then
        comes one to a unit defect at every boundary: a number that is added to the tangential
        equation there (`contact_system`). The last ones are those to the contributions of the top
        degrees of a known pressure, if there are any.
        """
        system = self.system
        count = 1 + len(system.radii)
        pressure_changes = system.pressure_terms - 1 if system.pressure_known else 0
        values = np.zeros((system.unknowns, count + pressure_changes))
        # the multipliers of a known pressure (True is 1) and of contributions of its top degrees
        values[0, 0] = system.pressure_known
        values[1 : 1 + pressure_changes, count:] = np.eye(pressure_changes)
        units = np.eye(count, values.shape[1])
        values += self.step(system.residual(values, units[0], units[1:]))
        if not system.symmetric:
            # next to a narrow stick zone at the edge the factors lose digits of these responses
            no_approach = np.zeros(count - 1)
            values[:, 1:] += self.step(system.residual(values[:, 1:], no_approach, units[1:, 1:]))
        return values

    @property
    def defect_responses(self) -> Array:
        """Changes of the solution by a unit defect at every boundary, as columns."""
        return self.unit_solutions[:, 1 : 1 + len(self.system.radii)]

    def coarse_differences(self, values: Array, system: ContactSystem) -> list[Array]:
        """Return a solution less the solutions in two coarser spaces.

        The first space lacks the top two degrees of every panel, the second the top one; a known
        pressure lacks them, too. Approach and defects are the same.

        Parameters
        ----------
        values : ndarray, shape (unknowns,)
            The solution.
        system : ContactSystem
            The system of the solution: that of the factors, or one with slightly different
            boundaries.
        """
        # A coarser solution has zeros at the unknowns that its space lacks. So it is the solution
        # for another right-hand side, which differs there by unknown forces: they follow from the
        # responses to unit forces at these unknowns.
        top_degrees = system.top_degree_indices[0]
        count = len(values)
        unit_forces = np.zeros((count, len(top_degrees)))
        unit_forces[top_degrees, np.arange(len(top_degrees))] = 1.0 / self.scale[top_degrees]
        responses = self.step(unit_forces)
        forces = np.zeros((count, 2))
        differences = np.empty((count, 2))
        for i, missing in enumerate(system.top_degree_indices):
            columns = responses[:, np.isin(top_degrees, missing)]
            scale = self.scale[missing]
            multipliers = np.linalg.solve(
                columns[missing] / scale[:, None], values[missing] / scale
            )
            forces[missing, i] = multipliers / scale
            differences[:, i] = columns @ multipliers
        no_approach = np.zeros(2)
        no_defects = np.zeros((len(system.radii), 2))
        residual = system.residual(differences, no_approach, no_defects)
        return [*(differences + self.step(residual + forces)).T]


class CholeskyFactoredSystem(FactoredSystem):
    """A symmetric positive definite system with its Cholesky factor.

    Vectors begin with the multipliers of a known pressure, and the matrix does not. The functions
    that coarser spaces lack come last, so that the leading parts of the factor are those of the
    coarser spaces. If one disk of radius c sticks under a known pressure, its matrix is ``c**5``
    times that of the unit disk with the compliance ``beta / c``, because the kernels are
    homogeneous (docs/theory, Abel factorisation). The space of the unit disk is cached, with its
    mass and Gram matrix. This is `system_matrix` by another way, without `ContactSystem.masses`.
    """

    def __init__(self, system: ContactSystem) -> None:
        self.system = system
        #: the matrix of the system over the one that is factored
        self._matrix_ratio = 1.0
        multipliers = system.pressure_terms if system.pressure_known else 0
        top_degrees = np.concatenate(system.top_degree_indices)
        # the number of the coarser spaces, of two, that lack an unknown
        lacking = np.bincount(top_degrees, minlength=system.unknowns)[multipliers:]
        self._order = multipliers + np.argsort(lacking, kind="stable")
        self._coarse_unknowns = (int((lacking < 1).sum()), int((lacking < 2).sum()))
        if multipliers and len(system.stick_parts) == 1:
            [field] = system.fields
            radius = system.parts[0].mesh.boundary.value
            space = unit_space(field.panels, field.degrees, shear=True)
            self._matrix_ratio = radius**5
            # its unknowns are in the same order
            self._cholesky = space.factor(system.parameters.beta / radius).cholesky
        else:
            self._cholesky = Cholesky(system_matrix(system)[np.ix_(self._order, self._order)])

    def step(self, right: Array) -> Array:
        """Return the solutions by the factor for right-hand sides as columns, uncorrected.

        Multipliers of a known pressure are returned as they are.
        """
        solution = right.copy()
        solution[self._order] = self._cholesky.solve(right[self._order].T).T / self._matrix_ratio
        return solution

    def coarse_differences(self, values: Array, system: ContactSystem) -> list[Array]:
        """Return a solution less the solutions in two coarser spaces.

        As `FactoredSystem.coarse_differences`. The boundaries of `system` do not matter here,
        because the factor alone gives the difference.
        """
        differences = np.zeros((len(values), 2))
        for column, coarse_unknowns in zip(differences.T, self._coarse_unknowns, strict=True):
            change = self._cholesky.coarse_change(values[self._order], coarse_unknowns)
            column[self._order] = -change
        if system.pressure_known and system.pressure_terms > 1:
            # the response to the degrees that the known pressure loses
            differences += self.unit_solutions[:, 1 + len(system.radii) :]
        return [*differences.T]

    def energies(self, values: Array) -> Array:
        """Return the energies, by panels, of the difference to the solution in the coarsest space.

        This is for full stick with an unknown pressure, which has one part. The coarsest space
        lacks the top two degrees of every panel.

        Parameters
        ----------
        values : ndarray, shape (unknowns,)
            The solution.

        Returns
        -------
        ndarray, shape (2, panels + 1)
            The diagonal part of the energy for p (first row) and for q/s (second row) on every
            panel and on the tail.
        """
        change = self._cholesky.coarse_change(values[self._order], self._coarse_unknowns[0])
        energies = np.empty_like(values)
        energies[self._order] = change**2 * self._cholesky.diagonal
        [part] = self.system.parts
        terms = [*(degree + 1 for degree in part.degrees), part.mesh.panels.tail_terms]
        starts = np.cumsum([0, *terms[:-1]])
        return np.asarray(np.add.reduceat(energies.reshape(2, -1), starts, axis=1))
