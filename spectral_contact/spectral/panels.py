"""Logarithmic panels: where the unknowns live and where the Galerkin integrals are sampled."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from spectral_contact.spectral.cache import BoundedCache
from spectral_contact.spectral.jacobi import (
    EXTRA,
    ROOT_TERMS,
    TAIL_EXTRA,
    TAIL_TERMS,
    gauss_rule,
    legendre_values,
    tail_values,
)

__all__ = ["LEAST_DEGREE", "LogPanels", "Nodes", "PanelNodes", "Resolution", "Used"]

Array = NDArray[np.float64]

#: The estimate sheds two degrees and must keep one.
LEAST_DEGREE = 2

_FUNCTIONS: BoundedCache[tuple[LogPanels, tuple[int, ...], int], NDArray[np.int_]] = BoundedCache(
    "functions in use", 1024
)
_DISTANCES: BoundedCache[LogPanels, Array] = BoundedCache("sampling points", 48)


@dataclass(frozen=True, slots=True)
class Nodes:
    """Quadrature nodes in the distance ``d`` from a boundary.

    Attributes
    ----------
    d : ndarray
        Distances in (0, 1], panel by panel and then the tail.
    rest : ndarray
        ``1 - d`` to full relative accuracy.
    weights : ndarray
        Weights of ``int_0^1 . dd / (2 sqrt(1 - d))``, the measure ``dt`` with ``d = 1 - t**2``.
    """

    d: Array
    rest: Array
    weights: Array


class PanelNodes(NamedTuple):
    """The Galerkin nodes and their distances to the panel ends.

    Attributes
    ----------
    nodes : Nodes
        All nodes, `node_counts` on the panels.
    first, other : tuple of ndarray
        Distances in ``x`` of each node of the first panel, and of any other, from the shallow and
        to the deep end of its panel.
    """

    nodes: Nodes
    first: tuple[Array, Array]
    other: tuple[Array, Array]


@dataclass(frozen=True, slots=True)
class LogPanels:
    """Panels of equal width in ``x = -ln d`` and one tail panel that is polynomial in ``d``.

    Parameters
    ----------
    panels : int
        Number of panels, at least 1.
    width : float
        Width of each in ``x``.
    degree : int
        Highest Legendre degree on each panel.
    power : float
        Endpoint weight: the functions are ``d**power`` times polynomials. 0, or -1/2 for a
        traction that is singular at the edge.
    root_tail : bool
        The tail is polynomial in ``sqrt(d)``, for square roots at the boundary.
    """

    panels: int
    width: float
    degree: int
    power: float = 0.0
    root_tail: bool = False

    @property
    def end(self) -> float:
        """Distance ``exp(-panels * width)`` at which the tail begins."""
        return float(np.exp(-self.panels * self.width))

    @property
    def size(self) -> int:
        """Number of coefficients, tail included."""
        return self.panels * (self.degree + 1) + self.tail_terms

    @property
    def tail_terms(self) -> int:
        """Number of tail polynomials."""
        return ROOT_TERMS if self.root_tail else TAIL_TERMS

    @property
    def tail_points(self) -> int:
        """Number of sampling points on the tail."""
        return self.tail_terms + 1

    @property
    def node_counts(self) -> tuple[int, int]:
        """Galerkin nodes on the first panel, and on every other one and the tail.

        Products of two half-integrals have degree ``4 degree + 2`` in the node variable times
        analytic factors: with these counts rounding is all that is left.
        """
        extra = max(10, 22 - self.degree)
        return 2 * self.degree + extra + 8, 2 * self.degree + extra

    def functions(self, degrees: tuple[int, ...]) -> NDArray[np.int_]:
        """Return the basis functions up to these degrees on the panels, and the tail (cached)."""
        return _FUNCTIONS.get((self, degrees, 0), lambda: self._functions(degrees))

    def _functions(self, degrees: tuple[int, ...]) -> NDArray[np.int_]:
        terms = self.degree + 1
        used = [j * terms + np.arange(n + 1) for j, n in enumerate(degrees)]
        return np.concatenate([*used, np.arange(self.panels * terms, self.size)])

    def top(self, degrees: tuple[int, ...], count: int) -> NDArray[np.int_]:
        """Return places among these of so many top degrees of every panel, and of the tail's last.

        Constants are none of them. They are kept.
        """
        return _FUNCTIONS.get((self, degrees, count), lambda: self._top(degrees, count))

    def _top(self, degrees: tuple[int, ...], count: int) -> NDArray[np.int_]:
        ends = np.cumsum(np.array(degrees) + 1).tolist()
        tops = zip(ends, degrees, strict=True)
        places = [np.arange(end - min(count, n), end) for end, n in tops]
        return np.concatenate([*places, [ends[-1] + self.tail_terms - 1]])

    @property
    def samples(self) -> int:
        """Number of sampling points on a panel.

        Enough for products with ``exp(-x)`` to be right to rounding, however low the degree.
        """
        return max(self.degree + 5, 18)

    def sampling(self, points: int | None = None) -> Array:
        """Return ``x`` of Gauss-Legendre points on every panel, by default `samples`."""
        g, _ = gauss_rule(points or self.samples)
        return self.width * (np.arange(self.panels)[:, None] + (1.0 + g) / 2.0)

    def tail_sampling(self) -> Array:
        """Return the distances of Gauss-Legendre sampling points on the tail, shape (n,)."""
        g, _ = gauss_rule(self.tail_points)
        return self.end * (1.0 + g) / 2.0

    @property
    def distances(self) -> Array:
        """Distances of the sampling points, those of the panels and then the tail's (cached)."""
        return _DISTANCES.get(self, lambda: self.with_tail(self.sampling()))

    def with_tail(self, x: Array) -> Array:
        """Return the distances of points on the panels, and of the sampling points in the tail."""
        return np.concatenate([np.exp(-x).ravel(), self.tail_sampling()])

    def half_line_nodes(self) -> tuple[Array, Array]:
        """Return ``x`` and ``dx`` weights for sources, shape (panels, n) each; tail excluded."""
        g, w = gauss_rule(self.degree + EXTRA)
        x = self.width * (np.arange(self.panels)[:, None] + (1.0 + g) / 2.0)
        return x, np.broadcast_to(w * self.width / 2.0, x.shape)

    def nodes(self) -> PanelNodes:
        """Return the Galerkin nodes and their distances to the panel ends.

        Notes
        -----
        Half-integrals of single basis functions have square-root singularities at the deep end of
        each panel, and the measure has one at the centre of the disk: ``x = h (1 - v**2)`` on a
        panel, ``x = h sin(phi)**2`` on the first and ``d = end * v**2`` on the tail remove them.
        """
        h = self.width
        g, w = gauss_rule(self.node_counts[0])
        phi = np.pi / 4 * (1.0 + g)
        first = h * np.cos(phi) ** 2
        first_x = h * np.sin(phi) ** 2
        first_dx = w * np.pi / 2.0 * h * np.sin(phi) * np.cos(phi)
        g, w = gauss_rule(self.node_counts[1])
        v = (1.0 + g) / 2.0
        other = h * v**2
        x = np.concatenate([first_x, (h * np.arange(2, self.panels + 1)[:, None] - other).ravel()])
        dx = np.concatenate([first_dx, np.tile(w * h * v, self.panels - 1)])
        d, rest = np.exp(-x), -np.expm1(-x)
        weights = dx * d / (2.0 * np.sqrt(rest))
        tail = self.end * v**2
        tail_weights = w * v * self.end / (2.0 * np.sqrt(1.0 - tail))
        nodes = Nodes(
            np.concatenate([d, tail]),
            np.concatenate([rest, 1.0 - tail]),
            np.concatenate([weights, tail_weights]),
        )
        return PanelNodes(nodes, (first_x, first), (h * (1.0 - g) / 2.0 * (1.0 + v), other))

    def panel_gram(self, decay: float) -> Array:
        """Return ``int_0^h P_i P_k exp(-decay x) dx`` on the first panel, (degree + 1) square."""
        g, w = gauss_rule(self.degree + EXTRA)
        values = legendre_values(g, self.degree)
        weight = w * self.width / 2.0 * np.exp(-decay * self.width * (1.0 + g) / 2.0)
        return np.asarray((values.T * weight) @ values)

    def mass(self, columns: NDArray[np.int_], a: float, b: float) -> Array:
        """Return ``int_0^1 phi psi (a + b d) dd`` of some of the functions, block diagonal.

        Parameters
        ----------
        columns : ndarray of int
            The functions, increasing. They have no endpoint weight.
        a, b : float

        Returns
        -------
        ndarray, shape (len(columns), len(columns))
        """
        matrix = np.zeros((len(columns), len(columns)))
        one, two = self.panel_gram(1.0), self.panel_gram(2.0)
        terms = self.degree + 1
        bounds = np.searchsorted(columns, np.arange(self.panels + 1) * terms).tolist()
        last = bounds[-1]
        for j, (low, high) in enumerate(pairwise(bounds)):
            grid = np.ix_(*[columns[low:high] - j * terms] * 2)
            d = np.exp(-j * self.width)
            matrix[low:high, low:high] = d * (a * one[grid] + b * d * two[grid])
        g, w = gauss_rule(self.tail_terms + TAIL_EXTRA)  # those of its half-integrals
        v = (1.0 + g) / 2.0
        d = self.end * v**2
        values = tail_values(d, self.end, self.tail_terms, self.root_tail)
        values = values[:, columns[last:] - self.panels * terms]
        weight = w * v * self.end * (a + b * d)
        matrix[last:, last:] = (values.T * weight) @ values
        return matrix


@dataclass(frozen=True, slots=True)
class Resolution:
    """A space: panels and the degree used on each of them."""

    panels: LogPanels
    degrees: tuple[int, ...]


#: The panels of a part, and the degrees on them.
Used: TypeAlias = tuple[LogPanels, tuple[int, ...]]
