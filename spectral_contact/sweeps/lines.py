"""Lines: scenes that differ in ``f/kappa`` alone. A few are solved, the others are interpolated.

Poisson's ratio enters by kappa alone (docs/theory): scenes with the same ``f/kappa`` have the same
zones, and their tractions are proportional to kappa, with its sign. Where the zones are one stick
disk with slip around it, ``ln f`` and ``ln(Q/f)`` are smooth functions of the logit of its radius
c, ``ln(c**2/(1 - c**2))``. Their singularities that are nearest to the real axis are at the
distance pi from it, where ``c**2/(1 - c**2)`` is negative, whatever the compliances. At chosen
radii the friction is solved for, polynomials go through these nodes (`fields.curves`), and are
inverted at the frictions of the scenes.

If one stick disk obeys the friction law at two frictions, it obeys it at all frictions between, so
that the interpolated scenes need no check (docs/internals).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from spectral_contact.contact.tuning import ROUNDING
from spectral_contact.fields import Array
from spectral_contact.fields.curves import (
    LEAST,
    Curves,
    InvertedCurves,
    nodes_allowed,
    nodes_needed,
)
from spectral_contact.fields.shakedown import shakedown
from spectral_contact.solution import Solution
from spectral_contact.sweeps.request import Request, Served
from spectral_contact.sweeps.sweep_parameters import Columns, Indices

if TYPE_CHECKING:
    from spectral_contact.sweeps.chunk import OnLine

#: Quantities that are proportional to the modulus of kappa at the same ``f/kappa``.
_PROPORTIONAL_TO_KAPPA: Final = frozenset({"edge_ratio", "critical_friction"})
#: Quantities that can be interpolated along a line.
_LINE_QUANTITIES: Final = _PROPORTIONAL_TO_KAPPA | {
    "approach",
    "stick_radius",
    "total_shear",
    "shakedown_ratio",
}


def lines(columns: Columns, todo: Indices, request: Request) -> Iterator[Indices]:
    """Yield groups of the scenes to do that differ in ``f/kappa`` alone.

    Each is an array of indices in the order of rising ``f/kappa``. Scenes with elastic coupling are
    in none.
    """
    if not frozenset(request.quantities) <= _LINE_QUANTITIES:
        return
    friction = columns.friction[todo]
    slips = (friction > 0.0) & (friction < np.inf) & (columns.kappa[todo] != 0.0)
    candidates = todo[slips & ~columns.coupled[todo] & columns.at_largest_load[todo]]
    with np.errstate(over="ignore"):  # a friction of any size
        ratio = columns.friction[candidates] / np.abs(columns.kappa[candidates])
    # by alpha, then beta, then f/kappa: lexsort takes the first criterion last
    candidates = candidates[
        np.lexsort([ratio, columns.beta[candidates], columns.alpha[candidates]])
    ]
    differs = (np.diff(columns.alpha[candidates]) != 0.0) | (
        np.diff(columns.beta[candidates]) != 0.0
    )
    for line in np.split(candidates, np.flatnonzero(differs) + 1):
        if len(line) >= LEAST:
            yield line


def interpolate_line(columns: Columns, request: Request, solver: OnLine) -> Served:
    """Return results of the scenes of a line, interpolated between a few that are solved.

    Parameters
    ----------
    columns : Columns
        The scenes, by rising ``f/kappa``.
    request : Request
        Of quantities that are a number for each scene.
    solver : OnLine
        Solves scenes of the line, and for the friction of a given stick radius; returns None where
        that fails.

    Returns
    -------
    Served
        Without scenes if too many nodes would have to be solved. The first and the last scene with
        one stick disk, which the solver has solved, are not among them.
    """
    kappa = np.abs(columns.kappa)
    friction = columns.friction
    ratio = friction / kappa
    mask = np.zeros(len(columns), dtype=bool)
    nothing = Served(mask, {}, {})
    # slip begins at the edge if alpha >= beta, else in an annulus within a ring that sticks
    edge_may_stick = bool(columns.alpha[0] < columns.beta[0])
    ends = _ends(ratio, edge_may_stick, solver)
    if ends is None:
        return nothing
    size = ends.size
    first = ends.solution
    inside = slice(1, size - 1)
    most_nodes = nodes_allowed(size)
    low, high = ends.logits
    if nodes_needed(low, high, request.rtol) > most_nodes:
        return nothing
    # the functions ln(f/kappa) and ln(Q/f) of the logit
    curves = Curves(low, high, 2)
    while curves.nodes.size < most_nodes:
        if curves.settled(request.rtol):
            values, errors = _disks(curves.invert(np.log(ratio[inside])))
            values["total_shear"] *= friction[inside] * np.sign(columns.kappa[inside])
            values["shakedown_ratio"], errors["shakedown_ratio"] = shakedown(
                first.critical_friction / abs(first.scene.kappa),
                first.error.critical_friction or 0.0,
                ratio[inside],
            )
            # quantities that do not depend on friction are those of the first scene
            for name in frozenset(request.quantities) - frozenset(values):
                scale = (
                    kappa[inside] / abs(first.scene.kappa)
                    if name in _PROPORTIONAL_TO_KAPPA
                    else 1.0
                )
                values[name] = np.full(size - 2, float(getattr(first, name))) * scale
                errors[name] = np.full(size - 2, float(getattr(first.error, name)))
            names = request.quantities
            # next to the critical friction the shakedown ratio has fewer digits than rtol, also if
            # the scene is solved
            checked = frozenset(names) - {"shakedown_ratio"}
            if all((errors[name] <= request.rtol).all() for name in checked):
                mask[inside] = True
                return Served(mask, {k: values[k] for k in names}, {k: errors[k] for k in names})
        node = solver.with_stick_radius(curves.next())
        if node is None:
            break
        # `node` is for the kappa of the first scene
        log_values = np.log([node.friction / kappa[0], node.total_shear / node.friction])
        curves.add(log_values, np.array([node.friction_error, node.shear_error]))
    return nothing


def _disks(inverted: InvertedCurves) -> tuple[dict[str, Array], dict[str, Array]]:
    """Return stick radii and, as total shears, ``Q/f``, with the estimates of their errors."""
    logit = inverted.places
    logit_errors = inverted.place_errors
    # c**2 and 1 - c**2: the relative error of c is (1 - c**2)/2 times the error of the logit
    z = 1.0 / (1.0 + np.exp(-logit))
    y = 1.0 / (1.0 + np.exp(logit))
    values = {"stick_radius": np.sqrt(z), "total_shear": np.exp(inverted.values[:, 0])}
    errors = {
        "stick_radius": 0.5 * y * logit_errors + ROUNDING,
        "total_shear": inverted.value_errors[:, 0]
        + inverted.slopes[:, 0] * logit_errors
        + ROUNDING,
    }
    return values, errors


@dataclass(frozen=True, slots=True)
class _Ends:
    """The scenes of a line with one stick disk: from the first scene to the last such one.

    Attributes
    ----------
    size : int
        Their number.
    logits : tuple of float
        The logits of the stick radii of the first and of the last one.
    solution : Solution
        That of the first scene.
    """

    size: int
    logits: tuple[float, float]
    solution: Solution


def _ends(ratio: Array, edge_may_stick: bool, solver: OnLine) -> _Ends | None:
    """Return the scenes that have one stick disk, which are the first ones of a line.

    None if the first scene has other zones, or if fewer than `LEAST` have one disk.
    """
    solved: dict[int, Solution] = {}

    def has_one_disk(i: int) -> bool:
        if edge_may_stick and solved:
            # the edge sticks if the friction is above q/p of full stick at the edge
            first = solved[0]
            if 0.0 < first.edge_ratio < ratio[i] * abs(first.scene.kappa):
                return False
        extra_quantities: tuple[str, ...] = ("stick_radius", "zones", "critical_friction")
        if edge_may_stick:
            extra_quantities = (*extra_quantities, "edge_ratio")
        solution = solver.at_scene(i, extra_quantities)
        if solution is None or tuple(zone.kind for zone in solution.zones) != ("stick", "slip"):
            return False
        solved[i] = solution
        return True

    last = 0
    above = len(ratio) - 1
    if not has_one_disk(last):
        return None
    # Where one disk is right at two frictions, it is right between. So the last scene with one
    # disk is found by bisection.
    if has_one_disk(above):
        last = above
    elif has_one_disk(LEAST - 1):
        last = LEAST - 1
    else:
        return None
    while above - last > 1:
        middle = (last + above) // 2
        if has_one_disk(middle):
            last = middle
        else:
            above = middle
    disks = [solved[i].zones[0] for i in (0, last)]
    z = np.array([disk.outer**2 for disk in disks])
    # 1 - c**2 without cancellation
    y = np.array([disk.outer_from_edge * (1.0 + disk.outer) for disk in disks])
    if not (np.minimum(z, y) > 0.0).all():
        return None
    low, high = np.log(z / y).tolist()
    return _Ends(last + 1, (low, high), solved[0]) if low < high else None
