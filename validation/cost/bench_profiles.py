"""Time contact under profiles against one dense solve.

Run as ``python validation/cost/bench_profiles.py``; prints tables. U is the time of one
``numpy.linalg.solve`` of a dense 1000 x 1000 system, measured in the same rounds, one BLAS thread.
Warm: another compliance and radius, or load, of the same kind, with operator caches filled;
solutions are never cached. Figures are medians, of processor time.
"""

from __future__ import annotations

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("OMP_NUM_THREADS", "1")

import math
from collections.abc import Iterator
from statistics import median
from time import process_time

import numpy as np

from spectral_contact import Scene, profiles, solve, sweep

ROUNDS, FEW = 9, 3
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


#: Friction as the contact grows under a parabola: what, friction, coupling, tolerances, goal in U.
GROWING: list[tuple[str, float, bool, tuple[float, ...], float]] = [
    ("full stick", math.inf, False, (1e-4, 1e-10), 2.0),
    ("partial slip", 0.05, False, (1e-4, 1e-10), 10.0),
    ("full stick, coupled", math.inf, True, (1e-4, 1e-10), 60.0),
    ("partial slip, coupled", 0.1, True, (1e-4,), 60.0),
]
GROWN = ["load", "approach", "pressure", "traction", "total_shear", "stick_radius"]
CURVE, CURVE_GOAL = 200, 5.0


def timed(scene: Scene, rtol: float = 1e-10, quantities: list[str] | None = None) -> float:
    """Return the seconds of a solve, of the processor."""
    begin = process_time()
    solve(scene, rtol, quantities, strict=False, progress=False)
    return process_time() - begin


def growing() -> Iterator[str]:
    """Yield the rows of growing contacts, and of a curve of many loads."""
    shape = profiles.Parabola(1.0)
    for name, friction, coupled, tolerances, goal in GROWING:
        for rtol in tolerances:
            scenes = [
                Scene(
                    0.3,
                    0.2,
                    0.2,
                    friction,
                    coupling=coupled,
                    profile=shape,
                    contact_radius=1.0 + 1e-3 * k,
                )
                for k in range(1 + FEW)
            ]
            timed(scenes[0], rtol, GROWN)
            pairs = [(timed(scene, rtol, GROWN), unit()) for scene in scenes[1:]]
            yield row(f"| {name} | {rtol:g} |", pairs, goal)
    for alpha in (0.5, 0.0):
        pairs = []
        for k in range(1 + FEW):
            loads, begin = np.linspace(0.1, 2.0 + 1e-3 * k, CURVE), process_time()
            names = ["contact_radius", "approach", "load", "stiffness"]
            sweep(
                Scene(0.3, alpha, profile=shape, load=1.0), load=loads, quantities=names, rtol=1e-10
            )
            pairs.append((process_time() - begin, unit()))
        yield row(f"| {CURVE} loads, alpha* = {alpha:g} | 1e-10 |", pairs[1:], CURVE_GOAL)


def row(head: str, pairs: list[tuple[float, float]], goal: float) -> str:
    """Return a row of the table of growing contacts."""
    seconds = median(one for one, _ in pairs)
    ratio = median(one / other for one, other in pairs)
    return f"{head} {1e3 * seconds:.0f} | {ratio:.1f} | {goal:g} |"


def unit() -> float:
    """Return the seconds of the dense solve."""
    begin = process_time()
    np.linalg.solve(_DENSE, _RIGHT)
    return process_time() - begin


def main() -> None:
    """Measure, and print each line when it is known."""
    print(f"# Contact under a profile, in dense solves\n\nrtol 1e-10, medians of {ROUNDS}.\n")
    print("| profile | alpha* | given | unknowns | warm [ms] | warm [U] | goal |")
    print("|---|---|---|---|---|---|---|")
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
                print(
                    f"| {name} | {alpha:g} | {control} | {unknowns} | {1e3 * seconds:.2f} | "
                    f"{ratio:.3f} | {goal:g} |",
                    flush=True,
                )
    print(
        "\nFriction under a growing contact, alpha* = beta* = 0.2, radius 1, with fields, "
        f"and curves of loads; medians of {FEW}.\n"
    )
    print("| what | rtol | warm [ms] | warm [U] | goal |\n|---|---|---|---|---|")
    for line in growing():
        print(line, flush=True)


if __name__ == "__main__":
    main()
