r"""Galerkin projections of K1 and K2 on a disk, and their regularised solution.

With ``d = 1 - z``, ``z = s**2`` the half-integral ``F(t) = 1/2 int_{t^2}^1 phi dz / sqrt(z - t^2)``
factors both kernels (docs/theory, Abel factorisation):

    <phi, N psi> = (1/pi) int F_phi F_psi dt           (normal, phi in p)
    <s phi, T s psi> = (1/pi) int t^2 F_phi F_psi dt   (tangential, q = s u, phi in u)

so each matrix is a Gram matrix ``H^T W H``: symmetric and positive definite by construction, with
no logarithm left to integrate. The solve of ``(c M + K) a = H^T W target - c load`` is a
regularised least-squares problem. The first-kind part cancels in the normal equations, which
loses ``eps/sqrt(c)`` at the edge; one correction with the residual taken in the half-integral,
where nothing cancels, restores it (corrected seminormal equations).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lapack

from spectral_contact.spectral.abel import (
    deeper_blocks,
    deeper_tail,
    tail_values,
)
from spectral_contact.spectral.cache import BoundedCache
from spectral_contact.spectral.jacobi import gauss_rule
from spectral_contact.spectral.panels import LogPanels, Nodes

__all__ = [
    "Change",
    "DiskOperators",
    "Factored",
    "GalerkinOperator",
    "Space",
    "disk_operators",
]

Array = NDArray[np.float64]

#: Above this compliance the normal equations lose no more than 30 eps, and need no correction.
_HARMLESS = 1e-3

_OPERATORS: BoundedCache[LogPanels, DiskOperators] = BoundedCache("disk operators", 12)


def disk_operators(panels: LogPanels) -> DiskOperators:
    """Return the operators of the unit disk on these panels, assembled once (cached)."""
    return _OPERATORS.get(panels, lambda: DiskOperators(panels))


class DiskOperators:
    """Half-integral matrix and Galerkin matrices on the unit disk for one set of panels.

    They know nothing of compliance, friction or Poisson's ratio; by homogeneity they also serve
    a stick disk of any radius c, with ``compliance / c``.

    Parameters
    ----------
    panels : LogPanels
        Panels in ``x = -ln(1 - s**2)``.
    """

    def __init__(self, panels: LogPanels) -> None:
        self.panels = panels
        nodes, first, other = panels.nodes()
        self.nodes: Nodes = nodes
        self.half_integral: Array = _half_integral(panels, nodes, first, other)

    @cached_property
    def normal(self) -> GalerkinOperator:
        """Projection of K1 with the mass matrix ``<phi, psi> = int phi psi s ds``."""
        mass = _block_diagonal(self.panels, 0.5, 0.0)
        return GalerkinOperator(self.panels, self.half_integral, self.nodes.weights / np.pi, mass)

    @cached_property
    def tangential(self) -> GalerkinOperator:
        """Projection of K2 for ``q = s u`` with the mass matrix ``int u v s**3 ds``."""
        mass = _block_diagonal(self.panels, 0.5, -0.5)
        weights = self.nodes.weights * self.nodes.rest / np.pi
        return GalerkinOperator(self.panels, self.half_integral, weights, mass)

    @cached_property
    def shear_moments(self) -> Array:
        """Vector of ``2 pi int q s ds = 2 pi int t F dt`` for ``q = s phi``, (4.3)."""
        t = np.sqrt(self.nodes.rest)
        return np.asarray(2.0 * np.pi * ((self.nodes.weights * t) @ self.half_integral))


class GalerkinOperator:
    """Gram matrix, mass matrix and node weights of one projected kernel.

    Attributes
    ----------
    half_integral : ndarray, shape (nodes, size)
        Half-integrals of the basis functions at the nodes.
    weights : ndarray, shape (nodes,)
        Weights of the Gram form, 1/pi included.
    mass : ndarray, shape (size, size)
        Mass matrix, block diagonal.
    gram : ndarray, shape (size, size)
        ``half_integral.T @ diag(weights) @ half_integral``.
    """

    def __init__(self, panels: LogPanels, half_integral: Array, weights: Array, mass: Array):
        self.panels = panels
        self.half_integral = half_integral
        self.weights = weights
        self.mass = mass
        self.gram: Array = _gram(panels, half_integral, weights)
        self._spaces: BoundedCache[tuple[int, ...], Space] = BoundedCache("Galerkin spaces", 24)

    def space(self, degrees: tuple[int, ...]) -> Space:
        """Return the subspace with these degrees on the panels, the tail whole (cached)."""
        return self._spaces.get(degrees, lambda: Space(self, degrees))


@dataclass(frozen=True, slots=True)
class Change:
    """Difference of a solution to the one in the next coarser space.

    Attributes
    ----------
    coefficients : ndarray, shape (size,)
    energies : ndarray, shape (panels,)
        Diagonal part of its energy on every panel, the tail counted to the last.
    """

    coefficients: Array
    energies: Array


class Space:
    """A subspace of an operator's basis: chosen degrees on every panel.

    Parameters
    ----------
    operator : GalerkinOperator
    degrees : tuple of int
        Highest degree on each panel, from 0 to the degree of the panels.
    """

    def __init__(self, operator: GalerkinOperator, degrees: tuple[int, ...]) -> None:
        self.operator = operator
        self.degrees = degrees
        terms = operator.panels.degree + 1
        keep, shed = [], []
        for j, n in enumerate(degrees):
            kept = max(n - 1, 1) if n else 1
            keep.append(np.arange(j * terms, j * terms + kept))
            shed.append(np.arange(j * terms + kept, j * terms + n + 1))
        tail = len(degrees) * terms
        size = operator.panels.size
        keep.append(np.arange(tail, size - 1))
        shed.append(np.arange(size - 1, size))
        self.kept = sum(map(len, keep))
        #: basis functions of the space, those of the coarser space first
        self.index = np.concatenate(keep + shed)
        grid = np.ix_(self.index, self.index)
        self._gram = operator.gram[grid]
        self._mass = operator.mass[grid]
        self._half_integral = operator.half_integral[:, self.index]

    @property
    def unknowns(self) -> int:
        """Number of unknowns."""
        return len(self.index)

    def factor(self, compliance: float) -> Factored:
        """Factor ``compliance * mass + gram`` on the space.

        Parameters
        ----------
        compliance : float
            The regularisation, at least 0.
        """
        return Factored(self, compliance)


class Factored:
    """The regularised least-squares problem of a space, factored once for many targets."""

    def __init__(self, space: Space, compliance: float) -> None:
        self.space = space
        self.compliance = compliance
        matrix = space._gram if compliance == 0.0 else space._gram + compliance * space._mass
        self.scale = 1.0 / np.sqrt(matrix.diagonal())
        # the transposed view is Fortran-ordered, which LAPACK takes without a copy
        self._scaled = (matrix * self.scale * self.scale[:, None]).T
        self._factor, info = lapack.dpotrf(self._scaled, lower=1, clean=0)
        if info != 0:
            raise ArithmeticError(f"Galerkin matrix not positive definite at pivot {info}")

    def solve(self, target: Array, load: Array | None = None, *, correct: bool = True) -> Array:
        """Minimise ``int (F - target)^2 W + compliance |a + lift|^2`` over the space.

        Parameters
        ----------
        target : ndarray, shape (nodes,) or (nodes, k)
            What the half-integral should be; columns are targets of their own.
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
        space, scale = self.space, self.scale
        fixed = 0.0 if load is None else self.compliance * load[space.index]
        values: Array = np.zeros(0)
        misfit = target
        rounds = 2 if correct and self.compliance < _HARMLESS else 1
        for correction in range(rounds):
            residual = (space.operator.weights * misfit.T) @ space._half_integral - fixed
            if correction and self.compliance != 0.0:
                residual -= self.compliance * (space._mass @ values).T
            step, _ = lapack.dpotrs(self._factor, (residual * scale).T, lower=1)
            step = (step.T * scale).T
            values = values + step if correction else step
            if correction + 1 < rounds:
                misfit = target - space._half_integral @ values
        coefficients = np.zeros((space.operator.panels.size, *target.shape[1:]))
        coefficients[space.index] = values
        return coefficients

    def change(self, coefficients: Array) -> Change:
        """Return what the top two degrees of every panel contribute to a solution.

        It is the difference to the Galerkin solution without them, from the same factorisation
        and without cancellation.
        """
        k, index, scale = self.space.kept, self.space.index, self.scale
        shed = coefficients[index[k:]] / scale[k:]
        right = self._scaled[:k, k:] @ shed
        step, _ = lapack.dpotrs(self._factor[:k, :k], right, lower=1)
        change = np.zeros_like(coefficients)
        change[index[:k]] = step * scale[:k]
        change[index[k:]] = -shed * scale[k:]
        panels = self.space.operator.panels
        panel = np.minimum(index // (panels.degree + 1), panels.panels - 1)
        energies = np.bincount(panel, weights=(change[index] / scale) ** 2)
        return Change(change, np.asarray(energies, dtype=float))


def _half_integral(panels: LogPanels, nodes: Nodes, first: Array, other: Array) -> Array:
    """Assemble the half-integral matrix from blocks that depend on panel differences alone."""
    p, h, degree = panels.panels, panels.width, panels.degree
    terms, start = degree + 1, len(first)
    matrix = np.zeros((len(nodes.d), panels.size))
    root = nodes.d[:, None] ** (0.5 + panels.power)
    blocks = deeper_blocks(first, p, h, degree, panels.power)
    np.multiply(blocks.reshape(start, -1), root[:start], out=matrix[:start, : p * terms])
    if p > 1:
        blocks = deeper_blocks(other, p - 1, h, degree, panels.power).reshape(len(other), -1)
    for i in range(1, p):
        rows = slice(start, start := start + len(other))
        own = blocks[:, : (p - i) * terms]
        np.multiply(own, root[rows], out=matrix[rows, i * terms : p * terms])
    matrix[:, p * terms :] = deeper_tail(
        nodes.d, panels.end, panels.tail_terms, panels.power, panels.root_tail
    )
    return matrix


def _gram(panels: LogPanels, half_integral: Array, weights: Array) -> Array:
    """Return ``H^T W H``, in strips of nodes: a node sees only its own panel and deeper ones."""
    terms, (first, other) = panels.degree + 1, panels.node_counts
    gram = np.zeros((panels.size, panels.size))
    cuts = sorted({0, *(round(panels.panels * k / 6) for k in range(1, 6)), panels.panels})
    for low, high in pairwise(cuts):
        start = 0 if low == 0 else first + (low - 1) * other
        stop = len(weights) if high == panels.panels else first + (high - 1) * other
        strip = half_integral[start:stop, low * terms :] * np.sqrt(weights[start:stop, None])
        # of a matrix and its own transpose NumPy computes one triangle, in half the time
        gram[low * terms :, low * terms :] += strip.T @ strip
    return gram


def _block_diagonal(panels: LogPanels, first: float, second: float) -> Array:
    """Return ``int phi psi (first + second d) dd``, block diagonal, tail included."""
    terms, h = panels.degree + 1, panels.width
    matrix = np.zeros((panels.size, panels.size))
    if panels.power != 0.0:
        return matrix  # not square integrable: such panels serve zero compliance alone
    one = first * panels.panel_gram(1.0)
    two = second * panels.panel_gram(2.0)
    for j in range(panels.panels):
        block = slice(j * terms, (j + 1) * terms)
        matrix[block, block] = np.exp(-j * h) * (one + np.exp(-j * h) * two)
    g, w = gauss_rule(panels.tail_terms + 3)
    v = (1.0 + g) / 2.0
    d = panels.end * v**2
    values = tail_values(d, panels.end, panels.tail_terms, panels.root_tail)
    weight = w * v * panels.end * (first + second * d)
    tail = slice(panels.panels * terms, None)
    matrix[tail, tail] = (values.T * weight) @ values
    return matrix
