"""A picture of a layer's law, with the pressures that a contact makes use of."""

from __future__ import annotations

from math import isinf, pi
from textwrap import fill
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from scipy.integrate import trapezoid

from spectral_contact.errors import NotComputedError
from spectral_contact.fields import Array
from spectral_contact.io.choices import instance
from spectral_contact.solution import Solution
from spectral_contact.view.figures import (
    BLACK,
    BLUE,
    SLIP_GREY,
    VERMILION,
    new_figure,
    require,
    style,
)
from spectral_contact.view.radii import graded_radii

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

#: How far beyond the largest pressure the law is drawn, and how far down without a start.
_BEYOND, _LEAST = 1.3, 1e-4
_POINTS = 400
#: Letters of a line of the title.
_WIDE = 90


class _Used(NamedTuple):
    """What of a law is drawn: its curve, the largest pressure and the mean."""

    w: Array
    p: Array
    largest: float
    mean: float
    slope: float
    start: float


def plot_law(solution: Solution) -> Figure:
    """Plot the law of a nonlinear layer, and mark the pressures that the contact makes use of.

    They are shaded, up to the largest. At the mean pressure the tangent and the secant are drawn
    that a linear layer in the place of the law may have. Where the contact has no edge the mean is
    that over the load. In SI units if the scene has SI data.

    Parameters
    ----------
    solution : Solution
        Of a scene with a layer, with the pressure and the load.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    SceneError
        If it is no Solution.
    NotComputedError
        If there is no layer, or the pressure or the load was not asked for.
    MissingDependencyError
        If matplotlib is not installed.
    """
    instance("solution", solution, Solution)
    layer, data = solution.scene.layer, solution.scene.physical
    if layer is None:
        raise NotComputedError("a law to plot", "the scene has no nonlinear layer")
    unit = 1.0 if data is None else data.quarter_modulus(solution.scene.poisson_ratio)
    used = _used(solution, unit)
    require()
    named = layer if data is None else data.layer
    with style():
        figure = new_figure(figsize=(8.0, 3.4), layout="constrained")
        for k, scale in enumerate(("linear", "log")):
            axes = figure.add_subplot(1, 2, k + 1)
            _draw(axes, used, logarithmic=scale == "log")
            length, stress = ("L", "E'") if data is None else ("m", "Pa")
            axes.set(xlabel=f"overclosure $w$ [{length}]", ylabel=f"pressure $p$ [{stress}]")
        figure.axes[0].legend(loc="upper left")
        figure.suptitle(fill(named.brief, _WIDE), fontsize="medium")
    return figure


def _used(solution: Solution, unit: float) -> _Used:
    """Return what is drawn, pressures in a unit of them over E'."""
    layer, radii = solution.scene.layer, graded_radii(solution)
    assert layer is not None
    values = solution.pressure(radii.s)
    largest = float(np.max(values))
    mean = solution.load / (pi * solution.domain_radius**2)
    if isinf(layer.start):  # over what bears the load: the domain ends at no edge
        weight = radii.s * values
        mean = float(trapezoid(weight * values, radii.s) / trapezoid(weight, radii.s))
    first = layer.start if not isinf(layer.start) else layer.overclosure(_LEAST * largest)
    last = layer.overclosure(largest)
    last = min(last + (_BEYOND - 1.0) * (last - first), layer.limit)
    w, at = np.linspace(first, last, _POINTS), layer.overclosure(mean)
    p = unit * layer.pressure(w)
    return _Used(w, p, unit * largest, unit * mean, unit * layer.stiffness(at), layer.start)


def _draw(axes: Axes, used: _Used, *, logarithmic: bool) -> None:
    """Draw the law, what is used of it, and its lines at the mean pressure."""
    positive = used.p > 0.0
    axes.plot(used.w[positive], used.p[positive], color=BLUE, label="law")
    least = _LEAST * used.largest
    axes.axhspan(least if logarithmic else 0.0, used.largest, color=SLIP_GREY, lw=0.0, zorder=0.5)
    at = float(np.interp(used.mean, used.p, used.w))
    line: dict[str, Any] = {"color": VERMILION, "lw": 1.0}
    tangent = used.mean + used.slope * (used.w - at)
    axes.plot(used.w[tangent > 0.0], tangent[tangent > 0.0], "-.", label="tangent", **line)
    if not isinf(used.start):
        secant = used.mean * (used.w - used.start) / (at - used.start)
        axes.plot(used.w[secant > 0.0], secant[secant > 0.0], ":", label="secant", **line)
    axes.plot([at], [used.mean], "o", color=BLACK, markersize=4.0, label="mean pressure")
    if logarithmic:
        axes.set_yscale("log")
        axes.set_ylim(least, float(used.p[-1]))
    else:
        axes.set_ylim(0.0, float(used.p[-1]))
    axes.margins(x=0.0)
