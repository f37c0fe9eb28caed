"""Plot of the decay of a solution's Legendre coefficients."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from spectral_contact.errors import NotComputedError
from spectral_contact.fields.series import AnnulusSeries, DiskSeries, LogSeries, ZonalField
from spectral_contact.io.choices import instance
from spectral_contact.solution import Solution
from spectral_contact.view.figures import VERMILION, new_figure, require, scene_title, style
from spectral_contact.view.radii import known_zones

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def plot_coefficients(solution: Solution) -> Figure:
    """Plot the decay of the Legendre coefficients on every panel, a plot for each series.

    Parameters
    ----------
    solution : Solution

    Returns
    -------
    matplotlib.figure.Figure
        Moduli of the coefficients over their degree, dimensionless, a curve for each panel. Panels
        far from the boundary at d = 0 are dark, those next to it light; the tail at the boundary is
        dashed.

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
        columns = min(len(series), 2)
        rows = -(-len(series) // columns)
        figure = new_figure(figsize=(4.6 * columns, 0.4 + 3.2 * rows), layout="constrained")
        for i, (title, one) in enumerate(series):
            _draw_coefficients(figure.add_subplot(rows, columns, i + 1), title, one)
        figure.suptitle(scene_title(solution.scene))
    return figure


def _pressure_series(solution: Solution) -> list[tuple[str, LogSeries]]:
    """Return the series of the pressure with their titles; none if it is a closed form."""
    field = solution.pressure_field
    if isinstance(field, ZonalField):
        # the pieces are zones with elastic coupling, else parts of the profile
        kinds = {(zone.inner, zone.outer): f" in {zone.kind}" for zone in known_zones(solution)}
        series = []
        inner = 0.0
        for piece in field.pieces:
            where = kinds.get((inner, piece.outer.value), "")
            series += _piece_series("$p^*$", piece.field, where, where)
            inner = piece.outer.value
        return series
    if field is None or field.series is None:
        return []
    return [("$p^*$, $d = 1 - s^2$", field.series)]


def _traction_series(solution: Solution) -> list[tuple[str, LogSeries]]:
    """Return the series of the traction in stick zones with their titles."""
    field = solution.traction_field
    pieces = [p.field for p in field.pieces] if isinstance(field, ZonalField) else [field]
    # in slip the traction is f times the pressure, whose series have no factor s: power is 0
    stuck = [one for one in pieces if not isinstance(one, AnnulusSeries) or one.power == 1]
    return [
        found
        for one in stuck
        for found in _piece_series("$q^*$", one, " in stick", " in a stick annulus")
    ]


def _piece_series(
    name: str, piece: object, of_disk: str, of_annulus: str
) -> list[tuple[str, LogSeries]]:
    """Return the series of a disk, or both of an annulus, with their titles.

    Parameters
    ----------
    name : str
        Symbol of the field.
    piece : object
        A closed form has no series.
    of_disk, of_annulus : str
        What a title says of a disk or an annulus, after the symbol.
    """
    if isinstance(piece, DiskSeries) and piece.series is not None:
        c = piece.outer.value
        place = "$d = 1 - s^2$" if c == 1.0 else rf"$d = 1 - s^2/c^2$, $c = {c:.4g}$"
        return [(f"{name}{of_disk}, {place}", piece.series)]
    if isinstance(piece, AnnulusSeries):
        ends = (piece.inner.value, piece.toward_inner), (piece.outer.value, piece.toward_outer)
        return [(f"{name}{of_annulus}, toward $s = {end:.4g}$", one) for end, one in ends]
    return []


def _why_no_series(solution: Solution) -> str:
    """Return why no field of a solution is a series."""
    missing = dict(solution.plan.missing)
    if "pressure" not in missing:  # it was asked for: a rough surface would have a series
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
    axes.plot(degree, tail[degree], "s--", color=VERMILION, lw=0.9, ms=3.5, label="tail")
    axes.set_yscale("log")
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.set_xlabel("degree $k$")
    axes.set_ylabel("Legendre coefficient $|c_k|$")
    axes.set_title(title)
    axes.legend(loc="upper right")
    axes.figure.colorbar(scale, ax=axes, label=r"panel at $-\ln d$")
