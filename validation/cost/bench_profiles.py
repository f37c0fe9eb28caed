"""Time contact under profiles against one dense solve.

Run as ``python validation/cost/bench_profiles.py``; writes validation/results/bench_profiles.md. U
is the time of one ``numpy.linalg.solve`` of a dense 1000 x 1000 system, measured in the same
rounds, one BLAS thread. Warm: another compliance and radius, or load, of the same kind, with
operator caches filled; solutions are never cached. Figures are medians.
"""

from __future__ import annotations

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("OMP_NUM_THREADS", "1")

from pathlib import Path
from statistics import median
from time import perf_counter

import numpy as np

from spectral_contact import Scene, profiles, solve

RESULTS = Path(__file__).parents[1] / "results"
ROUNDS = 9
SHAPES: list[tuple[str, profiles.Profile]] = [
    ("parabola", profiles.Parabola(1.0)),
    ("sphere", profiles.Sphere(3.0)),
    ("cone", profiles.Cone(1.0)),
    ("rounded flat", profiles.RoundedFlat(0.5, 1.0)),
    ("truncated cone", profiles.TruncatedCone(0.5, 1.0)),
]
#: what is given, and its goal in U
GIVEN = [("contact_radius", 0.03), ("load", 0.1)]
_DENSE = np.random.default_rng(0).standard_normal((1000, 1000))
_RIGHT = np.ones(1000)


def timed(scene: Scene) -> float:
    """Return the seconds of a solve."""
    begin = perf_counter()
    solve(scene, 1e-10, strict=False)
    return perf_counter() - begin


def unit() -> float:
    """Return the seconds of the dense solve."""
    begin = perf_counter()
    np.linalg.solve(_DENSE, _RIGHT)
    return perf_counter() - begin


def main() -> None:
    """Measure, and write the table."""
    lines = [
        "# Contact under a profile, in dense solves",
        "",
        f"rtol 1e-10, one BLAS thread, medians of {ROUNDS}; by validation/cost/bench_profiles.py.",
        "",
        "| profile | alpha* | given | unknowns | warm [ms] | warm [U] | goal |",
        "|---|---|---|---|---|---|---|",
    ]
    for name, profile in SHAPES:
        for alpha in (0.5, 1e-3, 0.0):
            for control, goal in GIVEN:
                scenes = [
                    Scene(
                        0.3,
                        alpha * (1.0 + 1e-3 * k),
                        profile=profile,
                        **{control: 1.2 + 1e-3 * k},  # type: ignore[arg-type]
                    )
                    for k in range(ROUNDS)
                ]
                unknowns = solve(scenes[0], 1e-10, strict=False).work.unknowns
                pairs = [(timed(scene), unit()) for scene in scenes]
                seconds = median(one for one, _ in pairs)
                ratio = median(one / other for one, other in pairs)
                lines.append(
                    f"| {name} | {alpha:g} | {control} | {unknowns} | {1e3 * seconds:.2f} | "
                    f"{ratio:.3f} | {goal:g} |"
                )
                print(lines[-1], flush=True)
    (RESULTS / "bench_profiles.md").write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
