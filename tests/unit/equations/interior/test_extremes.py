"""The largest stresses where pressure does not vanish at the edge, and the place of a tip."""

import math

import numpy as np
import pytest

from spectral_contact import Scene, profiles, solve

SPHERE = profiles.Parabola(1.0)


def adhesive(nu, alpha, profile=SPHERE):
    scene = Scene(nu, alpha, profile=profile, work_of_adhesion=0.05, load=0.1)
    return solve(scene, 1e-9).inside


@pytest.mark.parametrize("nu", [0.3, 0.5])
@pytest.mark.parametrize("measure", ["von_mises", "surface_tension"])
def test_infinite_suction_at_the_edge_leaves_no_bound(nu, measure):
    found = adhesive(nu, 0.0).largest(measure)
    assert (found.value, found.r) == (None, 1.0)
    assert "at the edge" in found.remark


def test_through_a_layer_the_stress_of_an_adhesive_contact_has_a_bound():
    """Next to the edge it is that below an edge of a uniform suction, a limit by direction."""
    body = adhesive(0.5, 0.5)
    found = body.largest("max_shear")
    theta = np.linspace(0.0, np.pi, 61)[1:-1]
    near = body.stress(from_edge=1e-12 * np.cos(theta), z=1e-12 * np.sin(theta)).max_shear.max()
    assert found.value == pytest.approx(near, rel=1e-8)
    # half-plane under a uniform load: the largest shear stress is the load over pi
    assert found.value == pytest.approx(math.sqrt(2.0 * 0.05 / 0.5) / math.pi, rel=1e-8)
    assert "approached at the edge" in found.remark


def test_a_largest_stress_close_to_the_edge_of_a_rough_punch_is_attained():
    body = solve(Scene(0.3, 0.03), 1e-10).inside
    found = body.largest("von_mises")
    assert found.attained
    assert 1e-9 < found.z < 1e-8
    edge = 1e-15 * np.array([np.cos(1.4), np.sin(1.4)])
    assert body.stress(from_edge=edge[0], z=edge[1]).von_mises < found.value


def test_the_place_of_an_infinite_pressure_is_the_tip():
    cone = solve(Scene(0.3, profile=profiles.Cone(0.8), load=0.1), 1e-9).inside
    assert cone.largest("von_mises").r == 0.0
