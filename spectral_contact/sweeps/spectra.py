"""Spectra: one decomposition serves normal contact and full stick for all compliances.

With the modes ``v_k`` of the normal operator, its eigenvalues ``lambda_k`` and the moments ``b_k``
of the modes (docs/internals) the pressure is ``delta* sum_k v_k b_k / (alpha* + lambda_k)``, and
``1/delta* = 2 pi sum_k b_k^2 / (alpha* + lambda_k)``. The edge pressure follows from the identity
``2 pi alpha p(1)^2 = delta + alpha ddelta/dalpha``. The right side of full stick is linear in the
pressure: one matrix has it for the modes of both operators. Total shear and edge ratio of full
stick are products of this matrix with ``1/(beta* + mu_j)`` and ``1/(alpha* + lambda_k)``, with the
eigenvalues ``mu_j`` of the tangential operator.

Tractions are those of kappa = 1. One mesh serves every compliance from 1e-14 to 1e14. Its
coordinate is ``x = -ln(1 - s**2)``, 0 at the centre and infinite at the edge.
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

#: Number of panels: they reach to ``x = 48``, 16 beyond the edge layer of the least compliance.
#: There p - p(1) has fallen to 1e-7 of p; the tail polynomials represent it from there on.
_PANELS: Final = 24
#: Compliances, or rows of a product, that are treated at a time, so that they stay in the cache of
#: a processor.
_BLOCK: Final = 256
#: Samples of q/p on every panel, among which its maximum is looked for.
_SAMPLES: Final = 16
#: Number of refinements around that maximum, each with samples a quarter as far apart.
_ZOOMS: Final = 5
#: A place is next to an end of a panel if its distance is at most this fraction of the width of
#: the panel: there the rounding of coefficients of high degree adds up.
_END_DISTANCE: Final = 0.05
#: If all pairs of the alphas and betas are at most this many times the pairs that are wanted, all
#: of them are computed, by a product of matrices.
_PAIRS_FACTOR: Final = 4


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
        modes = self.modes[space.index]
        #: moments of the tangential modes with the right side of every normal mode
        self.coupling = modes.T @ space.moments(self._right_sides(space.y)).T
        #: total shears of the modes
        self.shear = disk_shear(self.panels, (degree,) * _PANELS)[space.function] @ modes
        tail = self.panels.tail_terms
        #: Legendre polynomials at -1
        self._signs = (-1.0) ** np.arange(degree + 1)
        #: ``q/s`` of the modes at the edge, where the coordinate of the tail is -1
        self.edge = self._signs[:tail] @ self.modes[-tail:]

    def _right_sides(self, d: Array) -> Array:
        """Return the right side of full stick for every mode p of the pressure, (modes, places).

        It is ``R(t) = 2/t int_0^t s p ds / sqrt(t**2 - s**2)`` at ``d = 1 - t**2`` (docs/theory).
        """
        operators = transforms(self.panels)
        root = np.sqrt(1.0 - self.panels.sampling_distances)
        right_sides = []
        for mode in self.normal.modes.T:
            samples = 2.0 * operators.abel_left(np.ascontiguousarray(mode)) / root
            right_sides.append(sampled_series(self.panels, samples)(d))
        return np.array(right_sides)

    def shear_and_edge(self, alpha: Array, beta: Array) -> tuple[Array, Array]:
        """Return ``Q*/kappa`` and ``q/(kappa p)`` at the edge, for pairs of compliances."""
        alphas, a = np.unique(alpha, return_inverse=True)
        betas, b = np.unique(beta, return_inverse=True)
        pressure, edge_pressure = self.normal.pressure(alphas)
        # the right side of every alpha in the modes of the traction
        right_sides = pressure @ self.coupling.T
        inverse = 1.0 / (betas[:, None] + self.values)
        products = []
        for functional in (self.shear, self.edge):
            weights = functional * inverse
            if len(alphas) * len(betas) <= _PAIRS_FACTOR * len(alpha):
                products.append((right_sides @ weights.T)[a, b])
            else:
                products.append(_row_products(right_sides, a, weights, b))
        shear, edge = products
        return shear, edge / edge_pressure[a]

    def critical(self, alpha: Array, beta: Array, edge_ratio: Array) -> tuple[Array, Array]:
        """Return the largest ``|q|/(kappa p)`` of full stick, and an error at ends of panels.

        Parameters
        ----------
        alpha, beta : ndarray, shape (scenes,)
            Pairs of compliances.
        edge_ratio : ndarray, shape (scenes,)
            As `shear_and_edge` returns it.

        Returns
        -------
        critical, jumps : ndarray, shape (scenes,)
            The jumps are relative: see `_largest`.
        """
        critical = np.abs(edge_ratio)
        jumps = np.zeros(len(alpha))
        alphas, a = np.unique(alpha, return_inverse=True)
        pressure, _ = self.normal.pressure(alphas)
        right_sides = pressure @ self.coupling.T
        fields = pressure @ self.normal.modes.T
        # scenes of the same alpha are treated together
        order = np.argsort(a, kind="stable")
        bounds = np.searchsorted(a[order], np.arange(len(alphas) + 1))
        for k in range(len(alphas)):
            members = order[bounds[k] : bounds[k + 1]]
            for i in range(0, len(members), _BLOCK):
                part = members[i : i + _BLOCK]
                tractions = (right_sides[k] / (beta[part, None] + self.values)) @ self.modes.T
                inside, jumps[part] = self._largest(tractions, fields[k])
                critical[part] = np.maximum(critical[part], inside)
        return critical, jumps

    def _largest(self, tractions: Array, pressure: Array) -> tuple[Array, Array]:
        """Return the largest ``|q| / p`` on the panels, and the jumps at the ends of panels.

        Where the largest ratio is next to an end of a panel, the jump is the relative difference of
        q/p of the panels on both sides of that end; elsewhere it is 0. It is rounding, of up to
        5e-12, which a comparison of degrees at other places does not show.

        Parameters
        ----------
        tractions : ndarray, shape (rows, coefficients)
            Coefficients of ``q/s``, a row for each traction.
        pressure : ndarray, shape (coefficients,)
        """
        terms = self.panels.degree + 1
        count = _PANELS * terms
        q_over_s = tractions[:, :count].reshape(-1, _PANELS, terms)
        p = pressure[:count].reshape(_PANELS, terms)
        local = 2.0 * np.arange(_SAMPLES) / _SAMPLES - 1.0
        basis = legendre_rows(local, terms - 1)
        step = PANEL_WIDTH / _SAMPLES
        x = step * np.arange(_PANELS * _SAMPLES)
        s = np.sqrt(-np.expm1(-x))
        ratio = np.abs(s * (q_over_s @ basis).reshape(len(q_over_s), -1) / (p @ basis).ravel())
        largest_at = x[np.argmax(ratio, axis=1)]
        rows = np.arange(len(q_over_s))
        # nine places, each time a quarter as far apart
        offsets = np.linspace(-1.0, 1.0, 2 * 4 + 1)
        deepest = _PANELS * PANEL_WIDTH * (1.0 - 1e-15)
        for _ in range(_ZOOMS):
            places = np.clip(largest_at[:, None] + step * offsets, 0.0, deepest)
            panel = (places / PANEL_WIDTH).astype(np.intp)
            basis = legendre_rows(2.0 * (places / PANEL_WIDTH - panel) - 1.0, terms - 1)
            numerator = np.einsum("knm,nmk->nm", basis, q_over_s[rows[:, None], panel])
            denominator = np.einsum("knm,nmk->nm", basis, p[panel])
            ratio = np.abs(np.sqrt(-np.expm1(-places)) * numerator / denominator)
            best = np.argmax(ratio, axis=1)
            largest_at = places[rows, best]
            step /= 4.0
        place = largest_at / PANEL_WIDTH
        # the nearest end between two panels: for the panel on its left it is at the coordinate 1,
        # at which all Legendre polynomials are 1
        end = np.clip(np.rint(place).astype(np.intp), 1, _PANELS - 1)
        left = q_over_s[rows, end - 1].sum(axis=1) / p[end - 1].sum(axis=1)
        right = q_over_s[rows, end] @ self._signs / (p[end] @ self._signs)
        jump = np.where(np.abs(place - end) < _END_DISTANCE, np.abs(right / left - 1.0), 0.0)
        return _vertex(ratio, np.clip(best, 1, len(offsets) - 2)), jump


def _row_products(left: Array, a: Indices, right: Array, b: Indices) -> Array:
    """Return the inner products of rows a of one matrix with rows b of another, pair by pair."""
    result = np.empty(len(a))
    for i in range(0, len(a), _BLOCK):
        part = slice(i, i + _BLOCK)
        result[part] = np.einsum("ij,ij->i", left[a[part]], right[b[part]])
    return result


def _vertex(values: Array, at: Indices) -> Array:
    """Return the maximum of the parabola through three neighbouring values of every row.

    If that is not between them, it is the largest of the three.

    Parameters
    ----------
    values : ndarray, shape (rows, places)
        At equidistant places.
    at : ndarray, shape (rows,)
        The middle one of the three, in every row.
    """
    rows = np.arange(len(values))
    before, middle, after = (values[rows, at + k] for k in (-1, 0, 1))
    curvature = 2.0 * middle - before - after  # minus the second difference
    top = middle + (after - before) ** 2 / (8.0 * np.where(curvature > 0.0, curvature, np.inf))
    largest = np.maximum(np.maximum(before, middle), after)
    return np.where(np.abs(after - before) < 2.0 * curvature, np.maximum(top, largest), largest)
