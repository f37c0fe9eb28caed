"""Work that is timed, in U: the time of one dense solve of 1000 unknowns, measured beside it."""

from __future__ import annotations

import sys
import tomllib
from collections.abc import Callable, Iterable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from math import isfinite
from multiprocessing import get_context
from pathlib import Path
from statistics import median
from typing import Any

sys.path.append(str(Path(__file__).parents[1]))

from reporting import seconds, table, unit, write

#: The groups, and what is timed of some.
TABLE = tomllib.loads((Path(__file__).parent / "bench.toml").read_text(encoding="utf-8"))
#: Scenes that differ, before they are repeated.
SCENES = 9


@dataclass(frozen=True)
class Case:
    """Some work.

    Attributes
    ----------
    cells : tuple
        What its row begins with.
    work : callable
        From a place of 0 ... `SCENES`, which varies the scene a little, to the work.
    goal : float
        In U; infinite if there is none.
    rounds : int
    fill : bool
        Whether other scenes fill the caches before. Solutions are never cached.
    """

    cells: tuple[object, ...]
    work: Callable[[float], Callable[[], object]]
    goal: float
    rounds: int = 9
    fill: bool = True


def warm(case: Case) -> tuple[float, float]:
    """Return the median times of the rounds in seconds and in U, measured in the same round."""
    if case.fill:
        for place in range(min(case.rounds, SCENES)):
            case.work(place)()
    works = (case.work(k % SCENES + 0.5) for k in range(case.rounds))
    pairs = [(seconds(work), unit()) for work in works]
    return median(one for one, _ in pairs), median(one / u for one, u in pairs)


def goal(value: float | None) -> str:
    """Return a goal for a table."""
    return "–" if value is None or not isfinite(value) else f"{value:g}"


def run(name: str, cases: Iterable[Case]) -> None:
    """Time the cases of a group that bench.toml has a text of, and write their table."""
    group = TABLE["group"][name.removeprefix("bench_")]
    heading = f"{group['columns']} | warm [ms] | warm [U] | goal"
    rows = []
    for case in cases:
        time, ratio = warm(case)
        rows.append((*case.cells, f"{1e3 * time:.3g}", f"{ratio:.3g}", goal(case.goal)))
        print(*rows[-1], flush=True)
    write(name, f"{group['about']}\n\n{table(heading, rows)}")


def fresh(function: Callable[..., Any], *arguments: object) -> Any:
    """Return what a function returns in a fresh process."""
    with ProcessPoolExecutor(1, get_context("spawn")) as pool:
        return pool.submit(function, *arguments).result()
