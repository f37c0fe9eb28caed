"""Growing contacts and adhesion: two groups of bench.py."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import numpy as np
from timed import TABLE, Case, Row, report, timed_rows

from spectral_contact import Scene, adhesion_cycle, profiles, pull_off, solve, sweep

PARABOLA, CONE = profiles.Parabola(1.0), profiles.Cone(1.0)
TRUNCATED = profiles.TruncatedCone(0.5, 1.0)
#: The profiles of contacts that grow, by name; without one it is the parabola.
PROFILES = {None: PARABOLA, "Spence's cone": profiles.Cone(1.2)}
GROWN = ["load", "approach", "pressure", "traction", "total_shear", "stick_radius"]
CURVE = ["contact_radius", "approach", "load", "stiffness"]
#: What is done with adhesion, by the name in bench.toml.
TASKS = {"solve": solve, "pull_off": pull_off, "adhesion_cycle": adhesion_cycle}


def growing() -> Iterator[Case]:
    """Yield friction as the contact grows, and curves of many loads."""

    def grown(place: float, row: Row, rtol: float) -> Callable[[], object]:
        nu, compliance, asked = (0.0, 0.0, None) if "smooth" in row else (0.3, 0.2, GROWN)
        scene = Scene(
            *(nu, compliance, compliance, row["friction"]),
            coupling=row.get("coupling", False),
            profile=PROFILES[row.get("profile")],
            contact_radius=1.0 + 1e-3 * place,
        )
        return partial(solve, scene, rtol, asked, strict=False, progress=False)

    def curve(place: float, row: Row) -> Callable[[], object]:
        scene = Scene(0.3, row["compliance"], profile=PARABOLA, load=1.0)
        loads = np.linspace(0.1, 2.0 + 1e-3 * place, row["loads"])
        return partial(sweep, scene, load=loads, quantities=CURVE, rtol=row["rtol"])

    for row in TABLE["growing"]:
        for rtol in row["rtol"]:
            work = partial(grown, row=row, rtol=rtol)
            yield Case(row | {"rtol": rtol}, work, row["goal"], rounds=3)
    for row in TABLE["curve"]:
        yield Case(row, partial(curve, row=row), row["goal"], rounds=3)


def adhesive() -> Iterator[Case]:
    """Yield contact with adhesion, without slow cycles: on layers under a profile with breaks."""

    def work(place: float, row: Row, alpha: float, **given: Any) -> Callable[[], object]:
        scene = Scene(None, alpha * (1.0 + 1e-3 * place), work_of_adhesion=0.1, **given)
        return partial(TASKS[row["task"]], scene, **row["options"])

    for profile in (PARABOLA, CONE, TRUNCATED):
        for alpha in (1.0, 0.01, 0.0):
            slow = bool(profile.breaks) and alpha > 0.0
            for row in TABLE["adhesion"]:
                if not (slow and row["task"] == "adhesion_cycle"):
                    given = {"alpha": alpha, "profile": profile, row["control"]: 1.0}
                    rounds = 3 if slow or row["goal"] > 1.0 else 9
                    known = row | {"profile": type(profile).__name__, "alpha": alpha}
                    yield Case(known, partial(work, row=row, **given), row["goal"], rounds)


def main(group: str) -> None:
    """Measure a group and write."""
    report(group, timed_rows(growing() if group == "growing" else adhesive()))
