"""What full stick and one stick disk cost by the system of any zones, and by their own solvers.

Run as ``python validation/cost/one_system.py``; writes validation/results/one_system.md. Both solve
the same problem under the same pressure; the system begins at the boundary that is the solution,
while the solver of one disk looks for it. Medians of the processor's time, in turns, in U.
"""

from __future__ import annotations

import os

os.environ["OPENBLAS_NUM_THREADS"] = "1"
os.environ["OMP_NUM_THREADS"] = "1"

from collections.abc import Callable
from functools import partial
from math import inf
from pathlib import Path
from statistics import median
from time import process_time
from typing import Any

import numpy as np
from spectral_contact.contact.one_disk import solve_one_disk

from spectral_contact.contact.drive import Drive
from spectral_contact.contact.full_stick import solve_full_stick
from spectral_contact.contact.layout import Layout
from spectral_contact.contact.normal import solve_normal
from spectral_contact.contact.refine import refine
from spectral_contact.contact.zone_problem import FreeBoundaryProblem
from spectral_contact.spectral.parameters import Parameters

RESULTS = Path(__file__).parents[1] / "results"
COMPLIANCES = (0.5, 0.5), (1e-6, 1e-6), (0.5, 1e-9), (1e3, 1e-2)
TOLERANCES = 1e-4, 1e-12
FRICTION, MOST, REPEATS = 0.2, 20_000, 21


def seconds(work: Callable[[], Any]) -> float:
    """Return the time of the processor that some work takes."""
    begin = process_time()
    work()
    return process_time() - begin


def zones(
    drive: Drive, alpha: float, beta: float, friction: float, layout: Layout, rtol: float
) -> Any:
    """Solve by the system of any zones."""
    parameters = Parameters(alpha, beta, 1.0, friction)
    return refine(FreeBoundaryProblem(parameters, layout, rtol, drive=drive), rtol, MOST)


def row(name: str, alpha: float, beta: float, rtol: float, unit: float) -> str:
    """Return a line of the table."""
    drive = Drive(solve_normal(alpha, rtol, MOST).best.value)
    if name == "full stick":
        own = partial(solve_full_stick, drive, beta, rtol, MOST)
        form = inf, Layout((), (0,))
    else:
        friction = min(FRICTION, 0.1 / np.sqrt(alpha + 1.0))
        own = partial(solve_one_disk, drive, beta, friction, rtol, MOST)
        form = friction, own().best.value.layout
    system = partial(zones, drive, alpha, beta, *form, rtol)
    spent: list[tuple[float, float]] = []
    for _ in range(REPEATS):
        spent.append((seconds(own), seconds(system)))
    times = [median(column) / unit for column in zip(*spent, strict=True)]
    ratio = median(second / first for first, second in spent)
    unknowns = own().best.unknowns, system().best.unknowns
    cells = [name, f"{alpha:g}", f"{beta:g}", f"{rtol:g}", *unknowns]
    cells += [*(f"{one:.3f}" for one in times), f"{ratio:.1f}"]
    return "| " + " | ".join(map(str, cells)) + " |"


def main() -> None:
    """Time, print and store."""
    dense = np.random.default_rng(0).standard_normal((1000, 1000))
    unit = median(seconds(partial(np.linalg.solve, dense, dense[0])) for _ in range(5))
    head = "| | α* | β* | rtol | unknowns, own | system | own [U] | system [U] | ratio |"
    lines = [head, "|---" * 9 + "|"]
    for name in ("full stick", "one disk"):
        for compliances in COMPLIANCES:
            lines += [row(name, *compliances, rtol, unit) for rtol in TOLERANCES]
    text = "\n".join(lines) + "\n"
    (RESULTS / "one_system.md").write_text(text, encoding="utf-8")
    print(text)


if __name__ == "__main__":
    main()
