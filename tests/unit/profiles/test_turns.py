"""Radii near which the curve of an adhesive contact may have several folds."""

import pytest

from spectral_contact import profiles
from spectral_contact.profiles.turns import turning_radii

EVEN = [
    profiles.Parabola(1.0),
    profiles.Cone(1.2),
    profiles.Sphere(3.0),
    profiles.PowerLaw(1.0, 1.5),
    profiles.RoundedFlat(0.5, 1.0),
    profiles.Sampled.from_points([0.0, 0.5, 1.0, 2.0, 4.0], [0.0, 0.125, 0.5, 2.0, 8.0]),
]


@pytest.mark.parametrize("profile", EVEN, ids=lambda one: type(one).__name__)
def test_the_function_grows_under_profiles_that_steepen_evenly(profile):
    assert turning_radii(profile, 2.5) == []


@pytest.mark.parametrize("width", [1e-6, 1e-3, 0.1])
def test_it_turns_where_the_slope_rises_over_a_short_way_and_farther_out(width):
    edges = (0.0, 1.0, 1.0 + width, 50.0)
    profile = profiles.Sampled(edges, ((0.1,), (0.3, 0.2), (0.5,)))
    radii = turning_radii(profile, 20.0)
    assert radii == sorted(radii, reverse=True)
    assert max(radii) > 1.2
    assert min(radii) == pytest.approx(1.0 + width, rel=0.1 * width)


def test_next_to_a_corner_it_turns_there():
    radii = turning_radii(profiles.TruncatedCone(0.5, 1.2), 20.0)
    assert min(radii) == pytest.approx(0.5, rel=1e-6)
    assert 0.5 < max(radii) < 1.0
