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
from itertools import pairwise
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh

from spectral_contact.spectral.abel import deeper_blocks, deeper_tail
from spectral_contact.spectral.cache import BoundedCache
from spectral_contact.spectral.graded import Samples
from spectral_contact.spectral.panels import LogPanels, Nodes
from spectral_contact.spectral.regularised import Change, Regularised
from spectral_contact.threads import cached_property

__all__ = [
    "Change",
    "DiskOperators",
    "Factored",
    "GalerkinOperator",
    "Space",
    "Strip",
    "disk_operators",
]

Array = NDArray[np.float64]

#: Most strips of half-integrals, so that their zeros cost nothing, and the least functions of one.
_STRIPS, _WORTH = 8, 40

_OPERATORS: BoundedCache[LogPanels, DiskOperators] = BoundedCache("disk operators", 12)
# A space knows its operator, which knows its disk. Were it known to them too, what a cache forgets
# would stay until the collector of cycles comes by: hundreds of megabytes, measured.
_KERNELS: BoundedCache[tuple[DiskOperators, str], GalerkinOperator] = BoundedCache("kernels", 24)
_SPACES: BoundedCache[tuple[GalerkinOperator, tuple[int, ...]], Space] = BoundedCache(
    "Galerkin spaces", 96
)


def disk_operators(panels: LogPanels) -> DiskOperators:
    """Return the operators of the unit disk on these panels, assembled once (cached)."""
    return _OPERATORS.get(panels, lambda: DiskOperators(panels))


@dataclass(frozen=True, slots=True)
class Strip:
    """Half-integrals at consecutive nodes, which see only their own panel and deeper ones.

    Attributes
    ----------
    rows : slice
        The nodes.
    seen : int
        The first column that is not zero.
    values : ndarray
        The columns from there on.
    """

    rows: slice
    seen: int
    values: Array


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
        self.nodes: Nodes
        self.nodes, (start, first), (begin, other) = panels.nodes()
        self._offsets = start, begin
        # blocks of the half-integral, which depend on panel differences alone
        form = panels.panels, panels.width, panels.degree, panels.power
        to_end, from_start = np.concatenate([first, other]), np.concatenate([start, begin])
        blocks = deeper_blocks(to_end, *form, from_start)
        self._first, self._other = np.split(blocks.reshape(len(blocks), -1), [len(first)])
        self._tail = deeper_tail(
            self.nodes.d, panels.end, panels.tail_terms, panels.power, panels.root_tail
        )

    @cached_property
    def samples(self) -> Samples:
        """Few points that represent a smooth function at the many nodes."""
        return Samples(self.panels, self.nodes.d, self._offsets)

    @property
    def normal(self) -> GalerkinOperator:
        """Projection of K1 with the mass matrix ``<phi, psi> = int phi psi s ds`` (cached)."""
        return _KERNELS.get((self, "normal"), lambda: self._projected(1.0, (0.5, 0.0)))

    @property
    def tangential(self) -> GalerkinOperator:
        """Projection of K2 for ``q = s u``, mass matrix ``int u v s**3 ds`` (cached)."""
        rest = self.nodes.rest
        return _KERNELS.get((self, "tangential"), lambda: self._projected(rest, (0.5, -0.5)))

    def _projected(self, density: Array | float, measure: tuple[float, float]) -> GalerkinOperator:
        return GalerkinOperator(self, self.nodes.weights * density / np.pi, measure)

    @cached_property
    def half_integral(self) -> Array:
        """Half-integrals of all basis functions at the nodes, shape (nodes, size)."""
        matrix = np.zeros((len(self.nodes.d), self.panels.size))
        for strip in self.strips(np.arange(self.panels.size)):
            matrix[strip.rows, strip.seen :] = strip.values
        return matrix

    def strips(self, columns: NDArray[np.int_]) -> list[Strip]:
        """Return the half-integrals of the basis functions `columns`, an increasing list."""
        panels, (first, other) = self.panels, self.panels.node_counts
        terms = panels.degree + 1
        starts = np.searchsorted(columns, np.arange(panels.panels + 1) * terms).tolist()
        last = starts[-1]
        root = self.nodes.d[:, None] ** (0.5 + panels.power)
        count = min(max(len(columns) // _WORTH, 1), _STRIPS)
        cuts = sorted({round(panels.panels * k / count) for k in range(count + 1)})
        result, stop = [], 0
        for low, high in pairwise(cuts):
            start, seen = stop, starts[low]
            stop = first + (high - 1) * other if high < panels.panels else len(root)
            values = np.zeros((stop - start, len(columns) - seen))
            end = 0
            for i in range(low, high):
                begin, end = end, end + (other if i else first)
                blocks = self._other if i else self._first
                own = blocks.take(columns[starts[i] : last] - i * terms, axis=1)
                scaled = values[begin:end, starts[i] - seen : last - seen]
                np.multiply(own, root[start + begin : start + end], out=scaled)
            tail = columns[last:] - panels.panels * terms
            values[:, last - seen :] = self._tail[start:stop, tail]
            result.append(Strip(slice(start, stop), seen, values))
        return result


class GalerkinOperator:
    """One projected kernel: spaces to solve in, and its matrices in the whole basis.

    Parameters
    ----------
    disk : DiskOperators
        Whose half-integrals it is made of.
    weights : ndarray, shape (nodes,)
        Weights of the Gram form, 1/pi included.
    measure : tuple of float
        ``(a, b)`` of the mass matrix ``int phi psi (a + b d) dd``.
    """

    def __init__(self, disk: DiskOperators, weights: Array, measure: tuple[float, float]):
        self.disk = disk
        self.panels = disk.panels
        self.weights = weights
        self.measure = measure

    @cached_property
    def gram(self) -> Array:
        """Gram matrix ``half_integral.T @ diag(weights) @ half_integral``, (size, size)."""
        return self.gram_of(self.disk.strips(np.arange(self.panels.size)))

    @cached_property
    def mass(self) -> Array:
        """Mass matrix, block diagonal, (size, size)."""
        return self.mass_of(np.arange(self.panels.size))

    def gram_of(self, strips: list[Strip]) -> Array:
        """Return the Gram matrix of the basis functions in the strips."""
        size = strips[0].values.shape[1]
        gram = np.zeros((size, size))
        for strip in strips:
            weighted = strip.values * np.sqrt(self.weights[strip.rows, None])
            # of a matrix and its own transpose NumPy computes one triangle, in half the time
            gram[strip.seen :, strip.seen :] += weighted.T @ weighted
        return gram

    def mass_of(self, columns: NDArray[np.int_]) -> Array:
        """Return the mass matrix of the basis functions `columns`, an increasing list."""
        if self.panels.power != 0.0:  # not square integrable: such panels serve zero compliance
            return np.zeros((len(columns), len(columns)))
        return self.panels.mass(columns, *self.measure)

    def space(self, degrees: tuple[int, ...]) -> Space:
        """Return the subspace with these degrees on the panels, the tail whole (cached)."""
        return _SPACES.get((self, degrees), lambda: Space(self, degrees))


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
        self.size, self.panels = operator.panels.size, operator.panels.panels
        terms = operator.panels.degree + 1
        # two degrees of every panel are shed, but not the constant
        own, highest = np.arange(terms), np.array(degrees)[:, None]
        upper = own >= np.maximum(highest - 1, 1)
        keep = np.flatnonzero(~upper)
        shed = np.flatnonzero(upper & (own < highest))
        top = np.flatnonzero(upper & (own == highest))
        tail = np.arange(len(degrees) * terms, operator.panels.size)
        self.kept = len(keep) + len(tail) - 1
        #: as many with one degree less on every panel
        self.kept_but_one = self.kept + len(shed)
        #: basis functions of the space, those of the coarser spaces first
        self.index = np.concatenate([keep, tail[:-1], shed, top, tail[-1:]])
        #: their panels; that of the tail is one more
        self.panel = np.minimum(self.index // terms, len(degrees))
        # panel by panel, as the half-integral is triangular, and from there to the order above
        self._sorted = np.argsort(self.index)
        self._place = np.argsort(self._sorted)
        columns = self.index[self._sorted]
        order = np.ix_(self._place, self._place)
        self._strips = operator.disk.strips(columns)
        self.gram = operator.gram_of(self._strips)[order]
        self.mass = operator.mass_of(columns)[order]

    @property
    def unknowns(self) -> int:
        """Number of unknowns."""
        return len(self.index)

    @cached_property
    def constant_moments(self) -> Array:
        """Moments, as below, of the density 1: the load of a pressure is 4 pi times its product."""
        return self.moments(np.ones(len(self.operator.weights)))

    @cached_property
    def shear_moments(self) -> Array:
        """Vector of ``2 pi int q s ds = 2 pi int t F dt`` for ``q = s phi``, (4.3), (size,)."""
        nodes = self.operator.disk.nodes
        density = 2.0 * np.pi * nodes.weights * np.sqrt(nodes.rest)
        moments = np.zeros(self.operator.panels.size)
        moments[self.index] = self._against(density)
        return moments

    def half_integral(self, coefficients: Array) -> Array:
        """Return the half-integral at the nodes of a function of the space."""
        values = coefficients[self.index[self._sorted]]
        return np.concatenate([s.values @ values[s.seen :] for s in self._strips])

    def moments(self, density: Array) -> Array:
        """Return the inner products of the half-integrals with a density, in order of `index`.

        The density is given at the nodes, several as rows.
        """
        return self._against(self.operator.weights * density)

    def _against(self, density: Array) -> Array:
        """Return the sums of the half-integrals times a density, in order of `index`."""
        sums = np.zeros((*density.shape[:-1], len(self.index)))
        for strip in self._strips:
            sums[..., strip.seen :] += density[..., strip.rows] @ strip.values
        return sums[..., self._place]

    def spectrum(self) -> tuple[Array, Array]:
        """Return eigenvalues and modes: ``gram v = value mass v``, normalised by the mass.

        They solve the problem for every compliance at once (docs/maps).

        Returns
        -------
        values : ndarray, shape (unknowns,)
            At least 0, increasing.
        modes : ndarray, shape (size, unknowns)
            Coefficients, zero outside the space.
        """
        # the mass of a panel falls like its width: with unit diagonal it is well conditioned
        scale = 1.0 / np.sqrt(self.mass.diagonal())
        square = np.outer(scale, scale)
        values, vectors = eigh(self.gram * square, self.mass * square)
        modes = np.zeros((self.operator.panels.size, len(values)))
        modes[self.index] = vectors * scale[:, None]
        return np.maximum(values, 0.0), modes

    def factor(self, compliance: float) -> Factored:
        """Factor ``compliance * mass + gram`` on the space.

        Parameters
        ----------
        compliance : float
            The regularisation, at least 0.
        """
        return Regularised(self, compliance)


#: A space's problem, factored.
Factored: TypeAlias = Regularised[Space]
