"""The hard cases: scenes at the ends of the ranges, and what is measured of each.

Shared by `reference/test_hard_cases.py`, `../validation/honesty/hard_cases.py` and
`../validation/net/net.py`. All of it goes through the public API; `hard_inside` has what does not.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from spectral_contact import Scene, Solution

EPS = 2.0**-52
INPUTS = ("poisson_ratio", "normal_compliance", "tangential_compliance", "friction")


@dataclass(frozen=True)
class HardCase:
    """One scene.

    Attributes
    ----------
    name : str
    why : str
        What makes it hard.
    scene : Scene
    truth : str
        ``"reference"``: 20 digits. ``"one disk"``: 20 digits without a stick zone of 5e-29 at the
        edge. ``"full stick"``: 20 digits of full stick, which an annulus of 1e-6 does not change;
        the annulus is where q/p exceeds f. ``"finer"``: the solver in over-refined spaces.
    step : float
        Relative step of the differences for the conditioning.
    slow : bool
        Takes most of a minute; only its shift under one ulp of all inputs at once is measured.
    """

    name: str
    why: str
    scene: Scene
    truth: str = "reference"
    step: float = 1e-5
    slow: bool = False


CASES = (
    HardCase("ordinary", "nothing; to compare with", Scene(0.1, 0.5, 0.5, 0.1)),
    HardCase(
        "thin layers",
        "edge layers of width 1e-14 in p and q",
        Scene(0.3, 1e-14, 1e-14, math.inf),
    ),
    HardCase(
        "thin layers, slip",
        "the same at the rim of the stick disk, too",
        Scene(0.3, 1e-14, 1e-14, 0.1),
    ),
    HardCase(
        "thin normal layer",
        "a layer of 1e-14 in p; q is of the first kind, with a root at the rim",
        Scene(0.3, 1e-14, 0.0, 0.1),
    ),
    HardCase(
        "thin tangential layer",
        "p is infinite at the edge, which sticks in 5e-29",
        Scene(0.3, 0.0, 1e-14, 0.1),
        truth="one disk",
        slow=True,
    ),
    HardCase(
        "28 decades, α above β",
        "p is flat, q has a layer of 1e-13 at the rim",
        Scene(0.3, 1e14, 1e-14, 0.1),
    ),
    HardCase(
        "28 decades, β above α",
        "p has a layer of 1e-14, q is 1e-15 of it",
        Scene(0.3, 1e-14, 1e14, math.inf),
    ),
    HardCase(
        "28 decades, slip inside",
        "the same with slip in an inner annulus",
        Scene(0.3, 1e-14, 1e14, 1e-16),
        truth="finer",
    ),
    HardCase(
        "incompressible",
        "κ = 2e-12: all shear comes from a difference of doubles",
        Scene(0.5 - 2e-12, 0.5, 0.5, 1e-13),
    ),
    HardCase(
        "little friction, smooth",
        "c = 1e-40: exponentially small in κ/f",
        Scene(0.3, 0.0, 0.0, 0.003056104486155285),
    ),
    HardCase(
        "little friction, rough",
        "c = 1e-40: 2βf/κ",
        Scene(0.3, 0.5, 0.5, 1.4285714285714286e-41),
    ),
    HardCase(
        "nearly critical, smooth",
        "slip in 1e-6 at the edge, where p and q are infinite",
        Scene(0.3, 0.0, 0.0, 1.3194997695512054),
    ),
    HardCase(
        "nearly critical, rough",
        "slip in 1e-6 at the edge: f is 3e-6 below critical",
        Scene(0.3, 1.0, 0.5, 0.1091470327333),
        step=1e-7,
    ),
    HardCase(
        "nearly critical, inside",
        "slip in 1e-6 inside: f is 1e-12 below critical",
        Scene(0.3, 0.05, 1.0, 0.037414039401417),
        truth="full stick",
    ),
    HardCase(
        "coupled, smooth",
        "p and q change sign infinitely often towards the edge",
        Scene(0.1, 0.0, 0.0, math.inf, coupling=True),
    ),
    HardCase(
        "coupled, thin layers",
        "the same down to layers of 1e-14; the contact would open",
        Scene(0.3, 1e-14, 1e-14, math.inf, coupling=True),
    ),
    HardCase(
        "coupled, thin tangential layer",
        "p is infinite at the edge, and q turns from infinite to finite at 1e-14",
        Scene(0.3, 0.0, 1e-14, math.inf, coupling=True),
    ),
    HardCase(
        "coupled, auxetic",
        "ν is 1e-9 above -1: no coupling is stronger",
        Scene(1e-9 - 1.0, 1e-6, 1e-3, math.inf, coupling=True),
    ),
    HardCase(
        "coupled, incompressible",
        "κ = 2e-12: coupling is below rounding, and q a difference of doubles",
        Scene(0.5 - 2e-12, 0.5, 0.5, math.inf, coupling=True),
        step=1e-2,
    ),
)


def outputs(solution: Solution) -> dict[str, float]:
    """Return the scalars of a solution: approach, edge pressure, Q and every boundary."""
    values = {"approach": solution.approach}
    if solution.scene.normal_compliance > 0.0:
        values["p(1)"] = float(solution.pressure(from_edge=0.0))
    values["Q"] = solution.total_shear
    for k, zone in enumerate(solution.zones[:-1], start=1):
        values[f"b{k}"], values[f"1-b{k}"] = zone.outer, zone.outer_from_edge
    return values


def numbers(record: dict[str, Any]) -> dict[str, float]:
    """Return the scalars of a truth by the names of `hard_cases.outputs`, as doubles."""
    values = {"approach": float(record["approach"]), "Q": float(record["Q"])}
    edge = [
        p for (kind, d), p in zip(record["points"], record["pressure"], strict=True) if d == 0.0
    ]
    if edge and math.isfinite(float(edge[0])):
        values["p(1)"] = float(edge[0])
    for k, (outer, from_edge) in enumerate(record["boundaries"], start=1):
        values[f"b{k}"], values[f"1-b{k}"] = float(outer), float(from_edge)
    return values


def shifts(values: dict[str, float], others: dict[str, float]) -> dict[str, float]:
    """Return the relative differences."""
    return {name: abs(values[name] / other - 1.0) for name, other in others.items()}


def true_errors(solution: Solution, truth: dict[str, Any]) -> dict[str, float]:
    """Return the relative errors; of the zones, of boundaries and their distances to the edge."""
    exact, found = numbers(truth), outputs(solution)
    moved = shifts({k: v for k, v in found.items() if k in exact}, exact)
    errors = {"approach": moved["approach"], "total_shear": moved["Q"]}
    errors["zones"] = max((v for k, v in moved.items() if "b" in k), default=0.0)
    if solution.scene.couples:
        return errors | _coupled_errors(solution, truth)
    for name in ("pressure", "traction"):
        errors[name] = 0.0
        for (kind, at), text in zip(truth["points"], truth[name], strict=True):
            if kind == "s" and name == "traction":  # up to the shift of the rim
                at = at * (1.0 + (found["b1"] - exact["b1"]) / exact["b1"])
            value, exactly = float(getattr(solution, name)(**{kind: at})), float(text)
            if value != exactly and not beside_a_boundary(solution, kind, at):
                errors[name] = max(errors[name], abs(value / exactly - 1.0))
    return errors


def exceeded(solution: Solution, truth: dict[str, Any]) -> dict[str, tuple[float, float]]:
    """Return the true errors that are above their estimates, with these."""
    pairs = {
        name: (error, float(getattr(solution.error, name)))
        for name, error in true_errors(solution, truth).items()
    }
    return {name: pair for name, pair in pairs.items() if not pair[0] <= pair[1] + 2.0 * EPS}


def _coupled_errors(solution: Solution, truth: dict[str, Any]) -> dict[str, float]:
    """Return the errors of p and of q/s; where one changes sign, relative to the two together."""
    d = np.array([at for _, at in truth["points"]])
    exact = [np.array([float(text) for text in truth[n]]) for n in ("pressure", "traction")]
    sizes = [np.abs(field) for field in exact]
    if min(field.min() for field in exact) <= 0.0:
        p, u = exact[0], exact[1] / (1.0 - d)
        sizes = [np.hypot(p, u), np.hypot(u, solution.scene.kappa * p) * (1.0 - d)]
    errors = {}
    for name, its, size in zip(("pressure", "traction"), exact, sizes, strict=True):
        mine = getattr(solution, name)(from_edge=d)
        differ = mine != its  # infinities do not
        missed = np.abs(mine[differ] - its[differ]) / size[differ]
        errors[name] = float(np.max(missed, initial=0.0))
    return errors


def beside_a_boundary(solution: Solution, kind: str, at: float) -> bool:
    """Whether a point is within the uncertainty of a boundary, or beyond an edge zone of 1e-28."""
    if kind == "s":
        return False
    ends = [z.outer_from_edge for z in solution.zones[:-1]]
    blur = solution.error.zones or 0.0
    return any(abs(at - end) <= 10.0 * blur * end or at < end < 1e-20 for end in ends)


def perturbations(scene: Scene) -> Iterator[tuple[str, float, Scene]]:
    """Yield every input with its relative change and the scene, one ulp up and down."""
    for name in INPUTS:
        value = getattr(scene, name)
        if value and math.isfinite(value):
            for toward in (-math.inf, math.inf):
                fresh = math.nextafter(value, toward)
                try:
                    moved = replace(scene, **{name: fresh})
                except ValueError:  # out of the range
                    continue
                yield name, abs(fresh / value - 1.0), moved
