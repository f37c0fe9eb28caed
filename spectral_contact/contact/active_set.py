"""A first layout of zones for every case: the friction law on graded rings, by an active set.

Pressure and traction are constant on rings (`spectral.rings`). Every ring sticks at first; those
that then break the law change their state, until none does. That needs no guess and no search, and
without coupling it is a strictly convex problem whose solution is reached in any case. The rings
around boundaries are then split, and so on.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from math import inf, pi

import numpy as np
from numpy.typing import NDArray

from spectral_contact.contact.resolution import EPSILON_DEPTH
from spectral_contact.fields.series import Array, Radius
from spectral_contact.spectral.parameters import Parameters
from spectral_contact.spectral.regularised import Cholesky
from spectral_contact.spectral.rings import RingOperators, graded_rings, ring_operators

Integers = NDArray[np.int_]

#: Changes of all wrong rings that may fail to lower their number, before one changes at a time;
#: and systems solved at most. Random scenes took 12, or 33 where friction and coupling are strong.
_PATIENCE, _MOST = 4, 40
#: Distances from the edge are the fourth powers of even numbers. With 3 or 5 the approach is as
#: good (1e-5 with 60 rings); rings even in the logit all the way down err 60 times as much.
_EXPONENT = 4
#: Logit width of the widest rings; 25 scenes have the same zones with 0.75 and with 3.
_WIDEST = 1.5
#: Rings are split in so many, on either side of a boundary.
_PARTS, _AROUND = 4, 2
#: Rings of a zone that is none: where wide ones meet narrow ones they err most, and near an onset a
#: third of random scenes had up to three there that stick amid slip, or slip amid stick.
_FEW = 3


class RingLaw:
    """The equations on rings, scaled by the square roots of their areas.

    Then rows are of like size, and unknowns are p and q times these roots.

    Parameters
    ----------
    rings : RingOperators
    parameters : Parameters
    coupled : bool
        Whether q acts back on p.
    """

    def __init__(self, rings: RingOperators, parameters: Parameters, *, coupled: bool) -> None:
        self.rings = rings
        alpha, beta, kappa, self.friction = parameters
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
        """By what part of what friction bears the holding traction is below it; minus in slip.

        Its modulus is the margin by which the law holds, if it does.
        """
        with np.errstate(divide="ignore", over="ignore"):
            return np.asarray(1.0 - np.abs(self.holding) / self.limit)

    @property
    def positive(self) -> bool:
        """Whether the pressure is.

        Thin coupled layers in full stick may pull at the edge; and where friction times coupling is
        about 1 or more, coupled pressures oscillate on the widest rings. Beyond the first such ring
        all slips, unjudged.
        """
        return bool((self.pressure > 0.0).all())

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


def settle(law: RingLaw, states: Integers) -> RingState:
    """Change states until all obey the law; return what follows from the last ones.

    All wrong rings change at once. If their number does not fall, the last of them alone does: then
    a positive definite problem is solved after finitely many changes (Judice and Pires, 1994).
    """
    fewest, patience = len(states) + 1, _PATIENCE
    for _ in range(_MOST):
        state = law.solve(states)
        wanted = state.wanted()
        wrong = np.flatnonzero(wanted != states)
        if len(wrong) == 0:
            break
        if len(wrong) < fewest:
            fewest, patience = len(wrong), _PATIENCE
        elif patience > 0:
            patience -= 1
        else:
            wrong = wrong[-1:]
        states = states.copy()
        states[wrong] = wanted[wrong]
    return state


@dataclass(frozen=True, slots=True, eq=False)
class RingLayout:
    """Zones, and what they are read from.

    Attributes
    ----------
    states : tuple of int
        What every zone does, outward: 0 stick, +1 or -1 slip with ``q = +f p`` or ``-f p``. Zones
        of a few rings between others are left out once rings have been split.
    boundaries : tuple of Radius
        Between the zones, interpolated between rings; one fewer.
    on_rings : RingState
        The last of all.
    """

    states: tuple[int, ...]
    boundaries: tuple[Radius, ...]
    on_rings: RingState

    @property
    def settled(self) -> bool:
        """Whether the law holds on every ring, as far as the pressure is positive."""
        return bool((self.on_rings.wanted() == self.on_rings.states).all())

    @property
    def centre_unseen(self) -> bool:
        """Whether the stick disk, which every contact with friction has, is below all rings."""
        return self.states[0] != 0


def ring_layout(
    parameters: Parameters, *, coupled: bool, rings: int = 60, splits: int = 2
) -> RingLayout:
    """Return the zones that the friction law makes on rings.

    Parameters
    ----------
    parameters : Parameters
        Infinite friction is full stick.
    coupled : bool
        Whether q acts back on p.
    rings : int
        Rings of the first grid, but for those next to the centre and the edge.
    splits : int
        How often rings around boundaries are split.
    """
    logits = graded_rings(rings, _EXPONENT, _WIDEST, EPSILON_DEPTH, EPSILON_DEPTH)
    states = np.zeros(len(logits) - 1, dtype=int)
    # on smooth surfaces coupled full stick oscillates, so the states without coupling come first
    passes = [False] * coupled + [coupled] * (splits + 1)
    for number, back in enumerate(passes):
        found = settle(RingLaw(ring_operators(logits), parameters, coupled=back), states)
        states = found.states
        if coupled <= number < len(passes) - 1:
            logits, states = _split(found)
    states = _resolved(states) if splits else states
    last, ends = _boundaries(replace(found, states=states))
    return RingLayout(
        tuple(int(one) for one in states[np.append(last, len(states) - 1)]),
        tuple(Radius.from_logit(float(end)) for end in ends),
        found,
    )


def _resolved(states: Integers) -> Integers:
    """Return the states without zones of a few rings between others."""
    found = states.copy()
    starts = (np.flatnonzero(np.diff(states)) + 1).tolist()
    for begin, end in pairwise(starts):
        if end - begin <= _FEW:
            found[begin:end] = found[begin - 1]
    return found


def _boundaries(state: RingState) -> tuple[Integers, Array]:
    """Return the last ring of every zone but the outermost, and the logits where they end.

    That is where the margin, whose sign tells stick from slip, changes it between two rings.
    """
    last = np.flatnonzero(np.diff(state.states))
    reserve, middles = state.reserve, state.law.rings.middles
    inner, outer = reserve[last], reserve[last + 1]
    with np.errstate(divide="ignore", invalid="ignore"):
        share = inner / (inner - outer)
    between = middles[last] + share * (middles[last + 1] - middles[last])
    return last, np.where((share > 0.0) & (share < 1.0), between, state.law.rings.logits[last + 1])


def _split(state: RingState) -> tuple[Array, Integers]:
    """Return a grid with smaller rings where zones begin, and the states of its rings."""
    logits, rings = state.law.rings.logits, len(state.states)
    last, _ = _boundaries(state)
    near = [last + 1 + k for k in range(-_AROUND, _AROUND)]
    near.append(np.flatnonzero(state.states[:1]))  # the stick disk is smaller than the first ring
    marked = np.unique(np.clip(np.concatenate(near), 0, rings - 1))
    lower, upper = logits[marked], logits[marked + 1]
    deep = _PARTS * _WIDEST  # of the first ring and the last one, which are infinite
    lower = np.where(np.isinf(lower), upper - deep, lower)
    upper = np.where(np.isinf(upper), lower + deep, upper)
    inner = lower + np.outer(np.arange(1, _PARTS) / _PARTS, upper - lower)
    parts = np.ones(rings, dtype=int)
    parts[marked] = _PARTS
    return np.sort(np.concatenate([logits, inner.ravel()])), np.repeat(state.states, parts)
