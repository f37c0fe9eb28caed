import dataclasses

import numpy as np
import pytest
from mpmath.ctx_mp import MPContext
from numpy.testing import assert_allclose, assert_array_equal
from scipy import special

from spectral_contact.spectral.jacobi import ROOT_TERMS, TAIL_TERMS
from spectral_contact.spectral.panels import LogPanels

mp = MPContext()
mp.dps = 30

MESHES = pytest.mark.parametrize(
    "panels",
    [LogPanels(6, 2.0, 12), LogPanels(1, 1.0, 4), LogPanels(30, 2.0, 8), LogPanels(3, 1.0, 20)],
    ids=str,
)


def test_sizes():
    panels = LogPanels(5, 2.0, 7)
    assert_allclose(panels.end, np.exp(-10.0), rtol=1e-15)
    assert panels.tail_terms == TAIL_TERMS
    assert panels.size == 5 * 8 + TAIL_TERMS
    rooted = LogPanels(5, 2.0, 7, root_tail=True)
    assert rooted.tail_terms == ROOT_TERMS
    assert rooted.size == 5 * 8 + ROOT_TERMS


def test_panels_are_keys():
    # the operators are cached by their panels
    assert LogPanels(5, 2.0, 7) == LogPanels(5, 2.0, 7, 0.0, False)
    assert hash(LogPanels(5, 2.0, 7)) == hash(LogPanels(5, 2.0, 7, 0.0, False))
    different = {LogPanels(5, 2.0, 7, power, root) for power in (0.0, -0.5) for root in (0, 1)}
    assert len(different) == 4
    with pytest.raises(dataclasses.FrozenInstanceError):
        LogPanels(5, 2.0, 7).width = 1.0


# --- sampling -------------------------------------------------------------------------------------


@MESHES
def test_sampling_points_lie_in_their_panels(panels):
    x = panels.sampling()
    assert x.shape == (panels.panels, max(panels.degree + 5, 18))
    assert_array_equal(np.floor(x / panels.width), np.arange(panels.panels)[:, None] + 0 * x)
    assert np.all(np.diff(x, axis=1) > 0)
    d = panels.tail_sampling()
    assert len(d) > panels.tail_terms
    assert np.all((d > 0) & (d < panels.end))


@MESHES
@pytest.mark.parametrize("rate", [0.5, 1.0, 2.0])
def test_half_line_nodes_integrate_over_x(panels, rate):
    x, weights = panels.half_line_nodes()
    assert x.shape == weights.shape
    exact = -np.expm1(-rate * panels.panels * panels.width) / rate
    assert_allclose(np.sum(weights * np.exp(-rate * x)), exact, rtol=4e-15)


# --- Galerkin nodes in t --------------------------------------------------------------------------


@MESHES
def test_nodes_know_both_distances_and_those_to_the_ends(panels):
    nodes, (_, first), (_, other) = panels.nodes()
    assert_allclose(nodes.d + nodes.rest, 1.0, rtol=3e-16)
    assert np.all((nodes.rest > 0) & (nodes.d > 0) & (nodes.weights > 0))
    to_end = np.concatenate([first, *([other] * (panels.panels - 1))])
    number = np.repeat(np.arange(panels.panels), [len(first), *[len(other)] * (panels.panels - 1)])
    x = -np.log(nodes.d[: len(to_end)])
    assert_allclose(x + to_end, (number + 1) * panels.width, rtol=1e-15)
    assert np.all((to_end > 0) & (to_end < panels.width))
    assert np.all(nodes.d[len(to_end) :] < panels.end)
    central = nodes.rest[: len(first)]
    assert_allclose(central, -np.expm1(first - panels.width), rtol=3e-16 / central.min())


@MESHES
@pytest.mark.parametrize("m", [0, 1, 3])
def test_nodes_integrate_odd_powers_of_t(panels, m):
    # the shear force has one, so the centre must not be taken for a point of symmetry
    nodes, *_ = panels.nodes()
    assert_allclose(nodes.weights @ np.sqrt(nodes.rest) ** m, 1 / (m + 1), rtol=2e-15)


@MESHES
@pytest.mark.parametrize("m", [0, 1, 2, 3, 0.5, 1.5])
def test_nodes_integrate_over_t(panels, m):
    # int_0^1 (1 - t^2)^m dt, the square root at the edge included
    nodes, *_ = panels.nodes()
    exact = special.beta(m + 1, 0.5) / 2
    assert_allclose(nodes.weights @ nodes.d**m, exact, rtol=2e-15)
    exact = special.beta(m + 1, 1.5) / 2
    assert_allclose(nodes.weights @ (nodes.rest * nodes.d**m), exact, rtol=2e-15)


@MESHES
def test_nodes_integrate_products_of_roots_at_the_deep_ends(panels):
    # a half-integral is a polynomial times sqrt(distance to the deep end), plus another; squared
    nodes, (_, first), (_, other) = panels.nodes()
    h = mp.mpf(panels.width)
    for j in {0, panels.panels - 1}:
        to_end = first if j == 0 else other
        start = 0 if j == 0 else len(first) + (j - 1) * len(other)
        part = slice(start, start + len(to_end))
        for m in (1, 4 * panels.degree + 2):
            values = (to_end / panels.width) ** (m / 2)
            # in units of the panel's size, for the tolerance of mpmath is absolute
            value = nodes.weights[part] @ (values * nodes.d[part]) * np.exp(2 * j * panels.width)

            def integrand(root, j=j, m=m):  # x = j h + h root^2, which the centre needs
                x = h * root**2
                size = mp.exp(-2 * x) / mp.sqrt(-mp.expm1(-h * j - x))
                return (1 - x / h) ** (mp.mpf(m) / 2) * size * h * root

            assert_allclose(value, float(mp.quad(integrand, [0, 1])), rtol=1e-14)


# --- Gram matrix of the polynomials ---------------------------------------------------------------


@MESHES
@pytest.mark.parametrize("decay", [0.0, 1.0, 2.0])
def test_panel_gram(panels, decay):
    gram = panels.panel_gram(decay)
    n = panels.degree
    assert gram.shape == (n + 1, n + 1)
    assert_allclose(gram, gram.T, atol=2e-16)
    h = mp.mpf(panels.width)
    for i, k in ((0, 0), (0, n), (1, n - 1), (n, n)):
        exact = mp.quad(
            lambda u, i=i, k=k: (
                h * mp.legendre(i, 2 * u - 1) * mp.legendre(k, 2 * u - 1) * mp.exp(-decay * h * u)
            ),
            mp.linspace(0, 1, 5),
        )
        assert abs(gram[i, k] - float(exact)) < 4e-15 * np.sqrt(gram[i, i] * gram[k, k])
