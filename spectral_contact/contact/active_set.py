"""A first layout of zones for every case: the friction law on graded rings, by an active set.

Pressure and traction are constant on rings (`spectral.rings`). Every ring sticks at first; those
that then break the law change their state, until none does. That needs no guess and no search, and
without coupling it is a strictly convex problem whose solution is reached in any case. The rings
around boundaries, and where the law holds most narrowly, are then split, and so on.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, pi

import numpy as np
from numpy.typing import NDArray

from spectral_contact.fields import Radius
from spectral_contact.spectral.cholesky import Cholesky
from spectral_contact.spectral.rings import RingOperators, graded_rings, ring_operators

__all__ = ["Doubt", "RingLayout", "ring_layout"]

Array = NDArray[np.float64]
States = NDArray[np.int_]

#: Distances from the edge are the fourth powers of even numbers: with 3 or 5 p and q are as good.
_EXPONENT = 4.0
#: Logit width of the widest rings, and minus and plus the logits down to which the first grid goes:
#: a radius of 1e-5 and a distance of 1e-16 from the edge. Splits go farther where it matters.
_WIDEST, _CENTRE, _EDGE = 1.5, 24.0, 36.0
#: Rings are split in so many, on either side of a boundary.
_PARTS, _AROUND = 4, 2
#: Most doubts around which rings are split.
_DOUBTS = 2
#: Changes of all wrong rings that may fail to lower their number, before one changes at a time;
#: and changes in all.
_PATIENCE, _MOST = 4, 100


@dataclass(frozen=True, slots=True)
class Doubt:
    """A place inside a zone where the law holds most narrowly: another zone may be hidden there.

    Attributes
    ----------
    zone : int
    place : Radius
    margin : float
        As of `RingLayout.margin`.
    """

    zone: int
    place: Radius
    margin: float


@dataclass(frozen=True, slots=True, eq=False)
class RingLayout:
    """Zones, and pressure and traction on rings, dimensionless and for unit load.

    Attributes
    ----------
    states : tuple of int
        What every zone does, outward: 0 stick, +1 or -1 slip with ``q = +f p`` or ``-f p``.
    boundaries : tuple of Radius
        Between the zones, interpolated between rings; one fewer.
    doubts : tuple of Doubt
        The most doubtful first.
    approach, total_shear : float
    logits : ndarray, shape (rings + 1,)
        Boundaries of the rings, see `RingOperators`.
    pressure, traction, slip : ndarray, shape (rings,)
        Means of p, q and u_r over the area of each ring.
    ring_states : ndarray of int, shape (rings,)
    margin : ndarray, shape (rings,)
        By how much the law holds: ``1 - |q|/(f p)`` in stick; in slip what the traction would
        exceed ``f p`` by, relative to it, if the ring alone stuck. Negative where it is broken.
    iterations : int
        Linear systems solved, on all grids.
    settled : bool
        Whether the law holds on every ring.
    positive : bool
        Whether the pressure is; thin coupled layers may pull at the edge.
    """

    states: tuple[int, ...]
    boundaries: tuple[Radius, ...]
    doubts: tuple[Doubt, ...]
    approach: float
    total_shear: float
    logits: Array
    pressure: Array
    traction: Array
    slip: Array
    ring_states: States
    margin: Array
    iterations: int
    settled: bool
    positive: bool

    @property
    def centre_unseen(self) -> bool:
        """Whether the stick disk, which every contact with friction has, is below all rings."""
        return self.states[0] != 0


def ring_layout(
    alpha: float,
    beta: float,
    friction: float,
    kappa: float,
    coupled: bool,
    *,
    rings: int = 60,
    splits: int = 2,
) -> RingLayout:
    """Return the zones that the friction law makes on rings.

    Parameters
    ----------
    alpha, beta : float
        ``alpha*`` and ``beta*``, 0 or positive.
    friction : float
        Coulomb's coefficient, 0 or positive; infinite is full stick.
    kappa : float
        The coupling of p to q, 0 or positive.
    coupled : bool
        Whether q acts back on p.
    rings : int
        Rings of the first grid, but for those next to the centre and the edge.
    splits : int
        How often rings around boundaries and doubts are split.

    Returns
    -------
    RingLayout
    """
    logits = graded_rings(rings, _EXPONENT, _WIDEST, _CENTRE, _EDGE)
    states = np.zeros(len(logits) - 1, dtype=int)
    iterations = 0
    # on smooth surfaces coupled full stick oscillates, so the states without coupling come first
    passes = [False] * coupled + [coupled] * (splits + 1)
    for number, back in enumerate(passes):
        law = _Law(ring_operators(logits), alpha, beta, friction, kappa, back)
        found, more, settled = _settle(law, states)
        iterations += more
        states = found.states
        if coupled <= number < len(passes) - 1:
            logits, states = _split(found)
    return _layout(found, iterations, settled)


class _Law:
    """The equations on rings, scaled by the square roots of their areas.

    Then rows are of like size, and unknowns are p and q times these roots.
    """

    def __init__(
        self,
        rings: RingOperators,
        alpha: float,
        beta: float,
        friction: float,
        kappa: float,
        coupled: bool,
    ) -> None:
        self.rings = rings
        self.friction = friction
        self.coupled = coupled
        self.root = np.sqrt(rings.mass)
        scale = np.outer(self.root, self.root)
        identity = np.eye(len(self.root))
        self.normal = rings.normal / scale + alpha * identity
        self.tangential = rings.tangential / scale + beta * identity
        self.carried = kappa * rings.carried / scale
        self._alone = None if coupled else Cholesky(self.normal.copy()).solve(self.root)

    def solve(self, states: States) -> _Trial:
        """Return p, q and u_r for these states, scaled to unit load."""
        stick = np.flatnonzero(states == 0)
        share = np.where(states == 0, 0.0, states * (0.0 if self.friction == inf else self.friction))
        p, q = (self._both if self._alone is None else self._shear)(stick, share)
        load = 2.0 * pi * float(p @ self.root)
        p, q = p / load, q / load
        slip = self.tangential @ q - self.carried @ p
        slip[stick] = 0.0
        return _Trial(self, states, 1.0 / load, p / self.root, q / self.root, slip / self.root)

    def _shear(self, stick: States, share: Array) -> tuple[Array, Array]:
        """Return the pressure, which is known, and the traction, for unit approach."""
        assert self._alone is not None
        p = self._alone
        q = share * p
        right = (self.carried @ p - self.tangential @ q)[stick]
        if len(stick):
            q[stick] = Cholesky(self.tangential[np.ix_(stick, stick)]).solve(right)
        return p, q

    def _both(self, stick: States, share: Array) -> tuple[Array, Array]:
        """Return pressure and traction that depend on each other, for unit approach."""
        n = len(share)
        matrix = np.empty((n + len(stick), n + len(stick)))
        matrix[:n, :n] = self.normal - self.carried.T * share
        matrix[:n, n:] = -self.carried.T[:, stick]
        matrix[n:, :n] = (self.tangential * share - self.carried)[stick]
        matrix[n:, n:] = self.tangential[np.ix_(stick, stick)]
        both = np.linalg.solve(matrix, np.concatenate([self.root, np.zeros(len(stick))]))
        q = share * both[:n]
        q[stick] = both[n:]
        return both[:n], q


@dataclass(frozen=True, slots=True, eq=False)
class _Trial:
    """What follows from states of rings."""

    law: _Law
    states: States
    approach: float
    pressure: Array
    traction: Array
    slip: Array

    def wanted(self) -> States:
        """Return the states by the law: rings that pull beyond it slip, slip along q sticks."""
        sense = np.sign(self.traction * self.pressure).astype(int)
        pulls = np.abs(self.traction) > self.law.friction * np.abs(self.pressure)
        sticks = self.states * self.slip * self.pressure > 0.0
        return np.where(self.states == 0, sense * pulls, np.where(sticks, 0, self.states))

    def reserve(self) -> Array:
        """Return the margin of `RingLayout`, with the other sign in slip: smooth at boundaries."""
        law = self.law
        limit = law.friction * np.abs(self.pressure)
        with np.errstate(divide="ignore", invalid="ignore"):
            stick = 1.0 - np.abs(self.traction) / limit
            slip = self.states * np.sign(self.pressure) * self.slip
            slip /= law.tangential.diagonal() * limit
        return np.where(self.states == 0, stick, slip)


def _settle(law: _Law, states: States) -> tuple[_Trial, int, bool]:
    """Return the trial whose states obey the law, the systems solved, and whether it does.

    All wrong rings change at once. If their number does not fall, the last of them alone does: then
    a positive definite problem is solved after finitely many changes (Judice and Pires 1994).
    """
    fewest, patience = len(states) + 1, _PATIENCE
    for iteration in range(1, _MOST + 1):
        trial = law.solve(states)
        wanted = trial.wanted()
        wrong = np.flatnonzero(wanted != states)
        if len(wrong) == 0:
            return trial, iteration, True
        if len(wrong) < fewest:
            fewest, patience = len(wrong), _PATIENCE
        elif patience > 0:
            patience -= 1
        else:
            wrong = wrong[-1:]
        states = states.copy()
        states[wrong] = wanted[wrong]
    return trial, _MOST, False


def _boundaries(trial: _Trial) -> tuple[States, Array]:
    """Return the last ring of every zone but the outermost, and the logits where they end.

    That is where the margin, whose sign tells stick from slip, changes it between two rings.
    """
    last = np.flatnonzero(np.diff(trial.states))
    reserve, middles = trial.reserve(), trial.law.rings.middles
    inner, outer = reserve[last], reserve[last + 1]
    with np.errstate(divide="ignore", invalid="ignore"):
        share = inner / (inner - outer)
    between = middles[last] + share * (middles[last + 1] - middles[last])
    return last, np.where((share > 0.0) & (share < 1.0), between, trial.law.rings.logits[last + 1])


def _doubtful(trial: _Trial) -> States:
    """Return the rings inside zones where the law holds most narrowly, the most doubtful first."""
    margin = np.abs(trial.reserve())
    same = np.concatenate([[False], np.diff(trial.states) == 0, [True]])
    around = np.concatenate([[-inf], margin, [inf]])
    least = same[:-1] & same[1:] & (margin < around[:-2]) & (margin < around[2:])
    found = np.flatnonzero(least)
    return found[np.argsort(margin[found])]


def _split(trial: _Trial) -> tuple[Array, States]:
    """Return a grid with smaller rings where zones begin or might, and the states of its rings."""
    logits, rings = trial.law.rings.logits, len(trial.states)
    last, _ = _boundaries(trial)
    near = [last + 1 + k for k in range(-_AROUND, _AROUND)]
    near += [_doubtful(trial)[:_DOUBTS] + k for k in (-1, 0, 1)]
    marked = np.unique(np.clip(np.concatenate(near), 0, rings - 1))
    lower, upper = logits[marked], logits[marked + 1]
    deep = _PARTS * _WIDEST  # of the first ring and the last one, which are infinite
    lower, upper = (
        np.where(np.isinf(lower), upper - deep, lower),
        np.where(np.isinf(upper), lower + deep, upper),
    )
    inner = lower + np.outer(np.arange(1, _PARTS) / _PARTS, upper - lower)
    parts = np.ones(rings, dtype=int)
    parts[marked] = _PARTS
    return np.sort(np.concatenate([logits, inner.ravel()])), np.repeat(trial.states, parts)


def _layout(trial: _Trial, iterations: int, settled: bool) -> RingLayout:
    """Return the layout of a trial."""
    last, ends = _boundaries(trial)
    reserve, rings = trial.reserve(), trial.law.rings
    margin = np.where(trial.states == 0, reserve, -reserve)
    zone = np.searchsorted(last, np.arange(len(margin)))
    return RingLayout(
        states=tuple(int(state) for state in trial.states[np.append(last, len(margin) - 1)]),
        boundaries=tuple(Radius.from_logit(float(end)) for end in ends),
        doubts=tuple(
            Doubt(int(zone[i]), Radius.from_logit(float(rings.middles[i])), float(margin[i]))
            for i in _doubtful(trial)
        ),
        approach=trial.approach,
        total_shear=2.0 * pi * float(trial.traction @ rings.mass),
        logits=rings.logits,
        pressure=trial.pressure,
        traction=trial.traction,
        slip=trial.slip,
        ring_states=trial.states,
        margin=margin,
        iterations=iterations,
        settled=settled,
        positive=bool((trial.pressure > 0.0).all()),
    )
