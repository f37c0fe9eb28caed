"""The run of a scene with a profile: normal contact, then friction as the contact has grown."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from time import perf_counter
from typing import TYPE_CHECKING

import numpy as np

from spectral_contact.contact.contact_radius import Contact, find_radius, value_of
from spectral_contact.contact.indented import solve_indentation, values_only
from spectral_contact.contact.on_parts import Indentation
from spectral_contact.contact.tuning import ROUNDING
from spectral_contact.errors import NotComputedError, SceneError
from spectral_contact.layers.scene_layer import endless
from spectral_contact.profiles import Flat
from spectral_contact.profiles.control import ALL_CONTROLS
from spectral_contact.solution import (
    COUPLING,
    FULL_STICK,
    GROWTH,
    NORMAL,
    PROFILE_QUANTITIES,
    Ending,
    Plan,
    Solution,
    StepState,
)
from spectral_contact.solving.run import Run
from spectral_contact.solving.sharing import RadiusPath, StepCache
from spectral_contact.spectral.parameters import Parameters
from spectral_contact.view.progress import ProgressLine

if TYPE_CHECKING:
    from spectral_contact.contact.normal import NormalContact
    from spectral_contact.contact.ratio import FullStick
    from spectral_contact.layers import Layer
    from spectral_contact.scene import Scene
    from spectral_contact.solving.grown_fields import GrownFields
    from spectral_contact.solving.growth import Growth
    from spectral_contact.solving.stages import FlatPunches, Stages

#: Tolerance of the normal contact without coupling that bounds the radius up to which a history
#: with coupling is followed.
_ROUGH_TOLERANCE = 1e-4
#: A history is followed to a radius that is larger by this relative amount, so that the given load
#: or approach is certainly reached.
_RADIUS_MARGIN = 1e-3
#: The pressure that drives the traction is a series, whose error oscillates where the slope of the
#: law of a layer jumps. The relative error that it makes in the traction may be so many times that
#: of the series.
_KINK_TRACTION_FACTOR = 10.0
_NOT_REACHED = (
    "the given load or approach is not reached up to the contact radius without coupling, "
    "where the search ends"
)


class ProfileRun(Run):
    """The steps of a plan for a scene with a profile.

    Normal contact is solved at once. With friction the contact has a history: as it grows by a
    ring, the surface inside is displaced as by a flat punch of its radius, and pressure and
    traction grow by those of that punch. So fields today are integrals over flat punches of all
    radii before (docs/theory, Contacts that grow), and the zones are those of the latest punch.

    Parameters are those of `Run`, and `flat`, the function that solves a flat punch of the history
    (see `Stages`).
    """

    #: Quantities whose errors `rtol` bounds (`Run.bounded`). The traction is not among them: its
    #: error comes from the flat punches of the history, and is only estimated.
    bounded: tuple[str, ...] = ("approach", "pressure", "total_shear", *PROFILE_QUANTITIES)
    _driving: NormalContact | None = None

    def __init__(
        self,
        scene: Scene,
        todo: Plan,
        rtol: float,
        max_unknowns: int,
        cache: StepCache,
        flat: FlatPunches,
    ) -> None:
        super().__init__(scene, todo, rtol, max_unknowns, cache)
        self._flat = flat

    def run_steps(self, states: dict[str, StepState]) -> None:
        """Run normal contact, and friction if there is any."""
        if states[NORMAL] is StepState.RUN or (
            self._has_growth_step(states) and not self.scene.couples
        ):
            fields = {"pressure", "traction"}.intersection(self.plan.quantities)
            full_stick_runs = states.get(FULL_STICK) is StepState.RUN
            self._indent(pointwise=bool(fields) or full_stick_runs, drives=full_stick_runs)
        self.tangential(states, None)
        if states.get(FULL_STICK) is StepState.RUN:
            self._run_full_stick_under_flat()
        if self._has_growth_step(states):
            from spectral_contact.solving.stages import NoFlatPunchError

            with ProgressLine(self.cache.progress) as tell:
                stages = self._stages(self.scene, tell)
                if not self.scene.couples:
                    self._grow_uncoupled(stages)
                    return
                try:
                    self._grow_coupled(stages)
                except NoFlatPunchError as error:
                    self._grow_full_stick(str(error), tell)

    def _stages(self, scene: Scene, tell: Callable[[str], None]) -> Stages:
        """Return the flat punches of the history of a scene; `tell` as of `Stages`."""
        from spectral_contact.solving.stages import Stages

        return Stages(scene, self.rtol, self.max_unknowns, tell, self._fields(), self._flat)

    def _grow_full_stick(self, refusal: str, tell: Callable[[str], None]) -> None:
        """Store a history of full stick: some flat punch has no zones that obey the friction law.

        All errors are infinite, except that of the load, approach or radius that is given.
        """
        self._grow_coupled(self._stages(self.scene.replace(friction=math.inf), tell))
        assert self.history is not None
        self.history = replace(self.history, errors=np.full_like(self.history.errors, math.inf))
        for name in (*self.errors, "violation"):
            if name not in ALL_CONTROLS or getattr(self.scene, name) is None:
                self.errors[name] = math.inf
        self.refusal = refusal
        reason = f"full stick at all times; {refusal}"
        self.ran(reason, GROWTH)
        self.endings.append(Ending.ZONES)

    def _has_growth_step(self, states: dict[str, StepState]) -> bool:
        return states.get(GROWTH) is StepState.RUN

    def _indent(self, *, pointwise: bool, drives: bool = False) -> None:
        """Solve normal contact and store it.

        Parameters
        ----------
        pointwise : bool
            Whether `rtol` bounds the error of the pressure at every radius, else of the load only.
        drives : bool
            Whether the pressure loads full stick, which needs it to a tighter tolerance.
        """
        scene = self.scene
        begin = perf_counter()
        profile = scene.profile
        assert profile is not None
        error = 0.0
        solved: Contact
        if scene.contact_radius is not None:
            solved = self._contact_of_radius(scene.contact_radius, self.rtol, pointwise)
        elif scene.layer is not None:
            solved, error = self._through_layer(scene.layer, pointwise, drives)
        elif isinstance(profile, Flat):
            from spectral_contact.solving.adhesive import pinned

            solved = pinned(scene, self.rtol, self.max_unknowns, pointwise=pointwise)
        elif scene.work_of_adhesion is not None:
            from spectral_contact.solving.adhesive import adhesive

            solved, error = adhesive(scene, self.rtol, self.max_unknowns, pointwise=pointwise)
        else:
            path = self._path
            control_value = self._control_value
            alpha = scene.normal_compliance
            solved, error = find_radius(
                profile,
                self._contact_of_radius,
                self.rtol,
                load=scene.load,
                approach=scene.approach,
                pointwise=pointwise,
                near=path.predict(control_value),
                first=lambda a: values_only(profile, a, alpha, self.rtol, self.max_unknowns),
            )
            path.add(control_value, value_of(solved).radius)
        found: Indentation = self.record(NORMAL, solved, begin)
        if scene.work_of_adhesion is not None:
            found = self._store_adhesion(found, error, scene.work_of_adhesion)
        self._check_overclosure(found)
        self.pressure = found.pressure
        self._driving = found.normal
        if endless(scene):
            self.values["domain_radius"] = found.radius
        if scene.layer is not None:
            self.values["approach_scale"] = found.approach_size
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
        self._add_data_errors(found)

    def _add_data_errors(self, found: Indentation) -> None:
        """Add the errors of a profile or a law that was given by functions and is kept as a series.

        The error of the profile is relative to H at the contact radius, that of the law to the mean
        pressure. Both count in full in every quantity, except in the load, approach or radius that
        is given.
        """
        scene = self.scene
        assert scene.profile is not None
        data_error = scene.profile._relative_error(found.radius)
        if scene.layer is not None:
            contact_area = math.pi * found.radius**2
            law_errors = scene.layer._errors(found.overclosure)
            data_error += law_errors.pressure * contact_area / found.load
            self.errors["stiffness"] += law_errors.stiffness
            self.errors["indentation_work"] += law_errors.energy * contact_area / found.work
        for name in (
            "contact_radius",
            "load",
            "approach",
            "stiffness",
            "indentation_work",
            "pressure",
        ):
            if getattr(scene, name, None) is None:
                self.errors[name] += data_error
        if isinstance(scene.profile, Flat):
            self.errors["contact_radius"] = 0.0

    def _store_adhesion(self, found: Indentation, error: float, adhesion: float) -> Indentation:
        """Store what adhesion adds; return the contact with the surface energy in its work.

        Parameters
        ----------
        found : Indentation
        error : float
            Relative error of its radius.
        adhesion : float
            Work of adhesion.
        """
        from spectral_contact.solving.adhesive import (
            CONTROLS_HELD,
            curve_of,
            stability,
            with_surface_energy,
        )

        # under a flat punch the load is linear in the approach, and the surface energy is constant
        if isinstance(self.scene.profile, Flat):
            self.values.update(stable_under=CONTROLS_HELD, stiffness_on_branch=found.stiffness)
            self.errors["stiffness_on_branch"] = found.stiffness_error
            return found
        self.values.update(
            load_scale=found.load_size,
            approach_scale=found.approach_size,
            indentation_work_scale=found.work + math.pi * adhesion * found.radius**2,
        )
        if "stiffness_on_branch" in self.plan.quantities:
            # the states with adhesion, by their contact radius
            adhesive_curve = curve_of(self.scene, self.rtol, self.max_unknowns)
            stability_of_branch = stability(adhesive_curve, found, error)
            self.values["stable_under"] = stability_of_branch.stable_under
            if stability_of_branch.stiffness is None:
                self.unavailable["stiffness_on_branch"] = stability_of_branch.reason
            else:
                self.values["stiffness_on_branch"] = stability_of_branch.stiffness
                scale = max(abs(stability_of_branch.stiffness), found.stiffness)
                self.values["stiffness_on_branch_scale"] = scale
                self.errors["stiffness_on_branch"] = stability_of_branch.error
        return with_surface_energy(found, adhesion)

    def _run_full_stick_under_flat(self) -> None:
        """Solve full stick under a flat punch that is given as a profile, and store it.

        The solution is in units of the radius of the punch.
        """
        begin = perf_counter()
        scene = self.scene
        assert self._driving is not None
        radius = self.values["contact_radius"]
        kappa = scene.kappa
        scaled_compliances = self._driving.compliance, scene.tangential_compliance / radius
        solved = self.solve_full_stick(
            Parameters(*scaled_compliances, 1.0, math.inf),
            self._driving,
            pointwise="traction" in self.plan.quantities,
            ratios=False,
        )
        stick: FullStick = self.record(FULL_STICK, solved, begin)
        self.bounded = (*self.bounded, "traction")
        assert stick.traction is not None
        self.traction = stick.traction.times(kappa)
        self.values["total_shear"] = kappa * radius**2 * stick.total_shear
        # Traction and shear are linear in the pressure, whose error they have. If the slope of the
        # law jumps, the series of the pressure that drives them has an error of its own.
        series_error = self._driving.pressure_error
        self.errors.update(
            traction=stick.traction_error
            + self.errors["pressure"]
            + _KINK_TRACTION_FACTOR * series_error,
            total_shear=stick.shear_error
            + self.errors["load"]
            + self.errors["stiffness"]
            + series_error,
        )

    @property
    def _path(self) -> RadiusPath:
        """Radii of contacts like this one, from scene to scene."""
        scene = self.scene
        key = (scene.profile, scene.normal_compliance, scene.layer, scene.load is None)
        return self.cache.get(NORMAL, key, RadiusPath)

    @property
    def _control_value(self) -> float:
        """The load that is given, or the approach less its value at first contact."""
        scene = self.scene
        if scene.load is not None:
            return scene.load
        assert scene.approach is not None
        return scene.approach - (0.0 if scene.layer is None else scene.layer.start)

    def _through_layer(self, layer: Layer, pointwise: bool, drives: bool) -> tuple[Contact, float]:
        """Return the contact at the load, approach or separation that is given.

        Its radius has the relative error that is returned, too. `drives` is as of `_indent`.
        """
        from spectral_contact.contact.layered_setting import has_edge
        from spectral_contact.solving.through_layer import through_layer

        scene = self.scene
        assert scene.profile is not None
        edged = has_edge(scene.profile, layer)
        solved, error = through_layer(
            scene.profile,
            layer,
            self.pressure_tolerance if drives else self.rtol,
            self.max_unknowns,
            load=scene.load,
            approach=scene.approach,
            separation=scene.separation,
            pointwise=pointwise,
            drives=drives,
            near=self._path.predict(self._control_value) if edged else None,
        )
        if edged:
            self._path.add(self._control_value, value_of(solved).radius)
        return solved, error

    def _contact_of_radius(self, radius: float, tolerance: float, pointwise: bool) -> Contact:
        """Return normal contact at a given contact radius."""
        scene = self.scene
        assert scene.profile is not None
        if scene.layer is not None:
            from spectral_contact.contact.layered_contact import solve_layered
            from spectral_contact.contact.layered_setting import setting_at_radius

            setting = setting_at_radius(scene.profile, scene.layer, radius)
            return solve_layered(setting, tolerance, self.max_unknowns, pointwise=pointwise)
        arguments = scene.profile, radius, scene.normal_compliance, tolerance, self.max_unknowns
        adhesion = scene.work_of_adhesion or 0.0
        return solve_indentation(*arguments, pointwise=pointwise, adhesion=adhesion)

    def _check_overclosure(self, found: Indentation) -> None:
        """Raise if the overclosure exceeds the limit of the layer's law."""
        layer = self.scene.layer
        if layer is None:
            return
        # a separation may put the overclosure at the limit, to rounding
        if found.overclosure - layer.limit <= ROUNDING * found.approach_size:
            return
        [name] = [control for control in ALL_CONTROLS if getattr(self.scene, control) is not None]
        allowed = (
            f"such that the overclosure stays below the end of the law, {layer.limit:.6g}; "
            f"it becomes {found.overclosure:.6g}"
        )
        raise SceneError(name, getattr(self.scene, name), allowed)

    def _grow_uncoupled(self, stages: Stages) -> None:
        """Superpose the flat punches of the history with the increments of the load.

        Without coupling these follow from normal contact.
        """
        begin = perf_counter()
        scene = self.scene
        radius = self.values["contact_radius"]
        # the first radius of the history; load and traction up to there are negligible
        first_radius = stages.first_radius(radius, self.values["load"])
        growth = stages.grower(first_radius, radius).grown(
            first_radius, radius, self.values["load"]
        )
        today = self._store_zones(stages, growth)
        self.errors["total_shear"] += self.errors["load"]
        wanted = {"traction", "slip"}.intersection(self.plan.quantities)  # the pressure is known
        fields = self._superposed(growth, today, wanted)
        if "traction" in self.plan.quantities:
            assert scene.friction is not None
            assert self.pressure is not None
            traction = fields.traction(scene.friction, self.pressure)
            self.traction = traction.field
            self.errors["traction"] = (
                growth.error + traction.relative_error + self.errors["pressure"]
            )
        self._store_slip(fields, self.errors["load"])
        known_error = self.errors["load"] + self.errors["approach"]
        self._store_history(growth, begin, known_error)

    def _grow_coupled(self, stages: Stages) -> None:
        """Build the history with coupling, where the load at a radius depends on the history."""
        begin = perf_counter()
        scene = self.scene
        assert scene.friction is not None
        radius, load = self._uncoupled_bound()
        first_radius = stages.first_radius(radius, load)
        grower = stages.grower(first_radius, radius)
        growth = grower.grown(first_radius, radius, load)
        given_curve = "loads" if scene.approach is None else "approaches"
        value = scene.load if scene.approach is None else scene.approach
        radius_error = 0.0
        if value is not None:
            log_radius = growth.radius_of(given_curve, value)
            if log_radius is None:
                raise NotComputedError("contact_radius", _NOT_REACHED)
            growth = grower.until(growth, log_radius)
        radius = scene.contact_radius or math.exp(growth.log_radius)
        assert scene.profile is not None
        profile_error = scene.profile._relative_error(radius)
        error = growth.load_error + profile_error
        if value is not None:
            radius_error = growth.radius_error(given_curve, value) + profile_error
        self.values.update(
            contact_radius=radius,
            load=scene.load or growth.load,
            approach=scene.approach or growth.approach,
            indentation_work=growth.work,
        )
        self.errors.update(
            contact_radius=radius_error,
            load=0.0 if scene.load else error + growth.load_rate * radius_error,
            approach=0.0 if scene.approach else error + growth.approach_rate * radius_error,
            indentation_work=2.0 * error + (growth.load_rate + growth.approach_rate) * radius_error,
        )
        today = self._store_zones(stages, growth)
        self.errors["total_shear"] += error
        self.values["stiffness"] = radius / today.approach
        # the stiffness goes like a power of the radius: 1 on a smooth surface, 2 on a soft layer
        self.errors["stiffness"] = (today.error.approach or 0.0) + 2.0 * radius_error
        wanted = {"slip"}.intersection(self.plan.quantities)
        pointwise = not {"pressure", "traction"}.isdisjoint(self.plan.quantities)
        if pointwise:
            wanted |= {"pressure", "traction"}
        fields = self._superposed(growth, today, wanted)
        if pointwise:
            self._store_fields(fields, today, error)
        self._store_slip(fields, error)
        self._store_history(growth, begin)

    def _store_fields(self, fields: GrownFields, today: Solution, error: float) -> None:
        """Add up pressure and traction."""
        growth = fields.growth
        friction = self.scene.friction
        assert friction is not None
        from spectral_contact.solving.grown_fields import opening

        pressure = fields.pressure()
        self.pressure = pressure.field
        if today.opening is not None:
            self.values["opening"] = opening_length = opening(pressure.field)
            if opening_length is not None:
                message = (
                    f"one history; the contact would open within {opening_length:.3g} of the edge"
                )
                self.ran(message, COUPLING)
        mean_pressure = growth.load / (math.pi * fields.radius**2)
        history_error = growth.error + error + growth.load_rate * self.errors["contact_radius"]
        # `history_error` is relative to the pressure itself, which is taken to be at most twice the
        # mean
        self.errors["pressure"] = pressure.error / mean_pressure + 2.0 * history_error
        traction = fields.traction(friction, pressure.field)
        self.traction = traction.field
        self.errors["traction"] = history_error + traction.relative_error

    def _store_slip(self, fields: GrownFields, load_error: float) -> None:
        """Add up the slip, if it is asked for and there was any."""
        growth = fields.growth
        if "slip" not in self.plan.quantities:
            return
        self.errors["slip"] = 0.0
        if any(one.slips for one in growth.panels):
            found = fields.slip()
            self.slip = found.field
            self.errors["slip"] = (
                growth.slip_error / found.largest
                + found.relative_error
                + growth.beginning_error
                + load_error
                + growth.load_rate * self.errors["contact_radius"]
            )

    def _store_history(
        self, growth: Growth, begin: float, normal_error: float | None = None
    ) -> None:
        """Store curves of the history, such as the load by the radius, and note the work.

        `normal_error` is the error of their loads and approaches by normal contact; it is None with
        coupling, where they come from the history.
        """
        from spectral_contact.solving.growth_history import history_of

        self.history = history_of(growth, normal_error)
        self.record(GROWTH, growth, begin)

    def _superposed(self, growth: Growth, today: Solution, names: set[str]) -> GrownFields:
        """Return what superposes the fields of these names over the flat punches of a history.

        `today` is the latest flat punch.
        """
        from spectral_contact.solving.grown_fields import GrownFields
        from spectral_contact.solving.growth_panel import stick_radius

        compliances = self.scene.normal_compliance, self.scene.tangential_compliance
        radius = self.values["contact_radius"]
        min_compliance = min(compliances) / radius
        return GrownFields(growth, radius, stick_radius(today), min_compliance, self.rtol, names)

    def _uncoupled_bound(self) -> tuple[float, float]:
        """Return radius and load of normal contact without coupling.

        A radius that is sought is enlarged a little, to bound that with coupling.
        """
        scene = self.scene
        assert scene.profile is not None
        if scene.contact_radius is not None:
            contact = self._contact_of_radius(
                scene.contact_radius, _ROUGH_TOLERANCE, pointwise=False
            )
        else:
            contact, _ = find_radius(
                scene.profile,
                self._contact_of_radius,
                _ROUGH_TOLERANCE,
                load=scene.load,
                approach=scene.approach,
                pointwise=False,
            )
        value = value_of(contact)
        radius = value.radius
        # With coupling the radius is smaller. Near nu = 0.5 the difference is less than the error
        # of this radius, which is therefore enlarged.
        if scene.contact_radius is None:
            radius += min(_RADIUS_MARGIN * radius, (scene.profile.reach - radius) / 2.0)
        return radius, value.load

    def _store_zones(self, stages: Stages, growth: Growth) -> Solution:
        """Store today's zones, which are those of a flat punch, and the shear; return the punch."""
        today = stages.flat(math.exp(growth.log_radius))
        self.values.update(
            zones=today.zones, stick_radius=today.stick_radius, total_shear=growth.total_shear
        )
        radius_error = self.errors["contact_radius"]
        stick_error = growth.stick_rate * radius_error
        self.errors.update(
            zones=(today.error.zones or 0.0) + stick_error,
            stick_radius=(today.error.stick_radius or 0.0) + stick_error,
            total_shear=growth.shear_error + growth.shear_rate * radius_error,
        )
        return today

    def _fields(self) -> tuple[str, ...]:
        """Return the names of the fields that are superposed over the history."""
        quantities = self.plan.quantities
        if {"pressure", "traction", "slip"}.isdisjoint(quantities):
            return ()
        # panels of radii that resolve the traction resolve the slip, too
        names = ("pressure", "traction") if self.scene.couples else ("traction",)
        return (*names, "slip") if "slip" in quantities else names
