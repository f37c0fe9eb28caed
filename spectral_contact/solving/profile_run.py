"""The run of a scene with a profile: normal contact, then friction as the contact has grown."""

from __future__ import annotations

import math
from dataclasses import replace
from time import perf_counter
from typing import Any

from scipy.interpolate import barycentric_interpolate
from scipy.optimize import brentq

from spectral_contact.contact.contact_radius import Contact, find_radius, value_of
from spectral_contact.contact.indented import Indentation, solve_indentation
from spectral_contact.contact.layered_contact import layered_contact, solve_layered
from spectral_contact.contact.layered_setting import has_edge, setting_at_radius
from spectral_contact.contact.refine import Refinement
from spectral_contact.errors import SceneError
from spectral_contact.fields.series import Radius
from spectral_contact.layers.control import endless
from spectral_contact.profiles.control import CONTROLS
from spectral_contact.scene import Scene
from spectral_contact.solution import GROWTH, NORMAL, PROFILE_QUANTITIES, Solution, StepState
from spectral_contact.solving.grown_traction import grown_traction
from spectral_contact.solving.growth import Growth, grown
from spectral_contact.solving.planning import plan
from spectral_contact.solving.run import Run
from spectral_contact.solving.sharing import Shared

__all__ = ["ProfileRun"]

#: What the flat punches of a history are solved for.
_FLAT = ("pressure", "traction", "total_shear", "zones", "stick_radius", "approach")
#: Their tolerance, of that asked for, and the least.
_TIGHTER, _TIGHTEST = 0.1, 1e-12
#: Scenes that are extrapolated from, and how far in a logarithm.
_POINTS, _FARTHEST = 4, 1.0
#: Share of the tolerance of the load or traction that is not looked for in the history.
_NEGLIGIBLE = 0.01
#: Tolerances of the critical friction and of the radius at which slip begins.
_CRITICAL, _ONSET = 1e-10, 1e-12


class ProfileRun(Run):
    """The steps of a plan for a scene with a profile."""

    #: the traction is as certain as the flat punches of the history are
    bounded = ("approach", "pressure", "total_shear", *PROFILE_QUANTITIES)

    def run_steps(self, states: dict[str, StepState]) -> None:
        """Run normal contact, and friction if there is any."""
        if StepState.RUN in (states[NORMAL], states[GROWTH]):
            self._indent(pointwise="pressure" in self.plan.quantities or self._grows(states))
        self.tangential(states, None)
        if self._grows(states):
            self._grow()

    def _grows(self, states: dict[str, StepState]) -> bool:
        return states[GROWTH] is StepState.RUN

    def _indent(self, *, pointwise: bool) -> None:
        scene, begin = self.scene, perf_counter()
        profile = scene.profile
        assert profile is not None
        edged = scene.layer is None or has_edge(profile, scene.layer)
        error = 0.0
        value = scene.approach if scene.load is None else scene.load
        solved: Contact
        if value is None:
            assert scene.contact_radius is not None
            solved = self._at(scene.contact_radius, self.rtol, pointwise)
        elif not edged:
            assert scene.layer is not None
            solved = layered_contact(
                profile,
                scene.layer,
                self.rtol,
                self.max_unknowns,
                load=scene.load,
                approach=scene.approach,
                pointwise=pointwise,
            )
        else:
            key = (profile, scene.normal_compliance, scene.layer, scene.load is None)
            path = self.shared.get(NORMAL, key, _RadiusPath)
            origin = 0.0 if scene.layer is None else scene.layer.start
            at = value if scene.approach is None else value - origin
            solved, error = find_radius(
                profile,
                self._at,
                self.rtol,
                load=scene.load,
                approach=scene.approach,
                pointwise=pointwise,
                near=path.near(at),
                origin=origin,
            )
            path.add(at, value_of(solved).radius)
        found: Indentation = self.record(NORMAL, solved, begin)
        self._check(found)
        self.pressure = found.pressure
        if endless(scene):
            self.values["domain_radius"] = found.radius
        self.values.update(
            contact_radius=found.radius,
            load=found.load,
            approach=found.approach,
            stiffness=found.stiffness,
            indentation_work=found.work,
        )
        self.errors.update(
            contact_radius=error,
            load=found.load_error,
            approach=found.approach_error,
            stiffness=found.stiffness_error,
            indentation_work=found.work_error,
            pressure=found.pressure_error,
        )

    def _at(self, radius: float, tolerance: float, pointwise: bool) -> Contact:
        """Return the contact of a radius."""
        scene = self.scene
        assert scene.profile is not None
        if scene.layer is not None:
            setting = setting_at_radius(scene.profile, scene.layer, radius)
            return solve_layered(setting, tolerance, self.max_unknowns, pointwise=pointwise)
        return solve_indentation(
            scene.profile,
            radius,
            scene.normal_compliance,
            tolerance,
            self.max_unknowns,
            pointwise=pointwise,
        )

    def _check(self, found: Indentation) -> None:
        """Refuse what a layer's law does not know."""
        layer = self.scene.layer
        if layer is None or found.overclosure <= layer.limit:
            return
        [name] = [one for one in CONTROLS if getattr(self.scene, one) is not None]
        told = f"such that the overclosure stays below the end of the law, {layer.limit:.6g}; "
        told += f"it becomes {found.overclosure:.6g}"
        raise SceneError(name, getattr(self.scene, name), told)

    def _grow(self) -> None:
        """Add up the flat punches of the history."""
        begin = perf_counter()
        history = _Stages(self.scene, self.rtol, self.max_unknowns)
        radius = self.values["contact_radius"]
        growth = history.growth(radius, self.values["load"])
        today, friction = history.flat(radius), self.scene.friction
        assert friction is not None
        assert self.pressure is not None
        self.values.update(
            zones=today.zones, stick_radius=today.stick_radius, total_shear=growth.total_shear
        )
        moved = self.errors["contact_radius"]
        of_stick = growth.stick_rate * moved
        of_shear = growth.shear_rate * moved
        self.errors.update(
            zones=(today.error.zones or 0.0) + of_stick,
            stick_radius=(today.error.stick_radius or 0.0) + of_stick,
            total_shear=growth.shear_error + of_shear + self.errors["load"],
        )
        if "traction" in self.plan.quantities:
            outer = today.zones[0]
            stick = Radius(outer.outer, outer.outer_from_edge)
            smooth = 0.0 in (self.scene.normal_compliance, self.scene.tangential_compliance)
            found = grown_traction(growth, stick, friction, self.pressure, smooth=smooth)
            self.traction = found.field
            self.errors["traction"] = growth.error + found.error + self.errors["pressure"]
        self.record(GROWTH, growth, begin)


class _RadiusPath:
    """Loads or approaches and their contact radii, from scene to scene."""

    def __init__(self) -> None:
        self._known: list[tuple[float, float]] = []

    def add(self, value: float, radius: float) -> None:
        """Keep what a scene has found."""
        self._known = [*self._known[-_POINTS:], (math.log(value), math.log(radius))]

    def near(self, value: float) -> float | None:
        """Return where the radius may be: a polynomial in logarithms through the last scenes."""
        at = math.log(value)
        known = [one for one in self._known if 0.0 < abs(one[0] - at) < _FARTHEST]
        places = {place: log_radius for place, log_radius in known}
        if len(places) < 2:
            return None
        return math.exp(float(barycentric_interpolate(list(places), list(places.values()), at)))


class _Stages:
    """The loads and flat punches of a history."""

    def __init__(self, scene: Scene, rtol: float, max_unknowns: int) -> None:
        assert scene.profile is not None
        self.scene, self.rtol, self.max_unknowns = scene, rtol, max_unknowns
        self.profile = scene.profile
        self._tight = max(_TIGHTER * rtol, _TIGHTEST)
        without: dict[str, Any] = dict.fromkeys(("physical", "profile", *CONTROLS))
        self._flat = replace(scene, **without)
        self._shared = Shared()

    def load(self, radius: float) -> float:
        """Return the load of a contact radius."""
        found = solve_indentation(
            self.profile,
            radius,
            self.scene.normal_compliance,
            self._tight,
            self.max_unknowns,
            pointwise=False,
        )
        return (found.best.value if isinstance(found, Refinement) else found).load

    def _scene(self, radius: float) -> Scene:
        flat = self._flat
        return replace(
            flat,
            normal_compliance=flat.normal_compliance / radius,
            tangential_compliance=flat.tangential_compliance / radius,
        )

    def flat(self, radius: float) -> Solution:
        """Return the solution of a flat punch."""
        scene = self._scene(radius)
        run = Run(scene, plan(scene, _FLAT), self._tight, self.max_unknowns, self._shared)
        return run.solution()

    def critical(self, radius: float) -> float:
        """Return the critical friction of a flat punch."""
        scene = self._scene(radius)
        todo = plan(scene, ("critical_friction",))
        run = Run(scene, todo, _CRITICAL, self.max_unknowns, self._shared)
        return run.solution().critical_friction

    def growth(self, radius: float, load: float) -> Growth:
        """Return the history up to a contact radius."""
        least = self._least(radius, load)

        def stage(at: float) -> tuple[float, Solution]:
            return self.load(at), self.flat(at)

        return grown(stage, radius, load, least, self._onset(least, radius), self.rtol)

    def _least(self, radius: float, load: float) -> float:
        """Return a radius at which load and traction are negligible."""
        share, at = 1.0, radius
        while share > _NEGLIGIBLE * self.rtol:
            at /= 2.0
            share = self.load(at) / load * (radius / at) ** 2
            if share * (radius / at) > 1.0 and at < 1e-9 * radius:
                break
        return at

    def _onset(self, least: float, radius: float) -> float | None:
        """Return the radius at which slip begins; 0 if it is always there, None if never."""
        friction = self.scene.friction
        assert friction is not None
        if friction == math.inf:
            return None
        if self.scene.tangential_compliance == 0.0:
            return 0.0

        def excess(log_radius: float) -> float:
            return math.log(self.critical(math.exp(log_radius)) / friction)

        low, high = math.log(least), math.log(radius)
        if excess(high) <= 0.0:
            return None
        if excess(low) >= 0.0:
            return 0.0
        return math.exp(float(brentq(excess, low, high, xtol=_ONSET)))
