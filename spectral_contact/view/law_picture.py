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

#: Overclosures are drawn up to this many times that of the largest pressure; chosen.
_BEYOND = 1.3
#: If the law has no start, or the axis is logarithmic, pressures are drawn down to this share of
#: the largest one; chosen.
_LEAST = 1e-4
#: Points of the curve.
_POINTS = 400
#: Most characters of a line of the title.
_TITLE_WIDTH = 90


class _DrawnLaw(NamedTuple):
    """What is drawn of a law and of the pressures of a contact.

    Attributes
    ----------
    w, p : ndarray
        Overclosures and pressures of the law.
    largest, mean : float
        The largest pressure of the contact, and the mean.
    slope : float
        dp/dw at the mean pressure.
    start : float
        Overclosure at which the pressure begins; -inf for a law that has a pressure everywhere.
    """

    w: Array
    p: Array
    largest: float
    mean: float
    slope: float
    start: float


def plot_law(solution: Solution) -> Figure:
    """Plot the law of a nonlinear layer, and mark the pressures that the contact makes use of.

    Pressures up to the largest are shaded. The tangent and the secant at the mean pressure are
    drawn: a linear layer that is taken in place of the law may have the slope of either. Where the
    contact has no edge, the mean over the domain is weighted by the pressure. In SI units if the
    scene has SI data.

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
    layer = solution.scene.layer
    data = solution.scene.physical
    if layer is None:
        raise NotComputedError("a law to plot", "the scene has no nonlinear layer")
    unit = 1.0 if data is None else data.quarter_modulus(solution.scene.poisson_ratio)
    drawn = _drawn_law(solution, unit)
    require()
    named = layer if data is None else data.layer
    with style():
        figure = new_figure(figsize=(8.0, 3.4), layout="constrained")
        for k, scale in enumerate(("linear", "log")):
            axes = figure.add_subplot(1, 2, k + 1)
            _draw(axes, drawn, logarithmic=scale == "log")
            length, stress = ("L", "E'") if data is None else ("m", "Pa")
            axes.set(xlabel=f"overclosure $w$ [{length}]", ylabel=f"pressure $p$ [{stress}]")
        figure.axes[0].legend(loc="upper left")
        figure.suptitle(fill(named.brief, _TITLE_WIDTH), fontsize="medium")
    return figure


def _drawn_law(solution: Solution, unit: float) -> _DrawnLaw:
    """Return what is drawn; `unit` is E' in the unit of pressures that are drawn."""
    layer = solution.scene.layer
    assert layer is not None
    radii = graded_radii(solution)
    values = solution.pressure(radii.s)
    largest = float(np.max(values))
    mean = solution.load / (pi * solution.domain_radius**2)
    if isinf(layer.start):  # there is no edge, within which the mean could be taken
        weight = radii.s * values
        mean = float(trapezoid(weight * values, radii.s) / trapezoid(weight, radii.s))
    first = layer.start if not isinf(layer.start) else layer.overclosure(_LEAST * largest)
    last = layer.overclosure(largest)
    last = min(last + (_BEYOND - 1.0) * (last - first), layer.limit)
    w = np.linspace(first, last, _POINTS)
    p = unit * layer.pressure(w)
    slope = unit * layer.stiffness(layer.overclosure(mean))
    return _DrawnLaw(w, p, unit * largest, unit * mean, slope, layer.start)


def _draw(axes: Axes, law: _DrawnLaw, *, logarithmic: bool) -> None:
    """Draw the law, the pressures of the contact, and the lines at the mean pressure."""
    positive = law.p > 0.0
    axes.plot(law.w[positive], law.p[positive], color=BLUE, label="law")
    least = _LEAST * law.largest
    axes.axhspan(least if logarithmic else 0.0, law.largest, color=SLIP_GREY, lw=0.0, zorder=0.5)
    at_mean = float(np.interp(law.mean, law.p, law.w))
    line: dict[str, Any] = {"color": VERMILION, "lw": 1.0}
    tangent = law.mean + law.slope * (law.w - at_mean)
    axes.plot(law.w[tangent > 0.0], tangent[tangent > 0.0], "-.", label="tangent", **line)
    if not isinf(law.start):
        secant = law.mean * (law.w - law.start) / (at_mean - law.start)
        axes.plot(law.w[secant > 0.0], secant[secant > 0.0], ":", label="secant", **line)
    axes.plot([at_mean], [law.mean], "o", color=BLACK, markersize=4.0, label="mean pressure")
    if logarithmic:
        axes.set_yscale("log")
        axes.set_ylim(least, float(law.p[-1]))
    else:
        axes.set_ylim(0.0, float(law.p[-1]))
    axes.margins(x=0.0)
