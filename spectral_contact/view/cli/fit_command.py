"""``spectral-contact fit``: its options, and what they ask of `spectral_contact.calibration`."""

from __future__ import annotations

import argparse
import csv
from importlib.util import find_spec
from io import StringIO
from pathlib import Path
from typing import Any, Final

import numpy as np

from spectral_contact.calibration.curve_fit import fit_curve
from spectral_contact.calibration.force_curves import PARTS
from spectral_contact.calibration.indentation_curve import IndentationFit, first_modulus
from spectral_contact.calibration.indentation_data import IndentationData, read_curve
from spectral_contact.io.checks import within
from spectral_contact.io.documents import replace_file, reported
from spectral_contact.io.units import in_si
from spectral_contact.profiles.control import ALL_CONTROLS
from spectral_contact.scene import Scene
from spectral_contact.view import plotting
from spectral_contact.view.cli.files import add_reading
from spectral_contact.view.cli.layer_options import layer_given
from spectral_contact.view.cli.options import UsageError, flag, measured, number
from spectral_contact.view.cli.profile_options import profile_scene

#: Suffixes of a stored fit.
OUTPUTS: Final = (".csv",)
_MOST_EVALUATIONS: Final = 200
_FREE: Final = "reduced-modulus,zero-point"


def add_options(command: argparse.ArgumentParser) -> None:
    """Add what the command takes, but for the scene."""
    command.add_argument("file", metavar="FILE", help="text file with columns depth and load")
    group = command.add_argument_group("file of the curve")
    add_reading(group, "depth=2 [nm],load=3 [uN]")
    group.add_argument(
        "--part",
        choices=PARTS,
        help="part of the curve to fit (default: the approach, or the part that there is)",
    )
    group.add_argument(
        "--sigma",
        type=measured,
        metavar="X",
        help="standard deviation of the loads [N] (default: the column sigma, or that of the "
        "baseline)",
    )
    group = command.add_argument_group("fit")
    group.add_argument(
        "--free",
        metavar="A,B,...",
        default=_FREE,
        help="what to find (default: %(default)s): reduced-modulus, normal-compliance or the "
        "numbers of a layer's law, zero-point, load-offset, tilt, and work-of-adhesion if given",
    )
    group.add_argument(
        "--rtol", type=number, default=1e-8, help="tolerance of the solves (default: %(default)s)"
    )
    group.add_argument(
        "--output", metavar="FILE", help="store measured and fitted loads and residuals: .csv"
    )
    group.add_argument(
        "--plot",
        metavar="FILE",
        help=f"picture: {', '.join(plotting.FORMATS)}, or none (default: NAME_fit.png here, of a "
        "file NAME, if the extra plot is installed)",
    )


def choose_picture(arguments: argparse.Namespace) -> None:
    """Set which picture is drawn: the one asked for, none, or that of the file's name."""
    if arguments.plot is None and find_spec("matplotlib") is not None:
        arguments.plot = f"{Path(arguments.file).stem}_fit.png"
    elif arguments.plot is not None and arguments.plot.strip().lower() == "none":
        arguments.plot = None


def run(arguments: argparse.Namespace) -> str:
    """Fit, write the files that the options name, and return what there is to say."""
    if arguments.plot is not None:
        plotting.require()
    sigma = None if arguments.sigma is None else float(in_si("sigma", arguments.sigma, "N"))
    data = read_curve(
        arguments.file,
        IndentationData,
        part=arguments.part,
        sigma=sigma,
        columns=arguments.columns,
        header=arguments.header,
        decimal=arguments.decimal,
        invalid="skip" if arguments.skip_invalid else "missing",
        option="--columns",
    )
    free = [name.strip().replace("-", "_") for name in arguments.free.split(",")]
    rtol = within("rtol", arguments.rtol, "in [1e-12, 1e-4]")
    found = fit_curve(_scene(arguments, data), data, free, rtol, _MOST_EVALUATIONS, None)
    told = [str(found)]
    modulus = None if found.scene.physical is None else found.scene.physical.youngs_modulus
    if modulus is not None:
        ratio = found.scene.poisson_ratio
        told.append(f"Young's modulus {modulus:.5g} Pa, at a Poisson's ratio of {ratio:g}")
    if arguments.output is not None:
        with reported(arguments.output, "cannot be written"):
            replace_file(arguments.output, _rows(found).encode())
    if arguments.plot is not None:
        plotting.save(plotting.plot_fit(found), arguments.plot)
        told.append(f"picture: {arguments.plot}")
    return "\n".join(told)


def _scene(arguments: argparse.Namespace, data: IndentationData) -> Scene:
    """Return the scene of the options; a modulus that is not given is estimated."""
    given: dict[str, Any] = dict(vars(arguments))
    alien = [name for name in ALL_CONTROLS if name in given]
    if alien:
        raise UsageError(f"{flag(alien[0])}: the depths and loads are those of the file")
    if "friction" in given:
        raise UsageError("--friction: curves are fitted without friction")
    extent = float(np.ptp(data.depth))
    given["approach"] = extent if extent > 0.0 else 1.0
    if "reduced_modulus" in given or "youngs_modulus" in given:
        return profile_scene(argparse.Namespace(**given))
    if layer_given(given):
        raise UsageError("give --youngs-modulus or --reduced-modulus with a nonlinear layer")
    nu = given.get("poisson_ratio")
    if nu is None:
        given["reduced_modulus"] = 1.0
    else:
        given["youngs_modulus"] = 1.0
    scene = profile_scene(argparse.Namespace(**given))
    assert scene.profile is not None
    modulus = first_modulus(scene.profile, data)
    if nu is None:
        return scene.replace(reduced_modulus=modulus)
    return scene.replace(youngs_modulus=modulus * (1.0 - nu * nu))


def _rows(found: IndentationFit) -> str:
    text = StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["depth [m]", "load [N]", "sigma [N]", "fitted load [N]", "residual / sigma"])
    data = found.data
    columns = data.depth, data.load, data.sigma, found.loads, found.residuals
    writer.writerows(zip(*columns, strict=True))
    return text.getvalue()
