"""The gap far outside."""

import math

import pytest

from spectral_contact import Scene, SceneError, layers, profiles, solve


def test_far_outside_the_gap_is_the_height_less_the_approach():
    solution = solve(Scene(0.3, profile=profiles.Cone(1.0), load=0.1), 1e-9)
    far = 1e99
    height = far * solution.contact_radius / math.tan(1.0)
    assert solution.gap(beyond=far) == pytest.approx(height, rel=1e-14)
    with pytest.raises(SceneError, match=r"beyond = 1e\+160: must be such that the radius is"):
        solution.gap(beyond=1e160)


def test_the_gap_opens_at_the_edge_under_a_law_that_bends():
    """Bends of the law inside the contact are places where the pressure is not smooth."""
    law = layers.Table((0.0, 0.02, 0.04, 0.06), (0.0, 0.1, 0.5, 1.5))
    solution = solve(Scene(0.3, layer=law, profile=profiles.Parabola(1.0), load=0.1), 1e-9)
    assert abs(solution.gap(beyond=0.0)) < 1e-10 * solution.approach
