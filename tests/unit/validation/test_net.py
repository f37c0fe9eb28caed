"""The net of ../validation/net.py: that it catches what it is there for."""

import itertools
import math
import sys
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from spectral_contact import Scene, solve

sys.path += [
    str(folder)
    for folder in (Path(__file__).parents[3] / "validation").glob("**/")
    if folder.name != "results"
]

import honesty
import net_checks
import net_speed
from honesty_errors import compare, unexplained, violates
from honesty_scenes import outcome
from net import Section
from net_kept import Kept, kept_row, row_of, scene_of

SLIPPING = Scene(0.3, 0.5, 0.5, 0.05)


@pytest.fixture(scope="module")
def truth():
    return Kept(kept_row(solve(SLIPPING, 1e-12)))


def seen(solution, **changed):
    """Return an object like a solution with some things changed."""
    names = ("scene", "zones", "error", "opening", "approach", "total_shear", "stick_radius")
    same = {name: getattr(solution, name) for name in names}
    fields = {name: getattr(solution, name) for name in ("pressure", "traction", "slip")}
    return SimpleNamespace(**same | fields | changed)


def violated(solution, truth):
    found = compare(solution, truth, truth.at)
    return {name for name, triple in found.items() if violates(*triple)}


@pytest.mark.parametrize(
    ("own", "violations", "undecided"), [(1e-12, 1, False), (1e-6, 0, True), (math.inf, 0, True)]
)
def test_a_truth_that_is_not_known_decides_nothing(own, violations, undecided):
    row = {"errors": {"approach": (1e-7, 1e-9, own), "pressure": (1e-12, 1e-9, own)}}
    assert len(honesty.violations_of(row)) == violations
    assert honesty.undecided(row) is undecided


@pytest.mark.parametrize(
    ("changed", "known", "found"),
    [
        ({}, 1e-3, []),
        ({"violation": 1e-4}, 1e-3, ["violation"]),
        ({"violation": 1e-4, "slip": 1e-3}, 1e-3, []),
        ({"violation": 1e-4, "slip": math.inf}, 1e-3, ["violation", "slip"]),
        ({"slip": math.inf}, math.inf, []),
    ],
)
def test_an_infinite_estimate_of_slip_explains_nothing(changed, known, found):
    solution = solve(SLIPPING, 1e-6)
    solution = replace(solution, error=replace(solution.error, **changed))
    closest = replace(solution, error=replace(solution.error, slip=known))
    assert unexplained(solution, closest) == found
    row = {"errors": {}, "unexplained": found}
    assert [one["unexplained"] for one in honesty.violations_of(row)] == found


@pytest.mark.parametrize("coupled", [False, True])
def test_the_honesty_study_has_a_truth_for_every_kind_of_scene(coupled):
    row = outcome(1, 1, exact=False, coupled=coupled)
    assert "raised" not in row
    assert honesty.violations_of(row) == []


@pytest.mark.parametrize("rtol", [1e-3, 1e-9])
def test_an_honest_solution_passes_a_kept_truth(truth, rtol):
    assert violated(solve(SLIPPING, rtol), truth) == set()


@pytest.mark.parametrize("name", ["pressure", "traction", "slip"])
def test_a_wrong_field_is_caught_by_a_kept_truth(truth, name):
    solution = solve(SLIPPING, 1e-9)
    by = 1.0 + 3.0 * getattr(solution.error, name) + 3.0 * solution.error.zones + 1e-12

    def wrong(*args, **kwargs):
        return by * getattr(solution, name)(*args, **kwargs)

    assert violated(seen(solution, **{name: wrong}), truth) == {name}


def test_a_kept_traction_goes_on_by_its_slope(truth):
    solution = solve(SLIPPING, 1e-12)
    at = truth.at[(truth.at > 1e-3) & (truth.at < 0.4)]
    for moved in (at, at * (1.0 + 1e-4)):
        assert truth.traction(from_edge=moved) == pytest.approx(
            solution.traction(from_edge=moved), rel=1e-6
        )


def test_scenes_are_kept_exactly():
    for scene in (SLIPPING, Scene(0.1, 0.0, 1e-14, math.inf, coupling=True), Scene(0.2, 3.0)):
        assert scene_of(row_of(scene)) == scene


def test_the_law_is_kept_by_a_solution_and_missed_where_a_zone_is_missing():
    assert net_checks.off_the_law(solve(SLIPPING, 1e-6)) == []
    stuck = solve(replace(SLIPPING, friction=math.inf), 1e-6)
    [text] = net_checks.off_the_law(seen(stuck, scene=SLIPPING))
    assert text.startswith("stick: friction exceeded")
    solution = solve(SLIPPING, 1e-6)
    [text] = net_checks.off_the_law(seen(solution, slip=lambda *a, **k: -solution.slip(*a, **k)))
    assert text.startswith("slip: 1 of it in the wrong sense")


def times(*values):
    cycle = itertools.cycle(values)
    return lambda: next(cycle)


def test_a_slow_row_is_run_again_before_it_fails():
    row = net_speed.paired(net_speed.Row("", "", "", 0.0), times(1.0), times(1.2), 0.5, 3)
    assert (row.passed, row.runs, row.pairs, row.old) == (False, net_speed.RUNS, 3, 2.0)
    assert row.ratio == pytest.approx(1.2)
    slow_once = times(*[1.2] * 3, *[1.0] * 3)
    row = net_speed.paired(net_speed.Row("", "", "", 0.0), times(1.0), slow_once, 1.0, 3)
    assert (row.passed, row.runs, row.ratio) == (True, 2, 1.0)


def test_what_converged_has_to_converge():
    findings = [net_checks.Finding("a", True), net_checks.Finding("b", False)]
    before = {"a": {"converged": False}, "b": {"converged": False}}
    assert Section("honesty", findings, before).failures == []
    before["b"]["converged"] = True
    assert Section("honesty", findings, before).failures == ["b: does not converge any more"]


def test_a_hard_case_may_not_have_a_much_larger_estimate():
    before = {"converged": True, "estimates": {"zones": 1e-9, "pressure": 1e-16}}
    for estimates, count in (({"zones": 9e-9, "pressure": 9e-13}, 0), ({"zones": 2e-8}, 1)):
        finding = net_checks.Finding("a", True, [], estimates)
        assert len(Section("hard", [finding], {"a": before}).failures) == count
    assert net_checks.worse(net_checks.Finding("a", True, [], {"zones": np.nan}), before)
