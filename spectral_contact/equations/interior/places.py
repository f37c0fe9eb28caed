"""Where the loads of a solution are not smooth, and where therefore stress has no limit."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from spectral_contact.equations.interior.mesh import (
    BodyPoints,
    Evaluator,
    Grading,
    between,
    graded,
)
from spectral_contact.fields import Array
from spectral_contact.fields.series import CENTRE, EDGE, Radius, ZonalField
from spectral_contact.profiles import Flat
from spectral_contact.profiles.hull import LEAST_STEP

if TYPE_CHECKING:
    from spectral_contact.scene import Scene
    from spectral_contact.solution import Solution

#: E-folds of the panels towards the edge where the loads are bounded: down to 1e-26.
_BOUNDED_FOLDS = 60
#: The same where they may be infinite: down to 1e-50.
_SINGULAR_FOLDS = 115
#: Stresses are refused at points that are closer, in contact radii, to a place where they have no
#: limit.
_CLOSEST = 1e-16
#: The radius of a point next to a corner may round to that of the corner. Then the load is
#: evaluated at a radius that is smaller by this fraction.
_NUDGE = 4e-16
#: Relative error of stress that rounded radii make at the distance x from a zone boundary, in the
#: unit of `error_near_boundaries`. Next to an infinite pressure it is this times the rounding of
#: doubles, over x. The largest factor that was measured is 0.6.
_AT_INFINITE = 3.0
#: Next to any other boundary it is this times the rounding, over the root of x (largest factor
#: measured: 0.02).
_AT_OTHERS = 0.1
#: The error of such a boundary adds this times itself, over the same root (largest factor measured:
#: 0.4).
_BY_BOUNDARY = 1.0
_ROUNDING = float(np.finfo(float).eps)


def boundaries(solution: Solution) -> list[Radius]:
    """Return the ends of all zones of the loads, with the centre and the edge.

    Pressure and traction have the breaks of the profile in common, which may differ by rounding, as
    those of a contact that grows follow from logarithms. Such radii count as one.
    """
    by_value = {
        piece.outer.value: piece.outer
        for field in (solution.pressure_field, solution.traction_field)
        if isinstance(field, ZonalField)
        for piece in field.pieces
        if piece.outer.from_edge > 0.0
    }
    ends = [CENTRE]
    for value in sorted(by_value):
        place = by_value[value]
        # `between` takes the difference of the distances from the edge in the outer half
        scale = place.from_edge if value > 0.5 else value
        if between(ends[-1], place) > LEAST_STEP * scale:
            ends.append(place)
    return [*ends, EDGE]


def pointed(solution: Solution) -> bool:
    """Return whether loads are not smooth at the centre.

    Under a tip neither load is smooth. The traction of a contact that has grown from the centre is
    not smooth there under any profile.
    """
    profile = solution.scene.profile
    return profile is not None and (profile.pointed or solution.traction_field is not None)


def grading(solution: Solution) -> Grading:
    """Return the ends of the panels over the contact."""
    scene = solution.scene
    without_layer = scene.normal_compliance == 0.0
    without_layer |= solution.traction_field is not None and scene.tangential_compliance == 0.0
    unbounded = without_layer and loaded_edge(scene)
    folds = _SINGULAR_FOLDS if unbounded else _BOUNDED_FOLDS
    return graded(boundaries(solution), folds, folds if pointed(solution) else 0)


def loaded_edge(scene: Scene) -> bool:
    """Return whether the pressure does not vanish at the edge: a flat punch, or adhesion."""
    flat = scene.profile is None or isinstance(scene.profile, Flat)
    return flat or scene.work_of_adhesion is not None


def singular(solution: Solution) -> list[Radius]:
    """Return the places where stress is infinite, or depends on the direction.

    One such place is the edge, of a flat punch or with adhesion. On a smooth surface under a
    profile the others are tips and corners, at which the pressure is infinite.
    """
    edge = [EDGE] if loaded_edge(solution.scene) else []
    if solution.scene.profile is None:
        return edge
    field = solution.pressure_field
    assert field is not None
    inside = boundaries(solution)[:-1]
    pressures = [field(np.array(place.value), np.array(place.from_edge)) for place in inside]
    return edge + [place for place, p in zip(inside, pressures, strict=True) if not np.isfinite(p)]


def finite(load: Evaluator) -> Evaluator:
    """Return a load that is finite inside the edge.

    A radius next to a corner may round to that of the corner, at which the load is infinite. Such a
    load is evaluated a few roundings farther inward (`_NUDGE`).
    """

    def finite_load(s: Array, from_edge: Array) -> Array:
        values = np.asarray(load(s, from_edge))
        at_corner = np.isinf(values) & (from_edge > 0.0)
        if at_corner.any():
            inward = s[at_corner] * (1.0 - _NUDGE)
            values[at_corner] = load(inward, from_edge[at_corner] + _NUDGE * s[at_corner])
        return values

    return finite_load


def distance(points: BodyPoints, place: Radius) -> Array:
    """Return the distances of points from a place on the surface."""
    return np.asarray(np.hypot(points.beyond(place), points.z))


def within(points: BodyPoints, places: list[Radius]) -> NDArray[np.bool_]:
    """Return which points are so close to one of the places that stresses are refused."""
    close = np.zeros(len(points.r), dtype=bool)
    for place in places:
        close |= distance(points, place) < _CLOSEST
    return close


def error_near_boundaries(points: BodyPoints, solution: Solution) -> Array:
    """Return the relative errors of stress that are due to the radii of zone boundaries.

    Next to a boundary loads are evaluated at rounded radii, and the boundary is only known to its
    own error. At distances above the width of the tangential layer, loads vary there like the root
    of the distance. At a corner they vary like the logarithm of the distance, and the radius of the
    corner over the contact radius is rounded, too, and has the error of the contact radius. A point
    at the corner itself has no such error. The unit of distances is the distance of the boundary
    from the centre or from the edge, whichever is smaller.
    """
    errors = np.zeros(len(points.r))
    radius_error = solution.error.contact_radius or 0.0
    corners = singular(solution)
    scene = solution.scene
    flat = scene.profile is None
    # the width of the layer, in contact radii as all lengths here
    layer = scene.tangential_compliance / (1.0 if flat else solution.contact_radius)
    for place in boundaries(solution)[1:-1]:
        unit = min(place.value, place.from_edge)
        distances = distance(points, place)
        if place in corners:
            ratio = np.maximum(distances / unit, _ROUNDING)
            shift = _AT_INFINITE * _ROUNDING + radius_error * place.value / unit
            errors += np.where(distances > 0.0, shift / ratio, 0.0)
        else:
            boundary_error = _BY_BOUNDARY * min(solution.error.zones or 0.0, 1.0)
            shift = _AT_OTHERS * _ROUNDING + boundary_error
            errors += shift / np.sqrt(np.maximum((distances + layer) / unit, shift))
    return errors
