"""Zones on graded rings against those of `solve`: their number, kind and boundaries, and the time.

Run as ``python validation/honesty/ring_zones.py [scenes of each group]``; prints tables. Random
scenes are compared where `solve` converges.
Gaps are relative distances of the friction from where slip begins; there, a second zone of slip or
stick is narrow, and the question is which are seen with how many rings. The times are medians of
rounds that measure U, too.
"""

from __future__ import annotations

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("OMP_NUM_THREADS", "1")

import math
import sys
from dataclasses import replace
from pathlib import Path
from statistics import median
from time import perf_counter
from typing import Any
from unittest.mock import patch

sys.path.append(str(Path(__file__).parents[1] / "cost"))

import numpy as np
from bench_solve import dense_solve

from spectral_contact import Scene, SpectralContactError, solve
from spectral_contact.contact.active_set import RingLayout, RingSystem, ring_layout
from spectral_contact.fields.series import Radius
from spectral_contact.spectral.parameters import Parameters

SEED, COUNT = 18, 6
RINGS, SPLITS = (60, 120, 300), (0, 1, 2, 3)
GAPS = tuple(10.0**-k for k in range(2, 9))
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


#: Where slip begins at the edge, linearly there, and inside.
ONSETS = (("edge", 0.5, 0.2), ("edge", 0.5, 0.5), ("inside", 0.2, 0.5), ("inside", 0.05, 1.0))
#: Scenes at thresholds: at a second one the edge stick zone vanishes, the radius of the fourth is
#: known, and in the last slip is everywhere but in a disk too small to matter.
THRESHOLDS = (
    Scene(0.3, 0.05, 1.0, 0.02941066),
    Scene(0.3, 0.2, 0.5, 0.592739 / 7.0),
    Scene(0.3, 0.2, 0.5, 0.08546448375462859, coupling=True),
    Scene(0.0, friction=0.647468127, coupling=True),
    Scene(0.3216563614452209, 3.902806546943033, 4.804038693556474e-12, 14252.65, coupling=True),
    Scene(0.0026911724429, 0.1138912207903, 0.1810047332363, 0.3111328855888, coupling=True),
    Scene(0.3, 0.0, 0.0, 0.003, coupling=True),
    Scene(0.3, 0.1, 0.1, 1e-80, coupling=True),
)


def onsets() -> list[Row]:
    """Return, just below and above the onset of slip, whether rings see it."""
    rows = []
    for kind, alpha, beta in ONSETS:
        for coupled in (False, True):
            stick = Scene(0.3, alpha, beta, math.inf, coupling=coupled)
            critical = solve(stick, 1e-12, ("critical_friction",)).critical_friction
            for rings in RINGS[:2]:
                row: Row = {"kind": kind, "compliances": [alpha, beta], "coupled": coupled}
                row |= {"rings": rings, "seen": [], "wrong": []}
                above = layout(replace(stick, friction=1.01 * critical), rings)
                row["shift"] = 1.01 * (1.0 - float(above.ring_state.margin.min())) - 1.0
                for gap in GAPS:
                    below = layout(replace(stick, friction=critical * (1.0 - gap)), rings)
                    above = layout(replace(stick, friction=critical * (1.0 + gap)), rings)
                    row["seen"].append(len(below.states) > 1)
                    row["wrong"].append(len(above.states) > 1)
                rows.append(row)
    return rows


def thresholds() -> list[Row]:
    """Return what rings make of scenes at thresholds."""
    rows = []
    for scene in THRESHOLDS:
        for rings in RINGS:
            found, systems = counted(scene, rings)
            row: Row = {"scene": scene.to_dict(), "rings": rings, "states": found.states}
            row["boundaries"] = [[one.value, one.from_edge] for one in found.boundaries]
            rows.append(row | {"settled": found.converged, "iterations": systems})
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
                    begin = perf_counter()
                    layout(scene, rings)
                    shares.append((perf_counter() - begin) / dense_solve())
                row = {"case": name, "coupled": coupled, "rings": rings}
                rows.append(row | {"units": median(shares[1:])})
    return rows


def summary(rows: list[Row]) -> list[Row]:
    """Return counts and errors of groups, by rings and splits."""
    found = []
    for group in GROUPS:
        for coupled in (False, True):
            some = [r for r in rows if r["group"] == group and r["coupled"] == coupled]
            solved = [r["found"] for r in some if "found" in r]
            for number, first in enumerate(solved[0]):
                those = [one[number] for one in solved]
                errors = [error for one in those for error in one.get("logits", [])]
                found.append(
                    {
                        "group": group,
                        "coupled": coupled,
                        "rings": first["rings"],
                        "splits": first["splits"],
                        "refused": len(some) - len(solved),
                        "solved": len(solved),
                        "right": sum(one["right"] for one in those),
                        "settled": sum(one["settled"] for one in those),
                        "iterations": max(one["iterations"] for one in those),
                        "used": median(one["used"] for one in those),
                        "median": float(np.median(errors)),
                        "ninety": float(np.quantile(errors, 0.9)),
                        "largest": max(errors),
                    }
                )
    return found


def table(record: Row) -> str:
    """Return the results as Markdown."""
    lines = [
        f"{record['scenes']} random scenes that `solve` solves at rtol 1e-6. Right: number and "
        "kind of zones. Errors are those of `ln(c²/(1 − c²))` of all boundaries.",
        "",
        "| group | coupled | rings | splits | rings used | right | settled | most systems "
        "| median error | 90 % | largest |",
        "|---" * 11 + "|",
    ]
    for r in record["summary"]:
        lines.append(
            f"| {r['group']} | {'yes' if r['coupled'] else 'no'} | {r['rings']} | {r['splits']} "
            f"| {r['used']:.0f} | {r['right']} of {r['solved']} | {r['settled']} "
            f"| {r['iterations']} | {r['median']:.1e} | {r['ninety']:.1e} | {r['largest']:.1e} |"
        )
    lines += [
        "",
        "Onsets at ν = 0.3: slip is seen from a relative gap below the critical friction on; above "
        "it, wrongly, up to another. The shift is that of the critical friction on rings.",
        "",
        "| slip begins | α*, β* | coupled | rings | shift | seen from | wrong up to |",
        "|---" * 7 + "|",
    ]
    for r in record["onsets"]:
        # the least gap down to which all are seen
        unseen = [g for g, seen in zip(GAPS, r["seen"], strict=True) if not seen]
        seen = [g for g in GAPS if not unseen or g > max(unseen)]
        wrong = [g for g, one in zip(GAPS, r["wrong"], strict=True) if one]
        lines.append(
            f"| {r['kind']} | {r['compliances'][0]:g}, {r['compliances'][1]:g} "
            f"| {'yes' if r['coupled'] else 'no'} | {r['rings']} | {r['shift']:.0e} "
            f"| {min(seen):.0e} | {f'{max(wrong):.0e}' if wrong else '–'} |"
        )
    lines += [
        "",
        "Scenes at thresholds:",
        "",
        "| scene | rings | states | from the edge |",
        "|---" * 4 + "|",
    ]
    for r in record["thresholds"]:
        scene = Scene.from_dict(r["scene"])
        numbers = scene.poisson_ratio, scene.normal_compliance, scene.tangential_compliance
        ends = ", ".join(f"{edge:.4g}" for _, edge in r["boundaries"])
        lines.append(
            f"| {', '.join(f'{one:.6g}' for one in (*numbers, scene.friction))}"
            f"{', coupled' if scene.coupling else ''} | {r['rings']} | {r['states']} "
            f"| {ends} |"
        )
    lines += ["", "| time | coupled | rings | U |", "|---" * 4 + "|"]
    for r in record["times"]:
        coupled = "yes" if r["coupled"] else "no"
        lines.append(f"| {r['case']} | {coupled} | {r['rings']} | {r['units']:.2f} |")
    return "\n".join(lines) + "\n"


def main(count: int) -> None:
    """Measure, and print."""
    rows = random_scenes(count)
    record = {
        "scenes": sum("found" in row for row in rows),
        "summary": summary(rows),
        "onsets": onsets(),
        "thresholds": thresholds(),
        "times": times(),
    }
    print(table(record))


if __name__ == "__main__":
    main(int(sys.argv[1]) if sys.argv[1:] else COUNT)
