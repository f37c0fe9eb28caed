"""``spectral-contact sweep``: its options, and what they ask of `spectral_contact.sweeps`."""

from __future__ import annotations

import argparse
import math
import sys
from collections import Counter
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from spectral_contact.cli.options import friction, number, whole
from spectral_contact.inputs.checks import whole as checked_whole
from spectral_contact.io.documents import replace_file, reported
from spectral_contact.processes import workers
from spectral_contact.scene import Scene
from spectral_contact.solution import QUANTITIES
from spectral_contact.sweeps import plot_slice, sweep
from spectral_contact.sweeps.pictures import varying
from spectral_contact.view import plotting
from spectral_contact.view.report import table

if TYPE_CHECKING:
    import xarray

__all__ = ["OUTPUTS", "add_options", "run", "summary", "write"]

#: Suffixes of a stored sweep.
OUTPUTS: Final = (".nc", ".csv")
_PARAMETERS: Final = {
    "poisson_ratio": (0.1, "Poisson's ratio of the half-space, in (-1, 0.5]"),
    "normal_compliance": (0.5, "alpha* = alpha E / (4 (1 - nu^2) a)"),
    "tangential_compliance": (0.5, "beta* = beta E / (4 (1 - nu^2) a)"),
    "friction": (0.1, "coefficient >= 0; inf is full stick, none the frictionless problem"),
}


def add_options(command: argparse.ArgumentParser) -> None:
    """Add what a sweep takes."""
    group = command.add_argument_group("scenes")
    for name, (default, meaning) in _PARAMETERS.items():
        group.add_argument(
            f"--{name.replace('_', '-')}",
            type=_frictions if name == "friction" else _values,
            default=[default],
            metavar="VALUES",
            help=f"{meaning} (default: {default})",
        )
    group = command.add_argument_group("request")
    group.add_argument("--rtol", type=number, default=1e-8, help="(default: %(default)s)")
    group.add_argument(
        "--quantities",
        nargs="+",
        metavar="NAME",
        help=f"what to compute (default: the numbers): {', '.join(QUANTITIES)}",
    )
    group.add_argument("--s", type=_values, metavar="VALUES", help="radii of the fields, in [0, 1]")
    group.add_argument(
        "--from-edge", type=_values, metavar="VALUES", help="instead of --s: distances 1 - s"
    )
    group.add_argument(
        "--workers", type=whole, default=1, metavar="N", help="processes (default: %(default)s)"
    )
    group.add_argument(
        "--store", metavar="FOLDER", help="keep results here as they come, and go on from there"
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
        "--plot-quantity", metavar="NAME", help="which quantity (default: the first)"
    )
    group.add_argument(
        "--at",
        action="append",
        default=[],
        type=_cut,
        metavar="NAME=VALUE",
        help="where a dimension is cut for the plot, as in friction=0.2 (may be repeated)",
    )


def run(arguments: argparse.Namespace) -> xarray.Dataset:
    """Run the sweep that the options ask for.

    Raises
    ------
    SpectralContactError
        Whatever is wrong with the options.
    """
    if arguments.plot is not None:
        plotting.require()
    single, axes = {}, {}
    for name in _PARAMETERS:
        values = getattr(arguments, name)
        if len(values) == 1:
            single[name] = values[0]
        else:
            axes[name] = values
    # an axis is checked with the axes; until then its place is taken by what is always allowed
    base = Scene(**{"poisson_ratio": 0.3, **single})
    with workers(checked_whole("workers", arguments.workers, 1)) as executor:
        return sweep(
            base,
            **axes,
            quantities=arguments.quantities,
            rtol=arguments.rtol,
            s=arguments.s,
            from_edge=arguments.from_edge,
            executor=executor,
            store=arguments.store,
            progress=sys.stderr.isatty(),
        )


def write(dataset: xarray.Dataset, arguments: argparse.Namespace) -> None:
    """Write the files that the options name.

    Raises
    ------
    SolutionFileError
        If one cannot be written.
    SceneError
        If what is to be plotted is no slice.
    """
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
    for name, values in dataset.data_vars.items():
        if f"{name}_error" in dataset:
            error = dataset[f"{name}_error"]
            numbers = (values.min(), values.max(), error.max())
            cells.append((str(name), *(f"{float(one):.4g}" for one in numbers)))
    return f"{dataset.ending.size} scenes: {counts}\n" + table(cells)


def _content(dataset: xarray.Dataset, suffix: str) -> bytes:
    """Return what is in the file."""
    if suffix == ".csv":
        rows = dataset if dataset.sizes else dataset.expand_dims("scene")
        text: str = rows.to_dataframe().reset_index().to_csv(index=False)
        return text.encode()
    import h5netcdf
    from xarray.backends import H5NetCDFStore

    # in memory: on a full disk HDF5 may crash when it closes a file
    content = BytesIO()
    with h5netcdf.File(content, "w") as file:
        dataset.dump_to_store(H5NetCDFStore(file))
    return content.getvalue()


def _values(text: str) -> list[float]:
    """Return the numbers that a text stands for."""
    low, *rest = text.split(":")
    if not rest:
        return [number(part) for part in text.split(",")]
    refusal = argparse.ArgumentTypeError(f"{text!r} is not LOW:HIGH:COUNT[:log]")
    if len(rest) == 1 or rest[2:] not in ([], ["linear"], ["log"]):
        raise refusal
    start, high, count = number(low), number(rest[0]), whole(rest[1])
    if count < 1 or not math.isfinite(high - start):
        raise refusal
    if rest[2:] != ["log"]:
        return list(map(float, np.linspace(start, high, count)))
    if min(start, high) <= 0.0:
        raise argparse.ArgumentTypeError(f"{text!r}: equal ratios need positive ends")
    return list(map(float, np.geomspace(start, high, count)))


def _frictions(text: str) -> list[float | None]:
    """Return the same of friction, which may be ``none`` if it is alone."""
    alone = friction(text) if text.strip().lower() == "none" else 0.0
    return [None] if alone is None else list(_values(text))


def _cut(text: str) -> tuple[str, float]:
    name, equals, value = text.partition("=")
    if not equals:
        raise argparse.ArgumentTypeError(f"{text!r} is not NAME=VALUE")
    return name.strip().replace("-", "_"), number(value)
