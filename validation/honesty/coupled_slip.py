"""Whether the estimates of coupled partial slip bound the true errors, over random scenes.

Strata of honesty.py: ``coupled_slip`` writes validation/results/coupled_slip_honesty.json and .md,
``coupled_annuli``, whose scenes are such that slip tends to lie in an interior annulus,
coupled_annuli_honesty.json and .md. Every scene is solved at a random tolerance and again at 1e-12;
the second estimate is allowed for. Fields are compared at equal distances from the ends of the
zones, which have an estimate of their own, down to 1e-12 of a zone.
"""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from coupled_slip_errors import FIELDS, INTEGRALS, ratios, sample
from reporting import options, table, write

from spectral_contact import ConvergenceError, NotComputedError, Scene, solve

SEED, COUNT, TRUE_RTOL = 21, 160, 1e-12
#: Share of the scenes that are of two bodies with negative kappa.
TURNED = 0.5

Record = dict[str, Any]


def draw(number: int) -> tuple[Scene, float]:
    """Return a scene that slips, and a tolerance."""
    rng = np.random.default_rng([SEED, number])
    alpha, beta = (10.0 ** rng.uniform(-6.0, 1.0) for _ in range(2))
    kind = number % 8
    if kind == 0:
        alpha, beta = 0.0, 0.0
    elif kind == 1:
        beta = 0.0
    elif kind in (2, 3):
        beta = alpha
    scene = Scene(rng.uniform(-0.5, 0.49), alpha, beta, math.inf, coupling=True)
    critical = solve(scene, 1e-6, ("critical_friction",)).critical_friction
    most = min(0.99 * critical, 6.0 * scene.kappa, 1.0)
    least = 1e-14 if kind == 4 else min(0.02, 0.3 * most)
    friction = math.exp(rng.uniform(math.log(least), math.log(most)))
    rtol = 10.0 ** rng.uniform(-10.0, -3.0)
    return turned(scene.replace(friction=friction), rng), rtol


def turned(scene: Scene, rng: np.random.Generator) -> Scene:
    """Return the scene, or one of two bodies with the negative kappa."""
    return scene.replace(kappa=-scene.kappa) if rng.random() < TURNED else scene


def draw_annuli(number: int) -> tuple[Scene, float]:
    """Return a scene that slips where the edge may stick, and a tolerance."""
    rng = np.random.default_rng([SEED, number, 1])
    beta = 10.0 ** rng.uniform(-5.0, 1.0)
    alpha = 0.0 if number % 3 == 0 else beta * 10.0 ** rng.uniform(-4.0, -0.1)
    nu = rng.uniform(-0.5, 0.49)
    asked = "critical_friction", "edge_ratio"
    # coupling raises both: between those of full stick without it there is slip
    plain = solve(Scene(nu, alpha, beta, math.inf), 1e-6, asked)
    most, least = plain.critical_friction, plain.edge_ratio
    share = rng.uniform(0.02, 0.98)
    friction = most * 10.0 ** (-2.0 * share) if alpha == 0.0 else least + (most - least) * share
    rtol = 10.0 ** rng.uniform(-10.0, -2.0)
    return turned(Scene(nu, alpha, beta, friction, coupling=True), rng), rtol


def compare(number: int, annuli: bool) -> Record:
    """Return a scene with its estimates over the true errors."""
    scene, rtol = (draw_annuli if annuli else draw)(number)
    row: Record = {
        "number": number,
        "scene": [
            scene.kappa,
            scene.normal_compliance,
            scene.tangential_compliance,
            scene.friction,
        ],
        "rtol": rtol,
    }
    try:
        solution, truth = solve(scene, rtol), solve(scene, TRUE_RTOL, strict=False)
    except (NotComputedError, ConvergenceError) as refused:
        return row | {"refused": str(refused)}
    if truth.zones[-1].outer == truth.stick_radius:
        return row | {"refused": "no slip"}
    if len(truth.zones) != len(solution.zones):
        return row | {"refused": "zones differ"}
    found = ratios(sample(solution), sample(truth))
    return row | {"ratios": found, "radius": truth.stick_radius, "zones": len(truth.zones)}


def main(stratum: str, arguments: Sequence[str]) -> bool:
    """Measure, print and store; return whether an estimate failed."""
    rows = []
    for number in range(options(__doc__, arguments, scenes=COUNT).scenes):
        rows.append(compare(number, stratum == "coupled_annuli"))
        print(json.dumps(rows[-1]), flush=True)
    judged = [row for row in rows if "ratios" in row]
    turned_ones = sum(row["scene"][0] < 0.0 for row in judged)
    about = (
        f"{len(judged)} scenes, {turned_ones} of them with negative kappa and "
        f"{sum(row['zones'] > 2 for row in judged)} with slip in an interior annulus, and "
        f"{len(rows) - len(judged)} that are refused or reach rounding. True error over estimate:"
    )
    cells = []
    for name in (*INTEGRALS, "zones", *FIELDS, "slip"):
        values = [row["ratios"][name] for row in judged]
        cells.append((name.replace("_", " "), f"{np.median(values):.1g}", f"{max(values):.2f}"))
    text = f"{about}\n\n{table('quantity | median | largest', cells)}"
    # in version 1 scenes began with Poisson's ratio, in place of kappa
    record = {"seed": SEED, "scenes": len(judged), "rows": rows}
    write(f"{stratum}_honesty", text, record, version=2)
    return any(max(row["ratios"].values()) > 1.0 for row in judged)
