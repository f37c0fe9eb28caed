"""Normal contact through a nonlinear layer at a given load, approach or separation."""

from __future__ import annotations

from math import inf

from spectral_contact.contact.contact_radius import Contact, find_radius, indenter, value_of
from spectral_contact.contact.layered_bends import Bend
from spectral_contact.contact.layered_contact import (
    LayeredSolution,
    layered_contact,
    solve_layered_from,
)
from spectral_contact.contact.layered_setting import has_edge, setting_at_radius
from spectral_contact.errors import SceneError
from spectral_contact.layers.layer_base import Layer
from spectral_contact.profiles import Profile

#: Tolerance of a contact that is a first guess only.
_GUESS_TOLERANCE = 1e-4


def through_layer(
    profile: Profile,
    layer: Layer,
    tolerance: float,
    max_unknowns: int,
    *,
    load: float | None = None,
    approach: float | None = None,
    separation: float | None = None,
    pointwise: bool,
    near: float | None = None,
    drives: bool = False,
) -> tuple[Contact, float]:
    """Return the contact, and the relative error of its radius.

    Parameters
    ----------
    profile : Profile
        A `SceneError` says if it ends inside the contact, or before the pressure is negligible.
    layer : Layer
    tolerance : float
    max_unknowns : int
        Most unknowns of a space.
    load, approach, separation : float or None
        The given one of them. The separation is the gap at the centre; scenes have one only under a
        law without an edge (`profiles.control`).
    pointwise : bool
        Whether the pressure is wanted.
    near : float or None
        A guess of the radius.
    drives : bool
        Whether the pressure, under a flat punch, has to drive a traction.
    """
    bends: tuple[Bend, ...] = ()
    previous: LayeredSolution | None = None

    def contact_at(radius: float, tolerance: float, pointwise: bool) -> Contact:
        # the solution is like the previous one, and the law bends near the radii where it did
        nonlocal bends, previous
        setting = setting_at_radius(profile, layer, radius, bends)
        try:
            found, previous = solve_layered_from(
                previous, setting, tolerance, max_unknowns, pointwise=pointwise
            )
        except SceneError as error:
            # the error is about the radius tried, but the user has given a load or an approach
            name, value = ("load", load) if approach is None else ("approach", approach)
            raise SceneError(name, value, f"that of a contact radius {error.allowed}") from error
        bends = value_of(found).bends
        return found

    if not has_edge(profile, layer):
        found = layered_contact(
            profile,
            layer,
            tolerance,
            max_unknowns,
            load=load,
            approach=approach,
            separation=separation,
            pointwise=pointwise,
            drives=drives,
        )
        return found, 0.0
    return find_radius(
        profile,
        contact_at,
        tolerance,
        load=load,
        approach=approach,
        pointwise=pointwise,
        near=near or _smooth_radius(profile, layer, load, approach),
        origin=layer.start,
    )


def _smooth_radius(
    profile: Profile, layer: Layer, load: float | None, approach: float | None
) -> float | None:
    """Return the contact radius on a smooth surface under the same load, or at the same depth.

    The search for the radius begins there, since at far larger ones an exponential law overflows.
    The depth is the approach less its value at first contact. There is no such radius (None) if the
    profile ends before.
    """
    smooth = indenter(profile, 0.0, 0)
    indentation = None if approach is None else approach - layer.start
    try:
        found, _ = find_radius(
            profile, smooth, _GUESS_TOLERANCE, load=load, approach=indentation, pointwise=False
        )
    except SceneError:  # the profile ends before
        return None
    radius = value_of(found).radius
    return radius if radius < inf else None
