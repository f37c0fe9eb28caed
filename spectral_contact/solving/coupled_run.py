"""One solve with elastic coupling: pressure and traction are one system."""

from __future__ import annotations

import math
from dataclasses import replace
from time import perf_counter
from typing import TYPE_CHECKING

from spectral_contact.contact.resolution import NormalContact
from spectral_contact.contact.tuning import ONSET_BAND
from spectral_contact.solution import (
    COUPLING,
    FULL_STICK,
    PARTIAL_SLIP,
    SLIP_FIELD,
    ZONE_SEARCH,
    Ending,
    PlannedStep,
    StepState,
)
from spectral_contact.solving.asked import closer_tolerance
from spectral_contact.solving.run import Run
from spectral_contact.solving.sharing import place_of
from spectral_contact.spectral.parameters import Parameters
from spectral_contact.view.progress import ProgressLine

if TYPE_CHECKING:
    from spectral_contact.contact.ratio import FullStick
    from spectral_contact.contact.slip_outcome import PartialSlip
    from spectral_contact.contact.zone_search import CoupledSearch, NoZonesError
    from spectral_contact.solving.sharing import StickPath


#: The error of full stick that stands for slip, in units of what friction lacks.
_ROOM = 3.0
#: Tolerance of full stick at which it is seen that a scene is that close.
_DECIDES = 0.1 * ONSET_BAND
#: A distance at which slip is not looked for if full stick is good enough; and one at which
#: rounding hides it: at 1e-11 all annuli were found, at 1e-12 some, at 1e-13 hardly any.
_HIDDEN, _ROUNDED = 1e-8, 3e-13


class CoupledRun(Run):
    """The steps of a plan with elastic coupling; at friction 0 the traction is idle.

    Parameters are those of `Run`.
    """

    def tangential(self, states: dict[str, StepState], contact: NormalContact | None) -> None:
        """Solve for pressure and traction together."""
        if self.scene.friction == 0.0:
            super().tangential(states, contact)
            return
        self._together(states)

    def stick(self, contact: NormalContact, states: dict[str, StepState]) -> None:
        """Solve the coupled full stick for its ratios: at friction 0 the fields are not its own."""
        self._take(self._coupled_stick(self.rtol))

    @property
    def parameters(self) -> Parameters:
        """What pressure, traction and zones depend on."""
        assert self.scene.friction is not None
        return super().parameters._replace(kappa=self.scene.kappa, friction=self.scene.friction)

    def _together(self, states: dict[str, StepState]) -> None:
        """Solve full stick, and what it decides."""
        if self.scene.friction == math.inf:
            self.all_stick()
            self.errors.update(stick_radius=0.0, zones=0.0, slip=0.0)
        if states[COUPLING] is not StepState.RUN:
            return
        stick = self._coupled_stick(self.rtol)
        self._take(stick)
        if "pressure" in self.plan.quantities:
            self.values["opening"] = stick.opening
        if stick.opening is not None:
            self.outcome[COUPLING] = PlannedStep(
                COUPLING,
                StepState.RUN,
                f"one system; the contact would open within {stick.opening:.3g} of the edge",
            )
        if states[PARTIAL_SLIP] is not StepState.SKIPPED and not self.holds(stick):
            self._slipping(stick)

    def _coupled_stick(self, rtol: float) -> FullStick:
        scene, begin = self.scene, perf_counter()
        asked = set(self.plan.quantities) - {"zones", "stick_radius", "slip"}
        integrals = scene.friction == math.inf and asked <= {"approach", "total_shear"}
        tolerance = rtol if scene.friction == math.inf else min(rtol, _DECIDES)
        solved = self.stuck(self.parameters, tolerance=tolerance, pointwise=not integrals)
        stick: FullStick = self.record(FULL_STICK, solved, begin)
        return stick

    def _take(self, stick: FullStick) -> None:
        """Copy full stick, whose q/p has no meaning where the pressure is not positive."""
        self.take_stick(stick, 1.0)
        if stick.edge_ratio is None and "edge_ratio" in self.plan.quantities:
            self.lacking["edge_ratio"] = (
                "the traction and the pressure oscillate at the edge of a smooth surface"
                if stick.opening is None
                else f"the contact would open within {stick.opening:.3g} of the edge"
            )

    def _slipping(self, stick: FullStick) -> None:
        """Take over partial slip."""
        from spectral_contact.contact.onset import unresolved_slip
        from spectral_contact.contact.zone_search import CoupledSearch, NoZonesError

        parameters = self.parameters
        search = CoupledSearch(parameters, stick, self.rtol, self.max_unknowns, self.record)
        lack = 1.0 - parameters.friction / stick.critical
        unsure = lack + stick.critical_error
        hidden = lack <= _ROUNDED or (lack <= _HIDDEN and _ROOM * unsure < 0.5 * self.rtol)
        with ProgressLine(self.shared.progress) as tell:
            if not (parameters.alpha and parameters.beta):
                tell("zones of stick and slip")  # without a compliance it takes seconds
            try:
                found = None if hidden else self._found(search, unsure)
            except NoZonesError as missing:
                self._take_unlawful(stick, missing)
                return
        if found is None:
            closer = closer_tolerance(self.rtol)
            # hardly more than what is not known of full stick
            if closer < min(self.rtol, _DECIDES) and _ROOM * unsure > 0.5 * self.rtol:
                stick = self._coupled_stick(closer)
                self._take(stick)
                lack = max(1.0 - parameters.friction / stick.critical, 0.0)
                unsure = lack + stick.critical_error
            self._about_to_slip(stick, unsure, unresolved_slip(stick, parameters))
            return
        if "opening" in self.values:
            self.values["opening"] = None
        self.take(found, 1.0)
        one = "pressure and traction are one system"
        others = []
        if found.layout is not None and found.zones[0].kind == "stick":
            others = search.others(found.layout.logits[0])
        if others:
            radii = ", ".join(f"{radius:.3g}" for radius in others)
            one += f"; a larger stick radius may satisfy the friction law, too: {radii}"
        self.outcome[COUPLING] = PlannedStep(COUPLING, StepState.RUN, one)

    def _found(self, search: CoupledSearch, unsure: float) -> PartialSlip | None:
        """Return the zones, or None next to the onset where full stick is as good."""
        from spectral_contact.contact.zone_search import NoZonesError

        # stick radii of the same contact at other times, if it grows
        path: StickPath | None = self.shared.get(COUPLING, (), lambda: None)
        place = place_of(self.parameters)
        search.near = None if path is None else path.near(place)
        try:
            found = search.outcome()
        except NoZonesError:
            if unsure <= ONSET_BAND:
                return None
            closer = closer_tolerance(search.tolerance)
            # without a compliance it takes seconds
            if closer < search.tolerance and search.parameters.alpha and search.parameters.beta:
                return self._found(replace(search, tolerance=closer), unsure)
            raise
        if path is not None:
            path.add(place, found.layout)
        worst = max(
            found.pressure_error, found.traction_error, found.shear_error, found.approach_error
        )
        good = found.consistent and worst <= max(self.rtol, _ROOM * unsure)
        return found if good or unsure > ONSET_BAND else None

    def _take_unlawful(self, stick: FullStick, missing: NoZonesError) -> None:
        """Take what breaks the friction law least, where no zones were found that obey it.

        That are the best of the zones that were solved for, or full stick. What a violation changes
        is of its size, and nothing is known of where the surface slips.
        """
        self.refusal = f"no zones were found that obey the friction law ({missing})"
        excess = stick.critical / self.parameters.friction - 1.0
        violation = excess if missing.best is None else missing.best.violation
        if missing.best is None or violation > excess:
            violation = excess
            self.all_stick()
            self.skip(self.refusal, PARTIAL_SLIP, ZONE_SEARCH, SLIP_FIELD)
        else:
            self.take(replace(missing.best, consistent=False), 1.0)
            self.outcome[PARTIAL_SLIP] = PlannedStep(PARTIAL_SLIP, StepState.RUN, self.refusal)
        for name in self.bounded:
            self.errors[name] += _ROOM * violation
        self.errors.update(
            stick_radius=math.inf, zones=math.inf, slip=math.inf, violation=violation
        )
        self.endings.append(Ending.ZONES)

    def _about_to_slip(self, stick: FullStick, lack: float, radius_error: float) -> None:
        """Take full stick, with room for the slip that was not found.

        It exceeds friction by no more than friction lacks, and what that changes is of its size.
        """
        self.all_stick()
        room = _ROOM * lack
        for name in ("approach", "pressure", "traction", "total_shear"):
            self.errors[name] += room
        self.errors.update(
            stick_radius=radius_error, zones=max(radius_error, 1.0), slip=1.0, violation=lack
        )
        reason = f"slip is too narrow to be found: friction is {lack:.1e} below the critical"
        self.skip(reason, PARTIAL_SLIP, ZONE_SEARCH, SLIP_FIELD)
