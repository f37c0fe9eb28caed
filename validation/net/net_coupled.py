"""Find coupled scenes at thresholds of friction that one earlier commit solves.

Run as ``python validation/net/net_coupled.py`` (some minutes); writes
validation/net/coupled_thresholds.json with ten scenes next to second thresholds, where the edge
begins to slip as well, and ten where friction is below the critical one by 1e-9 of it or less. The
scenes are solved by the library of the commit `SOLVED_BY`. One that it refuses, or of whose zones
it does not know whether they are all, is left out, and the next is taken.
"""

from __future__ import annotations

import os

os.environ["OPENBLAS_NUM_THREADS"] = "1"
os.environ["OMP_NUM_THREADS"] = "1"

import itertools
import json
import math
import sys
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from net_commit import run_with_library_of

#: The commit whose solver decides which scenes are listed.
SOLVED_BY = "c22aa78ba1723f41c1d06b040e38abf9f06b9851"
FILE = Path(__file__).parent / "coupled_thresholds.json"
#: How many scenes there are of either kind, and how many of them may have the same compliances.
COUNT = 10
MOST_OF_A_BASE = 2
#: Poisson's ratio, normal and tangential compliance: with a second threshold, and with slip that
#: begins at the edge or inside.
SECOND_BASES = (
    (0.3, 0.2, 0.5),
    (0.3, 0.05, 1.0),
    (0.0, 0.2, 0.5),
    (0.1, 0.3, 0.6),
    (0.45, 0.1, 0.3),
    (-0.3, 0.2, 0.6),
    (0.2, 0.5, 2.0),
)
EDGE_BASES = (0.3, 1.0, 0.5), (0.0, 0.5, 0.3), (0.45, 2.0, 0.5), (-0.3, 0.3, 0.1)
INNER_BASES = (0.3, 0.05, 1.0), (0.3, 0.2, 0.5), (0.0, 0.1, 0.6), (0.1, 0.3, 0.9)
#: Relative distances from a threshold: on both sides of a second one, below an onset.
SECOND_DISTANCES = (0.0, 1e-9, -1e-9, 1e-10, -1e-10)
ONSET_DISTANCES = (1e-9, 5e-10, 2e-10, 1e-10)
#: To looser tolerances slip that has just begun is not known to be there.
SECOND_TOLERANCES = (1e-6, 1e-8, 1e-4, 1e-10)
ONSET_TOLERANCES = (1e-9, 1e-10, 1e-11, 1e-12)
#: A second threshold is where bisection to these digits, by solutions to this tolerance, ends.
DIGITS, BISECTION_RTOL = 1e-11, 1e-9
Row = dict[str, Any]


def second_threshold(base: tuple[float, float, float]) -> float:
    """Return the friction below which the edge slips, by bisection on the number of zones."""
    from spectral_contact import Scene, solve

    stick = Scene(*base, math.inf, coupling=True)
    found = solve(stick, 1e-10, ("critical_friction", "edge_ratio"))
    low = found.edge_ratio
    high = 0.5 * (found.critical_friction + found.edge_ratio)
    while high - low > DIGITS * high:
        middle = 0.5 * (low + high)
        scene = Scene(*base, middle, coupling=True)
        if len(solve(scene, BISECTION_RTOL, strict=False).zones) == 3:
            high = middle
        else:
            low = middle
    return 0.5 * (low + high)


def critical_friction(base: tuple[float, float, float]) -> float:
    """Return the friction below which there is slip."""
    from spectral_contact import Scene, solve

    stick = Scene(*base, math.inf, coupling=True)
    return float(solve(stick, 1e-12, ("critical_friction",)).critical_friction)


def candidates(kind: str) -> Iterator[tuple[tuple[float, float, float], Row]]:
    """Yield scenes at thresholds of a kind, with the bases that they have."""
    if kind == "second threshold":
        bases = SECOND_BASES
        threshold = second_threshold
        distances = SECOND_DISTANCES
        tolerances = itertools.cycle(SECOND_TOLERANCES)
    else:
        bases = tuple(itertools.chain(*zip(EDGE_BASES, INNER_BASES, strict=True)))
        threshold = critical_friction
        distances = ONSET_DISTANCES
        tolerances = itertools.cycle(ONSET_TOLERANCES)
    for turn, base in enumerate(bases):
        friction = threshold(base)
        for step in range(len(distances)):
            distance = distances[(turn + step) % len(distances)]
            name = f"{kind}, {', '.join(f'{value:g}' for value in base)}, {0.0 - distance:g}"
            scene = [*base, friction * (1.0 - distance), True]
            yield base, {"name": name, "scene": scene, "rtol": next(tolerances)}


def zones_of(scene: list[Any], rtol: float) -> Row | None:
    """Return the zones with their estimate, or None where the scene is not solved."""
    from net_kept import scene_of, zones_row

    from spectral_contact import SpectralContactError, solve

    try:
        solution = solve(scene_of(scene), rtol, strict=False)
    except SpectralContactError:
        return None
    slips = any(zone.kind == "slip" for zone in solution.zones)
    if not solution.converged or not solution.error.zones < 1.0 or not slips:
        return None
    return {"zones": zones_row(solution), "zones_error": float(solution.error.zones)}


def keep() -> None:
    """Find the scenes and store them, with the library that is imported."""
    rows: list[Row] = []
    for kind in ("second threshold", "onset"):
        found: list[Row] = []
        bases: list[tuple[float, float, float]] = []
        for base, row in candidates(kind):
            if len(found) == COUNT:
                break
            if bases.count(base) == MOST_OF_A_BASE:
                continue
            zones = zones_of(row["scene"], row["rtol"])
            print(row["name"], row["rtol"], zones, file=sys.stderr, flush=True)
            if zones is not None:
                found.append(row | zones)
                bases.append(base)
        rows += found
    record = {
        "schema": "spectral_contact.validation.coupled_thresholds",
        "version": 1,
        "solved_by": SOLVED_BY,
        "scenes": rows,
    }
    FILE.write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")


def load() -> list[Row]:
    """Return the scenes that are kept, as those at thresholds."""
    rows = json.loads(FILE.read_text(encoding="utf-8"))["scenes"]
    return [row | {"slow": False} for row in rows]


def main() -> None:
    """Run this file once more, with the library of the commit."""
    with TemporaryDirectory() as folder:
        run_with_library_of(SOLVED_BY, Path(folder), "import net_coupled; net_coupled.keep()")


if __name__ == "__main__":
    main()
