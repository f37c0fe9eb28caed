"""Load, approach, contact radius or separation of a profile, and profiles in documents."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from fractions import Fraction
from math import isinf
from typing import Any, Final

import numpy as np

from spectral_contact.errors import SceneError
from spectral_contact.io.checks import positive, real
from spectral_contact.io.kinds import kind_from
from spectral_contact.io.physical_data import LARGEST_COMPLIANCE, SMALLEST_COMPLIANCE
from spectral_contact.profiles.profile_base import Profile
from spectral_contact.profiles.sampled_profile import Sampled
from spectral_contact.profiles.shapes import (
    Cone,
    Flat,
    Parabola,
    PowerLaw,
    RoundedFlat,
    Sphere,
    TruncatedCone,
)
from spectral_contact.profiles.sums import Sum

#: What may be given of a contact under a profile, one of them.
CONTROLS: Final = ("contact_radius", "load", "approach")
#: The same where a layer may have pressure at every gap.
ALL_CONTROLS: Final = (*CONTROLS, "separation")
#: Least pressure of a layer at a given approach or separation. The load, a product of it with an
#: area, is then still a double with all digits.
_LEAST_PRESSURE: Final = 1e-290
#: Profiles by the name that they have in files.
KINDS: Final[dict[str, type[Profile]]] = {
    one.__name__: one
    for one in (Parabola, Sphere, PowerLaw, Cone, TruncatedCone, RoundedFlat, Sampled, Flat, Sum)
}
#: Names of the profiles that are given by numbers alone, with the names of these numbers.
SHAPES: Final = {
    name: tuple(one.name for one in fields(kind))  # type: ignore[arg-type]
    for name, kind in KINDS.items()
    if kind not in (Sampled, Flat, Sum)
}


def checked_controls(scene: Mapping[str, Any]) -> dict[str, float]:
    """Return what is given of a contact, by name: one number with a profile, none without.

    The scene is a mapping of all that it has, the compliance checked already.
    """
    profile = scene["profile"]
    layer = scene["layer"]
    given = {name: scene[name] for name in ALL_CONTROLS if scene[name] is not None}
    if profile is None:
        for name, value in given.items():
            told = "None without a profile: a flat punch's radius and load are the units"
            raise SceneError(name, value, told)
        return {}
    if type(profile) not in KINDS.values():
        raise SceneError("profile", profile, f"None or one of profiles: {', '.join(KINDS)}")
    assert isinstance(profile, Profile)
    adhesive = scene["work_of_adhesion"] is not None
    if isinstance(profile, Flat) and layer is None and scene["friction"] is not None:
        told = "None for a flat punch on a linear layer with friction, whose radius and load are "
        told += "the units: leave the profile out, and divide the compliances by its radius"
        raise SceneError("profile", profile, told)
    if len(given) != 1:
        told = "one value, the others None: give one of them with a profile"
        raise SceneError(", ".join(ALL_CONTROLS), tuple(map(scene.get, ALL_CONTROLS)), told)
    [(name, value)] = given.items()
    if name == "separation":
        return {name: _separated(value, layer)}
    if name == "contact_radius":
        return {name: _reached(value, profile, layer, scene["normal_compliance"], adhesive)}
    return {name: _pressed(name, value, layer, adhesive)}


def _reached(value: Any, profile: Profile, layer: Any, compliance: float, adhesive: bool) -> float:
    if isinstance(profile, Flat) or (layer is not None and isinf(layer.start)):
        told = "None: the contact has no edge that moves; give a load or an approach"
        raise SceneError("contact_radius", value, told)
    low = profile.flat_part
    high = profile.reach
    told = f"finite, and in ({low:.6g}, {high:.6g}), the range of the profile"
    limits: dict[str, Any] = {"low": low, "high": high, "low_open": True, "high_open": True}
    if adhesive and low > 0.0:  # the contact may be the flat part alone
        told = told.replace("(", "[", 1)
        limits["low_open"] = False
    radius = real("contact_radius", value, allowed=told, **limits)
    if compliance and not SMALLEST_COMPLIANCE <= compliance / radius <= LARGEST_COMPLIANCE:
        told = "such that normal_compliance / contact_radius is in [1e-14, 1e14]"
        raise SceneError("contact_radius", value, told)
    return radius


def _pressed(name: str, value: Any, layer: Any, adhesive: bool) -> float:
    if adhesive:
        return real(name, value, allowed="finite")
    if name == "approach" and layer is not None:
        told = f"finite and > {layer.start:.6g}, where the layer's pressure begins"
        number = real(name, value, allowed=told, low=layer.start, low_open=True)
        return _with_pressure(name, number, number, layer, "finite")
    return positive(name, value)


def _with_pressure(name: str, value: float, overclosure: float, layer: Any, allowed: str) -> float:
    """Return a value if the layer has a pressure at this overclosure."""
    with np.errstate(over="ignore", under="ignore"):
        if float(layer._pressure(np.array(overclosure))) >= _LEAST_PRESSURE:
            return value
    told = f"{allowed}, and such that the layer has a pressure there, at least {_LEAST_PRESSURE}"
    raise SceneError(name, value, told)


def _separated(value: Any, layer: Any) -> float:
    if layer is None or not isinf(layer.start):
        told = "None: only a layer law without a contact edge has one; give a load or an approach"
        raise SceneError("separation", value, told)
    allowed = f"finite, at least {-layer.limit:.6g}"
    number = real("separation", value, allowed=allowed, low=-layer.limit)
    return _with_pressure("separation", number, -number, layer, allowed)


def simplified(profile: Any) -> Any:
    """Return a profile, two parabolas as one and the two of any other sum in a fixed order."""
    if not isinstance(profile, Sum):
        return profile
    first = profile.first
    second = profile.second
    if isinstance(first, Parabola) and isinstance(second, Parabola):
        return Parabola(float(1 / (1 / Fraction(first.radius) + 1 / Fraction(second.radius))))
    return profile if repr(first) <= repr(second) else Sum(second, first)


def summed(profile: Any, punch_profile: Any) -> Any:
    """Return the gap between two bodies of which the second may be flat, as None."""
    if punch_profile is None:
        return profile
    if profile is None:
        told = "None without a profile of the other body: profile is that of the punch, too"
        raise SceneError("punch_profile", punch_profile, told)
    for name, one in (("profile", profile), ("punch_profile", punch_profile)):
        if not isinstance(one, Profile) or isinstance(one, Flat | Sum):
            raise SceneError(name, one, "a Profile that is not flat and no sum, with one of either")
    return simplified(Sum(profile, punch_profile))


def refuse_profile(scene: Any, what: str) -> None:
    """Refuse a scene with a profile, for a function that supports flat punches only."""
    if scene.profile is not None:
        told = f"a scene without a profile: {what} supports flat punches only"
        raise SceneError("scene", scene, told)


def profile_from(tree: Any) -> Profile:
    """Return the profile that `kind_tree` wrote."""
    return kind_from("profile", tree, KINDS)


def refuse_unloaded(scene: Any, what: str) -> None:
    """Refuse a scene below its largest load, for a function that does not support it."""
    if scene.unloaded_to < 1.0:
        told = f"a scene at its largest load: {what} does not support unloaded_to below 1"
        raise SceneError("scene", scene, told)
