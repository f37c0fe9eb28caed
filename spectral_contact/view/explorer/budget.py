"""How long a solve in the explorer may take, and which scenes are refused before one begins."""

from __future__ import annotations

from typing import Final

import numpy as np

from spectral_contact.records import COUPLING, GROWTH, Plan, StepState

#: A solve that takes longer than so many seconds is ended.
TIME_LIMIT: Final = 30.0
#: A scene whose estimate is above the limit by this factor is refused before it is solved. The
#: estimate knows the kind of a scene alone; a scene that takes three times less is still solved.
_SPREAD: Final = 3.0
_TOLERANCES: Final = (1e-4, 1e-6, 1e-8, 1e-10, 1e-12)
#: Median time in seconds of a solve to each of these tolerances, without and with elastic coupling,
#: where a contact with friction grows under a profile: a superposition of solves of flat punches.
#: Measured by `python validation/cost/explorer.py --budget`. The last one with coupling is a lower
#: bound: no solve of the sample was done after 600 s.
_GROWTH: Final = {False: (0.4, 0.5, 0.7, 1.3, 6.0), True: (2.0, 3.5, 7.0, 12.0, 600.0)}
#: The same of scenes in which no contact grows: the largest to any tolerance, in seconds.
_OTHERS: Final = 0.7


def expected_seconds(plan: Plan, rtol: float) -> float:
    """Return an estimate of the time that a plan takes to a tolerance, from its steps."""
    running = {step.name for step in plan.steps if step.state is StepState.RUN}
    if GROWTH not in running:
        return _OTHERS

    digits = -np.log10(_TOLERANCES)
    seconds = np.log(_GROWTH[COUPLING in running])
    return float(np.exp(np.interp(-np.log10(rtol), digits, seconds)))


def refusal(plan: Plan, rtol: float, seconds: float = TIME_LIMIT) -> str:
    """Return why a scene is not solved in the explorer, empty text if it is.

    Parameters
    ----------
    plan : Plan
        Of the scene.
    rtol : float
        The tolerance of the solve.
    seconds : float
        The time limit of a solve.
    """
    expected = expected_seconds(plan, rtol)
    if expected <= _SPREAD * seconds:
        return ""
    reason = next(step.reason for step in plan.steps if step.name == GROWTH)
    return (
        f"not solved here: {reason}, and at rtol = {rtol:g} that takes some {expected:.0f} s; "
        f"the explorer gives a scene {seconds:g} s. Choose a larger tolerance, or run this:"
    )


def overtime(seconds: float) -> str:
    """Return what is said of a scene whose solve was ended at the time limit."""
    return (
        f"ended after {seconds:g} s, which is what the explorer gives a scene. "
        "Choose a larger tolerance, or run this:"
    )
