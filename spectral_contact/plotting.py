"""Plots of a solution; matplotlib is imported only when drawing.

Figures are made through the object interface, never through pyplot: no window, no global state.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, fields
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from spectral_contact.choices import instance
from spectral_contact.documents import path_text, replace_file, reported
from spectral_contact.errors import MissingDependencyError, NotComputedError, SolutionFileError
from spectral_contact.fields import AnnulusSeries, DiskSeries, LogSeries, ZonalField
from spectral_contact.radii import Radii, graded_radii, known_zones, layer_depth
from spectral_contact.scene import Scene
from spectral_contact.solution import ErrorEstimates, Plan, Solution

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = [
    "FORMATS",
    "Radii",
    "check",
    "graded_radii",
    "plot_coefficients",
    "plot_solution",
    "require",
    "save",
    "scene_title",
    "style",
]

Array = NDArray[np.float64]

#: Suffixes that `save` knows.
FORMATS = (".png", ".pdf", ".svg")

# Colours of Okabe and Ito: told apart by the colour-blind, and in grey by their line styles.
_BLUE, _VERMILION, _GREEN, _BLACK = "#0072B2", "#D55E00", "#009E73", "#000000"
_SLIP_GREY = "#DDDDDD"
_STYLE = {
    "font.size": 9.0,
    "axes.titlesize": 9.0,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#CCCCCC",
    "grid.linewidth": 0.4,
    "legend.frameon": False,
    "legend.borderaxespad": 0.2,
    "legend.columnspacing": 1.2,
    "lines.linewidth": 1.4,
    "svg.hashsalt": "spectral_contact",
}


def check(plan: Plan) -> None:
    """Check, before the work, that a solution of this plan can be plotted.

    Raises
    ------
    SceneError
        If it is no Plan.
    NotComputedError
        If neither pressure nor traction will be there.
    MissingDependencyError
        If matplotlib is not installed.
    """
    instance("plan", plan, Plan)
    if not {"pressure", "traction"}.intersection(plan.quantities):
        reason = dict(plan.missing)["pressure"]
        raise NotComputedError("a field to plot (pressure or traction)", reason)
    require()


def require() -> Any:
    """Return matplotlib; called before the work, which its absence would cost.

    Raises
    ------
    MissingDependencyError
        If it is not installed.
    """
    try:
        import matplotlib
    except ImportError as error:
        raise MissingDependencyError("matplotlib", "plot") from error
    return matplotlib


def plot_solution(solution: Solution) -> Figure:
    """Plot p*, q*, f p*, the slip, the zones and the error estimates of a solution.

    The left panels show the fields over the radius; where they are singular, or nearly so, at the
    edge, they are cut off, and a note says so. The right panels show them over the distance from
    the edge, on logarithmic axes.

    Parameters
    ----------
    solution : Solution
        With the pressure, the traction, or both.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    SceneError
        If it is no Solution.
    NotComputedError
        If neither pressure nor traction were asked for.
    MissingDependencyError
        If matplotlib is not installed.
    """
    instance("solution", solution, Solution)
    check(solution.plan)
    radii = graded_radii(solution, 600)
    rows = _field_rows(solution, radii)
    with style():
        from matplotlib.figure import Figure

        heights = [2.5] * len(rows) + [0.5 + 0.22 * len(_estimates(solution))]
        figure = Figure(figsize=(8.0, 0.9 + sum(heights)), layout="constrained")
        grid = figure.add_gridspec(len(heights), 2, height_ratios=heights)
        for i, (label, curves) in enumerate(rows):
            left, right = figure.add_subplot(grid[i, 0]), figure.add_subplot(grid[i, 1])
            _draw_over_radius(left, radii, curves, solution)
            _draw_over_distance(right, radii, curves, solution)
            left.set(xlabel="radius $s = r / a$", ylabel=label)
            right.set(xlabel="distance from the edge $1 - s$", ylabel=label)
        _draw_errors(figure.add_subplot(grid[-1, :]), solution)
        figure.suptitle(scene_title(solution.scene))
    return figure


def plot_coefficients(solution: Solution) -> Figure:
    """Plot the decay of the Legendre coefficients on every panel, a plot for each series.

    Parameters
    ----------
    solution : Solution

    Returns
    -------
    matplotlib.figure.Figure
        Moduli of the coefficients over their degree, dimensionless; the panels from the boundary's
        far side (dark) to the boundary (light), and the tail panel dashed.

    Raises
    ------
    SceneError
        If it is no Solution.
    NotComputedError
        If no field of the solution is a series: fields that were not asked for, that vanish, or
        that have a closed form.
    MissingDependencyError
        If matplotlib is not installed.
    """
    instance("solution", solution, Solution)
    require()
    series = [*_pressure_series(solution), *_traction_series(solution)]
    if not series:
        raise NotComputedError("a series with coefficients", _why_no_series(solution))
    with style():
        from matplotlib.figure import Figure

        columns = min(len(series), 2)
        rows = -(-len(series) // columns)
        figure = Figure(figsize=(4.6 * columns, 0.4 + 3.2 * rows), layout="constrained")
        for i, (title, one) in enumerate(series):
            _draw_coefficients(figure.add_subplot(rows, columns, i + 1), title, one)
        figure.suptitle(scene_title(solution.scene))
    return figure


def save(figure: Figure, path: str | os.PathLike[str]) -> None:
    """Write a figure; the suffix, one of ``FORMATS``, decides the format.

    Raises
    ------
    SceneError
        If it is no figure of matplotlib.
    SolutionFileError
        For another suffix, or a path that cannot be written.
    MissingDependencyError
        If matplotlib is not installed.
    """
    require()
    from matplotlib.figure import Figure

    instance("figure", figure, Figure)
    path = path_text(path)
    suffix = Path(path).suffix.lower()
    if suffix not in FORMATS:
        raise SolutionFileError(path, f"the suffix must be one of {', '.join(FORMATS)}")
    # without the date, the same figure gives the same file
    date = {".pdf": {"CreationDate": None}, ".svg": {"Date": None}}
    drawn = BytesIO()
    with style():
        figure.savefig(drawn, format=suffix[1:], dpi=150, metadata=date.get(suffix))
    with reported(path, "cannot be written"):
        replace_file(path, drawn.getvalue())


@contextmanager
def style() -> Iterator[None]:
    """Draw in the style of all figures of the library while the context lasts.

    Raises
    ------
    MissingDependencyError
        If matplotlib is not installed.
    """
    with require().rc_context(_STYLE):
        yield


def scene_title(scene: Scene) -> str:
    """Return the parameters of a scene in the symbols of the theory, as a title of a figure.

    Raises
    ------
    SceneError
        If it is no Scene.
    """
    instance("scene", scene, Scene)
    friction = rf"$f = {scene.friction:g}$" if scene.friction is not None else "no friction"
    if scene.friction == np.inf:
        friction = "full stick"
    numbers = (
        rf"$\nu = {scene.poisson_ratio:g}$",
        rf"$\alpha^* = {_power(scene.normal_compliance)}$",
        rf"$\beta^* = {_power(scene.tangential_compliance)}$",
    )
    return ",   ".join((*numbers, friction, *["coupled"] * scene.coupling))


def _power(number: float) -> str:
    """Return a number in the way of mathematics: 2.5e-07 as 2.5 · 10^-7."""
    digits, _, exponent = f"{number:g}".partition("e")
    if not exponent:
        return digits
    factor = "" if digits == "1" else rf"{digits} \cdot "
    return f"{factor}10^{{{int(exponent)}}}"


# --- fields ---------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True, eq=False)
class _Curve:
    label: str
    values: Array
    colour: str
    line: str


def _field_rows(solution: Solution, radii: Radii) -> list[tuple[str, list[_Curve]]]:
    """Return the rows of panels: the axis label and the curves of each."""
    present, friction = solution.plan.quantities, solution.scene.friction
    rows, pressure = [], None
    if "pressure" in present:
        pressure = radii.evaluate(solution.pressure)
        rows.append((r"$p^* = a^2 p / P$", [_Curve("$p^*$", pressure, _BLUE, "-")]))
    if "traction" in present and (friction is not None or not rows):
        traction = radii.evaluate(solution.traction)
        curves = [_Curve("$q^*$", traction, _VERMILION, "-")]
        if pressure is not None and friction is not None and 0.0 < friction < np.inf:
            curves.append(_Curve("$f p^*$", friction * pressure, _BLACK, "--"))
        rows.append((r"$q^* = a^2 q / P$", curves))
    if "slip" in present and any(zone.kind == "slip" for zone in known_zones(solution)):
        slip = radii.evaluate(solution.slip)
        label = r"$u_r^* = a E u_r / (4 (1 - \nu^2) P)$"
        rows.append((label, [_Curve("slip $u_r^*$", slip, _GREEN, "-")]))
    return rows


def _draw_over_radius(axes: Axes, radii: Radii, curves: list[_Curve], solution: Solution) -> None:
    for curve in curves:
        axes.plot(radii.s, curve.values, curve.line, color=curve.colour, label=curve.label)
    for zone in known_zones(solution):
        if zone.kind == "slip":
            axes.axvspan(zone.inner, zone.outer, color=_SLIP_GREY, lw=0.0, zorder=0.5)
    values = np.concatenate([curve.values for curve in curves])
    bulk = np.concatenate([curve.values[radii.from_edge >= 0.02] for curve in curves])
    # an edge much higher than the rest, or infinite, is left to the other panel
    highest = np.nanmax(values)  # with coupling there may be no limit at the edge
    cut = highest > 2.5 * bulk.max()
    top = bulk.max() if cut else highest
    if cut:
        edge = f"up to {highest:.3g}" if np.isfinite(highest) else "infinite"
        corner: dict[str, Any] = {"transform": axes.transAxes, "ha": "right", "va": "top"}
        axes.text(0.97, 0.95, f"cut off: {edge} at the edge", **corner)
    axes.set_xlim(0.0, 1.0)
    axes.set_ylim(*_from_zero(bulk.min(), top))
    axes.legend(
        handles=[*axes.get_lines(), *_zone_patches(solution)],
        loc="lower left",
        bbox_to_anchor=(0.0, 1.0),
        ncols=4,
    )


def _draw_over_distance(axes: Axes, radii: Radii, curves: list[_Curve], solution: Solution) -> None:
    depth, d = layer_depth(solution), radii.from_edge
    shown = (d > 0.0) & (d < 1.0)
    for curve in curves:
        axes.plot(d[shown], curve.values[shown], curve.line, color=curve.colour, label=curve.label)
    for zone in known_zones(solution):
        if zone.kind == "slip":
            near, far = max(zone.outer_from_edge, depth), min(zone.inner_from_edge, 1.0)
            axes.axvspan(near, far, color=_SLIP_GREY, lw=0.0, zorder=0.5)
    axes.set_xscale("log")
    axes.set_xlim(1.0, depth)  # the edge is on the right, as in the other panel
    values = np.concatenate([curve.values[shown & (d <= 0.5)] for curve in curves])
    if 0.0 < 10.0 * values.min() < values.max():
        axes.set_yscale("log")
        axes.set_ylim(values.min() / 2.0, values.max() * 2.0)
    else:
        axes.set_ylim(*_from_zero(values.min(), values.max()))


def _from_zero(low: float, high: float) -> tuple[float, float]:
    """Return limits that contain zero and the values, with a margin so that both are seen."""
    low, high = min(low, 0.0), max(high, 0.0)
    margin = 0.05 * (high - low) or 1.0
    return low - margin, high + 2.0 * margin


def _zone_patches(solution: Solution) -> list[Any]:
    from matplotlib.patches import Patch

    kinds = {zone.kind for zone in known_zones(solution)}
    return [
        Patch(facecolor=colour, edgecolor="#888888", linewidth=0.6, label=kind)
        for kind, colour in (("stick", "white"), ("slip", _SLIP_GREY))
        if kind in kinds
    ]


# --- errors ---------------------------------------------------------------------------------------


def _estimates(solution: Solution) -> list[tuple[str, float]]:
    """Return the estimates there are, in the order of a report."""
    found = [(one.name, getattr(solution.error, one.name)) for one in fields(ErrorEstimates)]
    # no digit is known from 1 on; NaN is taken for that, too
    return [
        (name.replace("_", " "), error if error < 1.0 else 1.0)
        for name, error in found
        if error is not None
    ]


def _draw_errors(axes: Axes, solution: Solution) -> None:
    estimates = _estimates(solution)
    floor = 3e-17
    marker: dict[str, Any] = {"color": _BLUE, "markersize": 5.0, "clip_on": False, "zorder": 3.0}
    for row, (name, error) in enumerate(estimates):
        said = "no digit is known" if error >= 1.0 else ""
        if error <= floor:
            said = "none" if name == "violation" else "exact"
        place, face = max(error, floor), "white" if said else _BLUE
        axes.plot([place], [row], "o", markerfacecolor=face, **marker)
        axes.annotate(said, (place, row), (8, 0), textcoords="offset points", va="center")
    axes.axvline(solution.rtol, color=_VERMILION, ls="--", lw=1.0)
    above: dict[str, Any] = {"transform": axes.get_xaxis_transform(), "ha": "center"}
    axes.text(solution.rtol, 1.02, "rtol", color=_VERMILION, **above)
    axes.set_xscale("log")
    largest = max([solution.rtol, *(error for _, error in estimates)])
    axes.set_xlim(floor, 30.0 * largest)
    axes.set_ylim(len(estimates) - 0.5, -0.5)
    axes.set_yticks(range(len(estimates)), [name for name, _ in estimates])
    axes.set_xlabel("estimate of the relative error")


# --- coefficients ---------------------------------------------------------------------------------


def _pressure_series(solution: Solution) -> list[tuple[str, LogSeries]]:
    field = solution.pressure_field
    if isinstance(field, ZonalField):
        return [
            found for one in field.pieces for found in _piece_series("$p^*$", one.field, "slip")
        ]
    if field is None or field.series is None:
        return []
    return [("$p^*$, $d = 1 - s^2$", field.series)]


def _traction_series(solution: Solution) -> list[tuple[str, LogSeries]]:
    field = solution.traction_field
    pieces = [p.field for p in field.pieces] if isinstance(field, ZonalField) else [field]
    # a series without the factor s is a pressure: that is friction times it, in slip
    stuck = [one for one in pieces if not isinstance(one, AnnulusSeries) or one.power == 1]
    return [found for one in stuck for found in _piece_series("$q^*$", one, "a stick annulus")]


def _piece_series(name: str, piece: object, annulus: str) -> list[tuple[str, LogSeries]]:
    if isinstance(piece, DiskSeries) and piece.series is not None:
        c = piece.outer.value
        place = "$d = 1 - s^2$" if c == 1.0 else rf"$d = 1 - s^2/c^2$, $c = {c:.4g}$"
        return [(f"{name} in stick, {place}", piece.series)]
    if isinstance(piece, AnnulusSeries):
        ends = (piece.inner.value, piece.toward_inner), (piece.outer.value, piece.toward_outer)
        return [(f"{name} in {annulus}, toward $s = {end:.4g}$", one) for end, one in ends]
    return []


def _why_no_series(solution: Solution) -> str:
    missing = dict(solution.plan.missing)
    if "pressure" not in missing:
        return "the surface is smooth, its pressure a closed form"
    if "traction" not in missing:
        return "the traction is zero or a closed form, and the pressure was not asked for"
    return missing["pressure"]


def _draw_coefficients(axes: Axes, title: str, series: LogSeries) -> None:
    from matplotlib import colormaps
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize
    from matplotlib.ticker import MaxNLocator

    count = len(series.coefficients)
    scale = ScalarMappable(Normalize(0.0, count * series.width), colormaps["viridis"])
    colours = scale.to_rgba(series.width * (np.arange(count) + 0.5))
    for panel, coefficients in enumerate(np.abs(series.coefficients)):
        degree = np.flatnonzero(coefficients)
        axes.plot(degree, coefficients[degree], ".-", color=colours[panel], lw=0.9, ms=3.5)
    tail = np.abs(series.tail)
    degree = np.flatnonzero(tail)
    axes.plot(degree, tail[degree], "s--", color=_VERMILION, lw=0.9, ms=3.5, label="tail")
    axes.set_yscale("log")
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.set(title=title, xlabel="degree $k$", ylabel="Legendre coefficient $|c_k|$")
    axes.legend(loc="upper right")
    axes.figure.colorbar(scale, ax=axes, label=r"panel at $-\ln d$")
