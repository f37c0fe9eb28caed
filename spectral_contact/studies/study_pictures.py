"""Figures of studies, in the style of the figures of solutions; matplotlib is imported to draw."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from spectral_contact.io.documents import path_text
from spectral_contact.studies.study_results import Convergence, Point, Study, WorkPrecision
from spectral_contact.view.figures import new_figure
from spectral_contact.view.plotting import save, scene_title, style

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_SYMBOLS: Final = {
    "approach": r"approach $\delta^*$",
    "edge_pressure": "edge pressure $p^*(1)$",
    "pressure": "pressure $p^*$, worst point",
    "traction": "traction $q^*$, worst point",
    "total_shear": "total shear $Q^*$",
    "stick_radius": "stick radius $c^*$",
}
# Colours of Okabe and Ito, grey and brown; markers tell the curves apart in grey.
_COLOURS: Final = (
    *("#000000", "#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9"),
    *("#888888", "#8C510A"),
)
_MARKERS: Final = "os^DvPX*<"
#: Errors below this, which is below the rounding of doubles, are drawn here, as zero is; the axis
#: says so.
_LEAST: Final = 1e-16


def drawn(study: Study, path: str | os.PathLike[str] | None) -> Figure:
    """Return the figure of a study, written to a file if there is a path."""
    with style():
        figure = _convergence(study) if isinstance(study, Convergence) else _work_precision(study)
    if path is not None:
        save(figure, path_text(path))
    return figure


def _convergence(study: Convergence) -> Figure:
    """Return the errors over unknowns with the fitted rates, and over the times if there are any.

    Full markers are points that a rate goes through, open ones are not.
    """
    count = 2 if any(point.times for point in study.points) else 1
    rows = -(-len(study.quantities) // count)
    figure = new_figure(figsize=(1.4 + 3.8 * count, 3.9 + 0.18 * rows), layout="constrained")
    over_unknowns, *over_times = figure.subplots(1, count, sharey=True, squeeze=False)[0]
    kinds = {rate.kind for rate in study.rates.values() if rate is not None}
    # before anything is drawn, so that a panel without data has the limits of its scale
    over_unknowns.set(xlabel="unknowns $N$", yscale="log")
    if not kinds or "algebraic" in kinds:  # else linear, on which geometric rates are lines
        over_unknowns.set_xscale("log")
    for index, quantity in enumerate(study.quantities):
        _draw_rate(over_unknowns, study, quantity, index)
        for axes in over_times:
            _draw_times(axes, study.points, quantity, index)
    _finish([over_unknowns, *over_times], study.points)
    _add_legend(figure, over_unknowns, count)
    figure.suptitle(f"{study.solver}:   {scene_title(study.scene)}")
    return figure


def _work_precision(study: WorkPrecision) -> Figure:
    """Return the errors over times: a row for each scene, a panel for each quantity."""
    rows, columns = len(study.scenes), len(study.quantities)
    size = (max(1.4 + 3.0 * columns, 6.0), 0.5 + 3.2 * rows)
    figure = new_figure(figsize=size, layout="constrained")
    parts = figure.subfigures(rows, 1, squeeze=False)[:, 0]
    for part, scene in zip(parts, study.scenes, strict=True):
        panels = part.subplots(1, columns, sharey=True, squeeze=False)[0]
        for axes, quantity in zip(panels, study.quantities, strict=True):
            for index, solver in enumerate(study.solvers):
                _draw_times(axes, study.of(solver, scene), quantity, index)
                axes.plot([], [], label=solver, **_look(index))
            axes.set_title(_SYMBOLS[quantity])
        _finish(panels, [point for point in study.points if point.scene == scene])
        part.suptitle(scene_title(scene))
    _add_legend(figure, figure.axes[0], columns + 1)
    return figure


def _look(index: int) -> dict[str, Any]:
    """Return colour, marker and line of a curve."""
    colour, marker = _COLOURS[index % len(_COLOURS)], _MARKERS[index % len(_MARKERS)]
    return {"color": colour, "marker": marker, "ms": 4.5, "lw": 1.0}


def _draw_rate(axes: Axes, study: Convergence, quantity: str, index: int) -> None:
    """Draw one error over the unknowns, and the line of its rate."""
    rate, look, label = study.rate(quantity), _look(index), _SYMBOLS[quantity]
    used = () if rate is None else rate.used
    for i, point in enumerate(study.points):
        error = point.errors.get(quantity, np.inf)
        if point.unknowns and np.isfinite(error):
            face = look["color"] if i in used else "white"
            axes.plot([point.unknowns], [max(error, _LEAST)], **look | {"mfc": face, "zorder": 3.0})
    if rate is not None:
        ends = [study.points[i].unknowns or 0 for i in used]
        x = np.geomspace(min(ends), max(ends), 60)
        axes.plot(x, rate.at(x), **look | {"marker": ""})
        label = f"{label}: {rate}"
    axes.plot([], [], label=label, **look)


def _draw_times(axes: Axes, points: Iterable[Point], quantity: str, index: int) -> None:
    """Draw errors over warm times with their quartiles."""
    axes.set(xscale="log", yscale="log", xlabel="time [ms]")
    rows = [
        (1e3 * warm.median, 1e3 * warm.lower, 1e3 * warm.upper, max(error, _LEAST))
        for point in points
        if point.times is not None and np.isfinite(error := point.errors.get(quantity, np.inf))
        for warm in [point.times.warm]
    ]
    if rows:
        middle, low, high, errors = np.transpose(rows)
        spread = [middle - low, high - middle]
        axes.errorbar(middle, errors, xerr=spread, elinewidth=0.5, **_look(index))


def _finish(panels: Sequence[Axes], points: Sequence[Point]) -> None:
    """Label panels in a row, and say where errors are drawn that are too small for the axis."""
    from matplotlib.ticker import LogLocator, NullLocator, StrMethodFormatter

    least = min((error for point in points for error in point.errors.values()), default=1.0)
    less = ",\n$10^{-16}$ where it is less" if least < _LEAST else ""
    panels[0].set_ylabel(f"true relative error{less}")
    for axes in panels:
        low, high = axes.get_xlim()
        if axes.get_xscale() == "log" and high < 100.0 * low:  # few powers of ten
            axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
            axes.xaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
            axes.xaxis.set_minor_locator(NullLocator())


def _add_legend(figure: Figure, axes: Axes, columns: int) -> None:
    place: Any = "outside lower center"
    figure.legend(*axes.get_legend_handles_labels(), loc=place, ncols=columns, fontsize=8.0)
