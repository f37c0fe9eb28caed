"""Studies on disk: stored whole, refused when foreign, resumed after a kill."""

import csv
import json
import math
import os
import signal
import subprocess
import sys
import time
from dataclasses import replace
from types import SimpleNamespace

import peers
import pytest

import spectral_contact
from spectral_contact import Scene, SolutionFileError
from spectral_contact.studies import OwnSolver, Stopwatch, convergence, load, work_precision

NORMAL = Scene(0.1, 0.5)
LIMIT = SimpleNamespace(approach=0.25)
QUICK = Stopwatch(repeats=1, seconds=0.0, processes=1)
COUNTS = [8, 16, 32, 64]


class Counted:
    """A solver that knows how often it was called."""

    name = "counted"

    def __init__(self):
        self.calls = []

    def __call__(self, scene, count):
        self.calls.append(count)
        if count == 16:
            raise ValueError("never at 16")
        return peers.Decaying(scene, count)


def study(solver=None, resolutions=COUNTS, **options):
    options = {"stopwatch": None, "truth": LIMIT, **options}
    return convergence(solver or Counted(), NORMAL, resolutions, **options)


def refusal(call):
    with pytest.raises(SolutionFileError) as caught:
        call()
    assert "\n" not in str(caught.value)
    return str(caught.value)


# --- results --------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def both():
    one = convergence(
        OwnSolver(), Scene(0.1, 0.5, 0.5, math.inf), [1e-3, 1e-6], LIMIT, stopwatch=None
    )
    many = work_precision(
        {"counted": (Counted(), COUNTS[:2]), "ours": OwnSolver(("approach",))},
        NORMAL,
        [1e-3],
        quantities=["approach"],
        stopwatch=QUICK,
    )
    return {"convergence": one, "work-precision": many}


@pytest.mark.parametrize("kind", ["convergence", "work-precision"])
def test_a_stored_study_is_loaded_again(both, kind, tmp_path):
    path = tmp_path / "study.json"
    both[kind].save(path)
    again = load(str(path))
    assert again == both[kind]
    assert str(again) == str(both[kind])
    document = json.loads(path.read_text(encoding="utf-8"))
    assert (document["study"], document["version"]) == (kind, 1)


def test_infinite_errors_are_stored(tmp_path):
    nothing = study(lambda scene, count: SimpleNamespace(approach=math.nan), [8])
    nothing.save(tmp_path / "x.json")
    assert load(tmp_path / "x.json").points[0].errors == {"approach": math.inf}


def test_the_rates_are_stored_for_other_readers(tmp_path):
    def solver(scene, count):
        return peers.Decaying(scene, count)

    study(solver).save(tmp_path / "x.json")
    rate = json.loads((tmp_path / "x.json").read_text(encoding="utf-8"))["rates"]["approach"]
    assert (rate["kind"], rate["used"]) == ("algebraic", [0, 1, 2, 3])
    assert rate["value"] == pytest.approx(2.0)


def test_a_table_of_the_points(both, tmp_path):
    path = tmp_path / "study.csv"
    both["work-precision"].save(path)
    lines = path.read_text(encoding="utf-8").splitlines()
    comments = [line for line in lines if line.startswith("#")]
    rows = list(csv.DictReader(lines[len(comments) :]))
    assert any("gold table frictionless" in line for line in comments)
    assert any("numpy" in line for line in comments)
    points = both["work-precision"].points
    assert [row["solver"] for row in rows] == [point.solver for point in points]
    assert rows[1]["failure"] == "ValueError: never at 16"
    assert (rows[1]["error_approach"], rows[1]["warm_median_s"]) == ("", "")
    own, point = rows[-1], points[-1]
    assert float(own["error_approach"]) == point.errors["approach"]
    assert float(own["estimate_approach"]) == point.estimates["approach"]
    assert float(own["cold_median_s"]) == point.times.cold.median
    assert int(own["unknowns"]) == point.unknowns
    assert (own["normal_compliance"], own["friction"], own["blas_threads"]) == ("0.5", "", "1")


def test_paths_that_cannot_be(both, tmp_path):
    one = both["convergence"]
    assert "suffix" in refusal(lambda: one.save(tmp_path / "x.npz"))
    assert "cannot be written" in refusal(lambda: one.save(tmp_path / "no" / "x.json"))
    assert "cannot be read" in refusal(lambda: load(tmp_path / "missing.json"))
    assert "not a path" in refusal(lambda: load(3.5))


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"schema": "spectral_contact.gold"}, '"schema" is not "spectral_contact.study"'),
        ({"version": 2}, "version 2 is not known"),
        ({"version": True}, "version True"),
        ({"study": "speed"}, "'speed', not convergence or work-precision"),
        ({"more": 1}, "unknown 'more'"),
        ({"machine": None}, "damaged"),
        ({"points": [{}]}, "a point: keys are missing solver"),
        ({"scene": {}}, "scene"),
    ],
)
def test_what_is_no_study_is_refused(both, tmp_path, change, said):
    path = tmp_path / "study.json"
    both["convergence"].save(path)
    document = json.loads(path.read_text(encoding="utf-8")) | change
    path.write_text(json.dumps(document), encoding="utf-8")
    assert said in refusal(lambda: load(path))


@pytest.mark.parametrize("text", ["", "[]", "{", "\ufeff{}"])
def test_what_is_no_json_is_refused(tmp_path, text):
    path = tmp_path / "study.json"
    path.write_text(text, encoding="utf-8")
    assert "study" in refusal(lambda: load(path))


# --- the store ------------------------------------------------------------------------------------


def test_the_same_call_does_nothing_twice(tmp_path):
    store = tmp_path / "points.jsonl"
    first, second = Counted(), Counted()
    one = study(first, store=store)
    assert first.calls == COUNTS
    assert study(second, store=store) == one
    assert second.calls == []
    third = Counted()
    longer = study(third, [*COUNTS, 128], store=store)
    assert third.calls == [128]
    assert longer.points[:4] == one.points


def test_a_stored_point_keeps_its_times(tmp_path):
    store = tmp_path / "points.jsonl"
    one = study(resolutions=[8], store=store, stopwatch=QUICK)
    assert study(resolutions=[8], store=store, stopwatch=QUICK) == one
    assert one.points[0].times is not None


@pytest.mark.parametrize("kept", [0, 1, 30, -1])
def test_a_line_that_was_cut_is_done_again(tmp_path, kept):
    store = tmp_path / "points.jsonl"
    one = study(store=store)
    whole = store.read_bytes()
    lines = whole.splitlines(keepends=True)
    store.write_bytes(b"".join(lines[:2]) + lines[2][:kept])
    solver = Counted()
    assert study(solver, store=store) == one
    assert solver.calls == [32, 64]
    assert store.read_bytes() == whole


def test_what_is_no_store_is_left_alone(tmp_path):
    for content in (b"my notes", b"my notes\n", b"{}\n", b'{"schema": "other"', b"\xff\xfe\n"):
        store = tmp_path / "notes.txt"
        store.write_bytes(content)
        solver = Counted()
        assert "notes.txt" in refusal(lambda solver=solver, store=store: study(solver, store=store))
        assert store.read_bytes() == content
        assert solver.calls == []


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"stopwatch": QUICK}, "stopwatch"),
        ({"truth": SimpleNamespace(approach=0.25, scene=NORMAL)}, None),
        (
            {"truth": None, "quantities": ["approach"]},
            "of another truth, {'source': 'SimpleNamespace, given'",
        ),
        ({"quantities": ["approach"]}, None),
        ({"truth": SimpleNamespace(approach=0.26)}, "of another truth"),
        ({"name": "other"}, "of solver 'counted'"),
    ],
)
def test_the_store_of_another_study_is_refused(tmp_path, change, said):
    store = tmp_path / "points.jsonl"
    study(store=store)
    if said is None:
        assert len(study(store=store, **change).points) == 4
        return
    message = refusal(lambda: study(store=store, **change))
    assert said in message
    assert "use another store" in message


def test_solvers_and_scenes_may_join_a_store(tmp_path):
    class Here(Counted):
        """Nothing that another process could import, so that it is timed in this one."""

    store, quick = tmp_path / "points.jsonl", {"stopwatch": QUICK, "quantities": ["approach"]}
    one, other = Here(), Here()
    work_precision({"a": (one, [8])}, NORMAL, [1e-2], store=store, **quick)
    called = len(one.calls)
    both = {"a": (one, [8]), "b": (other, [8])}
    found = work_precision(both, [NORMAL, Scene(0.2, 1e-4)], [1e-2], store=store, **quick)
    assert len(found.points) == 4
    assert len(one.calls) == 2 * called  # on the new scene alone
    assert len(other.calls) == 2 * called


def test_another_kind_machine_or_version_is_another_study(tmp_path, monkeypatch):
    store = tmp_path / "points.jsonl"
    study(store=store)

    def compared():
        work_precision({"counted": (Counted(), COUNTS)}, NORMAL, [1e-2], [LIMIT], store=store)

    assert "study 'convergence', not 'work-precision'" in refusal(compared)
    with monkeypatch.context() as patch:
        patch.setattr(spectral_contact, "__version__", "9.9")
        assert "machine" in refusal(lambda: study(store=store))
    text = store.read_text(encoding="utf-8")
    store.write_text(text.replace('"version": 1, "study"', '"version": 2, "study"', 1))
    assert "line 1: version 2 is not known" in refusal(lambda: study(store=store))
    store.write_text(text.replace('"failure"', '"failures"', 1))
    assert "unknown 'failures'" in refusal(lambda: study(store=store))


def test_a_store_that_cannot_be_written_is_found_before_the_work(tmp_path):
    solver = Counted()
    assert "No such file" in refusal(lambda: study(solver, store=tmp_path / "no" / "x.jsonl"))
    assert "directory" in refusal(lambda: study(solver, store=tmp_path))
    assert solver.calls == []


_KILLED = """
import sys, time
import test_study_files as here
from pathlib import Path

class Stuck(here.Counted):
    def __call__(self, scene, count):
        if count == 64:
            Path(sys.argv[1] + ".stuck").touch()
            time.sleep(600)
        return super().__call__(scene, count)

here.study(Stuck(), store=sys.argv[1])
"""


def test_a_killed_run_loses_one_point(tmp_path):
    store = tmp_path / "points.jsonl"
    paths = os.pathsep.join([os.path.dirname(__file__), *sys.path])
    run = subprocess.Popen(
        [sys.executable, "-c", _KILLED, str(store)], env=os.environ | {"PYTHONPATH": paths}
    )
    try:
        while not (tmp_path / "points.jsonl.stuck").exists():
            assert run.poll() is None
            time.sleep(0.02)
    finally:
        run.send_signal(signal.SIGKILL)
        run.wait()
    solver = Counted()
    again = study(solver, store=store)
    assert solver.calls == [64]
    assert again == study()


def test_a_rate_beyond_the_doubles_is_stored(tmp_path):
    found = study(resolutions=[1, 2, 3], solver=peers.Decaying)
    wild = [1e200, 1e130, 1e-13]
    points = tuple(
        replace(point, unknowns=k + 1, errors={"approach": error})
        for k, (point, error) in enumerate(zip(found.points, wild, strict=True))
    )
    found = replace(found, points=points)
    rate = found.rate("approach")
    assert rate.interval[1] == math.inf
    found.save(tmp_path / "x.json")
    assert load(tmp_path / "x.json") == found
    stored = json.loads((tmp_path / "x.json").read_text(encoding="utf-8"))
    assert stored["rates"]["approach"]["interval"][1] == "inf"
    assert str(found)
