"""Functions of a space by their values: what is no linear operator, and what it is next to one."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from spectral_contact.spectral.jacobi import (
    gauss_rule,
    legendre_expansion_matrix,
    legendre_values,
)
from spectral_contact.spectral.panels import LogPanels

__all__ = ["Sampling"]

Array = NDArray[np.float64]
Used = tuple[LogPanels, tuple[int, ...]]


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
    """

    first: int
    sample: int
    count: int
    terms: int
    samples: int
    evaluate: Array
    expand: Array
    kept: Array

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
    """

    def __init__(self, used: tuple[Used, ...]) -> None:
        self._pieces: list[_Stretch] = []
        self.size = self.samples = 0
        for panels, degrees in used:
            terms, points = panels.degree + 1, panels.samples
            own = np.arange(terms) <= np.array(degrees)[:, None]
            self._add(len(degrees), terms, points, own.astype(float))
            self._add(1, panels.tail_terms, panels.tail_points, np.ones((1, panels.tail_terms)))

    def _add(self, count: int, terms: int, points: int, kept: Array) -> None:
        g, _ = gauss_rule(points)
        evaluate = legendre_values(g, terms - 1)
        expand = legendre_expansion_matrix(points, terms - 1)
        self._pieces.append(
            _Stretch(self.size, self.samples, count, terms, points, evaluate, expand, kept)
        )
        self.size += count * terms
        self.samples += count * points

    def values(self, coefficients: Array) -> Array:
        """Return a function at the sampling points, (samples,)."""
        parts = [piece.table(coefficients) @ piece.evaluate.T for piece in self._pieces]
        return np.concatenate([part.ravel() for part in parts])

    def coefficients(self, values: Array) -> Array:
        """Return the function through values, (size,)."""
        parts = [piece.kept * (piece.at(values) @ piece.expand.T) for piece in self._pieces]
        return np.concatenate([part.ravel() for part in parts])

    def factors(self, values: Array) -> Iterator[tuple[slice, Array]]:
        """Yield the blocks of the matrix that multiplies a function with values, (size, size).

        They are on its diagonal: the place of each, and the block.
        """
        for piece in self._pieces:
            weighted = piece.at(values)[:, :, None] * piece.evaluate
            blocks = (piece.expand @ weighted) * piece.kept[:, :, None] * piece.kept[:, None, :]
            for k, block in enumerate(blocks):
                start = piece.first + k * piece.terms
                yield slice(start, start + piece.terms), block
