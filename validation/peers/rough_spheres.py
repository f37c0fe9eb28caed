"""Greenwood and Tripp's rough spheres by ContactMechanics, beside ours.

Run as ``python validation/peers/rough_spheres.py``; writes
validation/results/peers_rough_spheres.md. Both solve the same problem: mu = 24.04, a separation of
half a standard deviation at the deformed centre. The truth has 20 digits, from `reference` with the
approach that this separation has. Needs ContactMechanics: ``pip install ContactMechanics``.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path

sys.path.append(str(Path(__file__).parents[1]))

from ContactMechanics.ReferenceSolutions.GreenwoodTripp import GreenwoodTripp
from reporting import seconds, table, unit, write
from scipy.integrate import simpson

from spectral_contact import Scene, layers, profiles, solve

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


def row(name: str, run: Callable[[], tuple[float, float]]) -> tuple[str, ...]:
    """Return the cells of a row: errors, the least of some times and the same in U."""
    dense = min(unit() for _ in range(REPEATS))
    spent = min(seconds(run) for _ in range(REPEATS))
    load, pressure = run()
    off = abs(load / LOAD - 1.0), abs(pressure / PRESSURE - 1.0)
    return name, *(f"{one:.0e}" for one in off), f"{spent:.2g}", f"{spent / dense:.2g}"


def main() -> None:
    """Write the table."""
    runs = {
        f"ContactMechanics, {n} points, to {tol:.0e}": partial(theirs, n, tol) for n, tol in GRIDS
    }
    runs |= {f"ours, rtol {rtol:.0e}": partial(ours, rtol) for rtol in TOLERANCES}
    cells = [row(name, run) for name, run in runs.items()]
    about = (
        "# Rough spheres, by ContactMechanics and by us\n\n"
        "Relative errors of Greenwood and Tripp's contact at mu = 24.04, separation 0.5, by "
        "validation/peers/rough_spheres.py. U is one dense solve of 1000 unknowns in the same run."
    )
    heading = " | load | pressure at the centre | s | U"
    write("peers_rough_spheres", f"{about}\n\n{table(heading, cells)}")


if __name__ == "__main__":
    main()
