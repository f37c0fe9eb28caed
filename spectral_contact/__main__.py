"""The command line: ``spectral-contact solve``, ``inside``, ``cycle``, ``sweep``, ``explore`` ...

Also ``python -m spectral_contact``.

Exit status: 0 on success; 1 if the tolerance was not met, or no scene of several was solved; 2
for a bad option, value, file or missing dependency; 130 when interrupted, 143 when terminated. An
error is one line on stderr.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NoReturn

from spectral_contact.errors import (
    ConvergenceError,
    NotComputedError,
    SceneError,
    SolutionFileError,
    SpectralContactError,
)
from spectral_contact.io.choices import suggestion
from spectral_contact.processes import PROGRAM, VERSION, failed, guarded
from spectral_contact.quantities import FIELDS
from spectral_contact.solution import GROWTH, QUANTITIES, Plan, Solution, StepState
from spectral_contact.solving.planning import plan
from spectral_contact.solving.solver import solve
from spectral_contact.threads import one_thread
from spectral_contact.view import plotting
from spectral_contact.view.cli import (
    benchmark_command,
    compare_command,
    cycle_command,
    explore_command,
    fit_command,
    inside_command,
    scene_options,
    study_command,
    sweep_command,
)
from spectral_contact.view.cli.options import NotSolved, UsageError, add_limits, joined, number
from spectral_contact.view.cli.profile_options import (
    add_any_scene,
    any_scene,
    given_scene,
    in_si_units,
)
from spectral_contact.view.report import report, write_csv

__all__ = ["main"]

_OUTPUTS = (".json", ".csv", ".npz")

#: Examples that the help of a command begins with, without the program's name.
EXAMPLES: Mapping[str, tuple[str, ...]] = {
    "solve": (
        "solve --poisson-ratio 0.3 --normal-compliance 0.05 --tangential-compliance 1 "
        "--friction 0.03",
        "solve --youngs-modulus 210e9 --poisson-ratio 0.3 --radius 5e-3 --load 1000 "
        "--normal-compliance-si 5e-14 --friction 0.05 --plot punch.png",
        "solve --profile sphere --radius 1 --load 0.1 --normal-compliance 0.01",
    ),
    "inside": (
        "inside --poisson-ratio 0.3 --normal-compliance 0.5 --plot body.png --output body.csv",
    ),
    "cycle": (
        "cycle --poisson-ratio 0.1 --normal-compliance 0.5 --tangential-compliance 0.5 "
        "--friction 0.1 --lowest 0.1",
        'cycle --youngs-modulus "210 GPa" --poisson-ratio 0.3 --radius "5 mm" --load "5 kN" '
        "--normal-compliance-si 5e-15 --tangential-compliance-si 6e-15 --friction 0.15 "
        "--lowest 0.2 --rtol 1e-4 --plot loop.png",
    ),
    "sweep": (
        "sweep --poisson-ratio 0:0.5:11 --friction 0.01:1:21:log --output map.nc",
        "sweep --youngs-modulus '70 GPa' --poisson-ratio 0.2 --profile parabola --radius '10 um' "
        "--load '0.1:10:50:log mN' --output curve.csv",
    ),
    "fit": (
        'fit curve.txt --profile sphere --radius "2.5 um" --poisson-ratio 0.5',
        'fit curve.csv --profile cone --half-angle "70.3 deg" --columns "depth=2 [nm],load=3 [uN]" '
        "--free reduced-modulus,zero-point,load-offset,tilt",
    ),
    "compare": (
        "compare nodes.csv --poisson-ratio 0.3 --normal-compliance 0.05 --friction none "
        "--columns r,pressure",
        'compare contact.rpt --youngs-modulus "210 GPa" --poisson-ratio 0.3 --radius "5 mm" '
        '--load 1000 --friction 0.05 --columns "r=2 [mm],pressure=4 [MPa]" --at-most 0.01',
    ),
    "explore": ("explore --poisson-ratio 0.3 --friction 0.05",),
}


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line.

    Parameters
    ----------
    argv : sequence of str, optional
        Arguments without the program's name; by default those of the process.

    Returns
    -------
    int
        The exit status, see the module's description.
    """
    return guarded(lambda: _run(sys.argv[1:] if argv is None else argv))


def _run(argv: Sequence[str]) -> int:
    """Do what the arguments ask for, and return the exit status of it."""
    try:
        arguments = _parser().parse_args(joined(argv))
        with one_thread():
            arguments.run(arguments)
    except SystemExit as stop:  # argparse, after --help and --version
        return int(stop.code or 0)
    except ConvergenceError as error:
        hint = " (--no-strict prints what was reached)" if "no_strict" in arguments else ""
        return failed(f"{error}{hint}", 1)
    except NotSolved as error:
        return failed(str(error), 1)
    except compare_command.TooLarge as error:
        print(error.report)
        return failed(str(error), 1)
    except SceneError as error:
        return failed(scene_options.in_options(error, in_si_units(arguments)), 2)
    except SpectralContactError as error:
        return failed(str(error), 2)
    return 0


# --- options --------------------------------------------------------------------------------------


class _Parser(argparse.ArgumentParser):
    """A parser whose complaint is one line, and suggests an option for one that is unknown."""

    def __init__(self, **options: Any) -> None:
        super().__init__(allow_abbrev=False, **options)

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        found, unknown = super().parse_known_args(args, namespace)
        if unknown:
            known = [name for action in self._actions for name in action.option_strings]
            meant = suggestion(unknown[0].partition("=")[0], known)
            self.error(f"unrecognized arguments: {' '.join(unknown)}{meant}")
        return found, unknown

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        """Suggest a choice for one that is unknown; argparse does so from Python 3.14 on."""
        try:
            super()._check_value(action, value)
        except argparse.ArgumentError as error:
            error.message += suggestion(value, action.choices or ())
            raise

    def error(self, message: str) -> NoReturn:
        raise UsageError(f"{message} (see {self.prog} --help)")


def _parser() -> _Parser:
    parser = _Parser(
        prog=PROGRAM,
        description="Solve the contact of a rigid punch, flat or of any convex shape, with a rough "
        "elastic half-space under Coulomb friction. `spectral-contact COMMAND --help` begins with "
        "examples.",
    )
    version = f"{PROGRAM} {VERSION}"
    parser.add_argument("--version", action="version", version=version)
    commands = parser.add_subparsers(dest="command", metavar="command", required=True)
    command = commands.add_parser(
        "solve",
        usage=_usage("solve"),
        help="solve one scene",
        description="Solve one scene; print quantities, error estimates, zones, plan and work.",
        epilog="Exit status: 0 solved, 1 tolerance not met, 2 bad input or file, 130 interrupted.",
    )
    add_any_scene(command)
    _add_request(command)
    command.set_defaults(run=_solve)
    _add_inside(commands)
    _add_cycle(commands)
    _add_studies(commands)
    _add_sweep(commands)
    _add_fit(commands)
    _add_compare(commands)
    _add_benchmarks(commands)
    _add_explore(commands)
    return parser


def _usage(command: str) -> str:
    """Return the usage of a command: its examples in place of the list of all its options."""
    lines = [f"{PROGRAM} {command} [options]", "", "examples:"]
    return "\n".join([*lines, *(f"  {PROGRAM} {example}" for example in EXAMPLES[command])])


def _add_request(command: _Parser) -> None:
    group = command.add_argument_group("request")
    group.add_argument(
        "--rtol",
        type=number,
        default=1e-10,
        help="bound on relative errors, 1e-13 to 1e-2 (default: %(default)s)",
    )
    group.add_argument(
        "--quantities",
        type=lambda text: tuple(name.strip() for name in text.split(",")),
        metavar="A,B,...",
        help=f"what to compute (default: all): {', '.join(QUANTITIES)}",
    )
    add_limits(group)
    group.add_argument(
        "--output",
        metavar="FILE",
        help="store the solution: .json or .npz exactly, .csv as a table of the fields",
    )
    group.add_argument(
        "--plot",
        metavar="FILE",
        help=f"plot the solution: {', '.join(plotting.FORMATS)} (needs the extra: plot)",
    )
    group.add_argument(
        "--history",
        metavar="FILE",
        help="store load, approach, shear and stick radius as the contact grows: .csv, one row for "
        "each contact radius",
    )


def _add_inside(commands: argparse._SubParsersAction[_Parser]) -> None:
    command = commands.add_parser(
        "inside",
        usage=_usage("inside"),
        help="stress and displacement inside the body",
        description="Solve one scene; print the largest stresses and the energies, store and plot "
        "stress and displacement below the surface.",
        epilog="Exit status: 0 done, 1 tolerance not met, 2 bad input or file, 130 interrupted.",
    )
    add_any_scene(command)
    inside_command.add_options(command)
    command.set_defaults(run=_inside)


def _add_cycle(commands: argparse._SubParsersAction[_Parser]) -> None:
    command = commands.add_parser(
        "cycle",
        usage=_usage("cycle"),
        help="the steady loop of a load that cycles",
        description="Find the steady loop of a load that cycles under a flat punch between that of "
        "the scene and a lower one: what sticks, what slips how far, and the energy that friction "
        "dissipates in each cycle.",
        epilog="Exit status: 0 done, 1 tolerance not met, 2 bad input or file, 130 interrupted.",
    )
    add_any_scene(command)
    cycle_command.add_options(command)
    command.set_defaults(run=_cycle)


def _add_studies(commands: argparse._SubParsersAction[_Parser]) -> None:
    study = commands.add_parser(
        "study",
        help="measure the errors and times of solvers",
        description="Measure errors against solutions to many digits, and times.",
    )
    for kind, command in _kinds(study, study_command.KINDS, " 1 no truth or no solve,"):
        scene_options.add_scene(command)
        study_command.add_options(command, kind)
        command.set_defaults(run=_study)


def _kinds(
    parent: _Parser, kinds: Mapping[str, str], status: str = ""
) -> Iterator[tuple[str, _Parser]]:
    """Add the kinds of a command, and yield each with its parser."""
    parsers = parent.add_subparsers(dest="kind", metavar="kind", required=True)
    for kind, about in kinds.items():
        yield (
            kind,
            parsers.add_parser(
                kind,
                help=about,
                description=f"{about.capitalize()}.",
                epilog=f"Exit status: 0 done,{status} 2 bad input or file, 130 interrupted.",
            ),
        )


def _add_sweep(commands: argparse._SubParsersAction[_Parser]) -> None:
    command = commands.add_parser(
        "sweep",
        usage=_usage("sweep"),
        help="solve a grid of scenes",
        description="Solve every combination of the parameters. VALUES are one number, several "
        "(0.1,0.2), or a range LOW:HIGH:COUNT; LOW:HIGH:COUNT:log spaces it in equal ratios. A run "
        "that was stopped resumes from its --store.",
        epilog="Exit status: 0 all solved, 1 a scene did not converge, 2 bad input or file, 130 "
        "interrupted. The first reason is printed; the output files name every one.",
    )
    sweep_command.add_options(command)
    command.set_defaults(run=_sweep)


def _add_fit(commands: argparse._SubParsersAction[_Parser]) -> None:
    command = commands.add_parser(
        "fit",
        usage=_usage("fit"),
        help="fit a measured force-indentation curve",
        description="Find the modulus, the layer and what the instrument adds from the depths and "
        "loads of a file (docs/indentation.md). The scene says what is known, in SI units; the "
        "numbers of it that are free are where the search starts.",
        epilog="Exit status: 0 done, 1 not converged, 2 bad input or file, 130 interrupted.",
    )
    add_any_scene(command)
    fit_command.add_options(command)
    command.set_defaults(run=_fit)


def _add_compare(commands: argparse._SubParsersAction[_Parser]) -> None:
    command = commands.add_parser(
        "compare",
        usage=_usage("compare"),
        help="compare the nodes of another code with the solution",
        description="Print the errors of fields at the nodes of a finite or boundary element code, "
        "and of numbers, in the units of the scene (docs/start/check.md). Displacements are those "
        "of the half-space below the layer.",
        epilog="Exit status: 0 done, 1 an error is larger than --at-most, 2 bad input or file, "
        "130 interrupted.",
    )
    add_any_scene(command)
    compare_command.add_options(command)
    command.set_defaults(run=lambda arguments: print(compare_command.run(arguments)))


def _add_benchmarks(commands: argparse._SubParsersAction[_Parser]) -> None:
    benchmark = commands.add_parser(
        "benchmark",
        help="problems to test other codes against",
        description="Ten problems with numbers and fields to test other codes against.",
    )
    for kind, command in _kinds(benchmark, benchmark_command.KINDS):
        benchmark_command.add_options(command, kind)
        command.set_defaults(run=lambda arguments: print(benchmark_command.run(arguments)))


def _add_explore(commands: argparse._SubParsersAction[_Parser]) -> None:
    command = commands.add_parser(
        "explore",
        usage=_usage("explore"),
        help="interactive explorer in a browser",
        description="Open a page with sliders in the browser (needs the extra: explore). It shows "
        "the scene of the options first. Only this machine can reach it; Ctrl-C ends it.",
        epilog="Exit status: 0 ended by Ctrl-C, 2 bad input or no free port.",
    )
    add_any_scene(command)
    explore_command.add_options(command)
    command.set_defaults(
        run=lambda arguments: explore_command.run(
            arguments, any_scene(arguments), lambda address: print(address, flush=True)
        )
    )


# --- from options to a solution -------------------------------------------------------------------


def _solve(arguments: argparse.Namespace) -> None:
    scene, remarks = given_scene(arguments)
    quantities = arguments.quantities
    if quantities is not None and "approach" in vars(arguments) and scene.profile is None:
        quantities = ("approach", *quantities)  # SI values hang on the load, hence on it
    _check_files(arguments, plan(scene, quantities))
    solution = solve(
        scene,
        arguments.rtol,
        quantities,
        max_unknowns=arguments.max_unknowns,
        strict=not arguments.no_strict,
    )
    try:
        _write(solution, arguments)
    finally:  # a full disk must not cost the user the result
        print(report(solution, remarks))


def _inside(arguments: argparse.Namespace) -> None:
    _check_paths(arguments, inside_command.OUTPUTS)
    print(inside_command.run(arguments))


def _cycle(arguments: argparse.Namespace) -> None:
    _check_paths(arguments, cycle_command.OUTPUTS)
    print(cycle_command.run(arguments))


def _study(arguments: argparse.Namespace) -> None:
    _check_paths(arguments, study_command.OUTPUTS)
    study = study_command.run(arguments, scene_options.scene(arguments))
    try:
        study_command.write(study, arguments)
    finally:
        print(study)
    study_command.check_some_solved(study)


def _sweep(arguments: argparse.Namespace) -> None:
    _check_paths(arguments, sweep_command.OUTPUTS)
    found = sweep_command.run(arguments)
    try:
        sweep_command.write(found, arguments)
    finally:
        print(sweep_command.summary(found))
    sweep_command.check_all_solved(found)


def _fit(arguments: argparse.Namespace) -> None:
    fit_command.choose_picture(arguments)
    _check_paths(arguments, fit_command.OUTPUTS)
    print(fit_command.run(arguments))


def _check_files(arguments: argparse.Namespace, todo: Plan) -> None:
    """Refuse, before the work, files that could not be written after it."""
    _check_paths(arguments, _OUTPUTS)
    if _is_csv(arguments.output) and not set(FIELDS).intersection(todo.quantities):
        raise UsageError(f"a .csv file is a table of {', '.join(FIELDS)}: ask for one")
    if arguments.plot is not None:
        plotting.check(todo)
    if arguments.history is not None:
        _check_path(Path(arguments.history), (".csv",))
        if not any(one.name == GROWTH and one.state is StepState.RUN for one in todo.steps):
            raise NotComputedError("history", "it needs a profile and friction")


def _check_paths(arguments: argparse.Namespace, outputs: Iterable[str]) -> None:
    for path, suffixes in ((arguments.output, outputs), (arguments.plot, plotting.FORMATS)):
        if path is not None:
            _check_path(Path(path), suffixes)


def _is_csv(path: str | None) -> bool:
    return path is not None and Path(path).suffix.lower() == ".csv"


def _check_path(path: Path, suffixes: Iterable[str]) -> None:
    if path.suffix.lower() not in suffixes:
        raise SolutionFileError(str(path), f"the suffix must be one of {', '.join(suffixes)}")
    try:
        if path.is_dir():
            raise SolutionFileError(str(path), "is a directory")
        if not path.parent.is_dir():
            raise SolutionFileError(str(path), "its directory does not exist")
        # it is replaced by a file made beside it
        needed = [Path(os.path.realpath(path)).parent, *([path] if path.exists() else [])]
        if not all(os.access(one, os.W_OK) for one in needed):
            raise SolutionFileError(str(path), "cannot be written: permission denied")
    except OSError as error:  # a name too long, or a directory that may not be searched
        reason = f"cannot be written: {error.strerror or error}"
        raise SolutionFileError(str(path), reason) from error


def _write(solution: Solution, arguments: argparse.Namespace) -> None:
    if _is_csv(arguments.output):
        write_csv(solution, arguments.output)
    elif arguments.output is not None:
        solution.save(arguments.output)
    if arguments.plot is not None:
        plotting.save(plotting.plot_solution(solution), arguments.plot)
    if arguments.history is not None:
        solution.history.to_csv(arguments.history)


if __name__ == "__main__":
    sys.exit(main())
