"""Many points of the body at once: polynomials on cells of toroidal coordinates.

Between the edge, the boundaries of zones and infinity, stress and displacement are analytic, down
to the surface. The coordinates are tau, which counts e-folds towards the edge, and sigma, an angle
(`charts`). In a cell with many points, a polynomial goes through the integrals at its nodes; its
values are the integrals at the points. Where the last coefficients of the polynomial are too large,
the cell is cut in two or in four, until too few points are left in it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from spectral_contact.equations.interior.charts import from_toroidal
from spectral_contact.equations.interior.integrals import Integrals
from spectral_contact.equations.interior.mesh import BodyPoints
from spectral_contact.fields import Array
from spectral_contact.fields.series import Radius

Direct = Callable[[BodyPoints], Integrals]
Relative = Callable[[BodyPoints, Array, Array], Array]

#: A cell gets a polynomial if it has at least this many times as many points as nodes. With fewer
#: points the nodes take longer than the points themselves (chosen).
_POINTS_PER_NODE = 1.2
#: Size of the first cells, in tau and in sigma (chosen).
_FIRST_SIZE = np.array([3.0, np.pi / 2.0])
#: A cell is not cut below this fraction of the first ones: it holds a boundary of zones, or one
#: point many times.
_SMALLEST = 2.0**-9
#: A cell is cut in both directions, tau and sigma, if the smaller of their truncation errors is at
#: least this fraction of the larger one; else only in the direction with the larger one (chosen).
_CUT_FRACTION = 0.05
#: Nodes of a cell resolve an interval between two boundaries of zones if its width in tau is at
#: least this fraction of the size of the cell.
_RESOLVED = 0.25
#: Next to a narrower interval, points within this many times its width are not interpolated.
_UNRESOLVED_RANGE = 8.0
#: Number of cells whose nodes are evaluated together, which bounds the memory.
_CELLS_TOGETHER = 64


class _Basis:
    """Chebyshev polynomials in one direction, and their nodes.

    Attributes
    ----------
    order : int
    nodes : ndarray, shape (order,)
    to_coefficients : ndarray, shape (order, order)
        Matrix from values at the nodes to coefficients.
    """

    def __init__(self, order: int) -> None:
        self.order = order
        self.nodes = np.cos(np.pi * (np.arange(order) + 0.5) / order)
        self.to_coefficients = np.linalg.inv(self.polynomials(self.nodes))

    def polynomials(self, x: Array) -> Array:
        """Return the polynomials at places in [-1, 1], in the last dimension."""
        return np.asarray(chebyshev.chebvander(x, self.order - 1))


class _Cell(NamedTuple):
    """A rectangle of toroidal coordinates: lower corner, size, and indices of the points in it."""

    low: Array
    size: Array
    points: NDArray[np.intp]


class _Fit(NamedTuple):
    """The integrals at the points of a cell, by a polynomial, and their errors.

    Attributes
    ----------
    values : ndarray, shape (components, points)
    error : ndarray, shape (components,)
        Estimated error of the values.
    load_sums : ndarray, shape (2, components)
        `of_pressure` and `of_traction` of `Integrals`, the largest of all nodes.
    truncation : ndarray, shape (2, components)
        The part of the error that is due to the finite degree in tau, and in sigma.
    """

    values: Array
    error: Array
    load_sums: Array
    truncation: Array


def _toroidal(points: BodyPoints) -> Array:
    """Return tau and sigma, stacked; far away, where both are small, to relative accuracy."""
    d = points.from_edge
    z = points.z
    # distances from the edge below 1e-30 count as 1e-30
    tau = np.log1p(4.0 * np.maximum(points.r, 0.0) / np.maximum(d**2 + z**2, 1e-60)) / 2.0
    return np.stack([tau, np.arctan2(2.0 * z, z**2 - d * (2.0 - d))])


def _first_cells(coordinates: Array) -> list[_Cell]:
    """Return the cells to begin with, those in which there are points.

    Parameters
    ----------
    coordinates : ndarray, shape (2, points)
        tau and sigma.
    """
    if coordinates.shape[1] == 0:
        return []
    index = np.floor(coordinates / _FIRST_SIZE[:, None]).astype(int)
    index[1] = np.minimum(index[1], 1)  # sigma = pi belongs to the second half
    _, cell_of_point = np.unique(2 * index[0] + index[1], return_inverse=True)
    by_cell = np.argsort(cell_of_point, kind="stable")
    groups = np.split(by_cell, np.cumsum(np.bincount(cell_of_point))[:-1])
    return [_Cell(index[:, group[0]] * _FIRST_SIZE, _FIRST_SIZE, group) for group in groups]


def _fits(cells: list[_Cell], coordinates: Array, direct: Direct, basis: _Basis) -> Iterator[_Fit]:
    """Yield the fit on each cell."""
    low = np.array([cell.low for cell in cells])[:, :, None]
    size = np.array([cell.size for cell in cells])[:, :, None]
    tau, sigma = np.moveaxis(low + size * (1.0 + basis.nodes) / 2.0, 1, 0)
    shape = (len(cells), basis.order, basis.order)
    nodes = np.broadcast_to(tau[:, :, None], shape), np.broadcast_to(sigma[:, None, :], shape)
    sums = direct(from_toroidal(*(np.ravel(one) for one in nodes)))
    for k, cell in enumerate(cells):
        cell_nodes = slice(k * basis.order**2, (k + 1) * basis.order**2)
        grid = sums.values[:, cell_nodes].reshape(-1, basis.order, basis.order)
        coefficients = basis.to_coefficients @ grid @ basis.to_coefficients.T
        x = 2.0 * (coordinates[:, cell.points] - cell.low[:, None]) / cell.size[:, None] - 1.0
        in_tau, in_sigma = map(basis.polynomials, x)
        values = np.einsum("cna,na->cn", in_tau @ coefficients, in_sigma)
        moduli = np.abs(coefficients)
        truncation = np.stack([_truncation(moduli), _truncation(moduli.swapaxes(1, 2))])
        error = truncation.sum(axis=0) + sums.quadrature[:, cell_nodes].max(axis=1)
        load_sums = np.stack(
            [
                sums.of_pressure[:, cell_nodes].max(axis=1),
                sums.of_traction[:, cell_nodes].max(axis=1),
            ]
        )
        yield _Fit(values, error, load_sums, truncation)


def narrow_intervals(places: Sequence[Radius]) -> Array:
    """Return the ends, in tau, of the intervals between boundaries, shape (intervals, 2).

    The interval that ends at the edge is left out, as tau resolves all widths towards the edge.
    """
    taus = [np.log1p(4.0 * place.value / place.from_edge**2) / 2.0 for place in places[:-1]]
    return np.array(list(pairwise(taus))).reshape(-1, 2)


def _unresolved(cell: _Cell, coordinates: Array, narrow: Array) -> NDArray[np.bool_]:
    """Return which points are next to intervals that the nodes of a cell do not resolve."""
    tau, sigma = coordinates
    unresolved = np.zeros(len(tau), dtype=bool)
    for low, high in narrow:
        width = high - low
        if width < _RESOLVED * cell.size.max():
            # a unit of tau is as long as one of sigma, and the contact is at sigma = pi
            distance = np.maximum(np.maximum(low - tau, tau - high), np.pi - sigma)
            unresolved |= distance < _UNRESOLVED_RANGE * width
    return unresolved


def _truncation(moduli: Array) -> Array:
    """Return eight times the sum of the terms that a series lacks, by its last coefficients.

    Pairs of coefficients are taken to go on as a geometric series, whose ratio is that of the last
    pair to the pair before it. The factor eight is a margin (chosen).

    Parameters
    ----------
    moduli : ndarray, shape (components, order, order)
        Moduli of the coefficients; the series is that in the second dimension.
    """
    by_degree = moduli.sum(axis=2)
    last = by_degree[:, -2:].sum(axis=1)
    before = by_degree[:, -4:-2].sum(axis=1)
    ratio = np.minimum(last / np.maximum(before, 1e-300), 0.95)
    return np.asarray(8.0 * last * ratio / (1.0 - ratio))


def _cut(
    cell: _Cell, coordinates: Array, points: NDArray[np.intp], truncation: Array
) -> list[_Cell]:
    """Return the halves or quarters of a cell, with the given points distributed over them.

    It is cut in the directions in which the degree of the polynomial does not suffice.
    """
    by_direction = truncation.sum(axis=1)
    halved = by_direction >= _CUT_FRACTION * by_direction.max()
    size = np.where(halved, cell.size / 2.0, cell.size)
    upper = (coordinates[:, points] >= (cell.low + size)[:, None]) & halved[:, None]
    quarter = upper[0] + 2 * upper[1]
    corners = [cell.low + size * np.array([k % 2, k // 2]) for k in range(4)]
    return [_Cell(corners[k], size, points[quarter == k]) for k in range(4)]


def interpolate(
    points: BodyPoints,
    rtol: float,
    order: int,
    direct: Direct,
    relative: Relative,
    out: Integrals,
    narrow: Array,
) -> NDArray[np.bool_]:
    """Fill in the integrals at points by polynomials, where many points are close together.

    Parameters
    ----------
    points : BodyPoints
    rtol : float
        Tolerance of the polynomials, relative as `relative` measures it.
    order : int
        Nodes of a cell in either direction.
    direct : callable
        Returns the integrals at points, without polynomials. At points of the surface they are the
        limits from the body.
    relative : callable
        Returns the relative errors at points, from the points, the integrals there and the errors
        of the integrals.
    out : Integrals
        Takes the integrals.
    narrow : ndarray
        What `narrow_intervals` returns.

    Returns
    -------
    ndarray of bool
        Which points remain to be evaluated: they are too few, or no polynomial is accurate.
    """
    basis = _Basis(order)
    fewest = _POINTS_PER_NODE * order**2
    remaining = np.ones(len(points.r), dtype=bool)
    coordinates = _toroidal(points)
    cells = _first_cells(coordinates)
    # batch by batch; the cells that result from cutting those of a batch are put at the end
    while cells := [cell for cell in cells if len(cell.points) >= fewest]:
        batch = cells[:_CELLS_TOGETHER]
        cells = cells[_CELLS_TOGETHER:]
        for cell, fit in zip(batch, _fits(batch, coordinates, direct, basis), strict=True):
            inside = cell.points
            errors = np.broadcast_to(fit.error[:, None], fit.values.shape)
            refused = ~(relative(points[inside], fit.values, errors) <= rtol)
            refused |= _unresolved(cell, coordinates[:, inside], narrow)
            accepted = inside[~refused]
            remaining[accepted] = False
            out.values[:, accepted] = fit.values[:, ~refused]
            out.quadrature[:, accepted] = fit.error[:, None]
            out.of_pressure[:, accepted], out.of_traction[:, accepted] = fit.load_sums[:, :, None]
            if refused.any() and np.all(cell.size > _SMALLEST * _FIRST_SIZE):
                cells += _cut(cell, coordinates, inside[refused], fit.truncation)
    return remaining
