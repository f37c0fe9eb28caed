"""Where the pressure under a nonlinear layer ends, and where it has features.

Under a law with an edge it ends at the contact radius. Under one with pressure at every gap it is
followed to where it has fallen below rounding of its largest value; if the layer is thin it turns
fast from contact to gap, and panels are graded to that place.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import exp, inf, log, pi, sqrt

import numpy as np
from numpy.typing import NDArray

from spectral_contact.contact.layered_bends import Bend
from spectral_contact.contact.layered_newton import LayeredSetting, balanced
from spectral_contact.contact.on_parts import feature_depths, layer_depth, profile_parts
from spectral_contact.errors import SceneError
from spectral_contact.fields.series import EDGE, Radius
from spectral_contact.layers.layer_base import Layer
from spectral_contact.profiles.profile_base import Profile
from spectral_contact.profiles.shapes import Flat
from spectral_contact.spectral.cells import DiskCells
from spectral_contact.spectral.parts import DiskPartition

Array = NDArray[np.float64]

#: Share of the pressure at the centre at which the disk ends.
_NOTHING = 1e-18
#: Where in the disk the turn may lie for panels to be graded to it, and how far from a break.
_INNER, _OUTER, _APART = 0.3, 0.85, 0.05
#: Load of a smooth contact over four times the product of radius and approach, that of a parabola.
_SHARE = 2.0 / 3.0
#: Largest radius that is looked at, how much less the least is, and how well one is found; a turn.
_FAR, _LEAST, _FOUND, _TURN = 1e100, 1e-200, 1e-3, 1e-12
#: Steps of a bisection of the overclosure, and where it begins, in sizes of the law.
_STEPS, _RANGE = 60, 1e3
#: First cell next to the turn in its width, by what the next is wider, and the widest; by how much
#: the last may be wider than that.
_CELL, _WIDER, _WIDEST, _LAST = 1.0, 2.5, 0.3, 0.1
#: Deepest turn in ``x``.
_DEEPEST = 25.0


def has_edge(profile: Profile, layer: Layer) -> bool:
    """Return whether the contact has a radius that the load decides."""
    return layer.start > -inf and not isinstance(profile, Flat)


def setting_at_radius(
    profile: Profile, layer: Layer, radius: float, bends: tuple[Bend, ...] = ()
) -> LayeredSetting:
    """Return the setting of a contact radius, for a law with an edge that bends at these radii."""
    return _to_edge(profile, layer, radius, None, bends)


def with_bends(setting: LayeredSetting, bends: tuple[Bend, ...]) -> LayeredSetting:
    """Return the setting with parts that end where the law bends, at these radii."""
    if setting.approach is None:
        return setting_at_radius(setting.profile, setting.layer, setting.radius, bends)
    found = setting_at_approach(setting.profile, setting.layer, setting.approach, bends)
    return replace(found, load=setting.load, centre=setting.centre, drives=setting.drives)


def setting_at_approach(
    profile: Profile, layer: Layer, approach: float, bends: tuple[Bend, ...] = ()
) -> LayeredSetting:
    """Return the setting of an approach, for a flat punch or a law without an edge.

    Parameters
    ----------
    profile : Profile
    layer : Layer
    approach : float
    bends : tuple of Bend
        Where the law is taken to bend.

    Raises
    ------
    SceneError
        If the profile ends before the pressure does.
    """
    if isinstance(profile, Flat):
        return _to_edge(profile, layer, profile.radius, approach, bends)
    radius = _domain(profile, layer, approach)
    turn = _turn(profile, layer, approach)
    knee = min(max(turn, _INNER * radius), _OUTER * radius)
    own, turns = profile_parts(profile, radius), []
    depth = _sharpness(profile, layer, approach, turn)
    if len(own.ends) == 1 and not layer.knots:
        cells = _cells(Radius(knee / radius, (radius - knee) / radius), exp(-depth))
        return LayeredSetting(profile, layer, radius, approach, own, (), (), cells=cells)
    if all(abs(one.value * radius - knee) >= _APART * radius for one in own.breaks):
        turns = [Radius(knee / radius, (radius - knee) / radius)]
    parts = _with_smooth_breaks(own, [*turns, *(bend.radius for bend in bends)])
    central = layer._overclosure(_central(layer, approach, max(turn, layer._size)))
    thin = 1.0 / max(float(layer._slope(np.array(central))) * radius, 1.0)
    depths, smooth = [], []
    for boundary, _, extent in parts.ends:
        smooth.append(boundary in turns or boundary is EDGE)
        known = depth if boundary in turns and turn == knee else 0.0
        depths.append(known if smooth[-1] else layer_depth(thin, boundary, extent))
    return LayeredSetting(
        profile, layer, radius, approach, parts, tuple(depths), tuple(smooth), bends=bends
    )


def _with_smooth_breaks(parts: DiskPartition, radii: list[Radius]) -> DiskPartition:
    """Return the parts cut at radii, too, at which the profile is smooth."""
    breaks = sorted([*parts.breaks, *radii], key=lambda radius: radius.value)
    return DiskPartition(tuple(breaks), parts.pointed, tuple(radii))


def _cells(pivot: Radius, width: float) -> DiskCells:
    """Return cells that become larger with their distance from a pivot.

    Next to it they are as wide as the turn from contact to gap, over its square.
    """

    def steps(reach: float) -> Array:
        ends, step = [0.0], _CELL * width * pivot.square
        while ends[-1] < reach * (1.0 - _LAST):
            ends.append(ends[-1] + min(step, _WIDEST))
            step *= _WIDER
        return np.array(ends[1:]) * (reach / ends[-1])

    inner, outer = -steps(pivot.square)[::-1], steps(pivot.rest)
    return DiskCells(pivot, (*inner.tolist(), 0.0, *outer.tolist()))


def _to_edge(
    profile: Profile,
    layer: Layer,
    radius: float,
    approach: float | None,
    bends: tuple[Bend, ...],
) -> LayeredSetting:
    own = profile_parts(profile, radius)
    parts = _with_smooth_breaks(own, [bend.radius for bend in bends])
    setting = LayeredSetting(profile, layer, radius, approach, parts, (), ())
    if approach is None:
        room = 2.0 * float(profile._height(np.array(radius)))
    else:
        room = approach - setting.origin
    centre = np.array([room / radius])
    slope = float(setting.slope(balanced(setting, centre, np.minimum(centre, 0.0)))[0])
    thin = 1.0 / max(slope, 1.0)
    depths = feature_depths(parts, thin, profile._to_pole(radius))
    smooth = (False,) * len(depths)
    return replace(setting, depths=depths, smooth=smooth, bends=bends)


def _domain(profile: Profile, layer: Layer, approach: float) -> float:
    """Return the radius beyond which the pressure is rounding."""
    pressure = _central(layer, approach, max(_turn(profile, layer, approach), layer._size))
    room = approach - layer._overclosure(max(_NOTHING * pressure, float(np.finfo(float).tiny)))

    def beyond(radius: float) -> bool:
        with np.errstate(over="ignore"):
            return float(profile._height(np.array(radius))) > room

    high = min(profile.reach, _FAR)
    if not beyond(high * (1.0 - _FOUND)):
        told = "such that the pressure ends before the profile does: "
        told += f"at its end, {high:.6g}, it is not below rounding yet"
        raise SceneError("approach", approach, told)
    return _bisected(beyond, high)


def _bisected(beyond: Callable[[float], bool], high: float, near: float = _FOUND) -> float:
    """Return the least radius for which a condition holds, as it does at the highest."""
    low = high * _LEAST
    while high - low > near * high:
        middle = sqrt(low) * sqrt(high)
        low, high = (low, middle) if beyond(middle) else (middle, high)
    return high


def _central(layer: Layer, approach: float, radius: float) -> float:
    """Return about the pressure at the centre of a contact of this radius."""
    low, high = approach - _RANGE * layer._size - radius, approach

    def more(w: float) -> bool:
        with np.errstate(over="ignore"):
            return w + 0.5 * radius * float(layer._pressure(np.array(w))) > approach

    for _ in range(_STEPS):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if more(middle) else (middle, high)
    return float(layer._pressure(np.array(high)))


def _turn(profile: Profile, layer: Layer, approach: float) -> float:
    """Return the radius of a smooth contact whose approach is that less of the layer's; or 0."""
    high = min(profile.reach, _FAR)

    def beyond(radius: float) -> bool:
        half = float(profile._transform(np.array(radius))) / 2.0
        pressure = 4 * _SHARE * half / (pi * radius)
        return pressure > float(layer._pressure(np.array(approach - half)))

    with np.errstate(over="ignore"):
        return _bisected(beyond, high, _TURN) if beyond(high * (1.0 - _FOUND)) else 0.0


def _sharpness(profile: Profile, layer: Layer, approach: float, turn: float) -> float:
    """Return how deep in ``x`` the turn from contact to gap is: the gap grows as ``y**(3/2)``."""
    if turn <= 0.0:
        return 0.0
    half = float(profile._transform(np.array(turn))) / 2.0
    w = np.array(approach - half)
    pressure, slope = float(layer._pressure(w)), float(layer._slope(w))
    if not (pressure > 0.0 and slope > 0.0):
        return 0.0
    return float(min(max(-2.0 / 3.0 * log(pressure / slope / half), 0.0), _DEEPEST))
