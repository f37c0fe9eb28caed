"""The traction basis on stick annuli: two families of panels on each, degrees chosen per panel."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import ceil, log, log1p, sqrt

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag

from spectral_contact.contact.resolution import interpolate
from spectral_contact.fields.series import Radius
from spectral_contact.spectral.annulus import Annulus, Family, Points, gap
from spectral_contact.spectral.annulus_space import AnnulusSpace, annulus_space, log_interpolation
from spectral_contact.spectral.galerkin import disk_operators
from spectral_contact.spectral.jacobi import gauss_rule
from spectral_contact.spectral.panels import SAMPLES, LogPanels

__all__ = ["StickAnnuli"]

Array = NDArray[np.float64]


class StickAnnuli:
    """Functions ``q = s psi`` on a list of annuli.

    Parameters
    ----------
    annuli : list of Annulus
        Ordered outward.
    degrees : list of list of tuple of int
        For each annulus and each of its two families, the degree on every panel.

    Attributes
    ----------
    columns : ndarray of int
        The functions in use, among those of the full bases of all annuli.
    extents : ndarray, shape (columns,)
        Roots of half the extents in ``s**2``, the units in which half-integrals are given.
    """

    def __init__(self, annuli: list[Annulus], degrees: list[list[tuple[int, ...]]]) -> None:
        self.annuli = annuli
        self.spaces = [
            annulus_space(a.toward_inner, a.toward_outer, (first, second))
            for a, (first, second) in zip(annuli, degrees, strict=True)
        ]
        starts = np.cumsum([0, *(a.size for a in annuli)])
        self.total = int(starts[-1])
        used = [s.columns + i for s, i in zip(self.spaces, starts[:-1], strict=True)]
        self.columns = np.concatenate(used) if used else np.zeros(0, dtype=int)
        units = [np.full(len(s.columns), _extent(a)) for s, a in self._pairs]
        self.extents = np.concatenate(units) if units else np.zeros(0)

    @property
    def _pairs(self) -> Iterator[tuple[AnnulusSpace, Annulus]]:
        return zip(self.spaces, self.annuli, strict=True)

    def parts(self) -> Iterator[tuple[Family, slice]]:
        """Yield every family with its place in the full basis."""
        start = 0
        for annulus in self.annuli:
            for family in annulus.families:
                yield family, slice(start, start + family.panels.size)
                start += family.panels.size

    def full(self, values: Array) -> Array:
        """Return coefficients of the full bases from those of the functions in use."""
        full = np.zeros(self.total)
        full[self.columns] = values
        return full

    def _half_integral(self, points: Points, own: int, block: Array) -> Array:
        """Return the half-integrals at points where those of the annulus `own` are known.

        They are inside of the annuli farther out, and outside of those before: of these there is
        no part, and no column.
        """
        blocks = [block]
        for space, annulus in list(self._pairs)[own + 1 :]:
            blocks.append(annulus.half_integral(points)[:, space.columns] / _extent(annulus))
        return np.hstack(blocks) if len(blocks) > 1 else block

    def at_own_nodes(self, own: int, half: int) -> tuple[Points, Array, Array]:
        """Return the nodes on half an annulus, the weights of ``ds**2`` and the half-integrals.

        These are of the last functions in use; of those before they are zero.
        """
        family, (d, weights, block) = self.annuli[own].families[half], self.spaces[own].nodes[half]
        points = family.points(d)
        return points, family.reach * weights, self._half_integral(points, own, block)

    def inside(self, own: int, inner: Radius) -> tuple[Points, Array, Array]:
        """Return the same between a radius and the inner end of an annulus.

        Near the end panels are equal in the logarithm of the distance to it, near the centre in
        that of ``s**2``.
        """
        annulus, space = self.annuli[own], self.spaces[own]
        end, half = annulus.inner, gap(annulus.inner, annulus.outer) / 2.0
        width = gap(inner, end)
        e, weights, block = space.outside_rule(min(width, end.square / 2.0) / half)
        if width > end.square / 2.0:
            g, w = gauss_rule(SAMPLES)
            length = log(end.square / (2.0 * inner.square))
            count = ceil(length / 2.0)
            x = length / count * (np.arange(count)[:, None] + (1.0 + g) / 2.0)
            z = end.square / 2.0 * np.exp(-x)
            near = ((end.square - z) / half).ravel()
            e = np.concatenate([e, near])
            weights = np.concatenate([weights, (z * (length / (2.0 * half * count) * w)).ravel()])
            block = np.concatenate([block, space.outside(near)])
        points = Points(end, -half * e)
        return points, half * weights, self._half_integral(points, own, block)

    def field_inside(self, values: Array) -> Callable[[Points], Array]:
        """Return the half-integral of a traction as a function of points outside all annuli."""
        parts = []
        start = 0
        for space, annulus in self._pairs:
            own = _extent(annulus) * values[start : start + len(space.columns)]
            start += len(space.columns)
            half = gap(annulus.inner, annulus.outer) / 2.0
            function = space.outside_function(own, annulus.inner.square / half)
            parts.append((annulus.inner, half, function))

        def field(points: Points) -> Array:
            total = np.zeros(len(points.offset))
            for end, half, function in parts:
                e = points.before(end) / half
                below = e > 0.0
                total[below] += function(e[below])
            return total

        return field

    def moments(self) -> Array:
        """Return ``int q s ds`` of the functions in use, half annulus by half annulus."""
        parts = [s.moments(a) for s, a in self._pairs]
        return _diagonal(parts)

    def mass(self) -> Array:
        """Return the mass matrix of the functions in use."""
        blocks = [s.mass(a) for s, a in self._pairs]
        return _diagonal(blocks)

    def falls(self, panels: LogPanels, rim: Radius) -> tuple[Array, Array, Array]:
        """Return by how much the half-integrals fall from the rim of the disk inward.

        They are sums over sources, and analytic in the logarithm of the distance of these from
        the rim: few places there stand for all.

        Returns
        -------
        falls : ndarray, shape (nodes, places)
            Of point sources at the places, at the Galerkin nodes of the disk.
        shares : ndarray, shape (places, columns)
            What a function has at the places: its half-integrals fall by the product.
        at_rim : ndarray, shape (columns,)
            The half-integrals at the rim.
        """
        if not self.annuli:
            return np.zeros((len(disk_operators(panels).nodes.d), 0)), np.zeros((0, 0)), np.zeros(0)
        pairs = [self._gathered(i, rim) for i in range(len(self.annuli))]
        above = np.concatenate([places for places, _ in pairs])
        shares = _diagonal([share for _, share in pairs])

        def function(d: Array) -> Array:
            below = rim.square * d[:, None]
            root = np.sqrt(below + above)
            return np.asarray(below / (root * (root + np.sqrt(above)) * np.sqrt(above)))

        values, _ = interpolate(panels, function)
        return values, shares, (1.0 / np.sqrt(above)) @ shares

    def _gathered(self, own: int, rim: Radius) -> tuple[Array, Array]:
        """Return few places, as distances from the rim, and the weights of an annulus there."""
        annulus, space = self.annuli[own], self.spaces[own]
        nearest, half = gap(rim, annulus.inner), gap(annulus.inner, annulus.outer) / 2.0
        distances, matrix = space.sources
        # from the nearest place on: an annulus may be far narrower than its distance from the rim
        x, span = np.log1p(half / nearest * distances), log1p(2.0 * half / nearest)
        count = max(ceil(span / 2.0), 1)
        ends = np.linspace(0.0, span, count + 1)
        g, _ = gauss_rule(SAMPLES)
        places, shares = [], []
        panel = np.clip(np.searchsorted(ends, x) - 1, 0, count - 1)
        for i in range(count):
            rows = panel == i
            fit = log_interpolation(x[rows], ends[i], ends[i + 1])
            place = ends[i] + (ends[i + 1] - ends[i]) * (1.0 + g) / 2.0
            places.append(nearest * np.exp(place))
            shares.append(half * (fit.T @ matrix[rows]))
        return np.concatenate(places), np.concatenate(shares)


def _diagonal(blocks: list[Array]) -> Array:
    """Return the block-diagonal matrix."""
    return np.asarray(block_diag(*blocks)) if len(blocks) > 1 else blocks[0]


def _extent(annulus: Annulus) -> float:
    """Return the root of half an annulus's extent in ``s**2``, the unit of half-integrals."""
    return sqrt(gap(annulus.inner, annulus.outer) / 2.0)
