"""Smooth spheres and cones: ContactMechanics' closed forms beside ours.

Run as ``python validation/peers/smooth.py``; writes validation/results/peers_smooth.md. E' is a
quarter of the contact modulus E/(1 - nu^2), which is 4 here. Needs ContactMechanics:
``pip install ContactMechanics``.
"""

from __future__ import annotations

import sys
from math import pi
from pathlib import Path

sys.path.append(str(Path(__file__).parents[1]))

import numpy as np
from ContactMechanics.ReferenceSolutions import Cone, Hertz
from reporting import table, write

from spectral_contact import Scene, Solution, profiles, solve

MODULUS, NU, RTOL = 4.0, 0.3, 1e-12
LOADS, ANGLES = (1e-3, 1.0, 1e3), (0.2, 0.8, 1.4)
RADII = np.linspace(0.0, 0.999, 200)
#: Of stresses, in contact radii: from the axis to beyond the edge, and down.
PLACES = np.meshgrid(np.linspace(0.0, 2.0, 9), np.linspace(0.01, 2.0, 9))


def largest(ours: object, theirs: object, size: float | None = None) -> float:
    """Return the largest difference, relative to what it differs from or to a size."""
    one, other = np.asarray(ours), np.asarray(theirs)
    return float(np.max(np.abs(one - other) / (np.abs(other) if size is None else size)))


def sphere(load: float) -> dict[str, float]:
    """Return differences of a parabola of radius 1."""
    mine: Solution = solve(Scene(NU, profile=profiles.Parabola(1.0), load=load), RTOL)
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
    mine: Solution = solve(Scene(NU, profile=profiles.Cone(angle), contact_radius=1.0), RTOL)
    ratio, _ = Cone.contact_radius_and_area(angle)
    mean = MODULUS * Cone.load_and_mean_pressure(angle)[1]
    shape = Cone.pressure(RADII[1:] * ratio, angle)  # radii over the penetration
    return {
        "approach": largest(mine.approach, 1.0 / ratio),
        "load": largest(mine.load, pi * mean),
        "pressure": largest(mine.pressure(RADII[1:]), mean * shape),
    }


def main() -> None:
    """Write the table."""
    rows = [(f"parabola, load {load:g}", sphere(load)) for load in LOADS]
    rows += [(f"cone, half-angle {angle:g}", cone(angle)) for angle in ANGLES]
    names = ("approach", "radius", "load", "work", "pressure", "stresses")
    cells = (
        (label, *(f"{found[name]:.0e}" if name in found else "" for name in names))
        for label, found in rows
    )
    about = (
        "# Smooth spheres and cones, by ContactMechanics and by us\n\n"
        "Largest relative differences, by validation/peers/smooth.py; those of stresses are "
        "relative to the largest pressure."
    )
    write("peers_smooth", f"{about}\n\n{table(' | '.join(['', *names]), cells)}")


if __name__ == "__main__":
    main()
