"""Pictures of the body: contours of a stress, and the deformed surface; matplotlib when drawing."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from spectral_contact.equations.interior import Inside
from spectral_contact.equations.interior.grids import QUANTITIES, unit_of
from spectral_contact.io import checks, choices
from spectral_contact.view.figures import BLACK, SLIP_GREY, VERMILION, new_figure, style

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_POINTS = 161
_LEVELS = 24
#: Colours end where this share of the points is; next to the edge many stresses are infinite.
_SHARE = 0.985
#: What the drawing is accurate to.
_RTOL = 1e-6
_LARGEST = {"von_mises": "von_mises", "max_shear": "max_shear"}


def plot_inside(body: Inside, quantity: str = "von_mises", *, r_max: float | None = None) -> Figure:
    """Plot the contours of a quantity in the plane of r and z, and the deformed surface above.

    The lines of equal `max_shear` are what photoelasticity shows. The place of the largest von
    Mises or shear stress is marked if there is one.

    Parameters
    ----------
    body : Inside
    quantity : str
        A column of `Inside.to_table`.
    r_max : float, optional
        How far the picture goes, in the units of the body's lengths: two radii by default.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    SceneError
        If a parameter is not one of these.
    MissingDependencyError
        If matplotlib is not installed.
    """
    choices.instance("body", body, Inside)
    choices.one_of("quantity", quantity, QUANTITIES)
    radius = body.radius
    far = (
        2.0 * radius
        if r_max is None
        else checks.positive("r_max", r_max, body.unit_names.si_length)
    )
    with style():
        figure = new_figure(figsize=(6.6, 6.8), layout="constrained")
        figure.set_layout_engine("constrained", w_pad=0.15)
        top, main = figure.subplots(2, 1, sharex=True, height_ratios=[1.0, 3.2])
        _draw_surface(top, body, far)
        _draw_contours(figure, main, body, quantity, far)
        if quantity in _LARGEST:
            _mark_largest(main, body, quantity, far)
        unit = body.unit_names.place
        main.set(xlabel=f"$r$ [{unit}]", ylabel=f"$z$ [{unit}]", aspect="equal")
        main.invert_yaxis()
    return figure


def _draw_contours(figure: Figure, axes: Axes, body: Inside, quantity: str, far: float) -> None:
    grid = np.linspace(0.0, far, _POINTS)
    values = body.to_table(*np.meshgrid(grid, grid), rtol=_RTOL)[quantity]
    shown = values[np.isfinite(values)]
    low, high = np.quantile(shown, [1.0 - _SHARE, _SHARE])
    if shown.min() >= 0.0:
        low = 0.0
    levels = np.linspace(low, high if high > low else low + 1.0, _LEVELS)
    filled = axes.contourf(grid, grid, values, levels, cmap="viridis", extend="both")
    axes.contour(grid, grid, values, levels[::2], colors="white", linewidths=0.4)
    label = f"{QUANTITIES[quantity]} [{unit_of(quantity, body.unit_names)}]"
    figure.colorbar(filled, ax=axes, label=label, format="%.3g")


def _draw_surface(axes: Axes, body: Inside, far: float) -> None:
    """Draw the deformed surface and the punch, both magnified by the axis."""
    radius = body.radius
    r = np.concatenate([np.linspace(0.0, radius, 101), np.linspace(radius, far, 101)[1:]])
    surface, length = body.surface(r, rtol=_RTOL), body.unit_names.displacement
    if body.flat:
        r_face, face = np.array([0.0, radius, radius]), surface.z[:1] + surface.gap[:1]
        face = np.append(np.repeat(face, 2), 0.0)
    else:  # only what is near the body is drawn
        face = np.where(r <= radius, surface.z + surface.gap, surface.z - surface.gap)
        near = face > -0.3 * face[0]
        r_face, face = r[near], face[near]
    axes.fill_between(r_face, np.minimum(face.min(), 0.0), face, color=SLIP_GREY, lw=0.0)
    axes.plot(r_face, face, color=BLACK, lw=1.0, label="punch")
    axes.plot(r, surface.z, color=VERMILION, label="surface")
    axes.set(ylabel=f"$u_z$ [{'1' if length.startswith('4') else length}]")
    axes.invert_yaxis()
    axes.legend(loc="lower right")


def _mark_largest(axes: Axes, body: Inside, quantity: str, far: float) -> None:
    found = body.largest(_LARGEST[quantity])
    if found.value is None:
        axes.set_title(found.remark, fontsize=8.0, wrap=True)
        return
    axes.set_title(f"largest: {found.value:.6g} ({found.remark})", fontsize=8.0)
    if found.r <= far and found.z <= far:
        axes.plot([found.r], [found.z], "x", color=VERMILION, ms=7.0, clip_on=False)
