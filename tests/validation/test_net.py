"""The net of ../validation/net/net.py: that it catches what it is there for."""

import itertools
import math
import sys
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from spectral_contact import solve

sys.path += [
    str(folder)
    for folder in (Path(__file__).parents[2] / "validation").glob("**/")
    if folder.name != "results"
]

import bench_solve
import flat_punches
import net
import net_baseline
import net_checks
import net_kept
import net_speed
from honesty_errors import compare, unexplained, violates
from honesty_scenes import outcome
from net import Section
from net_baseline import Baseline
from net_kept import Kept, scene_of

KEPT = net_kept.load()
#: A scene that slips next to the edge of a thick layer.
ROW = next(
    row
    for row in KEPT["honesty"]
    if row["kind"] == "uncoupled" and min(row["scene"][1:3]) > 0.1 and "slip" in row["truth"]
)
SLIPPING = scene_of(ROW["scene"])


@pytest.fixture(scope="module")
def truth():
    return Kept(ROW["truth"])


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
    assert len(flat_punches.violations_of(row)) == violations
    assert flat_punches.undecided(row) is undecided


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
    assert [one["unexplained"] for one in flat_punches.violations_of(row)] == found


@pytest.mark.parametrize("coupled", [False, True])
def test_the_honesty_study_has_a_truth_for_every_kind_of_scene(coupled):
    row = outcome(1, 1, coupled)
    assert "raised" not in row
    assert flat_punches.violations_of(row) == []


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
    return lambda: {"warm": next(cycle)}


def row_of_kind(kind):
    return net_speed.Row("", kind, "warm")


def test_a_slow_row_is_run_again_before_it_is_named():
    [row] = net_speed.compared([row_of_kind("normal")], times(1.0), times(1.2))
    assert (row.passed, row.runs, row.old) == (False, net_speed.RUNS, 1.0)
    assert row.ratio == pytest.approx(1.2)
    slow_once = times(*[1.2] * net_speed.PAIRS, *[1.0] * net_speed.PAIRS)
    [row] = net_speed.compared([row_of_kind("normal")], times(1.0), slow_once)
    assert (row.passed, row.runs, row.ratio) == (True, 2, 1.0)


def test_times_are_compared_by_the_shortest():
    noisy_old = times(1.0, 5.0, 5.0)
    noisy_new = times(9.0, 9.0, 2.0)
    [row] = net_speed.compared([row_of_kind("full stick")], noisy_old, noisy_new)
    assert (row.ratio, row.passed, row.runs) == (2.0, True, 1)


def test_every_row_has_a_limit_by_its_kind():
    kinds = dict(net_speed.cases())
    assert set(kinds.values()) == set(net_speed.LIMITS)
    assert kinds["normal, 0.5, rtol 1e-12"] == "normal"
    assert kinds["approach alone, 0.5, rtol 1e-10"] == "normal"
    assert kinds["full stick, 0.5, rtol 1e-12"] == "full stick"
    assert kinds["partial slip, 0.5, rtol 1e-12"] == "one disk"
    assert kinds["partial slip, 0.5, 0, rtol 1e-12"] == "one disk, β = 0"
    assert kinds["full stick, coupled, 0, rtol 1e-12"] == "coupled"
    assert kinds["critical friction"] == "sweep by spectra"
    assert kinds["c*, Q*, one slip annulus"] == "map of c*, Q*"


def test_a_measurement_is_of_the_library_that_is_asked_for():
    found = net_speed.timed(net_baseline.REPOSITORY, 0)
    assert set(found) == {"import", "first", "cold", "warm"}
    assert 0.0 < found["warm"] <= found["first"]


@pytest.mark.parametrize("place", [0.0, 8.5])
def test_the_added_case_of_slip_inside_has_it(place):
    [case] = [case for case in bench_solve.SOLVES["slip"] if case.problem == "slip inside"]
    kinds = [zone.kind for zone in solve(case.scene(place), 1e-6).zones]
    assert kinds == ["stick", "slip", "stick"]


def test_speed_alone_does_not_fail(monkeypatch, capsys):
    slow = net_speed.Row("slow", "normal", "warm", old=1.0, new=3.0)
    monkeypatch.setattr(net, "speed", lambda commit, quick: [slow])
    finding = net_checks.Finding("a", True)
    monkeypatch.setattr(net, "sections", lambda kept, every: [("coupled thresholds", [finding])])
    monkeypatch.setattr(sys, "argv", ["net.py", "--quick"])
    assert net.main() == 0
    printed = capsys.readouterr()
    assert "**3.00**" in printed.out
    assert "All gates hold. **1 rows are slower than their limits.**" in printed.out
    assert "slow, warm: 3.00, SLOWER than its limit 1.1" in printed.err
    finding.converged = False
    assert net.main() == 1


def test_all_coupled_thresholds_are_listed():
    rows = KEPT["coupled thresholds"]
    assert len(rows) == 20
    assert all(row["scene"][-1] is True and row["zones"] for row in rows)
    assert len({row["name"] for row in rows}) == len(rows)


@pytest.mark.parametrize(("zones", "converged"), [(1e-9, True), (1.0, False)])
def test_coupled_thresholds_have_all_their_zones(monkeypatch, zones, converged):
    solution = solve(SLIPPING, 1e-9)
    solution = replace(solution, error=replace(solution.error, zones=zones))
    monkeypatch.setattr(net_checks, "solve", lambda *args, **kwargs: solution)
    row = {"name": "a", "scene": ROW["scene"], "rtol": 1e-9, "zones": [], "slow": False}
    [finding] = net_checks.threshold_scenes([row], 1, zones_known=True)
    assert (finding.converged, finding.violations) == (converged, [])
    [finding] = net_checks.threshold_scenes([row], 1)
    assert finding.converged


def test_the_baseline_is_stored_as_it_is_loaded(monkeypatch, tmp_path):
    baseline = net_baseline.load()
    assert set(baseline.unconverged) >= {"gold", "hard", "honesty", "thresholds"}
    assert len(baseline.estimates) == 19
    kept = net_baseline.FILE.read_text(encoding="utf-8")
    monkeypatch.setattr(net_baseline, "FILE", tmp_path / "before.json")
    net_baseline.save(baseline)
    assert net_baseline.FILE.read_text(encoding="utf-8") == kept


def test_the_net_is_rebased_by_one_command(monkeypatch, tmp_path):
    monkeypatch.setattr(net_baseline, "FILE", tmp_path / "before.json")
    findings = {
        "gold": [net_checks.Finding("a", True), net_checks.Finding("b", False)],
        "hard": [net_checks.Finding("c", True, [], {"zones": 1e-9})],
    }
    monkeypatch.setattr(net, "sections", lambda kept, every: findings.items())
    net.record("1234567")
    found = net_baseline.load()
    assert found == Baseline("1234567", {"gold": ["b"], "hard": []}, {"c": {"zones": 1e-9}})
    called = []
    monkeypatch.setattr(net_baseline, "checked_out", lambda _: nullcontext(tmp_path))
    monkeypatch.setattr(net_baseline, "git", lambda *words: f"{words[-1]} in full\n".encode())
    monkeypatch.setattr(net.subprocess, "run", lambda *words, **more: called.append((words, more)))
    monkeypatch.setattr(sys, "argv", ["net.py", "--rebase", "1234567"])
    assert net.main() == 0
    [([command], more)] = called
    assert command[-1].endswith("net.record('1234567^{commit} in full')")
    assert more["env"]["PYTHONPATH"].startswith(str(tmp_path))


def test_all_have_to_converge_but_those_that_never_did():
    findings = [net_checks.Finding("a", True), net_checks.Finding("b", False)]
    before = Baseline("", {"honesty": ["b"], "thresholds": ["b"]})
    assert Section("honesty", findings, before).failures == []
    # at a threshold there is no excuse
    for section in ("thresholds", "gold"):
        assert Section(section, findings, before).failures == ["b: does not converge"]


def test_a_hard_case_may_not_have_a_much_larger_estimate():
    before = Baseline("", {}, {"a": {"zones": 1e-9, "pressure": 1e-16}})
    for estimates, count in (({"zones": 9e-9, "pressure": 9e-13}, 0), ({"zones": 2e-8}, 1)):
        finding = net_checks.Finding("a", True, [], estimates)
        assert len(Section("hard", [finding], before).failures) == count
    finding = net_checks.Finding("a", True, [], {"zones": np.nan})
    assert net_checks.worse(finding, before.estimates["a"])
