"""At how many stick radii coupled partial slip satisfies its condition, over random scenes.

Run as ``python validation/physics/coupled_uniqueness.py [--scenes N]``; writes
validation/results/coupled_uniqueness.json and .md.
"""

from __future__ import annotations

import json
import math
from collections import Counter
from dataclasses import asdict

import numpy as np
from common import options, table, write

from spectral_contact import Scene, solve
from spectral_contact.contact.coupled_radii import CandidateRadius, scan_logits, stick_radii
from spectral_contact.contact.layout import Layout
from spectral_contact.contact.zone_problem import FreeBoundaryProblem
from spectral_contact.spectral.parameters import Parameters

SEED, COUNT = 30, 600
#: The first radius that is looked at, and how far the others are apart, as logits.
FIRST, STEP = -24.0, 1.0


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


def shares(counts: list[int]) -> tuple[int, ...]:
    """Return how many of these numbers are 0, 1 and more."""
    seen = Counter(min(one, 2) for one in counts)
    return tuple(seen[k] for k in range(3))


def main(count: int) -> None:
    """Look at all scenes, print and store."""
    rows = []
    for number in range(count):
        scene = draw(number)
        found = [
            {
                "logit": round(one.logit, 3),
                "positive": one.excess < math.inf,
                "possible": one.admissible,
            }
            for one in radii(scene)
        ]
        rows.append({"number": number, "scene": asdict(scene), "radii": found})
        print(json.dumps(rows[-1]), flush=True)
    cells = []
    for number in sorted({len(row["radii"]) for row in rows}):
        own = [row["radii"] for row in rows if len(row["radii"]) == number]
        kinds = ([sum(r[key] for r in one) for one in own] for key in ("positive", "possible"))
        cells.append((number, len(own), *(share for kind in kinds for share in shares(kind))))
    heading = "radii | scenes | with positive pressure: none | one | more | "
    heading += "within friction, too: none | one | more"
    about = f"{len(rows)} scenes; radii at which the traction is continuous:\n\n"
    record = {"seed": SEED, "scenes": len(rows), "rows": rows}
    write("coupled_uniqueness", about + table(heading, cells), record)


if __name__ == "__main__":
    main(options(__doc__, scenes=COUNT).scenes)
