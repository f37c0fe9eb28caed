"""Whole solves, cold and warm: groups ``solve`` and ``coupled`` of bench.py.

*Cold* is the first solve in a fresh process after the import; *anew* the same scene once more with
emptied caches, when the code has run before. The net times these cases for other versions of the
library, too, which it imports itself.
"""

from __future__ import annotations

import platform
import subprocess
import sys
from functools import partial
from importlib import import_module
from statistics import median

import numpy as np
import scipy
from timed import Case, fresh, goal, seconds, table, unit, warm, write

KAPPA = 0.8 / 3.6  # at nu = 0.1
ROUNDS, PROCESSES = 27, 5

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

#: Elastic coupling, likewise.
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


def work(case: tuple, place: float) -> partial:
    """Return the solve of a case at a place."""
    from spectral_contact import solve

    return partial(solve, scene_of(case, place), case[3], case[4])


def cold(case: tuple) -> tuple[float, float]:
    """Return the first solve and the one with emptied caches, in U, of this fresh process."""
    from spectral_contact import clear_caches

    for module in ("scipy.linalg", "scipy.special"):  # no part of a solve
        import_module(module)

    first = seconds(work(case, 0.0))
    clear_caches()
    anew = seconds(work(case, 0.0))
    return first / unit(), anew / unit()


def import_time() -> tuple[float, float]:
    """Return import times in seconds: numpy alone, and this library over it."""
    code = (
        "from time import perf_counter as t; a=t(); import numpy; b=t(); "
        "import spectral_contact; print(b-a, t()-b)"
    )
    command = [sys.executable, "-c", code]
    texts = [subprocess.check_output(command, text=True) for _ in range(7)]
    runs = [[float(x) for x in text.split()] for text in texts]
    return median(r[0] for r in runs), median(r[1] for r in runs)


def main(name: str) -> None:
    """Measure and write."""
    numpy_import, own_import = import_time()
    rows = []
    for case in COUPLED if name == "bench_coupled" else CASES:
        what, _, _, rtol, _, cold_goal, warm_goal = case
        both = ", ".join(f"{c:g}" for c in dict.fromkeys(compliances(case)))
        time, ratio = warm(Case((), partial(work, case), 0.0, ROUNDS))
        unknowns = work(case, 0.5)().work.unknowns
        runs = [fresh(cold, case) for _ in range(PROCESSES)]
        first, anew = (f"{median(column):.2f}" for column in zip(*runs, strict=True))
        times = f"{1e3 * time:.2f}", f"{ratio:.3f}", goal(warm_goal), first, goal(cold_goal), anew
        rows.append((what, both, f"{rtol:g}", unknowns, *times))
        print(*rows[-1], flush=True)
    about = (
        f"Python {platform.python_version()}, numpy {np.__version__}, scipy {scipy.__version__}, "
        f"one BLAS thread; import {own_import:.2f} s over numpy's {numpy_import:.2f} s."
    )
    heading = "problem | α* = β* | rtol | unknowns | warm [ms] | warm [U] | goal | cold [U] | goal"
    write(name, f"{about}\n\n{table(f'{heading} | anew [U]', rows)}")
