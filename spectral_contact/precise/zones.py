"""Partial slip on any number of stick and slip zones, in fixed point, for ``kappa = 1``.

Tractions and boundaries are found together by Newton's method: the Jacobian is in double precision,
the residuals are in fixed point.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lu_factor, lu_solve

from spectral_contact.errors import ConvergenceError
from spectral_contact.fields.series import Radius
from spectral_contact.precise.fixed import Ints
from spectral_contact.precise.zone_trial import ZoneProblem, Zones, ZoneTrial

__all__ = ["solve_zones"]

Array = NDArray[np.float64]

_MOST_SWEEPS = 20
#: Accuracy of the tractions for which the boundaries' part of the Jacobian is taken.
_CLOSE = 1e-8
#: Its differences are taken ``2**-_STEP`` apart.
_STEP = 50
#: A step of the boundaries, as `_length` has it, from which on the Jacobian is kept, and the
#: longest that is taken.
_NEAR, _LONGEST = 0.02, 0.6
_MOST_STARTS = 8


def solve_zones(problem: ZoneProblem, radii: Sequence[Radius], *, held: bool = False) -> Zones:
    """Solve partial slip on zones.

    Parameters
    ----------
    problem : ZoneProblem
        With positive ``beta*``.
    radii : sequence of Radius
        Guesses of the boundaries.
    held : bool
        Leave the boundaries where they are. The traction is not continuous there then.

    Raises
    ------
    ConvergenceError
        If the boundaries do not settle, or refinement stalls before the digits are reached.
    """
    mp = problem.drive.fixed.mp
    logits = [mp.mpf(r.logit) for r in radii]
    if held:
        trial = ZoneTrial(problem, logits)
        return trial.outcome(_free(trial)[1])
    for _ in range(_MOST_STARTS):
        trial = ZoneTrial(problem, logits)
        newton, flat = _free(trial)
        newton.border(trial, flat)
        shift = newton.step(trial, flat)[1]
        length = _length(shift, logits)
        if length <= _NEAR:
            return _polished(newton, trial, flat, mp.mpf(10) ** -(problem.digits + 2))
        shift *= min(1.0, _LONGEST / length)
        logits = [x + mp.mpf(dx) for x, dx in zip(logits, shift, strict=True)]
    raise ConvergenceError("the zones do not settle", "ask for fewer digits")


def _free(trial: ZoneTrial) -> tuple[_Newton, Ints]:
    """Return the tractions with the boundaries held, and what solves for them."""
    newton, f = _Newton(trial), trial.problem.drive.fixed
    flat = np.zeros(trial.problem.bounds[-1], dtype=object)
    for _ in range(_MOST_SWEEPS):
        step = newton.free(trial.residual(flat))
        flat = flat + f.of(step)
        if trial.problem.share(step, flat) <= _CLOSE:
            break
    return newton, flat


def _length(shift: Array, logits: list[Any]) -> float:
    """Return the largest step, in logits or as a share of the distance to the next boundary."""
    steps = np.abs(shift).tolist()
    for (a, b), (da, db) in zip(pairwise(logits), pairwise(shift.tolist()), strict=True):
        steps.append(abs(da - db) / float(b - a))
    return float(max(steps))


def _polished(newton: _Newton, trial: ZoneTrial, flat: Ints, goal: Any) -> Zones:
    """Refine tractions and boundaries together."""
    f, problem, logits, last = trial.problem.drive.fixed, trial.problem, list(trial.logits), None
    for _ in range(_MOST_SWEEPS):
        step, shift = newton.step(trial, flat)
        flat = flat + f.of(step)
        logits = [x + f.mp.mpf(dx) for x, dx in zip(logits, shift, strict=True)]
        size = max(problem.share(step, flat), float(np.abs(shift).max()))
        # the next step would be as much smaller as this one is
        if size <= goal or (last is not None and size * size <= goal * last):
            return ZoneTrial(problem, logits).outcome(flat)
        if _length(shift, logits) > 2.0 * _NEAR:  # it leaves where its Jacobian is from
            break
        trial, last = ZoneTrial(problem, logits), size
    raise ConvergenceError("the zones do not settle", "ask for fewer digits")


class _Newton:
    """The Jacobian in double precision."""

    def __init__(self, trial: ZoneTrial) -> None:
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

    def border(self, trial: ZoneTrial, flat: Ints) -> None:
        """Add the rows of the conditions and, by differences, the columns of the boundaries."""
        f = self._f
        before = trial.residual(flat), trial.mismatch(flat)
        columns, corner = [], []
        for j in range(len(trial.logits)):
            logits = list(trial.logits)
            logits[j] += f.mp.ldexp(1, -_STEP)
            moved = ZoneTrial(trial.problem, logits)
            columns.append(f.floats((moved.residual(flat) - before[0]) << _STEP))
            corner.append(f.floats((moved.mismatch(flat) - before[1]) << _STEP))
        self._columns = self._solved(np.array(columns).T)
        self._rows = trial.conditions()
        self._schur = np.array(corner).T - self._rows @ self._columns

    def step(self, trial: ZoneTrial, flat: Ints) -> tuple[Array, Array]:
        """Return the steps of the tractions and of the boundaries."""
        free = self.free(trial.residual(flat))
        right = self._f.floats(trial.mismatch(flat)) + self._rows @ free
        shift = -np.asarray(np.linalg.solve(self._schur, right), dtype=float)
        return free - self._columns @ shift, shift
