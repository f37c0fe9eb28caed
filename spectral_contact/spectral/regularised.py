"""Positive definite problems: solutions for many right-hand sides, and those in coarser spaces.

The problem of one field, a pressure p or a shear q/s, is one of regularised least squares
(docs/theory). With the compliance c, the mass matrix M, the half-integrals H of the functions at
the nodes, the weights W of the nodes and the Gram matrix ``K = H^T W H``, the coefficients a solve
``(c M + K) a = H^T W target - c l``. The field may have a known part, the lift, outside the space;
l are its inner products with the functions.

Next to the edge ``target - H a`` is small. Forming ``K a`` instead loses ``eps/sqrt(c)`` of the
solution, relative to it, with the rounding ``eps``. One correction with the residual ``H^T W
(target - H a) - c M a`` restores the digits (corrected seminormal equations).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lapack

from spectral_contact.spectral.tuning import UNCORRECTED_COMPLIANCE
from spectral_contact.threads import cached_property

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Change:
    """The solution in a coarser space less the solution.

    Attributes
    ----------
    coefficients : ndarray, shape (size,)
    energies : ndarray, shape (panels + 1,)
        Diagonal part of the energy of the change on each panel, numbered as in `NodalSpace.panel`.
    """

    coefficients: Array
    energies: Array


class NodalSpace(ABC):
    """A space of functions, with their half-integrals at nodes t.

    The half-integral of a pressure p is ``F(t) = int_t^1 p s ds / sqrt(s^2 - t^2)``, and that of a
    shear u = q/s is the same integral of u, ``G(t) = int_t^1 q ds / sqrt(s^2 - t^2)``.

    The functions are polynomials on panels. One part of a disk, or a zone, has some panels and,
    next to its end, a tail (`LogPanels`). There are two coarser spaces, with two degrees less on
    every panel and with one degree less.

    Attributes
    ----------
    t, y : ndarray, shape (nodes,)
        Nodes of the half-integral, and ``1 - t**2`` without cancellation.
    past_break : ndarray, shape (nodes,)
        ``t**2 - b**2`` without cancellation for the largest break b of the punch's profile inside
        t, 0 if there is none; profiles are evaluated with it.
    weights, measure : ndarray, shape (nodes,)
        Weights of ``dt``, and of ``dt / pi`` or, for shear, ``t**2 dt / pi``, the measure of the
        inner products of half-integrals.
    index, panel : ndarray of int, shape (unknowns,)
        The coefficient that each unknown is, and the number of its panel, counted through all
        parts. A tail has the number `panels` if there is one part, else that of the last panel
        of its part.
    size, panels : int
        Length of a vector of coefficients, and number of panels.
    coarsest_unknowns, coarse_unknowns : int
        Number of unknowns with two degrees less on every panel, and with one degree less. The
        unknowns of a coarser space come first.
    gram, mass : ndarray, shape (unknowns, unknowns)
        Gram matrix of the half-integrals, and mass matrix, in the order of `index`.
    """

    t: Array
    y: Array
    past_break: Array
    weights: Array
    measure: Array
    index: NDArray[np.int_]
    panel: NDArray[np.int_]
    size: int
    panels: int
    coarsest_unknowns: int
    coarse_unknowns: int
    gram: cached_property[Array]
    mass: cached_property[Array]

    @property
    def unknowns(self) -> int:
        """Number of unknowns."""
        return len(self.index)

    @cached_property
    def constant_moments(self) -> Array:
        """Moments of the density 1.

        The load ``2 pi int p s ds = 4 int F dt`` of a pressure is 4 pi times the product of its
        coefficients with them.
        """
        return self.moments(np.ones(len(self.weights)))

    def moments(self, density: Array) -> Array:
        """Return the inner products of the half-integrals with a density, in order of `index`.

        The density is a function of t, given by its values at the nodes; several are rows.
        """
        return self.project(self.measure * density)

    @abstractmethod
    def project(self, weighted: Array) -> Array:
        """Return the sums over the nodes of the half-integrals times weighted values.

        This is the transpose of `half_integral`, in the order of `index`. Several weighted values
        are rows, as in `moments`.
        """

    @abstractmethod
    def half_integral(self, coefficients: Array) -> Array:
        """Return the half-integral at the nodes of a function with coefficients (size,)."""

    def factor(self, compliance: float) -> RegularisedProblem:
        """Factor ``compliance * mass + gram``."""
        return RegularisedProblem(self, compliance)


class Cholesky:
    """The Cholesky factor of a matrix, which is overwritten.

    Rounding errors are relative to the diagonal: the factor is as accurate as that of the matrix
    scaled to unit diagonal.

    Parameters
    ----------
    matrix : ndarray, shape (n, n)
        Symmetric and positive definite.

    Raises
    ------
    ArithmeticError
        If it is not positive definite.
    """

    def __init__(self, matrix: Array) -> None:
        #: diagonal of the matrix
        self.diagonal: Array = matrix.diagonal().copy()
        # The transposed view is Fortran-ordered, which LAPACK takes without a copy. The factor
        # replaces the lower triangle; the upper one stays as it is, and `coarse_change` needs it.
        self._factor, info = lapack.dpotrf(matrix.T, lower=1, clean=0, overwrite_a=1)
        if info != 0:
            raise ArithmeticError(f"Galerkin matrix not positive definite at pivot {info}")

    def solve(self, right: Array) -> Array:
        """Return the solution of a right-hand side (n,), or of several as rows (k, n)."""
        if right.ndim == 1:  # twice as fast as `dpotrs`
            solution, _ = lapack.dtrtrs(self._factor, right, lower=1)
            solution, _ = lapack.dtrtrs(self._factor, solution, lower=1, trans=1, overwrite_b=1)
        else:
            solution, _ = lapack.dpotrs(self._factor, right.T, lower=1)
        return np.asarray(solution.T)

    def coarse_change(self, solution: Array, coarse_unknowns: int) -> Array:
        """Return the solution in a coarser space less the solution.

        The coarser space has only the first `coarse_unknowns` unknowns, with the same right-hand
        side. No other factorisation is needed, and nothing cancels.
        """
        dropped = solution[coarse_unknowns:]
        # The triangular systems are those of the whole factor, with zeros for the last unknowns,
        # because LAPACK would take only a copy of its leading block.
        change = np.zeros(len(solution))
        change[:coarse_unknowns] = self._factor[:coarse_unknowns, coarse_unknowns:] @ dropped
        change, _ = lapack.dtrtrs(self._factor, change, lower=1, overwrite_b=1)
        change[coarse_unknowns:] = 0.0
        change, _ = lapack.dtrtrs(self._factor, change, lower=1, trans=1, overwrite_b=1)
        change[coarse_unknowns:] = -dropped
        return np.asarray(change)


class RegularisedProblem:
    """The regularised least-squares problem of a space, factored once for many targets."""

    def __init__(self, space: NodalSpace, compliance: float) -> None:
        self.space = space
        self.compliance = compliance
        matrix = compliance * space.mass
        matrix += space.gram
        self.cholesky = Cholesky(matrix)

    def solve(
        self, target: Array | float, lift_moments: Array | None = None, *, correct: bool = True
    ) -> Array:
        """Return the least-squares solution for a target.

        It minimises ``int (F - target)^2 W + compliance |p + lift|^2`` over the functions p of the
        space, with their half-integral F.

        Parameters
        ----------
        target : ndarray, shape (nodes,), or float
            The prescribed half-integral; a number is a constant.
        lift_moments : ndarray, shape (size,), optional
            Inner products of the functions with the lift.
        correct : bool
            Whether the solution is corrected with the half-integral residual, if the compliance is
            less than UNCORRECTED_COMPLIANCE. Integral quantities do not need it, nor does a
            solution whose singular part is in the lift.

        Returns
        -------
        ndarray, shape (size,)
            Coefficients, zero outside the space.
        """
        space = self.space
        index = space.index
        coefficients = np.zeros(space.size)
        lift = 0.0 if lift_moments is None else self.compliance * lift_moments[index]
        if isinstance(target, float):
            right = target * space.constant_moments
        else:
            right = space.moments(target)
        coefficients[index] = self.cholesky.solve(right - lift)
        if correct and self.compliance < UNCORRECTED_COMPLIANCE:
            residual = space.moments(target - space.half_integral(coefficients)) - lift
            residual -= self.compliance * space.mass @ coefficients[index]
            coefficients[index] += self.cholesky.solve(residual)
        return coefficients

    def change(self, coefficients: Array, *, degrees: int = 2) -> Change:
        """Return the solution in a coarser space less the solution, and the energies of that.

        No other factorisation is needed, and nothing cancels.

        Parameters
        ----------
        coefficients : ndarray, shape (size,)
            A solution.
        degrees : int
            How many top degrees of every panel the coarser space lacks: 2 or 1.
        """
        space = self.space
        unknowns = space.coarsest_unknowns if degrees == 2 else space.coarse_unknowns
        difference = self.cholesky.coarse_change(coefficients[space.index], unknowns)
        change = np.zeros(len(coefficients))
        change[space.index] = difference
        energies = np.bincount(
            space.panel, difference**2 * self.cholesky.diagonal, space.panels + 1
        )
        return Change(change, np.asarray(energies, dtype=float))
