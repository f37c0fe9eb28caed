"""``spectral-contact study``: what it asks of `spectral_contact.studies`."""

from __future__ import annotations

import argparse
import os
import sys
from typing import Annotated, Any, Final

from spectral_contact.errors import SceneError
from spectral_contact.studies.study import OwnSolver, convergence, named_solver, work_precision
from spectral_contact.studies.study_results import QUANTITIES, Study
from spectral_contact.view.cli.options import NotSolved, Option, Picture, resolution, written
from spectral_contact.view.cli.scene_options import FlatOptions

_TOLERANCES: Final = tuple(10.0**-k for k in range(2, 13))
_ACCURACIES: Final = tuple(10.0**-k for k in range(2, 13, 2))

Numbers = Annotated[list[float], Option(read=resolution, nargs="+")]
Names = Annotated[list[str], Option(*QUANTITIES, nargs="+", also=("--quantity",))]
Output = Annotated[str, written(".json", ".csv")]


def run_convergence(
    scene: FlatOptions,
    *,
    solver: str | None = None,
    resolutions: Numbers | None = None,
    no_times: bool = False,
    quantities: Names | None = None,
    output: Output | None = None,
    plot: Picture | None = None,
) -> None:
    """Error against unknowns and time of one solver.

    Exit status: 0 done, 1 no truth or no solve, 2 bad input or file, 130 interrupted.

    Parameters
    ----------
    solver : MODULE:FUNCTION
        A function of a scene and a resolution; its module may be in the current folder; by default
        this library, whose resolution is rtol.
    resolutions : N
        Resolutions to run the solver at; by default, for this library, 1e-2 to 1e-12.
    no_times : flag
        Measure errors only.
    quantities : NAME
        Quantities to measure; by default all available.
    output : FILE
        Store the study: .json exactly, .csv one row for each point.
    plot : FILE
        Plot the study (needs the extra: plot).
    """
    _find_modules_here()
    if resolutions is None and solver is not None:
        raise SceneError("resolutions", None, "given for a --solver")
    times: dict[str, Any] = {"repeats": 0} if no_times else {}
    study = convergence(
        OwnSolver(_asked(quantities)) if solver is None else named_solver(solver),
        scene.solved().scene,
        _TOLERANCES if resolutions is None else resolutions,
        name=solver,
        quantities=quantities,
        **times,
    )
    _finish(study, output, plot)


def run_work_precision(
    scene: FlatOptions,
    *,
    solver: Annotated[list[str] | None, Option(action="append")] = None,
    accuracies: Numbers = _ACCURACIES,  # type: ignore[assignment]
    quantities: Names | None = None,
    output: Output | None = None,
    plot: Picture | None = None,
) -> None:
    """Time to reach an accuracy, of this library and of other solvers.

    Exit status: 0 done, 1 no truth or no solve, 2 bad input or file, 130 interrupted.

    Parameters
    ----------
    solver : MODULE:FUNCTION[=N,N,...]
        A solver to compare this library with, and its resolutions from coarse to fine; without them
        it is called with the accuracies (may be repeated).
    accuracies : E
        Relative errors to be reached; by default 1e-2, 1e-4, ... 1e-12.
    quantities : NAME
        Quantities to measure; by default all available.
    output : FILE
        Store the study: .json exactly, .csv one row for each point.
    plot : FILE
        Plot the study (needs the extra: plot).
    """
    _find_modules_here()
    own = OwnSolver(_asked(quantities))
    solvers: dict[str, Any] = {own.name: own}
    for text in solver or ():
        name, listed, numbers = text.partition("=")
        solvers[name] = named_solver(name)
        if listed:
            try:
                at = [resolution(part) for part in numbers.split(",")]
            except argparse.ArgumentTypeError:
                told = "followed by numbers: =10,20,40"
                raise SceneError("solver", f"...={numbers}", told) from None
            solvers[name] = (solvers[name], at)
    _finish(
        work_precision(solvers, scene.solved().scene, accuracies, quantities=quantities),
        output,
        plot,
    )


def _find_modules_here() -> None:
    if os.getcwd() not in sys.path:
        sys.path.insert(0, os.getcwd())


def _finish(study: Study, output: str | None, plot: str | None) -> None:
    """Write the files, print the study, and raise `NotSolved` if no solve of it was done."""
    try:
        if output is not None:
            study.save(output)
        if plot is not None:
            study.plot(plot)
    finally:
        print(study)
    if study.points and all(point.failure for point in study.points):
        first = study.points[0]
        told = f"{first.solver} at {first.resolution:g}: {first.failure}"
        raise NotSolved(f"none of {len(study.points)} solves was done; the first one: {told}")


def _asked(quantities: list[str] | None) -> tuple[str, ...] | None:
    """Return what `solve` is asked for, to have the quantities of a study."""
    if quantities is None or not set(QUANTITIES).issuperset(quantities):
        return None
    return tuple({"pressure" if name == "edge_pressure" else name: None for name in quantities})
