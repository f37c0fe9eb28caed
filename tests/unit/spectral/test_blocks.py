"""Abel integrals as their value at a boundary and a difference to it."""

from itertools import product

import numpy as np
import pytest
from oracles.mesh_integrals import half_integral, inner_integral, sources

from spectral_contact.fields.series import EDGE, Radius
from spectral_contact.spectral.blocks import block
from spectral_contact.spectral.graded import graded_nodes
from spectral_contact.spectral.panels import LogPanels
from spectral_contact.spectral.parts import GradedMesh, z_difference

FIRST, SECOND = Radius.from_logit(-1.0), Radius.from_logit(8.0)
COUNT, DEGREE = 14, 16
USED, WHOLE = (12,) * COUNT, (DEGREE,) * COUNT


def meshes(power=0.0):
    """Return the halves of a disk and two annuli to the edge, the last with an endpoint weight."""
    panels = LogPanels(COUNT, 2.0, DEGREE)
    wide, narrow = z_difference(FIRST, SECOND) / 2.0, z_difference(SECOND, EDGE) / 2.0
    return [
        GradedMesh(FIRST, -1, FIRST.square, panels),
        GradedMesh(FIRST, 1, wide, panels),
        GradedMesh(SECOND, -1, wide, panels),
        GradedMesh(SECOND, 1, narrow, panels),
        GradedMesh(EDGE, -1, narrow, LogPanels(COUNT, 2.0, DEGREE, power)),
    ]


def at_nodes(integrals, nodes):
    """Return both kinds of integrals at the nodes, whole, and as a value and a difference."""
    identity = integrals.reduce(np.eye(len(integrals.boundary_value)))
    whole, more = integrals.value @ identity, integrals.increment @ identity
    if integrals.sampled:
        whole, more = nodes.interpolate(whole), nodes.interpolate(more)
    return whole, integrals.scale * integrals.boundary_value, more


def scale(matrix):
    """Return the largest entry of every panel, for each of its functions."""
    largest = np.abs(matrix).max(axis=0)
    panels = largest[: COUNT * (DEGREE + 1)].reshape(COUNT, -1).max(axis=1)
    rest = largest[COUNT * (DEGREE + 1) :]
    return np.concatenate([np.repeat(panels, DEGREE + 1), np.full(len(rest), rest.max())])


@pytest.mark.parametrize("power", [0.0, -0.5])
@pytest.mark.parametrize(("i", "k"), list(product(range(5), range(5))))
def test_they_are_the_integrals_of_the_meshes(i, k, power):
    nodes, mesh = meshes(power)[i], meshes(power)[k]
    rule = graded_nodes(nodes.panels, USED)
    points = nodes.points(rule.d)
    # next to the far end all is as near to it as the last digit of d says
    allowed = (1e-13 + 2e-16 / np.sqrt(rule.rest))[:, None]
    for side, reference in ((1, half_integral), (-1, inner_integral)):
        integrals = block(mesh, WHOLE, nodes, USED, side)
        known = reference(mesh, points)
        if integrals is None:
            assert not known.any()
            continue
        whole, at, more = at_nodes(integrals, rule)
        assert (np.abs(whole - known) <= allowed * scale(known)).all()
        assert (np.abs(at + more - known) <= allowed * scale(known)).all()


@pytest.mark.parametrize(("i", "k"), [(0, 2), (1, 4), (2, 0), (3, 1), (1, 2), (2, 1), (2, 4)])
def test_differences_keep_their_digits_next_to_the_boundary(i, k):
    nodes, mesh = meshes()[i], meshes()[k]
    rule = graded_nodes(nodes.panels, USED)
    outside = k > i
    integrals = block(mesh, WHOLE, nodes, USED, 1 if outside else -1)
    _, _, more = at_nodes(integrals, rule)
    # of a point source, from the sum and not from the difference
    d = rule.d[rule.d < 1e-6]
    z = nodes.sign * nodes.extent * d
    points, matrix = sources(mesh)
    apart = np.abs(points.before(nodes.boundary))[None]
    moved = apart - z[:, None] if outside else apart + z[:, None]
    closer = z[:, None] if outside else -z[:, None]
    kernel = closer / (np.sqrt(apart * moved) * (np.sqrt(apart) + np.sqrt(moved)))
    known = kernel @ matrix
    assert (np.abs(more[rule.d < 1e-6] - known) <= 1e-12 * scale(known)).all()
