"""A first layout of zones for every case: the friction law on graded rings, by an active set.

Pressure and traction are constant on rings (`spectral.rings`). Every ring sticks at first; those
that then break the law change their state, until none does. That needs no guess and no search, and
without coupling it is a strictly convex problem whose solution is reached in any case. The rings
around boundaries, and where the law holds most narrowly, are then split, and so on.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from math import inf, pi

import numpy as np
from numpy.typing import NDArray

from spectral_contact.contact.ring_law import RingLaw, RingState, Settled, settle
from spectral_contact.fields.series import Radius
from spectral_contact.spectral.rings import graded_rings, ring_operators

__all__ = ["Doubt", "RingLayout", "ring_layout"]

Array = NDArray[np.float64]
Integers = NDArray[np.int_]

#: Distances from the edge are the fourth powers of even numbers. With 3 or 5 the approach is as
#: good (1e-5 with 60 rings); rings even in the logit all the way down err 60 times as much.
_EXPONENT = 4.0
#: Logit width of the widest rings, and minus and plus the logits down to which the first grid goes:
#: a radius of 1e-5 and a distance of 1e-16 from the edge. Splits go farther where it matters.
_WIDEST, _CENTRE, _EDGE = 1.5, 24.0, 36.0
#: Rings are split in so many, on either side of a boundary.
_PARTS, _AROUND = 4, 2
#: Margins below which the law is in doubt, and most doubts around which rings are split.
_NARROW, _DOUBTS = 0.1, 2
#: Rings of a zone that is none: where wide ones meet narrow ones they err most, and near an onset a
#: third of random scenes had up to three there that stick amid slip, or slip amid stick.
_FEW = 3


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
        What every zone does, outward: 0 stick, +1 or -1 slip with ``q = +f p`` or ``-f p``. Zones
        of a few rings between others are left out once rings have been split.
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
        Whether the law holds on every ring, as far as the pressure is positive.
    positive : bool
        Whether it is. Thin coupled layers in full stick may pull at the edge; and where friction
        times coupling is about 1 or more, coupled pressures oscillate on the widest rings. Beyond
        the first such ring all slips, unjudged.
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
    ring_states: Integers
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
        law = RingLaw(ring_operators(logits), alpha, beta, friction, kappa, coupled=back)
        found = settle(law, states)
        iterations += found.iterations
        states = found.state.states
        if coupled <= number < len(passes) - 1:
            logits, states = _split(found.state)
    return _layout(found, _resolved(states) if splits else states, iterations)


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


def _doubtful(state: RingState) -> Integers:
    """Return the rings inside zones where the law holds most narrowly, the most doubtful first."""
    margin = np.abs(state.reserve)
    with np.errstate(divide="ignore", invalid="ignore"):
        # a slip that is smallest: its margin jumps with the width of rings
        height = np.where(state.states == 0, margin, np.abs(state.slip) / state.limit)
    same = np.concatenate([[False], np.diff(state.states) == 0, [True]])
    around = np.concatenate([[-inf], height, [inf]])
    least = same[:-1] & same[1:] & (height < around[:-2]) & (height < around[2:])
    found = np.flatnonzero(least & (margin < _NARROW))
    return found[np.argsort(margin[found])]


def _split(state: RingState) -> tuple[Array, Integers]:
    """Return a grid with smaller rings where zones begin or might, and the states of its rings."""
    logits, rings = state.law.rings.logits, len(state.states)
    last, _ = _boundaries(state)
    near = [last + 1 + k for k in range(-_AROUND, _AROUND)]
    near += [_doubtful(state)[:_DOUBTS] + k for k in (-1, 0, 1)]
    near.append(np.flatnonzero(state.states[:1]))  # the stick disk is smaller than the first ring
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
    return np.sort(np.concatenate([logits, inner.ravel()])), np.repeat(state.states, parts)


def _layout(found: Settled, states: Integers, iterations: int) -> RingLayout:
    """Return what was found as a layout, with zones where these states are."""
    state = found.state
    last, ends = _boundaries(replace(state, states=states))
    rings, margin = state.law.rings, np.abs(state.reserve)
    zone = np.searchsorted(last, np.arange(len(margin)))
    return RingLayout(
        states=tuple(int(one) for one in states[np.append(last, len(margin) - 1)]),
        boundaries=tuple(Radius.from_logit(float(end)) for end in ends),
        doubts=tuple(
            Doubt(int(zone[i]), Radius.from_logit(float(rings.middles[i])), float(margin[i]))
            for i in _doubtful(state)
        ),
        approach=state.approach,
        total_shear=2.0 * pi * float(state.traction @ rings.mass),
        logits=rings.logits,
        pressure=state.pressure,
        traction=state.traction,
        slip=state.slip,
        ring_states=state.states,
        margin=np.where(state.states == 0, state.reserve, -state.reserve),
        iterations=iterations,
        settled=found.settled,
        positive=bool((state.pressure > 0.0).all()),
    )
