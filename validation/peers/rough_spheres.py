"""Greenwood and Tripp's rough spheres by ContactMechanics, beside ours.

Run as ``python validation/peers/rough_spheres.py``; writes
validation/results/peers_rough_spheres.md. Both solve the same problem: mu = 24.04, a separation of
half a standard deviation at the deformed centre. The truth has 20 digits, from `reference` with the
approach that this separation has. Needs ContactMechanics: ``pip install ContactMechanics``.
"""

from __future__ import annotations

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import math
import sys
from collections.abc import Callable
from pathlib import Path
from time import perf_counter

sys.path.append(str(Path(__file__).parents[1] / "cost"))

from bench_solve import dense_solve
from ContactMechanics.ReferenceSolutions.GreenwoodTripp import GreenwoodTripp
from scipy.integrate import simpson

from spectral_contact import Scene, layers, profiles, solve

RESULTS = Path(__file__).parents[1] / "results"
MU, SEPARATION, CENTRE = 24.0425586841, 0.5, 7.705398372318
LOAD, PRESSURE = 44.168134490720222962, 4.6931940983576888024
#: Points and the change at which the iteration ends: the first are the defaults.
GRIDS = (100, 1e-6), (200, 1e-6), (200, 1e-9), (400, 1e-9)
TOLERANCES = 1e-4, 1e-8, 1e-12
REPEATS = 3


def theirs(points: int, tol: float) -> tuple[float, float]:
    """Return load and pressure at the centre."""
    _, p, rho = GreenwoodTripp(SEPARATION, MU, n=points, tol=tol)
    return 2.0 * math.pi * float(simpson(p * rho, x=rho)), float(p[0])


def ours(rtol: float) -> tuple[float, float]:
    """Return the same: lengths and loads have their unit where sigma is 1/2 and R is 1."""
    law = layers.GreenwoodWilliamson(
        density=MU / (16.0 / 3.0 * 0.5**1.5), tip_radius=1.0, height_deviation=0.5
    )
    scene = Scene(
        0.3, layer=law, profile=profiles.Parabola(1.0), approach=0.5 * (CENTRE - SEPARATION)
    )
    found = solve(scene, rtol, ["load", "pressure"])
    return found.load, float(found.pressure(0.0))


def row(name: str, run: Callable[[], tuple[float, float]]) -> str:
    """Return a line of the table: errors, the least of some times and the same in U."""
    seconds, unit = math.inf, math.inf
    for _ in range(REPEATS):
        unit = min(unit, dense_solve())
        start = perf_counter()
        load, pressure = run()
        seconds = min(seconds, perf_counter() - start)
    off = abs(load / LOAD - 1.0), abs(pressure / PRESSURE - 1.0)
    cells = [name, *(f"{one:.0e}" for one in off), f"{seconds:.2g}", f"{seconds / unit:.2g}"]
    return "| " + " | ".join(cells) + " |"


def main() -> None:
    """Write the table."""
    lines = [
        "# Rough spheres, by ContactMechanics and by us",
        "",
        "Relative errors of Greenwood and Tripp's contact at mu = 24.04, separation 0.5, by "
        "validation/peers/rough_spheres.py. U is one dense solve of 1000 unknowns in the same run.",
        "",
        "| | load | pressure at the centre | s | U |",
        "|---|---|---|---|---|",
    ]
    runs = [
        (f"ContactMechanics, {n} points, to {tol:.0e}", lambda n=n, tol=tol: theirs(n, tol))
        for n, tol in GRIDS
    ]
    runs += [(f"ours, rtol {rtol:.0e}", lambda rtol=rtol: ours(rtol)) for rtol in TOLERANCES]
    for name, run in runs:
        lines.append(row(name, run))
        print(lines[-1], flush=True)
    (RESULTS / "peers_rough_spheres.md").write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
