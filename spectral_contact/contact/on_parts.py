"""Parts, first spaces, series and error estimates of the pressure under a profile.

A profile with breaks cuts the contact into parts: a disk and annuli, whose panels are graded toward
the breaks and the edge. On a part ``x = -ln d`` is the depth of a place whose distance in s**2 from
the end of the part is d, in units of the extent of the part.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import ceil, log, sqrt
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from spectral_contact.contact.resolution import (
    concatenate_spaces,
    graded_space,
    relative_panel_changes,
)
from spectral_contact.fields.series import (
    CENTRE,
    EDGE,
    EdgeWeight,
    LogSeries,
    PressureField,
    Radius,
    ZonalField,
)
from spectral_contact.profiles.profile_base import Profile
from spectral_contact.spectral.panels import DiscreteSpace, LogPanels
from spectral_contact.spectral.parts import DiskPartition
from spectral_contact.spectral.regularised import Change
from spectral_contact.spectral.transforms import series_of

if TYPE_CHECKING:
    from spectral_contact.contact.layered_bends import Bend
    from spectral_contact.contact.normal import NormalContact

Array = NDArray[np.float64]

#: Least degrees per e-fold of the tolerance on the first and on the second panel of a part, if
#: there are several parts: the pressure on the next part is singular at their common break.
_MIN_DEGREES_PER_EFOLD = (1.0, 0.55)
#: E-folds by which one degree more on the first two panels of a disk without breaks lowers
#: the error of a smooth pressure: 5.3 under a parabola, with compliances of 1e-10 ... 1e-16.
_EFOLDS_PER_DEGREE = 5
#: Factor of the expected error of the pressure on a disk with breaks: the largest that one of three
#: times 300 random profiles needs.
_BREAK_FACTOR = 4.0


@dataclass(frozen=True, slots=True)
class Indentation:
    """Contact of a given radius under a profile.

    Lengths are in the unit of length of the profile, tractions in units of E'.

    Attributes
    ----------
    radius, approach, load, work : float
        ``a``, ``delta``, ``P`` and the work ``int P ddelta`` of the indentation so far.
    stiffness : float
        ``dP/ddelta``.
    growth : float
        ``ddelta/da``, to the few digits that a Newton step for the radius needs.
    pressure : PressureField or ZonalField or None
        The pressure p over ``s = r/a``; None if it was not wanted and is not needed for the rest.
    flat : PressureField or ZonalField or None
        ``a dp/ddelta`` at the radius ``a``: the pressure under a flat punch of that radius, for an
        approach of a.
    approach_error, load_error, work_error, stiffness_error : float
        Estimates of relative errors; 0 if `indented.values_only` computed the values alone.
    pressure_error : float
        The same of the pressure, pointwise, relative to itself or to its mean if that is larger.
    overclosure : float
        The largest overclosure in the contact, under a nonlinear layer.
    normal : NormalContact or None
        The pressure under a flat punch for unit load, which drives the traction, if that is wanted.
    bends : tuple of Bend
        The radii at which the law of a nonlinear layer bends.
    pull : float
        What adhesion takes from the approach at this radius. From the load it takes `stiffness`
        times as much. With adhesion `work` is the stored elastic energy.
    """

    radius: float
    approach: float
    load: float
    work: float
    stiffness: float
    growth: float
    pressure: PressureField | ZonalField | None
    flat: PressureField | ZonalField | None
    approach_error: float = 0.0
    load_error: float = 0.0
    work_error: float = 0.0
    stiffness_error: float = 0.0
    pressure_error: float = 0.0
    overclosure: float = 0.0
    normal: NormalContact | None = None
    bends: tuple[Bend, ...] = ()
    pull: float = 0.0

    @property
    def approach_size(self) -> float:
        """The length that the error of the approach is relative to."""
        if self.pull > 0.0:
            return self.approach + 2.0 * self.pull
        return max(abs(self.approach), self.approach - self.overclosure)

    @property
    def load_size(self) -> float:
        """The load that the error of the load is relative to.

        With adhesion the load is that without adhesion less `stiffness` times `pull`, and may be
        zero; the errors are relative to the sum of both.
        """
        return self.load + 2.0 * self.stiffness * self.pull

    def largest_error(self, *, pointwise: bool) -> float:
        """Return the largest relative error of a result, that of the pressure if it is wanted."""
        return max(
            self.approach_error,
            self.load_error,
            self.work_error,
            self.stiffness_error,
            self.pressure_error if pointwise else 0.0,
        )


class PartedProblem:
    """First spaces for a pressure on a disk in parts, and the parts of a space for all of them.

    Parameters
    ----------
    parts : DiskPartition
    depths : sequence of float
        Depth x of the narrowest feature of the pressure on every part, such as a layer at its end.
    tolerance : float
        Bound on the relative errors of load, approach, work and stiffness.
    pointwise : bool
        Whether it bounds the relative error of the pressure, too. If not, the attribute `tolerance`
        is the root of the parameter: load and approach superconverge, and have about the square of
        the relative error of the pressure.
    """

    def __init__(
        self, parts: DiskPartition, depths: Sequence[float], tolerance: float, *, pointwise: bool
    ) -> None:
        self.tolerance = tolerance if pointwise else sqrt(tolerance)
        self.pointwise = pointwise
        self.parts = parts
        self.spaces = [self._first_space(k, depth) for k, depth in enumerate(depths)]
        self.counts = [len(space.degrees) for space in self.spaces]

    def _first_space(self, part: int, depth: float) -> DiscreteSpace:
        """Return the first space of a part whose narrowest feature is at the depth x."""
        # at the tip of a pointed profile the pressure has powers of s, roots of the distance s**2
        rate = 0.5 if self.parts.ends[part][0] is CENTRE else 1.0
        space = graded_space(depth, self.tolerance, rate)
        efolds = -log(self.tolerance)
        if len(self.parts.ends) == 1:
            # an error of the first panels acts next to the edge like the load of a flat punch; in a
            # layer of the width exp(-depth) the pressure under it is larger by exp(depth / 2)
            least = [2.0 + (efolds + depth / 2.0) / _EFOLDS_PER_DEGREE] * 2
        else:
            least = [rate * efolds for rate in _MIN_DEGREES_PER_EFOLD]
        degrees = list(space.degrees)
        degrees[:2] = [
            max(degree, ceil(minimum)) for degree, minimum in zip(degrees, least, strict=False)
        ]
        return DiscreteSpace(space.panels, tuple(degrees))

    def start(self) -> DiscreteSpace:
        """Return the first space to try."""
        space = concatenate_spaces(self.spaces)
        capacity = 4 * ceil((max(space.degrees) + 1) / 4)
        return DiscreteSpace(replace(space.panels, degree=capacity), space.degrees)

    def part_spaces(self, space: DiscreteSpace) -> tuple[DiscreteSpace, ...]:
        """Return the space of every part: its panels and their degrees."""
        degrees = space.degrees
        spaces = []
        for count in self.counts:
            spaces.append(DiscreteSpace(replace(space.panels, count=count), degrees[:count]))
            degrees = degrees[count:]
        return tuple(spaces)


def profile_parts(profile: Profile, radius: float) -> DiskPartition:
    """Return the parts into which the breaks of a profile cut a contact of this radius."""
    breaks = tuple(Radius(b / radius, (radius - b) / radius) for b in profile.breaks if b < radius)
    return DiskPartition(breaks, profile.pointed)


def feature_depths(parts: DiskPartition, width: float, to_pole: float) -> tuple[float, ...]:
    """Return the depth x of the deepest feature at the end of every part.

    Parameters
    ----------
    parts : DiskPartition
    width : float
        Of the layer over the contact radius, at most 1.
    to_pole : float
        How far beyond the edge the half-integral has its pole, in the same unit: inside, it is a
        logarithm of the distance from there (`Sphere`), which takes panels graded to it.
    """
    inner = [layer_depth(width, boundary, extent) for boundary, _, extent in parts.ends[:-1]]
    edge, _, extent = parts.ends[-1]
    return *inner, layer_depth(min(width, to_pole), edge, extent)


def layer_depth(width: float, boundary: Radius, extent: float) -> float:
    """Return the depth x of a layer of this width, a difference of radii, next to a boundary.

    `extent` is that of the part, in s**2.
    """
    return max(-log(width * max(boundary.value, width) / extent), 0.0)


def pointwise_errors(
    parts: DiskPartition,
    spaces: tuple[DiscreteSpace, ...],
    coefficients: Array,
    change: Change,
    mean: float,
) -> Array:
    """Return the expected errors of the pressure on all panels.

    They are relative to the pressure, or to its mean if that is larger.

    Parameters
    ----------
    parts : DiskPartition
    spaces : tuple of DiscreteSpace
        The space of every part.
    coefficients : ndarray
        Those of the pressure, part by part.
    change : Change
        What the pressure loses with the top degrees of the space.
    mean : float
        The mean of the pressure.
    """
    errors: list[Array] = []
    # next to a break one change is a worse measure of the next one
    factor = _BREAK_FACTOR if len(spaces) > 1 else 1.0
    for (panels, _), series, part_change in zip(
        spaces,
        series_on_parts(spaces, coefficients),
        split_parts(spaces, change.coefficients),
        strict=True,
    ):
        size = np.maximum(np.abs(series.at_ends()), mean)
        expected = factor * relative_panel_changes(panels, part_change, size)
        if parts.pointed and not errors:
            # the pressure has a root at the tip, which the polynomials of the tail do not
            # represent whatever the degree: the error there is 1.8 times the change of the tail at
            # most
            tail_change = float(np.abs(part_change[-panels.tail_terms :]).sum()) / float(size[-1])
            expected[-1] = max(float(expected[-1]), 2.0 * tail_change)
        errors.append(expected)
    return np.concatenate(errors)


def series_on_parts(spaces: tuple[DiscreteSpace, ...], coefficients: Array) -> list[LogSeries]:
    """Return the series on every part of the function with these coefficients."""
    return [
        series_of(space.panels, part_coefficients)
        for space, part_coefficients in zip(spaces, split_parts(spaces, coefficients), strict=True)
    ]


def field_of(
    parts: DiskPartition, series: Sequence[LogSeries], weight: EdgeWeight | None = None
) -> PressureField | ZonalField:
    """Return the pressure with these series on the parts, and a weight that is added to them."""
    if len(parts.ends) == 1:
        return PressureField(weight, series[0])
    bounds = (CENTRE, *parts.breaks, EDGE)
    return replace(ZonalField.on_parts(bounds, series, pointed=parts.pointed), weight=weight)


def split_parts(spaces: tuple[DiscreteSpace, ...], coefficients: Array) -> list[Array]:
    """Return the coefficients of every part."""
    return np.split(coefficients, np.cumsum([space.panels.size for space in spaces])[:-1])


def edge_value(panels: LogPanels, coefficients: Array) -> float:
    """Return the value at the edge, which is that of the tail of the last part at its end."""
    tail = coefficients[-panels.tail_terms :].tolist()
    return float(sum(tail[::2]) - sum(tail[1::2]))
