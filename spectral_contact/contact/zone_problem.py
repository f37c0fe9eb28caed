"""Contact with given states of its zones: boundaries and fields, in spaces that are refined.

With elastic coupling pressure and traction are unknown together; without it the pressure is known,
and everything tangential is for kappa = 1. Full stick has no boundary, one stick disk has one.
Parameters are alpha and beta, the normal and tangential compliance, the elastic coupling kappa and
the friction f.

`refine` chooses the spaces. In each, `find_boundaries` moves the boundaries by Newton's method and
corrects the fields, and `ZoneEstimate` estimates the errors.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from spectral_contact.contact.error_estimate import ZoneEstimate
from spectral_contact.contact.free_boundary import (
    JACOBIAN_FIELD_TOL,
    Corrected,
    FieldSolution,
    Iterate,
    correct_to,
    fd_jacobian,
    find_boundaries,
)
from spectral_contact.contact.layout import Layout, NoBoundariesError, min_zone_width
from spectral_contact.contact.normal import NormalContact
from spectral_contact.contact.refine import Refinement, SpaceSolution, refine
from spectral_contact.contact.resolution import concatenate_spaces
from spectral_contact.contact.stick_radius import (
    MIN_LOGIT,
    NoStickDiskError,
    enclosed_root,
    min_search_logit,
)
from spectral_contact.contact.tuning import (
    COARSE_TOL,
    JACOBIAN_RANGE,
    NEGLIGIBLE_FRACTION,
    RESIDUAL_NOISE,
    ROUNDING,
)
from spectral_contact.contact.zone_solution import ZoneSolution
from spectral_contact.contact.zone_spaces import (
    edge_power,
    first_spaces,
    known_pressure_spaces,
    split_spaces,
)
from spectral_contact.fields.series import Array, PressureField, Radius
from spectral_contact.records import Ending
from spectral_contact.spectral.contact_fields import KnownDisplacement
from spectral_contact.spectral.contact_system import ContactSystem
from spectral_contact.spectral.factored import factored
from spectral_contact.spectral.panels import DiscreteSpace
from spectral_contact.spectral.parameters import Parameters


class FreeBoundaryProblem:
    """The contact with given states of its zones, for `refine`.

    The boundaries are unknowns in every space; each space begins with those of the last one.

    Parameters
    ----------
    parameters : Parameters
    layout : Layout
        States of the zones, and a guess of their boundaries. If it has a Jacobian, both are those
        of nearly the same contact (a warm start), and Newton's method begins from them.
    tolerance : float
        Bound on the relative errors.
    pointwise : bool
        Whether the tolerance bounds the errors of both fields, pointwise. Else it bounds those of
        approach and shear, which are about the squares of the errors of the fields; under a known
        pressure it then bounds that of the shear alone, which is not the square.
    known : NormalContact, optional
        Without elastic coupling, the contact with the pressure; parameters are those for kappa = 1.
    boundary_tolerance : float, optional
        Bound on the relative errors of the boundaries; by default the tolerance.
    displacement : KnownDisplacement, optional
        The displacement u_r that slip which is over has left where the surface sticks now; under a
        known pressure only.
    """

    def __init__(
        self,
        parameters: Parameters,
        layout: Layout,
        tolerance: float,
        *,
        pointwise: bool = True,
        known: NormalContact | None = None,
        boundary_tolerance: float | None = None,
        displacement: KnownDisplacement | None = None,
    ) -> None:
        self.parameters = parameters
        self.pointwise = pointwise
        self.states = layout.states
        self.boundary_tolerance = tolerance if boundary_tolerance is None else boundary_tolerance
        self.field_tolerance = tolerance if pointwise or known else float(np.sqrt(tolerance))
        self.warm_start = layout.jacobian is not None
        self._layout = layout
        self._known = known
        self._displacement = displacement
        self._first_spaces: list[DiscreteSpace] = []

    # systems

    def spaces(self, tolerance: float, logits: Array) -> list[DiscreteSpace]:
        """Return the first spaces of all parts for a tolerance: panels and degrees.

        Of the boundaries only the widths of zones matter, over those of layers. With an unknown
        pressure the spaces also have its power of y next to the edge.
        """
        radii = tuple(map(Radius.from_logit, logits.tolist()))
        if self._known:
            return known_pressure_spaces(self.parameters, radii, self.states, tolerance)
        pressure_power = edge_power(self.parameters, self.states)
        return first_spaces(self.parameters, radii, self.states, tolerance, pressure_power)

    def system(
        self,
        spaces: Sequence[DiscreteSpace],
        logits: Array,
        *,
        parameters: Parameters | None = None,
        with_contributions: bool = False,
    ) -> ContactSystem:
        """Return the equations with given boundaries.

        Parameters
        ----------
        spaces : sequence of DiscreteSpace
        logits : ndarray
        parameters : Parameters, optional
            By default those of the problem.
        with_contributions : bool
            Whether the contributions of the top two degrees of a known pressure and of its top one
            are right-hand sides, too, so that the error of the pressure enters the estimates.

        Raises
        ------
        NoBoundariesError
            If the zone at the edge is too narrow to represent.
        """
        radii = tuple(map(Radius.from_logit, logits.tolist()))
        if len(radii) > 1 and radii[-1].rest < np.finfo(float).eps * self.parameters.alpha:
            raise NoBoundariesError("the last zone vanishes")
        pressures: list[PressureField] = []
        if self._known is not None:
            pressures = [self._known.pressure]
            if with_contributions:
                contributions = [change.pressure for change in self._known.changes]
                # a pressure in closed form has no top degrees in a space of its own
                zero = PressureField(None, None)
                pressures += contributions or [zero, zero]
        return ContactSystem(
            radii,
            self.states,
            spaces,
            parameters or self.parameters,
            pressures,
            displacement=self._displacement,
        )

    def _boundaries_from(
        self,
        layout: Layout,
        spaces: Sequence[DiscreteSpace],
        boundary_tol: float,
        field_tol: float,
        *,
        with_contributions: bool = False,
    ) -> Iterate:
        """Return boundaries and fields in these spaces, from the boundaries of a layout."""

        def system_at(logits: Array) -> ContactSystem:
            return self.system(spaces, logits, with_contributions=with_contributions)

        assert layout.jacobian is not None
        logits = np.array(layout.logits)
        start = Iterate.first(logits, layout.jacobian, system_at(logits))
        return find_boundaries(
            system_at, start, boundary_tol, field_tol, warm_start=self.warm_start
        )

    # the first boundaries, in small spaces

    def coarse_solution(self, logit: float) -> FieldSolution:
        """Return the fields with one given boundary in the smallest space, that of COARSE_TOL."""
        logits = np.array([logit])
        system = self.system(self.spaces(COARSE_TOL, logits), logits)
        return correct_to(FieldSolution.first(factored(system)), COARSE_TOL).fields

    def coarse_residual(self, logit: float) -> float:
        """Return the boundary residual of `coarse_solution`."""
        return float(self.coarse_solution(logit).boundary_residual[0])

    def current_layout(self) -> Layout:
        """Return the boundaries to begin with in a space, and their Jacobian.

        Those of the last space; in the first space those of a warm start, or the guess improved to
        a few digits.

        Raises
        ------
        NoBoundariesError, NoStickDiskError
            If the boundary residual has no root near the guess.
        """
        layout = self._layout
        if layout.jacobian is not None:
            return layout
        if not layout.logits:
            return layout._replace(jacobian=np.zeros((0, 0)))
        if len(layout.logits) == 1:
            return self._initial_disk(layout.logits[0])
        logits = np.array(layout.logits)
        guess = layout._replace(jacobian=self.jacobian(logits))
        boundary_tol = min(COARSE_TOL, 0.5 * JACOBIAN_RANGE * min_zone_width(logits))
        iterate = self._boundaries_from(
            guess, self.spaces(COARSE_TOL, logits), boundary_tol, COARSE_TOL
        )
        next_step = float(np.abs(iterate.newton_step).max())
        if not next_step < JACOBIAN_RANGE * min_zone_width(iterate.logits):
            raise NoBoundariesError("no such boundaries are found")
        return self._layout_of(iterate.logits, iterate.jacobian)

    def _initial_disk(self, guess: float) -> Layout:
        """Return the boundary of one stick disk, and the slope of its residual."""
        least = MIN_LOGIT if self._known else min_search_logit(self.parameters)
        logit, slope = enclosed_root(self.coarse_residual, guess, COARSE_TOL, least=least)
        return self._layout_of(np.array([logit]), np.array([[slope]]))

    def jacobian(self, logits: Array, tolerance: float = JACOBIAN_FIELD_TOL) -> Array:
        """Return the Jacobian of the boundary residual by differences in the space of COARSE_TOL.

        The fields that are subtracted have errors up to the tolerance.
        """
        spaces = self.spaces(COARSE_TOL, logits)
        factors = factored(self.system(spaces, logits))
        centre = correct_to(FieldSolution.first(factors), tolerance).fields

        def residual(moved_logits: Array) -> Array:
            moved = replace(centre, system=self.system(spaces, moved_logits))
            return correct_to(moved, tolerance).fields.boundary_residual

        return fd_jacobian(residual, logits)

    def _layout_of(self, logits: Array, jacobian: Array) -> Layout:
        """Return these boundaries with the states of this problem."""
        return Layout(tuple(logits.tolist()), self.states, jacobian)

    # the interface of `refine`

    def start(self) -> DiscreteSpace:
        """Return the first space: those of all parts, concatenated."""
        self._layout = self.current_layout()
        logits = np.array(self._layout.logits)
        # boundaries superconverge: a space for half the digits has nearly all of theirs
        halfway_tol = float(np.sqrt(self.field_tolerance))
        if len(logits) and halfway_tol < COARSE_TOL and not (self._known and self.warm_start):
            boundary_tol = max(self.field_tolerance, RESIDUAL_NOISE)
            iterate = self._boundaries_from(
                self._layout, self.spaces(halfway_tol, logits), boundary_tol, halfway_tol
            )
            logits = iterate.logits
            if iterate.converged:
                logits = logits + iterate.newton_step
            self._layout = self._layout_of(logits, iterate.jacobian)
        self._first_spaces = self.spaces(self.field_tolerance, logits)
        return concatenate_spaces(self._first_spaces)

    def split(self, space: DiscreteSpace) -> list[DiscreteSpace]:
        """Return the spaces of all parts, from one that concatenates them as `start` does."""
        return split_spaces(space, self._first_spaces)

    def attempt(self, space: DiscreteSpace) -> SpaceSolution[ZoneSolution]:
        """Solve in a space, from the boundaries of the last one."""
        spaces = self.split(space)
        negligible = NEGLIGIBLE_FRACTION * self.boundary_tolerance
        boundary_tol = max(negligible, RESIDUAL_NOISE)
        if self.parameters.beta == 0.0:
            # a misplaced boundary leaves a traction that is singular there, of which no estimate
            # of the fields knows: the boundary is found to rounding
            boundary_tol = RESIDUAL_NOISE
        field_tol = max(negligible, 2.0 * ROUNDING)
        iterate = self._boundaries_from(
            self.current_layout(), spaces, boundary_tol, field_tol, with_contributions=True
        )
        if not iterate.converged:
            # next to the onset of a zone no step is below the tolerance, and Broyden's Jacobian is
            # not accurate enough for the estimates
            iterate = replace(iterate, jacobian=self.jacobian(iterate.logits, ROUNDING))
        self._layout = self._layout_of(iterate.logits, iterate.jacobian)
        return self.estimate(iterate)

    def estimate(self, iterate: Iterate) -> SpaceSolution[ZoneSolution]:
        """Return a solution with the estimates of its errors."""
        solution = ZoneEstimate(iterate, pointwise=self.pointwise).with_errors()
        if self._known and not self.pointwise:
            return replace(solution, error=solution.value.shear_error)
        return solution


class _GivenRadius(FreeBoundaryProblem):
    """Contact with a stick disk of a given radius, whose friction is unknown, for `refine`."""

    def attempt(self, space: DiscreteSpace) -> SpaceSolution[ZoneSolution]:
        """Solve in a space.

        The boundary residual ``r(f) = r(0) - f (r(0) - r(1))`` is linear in the friction, so that
        its root follows from two solutions. Its derivative by ``ln f`` at the root is ``-r(0)``;
        ``r(0)`` takes the place of the Jacobian in the estimate, where only moduli count.
        """
        spaces = self.split(space)
        logits = np.array(self._layout.logits)

        def system_at(friction: float) -> ContactSystem:
            parameters = self.parameters._replace(friction=friction)
            return self.system(spaces, logits, parameters=parameters, with_contributions=True)

        def solved(system: ContactSystem) -> Corrected:
            return correct_to(FieldSolution.first(factors, system), RESIDUAL_NOISE)

        frictionless = system_at(0.0)
        # the friction is in the right-hand sides only, so that these factors serve for any
        factors = factored(frictionless)
        without_friction, unit_friction = (
            float(solved(system).fields.boundary_residual[0])
            for system in (frictionless, system_at(1.0))
        )
        if not (without_friction > 0.0 and without_friction > unit_friction):
            raise NoStickDiskError(at_centre=False)
        friction = without_friction / (without_friction - unit_friction)
        fields, remaining = solved(system_at(friction))
        iterate = Iterate(logits, np.array([[without_friction]]), fields, remaining)
        return self.estimate(iterate)


def solve_stick(
    parameters: Parameters,
    tolerance: float,
    max_unknowns: int,
    *,
    known: NormalContact | None = None,
    pointwise: bool = True,
) -> Refinement[ZoneSolution]:
    """Solve with stick on the whole contact; see `solve_coupled_zones`."""
    full_stick = Layout((), (0,))
    if known is None:
        return solve_coupled_zones(
            parameters, full_stick, tolerance, max_unknowns, pointwise=pointwise
        )
    problem = FreeBoundaryProblem(
        parameters, full_stick, tolerance, pointwise=pointwise, known=known
    )
    return refine(problem, tolerance, max_unknowns)


def solve_given_radius(
    known: NormalContact,
    parameters: Parameters,
    radius: Radius,
    tolerance: float,
    max_unknowns: int,
) -> tuple[Refinement[ZoneSolution], float]:
    """Solve with one central stick disk of a given radius; return the friction ``f/kappa``, too.

    `ZoneSolution.logit_errors` is the error of ``ln f`` here, as the radius has none. Raises
    `NoStickDiskError` if the disk has this radius at no friction.
    """
    # with a Jacobian, of whatever value, no boundary is looked for (`current_layout`)
    disk = Layout((radius.logit,), (0, 1), np.eye(1))
    problem = _GivenRadius(parameters, disk, tolerance, known=known)
    refinement = refine(problem, tolerance, max_unknowns)
    # the last space may not be the best one
    return refinement, refinement.best.value.system.parameters.friction


def solve_coupled_zones(
    parameters: Parameters,
    layout: Layout,
    tolerance: float,
    max_unknowns: int,
    *,
    pointwise: bool = True,
) -> Refinement[ZoneSolution]:
    """Solve the coupled contact with the zones of a layout.

    The tolerance bounds the fields pointwise, or approach and shear. Where refinement stalls it
    begins once more, with the finer first space of a hundredth of the tolerance. `max_unknowns`
    bounds the unknowns of both fields together. The friction law is not checked here. Raises
    `NoBoundariesError` if there are no such boundaries.
    """
    refinements = list[Refinement[ZoneSolution]]()
    for space_tolerance in (tolerance, NEGLIGIBLE_FRACTION * tolerance):
        problem = FreeBoundaryProblem(parameters, layout, space_tolerance, pointwise=pointwise)
        # `refine` counts coefficients of the panels, each of which stands for p and for q/s
        refinements.append(refine(problem, tolerance, max_unknowns // 2))
        if refinements[-1].ending is not Ending.ROUNDING:
            break
    return min(refinements, key=lambda refinement: refinement.best.error)
