r"""Partial slip on any zones, in fixed point, for ``kappa = 1``.

With ``q = s psi``, half-integral G, and ``z = s^2`` the tangential equation is

    beta z psi + (1/pi) 1/2 int_{t^2 < z} t G dt^2 / sqrt(z - t^2) = int_0^s p s ds    in stick,

which is collocated. Newton's method finds tractions and boundaries at once: the Jacobian is in
double precision, the residuals are in fixed point.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import ceil, log, log10, pi, sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lu_factor, lu_solve

from spectral_contact.errors import ConvergenceError
from spectral_contact.fields import Radius
from spectral_contact.precise.annulus import AnnulusMesh, AnnulusSeries, Blocks
from spectral_contact.precise.between import Between
from spectral_contact.precise.drive import Drive
from spectral_contact.precise.fixed import Ints

__all__ = ["Layout", "Zones", "solve_zones"]

Array = NDArray[np.float64]

_LN10 = log(10.0)
_MOST_SWEEPS = 20


@dataclass(frozen=True)
class Layout:
    """What every zone does, and roughly where it ends.

    Attributes
    ----------
    states : tuple of int
        From the centre outward: 0 for stick, +1 or -1 for slip with that sign.
    radii : tuple of Radius
        The boundaries between them, one less.
    """

    states: tuple[int, ...]
    radii: tuple[Radius, ...]

    @property
    def widths(self) -> list[float]:
        """Widths of the zones in ``s**2``."""
        ends = [Radius(0.0, 1.0), *self.radii, Radius(1.0, 0.0)]
        return [
            (b.square - a.square) if b.value < 0.5 else a.rest - b.rest
            for a, b in zip(ends, ends[1:], strict=False)
        ]

    def panels(self, alpha: float, beta: float, digits: int, width: float) -> list[tuple[int, int]]:
        """Return the number of panels in the inner and the outer half of every zone.

        At a boundary the traction settles like ``d**2 ln d``, at the edge like ``d ln d`` below the
        scales of the problem.
        """
        widths, settle = self.widths, (digits + 2.0) * _LN10
        ends = []
        for b, near in zip(self.radii, zip(widths, widths[1:], strict=False), strict=True):
            ends.append(log(min(*near, beta * b.value, b.rest + alpha)) - settle / 2.0)
        ends.append(log(min(widths[-1], beta, alpha or 1.0)) - settle)
        depths = [
            [log(w) - end for end in pair] for w, pair in zip(widths, zip([0.0, *ends], ends))
        ]
        counts = [(max(ceil(a / width), 1), max(ceil(b / width), 1)) for a, b in depths]
        return [(1, counts[0][1]), *counts[1:]]


@dataclass(frozen=True)
class Zones:
    """Boundaries and tractions of the stick zones.

    Attributes
    ----------
    logits : tuple of mpf
        ``ln(b**2/(1 - b**2))`` of the boundaries, outward.
    tractions : tuple of AnnulusSeries or None
        ``q / s`` in every zone that sticks.
    total_shear : int
    unknowns : int
    """

    logits: tuple[Any, ...]
    tractions: tuple[AnnulusSeries | None, ...]
    total_shear: Any
    unknowns: int


def points_of(digits: int, width: float) -> int:
    """Return how many nodes of a panel resolve singularities ``i pi`` from it."""
    reach = 2.0 * pi / width
    return ceil((digits + 4.0) / log10(reach + sqrt(1.0 + reach * reach))) + 4


def solve_zones(
    drive: Drive, alpha: float, beta: float, friction: Any, layout: Layout, digits: int, width: float
) -> Zones:
    """Solve partial slip on the zones of a layout.

    Parameters
    ----------
    drive : Drive
    alpha, beta : float
        ``alpha*`` and ``beta*``, the latter positive.
    friction : int
        ``f / kappa`` in fixed point.
    layout : Layout
        Its radii are good guesses.
    digits : int
        Relative accuracy aimed at.
    width : float
        Panel width.

    Raises
    ------
    ConvergenceError
        If refinement stalls before the digits are reached.
    """
    f = drive.fixed
    blocks = Blocks(f, width, points_of(digits, width), digits)
    meshes = [AnnulusMesh(blocks, *n) for n in layout.panels(alpha, beta, digits, width)]
    problem = _Problem(drive, f.of(beta), friction, layout.states, meshes)
    logits = [f.mp.mpf(r.logit) for r in layout.radii]
    return problem.solve(logits, f.mp.mpf(10) ** -(digits + 2))


class _Problem:
    """States and meshes of the zones."""

    def __init__(
        self,
        drive: Drive,
        beta: Any,
        friction: Any,
        states: tuple[int, ...],
        meshes: list[AnnulusMesh],
    ) -> None:
        self.drive, self.beta, self.friction = drive, beta, friction
        self.states, self.meshes = states, meshes
        self.sticking = [k for k, state in enumerate(states) if state == 0]
        sizes = [meshes[k].above.size for k in self.sticking]
        self.bounds = np.cumsum([0, *sizes])

    def split(self, flat: Any) -> dict[int, Any]:
        """Return the values in every zone that sticks."""
        pieces = zip(self.sticking, self.bounds, self.bounds[1:], strict=False)
        return {k: flat[a:b].reshape(self.meshes[k].above.shape) for k, a, b in pieces}

    def solve(self, logits: list[Any], goal: Any) -> Zones:
        """Find tractions and boundaries."""
        f = self.drive.fixed
        trial = _Trial(self, logits)
        newton = _Newton(trial)
        flat = np.zeros(self.bounds[-1], dtype=object)
        step, last = newton.free(trial.residual(flat)), 1.0
        for _ in range(_MOST_SWEEPS):
            flat = flat + f.of(step)
            size = self._share(step, flat)
            if size > 1e-8:
                if size > 0.5 * last:
                    break
                last = size
                step = newton.free(trial.residual(flat))
                continue
            break
        newton.border(trial, flat)
        for _ in range(_MOST_SWEEPS):
            step, shift = newton.step(trial.residual(flat), trial.mismatch(flat))
            flat = flat + f.of(step)
            logits = [a + f.mp.mpf(b) for a, b in zip(logits, shift, strict=True)]
            trial = _Trial(self, logits)
            if max(self._share(step, flat), np.abs(shift).max()) <= goal:
                return trial.outcome(flat)
        raise ConvergenceError("the zones do not settle", "ask for fewer digits")

    def _share(self, step: Array, flat: Ints) -> float:
        """Return the largest step relative to the largest value in its zone."""
        f = self.drive.fixed
        steps, values = self.split(step), self.split(flat)
        return max(
            float(np.abs(steps[k]).max() / np.abs(f.floats(values[k])).max()) for k in self.sticking
        )


class _Trial:
    """The problem with its boundaries given."""

    def __init__(self, problem: _Problem, logits: list[Any]) -> None:
        self.problem, self.logits = problem, logits
        f, mp = problem.drive.fixed, problem.drive.fixed.mp
        self._f = f
        self.squares = [0 * f.one, *(f.of(1 / (1 + mp.exp(-x))) for x in logits), f.one]
        self.rests = [f.one, *(f.of(1 / (1 + mp.exp(x))) for x in logits), 0 * f.one]
        self.widths = [
            b - a for a, b in zip(self.squares, self.squares[1:], strict=False)
        ]
        zones = list(zip(problem.meshes, self.widths, strict=True))
        self.z = [s + f.times(w, m.above) for (m, w), s in zip(zones, self.squares, strict=False)]
        y = [r + f.times(w, m.below) for (m, w), r in zip(zones, self.rests[1:], strict=True)]
        self.y = y
        self.slip = {
            k: state * f.over(f.times(problem.friction, problem.drive.pressure(y[k])), f.sqrt(z))
            for k, (state, z) in enumerate(zip(problem.states, self.z, strict=True))
            if state
        }
        self.load = {k: problem.drive.load_inside(y[k]) for k in problem.sticking}
        self.last = problem.sticking[-1]

    @cached_property
    def between(self) -> dict[tuple[int, int], Between]:
        """The integrals from zone to zone."""
        meshes = self.problem.meshes
        return {
            (a, b): Between(
                meshes[a],
                meshes[b],
                (self.widths[a], self.widths[b]),
                self.squares[b] - self.squares[a + 1],
            )
            for a in range(self.last + 1)
            for b in range(a + 1, len(meshes))
        }

    def residual(self, flat: Ints) -> Ints:
        """Return by how much the equation is not satisfied at the nodes in stick."""
        f, problem = self._f, self.problem
        values = {**self.slip, **problem.split(flat)}
        inner = []
        for k in range(self.last + 1):
            total = f.times(f.sqrt(self.widths[k]), problem.meshes[k].half_integral(values[k]))
            for b in range(k + 1, len(problem.states)):
                total = total + self.between[k, b].half_integral(values[b])
            inner.append(f.times(f.sqrt(self.z[k]), total))
        result = []
        for k in problem.sticking:
            total = f.times(f.sqrt(self.widths[k]), problem.meshes[k].inner_integral(inner[k]))
            for a in range(k):
                total = total + self.between[a, k].inner_integral(inner[a])
            own = f.times(problem.beta, self.z[k], values[k])
            result.append(own + f.over(total, f.of(f.mp.pi)) - self.load[k])
        return np.concatenate([r.ravel() for r in result])

    def mismatch(self, flat: Ints) -> Ints:
        """Return by how much the traction is discontinuous at the boundaries, over f p."""
        f, problem = self._f, self.problem
        values = problem.split(flat)
        found = []
        for j, (before, after) in enumerate(zip(problem.states, problem.states[1:], strict=False)):
            k = j + (before != 0)
            limit = problem.meshes[k].series(values[k]).limits[before == 0]
            limit = f.times(limit, f.sqrt(self.squares[j + 1]))
            rest = np.array([self.rests[j + 1]], dtype=object)
            slipping = f.times(problem.friction, problem.drive.pressure(rest)[0])
            found.append(f.over(limit, slipping) - (before + after) * f.one)
        return np.array(found, dtype=object)

    def matrix(self) -> Array:
        """Return the matrix of the residual in double precision."""
        f, problem = self._f, self.problem
        size = [m.above.size for m in problem.meshes]
        half: dict[tuple[int, int], Array] = {}
        matrix = np.zeros((problem.bounds[-1],) * 2)
        parts = [slice(a, b) for a, b in zip(problem.bounds, problem.bounds[1:], strict=False)]
        for k in range(self.last + 1):
            columns = [c for c in problem.sticking if c >= k]
            half = {
                c: self.between[k, c].matrix()
                if c > k
                else np.sqrt(float(f.numbers(self.widths[k]))) * problem.meshes[k].matrix()
                for c in columns
            }
            root = np.sqrt(f.floats(self.z[k])).reshape(-1, 1) / pi
            for r, row in zip(problem.sticking, parts, strict=True):
                if r < k:
                    continue
                inner = (
                    self.between[k, r].inner_matrix()
                    if r > k
                    else np.sqrt(float(f.numbers(self.widths[k])))
                    * problem.meshes[k].inner_matrix()
                )
                for c, column in zip(problem.sticking, parts, strict=True):
                    if c >= k:
                        matrix[row, column] += inner @ (root * half[c])
        z = np.concatenate([self.z[k].ravel() for k in problem.sticking])
        matrix[np.diag_indices(len(matrix))] += float(f.numbers(problem.beta)) * f.floats(z)
        return matrix

    def outcome(self, flat: Ints) -> Zones:
        """Return the solution."""
        f, problem = self._f, self.problem
        values = {**self.slip, **problem.split(flat)}
        shear = 0
        for k, mesh in enumerate(problem.meshes):
            density = f.times(self.widths[k], mesh.weights, f.sqrt(self.z[k]))
            shear += f.times(f.of(f.mp.pi), f.times(density, values[k]).sum())
        tractions = tuple(
            None if state else problem.meshes[k].series(values[k])
            for k, state in enumerate(problem.states)
        )
        return Zones(tuple(self.logits), tractions, shear, int(problem.bounds[-1]))


class _Newton:
    """The Jacobian in double precision."""

    def __init__(self, trial: _Trial) -> None:
        self._f = trial.problem.drive.fixed
        matrix = trial.matrix()
        self._scale = 1.0 / np.abs(matrix).max(axis=1)
        matrix *= self._scale[:, None]
        self._factor = lu_factor(matrix, overwrite_a=True, check_finite=False)

    def free(self, residual: Ints) -> Array:
        """Return the step of the tractions with the boundaries held."""
        return -self._solved(self._f.floats(residual))

    def _solved(self, right: Array) -> Array:
        scaled = (right.T * self._scale).T
        return np.asarray(lu_solve(self._factor, scaled, check_finite=False))

    def border(self, trial: _Trial, flat: Ints) -> None:
        """Add the columns of the boundaries, by differences, and the rows of their conditions."""
        f, problem = self._f, trial.problem
        residual, mismatch = trial.residual(flat), trial.mismatch(flat)
        columns, corner = [], []
        step = f.mp.mpf(2) ** -50
        for j in range(len(trial.logits)):
            logits = list(trial.logits)
            logits[j] += step
            moved = _Trial(problem, logits)
            columns.append(f.floats(moved.residual(flat) - residual) / float(step))
            corner.append(f.floats(moved.mismatch(flat) - mismatch) / float(step))
        self._columns = self._solved(np.array(columns).T)
        unit = f.numbers  # noqa
        self._trial, self._flat, self._base = trial, flat, mismatch
        rows = np.array([self._conditions(c) for c in self._columns.T]).T
        self._schur = np.array(corner).T - rows

    def _conditions(self, step: Array) -> Array:
        """Return what a step of the tractions does to the conditions."""
        moved = self._trial.mismatch(self._flat + self._f.of(step))
        return self._f.floats(moved - self._base)

    def step(self, residual: Ints, mismatch: Ints) -> tuple[Array, Array]:
        """Return the steps of the tractions and of the boundaries."""
        free = self._solved(self._f.floats(residual))
        right = self._f.floats(mismatch) - self._conditions(free)
        shift = -np.linalg.solve(self._schur, right)
        return -free - self._columns @ shift, shift
