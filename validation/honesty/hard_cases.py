"""Measure the hard cases: python validation/honesty/hard_cases.py [--fresh].

Writes validation/results/hard_cases.json, .md and .png. The scenes are those of
tests/oracles/hard_cases.py. Of each: true errors beside their estimates at rtol = 1e-12, and at
1e-13 for the integral quantities alone; the condition of the matrices that the solver factors; how
much the inputs matter by themselves; what one ulp in each of them does; and what over-refined
spaces do. Truths of scenes that are in the results already are taken from there, unless --fresh
asks to compute them anew, which takes 4 minutes more.
"""

from __future__ import annotations

import math
import sys
import warnings
from dataclasses import replace
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np

sys.path.append(str(Path(__file__).parents[1]))
sys.path.append(str(Path(__file__).parents[2] / "tests"))

from hard_report import SHORT, draw, tables
from hard_truths import HOW, truth_of
from oracles import hard_cases as hard
from oracles.hard_cases import HardCase
from oracles.hard_inside import condition_numbers, overrefined
from reporting import RESULTS, options, stored, write

from spectral_contact import Scene, Solution, solve

#: Integral quantities, by the names of their truths.
INTEGRAL = {"approach": "approach", "total_shear": "Q", "stick_radius": "b1"}


def conditioning(solution: Solution) -> dict[str, dict[str, float]]:
    """Return the relative change of every output per relative change of every input.

    By `Solution.sensitivity`; inputs that are 0 or infinite are left out.
    """
    scene, values = solution.scene, hard.outputs(solution)
    inputs = [
        name for name in hard.INPUTS if getattr(scene, name) and math.isfinite(getattr(scene, name))
    ]
    with np.errstate(all="ignore"):  # where an edge zone is too narrow for its rates
        rates = solution.sensitivity(inputs, from_edge=[0.0], progress=False)
    found = {}
    for name in inputs:
        slopes = {"approach": rates["approach", name].value, "Q": rates["total_shear", name].value}
        if "p(1)" in values:
            slopes["p(1)"] = float(rates.fields["pressure", name].value[0])
        for k, one in enumerate(rates.boundaries.get(name, ()), start=1):
            slopes |= {f"b{k}": one.value, f"1-b{k}": one.value}
        value = getattr(scene, name)
        found[name] = {key: abs(slope * value / values[key]) for key, slope in slopes.items()}
    return found


def moved_by_ulps(
    case: HardCase, base: Solution, sensitivity: dict[str, dict[str, float]]
) -> list[dict[str, Any]]:
    """Return the largest shift of an output for one ulp of each input, and what explains it.

    The ratio is the shift to that which conditioning asks for: of that input times its ulp, and of
    any compliance or friction times a rounding, as a solve rounds those, too.
    """
    before, rows = hard.outputs(base), []
    for name, change, scene in all_at_once(case) if case.slow else hard.perturbations(case.scene):
        after = hard.outputs(solve(scene, 1e-12, strict=False))
        for key, moved in hard.shifts(after, before).items():
            rounded = max(
                [1.0, *(v.get(key, 0.0) for k, v in sensitivity.items() if k != "poisson_ratio")]
            )
            own = [v.get(key, 0.0) for k, v in sensitivity.items() if name in (k, "all")]
            explained = sum(own) * change + rounded * hard.EPS
            row = {"input": name, "output": key, "moved": moved, "explained": explained}
            rows.append(row | {"ratio": moved / explained})
    return rows


def all_at_once(case: HardCase) -> list[tuple[str, float, Scene]]:
    """Return the scene with every input an ulp larger."""
    values = {name: scene for name, _, scene in hard.perturbations(case.scene)}
    fresh = {name: getattr(scene, name) for name, scene in values.items()}
    return [("all", hard.EPS, replace(case.scene, **fresh))]


def at_the_limit(case: HardCase, exact: dict[str, float]) -> dict[str, list[float]] | None:
    """Return errors and estimates of the integral quantities at the least rtol."""
    if case.slow:
        return None
    solution = solve(case.scene, 1e-13, tuple(INTEGRAL), strict=False)
    return {
        name: [abs(getattr(solution, name) / exact[key] - 1.0), getattr(solution.error, name)]
        for name, key in INTEGRAL.items()
        if key in exact
    }


def accuracy(solution: Solution, truth: dict[str, Any]) -> dict[str, Any]:
    """Return the errors of a solution, their estimates, and what it took."""
    return {
        "errors": hard.true_errors(solution, truth),
        "estimates": {name: getattr(solution.error, name) for name in SHORT},
        "unknowns": max(step.unknowns for step in solution.work.steps),
    }


def measure(case: HardCase, truth: dict[str, Any]) -> dict[str, Any]:
    """Return all of one case."""
    begin = perf_counter()
    with condition_numbers() as matrices:
        solution = solve(case.scene, 1e-12, strict=False)
    seconds = perf_counter() - begin
    if "coupled" in matrices and not case.scene.couples:  # annuli are factored like two tractions
        matrices["annuli"] = matrices.pop("coupled")
    larger = None
    if not case.slow:
        with overrefined():
            larger = accuracy(solve(case.scene, 1e-12, strict=False), truth)
    sensitivity = conditioning(solution)
    return {
        "name": case.name,
        "why": case.why,
        "scene": case.scene.to_dict(),
        "how": HOW[case.truth],
        "truth": truth,
        "converged": solution.converged,
        "ending": solution.ending.name,
        "seconds": seconds,
        **accuracy(solution, truth),
        "integral": at_the_limit(case, hard.numbers(truth)),
        "matrices": matrices,
        "conditioning": sensitivity,
        "ulps": moved_by_ulps(case, solution, sensitivity),
        "overrefined": larger,
    }


def main() -> None:
    """Run and write the results."""
    warnings.simplefilter("error")
    np.seterr(all="raise")  # underflow, too
    known = {} if options(__doc__, fresh=False).fresh else stored("hard_cases")
    old = {row["name"]: row for row in known.get("cases", [])}
    rows, begin = [], perf_counter()
    for case in hard.CASES:
        row = old.get(case.name)
        print(f"{perf_counter() - begin:4.0f} s  {case.name}", file=sys.stderr, flush=True)
        same = row is not None and Scene.from_dict(row["scene"]) == case.scene
        rows.append(measure(case, row["truth"] if same else truth_of(case)))
    record = {"count": len(rows), "cases": rows}
    write("hard_cases", tables(record), record)
    draw(record, RESULTS / "hard_cases.png")


if __name__ == "__main__":
    main()
