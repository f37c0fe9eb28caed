"""Elastic coupling with any zones of stick and slip: their boundaries are solved for.

Pressure and traction are unknown together. At given boundaries the system is linear in the lifts,
the values there of what the half-integral of the traction lacks. Continuity gives them, and that
each is what the fields make it is the condition of its boundary.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf, pi

import numpy as np
from numpy.typing import NDArray

from spectral_contact.contact.boundaries import (
    NoBoundariesError,
    differences,
    longest,
    zones_error,
)
from spectral_contact.contact.corrections import LEFT, Move, Pace
from spectral_contact.contact.coupled_errors import field_errors, shares_of, sizes_of
from spectral_contact.contact.coupled_outcome import Solved
from spectral_contact.contact.coupled_parts import (
    joined,
    parted,
)
from spectral_contact.contact.coupled_spaces import first_spaces
from spectral_contact.contact.coupled_state import CoupledState, Effect
from spectral_contact.contact.layout import Layout
from spectral_contact.contact.refine import Attempt, Resolution
from spectral_contact.contact.resolution import (
    LEAST_RATE,
    ROUNDING,
    SAFETY,
    TRACTION_ROUNDING,
    boundary_error,
    series_of,
)
from spectral_contact.contact.slip_displacement import Stuck, largest_displacement
from spectral_contact.contact.stick_radius import root_near
from spectral_contact.fields.series import EDGE, Radius
from spectral_contact.spectral.annulus import Points
from spectral_contact.spectral.factored import Factored, Symmetric, factored
from spectral_contact.spectral.parameters import Parameters
from spectral_contact.spectral.system import System

__all__ = ["ROUGH", "UNFELT", "CoupledProblem", "CoupledZones"]

Array = NDArray[np.float64]

#: The logit of a stick disk too small to be felt, with 1e-17 of the load on it.
UNFELT = -40.0
#: Tolerance of the spaces in which boundaries are found first, and are looked at by the way.
ROUGH, _PROBE = 1e-3, 1e-2
#: How short the last step of the boundaries is in the first.
_SETTLED = 1e-3
#: A first guess of how fast the condition of one stick disk rises with its logit.
_SLOPE = 0.3
#: Where more of a step is left, of the narrowest zone, there are no such boundaries.
_LOST = 0.1
#: At the edge nothing happens in less than this of the layer.
_NARROWEST = 1e-12
#: A step as short as this is not taken, and one as short as that says nothing of slopes.
_ENOUGH, _MEANT = 1e-13, 1e-8
#: How far boundaries may move, of the narrowest zone, before their slopes are found anew.
_STALE = 0.1
#: Most corrections at given boundaries, and with boundaries that move.
_CORRECTIONS, _STEPS = 10, 40
#: How far the boundaries of factors may be, of a zone, in thick layers and in thin ones.
_FAR, _FAR_THIN, _THICK = 0.03, 1e-4, 1e-2
#: What of a step of the boundaries the fields may be off by, for that step and for its slopes.
_SHARE, _KNOWN = 0.3, 0.03
#: Compliances from which on corrections with factors in single precision are not more.
_SINGLE = 5e-7
#: What corrections should leave, of the tolerance, as boundaries are known better than the fields.
_FURTHER, _LEAST = 1e-3, 5e-15
#: Where all sticks q/s rounds by so much more at the centre, where it is weakly determined.
_CENTRE = 5.0
#: What rounding leaves of a pressure; and of approach and shear, with boundaries and without.
_PRESSURE_ROUNDING = 20.0 * ROUNDING
_NOISE, _STUCK_NOISE = 40.0 * ROUNDING, 2.0 * ROUNDING
#: A correction that is smaller and does not fall any more is rounding.
_ROUNDED = 1e-9


@dataclass(frozen=True, slots=True)
class CoupledZones(Solved):
    """Coupled partial slip on any zones, for unit load.

    Attributes
    ----------
    system : System
    solution : ndarray, shape (unknowns, 3)
        The vector of the system, and what the top two degrees and the top one contribute to it.
    """

    system: System
    solution: Array


class CoupledProblem:
    """Spaces for given states of the zones; the boundaries are found anew in each of them.

    Parameters
    ----------
    parameters : Parameters
    layout : Layout
    tolerance : float
        Bound on the relative errors of both fields, pointwise.
    pointwise : bool
        Whether it is that; else it bounds approach and shear, which err like its square.
    """

    def __init__(
        self, parameters: Parameters, layout: Layout, tolerance: float, *, pointwise: bool = True
    ) -> None:
        self.parameters, self.pointwise = parameters, pointwise
        self.goal = tolerance
        self.tolerance = tolerance if pointwise else float(np.sqrt(tolerance))
        self.states = layout.states
        self.logits = np.array(layout.logits)
        self._slopes = layout.slopes if layout.logits else np.zeros((0, 0))

    @property
    def layout(self) -> Layout:
        """The boundaries as they are known, with the slopes of their conditions."""
        slopes = self.slopes  # boundaries are found with them
        return Layout(tuple(self.logits.tolist()), self.states, slopes)

    @property
    def slopes(self) -> Array:
        """By how much the conditions rise with the boundaries, as logits."""
        if self._slopes is None:
            self._look_near()
        assert self._slopes is not None
        return self._slopes

    def _look_near(self) -> None:
        """Find the boundaries roughly, and the slopes of their conditions."""
        if len(self.logits) == 1:

            def mismatch(logit: float) -> float:
                return float(self.rough([logit]).mismatch[0])

            start = float(self.logits[0])
            logit, slope = root_near(mismatch, start, _SLOPE, _SETTLED, 1.0, UNFELT)
            self.logits, self._slopes = np.array([logit]), np.array([[slope]])
            return
        begin = self.logits
        self._slopes = self._differences()
        spaces = self._spaces(ROUGH)
        state = self._found(spaces, ROUGH, _SETTLED)
        narrowest = self._narrowest
        left = np.abs(np.linalg.solve(self._slopes, state.mismatch))
        if not float(left.max()) < _LOST * narrowest:
            raise NoBoundariesError("no such boundaries are found")
        if float(np.abs(self.logits - begin).max()) > _STALE * narrowest:
            self._slopes = self._differences()

    def rough(self, logits: Sequence[float]) -> CoupledState:
        """Return the contact with given boundaries, as logits, in a small space."""
        at = np.array(logits)
        system = self._system(self._spaces(_PROBE, at), at)
        return self._settled(self._factored(system), 1e-2 * _PROBE)

    def _differences(self) -> Array:
        """Return the slopes of the conditions in a small space."""
        spaces = self._spaces(ROUGH)

        def conditions(logits: Array) -> Array:
            factored = self._factored(self._system(spaces, logits))
            return self._settled(factored, 1e-2 * ROUGH).mismatch

        return differences(conditions, self.logits)

    # spaces

    def _spaces(self, tolerance: float, logits: Array | None = None) -> list[Resolution]:
        alpha, beta, _, _ = self.parameters
        radii = _radii(self.logits if logits is None else logits)
        return first_spaces(alpha, beta, radii, self.states, tolerance)

    def start(self) -> Resolution:
        """Return the first space, of all parts one after the other."""
        # boundaries superconverge: a space for half the digits has nearly all of theirs
        halfway = np.sqrt(self.tolerance)
        if len(self.slopes) and halfway < 0.1 * ROUGH:
            self._found(self._spaces(halfway), halfway, max(self.tolerance, _ENOUGH))
        spaces = self._spaces(self.tolerance)
        self._counts = [one.panels.panels for one in spaces]
        return joined(spaces)

    def _system(self, spaces: list[Resolution], logits: Array) -> System:
        radii = _radii(logits)
        narrowest = _NARROWEST * self.parameters.alpha
        if len(radii) > 1 and radii[-1].rest < narrowest:
            raise NoBoundariesError("the last zone vanishes")
        panels, degrees = [one.panels for one in spaces], [one.degrees for one in spaces]
        return System(radii, self.states, panels, degrees, self.parameters)

    def _factored(self, system: System) -> Factored:
        alpha, beta, _, _ = self.parameters
        thick = alpha >= _SINGLE and (beta == 0.0 or beta >= _SINGLE)
        return factored(system, exact=not thick)

    # solutions

    def _settled(self, factored: Factored, aim: float) -> CoupledState:
        """Correct a solution at given boundaries as far as is aimed."""
        state, size = CoupledState.begin(factored.system, factored), inf
        for _ in range(_CORRECTIONS):
            state, change = state.corrected()
            before, size = size, self._size(state, change)
            if size * max(LEFT, min(size / before, 1.0)) < aim or size > before:
                break
        return state

    def _size(self, state: CoupledState, change: Array) -> float:
        """Return the largest share of a change."""
        shares = shares_of(state.system, change, sizes_of(state.system, state.solution))
        return max(float(one.max()) for pair in shares for one in pair)

    def _found(self, spaces: list[Resolution], aim: float, settle: float) -> CoupledState:
        """Correct fields and boundaries together, until neither moves any more.

        The boundaries move when more is left of them than the fields may be off. Factors serve as
        long as corrections with them shrink.
        """
        factors = self._factored(self._system(spaces, self.logits))
        state, begin = CoupledState.begin(factors.system, factors), self.logits
        self.left = self.off = 0.0
        moved: Move | None = None
        pace = Pace(self._thinnest)
        for _ in range(_STEPS):
            state, change = state.corrected()
            pace.add(self._size(state, change), self._drift(begin))
            self.left = pace.left
            if moved is not None and self.left < _KNOWN * moved.length:
                self._learn(moved, state.mismatch)
                moved = None
            step: Array = -np.linalg.solve(self.slopes, state.mismatch).astype(float)
            self.off = float(np.abs(step).max(initial=0.0))
            own, slow = factors.system is state.system, pace.slow
            best = own and factors.exact  # no other factors are better
            rounded = slow and (best or (pace.size < _ROUNDED and self.off < settle))
            if rounded or (self.left < aim and self.off < settle):
                break
            if self.off > max(0.5 * settle, self.left / _SHARE):
                step *= min(1.0, longest(self.logits, step))
                moved = Move(step, float(np.abs(step).max()), state.mismatch)
                self.logits = self.logits + step
                state, pace.alike = state.at(self._system(spaces, self.logits)), 0
                slow = self._drift(begin) > self._far
            if slow:
                factors = factored(state.system, exact=factors.exact or (own and pace.alike > 0))
                state, begin, pace.alike = state.by(factors), self.logits, 0
        return state

    def _drift(self, begin: Array) -> float:
        """Return how far boundaries are from others, of the narrowest zone."""
        return float(np.abs(self.logits - begin).max(initial=0.0)) / self._narrowest

    @property
    def _far(self) -> float:
        return _FAR if self._thinnest > _THICK else _FAR_THIN

    @property
    def _thinnest(self) -> float:
        return min(1.0, *self.parameters[:2])

    @property
    def _narrowest(self) -> float:
        return float(min([1.0, *np.diff(self.logits)]))

    def _learn(self, move: Move, mismatch: Array) -> None:
        """Take from a step what it shows of the slopes (Broyden)."""
        if move.length > _MEANT:
            missed = mismatch - move.mismatch - self.slopes @ move.step
            self._slopes = self.slopes + np.outer(missed, move.step) / float(move.step @ move.step)

    # outcome

    def attempt(self, resolution: Resolution) -> Attempt[CoupledZones]:
        """Solve in a space."""
        spaces = parted(resolution, self._counts, self.parameters.alpha)
        aim, settle = max(_FURTHER * self.goal, _LEAST), max(0.01 * self.goal, _ENOUGH)
        state = self._found(spaces, aim, settle)
        return self._assess(spaces, state)

    def _assess(self, spaces: list[Resolution], state: CoupledState) -> Attempt[CoupledZones]:
        """Turn the final trial into a solution with its errors."""
        if not np.isfinite(state.solution).all():
            raise NoBoundariesError("the system has no solution that is finite")
        system, effects = state.system, state.effects()
        whole = state.solution * state.approach
        moved = [state.approach * one.change for one in effects]
        # what the boundaries still are off is felt everywhere
        inverse = np.abs(np.linalg.inv(self.slopes))
        off = 2.0 * float((inverse @ np.abs(state.mismatch)).max(initial=0.0))
        fields = field_errors(spaces, system, whole, moved[0])
        left = self.left + off
        rounding = 1.0 if system.radii else _CENTRE
        pressure_error = fields.pressure + left + _PRESSURE_ROUNDING
        traction_error = fields.traction + left + rounding * TRACTION_ROUNDING
        error = max(pressure_error, traction_error)
        # what superconverges may change little by accident, but hardly against the square
        squared = (float(fields.indicators.max()) + left + TRACTION_ROUNDING) ** 2
        noise = (_NOISE if system.radii else _STUCK_NOISE) + self.left * 1e-2
        known = squared + noise + off
        shifts = inverse @ self._missed(state, effects, squared + noise)
        shifts += float(np.finfo(float).eps) * np.abs(self.logits)
        bend = 2.0 * max(
            (float(d) ** 2 * r.rest for d, r in zip(shifts, system.radii, strict=True)), default=0.0
        )
        total = system.total_shear(whole)
        sheared = max(abs(system.total_shear(one)) for one in moved) / abs(total)
        boundary_errors = tuple(
            boundary_error(float(d), r) for d, r in zip(shifts, system.radii, strict=True)
        )
        stuck, stray = self._displacements(state, moved[0], effects[0].lifts)
        pressure, shear = system.split(whole)
        value = CoupledZones(
            system.radii,
            system.states,
            state.approach,
            total,
            [series_of(p.family.panels, c) for p, c in zip(system.parts, pressure, strict=True)],
            [
                series_of(p.shear.panels, shear[k]) if k in shear else None
                for k, p in enumerate(system.parts)
            ],
            stuck,
            max(abs(one.approach) for one in effects) + known,
            sheared + known + bend,
            pressure_error,
            traction_error,
            max((one[0] for one in boundary_errors[:1]), default=0.0),
            zones_error(system.radii, boundary_errors),
            stray,
            system,
            np.column_stack([whole, *moved]),
        )
        # no degree lowers what rounding leaves
        fields.indicators[fields.indicators <= self.left] = 0.0
        attempt = Attempt(value, error, fields.indicators, fields.rates, system.unknowns)
        return self._by_energies(attempt, state, noise) if system.symmetric else attempt

    def _by_energies(
        self, attempt: Attempt[CoupledZones], state: CoupledState, noise: float
    ) -> Attempt[CoupledZones]:
        """Return full stick with the errors of approach and shear as energies of changes.

        That of the shear is a product with its dual: no accident makes either small.
        """
        factors, system, rates = state.factored, state.system, attempt.rates**2
        assert isinstance(factors, Symmetric)
        own = factors.energies(state.solution)
        dual = factors.energies(factors.step(system.shear_functional))
        raised = own.sum(axis=0) / state.bearing(state.solution)
        products = np.sqrt(own * dual).sum(axis=0)
        sheared = products / abs(system.total_shear(state.solution))
        errors = [float(one[:-1] @ rates + one[-1]) + noise for one in (raised, sheared)]
        value = replace(
            attempt.value, approach_error=errors[0], shear_error=sum(errors) + _STUCK_NOISE
        )
        attempt = replace(attempt, value=value)
        if self.pointwise:
            return attempt
        error, indicators = max(value.approach_error, value.shear_error), raised + sheared
        return replace(attempt, error=error, indicators=indicators[:-1], rates=rates)

    def _displacements(
        self, state: CoupledState, change: Array, lifts: Array
    ) -> tuple[list[Stuck], float]:
        """Return what the slip zones see of E in stick, and the most that a change makes there."""
        system, scale = state.system, state.approach
        if not any(system.states):
            return [], 0.0
        whole = state.lacking(scale * state.solution, scale, scale * state.lifts)
        lost = self._stuck(system, state.lacking(change, 0.0, scale * lifts))
        return self._stuck(system, whole), SAFETY * self._largest_displacement(system, lost)

    def _missed(self, state: CoupledState, effects: list[Effect], noise: float) -> Array:
        """Return what the conditions of the boundaries may miss."""
        kept = 2.0 * SAFETY * LEAST_RATE
        missed = kept * np.max([np.abs(one.mismatch) for one in effects], axis=0)
        return np.asarray(missed + noise + self.left + 2.0 * np.abs(state.mismatch))

    @staticmethod
    def _stuck(system: System, misfit: Sequence[Array | None]) -> list[Stuck]:
        """Return the quadrature of ``t^2 E dt`` over the stick zones."""
        stuck = []
        for zone, state in enumerate(system.states):
            if state == 0:
                each = zip(system.parts, system.offsets, system.shear_weights, misfit, strict=True)
                parts = tuple(
                    (Points(part.family.boundary, offsets), pi * weights * missed)
                    for part, offsets, weights, missed in each
                    if part.zone == zone and missed is not None
                )
                stuck.append(Stuck((*system.radii, EDGE)[zone], parts))
        return stuck

    @staticmethod
    def _largest_displacement(system: System, stuck: list[Stuck]) -> float:
        """Return the largest displacement in the slip zones that E in the stick zones makes."""
        bounds = (*system.radii, EDGE)
        return max(
            largest_displacement(stuck, bounds[k - 1], bounds[k])
            for k, state in enumerate(system.states)
            if state != 0
        )


def _radii(logits: Array) -> tuple[Radius, ...]:
    return tuple(Radius.from_logit(float(x)) for x in logits)
