"""What problems for a pressure under a profile share: parts, first spaces, series, estimates."""

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
    from spectral_contact.contact.resolution import NormalContact

Array = NDArray[np.float64]

#: A part that ends at a break is seen from beyond it: its first two panels take so many degrees
#: for a digit (base e) more than others.
_FIRST, _SECOND = 1.0, 0.55
#: By so many digits (base e) a degree more on the first panels lowers the error of a smooth
#: pressure in a thin layer: 5.3 under a parabola, at layers of 1e-10 ... 1e-16.
_BY_DEGREE = 5
#: What breaks add to the expected error of the pressure, as the worst of three times 300 random
#: profiles need it.
_BROKEN = 4.0


@dataclass(frozen=True, slots=True)
class Indentation:
    """Contact of a given radius under a profile; lengths in the profile's, tractions in E'.

    Attributes
    ----------
    radius, approach, load, work : float
        ``a``, ``delta``, ``P`` and the work ``int P ddelta`` of the indentation so far.
    stiffness : float
        ``dP/ddelta``.
    growth : float
        ``ddelta/da``, to some digits.
    pressure : PressureField or ZonalField or None
        Over ``s = r/a``; None if it was not wanted and is not needed for the rest.
    flat : PressureField or ZonalField or None
        ``a dp/ddelta`` at the radius ``a``: the pressure of a flat punch.
    approach_error, load_error, work_error, stiffness_error : float
        Estimates of relative errors; 0 of a `glance`.
    pressure_error : float
        The same of the pressure, pointwise, relative to itself or to its mean if that is larger.
    overclosure : float
        The largest, under a nonlinear layer.
    normal : NormalContact or None
        The pressure under a flat punch as it drives a traction, if that is wanted.
    bends : tuple of Bend
        Where the law of a nonlinear layer bends.
    pull : float
        By how much adhesion lowers the approach at this radius; the load it lowers by `stiffness`
        times as much. The work is then the elastic energy that is stored.
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
        """What the error of the approach is relative to."""
        if self.pull > 0.0:
            return self.approach + 2.0 * self.pull
        return max(abs(self.approach), self.approach - self.overclosure)

    @property
    def load_size(self) -> float:
        """What the error of the load is relative to: with adhesion the sum of its two parts."""
        return self.load + 2.0 * self.stiffness * self.pull


class PartedProblem:
    """First spaces for a pressure on a disk in parts, and how a vector is cut.

    Parameters
    ----------
    parts : DiskPartition
    depths : sequence of float
        ``x`` of the deepest feature at the end of every part.
    tolerance : float
        Bound on the relative error.
    pointwise : bool
        Whether it is that of the pressure, too.
    """

    def __init__(
        self, parts: DiskPartition, depths: Sequence[float], tolerance: float, *, pointwise: bool
    ) -> None:
        # integrals superconverge: their errors are the squares of the pressure's
        self.tolerance, self.pointwise = tolerance if pointwise else sqrt(tolerance), pointwise
        self.parts = parts
        self.spaces = [self._first(k, depth) for k, depth in enumerate(depths)]
        self.counts = [len(one.degrees) for one in self.spaces]

    def _first(self, part: int, depth: float) -> DiscreteSpace:
        """Return the first space of a part in which the deepest feature is at a depth in ``x``."""
        # square roots of the distance in s**2 at a tip
        rate = 0.5 if self.parts.ends[part][0] is CENTRE else 1.0
        space = graded_space(depth, self.tolerance, rate)
        digits, degrees = -log(self.tolerance), list(space.degrees)
        least = [share * digits for share in (_FIRST, _SECOND)]
        if len(self.parts.ends) == 1:
            # what they leave acts on a thin layer like a flat punch: it grows by the root of the
            # width
            least = [2.0 + (digits + depth / 2.0) / _BY_DEGREE] * 2
        degrees[:2] = [max(one, ceil(other)) for one, other in zip(degrees, least, strict=False)]
        return DiscreteSpace(space.panels, tuple(degrees))

    def start(self) -> DiscreteSpace:
        """Return the first space to try."""
        space = concatenate_spaces(self.spaces)
        capacity = 4 * ceil((max(space.degrees) + 1) / 4)
        return DiscreteSpace(replace(space.panels, degree=capacity), space.degrees)

    def used(self, resolution: DiscreteSpace) -> tuple[DiscreteSpace, ...]:
        """Return the panels of every part, and the degrees on them."""
        degrees, used = resolution.degrees, []
        for count in self.counts:
            used.append(DiscreteSpace(replace(resolution.panels, panels=count), degrees[:count]))
            degrees = degrees[count:]
        return tuple(used)


def profile_parts(profile: Profile, radius: float) -> DiskPartition:
    """Return how a profile cuts a contact of this radius."""
    breaks = tuple(Radius(b / radius, (radius - b) / radius) for b in profile.breaks if b < radius)
    return DiskPartition(breaks, profile.pointed)


def feature_depths(parts: DiskPartition, thin: float, to_pole: float) -> tuple[float, ...]:
    """Return how deep in ``x`` the deepest feature at the end of every part is.

    Parameters
    ----------
    parts : DiskPartition
    thin : float
        Width of the layer over the contact radius, at most 1.
    to_pole : float
        How far beyond the edge the half-integral has its pole, in the same unit: inside, it is a
        logarithm of the distance from there (`Sphere`), which takes panels graded to it.
    """
    inner = [layer_depth(thin, boundary, extent) for boundary, _, extent in parts.ends[:-1]]
    edge, _, extent = parts.ends[-1]
    return *inner, layer_depth(min(thin, to_pole), edge, extent)


def layer_depth(thin: float, boundary: Radius, extent: float) -> float:
    """Return how deep in ``x`` a layer of this width next to a boundary is."""
    return max(-log(thin * max(boundary.value, thin) / extent), 0.0)


def pointwise_errors(
    parts: DiskPartition, used: tuple[DiscreteSpace, ...], whole: Array, change: Change, mean: float
) -> Array:
    """Return the expected errors of the pressure on all panels.

    They are relative to the pressure, or to its mean if that is larger.
    """
    errors: list[Array] = []
    series = series_on_parts(used, whole)
    each = zip(used, series, split_parts(used, change.coefficients), strict=True)
    # a change next to a break says less about the one after it
    factor = _BROKEN if len(used) > 1 else 1.0
    for (panels, _), one, changed in each:
        size = np.maximum(np.abs(one.at_ends()), mean)
        expected = factor * relative_panel_changes(panels, changed, size)
        if parts.pointed and not errors:
            # no degree lowers what the tail at a tip lacks, a root: 1.8 times what it sheds
            tail = float(np.abs(changed[-panels.tail_terms :]).sum()) / float(size[-1])
            expected[-1] = max(float(expected[-1]), 2.0 * tail)
        errors.append(expected)
    return np.concatenate(errors)


def series_on_parts(used: tuple[DiscreteSpace, ...], coefficients: Array) -> list[LogSeries]:
    """Return the function on every part."""
    return [
        series_of(p, c) for (p, _), c in zip(used, split_parts(used, coefficients), strict=True)
    ]


def field_of(
    parts: DiskPartition, series: Sequence[LogSeries], weight: EdgeWeight | None = None
) -> PressureField | ZonalField:
    """Return the pressure with these series on the parts, and a weight that is added to them."""
    if len(parts.ends) == 1:
        return PressureField(weight, series[0])
    bounds = (CENTRE, *parts.breaks, EDGE)
    return replace(ZonalField.on_parts(bounds, series, pointed=parts.pointed), weight=weight)


def split_parts(used: tuple[DiscreteSpace, ...], coefficients: Array) -> list[Array]:
    """Return the coefficients of every part."""
    return np.split(coefficients, np.cumsum([panels.size for panels, _ in used])[:-1])


def edge_value(panels: LogPanels, coefficients: Array) -> float:
    """Return the value at the edge, which the last part's tail has."""
    tail = coefficients[-panels.tail_terms :].tolist()
    return float(sum(tail[::2]) - sum(tail[1::2]))
