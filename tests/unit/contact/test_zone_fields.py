"""Fields on zones: estimates of where zones end."""

import pytest

from spectral_contact import Scene, solve
from spectral_contact.contact.zone_fields import estimated_stick_radius
from spectral_contact.spectral.parameters import Parameters


@pytest.mark.parametrize("kappa", [0.2, 1e-3, 1e-6])
def test_the_stick_radius_under_little_friction_depends_on_friction_over_kappa(kappa):
    """It was taken to be ``2 beta f``, for any kappa."""
    beta, ratio = 1e-2, 0.05
    solution = solve(Scene.from_kappa(kappa, 0.0, beta, ratio * kappa), 1e-4, ("stick_radius",))
    estimate = estimated_stick_radius(Parameters(0.0, beta, kappa, ratio * kappa))
    assert 0.5 < estimate / solution.stick_radius < 2.0
