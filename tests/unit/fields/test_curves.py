"""Interpolation of smooth functions between few nodes."""

import numpy as np
import pytest

from spectral_contact.fields.curves import Curves, nodes_allowed


def interpolated(low: float, high: float, nodes: int, noise: float = 0.0) -> Curves:
    """Return the curves of x and of sin(x) through some nodes."""
    rng = np.random.default_rng(1)
    curves = Curves(low, high, 2)
    for _ in range(nodes):
        x = curves.next()
        known = np.array([x, np.sin(x)]) + noise * rng.uniform(-1.0, 1.0, 2)
        curves.add(known, np.array([noise, noise]))
    return curves


def test_values_and_places_are_right_to_the_estimates():
    curves = interpolated(0.0, 3.0, 14)
    assert curves.settled(1e-8)
    wanted = np.linspace(0.1, 2.9, 50)
    found = curves.invert(wanted)
    assert (np.abs(found.places - wanted) <= found.place_errors + 1e-15).all()
    assert (np.abs(found.values[:, 0] - np.sin(wanted)) <= found.value_errors[:, 0] + 1e-15).all()
    assert found.slopes[:, 0] == pytest.approx(np.abs(np.cos(wanted)), abs=1e-8)


@pytest.mark.filterwarnings("error")
def test_many_nodes_in_a_narrow_interval_overflow_nothing():
    """Products of a hundred distances of 1e-6 did."""
    curves = interpolated(1.0, 1.0 + 1e-6, 100, noise=1e-13)
    assert not curves.settled(1e-15)
    found = curves.invert(np.linspace(1.0, 1.0 + 1e-6, 9)[1:-1])
    assert np.isfinite(found.values).all()


def test_functions_that_never_settle_are_given_up():
    assert nodes_allowed(30) == 24
    assert nodes_allowed(10_000) == 200
