"""What a scene calls for: a pure function from scene and quantities to the list of steps."""

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


@suggesting()
def plan(scene: Scene, quantities: Iterable[str] | None = None) -> Plan:
    """Return the shortest list of steps that yields the quantities, each with its reason.

    Parameters
    ----------
    scene : Scene
    quantities : iterable of str, optional
        Names out of `QUANTITIES`, with a profile out of `PROFILE_QUANTITIES`, with adhesion out of
        `ADHESION_QUANTITIES`, too, and below the largest load out of `UNLOADED_QUANTITIES`; the
        default is everything that the scene has but these.

    Returns
    -------
    Plan
        Nothing is computed. Steps marked "if needed" depend on the outcome of earlier ones.

    Raises
    ------
    SceneError
        For a name that is no quantity.
    """
    shaped = instance("scene", scene, Scene).profile is not None
    adhesive = scene.work_of_adhesion is not None
    unloaded = scene.unloaded_to < 1.0
    asked = asked_quantities(quantities, shaped=shaped, adhesive=adhesive, unloaded=unloaded)
    missing: dict[str, str] = {
        name: "it was not asked for" for name in _present(scene) if name not in asked
    }
    if scene.friction is None:
        for name in ("slip", *sorted(FULL_STICK_RATIOS)):
            missing[name] = _NO_FRICTION
        if unloaded:
            missing.update(dict.fromkeys(UNLOADED_QUANTITIES, _NO_FRICTION))
    elif scene.profile is not None:
        flat = isinstance(scene.profile, Flat)
        kind = "under profiles" if flat else "of growing contacts"
        lacking = ("slip",) if flat or scene.friction == 0.0 else ()
        for name in (*lacking, *sorted(FLAT_QUANTITIES)):
            missing[name] = f"it is not computed {kind}"
    elif scene.couples:
        missing["shakedown_ratio"] = "with elastic coupling its law is only approximate"
    if endless(scene):
        missing["contact_radius"] = "the layer law has no contact edge"
    present = tuple(name for name in _present(scene) if name not in missing)
    # full stick on an area that does not change depends on no history
    grows = not isinstance(scene.profile, Flat | None)
    last = (_growth if grows else _full_stick)(scene, present)
    steps = *_coupling(scene, present), _normal(scene, present), last
    if scene.profile is None:
        steps += _partial_slip(scene, present)
    if scene.unloaded_to < 1.0:
        steps += _unloading(steps[-1], present)
    return Plan(present, steps, tuple(sorted(missing.items())))


def _present(scene: Scene) -> tuple[str, ...]:
    """Return what scenes of this kind may have."""
    if scene.profile is None:
        return QUANTITIES + UNLOADED_QUANTITIES * (scene.unloaded_to < 1.0)
    more = ADHESION_QUANTITIES if scene.work_of_adhesion is not None else ()
    return (*PROFILE_QUANTITIES, *more, *QUANTITIES)


def _undriven(scene: Scene) -> str:
    """Return where the pressure drives no traction, for a reason; "" if it does."""
    if scene.friction is None or scene.kappa != 0.0:
        return ""
    return "at nu = 0.5" if scene.mismatch is None else "at kappa = 0"


def _affected(scene: Scene) -> frozenset[str]:
    """Return the quantities that depend on the traction."""
    return frozenset((*QUANTITIES, *PROFILE_QUANTITIES)) if scene.couples else TANGENTIAL_QUANTITIES


def _coupling(scene: Scene, present: tuple[str, ...]) -> tuple[PlannedStep, ...]:
    """Say whether the traction acts back on the pressure; without a word in the paper's model."""
    if not scene.coupling:
        return ()
    state = StepState.SKIPPED
    if scene.friction is None:
        reason = f"{_NO_FRICTION}: no traction acts back on the pressure"
    elif _undriven(scene):
        reason = f"{_undriven(scene)} pressure and traction do not move each other"
    elif scene.friction == 0.0 and not FULL_STICK_RATIOS.intersection(present):
        reason = "at friction 0 no traction acts back on the pressure"
    elif not _needs_tangential(scene, present):
        reason = "nothing asked for depends on the traction"
    else:
        state, reason = StepState.RUN, "the scene asks for it: pressure and traction are one system"
    return (PlannedStep(COUPLING, state, reason),)


def _needs_tangential(scene: Scene, present: Iterable[str]) -> bool:
    """Whether anything asked depends on a traction that is not zero by definition."""
    if scene.friction is None or _undriven(scene):
        return False
    asked = _affected(scene).intersection(present)
    if scene.friction == 0.0:
        return bool(asked & (FULL_STICK_RATIOS | {"slip"}))
    if scene.friction == math.inf:
        return bool(asked - {"zones", "stick_radius", "slip"})
    return bool(asked)


def _normal(scene: Scene, present: tuple[str, ...]) -> PlannedStep:
    bare = scene.normal_compliance == 0.0 and scene.layer is None
    smooth = "; closed form, the surface is smooth" if bare else ""
    if scene.work_of_adhesion is not None:
        smooth += "; adhesion pulls at the edge"
    if scene.couples and _needs_tangential(scene, present):
        return PlannedStep(NORMAL, StepState.SKIPPED, "the pressure is found with the traction")
    if "pressure" in present:
        return PlannedStep(NORMAL, StepState.RUN, "the pressure is asked for" + smooth)
    if _needs_tangential(scene, present):
        return PlannedStep(NORMAL, StepState.RUN, "the pressure drives the traction" + smooth)
    if {"approach", *PROFILE_QUANTITIES, *ADHESION_QUANTITIES}.intersection(present):
        what = "the approach" if scene.profile is None else "integrals"
        return PlannedStep(NORMAL, StepState.RUN, f"{what} alone, at low degree" + smooth)
    return PlannedStep(NORMAL, StepState.SKIPPED, "nothing asked for depends on the pressure")


def _growth(scene: Scene, present: tuple[str, ...]) -> PlannedStep:
    if scene.friction is None:
        return PlannedStep(GROWTH, StepState.SKIPPED, _NO_FRICTION)
    if scene.friction == 0.0:
        return PlannedStep(GROWTH, StepState.SKIPPED, "at friction 0 everything slips")
    if not _needs_tangential(scene, present):
        return PlannedStep(GROWTH, StepState.SKIPPED, "nothing asked for depends on the traction")
    reason = "the traction is a superposition of flat punches over the contact radius"
    return PlannedStep(GROWTH, StepState.RUN, reason)


def _full_stick(scene: Scene, present: tuple[str, ...]) -> PlannedStep:
    def step(state: StepState, reason: str) -> PlannedStep:
        return PlannedStep(FULL_STICK, state, reason)

    asked = _affected(scene).intersection(present)
    if scene.friction is None:
        return step(StepState.SKIPPED, _NO_FRICTION)
    if _undriven(scene):
        told = "the surface does not move: all stick, q = 0"
        return step(StepState.SKIPPED, f"{_undriven(scene)} {told}")
    if scene.friction == 0.0:
        if asked & FULL_STICK_RATIOS:
            return step(StepState.RUN, "a ratio q/p of full stick is asked for")
        return step(StepState.SKIPPED, "at friction 0 everything slips")
    if not _needs_tangential(scene, present):
        return step(StepState.SKIPPED, "nothing asked for depends on the traction")
    if scene.friction == math.inf:
        return step(StepState.RUN, "friction is infinite: no slip")
    return step(StepState.RUN, "decides whether there is slip")


def _partial_slip(scene: Scene, present: tuple[str, ...]) -> tuple[PlannedStep, ...]:
    friction, asked = scene.friction, _affected(scene).intersection(present)

    def skipped(reason: str) -> tuple[PlannedStep, ...]:
        names = (PARTIAL_SLIP, ZONE_SEARCH, SLIP_FIELD)
        return tuple(PlannedStep(name, StepState.SKIPPED, reason) for name in names)

    if friction is None:
        return skipped(_NO_FRICTION)
    if friction == math.inf:
        return skipped("friction is infinite: no slip")
    if _undriven(scene):
        return skipped(f"{_undriven(scene)} there is nothing to slip")
    if not asked - FULL_STICK_RATIOS:
        return skipped("nothing asked for depends on slip")
    if friction == 0.0:
        first, second, third = skipped("at friction 0 everything slips")
        if "slip" in present:
            third = PlannedStep(SLIP_FIELD, StepState.RUN, "the slip is asked for")
        return first, second, third
    reason = "only if the friction is below the critical one"
    if scene.tangential_compliance == 0.0:
        partial = PlannedStep(
            PARTIAL_SLIP, StepState.RUN, "without tangential compliance the edge always slips"
        )
    else:
        partial = PlannedStep(PARTIAL_SLIP, StepState.CONDITIONAL, reason)
    search = PlannedStep(
        ZONE_SEARCH, StepState.CONDITIONAL, "only if one stick disk breaks the friction law"
    )
    slip = PlannedStep(SLIP_FIELD, StepState.CONDITIONAL, "only if there is slip; checks its sense")
    return partial, search, slip


def _unloading(slip: PlannedStep, present: tuple[str, ...]) -> tuple[PlannedStep, ...]:
    """Return the steps below the largest load, after the last one that is about slip there."""
    if slip.state is StepState.SKIPPED:
        reason = f"{slip.reason}: all is that of the largest load times the load ratio"
        return tuple(PlannedStep(name, slip.state, reason) for name in (UNLOADING, LOAD_RATIOS))
    unloading = PlannedStep(
        UNLOADING, StepState.CONDITIONAL, "only if there is slip at the largest load"
    )
    if set(UNLOADED_QUANTITIES).isdisjoint(present):
        ratios = PlannedStep(LOAD_RATIOS, StepState.SKIPPED, "they are not asked for")
    else:
        reason = "only if there is slip at the largest load; where slip back begins, and turns"
        ratios = PlannedStep(LOAD_RATIOS, StepState.CONDITIONAL, reason)
    return unloading, ratios
