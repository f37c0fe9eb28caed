"""``spectral-contact inside``: its options, and what they ask of `Solution.inside`."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Final

import numpy as np

from spectral_contact.equations.interior import Extreme, Inside
from spectral_contact.equations.interior.grids import QUANTITIES, as_csv, as_npz
from spectral_contact.errors import NotComputedError
from spectral_contact.io.columns import Expected, NumberTable
from spectral_contact.io.documents import netcdf, replace_file, reported
from spectral_contact.scene import Scene
from spectral_contact.solution import Solution
from spectral_contact.solving.solver import solve
from spectral_contact.view import plotting
from spectral_contact.view.cli.files import add_reading, read, reading_given
from spectral_contact.view.cli.options import UsageError, number, values
from spectral_contact.view.cli.profile_options import any_scene
from spectral_contact.view.report import table

#: Suffixes of a stored table; a grid alone can be a dataset.
OUTPUTS: Final = (".csv", ".npz", ".nc")


def add_options(command: argparse.ArgumentParser) -> None:
    """Add what the command takes, but for the scene."""
    group = command.add_argument_group("points")
    for name, meaning in (("r", "distances from the axis"), ("z", "depths")):
        group.add_argument(
            f"--{name}",
            type=values,
            metavar="VALUES",
            help=f"{meaning} of a grid: numbers (0.1,0.2) or LOW:HIGH:COUNT, in contact radii, or "
            "in m for a scene in SI units (default: 0 to two radii)",
        )
    group.add_argument(
        "--points",
        metavar="FILE",
        help="instead: a text file with columns r and z, in these units or those of its headings",
    )
    add_reading(group, "r=2,z=3 [mm]")
    group.add_argument(
        "--punch", action="store_true", help="points in an elastic punch, depths counted into it"
    )
    group = command.add_argument_group("request")
    group.add_argument(
        "--rtol", type=number, default=1e-8, help="bound on relative errors (default: %(default)s)"
    )
    group.add_argument(
        "--quantity",
        default="von_mises",
        choices=QUANTITIES,
        metavar="NAME",
        help=f"quantity to plot (default: %(default)s): {', '.join(QUANTITIES)}",
    )
    group.add_argument(
        "--output", metavar="FILE", help="store all quantities at the points: .csv, .npz or .nc"
    )
    group.add_argument(
        "--plot", metavar="FILE", help="plot contours: .png, .pdf or .svg (needs the extra: plot)"
    )


def run(arguments: argparse.Namespace) -> str:
    """Solve, write the files that the options name, and return what there is to say."""
    points = arguments.points
    if points is not None and (arguments.r or arguments.z):
        raise UsageError("--points is instead of --r and --z")
    if points is None and reading_given(arguments):
        raise UsageError(f"{reading_given(arguments)[0]} goes with --points")
    output = arguments.output
    suffix = "" if output is None else Path(output).suffix.lower()
    if points is not None and suffix == ".nc":
        raise UsageError("a .nc file holds a grid: not with --points")
    if arguments.plot is not None:
        plotting.require()
    scene = any_scene(arguments)
    given = None if points is None else read(points, _expected(scene), arguments)
    solution = solve(scene, min(arguments.rtol, 1e-10))
    body = _body(solution, in_punch=arguments.punch)
    if output is not None:
        content = _content(body, arguments, given, suffix)
        with reported(output, "cannot be written"):
            replace_file(output, content)
    if arguments.plot is not None:
        plotting.save(plotting.plot_inside(body, arguments.quantity), arguments.plot)
    summary = _summary(body, solution)
    return summary if given is None else f"{given}\n{summary}"


def _body(solution: Solution, *, in_punch: bool) -> Inside:
    if solution.scene.physical is None:
        if in_punch:
            raise UsageError("--punch goes with --punch-youngs-modulus and --punch-poisson-ratio")
        return solution.inside
    return solution.physical.punch_inside if in_punch else solution.physical.inside


def _content(
    body: Inside, arguments: argparse.Namespace, given: NumberTable | None, suffix: str
) -> bytes:
    default = np.linspace(0.0, 2.0 * body.radius, 81)
    r, z = (default if one is None else np.array(one) for one in (arguments.r, arguments.z))
    if suffix == ".nc":
        return netcdf(body.to_xarray(r, z, rtol=arguments.rtol))
    if given is None:
        places = list(np.meshgrid(r, z, sparse=True))
    else:
        places = [given.values["r"], given.values["z"]]
    found = body.to_table(*places, rtol=arguments.rtol)
    return as_npz(found) if suffix == ".npz" else as_csv(found, body.unit_names)


def _expected(scene: Scene) -> tuple[Expected, ...]:
    """Return the columns of a file of points."""
    unit = "" if scene.physical is None else "m"
    return tuple(Expected(name, unit, at_least=0.0) for name in ("r", "z"))


def _summary(body: Inside, solution: Solution) -> str:
    cells: list[tuple[str, ...]] = [("", "largest", "at r", "at z", "error", "")]
    for name in ("von_mises", "max_shear", "surface_tension"):
        cells.append((name, *_said(body.largest(name))))
    told = f"{solution!r}\n{table(cells)}"
    try:
        energies = body.energies()
    except NotComputedError as error:
        return f"{told}\n{error}"
    parts = ("external", "strain", "layer", "friction", "defect")
    work = [("energy", "value"), *((name, f"{getattr(energies, name):.12g}") for name in parts)]
    return f"{told}\n{table(work)}"


def _said(found: Extreme) -> tuple[str, ...]:
    value = "-" if found.value is None else f"{found.value:.12g}"
    error = "-" if found.error is None else f"{found.error:.1e}"
    return value, f"{found.r:.8g}", f"{found.z:.8g}", error, found.remark
