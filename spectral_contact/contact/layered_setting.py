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
from spectral_contact.contact.layered_newton import LayeredSetting, series_overclosure
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
#: Least pressure, so that it has an overclosure.
_LEAST_PRESSURE = float(np.finfo(float).tiny)
#: Of the boundary between panels at the turn: its least and its largest radius, and its least
#: distance from a break of the profile, all over the radius of the disk.
_MIN_TURN, _MAX_TURN, _MIN_DISTANCE = 0.3, 0.99, 0.05
#: Load of a smooth contact of approach delta over ``4 a delta``, pressures in units of
#: ``E' = E/(4(1 - nu**2))``: 4/3 under a parabola, 1 under a cone. That of the parabola is taken
#: for every profile, as it only places the turn.
_LOAD_FACTOR = 4.0 / 3.0
#: Largest radius at which a bisection begins, and the ratio of its least radius to that.
_MAX_RADIUS, _MIN_RATIO = 1e100, 1e-200
#: Relative accuracy of the radius of the disk, and of a turn.
_RADIUS_TOLERANCE, _TURN_TOLERANCE = 1e-3, 1e-12
#: Width of the cells next to the turn over that of the turn; ratio of the widths of neighbouring
#: cells; largest width in ``s**2``. If cells come this near to the end, as a fraction of its
#: distance from the turn, all of them are widened instead of adding another one.
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
    radius = _disk_radius(profile, layer, approach)
    turn = _turn(profile, layer, approach)
    turn_in_disk = min(max(turn, _MIN_TURN * radius), _MAX_TURN * radius)
    at_turn = Radius(turn_in_disk / radius, (radius - turn_in_disk) / radius)
    depth = _turn_depth(profile, layer, approach, turn) if turn == turn_in_disk else 0.0
    profile_breaks = profile_parts(profile, radius)
    if len(profile_breaks.ends) == 1 and not layer.knots:
        cells = _cells(at_turn, exp(-depth))
        return LayeredSetting(profile, layer, radius, approach, profile_breaks, (), (), cells=cells)
    clear = all(abs(one.value - at_turn.value) >= _MIN_DISTANCE for one in profile_breaks.breaks)
    turn_boundary = [at_turn] if clear else []
    parts = _with_smooth_breaks(profile_breaks, [*turn_boundary, *(bend.radius for bend in bends)])
    central = layer._overclosure(_central_pressure(layer, approach, max(turn, layer._size)))
    # width of the edge layer, over the radius
    layer_width = 1.0 / max(float(layer._slope(np.array(central))) * radius, 1.0)
    depths, smooth = [], []
    for boundary, _, extent in parts.ends:
        smooth.append(boundary in turn_boundary or boundary is EDGE)
        known = depth if boundary in turn_boundary else 0.0
        depths.append(known if smooth[-1] else layer_depth(layer_width, boundary, extent))
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
        Width of the turn, a difference of ``s**2`` over that of the turn itself.
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
    profile_breaks = profile_parts(profile, radius)
    parts = _with_smooth_breaks(profile_breaks, [bend.radius for bend in bends])
    setting = LayeredSetting(profile, layer, radius, approach, parts, (), ())
    # what layer and body give way together at the centre: the approach from where the law begins,
    # for which twice the height at the edge is taken if it is not given
    if approach is None:
        largest_height = 2.0 * float(profile._height(np.array(radius)))
    else:
        largest_height = approach - setting.origin
    centre = np.array([largest_height / radius])
    slope = float(setting.slope(series_overclosure(setting, centre, np.minimum(centre, 0.0)))[0])
    layer_width = 1.0 / max(slope, 1.0)
    depths = feature_depths(parts, layer_width, profile._to_pole(radius))
    smooth = (False,) * len(depths)
    return replace(setting, depths=depths, smooth=smooth, bends=bends)


def _disk_radius(profile: Profile, layer: Layer, approach: float) -> float:
    """Return a radius beyond which the pressure is negligible.

    The pressure is negligible where the height of the undeformed punch exceeds the approach less
    the overclosure that belongs to a negligible pressure.
    """
    pressure = _central_pressure(layer, approach, max(_turn(profile, layer, approach), layer._size))
    # the largest height of the punch at which the pressure is not negligible
    largest_height = approach - layer._overclosure(max(_NEGLIGIBLE * pressure, _LEAST_PRESSURE))

    def beyond(radius: float) -> bool:
        with np.errstate(over="ignore"):
            return float(profile._height(np.array(radius))) > largest_height

    high = min(profile.reach, _MAX_RADIUS)
    if not beyond(high * (1.0 - _RADIUS_TOLERANCE)):
        allowed = "such that the pressure is below rounding where the profile ends, "
        allowed += f"at the radius {high:.6g}"
        raise SceneError("approach", approach, allowed)
    return _bisected(beyond, high)


def _bisected(
    beyond: Callable[[float], bool], high: float, tolerance: float = _RADIUS_TOLERANCE
) -> float:
    """Return the least radius at which a condition holds, by bisection of its logarithm.

    It holds at `high`.
    """
    low = high * _MIN_RATIO
    while high - low > tolerance * high:
        middle = sqrt(low) * sqrt(high)
        low, high = (low, middle) if beyond(middle) else (middle, high)
    return high


def _central_pressure(layer: Layer, approach: float, radius: float) -> float:
    """Return an estimate of the pressure at the centre of a contact of this radius, above zero.

    The body acts as a spring in series with the layer, as under a uniform pressure.
    """

    def too_large(w: float) -> bool:
        with np.errstate(over="ignore"):
            return w + 0.5 * radius * float(layer._pressure(np.array(w))) > approach

    step = layer._size + radius
    low = approach - step
    high = approach
    while too_large(low):
        step *= 2.0
        low -= step
    while low < (middle := 0.5 * (low + high)) < high:
        low, high = (low, middle) if too_large(middle) else (middle, high)
    return max(float(layer._pressure(np.array(high))), _LEAST_PRESSURE)


def _turn(profile: Profile, layer: Layer, approach: float) -> float:
    """Return the radius of the turn; 0 if the smooth contact would reach the end of the profile.

    It is that of a smooth contact whose approach is the given one less the overclosure of the layer
    under the mean pressure.
    """
    high = min(profile.reach, _MAX_RADIUS)

    def beyond(radius: float) -> bool:
        smooth_approach = float(profile._transform(np.array(radius))) / 2.0
        pressure = 4 * _LOAD_FACTOR * smooth_approach / (pi * radius)
        return pressure > float(layer._pressure(np.array(approach - smooth_approach)))

    with np.errstate(over="ignore"):
        return (
            _bisected(beyond, high, _TURN_TOLERANCE)
            if beyond(high * (1.0 - _RADIUS_TOLERANCE))
            else 0.0
        )


def _turn_depth(profile: Profile, layer: Layer, approach: float, turn: float) -> float:
    """Return the depth ``x = -ln d`` of the turn, from its width d.

    The width, as every distance d from the turn here, is a difference of ``s**2`` over that of the
    turn itself. Beyond the edge of a smooth contact the gap grows as ``d**(3/2)``. The width of the
    turn is the distance at which the gap equals the overclosure over which the pressure falls by a
    factor of e.
    """
    if turn <= 0.0:
        return 0.0
    smooth_approach = float(profile._transform(np.array(turn))) / 2.0
    w = np.array(approach - smooth_approach)
    pressure, slope = float(layer._pressure(w)), float(layer._slope(w))
    if not (pressure > 0.0 and slope > 0.0):
        return 0.0
    depth = -2.0 / 3.0 * log(pressure / slope / smooth_approach)
    return float(min(max(depth, 0.0), _MAX_TURN_DEPTH))
