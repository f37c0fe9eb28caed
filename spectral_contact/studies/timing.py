"""Times worth comparing: cold and warm apart, medians and quartiles, one BLAS thread.

Cold is the first solve of a fresh process, imports not counted, not even those that the solver
puts off until it needs them; warm is one of the repeats after it, with all caches filled. Both are
taken in processes of their own, in which BLAS has one thread, if the solver can be imported there.
A solver that cannot (a lambda, a function inside a function, or one of the main script) is timed in
this process, warm alone.
"""

from __future__ import annotations

import json
import os
import pickle
import subprocess
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from time import perf_counter
from typing import TYPE_CHECKING, Any

import numpy as np

from spectral_contact.errors import SceneError
from spectral_contact.io.checks import finite, real, whole
from spectral_contact.threads import THREADS, look_for_blas, one_thread

if TYPE_CHECKING:
    from spectral_contact.scene import Scene

_START = (
    "import sys; sys.path[:] = {path!r}; "
    "from spectral_contact.studies.timed_process import main; main()"
)


@dataclass(frozen=True, slots=True)
class Stopwatch:
    """How times are taken.

    Parameters
    ----------
    repeats : int
        Least number of warm repeats.
    seconds : float
        Least total time of them [s]: repeats go on until both are reached.
    longest : float
        Total time [s] after which there are no more of them, however few.
    processes : int
        Fresh processes, each of which gives one cold time; one more gives the warm ones.
    """

    repeats: int = 5
    seconds: float = 0.2
    longest: float = 10.0
    processes: int = 3

    def __post_init__(self) -> None:
        put = object.__setattr__
        for name in ("repeats", "processes"):
            put(self, name, whole(name, getattr(self, name), 1))
        for name in ("seconds", "longest"):
            value = real(name, getattr(self, name), allowed="finite and >= 0 [s]", low=0.0)
            put(self, name, value)


@dataclass(frozen=True, slots=True)
class Timing:
    """Several times of the same work, in seconds.

    Attributes
    ----------
    median, lower, upper : float
        Median and quartiles [s].
    repeats : int
    """

    median: float
    lower: float
    upper: float
    repeats: int

    @classmethod
    def of(cls, seconds: Sequence[float]) -> Timing:
        """Return median and quartiles of times.

        Raises
        ------
        SceneError
            If there is none, or one is below 0 or not finite.
        """
        taken = finite("seconds", seconds)
        if not taken.size or taken.min() < 0.0:
            raise SceneError("seconds", seconds, "at least one time, and none below 0")
        lower, median, upper = (float(q) for q in np.percentile(taken, (25, 50, 75)))
        return cls(median, lower, upper, len(seconds))


@dataclass(frozen=True, slots=True)
class Times:
    """The times of one solve.

    Attributes
    ----------
    warm : Timing
    cold : Timing or None
        None if the solver cannot be imported by a fresh process.
    blas_threads : int or None
        Threads of BLAS; None if nothing said how many.
    note : str
        Why there is no cold time; empty if there is.
    """

    warm: Timing
    cold: Timing | None
    blas_threads: int | None
    note: str = ""


def repeated(
    call: Callable[[], object], stopwatch: Stopwatch, clock: Callable[[], float] = perf_counter
) -> list[float]:
    """Return the times [s] of a call that is warmed up already."""
    times: list[float] = []
    total = 0.0
    while len(times) < stopwatch.repeats or total < stopwatch.seconds:
        begin = clock()
        call()
        times.append(clock() - begin)
        total += times[-1]
        if total >= stopwatch.longest:
            break
    return times


def times_of(
    solver: Callable[[Scene, Any], Any], scene: Scene, resolution: float, stopwatch: Stopwatch
) -> Times:
    """Time a solve in fresh processes, or, if that cannot be, in this one, which is warmed up."""
    try:
        first = _fresh((scene, solver, resolution, stopwatch, []))
        again = scene, solver, resolution, None, first["imported"]
        colds = [_fresh(again)["cold"] for _ in range(stopwatch.processes)]
    except _NotPortable as error:
        look_for_blas()  # the solver may have brought its own
        with one_thread() as threads:
            times = repeated(lambda: solver(scene, resolution), stopwatch)
        return Times(Timing.of(times), None, threads, str(error))
    return Times(Timing.of(first["warm"]), Timing.of(colds), 1)


class _NotPortable(Exception):
    """A fresh process cannot run the solver; says why."""


def _fresh(
    task: tuple[Scene, Callable[[Scene, Any], Any], float, Stopwatch | None, list[str]],
) -> dict[str, Any]:
    """Return the times of a fresh process; without a stopwatch the cold one alone.

    The last part of the task are modules to import before.
    """
    solver = task[1]
    try:
        pickled = pickle.dumps(task)
    except Exception as error:  # pickle raises whatever the object's own hooks raise
        raise _NotPortable(f"not importable: {' '.join(str(error).split())}") from error
    if _in_main_script(solver):
        raise _NotPortable("not importable: it is defined in the main script")
    done = subprocess.run(
        [sys.executable, "-c", _START.format(path=sys.path)],
        input=pickled,
        capture_output=True,
        check=False,
        env=os.environ | dict.fromkeys(THREADS, "1"),
    )
    if done.returncode != 0:
        said = done.stderr.decode(errors="replace").strip().splitlines()
        raise _NotPortable(f"a fresh process failed: {said[-1] if said else done.returncode}")
    found: dict[str, Any] = json.loads(done.stdout)
    return found


def _in_main_script(solver: Callable[[Scene, Any], Any]) -> bool:
    own = getattr(solver, "__module__", None)
    return "__main__" in (own, type(solver).__module__)
