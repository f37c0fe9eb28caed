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
from spectral_contact.spectral.jacobi import gauss_rule
from spectral_contact.spectral.panels import PANEL_SAMPLES

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class RingOperators:
    """Operators tested with every ring, in the measure ``s ds``.

    Attributes
    ----------
    logits : ndarray, shape (rings + 1,)
        ``ln(s**2/(1 - s**2))`` of the boundaries of rings, outward: from minus infinity, the
        centre, to infinity, the edge.
    mass : ndarray, shape (rings,)
        ``int s ds`` of each.
    normal, tangential : ndarray, shape (rings, rings)
        ``<phi_i, N phi_j>`` and ``<phi_i, T phi_j>``.
    carried : ndarray, shape (rings, rings)
        ``<phi_i, g[phi_j]>`` with ``g = (1/s) int_0^s eta p deta``; lower triangular.
    """

    logits: Array
    mass: Array
    normal: Array
    tangential: Array
    carried: Array

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
    """Return the operators of a grid (cached)."""
    return _assembled(logits.tobytes())


def _square_difference(lower: Array, upper: Array) -> Array:
    """Return the difference of the squares of two radii with these logits, to full accuracy."""
    with np.errstate(invalid="ignore"):  # both at the edge: the difference is 0
        relative = -np.expm1(np.where(lower == upper, 0.0, lower - upper))
    return np.asarray(relative * np.exp(-np.logaddexp(0.0, lower) - np.logaddexp(0.0, -upper)))


@bounded_cache("rings", 8)  # the first ones, and some that were refined
def _assembled(grid: bytes) -> RingOperators:
    """Return the operators: F and G of every ring at Gauss points of every ring.

    The half-integrals have square roots at the ends of rings, which ``t**2 = a**2 + w sin(phi)**2``
    takes away; radii outside of t are measured from t, so that nothing cancels.
    """
    logits = np.frombuffer(grid)
    a = logits[:-1]
    b = logits[1:]
    width = _square_difference(a, b)
    radius = np.exp(-np.logaddexp(0.0, -logits) / 2.0)
    thick = width / (radius[1:] + radius[:-1])
    x, weight = gauss_rule(PANEL_SAMPLES)
    phi = pi / 4 * (1.0 + x)
    t = np.sqrt(radius[:-1, None] ** 2 + width[:, None] * np.sin(phi) ** 2)
    # b**2 - t**2
    to_outer = width[:, None] * np.cos(phi) ** 2
    dt = weight * pi / 4 * width[:, None] * np.sin(phi) * np.cos(phi) / t

    n = len(width)
    places = np.arange(n)
    same = (places == places[:, None])[:, None, :]
    outside = (places >= places[:, None])[:, None, :]
    # from the outer radius of ring i to that of ring j, in s**2; 0 where ring j lies inside
    distance = _square_difference(b[:, None], np.maximum(b, b[:, None]))
    outer = np.sqrt(distance[:, None, :] + to_outer[:, :, None])
    inner = np.where(
        same, 0.0, np.concatenate([np.zeros((n, PANEL_SAMPLES, 1)), outer[:, :, :-1]], 2)
    )
    start = np.where(same, t[:, :, None], np.where(outside, radius[:-1], 1.0))
    length = np.where(same, (to_outer / (radius[1:, None] + t))[:, :, None], thick)
    f = np.where(outside, np.where(same, to_outer[:, :, None], width) / (outer + inner), 0.0)
    g = np.where(outside, np.log1p((length + f) / (start + inner)), 0.0)
    f = (np.sqrt(dt)[:, :, None] * f).reshape(-1, n)
    g = ((t * np.sqrt(dt))[:, :, None] * g).reshape(-1, n)
    carried = np.tril(np.outer(thick, width / 2.0), -1)
    carried[places, places] = thick**2 * (radius[1:] + 2.0 * radius[:-1]) / 6
    return RingOperators(logits, width / 2.0, f.T @ f / pi, g.T @ g / pi, carried)
