"""One solve with elastic coupling: pressure and traction are one system."""

from __future__ import annotations

import math
from dataclasses import replace
from time import perf_counter
from typing import TYPE_CHECKING

from spectral_contact.contact.normal import NormalContact
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


#: Full stick to this tolerance is accurate enough to tell whether ``1 - f/f_crit`` is below
#: `ONSET_BAND`.
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
        if states[COUPLING] is not StepState.RUN:
            return
        stick = self._coupled_stick(self.rtol)
        self._store_coupled_stick(stick)
        if "pressure" in self.plan.quantities:
            self.values["opening"] = stick.opening
        if stick.opening is not None:
            self.ran(
                f"one system; the contact would open within {stick.opening:.3g} of the edge",
                COUPLING,
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
                self._store_least_violation(stick, error)
                return
        if slip is None:
            self._store_unresolved_slip(stick, max_onset_distance)
            return
        self._store_slip(slip)

    def _store_slip(self, slip: PartialSlip) -> None:
        """Store partial slip, whose pressure is positive up to the edge."""
        # the opening stored so far, and noted with the coupling, is that of full stick
        if "opening" in self.values:
            self.values["opening"] = None
        self.ran("pressure and traction are one system", COUPLING)
        self.store(slip, 1.0)

    def _searched_zones(
        self, search: CoupledSearch, max_onset_distance: float
    ) -> PartialSlip | None:
        """Return partial slip on the zones of a search, or None where full stick is as accurate.

        Next to the onset of slip, within `ONSET_BAND`, None is returned if the search fails, or if
        the errors of the slip it finds are above `rtol` and above those of full stick. Elsewhere a
        search that fails is repeated with a tighter tolerance, if both compliances are positive.

        Parameters
        ----------
        search : CoupledSearch
        max_onset_distance : float
            ``1 - f/f_crit`` plus the error of the critical friction.
        """
        from spectral_contact.contact.zone_search import NoZonesError

        # stick radii at other times, if the contact grows
        path: StickPath | None = self.cache.get(COUPLING, (), lambda: None)
        log_point = log_parameters(self.parameters)
        search.warm_start = None if path is None else path.predict(log_point)
        try:
            slip = search.outcome()
        except NoZonesError:
            if max_onset_distance <= ONSET_BAND:
                return None
            tighter = closer_tolerance(search.tolerance)
            # without a compliance it takes seconds
            if tighter < search.tolerance and search.parameters.alpha and search.parameters.beta:
                return self._searched_zones(replace(search, tolerance=tighter), max_onset_distance)
            raise
        if path is not None:
            path.add(log_point, slip.layout)
        full_stick_error = ONSET_ERROR_FACTOR * max_onset_distance
        error = search.bounded_error(slip)
        accurate = slip.consistent and error <= max(self.rtol, full_stick_error)
        return slip if accurate or max_onset_distance > ONSET_BAND else None

    def _store_least_violation(self, stick: FullStick, error: NoZonesError) -> None:
        """Store the state that violates the friction law least, as no zones obey it.

        That is the best outcome of the search, or full stick. The violation, relative to ``f p``,
        changes the fields by about its own size. Where the surface slips is not known.
        """
        self.refusal = f"no zones were found that obey the friction law ({error})"
        violation = stick.critical / self.parameters.friction - 1.0  # of full stick
        slip = error.least_wrong
        if slip is None or slip.violation > violation:
            self.store_all_stick()
            self.skip(self.refusal, PARTIAL_SLIP, ZONE_SEARCH, SLIP_FIELD)
        else:
            violation = slip.violation
            self._store_slip(slip)
            self.ran(self.refusal, PARTIAL_SLIP)
        for name in self.bounded:
            self.errors[name] += ONSET_ERROR_FACTOR * violation
        self.errors.update(
            stick_radius=math.inf, zones=math.inf, slip=math.inf, violation=violation
        )
        self.endings.append(Ending.ZONES)

    def _store_unresolved_slip(self, stick: FullStick, max_onset_distance: float) -> None:
        """Store full stick in place of slip that is too narrow to be resolved.

        The traction of full stick exceeds ``f p`` by at most the fraction ``1 - f/f_crit`` of it.
        Slip would change the fields by about as much, which is added to their errors. Where that is
        above `rtol` it may be due to the error of the critical friction, and full stick is first
        solved to a tighter tolerance.

        Parameters
        ----------
        stick : FullStick
        max_onset_distance : float
            ``1 - f/f_crit`` plus the error of the critical friction.
        """
        tighter = closer_tolerance(self.rtol)
        too_inaccurate = ONSET_ERROR_FACTOR * max_onset_distance > 0.5 * self.rtol
        if tighter < min(self.rtol, _ONSET_TOLERANCE) and too_inaccurate:
            stick = self._coupled_stick(tighter)
            self._store_coupled_stick(stick)
            onset_distance = max(1.0 - self.parameters.friction / stick.critical, 0.0)
            max_onset_distance = onset_distance + stick.critical_error
        self.store_all_stick()
        self.store_unresolved_slip_errors(stick)
        for name in self.bounded:
            self.errors[name] += ONSET_ERROR_FACTOR * max_onset_distance
        self.errors["violation"] = max_onset_distance
        below = f"{max_onset_distance:.1e} below the critical"
        reason = f"slip is too narrow to be found: friction is {below}"
        self.skip(reason, PARTIAL_SLIP, ZONE_SEARCH, SLIP_FIELD)
