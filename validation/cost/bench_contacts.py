"""Growing contacts and adhesion: two groups of bench.py."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import numpy as np
from timed import TABLE, Case, run

from spectral_contact import Scene, adhesion_cycle, profiles, pull_off, solve, sweep

PARABOLA, CONE = profiles.Parabola(1.0), profiles.Cone(1.0)
TRUNCATED = profiles.TruncatedCone(0.5, 1.0)
#: The profiles of contacts that grow, by name; without one it is the parabola.
PROFILES = {None: PARABOLA, "Spence's cone": profiles.Cone(1.2)}
GROWN = ["load", "approach", "pressure", "traction", "total_shear", "stick_radius"]
CURVE = ["contact_radius", "approach", "load", "stiffness"]
#: Of a curve of loads, and of a cycle.
LOADS, POINTS = 200, 200
LEAN = ["load", "approach", "pressure", "stiffness", "indentation_work"]
#: With adhesion: what is done, what is given, the work, and the goal in U.
ADHESIVE: list[tuple[str, str, Callable[[Scene], object], float]] = [
    (
        "all but the stiffness on the branch, of a radius",
        "contact_radius",
        partial(solve, quantities=LEAN, strict=False),
        0.15,
    ),
    ("all, of a radius", "contact_radius", partial(solve, strict=False), 0.15),
    ("all, of a load", "load", partial(solve, strict=False), math.inf),
    ("pull-off", "load", partial(pull_off, strict=False), 1.0),
    (f"cycle, {POINTS} points", "load", partial(adhesion_cycle, control="load", points=POINTS), 5),
]


def growing() -> Iterator[Case]:
    """Yield friction as the contact grows, and curves of many loads."""

    def grown(place: float, row: dict[str, Any], rtol: float) -> Callable[[], object]:
        nu, compliance, asked = (0.0, 0.0, None) if "smooth" in row else (0.3, 0.2, GROWN)
        scene = Scene(
            *(nu, compliance, compliance, row["friction"]),
            coupling=row.get("coupling", False),
            profile=PROFILES[row.get("profile")],
            contact_radius=1.0 + 1e-3 * place,
        )
        return partial(solve, scene, rtol, asked, strict=False, progress=False)

    def curve(place: float, alpha: float) -> Callable[[], object]:
        scene = Scene(0.3, alpha, profile=PARABOLA, load=1.0)
        loads = np.linspace(0.1, 2.0 + 1e-3 * place, LOADS)
        return partial(sweep, scene, load=loads, quantities=CURVE, rtol=1e-10)

    for row in TABLE["growing"]:
        for rtol in row["rtol"]:
            work = partial(grown, row=row, rtol=rtol)
            yield Case((row["what"], f"{rtol:g}"), work, row["goal"], rounds=3)
    for alpha in (0.5, 0.0):
        cells = f"{LOADS} loads, alpha* = {alpha:g}", "1e-10"
        yield Case(cells, partial(curve, alpha=alpha), 5.0, rounds=3)


def adhesive() -> Iterator[Case]:
    """Yield contact with adhesion, without slow cycles: on layers under a profile with breaks."""

    def work(
        place: float, task: Callable[[Scene], object], alpha: float, **given: Any
    ) -> Callable[[], object]:
        scene = Scene(None, alpha * (1.0 + 1e-3 * place), work_of_adhesion=0.1, **given)
        return partial(task, scene)

    for profile in (PARABOLA, CONE, TRUNCATED):
        for alpha in (1.0, 0.01, 0.0):
            slow = bool(profile.breaks) and alpha > 0.0
            for what, control, task, goal in ADHESIVE:
                if not (slow and what.startswith("cycle")):
                    given = {"task": task, "alpha": alpha, "profile": profile, control: 1.0}
                    rounds = 3 if slow or goal > 1.0 else 9
                    cells = type(profile).__name__, f"{alpha:g}", what
                    yield Case(cells, partial(work, **given), goal, rounds)


GROUPS = {
    "bench_growing": growing,
    "bench_adhesion": adhesive,
}


def main(name: str) -> None:
    """Measure a group and write."""
    run(name, GROUPS[name]())
