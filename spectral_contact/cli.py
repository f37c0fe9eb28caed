"""The command line: ``spectral-contact solve``, also ``python -m spectral_contact solve``.

Exit status: 0 for a solution; 1 if the tolerance was not met; 2 for a bad option, value, file or
missing dependency; 130 when interrupted. Whatever fails is said in one line on stderr.
"""

from __future__ import annotations

import argparse
import math
import os
import sys
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn

import numpy as np

import spectral_contact
from spectral_contact import plotting
from spectral_contact.errors import (
    ConvergenceError,
    SceneError,
    SolutionFileError,
    SpectralContactError,
)
from spectral_contact.planning import plan
from spectral_contact.scene import Scene
from spectral_contact.solution import QUANTITIES, PhysicalSolution, Plan, Solution
from spectral_contact.solver import solve

__all__ = ["main"]

_PROGRAM = "spectral-contact"
_OUTPUTS = (".json", ".csv", ".npz")
_FIELDS = ("pressure", "traction", "slip")

_COMPLIANCES = ("normal_compliance", "tangential_compliance")
_SI_COMPLIANCES = ("normal_compliance_si", "tangential_compliance_si")
_SI = ("youngs_modulus", "radius", "load", "approach", *_SI_COMPLIANCES)
#: Dimensionless scene of a bare ``spectral-contact solve``; in SI the compliances default to 0.
_DEFAULT_NU, _DEFAULT_COMPLIANCE, _DEFAULT_FRICTION = 0.1, 0.5, 0.1


class _UsageError(SpectralContactError):
    """The options do not make a request."""


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
    try:
        arguments = _parser().parse_args(_joined(sys.argv[1:] if argv is None else argv))
        _solve(arguments)
        sys.stdout.flush()
    except SystemExit as stop:  # argparse, after --help and --version
        return int(stop.code or 0)
    except ConvergenceError as error:
        return _failed(f"{error} (--no-strict prints what was reached)", 1)
    except SceneError as error:
        return _failed(_in_options(error, _si_given(arguments)), 2)
    except SpectralContactError as error:
        return _failed(str(error), 2)
    except KeyboardInterrupt:
        return _failed("interrupted", 130)
    except OSError as error:  # of stdout; files are reported by those who write them
        # else the interpreter fails once more when it flushes at its end
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        if isinstance(error, BrokenPipeError):  # as in "| head"
            return 0
        return _failed(f"standard output: {error.strerror}", 2)
    return 0


def _failed(message: str, status: int) -> int:
    print(f"{_PROGRAM}: {' '.join(message.split())}", file=sys.stderr)
    return status


# --- options --------------------------------------------------------------------------------------


class _Parser(argparse.ArgumentParser):
    """A parser whose complaint is one line."""

    def error(self, message: str) -> NoReturn:
        raise _UsageError(f"{message} (see {self.prog} --help)")


def _parser() -> _Parser:
    parser = _Parser(
        prog=_PROGRAM,
        description="Contact of a rigid flat punch with a rough elastic half-space.",
        allow_abbrev=False,
    )
    version = f"{_PROGRAM} {spectral_contact.__version__}"
    parser.add_argument("--version", action="version", version=version)
    commands = parser.add_subparsers(dest="command", metavar="command", required=True)
    command = commands.add_parser(
        "solve",
        help="solve one scene",
        description="Solve one scene; print quantities, error estimates, zones, plan and work.",
        epilog="Exit status: 0 solved, 1 tolerance not met, 2 bad input or file, 130 interrupted.",
        allow_abbrev=False,
    )
    _add_scene(command)
    _add_physical(command)
    _add_request(command)
    return parser


def _add_scene(command: _Parser) -> None:
    group = command.add_argument_group("scene")
    group.add_argument(
        "--poisson-ratio",
        type=_number,
        metavar="NU",
        default=_DEFAULT_NU,
        help="Poisson's ratio of the half-space, in (-1, 0.5] (default: %(default)s)",
    )
    for option, symbol in (("normal", "alpha"), ("tangential", "beta")):
        group.add_argument(
            f"--{option}-compliance",
            type=_number,
            metavar=symbol.upper(),
            help=f"{symbol}* = {symbol} E / (4 (1 - nu^2) a), 0 (smooth) or in [1e-14, 1e14] "
            f"(default: {_DEFAULT_COMPLIANCE})",
        )
    group.add_argument(
        "--friction",
        type=_friction,
        metavar="F",
        default=_DEFAULT_FRICTION,
        help="Coulomb coefficient >= 0; inf is full stick, none the frictionless problem "
        "(default: %(default)s)",
    )


def _add_physical(command: _Parser) -> None:
    group = command.add_argument_group(
        "scene in SI units",
        "Any of these replaces the dimensionless compliances: modulus, radius and either load or "
        "approach are then required, the compliances default to 0.",
    )
    for name, metavar, meaning in (
        ("youngs-modulus", "E", "Young's modulus of the half-space [Pa]"),
        ("radius", "A", "radius of the punch [m]"),
        ("load", "P", "normal force [N]"),
        ("approach", "DELTA", "rigid approach of the punch [m]"),
        ("normal-compliance-si", "ALPHA", "normal compliance of the roughness [m/Pa]"),
        ("tangential-compliance-si", "BETA", "tangential compliance of the roughness [m/Pa]"),
    ):
        group.add_argument(f"--{name}", type=_number, metavar=metavar, help=meaning)


def _add_request(command: _Parser) -> None:
    group = command.add_argument_group("request")
    group.add_argument(
        "--rtol",
        type=_number,
        default=1e-10,
        help="bound on relative errors, 1e-13 to 1e-2 (default: %(default)s)",
    )
    group.add_argument(
        "--quantities",
        type=lambda text: tuple(name.strip() for name in text.split(",")),
        metavar="A,B,...",
        help=f"what to compute (default: all): {', '.join(QUANTITIES)}",
    )
    group.add_argument(
        "--max-unknowns",
        type=_whole,
        metavar="N",
        default=20_000,
        help="most unknowns of one linear system (default: %(default)s)",
    )
    group.add_argument(
        "--no-strict",
        action="store_true",
        help="if the tolerance cannot be met, print what was reached and exit with 0",
    )
    group.add_argument(
        "--output",
        metavar="FILE",
        help="store the solution: .json or .npz whole and exact, .csv a table of the fields",
    )
    group.add_argument(
        "--plot",
        metavar="FILE",
        help=f"plot the solution: {', '.join(plotting.FORMATS)} (needs the extra: plot)",
    )


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number") from None


def _whole(text: str) -> int:
    try:
        return int(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number") from None


def _friction(text: str) -> float | None:
    if text.strip().lower() == "none":
        return None
    number = _number(text)
    if not number >= 0.0:
        raise argparse.ArgumentTypeError(f"{text!r} must be >= 0, or inf (full stick), or none")
    return number


def _joined(argv: Sequence[str]) -> list[str]:
    """Write ``--option -1e-3`` as ``--option=-1e-3``; argparse takes the former for two options."""
    joined: list[str] = []
    for text in argv:
        if joined and joined[-1].startswith("--") and "=" not in joined[-1] and _negative(text):
            joined[-1] = f"{joined[-1]}={text}"
        else:
            joined.append(text)
    return joined


def _negative(text: str) -> bool:
    try:
        return text.startswith("-") and not math.isnan(float(text))
    except ValueError:
        return False


def _flag(name: str) -> str:
    return "--" + name.replace("_", "-")


def _in_options(error: SceneError, si: bool) -> str:
    """Return the message with the parameter under the name that the command line gives it."""
    names = [
        _flag(name + "_si" if si and name in _COMPLIANCES else name)
        for name in error.parameter.split(", ")
    ]
    return ", ".join(names) + str(error).removeprefix(error.parameter)


# --- from options to a solution -------------------------------------------------------------------


def _solve(arguments: argparse.Namespace) -> None:
    """Check everything that can be checked, solve, write the files and print the report."""
    scene = _scene(arguments)
    quantities = arguments.quantities
    if quantities is not None and arguments.approach is not None:
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
        print(_report(solution))


def _si_given(arguments: argparse.Namespace) -> bool:
    return any(getattr(arguments, name) is not None for name in _SI)


def _scene(arguments: argparse.Namespace) -> Scene:
    """Return the scene of the options, dimensionless or SI."""
    given = {name for name in (*_COMPLIANCES, *_SI) if getattr(arguments, name) is not None}
    if not _si_given(arguments):
        alpha, beta = (
            _DEFAULT_COMPLIANCE if getattr(arguments, name) is None else getattr(arguments, name)
            for name in _COMPLIANCES
        )
        return Scene(arguments.poisson_ratio, alpha, beta, arguments.friction)
    mixed = [name for name in _COMPLIANCES if name in given]
    if mixed:
        raise _UsageError(
            f"{_flag(mixed[0])} is dimensionless and cannot be mixed with SI input "
            f"({_flag(next(name for name in _SI if name in given))}); "
            f"use {_flag(mixed[0])}-si, in m/Pa"
        )
    missing = [_flag(name) for name in ("youngs_modulus", "radius") if name not in given]
    if missing:
        raise _UsageError(f"SI input needs {' and '.join(missing)}")
    if ("load" in given) == ("approach" in given):
        raise _UsageError("SI input needs either --load or --approach, not both")
    return Scene.from_physical(
        youngs_modulus=arguments.youngs_modulus,
        poisson_ratio=arguments.poisson_ratio,
        radius=arguments.radius,
        load=arguments.load,
        approach=arguments.approach,
        normal_compliance=arguments.normal_compliance_si or 0.0,
        tangential_compliance=arguments.tangential_compliance_si or 0.0,
        friction=arguments.friction,
    )


def _check_files(arguments: argparse.Namespace, todo: Plan) -> None:
    """Refuse, before the work, files that could not be written after it."""
    for path, suffixes in ((arguments.output, _OUTPUTS), (arguments.plot, plotting.FORMATS)):
        if path is not None:
            _check_path(Path(path), suffixes)
    if _is_csv(arguments.output) and not set(_FIELDS).intersection(todo.quantities):
        raise _UsageError(f"a .csv file is a table of {', '.join(_FIELDS)}: ask for one")
    if arguments.plot is not None:
        plotting.check(todo)


def _is_csv(path: str | None) -> bool:
    return path is not None and Path(path).suffix.lower() == ".csv"


def _check_path(path: Path, suffixes: Iterable[str]) -> None:
    if path.suffix.lower() not in suffixes:
        raise SolutionFileError(str(path), f"the suffix must be one of {', '.join(suffixes)}")
    if path.is_dir():
        raise SolutionFileError(str(path), "is a directory")
    if not path.parent.is_dir():
        raise SolutionFileError(str(path), "its directory does not exist")
    if not os.access(path if path.exists() else path.parent, os.W_OK):
        raise SolutionFileError(str(path), "cannot be written: permission denied")


def _write(solution: Solution, arguments: argparse.Namespace) -> None:
    if _is_csv(arguments.output):
        _write_csv(solution, arguments.output)
    elif arguments.output is not None:
        solution.save(arguments.output)
    if arguments.plot is not None:
        plotting.save(plotting.plot_solution(solution), arguments.plot)


# --- the report -----------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class _Row:
    """One scalar: its label, value, unit and the estimate of its relative error."""

    label: str
    value: float | None
    unit: str
    error: float | None


def _rows(solution: Solution) -> list[_Row]:
    """Return the dimensionless scalars of a solution."""
    rows = _scalars(solution, solution, {})
    if solution.error.violation is not None:
        rows.append(_Row("friction law, violation", solution.error.violation, "", None))
    return rows


def _si_rows(solution: Solution) -> list[_Row]:
    """Return the scalars that have a unit, in SI units."""
    data = solution.scene.physical
    if data is None:
        return []
    approach_error = solution.error.approach or 0.0
    # from an approach the load is computed, and everything scaled by it inherits its error
    inherited = 0.0 if data.approach is None else approach_error
    physical = solution.physical
    rows = [_Row("load", physical.load, "N", inherited)]
    units = {"pressure": "Pa", "traction": "Pa", "slip": "m", "approach": "m"}
    units |= {"stick_radius": "m", "total_shear": "N"}
    for row in _scalars(physical, solution, units):
        if row.label == "approach":
            error: float | None = 0.0 if data.approach is not None else approach_error
        elif row.label == "stick radius" or row.error is None:
            error = row.error
        else:
            error = row.error + inherited
        rows.append(_Row(row.label, row.value, row.unit, error))
    return [row for row in rows if row.unit]


def _scalars(
    source: Solution | PhysicalSolution, solution: Solution, units: dict[str, str]
) -> list[_Row]:
    """Return fields at centre and edge, and scalars, of a solution or of its SI view."""
    rows = []
    for name in solution.plan.quantities:
        unit, error = units.get(name, ""), getattr(solution.error, name)
        if name == "pressure":
            rows.append(_Row("pressure, centre", float(source.pressure(0.0)), unit, error))
        if name in _FIELDS:
            edge = float(getattr(source, name)(from_edge=0.0))
            rows.append(_Row(f"{name}, edge", edge, unit, error))
        elif name != "zones":
            rows.append(_Row(name.replace("_", " "), getattr(source, name), unit, error))
    return rows


def _report(solution: Solution) -> str:
    """Return everything that is printed; only the timings differ from run to run."""
    parts = [_scene_text(solution), _quantity_table(_rows(solution), "quantity")]
    if solution.scene.physical is not None:
        parts.append(_quantity_table(_si_rows(solution), "SI"))
    if "zones" in solution.plan.quantities:
        parts.append(_zone_table(solution))
    parts += [f"plan\n{_indented(str(solution.plan))}", _work_table(solution)]
    verdict = "yes" if solution.converged else f"no. {solution.ending.value}"
    parts.append(f"converged: {verdict}")
    return "\n\n".join(parts)


def _scene_text(solution: Solution) -> str:
    scene, data = solution.scene, solution.scene.physical
    friction = f"f = {scene.friction!r}"
    if scene.friction is None:
        friction = "no friction"
    elif scene.friction == math.inf:
        friction = "full stick"
    text = (
        f"nu = {scene.poisson_ratio!r}, alpha* = {scene.normal_compliance!r}, "
        f"beta* = {scene.tangential_compliance!r}, {friction}; rtol = {solution.rtol!r}"
    )
    if data is not None:
        drive = f"P = {data.load!r} N" if data.approach is None else f"delta = {data.approach!r} m"
        text += (
            f"\nE = {data.youngs_modulus!r} Pa, a = {data.radius!r} m, {drive}, "
            f"alpha = {data.normal_compliance!r} m/Pa, beta = {data.tangential_compliance!r} m/Pa"
        )
    return text


def _quantity_table(rows: list[_Row], title: str) -> str:
    cells = [(title, "value", "error estimate")]
    for row in rows:
        value = f"{_digits(row.value, row.error)} {row.unit}".rstrip()
        cells.append((row.label, value, "-" if row.value is None else _estimate(row.error)))
    return _table(cells)


def _zone_table(solution: Solution) -> str:
    zones, estimate = solution.zones, solution.error.zones
    if not zones:
        return "zones\n  none: without friction there is neither stick nor slip"
    cells: list[tuple[str, ...]] = [("zones", "from", "to", "1 - to", "error estimate")]
    for zone in zones:
        radii = (zone.inner, zone.outer, zone.outer_from_edge)
        cells.append((zone.kind, *(_digits(r, estimate) for r in radii), _estimate(estimate)))
    if solution.scene.physical is not None:
        metres = (_digits(zone.outer, estimate) for zone in solution.physical.zones)
        cells = [(*row, cell) for row, cell in zip(cells, ("to [m]", *metres), strict=True)]
    return _table(cells)


def _work_table(solution: Solution) -> str:
    cells = [("work", "unknowns", "degree", "spaces", "time")]
    for step in solution.work.steps:
        degree = str(max(step.degrees)) if step.degrees else "-"
        spaces = str(len(step.history)) if step.history else "-"
        time = f"{1e3 * step.seconds:.1f} ms"
        cells.append((step.name, str(step.unknowns), degree, spaces, time))
    work = solution.work
    cells.append(("total", "", "", "", f"{1e3 * work.seconds:.1f} ms"))
    return _table(cells)


def _table(cells: Sequence[tuple[str, ...]]) -> str:
    """Align columns to the left; the first line is a heading."""
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    widths[0] += 2
    lines = []
    for i, row in enumerate(cells):
        row = (row[0] if i == 0 else f"  {row[0]}", *row[1:])
        padded = (f"{cell:<{width}}" for cell, width in zip(row, widths, strict=True))
        lines.append("   ".join(padded).rstrip())
    return "\n".join(lines)


def _indented(text: str) -> str:
    return "\n".join(f"  {line}" for line in text.splitlines())


def _digits(value: float | None, error: float | None) -> str:
    """Return a value with the digits that its error leaves it, and one more."""
    if value is None:
        return "none"
    if error is None:
        return f"{value:.1e}" if value else "0"
    if error == 0.0:
        return repr(value).removesuffix(".0")
    # an estimate of NaN or infinity vouches for no digit
    digits = math.ceil(-math.log10(error)) + 1 if error < 0.1 else 2
    return f"{value:.{min(digits, 17)}g}"


def _estimate(error: float | None) -> str:
    if error is None:
        return "-"
    return "exact" if error == 0.0 else f"{error:.1e}"


# --- the table of fields --------------------------------------------------------------------------


def _write_csv(solution: Solution, path: str) -> None:
    radii = plotting.graded_radii(solution)
    columns: dict[str, Any] = {"s": radii.s, "one_minus_s": radii.from_edge}
    present = solution.plan.quantities
    friction = solution.scene.friction
    if "pressure" in present:
        columns["p"] = radii.evaluate(solution.pressure)
    if "traction" in present:
        columns["q"] = radii.evaluate(solution.traction)
    if "pressure" in present and friction is not None and math.isfinite(friction):
        # not 0 * inf at the edge of a smooth surface
        columns["f_p"] = friction * columns["p"] if friction else np.zeros(len(radii.s))
    if "slip" in present:
        columns["slip"] = radii.evaluate(solution.slip)
    lines = [f"# {line}" for line in _csv_comments(solution)]
    lines.append(",".join(columns))
    for row in zip(*(column.tolist() for column in columns.values()), strict=True):
        lines.append(",".join(map(repr, row)))
    try:
        Path(path).write_text("\n".join(lines) + "\n", encoding="utf-8", newline="\n")
    except OSError as error:
        reason = f"cannot be written: {error.strerror or error}"
        raise SolutionFileError(path, reason) from error


def _csv_comments(solution: Solution) -> list[str]:
    lines = [
        f"spectral_contact {spectral_contact.__version__}",
        *_scene_text(solution).splitlines(),
        f"converged: {'yes' if solution.converged else 'no'}",
        "dimensionless: s = r/a, p and q in P/a^2, slip in 4 (1 - nu^2) P / (a E)",
    ]
    for row in (*_rows(solution), *_si_rows(solution)):
        unit = f" {row.unit}" if row.unit else ""
        value = "none" if row.value is None else repr(row.value)
        error = f"relative error {row.error:.1e}" if row.error else "exact"
        estimate = "" if row.error is None or row.value is None else f" ({error})"
        lines.append(f"{row.label} = {value}{unit}{estimate}")
    if "zones" in solution.plan.quantities:
        for zone in solution.zones:
            lines.append(
                f"zone: {zone.kind} from {zone.inner!r} to {zone.outer!r}, "
                f"1 - s from {zone.inner_from_edge!r} to {zone.outer_from_edge!r}"
            )
    return lines
