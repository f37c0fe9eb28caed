"""How many scenes a second a sweep solves, how far they are from `solve`, what two processes win.

Run as ``python validation/cost/bench_sweep.py``; writes validation/results/bench_sweep.json and
.md. Rates are scenes per second of processor time of the whole call, the dataset included:
wall-clock time on a machine that is busy with other things would say more about those. "First" is
the call in a fresh process, which assembles and decomposes; "again" the better one of two later
ones. The largest deviation from single solves at rtol = 1e-12 is that of some scenes drawn from
each sweep, beside the largest estimate. The gain by two processes is wall-clock time, with their
caches filled. U is the time of solving 1000 linear equations, in the same process.
"""

from __future__ import annotations

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("OMP_NUM_THREADS", "1")

import json
import math
import subprocess
import sys
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path
from statistics import median
from time import perf_counter, process_time
from typing import Any

import numpy as np

RESULTS = Path(__file__).parents[1] / "results"
TOLERANCES = (1e-8, 1e-12)
CHECKED, LATER, PAIRS = 8, 2, 5


@dataclass(frozen=True)
class Case:
    """A sweep, and how fast it should be at ``rtol=1e-8``."""

    name: str
    quantities: tuple[str, ...]
    goal: float
    axes: dict[str, tuple[float, float, int]]
    friction: float | None = None
    fixed: tuple[float, float] = (0.5, 0.5)

    def scene(self):
        """Return the scene whose parameters vary."""
        from spectral_contact import Scene

        return Scene(0.3, *self.fixed, self.friction)

    def arguments(self, rtol: float) -> dict[str, Any]:
        """Return what `sweep` is called with."""
        axes = {
            name: (np.linspace if name == "friction" else np.geomspace)(*range_)
            for name, range_ in self.axes.items()
        }
        places = {"from_edge": [0.0]} if "pressure" in self.quantities else {}
        return {**axes, "quantities": list(self.quantities), "rtol": rtol, **places}


def _plane(count: int) -> dict[str, tuple[float, float, int]]:
    return {
        "normal_compliance": (1e-2, 1e2, count),
        "tangential_compliance": (1e-2, 1e2, count),
    }


#: Friction below the edge ratio of full stick, so that there is slip in every scene.
_SLIPPING = {"friction": (0.005, 0.09, 100), "normal_compliance": (0.5, 5.0, 3)}
CASES = (
    Case(
        "δ*, p*(1)", ("approach", "pressure"), 5e5, {"normal_compliance": (1e-10, 1e10, 1_000_000)}
    ),
    Case("Q*, full stick", ("total_shear",), 1e5, _plane(500), math.inf),
    Case("edge ratio", ("edge_ratio",), 1e3, _plane(500), math.inf),
    Case("critical friction", ("critical_friction",), 1e3, _plane(100), math.inf),
    Case("c*, Q*, one slip annulus", ("stick_radius", "total_shear"), 1000, _SLIPPING),
    *(
        Case(
            f"c*, Q*, slip inside, {steps} steps",
            ("stick_radius", "total_shear"),
            100,
            {"friction": (0.0294, 0.0370, count)},
            fixed=(0.05, 1.0),
        )
        for steps, count in (("small", 100), ("large", 8))
    ),
    Case(
        "c*, Q*, one slip annulus, f and β",
        ("stick_radius", "total_shear"),
        1000,
        {"friction": (0.005, 0.045, 100), "tangential_compliance": (0.05, 0.5, 10)},
    ),
    Case(
        "c*, Q*, one slip annulus, f and ν",
        ("stick_radius", "total_shear"),
        1000,
        {"friction": (0.005, 0.035, 100), "poisson_ratio": (0.1, 0.3, 10)},
    ),
    Case(
        "c*, Q*, one slip annulus, α and β",
        ("stick_radius", "total_shear"),
        1000,
        {"normal_compliance": (0.5, 5.0, 20), "tangential_compliance": (0.05, 0.5, 20)},
        0.03,
    ),
)


def measured(number: int, rtol: float) -> dict[str, Any]:
    """Return rates and deviations of a case, in this process."""
    from spectral_contact import solve
    from spectral_contact.sweeps import sweep

    case = CASES[number]
    arguments = case.arguments(rtol)
    times = []
    matrix, right = np.random.default_rng(0).normal(size=(1000, 1000)), np.ones(1000)
    units = []
    for _ in range(5):
        begin = process_time()
        np.linalg.solve(matrix, right)
        units.append(process_time() - begin)
    for _ in range(1 + LATER):
        begin = process_time()
        found = sweep(case.scene(), **arguments)
        times.append(process_time() - begin)
    scenes = found.ending.size
    worst = estimate = 0.0
    rng = np.random.default_rng(0)
    flat = found.stack(scene=found.ending.dims)
    for i in rng.choice(scenes, CHECKED, replace=False):
        one = flat.isel(scene=int(i))
        scene = case.scene()
        values = {name: float(one[name]) for name in case.axes}
        scene = type(scene)(
            values.get("poisson_ratio", 0.3),
            values.get("normal_compliance", scene.normal_compliance),
            values.get("tangential_compliance", scene.tangential_compliance),
            values.get("friction", scene.friction),
        )
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
        "unit": min(units),
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
            times = []
            for pool in (one, two):
                begin = perf_counter()
                sweep(case.scene(), **arguments, executor=pool)
                times.append(perf_counter() - begin)
            ratios.append(times[0] / times[1])
    return {"median": median(ratios), "best": max(ratios), "load": os.getloadavg()[0]}


def main() -> None:
    """Measure, print and store."""
    import spectral_contact
    from spectral_contact.studies import this_machine

    rows = []
    for rtol in TOLERANCES:
        for number in range(len(CASES)):
            done = subprocess.run(
                [sys.executable, __file__, str(number), repr(rtol)],
                capture_output=True,
                text=True,
                check=True,
            )
            rows.append(json.loads(done.stdout))
            print(rows[-1], flush=True)
    record = {
        "schema": "spectral_contact.validation.bench_sweep",
        "version": 1,
        "library": spectral_contact.__version__,
        "machine": ", ".join(f"{name} {one}" for name, one in this_machine().items()),
        "rows": rows,
        "gain": gain(),
    }
    RESULTS.mkdir(exist_ok=True)
    (RESULTS / "bench_sweep.json").write_text(json.dumps(record, indent=1) + "\n")
    (RESULTS / "bench_sweep.md").write_text(table(record))
    print(table(record))


def table(record: dict[str, Any]) -> str:
    """Return the results as Markdown."""
    lines = [
        "| quantities | rtol | scenes | first [1/s] | again [1/s] | again [1/U] | goal [1/s] | "
        "off `solve` by | estimate |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    for r in record["rows"]:
        per_unit = r["again"] * r["unit"]
        rates = f"{_rounded(r['first']):,} | {_rounded(r['again']):,} | {per_unit:,.3g} | "
        rates += f"{_rounded(r['goal']):,}"
        lines.append(
            f"| {r['case']} | {r['rtol']:g} | {r['scenes']:,} | {rates} | "
            f"{r['deviation']:.0e} | {r['estimate']:.0e} |"
        )
    gained = record["gain"]
    lines += [
        "",
        f"Two processes instead of one: {gained['median']:.2f} times faster in the median of "
        f"{PAIRS} pairs of runs, {gained['best']:.2f} at best; load average of the machine "
        f"{gained['load']:.1f}. {record['machine']}.",
    ]
    return "\n".join(lines) + "\n"


def _rounded(rate: float) -> int:
    """Return a rate with two digits."""
    digits = 1 - math.floor(math.log10(rate))
    return round(round(rate, digits))


if __name__ == "__main__":
    if len(sys.argv) == 3:
        print(json.dumps(measured(int(sys.argv[1]), float(sys.argv[2]))))
    else:
        main()
