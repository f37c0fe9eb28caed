"""A first layout of zones for every case: the friction law on graded rings, by an active set.

Pressure p, traction q and radial displacement u_r are constant on rings (`spectral.rings`). Every
ring sticks at first; rings that then violate the friction law change their state, until none does.
No guess of the zones is needed. Without elastic coupling this is a strictly convex problem, and its
solution is always reached. The rings around the boundaries of zones are then split, and the states
found again.

alpha, beta, kappa and f are the compliances, the coupling and the friction of docs/theory, in
`Parameters`. The logit of a radius s, over that of the contact, is ``ln(s**2/(1 - s**2))``.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from math import inf, pi

import numpy as np
from numpy.typing import NDArray

from spectral_contact.contact.layout import Layout
from spectral_contact.contact.resolution import EPSILON_DEPTH
from spectral_contact.contact.tuning import (
    FIRST_RINGS,
    MAX_RING_WIDTH,
    MAX_STEPS,
    RING_GRADING,
    RING_PATIENCE,
    RINGS_PER_SPLIT,
)
from spectral_contact.fields.series import Array
from spectral_contact.spectral.parameters import Parameters
from spectral_contact.spectral.rings import RingOperators, graded_rings, ring_operators

Integers = NDArray[np.int_]


class RingSystem:
    """The equations of pressure and traction on rings, integrated over the rings.

    Parameters
    ----------
    rings : RingOperators
    parameters : Parameters
    coupled : bool
        Whether the traction acts on the pressure: with elastic coupling. That the pressure acts on
        the traction is part of the equations in any case.
    frozen : ndarray, shape (rings,), optional
        The displacement of each ring if it sticks, for unit load; by default zero.

    Attributes
    ----------
    friction : float
    self_compliance : ndarray, shape (rings,)
        Displacement of each ring by a traction of 1 on this ring alone.
    """

    def __init__(
        self,
        rings: RingOperators,
        parameters: Parameters,
        *,
        coupled: bool,
        frozen: Array | float = 0.0,
    ) -> None:
        self.rings = rings
        self.friction = parameters.friction
        self.frozen = np.zeros(len(rings.mass)) + frozen
        mass = np.diag(rings.mass)
        self._normal = rings.normal + parameters.alpha * mass
        self._tangential = rings.tangential + parameters.beta * mass
        self._coupling = parameters.kappa * rings.coupling
        #: from the traction to the normal displacement
        self._reaction = self._coupling.T * coupled
        #: from the pressure to what the traction of a ring that sticks is to balance; the frozen
        #: displacement is that for unit load, and the load of a pressure is a row
        self._loading = self._coupling + np.outer(rings.mass * self.frozen, 2.0 * pi * rings.mass)
        self.self_compliance: Array = self._tangential.diagonal() / rings.mass

    def solve(self, states: Integers) -> RingState:
        """Return p, q and u_r for these states, scaled to unit load.

        The unknowns are the pressures of all rings and the tractions of those that stick, for unit
        approach.
        """
        mass = self.rings.mass
        sticking = np.flatnonzero(states == 0)
        # q/p of the rings that slip
        ratio = np.zeros(len(states))
        ratio[states != 0] = self.friction * states[states != 0]
        n = len(states)
        matrix = np.empty((n + len(sticking), n + len(sticking)))
        matrix[:n, :n] = self._normal - self._reaction * ratio
        matrix[:n, n:] = -self._reaction[:, sticking]
        matrix[n:, :n] = (self._tangential * ratio - self._loading)[sticking]
        matrix[n:, n:] = self._tangential[np.ix_(sticking, sticking)]
        # entries grow with the areas of rings: the displacement of a ring by itself is scaled to 1
        diagonal = np.append(self._normal.diagonal(), self._tangential.diagonal()[sticking])
        scale = 1.0 / np.sqrt(diagonal)
        matrix *= scale
        matrix *= scale[:, None]
        right = np.append(mass, np.zeros(len(sticking)))
        unknowns = scale * np.linalg.solve(matrix, scale * right)
        p = unknowns[:n]
        q = ratio * p
        q[sticking] = unknowns[n:]
        load = 2.0 * pi * float(p @ mass)
        p = p / load
        q = q / load
        displacement = (self._tangential @ q - self._coupling @ p) / mass
        displacement[sticking] = self.frozen[sticking]
        return RingState(self, states, 1.0 / load, p, q, displacement)


@dataclass(frozen=True, slots=True, eq=False)
class RingState:
    """The solution for given states of rings, for unit load.

    Attributes
    ----------
    system : RingSystem
    states : ndarray of int, shape (rings,)
        0 for stick, +1 or -1 for slip with ``q = +f p`` or ``q = -f p``.
    approach : float
        delta of docs/theory.
    pressure, traction, displacement : ndarray, shape (rings,)
        p, q and u_r: the mean of each over the area of a ring.
    """

    system: RingSystem
    states: Integers
    approach: float
    pressure: Array
    traction: Array
    displacement: Array

    @property
    def friction_limit(self) -> Array:
        """The largest traction ``f |p|`` that friction allows on each ring."""
        return np.asarray(self.system.friction * np.abs(self.pressure))

    @property
    def holding_traction(self) -> Array:
        """The traction with which a ring would stick if those of the others did not change.

        In contrast to the traction it has no kink at a boundary between stick and slip.
        """
        return (
            self.traction - (self.displacement - self.system.frozen) / self.system.self_compliance
        )

    @property
    def margin(self) -> Array:
        """One minus the modulus of the holding traction over ``f p``.

        If the friction law holds, it is positive on rings that stick and negative on those that
        slip, and its modulus says how far a ring is from the other state.
        """
        with np.errstate(divide="ignore", over="ignore"):
            return np.asarray(1.0 - np.abs(self.holding_traction) / self.friction_limit)

    @property
    def pressure_is_positive(self) -> bool:
        """Whether the pressure is positive on all rings.

        It need not be. With elastic coupling, thin layers in full stick may pull at the edge; and
        where ``kappa f`` is about 1 or more, pressures oscillate on the widest rings.
        """
        return bool((self.pressure > 0.0).all())

    def states_by_law(self) -> Integers:
        """Return the states by the friction law: a ring slips if its holding traction exceeds f p.

        From the first ring outward on which the pressure is not positive, all rings slip with the
        state +1, and the law is not verified: p and q oscillate there as long as zones nearer the
        centre are wrong.
        """
        if self.system.friction == inf:
            return np.zeros_like(self.states)
        holding = self.holding_traction
        states = np.where(np.abs(holding) > self.friction_limit, np.sign(holding).astype(int), 0)
        pulling = np.flatnonzero(self.pressure <= 0.0)
        if len(pulling):
            states[pulling[0] :] = 1
        return states


def solve_active_set(system: RingSystem, states: Integers) -> RingState:
    """Change states until all obey the friction law; return the solution for the last ones.

    All wrong rings change at once. If their number has not fallen in RING_PATIENCE rounds, only the
    outermost of them changes in each, until it falls: so a positive definite problem is solved
    after finitely many changes (Judice and Pires, 1994).
    """
    fewest = len(states) + 1
    patience = RING_PATIENCE
    for _ in range(MAX_STEPS):
        state = system.solve(states)
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
    """Zones, and the solution on rings that they follow from.

    Attributes
    ----------
    zones : Layout
        Their states, and the boundaries between them, interpolated between rings. The first state
        is not 0 where the stick disk is inside the first ring. After a split, a zone of fewer rings
        than `RINGS_PER_SPLIT` between two others is left out.
    ring_state : RingState
        The solution on the last grid.
    """

    zones: Layout
    ring_state: RingState

    @property
    def converged(self) -> bool:
        """Whether the law holds on every ring inside the first one without a positive pressure."""
        return bool((self.ring_state.states_by_law() == self.ring_state.states).all())

    @property
    def centre_unresolved(self) -> bool:
        """Whether the stick disk, which friction always leaves, is inside the first ring."""
        return self.zones.states[0] != 0


def ring_layout(
    parameters: Parameters,
    *,
    coupled: bool,
    first_rings: int = FIRST_RINGS,
    splits: int = 2,
    unloaded_to: float = 1.0,
) -> RingLayout:
    """Return the zones by the friction law on rings.

    Parameters
    ----------
    parameters : Parameters
        Infinite friction is full stick.
    coupled : bool
        Whether the traction acts on the pressure.
    first_rings : int
        Number of rings of the first grid, without those that are added next to the centre and the
        edge.
    splits : int
        How often the rings around boundaries are split.
    unloaded_to : float
        The load over the largest load there was before, without coupling. Below 1 what sticks has
        the displacement of before. Rings are split around the boundaries at the largest load.
    """

    def solved(logits: Array, states: Integers, *, coupled: bool = coupled) -> RingState:
        system = RingSystem(ring_operators(logits), parameters, coupled=coupled)
        return solve_active_set(system, states)

    logits = graded_rings(first_rings, RING_GRADING, MAX_RING_WIDTH, -EPSILON_DEPTH, EPSILON_DEPTH)
    states = np.zeros(len(logits) - 1, dtype=int)
    if coupled:
        # on smooth surfaces coupled full stick oscillates: begin with the states without coupling
        states = solved(logits, states, coupled=False).states
    ring_state = solved(logits, states)
    for _ in range(splits):
        ring_state = solved(*_split(ring_state))
    if unloaded_to < 1.0:
        system = RingSystem(
            ring_state.system.rings,
            parameters,
            coupled=False,
            frozen=ring_state.displacement / unloaded_to,
        )
        ring_state = solve_active_set(system, np.zeros_like(ring_state.states))
    zone_states = _without_spurious_zones(ring_state.states) if splits else ring_state.states
    last_rings, boundaries = _boundaries(replace(ring_state, states=zone_states))
    states_outward = zone_states[np.append(last_rings, -1)]
    zones = Layout(tuple(boundaries.tolist()), tuple(states_outward.tolist()))
    return RingLayout(zones, ring_state)


def _without_spurious_zones(states: Integers) -> Integers:
    """Return the states of rings, with narrow zones between two others joined to the inner one.

    Zones of fewer rings than one is split into are an error of the rings, which is largest where
    wide rings meet narrow ones: a third of random scenes near an onset had up to three rings that
    stick amid slip, or slip amid stick.
    """
    merged = states.copy()
    starts = (np.flatnonzero(np.diff(states)) + 1).tolist()
    for start, end in pairwise(starts):
        if end - start < RINGS_PER_SPLIT:
            merged[start:end] = merged[start - 1]
    return merged


def _boundaries(state: RingState) -> tuple[Integers, Array]:
    """Return the last ring of every zone but the outermost, and the logits where the zones end.

    A zone ends where the margin, interpolated linearly between the middles of two rings, is zero.
    If it does not change its sign there, the zone ends at the boundary of the rings.
    """
    last = np.flatnonzero(np.diff(state.states))
    middles = state.system.rings.middles
    margin_inside = state.margin[last]
    margin_outside = state.margin[last + 1]
    with np.errstate(divide="ignore", invalid="ignore"):
        fraction = margin_inside / (margin_inside - margin_outside)
    zero = middles[last] + fraction * (middles[last + 1] - middles[last])
    changes_sign = (fraction > 0.0) & (fraction < 1.0)
    return last, np.where(changes_sign, zero, state.system.rings.logits[last + 1])


def _split(state: RingState) -> tuple[Array, Integers]:
    """Return a grid with smaller rings around boundaries, and the states of its rings."""
    logits = state.system.rings.logits
    count = len(state.states)
    last, _ = _boundaries(state)
    # the two rings on either side
    to_split = [last + 1 + k for k in range(-2, 2)]
    if state.states[0] != 0:  # the stick disk is smaller than the first ring
        to_split.append(np.array([0]))
    marked = np.unique(np.clip(np.concatenate(to_split), 0, count - 1))
    lower = logits[marked]
    upper = logits[marked + 1]
    # the first ring and the last one are infinite in the logit: only a part of them is split
    logit_span = RINGS_PER_SPLIT * MAX_RING_WIDTH
    lower = np.where(np.isinf(lower), upper - logit_span, lower)
    upper = np.where(np.isinf(upper), lower + logit_span, upper)
    fractions = np.arange(1, RINGS_PER_SPLIT) / RINGS_PER_SPLIT
    new_logits = lower + np.outer(fractions, upper - lower)
    parts = np.ones(count, dtype=int)
    parts[marked] = RINGS_PER_SPLIT
    return np.sort(np.concatenate([logits, new_logits.ravel()])), np.repeat(state.states, parts)
