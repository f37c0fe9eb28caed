"""What a solve returns where no zones are found that obey the friction law."""

import math

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
def test_contacts_that_grow_are_not_made_of_what_breaks_the_law():
    scene = Scene(
        0.3, 0.5, 0.5, 0.05, coupling=True, profile=profiles.Parabola(1.0), contact_radius=1.0
    )
    with pytest.raises(NotComputedError, match="no zones were found"):
        solve(scene, 1e-3)
