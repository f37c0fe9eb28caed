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

from hard_report import draw, tables
from hard_truths import HOW, truth_of
from oracles.hard_cases import (
    CASES,
    EPS,
    HardCase,
    numbers,
    outputs,
    perturbations,
    shifts,
    true_errors,
)
from oracles.hard_inside import condition_numbers, overrefined
from reporting import RESULTS, options, stored, write

from spectral_contact import Scene, Solution, solve

INTEGRAL = ("approach", "total_shear", "stick_radius")
COLUMNS = ("approach", "pressure", "traction", "total_shear", "zones")


def conditioning(case: HardCase, truth: dict[str, Any]) -> dict[str, dict[str, float]]:
    """Return the relative change of every output per relative change of every input.

    By differences of solves; but Poisson's ratio enters through kappa alone, and without coupling
    q/kappa and the zones depend on f/kappa. The ends of a very narrow inner annulus are where q/p
    of full stick is f: their share follows from the slope of q/p. Where compliance is 1e-14 and
    only moves an edge zone as its square, the smooth punch stands for the rest.
    """
    scene = case.scene
    if case.slow:
        scene = replace(scene, tangential_compliance=0.0)
    if "slopes" in truth:
        scene = replace(scene, friction=math.inf)
    found = {
        name: differences(scene, name, case.step)
        for name in ("normal_compliance", "tangential_compliance", "friction")
        if getattr(scene, name) and math.isfinite(getattr(scene, name))
    }
    if "slopes" in truth:
        add_inside(case, truth, found)
    if case.slow:
        found["friction"].update({"b2": 0.0, "1-b2": 2.0})
        found["tangential_compliance"] = {"b2": 0.0, "1-b2": 2.0}
    nu = scene.poisson_ratio
    gain = abs(nu) / ((1.0 - 2.0 * nu) * (1.0 - nu))
    if scene.couples:
        found["poisson_ratio"] = by_coupling(scene, case.step, gain)
        return found
    by_friction = found.get("friction", {})
    found["poisson_ratio"] = {
        key: gain * abs(float(key == "Q") - by_friction.get(key, 0.0))
        for key in numbers(truth)
        if key not in ("approach", "p(1)")
    }
    return found


def differences(scene: Scene, name: str, step: float) -> dict[str, float]:
    """Return the logarithmic derivatives of the outputs, one-sided at the end of the range."""
    value = getattr(scene, name)
    low, high = (1e-14, 1e14) if "compliance" in name else (0.0, math.inf)
    ends = [min(max(value * (1.0 + h), low), high) for h in (step, -step)]
    up, down = (outputs(solve(replace(scene, **{name: v}), 1e-12, strict=False)) for v in ends)
    reach = math.log(ends[0] / ends[1])
    return {key: abs(math.log(up[key] / down[key])) / reach for key in up}


def by_coupling(scene: Scene, step: float, gain: float) -> dict[str, float]:
    """Return the logarithmic derivatives by Poisson's ratio, from differences in kappa."""
    ends = []
    for kappa in (scene.kappa * (1.0 + step), scene.kappa * (1.0 - step)):
        nu = (1.0 - 4.0 * kappa) / (2.0 - 4.0 * kappa)
        ends.append(replace(scene, poisson_ratio=nu) if nu > -1.0 else scene)
    up, down = (outputs(solve(one, 1e-12, strict=False)) for one in ends)
    reach = math.log(ends[0].kappa / ends[1].kappa)
    return {key: gain * abs(math.log(up[key] / down[key])) / reach for key in up}


def add_inside(case: HardCase, truth: dict[str, Any], found: dict[str, dict[str, float]]) -> None:
    """Add the ends of a very narrow inner annulus."""
    scene = replace(case.scene, friction=math.inf)
    found["friction"] = {"Q": 0.0}
    for k, ((outer, _), text) in enumerate(
        zip(truth["boundaries"], truth["slopes"], strict=True), start=1
    ):
        b, slope = float(outer), float(text)
        rates = {"friction": case.scene.friction}
        for name in ("normal_compliance", "tangential_compliance"):
            value, step = getattr(scene, name), 1e-5
            one, two = (
                solve(replace(scene, **{name: value * (1.0 + h)}), 1e-12) for h in (step, -step)
            )
            ratios = [float(each.traction(b) / each.pressure(b)) for each in (one, two)]
            rates[name] = (ratios[0] - ratios[1]) / (2.0 * step)
        for name, rate in rates.items():
            found[name].update({f"b{k}": abs(rate / (slope * b))})
            found[name].update({f"1-b{k}": abs(rate / (slope * (1.0 - b)))})


def moved_by_ulps(
    case: HardCase, base: Solution, sensitivity: dict[str, dict[str, float]]
) -> list[dict[str, Any]]:
    """Return the largest shift of an output for one ulp of each input, and what explains it.

    The ratio is the shift to that which conditioning asks for: of that input times its ulp, and of
    any compliance or friction times a rounding, as a solve rounds those, too.
    """
    before, rows = outputs(base), []
    for name, change, scene in all_at_once(case) if case.slow else perturbations(case.scene):
        after = outputs(solve(scene, 1e-12, strict=False))
        for key, moved in shifts(after, before).items():
            rounded = max(
                [1.0, *(v.get(key, 0.0) for k, v in sensitivity.items() if k != "poisson_ratio")]
            )
            own = [v.get(key, 0.0) for k, v in sensitivity.items() if name in (k, "all")]
            explained = sum(own) * change + rounded * EPS
            rows.append(
                {
                    "input": name,
                    "output": key,
                    "moved": moved,
                    "explained": explained,
                    "ratio": moved / explained,
                }
            )
    return rows


def all_at_once(case: HardCase) -> list[tuple[str, float, Scene]]:
    """Return the scene with every input an ulp larger."""
    values = {name: scene for name, _, scene in perturbations(case.scene)}
    fresh = {name: getattr(scene, name) for name, scene in values.items()}
    return [("all", EPS, replace(case.scene, **fresh))]


def at_the_limit(case: HardCase, exact: dict[str, float]) -> dict[str, list[float]] | None:
    """Return errors and estimates of the integral quantities at the least rtol."""
    if case.slow:
        return None
    solution = solve(case.scene, 1e-13, INTEGRAL)
    keys = {"approach": "approach", "total_shear": "Q", "stick_radius": "b1"}
    return {
        name: [abs(getattr(solution, name) / exact[key] - 1.0), getattr(solution.error, name)]
        for name, key in keys.items()
        if key in exact
    }


def measure(case: HardCase, truth: dict[str, Any]) -> dict[str, Any]:
    """Return all of one case."""
    begin = perf_counter()
    with condition_numbers() as matrices:
        solution = solve(case.scene, 1e-12, strict=False)
    seconds = perf_counter() - begin
    larger = None
    if not case.slow:
        with overrefined():
            fine = solve(case.scene, 1e-12, strict=False)
        larger = {
            "errors": true_errors(fine, truth),
            "estimates": {name: getattr(fine.error, name) for name in COLUMNS},
            "unknowns": max(step.unknowns for step in fine.work.steps),
        }
    sensitivity = conditioning(case, truth)
    return {
        "name": case.name,
        "why": case.why,
        "scene": case.scene.to_dict(),
        "how": HOW[case.truth],
        "truth": truth,
        "converged": solution.converged,
        "ending": solution.ending.name,
        "seconds": seconds,
        "unknowns": max(step.unknowns for step in solution.work.steps),
        "errors": true_errors(solution, truth),
        "estimates": {name: getattr(solution.error, name) for name in COLUMNS},
        "integral": at_the_limit(case, numbers(truth)),
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
    for case in CASES:
        row = old.get(case.name)
        print(f"{perf_counter() - begin:4.0f} s  {case.name}", file=sys.stderr, flush=True)
        same = row is not None and Scene.from_dict(row["scene"]) == case.scene
        rows.append(measure(case, row["truth"] if same else truth_of(case)))
    record = {"count": len(rows), "cases": rows}
    write("hard_cases", tables(record), record)
    draw(record, RESULTS / "hard_cases.png")


if __name__ == "__main__":
    main()
