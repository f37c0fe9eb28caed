"""The largest von Mises stress, shear stress and surface tension: where, or why there is none.

Places are searched in toroidal coordinates (see `patches`), in which the edge is infinitely far
away: a coarse net brackets the largest values, and each bracket is narrowed down.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize, minimize_scalar

from spectral_contact.interior.mesh import Points
from spectral_contact.interior.patches import from_toroidal
from spectral_contact.interior.results import Extreme, Stress

if TYPE_CHECKING:
    from spectral_contact.solution import Solution

__all__ = ["MEASURES", "largest"]

Array = NDArray[np.float64]
#: Stress at points, to a tolerance or to all digits.
StressAt = Callable[[Points, float | None], Stress]

#: What can be asked for, and how it follows from the stress.
MEASURES: dict[str, Callable[[Stress], Array]] = {
    "von_mises": lambda stress: np.asarray(stress.von_mises),
    "max_shear": lambda stress: np.asarray(stress.max_shear),
    "surface_tension": lambda stress: np.asarray(stress.principal[0]),
}
#: Where the edge is looked at: stresses there hang on the direction alone.
_AT_EDGE = 1e-15
#: Nets over tau and sigma, along a line and over the quarter plane; the edge is at tau = 35.
_LINE, _NET = 241, (61, 41)
_FARTHEST, _CLOSEST = 1e-3, 35.0
#: What the net is accurate to.
_COARSE = 1e-6
#: A bracket is narrowed to this share of its place.
_NARROW = 1e-9


class _Found(NamedTuple):
    """A local maximum: its coordinates, and how fast values fall around it."""

    value: float
    tau: float
    sigma: float
    fall: float


def largest(name: str, solution: Solution, stress: StressAt) -> Extreme:
    """Return the largest value of a measure of stress.

    Parameters
    ----------
    name : str
        One of `MEASURES`.
    solution : Solution
    stress : callable
        Dimensionless stress at points of the body.
    """
    tension = name == "surface_tension"
    reason = _tension_grows(solution) if tension else _shear_grows(solution)
    if reason:
        return Extreme(None, 1.0, 0.0, None, None, attained=False, remark=f"no bound: {reason}")

    def measure(tau: Array, sigma: Array, rtol: float | None = None) -> Array:
        return MEASURES[name](stress(from_toroidal(tau, sigma), rtol))

    found = [_on_line(measure, sigma) for sigma in (0.0, np.pi)]
    if not tension:
        found += [_on_axis(measure), *_in_body(measure)]
    top = max(one.value for one in found)
    best = next(one for one in found if one.value >= top * (1.0 - 1e-13))
    edge, error = _edge(MEASURES[name], solution, stress, tension)
    if edge > best.value * (1.0 - 1e-9):
        remark = "the supremum, approached at the edge"
        return Extreme(edge, 1.0, 0.0, error, 0.0, attained=False, remark=remark)
    at = from_toroidal(np.array([best.tau]), np.array([best.sigma]))
    here = stress(at, None)
    error = float(here.error[0] * here.norm[0] / best.value) if best.value else 0.0
    drop = 2.0 * best.value * max(error, 1e-15)
    place = float(np.sqrt(drop / best.fall) + _NARROW) if drop else 0.0
    r, z = float(at.r[0]), float(at.z[0])
    r = 0.0 if best.tau == 0.0 else r
    return Extreme(best.value, r, z, error, place, attained=True, remark="attained")


def _shear_grows(solution: Solution) -> str:
    """Return why shear stresses have no bound at the edge; nothing if they have one."""
    if not np.isfinite(solution.pressure(1.0)):
        return "the pressure of a smooth surface is infinite at the edge"
    if solution.traction_field is not None and solution.traction(1.0) != 0.0:
        return "the traction ends at the edge with a jump, next to which stress is logarithmic"
    return ""


def _tension_grows(solution: Solution) -> str:
    """Return why tension on the surface has no bound at the edge; nothing if it has one.

    A traction that is outward next to the edge presses on the material before and behind it.
    """
    pressure, traction = (one(1.0) for one in (solution.pressure, solution.traction))
    if np.isnan(pressure):
        return "pressure and traction change sign infinitely often towards the edge"
    if traction < 0.0:
        return "the traction next to the edge is inward"
    return ""


def _on_line(measure: Callable[..., Array], sigma: float) -> _Found:
    """Return the largest value on the free surface (sigma 0) or on the contact (pi)."""
    taus = np.geomspace(_FARTHEST, _CLOSEST, _LINE)

    def of(tau: Array, rtol: float | None = None) -> Array:
        return measure(tau, np.full_like(tau, sigma), rtol)

    return _along(of, taus, fixed=sigma, axis=0)


def _on_axis(measure: Callable[..., Array]) -> _Found:
    """Return the largest value on the axis."""
    sigmas = np.linspace(_FARTHEST, np.pi, _LINE)

    def of(sigma: Array, rtol: float | None = None) -> Array:
        return measure(np.zeros_like(sigma), sigma, rtol)

    return _along(of, sigmas, fixed=0.0, axis=1)


def _along(of: Callable[..., Array], grid: Array, fixed: float, axis: int) -> _Found:
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
    tau, sigma = (at, fixed) if axis == 0 else (fixed, at)
    return _Found(value, tau, sigma, fall)


def _in_body(measure: Callable[..., Array]) -> list[_Found]:
    """Return the largest local maxima off the surface and the axis."""
    taus = np.linspace(0.0, _CLOSEST, _NET[0])
    taus = np.concatenate([np.linspace(0.0, 3.0, _NET[0]), taus[taus > 3.0]])
    sigmas = np.linspace(0.0, np.pi, _NET[1])[1:-1]
    tau, sigma = (one.ravel() for one in np.meshgrid(taus, sigmas, indexing="ij"))
    values = measure(tau, sigma, _COARSE).reshape(len(taus), len(sigmas))
    peaks = _peaks(values)

    def reflected(x: Array) -> float:
        """Return minus the value, mirrored at the axis and at the surface."""
        angle = np.abs(np.mod(x[1] + np.pi, 2.0 * np.pi) - np.pi)
        return -float(measure(np.array([min(abs(x[0]), _CLOSEST)]), np.array([angle]))[0])

    found = []
    for i, j in peaks:
        start = np.array([taus[i], sigmas[j]])
        options = {"xatol": _NARROW, "fatol": 1e-15, "initial_simplex": start + 0.03 * _SIMPLEX}
        best = minimize(reflected, start, method="Nelder-Mead", options=options)
        across, around_edge = abs(float(best.x[0])), float(best.x[1])
        if 0.0 < around_edge < np.pi and across < _CLOSEST:
            around = [-reflected(best.x + 1e-3 * step) for step in np.vstack([_CROSS, -_CROSS])]
            fall = _fall(-best.fun, around, 1e-3)
            found.append(_Found(-float(best.fun), across, around_edge, fall))
    return found


_SIMPLEX = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
_CROSS = np.eye(2)


def _peaks(values: Array) -> list[tuple[int, int]]:
    """Return the two largest nodes of a net that no neighbour exceeds."""
    padded = np.pad(values, 1, constant_values=-np.inf)
    shifts = [(i, j) for i in range(3) for j in range(3) if (i, j) != (1, 1)]
    rows, columns = values.shape
    around = np.max([padded[i : i + rows, j : j + columns] for i, j in shifts], axis=0)
    where = np.argwhere(values >= around)
    order = np.argsort([-values[i, j] for i, j in where])[:2]
    return [(int(where[k][0]), int(where[k][1])) for k in order]


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
        return stress(Points(1.0 - d, d, z), None)

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
    width = max(solution.scene.normal_compliance, 1e-300)
    away = _AT_EDGE * (1.0 + 40.0 / width) if np.isfinite(pressure) else np.sqrt(_AT_EDGE)
    error = float(there.error[0] * there.norm[0] / abs(value)) if value else 0.0
    return value, error + float(min(away, 1.0))
