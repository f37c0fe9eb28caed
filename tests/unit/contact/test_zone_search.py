"""The search of the zones: which candidates are tried, in which order, and what is told of them."""

import math
from dataclasses import replace

import numpy as np
import pytest

from spectral_contact import Scene, StepState, solve
from spectral_contact.contact.full_stick import full_stick
from spectral_contact.contact.layout import Layout
from spectral_contact.contact.normal import solve_normal
from spectral_contact.contact.zone_problem import solve_stick
from spectral_contact.contact.zone_search import CoupledSearch, NoZonesError, UncoupledSearch
from spectral_contact.spectral.parameters import Parameters

HOLDS = "the friction law holds"


def value(name, result, begin):
    """Return the value of a step whose work nobody notes."""
    return result.best.value if hasattr(result, "best") else result


def uncoupled(alpha, beta, friction, warm_start=None):
    """Return the search of a scene; the friction is over kappa."""
    parameters = Parameters(alpha, beta, 1.0, friction)
    contact = value("normal", solve_normal(alpha, 1e-8, 5000, goal="traction"), 0.0)
    infinite = parameters._replace(friction=math.inf)
    stick = full_stick(solve_stick(infinite, 1e-8, 5000, known=contact), contact).best.value
    return UncoupledSearch(parameters, stick, 1e-6, 5000, value, contact, warm_start=warm_start)


def test_where_one_disk_will_do_nothing_else_is_tried():
    outcome = uncoupled(0.5, 0.5, 0.5).outcome()
    [trial] = outcome.trials
    assert trial.zones.states == (0, 1)
    assert trial.reason == "one stick disk"
    assert trial.verdict == HOLDS
    assert trial.text == f"2 zones (one stick disk): {HOLDS}"


@pytest.mark.parametrize(("beta", "friction"), [(0.02, 0.5), (0.3, 0.1), (1.0, 1e-3)])
def test_one_disk_has_stick_at_a_smooth_edge(beta, friction):
    [trial] = uncoupled(0.0, beta, friction).outcome().trials
    assert trial.zones.states == (0, 1, 0)
    assert trial.reason == "one stick disk, and stick at the edge"
    assert trial.verdict == HOLDS


def test_slip_between_disk_and_edge_has_a_width_to_begin_with():
    # so much friction that the estimate of the stick at the edge reaches into the disk
    disk = uncoupled(0.0, 1.0, 3.0)._disk(4.0)
    assert disk.zones.logits[0] < disk.zones.logits[1]


def test_a_disk_that_is_too_small_to_be_solved_for_is_no_candidate():
    """Newton's method takes half a minute to find no boundary of it."""
    parameters = Parameters(0.0, 1e-14, 0.25, 1e-28)
    infinite = parameters._replace(friction=math.inf)
    stick = full_stick(solve_stick(infinite, 1e-4, 5000), None).best.value
    outcome = CoupledSearch(parameters, stick, 1e-4, 5000, value).outcome()
    assert outcome.trials == ()
    assert [zone.kind for zone in outcome.zones] == ["slip", "stick"]


def test_slip_inside_tells_what_refuted_one_disk():
    outcome = uncoupled(0.05, 1.0, 0.23).outcome()
    assert [zone.kind for zone in outcome.zones] == ["stick", "slip", "stick"]
    *refuted, last = outcome.trials
    assert last.verdict == HOLDS
    assert last.zones.states == (0, 1, 0)
    assert refuted[0].reason == "one stick disk"
    assert all(trial.verdict != HOLDS for trial in refuted)


def test_zones_of_a_like_scene_come_first_and_alone_if_they_hold():
    zones = uncoupled(0.05, 1.0, 0.23).outcome().layout
    outcome = uncoupled(0.05, 1.0, 0.232, warm_start=zones).outcome()
    [trial] = outcome.trials
    assert trial.reason == "the zones of a like scene"
    assert trial.verdict == HOLDS


def test_zones_of_an_unlike_scene_are_refuted_and_the_search_goes_on():
    zones = uncoupled(0.05, 1.0, 0.23).outcome().layout
    outcome = uncoupled(0.5, 0.5, 0.5, warm_start=zones).outcome()
    first, *_, last = outcome.trials
    assert first.reason == "the zones of a like scene"
    assert first.verdict != HOLDS
    assert last.verdict == HOLDS
    assert last.zones.states == (0, 1)


def test_narrow_zones_of_a_like_scene_are_refuted_and_the_search_goes_on():
    narrow = Layout((1.0, 1.0005), (0, 1, 0))
    outcome = uncoupled(0.5, 0.5, 0.5, warm_start=narrow).outcome()
    predicted, disk = outcome.trials
    assert predicted.verdict != HOLDS
    assert disk.reason == "one stick disk"


def test_a_disk_that_is_far_off_is_followed_by_one_that_is_not_predicted():
    """There was no other, and full stick took the place of slip with c = 0.66."""
    # the Jacobian leads away from the root
    far = Layout((36.8,), (0, 1), np.array([[-0.26]]))
    outcome = uncoupled(0.4, 0.4, 0.5333, warm_start=far).outcome()
    predicted, other = outcome.trials
    assert predicted.verdict != HOLDS
    assert other.reason == "one stick disk"
    assert outcome.zones[0].outer == pytest.approx(0.6636, abs=1e-3)


def test_the_plan_tells_which_zones_were_tried():
    solution = solve(Scene(0.3, 0.05, 1.0, 0.23 / 7.0), 1e-6)
    [step] = [step for step in solution.plan.steps if step.name == "zone search"]
    assert step.state is StepState.RUN
    assert "3 zones satisfy the friction law; tried: 2 zones (one stick disk): " in step.reason
    assert step.reason.endswith(HOLDS)


def test_an_error_tells_what_refuted_each_candidate(monkeypatch):
    parameters = Parameters(0.3, 0.2, 0.25, 0.15)
    infinite = parameters._replace(friction=math.inf)
    stick = full_stick(solve_stick(infinite, 1e-4, 5000), None).best.value
    search = CoupledSearch(parameters, stick, 1e-4, 5000, value)
    fails = "no such boundaries"

    def refuse(search, candidate):
        raise ArithmeticError(fails)

    monkeypatch.setattr(CoupledSearch, "_solve", refuse)
    with pytest.raises(NoZonesError) as caught:
        search.outcome()
    tried = str(caught.value).split("; ")
    assert all(text.endswith(fails) for text in tried)
    assert any("where full stick exceeds the friction" in text for text in tried)
    assert caught.value.least_wrong is None


def coupled_with_one_annulus():
    """Return the search of a scene in which full stick shows one disk, too."""
    parameters = Parameters(0.3, 0.2, 0.25, 0.15)
    infinite = parameters._replace(friction=math.inf)
    stick = full_stick(solve_stick(infinite, 1e-4, 5000), None).best.value
    return CoupledSearch(parameters, stick, 1e-4, 5000, value)


def test_states_are_tried_from_other_boundaries_until_there_is_a_solution(monkeypatch):
    search = coupled_with_one_annulus()
    reasons = []

    def refuse(search, candidate):
        reasons.append(candidate.reason)
        raise ArithmeticError("no such boundaries")

    monkeypatch.setattr(CoupledSearch, "_solve", refuse)
    with pytest.raises(NoZonesError):
        search.outcome()
    assert reasons == [
        "slip where full stick exceeds the friction",
        "one stick disk",
    ]


def test_states_are_solved_for_once(monkeypatch):
    search = coupled_with_one_annulus()
    solve_candidate = CoupledSearch._solve
    monkeypatch.setattr(
        CoupledSearch,
        "_solve",
        lambda search, candidate: replace(solve_candidate(search, candidate), violation_text="no"),
    )
    with pytest.raises(NoZonesError) as caught:
        search.outcome()
    assert str(caught.value) == "2 zones (slip where full stick exceeds the friction): no"
    assert caught.value.least_wrong.zones[0].kind == "stick"


def test_predicted_zones_that_miss_the_tolerance_are_given_up(monkeypatch):
    zones = uncoupled(0.05, 1.0, 0.23).outcome().layout
    search = uncoupled(0.05, 1.0, 0.232, warm_start=zones)
    solve_candidate = UncoupledSearch._solve

    def solved(search, candidate):
        outcome = solve_candidate(search, candidate)
        return replace(outcome, shear_error=1e-3) if candidate.predicted else outcome

    monkeypatch.setattr(UncoupledSearch, "_solve", solved)
    first, *_, last = search.outcome().trials
    assert first.verdict == "the tolerance is not met from these boundaries"
    assert last.verdict == HOLDS


def test_a_narrow_annulus_is_the_same_at_every_tolerance():
    scene = Scene(
        0.3216563614452209,
        3.902806546943033,
        4.804038693556474e-12,
        14252.653932202149,
        coupling=True,
    )
    finest = solve(scene, 1e-12, ("zones",))
    for rtol in (1e-3, 1e-6, 1e-9):
        found = solve(scene, rtol, ("zones",))
        width, truth = found.zones[-1].inner_from_edge, finest.zones[-1].inner_from_edge
        assert abs(width / truth - 1.0) <= found.error.zones + finest.error.zones


@pytest.mark.parametrize("lack", [1e-5, 1e-7, 1e-9])
def test_slip_that_begins_at_the_edge_is_found(lack):
    stick = Scene(0.15, 0.05, 0.004, math.inf, coupling=True)
    critical = solve(stick, 1e-12, ("critical_friction",)).critical_friction
    scene = stick.replace(friction=critical * (1.0 - lack))
    widths = []
    for rtol in (1e-6, 1e-9, 1e-11):
        found = solve(scene, rtol)
        if 3.0 * lack < rtol:  # full stick, with room for it
            continue
        assert found.error.zones < 0.1
        widths.append((found.zones[-1].inner_from_edge, found.error.zones))
    for width, error in widths[:-1]:
        assert abs(width / widths[-1][0] - 1.0) <= error + widths[-1][1]
