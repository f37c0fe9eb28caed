"""``spectral-contact sweep``: its options, and what they ask of `spectral_contact.sweeps`."""

from __future__ import annotations

import argparse
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from spectral_contact.io.checks import whole as checked_whole
from spectral_contact.io.documents import netcdf, replace_file, reported
from spectral_contact.processes import workers
from spectral_contact.profiles.control import ALL_CONTROLS
from spectral_contact.scene import Scene
from spectral_contact.solution import QUANTITIES
from spectral_contact.sweeps.slice_pictures import plot_slice, varying
from spectral_contact.sweeps.sweep_run import sweep
from spectral_contact.view import plotting
from spectral_contact.view.cli.layer_options import LAW_NUMBERS
from spectral_contact.view.cli.options import (
    NotSolved,
    UsageError,
    add_option,
    friction,
    number,
    si_values,
    values,
    whole,
)
from spectral_contact.view.cli.profile_options import add_profile, profile_given, profile_scene
from spectral_contact.view.cli.scene_options import add_coupling, kappa
from spectral_contact.view.cli.scene_options import scene as si_scene
from spectral_contact.view.report import table

if TYPE_CHECKING:
    import xarray

#: Suffixes of a stored sweep.
OUTPUTS: Final = (".nc", ".csv")
#: Options that make the scenes SI ones, and those that these alone have.
_SI_ONLY: Final = (
    *("youngs_modulus", "reduced_modulus", "punch_youngs_modulus", "punch_poisson_ratio"),
    *("normal_compliance_si", "tangential_compliance_si"),
)
_PARAMETERS: Final = {
    "poisson_ratio": (0.1, "Poisson's ratio of the half-space, in (-1, 0.5]"),
    "normal_compliance": (0.5, "alpha* = alpha E / (4 (1 - nu^2) a)"),
    "tangential_compliance": (0.5, "beta* = beta E / (4 (1 - nu^2) a)"),
    "friction": (0.1, "coefficient of friction >= 0; inf: full stick, none: no friction"),
    "unloaded_to": (1.0, "load over the largest load, from which the punch is unloaded"),
}


def add_options(command: argparse.ArgumentParser) -> None:
    """Add what a sweep takes."""
    group = command.add_argument_group("scenes")
    for name, (default, meaning) in _PARAMETERS.items():
        kind = _frictions if name == "friction" else values
        add_option(group, name, kind, f"{meaning} (default: {default})", "VALUES")
    meaning = "instead of --poisson-ratio: kappa of two elastic bodies, in (-3/8, 3/8)"
    add_option(group, "kappa", values, meaning, "VALUES")
    add_coupling(group)
    add_profile(command, si_values)
    group = command.add_argument_group(
        "scenes in SI units",
        "Options with one value or several, and a unit behind them, as in '1:10:4 mN' (needs the "
        "extra: units). A modulus makes the scenes SI ones; compliances are then those in m/Pa.",
    )
    about = {
        "load": "load on the punch [N]; without a modulus, under a profile alone",
        "approach": "approach of the punch [m]; likewise",
        "radius": "radius of a flat punch, or of the tip of a profile, one value [m]; likewise",
        "youngs_modulus": "Young's modulus of the half-space [Pa]",
        "reduced_modulus": "in place of all moduli and Poisson's ratios: E* [Pa]",
        "punch_youngs_modulus": "that of an elastic punch, under a profile [Pa]",
        "punch_poisson_ratio": "Poisson's ratio of an elastic punch",
        "normal_compliance_si": "normal compliance of the roughness [m/Pa]",
        "tangential_compliance_si": "tangential compliance of the roughness [m/Pa]",
    }
    for name, meaning in about.items():
        add_option(group, name, si_values, meaning, "VALUES")
    group.add_argument(
        "--table",
        metavar="FILE",
        help="a scene for each row of a text file, with parameters and their units as headings "
        "(docs/files.md); the other options have the other parameters",
    )
    group = command.add_argument_group("request")
    group.add_argument(
        "--rtol", type=number, default=1e-8, help="bound on relative errors (default: %(default)s)"
    )
    group.add_argument(
        "--quantities",
        nargs="+",
        metavar="NAME",
        help=f"what to compute (default: everything but the fields): {', '.join(QUANTITIES)}",
    )
    group.add_argument(
        "--s",
        type=values,
        metavar="VALUES",
        help="radii s = r/a at which fields are computed, in [0, 1]",
    )
    group.add_argument(
        "--from-edge",
        type=values,
        metavar="VALUES",
        help="instead of --s: distances 1 - s from the edge",
    )
    group.add_argument(
        "--workers",
        type=whole,
        default=1,
        metavar="N",
        help="number of worker processes (default: %(default)s)",
    )
    group.add_argument(
        "--store",
        metavar="FOLDER",
        help="folder that keeps results; a run that was stopped resumes from it",
    )
    group = command.add_argument_group("output")
    group.add_argument(
        "--output", metavar="FILE", help="store the sweep: .nc whole (NetCDF), .csv a table"
    )
    group.add_argument(
        "--plot",
        metavar="FILE",
        help=f"plot a slice: {', '.join(plotting.FORMATS)} (needs the extra: plot)",
    )
    group.add_argument(
        "--plot-quantity",
        metavar="NAME",
        help="the quantity to plot (default: the first that varies)",
    )
    group.add_argument(
        "--at",
        action="append",
        default=[],
        type=_cut,
        metavar="NAME=VALUE",
        help="value at which the plot holds a further parameter, as in friction=0.2 (repeatable)",
    )


def run(arguments: argparse.Namespace) -> xarray.Dataset:
    """Run the sweep that the options ask for."""
    if arguments.plot is not None:
        plotting.require()
    given = vars(arguments)
    si = not set(_SI_ONLY).isdisjoint(given)
    names = (*_PARAMETERS, "kappa", "radius", *ALL_CONTROLS, "work_of_adhesion", *_SI_ONLY)
    lists = {name: given[name] for name in names if name in given}
    of_law = {name: given[name] for name in LAW_NUMBERS if name in given}
    axes = {
        name.removesuffix("_si"): several for name, several in lists.items() if len(several) > 1
    }
    if "radius" in axes and profile_given(arguments):
        raise UsageError("--radius: the tip of a profile has one radius")
    law = {
        name.removeprefix("layer_"): several for name, several in of_law.items() if len(several) > 1
    }
    first = {name: several[0] for name, several in (lists | of_law).items()}
    base = _si_base(arguments, first) if si else _base(arguments, first)
    varied: dict[str, Any] = {name: _plain(several, si) for name, several in axes.items()}
    with workers(checked_whole("workers", arguments.workers, 1)) as executor:
        return sweep(
            base,
            **varied,
            layer=law or None,
            table=arguments.table,
            quantities=arguments.quantities,
            rtol=arguments.rtol,
            s=arguments.s,
            from_edge=arguments.from_edge,
            executor=executor,
            store=arguments.store,
        )


def _plain(several: list[Any], si: bool) -> list[Any]:
    """Return values; a unit is understood in SI units alone."""
    for value in several:
        if isinstance(value, str) and not si:
            raise UsageError(f"{value}: a unit needs --youngs-modulus or --reduced-modulus")
    return several


def _si_base(arguments: argparse.Namespace, first: dict[str, Any]) -> Scene:
    """Return the first scene in SI units; what a table may have need not be given."""
    if arguments.table is not None and not set(ALL_CONTROLS) & set(first):
        first = {**first, "load": 1.0}
    chosen = argparse.Namespace(**vars(arguments) | first)
    if profile_given(arguments):
        return profile_scene(chosen)
    if "friction" not in first:
        chosen.friction = None
    if arguments.table is not None and "radius" not in first:
        chosen.radius = 1.0
    return si_scene(chosen)


def _base(arguments: argparse.Namespace, first: dict[str, Any]) -> Scene:
    first = {name: _plain([value], False)[0] for name, value in first.items()}
    if profile_given(arguments):
        return profile_scene(argparse.Namespace(**vars(arguments) | first))
    others = "radius", *ALL_CONTROLS, "work_of_adhesion"
    alien = [name for name in others if name in arguments]
    if alien:
        raise UsageError(f"--{alien[0]} needs --profile or --youngs-modulus")
    values = {name: default for name, (default, _) in _PARAMETERS.items()} | first
    values |= kappa(first)
    values.pop("kappa", None)
    return Scene(**values, coupling=arguments.coupling)


def write(dataset: xarray.Dataset, arguments: argparse.Namespace) -> None:
    """Write the files that the options name."""
    output = arguments.output
    if output is not None:
        with reported(output, "cannot be written"):
            replace_file(output, _content(dataset, Path(output).suffix.lower()))
    if arguments.plot is not None:
        at = dict(arguments.at)
        quantity = arguments.plot_quantity or varying(dataset, at)
        plotting.save(plot_slice(dataset, quantity, at), arguments.plot)


def summary(dataset: xarray.Dataset) -> str:
    """Return how many scenes ended how, and the range of every quantity."""
    endings = Counter(dataset.ending.values.ravel().tolist())
    counts = ", ".join(f"{count} {ending}" for ending, count in endings.most_common())
    cells: list[tuple[str, ...]] = [("quantity", "least", "largest", "largest error estimate")]
    for name, column in dataset.data_vars.items():
        if f"{name}_error" in dataset:
            error = dataset[f"{name}_error"]
            numbers = (column.min(), column.max(), error.max())
            cells.append((str(name), *(f"{float(one):.4g}" for one in numbers)))
    told = f"{dataset.ending.size} scenes: {counts}\n" + table(cells)
    return f"{dataset.attrs['table']}\n{told}" if "table" in dataset.attrs else told


def check_all_solved(dataset: xarray.Dataset) -> None:
    """Raise `NotSolved` with the first reason, if a scene of a sweep did not converge."""
    endings = dataset.ending.values.ravel().tolist()
    wrong = [k for k, ending in enumerate(endings) if ending != "converged"]
    if wrong:
        message = dataset.message.values.ravel().tolist()[wrong[0]]
        many = "none" if len(wrong) == len(endings) else f"{len(endings) - len(wrong)}"
        told = f"{many} of {len(endings)} scenes {'were' if many != 'none' else 'was'} solved"
        raise NotSolved(f"{told}; the first that was not: {endings[wrong[0]]}, {message}")


def _content(dataset: xarray.Dataset, suffix: str) -> bytes:
    if suffix == ".csv":
        rows = dataset if dataset.sizes else dataset.expand_dims("scene")
        text: str = rows.to_dataframe().reset_index().to_csv(index=False)
        return text.encode()
    return netcdf(dataset)


def _frictions(text: str) -> list[float | None]:
    """Return the same of friction, which may be ``none`` if it is alone."""
    alone = friction(text) if text.strip().lower() == "none" else 0.0
    return [None] if alone is None else list(values(text))


def _cut(text: str) -> tuple[str, float]:
    name, equals, value = text.partition("=")
    if not equals:
        raise argparse.ArgumentTypeError(f"{text!r} is not NAME=VALUE")
    return name.strip().replace("-", "_"), number(value)
