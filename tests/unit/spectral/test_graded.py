"""Nodes that follow the degrees, and charges that do."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from spectral_contact.spectral.abel import beyond, fall, far_fall
from spectral_contact.spectral.graded import GradedNodes
from spectral_contact.spectral.panels import LogPanels

PANELS, DEGREES = LogPanels(4, 2.0, 12), (9, 7, 4, 2)


@pytest.mark.parametrize("centred", [False, True])
def test_nodes_integrate_products_with_square_roots_at_the_ends_of_a_panel(centred):
    nodes = GradedNodes(PANELS, DEGREES, centred=centred)
    assert nodes.weights.sum() == pytest.approx(1.0, rel=1e-14)
    assert_allclose(nodes.rest + nodes.d, 1.0, rtol=1e-15)
    # sqrt(x (h - x)) on the second panel, over dx
    rows = slice(len(nodes.start[0]), len(nodes.start[0]) + len(nodes.start[1]))
    values = np.sqrt(nodes.start[1] * nodes.end[1]) / nodes.d[rows]
    assert nodes.weights[rows] @ values == pytest.approx(np.pi / 2.0, rel=1e-14)


@pytest.mark.parametrize("centred", [False, True])
def test_what_is_smooth_is_spread_from_samples_to_nodes(centred):
    nodes = GradedNodes(PANELS, DEGREES, centred=centred)
    values, wanted = (1.0 / np.sqrt(0.02 + d)[:, None] for d in (nodes.samples, nodes.d))
    assert_allclose(nodes.spread(values), wanted, rtol=1e-13)
    weights = np.cos(np.arange(len(nodes.d)))[:, None]
    gathered = (nodes.gathered(weights).T @ values).item()
    assert gathered == pytest.approx((weights.T @ nodes.spread(values)).item(), rel=1e-12)


def test_charges_may_have_a_degree_for_each_panel():
    d, form = np.array([1.0, 0.1, 1e-5]), (PANELS.panels, PANELS.width)
    used = PANELS.functions(DEGREES)
    for function in (fall, far_fall):
        every = (PANELS.degree,) * PANELS.panels
        whole, few = (np.array(function(d, PANELS.width, one)) for one in (every, DEGREES))
        assert_allclose(few, whole[..., used], rtol=1e-11, atol=1e-15)  # rounding of 1
    plain = fall(d, form[1], DEGREES)[0]
    whole = beyond(d, *form, PANELS.degree)[:, used]
    # Both sum terms of order one, and BLAS libraries differ in the order of a sum.
    assert_allclose(plain, whole, rtol=1e-11, atol=2.0 * np.finfo(float).eps)
