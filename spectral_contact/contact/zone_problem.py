"""Any zones of stick and slip: their boundaries are solved for.

With elastic coupling pressure and traction are unknown together, else the pressure is given. At
given boundaries the system is linear in the imbalances, by which what the half-integral of the
traction lacks there is off what the fields make it. Continuity gives them, and that there is none
is the condition of each boundary.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from math import inf, prod
from typing import cast

import numpy as np

from spectral_contact.contact.drive import Drive
from spectral_contact.contact.driven import Driven
from spectral_contact.contact.layout import Layout, NoBoundariesError
from spectral_contact.contact.normal import SMALL_COMPLIANCE
from spectral_contact.contact.radius_guess import guessed_radius
from spectral_contact.contact.refine import Attempt, Refinement, refine
from spectral_contact.contact.resolution import LEFT, PROBE, ROUGH, ROUNDING, TRIFLING, joined
from spectral_contact.contact.stick_radius import (
    LARGEST_LOGIT,
    LEAST_LOGIT,
    NOISE,
    SLOPING,
    NoStickDiskError,
    differences,
    least_logit,
    root_near,
    slope_at,
)
from spectral_contact.contact.zone_assessment import Assessment, ZoneSolution, shares_of, sizes_of
from spectral_contact.contact.zone_newton import ZonesNewton, ZoneState
from spectral_contact.contact.zone_spaces import (
    driven_spaces,
    edge_power,
    first_spaces,
    parted,
)
from spectral_contact.fields.series import Array, Radius
from spectral_contact.records import Ending
from spectral_contact.spectral.factored import Factored, factored
from spectral_contact.spectral.panels import Resolution
from spectral_contact.spectral.parameters import Parameters
from spectral_contact.spectral.regularised import HARMLESS
from spectral_contact.spectral.tangential import Tangential
from spectral_contact.threads import cached_property

#: At the edge nothing happens in less than this of the layer: 1e-12 misses annuli of 4e-12 that
#: are guessed at a tenth of their width, with 1e-16 no digit of them is another one.
_NARROWEST = 1e-14
#: How far boundaries may move, of the narrowest zone, before slopes are found anew; where more of a
#: step is left there are none. 25 scenes take 98 systems, 91 with 0.4 and 116 with 0.02.
_STALE = 0.1
#: Most corrections at given boundaries.
_CORRECTIONS = 10
#: How far the boundaries of factors may be, of a zone, in thick layers and in thin ones: 25 scenes
#: take 98 systems, 78 with 0.01 for the second, and 212 corrections, 227 with 0.3 for the first.
_FAR, _FAR_THIN = 0.03, 1e-4
#: By how much tighter first spaces are tried, so often, where the estimate does not fall any more:
#: what is added to a space here and there may not help, a better one does. And the least tolerance.
_FINER, _TRIES, _TIGHTEST = 0.1, 3, 1e-12
#: Error of the radius, as a logit, from which finer spaces start; 1e-3 and 1e-8 do not change them.
_NEAR = ROUGH * PROBE
#: Tolerance from which on no small space comes first: with three evaluations a radius is known to
#: 1e-13. So much smaller is what counts for nothing, as rounding here, of what slips.
_FEW_DIGITS = ROUGH**3
#: What weights of solutions that tell another one come to at most: more makes their noise felt.
_MOST_WEIGHT = 3


class FreeBoundaryProblem:
    """Spaces for given states of the zones; the boundaries are found anew in each of them.

    Parameters
    ----------
    parameters : Parameters
    layout : Layout
    tolerance : float
        Bound on the relative errors of both fields, pointwise.
    pointwise : bool
        Whether it is that; else it bounds approach and shear, which err like its square.
    drive : Drive, optional
        Of the pressure, if it is given; parameters are those for kappa = 1 then.
    goal : float, optional
        Bound on the relative errors of the boundaries; by default the tolerance.
    """

    def __init__(
        self,
        parameters: Parameters,
        layout: Layout,
        tolerance: float,
        *,
        pointwise: bool = True,
        drive: Drive | None = None,
        goal: float | None = None,
    ) -> None:
        self.parameters, self.pointwise = parameters, pointwise
        self.drives = [] if drive is None else [drive]
        self.goal = tolerance if goal is None else goal
        self.tolerance = tolerance if pointwise or self.drives else float(np.sqrt(tolerance))
        self.states = layout.states
        self.logits = np.array(layout.logits)
        slopes = layout.slopes if layout.logits else np.zeros((0, 0))
        if slopes is not None:
            self.slopes = slopes
        self.near = layout.slopes is not None

    @property
    def layout(self) -> Layout:
        """The boundaries as they are known, with the slopes of their conditions."""
        slopes = self.slopes  # boundaries are found with them
        return Layout(tuple(self.logits.tolist()), self.states, slopes)

    @cached_property
    def slopes(self) -> Array:
        """By how much the conditions rise with the boundaries, as logits: finds these roughly."""
        if len(self.logits) == 1:
            guess = float(self.logits[0]), 0.5, ROUGH
            least = least_logit(self.parameters)
            root = root_near(lambda x: float(self.rough(x).mismatch[0]), *guess, least=least)
            self.logits = np.array(root[:1])
            return np.array([root[1:]])
        begin, (spaces, factors) = self.logits, self._sloped()
        settle = min(ROUGH, 0.5 * _STALE * self.narrowest)
        state = ZonesNewton(self, spaces, settle, factors).run(ROUGH)
        left = float(np.abs(np.linalg.solve(self.slopes, state.mismatch)).max())
        if not left < _STALE * self.narrowest:
            raise NoBoundariesError("no such boundaries are found")
        if self.drift(begin) > _STALE:
            self._sloped()
        return self.slopes

    def rough(self, logit: float) -> ZoneState:
        """Return the contact with one given boundary in a small space."""
        at = np.array([logit])
        system = self.system(self.spaces(PROBE, at), at)
        return self.settled(ZoneState.begin(factored(system)), ROUGH)

    def _sloped(self, aim: float = SLOPING) -> tuple[list[Resolution], Factored]:
        """Find the slopes of the conditions in a small space; return it and its factors."""
        spaces = self.spaces(ROUGH)
        factors = factored(self.system(spaces, self.logits))
        begin = self.settled(ZoneState.begin(factors), aim)
        if self.tells(begin):
            return spaces, factors

        def conditions(logits: Array) -> Array:
            system = self.system(spaces, logits)
            own = factors if self.drift(logits) <= self.far else factored(system)
            return self.settled(replace(begin, system=system, factored=own), aim).mismatch

        self.slopes = differences(conditions, self.logits)
        return spaces, factors

    def tells(self, state: ZoneState) -> bool:
        """Take the slopes from fields, if panels know these near to boundaries and q has digits."""
        known = self.thinnest >= SMALL_COMPLIANCE and self.parameters.beta < 0.5 / ROUNDING
        if known:
            self.slopes = state.slopes(self.drives, float(np.sqrt(max(self.tolerance, SLOPING))))
        return known

    # spaces

    def spaces(self, tolerance: float, logits: Array | None = None) -> list[Resolution]:
        """Return the first spaces, at boundaries as they are known or at others."""
        alpha, beta, _, _ = self.parameters
        at = self.logits if logits is None else logits
        radii = tuple(map(Radius.from_logit, at.tolist()))
        form = alpha, beta, radii, self.states, tolerance
        return driven_spaces(*form) if self.drives else first_spaces(*form, self._edge_power)

    def start(self) -> Resolution:
        """Return the first space, of all parts one after the other."""
        # boundaries superconverge: a space for half the digits has nearly all of theirs
        halfway = np.sqrt(self.tolerance)
        known = self.drives and self.near  # to digits that are as good
        if len(self.slopes) and halfway < _FINER * ROUGH and not known:
            settle = max(self.tolerance, NOISE)
            state = self._newton(self.spaces(halfway), settle).run(halfway)
            last = np.linalg.solve(self.slopes, state.mismatch)
            if float(np.abs(last).max()) < settle:  # it saves a system in the first space
                self.logits = self.logits - last
        spaces = self.spaces(self.tolerance)
        self._counts = [one.panels.panels for one in spaces]
        return joined(spaces)

    def parted(self, resolution: Resolution) -> list[Resolution]:
        """Return the spaces of all parts, of one like that of `start`."""
        return parted(resolution, self._counts, self._edge_power)

    @property
    def _edge_power(self) -> float:
        """The endpoint weight of the pressure; one that is given has its series as it is."""
        if self.drives:
            return -0.5 if self.parameters.alpha == 0.0 else 0.0
        return edge_power(self.parameters, self.states)

    def system(self, spaces: list[Resolution], logits: Array) -> Tangential:
        """Return the equations with given boundaries.

        Raises
        ------
        NoBoundariesError
            If a zone vanishes.
        """
        radii = tuple(map(Radius.from_logit, logits.tolist()))
        if len(radii) > 1 and radii[-1].rest < _NARROWEST * self.parameters.alpha:
            raise NoBoundariesError("the last zone vanishes")
        form = radii, self.states, spaces, self.parameters
        if self.drives:
            return Driven(*form, self.drives, self.tolerance)
        from spectral_contact.spectral.system import System

        return System(*form)

    # solutions

    def _newton(self, spaces: list[Resolution], settle: float) -> ZonesNewton:
        factors = factored(self.system(spaces, self.logits))
        return ZonesNewton(self, spaces, settle, factors)

    def settled(self, state: ZoneState, aim: float) -> ZoneState:
        """Correct a solution at given boundaries, as far as is aimed."""
        size = inf
        for _ in range(_CORRECTIONS):
            state, change = state.corrected()
            before, size = size, self.size(state, change)
            if size * max(LEFT, min(size / before, 1.0)) < aim or size > before:
                break
        return state

    def size(self, state: ZoneState, change: Array) -> float:
        """Return the largest share of a change."""
        shares = shares_of(state.system, change, sizes_of(state.system, state.solution))
        return max(float(one.max()) for one in shares)

    def drift(self, begin: Array) -> float:
        """Return how far boundaries are from others, of the narrowest zone."""
        return float(np.abs(self.logits - begin).max(initial=0.0)) / self.narrowest

    @property
    def far(self) -> float:
        """How far boundaries may be from those of factors, of the narrowest zone."""
        return _FAR if self.thinnest > SMALL_COMPLIANCE else _FAR_THIN

    @property
    def thinnest(self) -> float:
        """The least compliance in an equation, or 1."""
        return min(1.0, *self.parameters[int(bool(self.drives)) : 2])

    @property
    def narrowest(self) -> float:
        """The width of the narrowest zone between boundaries, as logits, or 1."""
        return float(min([1.0, *np.diff(self.logits)]))

    # outcome

    def attempt(self, resolution: Resolution) -> Attempt[ZoneSolution]:
        """Solve in a space."""
        spaces = self.parted(resolution)
        if self.drives:
            self._know_errors()
        least = TRIFLING * self.goal
        newton = self._newton(spaces, max(least, NOISE))
        state = newton.run(max(least, 2.0 * ROUNDING))
        if not newton.settled and not self.tells(state):
            self._sloped(ROUNDING)  # next to the onset of a zone steps say nothing of slopes
        return Assessment(self, spaces, state, newton.left).attempt()

    def _know_errors(self) -> None:
        """Solve from now on with what is known of the errors of the pressure."""
        self.drives = [self.drives[0], *self.drives[0].changes]


class StickDiskProblem(FreeBoundaryProblem):
    """Spaces for a stick disk under a given pressure; the radius, if any, is found in each."""

    def find(self, layout: Layout) -> None:
        """Find the radius, and the slope there: roughly, or near that of a layout."""
        logit, slope = self._found(layout)
        self.logits, self.slopes = np.array([logit]), np.array([[slope]])

    def _found(self, layout: Layout) -> tuple[float, float]:
        form, near, slopes = (self.drives[0], self.parameters), None, layout.slopes
        for guess in layout.logits:
            if slopes is None:  # in a space that sees a narrow annulus
                spaces = self.spaces(self.tolerance, np.array([guess]))
                return guess, slope_at(partial(self._mismatch, spaces), guess)
            if LEAST_LOGIT < guess < LARGEST_LOGIT:
                near = guess, float(slopes[0, 0])
        if self.parameters.beta == 0.0:
            return guessed_radius(*form, _NEAR, near)
        near = near or guessed_radius(*form, PROBE)
        if self.tolerance > _FEW_DIGITS:  # three evaluations in the first space are enough
            return near
        small = self.spaces(ROUGH, np.array(near[:1]))
        return root_near(partial(self._mismatch, small), *near, _NEAR)

    def _mismatch(self, spaces: list[Resolution], logit: float) -> float:
        return float(self.at(spaces, np.array([logit])).mismatch[0])

    def at(
        self, spaces: list[Resolution], logits: Array, factors: Factored | None = None
    ) -> ZoneState:
        """Return the solution with a given radius, to rounding."""
        system = self.system(spaces, logits)
        state = ZoneState.begin(factors or factored(system), system)
        # the normal equations lose digits where compliance is small
        rim = system.radii[0].value if system.radii else 1.0
        for _ in range((factors is not None) + (self.parameters.beta < HARMLESS * rim)):
            state, _ = state.corrected()
        return state

    def start(self) -> Resolution:
        """Return the first space of the disk."""
        return self.spaces(self.tolerance)[0]

    def parted(self, resolution: Resolution) -> list[Resolution]:
        """Return the spaces of all parts: in slip nothing is unknown."""
        return [resolution] * (2 * len(self.states) - 1)

    def attempt(self, resolution: Resolution) -> Attempt[ZoneSolution]:
        """Solve in a space."""
        spaces = self.parted(resolution)
        self.drives = self.drives[:1]
        return self.assessed(spaces, *(self._at_root(spaces) if len(self.logits) else ()))

    def _at_root(self, spaces: list[Resolution]) -> tuple[ZoneState | None, float]:
        """Find the radius; return the solution there, if others tell it, and what it is off."""
        seen = dict[float, ZoneState]()

        def mismatch(logit: float) -> float:
            seen[logit] = self.at(spaces, np.array([logit]))
            self._know_errors()  # a first one is not the last
            return float(seen[logit].mismatch[0])

        begin, close = (float(self.logits[0]), float(self.slopes[0, 0])), ROUNDING
        if self.parameters.beta == 0.0:  # no field is in the condition
            form = self.drives[0], self.parameters, close
            logit, slope = guessed_radius(*form, begin, accuracy=close)
        else:
            close *= max(self.tolerance / _FEW_DIGITS * Radius.from_logit(begin[0]).rest, 1.0)
            logit, slope = root_near(mismatch, *begin, close)
        self.logits, self.slopes = np.array([logit]), np.array([[slope]])
        if len(seen) < 2:
            return None, 0.0
        # a polynomial through the last three is right to the product of the distances
        states, apart = list(seen.values())[-3:], [x - logit for x in seen][-3:]
        weights, off = [prod(b / (b - a) for b in apart if b != a) for a in apart], abs(prod(apart))
        if sum(map(abs, weights)) > _MOST_WEIGHT or off > close:
            return None, 0.0
        system = cast("Driven", self.system(spaces, self.logits))
        system.extrapolate([cast("Driven", one.system) for one in states], weights)
        return ZoneState.extrapolated(states, weights, system), off

    def assessed(
        self, spaces: list[Resolution], state: ZoneState | None = None, left: float = 0.0
    ) -> Attempt[ZoneSolution]:
        """Return the solution with the radius as it is, with its errors and what is left."""
        self._know_errors()
        state, own = state or self.at(spaces, self.logits), len(spaces[0].degrees)
        attempt = Assessment(self, spaces, state, left).attempt()
        return replace(
            attempt,
            error=attempt.error if self.pointwise else attempt.value.shear_error,
            indicators=attempt.indicators[:own],
            rates=attempt.rates[:own],
        )


class _GivenRadius(StickDiskProblem):
    """Spaces for a stick disk of a given radius, whose friction is found."""

    def attempt(self, resolution: Resolution) -> Attempt[ZoneSolution]:
        """Solve in a space; the slope is that by the logarithm of the friction."""
        spaces, mismatches = self.parted(resolution), list[float]()
        self.drives, factors = self.drives[:1], None
        for friction in (0.0, 1.0):
            self.parameters = self.parameters._replace(friction=friction)
            state = self.at(spaces, self.logits, factors)
            factors = state.factored
            mismatches.append(float(state.mismatch[0]))
        none, full = mismatches
        if not (none > 0.0 and none > full):
            raise NoStickDiskError(at_centre=False)
        self.parameters = self.parameters._replace(friction=none / (none - full))
        self.slopes = np.array([[none]])
        return self.assessed(spaces)


def solve_stick(
    parameters: Parameters,
    tolerance: float,
    max_unknowns: int,
    *,
    drive: Drive | None = None,
    pointwise: bool = True,
) -> Refinement[ZoneSolution]:
    """Solve with stick on the whole contact; see `solve_zones` and `solve_stick_disk`."""
    stuck = Layout((), (0,))
    if drive is None:
        return solve_zones(parameters, stuck, tolerance, max_unknowns, pointwise=pointwise)
    problem = StickDiskProblem(parameters, stuck, tolerance, pointwise=pointwise, drive=drive)
    return refine(problem, tolerance, max_unknowns)


def solve_stick_disk(
    drive: Drive, parameters: Parameters, layout: Layout, tolerance: float, max_unknowns: int
) -> Refinement[ZoneSolution]:
    """Solve partial slip under the assumption of one central stick disk, for kappa = 1.

    The layout has its slope as a like scene has it, a guess of the radius, or nothing. Whether the
    assumption holds is for the caller to check; raises `NoStickDiskError` if there is no radius.
    """
    # 1 - c falls like exp(-pi f/(2 kappa))
    if parameters.beta == 0.0 and parameters.friction > LARGEST_LOGIT:
        raise NoStickDiskError(at_centre=False)
    problem = StickDiskProblem(parameters, layout, tolerance, drive=drive)
    problem.find(layout)
    return refine(problem, tolerance, max_unknowns)


def solve_given_radius(
    drive: Drive, parameters: Parameters, radius: Radius, tolerance: float, max_unknowns: int
) -> tuple[Refinement[ZoneSolution], float]:
    """Solve with one central stick disk of a given radius; return the friction ``f/kappa``, too.

    ``shifts`` are the error of its logarithm; raises `NoStickDiskError` if none has this disk.
    """
    known = Layout((radius.logit,), (0, 1), np.eye(1))
    problem = _GivenRadius(parameters, known, tolerance, drive=drive)
    return refine(problem, tolerance, max_unknowns), problem.parameters.friction


def solve_zones(
    parameters: Parameters,
    layout: Layout,
    tolerance: float,
    max_unknowns: int,
    *,
    pointwise: bool = True,
) -> Refinement[ZoneSolution]:
    """Solve the coupled contact with the zones of a layout: a guess, or that of a problem.

    The tolerance bounds the fields pointwise, or approach and shear. Whether the friction law holds
    is for the caller to check; raises `NoBoundariesError` if there are no such boundaries.
    """
    found = list[Refinement[ZoneSolution]]()
    for k in range(_TRIES):
        aim = max(_FINER**k * tolerance, _TIGHTEST)
        problem = FreeBoundaryProblem(parameters, layout, aim, pointwise=pointwise)
        found.append(refine(problem, tolerance, max_unknowns // 2))
        best = min(found, key=lambda one: one.best.error)
        if best.ending is not Ending.ROUNDING or aim == _TIGHTEST:
            break
    return best
