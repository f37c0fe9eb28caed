"""Spheres and cones by ContactMechanics, beside ours.

Run as ``python validation/peers/contact_mechanics.py`` after ``pip install ContactMechanics``;
writes validation/results/peers_smooth.md and peers_rough_spheres.md.

Smooth spheres and cones have closed forms there. E' is a quarter of the contact modulus
E/(1 - nu^2), which is 4 here. Greenwood and Tripp's rough spheres are the same problem in both
codes: mu = 24.04, a separation of half a standard deviation at the deformed centre. Their truth has
20 digits, from `reference` with the approach that this separation has.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from functools import partial
from math import pi
from pathlib import Path

sys.path.append(str(Path(__file__).parents[1]))

import numpy as np
from ContactMechanics.ReferenceSolutions import Cone, Hertz
from ContactMechanics.ReferenceSolutions.GreenwoodTripp import GreenwoodTripp
from reporting import seconds, table, unit, write
from scipy.integrate import simpson

from spectral_contact import Scene, layers, profiles, solve

MODULUS, NU, RTOL = 4.0, 0.3, 1e-12
LOADS, ANGLES = (1e-3, 1.0, 1e3), (0.2, 0.8, 1.4)
RADII = np.linspace(0.0, 0.999, 200)
#: Of stresses, in contact radii: from the axis to beyond the edge, and down.
PLACES = np.meshgrid(np.linspace(0.0, 2.0, 9), np.linspace(0.01, 2.0, 9))

MU, SEPARATION, CENTRE = 24.0425586841, 0.5, 7.705398372318
LOAD, PRESSURE = 44.168134490720222962, 4.6931940983576888024
#: Points and the change at which the iteration ends: the first are the defaults.
GRIDS = (100, 1e-6), (200, 1e-6), (200, 1e-9), (400, 1e-9)
TOLERANCES = 1e-4, 1e-8, 1e-12
REPEATS = 3


# --- smooth ---------------------------------------------------------------------------------------


def largest(ours: object, theirs: object, size: float | None = None) -> float:
    """Return the largest difference, relative to what it differs from or to a size."""
    one, other = np.asarray(ours), np.asarray(theirs)
    return float(np.max(np.abs(one - other) / (np.abs(other) if size is None else size)))


def sphere(load: float) -> dict[str, float]:
    """Return differences of a parabola of radius 1."""
    mine = solve(Scene(NU, profile=profiles.Parabola(1.0), load=load), RTOL)
    a, top = Hertz.radius_and_pressure(load, 1.0, MODULUS)
    approach = Hertz.penetration(load, 1.0, MODULUS)
    stress = mine.inside.stress(*PLACES)
    tt, rr, zz, rz = (one * top for one in Hertz.stress(*PLACES, poisson=NU))
    pairs = (stress.tt, tt), (stress.rr, rr), (stress.zz, zz), (np.abs(stress.rz), np.abs(rz))
    return {
        "approach": largest(mine.approach, approach),
        "radius": largest(mine.contact_radius, a),
        "work": largest(mine.indentation_work, Hertz.elastic_energy(approach, 1.0, MODULUS)),
        "pressure": largest(mine.pressure(RADII), top * np.sqrt(1.0 - RADII**2)),
        "stresses": max(largest(*pair, top) for pair in pairs),
    }


def cone(angle: float) -> dict[str, float]:
    """Return differences of a cone of half-angle `angle` on a contact of radius 1."""
    mine = solve(Scene(NU, profile=profiles.Cone(angle), contact_radius=1.0), RTOL)
    ratio, _ = Cone.contact_radius_and_area(angle)
    mean = MODULUS * Cone.load_and_mean_pressure(angle)[1]
    shape = Cone.pressure(RADII[1:] * ratio, angle)  # radii over the penetration
    return {
        "approach": largest(mine.approach, 1.0 / ratio),
        "load": largest(mine.load, pi * mean),
        "pressure": largest(mine.pressure(RADII[1:]), mean * shape),
    }


def write_smooth() -> None:
    """Write the differences of smooth spheres and cones."""
    rows = {f"parabola, load {load:g}": sphere(load) for load in LOADS}
    rows |= {f"cone, half-angle {angle:g}": cone(angle) for angle in ANGLES}
    names = ("approach", "radius", "load", "work", "pressure", "stresses")
    cells = (
        (label, *(f"{found[name]:.0e}" if name in found else "" for name in names))
        for label, found in rows.items()
    )
    about = (
        "# Smooth spheres and cones, by ContactMechanics and by us\n\n"
        "Largest relative differences, by validation/peers/contact_mechanics.py; those of stresses "
        "are relative to the largest pressure."
    )
    write("peers_smooth", f"{about}\n\n{table(' | '.join(['', *names]), cells)}")


# --- rough ----------------------------------------------------------------------------------------


def theirs(points: int, tol: float) -> tuple[float, float]:
    """Return load and pressure at the centre."""
    _, p, rho = GreenwoodTripp(SEPARATION, MU, n=points, tol=tol)
    return 2.0 * pi * float(simpson(p * rho, x=rho)), float(p[0])


def ours(rtol: float) -> tuple[float, float]:
    """Return the same: lengths and loads have their unit where sigma is 1/2 and R is 1."""
    density = MU / (16.0 / 3.0 * 0.5**1.5)
    law = layers.GreenwoodWilliamson(density, tip_radius=1.0, height_deviation=0.5)
    approach = 0.5 * (CENTRE - SEPARATION)
    scene = Scene(NU, layer=law, profile=profiles.Parabola(1.0), approach=approach)
    found = solve(scene, rtol, ["load", "pressure"])
    return found.load, float(found.pressure(0.0))


def row(name: str, run: Callable[[], tuple[float, float]]) -> tuple[str, ...]:
    """Return the cells of a row: errors, the least of some times and the same in U."""
    dense = min(unit() for _ in range(REPEATS))
    spent = min(seconds(run) for _ in range(REPEATS))
    load, pressure = run()
    off = abs(load / LOAD - 1.0), abs(pressure / PRESSURE - 1.0)
    return name, *(f"{one:.0e}" for one in off), f"{spent:.2g}", f"{spent / dense:.2g}"


def write_rough() -> None:
    """Write the errors of rough spheres."""
    runs = {
        f"ContactMechanics, {n} points, to {tol:.0e}": partial(theirs, n, tol) for n, tol in GRIDS
    }
    runs |= {f"ours, rtol {rtol:.0e}": partial(ours, rtol) for rtol in TOLERANCES}
    about = (
        "# Rough spheres, by ContactMechanics and by us\n\n"
        "Relative errors of Greenwood and Tripp's contact at mu = 24.04, separation 0.5, by "
        "validation/peers/contact_mechanics.py. U is one dense solve of 1000 unknowns in the same "
        "run."
    )
    cells = [row(name, run) for name, run in runs.items()]
    heading = " | load | pressure at the centre | s | U"
    write("peers_rough_spheres", f"{about}\n\n{table(heading, cells)}")


if __name__ == "__main__":
    write_smooth()
    write_rough()
