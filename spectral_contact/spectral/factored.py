"""The matrix of a system and its factors: solutions are corrected with them.

Corrections take the residual in double precision, from the half-integrals, so that the factors may
be rough: of single precision as long as that serves, or those of boundaries close by.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lu_factor, lu_solve

from spectral_contact.spectral.regularised import Cholesky
from spectral_contact.threads import cached_property

if TYPE_CHECKING:
    from spectral_contact.spectral.tangential import Tangential

Array = NDArray[np.float64]

#: What a correction may leave of the last one: with 0.5, 13 of 16 inputs an ulp apart converge to
#: 1e-10 next to an edge that sticks over 2e-6, all to 1e-11; with 0.01 all do. Most leave 1e-7.
_LEFT_OVER = 0.01
#: A diagonal below it has no digits in single precision: a stick disk of 1e-9 has one of 1e-45.
_SINGLE = np.finfo(np.float32)
_LEAST = float(_SINGLE.tiny / _SINGLE.eps)


def factored(system: Tangential, *, exact: bool = True) -> Factored:
    """Return a system factored: by Cholesky if it is symmetric, else by LU; see `Factored`.

    In double precision all the same, where single precision would not serve corrections.
    """
    if system.symmetric:
        return Symmetric(system)
    found = Factored(system, exact=exact)
    return found if found.exact or found.serves else Factored(system, exact=True)


class Factored:
    """A system, factored.

    Parameters
    ----------
    system : Tangential
    exact : bool
        Factor in double precision, as is done anyway where single precision has not the range.
    """

    def __init__(self, system: Tangential, *, exact: bool = True) -> None:
        self.system, self.exact = system, exact
        kind = np.float64 if exact else np.float32
        matrix = system.matrix(kind)
        if not exact and np.abs(matrix.diagonal()).min() < _LEAST:
            self.exact, kind = True, np.float64
            matrix = system.matrix(kind)
        self.scale: Array = 1.0 / np.sqrt(np.abs(matrix.diagonal()).astype(float))
        matrix *= self.scale.astype(kind)
        matrix *= self.scale[:, None].astype(kind)
        # pivots are to be found among the equations of the pressure first, which are graded
        driven = matrix[system.count :]
        small = 0.5 / max(float(np.abs(driven[:, : system.count]).max(initial=0.0)), 0.5)
        driven *= small
        self._rows = self.scale.copy()
        self._rows[system.count :] *= small
        self._factor = lu_factor(matrix, overwrite_a=True, check_finite=False)

    def step(self, right: Array) -> Array:
        """Return the solution as factored, of right-hand sides as columns."""
        scaled = right * self._rows[:, None]
        size = np.maximum(np.abs(scaled).max(axis=0), np.finfo(float).tiny)
        scaled /= size
        step = lu_solve(self._factor, scaled.astype(self._factor[0].dtype), check_finite=False)
        return np.asarray(step * self.scale[:, None] * size)

    @cached_property
    def responses(self) -> Array:
        """The solutions for a unit imbalance at every boundary, without approach, as columns."""
        units = np.eye(len(self.system.radii))
        values = np.zeros((self.system.unknowns, len(units)))
        for _ in range(2):
            self._last = self.step(self.system.residual(values, np.zeros(len(units)), units))
            values += self._last
        return values

    @property
    def serves(self) -> bool:
        """Whether corrections shrink fast: the last one of the responses does at the boundaries.

        There a traction is what tiny coefficients are, whose digits single precision may lose.
        """
        if self.system.parameters.beta == 0.0:
            return True
        whole = self.system.jumps @ self.responses
        return bool(
            np.abs(self.system.jumps @ self._last).max() <= _LEFT_OVER * np.abs(whole).max()
        )

    def change(self, values: Array, system: Tangential) -> list[Array]:
        """Return what the top two degrees of every panel, and the top one, contribute.

        They are the differences to the solution without them, at the same approach and imbalances.
        A pressure that is given lacks its two changes with them. The system is that of the
        solution: that of the factors or a like one.
        """
        first, count = system.shed[0], len(values)
        right = np.zeros((count, len(first)))
        right[first, np.arange(len(first))] = 1.0 / self.scale[first]
        response = self.step(right)
        forced, changes = np.zeros((count, 2)), np.empty((count, 2))
        for i, shed in enumerate(system.shed):
            columns, own = response[:, np.isin(first, shed)], self.scale[shed]
            forces = np.linalg.solve(columns[shed] / own[:, None], values[shed] / own)
            forced[shed, i] = forces / own
            changes[:, i] = columns @ forces
        nothing = np.zeros(2), np.zeros((len(system.radii), 2))
        return [*(changes + self.step(system.residual(changes, *nothing) + forced)).T]


class Symmetric(Factored):
    """A symmetric positive definite system by Cholesky, what coarser spaces lack last.

    A pressure that is given stays as it is.
    """

    def __init__(self, system: Tangential) -> None:
        self.system, self.exact = system, True
        lacking = np.bincount(np.concatenate(system.shed), minlength=system.unknowns)
        self._known = system.count if system.given else 0
        self._order = self._known + np.argsort(lacking[self._known :], kind="stable")
        self._kept = tuple(int((lacking[self._known :] < n).sum()) for n in (1, 2))
        self._cholesky = Cholesky(system.matrix()[np.ix_(self._order, self._order)])

    def step(self, right: Array) -> Array:
        """Return the solution as factored, of right-hand sides as columns."""
        step = right.copy()
        step[self._order] = self._cholesky.solve(right[self._order].T).T
        return step

    def change(self, values: Array, system: Tangential) -> list[Array]:
        """Return what the top two degrees of every panel, and the top one, contribute."""
        changes = np.zeros((len(values), 2))
        for column, kept in zip(changes.T, self._kept, strict=True):
            column[self._order] = -self._cholesky.shed(values[self._order], kept)
        if system.given:  # by as much less is known of the pressure
            less = np.zeros_like(changes)
            less[1 : system.count] = np.eye(system.count - 1, 2)
            nothing = np.zeros(2), np.zeros((len(system.radii), 2))
            changes += less + self.step(system.residual(less, *nothing))
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
