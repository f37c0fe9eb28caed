"""Zones on graded rings against those of `solve`: their number, kind and boundaries, and the time.

Run as ``python validation/honesty/ring_zones.py [--scenes N]``, N of each group; prints tables.
Random scenes are compared where `solve` converges. The times are medians of rounds that measure U,
too.
"""

from __future__ import annotations

import itertools
import math
import sys
from functools import partial
from pathlib import Path
from statistics import median
from typing import Any
from unittest.mock import patch

sys.path.append(str(Path(__file__).parents[1]))

import numpy as np
from reporting import options, seconds, table, unit

from spectral_contact import Scene, SpectralContactError, solve
from spectral_contact.contact.active_set import RingLayout, RingSystem, ring_layout
from spectral_contact.fields.series import Radius
from spectral_contact.spectral.parameters import Parameters

SEED, COUNT = 18, 6
RINGS, SPLITS = (60, 120, 300), (0, 1, 2, 3)
GROUPS = ("edge slips", "slip inside", "equal compliances", "beta 0", "smooth")

Row = dict[str, Any]


def draw(group: str, coupled: bool, number: int) -> Scene:
    """Return a scene that slips in most cases."""
    rng = np.random.default_rng([SEED, GROUPS.index(group), coupled, number])
    nu = rng.uniform(-0.5, 0.49)
    alpha, beta = sorted(10.0 ** rng.uniform(-6.0, 1.0, 2), reverse=group != "slip inside")
    if group == "slip inside" and number % 4 == 0:
        alpha = 0.0
    if group == "equal compliances":
        beta = alpha
    if group in ("beta 0", "smooth"):
        beta = 0.0
    if group == "smooth":
        alpha = 0.0
    asked = "critical_friction", "edge_ratio"
    stick = solve(Scene(nu, alpha, beta, math.inf), 1e-6, asked)
    most = min(stick.critical_friction, 6.0 * stick.scene.kappa)
    least = stick.edge_ratio if group == "slip inside" and alpha > 0.0 else 0.03 * most
    friction = least + (most - least) * rng.uniform(0.02, 0.98)
    return Scene(nu, alpha, beta, friction, coupling=coupled)


def layout(scene: Scene, rings: int, splits: int = 2) -> RingLayout:
    """Return the zones of a scene on rings."""
    assert scene.friction is not None
    compliances = scene.normal_compliance, scene.tangential_compliance
    parameters = Parameters(*compliances, scene.kappa, scene.friction)
    return ring_layout(parameters, coupled=scene.coupling, first_rings=rings, splits=splits)


def counted(scene: Scene, rings: int, splits: int = 2) -> tuple[RingLayout, int]:
    """Return the zones of a scene on rings, and how many systems they take."""
    with patch.object(RingSystem, "solve", autospec=True, side_effect=RingSystem.solve) as solved:
        found = layout(scene, rings, splits)
    return found, solved.call_count


def compare(scene: Scene, solution: Any, rings: int, splits: int = 2) -> Row:
    """Return what a number of rings makes of a scene."""
    found, systems = counted(scene, rings, splits)
    zones = [zone.kind for zone in solution.zones]
    right = zones == ["slip" if state else "stick" for state in found.states]
    row: Row = {
        "rings": rings,
        "splits": splits,
        "used": len(found.ring_state.states),
        "right": right,
    }
    row |= {
        "settled": found.converged,
        "positive": found.ring_state.pressure_is_positive,
        "iterations": systems,
    }
    row["approach"] = found.ring_state.approach / solution.approach - 1.0
    if right:
        ends = [Radius(zone.outer, zone.outer_from_edge) for zone in solution.zones[:-1]]
        pairs = zip(found.boundaries, ends, strict=True)
        row["logits"] = [abs(one.logit - true.logit) for one, true in pairs]
    return row


def random_scenes(count: int) -> list[Row]:
    """Return comparisons of all groups."""
    rows = []
    for group in GROUPS:
        for coupled in (False, True):
            for number in range(count):
                scene = draw(group, coupled, number)
                row: Row = {"group": group, "coupled": coupled, "scene": scene.to_dict()}
                try:
                    solution = solve(scene, 1e-6)
                except SpectralContactError as refused:
                    rows.append(row | {"refused": type(refused).__name__})
                    continue
                row["zones"] = len(solution.zones)
                row["found"] = [compare(scene, solution, rings) for rings in RINGS]
                others = [splits for splits in SPLITS if splits != 2]
                row["found"] += [compare(scene, solution, RINGS[0], splits) for splits in others]
                rows.append(row)
    return rows


def times() -> list[Row]:
    """Return times in U; the first grid is kept, those with split rings are new."""
    rows = []
    cases = (("one disk", 0.5, 0.5, 0.03), ("slip inside", 0.05, 1.0, 0.03))
    for name, alpha, beta, friction in cases:
        for coupled in (False, True):
            for rings in RINGS:
                shares = []
                for number in range(8):
                    # frictions at which boundaries lie in other rings
                    scene = Scene(
                        0.3, alpha, beta, friction * (1.0 + 0.02 * number), coupling=coupled
                    )
                    shares.append(seconds(partial(layout, scene, rings)) / unit())
                row = {"case": name, "coupled": coupled, "rings": rings}
                rows.append(row | {"units": median(shares[1:])})
    return rows


def summary(rows: list[Row]) -> list[tuple[object, ...]]:
    """Return counts and errors of groups, by rings and splits, as cells of a table."""
    cells: list[tuple[object, ...]] = []
    for group, coupled in itertools.product(GROUPS, (False, True)):
        some = [r for r in rows if r["group"] == group and r["coupled"] == coupled]
        solved = [r["found"] for r in some if "found" in r]
        for each in zip(*solved, strict=True):
            errors = [error for one in each for error in one.get("logits", [])]
            sizes = np.median(errors), np.quantile(errors, 0.9), max(errors)
            cells.append(
                (
                    group,
                    "yes" if coupled else "no",
                    each[0]["rings"],
                    each[0]["splits"],
                    f"{median(one['used'] for one in each):.0f}",
                    f"{sum(one['right'] for one in each)} of {len(solved)}",
                    sum(one["settled"] for one in each),
                    max(one["iterations"] for one in each),
                    *(f"{size:.1e}" for size in sizes),
                )
            )
    return cells


def main(count: int) -> None:
    """Measure, and print."""
    rows = random_scenes(count)
    print(
        f"{sum('found' in row for row in rows)} random scenes that `solve` solves at rtol 1e-6. "
        "Right: number and kind of zones. Errors are those of `ln(c²/(1 − c²))` of all boundaries."
        "\n"
    )
    heading = "group | coupled | rings | splits | rings used | right | settled | most systems | "
    print(table(f"{heading}median error | 90 % | largest", summary(rows)), end="\n\n")
    cells = (
        (r["case"], "yes" if r["coupled"] else "no", r["rings"], f"{r['units']:.2f}")
        for r in times()
    )
    print(table("time | coupled | rings | U", cells))


if __name__ == "__main__":
    main(options(__doc__, scenes=COUNT).scenes)
