"""One solve with elastic coupling: pressure and traction are one system."""

from __future__ import annotations

import math
from time import perf_counter
from typing import TYPE_CHECKING

from spectral_contact.contact.coupled_stick import CoupledStick, solve_coupled_stick
from spectral_contact.contact.normal import NormalContact
from spectral_contact.errors import NotComputedError
from spectral_contact.run import Run
from spectral_contact.solution import (
    COUPLING,
    FULL_STICK,
    PARTIAL_SLIP,
    SLIP_FIELD,
    ZONE_SEARCH,
    PlannedStep,
    StepState,
)

if TYPE_CHECKING:
    from spectral_contact.contact.drive import Drive

__all__ = ["CoupledRun"]


class CoupledRun(Run):
    """The steps of a plan with elastic coupling; without friction the traction is idle."""

    def tangential(self, states: dict[str, StepState], contact: NormalContact | None) -> None:
        """Solve for pressure and traction together."""
        if self.scene.friction == 0.0:
            super().tangential(states, contact)
            return
        self.together(states)

    def stick(self, drive: Drive, states: dict[str, StepState]) -> None:
        """Solve the coupled full stick for its ratios: at friction 0 the fields are not its own."""
        self._take_ratios(self._coupled_stick())

    def together(self, states: dict[str, StepState]) -> None:
        """Solve full stick, and what it decides."""
        friction = self.scene.friction
        assert friction is not None
        if friction == math.inf:
            self.all_stick()
            self.errors.update(stick_radius=0.0, zones=0.0, slip=0.0)
        if states[COUPLING] is not StepState.RUN:
            return
        stick = self._coupled_stick()
        self._take_ratios(stick)
        self.pressure, self.traction = stick.pressure, stick.traction
        self.values.update(approach=stick.approach, total_shear=stick.total_shear)
        self.errors.update(
            approach=stick.approach_error,
            pressure=stick.pressure_error,
            traction=stick.traction_error,
            total_shear=stick.shear_error,
        )
        if "pressure" in self.plan.quantities:
            self.values["opening"] = stick.opening
        if stick.opening is not None:
            self.outcome[COUPLING] = PlannedStep(
                COUPLING,
                StepState.RUN,
                f"one system; the contact would open within {stick.opening:.3g} of the edge",
            )
        if states[PARTIAL_SLIP] is not StepState.SKIPPED:
            self._coupled_slip(stick)

    def _coupled_stick(self) -> CoupledStick:
        scene, begin = self.scene, perf_counter()
        asked = set(self.plan.quantities) - {"zones", "stick_radius", "slip"}
        integrals = scene.friction == math.inf and asked <= {"approach", "total_shear"}
        stick: CoupledStick = self.record(
            FULL_STICK,
            solve_coupled_stick(
                scene.normal_compliance,
                scene.tangential_compliance,
                scene.kappa,
                self.rtol,
                self.max_unknowns,
                pointwise=not integrals,
            ),
            begin,
        )
        return stick

    def _take_ratios(self, stick: CoupledStick) -> None:
        """Copy q/p of full stick, which has no meaning where the pressure is not positive."""
        self.values.update(edge_ratio=stick.edge_ratio, critical_friction=stick.critical)
        self.errors.update(edge_ratio=stick.edge_error, critical_friction=stick.critical_error)
        if stick.edge_ratio is None and "edge_ratio" in self.plan.quantities:
            self.lacking["edge_ratio"] = (
                "the traction and the pressure oscillate at the edge of a smooth surface"
                if stick.opening is None
                else f"the contact would open within {stick.opening:.3g} of the edge"
            )

    def _coupled_slip(self, stick: CoupledStick) -> None:
        """Stop at full stick above the critical friction; partial slip is not solved for."""
        friction = self.scene.friction
        assert friction is not None
        if friction < stick.critical:
            raise NotComputedError(
                "coupled partial slip",
                f"friction = {friction:.6g} is below the critical {stick.critical:.6g}, and full "
                "stick alone is solved for; pass friction=math.inf, or coupling=False",
            )
        self.all_stick()
        # only the errors may say that there is slip
        safe = friction * (1.0 - stick.critical_error) >= stick.critical
        error = 0.0 if safe else 1.0
        self.errors.update(stick_radius=error, zones=error, slip=error, violation=0.0)
        reason = f"friction is not below the critical {stick.critical:.6g}"
        self.skip(reason, PARTIAL_SLIP, ZONE_SEARCH, SLIP_FIELD)
