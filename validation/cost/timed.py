"""Work that is timed, in U: the time of one dense solve of 1000 unknowns, measured beside it."""

from __future__ import annotations

import platform
import sys
import tomllib
from collections.abc import Callable, Iterable, Iterator, Mapping
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from math import isfinite
from multiprocessing import get_context
from pathlib import Path
from statistics import median
from typing import Any

sys.path.append(str(Path(__file__).parents[1]))

import numpy as np
import scipy
from reporting import seconds, table, unit, write

#: The groups, and what is timed of some.
TABLE = tomllib.loads((Path(__file__).parent / "bench.toml").read_text(encoding="utf-8"))
VERSIONS = f"Python {platform.python_version()}, numpy {np.__version__}, scipy {scipy.__version__}"
#: Scenes that differ, before they are repeated.
SCENES = 9

Row = Mapping[str, Any]


@dataclass(frozen=True)
class Case:
    """Some work.

    Attributes
    ----------
    row : mapping
        What its row in the table begins with, by the names of bench.toml.
    work : callable
        From a place of 0 ... `SCENES`, which varies the scene a little, to the work.
    goal : float
        In U; infinite if there is none.
    rounds : int
    fill : bool
        Whether other scenes fill the caches before. Solutions are never cached.
    """

    row: Row
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


def timed_rows(cases: Iterable[Case]) -> Iterator[Row]:
    """Time cases, and yield the rows of their table."""
    for case in cases:
        time, ratio = warm(case)
        yield {**case.row, "milliseconds": 1e3 * time, "units": ratio, "goal": goal(case.goal)}


def report(
    group: str, rows: Iterable[Row], record: dict[str, Any] | None = None, **known: object
) -> None:
    """Write a group as bench.toml has it: the text, and what its columns have of each row."""
    texts = TABLE["group"][group]
    texts = TABLE["group"][texts.get("as", group)]
    heading = " | ".join(name for name, _ in texts["columns"]).format(**known)
    cells = []
    for row in rows:
        cells.append([cell.format(**row) for _, cell in texts["columns"]])
        print(*cells[-1], flush=True)
    text = texts["text"].format(table=table(heading, cells), **known)
    write(f"bench_{group}", text, record)


def fresh(function: Callable[..., Any], *arguments: object) -> Any:
    """Return what a function returns in a fresh process."""
    with ProcessPoolExecutor(1, get_context("spawn")) as pool:
        return pool.submit(function, *arguments).result()
