"""One stick disk under a given pressure, or all of it: a matrix costs next to nothing.

So the radius is enclosed. At a given radius everything is linear in the friction, too, so that the
friction of a disk needs no search.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np

from spectral_contact.contact.drive import Drive
from spectral_contact.contact.layout import Layout
from spectral_contact.contact.refine import Attempt, Refinement, refine
from spectral_contact.contact.resolution import PROBE, ROUGH, ROUNDING, TRIFLING, on_mesh
from spectral_contact.contact.stick_radius import (
    LARGEST_LOGIT,
    LEAST_LOGIT,
    NoStickDiskError,
    guessed_radius,
    root_near,
    slope_at,
)
from spectral_contact.contact.zone_assessment import Assessment, ZoneSolution
from spectral_contact.contact.zone_newton import ZoneState
from spectral_contact.contact.zone_problem import FreeBoundaryProblem
from spectral_contact.fields.series import Array, Radius
from spectral_contact.spectral.factored import Factored, factored
from spectral_contact.spectral.panels import Resolution
from spectral_contact.spectral.parameters import Parameters
from spectral_contact.spectral.regularised import HARMLESS

#: Error of the radius, as a logit, from which finer spaces start; 1e-3 and 1e-8 do not change them.
_NEAR = 1e-5


class StickDiskProblem(FreeBoundaryProblem):
    """Spaces for the stick disk; the radius is found anew in each of them, if there is one.

    Parameters are those of `FreeBoundaryProblem`, with the drive.
    """

    def __init__(
        self,
        parameters: Parameters,
        layout: Layout,
        tolerance: float,
        drive: Drive,
        *,
        pointwise: bool = True,
    ) -> None:
        super().__init__(parameters, layout, tolerance, pointwise=pointwise, drive=drive)
        self.drive, self.tolerance = drive, tolerance

    def find(self, layout: Layout) -> None:
        """Find the radius, and the slope there: roughly, or near that of a layout."""
        logit, slope = self._found(layout)
        self.logits, self.slopes = np.array([logit]), np.array([[slope]])

    def _found(self, layout: Layout) -> tuple[float, float]:
        form, (beta, near) = (self.drive, self.parameters), (self.parameters.beta, None)
        if layout.logits and layout.slopes is None:  # in a space that sees a narrow annulus
            [guess] = layout.logits
            spaces = self.spaces(self.tolerance, np.array([guess]))
            return guess, slope_at(partial(self._mismatch, spaces), guess)
        if layout.logits and layout.slopes is not None:
            near = layout.logits[0], float(layout.slopes[0, 0])
            if not LEAST_LOGIT < near[0] < LARGEST_LOGIT:
                near = None
        if beta == 0.0:
            return guessed_radius(*form, _NEAR, near)
        near = near or guessed_radius(*form, PROBE)
        small = self.spaces(ROUGH, np.array(near[:1]))
        return root_near(lambda x: self._mismatch(small, x, rough=True), *near, _NEAR)

    def _mismatch(self, spaces: list[Resolution], logit: float, *, rough: bool = False) -> float:
        return float(self.at(spaces, np.array([logit]), rough=rough).mismatch[0])

    def at(
        self,
        spaces: list[Resolution],
        logits: Array,
        factors: Factored | None = None,
        *,
        rough: bool = False,
    ) -> ZoneState:
        """Return the solution with a given radius, to rounding, or roughly."""
        system = self.system(spaces, logits, rough=rough)
        state = ZoneState.begin(factors or factored(system), system)
        # the normal equations lose digits where compliance is small
        radius = system.radii[0].value if system.radii else 1.0
        stiff = self.parameters.beta < HARMLESS * radius
        for _ in range((factors is not None) + (stiff and not rough)):
            state, _ = state.corrected()
        return state

    def start(self) -> Resolution:
        """Return the first space of the disk."""
        return on_mesh(self.spaces(self.tolerance)[0], self.drive.contact.panels)

    def parted(self, resolution: Resolution) -> list[Resolution]:
        """Return the spaces of all parts: in slip nothing is unknown."""
        return [resolution] * (2 * len(self.states) - 1)

    def attempt(self, resolution: Resolution) -> Attempt[ZoneSolution]:
        """Solve in a space."""
        spaces, drive = self.parted(resolution), self.drive
        self.drives = [drive]
        if len(self.logits):
            begin, form = (float(self.logits[0]), float(self.slopes[0, 0])), self.parameters
            least = max(TRIFLING * self.tolerance, ROUNDING)
            if self.parameters.beta == 0.0:  # no field is in the condition
                logit, slope = guessed_radius(drive, form, least, begin, accuracy=ROUNDING)
            else:
                mismatch = partial(self._mismatch, spaces)
                logit, slope = root_near(mismatch, *begin, least, known=ROUGH)
            self.logits, self.slopes = np.array([logit]), np.array([[slope]])
        return self.assessed(spaces)

    def assessed(self, spaces: list[Resolution]) -> Attempt[ZoneSolution]:
        """Return the solution with the radius as it is, with its errors."""
        # with what is known of the errors of the pressure
        self.drives = [self.drive, *self.drive.changes]
        state, own = self.at(spaces, self.logits), len(spaces[0].degrees)
        attempt = Assessment(self, spaces, state, 0.0).attempt()
        return replace(
            attempt,
            error=attempt.error if self.pointwise else attempt.value.shear_error,
            indicators=attempt.indicators[:own],
            rates=attempt.rates[:own],
        )


class _GivenRadius(StickDiskProblem):
    """Spaces for a stick disk of a given radius, whose friction is found."""

    def attempt(self, resolution: Resolution) -> Attempt[ZoneSolution]:
        """Solve in a space; the slope is that by the logarithm of the friction."""
        spaces, mismatches = self.parted(resolution), list[float]()
        self.drives, factors = [self.drive], None
        for friction in (0.0, 1.0):
            self.parameters = self.parameters._replace(friction=friction)
            state = self.at(spaces, self.logits, factors)
            factors = state.factored
            mismatches.append(float(state.mismatch[0]))
        none, full = mismatches
        if not (none > 0.0 and none > full):
            raise NoStickDiskError(at_centre=False)
        self.parameters = self.parameters._replace(friction=none / (none - full))
        self.slopes = np.array([[none]])
        return self.assessed(spaces)


def solve_stick_disk(
    drive: Drive, parameters: Parameters, layout: Layout, tolerance: float, max_unknowns: int
) -> Refinement[ZoneSolution]:
    """Solve partial slip under the assumption of one central stick disk, for kappa = 1.

    Parameters
    ----------
    drive : Drive
        Right-hand side, from the normal problem.
    parameters : Parameters
        For kappa = 1; friction is positive and below the critical value.
    layout : Layout
        The disk: with its slope as a like scene has it, with a guess of its radius, or with none.
    tolerance : float
        Bound on the relative error of q/s, pointwise.
    max_unknowns : int
        Most unknowns of a space.

    Returns
    -------
    Refinement
        Whether the assumption holds is for the caller to check.

    Raises
    ------
    NoStickDiskError
        If no radius in the range searched makes the traction continuous.
    """
    # 1 - c falls like exp(-pi f/(2 kappa))
    if parameters.beta == 0.0 and parameters.friction > LARGEST_LOGIT:
        raise NoStickDiskError(at_centre=False)
    problem = StickDiskProblem(parameters, layout, tolerance, drive)
    problem.find(layout)
    return refine(problem, tolerance, max_unknowns)


def solve_given_radius(
    drive: Drive, parameters: Parameters, radius: Radius, tolerance: float, max_unknowns: int
) -> tuple[Refinement[ZoneSolution], float]:
    """Solve partial slip with one central stick disk of a given radius, for kappa = 1.

    Parameters are those of `solve_stick_disk`; the friction that they have does not count.

    Returns
    -------
    Refinement
        Its ``shifts`` are the error of ``ln f``.
    float
        The friction ``f / kappa``.

    Raises
    ------
    NoStickDiskError
        If no friction has this disk.
    """
    known = Layout((radius.logit,), (0, 1), np.eye(1))
    problem = _GivenRadius(parameters, known, tolerance, drive)
    return refine(problem, tolerance, max_unknowns), problem.parameters.friction
