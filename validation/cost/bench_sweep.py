"""Scenes a second of sweeps, and their distance from `solve`: group ``sweep`` of bench.py.

Rates are scenes per second of processor time of the whole call, the dataset included: wall-clock
time on a machine that is busy with other things would say more about those. "First" is the call in
a fresh process, which assembles and decomposes; "again" the better one of two later ones. The
largest deviation from single solves at rtol = 1e-12 is that of some scenes drawn from each sweep,
beside the largest estimate. The gain by two processes is wall-clock time, with their caches filled.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context
from statistics import median
from time import perf_counter
from typing import Any

import numpy as np
from timed import TABLE, fresh, report, seconds, unit

TOLERANCES = (1e-8, 1e-12)
CHECKED, LATER, PAIRS = 8, 2, 5


@dataclass(frozen=True)
class Case:
    """A sweep of bench.toml, and how fast it should be at ``rtol=1e-8``."""

    name: str
    quantities: Sequence[str]
    goal: float
    axes: dict[str, Sequence[float]]
    friction: float | None = None
    fixed: Sequence[float] = (0.5, 0.5)

    def scene(self):
        """Return the scene whose parameters vary."""
        from spectral_contact import Scene

        return Scene(0.3, *self.fixed, self.friction)

    def arguments(self, rtol: float) -> dict[str, Any]:
        """Return what `sweep` is called with."""
        axes = {
            name: (np.linspace if name == "friction" else np.geomspace)(*ends)
            for name, ends in self.axes.items()
        }
        places = {"from_edge": [0.0]} if "pressure" in self.quantities else {}
        return {**axes, "quantities": self.quantities, "rtol": rtol, **places}


CASES = [Case(**row) for row in TABLE["sweep"]]


def measured(number: int, rtol: float) -> dict[str, Any]:
    """Return rates and deviations of a case, in this process."""
    from spectral_contact import solve
    from spectral_contact.sweeps import sweep

    case = CASES[number]
    arguments = case.arguments(rtol)
    unit_seconds = unit()
    times = [seconds(lambda: sweep(case.scene(), **arguments)) for _ in range(1 + LATER)]
    found = sweep(case.scene(), **arguments)
    scenes = found.ending.size
    worst = estimate = 0.0
    rng = np.random.default_rng(0)
    flat = found.stack(scene=found.ending.dims)
    for i in rng.choice(scenes, CHECKED, replace=False):
        one = flat.isel(scene=int(i))
        scene = case.scene().replace(**{name: float(one[name]) for name in case.axes})
        truth = solve(scene, 1e-12, case.quantities, strict=False)
        for name in case.quantities:
            exact = truth.pressure(1.0) if name == "pressure" else getattr(truth, name)
            value = float(np.ravel(one[name])[0])
            worst = max(worst, abs(value / exact - 1.0))
            estimate = max(estimate, float(one[f"{name}_error"]))
    return {
        "case": case.name,
        "rtol": rtol,
        "scenes": scenes,
        "converged": int((found.ending == "converged").sum()),
        "first": scenes / times[0],
        "again": scenes / min(times[1:]),
        "unit": unit_seconds,
        "goal": case.goal if rtol == TOLERANCES[0] else case.goal / 3.0,
        "deviation": worst,
        "estimate": estimate,
    }


def gain() -> dict[str, float]:
    """Return how much faster two processes are than one, wall clock, pairs of runs in turns."""
    from spectral_contact.sweeps import sweep

    case = CASES[4]
    arguments = {**case.arguments(1e-8), "chunk": 10}
    ratios = []
    spawn = get_context("spawn")
    with ProcessPoolExecutor(1, spawn) as one, ProcessPoolExecutor(2, spawn) as two:
        for pool in (one, two, two):
            sweep(case.scene(), **arguments, executor=pool)
        for _ in range(PAIRS):
            times = [perf_counter()]
            for pool in (one, two):
                sweep(case.scene(), **arguments, executor=pool)
                times.append(perf_counter())
            ratios.append((times[1] - times[0]) / (times[2] - times[1]))
    known = {"median": median(ratios), "best": max(ratios), "load": os.getloadavg()[0]}
    return known | {"pairs": PAIRS}


def main(group: str) -> None:
    """Measure and write."""
    from spectral_contact.studies import this_machine

    rows = []
    for rtol in TOLERANCES:
        for number in range(len(CASES)):
            rows.append(fresh(measured, number, rtol))
            print(rows[-1], flush=True)
    gained = gain()
    machine = ", ".join(f"{key} {one}" for key, one in this_machine().items())
    shown = (
        row
        | {key: float(f"{row[key]:.2g}") for key in ("first", "again", "goal")}
        | {"again_in_u": row["again"] * row["unit"]}
        for row in rows
    )
    record = {"machine": machine, "rows": rows, "gain": gained}
    report(group, shown, record, machine=machine, **gained)
