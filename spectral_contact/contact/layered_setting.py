"""The disk on which the pressure under a nonlinear layer is solved for, and its division.

The law is ``p = F(w)``, with the pressure p and the overclosure w. Under a law with an edge the
pressure ends at the contact radius. Under a law with pressure at every gap the disk reaches to
where the pressure is below the rounding of its largest value. If the layer is thin, the pressure
falls fast at about the radius of a smooth contact, the *turn* from contact to gap. Panels are
graded to it, or cells are small there.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import exp, inf, log, pi, sqrt

import numpy as np
from numpy.typing import NDArray

from spectral_contact.contact.layered_bends import Bend
from spectral_contact.contact.layered_newton import TINY, LayeredSetting, series_overclosure
from spectral_contact.contact.on_parts import feature_depths, layer_depth, profile_parts
from spectral_contact.errors import SceneError
from spectral_contact.fields.series import EDGE, Radius
from spectral_contact.layers.layer_base import Layer
from spectral_contact.profiles.profile_base import Profile
from spectral_contact.profiles.shapes import Flat
from spectral_contact.spectral.cells import DiskCells
from spectral_contact.spectral.parts import DiskPartition

Array = NDArray[np.float64]

#: The disk ends where the pressure is at most this fraction of that at the centre.
_NEGLIGIBLE = 1e-18
#: Least and largest radius, over that of the disk, of a boundary at the turn; and its least
#: distance from a break.
_MIN_TURN, _MAX_TURN, _MIN_DISTANCE = 0.3, 0.85, 0.05
#: Load of a smooth contact over four times the product of radius and approach, that of a parabola.
_LOAD_FACTOR = 2.0 / 3.0
#: Largest radius of a bisection, and the least over the largest.
_MAX_RADIUS, _MIN_RATIO = 1e100, 1e-200
#: Relative accuracy of the radius of the disk, and of a turn.
_RADIUS_TOLERANCE, _TURN_TOLERANCE = 1e-3, 1e-12
#: Steps of a bisection of the overclosure, and its range in sizes of the law.
_STEPS, _RANGE = 60, 1e3
#: Width of the cells next to the turn over the width of the turn; ratio of the widths of
#: neighbours; largest width; and relative distance from the end at which no further cell is added.
_FIRST_WIDTH, _WIDTH_RATIO, _MAX_WIDTH, _END_MARGIN = 1.0, 2.5, 0.3, 0.1
#: Largest depth of a turn in ``x = -ln d``.
_MAX_TURN_DEPTH = 25.0


def has_edge(profile: Profile, layer: Layer) -> bool:
    """Return whether the contact has a radius that depends on the load."""
    return layer.start > -inf and not isinstance(profile, Flat)


def setting_at_radius(
    profile: Profile, layer: Layer, radius: float, bends: tuple[Bend, ...] = ()
) -> LayeredSetting:
    """Return the setting for a contact radius, under a law with an edge and these bends."""
    return _to_edge(profile, layer, radius, None, bends)


def with_bends(setting: LayeredSetting, bends: tuple[Bend, ...]) -> LayeredSetting:
    """Return a setting with parts that end at these bends."""
    if setting.approach is None:
        return setting_at_radius(setting.profile, setting.layer, setting.radius, bends)
    found = setting_at_approach(setting.profile, setting.layer, setting.approach, bends)
    return replace(found, load=setting.load, centre=setting.centre, drives=setting.drives)


def setting_at_approach(
    profile: Profile, layer: Layer, approach: float, bends: tuple[Bend, ...] = ()
) -> LayeredSetting:
    """Return the setting for an approach, under a flat punch or a law without an edge.

    Parameters
    ----------
    profile : Profile
    layer : Layer
    approach : float
    bends : tuple of Bend
        The radii at which the law is assumed to bend.

    Raises
    ------
    SceneError
        If the profile ends before the pressure does.
    """
    if isinstance(profile, Flat):
        return _to_edge(profile, layer, profile.radius, approach, bends)
    radius = _domain(profile, layer, approach)
    turn = _turn(profile, layer, approach)
    knee = min(max(turn, _MIN_TURN * radius), _MAX_TURN * radius)
    own = profile_parts(profile, radius)
    turns = []
    depth = _turn_depth(profile, layer, approach, turn)
    if len(own.ends) == 1 and not layer.knots:
        cells = _cells(Radius(knee / radius, (radius - knee) / radius), exp(-depth))
        return LayeredSetting(profile, layer, radius, approach, own, (), (), cells=cells)
    if all(abs(one.value * radius - knee) >= _MIN_DISTANCE * radius for one in own.breaks):
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
    """Return the parts divided at further radii, at which the profile is smooth."""
    breaks = sorted([*parts.breaks, *radii], key=lambda radius: radius.value)
    return DiskPartition(tuple(breaks), parts.pointed, tuple(radii))


def _cells(pivot: Radius, width: float) -> DiskCells:
    """Return cells that grow with their distance from the turn.

    Parameters
    ----------
    pivot : Radius
        The turn.
    width : float
        Width of the turn, over the square of its radius.
    """

    def steps(reach: float) -> Array:
        ends = [0.0]
        step = _FIRST_WIDTH * width * pivot.square
        while ends[-1] < reach * (1.0 - _END_MARGIN):
            ends.append(ends[-1] + min(step, _MAX_WIDTH))
            step *= _WIDTH_RATIO
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
    """Return the setting of a contact that ends at a given radius, with panels graded to it."""
    own = profile_parts(profile, radius)
    parts = _with_smooth_breaks(own, [bend.radius for bend in bends])
    setting = LayeredSetting(profile, layer, radius, approach, parts, (), ())
    if approach is None:
        room = 2.0 * float(profile._height(np.array(radius)))
    else:
        room = approach - setting.origin
    centre = np.array([room / radius])
    slope = float(setting.slope(series_overclosure(setting, centre, np.minimum(centre, 0.0)))[0])
    thin = 1.0 / max(slope, 1.0)
    depths = feature_depths(parts, thin, profile._to_pole(radius))
    smooth = (False,) * len(depths)
    return replace(setting, depths=depths, smooth=smooth, bends=bends)


def _domain(profile: Profile, layer: Layer, approach: float) -> float:
    """Return the radius beyond which the pressure is negligible."""
    pressure = _central(layer, approach, max(_turn(profile, layer, approach), layer._size))
    room = approach - layer._overclosure(max(_NEGLIGIBLE * pressure, TINY))

    def beyond(radius: float) -> bool:
        with np.errstate(over="ignore"):
            return float(profile._height(np.array(radius))) > room

    high = min(profile.reach, _MAX_RADIUS)
    if not beyond(high * (1.0 - _RADIUS_TOLERANCE)):
        told = "such that the pressure ends before the profile does: "
        told += f"at its end, {high:.6g}, it is not below rounding yet"
        raise SceneError("approach", approach, told)
    return _bisected(beyond, high)


def _bisected(
    beyond: Callable[[float], bool], high: float, near: float = _RADIUS_TOLERANCE
) -> float:
    """Return the least radius at which a condition holds that holds at `high`, by bisection."""
    low = high * _MIN_RATIO
    while high - low > near * high:
        middle = sqrt(low) * sqrt(high)
        low, high = (low, middle) if beyond(middle) else (middle, high)
    return high


def _central(layer: Layer, approach: float, radius: float) -> float:
    """Return an estimate of the pressure at the centre of a contact of this radius.

    The body is taken for a spring in series with the layer.
    """
    low = approach - _RANGE * layer._size - radius
    high = approach

    def too_large(w: float) -> bool:
        with np.errstate(over="ignore"):
            return w + 0.5 * radius * float(layer._pressure(np.array(w))) > approach

    for _ in range(_STEPS):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if too_large(middle) else (middle, high)
    return float(layer._pressure(np.array(high)))


def _turn(profile: Profile, layer: Layer, approach: float) -> float:
    """Return the radius of the turn, or 0 if the layer is too soft for one.

    It is that of a smooth contact whose approach is the given one less the overclosure of the layer
    under the mean pressure.
    """
    high = min(profile.reach, _MAX_RADIUS)

    def beyond(radius: float) -> bool:
        half = float(profile._transform(np.array(radius))) / 2.0
        pressure = 4 * _LOAD_FACTOR * half / (pi * radius)
        return pressure > float(layer._pressure(np.array(approach - half)))

    with np.errstate(over="ignore"):
        return (
            _bisected(beyond, high, _TURN_TOLERANCE)
            if beyond(high * (1.0 - _RADIUS_TOLERANCE))
            else 0.0
        )


def _turn_depth(profile: Profile, layer: Layer, approach: float, turn: float) -> float:
    """Return the depth ``x = -ln d`` of the turn, from its width d in ``s**2``.

    Beyond the edge of a smooth contact the gap grows as ``d**(3/2)``. The turn is as wide as the
    distance at which the gap is the overclosure over which the law falls by e.
    """
    if turn <= 0.0:
        return 0.0
    half = float(profile._transform(np.array(turn))) / 2.0
    w = np.array(approach - half)
    pressure, slope = float(layer._pressure(w)), float(layer._slope(w))
    if not (pressure > 0.0 and slope > 0.0):
        return 0.0
    return float(min(max(-2.0 / 3.0 * log(pressure / slope / half), 0.0), _MAX_TURN_DEPTH))
