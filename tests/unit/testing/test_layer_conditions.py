"""`check_solution` of contacts through nonlinear layers: right ones pass, spoilt ones do not."""

from types import SimpleNamespace

import pytest

from spectral_contact import Scene, SceneError, layers, profiles, solve
from spectral_contact.testing import check_solution

BALL = profiles.Parabola(1.0)
SCENES = {
    "power law": Scene(0.3, layer=layers.PowerLaw(5.0, 2.0), profile=BALL, load=1.0),
    "abaqus, before first touch": Scene(
        0.3, layer=layers.Exponential(1.0, 0.1), profile=BALL, approach=-0.02
    ),
    "a law that bends": Scene(
        0.3, layer=layers.Table((0, 0.02, 0.04, 0.06), (0, 0.1, 0.5, 1.5)), profile=BALL, load=0.1
    ),
    "no edge": Scene(0.3, layer=layers.CalculixExponential(0.1, 0.1), profile=BALL, approach=0.2),
    "flat": Scene(
        0.3, layer=layers.GreenwoodWilliamson(9.0, 1.0, 0.5), profile=profiles.Flat(2.0), load=1.0
    ),
}


@pytest.mark.parametrize("name", SCENES)
def test_a_solution_passes_and_a_spoilt_one_does_not(name):
    scene = SCENES[name]
    solution = solve(scene, 1e-8)
    report = check_solution(solution, scene, 1e-7)
    assert len(report.checks) == (4 if name == "flat" else 5)
    numbers = {"approach": solution.approach, "domain_radius": solution.domain_radius}
    if name != "no edge":
        numbers["contact_radius"] = solution.contact_radius
    spoilt = SimpleNamespace(
        pressure=lambda from_edge: 1.0001 * solution.pressure(from_edge=from_edge), **numbers
    )
    checks = check_solution(spoilt, scene, 1e-5, strict=False).checks
    assert "surface follows the punch" in {one.name for one in checks if not one.passed}


def test_a_smaller_contact_would_be_in_reach_of_the_layer():
    scene = SCENES["abaqus, before first touch"]
    solution = solve(scene, 1e-6)
    small = SimpleNamespace(
        pressure=solution.pressure, contact_radius=0.9 * solution.contact_radius
    )
    checks = check_solution(small, scene, 1e-3, strict=False).checks
    assert "surface is below the punch outside" in {one.name for one in checks if not one.passed}


def test_the_radius_of_the_domain_is_asked_for():
    bare = SimpleNamespace(pressure=lambda s: s)
    with pytest.raises(SceneError, match="contact_radius"):
        check_solution(bare, SCENES["no edge"], 1e-3)
