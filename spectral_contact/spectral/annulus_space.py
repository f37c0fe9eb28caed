r"""Functions of chosen degrees on an annulus, and what belongs to them and not to a scene.

In units of half the annulus's extent in ``s**2`` the half-integrals depend on the panels alone: at
the annulus's own nodes, and past its inner end as functions of the scaled distance ``e`` from it.
Those are analytic in ``ln e`` up to an imaginary part of pi, so `SAMPLES` points on a panel of the
logarithm represent them.
"""

from __future__ import annotations

from collections.abc import Callable
from math import ceil, exp, log
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from spectral_contact.fields.series import LogSeries
from spectral_contact.spectral.annulus import UNIT, Annulus, Points
from spectral_contact.spectral.cache import BoundedCache
from spectral_contact.spectral.jacobi import (
    gauss_rule,
    legendre_expansion_matrix,
    legendre_interpolation_matrix,
)
from spectral_contact.spectral.panels import SAMPLES, LogPanels
from spectral_contact.threads import cached_property

__all__ = ["AnnulusSpace", "annulus_space", "log_interpolation"]

Array = NDArray[np.float64]
Degrees: TypeAlias = tuple[tuple[int, ...], tuple[int, ...]]

#: Width in ``ln e`` of the panels past the inner end.
_WIDTH = 2.0
#: Panels past those of the annulus after which all is a polynomial in ``sqrt(e)``, and its terms.
_DEEPER, _ROOT_TERMS = 3, 12

_SPACES: BoundedCache[tuple[LogPanels, LogPanels, Degrees], AnnulusSpace] = BoundedCache(
    "annulus spaces", 12
)


def annulus_space(inner: LogPanels, outer: LogPanels, degrees: Degrees) -> AnnulusSpace:
    """Return the space with these panels toward either end and degrees on them (cached)."""
    key = inner, outer, degrees
    return _SPACES.get(key, lambda: AnnulusSpace(*key))


def log_interpolation(points: Array, low: float, high: float) -> Array:
    """Return the matrix from values at `SAMPLES` points to those at `points`, in (low, high)."""
    local = (2.0 * points - low - high) / (high - low)
    return legendre_interpolation_matrix(local, SAMPLES)


class AnnulusSpace:
    """Functions on an annulus whose halves have unit extent in ``s**2``.

    On another one half-integrals are larger by the square root of the extent of a half.

    Parameters
    ----------
    inner, outer : LogPanels
        Panels toward either end.
    degrees : tuple of tuple of int
        Highest degree on every panel, toward either end.

    Attributes
    ----------
    columns : ndarray of int
        The functions in use, among all of both halves.
    """

    def __init__(self, inner: LogPanels, outer: LogPanels, degrees: Degrees) -> None:
        self._unit = Annulus(*UNIT, inner, outer)
        used = inner.functions(degrees[0]), outer.functions(degrees[1]) + inner.size
        self.columns = np.concatenate(used)
        self._split = int(np.searchsorted(self.columns, inner.size))
        self._bottom = inner.panels + _DEEPER
        self._outside: BoundedCache[int, Array] = BoundedCache("half-integrals past an annulus", 64)
        self._deep: BoundedCache[int, tuple[Array, Array, Array]] = BoundedCache(
            "rules past an annulus", 8
        )

    @cached_property
    def nodes(self) -> list[tuple[Array, Array, Array]]:
        """Of either half distances of the Galerkin nodes, weights and half-integrals there.

        Those in the outer half are of its own functions alone.
        """
        rules = []
        for family, first in zip(self._unit.families, (0, self._split), strict=True):
            d, weights = family.panels.distance_nodes(mirrored=family.sign > 0)
            matrix = self._half_integral(family.points(d))[:, first:]
            rules.append((d, weights, np.ascontiguousarray(matrix)))
        return rules

    def _half_integral(self, points: Points) -> Array:
        return self._unit.half_integral(points)[:, self.columns]

    @cached_property
    def _masses(self) -> list[tuple[slice, Array, Array]]:
        """Of either half its functions, and their mass with the densities 1 and ``d``."""
        columns, k = self.columns, self._split
        halves = (slice(0, k), columns[:k]), (slice(k, None), columns[k:] - columns[k])
        return [
            (part, f.panels.mass(own, 1.0, 0.0), f.panels.mass(own, 0.0, 1.0))
            for f, (part, own) in zip(self._unit.families, halves, strict=True)
        ]

    def mass(self, annulus: Annulus) -> Array:
        """Return ``int psi psi s^3 ds`` on an annulus with these panels."""
        matrix = np.zeros((len(self.columns), len(self.columns)))
        for family, (part, one, two) in zip(annulus.families, self._masses, strict=True):
            half = family.reach / 2.0
            block = (half * family.boundary.square) * one
            matrix[part, part] = block + (half * family.sign * family.reach) * two
        return matrix

    @cached_property
    def sources(self) -> tuple[Array, Array]:
        """Plain quadrature: distances from the inner end, and ``w psi / 2`` there as a matrix."""
        pairs = [family.sources() for family in self._unit.families]
        distances = [-points.before(UNIT[0]) for points, _ in pairs]
        (above, first), (below, second) = zip(distances, (m for _, m in pairs), strict=True)
        matrix = np.zeros((len(above) + len(below), self._unit.size))
        matrix[: len(above), : first.shape[1]] = first
        matrix[len(above) :, first.shape[1] :] = second
        return np.concatenate([above, below]), matrix[:, self.columns]

    def moments(self, annulus: Annulus) -> Array:
        """Return ``int s psi s ds`` on an annulus with these panels, as (2, columns): halves."""
        half, (distances, matrix) = annulus.families[0].reach, self.sources
        weighted = half * np.sqrt(annulus.inner.square + half * distances)
        parts = np.zeros((2, len(self.columns)))
        for part, rows in zip(parts, (distances <= 1.0, distances > 1.0), strict=True):
            part[:] = weighted[rows] @ matrix[rows]
        return parts

    # past the inner end

    def _on_panel(self, number: int) -> Array:
        """Return the half-integrals at samples of ``number < -ln(e) / 2 < number + 1``."""

        def matrix() -> Array:
            if number == self._bottom:
                g, _ = gauss_rule(_ROOT_TERMS)
                e = exp(-_WIDTH * number) * ((1.0 + g) / 2.0) ** 2
            else:
                g, _ = gauss_rule(SAMPLES)
                e = np.exp(-_WIDTH * (number + (1.0 + g) / 2.0))
            return self._half_integral(Points(UNIT[0], -e))

        return self._outside.get(number, matrix)

    def outside(self, e: Array) -> Array:
        """Return the half-integrals at distances `e` above all deep ones, (points, columns)."""
        x = -np.log(e)
        own = np.minimum(np.floor(x / _WIDTH).astype(int), self._bottom - 1)
        matrix = np.empty((len(e), len(self.columns)))
        for i in np.unique(own):
            rows = own == i
            ends = _WIDTH * i, _WIDTH * (i + 1)
            matrix[rows] = log_interpolation(x[rows], *ends) @ self._on_panel(int(i))
        return matrix

    def outside_rule(self, reach: float) -> tuple[Array, Array, Array]:
        """Return a quadrature of ``int_0^reach . de`` and the half-integrals at its points.

        It serves what is analytic in ``ln e``, and below the panels in ``sqrt(e)``.

        Returns
        -------
        e, weights : ndarray, shape (points,)
        matrix : ndarray, shape (points, columns)
        """
        v, tail_w = gauss_rule(_ROOT_TERMS)
        root, end = (1.0 + v) / 2.0, exp(-_WIDTH * self._bottom)
        if reach <= end:
            e = reach * root**2
            fit = legendre_interpolation_matrix(2.0 * np.sqrt(e / end) - 1.0, _ROOT_TERMS)
            return e, reach * root * tail_w, fit @ self._on_panel(self._bottom)
        g, w = gauss_rule(SAMPLES)
        start = -log(reach)
        # a panel of its own down to the first of those that are kept
        first = ceil(start / _WIDTH)
        width = _WIDTH * first - start
        top = np.exp(-start - width * (1.0 + g) / 2.0)
        e, weights, matrix = self._deep.get(first, lambda: self._kept_rule(first))
        return (
            np.concatenate([top, e]),
            np.concatenate([top * w * width / 2.0, weights]),
            np.concatenate([self.outside(top), matrix]),
        )

    def _kept_rule(self, first: int) -> tuple[Array, Array, Array]:
        """Return the rule from one of the panels that are kept down."""
        g, w = gauss_rule(SAMPLES)
        v, tail_w = gauss_rule(_ROOT_TERMS)
        panels = np.exp(-_WIDTH * (np.arange(first, self._bottom)[:, None] + (1.0 + g) / 2.0))
        root, end = (1.0 + v) / 2.0, exp(-_WIDTH * self._bottom)
        e = np.concatenate([panels.ravel(), end * root**2])
        weights = np.concatenate([(panels * w * _WIDTH / 2.0).ravel(), end * root * tail_w])
        kept = [self._on_panel(i) for i in range(first, self._bottom + 1)]
        return e, weights, np.concatenate(kept)

    def outside_function(self, values: Array, reach: float) -> Callable[[Array], Array]:
        """Return the half-integral of a function of the space at distances `e` up to `reach`."""
        first = min(int(np.floor(-log(reach) / _WIDTH)), self._bottom - 1)
        samples = np.array([self._on_panel(i) @ values for i in range(first, self._bottom)])
        table = samples @ legendre_expansion_matrix(SAMPLES, SAMPLES - 1).T
        tail = legendre_expansion_matrix(_ROOT_TERMS, _ROOT_TERMS - 1) @ (
            self._on_panel(self._bottom) @ values
        )
        series, scale = LogSeries(table, tail, _WIDTH, root_tail=True), exp(_WIDTH * first)
        return lambda e: series(e * scale)
