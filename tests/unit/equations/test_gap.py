"""The gap far outside."""

import math

import pytest

from spectral_contact import Scene, SceneError, profiles, solve


def test_far_outside_the_gap_is_the_height_less_the_approach():
    solution = solve(Scene(0.3, profile=profiles.Cone(1.0), load=0.1), 1e-9)
    far = 1e99
    height = far * solution.contact_radius / math.tan(1.0)
    assert solution.gap(beyond=far) == pytest.approx(height, rel=1e-14)
    with pytest.raises(SceneError, match=r"beyond = 1e\+160: must be such that the radius is"):
        solution.gap(beyond=1e160)
