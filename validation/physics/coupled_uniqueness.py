"""At how many stick radii coupled partial slip satisfies its condition, over random scenes.

Run as ``python validation/physics/coupled_uniqueness.py [count]``; writes
validation/results/coupled_uniqueness.json and .md.
"""

from __future__ import annotations

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("OMP_NUM_THREADS", "1")

import json
import math
import sys
from collections import Counter
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

import spectral_contact
from spectral_contact import Scene, solve
from spectral_contact.contact.coupled_radii import CandidateRadius, scan_logits, stick_radii
from spectral_contact.contact.layout import Layout
from spectral_contact.contact.zone_problem import FreeBoundaryProblem
from spectral_contact.spectral.parameters import Parameters

RESULTS = Path(__file__).parents[1] / "results"
SEED, COUNT = 30, 600
#: The first radius that is looked at, and how far the others are apart, as logits.
FIRST, STEP = -24.0, 1.0

Record = dict[str, Any]


def draw(number: int) -> Scene:
    """Return a scene that slips somewhere; one of its three kinds is smooth or half so."""
    rng = np.random.default_rng([SEED, number])
    alpha, beta = (10.0 ** rng.uniform(-8.0, 1.0) for _ in range(2))
    kind = number % 5
    if kind == 0:
        alpha, beta = 0.0, 0.0
    elif kind == 1:
        beta = 0.0
    elif kind == 2:
        beta = alpha
    ratio = rng.uniform(-0.99, 0.45)
    full = Scene(ratio, alpha, beta, math.inf, coupling=True)
    critical = solve(full, 1e-3, ("critical_friction",)).critical_friction
    most = min(critical, 100.0)
    least = min(0.2 * full.kappa, 0.2 * most)
    friction = math.exp(rng.uniform(math.log(least), math.log(most)))
    return Scene(ratio, alpha, beta, friction, coupling=True)


def radii(scene: Scene) -> list[CandidateRadius]:
    """Return all stick radii of a scene."""
    compliances = scene.normal_compliance, scene.tangential_compliance
    assert scene.friction is not None
    parameters = Parameters(*compliances, scene.kappa, scene.friction)
    problem = FreeBoundaryProblem(parameters, Layout((0.0,), (0, 1)), 1e-3)
    return list(stick_radii(problem, scan_logits(problem, FIRST, STEP)))


def table(record: Record) -> str:
    """Return the results as Markdown."""
    lines = [
        f"{record['scenes']} scenes; radii at which the traction is continuous:",
        "",
        "| radii | scenes | with positive pressure: none | one | more "
        "| within friction, too: none | one | more |",
        "|---|---|---|---|---|---|---|---|",
    ]

    def shares(counts: list[int]) -> str:
        seen = Counter(min(one, 2) for one in counts)
        return " | ".join(str(seen[k]) for k in range(3))

    rows = record["rows"]
    for number in sorted({len(row["radii"]) for row in rows}):
        own = [row["radii"] for row in rows if len(row["radii"]) == number]
        positive = shares([sum(r["positive"] for r in one) for one in own])
        possible = shares([sum(r["possible"] for r in one) for one in own])
        lines.append(f"| {number} | {len(own)} | {positive} | {possible} |")
    return "\n".join(lines) + "\n"


def main(count: int) -> None:
    """Look at all scenes, print and store."""
    rows = []
    for number in range(count):
        scene = draw(number)
        found = [
            {"logit": round(one.logit, 3), "positive": one.positive, "possible": one.admissible}
            for one in radii(scene)
        ]
        rows.append({"number": number, "scene": asdict(scene), "radii": found})
        print(json.dumps(rows[-1]), flush=True)
    record = {
        "schema": "spectral_contact.validation.coupled_uniqueness",
        "version": 1,
        "library": spectral_contact.__version__,
        "seed": SEED,
        "scenes": len(rows),
        "rows": rows,
    }
    (RESULTS / "coupled_uniqueness.json").write_text(json.dumps(record, indent=1) + "\n")
    (RESULTS / "coupled_uniqueness.md").write_text(table(record))
    print(table(record))


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else COUNT)
