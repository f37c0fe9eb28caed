r"""Partial slip on any zones, in fixed point, for ``kappa = 1``.

With ``q = s psi``, half-integral G, and ``z = s^2`` the tangential equation is

    beta z psi + (1/pi) 1/2 int_{t^2 < z} t G dt^2 / sqrt(z - t^2) = int_0^s p s ds    in stick,

which is collocated. Newton's method finds tractions and boundaries at once: the Jacobian is in
double precision, the residuals are in fixed point.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from math import ceil, log, log10, pi, sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lu_factor, lu_solve

from spectral_contact.errors import ConvergenceError
from spectral_contact.fields import EDGE, Radius
from spectral_contact.precise.annulus import AnnulusMesh, AnnulusSeries, Blocks
from spectral_contact.precise.between import Between
from spectral_contact.precise.drive import Drive
from spectral_contact.precise.fixed import Ints
from spectral_contact.spectral.annulus import gap
from spectral_contact.threads import cached_property

__all__ = ["Layout", "Zones", "solve_zones"]

Array = NDArray[np.float64]

_LN10 = log(10.0)
_MOST_SWEEPS = 20
#: Accuracy of the tractions for which the boundaries' part of the Jacobian is taken.
_CLOSE = 1e-8
#: Its differences are taken ``2**-_STEP`` apart.
_STEP = 50


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
        ends = [Radius(0.0, 1.0), *self.radii, EDGE]
        return [gap(a, b) for a, b in pairwise(ends)]

    def scales(self, alpha: float, beta: float, digits: int, width: float) -> float:
        """Return the decades from 1 down to what fixed point has to resolve."""
        deepest = width * max(map(max, self.panels(alpha, beta, digits, width))) / _LN10
        # the equation is divided by beta and s^2, which is down to 1e-8 of the rim's at the nodes
        return digits + deepest + 8.0 + abs(log10(beta)) - 2.0 * log10(self.radii[0].square)

    def panels(self, alpha: float, beta: float, digits: int, width: float) -> list[tuple[int, int]]:
        """Return the number of panels in the inner and the outer half of every zone.

        At a boundary the traction settles like ``d**2 ln d``, at the edge like ``d ln d`` below the
        scales of the problem.
        """
        widths, settle = self.widths, (digits + 2.0) * _LN10
        ends = []
        for b, near in zip(self.radii, pairwise(widths), strict=True):
            ends.append(log(min(*near, beta * b.value, b.rest + alpha)) - settle / 2.0)
        ends.append(log(min(widths[-1], beta, alpha or 1.0)) - settle)
        # nothing happens at the centre
        pairs = pairwise([log(widths[0]), *ends])
        depths = [[log(w) - end for end in pair] for w, pair in zip(widths, pairs, strict=True)]
        return [(max(ceil(a / width), 1), max(ceil(b / width), 1)) for a, b in depths]


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


def _points(digits: int, width: float) -> int:
    """Return how many nodes of a panel resolve singularities ``i pi`` from it."""
    reach = 2.0 * pi / width
    return ceil((digits + 4.0) / log10(reach + sqrt(1.0 + reach * reach))) + 4


def solve_zones(
    drive: Drive,
    alpha: float,
    beta: float,
    friction: Any,
    layout: Layout,
    digits: int,
    width: float,
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
    blocks = Blocks(f, width, _points(digits, width), digits)
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
        pieces = zip(self.sticking, pairwise(self.bounds), strict=True)
        return {k: flat[a:b].reshape(self.meshes[k].above.shape) for k, (a, b) in pieces}

    def solve(self, logits: list[Any], goal: Any) -> Zones:
        """Find tractions and boundaries."""
        f = self.drive.fixed
        trial = _Trial(self, logits)
        newton = _Newton(trial)
        flat = np.zeros(self.bounds[-1], dtype=object)
        for _ in range(_MOST_SWEEPS):
            step = newton.free(trial.residual(flat))
            flat = flat + f.of(step)
            if self._share(step, flat) <= _CLOSE:
                break
        newton.border(trial, flat)
        last = None
        for _ in range(_MOST_SWEEPS):
            step, shift = newton.step(trial, flat)
            flat = flat + f.of(step)
            logits = [x + f.mp.mpf(dx) for x, dx in zip(logits, shift, strict=True)]
            trial = _Trial(self, logits)
            size = max(self._share(step, flat), float(np.abs(shift).max()))
            # the next step would be as much smaller as this one is
            if size <= goal or (last is not None and size * size <= goal * last):
                return trial.outcome(flat)
            last = size
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
        self.widths = [b - a for a, b in pairwise(self.squares)]
        zones = list(zip(problem.meshes, self.widths, strict=True))
        self.z = [s + f.times(w, m.above) for (m, w), s in zip(zones, self.squares, strict=False)]
        y = [r + f.times(w, m.below) for (m, w), r in zip(zones, self.rests[1:], strict=True)]
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
        f, values = self._f, self.problem.split(flat)
        limits = {k: self.problem.meshes[k].limits(v) for k, v in values.items()}
        # of two neighbours one slips, and its state is the sense
        senses = [a + b for a, b in pairwise(self.problem.states)]
        found = [
            f.times(factor, limits[k][end]) - sense * f.one
            for (k, end, factor), sense in zip(self._ends, senses, strict=True)
        ]
        return np.array(found, dtype=object)

    @cached_property
    def _ends(self) -> list[tuple[int, int, Any]]:
        """Of every boundary: the zone that sticks, which of its ends, and ``s / (f p)``."""
        f, problem = self._f, self.problem
        p = problem.drive.pressure(np.array(self.rests[1:-1], dtype=object))
        factors = f.over(f.sqrt(np.array(self.squares[1:-1])), f.times(problem.friction, p))
        return [
            (j + 1, 0, factor) if problem.states[j] else (j, 1, factor)
            for j, factor in enumerate(factors)
        ]

    def conditions(self) -> Array:
        """Return the matrix of the mismatch in double precision."""
        f, problem = self._f, self.problem
        rows = np.zeros((len(self._ends), problem.bounds[-1]))
        for row, (k, end, factor) in zip(rows, self._ends, strict=True):
            limit = problem.meshes[k].blocks.limit
            values = problem.split(row)[k]
            values[-end] = f.floats(f.times(factor, limit[::-1] if end else limit))
        return rows

    def matrix(self) -> Array:
        """Return the matrix of the residual in double precision."""
        f, problem = self._f, self.problem
        matrix = np.zeros((problem.bounds[-1],) * 2)
        parts = pairwise(problem.bounds)
        places = {k: slice(a, b) for k, (a, b) in zip(problem.sticking, parts, strict=True)}
        for k in range(self.last + 1):
            mesh, own = problem.meshes[k], sqrt(float(f.numbers(self.widths[k])))
            root = np.sqrt(f.floats(self.z[k])).reshape(-1, 1) / pi
            outward = [c for c in problem.sticking if c >= k]
            half = {
                c: root * (self.between[k, c].matrix() if c > k else own * mesh.matrix())
                for c in outward
            }
            for r in outward:
                inner = self.between[k, r].inner_matrix() if r > k else own * mesh.inner_matrix()
                for c in outward:
                    matrix[places[r], places[c]] += inner @ half[c]
        z = np.concatenate([f.floats(self.z[k]).ravel() for k in problem.sticking])
        matrix[np.diag_indices(len(matrix))] += float(f.numbers(problem.beta)) * z
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
        """Add the rows of the conditions and, by differences, the columns of the boundaries."""
        f = self._f
        before = trial.residual(flat), trial.mismatch(flat)
        columns, corner = [], []
        for j in range(len(trial.logits)):
            logits = list(trial.logits)
            logits[j] += f.mp.ldexp(1, -_STEP)
            moved = _Trial(trial.problem, logits)
            columns.append(f.floats((moved.residual(flat) - before[0]) << _STEP))
            corner.append(f.floats((moved.mismatch(flat) - before[1]) << _STEP))
        self._columns = self._solved(np.array(columns).T)
        self._rows = trial.conditions()
        self._schur = np.array(corner).T - self._rows @ self._columns

    def step(self, trial: _Trial, flat: Ints) -> tuple[Array, Array]:
        """Return the steps of the tractions and of the boundaries."""
        free = self.free(trial.residual(flat))
        right = self._f.floats(trial.mismatch(flat)) + self._rows @ free
        shift = -np.asarray(np.linalg.solve(self._schur, right), dtype=float)
        return free - self._columns @ shift, shift
