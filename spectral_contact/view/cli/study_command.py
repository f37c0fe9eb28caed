"""``spectral-contact study``: what it asks of `spectral_contact.studies`."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Any, Final

from spectral_contact.studies.study import OwnSolver, convergence, named_solver, work_precision
from spectral_contact.studies.study_results import QUANTITIES, Study
from spectral_contact.view.cli import options
from spectral_contact.view.cli.options import NotSolved, Option, UsageError
from spectral_contact.view.cli.scene_options import FlatOptions

_TOLERANCES: Final = tuple(10.0**-k for k in range(2, 13))


def _solver_and_resolutions(text: str) -> tuple[str, list[float] | None]:
    """Return the two sides of ``MODULE:FUNCTION=N,N,...``; None without the second."""
    name, equals, numbers = text.partition("=")
    return name, options.resolutions(numbers) if equals else None


Numbers = Annotated[Sequence[float], options.several(options.resolutions)]
Solvers = Annotated[list[Any], Option(read=_solver_and_resolutions, action="append")]


@dataclass(frozen=True, slots=True, kw_only=True)
class Results:
    """Results.

    Parameters
    ----------
    quantities : NAME
        Quantities to measure; by default all available.
    output : FILE
        Store the study: .json exactly, .csv one row for each point.
    plot : FILE
        Plot the study (needs the extra: plot).
    """

    quantities: Annotated[
        list[str] | None, options.several(options.names, *QUANTITIES, also="--quantity")
    ] = None
    output: Annotated[str | None, options.written(".json", ".csv")] = None
    plot: options.Picture | None = None

    def own_solver(self) -> OwnSolver:
        """Return this library's solver, asked for the quantities of the study."""
        return OwnSolver(None if self.quantities is None else tuple(self.quantities))

    def write(self, study: Study) -> None:
        """Write the files, print the study, and raise `NotSolved` if all of its solves failed."""
        try:
            if self.output is not None:
                study.save(self.output)
            if self.plot:
                study.plot(self.plot)
        finally:
            print(study)
        if study.points and all(point.failure for point in study.points):
            first = study.points[0]
            told = f"{first.solver} at {first.resolution:g}: {first.failure}"
            raise NotSolved(f"none of {len(study.points)} solves was done; the first one: {told}")


def run_convergence(
    scene: FlatOptions,
    results: Results,
    *,
    solver: str | None = None,
    resolutions: Numbers | None = None,
    no_times: bool = False,
) -> None:
    """Error against unknowns and time of one solver.

    Exit status: 0 done, 1 no reference values or all solves failed, 2 bad input or file, 130
    interrupted.

    Parameters
    ----------
    solver : MODULE:FUNCTION
        A function of a scene and a resolution; its module may be in the current folder; by default
        this library, whose resolution is rtol.
    resolutions : N
        Resolutions to run the solver at; by default, for this library, 1e-2 to 1e-12.
    no_times : flag
        Measure errors only.
    """
    if resolutions is None and solver is not None:
        raise UsageError(f"--solver {solver} needs --resolutions, numbers that it is called with")
    times: dict[str, Any] = {"repeats": 0} if no_times else {}
    study = convergence(
        results.own_solver() if solver is None else _imported(solver),
        scene.build().scene,
        resolutions or _TOLERANCES,
        name=solver,
        quantities=results.quantities,
        **times,
    )
    results.write(study)


def run_work_precision(
    scene: FlatOptions,
    results: Results,
    *,
    solver: Solvers | None = None,
    accuracies: Numbers = _TOLERANCES[::2],
) -> None:
    """Time to reach an accuracy, of this library and of other solvers.

    Exit status: 0 done, 1 no reference values or all solves failed, 2 bad input or file, 130
    interrupted.

    Parameters
    ----------
    solver : MODULE:FUNCTION[=N,N,...]
        A solver to compare this library with, and its resolutions from coarse to fine; without them
        it is called with the accuracies (may be repeated).
    accuracies : E
        Relative errors to be reached; by default 1e-2, 1e-4, ... 1e-12.
    """
    solvers: dict[str, Any] = {OwnSolver.name: results.own_solver()}
    for name, at in solver or ():
        solvers[name] = _imported(name) if at is None else (_imported(name), at)
    study = work_precision(solvers, scene.build().scene, accuracies, quantities=results.quantities)
    results.write(study)


def _imported(solver: str) -> Any:
    """Return a solver by its name; its module may be in the current folder."""
    if os.getcwd() not in sys.path:
        sys.path.insert(0, os.getcwd())
    return named_solver(solver)
