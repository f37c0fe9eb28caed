"""Zones below the largest load: candidates, growth, and the loads at which something changes."""

import math
from copy import copy
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from spectral_contact import NotComputedError, Scene, solve
from spectral_contact.contact import unloading
from spectral_contact.contact.layout import Layout
from spectral_contact.contact.unloading import HistoryError, LoadRatio, Unloading
from spectral_contact.contact.zone_search import NoZonesError
from spectral_contact.fields.series import Radius
from spectral_contact.records import UNLOADING
from spectral_contact.solving import uncoupled_run
from spectral_contact.solving.planning import plan
from spectral_contact.solving.sharing import StepCache

SCENE = Scene(0.1, 0.5, 0.5, 0.1, unloaded_to=0.8)


@pytest.fixture(scope="module")
def from_largest_load() -> Unloading:
    run = uncoupled_run.UncoupledRun(SCENE, plan(SCENE, ["total_shear"]), 1e-9, 20_000, StepCache())
    run.solution()
    # what scenes at other loads take from this one
    found = run.cache.get(UNLOADING, run.cache._steps[UNLOADING][0], lambda: None)
    assert isinstance(found, Unloading)
    return found


def test_growth_over_the_slope_of_the_traction_is_the_derivative_of_the_boundaries(
    from_largest_load,
):
    step = 1e-3
    less, outcome, more = (
        from_largest_load._search(0.5 * np.exp(change)).outcome() for change in (-step, 0.0, step)
    )
    derivative = np.subtract(less.layout.logits, more.layout.logits) / (2.0 * step)
    search = from_largest_load._search(0.5)
    growth = search.growth(search.solve_zones(outcome.layout))
    # slopes of q/f - p by the logit, in what sticks inside of one boundary and outside of the other
    distances = np.array([[-step, step], [-2.0 * step, 2.0 * step]])
    y = 1.0 / (1.0 + np.exp(np.array(outcome.layout.logits) + distances)).ravel()
    friction = SCENE.friction / SCENE.kappa
    excess = (outcome.traction.evaluate(y) / friction - outcome.pressure.evaluate(y)).reshape(2, 2)
    slopes = (2.0 * excess[0] - 0.5 * excess[1]) / distances[0]
    np.testing.assert_allclose(derivative, -growth.changes / slopes, rtol=1e-3)
    assert growth.least == growth.changes.min() > growth.error > 0.0


def test_forward_slip_is_tried_where_full_stick_would_not_exceed_the_friction(from_largest_load):
    search = from_largest_load._search(0.8)
    zones = search.forward_zones
    np.testing.assert_allclose(zones.logits, search.outcome().layout.logits, atol=5e-3)
    outer = Radius.from_logit(zones.logits[1])
    place = np.array([outer.value]), np.array([outer.from_edge])
    ratio = search.stick.traction(*place) / search.stick.pressure.evaluate(np.array([outer.rest]))
    assert ratio == pytest.approx(SCENE.friction / SCENE.kappa, rel=1e-6)


def test_slip_back_is_left_out_with_its_boundaries():
    zones = Layout((-1.0, 0.0, 1.0, 2.0), (0, 1, 0, -1, 0))
    assert unloading._without_reverse_slip(zones) == Layout((-1.0, 0.0), (0, 1, 0))
    edge = Layout((-1.0, 0.0, 1.0), (0, 1, 0, -1))
    assert unloading._without_reverse_slip(edge) == Layout((-1.0, 0.0), (0, 1, 0))


def test_slip_that_is_missing_is_where_friction_is_exceeded(from_largest_load):
    # below the reverse ratio without slip back
    search = from_largest_load._search(0.2)
    solved = search.solve_zones(search.forward_zones)
    assert solved.system.states == (0, 1, 0)
    missing = unloading._with_missing_slip(solved)
    assert missing.states == (0, 1, 0, -1)
    found = from_largest_load._search(0.2).outcome()
    assert [zone.sense for zone in found.zones] == [1, 1, 1, -1]
    # slip back relieves what sticks beside it
    assert missing.logits[2] < found.layout.logits[2]


def test_where_nothing_exceeds_friction_no_slip_is_missing(from_largest_load):
    search = from_largest_load._search(0.8)
    assert unloading._with_missing_slip(search.solve_zones(search.forward_zones)) is None


def test_a_state_that_turned_names_the_load(from_largest_load, monkeypatch):
    known = SimpleNamespace(value=0.22, error=0.0)
    monkeypatch.setattr(Unloading, "turning_ratio", known)
    with pytest.raises(HistoryError, match=r"turning ratio 0\.22 "):
        from_largest_load.state(0.15, unloading._unrecorded)


def test_a_state_that_turned_is_refused_where_the_turning_ratio_is_not_found(
    from_largest_load, monkeypatch
):
    def not_found(_):
        raise NoZonesError("not found")

    monkeypatch.setattr(Unloading, "turning_ratio", property(not_found))
    with pytest.raises(HistoryError, match="turning ratio, which was not found"):
        from_largest_load.state(0.15, unloading._unrecorded)


def test_unknown_zones_that_miss_the_tolerance_are_no_answer(from_largest_load, monkeypatch):
    zones_outcome = unloading.zones_outcome
    refine = unloading.refine
    error = 1.0

    def missed(problem, tolerance, max_unknowns):
        refinement = refine(problem, tolerance, max_unknowns)
        return replace(refinement, best=replace(refinement.best, error=2.0 * tolerance))

    def uncertain(*given):
        return replace(zones_outcome(*given), zones_error=error)

    monkeypatch.setattr(unloading, "refine", missed)
    monkeypatch.setattr(unloading, "zones_outcome", uncertain)
    with pytest.raises(NoZonesError, match="the tolerance is not met from these boundaries"):
        from_largest_load._search(0.8).outcome()
    error = 0.5  # a digit is known: it is returned, and has not converged
    assert from_largest_load._search(0.8).outcome().zones_error == error


def test_zones_that_cannot_be_followed_are_searched_for(from_largest_load, monkeypatch):
    search = from_largest_load._search(0.2)
    searched = search.outcome().zones

    def fails(_, zones):
        raise NoZonesError("no boundaries near by")

    monkeypatch.setattr(unloading.UnloadedSearch, "solve_zones", fails)
    found = from_largest_load._search(0.2).followed(search.forward_zones)
    assert found.layout.states == (0, 1, 0, -1)
    assert [radius.value for radius in found.system.radii] == pytest.approx(
        [zone.outer for zone in searched[:-1]], rel=1e-9
    )


def test_slip_that_is_missing_next_to_slip_is_no_zone_of_its_own(from_largest_load, monkeypatch):
    search = from_largest_load._search(0.8)
    solved = search.solve_zones(search.forward_zones)
    ratios = unloading._friction_ratios

    def forward(one, part):
        y, ratio = ratios(one, part)
        return np.array([y, np.where(y > 0.5, 1.1, ratio)])

    monkeypatch.setattr(unloading, "_friction_ratios", forward)
    assert unloading._with_missing_slip(solved) is None


def test_the_reverse_ratio_is_just_below_where_cycles_shake_down(from_largest_load):
    found = from_largest_load.reverse_ratio
    assert isinstance(found, LoadRatio)
    assert abs(found.value / 0.2221247691538 - 1.0) <= found.error
    assert found.error < 1e-6


def test_a_margin_that_does_not_follow_the_load_has_no_reverse_ratio(
    from_largest_load, monkeypatch
):
    monkeypatch.setattr(unloading, "_reverse_margin", lambda solved: 1e-3)
    fresh = copy(from_largest_load)
    vars(fresh).pop("_onset_of_reverse_slip", None)
    with pytest.raises(NoZonesError, match="does not follow the load"):
        _ = fresh.reverse_ratio


def test_narrow_forward_slip_is_found_next_to_the_critical_friction():
    # 1 % below the critical friction
    scene = Scene(0.3, 0.5, 0.5, 0.1)
    states = [
        solve(scene.replace(unloaded_to=one), 1e-6, ["zones", "total_shear"])
        for one in (0.95, 0.9, 0.85)
    ]
    ends = [one.zones[0].outer_from_edge for one in states]
    assert ends[0] < ends[1] < ends[2]
    shears = [one.total_shear for one in states]
    # nearly in proportion to the load
    assert shears[1] == pytest.approx((shears[0] + shears[2]) / 2.0, rel=1e-7)


def test_narrow_forward_slip_is_found_at_lower_loads():
    stick = Scene(0.1, 0.5, 0.5, math.inf)
    critical = solve(stick, 1e-9, ["critical_friction"]).critical_friction
    scene = stick.replace(friction=0.99 * critical, unloaded_to=0.6)
    found = solve(scene, 1e-6, ["total_shear", "zones"])
    assert [zone.kind for zone in found.zones] == ["stick", "slip", "stick"]
    closer = solve(scene, 1e-8, ["total_shear", "zones"])
    assert abs(found.total_shear / closer.total_shear - 1.0) <= found.error.total_shear


def test_narrow_forward_slip_is_found_at_all_loads():
    """Its outer end hardly moves, and its inner end moves in proportion to what is taken off."""
    scene = Scene(0.1, 0.5, 0.5, 0.99 * 0.157139600873)  # 1 % below the critical friction
    loaded = solve(scene, 1e-10, ["zones"]).zones[0].outer
    moves = []
    for share in (0.1, 1e-3, 1e-6):
        found = solve(scene.replace(unloaded_to=1.0 - share), 1e-6, ["zones", "total_shear"])
        moves.append((loaded - found.zones[0].outer) / share)
        assert found.zones[1].outer - loaded == pytest.approx(5e-5, rel=0.01)
    assert moves[0] == pytest.approx(moves[1], rel=0.15)
    assert moves[2] == pytest.approx(moves[1], rel=0.02)


def test_a_zone_whose_growth_is_unknown_is_refused(from_largest_load, monkeypatch):
    growth = unloading.ZoneGrowth(np.array([-1.0]), -1.0, 0.1)
    monkeypatch.setattr(unloading.UnloadedSearch, "growth", lambda search, solved: growth)
    # the load is well above the turning ratio, where no zone shrinks
    monkeypatch.setattr(Unloading, "turning_ratio", LoadRatio(0.22, 0.0))
    with pytest.raises(NoZonesError, match="too narrow to say whether it grows"):
        from_largest_load.state(0.8, unloading._unrecorded)


def test_a_load_far_below_the_turning_ratio_is_refused_as_such(from_largest_load, monkeypatch):
    """There no zones may be found, and that they are too narrow would be no reason."""
    monkeypatch.setattr(Unloading, "turning_ratio", LoadRatio(0.22, 1e-9))
    with pytest.raises(HistoryError, match=r"below the turning ratio 0\.22 it depends"):
        from_largest_load.state(1e-3, unloading._unrecorded)


def test_a_load_that_is_the_largest_one_up_to_rounding_is_refused():
    """The change of the traction is rounding, and so are the zones that follow from its sign."""
    scene = SCENE.replace(unloaded_to=math.nextafter(1.0, 0.0))
    with pytest.raises(NotComputedError, match="the load is the largest one up to rounding"):
        solve(scene, 1e-4, ["total_shear"])


def test_thick_layers_slip_on_in_a_narrow_zone():
    """It was refused, as slip is but 1e-3 of the radius wide."""
    scene = Scene(0.45, 26.5, 26.5, 9.34e-5, unloaded_to=0.85)
    found, closer = (solve(scene, rtol, ["total_shear", "zones"]) for rtol in (1e-4, 1e-8))
    assert [zone.kind for zone in found.zones] == ["stick", "slip", "stick"]
    assert found.zones[1].outer - found.zones[0].outer < 2e-3
    assert abs(found.total_shear / closer.total_shear - 1.0) <= found.error.total_shear


def test_a_load_next_to_the_largest_one_is_solved_for_at_any_tolerance():
    scene = Scene(0.3, 0.05, 0.02, 0.0756, unloaded_to=0.999)
    found, closer = (solve(scene, rtol, ["total_shear", "zones"]) for rtol in (1e-2, 1e-8))
    assert [zone.kind for zone in found.zones] == ["stick", "slip", "stick"]
    for zone, close in zip(found.zones[:-1], closer.zones[:-1], strict=True):
        assert abs(zone.outer / close.outer - 1.0) <= found.error.zones
    assert abs(found.total_shear / closer.total_shear - 1.0) <= found.error.total_shear
