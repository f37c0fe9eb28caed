"""Newton's method for fields and boundaries, with factors and slopes that serve for a while."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import inf, pi
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from spectral_contact.contact.layout import NoBoundariesError
from spectral_contact.contact.resolution import LEFT, ROUGH, TINY, TRIFLING
from spectral_contact.contact.stick_radius import NOISE
from spectral_contact.fields.series import Array
from spectral_contact.spectral.panels import Resolution
from spectral_contact.spectral.parts import gap
from spectral_contact.threads import cached_property

if TYPE_CHECKING:
    from spectral_contact.contact.zone_problem import FreeBoundaryProblem
    from spectral_contact.spectral.contact_system import ContactSystem
    from spectral_contact.spectral.factored import Factored


class Effect(NamedTuple):
    """What a change of the space does at unit load.

    Attributes
    ----------
    change, imbalance : ndarray
        Of the solution and of its imbalances.
    mismatch : ndarray
        Of the conditions of the boundaries.
    approach : float
        Of the approach, relative.
    """

    change: Array
    imbalance: Array
    mismatch: Array
    approach: float


#: Where slopes are taken from fields, as multiples, and from those at both the one at the boundary:
#: 100 scenes of a sweep take 271 systems, 318 with slopes from secants alone.
_BESIDE, _TO_BOUNDARY = np.array([0, 1, 4]), np.array([4, -1]) / 3
#: In units of the zones, where they are taken if q changes by no more than rounding nearer by: over
#: all of a zone. Slopes at an annulus of 2e-13 are right to 1e-3, those nearer by off by a factor.
_FARTHER = 1.0 / float(_BESIDE.max())


@dataclass(eq=False)
class ZoneState:
    """The solution for unit approach with a continuous traction.

    Parameters
    ----------
    system : System
    factored : Factored
        Of this system or a like one.
    solution : ndarray, shape (unknowns,)
    imbalance : ndarray, shape (boundaries,)
        They make the traction continuous, or with no tangential compliance E zero.
    """

    system: ContactSystem
    factored: Factored
    solution: Array
    imbalance: Array

    @classmethod
    def begin(cls, factored: Factored, system: ContactSystem | None = None) -> ZoneState:
        """Return a first solution, to be corrected.

        Of the system that is factored, or of one with the same matrix.
        """
        own = system or factored.system
        state = cls(own, factored, factored.first[:, 0], np.zeros(len(own.radii)))
        state.imbalance, state.solution = state._continuous(state.solution)
        return state

    def _continuous(self, values: Array) -> tuple[Array, Array]:
        """Return the imbalances that take the jumps out of a vector, and what they make of it."""
        jumps = self.system.jump_rows
        if self.system.parameters.beta == 0.0 or not len(jumps):
            return -self.system.boundary_rows.shortfall @ values, values
        responses = self.factored.responses
        felt, missed = jumps @ responses, jumps @ values
        imbalance = -missed / felt[0] if len(felt) == 1 else -np.linalg.solve(felt, missed)
        return np.asarray(imbalance), np.asarray(values + responses @ imbalance)

    def corrected(self) -> tuple[ZoneState, Array]:
        """Return a better solution, and by how much it is changed."""
        missed = self.system.residual(self.solution[:, None], np.ones(1), self.imbalance[:, None])
        step = self.factored.step(missed)[:, 0]
        imbalance, solution = self._continuous(self.solution + step)
        if self.system.parameters.beta > 0.0:
            imbalance = self.imbalance + imbalance
        return replace(self, solution=solution, imbalance=imbalance), solution - self.solution

    @staticmethod
    def extrapolated(
        states: Sequence[ZoneState], weights: Sequence[float], system: ContactSystem
    ) -> ZoneState:
        """Return that of a system as a sum of states; of changes it has what the last one has."""
        each, solution = list(zip(weights, states, strict=True)), states[-1].solution.copy()
        solution[system.pressure_terms :] = sum(
            w * one.solution[one.system.pressure_terms :] for w, one in each
        )
        imbalance = np.asarray(sum(w * one.imbalance for w, one in each))
        return replace(states[-1], system=system, solution=solution, imbalance=imbalance)

    def bearing(self, values: Array) -> float:
        """Return ``int p s ds``."""
        return float(self.system.load_row @ values[: self.system.pressure_terms])

    @cached_property
    def approach(self) -> float:
        """The approach of unit load."""
        return 1.0 / (2.0 * pi * self.bearing(self.solution))

    @cached_property
    def mismatch(self) -> Array:
        """What the conditions of the boundaries miss, relative to ``kappa R`` there."""
        return np.asarray(-self.imbalance / self._demanded)

    @property
    def _demanded(self) -> Array:
        """``kappa R`` at the boundaries."""
        return np.asarray(self.system.boundary_rows.drive @ self.solution)

    def slopes(self, near: float) -> Array:
        """Return by how much the mismatch rises with the boundaries, as logits.

        A boundary that is off changes the fields, to first order, there alone: q jumps by its slope
        over that of friction. Imbalances take the jumps out. The slopes are taken `near` the
        boundaries, in units of the zones there.
        """
        system, (pressure, shear) = self.system, self.system.series(self.solution)
        jumps = np.zeros(len(system.radii))
        for k in (k for k in system.stick_parts if system.parts[k].boundary >= 0):
            own, j = system.parts[k].family, system.parts[k].boundary
            b = own.boundary
            narrower = min(gap(*pair) for pair in pairwise(system.bounds[j : j + 3]))
            friction = sum(system.states[j : j + 2]) * system.parameters.friction
            for share in (near, _FARTHER):
                d = share * min(narrower / own.reach, 1.0) * _BESIDE
                at = own.points(d)
                p = pressure[k](d)
                q = np.sqrt(at.z) * shear[k](d)
                excess = q - friction * p
                rises = (excess[1:] - excess[0]) / at.offset[1:]
                if abs(excess[1] - excess[0]) > NOISE * abs(q[0]):
                    break
            jumps[j] = _TO_BOUNDARY @ rises * b.square * b.rest
        felt = np.linalg.inv(system.jump_rows @ self.factored.responses)
        return np.asarray(felt * jumps / self._demanded[:, None])

    def unbalanced(self, share: float) -> Effect:
        """Return what would meet so much of the conditions, with a jump of the traction there.

        But for the square of what the boundaries are off it is the error of the fields.
        """
        imbalance = -share * self.imbalance
        return self._at_unit_load(imbalance, self.factored.responses @ imbalance)

    def effects(self) -> list[Effect]:
        """Return what the top two degrees of every panel contribute, and what the top one does."""
        changes = self.factored.change(self.solution, self.system)
        return [self._at_unit_load(*self._continuous(one)) for one in changes]

    def _at_unit_load(self, imbalance: Array, change: Array) -> Effect:
        raised = -self.bearing(change) / self.bearing(self.solution)
        return Effect(
            change + raised * self.solution,
            imbalance + raised * self.imbalance,
            -imbalance / self._demanded,
            raised,
        )


#: From which share of the last step on, or of the fields, it is the factor or rounding that is not
#: good enough: 0.05 and 0.6 change no digit of 53 scenes. And most corrections.
_SLOW, _STEPS = 0.2, 40
#: First corrections, which do not tell how good the factors are; and what those of other boundaries
#: leave, over their distance: with 0.3 and 20 no error of 53 scenes is above estimates.
_FIRST, _DRIFT = 1, 3.0
#: What of a step of the boundaries the fields may be off by for its slopes, for the step itself it
#: is TRIFLING: a scene of a sweep takes 3.1 systems, 4.5 with 0.3 for the step and 0.03. And
#: conditions that miss as little as the last say nothing of slopes: with 1e-14 one of 53 scenes has
#: a boundary off by more than its estimate, with 1e-8 another one.
_KNOWN, _MEANT = 0.003, 1e-11
#: A step that is more than so much of the one before does not show that they become shorter.
_SHRINKS = 0.5
#: Where boundaries are near by at most so many steps in a row do not become shorter. Next to the
#: second threshold with coupling 2 refuse 6 of 24 scenes and tolerances, 4 one, 8 none.
_MOST_STALLED = 6
#: By how much conditions rise with most boundaries. Next to the second threshold with coupling six
#: solves take 330 systems, 390 with 0.03, 510 without it; 0.5 makes others slower.
_STEEP = 0.1
#: A smaller correction that does not fall is rounding; 1e-6 and 1e-12 change no digit of 25 scenes.
_ROUNDED = 1e-9
#: Steps point in different ways if their smallest singular value is so much of the largest one.
_LEAST_ANGLE = 0.03


class _Move(NamedTuple):
    """A step of the boundaries, and what their conditions missed before it."""

    step: Array
    length: float
    mismatch: Array


_NOTHING = _Move(np.zeros(0), 0.0, np.zeros(0))


@dataclass(slots=True, eq=False)
class _Pace:
    """What corrections with the same factors at the same boundaries come to.

    Attributes
    ----------
    thinnest : float
        The least compliance, or 1.
    size, before : float
        Of the last correction and the one before, as the largest share.
    alike : int
        How many there were, but for the first.
    drift : float
        How far the boundaries of the factors are, of the narrowest zone.
    lossy : bool
        Whether factors lose the digits of small coefficients, next to a narrow zone at the edge.
    """

    thinnest: float
    size: float = 1.0
    before: float = 1.0
    alike: int = -_FIRST
    drift: float = 0.0
    lossy: bool = False

    def add(self, size: float, drift: float) -> None:
        """Count another one."""
        self.before, self.size, self.drift = self.size, size, drift
        self.alike += 1
        self.lossy = self.lossy or ((self.alike == 0 or self._astray) and size > _SLOW)

    @property
    def _astray(self) -> bool:
        """Whether the factors are those of other boundaries.

        They are off by about the distance of these, in units of a layer: every odd correction
        makes an error next to the boundaries, which the next one takes back.
        """
        return self.drift > LEFT / _DRIFT * self.thinnest

    @property
    def _telling(self) -> bool:
        return self.alike > 1 + self._astray

    @property
    def slow(self) -> bool:
        """Whether corrections do not shrink as they should."""
        whole = self.before if self._telling else 1.0
        return (self._telling or self._astray) and self.size > _SLOW * whole

    @property
    def left(self) -> float:
        """What the last one leaves."""
        if self._astray and self.alike % 2:
            return self.size
        expected = self.size / self.before if self._telling else 0.0
        return self.size * min(max(LEFT, _DRIFT * self.drift, expected), 1.0)


class ZonesNewton:
    """Corrects fields and boundaries, until neither moves any more.

    The boundaries move when more is left of them than the fields may be off. Factors serve as long
    as corrections with them shrink.

    Parameters
    ----------
    problem : FreeBoundaryProblem
        Its boundaries and their slopes are kept up.
    spaces : list of Resolution
    settle : float
        How short the last step of the boundaries is.
    factors : Factored
        Of these spaces and boundaries.

    Attributes
    ----------
    state : ZoneState
    left : float
        What is left of the fields.
    settled : bool
        Whether the last step of the boundaries is as short as it should be.
    """

    def __init__(
        self,
        problem: FreeBoundaryProblem,
        spaces: list[Resolution],
        settle: float,
        factors: Factored,
    ) -> None:
        self._problem, self._spaces, self._settle = problem, spaces, settle
        self._factors = factors
        self.state = ZoneState.begin(self._factors)
        self.left, self._begin, self._before, self._stalled = 0.0, problem.logits, inf, 0
        self._pace, self._move = _Pace(problem.thinnest), _NOTHING
        self._secants: list[tuple[Array, Array]] = []
        self._least, self._best = inf, (self.state, problem.logits)
        self.settled = False

    def run(self, aim: float) -> ZoneState:
        """Correct until less than an aim is left.

        Raises
        ------
        NoBoundariesError
            If boundaries are said to be near by and are not.
        """
        for _ in range(_STEPS):
            step = self._corrected()
            off = float(np.abs(step).max(initial=0.0))
            self.settled = off < self._settle
            still = self._still(off)
            self._remember(aim)
            own, slow = self._factors.system is self.state.system, self._pace.slow
            # no other factors are better, or what is left is rounding
            ended = own or (self._pace.size < _ROUNDED and still)
            if (slow and ended) or (self.left < aim and still):
                break
            if not still and self._telling(off):
                slow = self._moved(step, off)
            if slow:
                self._factored()
        if self._least < self._missed:  # what is left is rounding, or no boundaries are there
            self.state, self._problem.logits = self._best
        return self.state

    def _still(self, off: float) -> bool:
        """Return whether the boundaries are known no better: steps do not become shorter, twice.

        Once is an accident: with it conditions miss ten times as much at the onset of slip inside.
        """
        rounded = off < _ROUNDED or self._missed < _MEANT
        no_shorter = rounded and off > _SHRINKS * self._before and self._stalled > 0
        return self.settled or no_shorter

    def _telling(self, off: float) -> bool:
        """Return whether the fields are good enough for a step, and more than made from nothing."""
        known = self._pace.alike >= 0 and self.left < 1.0
        return known and off > max(0.5 * self._settle, self._noise / TRIFLING)

    def _remember(self, aim: float) -> None:
        """Keep the best there is, next to the onset of a zone."""
        if self.left < max(aim, NOISE) and self._missed < self._least:
            self._least, self._best = self._missed, (self.state, self._problem.logits)

    @property
    def _missed(self) -> float:
        return float(np.abs(self.state.mismatch).max(initial=0.0))

    @property
    def _noise(self) -> float:
        """What is left makes of a step, if conditions hardly change with the boundaries."""
        flat = float(np.abs(np.linalg.inv(self._problem.slopes)).max(initial=0.0))
        return self.left * max(1.0, _STEEP * flat) if self.left > NOISE else 0.0

    def _corrected(self) -> Array:
        """Correct the fields, learn from the last step, and return the next one."""
        problem = self._problem
        self.state, change = self.state.corrected()
        self._pace.add(problem.size(self.state, change), problem.drift(self._begin))
        self.left = self._pace.left
        if self._pace.alike == 0 and self.left < ROUGH:
            problem.tells(self.state)
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
        self.state = replace(self.state, system=problem.system(self._spaces, problem.logits))
        self._pace.alike = 0
        return problem.drift(self._begin) > problem.far

    def _factored(self) -> None:
        self._factors = type(self._factors)(self.state.system)
        self.state = replace(self.state, factored=self._factors)
        self._begin = self._problem.logits
        self._pace.alike = -1 - _FIRST if self._pace.lossy else 0


def through_secants(slopes: Array, secants: list[tuple[Array, Array]]) -> Array:
    """Return the slopes nearest to these that give the changes by steps: Broyden's update."""
    lengths = [np.linalg.norm(step) for step, _ in secants]
    ways = np.array([step / n for (step, _), n in zip(secants, lengths, strict=True)]).T
    found = np.array([change / n for (_, change), n in zip(secants, lengths, strict=True)]).T
    unseen = found - slopes @ ways
    return np.asarray(slopes + unseen @ np.linalg.pinv(ways, rcond=_LEAST_ANGLE))


def longest(x: Array, step: Array) -> float:
    """Return the factor that keeps the boundaries in order and the step moderate."""
    factor = 2.0 / max(float(np.abs(step).max()), TINY)
    for width, change in zip(np.diff(x), np.diff(step), strict=True):
        if change < 0.0:
            factor = min(factor, 0.5 * width / -change)
    return factor
