"""Options and action of ``spectral-contact cycle``."""

from __future__ import annotations

import argparse
from typing import Final

from spectral_contact.sweeps.steady_cycle import steady_cycle
from spectral_contact.view import plotting
from spectral_contact.view.cli import scene_options
from spectral_contact.view.cli.options import add_limits, number
from spectral_contact.view.cli.profile_options import any_scene

#: Suffixes of `--output`.
OUTPUTS: Final = (".npz", ".json", ".csv")


def add_options(command: argparse.ArgumentParser) -> None:
    """Add what the command takes, but for the scene."""
    group = command.add_argument_group("request")
    group.add_argument(
        "--lowest",
        type=number,
        required=True,
        metavar="SHARE",
        help="the lowest load over the largest one, which is that of the scene: between 0 and 1",
    )
    group.add_argument(
        "--rtol",
        type=number,
        default=1e-8,
        help="bound on the relative error of what is dissipated, 1e-11 to 1e-2 "
        "(default: %(default)s)",
    )
    add_limits(group)
    group.add_argument(
        "--output",
        metavar="FILE",
        help="store the cycle: .npz, .json; or slip amplitude and change of the traction over the "
        "radius: .csv",
    )
    group.add_argument(
        "--plot",
        metavar="FILE",
        help=f"plot the loop: {', '.join(plotting.FORMATS)} (needs the extra: plot)",
    )


def run(arguments: argparse.Namespace) -> str:
    """Find the loop, write the files that the options name, and return what there is to say."""
    if arguments.plot is not None:
        plotting.require()
    cycle = steady_cycle(
        any_scene(arguments),
        arguments.lowest,
        rtol=arguments.rtol,
        max_unknowns=arguments.max_unknowns,
        strict=not arguments.no_strict,
    )
    if arguments.output is not None:
        store = cycle.to_csv if arguments.output.lower().endswith(".csv") else cycle.save
        store(arguments.output)
    if arguments.plot is not None:
        plotting.save(cycle.plot(), arguments.plot)
    remarks = scene_options.defaults(arguments)  # a profile has been refused
    return "\n".join([cycle.summary(), *(f"remark: {one}" for one in remarks)])
