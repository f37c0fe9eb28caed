"""The plan of a solve: which steps a scene and the quantities asked for need, and why.

Nothing is computed here.
"""

from __future__ import annotations

import math
from collections.abc import Iterable

from spectral_contact.io.choices import instance, suggesting
from spectral_contact.layers.scene_layer import endless
from spectral_contact.profiles import Flat
from spectral_contact.quantities import (
    FLAT_QUANTITIES,
    FULL_STICK_RATIOS,
    TANGENTIAL_QUANTITIES,
)
from spectral_contact.scene import Scene
from spectral_contact.solution import (
    ADHESION_QUANTITIES,
    COUPLING,
    FULL_STICK,
    GROWTH,
    LOAD_RATIOS,
    NORMAL,
    PARTIAL_SLIP,
    PROFILE_QUANTITIES,
    QUANTITIES,
    SLIP_FIELD,
    UNLOADED_QUANTITIES,
    UNLOADING,
    ZONE_SEARCH,
    Plan,
    PlannedStep,
    StepState,
)
from spectral_contact.solving.asked import asked_quantities

_NO_FRICTION = "the scene has no friction coefficient"
#: Quantities that are proportional to the load as long as nothing slips.
_PROPORTIONAL_TO_LOAD = frozenset({"approach", "pressure", "traction", "slip", "total_shear"})


@suggesting()
def plan(scene: Scene, quantities: Iterable[str] | None = None) -> Plan:
    """Return the shortest list of steps that yields the quantities, each with its reason.

    Parameters
    ----------
    scene : Scene
    quantities : iterable of str, optional
        Names out of `QUANTITIES`; with a profile also out of `PROFILE_QUANTITIES`, with adhesion
        also out of `ADHESION_QUANTITIES`, and below the largest load also out of
        `UNLOADED_QUANTITIES`. The default is everything that the scene has except
        `UNLOADED_QUANTITIES`, which cost more than all the rest.

    Returns
    -------
    Plan
        Nothing is computed. Steps marked "if needed" depend on the outcome of earlier ones.

    Raises
    ------
    SceneError
        If a name is not one of these, or `scene` is not a `Scene`.
    """
    has_profile = instance("scene", scene, Scene).profile is not None
    unloaded = scene.unloaded_to < 1.0
    asked = asked_quantities(
        quantities,
        has_profile=has_profile,
        adhesive=scene.work_of_adhesion is not None,
        unloaded=unloaded,
    )
    possible = possible_quantities(scene)
    missing = {name: "it was not asked for" for name in possible if name not in asked}
    if scene.friction is None:
        for name in {"slip", *FULL_STICK_RATIOS, *UNLOADED_QUANTITIES}.intersection(possible):
            missing[name] = _NO_FRICTION
    elif has_profile:
        reason = "it is not computed for growing contacts"
        if isinstance(scene.profile, Flat):
            reason = "it is not computed under a flat punch that is given as a profile"
            missing["slip"] = reason
        elif scene.friction == 0.0:
            missing["slip"] = "it is not computed at friction 0 under a profile"
        missing.update(dict.fromkeys(FLAT_QUANTITIES, reason))
    elif scene.couples:
        # a scene with friction 0 or kappa 0 does not couple, and has the ratio 1 or 0 exactly
        missing["shakedown_ratio"] = "with elastic coupling its law is only approximate"
    if endless(scene):
        missing["contact_radius"] = "the layer law has no contact edge"
    present = tuple(name for name in possible if name not in missing)
    steps = *_coupling(scene, present), _normal(scene, present), _tangential(scene, present)
    if not has_profile:
        slip_steps = _partial_slip(scene, present)
        steps += slip_steps
        if unloaded:
            steps += _unloading(slip_steps[0], present)
    return Plan(present, steps, tuple(sorted(missing.items())))


def possible_quantities(scene: Scene) -> tuple[str, ...]:
    """Return the names of all quantities that a scene of this kind can have."""
    if scene.profile is None:
        thresholds = UNLOADED_QUANTITIES if scene.unloaded_to < 1.0 else ()
        return QUANTITIES + thresholds
    adhesion_quantities = ADHESION_QUANTITIES if scene.work_of_adhesion is not None else ()
    return PROFILE_QUANTITIES + adhesion_quantities + QUANTITIES


def _no_traction_condition(scene: Scene) -> str:
    """Return the condition, as text, under which the pressure drives no traction.

    It is empty if the pressure drives one, or without friction.
    """
    if scene.friction is None or scene.kappa != 0.0:
        return ""
    return "at nu = 0.5" if scene.mismatch is None else "at kappa = 0"


def _traction_dependent(scene: Scene) -> frozenset[str]:
    """Return the quantities that depend on the traction.

    With coupling these are all quantities but those of adhesion.
    """
    return frozenset((*QUANTITIES, *PROFILE_QUANTITIES)) if scene.couples else TANGENTIAL_QUANTITIES


def _coupling(scene: Scene, present: tuple[str, ...]) -> tuple[PlannedStep, ...]:
    """Return the step of elastic coupling, with its reason.

    There is no step if the scene does not ask for coupling.
    """
    if not scene.coupling:
        return ()
    state = StepState.SKIPPED
    if scene.friction is None:
        reason = f"{_NO_FRICTION}: no traction acts back on the pressure"
    elif _no_traction_condition(scene):
        reason = f"{_no_traction_condition(scene)} the pressure drives no traction"
    elif scene.friction == 0.0:
        reason = "at friction 0 no traction acts back on the pressure"
        if not FULL_STICK_RATIOS.isdisjoint(present):
            state = StepState.RUN
            reason = "the ratios q/p are those of coupled full stick"
    elif not _needs_tangential(scene, present):
        reason = "nothing asked for depends on the traction"
    else:
        state = StepState.RUN
        reason = "the scene asks for it: pressure and traction are one system"
    return (PlannedStep(COUPLING, state, reason),)


def _needs_tangential(scene: Scene, present: Iterable[str]) -> bool:
    """Return whether anything asked for needs the tangential problem solved.

    Nothing does without friction, or where the pressure drives no traction. Some quantities are
    known in advance: at friction 0 all but the slip and the ratios of full stick, at infinite
    friction the zones and the slip.
    """
    if scene.friction is None or _no_traction_condition(scene):
        return False
    asked = _traction_dependent(scene).intersection(present)
    if scene.friction == 0.0:
        # the slip is the displacement by the pressure, which is computed for it
        return bool(asked & (FULL_STICK_RATIOS | {"slip"}))
    if scene.friction == math.inf:
        return bool(asked - {"zones", "stick_radius", "slip", *UNLOADED_QUANTITIES})
    return bool(asked)


def _normal(scene: Scene, present: tuple[str, ...]) -> PlannedStep:
    """Return the step of normal contact, with its reason."""
    smooth_surface = scene.normal_compliance == 0.0 and scene.layer is None
    remark = "; closed form, the surface is smooth" if smooth_surface else ""
    if scene.work_of_adhesion is not None:
        remark += "; adhesion pulls at the edge"
    needs_tangential = _needs_tangential(scene, present)
    if scene.couples and needs_tangential:
        return PlannedStep(NORMAL, StepState.SKIPPED, "the pressure is found with the traction")
    if "pressure" in present:
        reason = "the pressure is asked for"
    elif needs_tangential:
        reason = "the pressure drives the tangential displacement"
    elif {"approach", *PROFILE_QUANTITIES, *ADHESION_QUANTITIES}.intersection(present):
        reason = "the approach alone" if scene.profile is None else "integrals alone"
        if not smooth_surface:
            reason += ", at low degree"
    else:
        return PlannedStep(NORMAL, StepState.SKIPPED, "nothing asked for depends on the pressure")
    return PlannedStep(NORMAL, StepState.RUN, reason + remark)


def _tangential(scene: Scene, present: tuple[str, ...]) -> PlannedStep:
    """Return the step by which the traction is found: full stick, or a growing contact.

    On a contact area that does not change, full stick does not depend on the history.
    """
    grows = not isinstance(scene.profile, Flat | None)
    state = StepState.SKIPPED
    if scene.friction is None:
        reason = _NO_FRICTION
    elif _no_traction_condition(scene):
        reason = (
            f"{_no_traction_condition(scene)} the pressure drives no traction: all stick, q = 0"
        )
    elif scene.friction == 0.0 and FULL_STICK_RATIOS.isdisjoint(present):
        reason = "at friction 0 everything slips"
    elif not _needs_tangential(scene, present):
        reason = "nothing asked for depends on the traction"
    else:
        state = StepState.RUN
        if grows:
            reason = "the traction is a superposition of flat punches over the contact radius"
        elif (
            scene.friction == 0.0
            or _traction_dependent(scene).intersection(present) <= FULL_STICK_RATIOS
        ):
            reason = "a ratio q/p of full stick is asked for"
        elif scene.friction == math.inf:
            reason = "friction is infinite: no slip"
        else:
            reason = "decides whether there is slip"
    return PlannedStep(GROWTH if grows else FULL_STICK, state, reason)


def _partial_slip(scene: Scene, present: tuple[str, ...]) -> tuple[PlannedStep, ...]:
    """Return the steps of partial slip, of its zones and of its slip, with their reasons."""
    friction = scene.friction
    asked = _traction_dependent(scene).intersection(present)

    def skipped(reason: str) -> tuple[PlannedStep, ...]:
        names = (PARTIAL_SLIP, ZONE_SEARCH, SLIP_FIELD)
        return tuple(PlannedStep(name, StepState.SKIPPED, reason) for name in names)

    if friction is None:
        return skipped(_NO_FRICTION)
    if friction == math.inf:
        return skipped("friction is infinite: no slip")
    if _no_traction_condition(scene):
        return skipped(f"{_no_traction_condition(scene)} nothing slips")
    if not asked - FULL_STICK_RATIOS:
        return skipped("nothing asked for depends on slip")
    if friction == 0.0:
        first, second, third = skipped("at friction 0 everything slips")
        if "slip" in present:
            third = PlannedStep(SLIP_FIELD, StepState.RUN, "the slip is asked for")
        return first, second, third
    if scene.tangential_compliance == 0.0:
        state = StepState.RUN
        reason = "without tangential compliance the edge slips at any finite friction"
    else:
        state = StepState.CONDITIONAL
        reason = "only if the friction is below the critical one"
    partial = PlannedStep(PARTIAL_SLIP, state, reason)
    reason = "only if partial slip with one central stick disk violates the friction law"
    search = PlannedStep(ZONE_SEARCH, StepState.CONDITIONAL, reason)
    reason = "only if there is slip; it also checks that slip opposes the traction"
    return partial, search, PlannedStep(SLIP_FIELD, StepState.CONDITIONAL, reason)


def _unloading(slip_step: PlannedStep, present: tuple[str, ...]) -> tuple[PlannedStep, ...]:
    """Return the steps of unloading, given the planned step of partial slip at the largest load."""
    if slip_step.state is StepState.SKIPPED:
        reason = slip_step.reason
        if not _PROPORTIONAL_TO_LOAD.isdisjoint(present):
            reason += "; what is proportional to the load is multiplied by the load ratio"
        return tuple(
            PlannedStep(name, slip_step.state, reason) for name in (UNLOADING, LOAD_RATIOS)
        )
    reason = "only if there is slip at the largest load"
    unloading = PlannedStep(UNLOADING, StepState.CONDITIONAL, reason)
    if set(UNLOADED_QUANTITIES).isdisjoint(present):
        load_ratios_step = PlannedStep(LOAD_RATIOS, StepState.SKIPPED, "no load ratio is asked for")
    else:
        reason += (
            ": the load ratios at which slip back begins and at which a slip zone begins to shrink"
        )
        load_ratios_step = PlannedStep(LOAD_RATIOS, StepState.CONDITIONAL, reason)
    return unloading, load_ratios_step
