"""Truth for the hard cases, to 20 digits where there is a way to them."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from dataclasses import replace
from typing import Any
from unittest import mock

from mpmath import isnan
from oracles.hard_cases import HardCase
from oracles.hard_inside import overrefined

from spectral_contact import Scene, solve
from spectral_contact.fields.series import Radius
from spectral_contact.precise import reference
from spectral_contact.precise.reference_solution import ReferenceSolution
from spectral_contact.precise.search import solved
from spectral_contact.precise.zone_trial import PreciseLayout

DIGITS = 20
#: Distances from the edge at which fields are compared.
DISTANCES = [0.97, 0.7, 0.4, 0.15, 0.03]
DISTANCES += [10.0**-k for k in (2, 3, 4, 5, 6, 8, 10, 12, 13, 14, 16)]
EDGE_TOO = [("from_edge", d) for d in (*DISTANCES, 0.0)]
#: And in a small stick disk, over its radius.
INSIDE = (0.25, 0.75, 0.999)
HOW = {
    "reference": f"`reference`, {DIGITS} digits",
    "one disk": f"`reference`, {DIGITS} digits, without the stick zone at the edge, which changes "
    "Q and c by less than 1e-14",
    "full stick": f"`reference`, {DIGITS} digits, of full stick; the annulus is where q > f p, to "
    "1e-5 of its width",
    "finer": "the solver, over-refined",
}


def truth_of(case: HardCase) -> dict[str, Any]:
    """Return the outputs and the fields of a case as decimal numbers."""
    if case.truth == "finer":
        with overrefined(28, 4):
            solution = solve(case.scene, 1e-12, strict=False)
            return _record(solution, EDGE_TOO, lambda value: repr(float(value)))
    if case.truth == "full stick":
        return _inside(case.scene)
    if case.truth == "one disk":
        return _exact_record(_without_edge_zone(case.scene))
    return _exact_record(reference(case.scene, DIGITS))


def _exact_record(exact: ReferenceSolution) -> dict[str, Any]:
    """Return what a solution to 20 digits has; points inside a small stick disk, too."""
    points = EDGE_TOO
    if isnan(exact.pressure(from_edge=0.0)):  # without a limit there
        points = points[:-1]
    if exact.stick_radius is not None and exact.stick_radius < 0.9:
        points = points + [("s", share * float(exact.stick_radius)) for share in INSIDE]
    return _record(exact, points, lambda value: _digits(exact, value))


def _digits(exact: ReferenceSolution, value: Any) -> str:
    return str(exact._run.fixed.mp.nstr(value, DIGITS + 2))


def _record(
    solution: Any, points: list[tuple[str, float]], text: Callable[[Any], str]
) -> dict[str, Any]:
    """Return what is kept of a solution."""
    return {
        "approach": text(solution.approach),
        "Q": text(solution.total_shear),
        "boundaries": [[text(z.outer), text(z.outer_from_edge)] for z in solution.zones[:-1]],
        "points": [list(point) for point in points],
        "pressure": [text(solution.pressure(**{kind: at})) for kind, at in points],
        "traction": [text(solution.traction(**{kind: at})) for kind, at in points],
    }


def _without_edge_zone(scene: Scene) -> ReferenceSolution:
    """Solve with one stick disk and nothing but slip outside, where the law does not hold."""
    disk = solve(replace(scene, tangential_compliance=0.0), 1e-9).zones[0]
    module = sys.modules["spectral_contact.precise.certified"]
    found = PreciseLayout((0, 1), (Radius(disk.outer, disk.outer_from_edge),))
    with mock.patch.multiple(module, _layout=lambda *_: found, lawful=solved):
        return reference(scene, DIGITS)


def _inside(scene: Scene) -> dict[str, Any]:
    """Return the truth for an inner annulus so narrow that it changes nothing else."""
    stuck = reference(replace(scene, friction=math.inf), DIGITS)
    mp = stuck._run.fixed.mp
    friction = mp.mpf(scene.friction)

    def excess(s: Any) -> Any:
        return stuck.traction(s) / stuck.pressure(s) - friction

    zones = solve(scene, 1e-12, strict=False).zones
    middle = (zones[0].outer + zones[1].outer) / 2.0
    width = zones[1].outer - zones[0].outer
    ends = [
        mp.findroot(excess, (middle + k * width, middle + 0.4 * k * width), solver="anderson")
        for k in (-0.7, 0.7)
    ]
    record = _exact_record(stuck)
    record["boundaries"] = [[_digits(stuck, b), _digits(stuck, 1 - b)] for b in ends]
    return record
