"""One solve: the steps of its plan in order, and what every kind of scene has of them."""

from __future__ import annotations

import logging
import math
from time import perf_counter
from typing import TYPE_CHECKING, Any

from spectral_contact.contact.normal import solve_normal
from spectral_contact.contact.refine import Refinement
from spectral_contact.contact.resolution import NormalContact
from spectral_contact.fields.history import ContactHistory
from spectral_contact.fields.series import CENTRE, EDGE, PressureField, ZonalField
from spectral_contact.scene import Scene
from spectral_contact.solution import (
    FULL_STICK,
    NORMAL,
    PARTIAL_SLIP,
    SLIP_FIELD,
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
from spectral_contact.solving.sharing import Shared
from spectral_contact.spectral.parameters import Parameters

if TYPE_CHECKING:
    from spectral_contact.contact.ratio import FullStick
    from spectral_contact.contact.slip_outcome import PartialSlip


_LOG = logging.getLogger("spectral_contact.solving.solver")

#: What follows from the pressure for everything tangential; no step of its own.
#: Values that are there unasked.
_BESIDE = ("opening", "domain_radius")
#: The pressure drives the traction, so it is solved tighter, as far as rounding lets it.
_TIGHTER, _TIGHTEST = 0.1, 1.2e-13


class Run:
    """The steps of a plan, with what they leave behind.

    Parameters
    ----------
    scene : Scene
    todo : Plan
    rtol : float
        Bound on relative errors.
    max_unknowns : int
        Most unknowns of one linear system.
    shared : Shared
        What scenes before this one have left.
    """

    #: What `rtol` bounds; zone boundaries and slip are as good as their conditioning allows.
    bounded: tuple[str, ...] = ("approach", "pressure", "traction", "total_shear")
    #: Why no zones obey the friction law, if none were found that do.
    refusal: str = ""

    def __init__(
        self, scene: Scene, todo: Plan, rtol: float, max_unknowns: int, shared: Shared
    ) -> None:
        self.shared = shared
        self.scene = scene
        self.plan = todo
        self.rtol = rtol
        self.max_unknowns = max_unknowns
        self.normal_key: tuple[object, ...] = ()
        self.exceeded = False
        self.wrong_slip = 0.0
        self.work: list[StepWork] = []
        self.endings: list[Ending] = []
        self.outcome: dict[str, PlannedStep] = {}
        self.lacking: dict[str, str] = {}
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
            A looser tolerance than that of the run, which the solution is held against and has.
        """
        states = {step.name: step.state for step in self.plan.steps}
        self.run_steps(states)
        if rtol is not None:
            self.rtol = rtol
        done = self._done()
        wanted = {*done.quantities}
        errors = {k: v for k, v in self.errors.items() if k in wanted or k == "violation"}
        ending = self._ending()
        return Solution(
            self.scene,
            self.rtol,
            done,
            ErrorEstimates(**errors),
            ending is Ending.CONVERGED,
            ending,
            Work(tuple(self.work)),
            {k: v for k, v in self.values.items() if k in wanted or k in _BESIDE},
            self.pressure if "pressure" in wanted else None,
            self.traction if "traction" in wanted else None,
            self.slip if "slip" in wanted else None,
            self.history,
        )

    def _ending(self) -> Ending:
        """Return the worst ending of a step, unless all is within the tolerance."""
        if self.exceeded:
            self.endings.append(Ending.UNKNOWNS)
        within = all(error <= self.rtol for error in self.bounded_errors())
        if within and not self.exceeded and Ending.ZONES not in self.endings:
            return Ending.CONVERGED
        found = [one for one in self.endings if one is not Ending.CONVERGED]
        return max(found, key=list(Ending).index, default=Ending.ROUNDING)

    @property
    def slip_unresolved(self) -> bool:
        """Whether a closer tolerance is called for, as no digit of the slip is known.

        It is if the slip is asked for, or if it seems to break the friction law by more than the
        tolerance: that may be noise, or a zone that is missing.
        """
        unknown = self.errors.get("slip") == math.inf
        return unknown and ("slip" in self.plan.quantities or self.wrong_slip > self.rtol)

    def run_steps(self, states: dict[str, StepState]) -> None:
        """Run what is to be run."""
        contact = self._normal(states) if states[NORMAL] is StepState.RUN else None
        self.tangential(states, contact)

    def _done(self) -> Plan:
        """Return the plan with what became of it."""
        if not self.outcome and not self.lacking:
            return self.plan
        return Plan(
            tuple(name for name in self.plan.quantities if name not in self.lacking),
            tuple(self.outcome.get(step.name, step) for step in self.plan.steps),
            tuple(sorted({**dict(self.plan.missing), **self.lacking}.items())),
        )

    def bounded_errors(self) -> list[float]:
        """Return the estimates that `rtol` bounds, of what was asked."""
        return [
            self.errors[name]
            for name in self.bounded
            if name in self.plan.quantities and name in self.errors
        ]

    def record(self, name: str, result: Any, begin: float) -> Any:
        """Note the work of a step and return its value."""
        seconds = perf_counter() - begin
        if isinstance(result, Refinement):
            best = result.best
            if best.unknowns > self.max_unknowns:
                self.exceeded = True
            entry = StepWork(
                name,
                best.unknowns,
                result.resolution.degrees,
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
    def tighter(self) -> float:
        """The tolerance of a pressure that drives a traction."""
        return max(self.rtol * _TIGHTER, min(self.rtol, _TIGHTEST))

    def _normal(self, states: dict[str, StepState]) -> NormalContact:
        """Run the normal problem as tightly as the rest of the plan needs it."""
        begin = perf_counter()
        drives = any(
            states[name] is not StepState.SKIPPED for name in (FULL_STICK, PARTIAL_SLIP, SLIP_FIELD)
        )
        tolerance = self.tighter if drives else self.rtol
        goal = "pressure" if "pressure" in self.plan.quantities else "approach"
        goal = "drive" if drives else goal
        compliance = self.scene.normal_compliance
        self.normal_key = compliance, tolerance, goal
        solved = self.shared.get(
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
        """Fill in what follows by definition, then run what does not."""
        scene, friction = self.scene, self.scene.friction
        exact = {"traction": 0.0, "total_shear": 0.0, "stick_radius": 0.0, "zones": 0.0}
        if friction is None:
            self.values.update(total_shear=0.0, zones=(), stick_radius=None)
            self.errors.update(exact)
            return
        if scene.poisson_ratio == 0.5:
            self.all_stick()
            self.values.update(total_shear=0.0, edge_ratio=0.0, critical_friction=0.0)
            self.errors.update(exact, slip=0.0, edge_ratio=0.0, critical_friction=0.0)
            return
        if friction == math.inf:
            self.all_stick()
            self.errors.update(stick_radius=0.0, zones=0.0, slip=0.0)
        if friction == 0.0:
            self.values.update(
                total_shear=0.0, stick_radius=0.0, zones=(Zone.between("slip", CENTRE, EDGE),)
            )
            self.errors.update(exact)
        if contact is None or not any(
            states[name] is not StepState.SKIPPED for name in (FULL_STICK, SLIP_FIELD)
        ):
            return
        if friction == 0.0 and states[SLIP_FIELD] is StepState.RUN:
            self._frictionless_slip(contact)
        if states[FULL_STICK] is StepState.RUN:
            self.stick(contact, states)

    def all_stick(self) -> None:
        """Note that the whole contact sticks."""
        self.values.update(stick_radius=1.0, zones=(Zone.between("stick", CENTRE, EDGE),))

    def _frictionless_slip(self, contact: NormalContact) -> None:
        """At friction 0 the surface slides by all that the pressure moves it: u = -kappa g."""
        from spectral_contact.contact.slip_displacement import free_displacement

        begin = perf_counter()
        self.slip, error = self.record(
            SLIP_FIELD, free_displacement(contact, self.scene.kappa, self.rtol), begin
        )
        self.errors["slip"] = error

    def stick(self, contact: NormalContact, states: dict[str, StepState]) -> None:
        """Solve full stick, and what it decides."""
        stick = self._full_stick(contact)
        self.take_stick(stick, self.scene.kappa)
        if states[PARTIAL_SLIP] is not StepState.SKIPPED and not self.holds(stick):
            self.slipping(contact, stick)

    def _full_stick(self, contact: NormalContact) -> FullStick:
        begin = perf_counter()
        asked, held = set(self.plan.quantities), self.scene.friction == math.inf
        fields = {"traction", "edge_ratio", "critical_friction"}
        pointwise = bool(asked & (fields if held else fields | {"slip", "zones", "stick_radius"}))
        # finite friction has to be compared with the critical one
        ratios = not held or bool(asked & {"edge_ratio", "critical_friction"})
        solved = self.shared.get(
            FULL_STICK,
            (*self.normal_key, self.parameters.beta, pointwise, ratios),
            lambda: self.stuck(self.parameters, contact, pointwise=pointwise, ratios=ratios),
        )
        stick: FullStick = self.record(FULL_STICK, solved, begin)
        return stick

    def stuck(
        self,
        parameters: Parameters,
        known: NormalContact | None = None,
        *,
        tolerance: float | None = None,
        pointwise: bool = True,
        ratios: bool = True,
    ) -> FullStick | Refinement[FullStick]:
        """Solve full stick, under a given pressure or not; the tolerance is that of the run."""
        from spectral_contact.contact.full_stick import full_stick, smooth_full_stick
        from spectral_contact.contact.zone_problem import solve_stick

        if known is not None and parameters.alpha == 0.0 == parameters.beta:
            return smooth_full_stick(known)
        form = parameters._replace(friction=math.inf), tolerance or self.rtol, self.max_unknowns
        found = solve_stick(*form, known=known, pointwise=pointwise)
        return full_stick(found, known, pointwise=pointwise, ratios=ratios)

    def take_stick(self, stick: FullStick, scale: float) -> None:
        """Copy full stick, with everything tangential scaled: at friction 0 its ratios alone."""
        edge = stick.edge_ratio
        self.values.update(
            edge_ratio=None if edge is None else scale * edge,
            critical_friction=scale * stick.critical,
        )
        self.errors.update(edge_ratio=stick.edge_error, critical_friction=stick.critical_error)
        if self.scene.friction != 0.0:
            self.values.update(approach=stick.approach, total_shear=scale * stick.total_shear)
            self.errors.update(
                approach=stick.approach_error,
                pressure=stick.pressure_error,
                traction=stick.traction_error,
                total_shear=stick.shear_error,
            )
            self.pressure = stick.pressure
            self.traction = None if stick.traction is None else stick.traction.times(scale)

    def holds(self, stick: FullStick) -> bool:
        """Return whether friction holds all, and note it if so."""
        friction, critical = self.scene.friction, self.values["critical_friction"]
        assert friction is not None
        if friction < critical:
            return False
        self.all_stick()
        self.errors.update(stick_radius=0.0, zones=0.0, slip=0.0, violation=0.0)
        if critical > friction * (1.0 - stick.critical_error):  # the errors decide
            from spectral_contact.contact.onset import unresolved_slip

            missed = unresolved_slip(stick, self.parameters)
            self.errors.update(stick_radius=missed, zones=max(missed, 1.0), slip=1.0)
        reason = f"friction is not below the critical {critical:.6g}"
        self.skip(reason, PARTIAL_SLIP, ZONE_SEARCH, SLIP_FIELD)
        return True

    @property
    def parameters(self) -> Parameters:
        """What the zones depend on: without elastic coupling those for kappa = 1."""
        scene = self.scene
        assert scene.friction is not None
        compliances = scene.normal_compliance, scene.tangential_compliance
        return Parameters(*compliances, 1.0, scene.friction / scene.kappa)

    def slipping(self, contact: NormalContact, stick: FullStick) -> None:
        """Find the zones, where friction does not hold all: of this class there are none."""
        raise NotImplementedError

    def take(self, solved: PartialSlip, scale: float) -> None:
        """Copy the outcome of partial slip, with everything tangential scaled."""
        reason = f"friction is below the critical {self.values['critical_friction']:.6g}"
        self.outcome[PARTIAL_SLIP] = PlannedStep(PARTIAL_SLIP, StepState.RUN, reason)
        if len(solved.zones) > 2:
            found = f"one stick disk breaks the friction law; {len(solved.zones)} zones found"
            self.outcome[ZONE_SEARCH] = PlannedStep(ZONE_SEARCH, StepState.RUN, found)
        else:
            self.skip("one stick disk satisfies the friction law", ZONE_SEARCH)
        self.outcome[SLIP_FIELD] = PlannedStep(
            SLIP_FIELD, StepState.RUN, "there is slip; its sense is checked"
        )
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
        self.traction, self.slip = solved.traction.times(scale), solved.slip.times(scale)
        if not solved.consistent:
            self.endings.append(Ending.ZONES)

    def skip(self, reason: str, *names: str) -> None:
        """Note why steps were not needed after all."""
        for name in names:
            self.outcome[name] = PlannedStep(name, StepState.SKIPPED, reason)
