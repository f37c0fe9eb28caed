"""Time fits of measured curves against one dense solve.

Run as ``python validation/cost/bench_fit.py``; writes validation/results/bench_fit.md. U is the
time of one ``numpy.linalg.solve`` of a dense 1000 x 1000 system, measured in the same run, one BLAS
thread; figures are of processor time, medians of three. Loads are the library's, with noise.
"""

from __future__ import annotations

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("OMP_NUM_THREADS", "1")

from pathlib import Path
from statistics import median
from time import process_time

import numpy as np

from spectral_contact import Scene, fit, layers, profiles, pull_off
from spectral_contact.calibration import IndentationData
from spectral_contact.calibration.adhesive_fits import BranchLoads
from spectral_contact.calibration.indentation_curve import curve_loads
from spectral_contact.calibration.layered_fits import layered_loads
from spectral_contact.layers.scene_layer import in_own_units

RESULTS = Path(__file__).parents[1] / "results"
ROUNDS = 3
MODULUS, RADIUS, COMPLIANCE = 4e3, 2.5e-6, 1e-10
NOISE, ADHESION = 2e-11, 5e-5
LAW = layers.Exponential(100.0, 2e-8)
#: points, layer, free parameters, tolerance, goal in U
CASES = (
    (400, "linear", ("reduced_modulus", "normal_compliance", "zero_point"), 1e-10, 170.0),
    (10_000, "none", ("reduced_modulus", "zero_point"), 1e-10, 170.0),
    (10_000, "linear", ("reduced_modulus", "normal_compliance", "zero_point"), 1e-10, 170.0),
    (
        10_000,
        "linear",
        ("reduced_modulus", "normal_compliance", "zero_point", "load_offset", "tilt"),
        1e-10,
        170.0,
    ),
    (10_000, "exponential", ("reduced_modulus", "zero_point"), 1e-6, 170.0),
    (10_000, "none, adhesion", ("reduced_modulus", "work_of_adhesion", "zero_point"), 1e-10, 170.0),
    (
        10_000,
        "linear, adhesion",
        ("reduced_modulus", "normal_compliance", "work_of_adhesion", "zero_point"),
        1e-10,
        170.0,
    ),
)
_DENSE = np.random.default_rng(0).standard_normal((1000, 1000))
_RIGHT = np.ones(1000)


def unit() -> float:
    """Return the seconds of a dense solve, of the processor."""
    begin = process_time()
    np.linalg.solve(_DENSE, _RIGHT)
    return process_time() - begin


def curve(points: int, layer: str, seed: int) -> IndentationData:
    """Return a noisy curve, a third of it in contact."""
    depth, quarter = np.linspace(-1e-6, 5e-7, points), MODULUS / 4.0
    tip = profiles.Sphere(RADIUS)
    compliance = COMPLIANCE if "linear" in layer else 0.0
    if "adhesion" in layer:
        last = pull_off(start(layer)).physical.approach
        load = np.zeros(points)
        found = BranchLoads(tip, 1e-10).loads(
            depth[depth >= last], compliance * quarter, ADHESION / quarter
        )
        load[depth >= last] = found.value
    elif layer == "exponential":
        load = layered_loads(tip, in_own_units(LAW, quarter), depth, 1e-7).value
    else:
        load = curve_loads(tip, depth, compliance * quarter, 1e-10)[:, 0]
    noise = NOISE * np.random.default_rng(seed).standard_normal(points)
    return IndentationData(depth, quarter * load + noise)


def start(layer: str) -> Scene:
    """Return where a fit starts."""
    known = {"reduced_modulus": 2e3, "profile": profiles.Sphere(RADIUS), "load": 1e-9}
    if "adhesion" in layer:
        known |= {"work_of_adhesion": ADHESION}
    if layer == "exponential":
        return Scene.from_physical(**known, layer=LAW)
    return Scene.from_physical(**known, normal_compliance=5e-11 * ("linear" in layer))


def timed(points: int, layer: str, free: tuple[str, ...], rtol: float, seed: int) -> float:
    """Return the time of a fit in U."""
    data, scene = curve(points, layer, seed), start(layer)
    units = [unit() for _ in range(3)]
    begin = process_time()
    fit(scene, data, free, rtol=rtol, progress=False)
    return (process_time() - begin) / median(units)


def main() -> None:
    """Time all fits, and write the table."""
    lines = [
        "# What fits of measured curves cost",
        "",
        f"By `python validation/cost/bench_fit.py`; a sphere, rounds: {ROUNDS}. U is one dense",
        "solve of 1000 unknowns.",
        "",
        "| points | layer | free parameters | tolerance | U | goal |",
        "|---|---|---|---|---|---|",
    ]
    for points, layer, free, rtol, goal in CASES:
        taken = median(timed(points, layer, free, rtol, seed) for seed in range(ROUNDS))
        lines.append(f"| {points} | {layer} | {len(free)} | {rtol:g} | {taken:.0f} | {goal:g} |")
        print(lines[-1], flush=True)
    (RESULTS / "bench_fit.md").write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
