"""Sweeps through executors: threads, processes and a real cluster; workers may be killed."""

import multiprocessing
import os
import signal
import subprocess
import sys
import threading
import time
from concurrent.futures import Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from contextlib import ExitStack, contextmanager

import numpy as np
import pytest

from spectral_contact import Scene, SolutionFileError
from spectral_contact.sweeps import chunk, sweep

pytest.importorskip("xarray", reason="part of the extra: sweep")

BASE = Scene(0.3, 0.5, 0.5, 0.1)
ASKED = {
    "friction": np.linspace(0.02, 0.2, 12),
    "quantities": ["stick_radius", "total_shear"],
    "chunk": 3,
}
SPAWN = multiprocessing.get_context("spawn")


@pytest.fixture(scope="module")
def expected():
    return sweep(BASE, **ASKED)


def test_threads(expected):
    with ThreadPoolExecutor(2) as pool:
        assert sweep(BASE, **ASKED, executor=pool).identical(expected)


def test_processes_and_their_store(expected, tmp_path):
    with ProcessPoolExecutor(2, SPAWN) as pool:
        assert sweep(BASE, **ASKED, executor=pool, store=tmp_path).identical(expected)
    assert sweep(BASE, **ASKED, store=tmp_path).identical(expected)


class Watched(ThreadPoolExecutor):
    """Notes how many chunks wait or are worked on whenever another one is handed in."""

    def __init__(self):
        super().__init__(1)
        self.futures, self.pending = [], []

    def submit(self, function, /, *arguments, **options):
        self.pending.append(sum(not one.done() for one in self.futures))
        self.futures.append(super().submit(function, *arguments, **options))
        return self.futures[-1]


def test_chunks_are_handed_in_a_few_at_a_time(expected, monkeypatch):
    monkeypatch.setattr(chunk, "_MOST_SUBMITTED", 2)
    with Watched() as pool:
        assert sweep(BASE, **ASKED, executor=pool).identical(expected)
    assert len(pool.futures) == 4
    assert max(pool.pending) <= 1


def test_chunks_that_have_not_begun_are_called_off(monkeypatch, tmp_path):
    """One thread works on the first chunk when the disk turns out to be full."""
    begun = []
    original = chunk.solve_chunk

    def slow(*arguments):
        begun.append(1)
        time.sleep(0.2)
        return original(*arguments)

    def full(*_):
        raise SolutionFileError("store", "cannot be written (No space left on device)")

    monkeypatch.setattr(chunk, "solve_chunk", slow)
    monkeypatch.setattr("spectral_contact.sweeps.sweep_run.Store.put", full)
    with ThreadPoolExecutor(1) as pool, pytest.raises(SolutionFileError, match="No space left"):
        sweep(BASE, **ASKED, executor=pool, store=tmp_path)
    assert len(begun) <= 2


def test_an_error_of_the_executor_is_not_hidden():
    class Refusing(Executor):
        def submit(self, function, /, *arguments, **options):
            future = Future()
            future.set_exception(ModuleNotFoundError("No module named 'spectral_contact'"))
            return future

    with pytest.raises(ModuleNotFoundError, match="spectral_contact"):
        sweep(BASE, **ASKED, executor=Refusing())


def test_a_process_that_is_killed_costs_time_alone(expected, caplog):
    with ProcessPoolExecutor(1, SPAWN) as pool:
        victim = pool.submit(os.getpid).result()
        pool.submit(os.kill, victim, signal.SIGKILL)
        assert sweep(BASE, **ASKED, executor=pool).identical(expected)
    assert "the executor broke" in caplog.text


# --- a cluster ------------------------------------------------------------------------------------


@contextmanager
def command(*arguments):
    """Run a module of `distributed` in a process of its own."""
    process = subprocess.Popen(
        [sys.executable, "-m", *arguments], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    try:
        yield process
    finally:
        process.kill()
        process.wait()


@pytest.fixture
def cluster(tmp_path):
    """A scheduler and two workers on loopback; returns a client and the workers' processes."""
    distributed = pytest.importorskip("distributed")
    where = str(tmp_path / "scheduler.json")
    with ExitStack() as stack:
        options = ("--host", "127.0.0.1", "--port", "0", "--no-dashboard")
        scheduler = "distributed.cli.dask_scheduler"
        stack.enter_context(command(scheduler, *options, "--scheduler-file", where))
        workers = [
            stack.enter_context(
                command(
                    "distributed.cli.dask_worker",
                    "--scheduler-file",
                    where,
                    *("--host", "127.0.0.1", "--nthreads", "1", "--no-nanny", "--no-dashboard"),
                    *("--local-directory", str(tmp_path)),
                )
            )
            for _ in range(2)
        ]
        client = stack.enter_context(distributed.Client(scheduler_file=where, timeout=60))
        client.wait_for_workers(2, timeout=60)
        yield client, workers


@pytest.mark.filterwarnings("default")  # those of distributed are its own
def test_a_dask_cluster_loses_a_worker_and_the_sweep_nothing(cluster, expected, tmp_path):
    client, workers = cluster
    folder = tmp_path / "store"

    def kill():
        while not (folder / "000000.npz").exists():
            time.sleep(0.005)
        workers[0].send_signal(signal.SIGKILL)

    assert sweep(BASE, **ASKED, executor=client.get_executor()).identical(expected)
    killer = threading.Thread(target=kill)
    killer.start()
    asked = {**ASKED, "chunk": 1}
    found = sweep(BASE, **asked, executor=client.get_executor(), store=folder)
    killer.join()
    workers[0].wait()
    for name in ("stick_radius", "total_shear"):
        assert np.allclose(found[name], expected[name], rtol=1e-12)
    assert (found.ending == "converged").all()
    assert len(list(folder.glob("*.npz"))) == 12
