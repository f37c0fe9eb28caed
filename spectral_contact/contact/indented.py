r"""Normal contact under a profile, of a given radius ``a``: `normal`'s equation with one more load.

On the unit disk ``(alpha/a) p + N p = (delta - h(a s))/a``, whose half-integral's target is
``[H(1) - H(t)] + 2 eps``: the bracket is known exactly, and the pressure is that of the bracket
plus ``eps`` times that of a flat punch, which the same factors give. ``eps`` is what makes the
pressure vanish at the edge (docs/theory, profiles).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from math import ceil, inf, log, pi, sqrt
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from spectral_contact.contact.normal import NormalContact
from spectral_contact.contact.refine import Attempt, Refinement, Resolution, refine
from spectral_contact.contact.resolution import (
    FIELD_ROUNDING,
    PANEL_WIDTH,
    ROUNDING,
    expected_error,
    panel_table,
    series_of,
    share_of_change,
    starting_resolution,
    table_rates,
)
from spectral_contact.contact.smooth_indented import smooth_pressure
from spectral_contact.contact.zone_spaces import joined
from spectral_contact.fields.series import CENTRE, LogSeries, PressureField, Radius, ZonalField
from spectral_contact.profiles import Profile
from spectral_contact.spectral.panels import LogPanels
from spectral_contact.spectral.parted import PartedSpace, Parts, PressureSpace, pressure_space
from spectral_contact.spectral.regularised import Change, Regularised

__all__ = [
    "Indentation",
    "PartedProblem",
    "Used",
    "bracket_of",
    "edge_value",
    "first_space",
    "pointwise_errors",
    "profile_parts",
    "series_on_parts",
    "solve_indentation",
    "split_parts",
]

Array = NDArray[np.float64]
Used: TypeAlias = tuple[LogPanels, tuple[int, ...]]

#: A part that ends at a break is seen from beyond it: its first two panels take so many degrees
#: for a digit (base e) more than others.
_FIRST, _SECOND = 0.95, 0.55
#: Places next to the edge, in units of the layer, where the pressure's slope is taken.
_SLOPE = 1e-4
#: Error of ``eps`` over what the tail at the edge changes.
_EDGE = 1.0
#: Panels and degree whose nodes integrate a known half-integral.
_NODES = 20, 20
#: What breaks add to the expected error of the pressure, and what integrals of a smooth space lack,
#: as the worst of three times 300 random profiles need them.
_BROKEN, _INTEGRATED = 8.0, 2.0
#: Roundings of the shift, and of what follows from it, measured over random profiles and against
#: the gold tables: the work under a rounded flat takes 3.05.
_ROUNDINGS = 3.5
#: The place of a break is rounded, which counts relative to its distance from the edge: so many of
#: our roundings for integrals and for the pressure, measured as close as 1e-4 of the radius.
_PLACE, _PLACE_POINTWISE = 0.2, 0.7
#: Rounding of the pressure deep in a thin layer, where it is what the layer's equation leaves.
_LAYER_ROUNDING = 1e-16


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
        Estimates of relative errors.
    pressure_error : float
        The same of the pressure, pointwise, relative to itself or to its mean if that is larger.
    overclosure : float
        The largest, under a nonlinear layer.
    normal : NormalContact or None
        The pressure under a flat punch as it drives a traction, if that is wanted.
    """

    radius: float
    approach: float
    load: float
    work: float
    stiffness: float
    growth: float
    pressure: PressureField | ZonalField | None
    flat: PressureField | ZonalField | None
    approach_error: float
    load_error: float
    work_error: float
    stiffness_error: float
    pressure_error: float
    overclosure: float = 0.0
    normal: NormalContact | None = None

    @property
    def approach_size(self) -> float:
        """What the error of the approach is relative to."""
        return max(abs(self.approach), self.approach - self.overclosure)


@dataclass(frozen=True, slots=True)
class _TwoPressures:
    """The two solutions in a space, and how they combine.

    Attributes
    ----------
    factored : Regularised
    flat, whole : ndarray
        Coefficients of the pressure of a flat punch for unit approach, and of the pressure.
    flat_half, whole_half : ndarray
        Their half-integrals at the nodes.
    target : ndarray
        What the half-integral of the pressure should be.
    shift : float
        ``eps``.
    flat_edge : float
        Pressure of the flat punch at the edge.
    """

    factored: Regularised[Any]
    flat: Array
    whole: Array
    flat_half: Array
    whole_half: Array
    target: Array
    shift: float
    flat_edge: float


@dataclass(frozen=True, slots=True)
class _IntegralErrors:
    """Errors of ``eps``, and of the integrals of the half-integrals at a given ``eps``."""

    shift: float
    load: float
    flat: float
    work: float


class PartedProblem(ABC):
    """First spaces for a pressure on a disk in parts, and how a vector is cut.

    Parameters
    ----------
    parts : Parts
    tolerance : float
        Bound on the relative error.
    pointwise : bool
        Whether it is that of the pressure, too.
    """

    def __init__(self, parts: Parts, tolerance: float, *, pointwise: bool) -> None:
        # integrals superconverge: their errors are the squares of the pressure's
        self.tolerance, self.pointwise = tolerance if pointwise else sqrt(tolerance), pointwise
        self.parts = parts
        self.spaces = [self._first(*end) for end in self.parts.ends]
        self.counts = [len(one.degrees) for one in self.spaces]

    @abstractmethod
    def _first(self, boundary: Radius, sign: int, extent: float) -> Resolution:
        """Return the first space of a part."""

    def start(self) -> Resolution:
        """Return the first space to try."""
        space = joined(self.spaces)
        capacity = 4 * ceil((max(space.degrees) + 1) / 4)
        return Resolution(replace(space.panels, degree=capacity), space.degrees)

    def used(self, resolution: Resolution) -> tuple[Used, ...]:
        """Return the panels of every part, and the degrees on them."""
        degrees, used = resolution.degrees, []
        for count in self.counts:
            used.append((replace(resolution.panels, panels=count), degrees[:count]))
            degrees = degrees[count:]
        return tuple(used)


class _IndentationProblem(PartedProblem):
    """Spaces for a contact under a profile."""

    def __init__(
        self,
        profile: Profile,
        radius: float,
        compliance: float,
        tolerance: float,
        *,
        pointwise: bool,
    ) -> None:
        self.profile, self.radius = profile, radius
        #: in units of the contact radius
        self.compliance = compliance / radius
        super().__init__(profile_parts(profile, radius), tolerance, pointwise=pointwise)

    def _first(self, boundary: Radius, sign: int, extent: float) -> Resolution:
        """Return the first space of a part."""
        thin = min(self.compliance, 1.0)
        # in units of the extent in s**2
        width = min(thin * max(boundary.value, thin) / extent, 1.0)
        return first_space(self, boundary, -log(width))

    def attempt(self, resolution: Resolution) -> Attempt[Indentation]:
        """Solve in a space."""
        used = self.used(resolution)
        space = pressure_space(self.parts, used)
        return self._judged(space, used, self._solve(space, used[-1][0]))

    def _solve(self, space: PressureSpace, edge: LogPanels) -> _TwoPressures:
        bracket = bracket_of(self.profile, self.radius, space)
        factored = space.factor(self.compliance)
        own = factored.solve(bracket)
        flat = factored.solve(2.0)
        at_edge = edge_value(edge, flat)
        shift = -edge_value(edge, own) / at_edge
        whole, half = own + shift * flat, space.half_integral
        target = bracket + 2.0 * shift
        return _TwoPressures(factored, flat, whole, half(flat), half(whole), target, shift, at_edge)

    def _judged(
        self, space: PressureSpace, used: tuple[Used, ...], solved: _TwoPressures
    ) -> Attempt[Indentation]:
        """Return the contact with its errors."""
        a, weights = self.radius, space.weights
        series = series_on_parts(used, solved.whole)
        moment, flat_moment = float(weights @ solved.whole_half), float(weights @ solved.flat_half)
        energy = float(weights @ (solved.whole_half * solved.target))
        whole_height = float(self.profile._transform(np.asarray(a))) / (2.0 * a)
        approach = whole_height + solved.shift

        change, mean = solved.factored.change(solved.whole), 4 / pi * moment
        indicators, rates = pointwise_errors(self.parts, used, solved.whole, change, mean)
        errors = self._integral_errors(solved, change, used[-1][0], rates)
        shifted = errors.shift + _ROUNDINGS * ROUNDING * max(whole_height, abs(solved.shift))
        pressure_error = float(indicators.max()) + _ROUNDINGS * FIELD_ROUNDING
        place = ROUNDING * max((a / (a - b) for b in self.profile.breaks if b < a), default=0.0)
        shifted += _PLACE * place * approach
        pressure_error += _PLACE_POINTWISE * place
        if len(used) > 1:
            pressure_error += _LAYER_ROUNDING * whole_height / (self.compliance * mean)
        indentation = Indentation(
            a,
            a * approach,
            4 * a**2 * moment,
            a**3 * energy,
            4 * a * flat_moment,
            self._growth(series[-1], self.parts.ends[-1][2], solved.flat_edge),
            self.parts.field(series),
            self.parts.field(series_on_parts(used, solved.flat)) if self.pointwise else None,
            shifted / approach + ROUNDING,
            (shifted * flat_moment + errors.load) / moment + ROUNDING,
            (4 * shifted * moment + errors.work) / energy + ROUNDING,
            errors.flat / flat_moment + 2.0 * ROUNDING,
            pressure_error,
        )
        error = max(indentation.approach_error, indentation.load_error)
        if self.pointwise:
            error = max(error, pressure_error)
        else:
            indicators, rates = indicators**2, rates**2
        return Attempt(indentation, error, indicators, rates, space.unknowns)

    def _integral_errors(
        self, solved: _TwoPressures, change: Change, edge: LogPanels, rates: Array
    ) -> _IntegralErrors:
        """Return the errors of what is integrated, and of the shift, which all of it inherits."""
        falls = np.append(rates**2, 1.0)
        own = change.energies
        flat = solved.factored.change(solved.flat).energies
        lost = float(np.abs(change.coefficients[-edge.tail_terms :]).sum())
        return _IntegralErrors(
            _EDGE * lost / solved.flat_edge,
            _INTEGRATED * pi / 2.0 * float(np.sqrt(own * flat) @ falls),
            _INTEGRATED * pi / 2.0 * float(flat @ falls),
            _INTEGRATED * pi * float(own @ falls),
        )

    def _growth(self, edge: LogSeries, reach: float, flat_edge: float) -> float:
        """Return ``ddelta/da``, from how the pressure falls to the edge."""
        y = min(_SLOPE * min(self.compliance, 1.0), 0.5 * reach)
        return 2.0 * edge.value(y / reach) / y / flat_edge


def first_space(problem: PartedProblem, boundary: Radius, depth: float) -> Resolution:
    """Return the first space of a part in which the deepest feature is at a depth in ``x``."""
    # square roots of the distance in s**2 at a tip
    rate = 0.5 if boundary is CENTRE else 1.0
    space = starting_resolution(depth, problem.tolerance, rate=rate)
    if len(problem.parts.ends) == 1:
        return space
    digits, degrees = -log(problem.tolerance), list(space.degrees)
    for j, share in enumerate((_FIRST, _SECOND)):
        degrees[j] = max(degrees[j], ceil(share * digits))
    return Resolution(space.panels, tuple(degrees))


def pointwise_errors(
    parts: Parts, used: tuple[Used, ...], whole: Array, change: Change, mean: float
) -> tuple[Array, Array]:
    """Return the expected errors of the pressure on all panels, and by what a degree lowers them.

    They are relative to the pressure, or to its mean if that is larger.
    """
    rates: list[Array] = []
    errors: list[Array] = []
    series = series_on_parts(used, whole)
    each = zip(
        used, series, split_parts(used, whole), split_parts(used, change.coefficients), strict=True
    )
    # a change next to a break says less about the one after it
    factor = _BROKEN if len(used) > 1 else 1.0
    for (panels, degrees), one, own, changed in each:
        rates.append(table_rates(degrees, panel_table(panels, own)))
        size = np.maximum(np.abs(one.at_ends()), mean)
        expected = factor * expected_error(share_of_change(panels, changed, size), rates[-1])
        if parts.pointed and not errors:
            # no degree lowers what the tail at a tip lacks, a root: 1.8 times what it sheds
            tail = float(np.abs(changed[-panels.tail_terms :]).sum()) / float(size[-1])
            expected[-1] = max(float(expected[-1]), 2.0 * tail)
        errors.append(expected)
    return np.concatenate(errors), np.concatenate(rates)


def series_on_parts(used: tuple[Used, ...], coefficients: Array) -> list[LogSeries]:
    """Return the function on every part."""
    return [
        series_of(p, c) for (p, _), c in zip(used, split_parts(used, coefficients), strict=True)
    ]


def split_parts(used: tuple[Used, ...], coefficients: Array) -> list[Array]:
    """Return the coefficients of every part."""
    return np.split(coefficients, np.cumsum([panels.size for panels, _ in used])[:-1])


def edge_value(panels: LogPanels, coefficients: Array) -> float:
    """Return the value at the edge, which the last part's tail has."""
    tail = coefficients[-panels.tail_terms :]
    return float(tail[::2].sum() - tail[1::2].sum())


def bracket_of(profile: Profile, radius: float, space: PressureSpace) -> Array:
    """Return ``H(1) - H(t)`` at the nodes, in units of the radius."""
    past = radius**2 * space.past
    return np.asarray(profile._fall(radius, space.t, space.y, past) / radius)


def profile_parts(profile: Profile, radius: float) -> Parts:
    """Return how a profile cuts a contact of this radius."""
    inside = [b for b in profile.breaks if b < radius]
    breaks = tuple(Radius(b / radius, (radius - b) / radius) for b in inside)
    return Parts(breaks, profile.pointed)


def _smooth(profile: Profile, radius: float, *, pointwise: bool) -> Indentation:
    """Return the contact on a smooth surface, where the half-integral is known."""
    parts, a = profile_parts(profile, radius), radius
    panels = LogPanels(_NODES[0], PANEL_WIDTH, _NODES[1])
    space = PartedSpace(parts, ((panels, (panels.degree,) * panels.panels),) * len(parts.ends))
    bracket = bracket_of(profile, a, space)
    moment, energy = float(space.weights @ bracket), float(space.weights @ bracket**2)
    pressure = smooth_pressure(profile, a, parts) if pointwise else None
    last = max((b for b in profile.breaks if b < a), default=0.0)
    past = (a - last) * (a + last) if last else 0.0
    return Indentation(
        a,
        float(profile._transform(np.asarray(a))) / 2.0,
        4 * a**2 * moment,
        a**3 * energy,
        8 * a,
        float(profile._rate(np.array([a]), np.array([past]))[0]) / 2.0,
        None if pressure is None else parts.field(pressure.series),
        None,
        ROUNDING,
        2.0 * ROUNDING,
        2.0 * ROUNDING,
        ROUNDING,
        inf if pressure is None else pressure.error + FIELD_ROUNDING,
    )


def solve_indentation(
    profile: Profile,
    radius: float,
    compliance: float,
    tolerance: float,
    max_unknowns: int,
    *,
    pointwise: bool = True,
) -> Indentation | Refinement[Indentation]:
    """Solve normal contact under a profile on a contact of a given radius.

    Parameters
    ----------
    profile : Profile
    radius : float
        Larger than the flat part of the profile, smaller than its reach.
    compliance : float
        ``alpha*`` in the profile's unit of length.
    tolerance : float
        Bound on the relative error of approach and load, and of the pressure if that is wanted.
    max_unknowns : int
        Most unknowns of a space.
    pointwise : bool
        Whether the pressure is wanted.

    Returns
    -------
    Indentation or Refinement
        On a smooth surface the half-integral is known, and there is nothing to refine.
    """
    if compliance == 0.0:
        return _smooth(profile, radius, pointwise=pointwise)
    problem = _IndentationProblem(profile, radius, compliance, tolerance, pointwise=pointwise)
    return refine(problem, tolerance, max_unknowns)
