"""Zones on graded rings against those of `solve`: their number, kind and boundaries, and the time.

Run as ``python validation/honesty/ring_zones.py [--scenes N]``, N of each group; prints a table.
Random scenes are compared where `solve` converges.
"""

from __future__ import annotations

import itertools
import math
import sys
from contextlib import suppress
from pathlib import Path
from statistics import median
from time import process_time
from typing import Any
from unittest.mock import patch

sys.path.append(str(Path(__file__).parents[1]))

import numpy as np
from reporting import options, table, unit

from spectral_contact import Scene, Solution, SpectralContactError, solve
from spectral_contact.contact.active_set import RingLayout, RingSystem, ring_layout
from spectral_contact.fields.series import Radius
from spectral_contact.spectral.parameters import Parameters

SEED, COUNT = 18, 6
RINGS = (60, 120, 300)
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


def compare(scene: Scene, solution: Solution, rings: int, splits: int = 2) -> Row:
    """Return what a number of rings makes of a scene: zones, boundaries, systems solved, time."""
    with patch.object(RingSystem, "solve", autospec=True, side_effect=RingSystem.solve) as systems:
        begin = process_time()
        found = layout(scene, rings, splits)
        spent = process_time() - begin
    kinds = [zone.kind for zone in solution.zones]
    right = kinds == ["slip" if state else "stick" for state in found.states]
    ends = [Radius(zone.outer, zone.outer_from_edge) for zone in solution.zones[:-1]]
    return {
        "rings": rings,
        "splits": splits,
        "used": len(found.ring_state.states),
        "right": right,
        "settled": found.converged,
        "systems": systems.call_count,
        "time": spent / unit(),
        "errors": [
            abs(one.logit - true.logit) for one, true in zip(found.boundaries, ends, strict=True)
        ]
        if right
        else [],
    }


def compared(group: str, coupled: bool, count: int) -> list[list[Row]]:
    """Return what every choice of rings and splits makes of the scenes of a group."""
    choices = [(rings, 2) for rings in RINGS] + [(RINGS[0], splits) for splits in (0, 1, 3)]
    rows = []
    for number in range(count):
        scene = draw(group, coupled, number)
        with suppress(SpectralContactError):
            solution = solve(scene, 1e-6)
            rows.append([compare(scene, solution, *choice) for choice in choices])
    return [list(row) for row in zip(*rows, strict=True)]


def main(count: int) -> None:
    """Measure, and print."""
    cells: list[tuple[object, ...]] = []
    for group, coupled in itertools.product(GROUPS, (False, True)):
        for rows in compared(group, coupled, count):
            errors = [error for row in rows for error in row["errors"]]
            sizes = np.median(errors), np.quantile(errors, 0.9), max(errors)
            cells.append(
                (
                    group,
                    "yes" if coupled else "no",
                    rows[0]["rings"],
                    rows[0]["splits"],
                    f"{median(row['used'] for row in rows):.0f}",
                    f"{sum(row['right'] for row in rows)} of {len(rows)}",
                    sum(row["settled"] for row in rows),
                    max(row["systems"] for row in rows),
                    f"{median(row['time'] for row in rows):.2f}",
                    *(f"{size:.1e}" for size in sizes),
                )
            )
    heading = (
        "group | coupled | rings | splits | rings used | right | settled | most systems | U | "
    )
    heading += "median error | 90 % | largest"
    print(
        "Random scenes that `solve` solves at rtol 1e-6. Right: number and kind of zones. Errors "
        f"are those of `ln(c²/(1 − c²))` of all boundaries.\n\n{table(heading, cells)}"
    )


if __name__ == "__main__":
    main(options(__doc__, scenes=COUNT).scenes)
