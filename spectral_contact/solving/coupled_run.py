"""One solve with elastic coupling: pressure and traction are one system."""

from __future__ import annotations

import math
from dataclasses import replace
from time import perf_counter
from typing import TYPE_CHECKING

from spectral_contact.contact.resolution import (
    NormalContact,
)
from spectral_contact.contact.tuning import (
    NEGLIGIBLE_FRACTION,
    ONSET_BAND,
    ONSET_ERROR_FACTOR,
    TRACTION_ROUNDING,
)
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
from spectral_contact.solving.sharing import log_parameters
from spectral_contact.spectral.parameters import Parameters
from spectral_contact.view.progress import ProgressLine

if TYPE_CHECKING:
    from spectral_contact.contact.ratio import FullStick
    from spectral_contact.contact.slip_outcome import PartialSlip
    from spectral_contact.contact.zone_search import CoupledSearch, NoZonesError
    from spectral_contact.solving.sharing import StickPath


#: Tolerance of full stick that tells whether ``1 - f/f_crit`` is below `ONSET_BAND`.
_ONSET_TOLERANCE = NEGLIGIBLE_FRACTION * ONSET_BAND


class CoupledRun(Run):
    """The steps of a plan with elastic coupling; at friction 0 there is no traction to couple.

    Parameters are those of `Run`.
    """

    def tangential(self, states: dict[str, StepState], contact: NormalContact | None) -> None:
        """Solve for pressure and traction together."""
        if self.scene.friction == 0.0:
            super().tangential(states, contact)
            return
        self._run_coupled(states)

    def run_full_stick(self, contact: NormalContact, states: dict[str, StepState]) -> None:
        """Solve coupled full stick for its ratios q/p; this is called at friction 0 only."""
        self._store_coupled_stick(self._coupled_stick(self.rtol))

    @property
    def parameters(self) -> Parameters:
        """Compliances, kappa and friction, as they are."""
        assert self.scene.friction is not None
        return super().parameters._replace(kappa=self.scene.kappa, friction=self.scene.friction)

    def _run_coupled(self, states: dict[str, StepState]) -> None:
        """Solve full stick, and partial slip if friction is below the critical one."""
        if self.scene.friction == math.inf:
            self.store_all_stick()
            self.errors.update(stick_radius=0.0, zones=0.0, slip=0.0)
        if states[COUPLING] is not StepState.RUN:
            return
        stick = self._coupled_stick(self.rtol)
        self._store_coupled_stick(stick)
        if "pressure" in self.plan.quantities:
            self.values["opening"] = stick.opening
        if stick.opening is not None:
            self.updated_steps[COUPLING] = PlannedStep(
                COUPLING,
                StepState.RUN,
                f"one system; the contact would open within {stick.opening:.3g} of the edge",
            )
        if states[PARTIAL_SLIP] is StepState.SKIPPED:
            return
        if self.is_supercritical():
            self.store_supercritical(stick)
        else:
            self._run_coupled_slip(stick)

    def _coupled_stick(self, rtol: float) -> FullStick:
        """Return coupled full stick; with finite friction close enough to decide on slip."""
        begin = perf_counter()
        if self.scene.friction == math.inf:
            tolerance = rtol
            quantities = set(self.plan.quantities) - {"zones", "stick_radius", "slip"}
            pointwise = not quantities <= {"approach", "total_shear"}
        else:
            tolerance = min(rtol, _ONSET_TOLERANCE)
            pointwise = True
        solved = self.solve_full_stick(self.parameters, tolerance=tolerance, pointwise=pointwise)
        stick: FullStick = self.record(FULL_STICK, solved, begin)
        return stick

    def _store_coupled_stick(self, stick: FullStick) -> None:
        """Store full stick; q/p at the edge has no value if the pressure is not positive there."""
        self.store_full_stick(stick, 1.0)
        if stick.edge_ratio is None and "edge_ratio" in self.plan.quantities:
            self.unavailable["edge_ratio"] = (
                "the traction and the pressure oscillate at the edge of a smooth surface"
                if stick.opening is None
                else f"the contact would open within {stick.opening:.3g} of the edge"
            )

    def _run_coupled_slip(self, stick: FullStick) -> None:
        """Search for the zones of slip; store them, or full stick where slip is unresolved."""
        from spectral_contact.contact.zone_search import CoupledSearch, NoZonesError

        parameters = self.parameters
        search = CoupledSearch(parameters, stick, self.rtol, self.max_unknowns, self.record)
        onset_distance = 1.0 - parameters.friction / stick.critical
        max_onset_distance = onset_distance + stick.critical_error
        # closer to the onset rounding hides the slip
        hidden = onset_distance <= TRACTION_ROUNDING
        with ProgressLine(self.cache.progress) as show_progress:
            if not (parameters.alpha and parameters.beta):
                show_progress("zones of stick and slip")  # without a compliance it takes seconds
            try:
                slip = None if hidden else self._searched_zones(search, max_onset_distance)
            except NoZonesError as error:
                self._store_refuted(stick, error)
                return
        if slip is None:
            self._store_unresolved_slip(stick, max_onset_distance)
            return
        if "opening" in self.values:
            self.values["opening"] = None
        self.store(slip, 1.0)
        reason = "pressure and traction are one system"
        if slip.layout is not None and slip.zones[0].kind == "stick":
            larger_radii = search.larger_radii(slip.layout.logits[0])
            if larger_radii:
                radii = ", ".join(f"{radius:.3g}" for radius in larger_radii)
                reason += f"; a larger stick radius may satisfy the friction law, too: {radii}"
        self.updated_steps[COUPLING] = PlannedStep(COUPLING, StepState.RUN, reason)

    def _searched_zones(self, search: CoupledSearch, onset_distance: float) -> PartialSlip | None:
        """Return partial slip on the zones of a search, or None where full stick is as accurate.

        That may be so only next to the onset of slip. Elsewhere a search that fails is repeated
        with a closer tolerance, unless the surface is smooth.

        Parameters
        ----------
        search : CoupledSearch
        onset_distance : float
            ``1 - f/f_crit``, with the error of the critical friction.
        """
        from spectral_contact.contact.zone_search import NoZonesError

        # of a growing contact: its stick radii at other times
        path: StickPath | None = self.cache.get(COUPLING, (), lambda: None)
        place = log_parameters(self.parameters)
        search.warm_start = None if path is None else path.predict(place)
        try:
            slip = search.outcome()
        except NoZonesError:
            if onset_distance <= ONSET_BAND:
                return None
            closer = closer_tolerance(search.tolerance)
            rough = search.parameters.alpha and search.parameters.beta
            if closer < search.tolerance and rough:  # a smooth surface takes seconds each time
                return self._searched_zones(replace(search, tolerance=closer), onset_distance)
            raise
        if path is not None:
            path.add(place, slip.layout)
        error = max(slip.pressure_error, slip.traction_error, slip.shear_error, slip.approach_error)
        accurate = slip.consistent and error <= max(self.rtol, ONSET_ERROR_FACTOR * onset_distance)
        return slip if accurate or onset_distance > ONSET_BAND else None

    def _store_refuted(self, stick: FullStick, error: NoZonesError) -> None:
        """Store the outcome that violates the friction law least, where the law holds on none.

        That is the best outcome of the search, or full stick. The violation changes the fields by
        about its own size, and leaves nothing known of where the surface slips.
        """
        self.refusal = f"no zones were found that obey the friction law ({error})"
        violation = stick.critical / self.parameters.friction - 1.0  # of full stick
        best = error.least_wrong
        if best is None or best.violation > violation:
            self.store_all_stick()
            self.skip(self.refusal, PARTIAL_SLIP, ZONE_SEARCH, SLIP_FIELD)
        else:
            violation = best.violation
            self.store(replace(best, consistent=False), 1.0)
            self.updated_steps[PARTIAL_SLIP] = PlannedStep(
                PARTIAL_SLIP, StepState.RUN, self.refusal
            )
        for name in self.bounded:
            self.errors[name] += ONSET_ERROR_FACTOR * violation
        self.errors.update(
            stick_radius=math.inf, zones=math.inf, slip=math.inf, violation=violation
        )
        self.endings.append(Ending.ZONES)

    def _store_unresolved_slip(self, stick: FullStick, onset_distance: float) -> None:
        """Store full stick in place of slip that is too narrow to be resolved.

        Its traction exceeds ``f p`` by ``1 - f/f_crit`` at most, and the slip changes the fields by
        about as much, which is added to their errors. If that is little more than the error of the
        critical friction, full stick is solved to a closer tolerance before.

        Parameters
        ----------
        stick : FullStick
        onset_distance : float
            ``1 - f/f_crit``, with the error of the critical friction.
        """
        from spectral_contact.contact.onset import unresolved_slip

        parameters = self.parameters
        closer = closer_tolerance(self.rtol)
        too_inaccurate = ONSET_ERROR_FACTOR * onset_distance > 0.5 * self.rtol
        if closer < min(self.rtol, _ONSET_TOLERANCE) and too_inaccurate:
            stick = self._coupled_stick(closer)
            self._store_coupled_stick(stick)
            onset_distance = (
                max(1.0 - parameters.friction / stick.critical, 0.0) + stick.critical_error
            )
        radius_error = unresolved_slip(stick, parameters)
        self.store_all_stick()
        for name in ("approach", "pressure", "traction", "total_shear"):
            self.errors[name] += ONSET_ERROR_FACTOR * onset_distance
        self.errors.update(
            stick_radius=radius_error,
            zones=max(radius_error, 1.0),
            slip=1.0,
            violation=onset_distance,
        )
        reason = (
            f"slip is too narrow to be found: friction is {onset_distance:.1e} below the critical"
        )
        self.skip(reason, PARTIAL_SLIP, ZONE_SEARCH, SLIP_FIELD)
