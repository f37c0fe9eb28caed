"""Functions of a space by their values: what is no linear operator, and what it is next to one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from spectral_contact.spectral.jacobi import gauss_rule, legendre_expansion_matrix, legendre_values
from spectral_contact.spectral.panels import Used

__all__ = ["Sampling"]

Array = NDArray[np.float64]

#: Samples beyond the degree of a polynomial.
_MORE = 8


@dataclass(frozen=True, slots=True)
class _Stretch:
    """Panels with as many terms and samples each, or a tail.

    Attributes
    ----------
    first, sample : int
        The first coefficient and the first sample.
    count, terms, samples : int
        Number of panels; terms and samples of each.
    evaluate, expand : ndarray
        From terms to samples, and back.
    kept : ndarray, shape (count, terms)
        1 for the terms in use, 0 for others.
    tail : bool
    """

    first: int
    sample: int
    count: int
    terms: int
    samples: int
    evaluate: Array
    expand: Array
    kept: Array
    tail: bool

    def table(self, coefficients: Array) -> Array:
        """Return the coefficients of these panels, (count, terms)."""
        stop = self.first + self.count * self.terms
        return coefficients[self.first : stop].reshape(self.count, self.terms)

    def at(self, values: Array) -> Array:
        """Return the values on these panels, (count, samples)."""
        stop = self.sample + self.count * self.samples
        return values[self.sample : stop].reshape(self.count, self.samples)


class Sampling:
    """Values of functions at the sampling points of all parts, and functions through values.

    Parameters
    ----------
    used : tuple of (LogPanels, tuple of int)
        Panels of every part, and the degrees on them.
    polynomials : tuple of int
        Degrees on cells instead.
    """

    def __init__(self, used: tuple[Used, ...] = (), polynomials: tuple[int, ...] = ()) -> None:
        self._pieces: list[_Stretch] = []
        self.size = self.samples = 0
        for panels, degrees in used:
            terms, points = panels.degree + 1, panels.samples
            own = np.arange(terms) <= np.array(degrees)[:, None]
            self._add(points, own.astype(float), tail=False)
            self._add(panels.tail_points, np.ones((1, panels.tail_terms)), tail=True)

        for degree in polynomials:
            self._add(degree + _MORE, np.ones((1, degree + 1)), tail=False)

    def _add(self, points: int, kept: Array, *, tail: bool) -> None:
        count, terms = kept.shape
        g, _ = gauss_rule(points)
        evaluate = legendre_values(g, terms - 1)
        expand = legendre_expansion_matrix(points, terms - 1)
        self._pieces.append(
            _Stretch(self.size, self.samples, count, terms, points, evaluate, expand, kept, tail)
        )
        self.size += count * terms
        self.samples += count * points

    def places(self) -> list[Array]:
        """Return the sampling points in [0, 1], piece by piece."""
        return [np.tile((1.0 + gauss_rule(p.samples)[0]) / 2.0, p.count) for p in self._pieces]

    def values(self, coefficients: Array) -> Array:
        """Return a function at the sampling points, (samples,)."""
        parts = [piece.table(coefficients) @ piece.evaluate.T for piece in self._pieces]
        return np.concatenate([part.ravel() for part in parts])

    def coefficients(self, values: Array) -> Array:
        """Return the function through values, (size,)."""
        parts = [piece.kept * (piece.at(values) @ piece.expand.T) for piece in self._pieces]
        return np.concatenate([part.ravel() for part in parts])

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
            stop = piece.first + piece.count * piece.terms
            own = rows[:, piece.first : stop].reshape(len(rows), piece.count, piece.terms)
            blocks = piece.expand @ (piece.at(values)[:, :, None] * piece.evaluate)
            product = own.transpose(1, 0, 2) @ blocks
            parts.append(product.transpose(1, 0, 2).reshape(len(rows), -1))
        return np.hstack(parts)

    def low(self, degree: int) -> NDArray[np.bool_]:
        """Return which coefficients are of a low degree, or of a tail, (size,)."""
        parts = []
        for piece in self._pieces:
            parts.append(np.tile(piece.tail | (np.arange(piece.terms) <= degree), piece.count))
        return np.concatenate(parts)
