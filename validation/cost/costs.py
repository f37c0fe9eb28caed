"""Measure what accuracy costs: digits, small roughness, and each effect of a scene.

Run as ``python validation/cost/costs.py [--quick] [--store FOLDER]``; writes costs.json and .md,
and by matplotlib costs.png and costs_growth.png, into validation/results.
Whatever is done is kept in the store, and the same command goes on where a run was stopped; what
other sources of the library gave is not taken. The truths, to 20 digits, are kept in
costs_truths.json beside the results, and made once, in some ten minutes. The price of many digits
is that of bench.py reference. With --quick times are rough, of one repeat, truths that are not
there yet are solves to 1e-12 on other panels, and unknowns that fall are looked for in fewer gold
scenes.
"""

from __future__ import annotations

import json
import math
import sys
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import asdict
from pathlib import Path
from typing import Any

sys.path.append(str(Path(__file__).parents[1]))
sys.path.append(str(Path(__file__).parents[1] / "honesty"))

import numpy as np
from costs_prices import MANY_DIGITS, RTOL, Price, prices, step_seconds
from costs_report import (
    all_unknowns,
    draw_errors,
    draw_growth,
    growth_argument,
    tables,
)
from flat_punches import sources
from honesty_scenes import true_solution
from reporting import RESULTS, options, stored, unit, write
from scipy.stats import linregress, t

from spectral_contact import Scene, Solution, gold, solve
from spectral_contact.studies import (
    OwnSolver,
    Point,
    Truth,
    convergence,
    this_machine,
    truth_of,
)
from spectral_contact.studies.timing import times_of
from spectral_contact.view.progress import ProgressLine

STORE = Path(tempfile.gettempdir()) / "spectral_contact_costs"
TRUTHS = RESULTS / "costs_truths.json"
EPS = 2.0**-52

NU, FRICTION = 0.1, 0.1
#: Problems, by their friction.
PROBLEMS = {"normal": None, "full stick": math.inf, "partial slip": FRICTION}
#: alpha* = beta*
COMPLIANCES = (0.5, 1e-2, 1e-4, 1e-8, 1e-12, 0.0)
TOLERANCES = tuple(float(f"1e-{digits}") for digits in range(2, 13))
#: Four for each digit: at these all gold scenes are looked at for unknowns that fall.
MANY_TOLERANCES = tuple(float(f"{10.0 ** (-k / 4):.3g}") for k in range(8, 49))
REPEATS = 5
FEWER_SCENES = 25

Task = tuple[str, Callable[[], Any]]


def scene_of(problem: str, compliance: float) -> Scene:
    """Return the scene of a problem at a compliance."""
    friction = PROBLEMS[problem]
    return Scene(NU, compliance, 0.0 if friction is None else compliance, friction)


CASES = {(p, c): scene_of(p, c) for p in PROBLEMS for c in COMPLIANCES}


def run(tasks: list[Task]) -> Iterator[Any]:
    """Yield the outcomes of tasks, with a line of progress."""
    with ProgressLine(None) as tell:
        for i, (name, task) in enumerate(tasks):
            tell(name, i / len(tasks))
            yield task()
        tell("", 1.0)


def kept(path: Path, make: Callable[[], Any]) -> Any:
    """Return what a file of JSON holds; it is made if it is not there."""
    if not path.exists():
        text = json.dumps(make(), allow_nan=False)
        part = path.with_suffix(".part")
        part.write_text(text + "\n", encoding="utf-8")
        part.replace(path)
    return json.loads(path.read_text(encoding="utf-8"))


# --- truths ---------------------------------------------------------------------------------------


def truth_row(truth: Truth) -> dict[str, Any]:
    """Return a truth as an object of JSON; infinite values are null."""
    row = asdict(truth) | {"scene": truth.scene.to_dict(), "from_edge": truth.from_edge.tolist()}
    row["fields"] = {
        name: [value if math.isfinite(value) else None for value in values.tolist()]
        for name, values in truth.fields.items()
    }
    return row


def truth_from_row(row: dict[str, Any]) -> Truth:
    """Return the truth that `truth_row` wrote."""
    fields = {
        name: np.array([math.inf if value is None else value for value in values])
        for name, values in row["fields"].items()
    }
    known = {"scene": Scene.from_dict(row["scene"]), "from_edge": np.array(row["from_edge"])}
    return Truth(**(row | known | {"fields": fields}))


def truths(quick: bool) -> dict[Scene, Truth]:
    """Return the truths of all cases; those that are missing are made, and kept unless quick."""
    rows = json.loads(TRUTHS.read_text(encoding="utf-8")) if TRUTHS.exists() else []
    found = {truth.scene: truth for truth in map(truth_from_row, rows)}
    missing = [scene for scene in CASES.values() if scene not in found]
    if quick:
        return found | {scene: truth_of(scene, true_solution(scene)) for scene in missing}
    tasks = [(f"truth at α* = {s.normal_compliance:g}", lambda s=s: truth_of(s)) for s in missing]
    for truth in run(tasks):
        found[truth.scene] = truth
        text = json.dumps([truth_row(one) for one in found.values()], indent=1, allow_nan=False)
        TRUTHS.write_text(text + "\n", encoding="utf-8")
    return found


# --- measurements ---------------------------------------------------------------------------------


def points_of(scene: Scene, truth: Truth, repeats: int) -> list[dict]:
    """Return the points of one scene at all tolerances."""
    study = convergence(OwnSolver(), scene, TOLERANCES, truth, repeats=repeats)
    return [row_of(point) for point in study.points]


def row_of(point: Point) -> dict[str, Any]:
    """Return a point with the unknowns of every step of its solve."""
    work = OwnSolver()(point.scene, point.resolution).work
    assert work.unknowns == point.unknowns
    steps = {step.name: step.unknowns for step in work.steps if step.unknowns}
    row = asdict(point) | {"scene": point.scene.to_dict()}
    return row | {"systems": steps, "refinements": work.refinements}


def exceeded(points: list[dict], known: dict[Scene, Truth]) -> list[dict]:
    """Return where a true error is above its estimate, that of the truth and rounding aside."""
    found = []
    for point in points:
        truth = known[CASES[point["problem"], point["compliance"]]]
        for name, estimate in point["estimates"].items():
            error = float(point["errors"][name])
            if error > float(estimate) + truth.error[name] + EPS:
                place = {key: point[key] for key in ("problem", "compliance", "resolution")}
                found.append({**place, "quantity": name, "error": error, "estimate": estimate})
    return found


def falls(scene: Scene) -> dict[str, Any]:
    """Return where fewer unknowns meet a tighter tolerance, and what tolerances are not met.

    The falls are [system, tolerance, unknowns before, unknowns at it]; the system is a step, or
    ``largest``, which is `Work.unknowns`.
    """
    found: list[list[Any]] = []
    unmet: list[float] = []
    before: dict[str, int] = {}
    for rtol in MANY_TOLERANCES:
        solution = solve(scene, rtol, strict=False)
        work = solution.work
        sizes = {"largest": work.unknowns} | {step.name: step.unknowns for step in work.steps}
        falling = [name for name, size in sizes.items() if size < before.get(name, 0)]
        found += [[name, rtol, before[name], sizes[name]] for name in falling]
        unmet += [] if solution.converged else [rtol]
        before = sizes
    return {"scene": scene.to_dict(), "falls": found, "unmet": unmet}


def priced(price: Price, repeats: int) -> dict[str, Any]:
    """Return what an item of the price list costs."""
    outcome = price.task(price.scene, RTOL)
    times = times_of(price.task, price.scene, RTOL, repeats)
    unknowns = None
    if isinstance(outcome, Solution):
        unknowns = sum(step.unknowns for step in outcome.work.steps)
    return {"item": price.item, "unknowns": unknowns, "times": asdict(times)}


def digits_priced() -> list[dict[str, Any]]:
    """Return the price of many digits, as bench.py reference measured it."""
    return [
        {"item": f"{row['digits']} digits", "unknowns": row["unknowns"], "seconds": row["seconds"]}
        for row in stored("bench_reference")["rows"]
        if row["scene"] == MANY_DIGITS
    ]


# --- growth ---------------------------------------------------------------------------------------


def line(x: np.ndarray, y: np.ndarray) -> dict[str, Any]:
    """Return the line of least squares, with the interval of 95 per cent of its slope."""
    fit = linregress(x, y)
    half = fit.stderr * t.ppf(0.975, len(x) - 2)
    return {
        "slope": fit.slope,
        "intercept": fit.intercept,
        "interval": [fit.slope - half, fit.slope + half],
        "residual": float(np.sqrt(np.mean((y - fit.intercept - fit.slope * x) ** 2))),
        "count": len(x),
    }


def fits(points: list[dict], problem: str) -> dict[str, Any]:
    """Return the growth of unknowns and of warm times, on rough surfaces."""
    rough = [p for p in points if p["problem"] == problem and p["compliance"] > 0.0]
    x, tapered = (
        np.array([growth_argument(p["resolution"], p["compliance"], power) for p in rough])
        for power in (1.0, 0.5)
    )
    unknowns = np.array([all_unknowns(p) for p in rough], dtype=float)
    seconds = np.array([p["times"]["warm"]["median"] for p in rough])
    return {
        "unknowns": line(x, unknowns),
        "unknowns_tapered": line(tapered, unknowns),
        "unknowns_power": line(np.log(x), np.log(unknowns)),
        "time_power": line(np.log(unknowns), np.log(seconds)),
    }


def record(store: Path, repeats: int) -> dict[str, Any]:
    """Measure what the store does not hold yet, and return the record of the study."""
    store.mkdir(parents=True, exist_ok=True)
    quick = repeats < REPEATS
    known = truths(quick)
    grid: list[Task] = [
        (
            f"{problem} at {compliance:g}",
            lambda scene=scene, name=f"{problem}_{compliance:g}.json": kept(
                store / name.replace(" ", "_"), lambda: points_of(scene, known[scene], repeats)
            ),
        )
        for (problem, compliance), scene in CASES.items()
    ]
    points = [
        {"problem": problem, "compliance": compliance} | row
        for (problem, compliance), rows in zip(CASES, run(grid), strict=True)
        for row in rows
    ]
    scenes = [solution.scene for table in gold.tables() for solution in table.solutions]
    scenes = scenes[: FEWER_SCENES if quick else None]
    looked: list[Task] = [
        (f"scene {i}", lambda i=i, s=s: kept(store / f"falls_{i}.json", lambda: falls(s)))
        for i, s in enumerate(scenes)
    ]
    findings = [found for found in run(looked) if found["falls"] or found["unmet"]]
    listed: list[Task] = [
        (p.item, lambda i=i, p=p: kept(store / f"price_{i}.json", lambda: priced(p, repeats)))
        for i, p in enumerate(prices())
    ]
    return {
        "sources": sources(),
        "count": len(points),
        "repeats": repeats,
        "machine": this_machine(),
        "dense_solve_seconds": kept(store / "dense_solve.json", unit),
        "truths": sorted({truth.source for truth in known.values()}),
        "exceeded": exceeded(points, known),
        "fits": {problem: fits(points, problem) for problem in PROBLEMS},
        "monotony": {
            "scenes": len(scenes),
            "tolerances": list(MANY_TOLERANCES),
            "findings": findings,
        },
        "prices": [*run(listed), *digits_priced()],
        "price_rtol": RTOL,
        "steps": kept(store / "steps.json", lambda: step_seconds(repeats)),
        "points": points,
    }


def main() -> None:
    """Run, or go on, and write the results."""
    asked = options(__doc__, quick=False, store=str(STORE))
    repeats = 1 if asked.quick else REPEATS
    store = Path(asked.store) / f"{sources()}-{'quick' if asked.quick else 'full'}"
    found = record(store, repeats)
    write("costs", tables(found), found)
    draw_errors(found, RESULTS / "costs.png")
    draw_growth(found, RESULTS / "costs_growth.png")


if __name__ == "__main__":
    main()
