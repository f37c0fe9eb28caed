"""A disk in cells with polynomials in ``z = s**2`` on each: for pressures without singularities.

The unknowns are the coefficients of Legendre polynomials in z on each cell. With the substitution
``z = t**2 + v**2`` the half-integral ``F(t) = int_t p s ds / sqrt(s**2 - t**2)`` of such a function
is an integral ``int p dv`` of a polynomial in v, which Gauss's rule has exactly. Cells may be small
next to one radius, the pivot. So their ends are given as offsets from it, and nothing cancels.
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

#: Width in the logarithm of the distance of a panel that is there only because a `LogSeries` has
#: at least one: the rest of the series, its tail, reaches to this panel.
_DUMMY_PANEL_WIDTH = 1e-15


@dataclass(frozen=True, slots=True)
class DiskCells:
    """The division of a disk into cells.

    Attributes
    ----------
    pivot : Radius
        The radius next to which cells may be small.
    offsets : tuple of float
        Ends of the cells, from the centre outward, as ``s**2`` less that of the pivot.
    """

    pivot: Radius
    offsets: tuple[float, ...]

    @property
    def lengths(self) -> Array:
        """Lengths of the cells in ``s**2``."""
        return np.diff(self.offsets)

    def squares_at(self, places: list[Array]) -> Array:
        """Return ``s**2`` at places in [0, 1] on every cell, one array for all cells."""
        starts = np.array(self.offsets[:-1]) + self.pivot.square
        starts[0] = 0.0
        cells = zip(starts, self.lengths, places, strict=True)
        return np.concatenate([start + length * place for start, length, place in cells])

    def field(self, coefficients: list[Array]) -> ZonalField:
        """Return the function with Legendre coefficients on every cell, from the centre outward.

        A series of the field is graded to one end, so a cell becomes two: one half for each end.
        """
        radii = []
        for offset in self.offsets[1:-1]:
            value = sqrt(self.pivot.square + offset)
            radii.append(Radius(value, (self.pivot.rest - offset) / (1.0 + value)))
        halves = (_half_cell(cell, end) for cell in coefficients for end in (-1.0, 1.0))
        return ZonalField.on_parts((CENTRE, *radii, EDGE), halves, pointed=True)


def _half_cell(coefficients: Array, end: float) -> LogSeries:
    """Return the polynomial between an end of a cell, -1 or 1, and its middle, 0.

    It is a series in the distance from the end. A polynomial in the distance is a tail.
    """
    terms = len(coefficients)
    g, _ = gauss_rule(terms)
    places = end - end * (1.0 + g) / 2.0
    tail = legendre_expansion_matrix(terms, terms - 1) @ (
        legendre_values(places, terms - 1) @ coefficients
    )
    return LogSeries(np.array([[tail.sum()]]), tail, _DUMMY_PANEL_WIDTH)


class CellSpace(NodalSpace):
    """The space of polynomials of given degrees on the cells of a disk.

    A cell is what `NodalSpace` calls a panel.
    """

    def __init__(self, cells: DiskCells, degrees: tuple[int, ...]) -> None:
        self._cells = cells
        self._degrees = degrees
        terms = np.array(degrees) + 1
        self.size = int(terms.sum())
        self.panels = len(degrees)
        cell = np.repeat(np.arange(len(terms)), terms)
        degree = np.arange(self.size) - np.repeat(np.cumsum(terms) - terms, terms)
        degrees_above = np.repeat(terms, terms) - 1 - degree
        self.index = np.argsort(-np.minimum(degrees_above, 2), kind="stable")
        self.coarsest_unknowns = int((degrees_above > 1).sum())
        self.coarse_unknowns = self.coarsest_unknowns + len(terms)
        self.panel = cell[self.index]
        self._mass: Array = (np.repeat(cells.lengths, terms) / (4 * degree + 2))[self.index]
        # A half-integral has a square root at the outer end of each cell, next to which the
        # substitution below clusters the nodes; in the first cell it removes that at the centre,
        # too. A node integrates products of functions on its cell and on those farther out.
        offsets = cells.offsets
        next_degrees = [*degrees[1:], 0]
        #: Distance in ``s**2`` of the nodes of each cell from its outer end.
        self._to_outer_end: list[Array] = []
        t = []
        y = []
        weights = []
        for k, length in enumerate(cells.lengths):
            g, w = gauss_rule(2 * max(degrees[k], next_degrees[k]) + NODE_STEP)
            root = (1.0 + g) / 2.0
            weight = w / 2.0
            if k == 0:
                angle = pi / 2.0 * root
                root = np.sin(angle)
                t.append(sqrt(length) * np.cos(angle))
                weights.append(pi / 2.0 * weight * sqrt(length) * root)
            else:
                t.append(np.sqrt(cells.pivot.square + (offsets[k + 1] - length * root**2)))
                weights.append(weight * length * root / t[-1])
            self._to_outer_end.append(length * root**2)
            y.append((cells.pivot.rest - offsets[k + 1]) + length * root**2)
        self.t = np.concatenate(t)
        self.y = np.concatenate(y)
        self.weights = np.concatenate(weights)
        self.measure = self.weights / pi
        # a punch whose profile has breaks takes panels
        self.past_break = np.zeros(len(self.t))

    @cached_property
    def _matrix(self) -> Array:
        """Half-integrals of the functions at the nodes, in the order of `index`.

        A function is 0 outside its cell j. Its half-integral at a node of cell k is 0 if j < k; it
        reaches over the whole of cell j if j > k, and from the node to the outer end if j is k.
        """
        lengths = self._cells.lengths
        offsets = self._cells.offsets
        rows = []
        for k, to_outer_end in enumerate(self._to_outer_end):
            row = []
            for j, n in enumerate(self._degrees):
                if j < k:
                    row.append(np.zeros((len(to_outer_end), n + 1)))
                    continue
                g, w = gauss_rule(n + 1)
                place = (1.0 + g) / 2.0
                length = lengths[j]
                # v runs from v_start over v_length; from_start and to_end are distances in s**2
                # of the Gauss points from the ends of cell j
                if j == k:
                    v_length = np.sqrt(to_outer_end)
                    to_end = to_outer_end[:, None] * (1.0 - place**2)
                    from_start = (length - to_outer_end)[:, None] + to_outer_end[:, None] * place**2
                else:
                    v_start = np.sqrt((offsets[j] - offsets[k + 1]) + to_outer_end)
                    v_end = np.sqrt(offsets[j + 1] - offsets[k + 1] + to_outer_end)
                    v_length = length / (v_start + v_end)
                    v_passed = v_length[:, None] * place
                    from_start = v_passed * (2.0 * v_start[:, None] + v_passed)
                    v_left = v_length[:, None] * (1.0 - place)
                    to_end = v_left * (2.0 * (v_start + v_length)[:, None] - v_left)
                row.append(
                    legendre_sums_between(
                        v_length[:, None] * (w / 2.0),
                        2.0 * from_start / length,
                        2.0 * to_end / length,
                        n,
                    )
                )
            rows.append(np.hstack(row))
        return np.ascontiguousarray(np.vstack(rows)[:, self.index])

    @cached_property
    def gram(self) -> Array:
        """Gram matrix ``(1/pi) int F_i F_j dt`` of the half-integrals."""
        weighted = self._matrix * np.sqrt(self.measure)[:, None]
        return np.asarray(weighted.T @ weighted)

    @cached_property
    def mass(self) -> Array:
        """Mass matrix ``int phi_i phi_j s ds``, which is diagonal."""
        return np.diag(self._mass)

    def project(self, weighted: Array) -> Array:
        """Return, for every function, the sum of its half-integral times weights at the nodes."""
        return np.asarray(weighted @ self._matrix)

    def half_integral(self, coefficients: Array) -> Array:
        """Return the half-integral at the nodes."""
        return np.asarray(self._matrix @ coefficients[self.index])


cell_space = bounded_cache("cells", 16)(CellSpace)
