r"""Moments of functions on panels: the coupling of pressure and traction.

s is the radius over that of the contact, and ``y = 1 - s**2``. Over kappa the traction q enters the
normal equation with ``int_s^1 q deta``, and the pressure p enters the tangential one with ``g[p] =
(1/s) int_0^s eta p deta`` (docs/coupling). With functions phi for a pressure and psi for a shear
q/s the Galerkin entries of both, in the measure ``s ds``, are

    <phi, int_s^1 eta psi deta> = <s psi, g[phi]> = 1/4 int_0^1 phi(y) int_0^y psi(y') dy' dy.

There is no kernel, and functions on different panels couple by the product of their moments.
In a part of several, y is replaced by the distance d from the boundary that the part is graded to,
in extents of the part.
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
    """Return ``int_0^1 psi density(d) dd`` of all functions psi of a part, shape (size,).

    With the fitting density these are loads and shears.
    """
    rule = moments_on(panels, (panels.degree,) * panels.count)
    # the rule is one of z / 2
    return np.asarray(2.0 * rule.with_densities(density(rule.d)[None])[0])


@bounded_cache("moments")
def moments(panels: LogPanels) -> Array:
    """Return ``int_0^1 psi dd`` of all functions, shape (size,) (cached)."""
    return load_vector(panels, np.ones_like)


@bounded_cache("outer moments")
def outer_moments(panels: LogPanels, psi_panels: LogPanels, sign: int) -> Array:
    """Return ``int phi int psi``, the integral of psi over larger radii than that of phi (cached).

    Parameters
    ----------
    panels, psi_panels : LogPanels
        The panels of phi and of psi: the same but for the endpoint weight.
    sign : int
        -1 if the part is graded to its outer end, so that the radius grows as d falls; else +1.

    Returns
    -------
    ndarray, shape (size, size)
        Row i for phi_i and column j for psi_j.
    """
    nested = _nested_moments(panels, psi_panels)
    return nested if sign < 0 else np.outer(moments(panels), moments(psi_panels)) - nested


def _nested_moments(panels: LogPanels, psi_panels: LogPanels) -> Array:
    """Return ``int_0^1 phi(d) int_0^d psi(d') dd' dd``, shape (size, size)."""
    terms = panels.degree + 1
    h = panels.width
    # Where the panel of psi is nearer the boundary than that of phi, the entry is the product of
    # the moments. Where it is farther off, the entry is 0.
    matrix = np.outer(moments(panels), moments(psi_panels))
    g, w = gauss_rule(panels.degree + EXTRA)
    x = h * (1.0 + g) / 2.0
    weights = w * h / 2.0
    basis = legendre_values(g, panels.degree)
    # on one panel, in x = -ln d: the inner integral is one from x to the end h of the panel
    rest = h - x
    inner_x = x[:, None] + rest[:, None] * (1.0 + g) / 2.0
    inner_weights = np.exp(-(1.0 + psi_panels.power) * inner_x) * w * rest[:, None] / 2.0
    inner_integrals = np.einsum(
        "iq,iqk->ik", inner_weights, legendre_values(2.0 * inner_x / h - 1.0, panels.degree)
    )
    outer_weights = weights * np.exp(-(1.0 + panels.power) * x)
    diagonal_block = (basis * outer_weights[:, None]).T @ inner_integrals
    # on panel j all distances are exp(-h j) times those on the first panel
    decay = np.exp(-(2.0 + panels.power + psi_panels.power) * h * np.arange(panels.count))
    for j in range(panels.count):
        rows = slice(j * terms, (j + 1) * terms)
        matrix[rows, : j * terms] = 0.0
        matrix[rows, rows] = decay[j] * diagonal_block
    tail = slice(panels.count * terms, None)
    matrix[tail, : tail.start] = 0.0
    d, weights, tail_basis = panels.tail_rule()
    # The inner integral over (0, d) is by the rule of the tail, shrunk from (0, end) by d / end.
    inner_d = d[:, None] * (d / panels.end)
    shrinkage = np.sqrt(d / panels.end)[:, None] ** 2
    inner_weights = weights * shrinkage * inner_d**psi_panels.power
    psi = tail_values(inner_d, psi_panels.end, psi_panels.tail_terms, psi_panels.root_tail)
    inner_integrals = np.einsum("iq,iqk->ik", inner_weights, psi)
    outer_weights = weights * d**panels.power
    matrix[tail, tail] = (tail_basis * outer_weights[:, None]).T @ inner_integrals
    return matrix
