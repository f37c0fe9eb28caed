"""Spaces in parts: their matrices from blocks, against every half-integral at every node."""

import numpy as np
import pytest
from oracles.mesh_integrals import half_integral

from spectral_contact.fields.series import Radius
from spectral_contact.spectral.panels import LogPanels
from spectral_contact.spectral.parts import DiskPartition, GradedMesh
from spectral_contact.spectral.spaces import Space

PANELS, DEGREES = LogPanels(6, 2.0, 8), (8, 6, 5, 4, 3, 2)


def space_of(breaks, pointed):
    """Return a space, and its half-integrals at its nodes without any block that is kept."""
    parts = DiskPartition(tuple(Radius(b, 1.0 - b) for b in breaks), pointed)
    space = Space(parts, ((PANELS, DEGREES),) * len(parts.ends))
    meshes = [GradedMesh(*end, PANELS) for end in parts.ends]
    rows = []
    for target, nodes in zip(meshes, space._nodes, strict=True):
        points = target.points(nodes.d)
        rows.append(np.hstack([half_integral(one, points) for one in meshes]))
    return space, np.vstack(rows)[:, space.index]


@pytest.mark.parametrize(
    ("breaks", "pointed"), [((0.4,), False), ((), True), ((0.3, 0.7), True), ((0.9,), False)]
)
def test_matrices_are_those_of_the_half_integrals(breaks, pointed):
    space, matrix = space_of(breaks, pointed)
    weighted = matrix * (space.weights / np.pi)[:, None]
    wanted = matrix.T @ weighted
    scale = 1.0 / np.sqrt(wanted.diagonal())
    assert np.abs((space.gram - wanted) * np.outer(scale, scale)).max() < 1e-13
    densities = np.array([np.cos(space.t), space.t**2])
    off = space.moments(densities) - densities @ weighted
    assert np.abs(off * scale).max() < 1e-14
    assert space.moments(densities[0]) == pytest.approx(space.moments(densities)[0], rel=1e-12)
    coefficients = np.zeros(space.size)
    coefficients[space.index] = np.random.default_rng(1).standard_normal(space.unknowns)
    found, whole = space.half_integral(coefficients), matrix @ coefficients[space.index]
    # node by node it is ill-conditioned: the first lies 2e-6 of a reach from where roots begin
    assert space.weights @ (found - whole) ** 2 < (1e-14) ** 2 * (space.weights @ whole**2)


def test_coarser_spaces_come_first_and_masses_are_of_their_parts():
    space, _ = space_of((0.4,), False)
    assert space.coarsest_unknowns < space.coarse_unknowns < space.unknowns
    # two degrees of every panel are shed, and of every tail one function
    assert space.unknowns - space.coarse_unknowns == 3 * (len(DEGREES) + 1)
    extents = np.bincount(space.panel, minlength=space.panels)
    assert extents.sum() == space.unknowns
    # the constants of all panels and tails add up to 1, whose mass is the half of the disk
    own = PANELS.functions(DEGREES)
    constants = np.zeros(PANELS.size)
    constants[: PANELS.count * 9 : 9] = constants[PANELS.count * 9] = 1.0
    assert constants[own].sum() == PANELS.count + 1
    ones = np.tile(constants, 3)[space.index]
    assert ones @ space.mass @ ones == pytest.approx(0.5, rel=1e-13)
