"""Whether the estimates of coupled partial slip bound the true errors, over random scenes.

Run as ``python validation/coupled_slip_honesty.py [count]``; writes
validation/results/coupled_slip_honesty.json and .md. Every scene is solved at a random tolerance
and again at 1e-12; the second estimate is allowed for. Fields are compared at equal distances from
the rim, which has an estimate of its own, down to 1e-12 of a zone.
"""

from __future__ import annotations

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("OMP_NUM_THREADS", "1")

import json
import math
import sys
from pathlib import Path
from typing import Any

import numpy as np

import spectral_contact
from spectral_contact import ConvergenceError, NotComputedError, Scene, Solution, solve

RESULTS = Path(__file__).parent / "results"
SEED, COUNT, TRUE_RTOL = 20, 160, 1e-12
INTEGRALS = ("approach", "total_shear", "stick_radius")
FIELDS = ("pressure", "traction")

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
    least = min(0.02, 0.3 * most)
    friction = math.exp(rng.uniform(math.log(least), math.log(most)))
    rtol = 10.0 ** rng.uniform(-10.0, -3.0)
    return Scene(scene.poisson_ratio, alpha, beta, friction, coupling=True), rtol


def values(solution: Solution, name: str) -> np.ndarray:
    """Return a field at places graded to the rim, from both sides, and to the edge."""
    rim, edge = solution.zones[0].outer, solution.zones[0].outer_from_edge
    near = np.geomspace(1e-12, 0.9, 40)
    field = getattr(solution, name)
    # a radius is known to its rounding, from the centre or from the edge
    inside = field(rim * (1.0 - near)) if rim < 0.5 else field(from_edge=edge + rim * near)
    narrow = min(rim, edge)
    outside = field(rim + narrow * near) if rim < 0.5 else field(from_edge=edge - narrow * near)
    return np.concatenate([inside, outside, field(from_edge=edge * near)])


def compare(number: int) -> Record:
    """Return a scene with its estimates over the true errors."""
    scene, rtol = draw(number)
    row: Record = {
        "number": number,
        "scene": [scene.poisson_ratio, *scene_numbers(scene)],
        "rtol": rtol,
    }
    try:
        solution, truth = (solve(scene, one) for one in (rtol, TRUE_RTOL))
    except (NotComputedError, ConvergenceError) as refused:
        return row | {"refused": str(refused)}
    if len(truth.zones) == 1:
        return row | {"refused": "no slip"}
    ratios: dict[str, float] = {}
    for name in INTEGRALS:
        error = abs(getattr(solution, name) / getattr(truth, name) - 1.0)
        allowed = getattr(solution.error, name) + getattr(truth.error, name)
        ratios[name] = error / allowed
    for name in FIELDS:
        first, second = (values(one, name) for one in (solution, truth))
        allowed = getattr(solution.error, name) + getattr(truth.error, name)
        ratios[name] = float(np.abs(first / second - 1.0).max()) / allowed
    first, second = (values(one, "slip") for one in (solution, truth))
    error = float(np.abs(first - second).max() / np.abs(second).max())
    ratios["slip"] = error / (solution.error.slip + truth.error.slip)
    return row | {"ratios": ratios, "radius": truth.stick_radius}


def scene_numbers(scene: Scene) -> list[float]:
    """Return compliances and friction."""
    assert scene.friction is not None
    return [scene.normal_compliance, scene.tangential_compliance, scene.friction]


def table(record: Record) -> str:
    """Return the results as Markdown."""
    rows = [row for row in record["rows"] if "ratios" in row]
    refused = len(record["rows"]) - len(rows)
    lines = [
        f"{record['scenes']} scenes, and {refused} that are refused or reach rounding. "
        "True error over estimate:",
        "",
        "| quantity | median | largest |",
        "|---|---|---|",
    ]
    for name in (*INTEGRALS, *FIELDS, "slip"):
        ratios = [row["ratios"][name] for row in rows]
        lines.append(f"| {name.replace('_', ' ')} | {np.median(ratios):.1g} | {max(ratios):.2f} |")
    return "\n".join(lines) + "\n"


def main(count: int) -> None:
    """Measure, print and store."""
    rows = []
    for number in range(count):
        rows.append(compare(number))
        print(json.dumps(rows[-1]), flush=True)
    record = {
        "schema": "spectral_contact.validation.coupled_slip_honesty",
        "version": 1,
        "library": spectral_contact.__version__,
        "seed": SEED,
        "scenes": sum("ratios" in row for row in rows),
        "rows": rows,
    }
    (RESULTS / "coupled_slip_honesty.json").write_text(json.dumps(record, indent=1) + "\n")
    (RESULTS / "coupled_slip_honesty.md").write_text(table(record))
    print(table(record))


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else COUNT)
