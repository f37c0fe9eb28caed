"""Radii of pictures and tables reach into the edge layer, in whatever unit lengths are."""

import pytest

from spectral_contact import Scene, profiles, solve
from spectral_contact.view.radii import graded_radii, layer_depth


@pytest.mark.parametrize("unit", [1e-6, 1.0, 1e6])
def test_the_layer_of_a_profile_is_over_the_contact_radius(unit):
    ball = Scene(
        0.3,
        profile=profiles.Parabola(unit),
        contact_radius=0.1 * unit,
        normal_compliance=1e-6 * unit,
    )
    solution = solve(ball, 1e-6)
    assert layer_depth(solution) == pytest.approx(1e-8)
    assert graded_radii(solution).outer[-2] == pytest.approx(1e-8)
