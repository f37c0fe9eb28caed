"""One solve: the steps of its plan in order, as far as all kinds of scenes have them in common.

`Run` solves normal contact, decides what follows without a solve (no friction, infinite friction,
an incompressible body), solves full stick, and compares the friction with the critical one. Partial
slip is left to subclasses. Values, fields and errors are stored as the solution has them.
"""

from __future__ import annotations

import logging
import math
from time import perf_counter
from typing import TYPE_CHECKING, Any

from spectral_contact.contact.normal import NormalContact, solve_normal
from spectral_contact.contact.refine import Refinement
from spectral_contact.contact.tuning import COARSE_TOL, FIELD_ROUNDING, NEGLIGIBLE_FRACTION
from spectral_contact.fields.history import ContactHistory
from spectral_contact.fields.series import CENTRE, EDGE, PressureField, ZonalField
from spectral_contact.fields.shakedown import shakedown
from spectral_contact.quantities import FIELDS, FOLLOWING_LOAD, FULL_STICK_RATIOS
from spectral_contact.scene import Scene
from spectral_contact.solution import (
    FULL_STICK,
    LOAD_RATIOS,
    NORMAL,
    PARTIAL_SLIP,
    SLIP_FIELD,
    UNLOADED_QUANTITIES,
    UNLOADING,
    ZONE_SEARCH,
    Ending,
    ErrorEstimates,
    Plan,
    PlannedStep,
    Solution,
    StepState,
    StepWork,
    TractionField,
    Work,
    Zone,
)
from spectral_contact.solving.sharing import StepCache
from spectral_contact.spectral.parameters import Parameters

if TYPE_CHECKING:
    from spectral_contact.contact.ratio import FullStick
    from spectral_contact.contact.slip_outcome import PartialSlip


#: The logger that users find under the name of the module with `solve`.
_LOG = logging.getLogger("spectral_contact.solving.solver")

#: Values of a solution that are there although no quantity asks for them.
_UNREQUESTED_VALUES = (
    *("opening", "domain_radius", "stable_under"),
    *("load_scale", "approach_scale", "indentation_work_scale", "stiffness_on_branch_scale"),
)


class Run:
    """The steps of a plan, and the results they store.

    Parameters
    ----------
    scene : Scene
    plan : Plan
    rtol : float
        Bound on relative errors.
    max_unknowns : int
        Most unknowns of one linear system.
    cache : StepCache
        Outcomes of steps of earlier scenes.

    Attributes
    ----------
    values, errors : dict
        Scalars and error estimates by the name of the quantity.
    pressure, traction, slip, history
        Fields, as far as they were solved for.
    updated_steps : dict of str to PlannedStep
        Steps that went otherwise than planned, or have a better reason now, by name.
    unavailable : dict of str to str
        Quantities that turned out to have no value, with the reason.
    work : list of StepWork
        Unknowns, time and ending of each step.
    endings : list of Ending
        How the steps ended.
    unknowns_exceeded : bool
        Whether a step needed more than `max_unknowns`.
    wrong_slip : float
        The largest displacement in slip that has the direction of the traction, against the
        friction law, relative to the largest displacement.
    normal_key : tuple
        All that the normal contact depends on.
    """

    #: Quantities whose errors `rtol` bounds; those of zone boundaries and slip are as small as
    #: their conditioning allows.
    bounded: tuple[str, ...] = ("approach", "pressure", "traction", "total_shear")
    #: Why no zones obey the friction law, if none were found that do.
    refusal: str = ""

    def __init__(
        self, scene: Scene, plan: Plan, rtol: float, max_unknowns: int, cache: StepCache
    ) -> None:
        self.cache = cache
        self.scene = scene
        self.plan = plan
        self.rtol = rtol
        self.max_unknowns = max_unknowns
        self.normal_key: tuple[object, ...] = ()
        self.unknowns_exceeded = False
        self.wrong_slip = 0.0
        self.work: list[StepWork] = []
        self.endings: list[Ending] = []
        self.updated_steps: dict[str, PlannedStep] = {}
        self.unavailable: dict[str, str] = {}
        self.values: dict[str, Any] = {}
        self.errors: dict[str, float] = {}
        self.pressure: PressureField | ZonalField | None = None
        self.traction: TractionField = None
        self.slip: TractionField = None
        self.history: ContactHistory | None = None

    def solution(self, rtol: float | None = None) -> Solution:
        """Run the plan.

        Parameters
        ----------
        rtol : float, optional
            A looser tolerance, which replaces that of the run after the steps: it decides whether
            the solution has converged.
        """
        states = {step.name: step.state for step in self.plan.steps}
        self.run_steps(states)
        if rtol is not None:
            self.rtol = rtol
        if self.scene.unloaded_to < 1.0:
            self._scale_to_load(self.scene.unloaded_to)
        plan = self._updated_plan()
        wanted = set(plan.quantities)
        errors = {k: v for k, v in self.errors.items() if k in wanted or k == "violation"}
        ending = self._ending()
        return Solution(
            self.scene,
            self.rtol,
            plan,
            ErrorEstimates(**errors),
            ending is Ending.CONVERGED,
            ending,
            Work(tuple(self.work)),
            {k: v for k, v in self.values.items() if k in wanted or k in _UNREQUESTED_VALUES},
            self.pressure if "pressure" in wanted else None,
            self.traction if "traction" in wanted else None,
            self.slip if "slip" in wanted else None,
            self.history,
        )

    def _scale_to_load(self, load_ratio: float) -> None:
        """Multiply results for unit load by a load ratio; the contact radius does not change."""
        for name in FOLLOWING_LOAD:
            if name in self.values:
                self.values[name] *= load_ratio
            elif name in FIELDS and (field := getattr(self, name)) is not None:
                setattr(self, name, field.times(load_ratio))

    def _ending(self) -> Ending:
        """Return the worst ending of a step, unless all is within the tolerance."""
        if self.unknowns_exceeded:
            self.endings.append(Ending.UNKNOWNS)
        within_rtol = all(error <= self.rtol for error in self.bounded_errors())
        if within_rtol and not self.unknowns_exceeded and Ending.ZONES not in self.endings:
            return Ending.CONVERGED
        endings = [ending for ending in self.endings if ending is not Ending.CONVERGED]
        return max(endings, key=list(Ending).index, default=Ending.ROUNDING)

    @property
    def slip_unresolved(self) -> bool:
        """Whether no digit of the slip is known, so that a closer tolerance is called for.

        That matters if the slip is wanted, or if it seems to violate the friction law by more than
        the tolerance: this violation may be noise, or show a missing zone.
        """
        no_digit = self.errors.get("slip") == math.inf
        return no_digit and ("slip" in self.plan.quantities or self.wrong_slip > self.rtol)

    def run_steps(self, states: dict[str, StepState]) -> None:
        """Run the steps of these states."""
        contact = self._normal(states) if states[NORMAL] is StepState.RUN else None
        self.tangential(states, contact)

    def _updated_plan(self) -> Plan:
        """Return the plan with the states and reasons that its steps have now."""
        if not self.updated_steps and not self.unavailable:
            return self.plan
        return Plan(
            tuple(name for name in self.plan.quantities if name not in self.unavailable),
            tuple(self.updated_steps.get(step.name, step) for step in self.plan.steps),
            tuple(sorted({**dict(self.plan.missing), **self.unavailable}.items())),
        )

    def bounded_errors(self) -> list[float]:
        """Return the error estimates that `rtol` bounds, of wanted quantities."""
        return [
            self.errors[name]
            for name in self.bounded
            if name in self.plan.quantities and name in self.errors
        ]

    def record(self, name: str, result: Any, begin: float) -> Any:
        """Note the work of a step, and return the value of its result.

        Parameters
        ----------
        name : str
            Of the step.
        result : Refinement or any
            A refinement has unknowns, an ending and a value; anything else is the value.
        begin : float
            The time at which the step began.
        """
        seconds = perf_counter() - begin
        if isinstance(result, Refinement):
            best = result.best
            if best.unknowns > self.max_unknowns:
                self.unknowns_exceeded = True
            entry = StepWork(
                name,
                best.unknowns,
                result.space.degrees,
                result.history,
                result.ending,
                seconds,
            )
            result = best.value
        else:
            entry = StepWork(name, 0, (), (), Ending.CONVERGED, seconds)
        self.work.append(entry)
        self.endings.append(entry.ending)
        _LOG.info("%s: %d unknowns, %.1f ms", name, entry.unknowns, 1e3 * seconds)
        return result

    @property
    def pressure_tolerance(self) -> float:
        """The tolerance of a pressure that loads the tangential problem.

        It is a fraction of `tangential_tolerance`, but not below some roundings of fields, nor
        above that tolerance.
        """
        lowest = min(self.tangential_tolerance, 3.0 * FIELD_ROUNDING)
        return max(self.tangential_tolerance * NEGLIGIBLE_FRACTION, lowest)

    @property
    def tangential_tolerance(self) -> float:
        """The tolerance of the tangential problem: `rtol`, and at most 1e-6 after unloading.

        At looser tolerances a narrow zone of slip back at the edge is not found, because traction
        may exceed friction there by the error that is allowed.
        """
        return min(self.rtol, COARSE_TOL**2) if self.scene.unloaded_to < 1.0 else self.rtol

    def _normal(self, states: dict[str, StepState]) -> NormalContact:
        """Solve normal contact, to the tolerance that the rest of the plan needs."""
        begin = perf_counter()
        tangential_steps = (FULL_STICK, PARTIAL_SLIP, SLIP_FIELD)
        loads_tangential = any(states[name] is not StepState.SKIPPED for name in tangential_steps)
        tolerance = self.pressure_tolerance if loads_tangential else self.rtol
        if loads_tangential:
            goal = "traction"
        elif "pressure" in self.plan.quantities:
            goal = "pressure"
        else:
            goal = "approach"
        compliance = self.scene.normal_compliance
        self.normal_key = compliance, tolerance, goal
        solved = self.cache.get(
            NORMAL,
            self.normal_key,
            lambda: solve_normal(compliance, tolerance, self.max_unknowns, goal=goal),
        )
        contact: NormalContact = self.record(NORMAL, solved, begin)
        self.pressure = contact.pressure
        self.values["approach"] = contact.approach
        self.errors["approach"] = contact.approach_error
        self.errors["pressure"] = contact.pressure_error
        return contact

    def tangential(self, states: dict[str, StepState], contact: NormalContact | None) -> None:
        """Store what follows without a solve, then run the tangential steps.

        With kappa = 0 nothing drives the surface sideways, and everything sticks at any friction.
        With infinite friction the zones are known, and with friction 0 all but the slip; the
        rest is solved for.

        Parameters
        ----------
        states : dict of str to StepState
            Of the steps.
        contact : NormalContact or None
            Normal contact, if it was solved.
        """
        scene = self.scene
        friction = scene.friction
        exact = {"traction": 0.0, "total_shear": 0.0, "stick_radius": 0.0, "zones": 0.0}
        if friction is None:
            self._no_load_ratios("nothing sticks")
            self.values.update(total_shear=0.0, zones=(), stick_radius=None)
            self.errors.update(exact)
            return
        if scene.kappa == 0.0:
            self._no_load_ratios("nothing slips")
            self.store_all_stick()
            zero_ratios = dict.fromkeys(FULL_STICK_RATIOS, 0.0)
            self.values.update(zero_ratios, total_shear=0.0)
            self.errors.update(exact | zero_ratios)
            return
        if friction == math.inf:
            self._no_load_ratios("nothing slips")
            self.store_all_stick()
        if friction == 0.0:
            self._no_load_ratios("nothing sticks")
            self.values.update(
                total_shear=0.0, stick_radius=0.0, zones=(Zone.from_radii("slip", CENTRE, EDGE),)
            )
            self.errors.update(exact)
        if contact is None or not any(
            states[name] is not StepState.SKIPPED for name in (FULL_STICK, SLIP_FIELD)
        ):
            return
        if friction == 0.0 and states[SLIP_FIELD] is StepState.RUN:
            self._frictionless_slip(contact)
        if states[FULL_STICK] is StepState.RUN:
            self.run_full_stick(contact, states)

    def store_all_stick(self) -> None:
        """Store that the whole contact sticks, for sure: errors are 0."""
        self.values.update(stick_radius=1.0, zones=(Zone.from_radii("stick", CENTRE, EDGE),))
        self.errors.update(stick_radius=0.0, zones=0.0, slip=0.0)

    def _no_load_ratios(self, reason: str) -> None:
        """Note that a scene below its largest load has no thresholds of the load, and why."""
        if self.scene.unloaded_to == 1.0:
            return
        for name in UNLOADED_QUANTITIES:
            if name in self.plan.quantities:
                self.unavailable[name] = reason
        message = f"{reason}; what is proportional to the load is multiplied by the load ratio"
        self.skip(message, UNLOADING, LOAD_RATIOS)

    def _frictionless_slip(self, contact: NormalContact) -> None:
        """Store the slip at friction 0, the displacement by the pressure: ``u = -kappa g``."""
        from spectral_contact.contact.slip_displacement import free_displacement

        begin = perf_counter()
        self.slip, error = self.record(
            SLIP_FIELD, free_displacement(contact, self.scene.kappa, self.rtol), begin
        )
        self.errors["slip"] = error

    def run_full_stick(self, contact: NormalContact, states: dict[str, StepState]) -> None:
        """Solve full stick, and partial slip if friction is below the critical one."""
        stick = self._full_stick(contact)
        self.store_full_stick(stick, self.scene.kappa)
        if states[PARTIAL_SLIP] is StepState.SKIPPED:
            return
        if self.is_supercritical():
            self.store_supercritical(stick)
        else:
            self.run_partial_slip(contact, stick)

    def _full_stick(self, contact: NormalContact) -> FullStick:
        """Return full stick under the known pressure, from the cache if it is there.

        The traction is solved for to the tolerance at every point if it is wanted, or the zones of
        slip that are found from it, and else as closely as the total shear needs. Ratios q/p are
        evaluated if they are wanted, or if the friction is finite: it is compared with the
        critical one, which is the largest ratio.
        """
        begin = perf_counter()
        quantities = set(self.plan.quantities)
        ratios = bool(quantities & FULL_STICK_RATIOS)
        pointwise = ratios or "traction" in quantities
        if self.scene.friction != math.inf:
            ratios = True
            pointwise |= bool(quantities & {"slip", "zones", "stick_radius"})
        key = *self.normal_key, self.parameters._replace(friction=math.inf), pointwise, ratios
        solved = self.cache.get(
            FULL_STICK,
            key,
            lambda: self.solve_full_stick(
                self.parameters, contact, pointwise=pointwise, ratios=ratios
            ),
        )
        stick: FullStick = self.record(FULL_STICK, solved, begin)
        return stick

    def solve_full_stick(
        self,
        parameters: Parameters,
        contact: NormalContact | None = None,
        *,
        tolerance: float | None = None,
        pointwise: bool = True,
        ratios: bool = True,
    ) -> FullStick | Refinement[FullStick]:
        """Return full stick.

        Parameters
        ----------
        parameters : Parameters
            Their friction does not matter.
        contact : NormalContact, optional
            Normal contact, whose pressure is known; without it the pressure is solved for, too.
        tolerance : float, optional
            In place of that of the run.
        pointwise : bool
            Whether the tolerance bounds the error of the traction, else of the total shear.
        ratios : bool
            Whether q/p at the edge and its largest value, the critical friction, are wanted.
        """
        from spectral_contact.contact.full_stick import full_stick, smooth_full_stick
        from spectral_contact.contact.zone_problem import solve_stick

        if contact is not None and parameters.alpha == 0.0 == parameters.beta:
            return smooth_full_stick(contact)
        solved = solve_stick(
            parameters._replace(friction=math.inf),
            tolerance or self.rtol,
            self.max_unknowns,
            known=contact,
            pointwise=pointwise,
        )
        return full_stick(solved, contact, pointwise=pointwise, ratios=ratios)

    def store_full_stick(self, stick: FullStick, scale: float) -> None:
        """Store full stick; at friction 0, where nothing sticks, its ratios q/p alone.

        Parameters
        ----------
        stick : FullStick
        scale : float
            Factor of all that is tangential: kappa, if full stick was solved for kappa = 1.
        """
        friction = self.scene.friction
        assert friction is not None
        edge_ratio = stick.edge_ratio
        critical = scale * stick.critical
        ratio, ratio_error = shakedown(critical, stick.critical_error, friction)
        self.values.update(
            edge_ratio=None if edge_ratio is None else scale * edge_ratio,
            critical_friction=critical,
            shakedown_ratio=ratio,
        )
        self.errors.update(
            edge_ratio=stick.edge_error,
            critical_friction=stick.critical_error,
            shakedown_ratio=ratio_error,
        )
        if friction != 0.0:
            self.values.update(approach=stick.approach, total_shear=scale * stick.total_shear)
            self.errors.update(
                approach=stick.approach_error,
                pressure=stick.pressure_error,
                traction=stick.traction_error,
                total_shear=stick.shear_error,
            )
            self.pressure = stick.pressure
            self.traction = None if stick.traction is None else stick.traction.times(scale)

    def is_supercritical(self) -> bool:
        """Return whether the friction is not below the critical one, so that nothing slips.

        Then the shakedown ratio is 0. Full stick has to be stored before.
        """
        return bool(self.values["shakedown_ratio"] == 0.0)

    def store_supercritical(self, stick: FullStick) -> None:
        """Store that the whole contact sticks, with errors for the slip that may be unresolved."""
        self.store_all_stick()
        self.errors["violation"] = 0.0
        self._no_load_ratios("nothing slips")
        if self.errors["shakedown_ratio"] > 0.0:  # friction may be below the critical, by its error
            self.store_unresolved_slip_errors(stick)
        reason = f"friction is not below the critical {self.values['critical_friction']:.6g}"
        self.skip(reason, PARTIAL_SLIP, ZONE_SEARCH, SLIP_FIELD)

    def store_unresolved_slip_errors(self, stick: FullStick) -> None:
        """Store the errors of full stick where slip is too narrow to be resolved.

        No digit is known of the zone that may be missing, nor of the slip in it.
        """
        from spectral_contact.contact.onset import unresolved_slip

        radius_error = unresolved_slip(stick, self.parameters)
        self.errors.update(stick_radius=radius_error, zones=max(radius_error, 1.0), slip=1.0)

    @property
    def parameters(self) -> Parameters:
        """Compliances, kappa and friction; without elastic coupling scaled to kappa = 1."""
        scene = self.scene
        assert scene.friction is not None
        return Parameters(
            scene.normal_compliance, scene.tangential_compliance, 1.0, scene.friction / scene.kappa
        )

    def run_partial_slip(self, contact: NormalContact, stick: FullStick) -> None:
        """Solve partial slip and store it; subclasses do."""
        raise NotImplementedError

    def store(self, solved: PartialSlip, scale: float) -> None:
        """Store partial slip, with all that is tangential scaled as in `store_full_stick`."""
        reason = f"friction is below the critical {self.values['critical_friction']:.6g}"
        self.ran(reason, PARTIAL_SLIP)
        kinds = [zone.kind for zone in solved.zones]
        if solved.consistent and kinds == ["stick", "slip"]:
            self.skip("one stick disk satisfies the friction law", ZONE_SEARCH)
        else:
            reason = f"{len(kinds)} zones satisfy the friction law"
            if not solved.consistent:
                reason = "no zones that were tried satisfy the friction law"
            elif kinds == ["stick"]:
                reason = "slip cannot be told from full stick"
            if len(solved.trials) > 1:
                reason += f"; tried: {'; '.join(trial.text for trial in solved.trials)}"
            self.ran(reason, ZONE_SEARCH)
        if kinds == ["stick"]:
            self.skip("slip cannot be told from full stick", SLIP_FIELD)
        else:
            self.ran("there is slip; its sense is checked", SLIP_FIELD)
        self.values.update(
            approach=solved.approach,
            zones=solved.zones,
            stick_radius=solved.zones[0].outer if solved.zones[0].kind == "stick" else 0.0,
            total_shear=scale * solved.total_shear,
        )
        self.errors.update(
            approach=solved.approach_error,
            pressure=solved.pressure_error,
            traction=solved.traction_error,
            total_shear=solved.shear_error,
            zones=solved.zones_error,
            stick_radius=solved.radius_error,
            slip=solved.slip_error,
            violation=solved.violation,
        )
        self.wrong_slip = solved.wrong_slip
        self.pressure = solved.pressure
        self.traction = solved.traction.times(scale)
        self.slip = solved.slip.times(scale)
        if not solved.consistent:
            self.endings.append(Ending.ZONES)

    def ran(self, reason: str, name: str) -> None:
        """Note that a step was run, and why."""
        self.updated_steps[name] = PlannedStep(name, StepState.RUN, reason)

    def skip(self, reason: str, *names: str) -> None:
        """Note that steps were not needed, and why."""
        for name in names:
            self.updated_steps[name] = PlannedStep(name, StepState.SKIPPED, reason)
