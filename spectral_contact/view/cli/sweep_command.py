"""``spectral-contact sweep``: what it asks of `spectral_contact.sweeps`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

from spectral_contact import QUANTITIES, plotting, sweep
from spectral_contact.errors import SceneError
from spectral_contact.io.checks import whole
from spectral_contact.processes import workers as worker_processes
from spectral_contact.profiles.control import ALL_CONTROLS
from spectral_contact.sweeps.dataset import summary, unsolved, write
from spectral_contact.sweeps.physical_scenes import columns_of
from spectral_contact.sweeps.slice_pictures import plot_slice, varying
from spectral_contact.view.cli import options
from spectral_contact.view.cli.options import NotSolved, UsageError
from spectral_contact.view.cli.scene_options import NUMBERS, SHAPES, SceneOptions


class SweptOptions(SceneOptions):
    """Options of every kind of scene, each of whose numbers may have several values."""

    number = options.values, "VALUES"

    def first_and_varying(self) -> tuple[dict[str, Any], dict[str, Any]]:
        """Return the options with their first values, and all values of those with several."""
        lists = {name: one for name, one in self.given.items() if name in NUMBERS}
        varying = {name: one for name, one in lists.items() if len(one) > 1}
        for name in varying:
            # of a table it is not known yet; `sweep` refuses a radius without SI units then
            in_si = self.si or "table" in self.given
            if name in SHAPES and not (name == "radius" and in_si):
                told = "one number: of a profile the radius alone varies, in SI units"
                raise SceneError(name, varying[name], told)
        first = {**self.given, **{name: one[0] for name, one in lists.items()}}
        return first, {name.removesuffix("_si"): one for name, one in varying.items()}


def run(
    scenes: SweptOptions,
    *,
    table: str | None = None,
    rtol: options.Number = 1e-8,
    quantities: Annotated[list[str] | None, options.several(options.names, *QUANTITIES)] = None,
    s: options.Values | None = None,
    from_edge: options.Values | None = None,
    workers: options.Whole = 1,
    store: str | None = None,
    output: Annotated[str | None, options.written(".nc", ".csv")] = None,
    plot: options.Picture | None = None,
    plot_quantity: str | None = None,
    at: options.NamedNumbers | None = None,
) -> None:
    r"""Solve a grid of scenes.

    Solve every combination of the parameters. VALUES are one number, several (0.1,0.2), or a range
    LOW:HIGH:COUNT; LOW:HIGH:COUNT:log spaces it in equal ratios; a unit stands behind them, as in
    '1:10:4 mN'. Of the shape of a profile only the radius may vary, in SI units. A run that was
    stopped resumes from its --store. Exit status: 0 all solved, 1 a scene did not converge, 2 bad
    input or file, 130 interrupted. The first reason is printed; the output files name every one.

    Parameters
    ----------
    table : FILE
        A scene for each row of a text file, with parameters and their units as headings
        (docs/files.md); the other options have the other parameters.
    rtol : X
        Bound on relative errors.
    quantities : NAME
        What to compute; by default everything but the fields. Under a profile also contact_radius,
        load, stiffness and indentation_work; in general.
    s : VALUES
        Radii s = r/a at which fields are computed, in [0, 1].
    from_edge : VALUES
        Instead of --s: distances 1 - s from the edge.
    workers : N
        Number of worker processes.
    store : FOLDER
        Folder that keeps results; a run that was stopped resumes from it.
    output : FILE
        Store the sweep: .nc whole (NetCDF), .csv a table.
    plot : FILE
        Plot a slice (needs the extra: plot).
    plot_quantity : NAME
        The quantity to plot; by default the first quantity that varies.
    at : NAME=VALUE
        Value at which a parameter is held that is on no axis of the plot, as in friction=0.2
        (repeatable).

    Examples
    --------
    spectral-contact sweep --poisson-ratio 0:0.5:11 --friction 0.01:1:21:log --output map.nc
    spectral-contact sweep --youngs-modulus '70 GPa' --poisson-ratio 0.2 --profile parabola \
        --radius '10 um' --load '0.1:10:50:log mN' --output curve.csv
    """
    if not plot and (at is not None or plot_quantity is not None):
        raise UsageError("--at and --plot-quantity need --plot, a file of the picture")
    given, axes = scenes.first_and_varying()
    if table is not None:
        given |= _first_of_table(table, given, scenes)
    law = {name.removeprefix("layer_"): axes.pop(name) for name in list(axes) if "layer_" in name}
    with worker_processes(whole("workers", workers, 1)) as executor:
        found = sweep(
            SceneOptions(given).build().scene,
            **axes,
            layer=law or None,
            table=table,
            quantities=quantities,
            rtol=rtol,
            s=s,
            from_edge=from_edge,
            executor=executor,
            store=store,
        )
    try:
        if output is not None:
            write(found, output)
        if plot:
            held = dict(at or ())
            picture = plot_slice(found, plot_quantity or varying(found, held), held)
            plotting.save(picture, plot)
    finally:
        print(summary(found))
    if unsolved(found):
        raise NotSolved(unsolved(found))


def _first_of_table(table: str, given: Mapping[str, Any], scenes: SweptOptions) -> dict[str, Any]:
    """Return the parameters that are not given, from the first row of a table, by option.

    `sweep` takes a whole scene, and replaces its parameters by those of each row.
    """
    moduli = "youngs_modulus", "reduced_modulus"
    physical = scenes.of_materials or bool(columns_of(table, moduli, physical=True)[0])
    columns, _ = columns_of(table, physical=physical)
    first = {}
    for name, values in columns.items():
        option = f"{name}_si" if physical and f"{name}_si" in NUMBERS else name
        pressed = name in ALL_CONTROLS and not given.keys().isdisjoint(ALL_CONTROLS)
        if option not in given and not pressed:
            first[option] = float(values[0])
    return first
