"""The largest von Mises stress, shear stress and surface tension: where, or why there is none.

Places are searched in coordinates in which the edge, or another place where loads are not smooth,
is infinitely far away (`charts`): a coarse net brackets the largest values, and each bracket is
narrowed down.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from scipy.optimize import minimize, minimize_scalar

from spectral_contact.equations.interior.charts import Chart, CoordinateLine, around
from spectral_contact.equations.interior.mesh import AXIS, BodyPoints
from spectral_contact.equations.interior.places import (
    boundaries,
    distance,
    loaded_edge,
    pointed,
    singular,
)
from spectral_contact.equations.interior.results import Extreme, Stress
from spectral_contact.fields import Array
from spectral_contact.fields.series import EDGE, Radius

if TYPE_CHECKING:
    from spectral_contact.solution import Solution

#: Stress at points, to a tolerance or to all digits.
StressAt = Callable[[BodyPoints, float | None], Stress]

#: The measures of stress by name, as functions of the stress.
MEASURES: dict[str, Callable[[Stress], Array]] = {
    "von_mises": lambda stress: np.asarray(stress.von_mises),
    "max_shear": lambda stress: np.asarray(stress.max_shear),
    "surface_tension": lambda stress: np.asarray(stress.principal[0]),
}
#: Distance from the edge at which stress stands for its limit along a direction. It is refused
#: below 1e-16.
_AT_EDGE = 1e-15
#: A place that is closer than this to an infinite pressure counts as being there (chosen).
_AT_TIP = 1e-7
#: Tolerance of stress at the nodes of nets and lines (chosen).
_COARSE = 1e-8
#: A bracket is narrowed to this: on a line relative to the coordinate of its upper end, on a net in
#: the coordinates themselves.
_NARROW = 1e-9
#: No maximum is sought from nodes of a net with less than this fraction of the largest value
#: (chosen).
_FOLLOWED_FRACTION = 0.8
#: Maxima are sought from at most this many nodes of a net (chosen).
_MOST_PEAKS = 3
#: Reason for shear stress without bound inside the contact.
_AT_TIPS = "the pressure is infinite at a tip or a corner"


class _Maximum(NamedTuple):
    """A local maximum.

    Attributes
    ----------
    value : float
    at : BodyPoints
        The one point where it is.
    curvature : float
        Second derivative with the sign changed, in coordinates of the chart: a step x from the
        place lowers the value by ``curvature x**2 / 2``.
    scale : float
        Bound of the length of a unit of these coordinates, over the distance from the edge.
    """

    value: float
    at: BodyPoints
    curvature: float
    scale: float


def largest(name: str, solution: Solution, nu: float, stress: StressAt) -> Extreme:
    """Return the largest value of a measure of stress.

    Parameters
    ----------
    name : str
        One of `MEASURES`.
    solution : Solution
    nu : float
        Poisson's ratio of the body.
    stress : callable
        Dimensionless stress at points of the body.
    """
    tension = name == "surface_tension"
    reason = _unbounded_tension(solution) if tension else _unbounded_shear(solution, nu)
    if reason:
        place = _tips(solution)[0] if reason == _AT_TIPS else EDGE
        remark = f"unbounded: {reason}"
        return Extreme(None, place.value, 0.0, None, None, attained=False, remark=remark)
    best = _search(MEASURES[name], solution, stress, tension)
    if loaded_edge(solution.scene):
        edge, error = _edge(MEASURES[name], solution, stress, tension)
        if edge > best.value * (1.0 - 1e-9):
            remark = "supremum, approached at the edge"
            return Extreme(edge, 1.0, 0.0, error, 0.0, attained=False, remark=remark)
    return _extreme(best, solution, stress)


def _extreme(best: _Maximum, solution: Solution, stress: StressAt) -> Extreme:
    """Return the largest value with the errors of it and of its place."""
    here = stress(best.at, None)
    error = float(here.error[0] * here.norm[0] / best.value) if best.value else 0.0
    # the computed maximum may be anywhere where the value is lower by no more than twice its error
    drop = 2.0 * best.value * max(error, 1e-15)
    place_error = float(np.sqrt(drop / best.curvature) + _NARROW) * best.scale if drop else 0.0
    r = float(best.at.r[0])
    z = float(best.at.z[0])
    r = 0.0 if r <= max(AXIS, place_error * float(best.at.to_edge[0])) else r
    # At nu = 0.5 stress next to a tip depends on the direction alone, and the search stops at some
    # small distance. The value is the supremum but for an error of 20 times that distance.
    for tip in _tips(solution):
        away = float(distance(best.at, tip)[0])
        if away < _AT_TIP:
            remark = "supremum, approached where the pressure is infinite"
            error += 20.0 * away
            return Extreme(best.value, tip.value, 0.0, error, 0.0, attained=False, remark=remark)
    return Extreme(best.value, r, z, error, place_error, attained=True, remark="attained")


def _unbounded_shear(solution: Solution, nu: float) -> str:
    """Return the reason why shear stresses have no bound, "" if they have one."""
    if loaded_edge(solution.scene):
        if not np.isfinite(solution.pressure(1.0)):
            return "the pressure of a smooth surface is infinite at the edge"
        if solution.traction_field is not None and solution.traction(1.0) != 0.0:
            return "the stress diverges logarithmically at the edge, where the traction jumps to 0"
    # Next to a tip or a corner the pressure p is nearly uniform, and the normal stresses are -p,
    # -(1 + 2 nu) p/2 or -2 nu p, which are all the same at nu = 0.5.
    if nu < 0.5 and _tips(solution):
        return _AT_TIPS
    return ""


def _tips(solution: Solution) -> list[Radius]:
    """Return the places inside the contact where the pressure is infinite: tips and corners."""
    return [place for place in singular(solution) if place is not EDGE]


def _unbounded_tension(solution: Solution) -> str:
    """Return the reason why tension on the surface has no bound at the edge, "" if it has one.

    Traction that pushes the surface outward next to the edge compresses it there, and traction
    inward stretches it. Without adhesion both loads go to zero at the edge of a profile.
    """
    if not loaded_edge(solution.scene):
        return ""
    pressure = solution.pressure(1.0)
    traction = solution.traction(1.0)
    if np.isnan(pressure):
        return "pressure and traction change sign infinitely often towards the edge"
    if pressure == -np.inf:
        return "the suction on a smooth surface is infinite at the edge"
    if traction < 0.0:
        return "the traction next to the edge is inward"
    return ""


def _search(
    measure: Callable[[Stress], Array], solution: Solution, stress: StressAt, tension: bool
) -> _Maximum:
    """Return the largest value on all charts, and at the places that they end at."""
    ends = boundaries(solution)
    charts = around(ends, centre=pointed(solution))

    def on_chart(chart: Chart) -> Callable[..., Array]:
        """Return the measure as a function of the coordinates of a chart."""
        return lambda u, v, rtol=None: measure(stress(chart.points(u, v), rtol))

    flat = solution.scene.profile is None
    maxima = [] if flat else _at_places(measure, solution, stress, ends)
    for chart in charts:
        lines = [line for line in chart.lines if line.on_surface or not tension]
        maxima += [_maximum_on_line(chart, on_chart(chart), line) for line in lines]
    if not tension:
        maxima += _off_lines(charts, on_chart, max(maximum.value for maximum in maxima))
    largest_value = max(maximum.value for maximum in maxima)
    # if values are equal but for rounding, the first of them
    return next(maximum for maximum in maxima if maximum.value >= largest_value * (1.0 - 1e-13))


def _off_lines(
    charts: list[Chart], on_chart: Callable[[Chart], Callable[..., Array]], on_lines: float
) -> list[_Maximum]:
    """Return the local maxima inside the charts that may exceed the largest one on their lines."""
    peaks = [(chart, *peak) for chart in charts for peak in _peaks(chart, on_chart(chart))]
    least = _FOLLOWED_FRACTION * max(on_lines, *(value for _, value, _ in peaks))
    high = [(chart, start) for chart, value, start in peaks if value >= least]
    return [
        maximum for chart, start in high for maximum in _maxima_near(chart, on_chart(chart), start)
    ]


def _at_places(
    measure: Callable[[Stress], Array], solution: Solution, stress: StressAt, ends: list[Radius]
) -> list[_Maximum]:
    """Return the values at those ends of zones at which stress has a limit."""
    infinite = singular(solution)
    maxima = []
    for end in ends:
        if end not in infinite:
            radius = np.array([max(end.value, AXIS)])
            point = BodyPoints(radius, np.array([end.from_edge]), np.zeros(1))
            value = float(measure(stress(point, None))[0])
            maxima.append(_Maximum(value, point, np.inf, 0.0))
    return maxima


def _maximum_on_line(chart: Chart, measure: Callable[..., Array], line: CoordinateLine) -> _Maximum:
    """Return the largest value along a line: next to the largest one on its grid."""
    grid = line.grid

    def on_line(x: Array, rtol: float | None = None) -> Array:
        return measure(*line.both(x), rtol)

    k = int(np.argmax(on_line(grid, _COARSE)))
    low = grid[max(k - 1, 0)]
    high = grid[min(k + 1, len(grid) - 1)]
    best = minimize_scalar(
        lambda x: -on_line(np.array([x]))[0],
        bounds=(low, high),
        method="bounded",
        options={"xatol": _NARROW * high},
    )
    node_value = float(on_line(grid[k : k + 1])[0])  # the maximum may be at an end of the line
    value, at = max((-float(best.fun), float(best.x)), (node_value, float(grid[k])))
    step = 1e-3 * (high - low)
    near = on_line(np.clip(np.array([at - step, at + step]), grid[0], grid[-1]))
    u, v = line.both(np.array([at]))
    curvature = _curvature(value, near, step)
    scale = chart.scale(float(u[0]), float(v[0]))
    return _Maximum(value, chart.points(u, v), curvature, scale)


def _maxima_near(chart: Chart, measure: Callable[..., Array], start: Array) -> list[_Maximum]:
    """Return the local maximum next to a node of a net, none if it is not inside the chart."""

    def negative(x: Array) -> float:
        u, v = chart.reflected(float(x[0]), float(x[1]))
        return -float(measure(np.array([u]), np.array([v]))[0])

    options = {"xatol": _NARROW, "fatol": 1e-15, "initial_simplex": start + 0.03 * _SIMPLEX}
    best = minimize(negative, start, method="Nelder-Mead", options=options)
    u = float(best.x[0])
    v = float(best.x[1])
    if not chart.inside(u, v):
        return []
    step = 1e-3
    near = [-negative(best.x + step * direction) for direction in np.vstack([_CROSS, -_CROSS])]
    u, v = chart.reflected(u, v)
    at = chart.points(np.array([u]), np.array([v]))
    return [_Maximum(-float(best.fun), at, _curvature(-best.fun, near, step), chart.scale(u, v))]


#: The first simplex of the method of Nelder and Mead, and the directions of the two coordinates.
_SIMPLEX = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
_CROSS = np.eye(2)


def _peaks(chart: Chart, measure: Callable[..., Array]) -> list[tuple[float, Array]]:
    """Return values and coordinates of the largest nodes of a net that no neighbour exceeds."""
    u, v = (coordinate.ravel() for coordinate in np.meshgrid(*chart.net, indexing="ij"))
    rows, columns = (len(coordinate) for coordinate in chart.net)
    values = measure(u, v, _COARSE).reshape(rows, columns)
    padded = np.pad(values, 1, constant_values=-np.inf)
    shifts = [(i, j) for i in range(3) for j in range(3) if (i, j) != (1, 1)]
    highest = np.max([padded[i : i + rows, j : j + columns] for i, j in shifts], axis=0)
    where = np.flatnonzero((values >= highest).ravel())
    order = where[np.argsort(-values.ravel()[where])][:_MOST_PEAKS]
    return [(float(values.flat[k]), np.array([u[k], v[k]])) for k in order]


def _curvature(value: float, near: object, step: float) -> float:
    """Return the least curvature at a maximum, from values a step of a coordinate away."""
    drop = float(np.min(value - np.asarray(near)))
    return max(2.0 * drop / step**2, 1e-12 * abs(value))


def _edge(
    measure: Callable[[Stress], Array], solution: Solution, stress: StressAt, on_surface: bool
) -> tuple[float, float]:
    """Return the largest limit at the edge over all directions, and its relative error."""
    pressure = float(solution.pressure(1.0))
    if not np.isfinite(pressure):  # then only the stress of the free surface has a limit
        angles = np.array([np.pi])
    else:
        angles = np.array([0.0, np.pi]) if on_surface else np.linspace(0.0, np.pi, 181)

    def at(theta: Array) -> Stress:
        d = _AT_EDGE * np.cos(theta)
        z = np.where(np.isin(theta, (0.0, np.pi)), 0.0, _AT_EDGE * np.sin(theta))
        return stress(BodyPoints(1.0 - d, d, z), None)

    values = measure(at(angles))
    best = angles[int(np.argmax(values))]
    if not on_surface:
        bounds = max(best - np.pi / 180.0, 0.0), min(best + np.pi / 180.0, np.pi)
        best = minimize_scalar(
            lambda x: -float(measure(at(np.array([x])))[0]), bounds=bounds, method="bounded"
        ).x
    there = at(np.array([best]))
    value = float(max(measure(there)[0], values.max()))
    # At the distance d from the edge the stress differs from its limit by about (d/width) ln d,
    # with the width of the layer and abs(ln d) < 40; on a smooth surface by sqrt(d).
    size = 1.0 if solution.scene.profile is None else solution.contact_radius
    width = max(solution.scene.normal_compliance / size, 1e-300)
    away = _AT_EDGE * (1.0 + 40.0 / width) if np.isfinite(pressure) else np.sqrt(_AT_EDGE)
    error = float(there.error[0] * there.norm[0] / abs(value)) if value else 0.0
    return value, error + float(min(away, 1.0))
