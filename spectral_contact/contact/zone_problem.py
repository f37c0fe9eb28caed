"""Any zones of stick and slip: their boundaries are solved for.

With elastic coupling pressure and traction are unknown together, else the pressure is given. At
given boundaries the system is linear in the lifts, the values there of what the half-integral of
the traction lacks. Continuity gives them, and that each is what the fields make it is the condition
of its boundary.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import inf, log

import numpy as np

from spectral_contact.contact.drive import Drive
from spectral_contact.contact.driven import Driven
from spectral_contact.contact.layout import Layout, NoBoundariesError
from spectral_contact.contact.normal import SMALL_COMPLIANCE
from spectral_contact.contact.refine import Attempt, Refinement, refine
from spectral_contact.contact.resolution import LEFT, PROBE, ROUGH, ROUNDING, TINY, TRIFLING, joined
from spectral_contact.contact.stick_radius import NOISE, root_near
from spectral_contact.contact.zone_assessment import Assessment, ZoneSolution, shares_of, sizes_of
from spectral_contact.contact.zone_newton import ZonesNewton, ZoneState
from spectral_contact.contact.zone_spaces import first_spaces, parted, with_known_slip
from spectral_contact.fields.series import Array, Radius
from spectral_contact.records import Ending
from spectral_contact.spectral.factored import Factored, factored
from spectral_contact.spectral.panels import Resolution
from spectral_contact.spectral.parameters import Parameters
from spectral_contact.spectral.system import System
from spectral_contact.spectral.tangential import Tangential
from spectral_contact.threads import cached_property

#: The logit of the smallest stick disk that is looked for without a layer of p. A larger one stands
#: for smaller ones then: from this many of its radii on p lacks 0.1/n**3 of kappa f, measured.
LEAST_PLAIN, CLEAR, _MOST_STAND_IN = -40.0, 128.0, 2.0**-11
#: What corrections leave of conditions whose differences are taken; what share of a zone's width
#: they span at most: 1e-5 takes 25 scenes 214 corrections, not 212; 0.03 and 0.5 change no digit.
_SLOPING, _MOST_SHARE = 1e-8, 0.2
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
        self.tolerance = tolerance if pointwise else float(np.sqrt(tolerance))
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
            least = _least_logit(self.parameters)
            root = root_near(lambda x: float(self.rough(x).mismatch[0]), *guess, least=least)
            self.logits = np.array(root[:1])
            return np.array([root[1:]])
        begin, (spaces, factors) = self.logits, self._sloped()
        settle = min(ROUGH, 0.5 * _STALE * self.narrowest)
        state = ZonesNewton(self, spaces, settle, factors).run(ROUGH)
        narrowest = self.narrowest
        left = float(np.abs(np.linalg.solve(self.slopes, state.mismatch)).max())
        if not left < _STALE * narrowest:
            raise NoBoundariesError("no such boundaries are found")
        if float(np.abs(self.logits - begin).max()) > _STALE * narrowest:
            self._sloped()
        return self.slopes

    def rough(self, logit: float) -> ZoneState:
        """Return the contact with one given boundary in a small space."""
        at = np.array([logit])
        system = self.system(self.spaces(PROBE, at), at)
        return self.settled(ZoneState.begin(factored(system)), ROUGH)

    def _sloped(self, aim: float = _SLOPING) -> tuple[list[Resolution], Factored]:
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
            self.slopes = state.slopes(self.drives, float(np.sqrt(max(self.tolerance, _SLOPING))))
        return known

    # spaces

    def spaces(self, tolerance: float, logits: Array | None = None) -> list[Resolution]:
        """Return the first spaces, at boundaries as they are known or at others."""
        alpha, beta, _, _ = self.parameters
        radii = _radii(self.logits if logits is None else logits)
        spaces = first_spaces(alpha, beta, radii, self.states, tolerance)
        return with_known_slip(spaces, self.states, tolerance) if self.drives else spaces

    def start(self) -> Resolution:
        """Return the first space, of all parts one after the other."""
        # boundaries superconverge: a space for half the digits has nearly all of theirs
        halfway = np.sqrt(self.tolerance)
        known = self.drives and self.near  # to digits that are as good
        if len(self.slopes) and halfway < _FINER * ROUGH and not known:
            settle = max(self.tolerance, NOISE)
            state = ZonesNewton(self, self.spaces(halfway), settle).run(halfway)
            last = np.linalg.solve(self.slopes, state.mismatch)
            if float(np.abs(last).max()) < settle:  # it saves a system in the first space
                self.logits = self.logits - last
        spaces = self.spaces(self.tolerance)
        self._counts = [one.panels.panels for one in spaces]
        return joined(spaces)

    def system(self, spaces: list[Resolution], logits: Array) -> Tangential:
        """Return the equations with given boundaries.

        Raises
        ------
        NoBoundariesError
            If a zone vanishes.
        """
        radii = _radii(logits)
        narrowest = _NARROWEST * self.parameters.alpha
        if len(radii) > 1 and radii[-1].rest < narrowest:
            raise NoBoundariesError("the last zone vanishes")
        form = radii, self.states, spaces, self.parameters
        return Driven(*form, self.drives) if self.drives else System(*form)

    # solutions

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
        spaces = parted(resolution, self._counts, self.parameters.alpha)
        if self.drives:  # from now on with what is known of the errors of the pressure
            self.drives = [self.drives[0], *self.drives[0].changes]
        least = TRIFLING * self.goal
        newton = ZonesNewton(self, spaces, max(least, NOISE))
        state = newton.run(max(least, 2.0 * ROUNDING))
        if not newton.settled:  # next to the onset of a zone steps say nothing of slopes
            self._sloped(ROUNDING)
        return Assessment(self, spaces, state, newton.left).attempt()


def _radii(logits: Array) -> tuple[Radius, ...]:
    return tuple(Radius.from_logit(float(x)) for x in logits)


def solve_zones(
    parameters: Parameters,
    layout: Layout,
    tolerance: float,
    max_unknowns: int,
    *,
    pointwise: bool = True,
) -> Refinement[ZoneSolution]:
    """Solve the coupled contact with the zones of a layout.

    Parameters
    ----------
    parameters : Parameters
    layout : Layout
        The states of the zones; the boundaries as a problem has them as `layout`, or a guess.
    tolerance : float
        Bound on the relative errors of both fields, pointwise.
    max_unknowns : int
        Most unknowns of a space.
    pointwise : bool
        Whether the fields are wanted; approach and shear alone, which the tolerance bounds then,
        need far fewer unknowns.

    Returns
    -------
    Refinement
        Whether the friction law holds is for the caller to check.

    Raises
    ------
    NoBoundariesError
        If there are no such boundaries.
    """
    best: Refinement[ZoneSolution] | None = None
    for k in range(_TRIES):
        aim = max(_FINER**k * tolerance, _TIGHTEST)
        problem = FreeBoundaryProblem(parameters, layout, aim, pointwise=pointwise)
        found = refine(problem, tolerance, max_unknowns // 2)
        if best is None or found.best.error < best.best.error:
            best = found
        if best.ending is not Ending.ROUNDING or aim == _TIGHTEST:
            break
    assert best is not None
    return best


def stand_in(parameters: Parameters) -> Radius:
    """Return the stick disk that stands for those too small to be felt.

    Without normal compliance p loses digits like 1/c next to it, and is a power of s far inside.
    """
    alpha, _, kappa, friction = parameters
    if alpha > 0.0:
        return Radius.from_logit(_least_logit(parameters))
    c = min(2.0 * np.sqrt(ROUNDING) / np.cbrt(max(kappa * friction, TINY)), _MOST_STAND_IN)
    return Radius(float(c), float(1.0 - c))


def _least_logit(parameters: Parameters) -> float:
    """Return the logit of a stick disk that is not felt: p hardly changes in so much of a layer."""
    alpha = parameters.alpha
    return 2.0 * log(ROUNDING * min(alpha, 1.0)) if alpha > 0.0 else LEAST_PLAIN


def solve_coupled_slip(
    parameters: Parameters, tolerance: float, max_unknowns: int
) -> Refinement[ZoneSolution]:
    """Solve with slip everywhere but in a disk too small to be felt, whose radius is given.

    Parameters are those of `solve_zones`.
    """
    alpha, _, kappa, friction = parameters
    # with less friction the traction has no digits; what sticks would have one of its own, which
    # costs digits by as much as it exceeds friction: none with so much compliance
    felt = Parameters(alpha, 1.0 / ROUNDING, kappa, max(friction, ROUNDING))
    # slopes so steep that the boundary does not move
    disk = Layout((stand_in(parameters).logit,), (0, 1), np.array([[1.0 / TINY]]))
    return solve_zones(felt, disk, tolerance, max_unknowns)


def differences(conditions_at: Callable[[Array], Array], logits: Array) -> Array:
    """Return the slopes by central differences, a share of the narrowest zone apart.

    Next to a narrow zone they fall with its width, and a small share would show rounding.
    """
    slopes, spacing = [], np.diff(logits)
    for i in range(len(logits)):
        near = min([1.0, *(abs(spacing[j]) for j in (i - 1, i) if 0 <= j < len(spacing))])
        share = min(float(np.cbrt(max(_SLOPING, ROUNDING / near**2))), _MOST_SHARE)
        h = share * near
        step = h * np.eye(len(logits))[i]
        slopes.append((conditions_at(logits + step) - conditions_at(logits - step)) / (2.0 * h))
    return np.array(slopes).T
