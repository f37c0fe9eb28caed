"""What a solve returns where no zones are found that obey the friction law."""

import math
from dataclasses import replace

import pytest

from spectral_contact import ConvergenceError, Scene, profiles, solve
from spectral_contact.contact.zone_search import CoupledSearch, NoZonesError
from spectral_contact.errors import NotComputedError
from spectral_contact.records import Ending

SCENE = Scene(0.3, 0.5, 0.5, 0.05, coupling=True)


@pytest.fixture
def no_zones(monkeypatch):
    """No search finds any."""

    def outcome(self):
        raise NoZonesError("nothing fits")

    monkeypatch.setattr(CoupledSearch, "outcome", outcome)


@pytest.mark.usefixtures("no_zones")
def test_full_stick_is_returned_unconverged_with_its_violation():
    solution = solve(SCENE, 1e-3, strict=False)
    stick = solve(SCENE.replace(friction=math.inf), 1e-3)
    assert (solution.converged, solution.ending) == (False, Ending.ZONES)
    assert solution.approach == pytest.approx(stick.approach, rel=1e-4)
    assert [zone.kind for zone in solution.zones] == ["stick"]
    excess = stick.critical_friction / SCENE.friction - 1.0
    assert solution.error.violation == pytest.approx(excess, rel=1e-3)
    assert solution.error.slip == solution.error.zones == math.inf
    assert solution.error.pressure > excess


@pytest.mark.usefixtures("no_zones")
def test_a_strict_solve_raises_with_what_there_is():
    with pytest.raises(
        ConvergenceError, match=r"no zones were found .* \(nothing fits\)"
    ) as caught:
        solve(SCENE, 1e-3)
    assert not caught.value.solution.converged


@pytest.mark.usefixtures("no_zones")
@pytest.mark.parametrize("given", [{"contact_radius": 1.0}, {"load": 2.0}])
def test_a_contact_that_grows_is_that_of_full_stick_of_which_no_digit_is_known(given):
    scene = Scene(0.3, 0.5, 0.5, 0.05, coupling=True, profile=profiles.Parabola(1.0), **given)
    with pytest.raises(ConvergenceError, match=r"no zones were found .* \(nothing fits\)"):
        solve(scene, 1e-3)
    found = solve(scene, 1e-3, strict=False)
    stick = solve(scene.replace(friction=math.inf), 1e-3)
    assert (found.converged, found.ending) == (False, Ending.ZONES)
    [(name, value)] = given.items()
    assert getattr(found, name) == value
    assert getattr(found.error, name) == 0.0
    for other in {"load", "approach", "total_shear", "stiffness"} - {name}:
        assert getattr(found, other) == getattr(stick, other)
        assert getattr(found.error, other) == math.inf, other
    assert found.pressure(0.5) == stick.pressure(0.5)
    assert found.error.pressure == found.error.stick_radius == found.error.violation == math.inf
    assert found.history.error("load", 0.5 * found.contact_radius) == math.inf
    assert "no digit is known" in found.summary()
    assert "full stick at all times; no zones were found" in str(found.plan)


def test_a_contact_that_grows_without_a_stick_disk_to_follow_is_refused_for_that():
    """It was said that slip did not reach the edge."""
    scene = Scene(
        0.3, 0.0, 0.0, 1e-3, coupling=True, profile=profiles.Parabola(1.0), contact_radius=1.0
    )
    with pytest.raises(NotComputedError, match="the stick disk is too small to be followed"):
        solve(scene, 1e-3, strict=False)


def test_what_violates_the_law_least_has_no_opening_of_full_stick(monkeypatch):
    scene = Scene(0.0, 1e-4, 1e-4, 0.3, coupling=True)
    best = CoupledSearch.outcome
    refused = []

    def outcome(self):
        error = NoZonesError("nothing fits")
        # as the best of outcomes that all violate the law
        error.least_wrong = replace(best(self), violation_text="the law is violated")
        refused.append(error)
        raise error

    monkeypatch.setattr(CoupledSearch, "outcome", outcome)
    found = solve(scene, 1e-3, strict=False)
    assert refused
    assert [zone.kind for zone in found.zones] == ["stick", "slip"]
    assert found.opening is None
    steps = {step.name: step.reason for step in found.plan.steps}
    assert steps["elastic coupling"] == "pressure and traction are one system"
    assert "no zones that were tried satisfy" in steps["zone search"]
