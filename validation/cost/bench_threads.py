"""BLAS held to one thread, as the library does, and not: group ``threads`` of bench.py.

Both ways take turns in one process whose BLAS has as many threads as the machine has processors;
caches are filled. Load is two processes that do nothing else than work. Times are wall-clock
medians. The load average at the start says whether "quiet" was true. The price of the hold is
measured by itself, in processor time, as the first to hold BLAS and inside another hold.
"""

from __future__ import annotations

import os

os.environ["OPENBLAS_NUM_THREADS"] = os.environ["OMP_NUM_THREADS"] = str(os.cpu_count())

import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from statistics import median
from time import perf_counter, sleep, thread_time
from timeit import repeat, timeit
from unittest import mock

from threadpoolctl import threadpool_info
from timed import VERSIONS, report

from spectral_contact import Scene, solve
from spectral_contact.solving import solver
from spectral_contact.threads import one_thread

BUSY, PAIRS, LONGEST = 2, 9, 90.0
TRIES, ENTRIES = 15, 2000

#: By name: the scene, without elastic coupling.
SCENES = {
    "default scene": Scene(0.1, 0.5, 0.5, 0.1),
    "slip inside": Scene(0.3, 0.05, 1.0, 0.23 / 7),
}
CASES = SCENES | {
    f"{name}, coupled": scene.replace(coupling=True) for name, scene in SCENES.items()
}


def not_held() -> mock._patch:
    """Let `solve` leave BLAS alone."""
    return mock.patch.object(solver, "one_thread", nullcontext)


@contextmanager
def load(processes: int) -> Iterator[None]:
    """Keep some processes busy."""
    busy = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(processes)]
    try:
        sleep(0.5)  # they have to start
        yield
    finally:
        for one in busy:
            one.kill()
            one.wait()


def pairs(scene: Scene) -> tuple[list[float], list[float]]:
    """Return the times of solves with BLAS held and without, which take turns."""

    def work() -> object:
        return solve(scene, strict=False)

    with not_held():
        work()
    work()
    held, free = [], []
    begin = perf_counter()
    for _ in range(PAIRS):
        held.append(timeit(work, number=1))
        with not_held():
            free.append(timeit(work, number=1))
        if perf_counter() - begin > LONGEST:
            break
    return held, free


def hold() -> None:
    """Hold BLAS to one thread, and let it go."""
    with one_thread():
        pass


def price() -> dict[str, float]:
    """Return what the hold costs in microseconds of processor time: the least of several means."""

    def least() -> float:
        times = repeat(hold, repeat=TRIES, number=ENTRIES, timer=thread_time)
        return 1e6 * min(times) / ENTRIES

    first = least()
    with one_thread():
        return {"first_us": first, "inside_us": least()}


def row(name: str, scene: Scene, busy: int) -> dict:
    """Return the figures of a case."""
    held, free = pairs(scene)
    return {
        "case": name,
        "busy": busy,
        "held_ms": 1e3 * median(held),
        "free_ms": 1e3 * median(free),
        "ratio": median(b / a for a, b in zip(held, free, strict=True)),
        "pairs": len(held),
    }


def main(group: str) -> None:
    """Measure and write."""
    before, cost = os.getloadavg()[0], price()
    rows = []
    for busy in (0, BUSY):
        with load(busy):
            rows += [row(*case, busy) for case in CASES.items()]
    count = max(one["num_threads"] for one in threadpool_info() if one["user_api"] == "blas")
    known = {"versions": VERSIONS, "processors": os.cpu_count(), "load": before, "threads": count}
    report(group, rows, {"price": cost, "rows": rows}, **known, **cost)
