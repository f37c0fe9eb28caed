"""The steady loop of a load that cycles under a flat punch, as partial slip under more friction.

After some cycles between the largest load, 1, and the lowest one, lambda, the traction changes by
``(1 - lambda) q*(f')`` from one to the other, where q* is that of unit load under the friction
``f' = f (1 + lambda)/(1 - lambda)`` (docs/cycles). The dissipated energy is an integral, over the
friction as variable, of the slip weighted by the pressure (`mean_slip`).

R is the critical friction of full stick, from which on nothing slips; without tangential compliance
it is infinite. The formula for the energy of unloading holds if nothing slips *forward*, in the
sense of loading, while the load falls: if the *slack* (`forward_slip`) is not negative.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Final

from spectral_contact.errors import ConvergenceError, SceneError
from spectral_contact.fields.shakedown import shakedown
from spectral_contact.io import checks
from spectral_contact.io.choices import instance, suggesting
from spectral_contact.profiles.control import refuse_unloaded
from spectral_contact.records import Ending
from spectral_contact.scene import Scene
from spectral_contact.solution import Solution
from spectral_contact.solving.solver import Continuation
from spectral_contact.sweeps.cycle_result import CycleErrors, SteadyCycle
from spectral_contact.sweeps.forward_slip import forward_slack, slack_rounding
from spectral_contact.sweeps.mean_slip import ASKED, MeanSlipCurve, ValueWithError, mean_slip
from spectral_contact.threads import one_thread

_TOLERANCES: Final = "in [1e-11, 1e-2]"
#: Tolerances of the solves over that of the dissipation, tried in turn.
_SOLVE_TOLERANCES: Final = (0.1, 1e-3)
#: The tightest tolerance of a solve.
_TIGHTEST: Final = 1e-12
#: Least coefficient of friction. The energy that a smaller one dissipates is below the range of
#: doubles.
_LEAST_FRICTION: Final = 1e-100
#: Largest coefficient of friction, by the same reason.
_LARGEST_FRICTION: Final = 1e100
#: A lowest load below this is replaced by it. The loop does not depend on so small a load, whose
#: square may underflow.
_LEAST_LOAD: Final = 1e-50
#: A slack above minus this may be 0, as it is where the surface slips back: there it is off by up
#: to 1e-12.
_ROUNDING_OF_SLACK: Final = 1e-9
#: Loops whose friction is this close to the critical one, over the distance of the deepest loop
#: from it, dissipate next to nothing, and may have fewer digits.
_NEAR_SHAKEDOWN: Final = 1e-2


@suggesting()
def steady_cycle(
    scene: Scene,
    lowest: float,
    *,
    rtol: float = 1e-8,
    max_unknowns: int = 20_000,
    strict: bool = True,
) -> SteadyCycle:
    """Return the steady loop of a load that cycles between its largest value and a lower one.

    Parameters
    ----------
    scene : Scene
        Of the largest load: a flat punch with friction, without elastic coupling.
    lowest : float
        The lowest load over the largest one, ``0 < lowest < 1``. At 0 the contact opens and forgets
        what was.
    rtol : float
        Bound on the relative error of what is dissipated, in [1e-11, 1e-2].
    max_unknowns : int
        As of `solve`.
    strict : bool
        Raise an error if the tolerance cannot be met (default); else return what was reached.

    Returns
    -------
    SteadyCycle
        From the shakedown ratio on nothing slips, and nothing is dissipated.

    Raises
    ------
    SceneError
        For an argument out of its range, or a scene with a profile, with elastic coupling or
        without friction.
    ConvergenceError
        If the tolerance cannot be met; it carries the best cycle.

    Examples
    --------
    >>> from spectral_contact import Scene, steady_cycle
    >>> cycle = steady_cycle(Scene(0.1, 0.5, 0.5, 0.1), lowest=0.1, rtol=1e-6)
    >>> print(f"{cycle.stick_radius:.6f} {cycle.dissipation:.6e}")
    0.796332 1.196742e-04
    """
    scene, lowest = checked_cycle(scene, lowest)
    rtol = checks.within("rtol", rtol, _TOLERANCES)
    max_unknowns = checks.whole("max_unknowns", max_unknowns, 1)
    strict = checks.flag("strict", strict)
    with one_thread():
        for factor in _SOLVE_TOLERANCES:
            tolerance = max(factor * rtol, _TIGHTEST)
            cycle = _solved(scene, lowest, rtol, tolerance, max_unknowns)
            if (cycle.converged and not _may_slip_forward(cycle)) or tolerance == _TIGHTEST:
                break
        if _may_slip(cycle) and tolerance > _TIGHTEST:
            closer_cycle = _solved(scene, lowest, rtol, _TIGHTEST, max_unknowns)
            cycle = closer_cycle if closer_cycle.converged else cycle
    if strict and not cycle.converged:
        cause = f"the error estimate {cycle.worst_error:.1e} does not meet rtol = {rtol:.1e}"
        raise ConvergenceError(cause, "Loosen rtol, or use strict=False.", cycle)
    return cycle


def _solved(
    scene: Scene, lowest: float, rtol: float, tolerance: float, max_unknowns: int
) -> SteadyCycle:
    """Return the loop of one scene, with solves to some tolerance."""
    friction = float(scene.friction or 0.0)
    family = CycleFamily(scene, [friction], [lowest], rtol, tolerance, max_unknowns)
    return family.cycle(scene, lowest)


def _may_slip(cycle: SteadyCycle) -> bool:
    """Return whether a loop is so close to shakedown that its solves do not say if it slips."""
    return cycle.reloading_dissipation == 0.0 < cycle.error.reloading_dissipation


def _may_slip_forward(cycle: SteadyCycle) -> bool:
    """Return whether a loop has a negative slack that is within the errors of its solves.

    It counts as a loop without forward slip only because of these errors. A slack of 0 does not
    depend on them: where the surface slips back, q = f p to rounding at any tolerance.
    """
    return cycle.unloading_dissipation is not None and cycle.slack < -_ROUNDING_OF_SLACK


def checked_cycle(scene: Scene, lowest: float) -> tuple[Scene, float]:
    """Return a scene and a lowest load for which the law of steady loops holds, checked."""
    refuse_unloaded(instance("scene", scene, Scene), "steady_cycle")
    lowest = checks.real("lowest", lowest, allowed="a number between 0 and 1")
    if not 0.0 < lowest < 1.0:
        raise SceneError("lowest", lowest, "between 0 and 1, both excluded")
    if scene.profile is not None:
        raise SceneError("profile", scene.profile, "None: the law is that of a flat punch")
    if scene.friction is None:
        raise SceneError("friction", None, "a coefficient of friction")
    if 0.0 < scene.friction < _LEAST_FRICTION or _LARGEST_FRICTION < scene.friction < math.inf:
        allowed = f"0, in [{_LEAST_FRICTION:g}, {_LARGEST_FRICTION:g}], or infinite"
        raise SceneError("friction", scene.friction, allowed)
    if scene.couples:
        raise SceneError("coupling", True, "False: with elastic coupling the law does not hold")
    return scene, lowest


class CycleFamily:
    """Steady loops of scenes that differ in friction and in the lowest load alone.

    Parameters
    ----------
    scene : Scene
    frictions, lowest : sequence of float
        The coefficients of friction and the lowest loads that will be asked for.
    rtol : float
        Of the dissipation.
    tolerance : float
        Of the solves.
    max_unknowns : int
    """

    def __init__(
        self,
        scene: Scene,
        frictions: Sequence[float],
        lowest: Sequence[float],
        rtol: float,
        tolerance: float,
        max_unknowns: int,
    ) -> None:
        self._rtol = rtol
        continuation = Continuation(tolerance, (*ASKED, "critical_friction"), max_unknowns)
        self._solve: Callable[[float], Solution] = lambda f: continuation.solve(
            scene.replace(friction=f)
        )
        self._stick = self._solve(math.inf)
        critical = self._stick.critical_friction
        #: within the error of the critical friction no digit of the slip is known
        self._margin = 0.0
        if critical < math.inf:
            self._margin = critical * (self._stick.error.critical_friction or 0.0)
        loop_frictions = [loop_friction(f, load) for f in frictions for load in lowest]
        slipping = [f for f in loop_frictions if 0.0 < f < critical - self._margin]
        least = min(slipping, default=critical)
        largest = max(slipping, default=critical)
        if critical < math.inf:
            largest = min(largest, critical - _NEAR_SHAKEDOWN * (critical - least))
        scale = abs(scene.kappa) + least
        self._curve = MeanSlipCurve(self._solve, least, largest, critical, scale, rtol)

    def cycle(self, scene: Scene, lowest: float) -> SteadyCycle:
        """Return the steady loop of a scene with another friction."""
        friction = scene.friction
        assert friction is not None
        critical = self._stick.critical_friction
        critical_error = self._stick.error.critical_friction or 0.0
        ratio, ratio_error = shakedown(critical, critical_error, friction)
        loop_f = loop_friction(friction, lowest)
        at_shakedown = critical > 0.0 and abs(loop_f - critical) <= self._margin
        if at_shakedown:
            loop = replace(self._stick, scene=scene.replace(friction=loop_f))
        else:
            loop = self._solve(loop_f)
        with_more_friction = [
            state for state in self._curve.states if (state.scene.friction or 0.0) > loop_f
        ]
        states = (loop, *with_more_friction, self._stick)
        if at_shakedown:
            unloading = reloading = ValueWithError(0.0, 1.0)
        else:
            unloading, reloading = self._dissipated(friction, lowest, loop)
        slack = forward_slack(states, friction)
        nothing_slips_forward = slack >= -slack_rounding(states)
        unloading_error = _relative(unloading) if nothing_slips_forward else None
        total_error = _relative(_sum(unloading, reloading)) if nothing_slips_forward else None
        cycle = SteadyCycle(
            scene,
            lowest,
            self._rtol,
            states,
            float(ratio),
            reloading.value,
            unloading.value if nothing_slips_forward else None,
            slack,
            CycleErrors(
                shakedown_ratio=float(ratio_error),
                stick_radius=_width_of_slip(scene, critical_error)
                if at_shakedown
                else loop.error.stick_radius,
                slip_amplitude=1.0 if at_shakedown else loop.error.slip,
                traction=max(loop.error.traction or 0.0, loop.error.pressure or 0.0),
                reloading_dissipation=_relative(reloading),
                unloading_dissipation=unloading_error,
                dissipation=total_error,
            ),
        )
        within_rtol = at_shakedown or cycle.worst_error <= self._rtol
        return replace(cycle, converged=loop.converged and within_rtol)

    def _dissipated(
        self, friction: float, lowest: float, loop: Solution
    ) -> tuple[ValueWithError, ValueWithError]:
        """Return the energies dissipated in unloading and in reloading, with absolute errors.

        These are W_down and W_up of docs/cycles, with the friction f as variable of the integrals.
        """
        mean = mean_slip(loop)
        if mean.value == 0.0 or friction == 0.0:
            nothing = ValueWithError(0.0, 0.0 if friction == 0.0 else mean.error)
            return nothing, nothing
        loop_f = loop_friction(friction, lowest)
        # loop_f - friction without cancellation where the lowest load is small
        excess = 2.0 * friction * max(lowest, _LEAST_LOAD) / (1.0 - lowest)
        # over the friction x = loop_f + beyond, with the weight 4 f**2/(x + f)**3
        unloading = self._curve.integrate(
            lambda beyond: (
                4.0 * (friction / (loop_f + beyond + friction)) ** 2 / (loop_f + beyond + friction)
            ),
            loop_f,
            loop_f + friction,
        )
        # with the weight 4 lambda**2 f**2/(x - f)**3, where x - f = excess + beyond
        reloading = self._curve.integrate(
            lambda beyond: ((1.0 - lowest) * excess / (excess + beyond)) ** 2 / (excess + beyond),
            loop_f,
            excess,
        )
        # the term at the end of the loop, (1 - lambda) A(f')
        end_term = (1.0 - lowest) * mean.value
        end_term_error = math.inf if loop.ending is Ending.ZONES else end_term * mean.error
        return (
            ValueWithError(
                friction * (lowest * end_term + unloading.value),
                friction * (lowest * end_term_error + unloading.error),
            ),
            ValueWithError(
                friction * (end_term - reloading.value),
                friction * (end_term_error + reloading.error),
            ),
        )


def _width_of_slip(scene: Scene, critical_error: float) -> float:
    """Return the error of the stick radius 1 of a loop that may slip after all.

    Its friction is the critical one within the error of that. Slip begins at the edge if
    alpha >= beta, else in an annulus, which may be anywhere.
    """
    at_edge = scene.normal_compliance >= scene.tangential_compliance
    return critical_error if at_edge else 1.0


def _sum(first: ValueWithError, second: ValueWithError) -> ValueWithError:
    return ValueWithError(first.value + second.value, first.error + second.error)


def _relative(energy: ValueWithError) -> float:
    """Return the error of an energy over its value; of the value 0 the error, and 1 at most."""
    return energy.error / energy.value if energy.value > 0.0 else min(energy.error, 1.0)


def loop_friction(friction: float, lowest: float) -> float:
    """Return the friction under which unit load has the zones of a loop."""
    return friction * (1.0 + lowest) / (1.0 - lowest)
