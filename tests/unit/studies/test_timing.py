"""Times by a clock of our own, and fresh processes that do what they should."""

import sys
from functools import partial

import numpy as np
import peers
import pytest
from threadpoolctl import threadpool_limits

from spectral_contact import Scene, SceneError, threads
from spectral_contact.studies import Stopwatch, Timing, timed_process, timing

SCENE = Scene(0.3, 0.5)
ONCE = Stopwatch(repeats=1, seconds=0.0, processes=1)


class Clock:
    """A clock that goes on only when work is done."""

    def __init__(self, costs):
        self.now, self.costs, self.calls = 0.0, iter(costs), 0

    def __call__(self):
        return self.now

    def work(self):
        self.calls += 1
        self.now += next(self.costs)


def times(costs, **stopwatch):
    clock = Clock(costs)
    found = timing.repeated(clock.work, Stopwatch(**stopwatch), clock)
    assert clock.calls == len(found)
    return found


def test_repeats_reach_both_their_number_and_their_time():
    assert times([1.0] * 9, repeats=5, seconds=0.2) == [1.0] * 5
    assert times([0.25] * 9, repeats=2, seconds=2.0) == [0.25] * 8


def test_repeats_of_slow_work_end():
    assert times([4.0, 7.0, 1.0], repeats=5, longest=10.0) == [4.0, 7.0]
    assert times([30.0, 1.0], repeats=5, longest=10.0) == [30.0]


def test_median_and_quartiles():
    one = Timing.of([5.0, 1.0, 2.0, 4.0, 30.0])
    assert one == Timing(4.0, 2.0, 5.0, 5)


@pytest.mark.parametrize(
    ("name", "value"),
    [("repeats", 0), ("repeats", 2.5), ("processes", 0), ("seconds", -1.0), ("longest", np.nan)],
)
def test_a_stopwatch_is_checked(name, value):
    with pytest.raises(SceneError, match=name):
        Stopwatch(**{name: value})


def test_an_importable_solver_is_timed_in_fresh_processes_with_one_thread(monkeypatch):
    monkeypatch.setenv("OPENBLAS_NUM_THREADS", "3")
    with pytest.raises(RuntimeError, match="more than one"):
        peers.environment(SCENE, 4)
    found = timing.times_of(
        peers.environment, SCENE, 4, Stopwatch(repeats=3, seconds=0.0, processes=2)
    )
    assert (found.cold.repeats, found.warm.repeats) == (2, 3)
    assert (found.blas_threads, found.note) == (1, "")
    assert 0.0 < found.warm.median < 1.0


@pytest.mark.parametrize(
    ("solver", "note"),
    [
        (lambda scene, count: peers.Decaying(scene, count), "not importable"),
        (partial(lambda scene, count: None), "not importable"),
        (peers.only_here, "a fresh process failed: RuntimeError: away from home"),
    ],
    ids=["lambda", "partial", "fails elsewhere"],
)
def test_other_solvers_are_timed_here_and_it_is_said(monkeypatch, solver, note):
    calls = []
    original = timing.subprocess.run

    def marked(*arguments, env, **options):
        calls.append(arguments)
        return original(*arguments, env=env | {"SPECTRAL_CONTACT_TEST_HOME": "1"}, **options)

    monkeypatch.setattr(timing.subprocess, "run", marked)
    found = timing.times_of(solver, SCENE, 4, Stopwatch(repeats=4, seconds=0.0))
    assert found.cold is None
    assert found.warm.repeats == 4
    assert found.note.startswith(note)
    assert bool(calls) == (solver is peers.only_here)


def test_the_main_script_cannot_be_imported_elsewhere(monkeypatch):
    monkeypatch.setattr(sys.modules["__main__"], "solver", peers.Decaying, raising=False)
    monkeypatch.setattr(peers.Decaying, "__module__", "__main__")
    monkeypatch.setattr(sys.modules["__main__"], "Decaying", peers.Decaying, raising=False)
    found = timing.times_of(peers.Decaying, SCENE, 4, ONCE)
    assert found.note == "not importable: it is defined in the main script"


def test_imports_that_a_solver_puts_off_are_not_counted(monkeypatch, tmp_path):
    text = "import time\nfrom peers import Decaying as solver\ntime.sleep(0.5)\n"
    (tmp_path / "imported_late.py").write_text(text)
    monkeypatch.syspath_prepend(tmp_path)
    assert timing.times_of(peers.imports_late, SCENE, 4, ONCE).cold.median < 0.25


@pytest.mark.parametrize(
    ("variables", "count"),
    [({"OPENBLAS_NUM_THREADS": "2"}, 2), ({"OMP_NUM_THREADS": "4"}, 4), ({}, None)],
)
def test_threads_of_this_process_are_what_the_environment_says(monkeypatch, variables, count):
    """If no BLAS is found that can be asked."""
    monkeypatch.setattr(threads._HOLD, "_libraries", [])
    monkeypatch.setattr(timing, "look_for_blas", lambda: None)
    for name in threads.THREADS:
        monkeypatch.delenv(name, raising=False)
    for name, value in variables.items():
        monkeypatch.setenv(name, value)
    assert timing.times_of(lambda *_: None, SCENE, 4, ONCE).blas_threads == count


def test_libraries_that_the_solver_brought_are_held(monkeypatch):
    monkeypatch.setattr(threads._HOLD, "_libraries", [])
    held = []

    def own(*_):
        held.extend(library.number() for library in threads._HOLD._libraries)

    with threadpool_limits(3, "blas"):
        assert timing.times_of(own, SCENE, 4, ONCE).blas_threads == 1
    assert set(held) == {1}


def test_the_worker_is_what_the_fresh_process_starts():
    assert "spectral_contact.studies.timed_process import main" in timing._START
    assert callable(timed_process.main)
