"""Ctrl-C, TERM, a kill and a closed stdout, in processes of their own."""

import os
import signal
import subprocess
import sys
import threading
import time
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import _ExecutorManagerThread
from pathlib import Path

import pytest

from spectral_contact.processes import _Terminated, guarded, workers

MODULE = (sys.executable, "-m", "spectral_contact")
#: The time of imports is spent where it can be found.
SITE = """
import os, sys, time
from importlib.abc import MetaPathFinder
class Slow(MetaPathFinder):
    def find_spec(self, name, *_):
        if name == {name!r}:
            open(os.environ["REACHED"], "w").close()
            time.sleep(60)
sys.meta_path.insert(0, Slow())
"""


def heard():
    """Let a child hear Ctrl-C, also where this process does not, as after nohup."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def start(*arguments, heard=heard, **environment):
    return subprocess.Popen(
        arguments,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        preexec_fn=heard,
        env=os.environ | environment,
    )


def wait_until(condition, process=None):
    end = time.monotonic() + 120
    while not condition():
        assert process is None or process.poll() is None, process.stderr.read()
        assert time.monotonic() < end
        time.sleep(0.02)


def alive(number):
    """Whether a process runs, and is not one that nobody has collected."""
    try:
        return Path(f"/proc/{number}/stat").read_text().rpartition(") ")[2][0] not in "ZX"
    except FileNotFoundError:
        return False


def children(number):
    found = Path(f"/proc/{number}/task/{number}/children").read_text()
    return [int(one) for one in found.split()]


# --- Ctrl-C and TERM ------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "module",
    ["numpy", "spectral_contact.view.cli.sweep_command", "spectral_contact.sweeps.sweep_run"],
)
def test_ctrl_c_while_it_imports_ends_it_without_a_traceback(tmp_path, module):
    (tmp_path / "sitecustomize.py").write_text(SITE.format(name=module))
    reached = tmp_path / "reached"
    path = os.pathsep.join([str(tmp_path), *filter(None, sys.path)])
    process = start(*MODULE, "solve", PYTHONPATH=path, REACHED=str(reached))
    wait_until(reached.exists, process)
    process.send_signal(signal.SIGINT)
    assert process.communicate() == ("", "")
    assert process.returncode == -signal.SIGINT


def test_other_programs_keep_their_ctrl_c():
    code = "import signal, spectral_contact; print(signal.getsignal(signal.SIGINT))"
    process = start(sys.executable, "-c", code)
    assert "default_int_handler" in process.communicate()[0]


@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="looks for processes in /proc")
@pytest.mark.parametrize(
    ("number", "status", "said"),
    [
        (signal.SIGINT, 130, "spectral-contact: interrupted\n"),
        (signal.SIGTERM, 143, "spectral-contact: terminated\n"),
        (signal.SIGKILL, -9, None),
    ],
)
def test_workers_end_with_their_parent(tmp_path, number, status, said):
    pytest.importorskip("xarray", reason="part of the extra: sweep")
    sweep = ("--friction", "0.01:0.12:4000", "--workers", "2", "--store", str(tmp_path / "store"))
    process = start(*MODULE, "sweep", *sweep)
    wait_until(lambda: list(tmp_path.glob("store/*.npz")), process)
    own = children(process.pid)
    assert len(own) >= 2  # and the one that collects semaphores
    if number == signal.SIGINT:
        os.killpg(process.pid, number)  # as a terminal does
    else:
        process.send_signal(number)
    out, err = process.communicate()
    assert (process.returncode, out) == (status, "")
    assert said is None or err == said, err
    wait_until(lambda: not any(map(alive, own)))


def deaf(_):
    time.sleep(0.5)  # the other worker has to do the next
    return os.getpid(), signal.getsignal(signal.SIGINT) is signal.SIG_IGN


def test_no_worker_ever_hears_ctrl_c():
    with workers(2) as pool:
        found = dict(pool.map(deaf, range(2)))
    assert list(found.values()) == [True, True]
    assert not deaf(None)[1]


def call_off_what_waits():
    with workers(2) as pool:
        futures = [pool.submit(time.sleep, 60.0) for _ in range(9)]
        wait_until(futures[1].running)
        # two run, and up to three more wait where they can no longer be called off
        assert [one.cancel() for one in futures][-4:] == [True] * 4
        raise _Terminated


def test_what_is_called_off_and_loses_its_worker_is_no_error(monkeypatch):
    complaints, shutdown = [], ProcessPoolExecutor.shutdown

    def late(*arguments, **keywords):
        time.sleep(0.3)  # the pool hears of what was done before
        shutdown(*arguments, **keywords)

    monkeypatch.setattr(threading, "excepthook", complaints.append)
    monkeypatch.setattr(ProcessPoolExecutor, "shutdown", late)
    with pytest.raises(_Terminated):
        call_off_what_waits()
    assert not complaints


def test_what_is_called_off_is_dropped_after_the_pool_was_left(monkeypatch):
    """Under load the thread of a pool may come to it no sooner; it must not miss the pool then."""
    complaints, drop = [], _ExecutorManagerThread.flag_executor_shutting_down

    def late(thread):
        time.sleep(0.3)
        drop(thread)

    monkeypatch.setattr(threading, "excepthook", complaints.append)
    monkeypatch.setattr(_ExecutorManagerThread, "flag_executor_shutting_down", late)
    with pytest.raises(_Terminated):
        call_off_what_waits()
    for thread in threading.enumerate():
        if isinstance(thread, _ExecutorManagerThread):
            thread.join(60.0)
    assert not complaints


POOL = """
import sys
import numpy as np
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from spectral_contact import Scene
from spectral_contact.sweeps import sweep
with ProcessPoolExecutor(1, get_context(sys.argv[1])) as pool:
    friction = np.linspace(0.01, 0.12, 4000)
    sweep(Scene(0.3, 0.5, 0.5), friction=friction, executor=pool, store=sys.argv[2])
"""


@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="looks for processes in /proc")
@pytest.mark.parametrize("method", ["spawn", "fork"])
def test_workers_of_any_pool_end_with_their_parent(tmp_path, method):
    pytest.importorskip("xarray", reason="part of the extra: sweep")
    process = start(sys.executable, "-c", POOL, method, str(tmp_path / "store"))
    wait_until(lambda: list(tmp_path.glob("store/*.npz")), process)
    own = children(process.pid)
    assert own
    process.kill()
    process.communicate()
    wait_until(lambda: not any(map(alive, own)))


def test_ctrl_c_that_is_ignored_stays_ignored():
    code = "import os, signal, spectral_contact.processes as p; "
    code += "print(p.guarded(lambda: os.kill(os.getpid(), signal.SIGINT) or 7))"

    def deaf():
        signal.signal(signal.SIGINT, signal.SIG_IGN)

    assert start(sys.executable, "-c", code, heard=deaf).communicate()[0] == "7\n"


@pytest.mark.parametrize(
    ("error", "status", "said"),
    [(KeyboardInterrupt, 130, "interrupted"), (_Terminated, 143, "terminated")],
)
def test_what_is_stopped_says_so(capsys, error, status, said):
    def run():
        raise error

    before = signal.getsignal(signal.SIGTERM)
    assert guarded(run) == status
    assert capsys.readouterr().err == f"spectral-contact: {said}\n"
    assert signal.getsignal(signal.SIGTERM) is before


def test_term_ends_what_is_being_done(capsys):
    assert guarded(lambda: os.kill(os.getpid(), signal.SIGTERM) or time.sleep(60)) == 143
    assert capsys.readouterr().err == "spectral-contact: terminated\n"


def test_work_in_progress_is_not_waited_for():
    def interrupted():
        with workers(2) as executor:
            begun = executor.submit(time.sleep, 300.0)
            wait_until(begun.running)
            raise KeyboardInterrupt

    begin = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert time.monotonic() - begin < 150.0


def test_one_worker_is_this_process():
    with workers(1) as executor:
        assert executor is None


# --- stdout and stderr ----------------------------------------------------------------------------

SHELL = f"{sys.executable} -m spectral_contact"


@pytest.mark.parametrize(
    ("command", "status", "said"),
    [
        ("{} solve --quantities approach >&-", 0, ""),
        ("{} solve --load 1 >&-", 2, "--youngs-modulus, --poisson-ratio"),
        ("{} solve --load 1 2>&-", 2, ""),
        ("{} solve --load 1 2>/dev/full", 2, ""),
    ],
)
def test_streams_that_are_closed(command, status, said):
    options = {"capture_output": True, "text": True, "check": False}
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONUNBUFFERED"}
    done = subprocess.run(["bash", "-c", command.format(SHELL)], env=environment, **options)
    assert (done.returncode, done.stdout) == (status, "")
    assert said in done.stderr
    assert done.stderr.count("\n") == bool(said)


@pytest.mark.parametrize(("option", "status"), [("--help", 0), ("--load=1", 2)])
def test_a_pipe_that_nobody_reads(option, status):
    reader, writer = os.pipe()
    os.close(reader)
    command = [*MODULE, "solve", option]
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONUNBUFFERED"}
    done = subprocess.run(
        command, env=environment, stdout=writer, stderr=subprocess.PIPE, text=True, check=False
    )
    os.close(writer)
    assert done.returncode == status
    assert done.stderr.count("\n") == bool(status)
