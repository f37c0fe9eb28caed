"""Pull-off of adhesive contacts, and the whole cycle of approach and retraction."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from dataclasses import replace
from math import inf, pi
from typing import Any

import numpy as np

from spectral_contact.contact.adhesion import (
    BY_APPROACH,
    BY_LOAD,
    AdhesiveCurve,
    Control,
    Fold,
    NoState,
    radius_effects,
)
from spectral_contact.contact.contact_radius import value_of
from spectral_contact.contact.on_parts import Indentation
from spectral_contact.contact.tuning import ROUNDING
from spectral_contact.errors import ConvergenceError, NotComputedError, SceneError
from spectral_contact.fields.cycle import AdhesionCycle, CycleState
from spectral_contact.io.checks import flag, positive, whole, within
from spectral_contact.io.choices import instance, one_of, suggesting
from spectral_contact.profiles import Flat
from spectral_contact.profiles.control import CONTROLS
from spectral_contact.scene import Scene
from spectral_contact.solution import Solution
from spectral_contact.solving.adhesive import (
    CONTROLS_HELD,
    curve_of,
    pinned_of,
    refuse_reach,
    with_surface_energy,
)
from spectral_contact.solving.asked import checked_tolerance
from spectral_contact.solving.planning import plan
from spectral_contact.solving.solver import solve
from spectral_contact.threads import one_thread

#: Least number of points of a cycle.
_FEWEST_POINTS = 2
#: Largest number of points of a cycle.
_MOST_POINTS = 100_000
#: One of this many points of a cycle is on the unstable part, at radii below that of pull-off.
_POINTS_PER_UNSTABLE = 4
#: Radius at which the unstable part ends, over the radius of pull-off. Under a profile with a flat
#: part there is no such part. Radii are then graded to the rim, and the least distance from it is
#: the largest one times the square of this number.
_UNSTABLE_END = 0.02
#: Tolerances of a cycle, which has no fields.
_TOLERANCES = "in [1e-12, 1e-2]"


@suggesting()
def pull_off(
    scene: Scene,
    control: str = "load",
    *,
    machine_stiffness: float | None = None,
    rtol: float = 1e-10,
    quantities: Iterable[str] | None = None,
    max_unknowns: int = 20_000,
    strict: bool = True,
) -> Solution:
    """Return the last stable state of an adhesive contact that is taken back.

    Parameters
    ----------
    scene : Scene
        With a work of adhesion; what is given of load, approach and contact radius does not matter.
    control : str
        What is held: "load" or "approach".
    machine_stiffness : float, optional
        Stiffness k of a machine between the punch and what moves, with control of the approach: it
        is ``delta + P/k`` that is held. In E'L, of a scene with SI data in N/m.
    rtol, quantities, max_unknowns, strict
        As of `solve`. At a fold `rtol` bounds the error of what is held, which is stationary there.
        The radius is less certain, and so are the pressure and what is not held: their errors are
        in ``error``, and ``less_certain`` names those above `rtol`.

    Returns
    -------
    Solution
        Of the scene at the contact radius of pull-off, whose error is in ``error.contact_radius``;
        under a flat punch, at the load or approach of pull-off.

    Raises
    ------
    SceneError
        For an argument out of its range, a scene without adhesion, or one in which no contact
        smaller than the profile is stable.
    NotComputedError
        If the contact shrinks to a point before it comes off, as it may under a tip.
    ConvergenceError
        As `solve`.

    Examples
    --------
    >>> from spectral_contact import Scene, profiles, pull_off
    >>> ball = profiles.Parabola(radius=1.0)
    >>> last = pull_off(Scene(0.3, profile=ball, load=0.0, work_of_adhesion=0.1))
    >>> print(f"{last.load / (3.141592653589793 * 0.1):.6f}")
    -1.500000
    """
    held = _control_held(scene, control, machine_stiffness)
    names = plan(scene, quantities).quantities
    rtol = checked_tolerance(rtol, names)
    max_unknowns = whole("max_unknowns", max_unknowns, 1)
    options: dict[str, Any] = {
        "rtol": rtol,
        "quantities": names,
        "max_unknowns": max_unknowns,
        "strict": flag("strict", strict),
    }
    with one_thread():
        if isinstance(scene.profile, Flat):
            return solve(_flat_at_pull_off(scene, control, rtol, max_unknowns), **options)
        curve = curve_of(scene, rtol, max_unknowns)
        _, fold = _ends(held, _folds(scene, curve, held))[-1]
        solution = _with_errors(solve(_at_radius(scene, fold.radius), **options), curve, fold)
    control_error = getattr(solution.error, control)
    if control_error is None or control_error <= rtol:
        return solution
    solution = replace(solution, converged=False)
    if strict:
        estimate = f"the error estimate {control_error:.1e} of the {control}"
        cause = f"{estimate} does not meet rtol = {rtol:.1e}"
        raise ConvergenceError(cause, "Loosen rtol, or use strict=False.", solution)
    return solution


@suggesting()
def adhesion_cycle(
    scene: Scene,
    control: str = "approach",
    *,
    machine_stiffness: float | None = None,
    points: int = 200,
    rtol: float = 1e-10,
    max_unknowns: int = 20_000,
) -> AdhesionCycle:
    """Return load against approach over a whole cycle of adhesive contact.

    The punch comes to the surface, contact jumps in, is pressed to the state of the scene, taken
    back, and jumps out. Both jumps are at the ends of stable states; between them are, in the
    arrays, those that are not stable.

    Parameters
    ----------
    scene : Scene
        With a work of adhesion and a profile that is not flat. Its state is the largest contact of
        the cycle, unless the one after the jump into contact is larger.
    control, machine_stiffness
        As of `pull_off`.
    points : int
        Of the arrays, from 2 to 100,000.
    rtol : float
        Bound on the relative errors, in [1e-12, 1e-2].
    max_unknowns : int
        As of `solve`.

    Returns
    -------
    AdhesionCycle
        `plotting.plot_adhesion_cycle` draws it.

    Raises
    ------
    SceneError, NotComputedError
        As `pull_off`.
    """
    held = _control_held(scene, control, machine_stiffness)
    points = whole("points", points, _FEWEST_POINTS)
    rtol = within("rtol", rtol, _TOLERANCES)
    max_unknowns = whole("max_unknowns", max_unknowns, 1)
    if points > _MOST_POINTS:
        raise SceneError("points", points, f"at most {_MOST_POINTS}")
    if isinstance(scene.profile, Flat):
        allowed = "not flat: the cycle of a flat punch is a straight line, which ends at pull_off"
        raise SceneError("profile", scene.profile, allowed)
    with one_thread():
        curve = curve_of(scene, rtol, max_unknowns)
        folds = _folds(scene, curve, held)
        ends = _ends(held, folds)
        first_state = _first_contact(scene, curve, held)
        radii = _radii(scene, curve, ends, first_state, points)
        states = curve.states(radii)
        stable = [sum(state.radius > a for state in folds) % 2 == 0 for a in radii]
        jump_out, jump_states = _jumps_out(curve, held, ends)
    # Jumps dissipate the energy before less that after, which is 0 without contact. In this list
    # the states are those after a jump and before the next one, by turns.
    energies = [_energy(held, state, curve.adhesion) for state in (first_state, *jump_states)]
    dissipated = sum(energies[1::2]) - sum(energies[::2])
    dissipation_error = sum(
        _energy_error(held, state, curve) for state in (first_state, *jump_states)
    )
    profile_error = max(map(curve.profile._relative_error, radii))
    controls_approach = held.of_approach > 0.0
    # with control of the load the energy is not given: it falls without bound after the last jump
    return AdhesionCycle(
        scene,
        control,
        None if machine_stiffness is None else 1.0 / held.of_load,
        np.array(radii),
        np.array([state.approach for state in states]),
        np.array([state.load for state in states]),
        np.array(stable),
        max(max(state.load_error, state.approach_error) for state in states) + profile_error,
        (_NO_CONTACT, _cycle_state(first_state)),
        jump_out,
        dissipated if controls_approach else None,
        dissipation_error if controls_approach else None,
    )


#: No contact, at the approach at which it begins.
_NO_CONTACT = CycleState(0.0, 0.0, 0.0)


def _control_held(scene: Scene, control: str, machine_stiffness: float | None) -> Control:
    """Return the control by its name and the machine; refuse a scene without adhesion."""
    if instance("scene", scene, Scene).work_of_adhesion is None:
        raise SceneError("scene", scene, "one with a work_of_adhesion")
    one_of("control", control, CONTROLS_HELD)
    if machine_stiffness is None:
        return BY_LOAD if control == "load" else BY_APPROACH
    unit = "" if scene.physical is None else "N/m"
    stiffness = positive("machine_stiffness", machine_stiffness, unit)
    if control == "load":
        allowed = "None under control of the load, to which a machine adds nothing"
        raise SceneError("machine_stiffness", machine_stiffness, allowed)
    stiffness /= _modulus(scene)
    if not 1.0 / sys.float_info.max <= stiffness < inf:
        raise SceneError("machine_stiffness", machine_stiffness, "in [1e-308, 1e308], in E'L")
    return Control(1.0 / stiffness, 1.0)


def _modulus(scene: Scene) -> float:
    """Return E' [Pa]; 1 of a scene without SI data."""
    data = scene.physical
    return 1.0 if data is None else data.quarter_modulus(scene.poisson_ratio)


def _flat_at_pull_off(scene: Scene, control: str, rtol: float, max_unknowns: int) -> Scene:
    """Return the scene of a flat punch at pull-off, which does not depend on a machine."""
    contact = pinned_of(scene, rtol, max_unknowns, pointwise=False)
    if control == "approach":
        return _changed(scene, "approach", contact.pull_off_approach)
    return _changed(scene, "load", contact.pull_off_load * _modulus(scene))


def _at_radius(scene: Scene, radius: float) -> Scene:
    """Return the scene at the contact radius of pull-off.

    The radius follows from the work of adhesion, which an error names.
    """
    try:
        return _changed(scene, "contact_radius", radius)
    except SceneError as refused:
        allowed = f"such that the contact_radius of pull-off, {radius:.3g}, is {refused.allowed}"
        raise SceneError("work_of_adhesion", scene.work_of_adhesion, allowed) from None


def _changed(scene: Scene, name: str, value: float) -> Scene:
    """Return a scene in which one control, such as the load, is given in place of another."""
    return scene.replace(**{**dict.fromkeys(CONTROLS), "branch": 0, name: value})


def _folds(scene: Scene, curve: AdhesiveCurve, held: Control) -> list[Fold]:
    """Return the folds, from large contacts to small ones; even ones end stable stretches.

    Raises
    ------
    SceneError
        If no contact smaller than the profile is stable.
    NotComputedError
        If the contact shrinks to a point.
    """
    try:
        folds = list(curve.folds(held))
    except NoState:
        refuse_reach(scene, "work_of_adhesion")
    if not folds:
        reason = "the contact shrinks to a point before it comes off"
        raise NotComputedError("pull_off", reason)
    return folds


def _ends(held: Control, folds: list[Fold]) -> list[tuple[int, Fold]]:
    """Return the folds at which a contact that is taken back jumps, with the numbers of branches.

    Stable stretches end at folds with even numbers. At such a fold the contact jumps to the next
    stable stretch, of smaller contacts, whose fold has a lower load, or approach, than this one; at
    the last one it comes off.
    """
    ends: list[tuple[int, Fold]] = []
    for number, fold in enumerate(folds):
        lower = not ends or held.value(fold.state) < held.value(ends[-1][1].state)
        if number % 2 == 0 and lower:
            ends.append((number, fold))
    return ends


def _with_errors(solution: Solution, curve: AdhesiveCurve, fold: Fold) -> Solution:
    """Return the solution at a fold with the errors by that of its radius."""
    if fold.curve is None:
        return solution
    errors: dict[str, float] = {"contact_radius": fold.error}
    rates = curve.rates(fold.state)
    effects = radius_effects(fold.state, rates, fold.error)
    # the work grows by P ddelta along the curve
    work = abs(fold.state.load * rates.approach) / solution.error_scales["indentation_work"]
    effects["indentation_work"] = work * fold.error
    for name, change in effects.items():
        estimate = getattr(solution.error, name)
        if estimate is not None:
            errors[name] = estimate + change
    return replace(solution, error=replace(solution.error, **errors))


def _first_contact(scene: Scene, curve: AdhesiveCurve, held: Control) -> Indentation:
    """Return the state after the jump into contact, at a load or approach of 0.

    It is on the stable stretch of the largest contacts.
    """
    try:
        return value_of(curve.find(held, 0.0, 0, pointwise=False)[0])
    except NoState:
        refuse_reach(scene, "work_of_adhesion")


def _radii(
    scene: Scene,
    curve: AdhesiveCurve,
    ends: list[tuple[int, Fold]],
    first_state: Indentation,
    points: int,
) -> list[float]:
    """Return the radii of the points, from large contacts to small ones."""
    given_state = solve(
        scene, curve.tolerance, ("contact_radius",), max_unknowns=curve.max_unknowns
    )
    largest = max(given_state.contact_radius, first_state.radius)
    at_pull_off = ends[-1][1].radius
    flat = curve.profile.flat_part
    if flat > 0.0:
        # radii down to the rim of the flat part, where contact ends
        beyond_rim = np.geomspace(
            largest - flat, _UNSTABLE_END * _UNSTABLE_END * (largest - flat), points - 1
        )
        return [*(flat + beyond_rim).tolist(), flat]
    unstable_count = points // _POINTS_PER_UNSTABLE
    stable = np.geomspace(
        largest, at_pull_off, points - unstable_count, endpoint=not unstable_count
    )
    return [
        *stable.tolist(),
        *np.geomspace(at_pull_off, _UNSTABLE_END * at_pull_off, unstable_count).tolist(),
    ]


def _jumps_out(
    curve: AdhesiveCurve, held: Control, ends: list[tuple[int, Fold]]
) -> tuple[tuple[CycleState, ...], list[Indentation]]:
    """Return states before and after every jump, and those of them that are in contact."""
    states: list[Indentation] = []
    for k, (_, fold) in enumerate(ends):
        states.append(fold.state)
        if k + 1 < len(ends):
            landing, _ = curve.find(held, held.value(fold.state), ends[k + 1][0], pointwise=False)
            states.append(value_of(landing))
    jumps = [_cycle_state(state) for state in states]
    if held.of_approach > 0.0:
        jumps.append(CycleState(0.0, held.value(states[-1]), 0.0))
    return tuple(jumps), states


def _cycle_state(state: Indentation) -> CycleState:
    return CycleState(state.radius, state.approach, state.load)


def _energy(held: Control, state: Indentation, adhesion: float) -> float:
    """Return the energy of contact, surfaces and machine, which a jump lowers.

    It is for control of the approach, through a machine of stiffness ``1/held.of_load``, if any.
    """
    return with_surface_energy(state, adhesion).work + held.of_load * state.load**2 / 2.0


def _energy_error(held: Control, state: Indentation, curve: AdhesiveCurve) -> float:
    """Return the absolute error of `_energy`.

    Elastic and surface energy, of which it is the difference, are rounded, and have the error of
    the profile.
    """
    surface = pi * curve.adhesion * state.radius**2
    relative_error = ROUNDING + curve.profile._relative_error(state.radius)
    spring = held.of_load * abs(state.load) * state.load_size * (state.load_error + relative_error)
    return state.work * state.work_error + relative_error * (state.work + surface) + spring
