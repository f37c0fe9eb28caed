"""Where the loads of a solution are not smooth, and where stress has no limit for that."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from spectral_contact.equations.interior.mesh import BodyPoints, Evaluator, Grading, graded
from spectral_contact.fields import Array
from spectral_contact.fields.series import CENTRE, EDGE, Radius, ZonalField
from spectral_contact.profiles import Flat

if TYPE_CHECKING:
    from spectral_contact.scene import Scene
    from spectral_contact.solution import Solution

#: E-folds of the panels towards the edge, where the loads are bounded and where they are not.
_BOUNDED_FOLDS, _SINGULAR_FOLDS = 60, 115
#: How close to such a place stresses are given: closer, the panels at the edge do not reach.
_CLOSEST = 1e-16
#: By how much a radius is moved that cannot be told from where the pressure is infinite.
_NUDGE = 4e-16
#: Roundings of a radius, over the distance from it, that a stress misses by where the pressure is
#: infinite (measured: 0.6).
_AT_INFINITE = 3.0
#: At other boundaries roundings, over the root of the distance (measured: 0.02), and what the
#: boundary may be wrong by, over the same (0.4).
_AT_OTHERS, _MOVED = 0.1, 1.0
_ROUNDING = float(np.finfo(float).eps)


def boundaries(solution: Solution) -> list[Radius]:
    """Return the ends of all zones of the loads, with the centre and the edge."""
    inner = {
        piece.outer.value: piece.outer
        for field in (solution.pressure_field, solution.traction_field)
        if isinstance(field, ZonalField)
        for piece in field.pieces
        if piece.outer.from_edge > 0.0
    }
    return [CENTRE, *(inner[value] for value in sorted(inner)), EDGE]


def pointed(solution: Solution) -> bool:
    """Return whether loads are not smooth at the centre: under a tip, or since contact began."""
    profile = solution.scene.profile
    return profile is not None and (profile.pointed or solution.traction_field is not None)


def grading(solution: Solution) -> Grading:
    """Return the ends of the panels over the contact."""
    scene = solution.scene
    smooth = scene.normal_compliance == 0.0
    smooth |= solution.traction_field is not None and scene.tangential_compliance == 0.0
    infinite = smooth and loaded_edge(scene)
    folds = _SINGULAR_FOLDS if infinite else _BOUNDED_FOLDS
    return graded(boundaries(solution), folds, folds if pointed(solution) else 0)


def loaded_edge(scene: Scene) -> bool:
    """Return whether the pressure does not vanish at the edge: a flat punch, or adhesion."""
    flat = scene.profile is None or isinstance(scene.profile, Flat)
    return flat or scene.work_of_adhesion is not None


def singular(solution: Solution) -> list[Radius]:
    """Return where stress is infinite, or depends on the direction.

    That is the edge of a flat punch, or with adhesion; under a profile, where pressure goes to zero
    at the edge, the tip of a cone or the corner of a truncated one, on a smooth surface.
    """
    edge = [EDGE] * loaded_edge(solution.scene)
    if solution.scene.profile is None:
        return edge
    field = solution.pressure_field
    assert field is not None
    inner = boundaries(solution)[:-1]
    values = [field(np.array(b.value), np.array(b.from_edge)) for b in inner]
    return edge + [b for b, value in zip(inner, values, strict=True) if not np.isfinite(value)]


def finite(load: Evaluator) -> Evaluator:
    """Return a load that is finite where its radius is that of a corner but for rounding."""

    def nudged(s: Array, from_edge: Array) -> Array:
        values = np.asarray(load(s, from_edge))
        at = np.isinf(values) & (from_edge > 0.0)
        if at.any():
            values[at] = load(s[at] * (1.0 - _NUDGE), from_edge[at] + _NUDGE * s[at])
        return values

    return nudged


def distance(points: BodyPoints, place: Radius) -> Array:
    """Return how far points are from a place on the surface."""
    return np.asarray(np.hypot(points.beyond(place), points.z))


def within(points: BodyPoints, places: list[Radius]) -> NDArray[np.bool_]:
    """Return which points are as good as at one of some places."""
    found = np.zeros(len(points.r), dtype=bool)
    for place in places:
        found |= distance(points, place) < _CLOSEST
    return found


def lost(points: BodyPoints, solution: Solution) -> Array:
    """Return by how much stress is in doubt next to boundaries of zones, relative to it.

    There loads are evaluated at radii that are rounded, and the boundaries themselves are only
    known to their own error. At a boundary loads go like the root of the distance, beyond the
    width of a tangential layer. At corners they go like its logarithm, and the place of a corner
    over the contact radius is rounded, too. At a corner itself nothing is in doubt.
    """
    found, infinite, scene = np.zeros(len(points.r)), singular(solution), solution.scene
    flat = scene.profile is None
    layer = scene.tangential_compliance / (1.0 if flat else solution.contact_radius)
    for place in boundaries(solution)[1:-1]:
        size, away = min(place.value, place.from_edge), distance(points, place)
        if place in infinite:
            ratio = np.maximum(away / size, _ROUNDING)
            found += np.where(away > 0.0, _AT_INFINITE * _ROUNDING / ratio, 0.0)
        else:
            wrong = _AT_OTHERS * _ROUNDING + _MOVED * min(solution.error.zones or 0.0, 1.0)
            found += wrong / np.sqrt(np.maximum((away + layer) / size, wrong))
    return found
