"""Solves of the explorer in processes of their own, each of which ends in time.

A solve holds its process until it is done, and cannot be told to stop. So it has a process that can
be killed: when its time is over, or when nobody wants its result any more.
"""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
import weakref
from collections.abc import Mapping
from concurrent.futures import Future
from contextlib import suppress
from threading import Lock, Semaphore, Thread, Timer
from time import monotonic
from typing import Any, Final

from spectral_contact.errors import SpectralContactError
from spectral_contact.solving.planning import plan
from spectral_contact.view.explorer.budget import TIME_LIMIT, overtime, refusal
from spectral_contact.view.explorer.shown import Look
from spectral_contact.view.explorer.state import Texts, code_of, rtol_of, scene_of

_WORKER: Final = "spectral_contact.view.explorer.worker"
#: A process that has not imported the library after so many seconds is given up. It takes 1 s on an
#: idle machine.
_START_LIMIT: Final = 120.0
_LOST: Final = "the process that solved this scene has ended before its time. To try it alone, run:"


class LookRequest:
    """One state to be looked at, in its turn.

    Attributes
    ----------
    future : Future of Look or None
        What is to be shown; None if the request was cancelled.
    """

    def __init__(self, texts: Texts) -> None:
        self.texts = dict(texts)
        self.future: Future[Look | None] = Future()
        self.cancelled = False
        self._process: _SolverProcess | None = None
        self._lock = Lock()

    def cancel(self) -> None:
        """End the solve, or do not begin it. What is done already stays done."""
        with self._lock:
            self.cancelled = True
            if self._process is not None:
                self._process.kill()
        self.finish(None)

    def look(self, process: _SolverProcess, seconds: float) -> Look | None:
        """Return what a process has to show; None if it was killed or has ended."""
        with self._lock:
            if self.cancelled:
                return None
            self._process = process
        try:
            return process.look(self.texts, seconds)
        finally:
            with self._lock:  # the next request of this process is not this one's to cancel
                self._process = None

    def finish(self, look: Look | None) -> None:
        """Set what is to be shown, unless that was done before."""
        with self._lock:
            if not self.future.done():
                self.future.set_result(look)


class Solvers:
    """Processes that solve, a bounded number of them, each one scene at a time.

    Parameters
    ----------
    count : int
        The largest number of processes; further requests wait for one of them.
    seconds : float
        The time limit of a solve. Importing the library does not count.
    """

    def __init__(self, count: int = 1, seconds: float = TIME_LIMIT) -> None:
        self.seconds = seconds
        self._slots = Semaphore(count)
        self._idle: list[_SolverProcess] = []
        self._processes: set[_SolverProcess] = set()
        self._lock = Lock()
        self._closed = False
        # also when the interpreter ends, or when nobody has these solvers any more
        self._finalizer = weakref.finalize(self, _end_all, self._processes)

    def request(self, texts: Texts) -> LookRequest:
        """Begin to look at a state; what is refused needs no process."""
        request = LookRequest(texts)
        refused = self._refused(texts)
        if refused is None:
            # a daemon, so that the interpreter does not wait for a solve at its end
            Thread(target=self.serve, args=(request,), daemon=True).start()
        else:
            request.finish(refused)
        return request

    def warm(self) -> None:
        """Start a process, which imports the library before the first request comes."""
        with self._lock:
            self._idle.append(self._started())

    def close(self) -> None:
        """End all processes, whatever they are doing; requests that wait are cancelled."""
        with self._lock:
            self._closed = True
        self._finalizer()

    def _refused(self, texts: Texts) -> Look | None:
        """Return why a state is not solved, None if it is."""
        try:
            scene, rtol = scene_of(texts), rtol_of(texts)
            reason = refusal(plan(scene), rtol, self.seconds)
            return Look(complaint=reason, code=code_of(texts)) if reason else None
        except SpectralContactError as error:
            return Look(complaint=str(error))

    def serve(self, request: LookRequest) -> None:
        """Look at a state, whatever it may cost, as soon as a process is free; wait for it."""
        with self._slots:
            look = None
            try:
                look = self._look(request)
            finally:
                request.finish(look)

    def _look(self, request: LookRequest) -> Look | None:
        while not request.cancelled:
            with self._lock:
                if self._closed:
                    return None
                is_new = not self._idle
                process = self._started() if is_new else self._idle.pop()
            look = request.look(process, self.seconds) if process.ready() else None
            with self._lock:
                reusable = process.alive and not self._closed
                if reusable:
                    self._idle.append(process)
                else:
                    self._processes.discard(process)
            if not reusable:
                process.end()
            if look is not None or request.cancelled or self._closed:
                return look
            if process.out_of_time:
                return Look(complaint=overtime(self.seconds), code=code_of(request.texts))
            if is_new:  # one that was idle may have ended before it was asked
                return Look(complaint=_LOST, code=code_of(request.texts))
        return None

    def _started(self) -> _SolverProcess:
        process = _SolverProcess()
        self._processes.add(process)
        return process


class _SolverProcess:
    """A process that solves one scene at a time."""

    def __init__(self) -> None:
        detached: dict[str, Any] = {"start_new_session": True}  # Ctrl-C is not for it
        if sys.platform == "win32":
            detached = {"creationflags": subprocess.CREATE_NEW_PROCESS_GROUP}
        # what this process can import, that one can
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
        self._process = subprocess.Popen(
            [sys.executable, "-m", _WORKER],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env=environment,
            **detached,
        )
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._questions, self._answers = self._process.stdin, self._process.stdout
        self._is_ready = self._killed = False
        self.out_of_time = False

    @property
    def alive(self) -> bool:
        """Whether it can be asked."""
        return not self._killed and self._process.poll() is None

    def ready(self) -> bool:
        """Wait until it has imported the library; return whether it has."""
        if not self._is_ready:
            self._is_ready = self._answer(_START_LIMIT) is not None
        return self._is_ready

    def look(self, texts: Mapping[str, str], seconds: float) -> Look | None:
        """Return what is to be shown of a state; None if the process has ended or was killed."""
        try:
            pickle.dump(texts, self._questions)
            self._questions.flush()
        except (OSError, ValueError):
            self.kill()
            return None
        begin = monotonic()
        look = self._answer(seconds)
        self.out_of_time = look is None and monotonic() - begin >= seconds
        assert isinstance(look, Look | None)
        return look

    def kill(self) -> None:
        """Stop it, whatever it is doing; who waits for its answer hears that it has ended."""
        self._killed = True
        self._process.kill()

    def end(self) -> None:
        """Kill it, wait until it has ended, and close its pipes."""
        self.kill()
        self._process.wait()
        for pipe in (self._questions, self._answers):
            with suppress(OSError):  # a question that nobody reads any more
                pipe.close()

    def _answer(self, seconds: float) -> object:
        """Return what the process writes, None if it has ended; it is killed after the time."""
        timer = Timer(seconds, self.kill)
        timer.daemon = True
        timer.start()
        try:
            return pickle.load(self._answers)
        except (EOFError, OSError, ValueError, pickle.UnpicklingError):
            self.kill()
            return None
        finally:
            timer.cancel()
            timer.join()  # it kills before this returns, or never


def _end_all(processes: set[_SolverProcess]) -> None:
    for process in list(processes):
        process.end()
