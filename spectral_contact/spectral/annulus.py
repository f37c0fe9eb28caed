"""Functions on an annulus: two families of logarithmic panels, one to each end."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from spectral_contact.fields.series import LogSeries, Radius
from spectral_contact.spectral.abel import deeper, deeper_blocks, deeper_tail, outer, outer_blocks
from spectral_contact.spectral.cache import BoundedCache, kept
from spectral_contact.spectral.jacobi import (
    EXTRA,
    gauss_rule,
    legendre_expansion_matrix,
    legendre_rows,
    legendre_values,
)
from spectral_contact.spectral.panels import LogPanels
from spectral_contact.spectral.parts import Family, gap, sampled_coefficients
from spectral_contact.threads import cached_property

Array = NDArray[np.float64]


#: Gauss points in ``d`` below the first panel; seen from beyond the first panel, a function of
#: ``d`` there is analytic in an ellipse of parameter 27 or more.
_DEEP_POINTS = 14


def sampled_series(panels: LogPanels, values: Array) -> LogSeries:
    """Return the series through samples at the sampling points of the panels and the tail."""
    return LogSeries(*sampled_coefficients(panels, values), panels.width)


class Transforms:
    """Abel integrals of a function at the sampling points of its own panels, without a matrix.

    In ``x`` they are convolutions: one row of blocks, kept for a set of panels, serves every panel
    by a shift. Points are the panels', then the tail's.

    Parameters
    ----------
    panels : LogPanels
        Without endpoint weight or root tail.
    """

    def __init__(self, panels: LogPanels) -> None:
        self.panels = panels
        self._x = panels.sampling()
        self._across: BoundedCache[tuple[int, float], Array] = BoundedCache(
            "Abel transforms across an annulus", 4
        )

    def deeper(self, coefficients: Array) -> Array:
        """Return the `deeper` integral, (..., sampling points), of functions (..., size)."""
        panels, terms = self.panels, self.panels.degree + 1
        blocks, tail = self._deeper
        count, shape = panels.panels, coefficients.shape[:-1]
        values = coefficients[..., count * terms :] @ tail.T
        from_panels = coefficients[..., : count * terms].reshape(*shape, count, terms) @ blocks
        sums = from_panels[..., -1, :].copy()
        size = sums.shape[-1]
        for j in range(1, count):
            stop = size - j * panels.samples
            sums[..., :stop] += from_panels[..., -1 - j, size - stop :]
        values[..., :size] += np.exp(-0.5 * self._x).ravel() * sums
        return np.asarray(values)

    def outer(self, coefficients: Array) -> Array:
        """Return the `outer` integral, (..., sampling points), of functions (..., size)."""
        panels, terms = self.panels, self.panels.degree + 1
        blocks, tail = self._outer
        count, shape = panels.panels, coefficients.shape[:-1]
        series = coefficients[..., : count * terms].reshape(*shape, count, terms)
        scaled = series * np.exp(-0.5 * panels.width * np.arange(count))[:, None]
        from_panels = scaled @ blocks
        values = from_panels[..., 0, :].copy()
        size = values.shape[-1]
        for j in range(1, count):
            start = j * panels.samples
            values[..., start:] += from_panels[..., j, : size - start]
        return np.concatenate([values, coefficients @ tail.T], axis=-1)

    def across(self, coefficients: Array, other: LogPanels) -> Array:
        """Return ``1/2 int f dd' / sqrt(2 - d - d')`` at the sampling points ``d`` of `other`.

        Of functions (..., size); the shape is (..., sampling points).
        This is what one half of an annulus contributes to the points of the other half, both of
        unit length. Only points of the first panel come near the sources: below, the integral
        is a polynomial in ``d`` to rounding.
        """
        near, reach = np.exp(-other.sampling()[0]), float(np.exp(-other.width))

        def matrix() -> Array:
            panels = self.panels
            d = np.concatenate([near, reach * (1.0 + gauss_rule(_DEEP_POINTS)[0]) / 2.0])
            return deeper(2.0 - d, panels.panels, panels.width, panels.degree)

        values = coefficients @ self._across.get((len(near), reach), matrix).T
        g, degree = 2.0 * other.distances[len(near) :] / reach - 1.0, _DEEP_POINTS - 1
        series = values[..., len(near) :] @ legendre_expansion_matrix(_DEEP_POINTS, degree).T
        deep = series @ legendre_rows(g, degree)
        return np.concatenate([values[..., : len(near)], deep], axis=-1)

    def mean(self, coefficients: Array) -> Array:
        """Return ``(1/d) int_0^d f dd'`` of a function, shape (sampling points,).

        Panel by panel from the boundary on, so that nothing cancels.
        """
        panels, terms = self.panels, self.panels.degree + 1
        count, end = panels.panels, panels.end
        on_panel, in_tail = self._mean
        series = coefficients[: count * terms].reshape(count, terms)
        in_tail = in_tail @ coefficients[count * terms :]
        start = np.exp(-panels.width * np.arange(count))
        parts = start[:, None] * (series @ on_panel)
        # what lies beyond each panel
        beyond = np.cumsum(np.concatenate([[end * in_tail[0]], parts[:0:-1, 0]]))[::-1]
        sums = beyond[:, None] + parts[:, 1:]
        means = sums / panels.distances[: sums.size].reshape(sums.shape)
        return np.concatenate([means.ravel(), in_tail[1:]])

    @cached_property
    def _mean(self) -> tuple[Array, Array]:
        """Matrices of `mean`: integrals over a panel and means over the tail.

        Over all of it first, then from every sampling point on.
        """
        panels, h = self.panels, self.panels.width
        g, w = gauss_rule(panels.degree + EXTRA)
        half = (1.0 + g) / 2.0
        # in units of the panel's exp(-x_j)
        begin = np.append(0.0, self._x[0])
        source = begin[:, None] + np.outer(h - begin, half)
        weight = np.exp(-source) * (w / 2.0) * (h - begin)[:, None]
        basis = legendre_values(2.0 * source / h - 1.0, panels.degree)
        on_panel = np.einsum("iq,iqk->ki", weight, basis)
        ends = np.append(1.0, panels.tail_sampling() / panels.end)
        tail = legendre_values(np.outer(ends, 2.0 * half) - 1.0, panels.tail_terms - 1)
        return on_panel, np.einsum("iqk,q->ik", tail, w / 2.0)

    @cached_property
    def _deeper(self) -> tuple[Array, Array]:
        panels = self.panels
        to_end = panels.width - self._x[0]
        blocks = deeper_blocks(to_end, panels.panels, panels.width, panels.degree)
        return _in_a_row(blocks[:, ::-1]), deeper_tail(panels.distances, panels.end)

    @cached_property
    def _outer(self) -> tuple[Array, Array]:
        panels = self.panels
        mesh = panels.panels, panels.width, panels.degree
        blocks = outer_blocks(self._x[0], *mesh)
        return _in_a_row(blocks), outer(panels.tail_sampling(), *mesh)


transforms = kept("Abel transforms", 12)(Transforms)


def _in_a_row(blocks: Array) -> Array:
    """Return blocks (points, panels, terms) side by side, (terms, panels * points)."""
    return blocks.transpose(2, 1, 0).reshape(blocks.shape[2], -1)


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

    def integrals(self, values: Sequence[Array], side: int) -> list[Array]:
        """Return integrals of functions at their own sampling points, on either half.

        The half-integral, over what lies outside of the points (+1), or the inner integral (-1), of
        values (..., points). In scaled distances the transforms depend on the panels alone.
        """
        panels = [family.panels for family in self.families]
        own = [transforms(one) for one in panels]
        each = [f.expand(one) for f, one in zip(self.families, values, strict=True)]
        # one half sees the other, too
        one, other = (0, 1) if side > 0 else (1, 0)
        found = [own[other].deeper(each[other])]
        found.insert(one, own[one].outer(each[one]) + own[other].across(each[other], panels[one]))
        return [np.sqrt(self.families[0].reach) * values for values in found]
