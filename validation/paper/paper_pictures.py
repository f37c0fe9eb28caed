"""Pictures in the paper's layout, readable in grey; matplotlib is imported when drawing."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from math import inf
from typing import TYPE_CHECKING, Any

import numpy as np
from paper_tables import WORDS, FigureData

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
_RADIUS = "radius $s = r / a$"
_TRACTION = r"traction $q^* = a^2 q / P$"
#: Pairs of compliances that the paper names.
_NAMED = (0.5, 0.2), (0.5, 0.5), (0.2, 0.5), (0.5, 1.0)


def draw(data: FigureData) -> Figure:
    """Draw a figure in the paper's layout, with a note of parameters and largest errors."""
    with style():
        columns = _COLUMNS.get(data.figure.name, 1)
        width = 5.2 if columns == 1 else 4.4 * columns
        figure = new_figure(figsize=(width, 4.3), layout="constrained")
        axes = [figure.add_subplot(1, columns, i + 1) for i in range(columns)]
        _DRAW[data.figure.name](axes, data)
        number = f"Figure {data.figure.name}. " if data.figure.name.isdigit() else ""
        figure.suptitle(number + data.figure.title)
        figure.supxlabel(_note(data), fontsize=7.0, x=0.02, ha="left")
    return figure


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


def _curves(
    axes: Axes, data: FigureData, by: str, over: str, value: str, label: str
) -> list[tuple[float, FigureData]]:
    """Draw a curve for every value of a parameter; full stick is dotted."""
    found = [(number, curve) for (number,), curve in data.curves(by)]
    finite = [one for one in found if one[0] < inf]
    for (number, curve), look in zip(finite, _family(len(finite)), strict=True):
        axes.plot(curve[over], curve[value], label=f"{label} = {number:g}", **look)
    for number, curve in found:
        if number == inf:
            axes.plot(curve[over], curve[value], ":", color="black", lw=1.8, label="full stick")
    axes.legend(handlelength=3.6, loc="lower right" if value == "stick_radius" else "upper left")
    return found


def _draw_2(axes: Sequence[Axes], data: FigureData) -> None:
    _curves(axes[0], data, "alpha", "s", "pressure", r"$\alpha^*$")
    axes[0].set(xlabel=_RADIUS, ylabel=r"pressure $p^* = a^2 p / P$", xlim=(0, 1), ylim=(0, 0.8))


def _draw_3(axes: Sequence[Axes], data: FigureData) -> None:
    _curves(axes[0], data, "beta", "s", "traction", r"$\beta^*$")
    axes[0].set(xlabel=_RADIUS, ylabel=_TRACTION, xlim=(0, 1), ylim=(0, 0.16))


def _draw_4(axes: Sequence[Axes], data: FigureData) -> None:
    curves = list(data.curves("alpha", "beta"))
    curves.sort(key=lambda one: -one[1]["edge_ratio"][0])
    for (pair, curve), look in zip(curves, _family(len(curves)), strict=True):
        nu, edge, critical = (curve[name] for name in ("nu", "edge_ratio", "critical_friction"))
        label = rf"$\alpha^* = {pair[0]:g}$, $\beta^* = {pair[1]:g}$"
        axes[0].plot(nu, edge, label=label, **look)
        if critical[0] > 1.02 * edge[0]:
            axes[0].plot(nu, critical, ":", color="black", lw=1.8, label=f"{label}, inside")
    axes[0].axhline(0.1, color="black", lw=0.6)
    axes[0].annotate("$f = 0.1$", (0.005, 0.1), (0, 2), textcoords="offset points")
    ylabel = "$q/p$ at the edge, full stick"
    axes[0].set(xlabel=r"Poisson's ratio $\nu$", ylabel=ylabel, xlim=(0, 0.5), ylim=(0, 0.5))
    axes[0].legend(handlelength=3.6)


def _draw_5(axes: Sequence[Axes], data: FigureData) -> None:
    for letter, one, ((nu,), part) in zip("ab", axes, data.curves("nu"), strict=True):
        found = _curves(one, part, "f", "s", "traction", "$f$")
        for number, curve in found:
            if number < inf:
                c = curve["stick_radius"][0]
                at = np.interp(c, curve["s"], curve["traction"])
                one.plot([c], [at], "o", color="black", ms=3.5, zorder=3.0)
        one.set(xlabel=_RADIUS, ylabel=_TRACTION, xlim=(0, 1), ylim=(0, 0.065))
        one.set_title(rf"({letter})  $\nu = {nu:g}$; dots: stick radius $c^*$", loc="left")


def _draw_6(axes: Sequence[Axes], data: FigureData) -> None:
    for letter, one, name, label in (
        ("a", axes[0], "stick_radius", "stick radius $c^* = c / a$"),
        ("b", axes[1], "total_shear", "total shear $Q^* = Q / P$"),
    ):
        for _, curve in _curves(one, data, "nu", "f", name, r"$\nu$"):
            # at the largest friction everything sticks
            at = curve["critical_friction"][0], curve[name][-1]
            one.plot(*at, "o", color="black", ms=3.5, zorder=3.0)
        one.set(xlabel="friction coefficient $f$", ylabel=label, xlim=(0, 0.2), ylim=(0, None))
        one.set_xticks([0.0, 0.05, 0.1, 0.15, 0.2])
        one.set_title(f"({letter})  full stick from the dots on", loc="left")


def _draw_onset(axes: Sequence[Axes], data: FigureData) -> None:
    alpha, beta = np.unique(data["alpha"]), np.unique(data["beta"])

    def grid(name: str) -> Array:
        return data[name].reshape(len(alpha), len(beta)).T

    kappa = (1.0 - 2.0 * data["nu"][0]) / (4.0 * (1.0 - data["nu"][0]))
    critical, edge = grid("critical_friction"), grid("edge_ratio")
    inside = beta[:, None] > alpha[None, :]
    distance = np.where(inside & (grid("from_edge") > 0.0), grid("from_edge"), np.nan)
    missed = np.where(inside & (critical > edge), critical / edge - 1.0, np.nan)
    fields = critical / kappa, distance, 100.0 * missed
    look: dict[str, Any] = {"colors": "black", "linestyles": "-", "linewidths": 0.9}
    for one, values, panel in zip(axes, fields, WORDS["onset"], strict=True):
        one.fill_between(alpha, alpha[0], alpha, color="#DDDDDD", lw=0.0, zorder=0.5)
        one.plot(alpha, alpha, color="black", lw=2.0)
        one.set(xscale="log", yscale="log", xlabel=r"normal compliance $\alpha^*$")
        one.set_ylabel(r"tangential compliance $\beta^*$")
        # the values range over decades: between the points of the grid their logarithms are even
        exponents = np.log10(panel["levels"])
        lines = one.contour(alpha, beta, np.log10(values), exponents, **look)
        _whole(lines)
        one.clabel(lines, fmt=_power_of_ten, fontsize=7.0, manual=panel["labels"])
        one.plot(*zip(*_NAMED, strict=True), "o", color="#0072B2", ms=4.0, mec="white", mew=0.6)
        one.set_title(panel["title"], loc="left")
    for one, place, text in (
        (axes[1], (0.04, 0.92), "starts inside"),
        (axes[1], (0.62, 0.04), "starts at the edge"),
        (axes[2], (0.55, 0.04), "dots: pairs of Section 4"),
    ):
        one.text(*place, text, transform=one.transAxes, style="italic")


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


_COLUMNS = {"5": 2, "6": 2, "onset": 3}
_DRAW: dict[str, Callable[[Sequence[Axes], FigureData], None]] = {
    "2": _draw_2,
    "3": _draw_3,
    "4": _draw_4,
    "5": _draw_5,
    "6": _draw_6,
    "onset": _draw_onset,
}
