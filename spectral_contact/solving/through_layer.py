"""Normal contact through a nonlinear layer, of whatever is given."""

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
_ROUGH = 1e-4


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
        Where the radius may be.
    drives : bool
        Whether the pressure, under a flat punch, has to drive a traction.
    """
    bends: tuple[Bend, ...] = ()
    last: LayeredSolution | None = None

    def at(radius: float, tolerance: float, pointwise: bool) -> Contact:
        # the solution is about the last one, and the law bends about where it did
        nonlocal bends, last
        setting = setting_at_radius(profile, layer, radius, bends)
        try:
            found, last = solve_layered_from(
                last, setting, tolerance, max_unknowns, pointwise=pointwise
            )
        except SceneError as error:
            # it is about the radius tried, which is not what the user has given
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
        at,
        tolerance,
        load=load,
        approach=approach,
        pointwise=pointwise,
        near=near or _nearby(profile, layer, load, approach),
        origin=layer.start,
    )


def _nearby(
    profile: Profile, layer: Layer, load: float | None, approach: float | None
) -> float | None:
    """Return the radius of a smooth contact under the same load or approach, None if there is none.

    The search for the radius begins there, since at far larger ones an exponential law overflows.
    """
    smooth = indenter(profile, 0.0, 0)
    deep = None if approach is None else approach - layer.start
    try:
        found, _ = find_radius(profile, smooth, _ROUGH, load=load, approach=deep, pointwise=False)
    except SceneError:  # the profile ends before
        return None
    radius = value_of(found).radius
    return radius if radius < inf else None
