r"""Free boundaries: Newton's method for the boundaries between zones and the fields on them.

At given boundaries the equations are linear. Their solution has a continuous traction, but the
residual E of the tangential equation has a *defect* at every boundary: a number that would have to
be zero (`spectral.contact_system`). The *boundary residual* is minus that defect over ``kappa R``
there, the value that stick prescribes for the half-integral of the traction; boundaries are where
it vanishes. They are found by Newton's method with Broyden's update of the Jacobian.

To save factorisations the factors of a system whose boundaries are near by serve as a
preconditioner. The residual is always that of the system at hand, so that the limit of the
corrections is exact and only their number grows. When they do not shrink as they should, the matrix
is factored anew.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import inf, pi
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from spectral_contact.contact.layout import NoBoundariesError
from spectral_contact.contact.relative_changes import relative_changes
from spectral_contact.contact.resolution import TINY
from spectral_contact.contact.tuning import (
    COARSE_TOL,
    JACOBIAN_RANGE,
    MAX_CONTRACTION,
    MAX_STEPS,
    MIN_STEP_ANGLE,
    NEGLIGIBLE_FRACTION,
    PANEL_WIDTH,
    RESIDUAL_NOISE,
    RIGID_TRACTION_ROUNDING,
    ROUNDING,
)
from spectral_contact.fields.series import Array
from spectral_contact.spectral.factored import FactoredSystem, factored
from spectral_contact.threads import cached_property

if TYPE_CHECKING:
    from spectral_contact.spectral.contact_system import ContactSystem

#: Error to which fields are corrected before a Jacobian is taken from their differences. The step
#: of the differences is its cube root, COARSE_TOL, times the width of a zone (`fd_jacobian`).
JACOBIAN_FIELD_TOL = COARSE_TOL**3


class Perturbation(NamedTuple):
    """A first-order change of a solution at unit load, by another space or other defects.

    Attributes
    ----------
    change, defects : ndarray
        Change of the vector of the system, and of the defects.
    boundary_residual : ndarray
        Change of the boundary residual.
    approach : float
        Relative change of the approach.
    """

    change: Array
    defects: Array
    boundary_residual: Array
    approach: float


@dataclass(frozen=True, eq=False)
class FieldSolution:
    """The fields on given boundaries for unit approach, with a continuous traction.

    A known pressure has unit load instead, and `approach`, which scales to that, is 1.

    Attributes
    ----------
    system : ContactSystem
    factors : FactoredSystem
        Factors of the matrix of this system, or of one with slightly different boundaries.
    values : ndarray, shape (unknowns,)
        The vector of the system.
    defects : ndarray, shape (boundaries,)
        Defects of E at the boundaries by which the traction is continuous; without tangential
        compliance, by which E(b) is zero.
    """

    system: ContactSystem
    factors: FactoredSystem
    values: Array
    defects: Array

    @classmethod
    def first(cls, factors: FactoredSystem, system: ContactSystem | None = None) -> FieldSolution:
        """Return the direct solution with the factors, as a start in their system or another."""
        system = system or factors.system
        no_defects = np.zeros(len(system.radii))
        direct = cls(system, factors, factors.unit_solutions[:, 0], no_defects)
        return direct._continuous(direct.values, no_defects)

    def _continuous(self, values: Array, defects: Array) -> FieldSolution:
        """Return fields of these values whose traction is continuous, with the defects for it.

        With tangential compliance the defects for it are added to those that the values had.
        Without it the values do not depend on defects, and those for it are all of them.
        """
        needed, values = self.without_jumps(values)
        rigid = self.system.parameters.beta == 0.0
        return replace(self, values=values, defects=needed if rigid else defects + needed)

    def without_jumps(self, values: Array) -> tuple[Array, Array]:
        """Return the defects that remove the jumps of q from a vector, and the vector without them.

        With J the rows of the jumps and V the responses to unit defects, ``J (v + V d) = 0``.
        """
        system = self.system
        rows = system.jump_rows
        if system.parameters.beta == 0.0 or not len(rows):
            return np.asarray(-system.boundary_rows.residual @ values), values
        responses = self.factors.defect_responses
        defects = -np.linalg.solve(rows @ responses, rows @ values)
        return np.asarray(defects), np.asarray(values + responses @ defects)

    def correct_once(self) -> tuple[FieldSolution, Array]:
        """Return the fields after one correction with the factors, and the change of the vector."""
        residual = self.system.residual(self.values[:, None], np.ones(1), self.defects[:, None])
        step = self.factors.step(residual)[:, 0]
        result = self._continuous(self.values + step, self.defects)
        return result, result.values - self.values

    def refactored(self) -> FieldSolution:
        """Return the same fields with the factors of their own system."""
        return replace(self, factors=factored(self.system))

    def load_integral(self, values: Array) -> float:
        """Return ``int p s ds``."""
        return float(self.system.load_row @ values[: self.system.pressure_terms])

    @cached_property
    def approach(self) -> float:
        """The approach of unit load."""
        return 1.0 / (2.0 * pi * self.load_integral(self.values))

    @cached_property
    def boundary_residual(self) -> Array:
        """The defects, relative to the stick target at the boundaries, with opposite sign."""
        return np.asarray(-self.defects / self.stick_target)

    @property
    def stick_target(self) -> Array:
        """``kappa R(b)``, which stick prescribes for G(b), at the boundaries b, (boundaries,)."""
        return np.asarray(self.system.boundary_rows.stick_target @ self.values)

    def relative_size(self, change: Array) -> float:
        """Return the largest relative change of the fields on any panel.

        Parameters
        ----------
        change : ndarray, shape (unknowns,)
            A change of `values`, for unit approach as these are.
        """
        changes = relative_changes(self.system, self.values, change)
        return max(float(relative.max()) for relative in changes)

    @cached_property
    def boundary_perturbation(self) -> Perturbation:
        """Twice what removing the defects changes at given boundaries; 2 is for safety.

        The traction jumps then. To first order the fields change by as much as if the boundaries
        moved to where they should be, so that this is a bound of their error by misplaced
        boundaries. It is zero without tangential compliance, where no field depends on the defects.
        """
        factor = 2.0 if self.system.parameters.beta > 0.0 else 0.0
        defects = -factor * self.defects
        return self._at_unit_load(defects, self.factors.defect_responses @ defects)

    def coarse_differences(self) -> list[Perturbation]:
        """Return the solution less that of a coarser space, twice.

        The coarser spaces have two degrees less on every panel, and one degree less.
        """
        changes = self.factors.coarse_differences(self.values, self.system)
        return [self._at_unit_load(*self.without_jumps(change)) for change in changes]

    def _at_unit_load(self, defects: Array, change: Array) -> Perturbation:
        """Return a change of the fields for unit approach as one for unit load."""
        approach = -self.load_integral(change) / self.load_integral(self.values)
        return Perturbation(
            change + approach * self.values,
            defects + approach * self.defects,
            -defects / self.stick_target,
            approach,
        )


class Corrected(NamedTuple):
    """Corrected fields, and the estimate of their relative error against the direct solution."""

    fields: FieldSolution
    remaining: float


def correct_to(fields: FieldSolution, tolerance: float) -> Corrected:
    """Correct fields at given boundaries to a tolerance, or until only rounding is left.

    Parameters
    ----------
    fields : FieldSolution
    tolerance : float
        Relative, of the fields.

    Notes
    -----
    The *contraction* is the length of a correction over that of the one before. With the factors of
    other boundaries it is unknown at the first correction. The matrix at hand is factored if the
    contraction with such factors is above MAX_CONTRACTION, or if it is unknown and the correction
    is longer than COARSE_TOL. Corrections that are shorter and do not shrink go on with the same
    factors.
    """
    # where beta > 0, new factors may lower the rounding
    rounding = RIGID_TRACTION_ROUNDING if fields.system.parameters.beta == 0.0 else 0.0
    length_before = inf
    remaining = inf
    for _ in range(MAX_STEPS):
        exact_factors = fields.factors.system is fields.system
        next_fields, change = fields.correct_once()
        length = next_fields.relative_size(change)
        if not np.isfinite(length):
            return Corrected(fields, inf)
        if length_before < inf:
            contraction = length / length_before
        else:
            # the first correction: with the factors of the matrix itself only rounding is left
            # after it, with those of other boundaries it is counted as one that does not shrink
            contraction = 0.0 if exact_factors else 1.0
        fields = next_fields
        remaining = length * min(max(contraction, NEGLIGIBLE_FRACTION), 1.0)
        if remaining < tolerance:
            break
        length_before = length
        if contraction > MAX_CONTRACTION:
            if exact_factors or length < rounding:
                break  # only rounding is left
            if contraction < 1.0 or length > COARSE_TOL:
                fields = fields.refactored()
                length_before = inf
    return Corrected(fields, remaining)


@dataclass(frozen=True, eq=False)
class Iterate:
    """An iterate of Newton's method: boundaries, the fields on them, and the Jacobian.

    Attributes
    ----------
    logits : ndarray, shape (boundaries,)
        ``ln(b**2/(1 - b**2))`` of the boundaries, outward.
    jacobian : ndarray, shape (boundaries, boundaries)
        Derivatives of the boundary residual by the logits.
    fields : FieldSolution
    remaining : float
        Estimate of the relative error that the last correction left of the fields.
    converged : bool
        Whether the next step of the boundaries is shorter than the tolerance.
    """

    logits: Array
    jacobian: Array
    fields: FieldSolution
    remaining: float = inf
    converged: bool = False

    @classmethod
    def first(cls, logits: Array, jacobian: Array, system: ContactSystem) -> Iterate:
        """Return the iterate to begin with: boundaries, and the direct solution with them."""
        return cls(logits, jacobian, FieldSolution.first(factored(system)))

    @property
    def newton_step(self) -> Array:
        """The Newton step of the logits, minus the inverse Jacobian times the residual."""
        return np.asarray(-np.linalg.solve(self.jacobian, self.fields.boundary_residual))

    def corrected_to(self, tolerance: float, *, converged: bool = False) -> Iterate:
        """Return the iterate with its fields corrected to a tolerance."""
        if self.remaining <= tolerance:
            return replace(self, converged=converged)
        fields, remaining = correct_to(self.fields, tolerance)
        return replace(self, fields=fields, remaining=remaining, converged=converged)

    def corrected_for_step(self, boundary_tol: float) -> Iterate:
        """Return the iterate with the error of its fields below a fraction of the Newton step.

        The fraction is NEGLIGIBLE_FRACTION. A loose tolerance comes first, as the length of the
        step is not known before. No step is taken for shorter than `boundary_tol`.
        """
        iterate = self.corrected_to(COARSE_TOL)
        tolerance = COARSE_TOL
        while True:
            length = float(np.abs(iterate.newton_step).max())
            needed = max(NEGLIGIBLE_FRACTION * max(length, boundary_tol), ROUNDING)
            if not iterate.remaining > needed or tolerance <= needed:
                return iterate
            tolerance = needed
            iterate = iterate.corrected_to(tolerance)


def find_boundaries(
    system_at: Callable[[Array], ContactSystem],
    start: Iterate,
    boundary_tol: float,
    field_tol: float,
    *,
    warm_start: bool = False,
) -> Iterate:
    """Move the boundaries by Newton's method until the next step is shorter than a tolerance.

    Parameters
    ----------
    system_at : callable
        Returns the system with boundaries at some logits, in one space.
    start : Iterate
    boundary_tol : float
        A step of the logits that is shorter than this is not taken.
    field_tol : float
        Relative error of the fields.
    warm_start : bool
        Whether the start is the solution of nearly the same problem, so that boundaries must be
        close to it.

    Returns
    -------
    Iterate
        Converged, or the one with the least boundary residual if that does not fall any more: a
        cold start that fails raises nothing.

    Raises
    ------
    NoBoundariesError
        If the residual does not vanish near a warm start.
    """
    iterate = start.corrected_to(max(field_tol, COARSE_TOL))
    if not len(start.logits):
        return iterate.corrected_to(field_tol, converged=True)
    best = iterate
    least_residual = inf
    size_before = inf
    stalled = 0
    secants: list[tuple[Array, Array]] = []  # the last steps, with the changes of the residual
    for _ in range(MAX_STEPS):
        iterate = iterate.corrected_for_step(boundary_tol)
        residual = iterate.fields.boundary_residual
        step = iterate.newton_step
        length = float(np.abs(step).max())
        if not np.isfinite(length):
            break
        size = float(np.abs(residual).max())
        stalled = stalled + 1 if size > 0.5 * size_before else 0
        size_before = size
        if size < least_residual:
            best = iterate
            least_residual = size
        if length < boundary_tol:
            return iterate.corrected_to(field_tol, converged=True)
        if stalled > 1 and least_residual < RESIDUAL_NOISE:
            break
        step *= _feasible_fraction(iterate.logits, step)
        logits = iterate.logits + step
        fields = replace(iterate.fields, system=system_at(logits))
        moved = Iterate(logits, iterate.jacobian, fields).corrected_for_step(boundary_tol)
        secants.append((step, moved.fields.boundary_residual - residual))
        secants = secants[-len(step) :]
        iterate = replace(moved, jacobian=_broyden(iterate.jacobian, secants))
    if warm_start and least_residual > RESIDUAL_NOISE:
        raise NoBoundariesError("no boundaries near by")
    return best.corrected_to(field_tol)


def fd_jacobian(residual_at: Callable[[Array], Array], logits: Array) -> Array:
    """Return the derivatives of a residual by the logits, by central differences.

    With w the width of the narrower zone at the boundary, over which the residual varies, the half
    step h balances the noise of the residual and its third derivative:
    ``h/w = max(JACOBIAN_FIELD_TOL, ROUNDING / w**2)**(1/3)``, at most JACOBIAN_RANGE.
    """
    columns = []
    widths = np.diff(logits)
    for i in range(len(logits)):
        width = min([1.0, *(abs(widths[j]) for j in (i - 1, i) if 0 <= j < len(widths))])
        relative_step = float(np.cbrt(max(JACOBIAN_FIELD_TOL, ROUNDING / width**2)))
        half_step = min(relative_step, JACOBIAN_RANGE) * width
        step = half_step * np.eye(len(logits))[i]
        difference = residual_at(logits + step) - residual_at(logits - step)
        columns.append(difference / (2.0 * half_step))
    return np.array(columns).T


def _broyden(jacobian: Array, secants: list[tuple[Array, Array]]) -> Array:
    """Return the matrix nearest to a Jacobian that maps the last steps to the changes they made.

    With the steps S and the changes Y as columns, ``J + (Y - J S) S^+`` (Broyden's update for
    several steps). Entries of ``Y - J S`` that are rounding are taken as zero, as in Dennis and
    Schnabel, Numerical Methods for Unconstrained Optimization and Nonlinear Equations, algorithm
    A8.3.1: over a short step rounding would pass for a steep slope.
    """
    steps = np.array([step for step, _ in secants]).T
    changes = np.array([change for _, change in secants]).T
    if not np.isfinite(changes).all():
        return jacobian
    unexplained = changes - jacobian @ steps
    unexplained[np.abs(unexplained) < RESIDUAL_NOISE] = 0.0
    lengths = np.linalg.norm(steps, axis=0)
    inverse = np.linalg.pinv(steps / lengths, rcond=MIN_STEP_ANGLE)
    return np.asarray(jacobian + unexplained / lengths @ inverse)


def _feasible_fraction(logits: Array, step: Array) -> float:
    """Return the fraction of a step that can be taken.

    No boundary moves by more than the width of a panel, and no zone becomes narrower than half of
    its own.
    """
    fraction = min(1.0, PANEL_WIDTH / max(float(np.abs(step).max()), TINY))
    for width, change in zip(np.diff(logits), np.diff(step), strict=True):
        if change < 0.0:
            fraction = min(fraction, 0.5 * width / -change)
    return fraction
