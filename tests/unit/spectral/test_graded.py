"""Nodes that follow the degrees, and charges that do."""

import numpy as np
import pytest
from mpmath.ctx_mp import MPContext
from numpy.testing import assert_allclose
from scipy import special

from spectral_contact.spectral.abel import (
    exterior_with_decrement,
    opposite_end_decrement,
)
from spectral_contact.spectral.graded import GradedNodes
from spectral_contact.spectral.panels import LogPanels

mp = MPContext()
mp.dps = 30

PANELS, DEGREES = LogPanels(4, 2.0, 12), (9, 7, 4, 2)
MESHES = pytest.mark.parametrize(
    "panels",
    [LogPanels(6, 2.0, 12), LogPanels(1, 1.0, 4), LogPanels(30, 2.0, 8), LogPanels(3, 1.0, 20)],
    ids=str,
)


def nodes_of(panels):
    """Return the nodes for every degree, and the weights of ``dt`` with ``d = 1 - t**2``."""
    nodes = GradedNodes(panels, (panels.degree,) * panels.count)
    return nodes, nodes.weights / (2.0 * np.sqrt(nodes.rest))


def ends(nodes):
    """Return the distances to the deep ends of the panels: nodes are as dense at both ends."""
    return [one[::-1] for one in nodes.from_start]


@MESHES
def test_nodes_know_both_distances_and_those_to_the_ends(panels):
    nodes, _ = nodes_of(panels)
    assert_allclose(nodes.d + nodes.rest, 1.0, rtol=3e-16)
    assert np.all((nodes.rest > 0) & (nodes.d > 0) & (nodes.weights > 0))
    assert np.all(np.diff(nodes.d) < 0)
    assert np.all(np.diff(nodes.samples) < 0)
    to_start, to_end = np.concatenate(nodes.from_start), np.concatenate(ends(nodes))
    assert_allclose(to_start + to_end, panels.width, rtol=1e-15)
    number = np.repeat(np.arange(panels.count), [len(one) for one in ends(nodes)])
    x = -np.log(nodes.d[: len(to_end)])
    assert_allclose(x + to_end, (number + 1) * panels.width, rtol=1e-15)
    assert np.all((to_end > 0) & (to_end < panels.width))
    assert np.all(nodes.d[len(to_end) :] < panels.end)
    central = nodes.rest[: len(nodes.from_start[0])]
    assert_allclose(central, -np.expm1(-nodes.from_start[0]), rtol=3e-16)


@MESHES
@pytest.mark.parametrize("m", [0, 1, 3])
def test_nodes_integrate_odd_powers_of_t(panels, m):
    # the shear force has one, so the centre must not be taken for a point of symmetry
    nodes, weights = nodes_of(panels)
    assert_allclose(weights @ np.sqrt(nodes.rest) ** m, 1 / (m + 1), rtol=2e-15)


@MESHES
@pytest.mark.parametrize("m", [0, 1, 2, 3, 0.5, 1.5])
def test_nodes_integrate_over_t(panels, m):
    # int_0^1 (1 - t^2)^m dt, the square root at the edge included
    nodes, weights = nodes_of(panels)
    exact = special.beta(m + 1, 0.5) / 2
    assert_allclose(weights @ nodes.d**m, exact, rtol=2e-15)
    exact = special.beta(m + 1, 1.5) / 2
    assert_allclose(weights @ (nodes.rest * nodes.d**m), exact, rtol=2e-15)


@MESHES
def test_nodes_integrate_products_of_roots_at_the_deep_ends(panels):
    # a half-integral is a polynomial times sqrt(distance to the deep end), plus another; squared
    nodes, weights = nodes_of(panels)
    h = mp.mpf(panels.width)
    for j in {0, panels.count - 1}:
        start = sum(len(one) for one in ends(nodes)[:j])
        part = slice(start, start + len(ends(nodes)[j]))
        for m in (1, 4 * panels.degree + 2):
            values = (ends(nodes)[j] / panels.width) ** (m / 2)
            # in units of the panel's size, for the tolerance of mpmath is absolute
            value = weights[part] @ (values * nodes.d[part]) * np.exp(2 * j * panels.width)

            def integrand(root, j=j, m=m):  # x = j h + h root^2, which the centre needs
                x = h * root**2
                size = mp.exp(-2 * x) / mp.sqrt(-mp.expm1(-h * j - x))
                return (1 - x / h) ** (mp.mpf(m) / 2) * size * h * root

            assert_allclose(value, float(mp.quad(integrand, [0, 1])), rtol=1e-14)


def test_nodes_integrate_products_with_square_roots_at_the_ends_of_a_panel():
    nodes = GradedNodes(PANELS, DEGREES)
    assert nodes.weights.sum() == pytest.approx(1.0, rel=1e-14)
    assert_allclose(nodes.rest + nodes.d, 1.0, rtol=1e-15)
    # sqrt(x (h - x)) on the second panel, over dx
    rows = slice(len(nodes.from_start[0]), len(nodes.from_start[0]) + len(nodes.from_start[1]))
    values = np.sqrt(nodes.from_start[1] * ends(nodes)[1]) / nodes.d[rows]
    assert nodes.weights[rows] @ values == pytest.approx(np.pi / 2.0, rel=1e-14)


def test_what_is_smooth_is_spread_from_samples_to_nodes():
    nodes = GradedNodes(PANELS, DEGREES)
    values, wanted = (1.0 / np.sqrt(0.02 + d)[:, None] for d in (nodes.samples, nodes.d))
    assert_allclose(nodes.interpolate(values), wanted, rtol=1e-13)
    weights = np.cos(np.arange(len(nodes.d)))[:, None]
    gathered = (nodes.interpolate_transpose(weights).T @ values).item()
    assert gathered == pytest.approx((weights.T @ nodes.interpolate(values)).item(), rel=1e-12)


def test_charges_may_have_a_degree_for_each_panel():
    d = np.array([1.0, 0.1, 1e-5])
    used = PANELS.functions(DEGREES)
    for function in (exterior_with_decrement, opposite_end_decrement):
        every = (PANELS.degree,) * PANELS.count
        whole, few = (np.array(function(d, PANELS.width, one)) for one in (every, DEGREES))
        same = whole[..., used[: few.shape[-1]]]
        assert_allclose(few, same, rtol=1e-11, atol=1e-15)  # rounding of 1
