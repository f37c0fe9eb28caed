r"""Moments of functions on panels: what couples pressure and traction.

With ``p`` and ``q = s u`` the tractions change each other's displacement by

    <phi, int_s^1 q deta> = <s psi, g[p]> = 1/4 int_0^1 phi(y) int_0^y psi(y') dy' dy

in the measure ``s ds`` and in ``y = 1 - s**2``: no kernel is left, and what lies on different
panels couples by the product of its moments. Moments with a density are loads and shears.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from spectral_contact.spectral.abel import moments_on
from spectral_contact.spectral.cache import bounded_cache
from spectral_contact.spectral.jacobi import gauss_rule, legendre_values, tail_values
from spectral_contact.spectral.panels import LogPanels
from spectral_contact.spectral.tuning import EXTRA

Array = NDArray[np.float64]


def load_vector(panels: LogPanels, density: Callable[[Array], Array]) -> Array:
    """Return ``int basis * density(d) dd`` over (0, 1)."""
    on_all = moments_on(panels, (panels.degree,) * panels.panels)
    return np.asarray(2.0 * on_all.with_densities(density(on_all.d)[None])[0])


@bounded_cache("moments")
def moments(panels: LogPanels) -> Array:
    """Return ``int_0^1 psi dy`` of all functions, shape (size,) (cached)."""
    return load_vector(panels, np.ones_like)


@bounded_cache("outer moments")
def outer_moments(panels: LogPanels, other: LogPanels, sign: int) -> Array:
    """Return ``int phi int psi`` over what of psi lies outside of phi, on a part of unit extent.

    The panels of phi and of psi are the same but for the endpoint weight (cached).
    """
    nested = _nested_moments(panels, other)
    return nested if sign < 0 else np.outer(moments(panels), moments(other)) - nested


def _nested_moments(panels: LogPanels, inner: LogPanels) -> Array:
    """Return ``int_0^1 phi(y) int_0^y psi(y') dy' dy``, shape (size, size)."""
    terms = panels.degree + 1
    h = panels.width
    # psi on a panel nearer the boundary counts in full, on one farther from it not at all
    matrix = np.outer(moments(panels), moments(inner))
    g, w = gauss_rule(panels.degree + EXTRA)
    x = h * (1.0 + g) / 2.0
    weights = w * h / 2.0
    basis = legendre_values(g, panels.degree)
    rest = h - x
    inner_x = x[:, None] + rest[:, None] * (1.0 + g) / 2.0
    values = np.exp(-(1.0 + inner.power) * inner_x) * w * rest[:, None] / 2.0
    within = np.einsum(
        "iq,iqk->ik", values, legendre_values(2.0 * inner_x / h - 1.0, panels.degree)
    )
    diagonal_block = (basis * (weights * np.exp(-(1.0 + panels.power) * x))[:, None]).T @ within
    decay = np.exp(-(2.0 + panels.power + inner.power) * h * np.arange(panels.panels))
    for j in range(panels.panels):
        rows = slice(j * terms, (j + 1) * terms)
        matrix[rows, : j * terms] = 0.0
        matrix[rows, rows] = decay[j] * diagonal_block
    tail = panels.panels * terms
    matrix[tail:, :tail] = 0.0
    d, weights, basis = panels.tail_rule()
    v = np.sqrt(d / panels.end)
    inner_d = d[:, None] * (d / panels.end)
    # dd' = end v**2 2 v' dv', with d' = end v**2 v'**2
    values = weights * v[:, None] ** 2 * inner_d**inner.power
    tails = tail_values(inner_d, inner.end, inner.tail_terms, inner.root_tail)
    within = np.einsum("iq,iqk->ik", values, tails)
    matrix[tail:, tail:] = (basis * (weights * d**panels.power)[:, None]).T @ within
    return matrix
