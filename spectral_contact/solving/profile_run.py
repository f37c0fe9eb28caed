"""The run of a scene with a profile: its normal contact, found with what else it has."""

from __future__ import annotations

from time import perf_counter

from spectral_contact.contact.contact_radius import find_radius
from spectral_contact.contact.indented import Indentation, solve_indentation
from spectral_contact.contact.refine import Refinement
from spectral_contact.solution import NORMAL, PROFILE_QUANTITIES, StepState
from spectral_contact.solving.run import Run

__all__ = ["ProfileRun"]

#: Compliances in units of the contact radius.
_LEAST, _MOST = 1e-14, 1e14


class ProfileRun(Run):
    """The steps of a plan for a scene with a profile."""

    bounded = (*Run.bounded, *PROFILE_QUANTITIES)

    def run_steps(self, states: dict[str, StepState]) -> None:
        """Run normal contact; without friction there is nothing else."""
        if states[NORMAL] is StepState.RUN:
            self._indent()
        self.tangential(states, None)

    def _indent(self) -> None:
        scene, begin = self.scene, perf_counter()
        profile, alpha = scene.profile, scene.normal_compliance
        assert profile is not None
        pointwise = "pressure" in self.plan.quantities
        error = 0.0
        solved: Indentation | Refinement[Indentation]
        if scene.contact_radius is not None:
            solved = solve_indentation(
                profile,
                scene.contact_radius,
                alpha,
                self.rtol,
                self.max_unknowns,
                pointwise=pointwise,
            )
        else:
            solved, error = find_radius(
                profile,
                alpha,
                self.rtol,
                self.max_unknowns,
                load=scene.load,
                approach=scene.approach,
                pointwise=pointwise,
            )
        found: Indentation = self.record(NORMAL, solved, begin)
        self.pressure = found.pressure
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
            stiffness=found.stiffness_error + error,
            indentation_work=found.work_error + 5.0 * error,
            pressure=found.pressure_error + error,
        )
