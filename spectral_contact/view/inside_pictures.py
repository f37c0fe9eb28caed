"""Pictures of the body: contours of a stress, and the deformed surface; matplotlib when drawing."""

from __future__ import annotations

from textwrap import fill
from typing import TYPE_CHECKING, Any

import numpy as np

from spectral_contact.equations.interior import Inside
from spectral_contact.equations.interior.grids import QUANTITIES, unit_of
from spectral_contact.io import checks, choices
from spectral_contact.view.figures import BLACK, SLIP_GREY, VERMILION, new_figure, style

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

#: Points along each axis, and levels of the contours; chosen.
_POINTS = 161
_LEVELS = 24
#: The colours cover the values between this quantile and one minus it: next to the edge many
#: stresses are infinite.
_QUANTILE = 0.985
#: Relative tolerance of what is drawn.
_RTOL = 1e-6
#: Quantities whose largest value is marked.
_MARKED = ("von_mises", "max_shear")
#: Texts of axes for units and quantities whose names in a table differ.
_UNITS = {
    "a": "$a$",
    "L": "$L$",
    "E'": "$E'$",
    "P / a^2": "$P/a^2$",
    "4 (1 - nu^2) P / (a E)": r"$4(1-\nu^2)P/(aE)$",
}
_SYMBOLS = {
    "u_r": "$u_r$",
    "u_z": "$u_z$",
    "sigma_rr": r"$\sigma_{rr}$",
    "sigma_tt": r"$\sigma_{\theta\theta}$",
    "sigma_zz": r"$\sigma_{zz}$",
    "sigma_rz": r"$\sigma_{rz}$",
    "von_mises": "von Mises stress",
    "max_shear": r"$\tau_{max}$",
    "mean": r"$\sigma_m$",
    "principal_1": r"$\sigma_1$",
    "principal_2": r"$\sigma_2$",
    "principal_3": r"$\sigma_3$",
    "displacement_error": "relative error",
    "stress_error": "relative error",
}


def plot_inside(body: Inside, quantity: str = "von_mises", *, r_max: float | None = None) -> Figure:
    """Plot the contours of a quantity in the plane of r and z, and the deformed surface above.

    Lines of equal `max_shear` are the fringes of photoelasticity. If a largest von Mises or shear
    stress is attained, a cross marks its place.

    Parameters
    ----------
    body : Inside
    quantity : str
        A column of `Inside.to_table`.
    r_max : float, optional
        Largest radius and depth shown, in the units of the body's lengths; two radii by default.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    SceneError
        If a parameter is of another type or out of its range.
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
        main.set_title(QUANTITIES[quantity])
        if quantity in _MARKED:
            _mark_largest(main, body, quantity, far)
        unit = _bracketed(body.unit_names.place)
        main.set(xlabel=f"$r${unit}", ylabel=f"$z${unit}", aspect="equal")
        main.invert_yaxis()
    return figure


def _draw_contours(figure: Figure, axes: Axes, body: Inside, quantity: str, far: float) -> None:
    """Draw a quantity over the radius and the depth, both up to `far`."""
    from matplotlib.ticker import MaxNLocator

    grid = np.linspace(0.0, far, _POINTS)
    values = body.to_table(*np.meshgrid(grid, grid), rtol=_RTOL)[quantity]
    shown = values[np.isfinite(values)]
    low, high = np.quantile(shown, [1.0 - _QUANTILE, _QUANTILE])
    if shown.min() >= 0.0:
        low = 0.0
    # round numbers, which the colour bar can be read by
    levels = MaxNLocator(_LEVELS).tick_values(low, high if high > low else low + 1.0)
    filled = axes.contourf(grid, grid, values, levels, cmap="viridis", extend="both")
    axes.contour(grid, grid, values, levels[::2], colors="white", linewidths=0.4)
    unit = _bracketed(unit_of(quantity, body.unit_names))
    figure.colorbar(filled, ax=axes, label=f"{_SYMBOLS.get(quantity, quantity)}{unit}")


def _draw_surface(axes: Axes, body: Inside, far: float) -> None:
    """Draw the deformed surface and the punch, both magnified by the axis."""
    radius = body.radius
    r = np.concatenate([np.linspace(0.0, radius, 101), np.linspace(radius, far, 101)[1:]])
    surface = body.surface(r, rtol=_RTOL)
    # in the contact the face of the punch is below the surface of the half-space, by the
    # compression of the layer; outside it is above it. Both distances are `surface.gap`
    if body.flat:
        r_face = np.array([0.0, radius, radius])
        face = np.append(np.repeat(surface.z[:1] + surface.gap[:1], 2), 0.0)
    else:  # only the part near the body is drawn
        face = np.where(r <= radius, surface.z + surface.gap, surface.z - surface.gap)
        # adhesion may lift the surface: then the whole contact is drawn, and as much above it
        lifted = face[r <= radius].min() if surface.z.min() < 0.0 else 0.0
        near = face > min(lifted, 0.0) - 0.3 * abs(face[0])
        r_face = r[near]
        face = face[near]
    axes.fill_between(r_face, np.minimum(face.min(), 0.0), face, color=SLIP_GREY, lw=0.0)
    axes.plot(r_face, face, color=BLACK, lw=1.0, label="punch")
    axes.plot(r, surface.z, color=VERMILION, label="surface")
    axes.set(ylabel=f"$u_z${_bracketed(body.unit_names.displacement)}")
    axes.invert_yaxis()
    axes.legend(loc="lower right")


def _bracketed(unit: str) -> str:
    """Return a unit as an axis has it; nothing for a pure number."""
    return "" if unit == "1" else f" [{_UNITS.get(unit, unit)}]"


def _mark_largest(axes: Axes, body: Inside, quantity: str, far: float) -> None:
    """Write the largest value of a quantity, and mark its place if that is shown."""
    found = body.largest(quantity)
    text = found.remark
    if found.value is not None:
        text = f"largest: {found.value:.6g}, {'at the cross' if found.attained else text}"
    box = {"facecolor": "white", "alpha": 0.85, "edgecolor": "none"}
    corner: dict[str, Any] = {"transform": axes.transAxes, "ha": "right", "va": "bottom"}
    axes.text(0.985, 0.015, fill(text, 50), bbox=box, fontsize=8.0, **corner)
    if found.value is None:
        return
    if found.r <= far and found.z <= far:
        axes.plot([found.r], [found.z], "x", color=VERMILION, ms=7.0, clip_on=False)
