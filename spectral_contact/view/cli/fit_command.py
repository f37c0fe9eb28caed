"""``spectral-contact fit``."""

from __future__ import annotations

from collections.abc import Mapping
from importlib.util import find_spec
from pathlib import Path
from typing import Annotated, Any

import numpy as np

from spectral_contact import Scene, fit, plotting
from spectral_contact.calibration.force_curves import PARTS
from spectral_contact.calibration.indentation_curve import with_modulus
from spectral_contact.calibration.indentation_data import IndentationData
from spectral_contact.profiles.control import ALL_CONTROLS
from spectral_contact.view.cli import options
from spectral_contact.view.cli.files import Reading
from spectral_contact.view.cli.options import Option, UsageError, flag
from spectral_contact.view.cli.scene_options import PROFILES, SceneOptions


def run(
    scene: SceneOptions,
    reading: Reading,
    file: str,
    *,
    part: Annotated[str | None, options.chosen(*PARTS)] = None,
    sigma: Annotated[float | str | None, Option(read=options.value)] = None,
    free: str = "reduced-modulus,zero-point",
    rtol: options.Number = 1e-8,
    output: Annotated[str | None, options.written(".csv")] = None,
    plot: options.Picture | None = None,
) -> None:
    r"""Fit a measured force-indentation curve.

    Find the modulus, the layer and what the instrument adds from the depths and loads of a file
    (docs/indentation.md). The scene has the known numbers, in SI units; of the free numbers it has
    the values at which the search starts. Exit status: 0 done, 1 not converged, 2 bad input or
    file, 130 interrupted.

    Parameters
    ----------
    file : FILE
        Text file with columns depth and load.
    part : PART
        Part of the curve to fit; by default the approach, or the part that there is.
    sigma : X
        Standard deviation of the loads [N]; by default the column sigma, or that of the baseline.
    free : A,B,...
        What to find: reduced-modulus, normal-compliance or the numbers of a layer's law,
        zero-point, load-offset, tilt, and work-of-adhesion if given.
    rtol : X
        Tolerance of the solves.
    output : FILE
        Store measured and fitted loads and residuals.
    plot : FILE
        Picture, or none; by default NAME_fit.png here, of a file NAME, if the extra plot is
        installed.

    Examples
    --------
    spectral-contact fit curve.txt --profile sphere --radius "2.5 um" --poisson-ratio 0.5
    spectral-contact fit curve.csv --profile cone --half-angle "70.3 deg" \
        --columns "depth=2 [nm],load=3 [uN]" --free reduced-modulus,zero-point,load-offset,tilt
    """
    for name in (*ALL_CONTROLS, "friction"):
        if name in scene.given:
            told = "depths and loads are those of the file, and there is no friction"
            raise UsageError(f"{flag(name)} is no option of a fit: {told}")
    if "profile" not in scene.given:
        raise UsageError(f"--profile is missing: it must be one of {', '.join(PROFILES)}")
    if plot is None and find_spec("matplotlib") is not None:
        plot = options.picture(f"{Path(file).stem}_fit.png")
    data = IndentationData.from_file(file, part=part, sigma=sigma, **reading.arguments("missing"))
    found = fit(_start(scene.given, data), data, options.names(free), rtol=rtol)
    if output is not None:
        found.to_csv(output)
    if plot:
        plotting.save(plotting.plot_fit(found), plot)
    print(found, *([f"picture: {plot}"] if plot else []), sep="\n")


def _start(known: Mapping[str, Any], data: IndentationData) -> Scene:
    """Return the scene at which the fit begins; a modulus that is not given is estimated."""
    # a scene needs an approach: that of the curve, or any if the curve has no depth
    given = {**known, "approach": float(np.ptp(data.depth)) or 1.0}
    if "reduced_modulus" in given or "youngs_modulus" in given:
        return SceneOptions(given).build().scene
    if "layer" in given:
        raise UsageError("--layer needs --youngs-modulus or --reduced-modulus to begin with")
    modulus = "youngs_modulus" if "poisson_ratio" in given else "reduced_modulus"
    return with_modulus(SceneOptions({**given, modulus: 1.0}).build().scene, data)
