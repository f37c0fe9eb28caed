"""Compare estimated with true errors over random scenes.

Run as ``python validation/honesty.py [scenes] [seed]``; writes validation/results/honesty.json and
.md. Truth is a solve at rtol = 1e-12, whose own estimate is allowed for; the traction is compared
up to the estimated shift of the zone boundaries. A violation is a true error above the estimate.
Scenes cover alpha, beta in {0} and 1e-14 ... 1e14, all nu, and friction from 1e-3 of the critical
to 1e-6 below it; tolerances are 1e-2 ... 1e-10.
"""

from __future__ import annotations

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import json
import math
import sys
from collections import defaultdict
from pathlib import Path
from time import perf_counter

import numpy as np

from spectral_contact import Scene, Solution, __version__, solve

RESULTS = Path(__file__).parent / "results"
EPS = 2.2e-16
DISTANCES = 10.0 ** -np.linspace(1e-3, 30.0, 600)


def random_scene(rng: np.random.Generator) -> tuple[Scene, float]:
    """Return a scene and a tolerance."""
    mode = rng.integers(3)
    alpha, beta = 10.0 ** rng.uniform(-14, 14, 2)
    if mode == 0:
        alpha, beta = 10.0 ** rng.uniform(-4, 1, 2)
    elif mode == 1:
        alpha = float(np.clip(beta * 10.0 ** rng.uniform(-3, 1), 1e-14, 1e14))
    alpha *= rng.random() >= 0.1
    beta *= rng.random() >= 0.1
    nu = rng.uniform(-0.99, 0.499)
    rtol = 10.0 ** rng.uniform(-10, -2)
    stick = solve(Scene(nu, alpha, beta, math.inf), 1e-9, ("critical_friction",))
    critical = stick.critical_friction
    if math.isinf(critical):
        friction = Scene(nu).kappa * 10.0 ** rng.uniform(-2, 1.2)
    elif rng.random() < 0.7:
        friction = critical * 10.0 ** rng.uniform(-3, 0)
    else:
        friction = critical * (1.0 - 10.0 ** rng.uniform(-6, -1))
    return Scene(nu, alpha, beta, friction), rtol


def compare(solution: Solution, truth: Solution) -> dict[str, tuple[float, float, float]]:
    """Return for each quantity the true error, the estimate, and the estimate of the truth."""

    def relative(name: str) -> float:
        a, b = getattr(solution, name), getattr(truth, name)
        return 0.0 if a == b else abs(a / b - 1.0) if b else math.inf

    def pointwise(name: str) -> np.ndarray:
        a = getattr(solution, name)(from_edge=DISTANCES)
        return np.abs(a / getattr(truth, name)(from_edge=DISTANCES) - 1.0)

    errors = {
        name: relative(name)
        for name in ("approach", "total_shear", "stick_radius", "critical_friction")
    }
    errors["pressure"] = float(pointwise("pressure").max())
    away = np.ones(len(DISTANCES), dtype=bool)
    boundaries = [0.0]
    for z, t in zip(solution.zones[:-1], truth.zones[:-1], strict=True):
        shift = solution.error.zones * max(z.outer_from_edge, 1e-300)
        away &= np.abs(DISTANCES - z.outer_from_edge) > 1e3 * shift
        boundaries += [z.outer / t.outer - 1.0, z.outer_from_edge / t.outer_from_edge - 1.0]
    errors["zones"] = float(np.abs(boundaries).max())
    errors["traction"] = float(pointwise("traction")[away].max(initial=0.0))
    slip = truth.slip(from_edge=DISTANCES)
    if np.any(slip):
        difference = np.abs(solution.slip(from_edge=DISTANCES) - slip)
        errors["slip"] = float(difference.max() / np.abs(slip).max())
    return {
        name: (error, getattr(solution.error, name), getattr(truth.error, name))
        for name, error in errors.items()
    }


def study(count: int, seed: int) -> dict:
    """Run the study and return its record."""
    rng = np.random.default_rng(seed)
    rows: dict[str, list[tuple[float, float, float]]] = defaultdict(list)
    violations, unconverged, differing, begin = [], 0, 0, perf_counter()
    for done in range(count):
        scene, rtol = random_scene(rng)
        truth = solve(scene, 1e-12, strict=False)
        solution = solve(scene, rtol, strict=False)
        unconverged += not solution.converged
        if [z.kind for z in solution.zones] != [z.kind for z in truth.zones]:
            differing += 1  # at the onset of a zone; both report their violation
            continue
        for name, values in compare(solution, truth).items():
            rows[name].append(values)
            error, estimate, own = values
            if error > estimate + own + 20 * EPS:
                violations.append(
                    {
                        "scene": repr(scene),
                        "rtol": rtol,
                        "quantity": name,
                        "error": error,
                        "estimate": estimate,
                    }
                )
        if sys.stderr.isatty():
            print(
                f"\r{done + 1}/{count} scenes, {perf_counter() - begin:.0f} s",
                end="",
                file=sys.stderr,
            )
    summary = {}
    for name, values in rows.items():
        error, estimate, _ = np.array(values).T
        ratio = estimate / np.maximum(error, 10 * EPS)
        summary[name] = {
            "scenes": len(values),
            "violations": sum(v["quantity"] == name for v in violations),
            "ratio_percentiles_5_50_95": [float(x) for x in np.percentile(ratio, [5, 50, 95])],
            "share_within_100": float(np.mean(ratio <= 100.0)),
        }
    return {
        "schema": "spectral_contact.validation.honesty",
        "version": 1,
        "library": __version__,
        "scenes": count,
        "seed": seed,
        "unconverged": unconverged,
        "differing_zones": differing,
        "seconds": perf_counter() - begin,
        "summary": summary,
        "violations": violations,
    }


def table(record: dict) -> str:
    """Return the record as a Markdown table."""
    lines = [
        f"{record['scenes']} scenes, seed {record['seed']}; {record['unconverged']} did not "
        f"converge and said so; {record['differing_zones']} lie at the onset of a zone, where the "
        "two solves differ in zones.",
        "",
        "| quantity | scenes | violations | estimate / max(true, 10 eps), 5, 50, 95 % "
        "| within 100 |",
        "|---|---|---|---|---|",
    ]
    for name, s in record["summary"].items():
        low, mid, high = s["ratio_percentiles_5_50_95"]
        lines.append(
            f"| {name} | {s['scenes']} | {s['violations']} | {low:.1f}, {mid:.0f}, {high:.3g} | "
            f"{100 * s['share_within_100']:.0f} % |"
        )
    return "\n".join(lines) + "\n"


def main() -> None:
    """Run with the counts of the command line."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 300
    seed = int(sys.argv[2]) if len(sys.argv) > 2 else 1
    record = study(count, seed)
    RESULTS.mkdir(exist_ok=True)
    (RESULTS / "honesty.json").write_text(json.dumps(record, indent=1) + "\n")
    (RESULTS / "honesty.md").write_text(table(record))
    print(table(record))
    for violation in record["violations"]:
        print(violation)


if __name__ == "__main__":
    main()
