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

#: What can be asked for, and how it follows from the stress.
MEASURES: dict[str, Callable[[Stress], Array]] = {
    "von_mises": lambda stress: np.asarray(stress.von_mises),
    "max_shear": lambda stress: np.asarray(stress.max_shear),
    "surface_tension": lambda stress: np.asarray(stress.principal[0]),
}
#: How far from the edge stress that depends on the direction alone is looked at.
_AT_EDGE = 1e-15
#: How close to an infinite pressure a place counts as it.
_AT_TIP = 1e-7
#: What the nets are accurate to.
_COARSE = 1e-8
#: A bracket is narrowed to this share of its place.
_NARROW = 1e-9
#: Nodes of the nets with a smaller share of the largest value are not followed up.
_WORTH = 0.8
#: So many of a net are.
_PEAKS = 3
#: Why shear stress has no bound inside the contact.
_AT_TIPS = "the pressure is infinite at a tip or a corner"


class _Found(NamedTuple):
    """A local maximum: where it is, how fast values fall around, and over which distance."""

    value: float
    at: BodyPoints
    fall: float
    share: float


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
    reason = _tension_grows(solution) if tension else _shear_grows(solution, nu)
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


def _extreme(best: _Found, solution: Solution, stress: StressAt) -> Extreme:
    here = stress(best.at, None)
    error = float(here.error[0] * here.norm[0] / best.value) if best.value else 0.0
    drop = 2.0 * best.value * max(error, 1e-15)
    place = float(np.sqrt(drop / best.fall) + _NARROW) * best.share if drop else 0.0
    r, z = float(best.at.r[0]), float(best.at.z[0])
    r = 0.0 if r <= max(AXIS, place * float(best.at.to_edge[0])) else r
    for tip in _tips(solution):  # at nu = 0.5 stress next to it depends on the direction alone
        away = float(distance(best.at, tip)[0])
        if away < _AT_TIP:
            remark = "supremum, approached where the pressure is infinite"
            error += 20.0 * away
            return Extreme(best.value, tip.value, 0.0, error, 0.0, attained=False, remark=remark)
    return Extreme(best.value, r, z, error, place, attained=True, remark="attained")


def _shear_grows(solution: Solution, nu: float) -> str:
    """Return why shear stresses have no bound; nothing if they have one."""
    if loaded_edge(solution.scene):
        if not np.isfinite(solution.pressure(1.0)):
            return "the pressure of a smooth surface is infinite at the edge"
        if solution.traction_field is not None and solution.traction(1.0) != 0.0:
            return "the stress diverges logarithmically at the edge, where the traction jumps to 0"
    # under a pressure that is locally uniform all stresses are it, or (1 + 2 nu) / 2 of it
    if nu < 0.5 and _tips(solution):
        return _AT_TIPS
    return ""


def _tips(solution: Solution) -> list[Radius]:
    """Return where pressure is infinite inside the contact: at tips and corners."""
    return [place for place in singular(solution) if place is not EDGE]


def _tension_grows(solution: Solution) -> str:
    """Return why tension on the surface has no bound at the edge; nothing if it has one.

    A traction that is outward next to the edge presses on the material before and behind it. Under
    a profile both loads go to zero at the edge, but with adhesion.
    """
    if not loaded_edge(solution.scene):
        return ""
    pressure, traction = (one(1.0) for one in (solution.pressure, solution.traction))
    if np.isnan(pressure):
        return "pressure and traction change sign infinitely often towards the edge"
    if pressure == -np.inf:
        return "the suction on a smooth surface is infinite at the edge"
    if traction < 0.0:
        return "the traction next to the edge is inward"
    return ""


def _search(
    of: Callable[[Stress], Array], solution: Solution, stress: StressAt, tension: bool
) -> _Found:
    """Return the largest value that is found on all charts, and at places next to them."""
    ends = boundaries(solution)
    charts = around(ends, centre=pointed(solution))

    def on(chart: Chart) -> Callable[..., Array]:
        return lambda u, v, rtol=None: of(stress(chart.points(u, v), rtol))

    flat = solution.scene.profile is None
    found = [] if flat else _at_places(of, solution, stress, ends)
    lines = [(one, line) for one in charts for line in one.lines if line.on_surface or not tension]
    found += [_along(chart, on(chart), line) for chart, line in lines]
    if not tension:
        found += _off_lines(charts, on, max(one.value for one in found))
    top = max(one.value for one in found)
    return next(one for one in found if one.value >= top * (1.0 - 1e-13))


def _off_lines(
    charts: list[Chart], on: Callable[[Chart], Callable[..., Array]], known: float
) -> list[_Found]:
    """Return the local maxima off the boundaries of the charts that may exceed what is known."""
    peaks = [(one, *peak) for one in charts for peak in _peaks(one, on(one))]
    worth = _WORTH * max(known, *(value for _, value, _ in peaks))
    high = [(chart, start) for chart, value, start in peaks if value >= worth]
    return [one for chart, start in high for one in _climbed(chart, on(chart), start)]


def _at_places(
    of: Callable[[Stress], Array], solution: Solution, stress: StressAt, ends: list[Radius]
) -> list[_Found]:
    """Return the values where loads are not smooth, but stress has a limit."""
    infinite, found = singular(solution), []
    for end in ends:
        if end not in infinite:
            one = np.array([max(end.value, AXIS)]), np.array([end.from_edge]), np.zeros(1)
            value = float(of(stress(BodyPoints(*one), None))[0])
            found.append(_Found(value, BodyPoints(*one), np.inf, 0.0))
    return found


def _along(chart: Chart, measure: Callable[..., Array], line: CoordinateLine) -> _Found:
    grid = line.grid

    def of(x: Array, rtol: float | None = None) -> Array:
        return measure(*line.both(x), rtol)

    k = int(np.argmax(of(grid, _COARSE)))
    low, high = grid[max(k - 1, 0)], grid[min(k + 1, len(grid) - 1)]
    narrow = {"xatol": _NARROW * high}
    best = minimize_scalar(
        lambda x: -of(np.array([x]))[0], bounds=(low, high), method="bounded", options=narrow
    )
    node = float(of(grid[k : k + 1])[0])
    value, at = max((-float(best.fun), float(best.x)), (node, float(grid[k])))
    step = 1e-3 * (high - low)
    fall = _fall(value, of(np.clip(np.array([at - step, at + step]), grid[0], grid[-1])), step)
    u, v = line.both(np.array([at]))
    return _Found(value, chart.points(u, v), fall, chart.share(float(u[0])))


def _climbed(chart: Chart, measure: Callable[..., Array], start: Array) -> list[_Found]:
    """Return the local maximum next to a node of a net, if it is inside the chart."""

    def negative(x: Array) -> float:
        u, v = chart.reflected(float(x[0]), float(x[1]))
        return -float(measure(np.array([u]), np.array([v]))[0])

    options = {"xatol": _NARROW, "fatol": 1e-15, "initial_simplex": start + 0.03 * _SIMPLEX}
    best = minimize(negative, start, method="Nelder-Mead", options=options)
    u, v = float(best.x[0]), float(best.x[1])
    if not chart.inside(u, v):
        return []
    near = [-negative(best.x + 1e-3 * step) for step in np.vstack([_CROSS, -_CROSS])]
    u, v = chart.reflected(u, v)
    at = chart.points(np.array([u]), np.array([v]))
    return [_Found(-float(best.fun), at, _fall(-best.fun, near, 1e-3), chart.share(u))]


_SIMPLEX = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
_CROSS = np.eye(2)


def _peaks(chart: Chart, measure: Callable[..., Array]) -> list[tuple[float, Array]]:
    """Return the largest nodes of a net that no neighbour exceeds, with their values."""
    u, v = (one.ravel() for one in np.meshgrid(*chart.net, indexing="ij"))
    rows, columns = (len(one) for one in chart.net)
    values = measure(u, v, _COARSE).reshape(rows, columns)
    padded = np.pad(values, 1, constant_values=-np.inf)
    shifts = [(i, j) for i in range(3) for j in range(3) if (i, j) != (1, 1)]
    highest = np.max([padded[i : i + rows, j : j + columns] for i, j in shifts], axis=0)
    where = np.flatnonzero((values >= highest).ravel())
    order = where[np.argsort(-values.ravel()[where])][:_PEAKS]
    return [(float(values.flat[k]), np.array([u[k], v[k]])) for k in order]


def _fall(value: float, around: object, step: float) -> float:
    """Return the least curvature from values around; steps are in tau or sigma."""
    drop = float(np.min(value - np.asarray(around)))
    return max(2.0 * drop / step**2, 1e-12 * abs(value))


def _edge(
    of: Callable[[Stress], Array], solution: Solution, stress: StressAt, on_surface: bool
) -> tuple[float, float]:
    """Return the largest limit at the edge over all directions, and its relative error."""
    pressure = float(solution.pressure(1.0))
    if not np.isfinite(pressure):  # then it is the free surface that may matter
        angles = np.array([np.pi])
    else:
        angles = np.array([0.0, np.pi]) if on_surface else np.linspace(0.0, np.pi, 181)

    def at(theta: Array) -> Stress:
        d = _AT_EDGE * np.cos(theta)
        z = np.where(np.isin(theta, (0.0, np.pi)), 0.0, _AT_EDGE * np.sin(theta))
        return stress(BodyPoints(1.0 - d, d, z), None)

    values = of(at(angles))
    best = angles[int(np.argmax(values))]
    if not on_surface:
        bounds = max(best - np.pi / 180.0, 0.0), min(best + np.pi / 180.0, np.pi)
        best = minimize_scalar(
            lambda x: -float(of(at(np.array([x])))[0]), bounds=bounds, method="bounded"
        ).x
    there = at(np.array([best]))
    value = float(max(of(there)[0], values.max()))
    # what is left of the way to the edge changes the stress by d ln d over the layer's width
    size = 1.0 if solution.scene.profile is None else solution.contact_radius
    width = max(solution.scene.normal_compliance / size, 1e-300)
    away = _AT_EDGE * (1.0 + 40.0 / width) if np.isfinite(pressure) else np.sqrt(_AT_EDGE)
    error = float(there.error[0] * there.norm[0] / abs(value)) if value else 0.0
    return value, error + float(min(away, 1.0))
