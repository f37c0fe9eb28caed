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

#: Contact radii that are drawn, from this share of today's on.
_LEAST, _POINTS = 1e-3, 300


def plot_history(solution: Solution) -> Figure:
    """Plot load, total shear and approach over the contact radius, and the stick radius.

    In the last panel it is over the edge of the contact, with slip between them.

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
    b = np.clip(np.linspace(max(first, _LEAST * last), last, _POINTS), first, last)
    loads = (("$P$", history.load(b), BLUE), ("$Q$", history.total_shear(b), VERMILION))
    with style():
        figure = new_figure(figsize=(10.0, 3.4), layout="constrained")
        figure.suptitle(scene_title(solution.scene))
        forces, sinking, zones = figure.subplots(1, 3)
        for label, values, colour in loads:
            forces.plot(b, values, color=colour, label=label)
        forces.set(xlabel="contact radius [$L$]", ylabel="load, total shear [$E'L^2$]")
        forces.legend()
        sinking.plot(b, history.approach(b), color=GREEN)
        sinking.set(xlabel="contact radius [$L$]", ylabel=r"approach $\delta$ [$L$]")
        sticking = b * history.stick_radius(b)
        zones.plot(b, sticking, color=BLUE, label="stick radius")
        zones.fill_between(b, sticking, b, color=SLIP_GREY, lw=0.0, label="slip")
        zones.plot(b, b, "k-", lw=0.8)
        zones.set(xlabel="contact radius [$L$]", ylabel="radius [$L$]")
        zones.legend(loc="upper left")
        for axes in (forces, sinking, zones):
            axes.set_xlim(0.0, last)
            axes.set_ylim(0.0, None)
    return figure
