"""Measure what accuracy costs: digits, small roughness, and each effect of a scene.

Run as ``python validation/cost/costs.py [--quick] [--store FOLDER]``; writes costs.json and .md,
and by matplotlib costs.png, into validation/results.
Whatever is done is kept in the store, and the same command goes on where a run was stopped; what
other sources of the library gave is not taken. The truths have 20 digits, of gold tables or of
`reference`, which takes some ten minutes. The price of many digits is that of bench.py reference.
With --quick times are rough, of one repeat, truths are solves to 1e-12 on other panels, and
unknowns that fall are looked for in fewer gold scenes.
"""

from __future__ import annotations

import math
import sys
import tempfile
from collections.abc import Callable
from dataclasses import asdict, dataclass
from functools import partial
from itertools import product
from pathlib import Path
from typing import Any, ClassVar

sys.path.append(str(Path(__file__).parents[1]))
sys.path.append(str(Path(__file__).parents[1] / "honesty"))

import numpy as np
from costs_report import all_unknowns, draw_errors, growth_argument, tables
from honesty_scenes import true_solution
from reporting import RESULTS, options, resumed, sources, stored, unit, write
from scipy.stats import linregress, t

from spectral_contact import Scene, Solution, clear_caches, gold, solve
from spectral_contact.studies import (
    OwnSolver,
    Point,
    convergence,
    this_machine,
    truth_of,
)
from spectral_contact.studies.timing import times_of

STORE = Path(tempfile.gettempdir()) / "spectral_contact_costs"

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

#: The price list: its tolerance, and two scenes, one with slip between two zones of stick.
RTOL = 1e-10
ONE_DISK = Scene(0.1, 0.5, 0.5, 0.1)
ANNULUS = Scene(0.3, 0.05, 1.0, 0.23 / 7.0)
#: What bench.py reference calls the first scene.
MANY_DIGITS = "partial slip, α* = β* = 0.5, f = 0.1"
RADII = np.linspace(0.0, 1.0, 1000)

Record = dict[str, Any]


# --- digits and roughness -------------------------------------------------------------------------


def points_of(problem: str, compliance: float, repeats: int) -> list[Record]:
    """Return the points of a problem at a compliance, one for each tolerance."""
    friction = PROBLEMS[problem]
    scene = Scene(NU, compliance, 0.0 if friction is None else compliance, friction)
    truth = truth_of(scene, true_solution(scene) if repeats < REPEATS else None)
    study = convergence(OwnSolver(), scene, TOLERANCES, truth, repeats=repeats)
    named = {"problem": problem, "compliance": compliance, "truth": truth.source}
    return [named | row_of(point) for point in study.points]


def row_of(point: Point) -> Record:
    """Return a point with the unknowns of every step."""
    work = OwnSolver()(point.scene, point.resolution).work
    assert work.unknowns == point.unknowns
    return asdict(point) | {
        "scene": point.scene.to_dict(),
        "systems": {step.name: step.unknowns for step in work.steps if step.unknowns},
        "refinements": work.refinements,
    }


def falls(scene: Scene) -> Record:
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


# --- prices ---------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class OfSolution:
    """Something that is asked of a solution which is there already; timed like a solver."""

    asked: Callable[[], Any]
    clear_caches: ClassVar[Callable[[], None]] = staticmethod(clear_caches)

    def __call__(self, _scene: Scene, _rtol: float) -> Any:
        """Return what is asked."""
        return self.asked()


def prices() -> list[tuple[str, Scene, Callable[[Scene, float], Any]]]:
    """Return the items, from the cheapest solve to what is asked of its solution."""
    solution = solve(ONE_DISK, RTOL)
    fields = [
        (f"{name} at {len(RADII)} radii", OfSolution(partial(getattr(solution, name), RADII)))
        for name in ("pressure", "traction", "slip")
    ]
    bounds = OfSolution(lambda: solution.approach_bounds)
    return [
        ("approach alone", ONE_DISK, OwnSolver(("approach",))),
        ("pressure", ONE_DISK, OwnSolver(("pressure",))),
        ("does it slip? (full stick)", ONE_DISK, OwnSolver(("critical_friction",))),
        ("everything, one stick disk", ONE_DISK, OwnSolver()),
        ("everything, slip in an annulus", ANNULUS, OwnSolver()),
        *((name, ONE_DISK, task) for name, task in fields),
        ("rigorous bounds of the approach", ONE_DISK, bounds),
    ]


def priced(item: str, scene: Scene, task: Callable[[Scene, float], Any], repeats: int) -> Record:
    """Return what an item of the price list costs."""
    outcome = task(scene, RTOL)
    times = times_of(task, scene, RTOL, repeats)
    unknowns = None
    if isinstance(outcome, Solution):
        unknowns = sum(step.unknowns for step in outcome.work.steps)
    return {"item": item, "unknowns": unknowns, "times": asdict(times)}


def digits_priced() -> list[Record]:
    """Return the price of many digits, as bench.py reference measured it."""
    return [
        {"item": f"{row['digits']} digits", "unknowns": row["unknowns"], "seconds": row["seconds"]}
        for row in stored("bench_reference")["rows"]
        if row["scene"] == MANY_DIGITS
    ]


# --- growth ---------------------------------------------------------------------------------------


def line(x: np.ndarray, y: np.ndarray) -> Record:
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


def fits(points: list[Record], problem: str) -> Record:
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


def record(store: Path, repeats: int) -> Record:
    """Measure what the store does not hold yet, and return the record of the study."""
    scenes = [solution.scene for table in gold.tables() for solution in table.solutions]
    scenes = scenes[: FEWER_SCENES if repeats < REPEATS else None]
    tasks = {
        "points": {
            "{} at {:g}".format(*case): partial(points_of, *case, repeats)
            for case in product(PROBLEMS, COMPLIANCES)
        },
        "falls": {f"scene {i}": partial(falls, scene) for i, scene in enumerate(scenes)},
        "prices": {price[0]: partial(priced, *price, repeats) for price in prices()},
        "rest": {"dense solve": unit},
    }
    done = {
        group: resumed(store.with_name(f"{store.name}-{group}.jsonl"), some)
        for group, some in tasks.items()
    }
    points = [point for rows in done["points"].values() for point in rows]
    looked = done["falls"].values()
    return {
        "sources": sources(),
        "count": len(points),
        "repeats": repeats,
        "machine": this_machine(),
        "dense_solve_seconds": done["rest"]["dense solve"],
        "truths": sorted({point["truth"] for point in points}),
        "fits": {problem: fits(points, problem) for problem in PROBLEMS},
        "monotony": {
            "scenes": len(scenes),
            "tolerances": list(MANY_TOLERANCES),
            "findings": [found for found in looked if found["falls"] or found["unmet"]],
        },
        "prices": [*done["prices"].values(), *digits_priced()],
        "price_rtol": RTOL,
        "points": points,
    }


def main() -> None:
    """Run, or go on, and write the results."""
    asked = options(__doc__, quick=False, store=str(STORE))
    store = Path(asked.store) / f"{sources()}-{'quick' if asked.quick else 'full'}"
    found = record(store, 1 if asked.quick else REPEATS)
    write("costs", tables(found), found)
    draw_errors(found, RESULTS / "costs.png")


if __name__ == "__main__":
    main()
