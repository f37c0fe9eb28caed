"""The coupled system of a stick disk and slip around it: nodes, charges, matrix, factors."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from spectral_contact.contact.coupled_spaces import first_spaces
from spectral_contact.fields import Radius
from spectral_contact.spectral.abel import beyond, fall, far_fall
from spectral_contact.spectral.graded import GradedNodes
from spectral_contact.spectral.panels import LogPanels
from spectral_contact.spectral.parameters import Parameters
from spectral_contact.spectral.sliding import SlidingDisk
from spectral_contact.spectral.sliding_factor import SlidingFactored, assembled

PANELS, DEGREES = LogPanels(4, 2.0, 12), (9, 7, 4, 2)
KAPPA, FRICTION = 0.2, 0.1


def sliding(alpha, beta, tolerance=1e-6):
    radius = Radius.from_logit(-1.0)
    spaces = first_spaces(alpha, beta, radius, tolerance)
    panels, degrees = zip(*((one.panels, one.degrees) for one in spaces), strict=True)
    return SlidingDisk(radius, panels, degrees, (alpha == 0.0, beta == 0.0))


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
        whole, few = (np.array(function(d, *form, one)) for one in (PANELS.degree, DEGREES))
        assert_allclose(few, whole[..., used], rtol=1e-11, atol=1e-17)
    plain = fall(d, *form, DEGREES)[0]
    whole = beyond(d, *form, PANELS.degree)[:, used]
    # Both sum terms of order one, and BLAS libraries differ in the order of a sum.
    assert_allclose(plain, whole, rtol=1e-11, atol=2.0 * np.finfo(float).eps)


@pytest.mark.parametrize(("alpha", "beta"), [(0.5, 0.5), (1e-3, 1e-5), (0.5, 0.0), (0.0, 0.0)])
def test_the_matrix_is_that_of_the_residual(alpha, beta):
    disk = sliding(alpha, beta)
    parameters = Parameters(alpha, beta, KAPPA, FRICTION)
    matrix, scale = assembled(disk, parameters, np.float64)
    nothing = np.zeros(disk.unknowns)
    residual = disk.residual(np.diag(scale), parameters, nothing, nothing) * scale[:, None]
    assert np.abs(matrix + residual).max() < 1e-8
    single, _ = assembled(disk, parameters, np.float32)
    assert single.dtype == np.float32
    assert np.abs(single - matrix).max() < 1e-5 * np.abs(matrix).max()


@pytest.mark.parametrize("exact", [False, True])
def test_corrections_converge_and_the_top_degrees_are_what_changes(exact):
    disk = sliding(0.5, 0.2)
    factored = SlidingFactored(disk, Parameters(0.5, 0.2, KAPPA, FRICTION), exact=exact)
    values = factored.start()
    for _ in range(3):
        change = factored.correction(values)
        values = values + change
    assert np.abs(change).max() < 1e-12 * np.abs(values).max()
    # without the top degrees the solution is the one in the space without them
    columns = np.eye(2)
    for shed, changed in zip(disk.shed, factored.change(values), strict=True):
        less = values - changed
        assert np.abs(less[shed]).max() < 1e-10 * np.abs(values).max()
        kept = np.setdiff1d(np.arange(disk.unknowns), shed)
        missed = disk.residual(less, factored.parameters, columns[0], columns[1])
        missed, weight = missed * factored.scale[:, None], values / factored.scale[:, None]
        assert np.abs(missed[kept]).max() < 1e-10 * np.abs(weight).max()
