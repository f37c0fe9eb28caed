"""Operators on rings: pressure p and traction q are constant on each of them.

Symbols are those of docs/theory: ``s`` the radius over that of the contact, N and T the normal and
the tangential operator of the half-space, g the radial displacement by the pressure over kappa, F
and G the half-integrals ``int_t^1 p s ds / sqrt(s**2 - t**2)`` and ``int_t^1 q ds / sqrt(s**2 -
t**2)``. The functions phi_i are 1 on ring i and 0 elsewhere.

The method is Galerkin's, through Abel's factorisation: the matrices of N and T are Gram matrices of
F and G, symmetric and positive definite, and the matrix of the normal displacement by q is the
transpose of that of g. So the discrete system has an energy, as the continuous one has.
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
        ``int s ds`` over each ring: the diagonal of the mass matrix.
    normal, tangential : ndarray, shape (rings, rings)
        ``<phi_i, N phi_j>`` and ``<phi_i, T phi_j>``.
    coupling : ndarray, shape (rings, rings)
        ``<phi_i, g[phi_j]>`` with ``g = (1/s) int_0^s eta p deta``; lower triangular.
    """

    logits: Array
    mass: Array
    normal: Array
    tangential: Array
    coupling: Array

    @property
    def middles(self) -> Array:
        """Logits of the middle of each ring: where ``s**2`` is the mean of its two ends."""
        inside = np.exp(-np.logaddexp(0.0, -self.logits))
        outside = np.exp(-np.logaddexp(0.0, self.logits))
        return np.asarray(np.log((inside[1:] + inside[:-1]) / (outside[1:] + outside[:-1])))


def graded_rings(
    count: int, exponent: float, max_width: float, centre_logit: float, edge_logit: float
) -> Array:
    """Return the logits of boundaries of rings that grow finer towards the edge, (rings + 1,).

    The boundaries of a graded grid have the distances ``(k/count)**exponent`` from the edge. Next
    to the centre and to the edge its rings are wider in the logit than `max_width`; there rings of
    equal widths in the logit take their place, down to `centre_logit` and up to `edge_logit`. The
    first ring and the last one reach from there to the centre and to the edge.
    """
    from_edge = (np.arange(count - 1, 0, -1) / count) ** exponent
    graded = 2.0 * np.log1p(-from_edge) - np.log(from_edge * (2.0 - from_edge))
    narrow_rings = np.flatnonzero(np.diff(graded) <= max_width)
    graded = graded[narrow_rings[0] : narrow_rings[-1] + 2]
    to_centre, to_edge = (
        start
        + (stop - start) * np.linspace(0, 1, int(np.ceil(abs(stop - start) / max_width)) + 1)[1:]
        for start, stop in ((graded[0], centre_logit), (graded[-1], edge_logit))
    )
    return np.concatenate([[-np.inf], to_centre[::-1], graded, to_edge, [np.inf]])


def ring_operators(logits: Array) -> RingOperators:
    """Return the matrices of a grid, for the logits of the boundaries of its rings (cached)."""
    return _assembled(logits.tobytes())


def _square_difference(lower: Array, upper: Array) -> Array:
    """Return the difference of the squares of two radii with these logits, to full accuracy."""
    with np.errstate(invalid="ignore"):  # at the edge both logits are infinite, and equal
        relative = -np.expm1(np.where(lower == upper, 0.0, lower - upper))
    return np.asarray(relative * np.exp(-np.logaddexp(0.0, lower) - np.logaddexp(0.0, -upper)))


@bounded_cache("rings", 8)  # the first grid, and some refined ones
def _assembled(grid: bytes) -> RingOperators:
    """Return the operators of the grid whose logits have these bytes.

    They are sums over Gauss points t of the half-integrals F and G of every ring. These have square
    roots at the ends of a ring from a to b, which the substitution ``t**2 = a**2 + (b**2 - a**2)
    sin(angle)**2`` removes. With ``u = sqrt(s**2 - t**2)`` F of a ring is the difference of u at
    its two ends, and G that of ``ln(s + u)``. Both are taken without cancellation, from distances
    in ``s**2`` from t.
    """
    logits = np.frombuffer(grid)
    outer_logit = logits[1:]
    width = _square_difference(logits[:-1], outer_logit)
    radius = np.exp(-np.logaddexp(0.0, -logits) / 2.0)
    thickness = width / (radius[1:] + radius[:-1])
    x, weight = gauss_rule(PANEL_SAMPLES)
    angle = pi / 4 * (1.0 + x)
    t = np.sqrt(radius[:-1, None] ** 2 + width[:, None] * np.sin(angle) ** 2)
    # b**2 - t**2 in the ring of t
    to_outer = width[:, None] * np.cos(angle) ** 2
    dt = weight * pi / 4 * width[:, None] * np.sin(angle) * np.cos(angle) / t

    # The axes of what follows are: ring i of the points t, number of the point in it, ring j of
    # phi_j. The half-integral at t is one over the part of ring j outside t.
    count = len(width)
    rings = np.arange(count)
    same = (rings == rings[:, None])[:, None, :]
    outside = (rings >= rings[:, None])[:, None, :]
    # from the outer radius of ring i to that of ring j, in s**2; 0 where ring j lies inside
    distance = _square_difference(
        outer_logit[:, None], np.maximum(outer_logit, outer_logit[:, None])
    )
    u_outer = np.sqrt(distance[:, None, :] + to_outer[:, :, None])
    u_inner = np.where(
        same, 0.0, np.concatenate([np.zeros((count, PANEL_SAMPLES, 1)), u_outer[:, :, :-1]], 2)
    )
    # where ring j lies inside t, the radius 1 stands for any number but 0: the result is not used
    inner_radius = np.where(same, t[:, :, None], np.where(outside, radius[:-1], 1.0))
    length = np.where(same, (to_outer / (radius[1:, None] + t))[:, :, None], thickness)
    extent = np.where(same, to_outer[:, :, None], width)
    f = np.where(outside, extent / (u_outer + u_inner), 0.0)
    g = np.where(outside, np.log1p((length + f) / (inner_radius + u_inner)), 0.0)
    f_rows = (np.sqrt(dt)[:, :, None] * f).reshape(-1, count)
    g_rows = ((t * np.sqrt(dt))[:, :, None] * g).reshape(-1, count)
    coupling = np.tril(np.outer(thickness, width / 2.0), -1)
    coupling[rings, rings] = thickness**2 * (radius[1:] + 2.0 * radius[:-1]) / 6
    return RingOperators(
        logits, width / 2.0, f_rows.T @ f_rows / pi, g_rows.T @ g_rows / pi, coupling
    )
