"""The stick radii that ../validation/physics/coupled_uniqueness.py counts."""

import sys
from pathlib import Path

import numpy as np
import pytest

from spectral_contact import Scene, solve
from spectral_contact.contact.layout import Layout
from spectral_contact.contact.zone_problem import FreeBoundaryProblem
from spectral_contact.spectral.parameters import Parameters

sys.path += [
    str(folder)
    for folder in (Path(__file__).parents[2] / "validation").glob("**/")
    if folder.name != "results"
]

from coupled_uniqueness import stick_radii


def radii(scene, logits):
    compliances = scene.normal_compliance, scene.tangential_compliance
    parameters = Parameters(*compliances, scene.kappa, scene.friction)
    problem = FreeBoundaryProblem(parameters, Layout((0.0,), (0, 1)), 1e-3)
    return list(stick_radii(problem, logits))


def test_a_thick_layer_has_one_which_is_that_of_the_solution():
    scene = Scene(0.1, 0.5, 0.5, friction=0.1, coupling=True)
    [found] = radii(scene, np.linspace(-10.0, 20.0, 31))
    assert found.admissible
    c = solve(scene, 1e-6, ("stick_radius",)).stick_radius
    assert found.logit == pytest.approx(np.log(c**2 / (1.0 - c**2)), abs=0.03)


def test_where_the_edge_sticks_both_are_told_from_contacts():
    """Slip lies in an interior annulus, so at one of the radii stick is beyond friction."""
    _, second = radii(
        Scene(0.25, 0.0026, 0.111, 0.1012, coupling=True), np.linspace(-6.0, 14.0, 21)
    )
    assert 0.1 < second.excess < np.inf  # the pressure is positive
    assert not second.admissible


def test_on_a_smooth_surface_the_pressure_of_others_is_negative():
    scene = Scene(0.026, 0.0, 0.0, friction=0.2143, coupling=True)
    first, *others = radii(scene, np.linspace(-6.0, 30.0, 37))
    assert first.admissible
    assert others
    assert not any(one.excess < np.inf for one in others)
