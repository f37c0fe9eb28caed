"""Pictures in the paper's layout, readable in grey; matplotlib is imported when drawing."""

from __future__ import annotations

from collections.abc import Iterator
from math import inf
from typing import TYPE_CHECKING, Any

import numpy as np
from paper_tables import FigureData

from spectral_contact.fields import Array
from spectral_contact.view.figures import new_figure, style

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

#: Dashes of the curves of one family; dots are left to full stick, as in the paper.
_DASHES: tuple[Any, ...] = (
    "-",
    (0, (7, 2)),
    (0, (4, 1.5, 1, 1.5)),
    (0, (3, 1.5)),
    (0, (9, 2, 1, 2, 1, 2)),
    (0, (14, 2)),
)
#: Pairs of compliances that the paper names.
_NAMED = (0.5, 0.2), (0.5, 0.5), (0.2, 0.5), (0.5, 1.0)


def draw(data: FigureData) -> Figure:
    """Draw a figure in the paper's layout, with a note of parameters and largest errors."""
    panels = data.figure.panels
    with style():
        width = 5.2 if len(panels) == 1 else 4.4 * len(panels)
        figure = new_figure(figsize=(width, 4.3), layout="constrained")
        axes = figure.subplots(1, len(panels), squeeze=False)[0]
        for one, panel in zip(axes, panels, strict=True):
            _draw_panel(one, data, panel)
        number = f"Figure {data.figure.name}. " if data.figure.name.isdigit() else ""
        figure.suptitle(number + data.figure.title)
        figure.supxlabel(_note(data), fontsize=7.0, x=0.02, ha="left")
    return figure


def _draw_panel(axes: Axes, data: FigureData, panel: dict[str, Any]) -> None:
    """Draw curves as paper.toml says, or what a figure has in place of them."""
    if "levels" in panel:
        _draw_onset(axes, data, panel)
    elif "by" in panel:
        _draw_curves(axes, data, panel)
    else:
        _draw_edge_ratios(axes, data)
    axes.set(**panel["axes"])
    axes.set_title(panel.get("title", ""), loc="left")


def _note(data: FigureData) -> str:
    errors = ", ".join(
        f"{name.replace('_', ' ')} {data.largest_error(name):.0e}" for name in data.figure.values
    )
    return (
        f"The paper's text prints: {data.figure.given}.\n"
        f"Our choice: {data.figure.chosen}.\n"
        f"Largest estimates of relative errors: {errors}."
    )


def _family(count: int) -> Iterator[dict[str, Any]]:
    """Yield the looks of the curves of a family: from dark to light, and told apart by dashes."""
    from matplotlib import colormaps

    shades = colormaps["viridis"](np.linspace(0.0, 0.8, count))
    for shade, dashes in zip(shades, _DASHES, strict=False):
        yield {"color": shade, "linestyle": dashes}


def _draw_curves(axes: Axes, data: FigureData, panel: dict[str, Any]) -> None:
    """Draw a curve for every value of a parameter; full stick is dotted."""
    if "nu" in panel:
        [data] = [part for (nu,), part in data.curves("nu") if nu == panel["nu"]]
    over, value = panel["over"], panel["value"]
    found = [(number, curve) for (number,), curve in data.curves(panel["by"])]
    finite = [one for one in found if one[0] < inf]
    for (number, curve), look in zip(finite, _family(len(finite)), strict=True):
        axes.plot(curve[over], curve[value], label=f"{panel['label']} = {number:g}", **look)
    for number, curve in found:
        if number == inf:
            axes.plot(curve[over], curve[value], ":", color="black", lw=1.8, label="full stick")
    axes.legend(handlelength=3.6, loc="lower right" if value == "stick_radius" else "upper left")
    for number, curve in found:
        if number < inf and "dots" in panel:
            x = curve[panel["dots"]][0]
            # at the largest friction everything sticks
            y = np.interp(x, curve[over], curve[value]) if over == "s" else curve[value][-1]
            axes.plot(x, y, "o", color="black", ms=3.5, zorder=3.0)


def _draw_edge_ratios(axes: Axes, data: FigureData) -> None:
    """Draw the edge ratio of each pair of compliances, and the critical friction above it."""
    curves = list(data.curves("alpha", "beta"))
    curves.sort(key=lambda one: -one[1]["edge_ratio"][0])
    for (pair, curve), look in zip(curves, _family(len(curves)), strict=True):
        nu, edge, critical = (curve[name] for name in ("nu", "edge_ratio", "critical_friction"))
        label = rf"$\alpha^* = {pair[0]:g}$, $\beta^* = {pair[1]:g}$"
        axes.plot(nu, edge, label=label, **look)
        if critical[0] > 1.02 * edge[0]:
            axes.plot(nu, critical, ":", color="black", lw=1.8, label=f"{label}, inside")
    axes.axhline(0.1, color="black", lw=0.6)
    axes.annotate("$f = 0.1$", (0.005, 0.1), (0, 2), textcoords="offset points")
    axes.legend(handlelength=3.6)


def _draw_onset(axes: Axes, data: FigureData, panel: dict[str, Any]) -> None:
    """Draw contours over both compliances, and the diagonal below which slip starts inside."""
    alpha, beta = np.unique(data["alpha"]), np.unique(data["beta"])
    kappa = (1.0 - 2.0 * data["nu"]) / (4.0 * (1.0 - data["nu"]))
    critical, edge = data["critical_friction"], data["edge_ratio"]
    inside = data["beta"] > data["alpha"]
    values = {
        "critical": critical / kappa,
        "distance": np.where(inside & (data["from_edge"] > 0.0), data["from_edge"], np.nan),
        "missed": np.where(inside & (critical > edge), 100.0 * (critical / edge - 1.0), np.nan),
    }[panel["of"]].reshape(len(alpha), len(beta))
    axes.fill_between(alpha, alpha[0], alpha, color="#DDDDDD", lw=0.0, zorder=0.5)
    axes.plot(alpha, alpha, color="black", lw=2.0)
    axes.set(**panel["axes"])
    # the values range over decades: between the points of the grid their logarithms are even
    exponents = np.log10(panel["levels"])
    look: dict[str, Any] = {"colors": "black", "linestyles": "-", "linewidths": 0.9}
    lines = axes.contour(alpha, beta, np.log10(values.T), exponents, **look)
    _whole(lines)
    axes.clabel(lines, fmt=_power_of_ten, fontsize=7.0, manual=panel["labels"])
    axes.plot(*zip(*_NAMED, strict=True), "o", color="#0072B2", ms=4.0, mec="white", mew=0.6)
    for text, (x, y) in panel.get("texts", {}).items():
        axes.text(x, y, text, transform=axes.transAxes, style="italic")


def _whole(lines: Any) -> None:
    """Leave of every contour its longest piece: beside the diagonal the grid breaks it up."""
    from matplotlib.path import Path

    def length(piece: Array) -> float:
        return float(np.sum(np.hypot(*np.diff(np.log(piece), axis=0).T)))

    found = [max(pieces, key=length, default=np.empty((0, 2))) for pieces in lines.allsegs]
    codes = [[Path.MOVETO, *[Path.LINETO] * (len(piece) - 1)][: len(piece)] for piece in found]
    lines.set_paths([Path(*one) for one in zip(found, codes, strict=True)])


def _power_of_ten(exponent: float) -> str:
    return rf"$10^{{{exponent:.0f}}}$" if exponent < -2.5 else f"{10.0**exponent:g}"
