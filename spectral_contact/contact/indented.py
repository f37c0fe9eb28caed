r"""Normal contact under a profile, of a given radius ``a``.

h(s) is the height of the punch, delta the approach, alpha the normal compliance, and N the normal
operator of docs/theory. All lengths are in units of a in what follows, alpha and the work of
adhesion w among them. Pressures are in units of E', a quarter of the plane-strain modulus E*, so
that the stiffness of a flat punch is 8 on a smooth surface. On the unit disk the pressure p obeys
``alpha p + N p = delta - h``.

On a smooth surface (alpha = 0) the half-integral F(t) = ``int_t^1 p s ds / sqrt(s**2 - t**2)`` is
known: with ``H(t) = 2 t int_0^t h'(s) ds / sqrt(t**2 - s**2)`` it is ``2 delta - H(t)``. That is
written ``[H(1) - H(t)] + 2 eps``, with ``delta = H(1)/2 + eps`` (docs/profiles), and is called the
*target*; the bracket is evaluated without cancellation. With a layer the target is the right-hand
side of the least-squares form of the problem (docs/theory). The problem is solved for two
right-hand sides with one factorised matrix: the pressure is that of the bracket plus ``eps`` times
that of a flat punch of unit approach. The number ``eps``, the *shift*, is such that the pressure at
the edge is zero.

With adhesion the pressure at the edge is minus the *suction*, ``sqrt(2 w / alpha)``: then the
energy release rate ``alpha p**2 / 2`` is w. This lowers eps by the *pull*. On a smooth surface the
pressure at the edge is infinite; w determines the factor of its inverse square root (docs/theory,
adhesion).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import inf, pi, sqrt

import numpy as np
from numpy.typing import NDArray

from spectral_contact.contact.on_parts import (
    Indentation,
    PartedProblem,
    edge_value,
    feature_depths,
    field_of,
    pointwise_errors,
    profile_parts,
    series_on_parts,
)
from spectral_contact.contact.refine import Refinement, SpaceSolution, refine, within_budget
from spectral_contact.contact.smooth_indented import smooth_contact
from spectral_contact.contact.tuning import FIELD_ROUNDING, ROUNDING
from spectral_contact.errors import SceneError
from spectral_contact.fields.series import EdgeWeight, LogSeries
from spectral_contact.profiles.profile_base import Profile
from spectral_contact.spectral.panels import DiscreteSpace, LogPanels
from spectral_contact.spectral.regularised import RegularisedProblem
from spectral_contact.spectral.spaces import Space, disk_space

Array = NDArray[np.float64]

#: What is required of the radius, load or approach of a contact.
REPRESENTABLE = "such that load and work of the contact are in [2.3e-308, 1.7e308], the range of "
REPRESENTABLE += "floating-point numbers"
#: What a load, work or approach has to be that came out negative.
POSITIVE = "such that load, work and approach are positive beyond rounding: "
POSITIVE += "the slope of the profile is too small there, or the layer is too thin"

#: The slope of the pressure at the edge is taken at this distance y from there, in units of the
#: width of the layer at the edge. Under a sphere the half-integral has a pole at the equator; if
#: that is nearer than the layer is wide, the unit is the distance to it.
_SLOPE_DISTANCE = 1e-4
#: A layer thinner than this share of 1, of the distance to the pole and of the last part of the
#: profile changes ``ddelta/da`` by about 20 times this share.
_THIN = 1e-8
#: The error of an integral is this times the energy of what the top degrees contribute. The worst
#: of 900 random profiles needs this factor.
_ENERGY_FACTOR = 2.0
#: Rounding error of the shift, and of the results that follow from it, in units of ROUNDING. It was
#: measured over random profiles, against the gold tables (the work under a rounded flat is off by
#: 3.05 units) and for radii next to the equator of a sphere (the load is off by 3.9 units without
#: fused multiply-add, tests/reference/test_indentation.py).
_ROUNDINGS = 5.0
#: The radius b of a break is rounded. The relative error of its distance from the edge is ROUNDING
#: a/(a - b). The error of the approach is the first number times that, and the error of the
#: pressure the second, measured for distances down to 1e-4 of the contact radius.
_BREAK_ROUNDINGS, _BREAK_FIELD_ROUNDINGS = 0.2, 0.7
#: Rounding error of the pressure at a tip and at breaks. Where alpha is small, alpha p is a small
#: difference of lengths of the order of the depth of the indentation. So the error is this times
#: ``depth / sqrt(alpha b)`` at a break of radius b, and this times ``depth / (2 alpha)`` at a tip,
#: with alpha and b in units of the contact radius. Measured against 18 digits, for alpha from 1e-8
#: to 1e-2, with and without fused multiply-add, it is at most 1.8e-15, both at the breaks of
#: rounded flats and truncated cones and at the tips of power laws.
_LAYER_ROUNDING = 2.5e-15


class UnrepresentableError(SceneError):
    """Load or work of a contact of this radius are no positive floating-point numbers."""


@dataclass(frozen=True, slots=True)
class _TwoPressures:
    """The pressures under a flat punch and under the profile, in one space.

    Attributes
    ----------
    factored : RegularisedProblem
    flat, pressure : ndarray
        Coefficients of the pressure of a flat punch for unit approach, and of the pressure p under
        the profile.
    flat_half, pressure_half : ndarray
        Their half-integrals at the nodes.
    target : ndarray
        The target of the half-integral of p.
    shift : float
        ``eps``.
    pull : float
        The part that adhesion takes from ``eps``.
    pull_error : float
        Relative error of the pull in the coarser space.
    flat_edge : float
        Pressure of the flat punch at the edge.
    """

    factored: RegularisedProblem
    flat: Array
    pressure: Array
    flat_half: Array
    pressure_half: Array
    target: Array
    shift: float
    pull: float
    pull_error: float
    flat_edge: float


class _IndentationProblem(PartedProblem):
    """The problem of a contact of given radius under a profile, for `refine`."""

    def __init__(
        self,
        profile: Profile,
        radius: float,
        compliance: float,
        tolerance: float,
        *,
        pointwise: bool,
        adhesion: float = 0.0,
    ) -> None:
        self.profile = profile
        self.radius = radius
        self.suction = sqrt(2.0 * adhesion / compliance)
        #: in units of the contact radius
        self.compliance = compliance / radius
        parts = profile_parts(profile, radius)
        width = min(self.compliance, 1.0)
        depths = feature_depths(parts, width, profile._to_pole(radius))
        super().__init__(parts, depths, tolerance, pointwise=pointwise)

    def attempt(self, space: DiscreteSpace) -> SpaceSolution[Indentation]:
        """Return the solution in a space, with its error estimates."""
        used = self.part_spaces(space)
        nodal_space = disk_space(self.parts, used)
        solved = self._solve(nodal_space, used[-1].panels)
        return self._with_errors(nodal_space, used, solved)

    def _solve(self, space: Space, edge: LogPanels) -> _TwoPressures:
        """Return both pressures; `edge` are the panels next to the edge."""
        bracket = self.profile._bracket(self.radius, space.t, space.y, space.past_break)
        factored = space.factor(self.compliance)
        by_bracket = factored.solve(bracket)
        flat = factored.solve(2.0)
        flat_edge = edge_value(edge, flat)
        flat_half = space.half_integral(flat)
        pull, pull_error = self._pull(factored, flat, float(space.weights @ flat_half))
        shift = -edge_value(edge, by_bracket) / flat_edge - pull
        pressure = by_bracket + shift * flat
        return _TwoPressures(
            factored,
            flat,
            pressure,
            flat_half,
            space.half_integral(pressure),
            bracket + 2.0 * shift,
            shift,
            pull,
            pull_error,
            flat_edge,
        )

    def _pull(
        self, factored: RegularisedProblem, flat: Array, flat_moment: float
    ) -> tuple[float, float]:
        """Return the pull, and its relative error in the coarser space.

        The pull is the suction over the pressure ``p_e`` of the flat punch at the edge. By an exact
        identity (docs/theory, adhesion), ``p_e**2 = 2/(pi alpha) int F dt + int p**2 s ds`` for
        unit approach. Integrals superconverge, so that this has more digits than the pressure at
        the edge itself. `flat_moment` is ``int F dt`` of the flat punch.

        The error is that of the sum in the coarser space, without the top degrees.
        """
        if self.suction == 0.0:
            return 0.0, 0.0
        space = factored.space
        index = space.index
        change = factored.change(flat).coefficients
        moment = 2.0 / (pi * self.compliance) * flat_moment
        square = moment + float(flat[index] @ (space.mass @ flat[index]))
        # int (p + change)**2 s ds - int p**2 s ds, without cancellation
        weighted = space.mass @ (2.0 * flat + change)[index]
        square_change = float(change[index] @ weighted)
        return self.suction / sqrt(square), abs(square_change) / (2.0 * square)

    def values_only(self, max_unknowns: int) -> Indentation:
        """Return the contact in the first space, with 0 in place of error estimates."""
        used = self.part_spaces(within_budget(self.start(), max_unknowns))
        space = disk_space(self.parts, used)
        return self._contact(space, used, self._solve(space, used[-1].panels))

    def _contact(
        self, space: Space, used: tuple[DiscreteSpace, ...], solved: _TwoPressures
    ) -> Indentation:
        """Return the contact without error estimates."""
        a = self.radius
        weights = space.weights
        series = series_on_parts(used, solved.pressure)
        flat = series_on_parts(used, solved.flat)
        edge_series = series[-1]
        if solved.pull > 0.0:
            # the pressure without adhesion
            edge_series = series_on_parts(used, solved.pressure + solved.pull * solved.flat)[-1]
        return Indentation(
            a,
            a * (self._smooth_approach + solved.shift),
            4 * a * a * float(weights @ solved.pressure_half),
            a * a * a * float(weights @ (solved.pressure_half * solved.target)),
            4 * a * float(weights @ solved.flat_half),
            self._growth(edge_series, self.parts.ends[-1][2], solved.flat_edge),
            field_of(self.parts, series) if self.pointwise else None,
            field_of(self.parts, flat) if self.pointwise else None,
            pull=a * solved.pull,
        )

    @property
    def _smooth_approach(self) -> float:
        """The approach on a smooth surface, ``H(a)/2``, in units of the radius."""
        return float(self.profile._transform(np.asarray(self.radius))) / (2.0 * self.radius)

    def _with_errors(
        self, space: Space, used: tuple[DiscreteSpace, ...], solved: _TwoPressures
    ) -> SpaceSolution[Indentation]:
        """Return the contact with its error estimates."""
        a = self.radius
        contact = self._contact(space, used, solved)
        _check_range(contact)
        # in units of the radius: int F dt of the pressure and of the flat punch, the work, the
        # approach on a smooth surface and the approach
        moment = contact.load_size / (4 * a**2)
        flat_moment = contact.stiffness / (4 * a)
        energy = contact.work / a**3
        smooth_approach = self._smooth_approach
        approach = contact.approach_size / a
        change = solved.factored.change(solved.pressure)
        mean = 4 / pi * moment
        indicators = pointwise_errors(self.parts, used, solved.pressure, change, mean)
        energies = change.energies
        flat_change = solved.factored.change(solved.flat)
        flat_energies = _ENERGY_FACTOR * flat_change.energies
        # errors of the two integrals at a given shift
        moment_error = pi / 2.0 * float(np.sqrt(_ENERGY_FACTOR * energies * flat_energies).sum())
        energy_error = _ENERGY_FACTOR * pi * float(energies.sum())
        # The pressure at the edge is a sum of the last coefficients alone, those of the tail that
        # the mesh ends in. What the top degrees contribute to it, without adhesion, divided by the
        # pressure of the flat punch there, is the error of eps.
        regular = change.coefficients + solved.pull * flat_change.coefficients
        edge_change = float(np.abs(regular[-used[-1].panels.tail_terms :]).sum())
        # the order of magnitude of the half-integrals of the two pressures that are added
        depth = max(smooth_approach, abs(solved.shift))
        noise = _ROUNDINGS * ROUNDING * depth
        shift_error = edge_change / solved.flat_edge + noise
        # changes by the top degrees contain this rounding, too, but may be small by accident
        layer_rounding = _LAYER_ROUNDING * depth * self._layer_rounding(used, solved, mean)
        pressure_error = max(float(indicators.max()), layer_rounding) + _ROUNDINGS * FIELD_ROUNDING
        breaks = [b for b in self.profile.breaks if b < a]
        break_rounding = ROUNDING * max((a / (a - b) for b in breaks), default=0.0)
        shift_error += _BREAK_ROUNDINGS * break_rounding * approach
        # of int F dt of the flat punch
        from_moment = pi / 2.0 * float(flat_energies.sum()) / flat_moment
        if solved.pull > 0.0:
            shift_error += solved.pull * (solved.pull_error + from_moment + ROUNDING)
        pressure_error += _BREAK_FIELD_ROUNDINGS * break_rounding
        indentation = replace(
            contact,
            approach_error=shift_error / approach + ROUNDING,
            load_error=(shift_error * flat_moment + moment_error) / moment + ROUNDING,
            work_error=(4 * shift_error * moment + energy_error) / energy + ROUNDING,
            stiffness_error=from_moment + 2.0 * ROUNDING,
            pressure_error=pressure_error,
        )
        if not self.pointwise:  # errors of integrals are squares of those of the pressure
            indicators = indicators**2
        error = indentation.largest_error(pointwise=self.pointwise)
        return SpaceSolution(indentation, error, indicators, space.unknowns)

    def _layer_rounding(
        self, used: tuple[DiscreteSpace, ...], solved: _TwoPressures, mean: float
    ) -> float:
        """Return the factor of the rounding of lengths in the relative error of the pressure.

        It is the largest of ``1 / (sqrt(alpha b) p)`` at breaks and ``1 / (2 alpha p)`` at the tip
        (`_LAYER_ROUNDING`), which is the same expression with ``b = 4 alpha``.
        """
        series = series_on_parts(used, solved.pressure)
        factors = [0.0]
        for (boundary, _, _), part in zip(self.parts.ends[:-1], series[:-1], strict=True):
            size = max(abs(float(part.at_ends()[-1])), mean)
            width = sqrt(self.compliance * max(boundary.value, 4.0 * self.compliance))
            factors.append(1.0 / (width * size))
        return max(factors)

    def _growth(self, edge: LogSeries, extent: float, flat_edge: float) -> float:
        """Return ``ddelta/da``, from the slope of the pressure next to the edge.

        Without adhesion. As a grows by da, the pressure at the old edge grows from 0 to da times
        the slope of the pressure there. This is the pressure that a flat punch of the approach
        ddelta has at the edge. `edge` is the pressure on the last part, and `extent` the extent of
        that part in ``s**2``.

        Under a thin layer the pressure there is lost in the rounding of that at the edge; the rate
        is then that on a smooth surface.
        """
        to_pole = self.profile._to_pole(self.radius)
        if self.compliance < _THIN * min(to_pole, extent, 1.0):
            return _smooth_growth(self.profile, self.radius)
        y = min(_SLOPE_DISTANCE * min(self.compliance, to_pole, 1.0), 0.5 * extent)
        return 2.0 * edge.value(y / extent) / y / flat_edge


def _check_range(contact: Indentation) -> None:
    """Refuse a contact whose load or work is negative or no normal double.

    Where the slope of a profile is as small as the errors of its series, a load may have any sign.
    One that is no normal double has lost digits, or is infinite.

    Products with powers of the radius overflow to infinity; a power itself would raise an error.
    """
    limits = np.finfo(float)
    for value in (contact.load_size, contact.work):
        if value < 0.0:
            raise UnrepresentableError("contact_radius", contact.radius, POSITIVE)
        if not limits.tiny <= value <= limits.max:
            raise UnrepresentableError("contact_radius", contact.radius, REPRESENTABLE)


def _smooth_growth(profile: Profile, radius: float) -> float:
    """Return ``ddelta/da`` on a smooth surface, without adhesion."""
    last_break = max((b for b in profile.breaks if b < radius), default=0.0)
    past_break = (radius - last_break) * (radius + last_break) if last_break else 0.0
    return float(profile._rate(np.array([radius]), np.array([past_break]))[0]) / 2.0


def _smooth(
    profile: Profile, radius: float, *, pointwise: bool, estimated: bool, adhesion: float
) -> Indentation:
    """Return the contact on a smooth surface, where the half-integral F is known.

    Adhesion lowers F by a constant, which is the half-integral of a flat punch (Johnson, Kendall
    and Roberts, 1971).
    """
    parts = profile_parts(profile, radius)
    a = radius
    contact = smooth_contact(profile, a, parts, pointwise=pointwise, estimated=estimated)
    pressure = contact.pressure
    pull = sqrt(pi * a * adhesion / 2.0)
    flat_half = 2.0 * pull / a
    weight = EdgeWeight(-2.0 / pi * flat_half, 0.0) if adhesion else None
    return Indentation(
        a,
        float(profile._transform(np.asarray(a))) / 2.0 - pull,
        4 * a * a * (contact.moment - flat_half),
        a * a * a * (contact.energy - flat_half * (2.0 * contact.moment - flat_half)),
        8 * a,
        _smooth_growth(profile, a),
        None if pressure is None else field_of(parts, pressure.series, weight),
        None,
        ROUNDING,
        2.0 * ROUNDING + contact.moment_error,
        2.0 * ROUNDING + contact.energy_error,
        ROUNDING,
        inf if pressure is None else pressure.error + FIELD_ROUNDING,
        pull=pull,
    )


def solve_indentation(
    profile: Profile,
    radius: float,
    compliance: float,
    tolerance: float,
    max_unknowns: int,
    *,
    pointwise: bool = True,
    adhesion: float = 0.0,
) -> Indentation | Refinement[Indentation]:
    """Solve normal contact under a profile on a contact of a given radius.

    Parameters
    ----------
    profile : Profile
    radius : float
        The contact radius a, larger than that of the flat part of the profile and smaller than the
        radius where the profile ends (its reach); with adhesion it may be that of the flat part.
    compliance : float
        alpha, in the profile's unit of length.
    tolerance : float
        Bound on the relative error of approach and load, and of the pressure if that is wanted.
    max_unknowns : int
        Most unknowns of a space.
    pointwise : bool
        Whether the pressure is wanted.
    adhesion : float
        Work of adhesion, in the unit of pressure times that of length; 0 without.

    Returns
    -------
    Indentation or Refinement
        An `Indentation` on a smooth surface, where the half-integral is known and there is nothing
        to refine. Else a `Refinement`.

    Raises
    ------
    SceneError
        If load or work are too small or too large for floating-point numbers.
    """
    limits = np.finfo(float)
    if not limits.tiny <= radius * radius <= limits.max:
        raise UnrepresentableError("contact_radius", radius, REPRESENTABLE)
    if compliance == 0.0:
        contact = _smooth(profile, radius, pointwise=pointwise, estimated=True, adhesion=adhesion)
        _check_range(contact)
        return contact
    problem = _IndentationProblem(
        profile, radius, compliance, tolerance, pointwise=pointwise, adhesion=adhesion
    )
    return refine(problem, tolerance, max_unknowns)


def values_only(
    profile: Profile,
    radius: float,
    compliance: float,
    tolerance: float,
    max_unknowns: int,
    *,
    adhesion: float = 0.0,
) -> Indentation:
    """Return the contact in the first space, without pressure and estimates of discretisation.

    Parameters are those of `solve_indentation`.
    """
    if compliance == 0.0:
        return _smooth(profile, radius, pointwise=False, estimated=False, adhesion=adhesion)
    problem = _IndentationProblem(
        profile, radius, compliance, tolerance, pointwise=False, adhesion=adhesion
    )
    return problem.values_only(max_unknowns)
