"""Zones on graded rings against those of `solve`: their number, kind and boundaries, and the time.

Run as ``python validation/ring_zones.py [scenes of each group]``; writes
validation/results/ring_zones.json and .md. Random scenes are compared where `solve` converges.
Gaps are relative distances of the friction from where slip begins; there, a second zone of slip or
stick is narrow, and the question is which are seen with how many rings. The times are medians of
rounds that measure U, too.
"""

from __future__ import annotations

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("OMP_NUM_THREADS", "1")

import json
import math
import sys
from pathlib import Path
from statistics import median
from time import perf_counter
from typing import Any

import numpy as np
from bench_solve import dense_solve

import spectral_contact
from spectral_contact import Scene, SpectralContactError, solve
from spectral_contact.contact.active_set import RingLayout, ring_layout

RESULTS = Path(__file__).parent / "results"
SEED, COUNT = 18, 60
RINGS = (30, 60, 120, 300)
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


def layout(scene: Scene, rings: int) -> RingLayout:
    """Return the zones of a scene on rings."""
    assert scene.friction is not None
    compliances = scene.normal_compliance, scene.tangential_compliance
    return ring_layout(*compliances, scene.friction, scene.kappa, scene.coupling, rings=rings)


def compare(scene: Scene, solution: Any, rings: int) -> Row:
    """Return what a number of rings makes of a scene."""
    found = layout(scene, rings)
    zones = [zone.kind for zone in solution.zones]
    right = zones == ["slip" if state else "stick" for state in found.states]
    row: Row = {"rings": rings, "used": len(found.pressure), "right": right}
    row |= {"settled": found.settled, "positive": found.positive, "iterations": found.iterations}
    row["approach"] = found.approach / solution.approach - 1.0
    if right:
        row["logits"] = [
            abs(one.logit - 2.0 * math.log(zone.outer) + math.log(zone.outer_from_edge * (1.0 + zone.outer)))
            for one, zone in zip(found.boundaries, solution.zones[:-1], strict=True)
        ]
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
                rows.append(row)
    return rows


if __name__ == "__main__":
    count = int(sys.argv[1])
    rows = random_scenes(count)
    for group in GROUPS:
        for coupled in (False, True):
            some = [r for r in rows if r["group"] == group and r["coupled"] == coupled]
            ok = [r for r in some if "found" in r]
            print(group, coupled, len(some), "refused", len(some) - len(ok), "zones", [r["zones"] for r in ok])
            for i, rings in enumerate(RINGS):
                f = [r["found"][i] for r in ok]
                l = sorted(x for one in f for x in one.get("logits", []))
                print("  ", rings, f[0]["used"], "right", sum(o["right"] for o in f), "settled", sum(o["settled"] for o in f), "its", max(o["iterations"] for o in f),
                      "logit median %.1e 90%% %.1e max %.1e" % (median(l), l[int(.9 * len(l))], l[-1]) if l else "", [ok[k]["scene"] for k, o in enumerate(f) if not o["right"]][:2])
