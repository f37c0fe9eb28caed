"""True errors of every quantity of a solution, against any object with the truth's fields."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from spectral_contact import NotComputedError, Solution

EPS = 2.2e-16
#: Where fields are compared, measured from the edge; `places` adds some in every zone.
DISTANCES = 10.0 ** -np.linspace(1e-3, 30.0, 600)
SCALARS = ("approach", "total_shear", "stick_radius", "edge_ratio", "critical_friction")


def _relative(value: float, truth: float) -> float:
    if value == truth:
        return 0.0
    return abs(value / truth - 1.0) if truth else math.inf


def places(truth: Any, distances: np.ndarray = DISTANCES, within: int = 40) -> np.ndarray:
    """Return distances from the edge at which fields are compared, so many of them in each zone."""
    share = 0.5 - 0.5 * np.cos(np.pi * (np.arange(within) + 0.5) / within)
    inside = [
        zone.outer_from_edge + (zone.inner_from_edge - zone.outer_from_edge) * share
        for zone in truth.zones
    ]
    at = np.concatenate([distances, *inside])
    return at[at < 1.0]  # at the centre itself there is no traction to compare


def _pointwise(solution: Solution, truth: Any, name: str, at: np.ndarray) -> np.ndarray:
    value, true = (getattr(one, name)(from_edge=at) for one in (solution, truth))
    if solution.scene.couples:
        return np.abs(value - true) / _sizes(solution, truth, at)[name]
    return np.abs(value / true - 1.0)


def _sizes(solution: Solution, truth: Any, at: np.ndarray) -> dict[str, np.ndarray]:
    """Return what errors are relative to with coupling: where signs change, the two together."""
    p, u = truth.pressure(from_edge=at), truth.traction(from_edge=at) / (1.0 - at)
    if solution.opening is not None or min(p.min(), u.min()) <= 0.0:
        p, u = np.hypot(p, u), np.hypot(u, solution.scene.kappa * p)
    return {"pressure": p, "traction": u * (1.0 - at)}


def _moved(truth: Any, at: np.ndarray, shift: float) -> np.ndarray:
    """Return by how much the traction varies where places move by a share of the radius."""
    changes, central = np.zeros(len(at)), at > 0.5
    if np.isfinite(shift):
        s, near = 1.0 - at[central], at[~central]
        outward = np.minimum(s * (1.0 + shift), 1.0)
        changes[central] = truth.traction(outward) / truth.traction(s) - 1.0
        moved = truth.traction(from_edge=near * max(1.0 - shift, 0.0))
        changes[~central] = moved / truth.traction(from_edge=near) - 1.0
    return np.abs(changes)


def zones_alike(solution: Solution, truth: Any) -> bool:
    """Return whether both have the same kinds of zones in the same order."""
    return [z.kind for z in solution.zones] == [z.kind for z in truth.zones]


def zones_error(solution: Solution, truth: Any) -> float:
    """Return the largest error of a boundary, from the centre and from the edge.

    Where a zone is missing or too many, its ends count as one: they are off by its width.
    """
    if zones_alike(solution, truth):
        pairs = list(zip(solution.zones[:-1], truth.zones[:-1], strict=True))
        errors = [_relative(z.outer, t.outer) for z, t in pairs]
        errors += [_relative(z.outer_from_edge, t.outer_from_edge) for z, t in pairs]
        return max(errors, default=0.0)
    ends = sorted({(-z.outer_from_edge, z.outer) for one in (solution, truth) for z in one.zones})
    worst, inner = 0.0, (-1.0, 0.0)
    for end in ends:
        middle = 0.5 * (inner[0] + end[0])
        if _kind_at(solution, -middle) != _kind_at(truth, -middle):
            outward = end[1] / inner[1] - 1.0 if inner[1] else math.inf
            worst = max(worst, outward, 1.0 - end[0] / inner[0])
        inner = end
    return worst


def _kind_at(solution: Solution, from_edge: float) -> str:
    return next(z.kind for z in solution.zones if z.outer_from_edge < from_edge)


def _has(solution: Any, name: str) -> bool:
    """Return whether a solution has a scalar; with coupling the edge ratio may have no meaning."""
    try:
        return hasattr(solution, name)
    except NotComputedError:
        return False


def compare(
    solution: Solution, truth: Any, among: np.ndarray | None = None
) -> dict[str, tuple[float, float, float]]:
    """Return for each quantity the true error, the estimate, and the estimate of the truth.

    Fields are compared at distances from the edge `among` which the truth is known, if it is not
    everywhere.
    """
    everywhere = places(truth) if among is None else among
    known = [name for name in SCALARS if _has(solution, name) and _has(truth, name)]
    errors = {n: _relative(getattr(solution, n), getattr(truth, n)) for n in known}
    errors["pressure"] = float(_pointwise(solution, truth, "pressure", everywhere).max())
    errors["zones"] = zones_error(solution, truth)
    if solution.scene.friction == math.inf:  # by definition
        del errors["zones"], errors["stick_radius"]
    away = np.ones(len(everywhere), dtype=bool)
    for zone in solution.zones[:-1]:  # the traction up to the shift of the boundaries
        shift = solution.error.zones * max(zone.outer_from_edge, 1e-300)
        away &= np.abs(everywhere - zone.outer_from_edge) > 1e3 * shift
    at = everywhere[away]
    traction = _pointwise(solution, truth, "traction", at) - _moved(truth, at, solution.error.zones)
    errors["traction"] = float(traction.max(initial=0.0))
    slip = truth.slip(from_edge=everywhere) if hasattr(truth, "slip") else None
    if slip is not None and np.any(slip):
        difference = np.abs(solution.slip(from_edge=everywhere) - slip)
        errors["slip"] = float(difference.max() / np.abs(slip).max())
    return {
        name: (error, float(getattr(solution.error, name)), float(getattr(truth.error, name)))
        for name, error in errors.items()
    }


def violates(error: float, estimate: float, own: float) -> bool:
    """Return whether a true error is above the estimate; what is no number violates, too."""
    return not error <= estimate + own + 20 * EPS


def unexplained(solution: Solution, closest: Solution | None = None) -> list[str]:
    """Return what a solution that converged says of slip that its estimates do not explain.

    Parameters
    ----------
    solution : Solution
    closest : Solution, optional
        The same scene at the closest tolerance: where that knows a digit of the slip, an infinite
        estimate is not the last resort.

    Returns
    -------
    list of str
        ``"violation"`` where the friction law is broken by more than the tolerance and all finite
        estimates, ``"slip"`` where its estimate is infinite and need not be.
    """
    error, found = solution.error, []
    if not solution.converged:
        return found
    fields = max(error.pressure or 0.0, error.traction or 0.0)
    slip = error.slip if error.slip is not None and error.slip < math.inf else 0.0
    slips = any(zone.kind == "slip" for zone in solution.zones)
    explained = max(solution.rtol, 2.0 * fields, slip if slips else 0.0)
    if (error.violation or 0.0) > explained:
        found.append("violation")
    # an error of 1 is that of full stick in place of slip that is too narrow: no digit is known
    if error.slip == math.inf and closest is not None and (closest.error.slip or 0.0) < 1.0:
        found.append("slip")
    return found
