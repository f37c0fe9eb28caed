"""Hypothesis strategies for scenes, which cover the space of parameters (extra ``testing``).

Two corners are left out, as they are slow or ill-conditioned and need tests of their own:
friction from 0.99 of the critical one up to it, and a tangential compliance below 1e-9 with a
normal one below a tenth of it.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import lru_cache
from typing import TYPE_CHECKING

from spectral_contact.errors import MissingDependencyError, SceneError
from spectral_contact.io.checks import within
from spectral_contact.io.choices import instance
from spectral_contact.scene import Scene
from spectral_contact.solving.solver import solve

try:
    from hypothesis import assume
    from hypothesis import strategies as st
except ImportError as missing:
    raise MissingDependencyError("hypothesis", "testing") from missing

if TYPE_CHECKING:
    from hypothesis.strategies import DrawFn, SearchStrategy

__all__ = [
    "compliances",
    "coupled_stick_scenes",
    "frictionless_scenes",
    "full_stick_scenes",
    "partial_slip_scenes",
    "poisson_ratios",
    "powers_of_ten",
    "scenes",
]


def powers_of_ten(low: float, high: float) -> SearchStrategy[float]:
    """Return numbers from ``10**low`` to ``10**high``, evenly by their logarithm.

    Raises
    ------
    SceneError
        If the exponents are not real numbers in [-300, 300], or not in their order.
    """
    lowest = within("low", low, "in [-300, 300]")
    highest = within("high", high, "in [-300, 300]")
    if lowest > highest:
        raise SceneError("low, high", (low, high), "in their order")
    return st.floats(lowest, highest).map(lambda exponent: 10.0**exponent)


def compliances() -> SearchStrategy[float]:
    """Return 0, any compliance of twenty-eight decades, or a moderate one."""
    return st.one_of(st.just(0.0), powers_of_ten(-13.9, 13.9), powers_of_ten(-4, 2))


def poisson_ratios() -> SearchStrategy[float]:
    """Return Poisson's ratios at which kappa is not 0, from -0.99 to 0.499."""
    return st.floats(-0.99, 0.499)


def frictionless_scenes() -> SearchStrategy[Scene]:
    """Return scenes of the normal problem alone."""
    return st.builds(Scene, poisson_ratios(), compliances())


def scenes(friction: SearchStrategy[float | None]) -> SearchStrategy[Scene]:
    """Return scenes with any compliances.

    Parameters
    ----------
    friction : strategy
        Of the coefficient of friction.

    Raises
    ------
    SceneError
        If it is no strategy.
    """
    return _scenes(instance("friction", friction, st.SearchStrategy))


@st.composite
def _scenes(draw: DrawFn, friction: SearchStrategy[float | None]) -> Scene:
    alpha = draw(compliances())
    beta = draw(compliances())
    assume(not (0.0 < beta < 1e-9 and alpha < beta / 10.0))
    return Scene(draw(poisson_ratios()), alpha, beta, draw(friction))


def full_stick_scenes() -> SearchStrategy[Scene]:
    """Return scenes of infinite friction."""
    return scenes(st.just(math.inf))


def coupled_stick_scenes() -> SearchStrategy[Scene]:
    """Return scenes of infinite friction with elastic coupling."""
    return full_stick_scenes().map(lambda scene: replace(scene, coupling=True))


@st.composite
def partial_slip_scenes(draw: DrawFn) -> Scene:
    """Return scenes with friction from a thousandth of the critical one to 0.99 of it."""
    scene = draw(full_stick_scenes())
    share = draw(st.one_of(st.floats(0.05, 0.98), powers_of_ten(-3, 0)))
    assume(share < 0.99)
    critical = _critical_friction(scene)
    if not math.isfinite(critical):
        # without tangential compliance the critical friction is infinite, and 5 kappa takes its
        # place. The stick radius is about 4 exp(-2 kappa/f); the solver takes one below 4e-59 for
        # full slip, so that the friction may not be too small
        critical = 5.0 * scene.kappa
        share = max(share, 0.02)
    return Scene(
        scene.poisson_ratio, scene.normal_compliance, scene.tangential_compliance, share * critical
    )


@lru_cache(maxsize=512)
def _critical_friction(scene: Scene) -> float:
    return float(solve(scene, 1e-8, ("critical_friction",)).critical_friction)
