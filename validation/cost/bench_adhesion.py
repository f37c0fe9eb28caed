"""Time adhesive contact against one dense solve.

Run as ``python validation/cost/bench_adhesion.py``; writes validation/results/bench_adhesion.md. U
is the time of one ``numpy.linalg.solve`` of a dense 1000 x 1000 system, measured in the same
rounds, one BLAS thread. Warm: another compliance of the same kind, with operator caches filled;
solutions are never cached. Figures are of processor time, the shortest of some rounds, which other
programs lengthen least.
"""

from __future__ import annotations

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("OMP_NUM_THREADS", "1")

import math
from collections.abc import Callable
from pathlib import Path
from time import process_time

import numpy as np

from spectral_contact import Scene, adhesion_cycle, profiles, pull_off, solve

RESULTS = Path(__file__).parents[1] / "results"
ROUNDS, FEW = 7, 3
POINTS = 200
LEAN = ["load", "approach", "pressure", "stiffness", "indentation_work"]
SHAPES: list[tuple[str, profiles.Profile]] = [
    ("parabola", profiles.Parabola(1.0)),
    ("cone", profiles.Cone(1.0)),
    ("truncated cone", profiles.TruncatedCone(0.5, 1.0)),
]
#: What is done, what is given, the rounds, and the goal in U.
WORK: list[tuple[str, str, Callable[[Scene], object], float]] = [
    (
        "all but the stiffness on the branch, of a radius",
        "contact_radius",
        lambda scene: solve(scene, quantities=LEAN, strict=False),
        0.15,
    ),
    ("all, of a radius", "contact_radius", lambda scene: solve(scene, strict=False), 0.15),
    ("all, of a load", "load", lambda scene: solve(scene, strict=False), math.inf),
    ("pull-off", "load", lambda scene: pull_off(scene, strict=False), 1.0),
    (
        f"cycle, {POINTS} points",
        "load",
        lambda scene: adhesion_cycle(scene, "load", points=POINTS),
        5.0,
    ),
]
_DENSE = np.random.default_rng(0).standard_normal((1000, 1000))
_RIGHT = np.ones(1000)


def seconds(work: Callable[[], object]) -> float:
    """Return the processor's time."""
    begin = process_time()
    work()
    return process_time() - begin


def main() -> None:
    """Measure, and write the table."""
    lines = [
        "# Adhesive contact, in dense solves",
        "",
        "rtol 1e-10, one BLAS thread, shortest of some rounds; by "
        "validation/cost/bench_adhesion.py. Under a profile with breaks every radius has operators "
        "of its own, of which the sixty or so of a curve are not kept.",
        "",
        "| profile | alpha* | what | warm [ms] | warm [U] | goal |",
        "|---|---|---|---|---|---|",
    ]
    for name, profile in SHAPES:
        for alpha in (1.0, 0.01, 0.0):
            slow = bool(profile.breaks) and alpha > 0.0
            for what, given, work, goal in WORK:
                if slow and what.startswith("cycle"):
                    continue
                rounds = FEW if slow or goal > 1.0 else ROUNDS
                pairs = []
                for k in range(rounds + 1):
                    scene = Scene(
                        None,
                        alpha * (1.0 + 1e-3 * k),
                        profile=profile,
                        work_of_adhesion=0.1,
                        **{given: 1.0},  # type: ignore[arg-type]
                    )
                    took = seconds(lambda scene=scene, work=work: work(scene))  # type: ignore[misc]
                    pairs.append((took, seconds(lambda: np.linalg.solve(_DENSE, _RIGHT))))
                pairs = pairs[1:]
                told = f"{goal:g}" if math.isfinite(goal) else "-"
                once, dense = map(min, zip(*pairs, strict=True))
                ratio = once / dense
                lines.append(
                    f"| {name} | {alpha:g} | {what} | {1e3 * once:.1f} | {ratio:.2f} | {told} |"
                )
                print(lines[-1], flush=True)
    (RESULTS / "bench_adhesion.md").write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
