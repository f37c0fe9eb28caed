"""Loads and works under profiles on smooth surfaces, against rules on other panels."""

import numpy as np
import pytest

from spectral_contact import Scene, profiles, solve

WIDTH, PLACE, REACH = 0.15, 0.5, 1.3


def slope(r):
    """Return half of ``|r - PLACE| + r - PLACE``, rounded over a width, less its value at 0."""
    return (np.hypot(r - PLACE, WIDTH) + r - np.hypot(PLACE, WIDTH)) / 2.0


def height(r):
    """Return the integral of the slope."""

    def integral(x):
        return (x * np.hypot(x, WIDTH) + WIDTH**2 * np.arcsinh(x / WIDTH)) / 2.0

    bend = integral(r - PLACE) - integral(-PLACE)
    return (bend + r**2 / 2.0 - np.hypot(PLACE, WIDTH) * r) / 2.0


@pytest.mark.parametrize("quantity", ["load", "indentation_work"])
def test_a_bend_inside_a_panel_is_in_the_estimates_of_the_integrals(quantity):
    """Breaks that the profile does not need move the panels, and resolve the bend."""
    found, truth = (
        solve(
            Scene(
                0.3,
                profile=profiles.Sampled.from_functions(height, slope, reach=REACH, breaks=breaks),
                contact_radius=1.0,
            ),
            1e-12,
            [quantity],
            strict=False,
        )
        for breaks in ((), (0.25, 0.4, 0.5, 0.6, 0.75))
    )
    room = getattr(found.error, quantity) + getattr(truth.error, quantity)
    assert getattr(truth.error, quantity) < 2e-13
    assert getattr(found, quantity) == pytest.approx(getattr(truth, quantity), rel=room)
    # sixteen points a panel lose more than the profile's own error, and the estimate says so
    assert getattr(found.error, quantity) > 5e-13


def test_a_smooth_profile_costs_no_digit():
    contact = solve(Scene(0.3, profile=profiles.Parabola(1.0), contact_radius=1.0), 1e-12, ["load"])
    assert contact.load == pytest.approx(16.0 / 3.0, rel=contact.error.load)
    assert contact.error.load < 1e-14
