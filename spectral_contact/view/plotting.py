"""Plots of a solution; matplotlib is imported only when drawing.

Figures are made through the object interface, never through pyplot: no window, no global state.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

import numpy as np

from spectral_contact.errors import NotComputedError
from spectral_contact.fields import Array
from spectral_contact.io.choices import instance
from spectral_contact.solution import ErrorEstimates, Plan, Solution
from spectral_contact.view.adhesion_picture import plot_adhesion_cycle
from spectral_contact.view.coefficients import plot_coefficients
from spectral_contact.view.figures import (
    BLACK,
    BLUE,
    FORMATS,
    GREEN,
    SLIP_GREY,
    STICK_WHITE,
    VERMILION,
    ZONE_EDGE,
    math_number,
    new_figure,
    require,
    save,
    scene_title,
    style,
)
from spectral_contact.view.fits import plot_fit
from spectral_contact.view.history_picture import plot_history
from spectral_contact.view.inside_pictures import plot_inside
from spectral_contact.view.law_picture import plot_law
from spectral_contact.view.radii import (
    Radii,
    bulk_limits,
    from_zero,
    graded_radii,
    known_radius,
    known_zones,
    layer_depth,
)
from spectral_contact.view.report import if_known

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = [
    "FORMATS",
    "Radii",
    "check",
    "graded_radii",
    "plot_adhesion_cycle",
    "plot_coefficients",
    "plot_fit",
    "plot_history",
    "plot_inside",
    "plot_law",
    "plot_solution",
    "require",
    "save",
    "scene_title",
    "style",
]


#: Prefixes of units by their powers of ten.
_PREFIXES = {-9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G"}


def check(plan: Plan) -> None:
    """Check, before anything is solved, that a solution of this plan can be plotted.

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


def plot_solution(solution: Solution) -> Figure:
    """Plot p*, q*, f p*, the slip, the zones and the error estimates of a solution.

    The axes of a scene with SI data are in SI units: p, q and f p over r. There are two exceptions,
    in which these units are not known and axes are dimensionless: a flat punch of given approach,
    if the quantity `approach` was not asked for; and a profile, if the contact radius is neither
    given nor asked for.

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
    units = _AxisUnits.of(solution)
    rows = _field_rows(solution, radii, units)
    with style():
        heights = [2.5] * len(rows) + [0.5 + 0.22 * len(_estimates(solution))]
        figure = new_figure(figsize=(8.0, 0.9 + sum(heights)), layout="constrained")
        grid = figure.add_gridspec(len(heights), 2, height_ratios=heights)
        for i, (label, curves) in enumerate(rows):
            left, right = figure.add_subplot(grid[i, 0]), figure.add_subplot(grid[i, 1])
            _draw_over_radius(left, radii, curves, solution, units)
            _draw_over_distance(right, radii, curves, solution, units)
            left.set(xlabel=units.over_radius, ylabel=label)
            right.set(xlabel=units.over_distance, ylabel=label)
        _draw_errors(figure.add_subplot(grid[-1, :]), solution)
        figure.suptitle("\n".join([scene_title(solution.scene), *units.title]))
    return figure


# --- fields ---------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True, eq=False)
class _Curve:
    """Values over the radii, and how they are drawn."""

    label: str
    values: Array
    colour: str
    line: str


@dataclass(frozen=True, slots=True)
class _AxisUnits:
    """Units of the axes.

    Attributes
    ----------
    length, stress, slip : float
        What dimensionless radii, stresses and slips are multiplied by.
    length_unit, stress_unit, slip_unit : str
        Names of the units. They are empty where an axis is dimensionless; its label then has the
        symbol of docs/theory.
    title : tuple of str
        Lines of the title about profile and SI data.
    """

    length: float
    stress: float
    slip: float = 1.0
    length_unit: str = ""
    stress_unit: str = ""
    slip_unit: str = ""
    title: tuple[str, ...] = ()

    @classmethod
    def of(cls, solution: Solution) -> _AxisUnits:
        """Return the units of the scene; dimensionless if load or contact radius is not known."""
        profile = solution.scene.profile
        data = solution.scene.physical
        domain_radius = None if profile is None else known_radius(solution)
        radius_given = solution.scene.contact_radius is not None
        has_edge = profile is None or radius_given or "contact_radius" in solution.values
        # R is the radius of the domain of a layer law without an edge
        symbol = "a" if has_edge else "R"
        if profile is not None and (data is None or domain_radius is None):
            layer = solution.scene.layer
            shown = [profile.brief, *([] if layer is None else [layer.brief])]
            if domain_radius is not None:
                shown.append(rf"${symbol} = {math_number(domain_radius)}\,L$")
            title = (",   ".join(shown),)
            return cls(1.0, 1.0, stress_unit="$E'$", slip_unit="$L$", title=title)
        if data is None:
            return cls(1.0, 1.0)
        # under a flat punch the unit of stress has the load in it
        if not (profile or data.load or "approach" in solution.plan.quantities):
            return cls(1.0, 1.0)
        physical = solution.physical
        scales = physical.units
        slip_scale = scales.displacement if profile is None else 1.0
        length_power = _prefix_power(scales.length)
        stress_power = _prefix_power(scales.stress)
        slip_power = _prefix_power(slip_scale)
        moduli = {
            "E": data.youngs_modulus,
            "E_2": data.punch_youngs_modulus,
            "E^*": data.reduced_modulus,
        }
        moduli_text = ",   ".join(
            rf"${name} = {math_number(one)}$ Pa" for name, one in moduli.items() if one is not None
        )
        radius = rf"${symbol} = {math_number(physical.radius)}$ m"
        shown = [one.brief for one in (profile, data.layer) if one is not None]
        load, _ = if_known(lambda: physical.load)
        load_text = [] if load is None else [rf"$P = {math_number(load)}$ N"]
        return cls(
            scales.length / 10.0**length_power,
            scales.stress / 10.0**stress_power,
            slip_scale / 10.0**slip_power,
            f"{_PREFIXES[length_power]}m",
            f"{_PREFIXES[stress_power]}Pa",
            f"{_PREFIXES[slip_power]}m",
            (",   ".join([*shown, moduli_text, radius, *load_text]),),
        )

    @property
    def over_radius(self) -> str:
        """The label of an axis of radii."""
        return f"radius $r$ [{self.length_unit}]" if self.length_unit else "radius $s = r / a$"

    @property
    def over_distance(self) -> str:
        """The label of an axis of distances from the edge."""
        if self.length_unit:
            return f"distance from the edge $a - r$ [{self.length_unit}]"
        return "distance from the edge $1 - s$"

    @property
    def slip_symbol(self) -> str:
        """The symbol of the slip."""
        return "$u_r$" if self.slip_unit else "$u_r^*$"

    @property
    def slip_axis(self) -> str:
        """The label of an axis of slip."""
        if self.slip_unit:
            return f"$u_r$ [{self.slip_unit}]"
        return r"$u_r^* = a E u_r / (4 (1 - \nu^2) P)$"

    def symbol(self, name: str) -> str:
        """Return the symbol of a stress, with a star where it is dimensionless."""
        return f"${name}$" if self.stress_unit else f"${name}^*$"

    def axis(self, name: str) -> str:
        """Return the label of an axis of stress."""
        return (
            f"${name}$ [{self.stress_unit}]" if self.stress_unit else f"${name}^* = a^2 {name} / P$"
        )


def _prefix_power(scale: float) -> int:
    """Return the power of ten of the prefix with which a scale is in [1, 1000), or nearest."""
    power = 3 * math.floor(math.log10(scale) / 3.0)
    return min(max(power, min(_PREFIXES)), max(_PREFIXES))


def _field_rows(
    solution: Solution, radii: Radii, units: _AxisUnits
) -> list[tuple[str, list[_Curve]]]:
    """Return the rows of panels: the axis label and the curves of each."""
    present, friction = solution.plan.quantities, solution.scene.friction
    rows = []
    pressure = None
    if "pressure" in present:
        pressure = units.stress * radii.evaluate(solution.pressure)
        curves = [_Curve(units.symbol("p"), pressure, BLUE, "-")]
        rows.append((units.axis("p"), curves))
    if "traction" in present and (friction is not None or not rows):
        traction = units.stress * radii.evaluate(solution.traction)
        curves = [_Curve(units.symbol("q"), traction, VERMILION, "-")]
        if pressure is not None and friction is not None and 0.0 < friction < np.inf:
            # between bodies of negative kappa the traction is negative, and so is its bound
            negative = (solution.scene.mismatch or 0.0) < 0.0
            bound = -friction if negative else friction
            name = units.symbol("-f p" if negative else "f p")
            curves.append(_Curve(name, bound * pressure, BLACK, "--"))
        rows.append((units.axis("q"), curves))
    if "slip" in present and any(zone.kind == "slip" for zone in known_zones(solution)):
        slip = units.slip * radii.evaluate(solution.slip)
        rows.append((units.slip_axis, [_Curve(f"slip {units.slip_symbol}", slip, GREEN, "-")]))
    return rows


def _draw_over_radius(
    axes: Axes, radii: Radii, curves: list[_Curve], solution: Solution, units: _AxisUnits
) -> None:
    """Draw curves over the radius, slip zones in grey; a peak at the edge is cut off and noted."""
    a = units.length
    for curve in curves:
        axes.plot(a * radii.s, curve.values, curve.line, color=curve.colour, label=curve.label)
    for zone in known_zones(solution):
        if zone.kind == "slip":
            axes.axvspan(a * zone.inner, a * zone.outer, color=SLIP_GREY, lw=0.0, zorder=0.5)
    # values next to the edge that are much larger than the rest are shown in the other panel
    limits = bulk_limits(radii, [curve.values for curve in curves])
    values = np.concatenate([curve.values for curve in curves])
    places = np.tile(radii.s, len(curves))
    # with coupling there may be no limit at the edge, which is NaN
    peaks = (np.nanargmin(values), 0.05, "bottom"), (np.nanargmax(values), 0.95, "top")
    for at, height, side in peaks:
        if not limits[0] <= values[at] <= limits[1]:
            corner: dict[str, Any] = {"transform": axes.transAxes, "ha": "right", "va": side}
            axes.text(0.97, height, f"cut off: {_peak_text(values[at], places[at])}", **corner)
    axes.set_xlim(0.0, a)
    axes.set_ylim(*limits)
    axes.legend(
        handles=[*axes.get_lines(), *_zone_patches(solution)],
        loc="lower left",
        bbox_to_anchor=(0.0, 1.0),
        ncols=4,
    )


def _peak_text(value: float, place: float) -> str:
    """Return the value of a curve that is cut off, and where it has it."""
    peak = "infinite" if math.isinf(value) else f"{'up' if value > 0.0 else 'down'} to {value:.3g}"
    return f"{peak} at {'the edge' if place == 1.0 else f'$s$ = {place:.3g}'}"


def _draw_over_distance(
    axes: Axes, radii: Radii, curves: list[_Curve], solution: Solution, units: _AxisUnits
) -> None:
    """Draw curves over the distance from the edge, on a logarithmic axis."""
    depth = layer_depth(solution)
    d = radii.from_edge
    a = units.length
    shown = (d > 0.0) & (d < 1.0)
    for curve in curves:
        axes.plot(
            a * d[shown], curve.values[shown], curve.line, color=curve.colour, label=curve.label
        )
    for zone in known_zones(solution):
        if zone.kind == "slip":
            near, far = max(zone.outer_from_edge, depth), min(zone.inner_from_edge, 1.0)
            axes.axvspan(a * near, a * far, color=SLIP_GREY, lw=0.0, zorder=0.5)
    axes.set_xscale("log")
    axes.set_xlim(a, a * depth)  # the edge is on the right, as in the other panel
    values = np.concatenate([curve.values[shown & (d <= 0.5)] for curve in curves])
    if 0.0 < 10.0 * values.min() < values.max():
        axes.set_yscale("log")
        axes.set_ylim(values.min() / 2.0, values.max() * 2.0)
    else:
        axes.set_ylim(*from_zero(values.min(), values.max()))


def _zone_patches(solution: Solution) -> list[Any]:
    from matplotlib.patches import Patch

    kinds = {zone.kind for zone in known_zones(solution)}
    return [
        Patch(facecolor=colour, edgecolor=ZONE_EDGE, linewidth=0.6, label=kind)
        for kind, colour in (("stick", STICK_WHITE), ("slip", SLIP_GREY))
        if kind in kinds
    ]


# --- errors ---------------------------------------------------------------------------------------


def _estimates(solution: Solution) -> list[tuple[str, float]]:
    """Return the names and values of all error estimates; values above 1 are replaced by 1."""
    found = [(one.name, getattr(solution.error, one.name)) for one in fields(ErrorEstimates)]
    # an estimate of 1 or more, or NaN, says that no digit is known
    return [
        (name.replace("_", " "), error if error < 1.0 else 1.0)
        for name, error in found
        if error is not None
    ]


def _draw_errors(axes: Axes, solution: Solution) -> None:
    """Draw the error estimates, a row for each, and the tolerance as a line."""
    estimates = _estimates(solution)
    floor = 3e-17  # an error of 0 is drawn here, below all others
    marker: dict[str, Any] = {"color": BLUE, "markersize": 5.0, "clip_on": False, "zorder": 3.0}
    for row, (name, error) in enumerate(estimates):
        text = "no digit is known" if error >= 1.0 else ""
        if error <= floor:
            text = "none" if name == "violation" else "exact"
        place = max(error, floor)
        face = "white" if text else BLUE
        axes.plot([place], [row], "o", markerfacecolor=face, **marker)
        axes.annotate(text, (place, row), (8, 0), textcoords="offset points", va="center")
    axes.axvline(solution.rtol, color=VERMILION, ls="--", lw=1.0)
    above: dict[str, Any] = {"transform": axes.get_xaxis_transform(), "ha": "center"}
    axes.text(solution.rtol, 1.02, "rtol", color=VERMILION, **above)
    axes.set_xscale("log")
    largest = max([solution.rtol, *(error for _, error in estimates)])
    axes.set_xlim(floor, 30.0 * largest)
    axes.set_ylim(len(estimates) - 0.5, -0.5)
    axes.set_yticks(range(len(estimates)), [name for name, _ in estimates])
    axes.set_xlabel("estimate of the relative error")
