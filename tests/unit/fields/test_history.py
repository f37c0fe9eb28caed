"""The history of a growing contact: where it ends."""

import math

import pytest

from spectral_contact import Scene, profiles, solve


@pytest.mark.parametrize("radius", [1.0, 1e-9, 1e-40])
def test_the_history_reaches_the_contact_radius_of_today(radius):
    ball = profiles.Parabola(10.0 * radius)
    scene = Scene(0.3, friction=math.inf, profile=ball, contact_radius=radius)
    solution = solve(scene, 1e-6)
    error = solution.history.error("load", radius)
    assert solution.history.load(radius) == pytest.approx(solution.load, rel=error, abs=0)
