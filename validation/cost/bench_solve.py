"""Time the solver against one dense solve, and show what each step costs.

Run as ``python validation/cost/bench_solve.py``; writes validation/results/bench_solve.md.
U is the time of one ``numpy.linalg.solve`` of a dense 1000 x 1000 system in the same process,
one BLAS thread. Cold: first solve in a fresh process after import. Anew: the same scene once more
with emptied caches, when the code has run before. Warm: another alpha, beta, nu, f with operator
caches filled; solutions are never cached. Figures are medians, those of warm solves of rounds that
measure U, too. The ratio to it is what to read on a noisy machine.
"""

from __future__ import annotations

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("OMP_NUM_THREADS", "1")

import platform
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from time import process_time

import numpy as np

RESULTS = Path(__file__).parents[1] / "results"
CACHE = TemporaryDirectory()  # of byte code
KAPPA = 0.8 / 3.6  # at nu = 0.1
REPEATS, ROUNDS = 9, 7

#: name, compliances (one for both, or a pair), f/kappa (None: frictionless, inf: full stick), rtol,
#: quantities, goals in U
CASES: list[
    tuple[str, float, float | None, float, tuple[str, ...] | None, float | None, float | None]
] = [
    ("normal", 0.5, None, 1e-12, None, 0.75, 0.02),
    ("normal", 1e-6, None, 1e-12, None, 0.75, 0.02),
    ("normal", 0.5, None, 1e-4, None, None, 0.005),
    ("approach alone", 0.5, None, 1e-10, ("approach",), None, 0.01),
    ("approach alone", 1e-6, None, 1e-10, ("approach",), None, 0.01),
    ("full stick", 0.5, float("inf"), 1e-12, None, 1.5, None),
    ("full stick", 1e-6, float("inf"), 1e-12, None, 1.5, None),
    ("partial slip", 0.5, 0.3, 1e-12, None, 4.0, 0.25),
    ("partial slip", 1e-6, 2.0, 1e-12, None, 4.0, 0.25),
    ("partial slip", 0.5, 0.3, 1e-2, None, None, None),
]

_DENSE = np.random.default_rng(0).standard_normal((1000, 1000))

#: Elastic coupling, likewise; `bench_coupled` runs them.
COUPLED = [
    ("full stick, coupled", 0.5, float("inf"), 1e-12, None, 3.0, 0.5),
    ("full stick, coupled", 1e-6, float("inf"), 1e-12, None, 3.0, 0.5),
    ("full stick, coupled", 0.0, float("inf"), 1e-12, None, None, None),
    ("partial slip, coupled", 0.5, 0.3, 1e-12, None, None, 5.0),
    ("partial slip, coupled", 0.5, 0.3, 1e-6, None, None, None),
    ("partial slip, coupled", 1e-6, 2.0, 1e-12, None, None, 5.0),
    ("partial slip, coupled", 0.0, 2.0, 1e-12, None, None, None),
    ("slip inside, coupled", (0.05, 1.0), 0.23, 1e-12, None, None, None),
    ("slip inside, coupled", (0.05, 1.0), 0.23, 1e-6, None, None, None),
]

_COLD = """
import os
os.environ["OPENBLAS_NUM_THREADS"] = os.environ["OMP_NUM_THREADS"] = "1"
import numpy as np
from time import perf_counter
from spectral_contact import Scene, clear_caches, solve
import scipy.linalg, scipy.special
def solved():
    begin = perf_counter()
    solve(Scene(0.1, {c}, {b}, {f}, **{more}), {rtol}, {q})
    return perf_counter() - begin
cold = solved()
clear_caches()
anew = solved()
a = np.random.default_rng(0).standard_normal((1000, 1000))
np.linalg.solve(a, a[0])
times = []
for _ in range(7):
    begin = perf_counter(); np.linalg.solve(a, a[0]); times.append(perf_counter() - begin)
print(cold / sorted(times)[3], anew / sorted(times)[3])
"""


def dense_solve() -> float:
    """Return U in seconds."""
    return _median(lambda i: np.linalg.solve(_DENSE, _DENSE[0]))


def _median(function: Callable[[int], object]) -> float:
    times = []
    for i in range(REPEATS):
        begin = process_time()
        function(i)
        times.append(process_time() - begin)
    return median(times)


def scene_of(case: tuple, i: float):
    """Return the scene of a case, varied by `i` hundredths."""
    from spectral_contact import Scene

    _, _, ratio, *_ = case
    c, b = compliances(case)
    shift = 1.0 + 0.01 * i
    nu = 0.1
    if ratio is None:
        return Scene(nu, c * shift)
    friction = ratio if ratio == float("inf") else ratio * KAPPA * shift
    # a smooth surface has nothing else to vary
    return Scene(nu * (shift if c == 0.0 else 1.0), c * shift, b * shift, friction, **_more(case))


def compliances(case: tuple) -> tuple[float, float]:
    """Return the normal and the tangential compliance of a case."""
    first, second = case[1] if isinstance(case[1], tuple) else (case[1], case[1])
    return first, second


def _more(case: tuple) -> dict[str, bool]:
    """Return what the scenes of a case have beside numbers."""
    return {"coupling": True} if "coupled" in case[0] else {}


def warm(case: tuple) -> tuple[float, float, int]:
    """Return the warm time in seconds, in U measured just before, and the unknowns.

    Medians of rounds, so that a machine that is slow for a while is slow for both.
    """
    from spectral_contact import solve

    rtol, quantities = case[3], case[4]
    times, ratios = [], []
    for _ in range(ROUNDS):
        unit = dense_solve()
        for i in range(REPEATS):
            solution = solve(scene_of(case, i), rtol, quantities)
        # other scenes than those that filled the caches
        times.append(_median(lambda i: solve(scene_of(case, i + 0.5), rtol, quantities)))
        ratios.append(times[-1] / unit)
    return median(times), median(ratios), solution.work.unknowns


def cold(case: tuple) -> tuple[float, float]:
    """Return the first solve and the one with emptied caches, in U of the same process.

    Medians over fresh processes.
    """
    _, _, ratio, rtol, quantities, *_ = case
    c, b = compliances(case)
    friction = (
        "None" if ratio is None else f'float("{ratio}") * {1.0 if ratio == float("inf") else KAPPA}'
    )
    code = _COLD.format(
        c=c, b=0.0 if ratio is None else b, f=friction, rtol=rtol, q=quantities, more=_more(case)
    )
    runs = [[float(x) for x in _fresh(code).split()] for _ in range(5)]
    first, anew = (median(column) for column in zip(*runs, strict=True))
    return first, anew


def _fresh(code: str) -> str:
    """Return what a fresh process prints; byte code is cached, as in any installation."""
    with_cache = os.environ | {"PYTHONDONTWRITEBYTECODE": "", "PYTHONPYCACHEPREFIX": CACHE.name}
    return subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, env=with_cache
    ).stdout


def import_time() -> tuple[float, float]:
    """Return import times in seconds: numpy alone, and this library over it."""
    code = (
        "from time import perf_counter as t; a=t(); import numpy; b=t(); "
        "import spectral_contact; print(b-a, t()-b)"
    )
    runs = []
    for _ in range(7):
        runs.append([float(x) for x in _fresh(code).split()])
    return median(r[0] for r in runs), median(r[1] for r in runs)


def main() -> None:
    """Measure, print and store."""
    run("bench_solve", CASES)


def run(name: str, cases: list[tuple]) -> None:
    """Measure cases, print and store under a name."""
    import scipy

    numpy_import, own_import = import_time()
    rows = []
    for case in cases:
        time, ratio, unknowns = warm(case)
        first, anew = cold(case)
        rows.append(
            {
                "case": case[0],
                "compliance": case[1],
                "rtol": case[3],
                "unknowns": unknowns,
                "U_ms": 1e3 * time / ratio,
                "warm_ms": 1e3 * time,
                "warm_U": ratio,
                "warm_goal_U": case[6],
                "cold_U": first,
                "cold_goal_U": case[5],
                "anew_U": anew,
            }
        )
    record = {
        "python": platform.python_version(),
        "numpy": np.__version__,
        "scipy": scipy.__version__,
        "import_numpy_s": numpy_import,
        "import_over_numpy_s": own_import,
        "rows": rows,
    }
    RESULTS.mkdir(exist_ok=True)
    text = table(record)
    (RESULTS / f"{name}.md").write_text(text)
    print(text)


def table(record: dict) -> str:
    """Return the results as a Markdown table."""

    def goal(value: float | None) -> str:
        return "–" if value is None else f"{value:g}"

    lines = [
        f"Python {record['python']}, numpy {record['numpy']}, scipy {record['scipy']}, "
        f"one BLAS thread; import {record['import_over_numpy_s']:.2f} s over numpy's "
        f"{record['import_numpy_s']:.2f} s.",
        "",
        "| problem | α* = β* | rtol | unknowns | warm [ms] | warm [U] | goal | cold [U] | goal | "
        "anew [U] |",
        "|---|---|---|---|---|---|---|---|---|---|",
    ]
    for r in record["rows"]:
        one = r["compliance"]
        both = ", ".join(f"{c:g}" for c in one) if isinstance(one, (list, tuple)) else f"{one:g}"
        lines.append(
            f"| {r['case']} | {both} | {r['rtol']:g} | {r['unknowns']} | "
            f"{r['warm_ms']:.2f} | {r['warm_U']:.3f} | {goal(r['warm_goal_U'])} | "
            f"{r['cold_U']:.2f} | {goal(r['cold_goal_U'])} | {r['anew_U']:.2f} |"
        )
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    main()
