"""Figures of studies, in the style of the figures of solutions; matplotlib is imported to draw."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from spectral_contact.io.documents import path_text
from spectral_contact.studies.fitting import Rate
from spectral_contact.studies.study_results import Convergence, Point, Study, WorkPrecision
from spectral_contact.studies.timing import Timing
from spectral_contact.view.figures import new_figure
from spectral_contact.view.plotting import save, scene_title, style

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_SYMBOLS = {
    "approach": r"approach $\delta^*$",
    "edge_pressure": "edge pressure $p^*(1)$",
    "pressure": "pressure $p^*$, worst point",
    "traction": "traction $q^*$, worst point",
    "total_shear": "total shear $Q^*$",
    "stick_radius": "stick radius $c^*$",
}
# Colours of Okabe and Ito, grey and brown; markers tell the curves apart in grey.
_COLOURS = (
    *("#000000", "#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9"),
    *("#888888", "#8C510A"),
)
_MARKERS = ("o", "s", "^", "D", "v", "P", "X", "*", "<")
_LINES = ("-", "--", "-.")
#: Doubles know no smaller error: what is below, and zero, is drawn here, and the axis says so.
_LEAST = 1e-16
_ERROR = "true relative error"


def drawn(study: Study, path: str | os.PathLike[str] | None, cold: bool = True) -> Figure:
    """Return the figure of a study, written to a file if there is a path."""
    states = ("warm", "cold") if cold else ("warm",)
    draw: Any = _convergence if isinstance(study, Convergence) else _work_precision
    figure: Figure = draw(study, states)
    if path is not None:
        save(figure, path_text(path))
    return figure


def _convergence(study: Convergence, wanted: Sequence[str]) -> Figure:
    """Return the errors over unknowns with the fitted rates, and over the times wanted.

    Full markers are points that a rate goes through, open ones are not. The time panels are there
    if there are such times.
    """
    states = [state for state in wanted if _timed(study.points, state)]
    with style():
        count = 1 + len(states)
        rows = -(-len(study.quantities) // count)
        figure = new_figure(figsize=(1.4 + 3.4 * count, 3.9 + 0.18 * rows), layout="constrained")
        axes = figure.subplots(1, count, sharey=True, squeeze=False)[0]
        for index, quantity in enumerate(study.quantities):
            _draw_rate(axes[0], study, quantity, index)
            for one, state in zip(axes[1:], states, strict=True):
                timings, errors = _series(study.points, quantity, state)
                _draw_times(one, timings, errors, index, cold=state == "cold")
        for one in axes:
            one.set_yscale("log")
        _say_clamped(axes[0], study.points, study.quantities)
        _label_unknowns(axes[0], study)
        for one, state in zip(axes[1:], states, strict=True):
            one.set(xscale="log", xlabel=f"time {state} [ms]")
        for one in axes:
            _plain_ticks(one)
        _legend(figure, axes[:1], columns=count)
        figure.suptitle(f"{study.solver}:   {scene_title(study.scene)}")
    return figure


def _work_precision(study: WorkPrecision, states: Sequence[str]) -> Figure:
    """Return the errors over times: a row for each scene, a panel for each quantity.

    Full markers are warm times, open ones cold times.
    """
    with style():
        rows, columns = len(study.scenes), len(study.quantities)
        width, height = max(1.4 + 3.0 * columns, 6.0), 0.5 + 3.2 * rows
        figure = new_figure(figsize=(width, height), layout="constrained")
        parts = figure.subfigures(rows, 1, squeeze=False)[:, 0]
        for part, scene in zip(parts, study.scenes, strict=True):
            axes = part.subplots(1, columns, sharey=True, squeeze=False)[0]
            for one, quantity in zip(axes, study.quantities, strict=True):
                for index, solver in enumerate(study.solvers):
                    points = study.of(solver, scene)
                    for state in states:
                        timings, errors = _series(points, quantity, state)
                        name = f"{solver}, {state}" if len(states) > 1 else solver
                        label = name if timings else None
                        cold = state == "cold"
                        _draw_times(one, timings, errors, index, cold=cold, label=label)
                xlabel = "time [ms]" if len(states) > 1 else f"time {states[0]} [ms]"
                one.set(xscale="log", yscale="log", xlabel=xlabel, title=_SYMBOLS[quantity])
                _plain_ticks(one)
            _say_clamped(axes[0], [p for p in study.points if p.scene == scene], study.quantities)
            axes[0].set_ylabel(_ERROR)
            part.suptitle(scene_title(scene))
        curves = len(states) * len(study.solvers)
        _legend(figure, figure.axes, columns=min(curves, columns + 1))
    return figure


def _timed(points: Sequence[Point], state: str) -> bool:
    return any(p.times is not None and getattr(p.times, state) is not None for p in points)


def _series(points: Sequence[Point], quantity: str, state: str) -> tuple[list[Timing], list[float]]:
    """Return the timings and the errors of points that have both."""
    timings, errors = [], []
    for point in points:
        taken = None if point.times is None else getattr(point.times, state)
        error = point.errors.get(quantity, np.inf)
        if taken is not None and np.isfinite(error):
            timings.append(taken)
            errors.append(max(error, _LEAST))
    return timings, errors


def _draw_rate(axes: Axes, study: Convergence, quantity: str, index: int) -> None:
    """Draw one error over the unknowns, and the line of its rate."""
    rate, colour, marker = study.rate(quantity), _colour(index), _marker(index)
    used = () if rate is None else rate.used
    found = [
        (i, point.unknowns, max(point.errors[quantity], _LEAST))
        for i, point in enumerate(study.points)
        if point.unknowns and np.isfinite(point.errors.get(quantity, np.inf))
    ]
    for i, unknowns, error in found:
        face = colour if i in used else "white"
        axes.plot([unknowns], [error], marker, color=colour, mfc=face, ms=4.5, zorder=3.0)
    label = _SYMBOLS[quantity]
    if rate is not None:
        ends = [n for i, n, _ in found if i in used]
        x = np.geomspace(min(ends), max(ends), 60)
        axes.plot(x, rate.at(x), _line(index), color=colour, lw=1.0)
        label = f"{label}: {_law(rate)}"
    axes.plot([], [], marker=marker, ls=_line(index), color=colour, lw=1.0, ms=4.5, label=label)


def _law(rate: Rate) -> str:
    """Return the law of a rate as a formula, with the interval of its number."""
    width = rate.interval[1] - rate.interval[0]
    # no more digits than the interval tells
    places = int(np.clip(np.ceil(-np.log10(max(width, 1e-3))), 0, 3))
    value, low, high = (f"{round(one, places):g}" for one in (rate.value, *rate.interval))
    number = f"{value} [{low}, {high}]"
    if rate.kind == "algebraic":
        return rf"$\sim N^{{-k}}$, $k$ = {number}"
    power = "N" if rate.kind == "geometric" else r"\sqrt{N}"
    return rf"$\sim \rho^{{-{power}}}$, $\rho$ = {number}"


def _draw_times(
    axes: Axes,
    timings: Sequence[Timing],
    errors: Sequence[float],
    index: int,
    *,
    cold: bool,
    label: str | None = None,
) -> None:
    """Draw errors over times with their quartiles.

    Cold times, of a few processes, are points without a line: it would run back and forth.
    """
    if not timings:
        return
    colour = _colour(index)
    spread = [
        [1e3 * (taken.median - taken.lower) for taken in timings],
        [1e3 * (taken.upper - taken.median) for taken in timings],
    ]
    axes.errorbar(
        [1e3 * taken.median for taken in timings],
        errors,
        xerr=spread,
        fmt=_marker(index),
        ls="" if cold else _line(index),
        color=colour,
        mfc="white" if cold else colour,
        ms=4.5,
        lw=0.8,
        elinewidth=0.5,
        label=label,
    )


def _say_clamped(axes: Axes, points: Iterable[Point], quantities: Iterable[str]) -> None:
    """End the axis where errors are drawn that are too small for it, and say so."""
    names = list(quantities)
    if any(point.errors.get(name, np.inf) < _LEAST for point in points for name in names):
        axes.set_ylim(bottom=_LEAST / 3.0)
        said = rf"$\leq 10^{{{np.log10(_LEAST):.0f}}}$, or 0"
        axes.axhline(_LEAST, color="#888888", lw=0.6)
        axes.annotate(
            said,
            (1.0, _LEAST),
            (-3, 3),
            xycoords=("axes fraction", "data"),
            textcoords="offset points",
            ha="right",
            fontsize=7.0,
        )


def _label_unknowns(axes: Axes, study: Convergence) -> None:
    """Label the axis of the unknowns; it is linear where errors fall geometrically."""
    kinds = {rate.kind for rate in study.rates.values() if rate is not None}
    if not kinds or "algebraic" in kinds:
        axes.set_xscale("log")
    axes.set(xlabel="unknowns $N$", ylabel=_ERROR)


def _plain_ticks(axes: Axes) -> None:
    """Write few and plain numbers on a logarithmic axis of less than a decade or two."""
    from matplotlib.ticker import LogLocator, MaxNLocator, NullLocator, StrMethodFormatter

    low, high = axes.get_xlim()
    if axes.get_xscale() != "log" or high > 100.0 * low:
        return
    few = MaxNLocator(4) if high < 8.0 * low else LogLocator(subs=(1.0, 2.0, 5.0))
    axes.xaxis.set_major_locator(few)
    axes.xaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
    axes.xaxis.set_minor_locator(NullLocator())


def _legend(figure: Figure, axes: Iterable[Axes], columns: int) -> None:
    """Put one legend below all panels; what has the same label in several is there once."""
    found: dict[str, Any] = {}
    for one in axes:
        handles, labels = one.get_legend_handles_labels()
        found |= dict(zip(labels, handles, strict=True))
    place: Any = "outside lower center"
    figure.legend(found.values(), found.keys(), loc=place, ncols=columns, fontsize=8.0)


def _pick(values: Sequence[str]) -> Callable[[int], str]:
    return lambda index: values[index % len(values)]


_colour, _marker, _line = _pick(_COLOURS), _pick(_MARKERS), _pick(_LINES)
