"""One decomposition serves every roughness: normal contact and full stick for any compliances.

With the modes ``v_k`` of the normal operator, its eigenvalues ``lambda_k`` and their moments
``b_k`` (docs/maps) the pressure is ``delta* sum_k v_k b_k / (alpha* + lambda_k)``, and
``1/delta* = 2 pi sum_k b_k^2 / (alpha* + lambda_k)``. The edge pressure follows from the identity
``2 pi alpha p(1)^2 = delta + alpha ddelta/dalpha``. What the pressure demands of the traction is
linear, so the modes of both operators are coupled by one matrix, and total shear and edge ratio of
full stick are products of it with ``1/(beta* + mu_j)`` and ``1/(alpha* + lambda_k)``.

All is for kappa = 1. One mesh serves every compliance from 1e-14 to 1e14.
"""

from __future__ import annotations

from math import pi
from typing import Final

import numpy as np
from numpy.typing import NDArray

from spectral_contact.contact.tuning import PANEL_WIDTH
from spectral_contact.fields import Array
from spectral_contact.spectral.blocks import disk_shear
from spectral_contact.spectral.jacobi import legendre_rows
from spectral_contact.spectral.panels import LogPanels
from spectral_contact.spectral.spaces import unit_space
from spectral_contact.spectral.transforms import sampled_series, transforms

Indices = NDArray[np.intp]

#: To ``x = 48``: 16 beyond the layer of the least compliance, where p - p(1) has fallen to 1e-7
#: of p; the tail polynomials do the rest.
_PANELS: Final = 24
#: Compliances at a time, so that the sums stay in the cache of a processor.
_BLOCK: Final = 256
#: Where q/p is sampled on every panel to find its maximum, and how often that is zoomed in on.
_SAMPLES, _ZOOMS = 16, 5
#: The share of a panel next to its ends where coefficients that are rounding add up.
_BESIDE: Final = 0.05
#: A grid of all pairs of compliances may have this many times the pairs that are wanted.
_SPARE: Final = 4


class NormalSpectrum:
    """Approach and pressure for every normal compliance.

    Parameters
    ----------
    degree : int
        On every panel.
    """

    def __init__(self, degree: int) -> None:
        self.panels = LogPanels(_PANELS, PANEL_WIDTH, degree)
        space = unit_space(self.panels, (degree,) * _PANELS)
        self.values, self.modes = space.spectrum()
        #: ``int v_k s ds``
        self.moments = 2.0 * space.constant_moments @ self.modes[space.index]

    def approach(self, alpha: Array) -> tuple[Array, Array]:
        """Return approach and edge pressure, each of shape (scenes,), for positive `alpha`."""
        approach, slope = np.empty_like(alpha), np.empty_like(alpha)
        square = self.moments**2
        for i in range(0, len(alpha), _BLOCK):
            part = slice(i, i + _BLOCK)
            inverse = 1.0 / (alpha[part, None] + self.values)
            approach[part] = 1.0 / (2.0 * pi * (inverse @ square))
            slope[part] = 2.0 * pi * approach[part] ** 2 * (np.square(inverse) @ square)
        return approach, np.sqrt((approach / alpha + slope) / (2.0 * pi))

    def pressure(self, alpha: Array) -> tuple[Array, Array]:
        """Return the pressure in the modes, shape (scenes, modes), and the edge pressure."""
        approach, edge = self.approach(alpha)
        return approach[:, None] * self.moments / (alpha[:, None] + self.values), edge


class StickSpectrum:
    """Full stick for every pair of positive compliances.

    Parameters
    ----------
    degree : int
        On every panel, of pressure and traction.
    """

    def __init__(self, degree: int) -> None:
        self.normal = NormalSpectrum(degree)
        self.panels = self.normal.panels
        space = unit_space(self.panels, (degree,) * _PANELS, shear=True)
        self.values, self.modes = space.spectrum()
        own = self.modes[space.index]
        #: what a mode of the pressure demands of a mode of the traction, (tangential, normal)
        self.coupling = own.T @ space.moments(self._targets(space.y)).T
        self.shear = disk_shear(self.panels, (degree,) * _PANELS)[space.function] @ own
        tail = self.panels.tail_terms
        #: Legendre polynomials at -1
        self._signs = (-1.0) ** np.arange(degree + 1)
        #: ``q/s`` of the modes at the edge
        self.edge = self._signs[:tail] @ self.modes[-tail:]

    def _targets(self, d: Array) -> Array:
        """Return R of every mode of the pressure, shape (modes, places); see `contact.drive`."""
        own = transforms(self.panels)
        root = np.sqrt(1.0 - self.panels.sampling_distances)
        return np.array(
            [
                sampled_series(self.panels, 2.0 * own.abel_left(np.ascontiguousarray(mode)) / root)(
                    d
                )
                for mode in self.normal.modes.T
            ]
        )

    def shear_and_edge(self, alpha: Array, beta: Array) -> tuple[Array, Array]:
        """Return ``Q*/kappa`` and ``q/(kappa p)`` at the edge, for pairs of compliances."""
        alphas, a = np.unique(alpha, return_inverse=True)
        betas, b = np.unique(beta, return_inverse=True)
        pressure, edge_pressure = self.normal.pressure(alphas)
        demands = pressure @ self.coupling.T
        inverse = 1.0 / (betas[:, None] + self.values)
        found = []
        for functional in (self.shear, self.edge):
            weights = functional * inverse
            if len(alphas) * len(betas) <= _SPARE * len(alpha):
                found.append((demands @ weights.T)[a, b])
            else:
                found.append(_row_products(demands, a, weights, b))
        shear, edge = found
        return shear, edge / edge_pressure[a]

    def critical(self, alpha: Array, beta: Array, edge_ratio: Array) -> tuple[Array, Array]:
        """Return the largest ``|q|/(kappa p)`` of full stick, and what ends of panels round in it.

        For pairs of compliances.

        Parameters
        ----------
        alpha, beta : ndarray, shape (scenes,)
        edge_ratio : ndarray, shape (scenes,)
            As `shear_and_edge` returns it.
        """
        critical, jumps = np.abs(edge_ratio), np.zeros(len(alpha))
        alphas, own = np.unique(alpha, return_inverse=True)
        pressure, _ = self.normal.pressure(alphas)
        demands = pressure @ self.coupling.T
        fields = pressure @ self.normal.modes.T
        order = np.argsort(own, kind="stable")
        bounds = np.searchsorted(own[order], np.arange(len(alphas) + 1))
        for k in range(len(alphas)):
            members = order[bounds[k] : bounds[k + 1]]
            for i in range(0, len(members), _BLOCK):
                part = members[i : i + _BLOCK]
                tractions = (demands[k] / (beta[part, None] + self.values)) @ self.modes.T
                inside, jumps[part] = self._largest(tractions, fields[k])
                critical[part] = np.maximum(critical[part], inside)
        return critical, jumps

    def _largest(self, tractions: Array, pressure: Array) -> tuple[Array, Array]:
        """Return the largest ``s |u| / p`` on the panels, for rows of coefficients of u.

        And by how much, relatively, q/p jumps where that is next to an end of a panel: rounding of
        up to 5e-12 there, which no difference of degrees at other places shows.
        """
        terms = self.panels.degree + 1
        count = _PANELS * terms
        q = tractions[:, :count].reshape(-1, _PANELS, terms)
        p = pressure[:count].reshape(_PANELS, terms)
        local = 2.0 * np.arange(_SAMPLES) / _SAMPLES - 1.0
        basis = legendre_rows(local, terms - 1)
        step = PANEL_WIDTH / _SAMPLES
        x = step * np.arange(_PANELS * _SAMPLES)
        root = np.sqrt(-np.expm1(-x))
        ratio = np.abs(root * (q @ basis).reshape(len(q), -1) / (p @ basis).ravel())
        where = x[np.argmax(ratio, axis=1)]
        rows = np.arange(len(q))[:, None]
        offsets = np.linspace(-1.0, 1.0, 2 * 4 + 1)
        deepest = _PANELS * PANEL_WIDTH * (1.0 - 1e-15)
        for _ in range(_ZOOMS):
            places = np.clip(where[:, None] + step * offsets, 0.0, deepest)
            panel = (places / PANEL_WIDTH).astype(np.intp)
            basis = legendre_rows(2.0 * (places / PANEL_WIDTH - panel) - 1.0, terms - 1)
            above = np.einsum("knm,nmk->nm", basis, q[rows, panel])
            below = np.einsum("knm,nmk->nm", basis, p[panel])
            ratio = np.abs(np.sqrt(-np.expm1(-places)) * above / below)
            best = np.argmax(ratio, axis=1)
            where = places[rows[:, 0], best]
            step /= 4.0
        each, place = np.arange(len(q)), where / PANEL_WIDTH
        end = np.clip(np.rint(place).astype(np.intp), 1, _PANELS - 1)
        left = q[each, end - 1].sum(axis=1) / p[end - 1].sum(axis=1)
        right = q[each, end] @ self._signs / (p[end] @ self._signs)
        jump = np.where(np.abs(place - end) < _BESIDE, np.abs(right / left - 1.0), 0.0)
        return _vertex(ratio, np.clip(best, 1, len(offsets) - 2)), jump


def _row_products(left: Array, a: Indices, right: Array, b: Indices) -> Array:
    """Return the inner products of rows of two matrices, pair by pair."""
    result = np.empty(len(a))
    for i in range(0, len(a), _BLOCK):
        part = slice(i, i + _BLOCK)
        result[part] = np.einsum("ij,ij->i", left[a[part]], right[b[part]])
    return result


def _vertex(values: Array, at: Indices) -> Array:
    """Return the top of the parabola through three equidistant values, or the largest of them."""
    rows = np.arange(len(values))
    before, middle, after = (values[rows, at + k] for k in (-1, 0, 1))
    bend = 2.0 * middle - before - after
    top = middle + (after - before) ** 2 / (8.0 * np.where(bend > 0.0, bend, np.inf))
    largest = np.maximum(np.maximum(before, middle), after)
    # a vertex beyond its neighbours is no vertex: the maximum is at an end
    return np.where(np.abs(after - before) < 2.0 * bend, np.maximum(top, largest), largest)
