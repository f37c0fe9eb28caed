"""Any zones of stick and slip, with free boundaries, in spaces that are refined.

With elastic coupling pressure and traction are unknown together; without it the pressure is known,
and everything tangential is for kappa = 1. Full stick has no boundary, one stick disk has one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from spectral_contact.contact.error_estimate import ZoneEstimate, ZoneSolution, relative_size
from spectral_contact.contact.free_boundary import (
    FieldSolution,
    FreeBoundary,
    Iterate,
    corrected,
)
from spectral_contact.contact.layout import Layout, NoBoundariesError
from spectral_contact.contact.refine import Attempt, Refinement, refine
from spectral_contact.contact.resolution import (
    PROBE,
    ROUGH,
    ROUNDING,
    TRIFLING,
    NormalContact,
    joined,
)
from spectral_contact.contact.stick_radius import (
    LEAST_LOGIT,
    NOISE,
    SLOPING,
    NoStickDiskError,
    differences,
    least_logit,
    root_near,
)
from spectral_contact.contact.zone_spaces import first_spaces, known_pressure_spaces, parted
from spectral_contact.fields.series import Array, PressureField, Radius
from spectral_contact.records import Ending
from spectral_contact.spectral.contact_system import ContactSystem
from spectral_contact.spectral.factored import Factored, factored
from spectral_contact.spectral.panels import DiscreteSpace
from spectral_contact.spectral.parameters import Parameters

#: A last zone that is narrower than this share of the layer at the edge is none: 1e-12 misses
#: annuli of 4e-12, and with 1e-16 no digit of them is another one.
_NARROWEST_AT_EDGE = 1e-14
#: The Jacobian serves as long as boundaries move by less than this share of the narrowest zone.
_JACOBIAN_RANGE = 0.1
#: Where the estimate stalls the first space is that of this share of the tolerance, so many times,
#: and never of less than a least tolerance.
_TIGHTER, _MOST_TRIES, _TIGHTEST = 0.1, 3, 1e-12
#: Slope of the condition of one stick radius in its logit to begin secants with.
_FIRST_SLOPE = 0.5


class FreeBoundaryProblem:
    """Spaces for given states of the zones; the boundaries are found anew in each of them.

    Parameters
    ----------
    parameters : Parameters
    layout : Layout
        States of the zones, and a guess of their boundaries. Where it has a Jacobian the boundaries
        are near by.
    tolerance : float
        Bound on the relative errors of both fields, pointwise.
    pointwise : bool
        Whether it is that; else it bounds approach and shear, which err like its square.
    known : NormalContact, optional
        The contact whose pressure is known; parameters are those for kappa = 1 then.
    goal : float, optional
        Bound on the relative errors of the boundaries; by default the tolerance.
    """

    def __init__(
        self,
        parameters: Parameters,
        layout: Layout,
        tolerance: float,
        *,
        pointwise: bool = True,
        known: NormalContact | None = None,
        goal: float | None = None,
    ) -> None:
        self.parameters, self.pointwise = parameters, pointwise
        self.states = layout.states
        self.goal = tolerance if goal is None else goal
        self.tolerance = tolerance if pointwise or known else float(np.sqrt(tolerance))
        self.near = layout.jacobian is not None
        self._layout = layout
        self._known = known
        self._counts: list[int] = []

    # systems

    def spaces(self, tolerance: float, logits: Array) -> list[DiscreteSpace]:
        """Return the first spaces for a tolerance, with these boundaries."""
        alpha, beta, _, _ = self.parameters
        radii = tuple(map(Radius.from_logit, logits.tolist()))
        first = known_pressure_spaces if self._known else first_spaces
        return first(alpha, beta, radii, self.states, tolerance)

    def system(
        self, spaces: Sequence[DiscreteSpace], logits: Array, *, changes: bool = False
    ) -> ContactSystem:
        """Return the equations with given boundaries.

        Parameters
        ----------
        spaces : sequence of DiscreteSpace
        logits : ndarray
        changes : bool
            Whether it takes the changes of a known pressure, which tell of its error.

        Raises
        ------
        NoBoundariesError
            If a zone vanishes.
        """
        radii = tuple(map(Radius.from_logit, logits.tolist()))
        if len(radii) > 1 and radii[-1].rest < _NARROWEST_AT_EDGE * self.parameters.alpha:
            raise NoBoundariesError("the last zone vanishes")
        pressures: list[PressureField] = []
        if self._known is not None:
            pressures = [self._known.pressure]
            if changes:
                own = [change.pressure for change in self._known.changes]
                nothing = PressureField(None, None)  # an exact pressure has no error of its own
                pressures += own or [nothing, nothing]
        return ContactSystem(
            radii,
            self.states,
            spaces,
            self.parameters,
            pressures,
            truncated=changes and self._known is not None,
        )

    def _newton(self, spaces: Sequence[DiscreteSpace], *, changes: bool = False) -> FreeBoundary:
        return FreeBoundary(
            lambda logits: self.system(spaces, logits, changes=changes), relative_size
        )

    # where boundaries are looked for first, in small spaces

    def rough(self, logit: float) -> FieldSolution:
        """Return the contact with one given boundary in a small space."""
        logits = np.array([logit])
        system = self.system(self.spaces(PROBE, logits), logits)
        return corrected(FieldSolution.first(factored(system)), ROUGH, relative_size).fields

    def located(self) -> Layout:
        """Return the boundaries with their Jacobian: as they are given, or as found roughly.

        Raises
        ------
        NoBoundariesError, NoStickDiskError
            If there are none.
        """
        layout = self._layout
        if layout.jacobian is not None:
            return layout
        if not layout.logits:
            return layout._replace(jacobian=np.zeros((0, 0)))
        if len(layout.logits) == 1:
            return self._located_disk(layout.logits[0])
        logits = np.array(layout.logits)
        spaces = self.spaces(ROUGH, logits)
        newton = self._newton(spaces)
        jacobian = self._jacobian(spaces, logits)
        settle = min(ROUGH, 0.5 * _JACOBIAN_RANGE * narrowest(logits))
        iterate = newton.solve(newton.start(logits, jacobian), settle, ROUGH)
        left = float(np.abs(iterate.newton_step).max())
        if not left < _JACOBIAN_RANGE * narrowest(iterate.logits):
            raise NoBoundariesError("no such boundaries are found")
        return self._layout_of(iterate.logits, iterate.jacobian)

    def _located_disk(self, guess: float) -> Layout:
        """Return the boundary of one stick disk, and the slope of its residual."""
        least = LEAST_LOGIT if self._known else least_logit(self.parameters)

        def residual(logit: float) -> float:
            return float(self.rough(logit).boundary_residual[0])

        logit, slope = root_near(residual, guess, _FIRST_SLOPE, ROUGH, least=least)
        return self._layout_of(np.array([logit]), np.array([[slope]]))

    def _jacobian(
        self, spaces: Sequence[DiscreteSpace], logits: Array, tolerance: float = SLOPING
    ) -> Array:
        """Return the derivatives of the boundary residual by differences."""
        factors = factored(self.system(spaces, logits))
        begin = corrected(FieldSolution.first(factors), tolerance, relative_size).fields

        def residual(at: Array) -> Array:
            moved = replace(begin, system=self.system(spaces, at))
            return corrected(moved, tolerance, relative_size).fields.boundary_residual

        return differences(residual, logits)

    def _layout_of(self, logits: Array, jacobian: Array) -> Layout:
        return Layout(tuple(logits.tolist()), self.states, jacobian)

    # what `refine` asks for

    def start(self) -> DiscreteSpace:
        """Return the first space, of all parts one after the other."""
        self._layout = self.located()
        logits = np.array(self._layout.logits)
        # boundaries superconverge: in a space for half the digits they have nearly all of theirs
        halfway = float(np.sqrt(self.tolerance))
        if len(logits) and halfway < _TIGHTER * ROUGH and not (self._known and self.near):
            newton = self._newton(self.spaces(halfway, logits))
            assert self._layout.jacobian is not None
            begin = newton.start(logits, self._layout.jacobian)
            settle = max(self.tolerance, NOISE)
            iterate = newton.solve(begin, settle, halfway, near=self.near)
            logits = iterate.logits
            if iterate.converged:
                logits = logits + iterate.newton_step
            self._layout = self._layout_of(logits, iterate.jacobian)
        spaces = self.spaces(self.tolerance, logits)
        self._counts = [space.panels.panels for space in spaces]
        return joined(spaces)

    def parted(self, resolution: DiscreteSpace) -> list[DiscreteSpace]:
        """Return the spaces of all parts, of one like that of `start`."""
        return parted(resolution, self._counts, self.parameters.alpha)

    def attempt(self, resolution: DiscreteSpace) -> Attempt[ZoneSolution]:
        """Solve in a space."""
        spaces = self.parted(resolution)
        layout = self.located()
        newton = self._newton(spaces, changes=True)
        least = TRIFLING * self.goal
        assert layout.jacobian is not None
        begin = newton.start(np.array(layout.logits), layout.jacobian)
        iterate = newton.solve(begin, max(least, NOISE), max(least, 2.0 * ROUNDING), near=self.near)
        if not iterate.converged:  # next to the onset of a zone steps say nothing of the Jacobian
            jacobian = self._jacobian(self.spaces(ROUGH, iterate.logits), iterate.logits, ROUNDING)
            iterate = replace(iterate, jacobian=jacobian)
        self._layout = self._layout_of(iterate.logits, iterate.jacobian)
        return self.estimated(iterate, spaces)

    def estimated(self, iterate: Iterate, spaces: list[DiscreteSpace]) -> Attempt[ZoneSolution]:
        """Return a solution with the estimates of its errors."""
        attempt = ZoneEstimate(iterate, spaces, pointwise=self.pointwise).attempt()
        if self._known and not self.pointwise:
            return replace(attempt, error=attempt.value.shear_error)
        return attempt


def narrowest(logits: Array) -> float:
    """Return the width of the narrowest zone between boundaries, as logits, or 1."""
    return float(min([1.0, *np.diff(logits)]))


class _GivenRadius(FreeBoundaryProblem):
    """Spaces for a stick disk of a given radius, whose friction is found."""

    def attempt(self, resolution: DiscreteSpace) -> Attempt[ZoneSolution]:
        """Solve in a space; the derivative is that by the logarithm of the friction."""
        spaces = self.parted(resolution)
        logits = np.array(self._layout.logits)
        residuals = []
        factors: Factored | None = None
        for friction in (0.0, 1.0):
            self.parameters = self.parameters._replace(friction=friction)
            system = self.system(spaces, logits)
            factors = factors or factored(system)
            begin = FieldSolution.first(factors, system)
            fields = corrected(begin, NOISE, relative_size).fields
            residuals.append(float(fields.boundary_residual[0]))
        none, full = residuals
        # the residual is linear in the friction
        if not (none > 0.0 and none > full):
            raise NoStickDiskError(at_centre=False)
        self.parameters = self.parameters._replace(friction=none / (none - full))
        assert factors is not None
        system = self.system(spaces, logits, changes=True)
        begin = FieldSolution.first(factors, system)
        fields, remaining = corrected(begin, NOISE, relative_size)
        iterate = Iterate(logits, np.array([[none]]), fields, remaining)
        return self.estimated(iterate, spaces)


def solve_stick(
    parameters: Parameters,
    tolerance: float,
    max_unknowns: int,
    *,
    known: NormalContact | None = None,
    pointwise: bool = True,
) -> Refinement[ZoneSolution]:
    """Solve with stick on the whole contact; see `solve_zones`."""
    stuck = Layout((), (0,))
    if known is None:
        return solve_zones(parameters, stuck, tolerance, max_unknowns, pointwise=pointwise)
    problem = FreeBoundaryProblem(parameters, stuck, tolerance, pointwise=pointwise, known=known)
    return refine(problem, tolerance, max_unknowns)


def solve_given_radius(
    known: NormalContact,
    parameters: Parameters,
    radius: Radius,
    tolerance: float,
    max_unknowns: int,
) -> tuple[Refinement[ZoneSolution], float]:
    """Solve with one central stick disk of a given radius; return the friction ``f/kappa``, too.

    ``shifts`` are the error of its logarithm; raises `NoStickDiskError` if none has this disk.
    """
    disk = Layout((radius.logit,), (0, 1), np.eye(1))
    problem = _GivenRadius(parameters, disk, tolerance, known=known)
    return refine(problem, tolerance, max_unknowns), problem.parameters.friction


def solve_zones(
    parameters: Parameters,
    layout: Layout,
    tolerance: float,
    max_unknowns: int,
    *,
    pointwise: bool = True,
) -> Refinement[ZoneSolution]:
    """Solve the coupled contact with the zones of a layout: a guess, or that of a problem.

    The tolerance bounds the fields pointwise, or approach and shear. Whether the friction law holds
    is for the caller to check; raises `NoBoundariesError` if there are no such boundaries.
    """
    found = list[Refinement[ZoneSolution]]()
    for k in range(_MOST_TRIES):
        aim = max(_TIGHTER**k * tolerance, _TIGHTEST)
        problem = FreeBoundaryProblem(parameters, layout, aim, pointwise=pointwise)
        found.append(refine(problem, tolerance, max_unknowns // 2))
        best = min(found, key=lambda one: one.best.error)
        if best.ending is not Ending.ROUNDING or aim == _TIGHTEST:
            break
    return best
