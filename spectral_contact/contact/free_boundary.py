r"""Free boundaries: Newton's method for the boundaries between zones and the fields on them.

At given boundaries the equations are linear. Their solution has a continuous traction, and a defect
of E at every boundary (`spectral.contact_system`). The *boundary residual* is that defect over the
drive ``kappa R`` there; boundaries are where it vanishes. It is found by Newton's method with
Broyden's update of the Jacobian.

Fields are corrected with the factors of a matrix whose boundaries may be others: as the residual
is that of the equations at hand, this costs corrections and no accuracy. When corrections do not
shrink as they should, the matrix is factored anew.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import inf, pi
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from spectral_contact.contact.layout import NoBoundariesError
from spectral_contact.contact.resolution import ROUGH, TINY
from spectral_contact.contact.stick_radius import NOISE
from spectral_contact.fields.series import Array
from spectral_contact.spectral.factored import Factored, factored
from spectral_contact.threads import cached_property

if TYPE_CHECKING:
    from spectral_contact.spectral.contact_system import ContactSystem

#: The matrix is factored anew when a correction is more than this share of the one before.
_SLOWEST_CONTRACTION = 0.2
#: The share of itself that a correction leaves at least. With 1e-4 estimates of stick radii are 0.6
#: times as large in the mean of 91 scenes, and the largest error is 0.55 of one, else 0.50.
LEAST_CONTRACTION = 0.01
#: The fields are known to this share of a step of the boundaries before it is taken.
_FIELD_TO_STEP = 0.01
#: A step that is more than this share of the one before does not show that steps become shorter.
#: After so many of these in a row there are no boundaries near by.
_SHORTER, _MOST_STALLED = 0.5, 8
#: Longest step of a boundary, as a logit.
_LONGEST_STEP = 2.0
#: Most steps of the boundaries, and corrections of the fields at given ones.
_MOST_STEPS, _MOST_CORRECTIONS = 40, 30
#: Steps whose directions differ by less than this tell the Jacobian nothing new.
_LEAST_ANGLE = 0.03

SystemAt = Callable[[Array], "ContactSystem"]


class Perturbation(NamedTuple):
    """What a change of the space does at unit load.

    Attributes
    ----------
    change, defects : ndarray
        Of the solution and of its defects.
    boundary_residual : ndarray
        Of the boundary residual.
    approach : float
        Of the approach, relative.
    """

    change: Array
    defects: Array
    boundary_residual: Array
    approach: float


@dataclass(frozen=True, eq=False)
class FieldSolution:
    """The fields on given boundaries for unit approach, with a continuous traction.

    Attributes
    ----------
    system : ContactSystem
    factors : Factored
        Of this system or of one with other boundaries near by.
    values : ndarray, shape (unknowns,)
        The vector of the system.
    defects : ndarray, shape (boundaries,)
        They make the traction continuous; without tangential compliance they make E(b) zero.
    """

    system: ContactSystem
    factors: Factored
    values: Array
    defects: Array

    @classmethod
    def first(cls, factors: Factored, system: ContactSystem | None = None) -> FieldSolution:
        """Return the solution as the factors have it, of their system or of one like it."""
        system = system or factors.system
        nothing = np.zeros(len(system.radii))
        begin = cls(system, factors, factors.first[:, 0], nothing)
        return begin._continuous(begin.values, nothing)

    def _continuous(self, values: Array, defects: Array) -> FieldSolution:
        """Return these fields, with further defects, without jumps of the traction."""
        further, values = self.without_jumps(values)
        rigid = self.system.parameters.beta == 0.0
        return replace(self, values=values, defects=further if rigid else defects + further)

    def without_jumps(self, values: Array) -> tuple[Array, Array]:
        """Return the defects that take the jumps out of a vector, and the vector without them."""
        system = self.system
        jumps = system.jump_rows
        if system.parameters.beta == 0.0 or not len(jumps):
            return np.asarray(-system.boundary_rows.shortfall @ values), values
        responses = self.factors.responses
        defects = -np.linalg.solve(jumps @ responses, jumps @ values)
        return np.asarray(defects), np.asarray(values + responses @ defects)

    def corrected(self) -> tuple[FieldSolution, Array]:
        """Return better fields, and the change of their values."""
        residual = self.system.residual(self.values[:, None], np.ones(1), self.defects[:, None])
        step = self.factors.step(residual)[:, 0]
        better = self._continuous(self.values + step, self.defects)
        return better, better.values - self.values

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
        """The defects, relative to the drive ``kappa R`` at the boundaries, with opposite sign."""
        return np.asarray(-self.defects / self.drive)

    @property
    def drive(self) -> Array:
        """``kappa R`` at the boundaries."""
        return np.asarray(self.system.boundary_rows.drive @ self.values)

    def boundary_perturbation(self, share: float) -> Perturbation:
        """Return what removes so much of the boundary residual, with a jump of the traction.

        That is the error of the fields to first order in how far the boundaries are off.
        """
        defects = -share * self.defects
        return self._at_unit_load(defects, self.factors.responses @ defects)

    def coarse_differences(self) -> list[Perturbation]:
        """Return what the top two degrees of every panel contribute, and what the top one does."""
        changes = self.factors.change(self.values, self.system)
        return [self._at_unit_load(*self.without_jumps(change)) for change in changes]

    def _at_unit_load(self, defects: Array, change: Array) -> Perturbation:
        raised = -self.load_integral(change) / self.load_integral(self.values)
        return Perturbation(
            change + raised * self.values,
            defects + raised * self.defects,
            -defects / self.drive,
            raised,
        )


class Corrected(NamedTuple):
    """Fields, and the error that corrections leave of them, relative."""

    fields: FieldSolution
    remaining: float


def corrected(
    fields: FieldSolution,
    tolerance: float,
    size: Callable[[FieldSolution, Array], float],
) -> Corrected:
    """Correct fields at given boundaries to a tolerance, or until only rounding is left.

    Parameters
    ----------
    fields : FieldSolution
    tolerance : float
        Relative, of the fields.
    size : callable
        Returns the relative size of a change of the fields.
    """
    before = inf
    remaining = inf
    for _ in range(_MOST_CORRECTIONS):
        own = fields.factors.system is fields.system
        better, change = fields.corrected()
        length = size(better, change)
        if not np.isfinite(length):
            return Corrected(fields, inf)
        # with the factors of other boundaries the first correction says nothing of the next one
        contraction = length / before if before < inf else (0.0 if own else 1.0)
        fields = better
        remaining = length * min(max(contraction, LEAST_CONTRACTION), 1.0)
        if remaining < tolerance:
            break
        before = length
        if contraction > _SLOWEST_CONTRACTION:
            if own:
                break  # rounding
            if contraction < 1.0 or length > ROUGH:
                fields = fields.refactored()
                before = inf
    return Corrected(fields, remaining)


@dataclass(frozen=True, eq=False)
class Iterate:
    """What Newton's method begins with and ends in.

    Attributes
    ----------
    logits : ndarray, shape (boundaries,)
        ``ln(b**2/(1 - b**2))`` of the boundaries, outward.
    jacobian : ndarray, shape (boundaries, boundaries)
        Derivatives of the boundary residual by the logits.
    fields : FieldSolution
    remaining : float
        The error that corrections leave of the fields, relative.
    converged : bool
        Whether the last step of the boundaries is as short as was asked.
    """

    logits: Array
    jacobian: Array
    fields: FieldSolution
    remaining: float = inf
    converged: bool = False

    @property
    def newton_step(self) -> Array:
        """The step of the boundaries that the Jacobian asks for."""
        return np.asarray(-np.linalg.solve(self.jacobian, self.fields.boundary_residual))


class FreeBoundary:
    """Newton's method in one space.

    Parameters
    ----------
    system_at : callable
        Returns the system with boundaries at some logits.
    size : callable
        Returns the relative size of a change of the fields.
    """

    def __init__(self, system_at: SystemAt, size: Callable[[FieldSolution, Array], float]) -> None:
        self._system_at, self._size = system_at, size

    def start(self, logits: Array, jacobian: Array) -> Iterate:
        """Return the first iterate at these boundaries."""
        fields = FieldSolution.first(factored(self._system_at(logits)))
        return Iterate(logits, jacobian, fields)

    def solve(
        self, start: Iterate, boundary_tol: float, field_tol: float, *, near: bool = False
    ) -> Iterate:
        """Move the boundaries until the next step is shorter than a tolerance.

        Parameters
        ----------
        start : Iterate
        boundary_tol : float
            Longest step of a boundary, as a logit, that is left out.
        field_tol : float
            Relative, of the fields.
        near : bool
            Whether the boundaries are said to be near by.

        Returns
        -------
        Iterate
            The one with the least boundary residual, if steps do not become shorter.

        Raises
        ------
        NoBoundariesError
            If boundaries are said to be near by and are not.
        """
        iterate = self._with_fields(start, max(field_tol, ROUGH))
        if not len(start.logits):
            return self._with_fields(iterate, field_tol, converged=True)
        best, least = iterate, inf
        before, stalled = inf, 0
        secants: list[tuple[Array, Array]] = []
        for _ in range(_MOST_STEPS):
            iterate = self._known_to_step(iterate, boundary_tol, field_tol)
            residual = iterate.fields.boundary_residual
            step = iterate.newton_step
            length = float(np.abs(step).max())
            if not np.isfinite(length):
                break
            if float(np.abs(residual).max()) < least:
                best, least = iterate, float(np.abs(residual).max())
            if length < boundary_tol:
                return self._with_fields(iterate, field_tol, converged=True)
            stalled = stalled + 1 if length > _SHORTER * before else 0
            if stalled > _MOST_STALLED or (stalled > 1 and least < NOISE):
                break
            step *= _feasible_share(iterate.logits, step)
            before = length
            moved = self._moved(iterate, step)
            moved = self._known_to_step(moved, boundary_tol, field_tol)
            secants.append((step, moved.fields.boundary_residual - residual))
            secants = secants[-len(step) :]
            iterate = replace(moved, jacobian=_broyden(iterate.jacobian, secants))
        if near and least > NOISE:
            raise NoBoundariesError("no boundaries near by")
        return self._with_fields(best, field_tol)

    def _moved(self, iterate: Iterate, step: Array) -> Iterate:
        """Return the iterate with other boundaries, its fields not corrected yet."""
        logits = iterate.logits + step
        fields = replace(iterate.fields, system=self._system_at(logits))
        return replace(iterate, logits=logits, fields=fields, remaining=inf)

    def _known_to_step(self, iterate: Iterate, boundary_tol: float, field_tol: float) -> Iterate:
        """Correct the fields until they are known to a share of the step that they ask for."""
        tolerance = ROUGH
        while True:
            if iterate.remaining > tolerance:
                iterate = self._with_fields(iterate, tolerance)
            length = float(np.abs(iterate.newton_step).max())
            wanted = max(_FIELD_TO_STEP * max(length, boundary_tol), field_tol)
            if not iterate.remaining > wanted or tolerance <= wanted:
                return iterate
            tolerance = wanted

    def _with_fields(
        self, iterate: Iterate, tolerance: float, *, converged: bool = False
    ) -> Iterate:
        """Return the iterate with its fields corrected to a tolerance."""
        if iterate.remaining > tolerance:
            fields, remaining = corrected(iterate.fields, tolerance, self._size)
            iterate = replace(iterate, fields=fields, remaining=remaining)
        return replace(iterate, converged=converged)


def _broyden(jacobian: Array, secants: list[tuple[Array, Array]]) -> Array:
    """Return the matrix nearest to a Jacobian that maps the last steps to their changes."""
    lengths = [float(np.linalg.norm(step)) for step, _ in secants]
    steps = np.array([step / n for (step, _), n in zip(secants, lengths, strict=True)]).T
    changes = np.array([change / n for (_, change), n in zip(secants, lengths, strict=True)]).T
    if not np.isfinite(changes).all():
        return jacobian
    inverse = np.linalg.pinv(steps, rcond=_LEAST_ANGLE)
    return np.asarray(jacobian + (changes - jacobian @ steps) @ inverse)


def _feasible_share(logits: Array, step: Array) -> float:
    """Return the share of a step that keeps the boundaries in order, and the step moderate."""
    share = min(1.0, _LONGEST_STEP / max(float(np.abs(step).max()), TINY))
    for width, change in zip(np.diff(logits), np.diff(step), strict=True):
        if change < 0.0:
            share = min(share, 0.5 * width / -change)
    return share
