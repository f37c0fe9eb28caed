"""What the net times, and how much slower than at the commit each kind may be.

The cases are those of bench_solve, bench_coupled and bench_sweep, and two kinds of slip that these
lack: without tangential compliance, and inside.
"""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.append(str(Path(__file__).parents[1] / "cost"))

import bench_solve
import bench_sweep

#: Cases as `bench_solve.CASES` has them. With slip inside, friction is between the second
#: threshold and the critical friction, for every scene that `bench_solve.scene_of` makes of it.
ADDED = (
    ("partial slip", (0.5, 0.0), 0.3, 1e-12, None, None, None),
    ("slip inside", (0.05, 1.0), 0.215, 1e-12, None, None, None),
)
SOLVES = {"solve": (*bench_solve.CASES, *ADDED), "coupled": tuple(bench_solve.COUPLED)}
SWEEPS = bench_sweep.CASES

#: The largest ratio of times, new over old, of each kind.
LIMITS = {
    "normal": 1.1,
    "sweep by spectra": 1.1,
    "full stick": 2.0,
    "one disk": 3.0,
    "one disk, β = 0": 6.0,
    "slip inside": 2.0,
    "coupled": 2.5,
    "map of c*, Q*": 4.0,
}


def kind_of_solve(case: tuple) -> str:
    """Return the kind of a case of `SOLVES`."""
    name = case[0]
    if "coupled" in name:
        return "coupled"
    if name == "partial slip":
        return "one disk, β = 0" if bench_solve.compliances(case)[1] == 0.0 else "one disk"
    return name if name in LIMITS else "normal"


def kind_of_sweep(case: bench_sweep.Case) -> str:
    """Return the kind of a sweep."""
    return "map of c*, Q*" if "stick_radius" in case.quantities else "sweep by spectra"
