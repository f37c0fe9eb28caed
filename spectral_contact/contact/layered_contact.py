"""Contact through a nonlinear layer, of an approach or under a load.

Where the contact has no radius of its own, which is under a flat punch or a law with pressure at
every gap, the load is a function of the approach, with the stiffness as derivative: its logarithm
bends down and itself up, so that Newton's method comes from either side without overshooting.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import inf, log, pi

import numpy as np

from spectral_contact.contact.indented import Indentation
from spectral_contact.contact.layered import LayeredProblem
from spectral_contact.contact.layered_newton import LayeredSetting
from spectral_contact.contact.layered_setting import setting_at_approach
from spectral_contact.contact.refine import Refinement, refine
from spectral_contact.errors import SceneError
from spectral_contact.layers.base import Layer
from spectral_contact.profiles import Profile

__all__ = ["layered_contact", "solve_layered"]

Contact = Refinement[Indentation]

#: Steps in all.
_STEPS = 100
#: Share of the tolerance that the load may be off, and its rounding.
_SHARE, _ROUNDING = 0.02, 2e-15
#: Where growth of the pressure with the load is looked for.
_PLACES = np.linspace(0.0, 1.0, 257)


def solve_layered(
    setting: LayeredSetting, tolerance: float, max_unknowns: int, *, pointwise: bool = True
) -> Contact:
    """Solve normal contact through a nonlinear layer in a setting.

    Parameters
    ----------
    setting : LayeredSetting
    tolerance : float
        Bound on the relative error of approach and load, and of the pressure if that is wanted.
    max_unknowns : int
        Most unknowns of a space.
    pointwise : bool
        Whether the pressure is wanted.
    """
    problem = LayeredProblem(setting, tolerance, pointwise=pointwise)
    return refine(problem, tolerance, max_unknowns)


def layered_contact(
    profile: Profile,
    layer: Layer,
    tolerance: float,
    max_unknowns: int,
    *,
    load: float | None,
    approach: float | None,
    pointwise: bool,
) -> Contact:
    """Return the contact of an approach or under a load, where it has no radius of its own.

    Parameters
    ----------
    profile : Profile
    layer : Layer
    tolerance, max_unknowns, pointwise
        As of `solve_layered`.
    load, approach : float or None
        One of them.

    Raises
    ------
    SceneError
        If the profile ends before the pressure does.
    """

    def solved(pointwise: bool) -> Callable[[float], Contact]:
        def at(approach: float) -> Contact:
            setting = setting_at_approach(profile, layer, approach)
            return solve_layered(setting, tolerance, max_unknowns, pointwise=pointwise)

        return at

    if approach is not None:
        return _exactly(solved(pointwise)(approach), approach)
    assert load is not None
    try:
        near = _searched(solved(False), _begin(layer, load), load, _SHARE * tolerance)
        found = _searched(solved(pointwise), near.best.value.approach, load, _SHARE * tolerance)
    except SceneError as error:
        told = f"what the profile carries before it ends: {error.allowed}"
        raise SceneError("load", load, told) from error
    return _under(found, load)


def _begin(layer: Layer, load: float) -> float:
    """Return an approach to begin with, at which something is carried."""
    return layer._overclosure(load) if layer.limit == inf else layer.start + layer._size


def _searched(
    solve: Callable[[float], Contact], approach: float, load: float, near: float
) -> Contact:
    """Step until the load is as near to what is asked for in its logarithm."""
    found, least = solve(approach), inf
    for _ in range(_STEPS):
        one = found.best.value
        off = log(one.load / load)
        if abs(off) <= max(near, _ROUNDING) or (abs(off) >= least and least < 1e3 * near):
            break
        least = min(least, abs(off))
        missing = (load - one.load) if off > 0.0 else -off * one.load
        found = solve(one.approach + missing / one.stiffness)
    return found


def _exactly(found: Contact, approach: float) -> Contact:
    """Return the contact of just this approach."""
    one = replace(found.best.value, approach=approach, approach_error=0.0)
    return replace(found, best=replace(found.best, value=one))


def _under(found: Contact, load: float) -> Contact:
    """Return the contact under just this load, whose error is that of the approach."""
    one = found.best.value
    off = one.load_error + 2.0 * abs(one.load / load - 1.0)
    moved = off * one.load / one.stiffness
    best = replace(
        one,
        load=load,
        load_error=0.0,
        approach_error=one.approach_error + moved / one.approach_size,
        work_error=one.work_error + one.load * moved / one.work,
        # as fast as the pressure itself at most
        stiffness_error=one.stiffness_error + off,
        pressure_error=one.pressure_error + off * _sharper(one),
    )
    return replace(found, best=replace(found.best, value=best))


def _sharper(one: Indentation) -> float:
    """Return by how much the pressure, or its mean, grows with the load, both relative."""
    if one.pressure is None or one.flat is None:
        return inf
    p, flat = one.pressure(_PLACES, 1.0 - _PLACES), one.flat(_PLACES, 1.0 - _PLACES)
    mean = one.load / (pi * one.radius**2)
    moved = flat / one.radius * one.load / one.stiffness
    return float((moved / np.maximum(p, mean)).max())
