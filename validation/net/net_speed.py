"""Time the working tree beside the baseline, and return the ratios of their times.

A measurement is a fresh process with the library of either version, which runs this file on one
case of bench.py. The two versions take turns, and the ratio of a row is that of their shortest
times, as other work on the machine makes times longer and never shorter.
"""

from __future__ import annotations

import ctypes
import json
import math
import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from time import process_time

sys.path.append(str(Path(__file__).parents[1]))
sys.path.append(str(Path(__file__).parents[1] / "cost"))

import bench_solve
import bench_sweep
from net_baseline import REPOSITORY, checked_out
from reporting import seconds, unit

HERE = Path(__file__).parent
SOLVES = [case for cases in bench_solve.SOLVES.values() for case in cases]
SWEEPS = bench_sweep.CASES
SWEEP_RTOL = bench_sweep.TOLERANCES[0]

#: The largest ratio of times, new over old, of each kind.
LIMITS = {
    "normal": 1.1,
    "sweep by spectra": 1.1,
    "full stick": 2.0,
    "one disk": 3.0,
    "one disk, β = 0": 6.0,
    "slip inside": 2.0,
    "coupled": 2.5,
    "map of c*, Q*": 4.0,
}
#: A row has so many runs to come below its limit, each of so many pairs of processes.
RUNS, PAIRS = 4, 3
#: Scenes that fill the caches, before as many between them are timed.
SCENES = 9


@dataclass
class Row:
    """What is timed, and how long it takes.

    Attributes
    ----------
    case, kind, mode : str
        The kind decides the limit. *First* is in a fresh process, *cold* with emptied caches when
        the code has run before, *warm* with caches that other scenes have filled.
    old, new : float
        Shortest times in U, of all runs.
    runs : int
        After how many runs the ratio was small enough.
    """

    case: str
    kind: str
    mode: str
    old: float = math.inf
    new: float = math.inf
    runs: int = 0

    @property
    def ratio(self) -> float:
        """New over old."""
        return self.new / self.old

    @property
    def limit(self) -> float:
        """What the ratio may be at most."""
        return LIMITS[self.kind]

    @property
    def passed(self) -> bool:
        """Whether the ratio is within its limit."""
        return self.ratio <= self.limit


def kind_of_solve(case: bench_solve.Solve) -> str:
    """Return the kind of a case of `SOLVES`."""
    if "coupled" in case.problem:
        return "coupled"
    if case.problem == "partial slip":
        return "one disk, β = 0" if case.compliances[1] == 0.0 else "one disk"
    return case.problem if case.problem in LIMITS else "normal"


def kind_of_sweep(case: bench_sweep.Case) -> str:
    """Return the kind of a sweep."""
    return "map of c*, Q*" if "stick_radius" in case.quantities else "sweep by spectra"


def cases() -> list[tuple[str, str]]:
    """Return names and kinds of all cases: solves, then sweeps."""
    solves = [(f"{case.name}, rtol {case.rtol:g}", kind_of_solve(case)) for case in SOLVES]
    return solves + [(case.name, kind_of_sweep(case)) for case in SWEEPS]


def work_of(number: int, place: float) -> Callable[[], object]:
    """Return the work of a case; `place` varies the scene of a solve."""
    if number < len(SOLVES):
        return SOLVES[number].work(place)
    from spectral_contact.sweeps import sweep  # of either version

    case = SWEEPS[number - len(SOLVES)]
    return partial(sweep, case.scene(), **case.arguments(SWEEP_RTOL))


def measured(number: int) -> dict[str, float]:
    """Return the times of a case in U, by mode, in this fresh process."""
    begin = process_time()
    from spectral_contact import clear_caches

    times = {"import": process_time() - begin, "first": seconds(work_of(number, 0.0))}
    is_solve = number < len(SOLVES)
    clear_caches()
    # memory that was touched is given back, as in a fresh process
    getattr(ctypes.CDLL(None), "malloc_trim", lambda _: None)(0)
    times["cold"] = seconds(work_of(number, 0.0))
    for place in range(SCENES if is_solve else 0):
        work_of(number, float(place))()
    places = range(SCENES if is_solve else 1)
    times["warm"] = min(seconds(work_of(number, place + 0.5)) for place in places)
    u = unit()
    return {mode: one / u for mode, one in times.items()}


def timed(library: Path, number: int) -> dict[str, float]:
    """Return what `measured` says of a case with the library in a folder."""
    environment = os.environ | {"PYTHONPATH": os.pathsep.join((str(library), str(HERE)))}
    command = [sys.executable, "-P", str(HERE / "net_speed.py"), str(number)]
    return json.loads(subprocess.check_output(command, env=environment, text=True))


Timing = Callable[[], dict[str, float]]


def compared(rows: list[Row], old: Timing, new: Timing) -> list[Row]:
    """Fill the rows of a case, one a mode: time both in turns, again as long as one is too slow."""
    for run in range(1, RUNS + 1):
        for pair in range(PAIRS):
            if pair % 2:
                second = new()
                first = old()
            else:
                first = old()
                second = new()
            for row in rows:
                row.old = min(row.old, first[row.mode])
                row.new = min(row.new, second[row.mode])
                row.runs = run
        if all(row.passed for row in rows):
            break
    return rows


def speed(commit: str, quick: bool) -> Iterator[Row]:
    """Yield the rows of all cases as they are done; quickly, none of the slow and only warm."""
    with checked_out(commit) as baseline:
        for number, (name, kind) in enumerate(cases()):
            if quick and ("inside" in name or kind == "map of c*, Q*"):
                continue
            rows = [Row(name, kind, mode) for mode in (("warm",) if quick else ("warm", "cold"))]
            if number == 0 and not quick:
                rows += [Row(name, kind, "first"), Row("import", "normal", "import")]
            yield from compared(
                rows, partial(timed, baseline, number), partial(timed, REPOSITORY, number)
            )


if __name__ == "__main__":
    print(json.dumps(measured(int(sys.argv[1]))))
