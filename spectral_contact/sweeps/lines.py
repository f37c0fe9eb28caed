"""Scenes that differ in ``f/kappa`` alone: few of these are solved, and all scenes lie between.

Poisson's ratio enters by kappa: with the same ``f/kappa`` zones are the same, and tractions are as
kappa, the sign included. With one stick disk ``ln f`` and ``ln(Q/f)`` are smooth in the logit of
its radius: whatever the compliances, singularities are pi away from the real axis. Polynomials go
through solved frictions there (`curves`), and are inverted for those of the scenes.

No law has to be checked between two frictions at which one disk is right (docs/maps).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from spectral_contact.contact.tuning import ROUNDING
from spectral_contact.fields import Array
from spectral_contact.fields.curves import LEAST, Curves, Placed, nodes_allowed, nodes_needed
from spectral_contact.fields.shakedown import shakedown
from spectral_contact.solution import Solution
from spectral_contact.sweeps.request import Request, Served
from spectral_contact.sweeps.sweep_parameters import Columns, Indices

if TYPE_CHECKING:
    from spectral_contact.sweeps.chunk import OnLine

#: What is proportional to kappa at the same ``f/kappa``.
_AS_KAPPA: Final = frozenset({"edge_ratio", "critical_friction"})
#: What is known between solved frictions.
_KNOWN: Final = _AS_KAPPA | {"approach", "stick_radius", "total_shear", "shakedown_ratio"}


def lines(columns: Columns, todo: Indices, request: Request) -> Iterator[Indices]:
    """Yield scenes, of those to do, that differ in ``f/kappa`` alone, as it rises; none coupled."""
    if not frozenset(request.quantities) <= _KNOWN:
        return
    friction = columns.values[3, todo]
    slips = (friction > 0.0) & (friction < np.inf) & (columns.kappa[todo] != 0.0)
    own = todo[slips & ~columns.coupled[todo] & columns.at_largest_load[todo]]
    with np.errstate(over="ignore"):  # a friction of any size
        ratio = columns.values[3, own] / np.abs(columns.kappa[own])
    own = own[np.lexsort([ratio, *columns.values[[2, 1]][:, own]])]
    turns = np.diff(columns.values[1:3, own], axis=1) != 0.0
    for line in np.split(own, np.flatnonzero(turns.any(axis=0)) + 1):
        if len(line) >= LEAST:
            yield line


def between(columns: Columns, request: Request, solver: OnLine) -> Served:
    """Return what is known of the scenes of a line from a few that are solved.

    Parameters
    ----------
    columns : Columns
        The scenes, by rising ``f/kappa``.
    request : Request
        For numbers alone.
    solver : OnLine
    """
    kappa, friction = np.abs(columns.kappa), columns.values[3]
    ratio = friction / kappa
    mask = np.zeros(len(columns), dtype=bool)
    nothing = Served(mask, {}, {})
    ends = _ends(ratio, bool(np.less(*columns.values[1:3, 0])), solver)  # where an edge may stick
    if ends is None:
        return nothing
    size, one = ends.size, ends.solution
    inner, most = slice(1, size - 1), nodes_allowed(size)
    low, high = ends.logits
    if nodes_needed(low, high, request.rtol) > most:
        return nothing
    # of ln(f/kappa) and ln(Q/f)
    curves = Curves(low, high, 2)
    while curves.nodes.size < most:
        if curves.settled(request.rtol):
            values, errors = _disks(curves.where(np.log(ratio[inner])))
            values["total_shear"] *= friction[inner] * np.sign(columns.kappa[inner])
            values["shakedown_ratio"], errors["shakedown_ratio"] = shakedown(
                one.critical_friction / abs(one.scene.kappa),
                one.error.critical_friction or 0.0,
                ratio[inner],
            )
            for name in frozenset(request.quantities) - frozenset(values):  # at any friction
                scale = kappa[inner] / abs(one.scene.kappa) if name in _AS_KAPPA else 1.0
                values[name] = np.full(size - 2, float(getattr(one, name))) * scale
                errors[name] = np.full(size - 2, float(getattr(one.error, name)))
            asked = request.quantities
            # next to the critical friction the shakedown ratio has fewer digits, solved or not
            bound = frozenset(asked) - {"shakedown_ratio"}
            if all((errors[name] <= request.rtol).all() for name in bound):
                mask[inner] = True
                return Served(mask, {k: values[k] for k in asked}, {k: errors[k] for k in asked})
        found = solver.at_radius(curves.next())
        if found is None:
            break
        known = np.log([found.friction / kappa[0], found.total_shear / found.friction])
        curves.add(known, np.array([found.friction_error, found.shear_error]))
    return nothing


def _disks(found: Placed) -> tuple[dict[str, Array], dict[str, Array]]:
    """Return stick radii and ``Q/f``, and the estimates of their errors."""
    logit, moved = found.places, found.moved
    z, y = 1.0 / (1.0 + np.exp(-logit)), 1.0 / (1.0 + np.exp(logit))
    values = {"stick_radius": np.sqrt(z), "total_shear": np.exp(found.values[:, 0])}
    errors = {
        "stick_radius": 0.5 * y * moved + ROUNDING,
        "total_shear": found.lost[:, 0] + found.slopes[:, 0] * moved + ROUNDING,
    }
    return values, errors


@dataclass(frozen=True, slots=True)
class _Ends:
    """How many scenes have one stick disk, the logits of the first and the last, a solution."""

    size: int
    logits: tuple[float, float]
    solution: Solution


def _ends(ratio: Array, sticky: bool, solver: OnLine) -> _Ends | None:
    """Return between which scenes there is one stick disk, if it is at the first and many more."""
    alone: dict[int, Solution] = {}

    def is_alone(i: int) -> bool:
        # an edge that full stick does not make slip: slip is inside, and a solution tells no more
        if sticky and alone and 0.0 < alone[0].edge_ratio < ratio[i] * abs(alone[0].scene.kappa):
            return False
        more = "stick_radius", "zones", "critical_friction", *["edge_ratio"] * sticky
        found = solver.at_scene(i, more)
        if found is None or tuple(zone.kind for zone in found.zones) != ("stick", "slip"):
            return False
        alone[i] = found
        return True

    low, high = 0, len(ratio) - 1
    if not is_alone(low):
        return None
    # where one disk is right at two frictions, it is between
    if is_alone(high):
        low = high
    elif is_alone(LEAST - 1):
        low = LEAST - 1
    else:
        return None
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if is_alone(middle) else (low, middle)
    disks = [alone[i].zones[0] for i in (0, low)]
    z, y = np.array([(one.outer**2, one.outer_from_edge * (1.0 + one.outer)) for one in disks]).T
    if not (np.minimum(z, y) > 0.0).all():
        return None
    first, last = np.log(z / y).tolist()
    return _Ends(low + 1, (first, last), alone[0]) if first < last else None
