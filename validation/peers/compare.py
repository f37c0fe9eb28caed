"""Measure this library beside what one would take instead: python validation/peers/compare.py.

Needs the extra ``peers``. Writes validation/results/peers_normal, peers_full_stick and
peers_partial_slip, each as .json (a study to be loaded), .md (the times to reach an accuracy) and
.png (work against precision).
"""

from __future__ import annotations

import sys
import tomllib
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

sys.path.append(str(Path(__file__).parents[1]))

import elements
import nystrom
from reporting import RESULTS, options, table

from spectral_contact import MissingDependencyError, Scene
from spectral_contact.studies import OwnSolver, WorkPrecision, named_solver, work_precision
from spectral_contact.view.report import scene_text

PACKAGES = ("tamaas", "scikit-fem")
ACCURACIES = (1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12)
TABLE = tomllib.loads(Path(__file__).with_name("peers.toml").read_text(encoding="utf-8"))
#: By name: the solver, and the resolutions.
PEERS = {
    name: (named_solver(row["solver"]), tuple(row["resolutions"]))
    for name, row in TABLE["peers"].items()
}


def clear_caches() -> None:
    """Empty the caches of the peers: Gauss's rules, and Nyström's weights of the logarithm."""
    elements.gauss.cache_clear()
    nystrom.log_weights.cache_clear()


for peer, _ in PEERS.values():
    peer.clear_caches = clear_caches

#: So many of the finest resolutions of each peer are not in a small run.
FINEST = 5


@dataclass(frozen=True)
class Problem:
    """What is compared: scenes with gold, quantities, and the peers that can do it."""

    scenes: tuple[Scene, ...]
    quantities: tuple[str, ...]
    peers: tuple[str, ...]


PROBLEMS = {
    problem: Problem(
        tuple(Scene(*numbers) for numbers in row["scenes"]),
        tuple(row["quantities"]),
        tuple(name for name, peer in TABLE["peers"].items() if problem in peer["problems"]),
    )
    for problem, row in TABLE["problems"].items()
}


def measured(name: str, small: bool) -> WorkPrecision:
    """Run a problem."""
    problem = PROBLEMS[name]
    own = tuple("pressure" if q == "edge_pressure" else q for q in problem.quantities)
    solvers = {OwnSolver().name: (OwnSolver(own), ACCURACIES)}
    for peer in problem.peers:
        solver, resolutions = PEERS[peer]
        solvers[peer] = solver, resolutions[:-FINEST] if small else resolutions
    return work_precision(
        solvers,
        problem.scenes,
        ACCURACIES,
        quantities=problem.quantities,
        repeats=1 if small else 5,
    )


def tables(study: WorkPrecision, packages: str) -> str:
    """Return the Markdown tables: the times of each solver to reach each accuracy."""
    machine = ", ".join(f"{name} {one}" for name, one in study.machine.items())
    parts = [
        f"{len(study.points)} solves; {machine}{packages}; one thread. Milliseconds, warm and, in "
        "italics, with empty caches; in parentheses the ratio to the first row. Medians of "
        f"{min(p.times.warm.repeats for p in study.points if p.times)} repeats or more."
    ]
    goals = [f"{goal:.0e}" for goal in study.accuracies]
    for scene in study.scenes:
        for quantity in study.quantities:
            rows = (
                (
                    solver,
                    *(_cell(study, solver, scene, quantity, goal) for goal in study.accuracies),
                )
                for solver in study.solvers
            )
            heading = " | ".join([f"{TABLE['symbols'][quantity]} to", *goals])
            parts += [f"{scene_text(scene)}:", table(heading, rows)]
    parts += [
        f"{p.solver} at {p.resolution:g} fails: {p.failure}" for p in study.points if p.failure
    ]
    return "\n\n".join(parts) + "\n"


def _cell(study: WorkPrecision, solver: str, scene: Scene, quantity: str, goal: float) -> str:
    """Return the time of a solver, warm and cold, with the ratio to the first one's."""
    first = study.solvers[0]
    found = []
    for mark, cold in (("", False), ("*", True)):
        time = study.reached(solver, scene, quantity, goal, cold=cold)
        if time is None:
            return "–"
        ours = study.reached(first, scene, quantity, goal, cold=cold)
        ratio = "" if solver == first or ours is None else f" ({_rounded(time / ours)}×)"
        found.append(f"{mark}{_rounded(1e3 * time)}{ratio}{mark}")
    return "<br>".join(found)


def _rounded(number: float) -> str:
    """Return two digits, never in exponents."""
    return f"{number:.0f}" if number >= 99.5 else f"{number:.2g}"


def _versions(peers: tuple[str, ...]) -> str:
    """Return the versions of the packages among the peers."""
    try:
        return "".join(f", {one} {version(one)}" for one in PACKAGES if one in peers)
    except PackageNotFoundError as error:
        raise MissingDependencyError(str(error.name), "peers") from error


def main() -> None:
    """Run, and write the results."""
    asked = options(__doc__, problems=",".join(PROBLEMS), small=False, results=str(RESULTS))
    chosen, folder = asked.problems.split(","), Path(asked.results)
    if unknown := set(chosen) - set(PROBLEMS):
        sys.exit(f"--problems = {', '.join(unknown)}: must be some of {', '.join(PROBLEMS)}")
    packages = {name: _versions(PROBLEMS[name].peers) for name in chosen}
    folder.mkdir(exist_ok=True)
    for name in chosen:
        study = measured(name, asked.small)
        path = folder / f"peers_{name}"
        study.save(path.with_suffix(".json"))
        study.plot(path.with_suffix(".png"))
        path.with_suffix(".md").write_text(tables(study, packages[name]), encoding="utf-8")


if __name__ == "__main__":
    main()
