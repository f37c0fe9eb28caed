"""Positive definite problems: solutions for many right-hand sides, and those in coarser spaces.

Most are the regularised least-squares problem of a space (docs/theory): with the compliance c, the
mass matrix M, the half-integrals H of the functions at the nodes, the weights W of the nodes and
the Gram matrix ``K = H^T W H``, the coefficients a solve ``(c M + K) a = H^T W target - c l``,
where l are the inner products with a known part of the solution, the *lift*.
Next to the edge ``target - H a`` is small, and forming ``K a`` loses ``eps/sqrt(c)``; one
correction with the residual ``H^T W (target - H a) - c M a`` restores it (corrected seminormal
equations).
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
        What the functions of every panel contribute to its energy, ``sum_i K_ii d_i**2`` with the
        coefficients d of the change and the diagonal of the matrix K. The panels have the numbers
        `NodalSpace.panel`.
    """

    coefficients: Array
    energies: Array


class NodalSpace(ABC):
    """Functions p, and their half-integrals ``F(t) = int_t^1 p s ds / sqrt(s^2 - t^2)`` at nodes t.

    Attributes
    ----------
    t, y : ndarray, shape (nodes,)
        Nodes of the half-integral, and ``1 - t**2`` without cancellation.
    past_break : ndarray, shape (nodes,)
        ``t**2 - b**2`` without cancellation for the largest break b of the profile inside t, a
        radius at which a derivative of the profile jumps; 0 if there is none. Profiles are
        evaluated with it.
    weights, measure : ndarray, shape (nodes,)
        Weights of ``dt``, and of ``dt / pi`` or, for shear, ``t**2 dt / pi``, the measure in which
        half-integrals are multiplied.
    index, panel : ndarray of int, shape (unknowns,)
        Places of the unknowns among the coefficients, and the number of the panel of each, through
        all parts. A tail has the number `panels` if there is one part, else that of the last panel
        of its part.
    size, panels : int
        Length of a vector of coefficients, and number of panels.
    coarsest_unknowns, coarse_unknowns : int
        Numbers of unknowns of the two coarser spaces: with two degrees less on every panel, and
        with one degree less. These unknowns come first.
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

        The load ``2 pi int p s ds = 4 int F dt`` of a pressure is 4 pi times its product with them.
        """
        return self.moments(np.ones(len(self.weights)))

    def moments(self, density: Array) -> Array:
        """Return the inner products of the half-integrals with a density, in order of `index`.

        The density is given at the nodes, several as rows.
        """
        return self.project(self.measure * density)

    @abstractmethod
    def project(self, weighted: Array) -> Array:
        """Return the sums over the nodes of the half-integrals times weighted values.

        This is the transpose of `half_integral` for the unknowns.

        The result is in the order of `index`; several weighted values are rows, as in `moments`.
        """

    @abstractmethod
    def half_integral(self, coefficients: Array) -> Array:
        """Return the half-integral at the nodes; coefficients (size,) are 0 outside the space."""

    def factor(self, compliance: float) -> Regularised:
        """Factor ``compliance * mass + gram``."""
        return Regularised(self, compliance)


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
        # replaces the lower triangle; the upper one stays as it is, and
        # `coarse_change` needs it.
        self._factor, info = lapack.dpotrf(matrix.T, lower=1, clean=0, overwrite_a=1)
        if info != 0:
            raise ArithmeticError(f"Galerkin matrix not positive definite at pivot {info}")

    def solve(self, right: Array) -> Array:
        """Return the solution of a right-hand side (n,), or of several as rows (k, n)."""
        if right.ndim == 1:
            step, _ = lapack.dtrtrs(self._factor, right, lower=1)
            step, _ = lapack.dtrtrs(self._factor, step, lower=1, trans=1, overwrite_b=1)
        else:
            step, _ = lapack.dpotrs(self._factor, right.T, lower=1)
        return np.asarray(step.T)

    def coarse_change(self, solution: Array, coarse_unknowns: int) -> Array:
        """Return the solution in a coarser space less the solution.

        The coarser space has the first `coarse_unknowns` unknowns alone, with the same right-hand
        side. It takes no other factorisation, and nothing cancels.
        """
        last = solution[coarse_unknowns:]
        # with all of the factor: its leading block would have to be copied
        step = np.zeros(len(solution))
        step[:coarse_unknowns] = self._factor[:coarse_unknowns, coarse_unknowns:] @ last
        step, _ = lapack.dtrtrs(self._factor, step, lower=1, overwrite_b=1)
        step[coarse_unknowns:] = 0.0
        step, _ = lapack.dtrtrs(self._factor, step, lower=1, trans=1, overwrite_b=1)
        step[coarse_unknowns:] = -last
        return np.asarray(step)


class Regularised:
    """The regularised least-squares problem of a space, factored once for many targets."""

    def __init__(self, space: NodalSpace, compliance: float) -> None:
        self.space = space
        self.compliance = compliance
        matrix = compliance * space.mass
        matrix += space.gram
        self.cholesky = Cholesky(matrix)

    def solve(
        self, target: Array | float, lift_products: Array | None = None, *, correct: bool = True
    ) -> Array:
        """Minimise ``int (F - target)^2 W + compliance |a + lift|^2`` over the space.

        Parameters
        ----------
        target : ndarray, shape (nodes,), or float
            What the half-integral should be; a number is a constant.
        lift_products : ndarray, shape (size,), optional
            Inner products of the basis with the lift, a known function that is added to the
            solution. The target is then what the half-integral of the unknown part should be.
        correct : bool
            Whether to correct with the half-integral residual below UNCORRECTED_COMPLIANCE.
            Integral quantities do not need it, nor does a solution whose singular part is in the
            lift.

        Returns
        -------
        ndarray, shape (size,)
            Coefficients, zero outside the space.
        """
        space = self.space
        index = space.index
        # the target less the half-integral of the coefficients
        remaining_target = target
        coefficients = np.zeros(space.size)
        solves = 2 if correct and self.compliance < UNCORRECTED_COMPLIANCE else 1
        for correction in range(solves):
            if isinstance(remaining_target, float):
                residual = remaining_target * space.constant_moments
            else:
                residual = space.moments(remaining_target)
            if lift_products is not None:
                residual -= self.compliance * lift_products[index]
            if correction and self.compliance != 0.0:
                residual -= self.compliance * space.mass @ coefficients[index]
            step = self.cholesky.solve(residual)
            coefficients[index] = coefficients[index] + step if correction else step
            if correction + 1 < solves:
                remaining_target = target - space.half_integral(coefficients)
        return coefficients

    def change(self, coefficients: Array, *, degrees: int = 2) -> Change:
        """Return the solution in a coarser space less the solution, and its energy.

        The coarser space lacks the top two degrees of every panel, or the top one. It takes no
        other factorisation, and nothing cancels.

        Parameters
        ----------
        coefficients : ndarray, shape (size,)
            A solution.
        degrees : int
            2 or 1.
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
