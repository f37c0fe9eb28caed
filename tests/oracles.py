"""Independent oracles: the equations evaluated with the elliptic kernels, no Abel factorisation.

They share with the solver nothing but the fields they are given to check.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np
from scipy import special


def tanh_sinh(
    function: Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray], width: float
) -> float:
    """Integrate ``function(x, from_left, from_right)`` over (0, width), singular ends allowed."""
    t = np.arange(-5.6, 5.6001, 1 / 32)
    u = np.pi / 2 * np.sinh(t)
    left = 1 / (1 + np.exp(-2 * np.clip(u, -340, 340)))
    right = 1 / (1 + np.exp(2 * np.clip(u, -340, 340)))
    weight = np.pi * np.cosh(t) * left * right / 32
    value = function(width * left, width * left, width * right)
    return width * float(np.sum(weight * value))


def _k1(eta, s, gap):
    hi = np.maximum(eta, s)
    return eta / hi * special.ellipkm1(np.clip(gap * (eta + s) / hi**2, 1e-300, 1))


def _k2(eta, s, gap):
    hi, lo = np.maximum(eta, s), np.minimum(eta, s)
    return (
        eta
        * lo
        / (3 * hi**2)
        * special.elliprd(0.0, np.clip(gap * (eta + s) / hi**2, 1e-300, 1), 1.0)
    )


def potential(
    field: Callable[..., np.ndarray],
    kernel: Callable[..., np.ndarray],
    from_edge: float,
    breaks: tuple[float, ...] = (),
) -> float:
    """Return ``(1/pi) int_0^1 field K(eta, s) deta`` at ``s = 1 - from_edge``.

    `breaks` are the distances from the edge at which the field is not smooth.
    """
    points = sorted({0.0, 1.0, from_edge, *breaks})
    # geometric cuts toward the edge and the field point keep the layers resolved
    total = 0.0
    for near, far in pairwise(points):

        def integrand(_, left, right, near=near, far=far):
            d = np.where(left < right, near + left, far - right)
            gap = np.abs(d - from_edge)
            if near == from_edge:
                gap = left
            elif far == from_edge:
                gap = right
            eta = 1 - d
            if far == 1.0:
                eta = np.where(right < left, right, eta)
            return field(from_edge=np.clip(d, 0, 1)) * kernel(eta, 1 - from_edge, gap)

        total += tanh_sinh(integrand, far - near)
    return total / np.pi


def normal_residual(solution, from_edge: float, breaks: tuple[float, ...] = ()) -> float:
    """Return ``(alpha p + N p)/delta - 1`` by the elliptic kernel, equation (3.5)."""
    value = potential(solution.pressure, _k1, from_edge, breaks)
    alpha = solution.scene.normal_compliance
    if alpha > 0:
        value += alpha * solution.pressure(from_edge=from_edge)
    return value / solution.approach - 1


def displacement(solution, from_edge: float, breaks: tuple[float, ...] = ()) -> tuple[float, float]:
    """Return ``beta q + T q - kappa g`` by the elliptic kernel, and the size of ``kappa g``."""
    s = 1 - from_edge

    def inner(_, left, right):
        return (
            left * solution.pressure(left) if s < 1 else left * solution.pressure(from_edge=right)
        )

    load = tanh_sinh(inner, s)
    zones = solution.zones
    edges = [z.outer_from_edge for z in zones if 0 < z.outer_from_edge < 1]
    value = potential(solution.traction, _k2, from_edge, tuple(edges) + breaks)
    beta = solution.scene.tangential_compliance
    if beta > 0:
        value += beta * solution.traction(from_edge=from_edge)
    drive = solution.scene.kappa * load / s
    return value - drive, drive
