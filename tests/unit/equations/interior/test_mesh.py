"""Points that are nearly on the surface, next to a tip and to the edge."""

import numpy as np
import pytest

from spectral_contact import Scene, profiles, solve
from spectral_contact.closed_forms import flat_punch_stress


@pytest.mark.parametrize("slope", [0.9, 1e-3, 1e-6])
def test_shear_below_a_tip_depends_on_the_direction_at_any_distance(slope):
    body = solve(Scene(0.3, profile=profiles.Cone(1.0), load=0.1), 1e-10).inside
    far = body.stress(1e-8, 1e-8 * slope)
    for r in (1e-12, 1e-15):
        near = body.stress(r, r * slope)
        assert abs(near.rz - far.rz) < 2e-7 * abs(far.rz)


@pytest.mark.parametrize("from_edge", [-1e-15, -1e-8, 1e-12])
def test_just_below_the_surface_next_to_an_infinite_pressure(from_edge):
    depth = 0.9e-16 * abs(from_edge)
    found = solve(Scene(0.3)).inside.stress(from_edge=from_edge, z=depth)
    exact = flat_punch_stress(0.3, from_edge=from_edge, z=depth)
    apart = [abs(getattr(found, part) - getattr(exact, part)) for part in ("rr", "tt", "zz", "rz")]
    assert max(apart) <= found.error * found.norm


@pytest.mark.parametrize("from_edge", [1e-70, -1e-90, 0.0])
def test_the_nearest_points_to_the_edge_of_a_profile_have_stresses(from_edge):
    body = solve(Scene(0.3, profile=profiles.Parabola(1.0), load=0.1), 1e-10).inside
    for depth in (1e-78, 1e-61, 1e-59):
        found = body.stress(from_edge=from_edge, z=depth)
        tension = 0.4 / 3.0 * body.stress(0.0).zz  # Johnson (1985), section 3.4
        assert [found.rr, found.tt] == pytest.approx([-tension, tension], rel=1e-11)
        assert 0.0 < found.error < 1e-10
        assert np.abs([found.zz, found.rz]).max() < 1e-28
