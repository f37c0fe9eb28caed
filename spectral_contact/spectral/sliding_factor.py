"""The matrix of a sliding disk and its factors: corrections are made with them.

Corrections take the residual in double precision, without a matrix, so that the factors may be
rough: they are of single precision as long as that serves, at half the cost.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lu_factor, lu_solve

from spectral_contact.spectral.parameters import Parameters
from spectral_contact.spectral.sliding import SlidingDisk

__all__ = ["SlidingFactored", "assembled", "shed_changes"]

Array = NDArray[np.float64]


class SlidingFactored:
    """Partial slip with coupling in one space, factored.

    Parameters
    ----------
    disk : SlidingDisk
    parameters : Parameters
    exact : bool
        Factor in double precision.
    """

    def __init__(self, disk: SlidingDisk, parameters: Parameters, *, exact: bool = False) -> None:
        self.disk, self.parameters, self.exact = disk, parameters, exact
        kind = np.float64 if exact else np.float32
        matrix, self.scale = assembled(disk, parameters, kind)
        # pivots are to be found among the equations of the pressure first, which are graded
        driven = matrix[disk.count :]
        small = 0.5 / max(float(np.abs(driven[:, : disk.count]).max()), 0.5)
        driven *= small
        self._rows = self.scale.copy()
        self._rows[disk.count :] *= small
        self._factor = lu_factor(matrix, overwrite_a=True, check_finite=False)

    def step(self, right: Array) -> Array:
        """Return the solution as factored, of right-hand sides as columns."""
        scaled = right * self._rows[:, None]
        size = np.maximum(np.abs(scaled).max(axis=0), np.finfo(float).tiny)
        scaled /= size
        step = lu_solve(self._factor, scaled.astype(self._factor[0].dtype), check_finite=False)
        return np.asarray(step * self.scale[:, None] * size)

    def start(self) -> Array:
        """Return the solutions for unit approach and, with compliance, for a unit lift.

        They are columns, and not corrected.
        """
        columns = 2 if self.parameters.beta else 1
        return self.correction(np.zeros((self.disk.unknowns, columns)))

    def correction(self, values: Array, disk: SlidingDisk | None = None) -> Array:
        """Return by how much the solutions are off, from their misfits.

        Parameters
        ----------
        values : ndarray
            As `start` returns them.
        disk : SlidingDisk, optional
            Another disk, hardly larger or smaller, whose solutions they are.
        """
        disk = disk or self.disk
        columns = np.eye(2)[:, : values.shape[1]]
        return self.step(disk.residual(values, self.parameters, columns[0], columns[1]))

    def change(self, values: Array, disk: SlidingDisk | None = None) -> list[Array]:
        """Return what the top two degrees of every panel, and the top one, contribute.

        They are the differences to the solutions without them, as columns.
        """
        disk = disk or self.disk
        nothing = np.zeros(2 * values.shape[1])

        def residual(changes: Array) -> Array:
            return disk.residual(changes, self.parameters, nothing, nothing)

        return shed_changes(self.step, self.scale, disk.shed, values, residual)


def shed_changes(
    step: Callable[[Array], Array],
    scale: Array,
    sheds: Sequence[NDArray[np.int_]],
    values: Array,
    residual: Callable[[Array], Array],
) -> list[Array]:
    """Return the differences of solutions to those without some of the unknowns.

    Parameters
    ----------
    step : callable
        Solves with the factors, for columns.
    scale : ndarray, shape (unknowns,)
        Of the unknowns, in the matrix that was factored.
    sheds : sequence of ndarray of int
        The unknowns that are left out, the first time those of all other times, too.
    values : ndarray, shape (unknowns, k)
        The solutions.
    residual : callable
        What changes, as columns, leave of both equations.
    """
    first, k = sheds[0], values.shape[1]
    right = np.zeros((len(values), len(first)))
    right[first, np.arange(len(first))] = 1.0 / scale[first]
    response = step(right)
    forced = np.zeros((len(values), len(sheds) * k))
    changes = np.empty_like(forced)
    for i, shed in enumerate(sheds):
        columns, own = response[:, np.isin(first, shed)], scale[shed, None]
        forces = np.linalg.solve(columns[shed] / own, values[shed] / own)
        forced[shed, i * k : (i + 1) * k] = forces / own
        changes[:, i * k : (i + 1) * k] = columns @ forces
    return np.hsplit(changes + step(residual(changes) + forced), len(sheds))


def assembled(
    disk: SlidingDisk, parameters: Parameters, kind: type[np.floating[Any]]
) -> tuple[NDArray[Any], Array]:
    """Return the matrix of both equations; it is that of `SlidingDisk.residual` but for roundings.

    Parameters
    ----------
    disk : SlidingDisk
    parameters : Parameters
    kind : type
        Precision of the matrix.

    Returns
    -------
    matrix : ndarray
        Rows and columns are scaled.
    scale : ndarray
        What they are multiplied by, so that the diagonal is nearly 1.
    """
    return _Assembly(disk, parameters, kind).matrix()


class _Assembly:
    """The blocks of the matrix.

    Products are taken in the precision asked, of scaled functions, so that none is too small for
    it. What is seen across the rim is summed over its samples.
    """

    def __init__(
        self, disk: SlidingDisk, parameters: Parameters, kind: type[np.floating[Any]]
    ) -> None:
        self._disk, self._kind = disk, kind
        self._alpha, self._beta, self._kappa, self._friction = parameters
        own, around = disk.transforms
        n, scale = disk.inside, np.sqrt(disk.half)
        on_disk, above, below, shear = disk.weights
        #: test functions times weights: of the disk, across its rim, above the rim, below the edge
        self._own = disk.radius.value * own.half
        self._across = own.nodes.gathered(on_disk[:, None] * own.nodes.spread(disk.plain))
        self._above, self._below = scale * around.half, scale * around.edge_half
        squares = np.zeros(disk.unknowns)
        squares[:n] = on_disk @ self._own**2
        squares[n : disk.count] = np.einsum("ij,ij->j", self._across, disk.plain)
        squares[n : disk.count] += above @ self._above**2
        squares[n + around.split : disk.count] += below @ self._below**2
        squares[disk.count :] = shear @ self._own**2
        masses = np.concatenate([one.diagonal() for one in disk.masses])
        squares[: disk.count] += self._alpha * masses[: disk.count]
        squares[disk.count :] += self._beta * masses[disk.count :]
        self.scale: Array = 1.0 / np.sqrt(squares)
        self._weights = disk.weights
        #: scales of the pressure on the disk and around it, and of the traction
        self._scales = s = np.split(self.scale, [n, disk.count])
        self._own_u = self._own * s[2]
        self._own *= s[0]
        self._across *= s[1]
        self._seen = disk.plain * s[1]
        self._above *= s[1]
        self._below *= s[1][around.split :]
        self._result = np.zeros((disk.unknowns, disk.unknowns), kind)

    def _product(self, left: Array, right: Array) -> NDArray[Any]:
        return np.asarray(left.astype(self._kind).T @ right.astype(self._kind))

    def _square(self, values: Array, weights: Array) -> NDArray[Any]:
        root = (values * np.sqrt(weights)[:, None]).astype(self._kind)
        # of a matrix and its own transpose NumPy computes one triangle, in half the time
        return np.asarray(root.T @ root)

    def matrix(self) -> tuple[NDArray[Any], Array]:
        """Return the matrix and its scale."""
        disk, matrix, n = self._disk, self._result, self._disk.inside
        own, around = disk.transforms
        p, annulus, u = slice(n), slice(n, disk.count), slice(disk.count, None)
        edge = slice(n + around.split, disk.count)
        on_disk, above, below, shear = self._weights
        matrix[p, p] = self._square(self._own, on_disk)
        gathered = own.nodes.gathered(on_disk[:, None] * self._own)
        matrix[p, annulus] = self._product(gathered, self._seen)
        matrix[annulus, p] = matrix[p, annulus].T
        matrix[annulus, annulus] = self._product(self._across, self._seen)
        matrix[annulus, annulus] += self._square(self._above, above)
        matrix[edge, edge] += self._square(self._below, below)
        matrix[u, u] = self._square(self._own_u, shear)
        if disk.weighted[0]:
            self._pressure_by_traction()
        else:
            self._pressure_by_moments()
        self._traction_by_pressure()
        begin = 0
        alpha, beta = self._alpha, self._beta
        for mass, compliance in zip(disk.masses, (alpha, alpha, alpha, beta), strict=True):
            rows = slice(begin, begin + len(mass))
            if compliance:
                scale = self.scale[rows]
                matrix[rows, rows] += compliance * (scale[:, None] * mass * scale)
            begin = rows.stop
        return matrix, self.scale

    def _pressure_by_moments(self) -> None:
        """Add what the traction does to the normal equation, which no weight spoils: no kernel."""
        disk, matrix, n = self._disk, self._result, self._disk.inside
        own, around = disk.transforms
        p, annulus, u = slice(n), slice(n, disk.count), slice(disk.count, None)
        factor = 0.25 * self._kappa
        scales = self._scales
        coupled = (factor * disk.radius.value**4) * (scales[0][:, None] * own.inner * scales[2])
        matrix[p, u] = -coupled
        slip = disk.over.after(around.outside) * (
            (factor * self._friction * disk.half**2) * scales[1]
        )
        matrix[annulus, annulus] -= scales[1][:, None] * slip
        drag = self._kappa * self._friction * scales[1] * disk.drag
        matrix[p, annulus] -= np.outer(scales[0] * disk.load[:n], drag)

    def _pressure_by_traction(self) -> None:
        """Add what the traction does to the normal equation.

        What ``t I(t)`` and ``int q ds`` have in common is taken out before it is rounded.
        """
        disk, matrix, n = self._disk, self._result, self._disk.inside
        own, around = disk.transforms
        on_disk, above, below, _ = self._weights
        split, whole = around.over_split, disk.over.shape[0]
        p, annulus, u = slice(n), slice(n, disk.count), slice(disk.count, None)
        edge = slice(n + around.split, disk.count)
        c = disk.radius.value
        of_disk = 2.0 * self._kappa * self._scales[2]
        pull, start = of_disk * disk.pull, of_disk * c * own.start
        stuck = own.root[:, None] * (own.rise + own.start) * (c**2 * of_disk) - pull
        weighted = on_disk[:, None] * stuck
        matrix[p, u] = self._product(self._own, weighted)
        matrix[annulus, u] = self._product(self._seen, own.nodes.gathered(weighted))
        t, step, falling = disk.above
        weights = above[:, None] * self._above
        fallen = around.above.gathered(t[:, None] * weights)
        matrix[annulus, u] -= self._product(fallen, of_disk * falling)
        matrix[annulus, u] += np.outer(weights.sum(axis=0), c * start - pull)
        matrix[annulus, u] += np.outer(step @ weights, start)
        drag = disk.drag_over
        swept = np.zeros((matrix.shape[0], whole), self._kind)
        swept[annulus, :split] = self._product(
            weights, np.sqrt(disk.half) * t[:, None] * around.inner - drag[:split]
        )
        swept[annulus, split:] = np.outer(weights.sum(axis=0), -drag[split:])
        t, seen = disk.below
        weights = below[:, None] * self._below
        matrix[edge, u] += (around.smooth_below.T @ (t[:, None] * weights)).T @ (of_disk * seen)
        matrix[edge, u] -= np.outer(weights.sum(axis=0), pull)
        swept[edge] += self._product(
            weights, np.sqrt(disk.half) * t[:, None] * around.edge_inner - drag
        )
        swept[p] = np.outer(on_disk @ self._own, -drag)
        swept[annulus] += np.outer(self._across.sum(axis=0), -drag)
        slip = 2.0 * self._kappa * self._friction * self._scales[1]
        matrix[: disk.count, annulus] += disk.over.after(swept[: disk.count]) * slip

    def _traction_by_pressure(self) -> None:
        """Add what the pressure does to the tangential equation."""
        disk, matrix, n = self._disk, self._result, self._disk.inside
        own, _ = disk.transforms
        scales = self._scales
        weighted = self._weights[3][:, None] * self._own_u
        root = own.root[:, None]
        drive = own.rise / root + own.start * (own.nodes.d[:, None] / (root * (1.0 + root)))
        matrix[disk.count :, :n] = self._product(weighted, -2.0 * self._kappa * scales[0] * drive)
        falls = self._product(own.nodes.gathered(weighted), disk.falls)
        matrix[disk.count :, n : disk.count] = disk.over.after(falls) * (
            -self._friction * scales[1]
        )
