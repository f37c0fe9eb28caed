"""Logarithmic panels: where the unknowns live and where the Galerkin integrals are sampled."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from spectral_contact.spectral.blockwise import Blockwise
from spectral_contact.spectral.cache import bounded_cache
from spectral_contact.spectral.jacobi import (
    PANEL_SAMPLES,
    gauss_rule,
    legendre_values,
    power_rule,
    tail_values,
)
from spectral_contact.spectral.tuning import (
    EXTRA,
    SAMPLING_EXTRA,
    TAIL_TERMS,
)

Array = NDArray[np.float64]

#: Error estimates compare with spaces that lack two degrees of every panel, and one must be left.
LEAST_DEGREE = 2


class BasisRule(NamedTuple):
    """Points and weights of a rule, and a basis at the points, (points, functions)."""

    points: Array
    weights: Array
    basis: Array


@dataclass(frozen=True, slots=True)
class LogPanels:
    """Panels of equal width in ``x = -ln d`` and one tail panel that is polynomial in ``d``.

    Parameters
    ----------
    count : int
        Number of panels, at least 1.
    width : float
        Width of each in ``x``.
    degree : int
        Highest Legendre degree on each panel.
    power : float
        Endpoint weight: the functions are ``d**power`` times polynomials. 0, or for a traction
        that is singular at the edge -1/2 or more.
    root_tail : bool
        The tail is polynomial in ``sqrt(d)``, for square roots at the boundary.
    """

    count: int
    width: float
    degree: int
    power: float = 0.0
    root_tail: bool = False

    @property
    def end(self) -> float:
        """Distance ``exp(-count * width)`` at which the tail begins."""
        return float(np.exp(-self.count * self.width))

    @property
    def size(self) -> int:
        """Number of coefficients, tail included."""
        return self.count * (self.degree + 1) + self.tail_terms

    @property
    def tail_terms(self) -> int:
        """Number of tail polynomials; in ``sqrt(d)`` they leave ``d**(9/2)``, in d ``d**3``."""
        return 3 * TAIL_TERMS if self.root_tail else TAIL_TERMS

    def table(self, coefficients: Array) -> Array:
        """Return the coefficients on the panels as (panels, degree + 1), a view without tail."""
        return coefficients[: -self.tail_terms].reshape(self.count, self.degree + 1)

    @property
    def tail_points(self) -> int:
        """Number of sampling points on the tail."""
        return self.tail_terms + 1

    @bounded_cache("functions in use")
    def functions(self, degrees: tuple[int, ...]) -> NDArray[np.int_]:
        """Return the basis functions up to these degrees on the panels, and the tail (cached)."""
        on_panels = np.flatnonzero(np.arange(self.degree + 1) <= np.array(degrees)[:, None])
        return np.append(on_panels, np.arange(self.size - self.tail_terms, self.size))

    @bounded_cache("top degrees")
    def top(self, degrees: tuple[int, ...], count: int) -> NDArray[np.int_]:
        """Return where, among `functions`, the top `count` degrees of every panel are.

        Constants are not among them, and the last function of the tail is (cached).
        """
        functions = self.functions(degrees)
        highest = np.repeat(degrees, np.add(degrees, 1))
        degree = functions[: -self.tail_terms] % (self.degree + 1)
        tops = np.flatnonzero(degree > highest - np.minimum(count, highest))
        return np.append(tops, len(functions) - 1)

    @property
    def samples(self) -> int:
        """Number of sampling points on a panel.

        Enough for products with ``exp(-x)`` to be right to rounding, however low the degree.
        """
        return max(self.degree + SAMPLING_EXTRA, PANEL_SAMPLES)

    def sampling(self, count: int | None = None) -> Array:
        """Return ``x`` of `count` Gauss-Legendre points on every panel, by default `samples`.

        The shape is (panels, count).
        """
        g, _ = gauss_rule(count or self.samples)
        return self.width * (np.arange(self.count)[:, None] + (1.0 + g) / 2.0)

    def tail_sampling(self) -> Array:
        """Return the distances of Gauss-Legendre points on a tail that is polynomial in d, (n,)."""
        g, _ = gauss_rule(self.tail_points)
        return self.end * (1.0 + g) / 2.0

    @property
    @bounded_cache("sampling points")
    def sampling_distances(self) -> Array:
        """Distances of the sampling points, those of the panels and then the tail's (cached)."""
        return np.concatenate([np.exp(-self.sampling()).ravel(), self.tail_sampling()])

    @bounded_cache("rules on tails")
    def tail_rule(self) -> BasisRule:
        """Return distances and ``dd`` weights on the tail, and the polynomials there (cached).

        The weights are for integrands that contain ``d**power``; the polynomials do not contain it.
        """
        v, w = power_rule(self.tail_terms + EXTRA, 1.0 + 2.0 * self.power)
        d = self.end * v**2
        values = tail_values(d, self.end, self.tail_terms, self.root_tail)
        return BasisRule(d, 2.0 * w * v ** (-2.0 * self.power) * self.end, values)

    def mass(self, degrees: tuple[int, ...], constant: float, rising: float = 0.0) -> Blockwise:
        """Return ``int_0^1 phi psi (constant + rising d) dd``, a block for each panel and the tail.

        The functions are those up to these degrees on the panels, and those of the tail. With an
        endpoint weight the matrix is zero: such panels serve where there is no compliance.
        """
        densities = np.array([constant, rising]) * (self.power == 0.0)
        on_panel, on_tail = self._masses()
        extents = np.exp(-self.width * np.arange(self.count))
        blocks = np.tensordot(densities * extents[:, None] ** (1, 2), on_panel, 1)
        used = [block[: n + 1, : n + 1] for block, n in zip(blocks, degrees, strict=True)]
        return Blockwise([*used, np.tensordot(densities, on_tail, 1)])

    @bounded_cache("masses")
    def _masses(self) -> tuple[Array, Array]:
        """Return masses with the densities 1 and d, on the first panel and on the tail (cached)."""
        g, w = gauss_rule(self.degree + EXTRA)
        values = legendre_values(g, self.degree)
        distances = np.exp(-self.width * (1.0 + g) / 2.0)
        d, weights, tail = self.tail_rule()
        on_panel = []
        on_tail = []
        for k in (0, 1):
            panel_weights = w * self.width / 2.0 * distances ** (1 + k)
            on_panel.append((values.T * panel_weights) @ values)
            on_tail.append((tail.T * (weights * d**k)) @ tail)
        return np.array(on_panel), np.array(on_tail)


class DiscreteSpace(NamedTuple):
    """A space on a part: panels and the degree used on each of them."""

    panels: LogPanels
    degrees: tuple[int, ...]
