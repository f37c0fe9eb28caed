"""Contact of a given radius under a profile: the rounding of the pressure at a tip."""

from dataclasses import replace
from math import pi

import numpy as np
import pytest

from spectral_contact import Scene, SceneError, profiles, solve
from spectral_contact.contact.indented import (
    _IndentationProblem,
    solve_indentation,
    values_only,
)
from spectral_contact.spectral.panels import DiscreteSpace

#: A profile with a tip, a contact radius, a normal compliance and a work of adhesion. In a thin
#: layer under strong adhesion ``alpha p`` is a small difference at the tip.
TIPS = {
    "power law": (profiles.PowerLaw(0.48138758784301366, 1.5), 1.22140432939697, 4.2e-5, 417.2),
    "cone": (profiles.Cone(0.9), 1.0, 8.5e-6, 400.0),
    "steep power law": (profiles.PowerLaw(1.0, 1.5), 1.0, 8.5e-6, 4000.0),
}


@pytest.mark.parametrize("scene", TIPS.values(), ids=TIPS)
def test_the_rounding_of_the_pressure_at_a_tip_is_within_its_estimate(
    scene: tuple[profiles.Profile, float, float, float],
) -> None:
    """Spaces that all resolve the pressure differ by their own rounding alone."""
    profile, radius, compliance, adhesion = scene
    problem = _IndentationProblem(
        profile, radius, compliance, 1e-12, pointwise=True, adhesion=adhesion
    )
    first = problem.start()
    found = []
    for more in range(5, 14):
        degrees = tuple(min(degree + more, 38) for degree in first.degrees)
        space = DiscreteSpace(replace(first.panels, degree=40), degrees)
        found.append(problem.attempt(space).value)
    at_tip = []
    for contact in found:
        assert contact.pressure is not None
        at_tip.append(float(contact.pressure(np.zeros(1), np.ones(1))[0]))
    truth = float(np.median(at_tip))
    size = max(abs(truth), found[0].load_size / (pi * radius**2))
    errors = np.abs(np.array(at_tip) - truth) / size
    estimates = np.array([contact.pressure_error for contact in found])
    assert (errors <= estimates).all(), errors / estimates


@pytest.mark.parametrize("compliance", [1e-10, 1e-14])
@pytest.mark.parametrize("profile", [profiles.Cone(0.1), profiles.RoundedFlat(0.5, 1.0)])
def test_the_growth_of_the_approach_keeps_its_digits_under_thin_layers(profile, compliance):
    """That under a layer of 1e-14 was -44 in place of 16, from a pressure that was rounding."""

    def approach(radius: float) -> float:
        return values_only(profile, radius, compliance, 1e-10, 1000).approach

    slope = (approach(1.001) - approach(0.999)) / 0.002
    growth = values_only(profile, 1.0, compliance, 1e-10, 1000).growth
    assert growth == pytest.approx(slope, rel=1e-5)


@pytest.mark.parametrize("radius", [1e-300, 1e-110, 1e110, 1e300])
def test_a_radius_whose_load_is_no_floating_point_number_is_refused(radius):
    """The load was 0, with an estimate of 4e-15, or Python raised an OverflowError."""
    with pytest.raises(SceneError, match=r"^contact_radius = .* floating-point numbers"):
        solve_indentation(profiles.Parabola(10.0), radius, 0.0, 1e-10, 1000)


@pytest.mark.parametrize(
    ("exponent", "compliance", "rtol"), [(8.0, 1.0, 1e-8), (8.0, 0.01, 1e-10), (12.0, 1e-4, 1e-6)]
)
def test_spaces_are_refined_until_the_work_is_known_to_the_tolerance(
    exponent: float, compliance: float, rtol: float
) -> None:
    """They were refined for load and approach alone; the solve said that rounding was reached."""
    blunt = profiles.PowerLaw(1.0, exponent)
    scene = Scene(0.3, compliance, profile=blunt, contact_radius=0.5)
    solution = solve(scene, rtol, ["load", "indentation_work"])
    assert solution.error.indentation_work <= rtol
    truth = solve(scene, 1e-12, ["indentation_work"])
    off = abs(solution.indentation_work / truth.indentation_work - 1.0)
    assert off <= solution.error.indentation_work + truth.error.indentation_work
