"""Elastic coupling with any zones of stick and slip: their boundaries are solved for.

Pressure and traction are unknown together. At given boundaries the system is linear in the lifts,
the values there of what the half-integral of the traction lacks. Continuity gives them, and that
each is what the fields make it is the condition of its boundary.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import inf, pi, sqrt

import numpy as np
from numpy.typing import NDArray

from spectral_contact.adaptive import Attempt, Refinement, Resolution, refine
from spectral_contact.contact.boundaries import (
    Boundaries,
    NoBoundariesError,
    differences,
    find_boundaries,
    zones_error,
)
from spectral_contact.contact.coupled_outcome import Solved
from spectral_contact.contact.coupled_parts import (
    joined,
    leading_depth,
    parted,
    root_error,
    rounding_depth,
)
from spectral_contact.contact.layout import Layout
from spectral_contact.contact.resolution import (
    LEAST_RATE,
    ROUNDING,
    SAFETY,
    TRACTION_ROUNDING,
    boundary_error,
    decay_rates,
    expected_error,
    series_of,
    share_of_change,
)
from spectral_contact.contact.slip_displacement import Stuck, largest_displacement
from spectral_contact.contact.zones_spaces import first_spaces
from spectral_contact.contact.zones_trial import ZonesTrial
from spectral_contact.fields import EDGE, Radius
from spectral_contact.spectral.annulus import Points
from spectral_contact.spectral.parameters import Parameters
from spectral_contact.spectral.sliding_zones import SlidingZones
from spectral_contact.spectral.zones_factored import ZonesFactored

__all__ = ["CoupledZones", "find_coupled_zones", "solve_coupled_zones"]

Array = NDArray[np.float64]

#: Tolerance of the spaces in which boundaries are found first.
_ROUGH = 1e-3
#: How short the last step of the boundaries is in them, and at most in any space.
_SETTLED, _LOOSEST = 1e-4, 1e-7
#: Where more of a step is left, of the narrowest zone, there are no such boundaries.
_LOST = 0.1
#: At the edge nothing happens in less than this of the layer.
_NARROWEST = 1e-12
#: A step as short as this is not taken.
_ENOUGH = 1e-13
#: How far boundaries may move, of the narrowest zone, before their slopes are found anew.
_STALE = 0.1
#: Most corrections, the share of its step that one leaves at least, and from which share on it is
#: the factor or rounding that is not good enough.
_CORRECTIONS, _LEFT, _SLOW = 10, 1e-2, 0.2
#: What corrections should leave, of the tolerance, as boundaries are known better than the fields;
#: and what they may leave with the factors of other boundaries.
_FURTHER, _ENOUGH_LEFT = 1e-6, 1e-2
#: A correction that is smaller and does not fall any more is rounding.
_ROUNDED = 1e-9


@dataclass(frozen=True, slots=True)
class CoupledZones(Solved):
    """Coupled partial slip on any zones, for unit load.

    Attributes
    ----------
    zones : SlidingZones
        The operators.
    driven, sheared : list of ndarray
        Coefficients of p and of q/s on every part, and what the top two degrees contribute to
        them, as columns.
    """

    zones: SlidingZones
    driven: list[Array]
    sheared: list[Array]


class _CoupledZonesProblem:
    """Spaces for given states of the zones; the boundaries are found anew in each of them."""

    def __init__(self, parameters: Parameters, layout: Layout, tolerance: float) -> None:
        self.parameters, self.tolerance = parameters, tolerance
        self.states = layout.states
        self.logits = np.array(layout.logits)
        if layout.slopes is not None:
            self.slopes = layout.slopes
            return
        self.slopes = self._differences()
        start = self.logits
        found = self._find(self._spaces(_ROUGH), _ROUGH, _SETTLED)
        left = np.abs(np.linalg.solve(found.slopes, found.trial.mismatch))
        if not float(left.max()) < _LOST * min([1.0, *np.diff(self.logits)]):
            raise NoBoundariesError("no such boundaries are found")
        moved = float(np.abs(self.logits - start).max())
        if moved > _STALE * min([1.0, *np.diff(self.logits)]):
            self.slopes = self._differences()

    @property
    def layout(self) -> Layout:
        """The boundaries as they are known, with the slopes of their conditions."""
        return Layout(tuple(self.logits.tolist()), self.states, self.slopes)

    # spaces

    @staticmethod
    def _radii(logits: Array) -> tuple[Radius, ...]:
        return tuple(Radius.from_logit(float(x)) for x in logits)

    def _spaces(self, tolerance: float) -> list[Resolution]:
        alpha, beta, _, _ = self.parameters
        return first_spaces(alpha, beta, self._radii(self.logits), tolerance)

    def start(self) -> Resolution:
        """Return the first space, of all parts one after the other."""
        # boundaries superconverge: a space for half the digits has nearly all of theirs
        halfway = sqrt(self.tolerance)
        if halfway < 0.1 * _ROUGH:
            self._find(self._spaces(halfway), halfway, max(self.tolerance, _ENOUGH))
        spaces = self._spaces(self.tolerance)
        self._counts = [one.panels.panels for one in spaces]
        return joined(spaces)

    # solutions

    def _trials(self, spaces: list[Resolution], tolerance: float) -> Callable[[Array], ZonesTrial]:
        """Return what solves with given boundaries; factors serve as long as they do."""
        panels, degrees = [one.panels for one in spaces], [one.degrees for one in spaces]
        last: list[ZonesTrial] = []
        least = [0.0]  # what the factors leave at their own boundaries

        def trial_at(logits: Array) -> ZonesTrial:
            if Radius.from_logit(float(logits[-1])).rest < _NARROWEST * self.parameters.alpha:
                raise NoBoundariesError("the last zone vanishes")
            zones = SlidingZones(
                self._radii(logits), self.states, panels, degrees, self.parameters.alpha == 0.0
            )
            if last:
                like = ZonesTrial(zones, last[0].factored, last[0].solution, last[0].lifts, inf)
                trial = self._corrected(like, tolerance)
                if trial.left < max(_ENOUGH_LEFT * tolerance, 10.0 * least[0]):
                    last[0] = trial
                    return trial
            factored = ZonesFactored(zones, self.parameters)
            begin = np.zeros(zones.unknowns), np.zeros(len(logits))
            last[:] = [self._corrected(ZonesTrial(zones, factored, *begin, inf), tolerance)]
            least[0] = last[0].left
            return last[0]

        return trial_at

    def _corrected(self, trial: ZonesTrial, tolerance: float) -> ZonesTrial:
        """Correct a solution as far as it goes."""
        zones = trial.zones
        own, size = trial.factored.zones is zones, inf
        aim = max(_FURTHER * tolerance, ROUNDING)
        for _ in range(_CORRECTIONS):
            trial, change = trial.corrected()
            shares = self._shares(zones, change, trial.solution)
            before, size = size, max(float(one.max()) for pair in shares for one in pair)
            trial.left = size * max(_LEFT, min(size / before, 1.0))
            slow = size > _SLOW * before
            if trial.left < aim or (slow and size < _ROUNDED) or (size > before and not own):
                break
        return trial

    def _shares(self, zones: SlidingZones, change: Array, size: Array) -> list[list[Array]]:
        """Return a change of p and of q/s on every panel, relative to their sizes there."""
        alpha, beta, _, _ = self.parameters
        shares: list[list[Array]] = []
        moved, values = zones.split(change), zones.split(size)
        for k, part in enumerate(zones.parts):
            panels, reach = part.family.panels, part.family.reach
            leading = leading_depth(alpha, beta, reach) if panels.power else inf
            known = inf if part.boundary < 0 else rounding_depth(part.family.boundary, reach)
            pairs = [(panels, moved[0][k], values[0][k])]
            if k in moved[1]:
                pairs.append((part.shear.panels, moved[1][k], values[1][k]))
            shares.append([])
            for own, step, whole in pairs:
                ends = series_of(own, whole).at_ends()
                share = share_of_change(own, step, ends, leading=leading, known=known)
                shares[-1].append(share)
        return shares

    # boundaries

    def _differences(self) -> Array:
        """Return the slopes of the conditions in the space in which they are found first."""
        trial_at = self._trials(self._spaces(_ROUGH), _ROUGH)
        return differences(lambda logits: trial_at(logits).mismatch, self.logits)

    def _find(
        self, spaces: list[Resolution], tolerance: float, settle: float
    ) -> Boundaries[ZonesTrial]:
        """Find the boundaries in a space; after the first one they are near."""
        near = tolerance < _ROUGH
        found = find_boundaries(
            self._trials(spaces, tolerance),
            lambda trial: trial.mismatch,
            self.logits,
            self.slopes,
            min(settle, _LOOSEST) if near else settle,
            _ENOUGH,
            near=near,
        )
        self.logits, self.slopes = found.logits, found.slopes
        return found

    # outcome

    def attempt(self, resolution: Resolution) -> Attempt[CoupledZones]:
        spaces = parted(resolution, self._counts, self.parameters.alpha)
        settle = max(self.tolerance, 100.0 * _ENOUGH)
        return self._assess(spaces, self._find(spaces, self.tolerance, settle).trial)

    def _assess(self, spaces: list[Resolution], trial: ZonesTrial) -> Attempt[CoupledZones]:
        """Turn the final trial into a solution with its errors."""
        zones = trial.zones
        whole = trial.solution * trial.approach
        effects = trial.effects()
        moved = [trial.approach * one.change for one in effects]
        pressure, shear = zones.split(whole)
        rates = [
            [decay_rates(space, one) for one in (pressure[k], shear.get(k)) if one is not None]
            for k, space in enumerate(spaces)
        ]
        shares = self._shares(zones, moved[0], whole)
        expected = [
            [expected_error(*pair) for pair in zip(*both, strict=True)]
            for both in zip(shares, rates, strict=True)
        ]
        # what the boundaries still are off is felt everywhere
        inverse = np.abs(np.linalg.inv(self.slopes))
        off = 2.0 * float((inverse @ np.abs(trial.mismatch)).max())
        left = trial.left + off
        pressure_error = max(float(one[0].max()) for one in expected)
        pressure_error += left + 20.0 * ROUNDING
        traction_error = max(float(one[-1].max()) for one in expected)
        traction_error = max(traction_error, self._edge_error(zones, moved[0], whole))
        traction_error += left + TRACTION_ROUNDING
        error = max(pressure_error, traction_error)
        # what superconverges may change little by accident, but hardly against the square
        squared = error**2
        total = trial.shear(whole)
        sheared = max(abs(trial.shear(one)) for one in moved) / abs(total)
        noise = 40.0 * ROUNDING + trial.left * 1e-2
        known = squared + noise + off
        kept = 2.0 * SAFETY * LEAST_RATE
        missed = kept * np.max([np.abs(one.mismatch) for one in effects], axis=0)
        missed = missed + squared + noise + 2.0 * np.abs(trial.mismatch)
        shifts = inverse @ missed + float(np.finfo(float).eps) * np.abs(self.logits)
        scales = (trial.approach, trial.lifts), (0.0, effects[0].lifts)
        stuck, lost = (
            self._stuck(zones, trial.lacking(vector, approach, trial.approach * lifts))
            for vector, (approach, lifts) in zip((whole, moved[0]), scales, strict=True)
        )
        boundary_errors = tuple(
            boundary_error(float(d), r) for d, r in zip(shifts, zones.radii, strict=True)
        )
        bend = 2.0 * max(float(d) ** 2 * r.rest for d, r in zip(shifts, zones.radii, strict=True))
        value = CoupledZones(
            zones.radii,
            zones.states,
            trial.approach,
            total,
            [series_of(p.family.panels, c) for p, c in zip(zones.parts, pressure, strict=True)],
            [
                series_of(p.shear.panels, shear[k]) if k in shear else None
                for k, p in enumerate(zones.parts)
            ],
            stuck,
            max(abs(one.approach) for one in effects) + known,
            sheared + known + bend,
            pressure_error,
            traction_error,
            boundary_errors[0][0],
            zones_error(zones.radii, boundary_errors),
            SAFETY * self._largest_displacement(zones, lost),
            zones,
            *self._columns(trial, whole, moved[0]),
        )
        indicators = np.concatenate([np.max(one, axis=0) for one in expected])
        # no degree lowers what rounding leaves
        indicators[indicators <= trial.left] = 0.0
        rate = np.concatenate([np.max(one, axis=0) for one in rates])
        return Attempt(value, error, indicators, rate, zones.unknowns)

    def _edge_error(self, zones: SlidingZones, change: Array, whole: Array) -> float:
        """Return the error of q/s at an edge where it has a root."""
        part = zones.parts[-1]
        if self.parameters.alpha > 0.0 or part.state != 0:
            return 0.0
        moved, values = (zones.split(one)[1][len(zones.parts) - 1] for one in (change, whole))
        panels = part.shear.panels
        return root_error(panels, moved, series_of(panels, values).at_ends()[-1])

    def _columns(
        self, trial: ZonesTrial, whole: Array, moved: Array
    ) -> tuple[list[Array], list[Array]]:
        """Return the coefficients of p and of q/s on every part, with their changes."""
        pairs = np.column_stack([whole, moved])
        traction = trial.zones.whole_traction(pairs, self.parameters.friction)
        return trial.zones.split(pairs)[0], traction

    @staticmethod
    def _stuck(zones: SlidingZones, misfit: list[Array]) -> list[Stuck]:
        """Return the quadrature of ``t^2 E dt`` over the stick zones."""
        stuck = []
        for zone, state in enumerate(zones.states):
            if state == 0:
                parts = tuple(
                    (Points(part.family.boundary, zones.offsets[k]), pi * weights * misfit[k])
                    for k, (part, weights) in enumerate(
                        zip(zones.parts, zones.shear_weights, strict=True)
                    )
                    if part.zone == zone
                )
                stuck.append(Stuck((*zones.radii, EDGE)[zone], parts))
        return stuck

    @staticmethod
    def _largest_displacement(zones: SlidingZones, stuck: list[Stuck]) -> float:
        """Return the largest displacement in the slip zones that E in the stick zones makes."""
        bounds = (*zones.radii, EDGE)
        return max(
            largest_displacement(stuck, bounds[k - 1], bounds[k])
            for k, state in enumerate(zones.states)
            if state != 0
        )


def find_coupled_zones(parameters: Parameters, layout: Layout) -> Layout:
    """Return the boundaries of zones like these, to some digits, with what starts their solution.

    Parameters and errors are those of `solve_coupled_zones`.
    """
    return _CoupledZonesProblem(parameters, layout, _ROUGH).layout


def solve_coupled_zones(
    parameters: Parameters,
    layout: Layout,
    tolerance: float,
    max_unknowns: int,
) -> Refinement[CoupledZones]:
    """Solve coupled partial slip with the zones of a layout.

    Parameters
    ----------
    parameters : Parameters
        With ``beta*`` > 0.
    layout : Layout
        The states of the zones; the boundaries as `find_coupled_zones` returns them, or a guess.
    tolerance : float
        Bound on the relative errors of both fields, pointwise.
    max_unknowns : int
        Most unknowns of a space.

    Returns
    -------
    Refinement
        Whether the friction law holds is for the caller to check.

    Raises
    ------
    NoBoundariesError
        If there are no such boundaries.
    """
    problem = _CoupledZonesProblem(parameters, layout, tolerance)
    return refine(problem, tolerance, max_unknowns // 2)
