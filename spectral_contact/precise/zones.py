"""Partial slip on any number of stick and slip zones, in fixed point, for ``kappa = 1``.

For given boundaries the tractions are refined by a factorisation in double precision, with
residuals in fixed point. The boundaries are then moved until the tractions do not jump there, by
Newton's method first, and near the solution by Broyden's. The jumps are called the mismatch.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from math import inf
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from spectral_contact.errors import ConvergenceError
from spectral_contact.precise.fixed import DoubleFactors, Ints
from spectral_contact.precise.zone_trial import ZoneProblem, Zones, ZoneTrial
from spectral_contact.view.progress import silent

if TYPE_CHECKING:
    from spectral_contact.fields.series import Radius


Array = NDArray[np.float64]

_MOST_SWEEPS = 20
#: Accuracy of the tractions at which the slopes of the mismatch are computed.
_CLOSE = 1e-8
#: Slopes are difference quotients, in which the logit of a boundary changes by ``2**-_STEP_BITS``.
_STEP_BITS = 50
#: Newton's step, in the measure of `_length`, below which factorisation and slopes are kept.
_NEAR = 0.02
#: The longest step that is taken, in the same measure.
_LONGEST = 0.6
_MOST_STARTS = 8
#: The largest jump of the tractions that is tolerated, as a multiple of the accuracy of the
#: boundaries.
_CONTINUOUS = 100.0


def solve_zones(
    problem: ZoneProblem,
    radii: Sequence[Radius],
    tell: Callable[[str], None] = silent,
    *,
    held: bool = False,
    near: Zones | None = None,
) -> Zones:
    """Solve partial slip on zones.

    Parameters
    ----------
    problem : ZoneProblem
        With positive ``beta*``.
    radii : sequence of Radius
        Guesses of the boundaries.
    tell : callable
        Is told every step.
    held : bool
        Leave the boundaries where they are; the traction is then not continuous there.
    near : Zones, optional
        The same zones solved on another mesh: better guesses of the boundaries, and the slopes.

    Raises
    ------
    ConvergenceError
        If the boundaries do not settle, or refinement stalls before the digits are reached.
    """
    mp = problem.drive.fixed.mp
    logits = [mp.mpf(r.logit) for r in radii] if near is None else [+mp.mpf(x) for x in near.logits]
    goal = 10.0 ** -(problem.digits + 2)
    flat = np.zeros(problem.offsets[-1], dtype=object)  # the unknowns of all zones
    tell("zones")
    if held:
        trial = ZoneTrial(problem, logits)
        return trial.outcome(_Preconditioned(trial).refined(trial, flat, goal))
    if near is not None:
        assert near.slopes is not None
        trial = ZoneTrial(problem, logits)
        return _settled(_Preconditioned(trial), trial, flat, near.slopes, (goal, inf))
    for number in range(1, _MOST_STARTS + 1):
        tell(f"zones, start {number}")
        trial = ZoneTrial(problem, logits)
        factored = _Preconditioned(trial)
        flat = factored.refined(trial, 0 * flat, _CLOSE)
        slopes = factored.slopes(trial, flat)
        shift = _step(slopes, problem.drive.fixed.floats(trial.mismatch(flat)))
        length = _length(shift, logits)
        if length <= _NEAR:
            tell("zones, all digits")
            return _settled(factored, trial, flat, slopes, (goal, 1e3 * goal))
        logits = _moved(logits, shift * min(1.0, _LONGEST / length))
    raise ConvergenceError("the zones do not settle", "ask for fewer digits")


def _settled(
    factored: _Preconditioned,
    trial: ZoneTrial,
    flat: Ints,
    slopes: Array,
    goals: tuple[float, float],
) -> Zones:
    """Move the boundaries until they settle, and the tractions with them.

    The first of the goals is the largest last step of the boundaries, in logits, and of the
    tractions; the second is that of the boundaries in the measure of `_length`.
    """
    f = trial.problem.drive.fixed
    problem = trial.problem
    before = shift = np.zeros_like(slopes[0])
    size = 0.0  # of the last step of the boundaries, in logits
    expected = 0.0  # size of the next one
    for _ in range(_MOST_SWEEPS):
        flat = factored.refined(trial, flat, max(goals[0], 1e-4 * expected))
        mismatch = f.floats(trial.mismatch(flat))
        # Broyden's update, but not after a small step: its change of the mismatch would be that by
        # the errors of the tractions
        if size > 1e6 * goals[0]:
            slopes = slopes + np.outer(mismatch - before - slopes @ shift, shift) / (shift @ shift)
        before = mismatch
        shift = _step(slopes, mismatch)
        size = float(np.abs(shift).max())
        length = _length(shift, trial.logits)
        # under little compliance steps below the goal change the traction enough for the friction
        # law to be violated: the jumps are checked, too
        continuous = np.abs(mismatch).max() <= _CONTINUOUS * goals[0]
        if size <= goals[0] and length <= goals[1] and continuous:
            return trial.outcome(factored.refined(trial, flat, goals[0]), slopes)
        if length > 2.0 * _NEAR:  # the factorisation holds for boundaries nearby alone
            break
        expected = size * length
        trial = ZoneTrial(problem, _moved(trial.logits, shift))
    raise ConvergenceError("the zones do not settle", "ask for fewer digits")


def _step(slopes: Array, mismatch: Array) -> Array:
    """Return Newton's step of the boundaries, in logits, for a mismatch."""
    return -np.asarray(np.linalg.solve(slopes, mismatch), dtype=float)


def _moved(logits: Sequence[Any], shift: Array) -> list[Any]:
    """Return the logits of the boundaries after a step."""
    return [x + x.context.mpf(dx) for x, dx in zip(logits, shift, strict=True)]


def _length(shift: Array, logits: Sequence[Any]) -> float:
    """Return the largest step, in logits or as a share of the distance to the next boundary."""
    steps = np.abs(shift).tolist()
    for (a, b), (da, db) in zip(pairwise(logits), pairwise(shift.tolist()), strict=True):
        steps.append(abs(da - db) / float(b - a))
    return float(max(steps))


class _Preconditioned:
    """The equations for the tractions of a trial, factored in double precision."""

    def __init__(self, trial: ZoneTrial) -> None:
        self._f = trial.problem.drive.fixed
        self._factored = DoubleFactors(trial.matrix())

    def refined(self, trial: ZoneTrial, flat: Ints, goal: float) -> Ints:
        """Return the tractions of a trial to the accuracy `goal`, refined from `flat`."""
        for _ in range(_MOST_SWEEPS):
            step = -self._factored.solved(self._f.floats(trial.residual(flat)))
            flat = np.asarray(flat + self._f.of(step))
            if trial.problem.relative_step(step, flat) <= goal:
                return flat
        raise ConvergenceError("the tractions do not settle", "ask for fewer digits")

    def slopes(self, trial: ZoneTrial, flat: Ints) -> Array:
        """Return the derivatives of the mismatch by the logits of the boundaries.

        For each set of boundaries the tractions solve their equation, so these derivatives are a
        Schur complement in the Jacobian of both.
        """
        f = self._f
        before = trial.residual(flat), trial.mismatch(flat)
        columns = []
        corner = []
        for j in range(len(trial.logits)):
            logits = list(trial.logits)
            logits[j] += f.mp.ldexp(1, -_STEP_BITS)
            moved = ZoneTrial(trial.problem, logits)
            columns.append(f.floats((moved.residual(flat) - before[0]) << _STEP_BITS))
            corner.append(f.floats((moved.mismatch(flat) - before[1]) << _STEP_BITS))
        return np.array(corner).T - trial.conditions() @ self._factored.solved(np.array(columns).T)
