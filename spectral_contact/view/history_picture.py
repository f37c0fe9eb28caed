"""A picture of how a contact has grown."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from spectral_contact.io.choices import instance
from spectral_contact.solution import Solution
from spectral_contact.view.figures import (
    BLUE,
    GREEN,
    SLIP_GREY,
    VERMILION,
    new_figure,
    require,
    scene_title,
    style,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: Contact radii are drawn from this share of the last one on.
_LEAST = 1e-3
#: Points of a curve.
_POINTS = 300


def plot_history(solution: Solution) -> Figure:
    """Plot load, total shear and approach over the contact radius, and the stick radius.

    The third plot has the stick radius and the contact radius; the contact slips between them. In
    SI units if the scene has SI data.

    Parameters
    ----------
    solution : Solution
        Of a growing contact with friction.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    SceneError
        If it is no Solution.
    NotComputedError
        If no history was followed.
    MissingDependencyError
        If matplotlib is not installed.
    """
    instance("solution", solution, Solution)
    history = solution.history
    require()
    first, last = history.radii[[0, -1]]
    radii = np.clip(np.linspace(max(first, _LEAST * last), last, _POINTS), first, last)
    data = solution.scene.physical
    length, force, unit = "$L$", "$E'L^2$", 1.0
    if data is not None:  # lengths are in m then
        length, force = "m", "N"
        unit = data.quarter_modulus(solution.scene.poisson_ratio)
    shear = unit * history.total_shear(radii)
    curves = (("$P$", unit * history.load(radii), BLUE), ("$Q$", shear, VERMILION))
    # between bodies of negative kappa the shear is negative
    lowest = 1.05 * min(0.0, float(shear.min()))
    with style():
        figure = new_figure(figsize=(10.0, 3.4), layout="constrained")
        figure.suptitle(scene_title(solution.scene))
        forces, approach, zones = figure.subplots(1, 3)
        for label, values, colour in curves:
            forces.plot(radii, values, color=colour, label=label)
        forces.set(ylabel=f"load, total shear [{force}]")
        forces.legend()
        approach.plot(radii, history.approach(radii), color=GREEN)
        approach.set(ylabel=rf"approach $\delta$ [{length}]")
        stick_radii = radii * history.stick_radius(radii)  # which is over the contact radius
        zones.plot(radii, stick_radii, color=BLUE, label="stick radius")
        zones.fill_between(radii, stick_radii, radii, color=SLIP_GREY, lw=0.0, label="slip")
        zones.plot(radii, radii, "k-", lw=0.8)
        zones.set(ylabel=f"radius [{length}]")
        zones.legend(loc="upper left")
        for axes, low in ((forces, lowest), (approach, 0.0), (zones, 0.0)):
            axes.set_xlabel(f"contact radius [{length}]")
            axes.set_xlim(0.0, last)
            axes.set_ylim(low, None)
    return figure
