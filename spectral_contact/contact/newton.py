"""Newton's method for fields and boundaries, with factors and slopes that serve for a while."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from spectral_contact.contact.boundaries import NoBoundariesError, longest, through_secants
from spectral_contact.contact.coupled_state import CoupledState
from spectral_contact.contact.refine import Resolution
from spectral_contact.spectral.factored import Factored, factored

if TYPE_CHECKING:
    from spectral_contact.contact.coupled_problem import CoupledProblem

__all__ = ["LEFT", "ZonesNewton"]

Array = NDArray[np.float64]

#: The share of its step that a correction leaves at least, and from which share on it is the factor
#: or rounding that is not good enough.
LEFT, _SLOW = 1e-2, 0.2
#: Corrections of a solution from nothing, which do not tell how good the factors are; and what is
#: left by those of other boundaries, over their distance.
_FIRST, _DRIFT = 2, 3.0
#: Most corrections.
_STEPS = 40
#: What of a step of the boundaries the fields may be off by, for that step and for its slopes: a
#: scene of a sweep takes 3.1 systems, 4.5 with 0.3 and 0.03. And conditions that miss as little as
#: the last say nothing of slopes.
_SHARE, _KNOWN, _MEANT = 0.01, 0.003, 1e-11
#: A step that is more than so much of the one before does not show that they become shorter.
_SHRINKS = 0.5
#: Where boundaries are near by at most so many steps in a row do not become shorter.
_MOST_STALLED = 2
#: What is left of the fields where no correction makes conditions any better.
_CORRECTED = 1e-13
#: A correction that is smaller and does not fall any more is rounding.
_ROUNDED = 1e-9


@dataclass(frozen=True, slots=True)
class _Move:
    """A step of the boundaries, and what their conditions missed before it."""

    step: Array
    length: float
    mismatch: Array


_NOTHING = _Move(np.zeros(0), 0.0, np.zeros(0))


@dataclass(slots=True)
class _Pace:
    """What corrections with the same factors at the same boundaries come to.

    Attributes
    ----------
    thinnest : float
        The least compliance, or 1.
    size, before : float
        Of the last correction and the one before, as the largest share.
    alike : int
        How many there were, but for those from nothing.
    drift : float
        How far the boundaries of the factors are, of the narrowest zone.
    """

    thinnest: float
    size: float = 1.0
    before: float = 1.0
    alike: int = -_FIRST
    drift: float = 0.0

    def add(self, size: float, drift: float) -> None:
        """Count another one."""
        self.before, self.size, self.drift = self.size, size, drift
        self.alike += 1

    @property
    def _astray(self) -> bool:
        """Whether the factors are those of other boundaries.

        They are off by about the distance of these, in units of a layer: they make an error next
        to the boundaries first, which the next correction takes back.
        """
        return self.drift > LEFT / _DRIFT * self.thinnest

    @property
    def _telling(self) -> bool:
        return self.alike > 1 + self._astray

    @property
    def slow(self) -> bool:
        """Whether corrections do not shrink as they should."""
        return self._telling and self.size > _SLOW * self.before

    @property
    def left(self) -> float:
        """What the last one leaves."""
        if self._astray and self.alike < 2:
            return self.size
        expected = self.size / self.before if self._telling else 0.0
        return self.size * min(max(LEFT, _DRIFT * self.drift, expected), 1.0)


class ZonesNewton:
    """Corrects fields and boundaries, until neither moves any more.

    The boundaries move when more is left of them than the fields may be off. Factors serve as long
    as corrections with them shrink.

    Parameters
    ----------
    problem : CoupledProblem
        Its boundaries and their slopes are kept up.
    spaces : list of Resolution
    settle : float
        How short the last step of the boundaries is.
    factors : Factored, optional
        Of these spaces and boundaries, if known.

    Attributes
    ----------
    state : CoupledState
    left : float
        What is left of the fields.
    """

    def __init__(
        self,
        problem: CoupledProblem,
        spaces: list[Resolution],
        settle: float,
        factors: Factored | None = None,
    ) -> None:
        self._problem, self._spaces, self._settle = problem, spaces, settle
        self._factors = factors or problem.factored(problem.system(spaces, problem.logits))
        self.state = CoupledState.begin(self._factors.system, self._factors)
        self.left, self._begin, self._before, self._stalled = 0.0, problem.logits, inf, 0
        self._pace, self._move = _Pace(problem.thinnest), _NOTHING
        self._secants: list[tuple[Array, Array]] = []
        self._least, self._best = inf, (self.state, problem.logits)

    def run(self, aim: float) -> CoupledState:
        """Correct until less than an aim is left.

        Raises
        ------
        NoBoundariesError
            If boundaries are said to be near by and are not.
        """
        for _ in range(_STEPS):
            step = self._corrected()
            off = float(np.abs(step).max(initial=0.0))
            still = self._still(off)
            self._remember(aim)
            own, slow = self._factors.system is self.state.system, self._pace.slow
            # no other factors are better, or what is left is rounding
            ended = (own and self._factors.exact) or (self._pace.size < _ROUNDED and still)
            if (slow and ended) or (self.left < aim and still):
                break
            if not still and self._telling(off):
                slow = self._moved(step, off)
            if slow:
                self._factored(exact=self._factors.exact or (own and self._pace.alike > 0))
        if self._least < self._missed:  # what is left is rounding, or no boundaries are there
            self.state, self._problem.logits = self._best
        return self.state

    def _still(self, off: float) -> bool:
        """Return whether the boundaries are known no better: steps do not become shorter."""
        rounded = off < _ROUNDED or self._missed < _MEANT
        return off < self._settle or (rounded and off > _SHRINKS * self._before)

    def _telling(self, off: float) -> bool:
        """Return whether the fields are good enough for a step, and more than made from nothing."""
        return self._pace.alike >= 0 and off > max(0.5 * self._settle, self._noise / _SHARE)

    def _remember(self, aim: float) -> None:
        """Keep the best there is, next to the onset of a zone."""
        if self.left < max(aim, _CORRECTED) and self._missed < self._least:
            self._least, self._best = self._missed, (self.state, self._problem.logits)

    @property
    def _missed(self) -> float:
        return float(np.abs(self.state.mismatch).max(initial=0.0))

    @property
    def _noise(self) -> float:
        """What is left makes of a step: next to a narrow zone conditions hardly change."""
        return self.left / self._problem.narrowest if self.left > _CORRECTED else 0.0

    def _corrected(self) -> Array:
        """Correct the fields, learn from the last step, and return the next one."""
        problem = self._problem
        self.state, change = self.state.corrected()
        self._pace.add(problem.size(self.state, change), problem.drift(self._begin))
        self.left = self._pace.left
        if self._noise < _KNOWN * self._move.length:
            self._learn()
        return -np.linalg.solve(problem.slopes, self.state.mismatch).astype(float)

    def _learn(self) -> None:
        """Take from a step, and those before, what they show of the slopes."""
        move, self._move = self._move, _NOTHING
        if float(np.abs(move.mismatch).max()) > _MEANT:
            own = move.step, self.state.mismatch - move.mismatch
            self._secants = [*self._secants, own][-len(move.step) :]
            self._problem.slopes = through_secants(self._problem.slopes, self._secants)

    def _moved(self, step: Array, off: float) -> bool:
        """Move the boundaries, and return whether they need factors of their own."""
        problem = self._problem
        if self._move.length:
            self._learn()
        step = step * min(1.0, longest(problem.logits, step))
        self._move = _Move(step, float(np.abs(step).max()), self.state.mismatch)
        self._stalled = self._stalled + 1 if off > _SHRINKS * self._before else 0
        if problem.near and self._stalled > _MOST_STALLED:
            raise NoBoundariesError("no boundaries near by")
        problem.logits, self._before = problem.logits + step, off
        self.state = self.state.at(problem.system(self._spaces, problem.logits))
        self._pace.alike = 0
        return problem.drift(self._begin) > problem.far

    def _factored(self, *, exact: bool) -> None:
        self._factors = factored(self.state.system, exact=exact)
        self.state, self._begin = self.state.by(self._factors), self._problem.logits
        self._pace.alike = 0
