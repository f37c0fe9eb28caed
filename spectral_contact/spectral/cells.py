r"""A disk in cells with polynomials in ``s**2`` on each: for pressures without singularities.

In ``u`` with ``z = t**2 + u**2`` half-integrals of polynomials are integrals of polynomials, which
Gauss's rule has exactly. Cells are given by how far they are from a pivot, next to which they may
be small; nothing cancels there.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi, sqrt

import numpy as np
from numpy.typing import NDArray

from spectral_contact.fields.legendre import legendre_sums_between
from spectral_contact.fields.series import (
    CENTRE,
    EDGE,
    LogSeries,
    Radius,
    ZonalField,
)
from spectral_contact.spectral.cache import bounded_cache
from spectral_contact.spectral.jacobi import gauss_rule, legendre_expansion_matrix, legendre_values
from spectral_contact.spectral.regularised import NodalSpace
from spectral_contact.spectral.tuning import NODE_STEP
from spectral_contact.threads import cached_property

Array = NDArray[np.float64]

#: Width in ``x`` of a panel that holds nothing but its end: the series is its tail.
_NO_PANEL = 1e-15


@dataclass(frozen=True, slots=True)
class DiskCells:
    """How a disk is cut.

    Attributes
    ----------
    pivot : Radius
    offsets : tuple of float
        Ends of the cells in ``s**2`` from the pivot's, from the centre to the edge.
    """

    pivot: Radius
    offsets: tuple[float, ...]

    @property
    def lengths(self) -> Array:
        """Their extents in ``s**2``."""
        return np.diff(self.offsets)

    def from_centre(self, local: list[Array]) -> Array:
        """Return ``s**2`` at places in [0, 1] on every cell."""
        starts = np.array(self.offsets[:-1]) + self.pivot.square
        starts[0] = 0.0
        each = zip(starts, self.lengths, local, strict=True)
        return np.concatenate([start + length * one for start, length, one in each])

    def field(self, coefficients: list[Array]) -> ZonalField:
        """Return the function with Legendre coefficients on every cell, from the centre outward."""
        radii = []
        for offset in self.offsets[1:-1]:
            value = sqrt(self.pivot.square + offset)
            radii.append(Radius(value, (self.pivot.rest - offset) / (1.0 + value)))
        halves = (_half(own, np.array([end, 0.0])) for own in coefficients for end in (-1.0, 1.0))
        return ZonalField.on_parts((CENTRE, *radii, EDGE), halves, pointed=True)


def _half(coefficients: Array, ends: Array) -> LogSeries:
    """Return the polynomial between two places, as a series in the distance from the first."""
    terms = len(coefficients)
    g, _ = gauss_rule(terms)
    at = ends[0] + (ends[1] - ends[0]) * (1.0 + g) / 2.0
    tail = legendre_expansion_matrix(terms, terms - 1) @ (
        legendre_values(at, terms - 1) @ coefficients
    )
    return LogSeries(np.array([[tail.sum()]]), tail, _NO_PANEL)


class CellSpace(NodalSpace):
    """Polynomials of these degrees on cells; what a problem for the pressure asks of a space."""

    def __init__(self, cells: DiskCells, degrees: tuple[int, ...]) -> None:
        self._cells, self._degrees = cells, degrees
        terms = np.array(degrees) + 1
        self.size, self.panels = int(terms.sum()), len(degrees)
        cell = np.repeat(np.arange(len(terms)), terms)
        degree = np.arange(self.size) - np.repeat(np.cumsum(terms) - terms, terms)
        left = np.repeat(terms, terms) - 1 - degree
        self.index = np.argsort(-np.minimum(left, 2), kind="stable")
        self.coarsest_unknowns = int((left > 1).sum())
        self.coarse_unknowns = self.coarsest_unknowns + len(terms)
        self.panel = cell[self.index]
        self._mass: Array = (np.repeat(cells.lengths, terms) / (4 * degree + 2))[self.index]
        # nodes are clustered at the outer end of every cell
        lengths, offsets, around = cells.lengths, cells.offsets, [*degrees, 0]
        self._below: list[Array] = []
        t, y, weights = [], [], []
        for k, length in enumerate(lengths):
            g, w = gauss_rule(2 * max(around[k], around[k + 1]) + NODE_STEP)
            v, dv = (1.0 + g) / 2.0, w / 2.0
            if k == 0:  # and no square root at the centre
                phi = pi / 2.0 * v
                v = np.sin(phi)
                t.append(sqrt(length) * np.cos(phi))
                weights.append(pi / 2.0 * dv * sqrt(length) * v)
            else:
                t.append(np.sqrt(cells.pivot.square + (offsets[k + 1] - length * v**2)))
                weights.append(dv * length * v / t[-1])
            self._below.append(length * v**2)
            y.append((cells.pivot.rest - offsets[k + 1]) + length * v**2)
        self.t, self.y, self.weights = np.concatenate(t), np.concatenate(y), np.concatenate(weights)
        self.measure = self.weights / pi
        self.past_break = np.zeros(len(self.t))

    @cached_property
    def _matrix(self) -> Array:
        """Half-integrals of the functions at the nodes, in the order of `index`."""
        lengths, offsets = self._cells.lengths, self._cells.offsets
        rows = []
        for k, below in enumerate(self._below):
            row = []
            for j, n in enumerate(self._degrees):
                if j < k:
                    row.append(np.zeros((len(below), n + 1)))
                    continue
                g, w = gauss_rule(n + 1)
                share, length = (1.0 + g) / 2.0, lengths[j]
                if j == k:
                    span = np.sqrt(below)
                    to_end = below[:, None] * (1.0 - share**2)
                    from_start = (length - below)[:, None] + below[:, None] * share**2
                else:
                    first = np.sqrt((offsets[j] - offsets[k + 1]) + below)
                    span = length / (first + np.sqrt(offsets[j + 1] - offsets[k + 1] + below))
                    step = span[:, None] * share
                    from_start = step * (2.0 * first[:, None] + step)
                    rest = span[:, None] * (1.0 - share)
                    to_end = rest * (2.0 * (first + span)[:, None] - rest)
                ends = 2.0 * from_start / length, 2.0 * to_end / length
                row.append(legendre_sums_between(span[:, None] * (w / 2.0), *ends, n))
            rows.append(np.hstack(row))
        return np.ascontiguousarray(np.vstack(rows)[:, self.index])

    @cached_property
    def gram(self) -> Array:
        """Gram matrix of the half-integrals."""
        weighted = self._matrix * np.sqrt(self.measure)[:, None]
        return np.asarray(weighted.T @ weighted)

    @cached_property
    def mass(self) -> Array:
        """Mass matrix ``int phi psi s ds``."""
        return np.diag(self._mass)

    def project(self, weighted: Array) -> Array:
        """Return the sums of the half-integrals times weighted values at the nodes."""
        return np.asarray(weighted @ self._matrix)

    def half_integral(self, coefficients: Array) -> Array:
        """Return the half-integral at the nodes."""
        return np.asarray(self._matrix @ coefficients[self.index])


cell_space = bounded_cache("cells", 16)(CellSpace)
