"""Loads that fall and rise under a flat punch, by increments on rings, against the library.

Run as ``python validation/physics/load_history.py`` (minutes); writes
validation/results/load_history.md. The rings (tests/oracles/load_history.py) know neither zones nor
memory: each increment is a quadratic programme. They are of second order where their ends are the
boundaries of zones. What they cannot do is tell their own error without finer rings and smaller
increments, which is why the library has no such march.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from common import table, write

from spectral_contact import Scene, __version__, solve
from tests.oracles.load_history import Rings, even_ends

SCENE = Scene(0.1, 0.5, 0.5, 0.1)
RATIOS = 0.99, 0.8, 0.5, 0.3, 0.2205
RINGS = 100, 200, 400
STEPS = 1, 8, 32, 128


def shear(loads: Sequence[float], count: int, radii: Sequence[float] = ()) -> float:
    """Return Q*/kappa after loads one after another, on rings with ends at some radii."""
    compliances = SCENE.normal_compliance, SCENE.tangential_compliance
    rings = Rings(*compliances, SCENE.friction / SCENE.kappa, even_ends(radii, count))
    for load in loads:
        rings.move_to(float(load))
    return rings.total_shear


def unloading() -> Iterator[tuple[object, ...]]:
    """Yield rows: the shear by rings that end where zones do, against the library."""
    largest = solve(SCENE, 1e-10, ["zones"])
    for ratio in RATIOS:
        solution = solve(SCENE.replace(unloaded_to=ratio), 1e-10, ["zones", "total_shear"])
        known = solution.total_shear / SCENE.kappa
        radii = [zone.outer for one in (largest, solution) for zone in one.zones[:-1]]
        off = [shear([1.0, ratio], count, radii) - known for count in RINGS]
        off.append(off[-1] + (off[-1] - off[-2]) / 3.0)
        yield ratio, f"{known:.12f}", *(f"{one:.1e}" for one in off)


def history() -> Iterator[tuple[object, ...]]:
    """Yield rows: the shear at a load below the turning ratio in one increment and in many."""
    for ratio in (0.2, 0.1):
        shears = (shear(np.linspace(1.0, ratio, steps + 1), 200) for steps in STEPS)
        yield ratio, *(f"{one:.8f}" for one in shears)


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
