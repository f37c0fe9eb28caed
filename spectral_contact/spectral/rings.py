"""Operators on rings: pressure and traction are constant on each of them.

Galerkin's method through Abel's factorisation (docs/theory), so that energy is conserved: the
matrices are Gram matrices of half-order integrals, symmetric and positive definite, and the
coupling of p to q is the transpose of that of q to p.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np
from numpy.typing import NDArray

from spectral_contact.spectral.cache import bounded_cache
from spectral_contact.spectral.jacobi import PANEL_SAMPLES, gauss_rule

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class RingOperators:
    """Galerkin matrices of functions that are constant on rings, in the measure ``s ds``.

    The function phi_i is 1 on ring i and 0 elsewhere.

    Attributes
    ----------
    logits : ndarray, shape (rings + 1,)
        ``ln(s**2/(1 - s**2))`` of the boundaries of rings, outward: from minus infinity, the
        centre, to infinity, the edge.
    mass : ndarray, shape (rings,)
        ``int s ds`` of each.
    normal, tangential : ndarray, shape (rings, rings)
        ``<phi_i, N phi_j>`` and ``<phi_i, T phi_j>``.
    coupling : ndarray, shape (rings, rings)
        ``<phi_i, g[phi_j]>`` with the tangential displacement ``g = (1/s) int_0^s eta p deta`` that
        a pressure p makes, for kappa = 1; lower triangular.
    """

    logits: Array
    mass: Array
    normal: Array
    tangential: Array
    coupling: Array

    @property
    def middles(self) -> Array:
        """Logits in the middle of each ring, in the mean square of its radius."""
        inside = np.exp(-np.logaddexp(0.0, -self.logits))
        outside = np.exp(-np.logaddexp(0.0, self.logits))
        return np.asarray(np.log((inside[1:] + inside[:-1]) / (outside[1:] + outside[:-1])))


def graded_rings(count: int, exponent: float, widest: float, centre: float, edge: float) -> Array:
    """Return the logits of boundaries of rings that grow finer towards the edge, (rings + 1,).

    Distances from the edge are even numbers to the power `exponent`, of so many rings. Those that
    are wider in the logit than `widest` are replaced by even ones, from `-centre` to `edge`, and
    one more to the ends.
    """
    depth = (np.arange(count - 1, 0, -1) / count) ** exponent
    inner = 2.0 * np.log1p(-depth) - np.log(depth * (2.0 - depth))
    narrow = np.flatnonzero(np.diff(inner) <= widest)
    inner = inner[narrow[0] : narrow[-1] + 2]
    to_centre, to_edge = (
        a + (b - a) * np.linspace(0.0, 1.0, int(np.ceil(abs(b - a) / widest)) + 1)[1:]
        for a, b in ((inner[0], -centre), (inner[-1], edge))
    )
    return np.concatenate([[-np.inf], to_centre[::-1], inner, to_edge, [np.inf]])


def ring_operators(logits: Array) -> RingOperators:
    """Return the matrices of a grid, for the logits of the boundaries of its rings (cached)."""
    return _assembled(logits.tobytes())


def _square_difference(lower: Array, upper: Array) -> Array:
    """Return the difference of the squares of two radii with these logits, to full accuracy."""
    with np.errstate(invalid="ignore"):  # both at the edge: the difference is 0
        relative = -np.expm1(np.where(lower == upper, 0.0, lower - upper))
    return np.asarray(relative * np.exp(-np.logaddexp(0.0, lower) - np.logaddexp(0.0, -upper)))


@bounded_cache("rings", 8)  # the first ones, and some that were refined
def _assembled(grid: bytes) -> RingOperators:
    """Return the matrices of a grid, from half-integrals of every ring at points of every ring.

    The half-integrals are F of a unit pressure and G of a unit traction (docs/theory). They have
    square roots at the ends of rings, which ``t**2 = inner**2 + square_width sin(phi)**2`` takes
    away; radii outside of t are measured from t, so that nothing cancels.
    """
    logits = np.frombuffer(grid)
    inner_logits = logits[:-1]
    outer_logits = logits[1:]
    # of every ring the difference of the squares of its two radii, and of the radii
    square_width = _square_difference(inner_logits, outer_logits)
    radius = np.exp(-np.logaddexp(0.0, -logits) / 2.0)
    thickness = square_width / (radius[1:] + radius[:-1])
    x, weight = gauss_rule(PANEL_SAMPLES)
    phi = pi / 4 * (1.0 + x)
    # points t of every ring, the distance from t**2 to the square of its outer radius, and dt
    t = np.sqrt(radius[:-1, None] ** 2 + square_width[:, None] * np.sin(phi) ** 2)
    to_outer = square_width[:, None] * np.cos(phi) ** 2
    dt = weight * pi / 4 * square_width[:, None] * np.sin(phi) * np.cos(phi) / t

    # indices of all that follows: the ring of t, t, the ring that is integrated
    count = len(square_width)
    number = np.arange(count)
    same = (number == number[:, None])[:, None, :]
    outside = (number >= number[:, None])[:, None, :]
    # from the outer radius of the one ring to that of the other, in s**2; 0 where that lies inside
    distance = _square_difference(
        outer_logits[:, None], np.maximum(outer_logits, outer_logits[:, None])
    )
    # sqrt(s**2 - t**2) at the outer and at the inner radius of the ring that is integrated
    outer_root = np.sqrt(distance[:, None, :] + to_outer[:, :, None])
    no_root = np.zeros((count, PANEL_SAMPLES, 1))
    inner_root = np.where(same, 0.0, np.concatenate([no_root, outer_root[:, :, :-1]], 2))
    # where the integral begins, and how long it is
    start = np.where(same, t[:, :, None], np.where(outside, radius[:-1], 1.0))
    length = np.where(same, (to_outer / (radius[1:, None] + t))[:, :, None], thickness)
    square_length = np.where(same, to_outer[:, :, None], square_width)
    of_pressure = np.where(outside, square_length / (outer_root + inner_root), 0.0)
    of_traction = np.where(outside, np.log1p((length + of_pressure) / (start + inner_root)), 0.0)
    of_pressure = (np.sqrt(dt)[:, :, None] * of_pressure).reshape(-1, count)
    of_traction = ((t * np.sqrt(dt))[:, :, None] * of_traction).reshape(-1, count)
    coupling = np.tril(np.outer(thickness, square_width / 2.0), -1)
    coupling[number, number] = thickness**2 * (radius[1:] + 2.0 * radius[:-1]) / 6
    return RingOperators(
        logits,
        square_width / 2.0,
        of_pressure.T @ of_pressure / pi,
        of_traction.T @ of_traction / pi,
        coupling,
    )
