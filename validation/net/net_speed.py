"""Time the working tree and the commit side by side, and return the ratios of their times.

Two processes live as long as the benchmarks and are asked in turns, the order changing from pair to
pair. The ratio of a row is that of the shortest time of either, as other work on the machine makes
times longer and never shorter. Both are driven by the cases of `net_cases` through the public API.
"""

from __future__ import annotations

import json
import math
import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from typing import Any

sys.path.append(str(Path(__file__).parents[1] / "cost"))

import bench_solve
import bench_sweep
from net_cases import LIMITS, SOLVES, SWEEPS, kind_of_solve, kind_of_sweep
from net_commit import COMMIT, REPOSITORY, checked_out

HERE = Path(__file__).parent
#: As many runs a row has to come below its limit.
RUNS = 4
#: Pairs of a row: at least, at most, and for how many seconds if they are short.
FEWEST, MANY, LONG = 3, 15, 1.5
#: Seconds of one measurement of something short.
SHORT = 0.02
#: Pairs of fresh processes, and cases whose first solve there is timed: benchmark and number.
FRESH = 5
FIRST = (("solve", 0), ("solve", 7), ("coupled", 3))


class Worker:
    """A process with one version of the library.

    Parameters
    ----------
    source : Path
        The folder that has the package.
    cache : Path
        Where byte code is kept.
    """

    def __init__(self, source: Path, cache: Path) -> None:
        more = {
            "PYTHONPATH": os.pathsep.join((str(source), str(HERE))),
            "PYTHONPYCACHEPREFIX": str(cache),
            "PYTHONDONTWRITEBYTECODE": "",
        }
        command = [sys.executable, "-P", str(HERE / "net_worker.py")]
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
        self._process = subprocess.Popen(command, env=os.environ | more, **pipes)
        hello = self._answer()
        self.import_seconds = float(hello["import"])
        if not Path(hello["file"]).is_relative_to(source):
            self.close()
            raise RuntimeError(f"{hello['file']} is imported instead of that in {source}")

    def ask(self, **request: Any) -> float:
        """Return the seconds that are asked for."""
        self._process.stdin.write(json.dumps(request) + "\n")
        self._process.stdin.flush()
        return float(self._answer())

    def _answer(self) -> Any:
        line = self._process.stdout.readline()
        if not line:
            raise RuntimeError("a timing process ended; its message is above")
        return json.loads(line)

    def close(self) -> None:
        """End the process."""
        self._process.stdin.close()
        self._process.wait()


@dataclass
class Row:
    """What is timed, and how long it takes.

    Attributes
    ----------
    benchmark, case, kind, mode : str
        The kind decides the limit.
    rtol : float
    old, new : float
        Shortest times in U, of all runs.
    ratio : float
        New over old.
    pairs, runs : int
        How many pairs in all, and in how many runs until the ratio was small enough.
    """

    benchmark: str
    case: str
    kind: str
    mode: str
    rtol: float
    old: float = 0.0
    new: float = 0.0
    ratio: float = 0.0
    pairs: int = 0
    runs: int = 0

    @property
    def limit(self) -> float:
        """What the ratio may be at most."""
        return LIMITS[self.kind]

    @property
    def passed(self) -> bool:
        """Whether the ratio is within its limit."""
        return self.ratio <= self.limit


Timing = Callable[[], float]


def paired(row: Row, old: Timing, new: Timing, unit: float, fewest: int) -> Row:
    """Fill a row: time both in turns, anew as long as the ratio is too large."""
    shortest_old = shortest_new = math.inf
    for run in range(1, RUNS + 1):
        pairs = 0
        spent = 0.0
        while pairs < fewest or (spent < LONG and pairs < MANY):
            if pairs % 2:
                second = new()
                first = old()
            else:
                first = old()
                second = new()
            shortest_old = min(shortest_old, first)
            shortest_new = min(shortest_new, second)
            pairs += 1
            spent += first + second
        row.old = shortest_old / unit
        row.new = shortest_new / unit
        row.ratio = shortest_new / shortest_old
        row.pairs += pairs
        row.runs = run
        if row.passed:
            break
    return row


def requests(quick: bool) -> Iterator[tuple[Row, dict[str, Any]]]:
    """Yield the rows to time in the living processes; quickly, none of the slow and none cold."""
    modes = ("warm",) if quick else ("warm", "cold")
    for benchmark, cases in SOLVES.items():
        for number, case in enumerate(cases):
            if quick and "inside" in case[0]:
                continue
            values = dict.fromkeys(bench_solve.compliances(case))
            name = ", ".join([case[0], *(f"{value:g}" for value in values)])
            for mode in modes:
                request = {"benchmark": benchmark, "number": number}
                yield Row(benchmark, name, kind_of_solve(case), mode, case[3]), request
    loose, tight = bench_sweep.TOLERANCES
    for rtol in (loose,) if quick else (loose, tight):
        for number, case in enumerate(SWEEPS):
            if quick and "slip" in case.name:
                continue
            request = {"benchmark": "sweep", "number": number, "rtol": rtol}
            # what a sweep assembles hardly depends on the tolerance
            for mode in modes if rtol == loose else ("warm",):
                yield Row("sweep", case.name, kind_of_sweep(case), mode, rtol), request


def speed(quick: bool) -> Iterator[Row]:
    """Yield the rows of all benchmarks as they are done."""
    with TemporaryDirectory() as folder:
        old, cache = Path(folder) / "old", Path(folder) / "cache"
        old.mkdir()
        sources = checked_out(old, COMMIT), REPOSITORY
        workers = [Worker(source, cache) for source in sources]
        unit = median(worker.ask(mode="unit") for worker in workers)
        yield from living(workers, unit, quick)
        for worker in workers:
            worker.close()
        if not quick:
            yield from fresh(sources, cache, unit)


def living(workers: list[Worker], unit: float, quick: bool) -> Iterator[Row]:
    """Yield rows of processes that live on."""
    filled, last = {}, 0.0
    for row, request in requests(quick):
        if request != filled:
            last = min(worker.ask(mode="fill", **request) for worker in workers)
            filled = request
        repeats = min(max(round(SHORT / max(last, 1e-6)), 1), 50)
        asked = request | {"mode": row.mode, "repeats": repeats}
        old, new = (partial(worker.ask, **asked) for worker in workers)
        yield paired(row, old, new, unit, 1 if quick else FEWEST)


def fresh(sources: tuple[Path, Path], cache: Path, unit: float) -> Iterator[Row]:
    """Yield rows of fresh processes: the import, and the first solve after it."""

    def imported(source: Path) -> float:
        worker = Worker(source, cache)
        worker.close()
        return worker.import_seconds

    def solved(source: Path, benchmark: str, number: int) -> float:
        worker = Worker(source, cache)
        seconds = worker.ask(mode="first", benchmark=benchmark, number=number)
        worker.close()
        return seconds

    old, new = (partial(imported, source) for source in sources)
    row = Row("import", "over numpy", "normal", "fresh", 0.0)
    yield paired(row, old, new, unit, FRESH)
    for benchmark, number in FIRST:
        case = SOLVES[benchmark][number]
        old, new = (partial(solved, source, benchmark, number) for source in sources)
        row = Row(benchmark, case[0], kind_of_solve(case), "fresh", case[3])
        yield paired(row, old, new, unit, FRESH)
