"""The matrix of a system and its factors: solutions are corrected with them.

Corrections take the residual from the half-integrals, so that the factors may be rough: those of
boundaries close by serve.
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
    """A system, factored.

    In single precision it has subnormal numbers, since what is next to a boundary is tiny: on a
    processor that is slow with these coupled partial slip takes 1.3 times as long, else 0.92.
    """

    def __init__(self, system: ContactSystem) -> None:
        self.system, matrix = system, system_matrix(system)
        self.scale: Array = 1.0 / np.sqrt(np.abs(matrix.diagonal()))
        matrix *= self.scale
        matrix *= self.scale[:, None]
        # pivots are to be found among the equations of the pressure first, which are graded
        driven = matrix[system.pressure_terms :]
        small = 0.5 / max(float(np.abs(driven[:, : system.pressure_terms]).max(initial=0.0)), 0.5)
        driven *= small
        self._rows = self.scale.copy()
        self._rows[system.pressure_terms :] *= small
        self._factor = lu_factor(matrix, overwrite_a=True, check_finite=False)

    def step(self, right: Array) -> Array:
        """Return the solution as factored, of right-hand sides as columns."""
        scaled = right * self._rows[:, None]
        size = np.maximum(np.abs(scaled).max(axis=0), np.finfo(float).tiny)
        scaled /= size
        step = lu_solve(self._factor, scaled, overwrite_b=True, check_finite=False)
        return np.asarray(step * self.scale[:, None] * size)

    @cached_property
    def first(self) -> Array:
        """Solutions for unit approach, imbalances and changes of a given pressure, as columns."""
        system, count = self.system, 1 + len(self.system.radii)
        changes = system.pressure_terms - 1 if system.pressure_known else 0
        values = np.zeros((system.unknowns, count + changes))
        if system.symmetric and not system.pressure_known:
            values[: system.pressure_terms, 0] = system.load_row
            return self.step(values)
        values[0, 0] = system.pressure_known
        values[1 : 1 + changes, count:] = np.eye(changes)
        units = np.eye(count, values.shape[1])
        values += self.step(system.project(system.pointwise_residual(values, units[0], units[1:])))
        if not system.symmetric:  # next to a narrow edge that sticks factors lose what is there
            nothing = np.zeros(count - 1)
            values[:, 1:] += self.step(system.residual(values[:, 1:], nothing, units[1:, 1:]))
        return values

    @property
    def responses(self) -> Array:
        """The solutions for a unit imbalance at every boundary, without approach, as columns."""
        return self.first[:, 1 : 1 + len(self.system.radii)]

    def change(self, values: Array, system: ContactSystem) -> list[Array]:
        """Return what the top two degrees of every panel, and the top one, contribute.

        They are the differences to the solution without them, at the same approach and imbalances.
        A pressure that is given lacks its two changes with them. The system is that of the
        solution: that of the factors or a like one.
        """
        first, count = system.top_degree_indices[0], len(values)
        right = np.zeros((count, len(first)))
        right[first, np.arange(len(first))] = 1.0 / self.scale[first]
        response = self.step(right)
        forced, changes = np.zeros((count, 2)), np.empty((count, 2))
        for i, shed in enumerate(system.top_degree_indices):
            columns, own = response[:, np.isin(first, shed)], self.scale[shed]
            forces = np.linalg.solve(columns[shed] / own[:, None], values[shed] / own)
            forced[shed, i] = forces / own
            changes[:, i] = columns @ forces
        nothing = np.zeros(2), np.zeros((len(system.radii), 2))
        return [*(changes + self.step(system.residual(changes, *nothing) + forced)).T]


class Symmetric(Factored):
    """A symmetric positive definite system by Cholesky, what coarser spaces lack last.

    A pressure that is given stays as it is. Then a disk has the matrix of the unit disk, which is
    kept, with ``beta / c``.
    """

    def __init__(self, system: ContactSystem) -> None:
        self.system, self._unit = system, 1.0
        known = system.pressure_terms if system.pressure_known else 0
        if system.pressure_known and len(system.stick_parts) == 1:
            [field], radius = system.fields, system.parts[0].family.boundary.value
            space = unit_space(field.panels, field.degrees, shear=True)
            self._unit, self._kept = radius**5, (space.kept, space.kept_but_one)
            self._order = known + space.place
            self._cholesky = space.factor(system.parameters.beta / radius).cholesky
            return
        tops = np.concatenate(system.top_degree_indices)
        lacking = np.bincount(tops, minlength=system.unknowns)[known:]
        self._order = known + np.argsort(lacking, kind="stable")
        self._kept = int((lacking < 1).sum()), int((lacking < 2).sum())
        self._cholesky = Cholesky(system_matrix(system)[np.ix_(self._order, self._order)])

    def step(self, right: Array) -> Array:
        """Return the solution as factored, of right-hand sides as columns."""
        step = right.copy()
        step[self._order] = self._cholesky.solve(right[self._order].T).T / self._unit
        return step

    def change(self, values: Array, system: ContactSystem) -> list[Array]:
        """Return what the top two degrees of every panel, and the top one, contribute."""
        changes = np.zeros((len(values), 2))
        for column, kept in zip(changes.T, self._kept, strict=True):
            column[self._order] = -self._cholesky.shed(values[self._order], kept)
        if system.pressure_known and system.pressure_terms > 1:  # the pressure lacks as much
            changes += self.first[:, 1 + len(system.radii) :]
        return [*changes.T]

    def energies(self, values: Array) -> Array:
        """Return the energies of what the top two degrees contribute, shape (2, panels + 1).

        Those of p and of q/s, on every panel and the tail.
        """
        shed = self._cholesky.shed(values[self._order], self._kept[0])
        energies = np.empty_like(values)
        energies[self._order] = shed**2 * self._cholesky.diagonal
        [part] = self.system.parts
        terms = [*(n + 1 for n in part.degrees), part.family.panels.tail_terms]
        starts = np.cumsum([0, *terms[:-1]])
        return np.asarray(np.add.reduceat(energies.reshape(2, -1), starts, axis=1))
