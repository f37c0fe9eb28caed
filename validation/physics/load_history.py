"""Loads that fall and rise under a flat punch, by increments on rings, against the library.

Run as ``python validation/physics/load_history.py`` (minutes); writes
validation/results/load_history.md. The rings (tests/oracles/load_history.py) know neither zones nor
memory: each increment is a quadratic programme. They are of second order where their ends are the
boundaries of zones. What they cannot do is tell their own error without finer rings and smaller
increments, which is why the library has no such march.
"""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.append(str(Path(__file__).parents[1]))
sys.path.append(str(Path(__file__).parents[2]))

import numpy as np
from reporting import table, write

from spectral_contact import Scene, __version__, solve
from tests.oracles.load_history import Rings, even_ends

SCENE = Scene(0.1, 0.5, 0.5, 0.1)
RATIOS = 0.99, 0.8, 0.5, 0.3, 0.2205
RINGS = 100, 200, 400
STEPS = 1, 8, 32, 128


def rings(ends: np.ndarray) -> Rings:
    """Return rings of the scene."""
    assert SCENE.friction is not None
    friction = SCENE.friction / SCENE.kappa
    return Rings(SCENE.normal_compliance, SCENE.tangential_compliance, friction, ends)


def unloading() -> list[tuple[object, ...]]:
    """Return rows: the shear by rings that end where zones do, against the library."""
    rows = []
    largest = solve(SCENE, 1e-10, ["zones"])
    for ratio in RATIOS:
        solution = solve(SCENE.replace(unloaded_to=ratio), 1e-10, ["zones", "total_shear"])
        known = solution.total_shear / SCENE.kappa
        radii = [zone.outer for one in (largest, solution) for zone in one.zones[:-1]]
        differences = []
        for count in RINGS:
            own = rings(even_ends(radii, count))
            own.move_to(1.0)
            own.move_to(ratio)
            differences.append(own.total_shear - known)
        limit = differences[-1] + (differences[-1] - differences[-2]) / 3.0
        cells = (f"{one:.1e}" for one in (*differences, limit))
        rows.append((ratio, f"{known:.12f}", *cells))
    return rows


def history() -> list[tuple[object, ...]]:
    """Return rows: the shear at a load below the turning ratio in one increment and in many."""
    rows = []
    for ratio in (0.2, 0.1):
        shears = []
        for steps in STEPS:
            own = rings(even_ends([], 200))
            own.move_to(1.0)
            for load in np.linspace(1.0, ratio, steps + 1)[1:]:
                own.move_to(float(load))
            shears.append(own.total_shear)
        rows.append((ratio, *(f"{one:.8f}" for one in shears)))
    return rows


def main() -> None:
    """Measure, and write the table."""
    heads = " | ".join(f"{count} rings" for count in RINGS)
    parts = [
        "# The load falls and rises",
        f"spectral_contact {__version__}, `python validation/physics/load_history.py`; "
        "alpha* = beta* = 0.5, nu = 0.1, f = 0.1.",
        "First unloading: Q*/kappa of the library at rtol 1e-10, and that of rings less it; "
        "the last column takes out the second order.",
        table(f"load ratio | Q*/kappa | {heads} | without second order", unloading()),
        "Below the turning ratio: Q*/kappa on 200 rings by the number of increments.",
        table(f"load ratio | {' | '.join(map(str, STEPS))}", history()),
    ]
    write("load_history", "\n\n".join(parts))


if __name__ == "__main__":
    main()
