"""Functions by their values at sampling points, for laws that act point by point.

The pressure of a layer follows from its overclosure at the same radius, by a law that is not
linear. So `Sampling` evaluates a function given by its coefficients, and expands one given by its
values. The derivative of a law is a function that others are multiplied with: `Sampling.times`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from spectral_contact.spectral.jacobi import gauss_rule, legendre_expansion_matrix, legendre_values
from spectral_contact.spectral.panels import DiscreteSpace
from spectral_contact.spectral.tuning import EXTRA

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class _PanelGroup:
    """The panels of a part, which have as many terms and samples each, its tail, or a cell.

    Attributes
    ----------
    coefficient_slice, sample_slice : slice
        Where its coefficients are among all, and its sampling points.
    evaluation, expansion : ndarray
        The matrices from the terms of a panel to values at its sampling points, and back.
    used : ndarray, shape (panels, terms)
        1 for the terms in use, 0 for others.
    is_tail : bool
    """

    coefficient_slice: slice
    sample_slice: slice
    evaluation: Array
    expansion: Array
    used: Array
    is_tail: bool

    def terms(self, coefficients: Array) -> Array:
        """Return its terms, (..., panels, terms), from all coefficients, (..., size)."""
        own = coefficients[..., self.coefficient_slice]
        return own.reshape(*own.shape[:-1], *self.used.shape)

    def values(self, values: Array) -> Array:
        """Return its values, (panels, samples), from those at all sampling points."""
        return values[self.sample_slice].reshape(len(self.used), -1)


class Sampling:
    """The sampling points of all parts: functions from coefficients to values there, and back.

    Parameters
    ----------
    spaces : tuple of DiscreteSpace
        Those of the parts.
    cell_degrees : tuple of int
        Degrees of the polynomials on cells, which take the place of parts.

    Attributes
    ----------
    size, samples : int
        Number of coefficients, and of sampling points.
    """

    def __init__(
        self, spaces: tuple[DiscreteSpace, ...] = (), cell_degrees: tuple[int, ...] = ()
    ) -> None:
        self._groups: list[_PanelGroup] = []
        self.size = 0
        self.samples = 0
        for panels, degrees in spaces:
            used = np.arange(panels.degree + 1) <= np.array(degrees)[:, None]
            self._add(panels.samples, used.astype(float), is_tail=False)
            self._add(panels.tail_points, np.ones((1, panels.tail_terms)), is_tail=True)
        for degree in cell_degrees:
            self._add(degree + EXTRA, np.ones((1, degree + 1)), is_tail=False)

    def _add(self, points: int, used: Array, *, is_tail: bool) -> None:
        """Add panels with so many sampling points each."""
        count, terms = used.shape
        coefficients = slice(self.size, self.size + count * terms)
        samples = slice(self.samples, self.samples + count * points)
        evaluation = legendre_values(gauss_rule(points)[0], terms - 1)
        expansion = legendre_expansion_matrix(points, terms - 1)
        self._groups.append(
            _PanelGroup(coefficients, samples, evaluation, expansion, used, is_tail)
        )
        self.size = coefficients.stop
        self.samples = samples.stop

    def places_on_cells(self) -> list[Array]:
        """Return the places of the sampling points of every cell, from 0 to 1 on the cell."""
        return [(1.0 + gauss_rule(len(group.evaluation))[0]) / 2.0 for group in self._groups]

    def values(self, coefficients: Array) -> Array:
        """Return a function at the sampling points, (samples,)."""
        pieces = [group.terms(coefficients) @ group.evaluation.T for group in self._groups]
        return np.concatenate([piece.ravel() for piece in pieces])

    def coefficients(self, values: Array) -> Array:
        """Return the coefficients of the function through values, (size,)."""
        pieces = [group.used * (group.values(values) @ group.expansion.T) for group in self._groups]
        return np.concatenate([piece.ravel() for piece in pieces])

    def bounds(self, coefficients: Array) -> Array:
        """Return at every sampling point a bound of a function on its panel, (samples,)."""
        pieces = []
        for group in self._groups:
            sums = np.abs(group.terms(coefficients)).sum(axis=1)
            pieces.append(np.repeat(sums, len(group.evaluation)))
        return np.concatenate(pieces)

    def times(self, rows: Array, values: Array) -> Array:
        """Return rows times the matrix by which functions are multiplied with one, (n, size).

        Parameters
        ----------
        rows : ndarray, shape (n, size)
            They act on coefficients, and are zero for terms that are not in use.
        values : ndarray, shape (samples,)
            The function that others are multiplied with, at the sampling points.
        """
        pieces = []
        for group in self._groups:
            matrices = group.expansion @ (group.values(values)[:, :, None] * group.evaluation)
            product = group.terms(rows).transpose(1, 0, 2) @ matrices
            pieces.append(product.transpose(1, 0, 2).reshape(len(rows), -1))
        return np.hstack(pieces)

    def low(self, degree: int) -> NDArray[np.bool_]:
        """Return which coefficients are those of this degree or a lower one, or of a tail."""
        pieces = []
        for group in self._groups:
            count, terms = group.used.shape
            pieces.append(np.tile(group.is_tail | (np.arange(terms) <= degree), count))
        return np.concatenate(pieces)
