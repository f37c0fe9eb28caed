"""The friction law on rings, and the active set that obeys it."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, pi

import numpy as np
from numpy.typing import NDArray

from spectral_contact.spectral.cholesky import Cholesky
from spectral_contact.spectral.rings import RingOperators

__all__ = ["RingLaw", "RingState", "Settled", "settle"]

Array = NDArray[np.float64]
Integers = NDArray[np.int_]

#: Changes of all wrong rings that may fail to lower their number, before one changes at a time;
#: and systems solved at most. Random scenes took 12, or 33 where friction and coupling are strong.
_PATIENCE, _MOST = 4, 40


class RingLaw:
    """The equations on rings, scaled by the square roots of their areas.

    Then rows are of like size, and unknowns are p and q times these roots.

    Parameters
    ----------
    rings : RingOperators
    alpha, beta, friction, kappa : float
        As of `ring_layout`.
    coupled : bool
        Whether q acts back on p.
    """

    def __init__(
        self,
        rings: RingOperators,
        alpha: float,
        beta: float,
        friction: float,
        kappa: float,
        *,
        coupled: bool,
    ) -> None:
        self.rings = rings
        self.friction = friction
        self._root = np.sqrt(rings.mass)
        scale = np.outer(self._root, self._root)
        identity = np.eye(len(self._root))
        self._normal = rings.normal / scale + alpha * identity
        self._tangential = rings.tangential / scale + beta * identity
        self._carried = kappa * rings.carried / scale
        #: by what q of a ring falls if only this ring slips by a unit
        self.own: Array = self._tangential.diagonal()
        self._alone = None if coupled else Cholesky(self._normal.copy()).solve(self._root)

    def solve(self, states: Integers) -> RingState:
        """Return p, q and u_r for these states, scaled to unit load."""
        stick = np.flatnonzero(states == 0)
        share = np.zeros(len(states))
        share[states != 0] = self.friction * states[states != 0]
        p, q = self._both(stick, share) if self._alone is None else self._shear(stick, share)
        load = 2.0 * pi * float(p @ self._root)
        p, q = p / load, q / load
        slip = self._tangential @ q - self._carried @ p
        slip[stick] = 0.0
        root = self._root
        return RingState(self, states, 1.0 / load, p / root, q / root, slip / root)

    def _shear(self, stick: Integers, share: Array) -> tuple[Array, Array]:
        """Return the pressure, which is known, and the traction, for unit approach."""
        assert self._alone is not None
        p = self._alone
        q = share * p
        right = (self._carried @ p - self._tangential @ q)[stick]
        if len(stick):
            q[stick] = Cholesky(self._tangential[np.ix_(stick, stick)]).solve(right)
        return p, q

    def _both(self, stick: Integers, share: Array) -> tuple[Array, Array]:
        """Return pressure and traction that depend on each other, for unit approach."""
        n = len(share)
        matrix = np.empty((n + len(stick), n + len(stick)))
        matrix[:n, :n] = self._normal - self._carried.T * share
        matrix[:n, n:] = -self._carried.T[:, stick]
        matrix[n:, :n] = (self._tangential * share - self._carried)[stick]
        matrix[n:, n:] = self._tangential[np.ix_(stick, stick)]
        # a small ring has little compliance of its own where the surfaces are smooth
        scale = 1.0 / np.sqrt(np.concatenate([self._normal.diagonal(), self.own[stick]]))
        matrix *= scale
        matrix *= scale[:, None]
        right = np.concatenate([self._root, np.zeros(len(stick))])
        both = scale * np.linalg.solve(matrix, scale * right)
        q = share * both[:n]
        q[stick] = both[n:]
        return both[:n], q


@dataclass(frozen=True, slots=True, eq=False)
class RingState:
    """What follows from states of rings: means of p, q and u_r over the area of each.

    Attributes
    ----------
    law : RingLaw
    states : ndarray of int, shape (rings,)
        0 stick, +1 or -1 slip with ``q = +f p`` or ``-f p``.
    approach : float
        For unit load.
    pressure, traction, slip : ndarray, shape (rings,)
    """

    law: RingLaw
    states: Integers
    approach: float
    pressure: Array
    traction: Array
    slip: Array

    @property
    def limit(self) -> Array:
        """What friction bears on each ring."""
        return np.asarray(self.law.friction * np.abs(self.pressure))

    @property
    def holding(self) -> Array:
        """The traction that would hold each ring if the others stayed as they are.

        It passes smoothly from stick to slip.
        """
        return self.traction - self.slip / self.law.own

    @property
    def reserve(self) -> Array:
        """By what part of what friction bears the holding traction is below it; minus in slip."""
        with np.errstate(divide="ignore", over="ignore"):
            return np.asarray(1.0 - np.abs(self.holding) / self.limit)

    def wanted(self) -> Integers:
        """Return the states by the law: rings slip that friction does not hold.

        Where surfaces would separate, zones are wrong nearer the centre already. Until these are
        right, all beyond slips outward: its pressure and traction oscillate.
        """
        if self.law.friction == inf:
            return np.zeros_like(self.states)
        holding = self.holding
        states = np.where(np.abs(holding) > self.limit, np.sign(holding).astype(int), 0)
        apart = np.flatnonzero(self.pressure <= 0.0)
        if len(apart):
            states[apart[0] :] = 1
        return states


@dataclass(frozen=True, slots=True, eq=False)
class Settled:
    """What an active set came to: the state, the systems solved, whether the law holds."""

    state: RingState
    iterations: int
    settled: bool


def settle(law: RingLaw, states: Integers) -> Settled:
    """Change states until all obey the law.

    All wrong rings change at once. If their number does not fall, the last of them alone does: then
    a positive definite problem is solved after finitely many changes (Judice and Pires, 1994).

    Parameters
    ----------
    law : RingLaw
    states : ndarray of int, shape (rings,)
        What to begin with.
    """
    fewest, patience = len(states) + 1, _PATIENCE
    for iteration in range(1, _MOST + 1):
        state = law.solve(states)
        wanted = state.wanted()
        wrong = np.flatnonzero(wanted != states)
        if len(wrong) == 0:
            return Settled(state, iteration, True)
        if len(wrong) < fewest:
            fewest, patience = len(wrong), _PATIENCE
        elif patience > 0:
            patience -= 1
        else:
            wrong = wrong[-1:]
        states = states.copy()
        states[wrong] = wanted[wrong]
    return Settled(state, _MOST, False)
