"""Figure of the steady loop of a load that cycles."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.interpolate import PchipInterpolator

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
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from spectral_contact.sweeps.cycle_result import SteadyCycle

#: Points of a curve, chosen.
_POINTS = 400


def plot_steady_cycle(cycle: SteadyCycle) -> Figure:
    """Draw the loop of the total shear over the load, and the slip over the radius.

    Parameters
    ----------
    cycle : SteadyCycle

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    MissingDependencyError
        If matplotlib is not installed.
    """
    require()
    with style():
        figure = new_figure(figsize=(8.4, 3.6), layout="constrained")
        left, right = figure.subplots(1, 2)
        draw_loop(left, cycle)
        _draw_slip(right, cycle)
        figure.suptitle(f"{scene_title(cycle.scene)},   load from 1 to {cycle.lowest:.4g} and back")
    return figure


def draw_loop(axes: Axes, cycle: SteadyCycle) -> None:
    """Draw total shear over load, less that of full stick.

    The shear of full stick is proportional to the load, so that both branches are steep with it.
    The area between them is the same without it.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
    cycle : SteadyCycle
    """
    full_stick_shear = cycle.states[-1].total_shear
    branches = [("reloading", cycle.reloading, BLUE, "-")]
    if cycle.unloading_dissipation is not None:
        branches.insert(0, ("unloading", cycle.unloading, VERMILION, "--"))
    load = np.linspace(cycle.lowest, 1.0, _POINTS)
    for name, branch, colour, line_style in branches:
        # the shear of a branch is counted from the largest load, 1
        beyond_stick = branch.shear + (1.0 - branch.load) * full_stick_shear
        order = np.argsort(branch.load)
        smooth = PchipInterpolator(branch.load[order], beyond_stick[order])
        axes.plot(load, smooth(load), line_style, color=colour, label=name)
    axes.set_xlabel("load over the largest load")
    axes.set_ylabel("total shear beyond full stick [$P$]")
    axes.legend()


def _draw_slip(axes: Axes, cycle: SteadyCycle) -> None:
    """Draw the slip amplitude over the radius, slip zones in grey."""
    s = np.linspace(0.0, 1.0, _POINTS)
    for zone in cycle.zones:
        if zone.kind == "slip":
            axes.axvspan(zone.inner, zone.outer, color=SLIP_GREY, linewidth=0.0)
    axes.plot(s, cycle.slip_amplitude(s), color=GREEN)
    axes.set_xlim(0.0, 1.0)
    axes.set_ylim(bottom=0.0)
    axes.set_xlabel("radius $s = r/a$")
    axes.set_ylabel(r"slip amplitude [$4(1-\nu^2)P/(aE)$]")
