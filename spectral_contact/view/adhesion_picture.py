"""Picture of the cycle of an adhesive contact: load against approach."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from spectral_contact.fields import Array
from spectral_contact.fields.cycle import AdhesionCycle, CycleState
from spectral_contact.io.choices import instance
from spectral_contact.view.figures import BLACK, BLUE, VERMILION, new_figure, scene_title, style

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Mask = NDArray[np.bool_]

#: Length of the arrow of a jump that ends in no state, as a share of the axis; chosen.
_ARROW = 0.1


def plot_adhesion_cycle(cycle: AdhesionCycle) -> Figure:
    """Draw load against approach: stable and unstable states, and the jumps in and out of contact.

    Parameters
    ----------
    cycle : AdhesionCycle
        With loads in E'L² and lengths in L, or in SI units, as `AdhesionCycle.in_si` returns it.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    SceneError
        If it is something else.
    MissingDependencyError
        If matplotlib is not installed.
    """
    instance("cycle", cycle, AdhesionCycle)
    with style():
        figure = new_figure(figsize=(6.4, 4.4), layout="constrained")
        axes: Axes = figure.subplots()
        stable: Mask = np.asarray(cycle.stable, dtype=bool)
        for kind, name, line in ((stable, "stable", "-"), (~stable, "not stable", "--")):
            approach, load = _shown(cycle.approach, kind), _shown(cycle.load, kind)
            axes.plot(approach, load, line, color=BLUE, label=name)
        _draw_jump(axes, cycle.jump_in, VERMILION, "jump into contact")
        for k in range(0, len(cycle.jump_out), 2):
            _draw_jump(axes, cycle.jump_out[k : k + 2], BLACK, "jump out of contact" * (k == 0))
        axes.axhline(0.0, color=BLACK, linewidth=0.6)
        length = "L" if cycle.scene.physical is None else "m"
        force = "N" if cycle.si_units else f"$E'$ {length}²"
        axes.set_xlabel(rf"approach $\delta$ [{length}]")
        axes.set_ylabel(f"load $P$ [{force}]")
        axes.legend(frameon=False)
        figure.suptitle(f"{scene_title(cycle.scene)},   control of the {cycle.control}")
    return figure


def _shown(values: Array, kind: Mask) -> Array:
    """Return the values of a kind and the first one after each run of them, and NaN elsewhere.

    So the curves of both kinds meet.
    """
    near = kind.copy()
    near[1:] |= kind[:-1] & ~kind[1:]
    return np.where(near, values, np.nan)


def _draw_jump(axes: Axes, states: tuple[CycleState, ...], colour: str, name: str) -> None:
    """Draw an arrow between two states, or from a single state to smaller approaches."""
    begin = states[0]
    end = states[-1]
    place = end.approach, end.load
    if len(states) == 1:
        low, high = axes.get_xlim()
        place = begin.approach - _ARROW * (high - low), begin.load
    arrow = {"arrowstyle": "->", "color": colour, "linestyle": ":", "linewidth": 1.6}
    axes.annotate("", place, (begin.approach, begin.load), arrowprops=arrow)
    axes.plot([begin.approach], [begin.load], "o", color=colour, markersize=4, label=name or None)
