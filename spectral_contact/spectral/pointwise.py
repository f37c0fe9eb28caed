"""Functions of a space by their values: what is no linear operator, and what it is next to one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from spectral_contact.spectral.jacobi import gauss_rule, legendre_expansion_matrix, legendre_values
from spectral_contact.spectral.panels import DiscreteSpace
from spectral_contact.spectral.tuning import EXTRA

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class _Stretch:
    """Panels with as many terms and samples each, or a tail.

    Attributes
    ----------
    own, sampled : slice
        Its coefficients and its samples.
    evaluate, expand : ndarray
        From terms to samples, and back.
    kept : ndarray, shape (panels, terms)
        1 for the terms in use, 0 for others.
    tail : bool
    """

    own: slice
    sampled: slice
    evaluate: Array
    expand: Array
    kept: Array
    tail: bool

    def at(self, values: Array) -> Array:
        """Return the values on these panels, (panels, samples)."""
        return values[self.sampled].reshape(len(self.kept), -1)


class Sampling:
    """Values of functions at the sampling points of all parts, and functions through values.

    Parameters
    ----------
    used : tuple of DiscreteSpace
        Of every part.
    polynomials : tuple of int
        Degrees on cells instead.
    """

    def __init__(
        self, used: tuple[DiscreteSpace, ...] = (), polynomials: tuple[int, ...] = ()
    ) -> None:
        self._pieces: list[_Stretch] = []
        self.size = self.samples = 0
        for panels, degrees in used:
            terms, points = panels.degree + 1, panels.samples
            own = np.arange(terms) <= np.array(degrees)[:, None]
            self._add(points, own.astype(float), tail=False)
            self._add(panels.tail_points, np.ones((1, panels.tail_terms)), tail=True)

        for degree in polynomials:
            self._add(degree + EXTRA, np.ones((1, degree + 1)), tail=False)

    def _add(self, points: int, kept: Array, *, tail: bool) -> None:
        count, terms = kept.shape
        evaluate = legendre_values(gauss_rule(points)[0], terms - 1)
        expand = legendre_expansion_matrix(points, terms - 1)
        own = slice(self.size, self.size + count * terms)
        sampled = slice(self.samples, self.samples + count * points)
        self._pieces.append(_Stretch(own, sampled, evaluate, expand, kept, tail))
        self.size, self.samples = own.stop, sampled.stop

    def places(self) -> list[Array]:
        """Return the sampling points in [0, 1], piece by piece."""
        each = [(gauss_rule(len(piece.evaluate))[0], len(piece.kept)) for piece in self._pieces]
        return [np.tile((1.0 + g) / 2.0, count) for g, count in each]

    def values(self, coefficients: Array) -> Array:
        """Return a function at the sampling points, (samples,)."""
        parts = [
            coefficients[piece.own].reshape(piece.kept.shape) @ piece.evaluate.T
            for piece in self._pieces
        ]
        return np.concatenate([part.ravel() for part in parts])

    def coefficients(self, values: Array) -> Array:
        """Return the function through values, (size,)."""
        parts = [piece.kept * (piece.at(values) @ piece.expand.T) for piece in self._pieces]
        return np.concatenate([part.ravel() for part in parts])

    def bounds(self, coefficients: Array) -> Array:
        """Return at every sampling point a bound of a function on its panel, (samples,)."""
        parts = []
        for piece in self._pieces:
            sums = np.abs(coefficients[piece.own].reshape(piece.kept.shape)).sum(axis=1)
            parts.append(np.repeat(sums, len(piece.evaluate)))
        return np.concatenate(parts)

    def times(self, rows: Array, values: Array) -> Array:
        """Return rows times the matrix that multiplies a function with values, (n, size).

        Parameters
        ----------
        rows : ndarray, shape (n, size)
            Zero for terms that are not in use.
        values : ndarray, shape (samples,)
        """
        parts = []
        for piece in self._pieces:
            own = rows[:, piece.own].reshape(len(rows), *piece.kept.shape)
            blocks = piece.expand @ (piece.at(values)[:, :, None] * piece.evaluate)
            product = own.transpose(1, 0, 2) @ blocks
            parts.append(product.transpose(1, 0, 2).reshape(len(rows), -1))
        return np.hstack(parts)

    def low(self, degree: int) -> NDArray[np.bool_]:
        """Return which coefficients are of a low degree, or of a tail, (size,)."""
        shapes = [(piece.tail, *piece.kept.shape) for piece in self._pieces]
        parts = [np.tile(tail | (np.arange(n) <= degree), count) for tail, count, n in shapes]
        return np.concatenate(parts)
