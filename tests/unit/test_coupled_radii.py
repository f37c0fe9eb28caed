"""Other stick disks than the one that coupled partial slip is solved with."""

import numpy as np
import pytest

from spectral_contact import Scene, solve
from spectral_contact.contact.coupled_disk import CoupledDiskProblem
from spectral_contact.contact.coupled_radii import stick_radii


def radii(scene, logits):
    compliances = scene.normal_compliance, scene.tangential_compliance
    return stick_radii(CoupledDiskProblem(*compliances, scene.kappa, scene.friction, 1e-3), logits)


def test_a_thick_layer_has_one_which_is_that_of_the_solution():
    scene = Scene(0.1, 0.5, 0.5, friction=0.1, coupling=True)
    [found] = radii(scene, np.linspace(-10.0, 20.0, 31))
    assert found.possible
    c = solve(scene, 1e-6, ("stick_radius",)).stick_radius
    assert found.logit == pytest.approx(np.log(c**2 / (1.0 - c**2)), abs=0.03)


def test_where_the_edge_sticks_both_are_told_from_contacts():
    """Slip lies in an interior annulus, so at one of the radii stick is beyond friction."""
    _, second = radii(
        Scene(0.25, 0.0026, 0.111, 0.1012, coupling=True), np.linspace(-6.0, 14.0, 21)
    )
    assert second.positive
    assert second.excess > 0.1
    assert not second.possible


def test_on_a_smooth_surface_the_pressure_of_others_is_negative():
    scene = Scene(0.026, 0.0, 0.0, friction=0.2143, coupling=True)
    first, *others = radii(scene, np.linspace(-6.0, 30.0, 37))
    assert first.possible
    assert others
    assert not any(one.positive for one in others)
