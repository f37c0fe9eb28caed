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
from spectral_contact.fields.curves import LEAST, Curves, Placed, nodes_allowed, nodes_needed
from spectral_contact.fields.shakedown import shakedown
from spectral_contact.solution import Solution
from spectral_contact.sweeps.request import Request, Served
from spectral_contact.sweeps.sweep_parameters import Columns, Indices

if TYPE_CHECKING:
    from spectral_contact.sweeps.chunk import OnLine

#: Quantities that are proportional to the modulus of kappa at the same ``f/kappa``.
_AS_KAPPA: Final = frozenset({"edge_ratio", "critical_friction"})
#: Quantities that are known of all scenes of a line.
_KNOWN: Final = _AS_KAPPA | {"approach", "stick_radius", "total_shear", "shakedown_ratio"}


def lines(columns: Columns, todo: Indices, request: Request) -> Iterator[Indices]:
    """Yield groups of the scenes to do that differ in ``f/kappa`` alone.

    Each is an array of indices in the order of rising ``f/kappa``. Scenes with elastic coupling are
    in none.
    """
    if not frozenset(request.quantities) <= _KNOWN:
        return
    friction = columns.friction[todo]
    slips = (friction > 0.0) & (friction < np.inf) & (columns.kappa[todo] != 0.0)
    own = todo[slips & ~columns.coupled[todo] & columns.at_largest_load[todo]]
    with np.errstate(over="ignore"):  # a friction of any size
        ratio = columns.friction[own] / np.abs(columns.kappa[own])
    # by alpha, then beta, then f/kappa: lexsort takes the first criterion last
    own = own[np.lexsort([ratio, columns.beta[own], columns.alpha[own]])]
    differs = (np.diff(columns.alpha[own]) != 0.0) | (np.diff(columns.beta[own]) != 0.0)
    for line in np.split(own, np.flatnonzero(differs) + 1):
        if len(line) >= LEAST:
            yield line


def between(columns: Columns, request: Request, solver: OnLine) -> Served:
    """Return what is known of the scenes of a line from a few that are solved.

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
    one = ends.solution
    inner = slice(1, size - 1)
    most = nodes_allowed(size)
    low, high = ends.logits
    if nodes_needed(low, high, request.rtol) > most:
        return nothing
    # the functions ln(f/kappa) and ln(Q/f) of the logit
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
            # what does not depend on friction is that of the first scene
            for name in frozenset(request.quantities) - frozenset(values):
                scale = kappa[inner] / abs(one.scene.kappa) if name in _AS_KAPPA else 1.0
                values[name] = np.full(size - 2, float(getattr(one, name))) * scale
                errors[name] = np.full(size - 2, float(getattr(one.error, name)))
            asked = request.quantities
            # next to the critical friction the shakedown ratio has fewer digits than rtol, also if
            # the scene is solved
            checked = frozenset(asked) - {"shakedown_ratio"}
            if all((errors[name] <= request.rtol).all() for name in checked):
                mask[inner] = True
                return Served(mask, {k: values[k] for k in asked}, {k: errors[k] for k in asked})
        found = solver.with_stick_radius(curves.next())
        if found is None:
            break
        # of the first scene, for which the friction was solved
        known = np.log([found.friction / kappa[0], found.total_shear / found.friction])
        curves.add(known, np.array([found.friction_error, found.shear_error]))
    return nothing


def _disks(found: Placed) -> tuple[dict[str, Array], dict[str, Array]]:
    """Return stick radii and, as total shears, ``Q/f``, with the estimates of their errors."""
    logit = found.places
    moved = found.moved
    # c**2 and 1 - c**2: the relative error of c is (1 - c**2)/2 times the error of the logit
    z = 1.0 / (1.0 + np.exp(-logit))
    y = 1.0 / (1.0 + np.exp(logit))
    values = {"stick_radius": np.sqrt(z), "total_shear": np.exp(found.values[:, 0])}
    errors = {
        "stick_radius": 0.5 * y * moved + ROUNDING,
        "total_shear": found.lost[:, 0] + found.slopes[:, 0] * moved + ROUNDING,
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
        more: tuple[str, ...] = ("stick_radius", "zones", "critical_friction")
        if edge_may_stick:
            more = (*more, "edge_ratio")
        found = solver.at_scene(i, more)
        if found is None or tuple(zone.kind for zone in found.zones) != ("stick", "slip"):
            return False
        solved[i] = found
        return True

    last = 0
    beyond = len(ratio) - 1
    if not has_one_disk(last):
        return None
    # where one disk is right at two frictions, it is right between: the last one is bisected for
    if has_one_disk(beyond):
        last = beyond
    elif has_one_disk(LEAST - 1):
        last = LEAST - 1
    else:
        return None
    while beyond - last > 1:
        middle = (last + beyond) // 2
        if has_one_disk(middle):
            last = middle
        else:
            beyond = middle
    disks = [solved[i].zones[0] for i in (0, last)]
    z = np.array([one.outer**2 for one in disks])
    # 1 - c**2 without cancellation
    y = np.array([one.outer_from_edge * (1.0 + one.outer) for one in disks])
    if not (np.minimum(z, y) > 0.0).all():
        return None
    low, high = np.log(z / y).tolist()
    return _Ends(last + 1, (low, high), solved[0]) if low < high else None
