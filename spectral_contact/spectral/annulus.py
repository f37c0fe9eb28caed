"""Functions on an annulus: two families of logarithmic panels, one to each end."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from spectral_contact.fields.series import LogSeries, Radius
from spectral_contact.spectral.abel import tail_values
from spectral_contact.spectral.graded import FAR_FIT, FAR_NODES
from spectral_contact.spectral.jacobi import (
    gauss_rule,
    legendre_expansion_matrix,
    legendre_values,
)
from spectral_contact.spectral.panels import LogPanels
from spectral_contact.spectral.transforms import Transforms, transforms
from spectral_contact.threads import cached_property

__all__ = [
    "FAR_FIT",
    "FAR_NODES",
    "Annulus",
    "Family",
    "Points",
    "gap",
    "sampled_series",
]

Array = NDArray[np.float64]


def gap(a: Radius, b: Radius) -> float:
    """Return ``b**2 - a**2`` without cancellation."""
    difference = a.from_edge - b.from_edge if a.value >= 0.5 else b.value - a.value
    return difference * (a.value + b.value)


@dataclass(frozen=True, slots=True)
class Points:
    """Radii given by ``s**2 = anchor**2 + offset``, so that differences keep their digits."""

    anchor: Radius
    offset: Array

    def before(self, boundary: Radius) -> Array:
        """Return ``boundary**2 - s**2``."""
        return gap(self.anchor, boundary) - self.offset

    @property
    def z(self) -> Array:
        """Return ``s**2``."""
        return self.anchor.square + self.offset

    @property
    def y(self) -> Array:
        """Return ``1 - s**2``."""
        return self.anchor.rest - self.offset


@dataclass(frozen=True, slots=True)
class Family:
    """Panels in the logarithm of the distance to one end of an annulus.

    Attributes
    ----------
    boundary : Radius
        The end.
    sign : int
        +1 if the annulus lies above (outside) the boundary, -1 if below.
    reach : float
        Extent in ``s**2``.
    panels : LogPanels
        With an endpoint weight only below the boundary.
    """

    boundary: Radius
    sign: int
    reach: float
    panels: LogPanels

    def points(self, d: Array) -> Points:
        """Return the points at scaled distances `d` in [0, 1]."""
        return Points(self.boundary, self.sign * self.reach * d)

    def sampling(self) -> Points:
        """Return the sampling points: panels, then tail."""
        return self.points(transforms(self.panels).distances)

    def sources(self) -> tuple[Points, Array]:
        """Return plain quadrature: points, and ``1/2 w psi`` as a matrix (points, size)."""
        p = self.panels
        x, w = p.half_line_nodes()
        g, _ = gauss_rule(x.shape[1])
        values = legendre_values(g, p.degree)
        gt, wt = gauss_rule(p.tail_terms + 3)
        tail = p.end * (1.0 + gt) / 2.0
        matrix = np.zeros((x.size + len(gt), p.size))
        for j in range(p.panels):
            rows = slice(j * x.shape[1], (j + 1) * x.shape[1])
            columns = slice(j * (p.degree + 1), (j + 1) * (p.degree + 1))
            matrix[rows, columns] = values * (w[j] * np.exp(-x[j]))[:, None]
        basis = tail_values(tail, p.end, p.tail_terms, p.root_tail)
        matrix[x.size :, p.panels * (p.degree + 1) :] = basis * (wt * p.end / 2.0)[:, None]
        points = self.points(np.concatenate([np.exp(-x).ravel(), tail]))
        return points, 0.5 * self.reach * matrix

    def unresolved(self, series: LogSeries) -> float:
        """Return the largest of the last coefficients of any panel or of the tail."""
        return float(max(np.abs(series.coefficients[:, -3:]).max(), np.abs(series.tail[-2:]).max()))

    def truncated(self, values: Array, power: float) -> float:
        """Return the largest that `expand` drops of any panel or tail, times ``d**power``."""
        series, p = sampled_series(self.panels, values), self.panels
        dropped = np.abs(series.coefficients[:, p.degree + 1 :]).max(axis=1)
        in_panels = dropped * np.exp(-power * p.width * np.arange(p.panels))
        return float(max(in_panels.max(), np.abs(series.tail[p.tail_terms :]).max() * p.end**power))

    def expand(self, values: Array) -> Array:
        """Return coefficients, of the size of the basis, through values at the sampling points."""
        series = sampled_series(self.panels, values)
        p = self.panels
        table = series.coefficients[:, : p.degree + 1]
        return np.concatenate([table.ravel(), series.tail[: p.tail_terms]])


class _Halves(NamedTuple):
    """Transforms of the inner and the outer half, and the coefficients on them."""

    inner: Transforms
    outer: Transforms
    on_inner: Array
    on_outer: Array


@dataclass(frozen=True)
class Annulus:
    """An annulus with a family of panels to each end.

    Attributes
    ----------
    inner, outer : Radius
    toward_inner, toward_outer : LogPanels
        Panels of the two halves.
    """

    inner: Radius
    outer: Radius
    toward_inner: LogPanels
    toward_outer: LogPanels

    @cached_property
    def families(self) -> tuple[Family, Family]:
        """The two halves: above the inner end, below the outer end."""
        half = gap(self.inner, self.outer) / 2.0
        return (
            Family(self.inner, 1, half, self.toward_inner),
            Family(self.outer, -1, half, self.toward_outer),
        )

    @cached_property
    def sampling(self) -> tuple[Array, Array]:
        """``1 - s**2`` and ``s**2`` at the sampling points, those of the inner half first."""
        points = [family.sampling() for family in self.families]
        return np.concatenate([p.y for p in points]), np.concatenate([p.z for p in points])

    @property
    def sampling_split(self) -> int:
        """Number of sampling points of the inner family."""
        return len(transforms(self.toward_inner).distances)

    def own_half_integral(self, coefficients: Array) -> Array:
        """Return the half-integral of a function at the annulus's own sampling points.

        In scaled distances the transforms depend on the panels alone, whose blocks are cached.
        The inner family's points come first.
        """
        inner, outer, a, b = self._split(coefficients)
        above = inner.outer(a) + outer.across(b, self.toward_inner)
        return self._scale * np.concatenate([above, outer.deeper(b)])

    def own_inner_integral(self, coefficients: Array) -> Array:
        """Return the inner integral of a function at the annulus's own sampling points."""
        inner, outer, a, b = self._split(coefficients)
        below = inner.across(a, self.toward_outer) + outer.outer(b)
        return self._scale * np.concatenate([inner.deeper(a), below])

    def _split(self, coefficients: Array) -> _Halves:
        size = self.toward_inner.size
        pair = transforms(self.toward_inner), transforms(self.toward_outer)
        return _Halves(*pair, coefficients[:size], coefficients[size:])

    @property
    def _scale(self) -> float:
        return float(np.sqrt(gap(self.inner, self.outer) / 2.0))

    def halves(self, values: Array) -> tuple[Array, Array]:
        """Return the parts of values at the sampling points that lie in either half."""
        return values[: self.sampling_split], values[self.sampling_split :]

    def expand(self, values: Sequence[Array]) -> Array:
        """Return coefficients through values at the sampling points of both families."""
        pairs = zip(self.families, values, strict=True)
        return np.concatenate([f.expand(v) for f, v in pairs])


def sampled_series(panels: LogPanels, values: Array) -> LogSeries:
    """Return the series through samples at the sampling points of the panels and the tail."""
    tail_points = panels.tail_points
    inner = values[:-tail_points].reshape(panels.panels, -1)
    points = inner.shape[1]
    expand = legendre_expansion_matrix(points, points - 1)
    expand_tail = legendre_expansion_matrix(tail_points, tail_points - 1)
    return LogSeries(inner @ expand.T, expand_tail @ values[-tail_points:], panels.width)
