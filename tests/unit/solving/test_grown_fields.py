"""The quadrature over the history of a growing contact."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.special import beta, digamma

from spectral_contact import Scene, profiles, solve
from spectral_contact.solving.grown_fields import _History, tanh_rule


@pytest.mark.parametrize("error", [1e-3, 1e-6, 1e-12])
@pytest.mark.parametrize(("low", "high"), [(-0.5, 0.5), (0.5, -0.5), (-0.25, 0.0), (0.0, 0.0)])
def test_what_is_singular_at_the_ends_is_integrated_to_the_digits_asked(low, high, error):
    """int x^low (1 - x)^high, a complete beta function; x at the upper end has 16 digits."""
    digits = -math.log(error)
    nodes, weights = tanh_rule(digits, depth=2.0 * digits)
    found = weights @ (nodes**low * (nodes[::-1]) ** high)
    assert found == pytest.approx(beta(low + 1.0, high + 1.0), rel=10.0 * error)


def test_a_root_with_a_logarithm_needs_nodes_a_little_nearer_to_the_end():
    """int ln(x)/sqrt(x) = -4: nodes from x on leave out -2 sqrt(x) ln(x)."""
    digits = -math.log(1e-10)
    truth = beta(0.5, 1.0) * (digamma(0.5) - digamma(1.5))
    assert truth == pytest.approx(-4.0)
    errors = []
    for depth in (2.0 * digits, 2.0 * (digits + math.log(4.0 * digits))):
        nodes, weights = tanh_rule(digits, depth)
        errors.append(abs(weights @ (np.log(nodes) / np.sqrt(nodes)) - truth))
    assert errors[0] > 1e-9
    assert errors[1] < 2e-10


def slipping_panel(low, high, log_stick):
    """Return a stand-in for a panel on which all stages have the same stick radius."""
    return SimpleNamespace(
        low=low,
        high=high,
        slips=True,
        punches_alike=True,
        stick=[log_stick],
        log_stick=lambda t: np.full_like(t, log_stick),
    )


def test_radii_between_the_stick_radii_of_two_panels_stuck_where_the_panels_meet():
    """They passed for radii that never slipped: their slip was zero, their traction off."""
    panels = (slipping_panel(0.0, 1.0, -0.5), slipping_panel(1.0, 2.0, -0.4))
    growth = SimpleNamespace(all_panels=panels, panels=panels)
    history = _History(growth, rule=tanh_rule(10.0, 10.0), degree=5)
    stuck = history.when_stuck(np.array([0.3, 0.55, 0.9, 1.8]))
    assert stuck == pytest.approx([0.8, 1.0, 1.3, 2.0])


def test_the_error_of_the_slip_has_what_is_before_the_history():
    """Under a power of 20 what is left out at the first radius was 1.4 times the estimate.

    On a smooth surface the slip of points that stick goes like the power of the profile.
    """
    blunt = profiles.PowerLaw(1.0, 20.0)
    scene = Scene.from_kappa(0.113, friction=0.1255, profile=blunt, contact_radius=0.7)
    solution = solve(scene, 1e-4, ["slip", "stick_radius"])
    s = np.linspace(0.3, 0.55, 26)
    assert s[-1] < solution.stick_radius
    largest = np.abs(solution.slip(np.linspace(0.0, 1.0, 201))).max()
    off = np.abs(solution.slip(s) - solution.slip(s[-1]) * (s / s[-1]) ** 20)
    assert 1e-8 * largest < off.max() < solution.error.slip * largest
