"""The regularised least-squares problem of a space: solved, corrected, and its changes told."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any, Generic, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from spectral_contact.spectral.cholesky import Cholesky
from spectral_contact.threads import cached_property

__all__ = ["HARMLESS", "Change", "Factorable", "NodalSpace", "Regularised"]

Array = NDArray[np.float64]

#: So many targets are solved for one by one: products with few vectors take BLAS more time.
_FEW = 3
#: Above this compliance the normal equations lose no more than 30 eps, and need no correction; of
#: q/s at the centre they lose some thousand eps at 1e-3 ... 0.02.
HARMLESS = 0.1


@dataclass(frozen=True, slots=True)
class Change:
    """Difference of a solution to the one in the next coarser space.

    Attributes
    ----------
    coefficients : ndarray, shape (size,)
    energies : ndarray, shape (panels + 1,)
        Diagonal part of its energy on every panel, and on the tail.
    """

    coefficients: Array
    energies: Array


class Factorable(Protocol):
    """What is factored: a `Space`, or one of several parts.

    Attributes
    ----------
    size : int
        Length of a vector of coefficients.
    panels : int
        Number of panels.
    index, panel : ndarray of int
        Places of the unknowns among the coefficients, and the panels that they belong to.
    kept, kept_but_one : int
        How many unknowns the spaces have with two degrees less on every panel, and with one less.
    gram, mass, constant_moments : ndarray
        In the order of `index`.
    """

    size: int
    panels: int
    index: NDArray[np.int_]
    panel: NDArray[np.int_]
    kept: int
    kept_but_one: int

    @property
    def gram(self) -> Array:
        """Gram matrix of the half-integrals."""

    @property
    def mass(self) -> Array:
        """Mass matrix."""

    @property
    def constant_moments(self) -> Array:
        """Moments of the density 1."""

    def moments(self, density: Array) -> Array:
        """Return the inner products of the half-integrals with a density."""

    def half_integral(self, coefficients: Array) -> Array:
        """Return the half-integral at the nodes."""


S = TypeVar("S", bound=Factorable)


class Regularised(Generic[S]):
    """The regularised least-squares problem of a space, factored once for many targets."""

    def __init__(self, space: S, compliance: float) -> None:
        self.space = space
        self.compliance = compliance
        matrix = compliance * space.mass
        matrix += space.gram
        self._cholesky = Cholesky(matrix)

    def solve(
        self, target: Array | float, load: Array | None = None, *, correct: bool = True
    ) -> Array:
        """Minimise ``int (F - target)^2 W + compliance |a + lift|^2`` over the space.

        Parameters
        ----------
        target : ndarray, shape (nodes,) or (nodes, k), or float
            What the half-integral should be; columns are targets of their own, a number is a
            constant.
        load : ndarray, shape (size,), optional
            Inner products of the basis with a known part of the solution, the lift.
        correct : bool
            Whether to correct with the half-integral residual. Integral quantities do not need
            it, nor does a solution whose singular part is in the lift.

        Returns
        -------
        ndarray, shape (size,) or (size, k)
            Coefficients, zero outside the space.
        """
        if not isinstance(target, float) and target.ndim == 2 and target.shape[1] <= _FEW:
            columns = np.ascontiguousarray(target.T)
            return np.column_stack([self.solve(one, load, correct=correct) for one in columns])
        space = self.space
        fixed = 0.0 if load is None else self.compliance * load[space.index]
        coefficients = np.zeros((space.size, *np.shape(target)[1:]))
        misfit = target
        rounds = 2 if correct and self.compliance < HARMLESS else 1
        for correction in range(rounds):
            if isinstance(misfit, float):
                residual = misfit * space.constant_moments - fixed
            else:
                residual = space.moments(misfit.T) - fixed
            if correction and self.compliance != 0.0:
                residual -= self.compliance * (space.mass @ coefficients[space.index]).T
            coefficients[space.index] += self._cholesky.solve(residual).T
            if correction + 1 < rounds:
                misfit = target - space.half_integral(coefficients)
        return coefficients

    def dual(self, functional: Array) -> Array:
        """Return the dual solution of a linear functional: what its value is most sensitive to.

        Parameters
        ----------
        functional : ndarray, shape (size,)
            Values of the functional on the basis.
        """
        index = self.space.index
        coefficients = np.zeros_like(functional)
        coefficients[index] = self._cholesky.solve(functional[index])
        return coefficients

    def change(self, coefficients: Array, *, degrees: int = 2) -> Change:
        """Return what the top two degrees of every panel, or the top one, contribute.

        It is the difference to the Galerkin solution without them, from the same factorisation
        and without cancellation.
        """
        index = self.space.index
        kept = self.space.kept if degrees == 2 else self.space.kept_but_one
        shed = self._cholesky.shed(coefficients[index], kept)
        change = np.zeros_like(coefficients)
        change[index] = shed
        places = self.space.panels + 1
        energies = np.bincount(self.space.panel, shed**2 * self._cholesky.diagonal, places)
        return Change(change, np.asarray(energies, dtype=float))


class NodalSpace(ABC):
    """Functions with the half-integrals that they have at nodes.

    Attributes are those of `Factorable`, and of `PressureSpace` in `parted`.
    """

    t: Array
    y: Array
    past: Array
    weights: Array
    index: NDArray[np.int_]
    panel: NDArray[np.int_]
    size: int
    panels: int
    kept: int
    kept_but_one: int

    @property
    def unknowns(self) -> int:
        """Number of unknowns."""
        return len(self.index)

    @property
    def functions(self) -> Factorable:
        """The functions with their matrices."""
        return self

    @property
    @abstractmethod
    def gram(self) -> Array:
        """Gram matrix of the half-integrals."""

    @property
    @abstractmethod
    def mass(self) -> Array:
        """Mass matrix ``int phi psi s ds``."""

    @cached_property
    def constant_moments(self) -> Array:
        """Moments of the density 1."""
        return self.moments(np.ones(len(self.weights)))

    @abstractmethod
    def moments(self, density: Array) -> Array:
        """Return the inner products of the half-integrals with a density, in order of `index`."""

    @abstractmethod
    def half_integral(self, coefficients: Array) -> Array:
        """Return the half-integral at the nodes."""

    def factor(self, compliance: float) -> Regularised[Any]:
        """Factor the problem with a compliance."""
        return Regularised(self, compliance)
