"""BLAS held to one thread and given back; forks while threads work."""

import os
import re
import subprocess
import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest
from threadpoolctl import threadpool_info, threadpool_limits

import spectral_contact
from spectral_contact import ConvergenceError, Scene, solve, threads
from spectral_contact import __main__ as cli
from spectral_contact.precise import reference
from spectral_contact.solving.run import Run
from spectral_contact.solving.solver import Continuation
from spectral_contact.sweeps import chunk, sweep, sweep_run
from spectral_contact.sweeps.request import Rows, requested
from spectral_contact.sweeps.sweep_parameters import listed
from spectral_contact.threads import one_thread

SCENE = Scene(0.1, 0.5)


def blas():
    """Return the numbers of threads of all BLAS libraries of this process."""
    return [one["num_threads"] for one in threadpool_info() if one["user_api"] == "blas"]


ONE, THREE = ([number] * len(blas()) for number in (1, 3))


@pytest.fixture
def _three_threads():
    """Let BLAS have three threads, whatever tests are run with, and want them back."""
    with threadpool_limits(3, "blas"):
        assert blas() == THREE
        yield
        assert blas() == THREE


three_threads = pytest.mark.usefixtures("_three_threads")


def solve_chunk():
    request = requested(["approach"], 1e-6, 100, None, None)
    chunk.solve_chunk(listed([SCENE]).columns(np.arange(1)), request, 0, Continuation)


# what is called, and what is called in the midst of it
CALLS = {
    "solve": (lambda: solve(SCENE), Run, "_normal"),
    "continuation": (lambda: Continuation(1e-6, ["approach"], 99).solve(SCENE), Run, "_normal"),
    "reference": (
        lambda: reference(Scene(0.1), 15),
        import_module("spectral_contact.precise.certified"),
        "_compare",
    ),
    "sweep": (lambda: sweep(SCENE, poisson_ratio=[0.1, 0.2]), sweep_run, "_collected"),
    "chunk": (solve_chunk, Rows, "take"),
    "command": (lambda: cli.main(["solve", "--poisson-ratio", "0.1"]), Run, "_normal"),
}


@three_threads
@pytest.mark.parametrize("name", CALLS)
def test_work_is_done_with_one_thread(monkeypatch, name):
    call, owner, attribute = CALLS[name]
    original, inside = getattr(owner, attribute), []

    def spy(*arguments):
        inside.append(blas())
        return original(*arguments)

    monkeypatch.setattr(owner, attribute, spy)
    call()
    assert inside == [ONE] * len(inside) != []


@three_threads
def test_errors_give_back(monkeypatch):
    with pytest.raises(ConvergenceError):
        solve(SCENE, 1e-10, max_unknowns=10)
    assert blas() == THREE

    def stop(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(Run, "_normal", stop)
    with pytest.raises(KeyboardInterrupt):
        solve(SCENE)


@three_threads
def test_the_last_thread_gives_back():
    """The main thread controls threadpoolctl here, and others must be obeyed all the same."""
    with ThreadPoolExecutor(1) as first, ThreadPoolExecutor(1) as second:
        holds = one_thread(), one_thread()
        first.submit(holds[0].__enter__).result()
        second.submit(holds[1].__enter__).result()
        first.submit(holds[0].__exit__, None, None, None).result()
        assert blas() == ONE
        second.submit(holds[1].__exit__, None, None, None).result()
        assert blas() == THREE


@three_threads
def test_many_threads_at_once():
    seen = []

    def work(_):
        with one_thread(), one_thread():
            seen.extend(blas())

    with ThreadPoolExecutor(8) as pool:
        list(pool.map(work, range(200)))
    assert set(seen) == {1}


@three_threads
def test_it_may_be_entered_again():
    with one_thread():
        with one_thread():
            pass
        assert blas() == ONE


@three_threads
def test_a_number_that_was_set_in_the_midst_is_given_back():
    with one_thread(), threadpool_limits(2, "blas"):
        with one_thread():
            assert blas() == ONE
        assert blas() == [2] * len(ONE)


class OfThread:
    """A library in which every thread has a number of its own, four at first."""

    internal_api = "mkl"

    def __init__(self):
        self._own = threading.local()

    @property
    def num_threads(self):
        return vars(self._own).get("number", 4)

    def set_num_threads(self, number):
        self._own.number = number


def test_numbers_of_threads_are_given_back_by_each(monkeypatch):
    library, of_other = OfThread(), one_thread()
    monkeypatch.setattr(threads, "_libraries", lambda: [library])

    def number():
        return library.num_threads

    with ThreadPoolExecutor(1) as other:
        library.set_num_threads(2)
        with one_thread():
            other.submit(of_other.__enter__).result()
            assert (number(), other.submit(number).result()) == (1, 1)
        assert (number(), other.submit(number).result()) == (2, 1)
        other.submit(of_other.__exit__, None, None, None).result()
        assert (number(), other.submit(number).result()) == (2, 4)


# -- in a fresh process ---------------------------------------------------------------------------

PREAMBLE = """
import os, signal, sys, threading
from threadpoolctl import threadpool_info
def blas():
    return {one["num_threads"] for one in threadpool_info() if one["user_api"] == "blas"}
"""

FORKS = """
from spectral_contact import Scene, clear_caches, solve
from spectral_contact.spectral.cache import bounded_cache
from spectral_contact.threads import cached_property, one_thread

def forked(check):
    child = os.fork()
    if child == 0:
        signal.alarm(20)  # a deadlock
        os._exit(0 if check() else 1)
    return os.waitpid(child, 0)[1]

class Held:
    @cached_property
    def slow(self):
        return wait()

inside, done = threading.Event(), threading.Event()
def wait():
    if threading.current_thread() is not threading.main_thread():
        inside.set()
        done.wait()
    return 1

def while_a_thread(work, check):
    inside.clear(), done.clear()
    thread = threading.Thread(target=work)
    thread.start()
    inside.wait()
    status = forked(check)
    done.set()
    thread.join()
    return status

def hold():
    with one_thread():
        wait()

def solves():
    inside.set()
    while not done.is_set():
        clear_caches()
        solve(scene, 1e-4)

scene, cached = Scene(0.1, 0.5, 0.5, 0.1), bounded_cache("held", 2)(wait)
solve(scene, 1e-4)
print("cache", while_a_thread(cached, lambda: cached() == 1))
print("property", while_a_thread(lambda: Held().slow, lambda: Held().slow == 1))
print("blas", while_a_thread(hold, lambda: hold() or blas() == {1}))
print("parent", blas())
for _ in range(5):
    print("solve", while_a_thread(solves, lambda: clear_caches() or solve(scene, 1e-4).converged))
"""

FIRST = """
from spectral_contact import Scene, solve
from spectral_contact.solving.run import Run
original = Run._normal
def spy(*arguments):
    print("inside", blas())
    return original(*arguments)
Run._normal = spy
solve(Scene(0.1, 0.5))
print("after", blas())
"""


def run(code):
    """Run code in a process whose BLAS has two threads, and return what it prints."""
    done = subprocess.run(
        [sys.executable, "-W", "ignore::DeprecationWarning", "-c", PREAMBLE + code],
        env=os.environ | {"OPENBLAS_NUM_THREADS": "2"},
        capture_output=True,
        text=True,
        check=True,
        timeout=120,
    )
    return done.stdout.splitlines()


@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system has no fork")
def test_a_fork_while_threads_work():
    assert run(FORKS) == [
        "cache 0",
        "property 0",
        "blas 0",
        "parent {2}",
        *["solve 0"] * 5,
    ]


def test_no_module_has_cached_properties_with_locks():
    """Those of functools have one before Python 3.12, which a fork may copy while it is held."""
    package = Path(spectral_contact.__file__).parent
    found = [
        path.name
        for path in package.rglob("*.py")
        if re.search(r"from functools import .*\bcached_property\b", path.read_text("utf-8"))
    ]
    assert found == []


def test_the_first_solve_of_a_process_is_held():
    assert run(FIRST) == ["inside {1}", "after {2}"]
