"""Many points of the body at once: polynomials on cells of toroidal coordinates.

Between the edge, the boundaries of zones and infinity, stress and displacement are analytic, down
to the surface. With the distances d1 from the edge and d2 from the opposite one, tau = ln(d2/d1)
counts e-folds towards the edge, and sigma is the angle between the two directions: pi on the
contact, 0 on the free surface. A cell in which many points lie is replaced by a polynomial; it is
cut in two where its last coefficients are too large, until too few points are left.
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

#: A cell with fewer points than this many times its nodes is not worth them.
_FEWEST = 1.2
#: Size of the cells that are tried first.
_WIDTH = np.array([3.0, np.pi / 2.0])
#: A cell is not cut below this share of the first ones: it holds a boundary of zones, or one point
#: many times.
_SMALLEST = 2.0**-9
#: A cell is cut in both directions if the better one has this share of what the worse one lacks.
_ALSO = 0.05
#: Nodes of a cell resolve an interval between two boundaries of zones that is this share of it;
#: next to a narrower one, points within so many times its width are not interpolated.
_RESOLVED, _AROUND = 0.25, 8.0
#: Cells whose nodes are evaluated together, which bounds the memory.
_TOGETHER = 64


class _Basis:
    """Chebyshev's polynomials of so many nodes in either direction.

    Attributes
    ----------
    order : int
    nodes : ndarray, shape (order,)
    to_coefficients : ndarray, shape (order, order)
        Takes values at the nodes to coefficients.
    """

    def __init__(self, order: int) -> None:
        self.order = order
        self.nodes = np.cos(np.pi * (np.arange(order) + 0.5) / order)
        self.to_coefficients = np.linalg.inv(self.at(self.nodes))

    def at(self, x: Array) -> Array:
        """Return the polynomials at places in [-1, 1], in the last dimension."""
        return np.asarray(chebyshev.chebvander(x, self.order - 1))


class _Cell(NamedTuple):
    """A rectangle of toroidal coordinates: its corner, its size, and the points that are in it."""

    low: Array
    size: Array
    points: NDArray[np.intp]


class _Fit(NamedTuple):
    """Values at the points of a cell, their error, sizes of the terms, and last coefficients."""

    values: Array
    quadrature: Array
    sizes: Array
    tails: Array


def _toroidal(points: BodyPoints) -> Array:
    """Return tau and sigma, stacked; far away both are small, and accurate."""
    d, z = points.from_edge, points.z
    # no point is at the edge itself by more than 1e-30
    tau = np.log1p(4.0 * np.maximum(points.r, 0.0) / np.maximum(d**2 + z**2, 1e-60)) / 2.0
    return np.stack([tau, np.arctan2(2.0 * z, z**2 - d * (2.0 - d))])


def _first(at: Array) -> list[_Cell]:
    """Return the cells to begin with, each with its points; without points there are none."""
    if at.shape[1] == 0:
        return []
    number = np.floor(at / _WIDTH[:, None]).astype(int)
    number[1] = np.minimum(number[1], 1)
    _, owner = np.unique(2 * number[0] + number[1], return_inverse=True)
    order = np.argsort(owner, kind="stable")
    groups = np.split(order, np.cumsum(np.bincount(owner))[:-1])
    return [_Cell(number[:, some[0]] * _WIDTH, _WIDTH, some) for some in groups]


def _fits(cells: list[_Cell], at: Array, direct: Direct, basis: _Basis) -> Iterator[_Fit]:
    """Yield what polynomials on the cells say of the points there."""
    low, size = (np.array([cell[k] for cell in cells])[:, :, None] for k in (0, 1))
    tau, sigma = np.moveaxis(low + size * (1.0 + basis.nodes) / 2.0, 1, 0)
    shape = (len(cells), basis.order, basis.order)
    nodes = np.broadcast_to(tau[:, :, None], shape), np.broadcast_to(sigma[:, None, :], shape)
    sums = direct(from_toroidal(*(np.ravel(one) for one in nodes)))
    for k, cell in enumerate(cells):
        own = slice(k * basis.order**2, (k + 1) * basis.order**2)
        grid = sums.values[:, own].reshape(-1, basis.order, basis.order)
        coefficients = basis.to_coefficients @ grid @ basis.to_coefficients.T
        x = 2.0 * (at[:, cell.points] - cell.low[:, None]) / cell.size[:, None] - 1.0
        across, around = map(basis.at, x)
        values = np.einsum("cna,na->cn", across @ coefficients, around)
        tails = np.stack([_tail(np.abs(coefficients)), _tail(np.abs(coefficients).swapaxes(1, 2))])
        missing = tails.sum(axis=0) + sums.quadrature[:, own].max(axis=1)
        sizes = np.stack([one[:, own].max(axis=1) for one in (sums.of_pressure, sums.of_traction)])
        yield _Fit(values, missing, sizes, tails)


def narrow_intervals(places: Sequence[Radius]) -> Array:
    """Return the ends, in tau, of the intervals between boundaries, shape (intervals, 2).

    Those that end at the centre or at the edge are left out: the one is where loads are smooth, or
    singular in a way that is seen from afar, and towards the other tau resolves all widths.
    """
    inner = places[1:-1]
    taus = [np.log1p(4.0 * one.value / one.from_edge**2) / 2.0 for one in inner]
    return np.array(list(pairwise(taus))).reshape(-1, 2)


def _unseen(cell: _Cell, at: Array, narrow: Array) -> NDArray[np.bool_]:
    """Return which points are next to intervals that the nodes of a cell do not resolve."""
    found = np.zeros(at.shape[1], dtype=bool)
    for low, high in narrow:
        width = high - low
        if width < _RESOLVED * cell.size.max():
            apart = np.maximum(np.maximum(low - at[0], at[0] - high), np.pi - at[1])
            found |= apart < _AROUND * width
    return found


def _tail(moduli: Array) -> Array:
    """Return eight times what a series lacks if it goes on falling as its last coefficients do."""
    size = moduli.sum(axis=2)
    last, before = size[:, -2:].sum(axis=1), size[:, -4:-2].sum(axis=1)
    ratio = np.minimum(last / np.maximum(before, 1e-300), 0.95)
    return np.asarray(8.0 * last * ratio / (1.0 - ratio))


def _cut(cell: _Cell, at: Array, bad: NDArray[np.intp], tails: Array) -> list[_Cell]:
    """Cut a cell across the directions in which its polynomial is bad."""
    moduli = tails.sum(axis=1)
    across = moduli >= _ALSO * moduli.max()
    size = np.where(across, cell.size / 2.0, cell.size)
    upper = (at[:, bad] >= (cell.low + size)[:, None]) & across[:, None]
    part = upper[0] + 2 * upper[1]
    corners = [cell.low + size * np.array([k % 2, k // 2]) for k in range(4)]
    return [_Cell(corners[k], size, bad[part == k]) for k in range(4)]


def interpolate(
    points: BodyPoints,
    rtol: float,
    order: int,
    direct: Direct,
    relative: Relative,
    out: Integrals,
    narrow: Array,
) -> NDArray[np.bool_]:
    """Fill in the integrals at points that many others are close to.

    Parameters
    ----------
    points : BodyPoints
    rtol : float
        What the polynomials may miss by, as `relative` measures it.
    order : int
        Nodes of a cell in either direction.
    direct : callable
        Integrals at given points, as limits from the body on the surface.
    relative : callable
        Relative error of points with given integrals and their errors.
    out : Integrals
        What to fill in.
    narrow : ndarray
        What `narrow_intervals` returns.

    Returns
    -------
    ndarray of bool
        Which points are left: there are too few of them, or no polynomial serves.
    """
    basis, fewest = _Basis(order), _FEWEST * order**2
    left = np.ones(len(points.r), dtype=bool)
    at = _toroidal(points)
    cells = _first(at)
    while cells := [cell for cell in cells if len(cell.points) >= fewest]:
        now, cells = cells[:_TOGETHER], cells[_TOGETHER:]
        for cell, fit in zip(now, _fits(now, at, direct, basis), strict=True):
            which = cell.points
            missing = np.broadcast_to(fit.quadrature[:, None], fit.values.shape)
            bad = ~(relative(points[which], fit.values, missing) <= rtol)
            bad |= _unseen(cell, at[:, which], narrow)
            good = which[~bad]
            left[good] = False
            out.values[:, good] = fit.values[:, ~bad]
            out.quadrature[:, good] = fit.quadrature[:, None]
            out.of_pressure[:, good], out.of_traction[:, good] = fit.sizes[:, :, None]
            if bad.any() and np.all(cell.size > _SMALLEST * _WIDTH):
                cells += _cut(cell, at, which[bad], fit.tails)
    return left
