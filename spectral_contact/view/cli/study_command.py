"""``spectral-contact study``: its options, and what they ask of `spectral_contact.studies`."""

from __future__ import annotations

import argparse
import os
import sys
from typing import Any, Final

from spectral_contact.errors import SceneError
from spectral_contact.scene import Scene
from spectral_contact.studies.study import OwnSolver, convergence, named_solver, work_precision
from spectral_contact.studies.study_results import QUANTITIES, Study
from spectral_contact.view import plotting
from spectral_contact.view.cli.options import NotSolved, resolution

#: The studies, and what they do.
KINDS: Final = {
    "convergence": "error against unknowns and time of one solver",
    "work-precision": "time to reach an accuracy, of this library and of other solvers",
}
#: Suffixes of a stored study.
OUTPUTS: Final = (".json", ".csv")
_TOLERANCES: Final = tuple(10.0**-k for k in range(2, 13))
_ACCURACIES: Final = tuple(10.0**-k for k in range(2, 13, 2))


def add_options(command: argparse.ArgumentParser, kind: str) -> None:
    """Add what a study takes besides the scene."""
    group = command.add_argument_group("study")
    if kind == "convergence":
        group.add_argument(
            "--solver",
            metavar="MODULE:FUNCTION",
            help="a function of a scene and a resolution; its module may be in the current folder "
            "(default: this library, whose resolution is rtol)",
        )
        group.add_argument(
            "--resolutions",
            type=resolution,
            nargs="+",
            metavar="N",
            help="resolutions to run the solver at (default for this library: 1e-2 to 1e-12)",
        )
        group.add_argument("--no-times", action="store_true", help="measure errors only")
    else:
        group.add_argument(
            "--solver",
            action="append",
            default=[],
            metavar="MODULE:FUNCTION[=N,N,...]",
            help="a solver to compare this library with, and its resolutions from coarse to fine; "
            "without them it is called with the accuracies (may be repeated)",
        )
        group.add_argument(
            "--accuracies",
            type=resolution,
            nargs="+",
            default=_ACCURACIES,
            metavar="E",
            help="relative errors to be reached (default: 1e-2, 1e-4, ... 1e-12)",
        )
    group.add_argument(
        "--quantity",
        "--quantities",
        dest="quantities",
        nargs="+",
        metavar="NAME",
        help=f"quantities to measure (default: all available): {', '.join(QUANTITIES)}",
    )
    group.add_argument(
        "--output",
        metavar="FILE",
        help="store the study: .json exactly, .csv one row for each point",
    )
    group.add_argument(
        "--plot",
        metavar="FILE",
        help=f"plot the study: {', '.join(plotting.FORMATS)} (needs the extra: plot)",
    )


def run(arguments: argparse.Namespace, scene: Scene) -> Study:
    """Run the study that the options ask for."""
    if arguments.plot is not None:
        plotting.require()
    if arguments.solver and os.getcwd() not in sys.path:
        sys.path.insert(0, os.getcwd())
    common: dict[str, Any] = {"quantities": arguments.quantities}
    own = OwnSolver(_asked(arguments.quantities))
    if arguments.kind == "work-precision":
        solvers: dict[str, Any] = {own.name: own}
        for text in arguments.solver:
            name, listed, resolutions = text.partition("=")
            solver = named_solver(name)
            solvers[name] = (solver, _numbers(resolutions)) if listed else solver
        return work_precision(solvers, scene, arguments.accuracies, **common)
    resolutions = arguments.resolutions
    if resolutions is None and arguments.solver is not None:
        raise SceneError("resolutions", None, "given for a --solver")
    return convergence(
        own if arguments.solver is None else named_solver(arguments.solver),
        scene,
        _TOLERANCES if resolutions is None else resolutions,
        name=arguments.solver,
        **common | ({"repeats": 0} if arguments.no_times else {}),
    )


def write(study: Study, arguments: argparse.Namespace) -> None:
    """Write the files that the options name."""
    if arguments.output is not None:
        study.save(arguments.output)
    if arguments.plot is not None:
        study.plot(arguments.plot)


def check_some_solved(study: Study) -> None:
    """Raise `NotSolved` with the first reason, if no solve of a study was done."""
    points = study.points
    if points and all(point.failure for point in points):
        first = points[0]
        told = f"{first.solver} at {first.resolution:g}: {first.failure}"
        raise NotSolved(f"none of {len(points)} solves was done; the first one: {told}")


def _asked(quantities: list[str] | None) -> tuple[str, ...] | None:
    """Return what `solve` is asked for, to have the quantities of a study."""
    if quantities is None or not set(QUANTITIES).issuperset(quantities):
        return None
    return tuple({"pressure" if name == "edge_pressure" else name: None for name in quantities})


def _numbers(text: str) -> list[float]:
    try:
        return [resolution(part) for part in text.split(",")]
    except argparse.ArgumentTypeError:
        raise SceneError("solver", f"...={text}", "followed by numbers: =10,20,40") from None
