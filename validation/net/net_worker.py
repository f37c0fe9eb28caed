"""A process that times one version of the library, as `net_speed` asks it to.

Reads one request a line from stdin and answers with one line on stdout, both JSON. Which version it
is decides PYTHONPATH; the cases are those of `net_cases`. Times are those of the processor, so that
another process does not count.
"""

from __future__ import annotations

import os

os.environ["OPENBLAS_NUM_THREADS"] = "1"
os.environ["OMP_NUM_THREADS"] = "1"

import ctypes
import json
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path
from statistics import median
from time import perf_counter
from typing import Any

sys.path.append(str(Path(__file__).parents[1]))
sys.path.append(str(Path(__file__).parents[1] / "cost"))

import bench_solve
from net_cases import SOLVES, SWEEPS
from reporting import seconds, unit

#: Scenes that differ, before they are repeated; most scenes, and seconds, that fill the caches.
SCENES, FILLING = 9, 1.0


def solve_work(case: tuple[Any, ...], place: float) -> Callable[[], object]:
    """Return one solve of a benchmark; `place` varies the scene."""
    from spectral_contact import solve

    return partial(solve, bench_solve.scene_of(case, place), case[3], case[4])


def sweep_work(number: int, rtol: float) -> Callable[[], object]:
    """Return one sweep of a benchmark."""
    try:
        from spectral_contact.sweeps import sweep
    except ImportError:  # the commit of the comparison
        from spectral_contact.sweep import sweep

    case = SWEEPS[number]
    return partial(sweep, case.scene(), **case.arguments(rtol))


def work_of(request: dict[str, Any]) -> Callable[[float], Callable[[], object]]:
    """Return what makes the work of a request from what varies the scene."""
    if request["benchmark"] == "sweep":
        return lambda _: sweep_work(request["number"], request["rtol"])
    case = SOLVES[request["benchmark"]][request["number"]]
    return lambda place: solve_work(case, place)


def fill(request: dict[str, Any]) -> float:
    """Fill the caches by other scenes than those that are timed; return the last one's time."""
    work, spent, last = work_of(request), 0.0, 0.0
    for place in range(SCENES if request["benchmark"] != "sweep" else 1):
        last = seconds(work(float(place)))
        spent += last
        if spent > FILLING:
            break
    return last


def warm(request: dict[str, Any]) -> float:
    """Return the median time of some scenes with full caches."""
    work = work_of(request)
    places = (k % SCENES + 0.5 for k in range(request["repeats"]))
    return median(seconds(work(place)) for place in places)


def cold(request: dict[str, Any]) -> float:
    """Return the median time of a scene with emptied caches, when the code has run before.

    The memory is given back to the system, as in a fresh process: to touch it first takes a sixth
    of the time of a small solve. The commit's own `clear_caches` keeps it.
    """
    from spectral_contact import clear_caches

    give_back = getattr(ctypes.CDLL(None), "malloc_trim", lambda _: None)
    work, times = work_of(request)(0.0), []
    for _ in range(request["repeats"]):
        clear_caches()
        give_back(0)
        times.append(seconds(work))
    return median(times)


def first(request: dict[str, Any]) -> float:
    """Return the time of one scene as it is: of the first, in a fresh process."""
    return seconds(work_of(request)(0.0))


MODES = {"fill": fill, "warm": warm, "cold": cold, "first": first, "unit": lambda _: unit()}


def main() -> None:
    """Answer until there are no more requests."""
    answers, sys.stdout = sys.stdout, sys.stderr  # what the library prints is no answer
    begin = perf_counter()
    import spectral_contact

    hello = {"import": perf_counter() - begin, "file": spectral_contact.__file__}
    print(json.dumps(hello), file=answers, flush=True)
    for line in sys.stdin:
        request = json.loads(line)
        print(json.dumps(MODES[request["mode"]](request)), file=answers, flush=True)


if __name__ == "__main__":
    main()
