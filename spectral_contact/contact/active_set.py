"""A first layout of zones for every case: the friction law on graded rings, by an active set.

Pressure p, traction q and radial displacement are constant on rings (`spectral.rings`). Every ring
sticks at first; those that then violate the law change their state, until none does. That needs no
guess and no search, and without coupling it is a strictly convex problem, whose solution is reached
in any case. The rings around the boundaries of zones are then split, and the law is solved again.

alpha, beta, kappa and friction f are those of `Parameters`; the logit of a radius is
``ln(s**2/(1 - s**2))``.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from math import inf, pi

import numpy as np
from numpy.typing import NDArray

from spectral_contact.contact.resolution import EPSILON_DEPTH
from spectral_contact.contact.tuning import (
    FIRST_RINGS,
    MAX_RING_SYSTEMS,
    MAX_RING_WIDTH,
    MAX_SPURIOUS_RINGS,
    RING_GRADING,
    RING_PATIENCE,
    RING_SPLITS,
    RINGS_PER_SPLIT,
    SPLIT_NEIGHBOURS,
)
from spectral_contact.fields.series import Array, Radius
from spectral_contact.spectral.parameters import Parameters
from spectral_contact.spectral.regularised import Cholesky
from spectral_contact.spectral.rings import RingOperators, graded_rings, ring_operators

Integers = NDArray[np.int_]


class RingLaw:
    """The equations of pressure and traction on rings, scaled by the square roots of their areas.

    The unknowns are p and q times these roots, so that all rows are of like size.

    Parameters
    ----------
    rings : RingOperators
    parameters : Parameters
    coupled : bool
        Whether q acts back on p.
    frozen : ndarray, shape (rings,), optional
        The displacement of each ring if it sticks, for unit load; by default zero.

    Attributes
    ----------
    friction : float
    self_compliance : ndarray, shape (rings,)
        Displacement of each ring that a traction of 1 on this ring alone makes.
    """

    def __init__(
        self,
        rings: RingOperators,
        parameters: Parameters,
        *,
        coupled: bool,
        frozen: Array | None = None,
    ) -> None:
        alpha, beta, kappa, friction = parameters
        self.rings = rings
        self.friction = friction
        self._root_area = np.sqrt(rings.mass)
        self.frozen = np.zeros(len(rings.mass)) if frozen is None else frozen
        scale = np.outer(self._root_area, self._root_area)
        identity = np.eye(len(self._root_area))
        self._normal = rings.normal / scale + alpha * identity
        self._tangential = rings.tangential / scale + beta * identity
        self._coupling = kappa * rings.carried / scale
        self.self_compliance: Array = self._tangential.diagonal()
        self._known_pressure: Array | None = None
        if not coupled:
            self._known_pressure = Cholesky(self._normal.copy()).solve(self._root_area)

    def solve(self, states: Integers) -> RingState:
        """Return p, q and the displacement for these states, scaled to unit load."""
        sticking = np.flatnonzero(states == 0)
        ratio = np.zeros(len(states))
        ratio[states != 0] = self.friction * states[states != 0]
        if self._known_pressure is None:
            p, q = self._solve_coupled(sticking, ratio)
        else:
            p = self._known_pressure
            load = 2.0 * pi * float(p @ self._root_area)
            frozen = load * self._root_area * self.frozen
            q = self._solve_traction(p, sticking, ratio, frozen)
        load = 2.0 * pi * float(p @ self._root_area)
        p = p / load
        q = q / load
        root = self._root_area
        slip = (self._tangential @ q - self._coupling @ p) / root
        slip[sticking] = self.frozen[sticking]
        return RingState(self, states, 1.0 / load, p / root, q / root, slip)

    def _solve_traction(self, p: Array, sticking: Integers, ratio: Array, frozen: Array) -> Array:
        """Return the traction under a known pressure, for unit approach.

        Parameters
        ----------
        p : ndarray, shape (rings,)
        sticking : ndarray of int
            Numbers of the rings that stick.
        ratio : ndarray, shape (rings,)
            q/p of the rings that slip.
        frozen : ndarray, shape (rings,)
            Displacement of the rings that stick.
        """
        q = ratio * p
        right = (self._coupling @ p - self._tangential @ q + frozen)[sticking]
        if len(sticking):
            q[sticking] = Cholesky(self._tangential[np.ix_(sticking, sticking)]).solve(right)
        return q

    def _solve_coupled(self, sticking: Integers, ratio: Array) -> tuple[Array, Array]:
        """Return pressure and traction that depend on each other, for unit approach.

        The unknowns are the pressures of all rings and the tractions of those that stick.
        `sticking` and `ratio` are those of `_solve_traction`.
        """
        n = len(ratio)
        matrix = np.empty((n + len(sticking), n + len(sticking)))
        matrix[:n, :n] = self._normal - self._coupling.T * ratio
        matrix[:n, n:] = -self._coupling.T[:, sticking]
        matrix[n:, :n] = (self._tangential * ratio - self._coupling)[sticking]
        matrix[n:, n:] = self._tangential[np.ix_(sticking, sticking)]
        # on smooth surfaces the diagonal of a small ring is small: scale it to 1
        diagonal = np.concatenate([self._normal.diagonal(), self.self_compliance[sticking]])
        scale = 1.0 / np.sqrt(diagonal)
        matrix *= scale
        matrix *= scale[:, None]
        right = np.concatenate([self._root_area, np.zeros(len(sticking))])
        unknowns = scale * np.linalg.solve(matrix, scale * right)
        p = unknowns[:n]
        q = ratio * p
        q[sticking] = unknowns[n:]
        return p, q


@dataclass(frozen=True, slots=True, eq=False)
class RingState:
    """The solution for given states of rings: means of p, q and u_r over the area of each.

    Attributes
    ----------
    law : RingLaw
    states : ndarray of int, shape (rings,)
        0 for stick, +1 or -1 for slip with ``q = +f p`` or ``q = -f p``.
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
        """The largest traction ``f |p|`` that friction bears on each ring."""
        return np.asarray(self.law.friction * np.abs(self.pressure))

    @property
    def holding_traction(self) -> Array:
        """The traction that would make each ring stick if the others stayed as they are.

        Unlike the traction it passes smoothly from stick to slip.
        """
        return self.traction - (self.slip - self.law.frozen) / self.law.self_compliance

    @property
    def margin(self) -> Array:
        """One minus the holding traction over ``f p``: positive in stick, negative in slip.

        If the law holds, its modulus is the margin by which it does.
        """
        with np.errstate(divide="ignore", over="ignore"):
            return np.asarray(1.0 - np.abs(self.holding_traction) / self.limit)

    @property
    def positive(self) -> bool:
        """Whether the pressure is positive on all rings.

        It need not be: with coupling, thin layers in full stick may pull at the edge, and where
        ``kappa f`` is about 1 or more, pressures oscillate on the widest rings. Beyond the first
        such ring all rings slip, and the law is not verified.
        """
        return bool((self.pressure > 0.0).all())

    def states_by_law(self) -> Integers:
        """Return the states that the law asks for: rings slip whose holding traction exceeds f p.

        Beyond the first ring at which the surfaces would separate all rings slip outward: p and q
        oscillate there as long as zones nearer the centre are wrong.
        """
        if self.law.friction == inf:
            return np.zeros_like(self.states)
        holding = self.holding_traction
        states = np.where(np.abs(holding) > self.limit, np.sign(holding).astype(int), 0)
        separated = np.flatnonzero(self.pressure <= 0.0)
        if len(separated):
            states[separated[0] :] = 1
        return states


def solve_active_set(law: RingLaw, states: Integers) -> RingState:
    """Change states until all obey the law; return the solution for the last ones.

    All wrong rings change at once. If their number does not fall, the last of them alone does: then
    a positive definite problem is solved after finitely many changes (Judice and Pires, 1994).
    """
    fewest = len(states) + 1
    patience = RING_PATIENCE
    for _ in range(MAX_RING_SYSTEMS):
        state = law.solve(states)
        wanted_states = state.states_by_law()
        wrong = np.flatnonzero(wanted_states != states)
        if len(wrong) == 0:
            break
        if len(wrong) < fewest:
            fewest = len(wrong)
            patience = RING_PATIENCE
        elif patience > 0:
            patience -= 1
        else:
            wrong = wrong[-1:]
        states = states.copy()
        states[wrong] = wanted_states[wrong]
    return state


@dataclass(frozen=True, slots=True, eq=False)
class RingLayout:
    """Zones, and the rings they are read from.

    Attributes
    ----------
    states : tuple of int
        Of every zone, outward: 0 for stick, +1 or -1 for slip with ``q = +f p`` or ``q = -f p``.
        Zones of at most `MAX_SPURIOUS_RINGS` between others are left out once rings were split.
    boundaries : tuple of Radius
        Between the zones, interpolated between rings; one fewer than zones.
    on_rings : RingState
        The solution on the last grid.
    """

    states: tuple[int, ...]
    boundaries: tuple[Radius, ...]
    on_rings: RingState

    @property
    def converged(self) -> bool:
        """Whether the law holds on every ring, as far as the pressure is positive."""
        return bool((self.on_rings.states_by_law() == self.on_rings.states).all())

    @property
    def centre_unresolved(self) -> bool:
        """Whether the stick disk, which every contact with friction has, is below all rings."""
        return self.states[0] != 0


def ring_layout(
    parameters: Parameters,
    *,
    coupled: bool,
    rings: int = FIRST_RINGS,
    splits: int = RING_SPLITS,
    unloaded_to: float = 1.0,
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
        How often the rings around boundaries are split.
    unloaded_to : float
        The load over the largest load there was before, without coupling. Below 1 what sticks has
        the displacement of before. Rings are split around the boundaries at the largest load.
    """
    logits = graded_rings(rings, RING_GRADING, MAX_RING_WIDTH, EPSILON_DEPTH, EPSILON_DEPTH)
    states = np.zeros(len(logits) - 1, dtype=int)
    if coupled:
        # on smooth surfaces coupled full stick oscillates: begin with the states without coupling
        states = solve_active_set(
            RingLaw(ring_operators(logits), parameters, coupled=False), states
        ).states
    on_rings = solve_active_set(
        RingLaw(ring_operators(logits), parameters, coupled=coupled), states
    )
    for _ in range(splits):
        logits, states = _split(on_rings)
        on_rings = solve_active_set(
            RingLaw(ring_operators(logits), parameters, coupled=coupled), states
        )
    if unloaded_to < 1.0:
        frozen = on_rings.slip / unloaded_to
        law = RingLaw(ring_operators(logits), parameters, coupled=False, frozen=frozen)
        on_rings = solve_active_set(law, np.zeros_like(states))
    zone_states = _without_spurious_zones(on_rings.states) if splits else on_rings.states
    last_rings, boundaries = _boundaries(replace(on_rings, states=zone_states))
    outermost = len(zone_states) - 1
    return RingLayout(
        tuple(int(state) for state in zone_states[np.append(last_rings, outermost)]),
        tuple(Radius.from_logit(float(logit)) for logit in boundaries),
        on_rings,
    )


def _without_spurious_zones(states: Integers) -> Integers:
    """Return the states of rings, with zones of a few rings given to the zone inside them."""
    merged = states.copy()
    starts = (np.flatnonzero(np.diff(states)) + 1).tolist()
    for start, end in pairwise(starts):
        if end - start <= MAX_SPURIOUS_RINGS:
            merged[start:end] = merged[start - 1]
    return merged


def _boundaries(state: RingState) -> tuple[Integers, Array]:
    """Return the last ring of every zone but the outermost, and the logits where the zones end.

    A zone ends where the margin, which is positive in stick and negative in slip, is zero between
    the middles of two rings. If it does not change its sign, the zone ends between the rings.
    """
    last = np.flatnonzero(np.diff(state.states))
    middles = state.law.rings.middles
    margin_inside = state.margin[last]
    margin_outside = state.margin[last + 1]
    with np.errstate(divide="ignore", invalid="ignore"):
        fraction = margin_inside / (margin_inside - margin_outside)
    zero = middles[last] + fraction * (middles[last + 1] - middles[last])
    changes_sign = (fraction > 0.0) & (fraction < 1.0)
    return last, np.where(changes_sign, zero, state.law.rings.logits[last + 1])


def _split(state: RingState) -> tuple[Array, Integers]:
    """Return a grid with smaller rings around boundaries, and the states of its rings."""
    logits = state.law.rings.logits
    count = len(state.states)
    last, _ = _boundaries(state)
    to_split = [last + 1 + k for k in range(-SPLIT_NEIGHBOURS, SPLIT_NEIGHBOURS)]
    if state.states[0] != 0:  # the stick disk is smaller than the first ring
        to_split.append(np.array([0]))
    marked = np.unique(np.clip(np.concatenate(to_split), 0, count - 1))
    lower = logits[marked]
    upper = logits[marked + 1]
    # the first ring and the last one are infinite in the logit: only a part of them is split
    depth = RINGS_PER_SPLIT * MAX_RING_WIDTH
    lower = np.where(np.isinf(lower), upper - depth, lower)
    upper = np.where(np.isinf(upper), lower + depth, upper)
    fractions = np.arange(1, RINGS_PER_SPLIT) / RINGS_PER_SPLIT
    inner = lower + np.outer(fractions, upper - lower)
    parts = np.ones(count, dtype=int)
    parts[marked] = RINGS_PER_SPLIT
    return np.sort(np.concatenate([logits, inner.ravel()])), np.repeat(state.states, parts)
