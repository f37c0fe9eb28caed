r"""Normal contact under a profile, of a given radius ``a``: `normal`'s equation with one more load.

On the unit disk ``(alpha/a) p + N p = (delta - h(a s))/a``, whose half-integral's target is
``[H(1) - H(t)] + 2 eps``: the bracket is known exactly, and the pressure is that of the bracket
plus ``eps`` times that of a flat punch, which the same factors give. ``eps`` is what makes the
pressure vanish at the edge (docs/theory, profiles).

With adhesion it is what makes the pressure at the edge ``-sqrt(2 w / alpha)``, at which the energy
release rate ``alpha p**2 / 2`` is the work of adhesion w; on a smooth surface the pressure is
infinite there, and its intensity is given (docs/theory, adhesion).
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
    field_of,
    layer_depth,
    pointwise_errors,
    profile_parts,
    series_on_parts,
)
from spectral_contact.contact.refine import Refinement, SpaceSolution, refine, within_budget
from spectral_contact.contact.smooth_indented import smooth_contact
from spectral_contact.contact.tuning import FIELD_ROUNDING, ROUNDING
from spectral_contact.fields.series import EdgeWeight, LogSeries
from spectral_contact.profiles.profile_base import Profile
from spectral_contact.spectral.panels import DiscreteSpace, LogPanels
from spectral_contact.spectral.regularised import Regularised
from spectral_contact.spectral.spaces import Space, disk_space

Array = NDArray[np.float64]

#: Places next to the edge, in units of the layer, where the pressure's slope is taken.
_SLOPE = 1e-4
#: Error of ``eps`` over what the tail at the edge changes.
_EDGE = 1.0
#: What integrals of a smooth space lack, as the worst of three times 300 random profiles need it.
_INTEGRATED = 2.0
#: Roundings of the shift, and of what follows from it, measured over random profiles and against
#: the gold tables: the work under a rounded flat takes 3.05.
_ROUNDINGS = 3.5
#: The place of a break is rounded, which counts relative to its distance from the edge: so many of
#: our roundings for integrals and for the pressure, measured as close as 1e-4 of the radius.
_PLACE, _PLACE_POINTWISE = 0.2, 0.7
#: Rounding of the pressure deep in a thin layer, where it is what the layer's equation leaves.
_LAYER_ROUNDING = 1e-16


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
    pull : float
        By how much adhesion lowers ``eps``.
    pull_error : float
        Relative error of that in the coarser space.
    flat_edge : float
        Pressure of the flat punch at the edge.
    """

    factored: Regularised
    flat: Array
    whole: Array
    flat_half: Array
    whole_half: Array
    target: Array
    shift: float
    pull: float
    pull_error: float
    flat_edge: float


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
        adhesion: float = 0.0,
    ) -> None:
        self.profile, self.radius = profile, radius
        #: suction at the edge
        self.suction = sqrt(2.0 * adhesion / compliance)
        #: in units of the contact radius
        self.compliance = compliance / radius
        parts, thin = profile_parts(profile, radius), min(self.compliance, 1.0)
        depths = [layer_depth(thin, boundary, extent) for boundary, _, extent in parts.ends]
        super().__init__(parts, depths, tolerance, pointwise=pointwise)

    def attempt(self, resolution: DiscreteSpace) -> SpaceSolution[Indentation]:
        """Solve in a space."""
        used = self.part_spaces(resolution)
        space = disk_space(self.parts, used)
        return self._judged(space, used, self._solve(space, used[-1][0]))

    def _solve(self, space: Space, edge: LogPanels) -> _TwoPressures:
        bracket = self.profile._bracket(self.radius, space.t, space.y, space.past)
        factored = space.factor(self.compliance)
        own = factored.solve(bracket)
        flat = factored.solve(2.0)
        at_edge = edge_value(edge, flat)
        half = space.half_integral
        flat_half = half(flat)
        pull, pull_error = self._pull(factored, flat, float(space.weights @ flat_half))
        shift = -edge_value(edge, own) / at_edge - pull
        whole = own + shift * flat
        target = bracket + 2.0 * shift
        halves = flat_half, half(whole)
        pulled = pull, pull_error
        return _TwoPressures(factored, flat, whole, *halves, target, shift, *pulled, at_edge)

    def _pull(self, factored: Regularised, flat: Array, flat_moment: float) -> tuple[float, float]:
        """Return by how much adhesion lowers ``eps``, and the relative error in a coarser space.

        The pressure of the flat punch at the edge, which the suction is divided by, follows from
        integrals, which superconverge (docs/theory, exact identities).
        """
        if self.suction == 0.0:
            return 0.0, 0.0
        space = factored.space
        index = space.index
        change = factored.change(flat).coefficients
        image = space.mass @ (2.0 * flat + change)[index]
        moment = 2.0 / (pi * self.compliance) * flat_moment
        square = moment + float(flat[index] @ (space.mass @ flat[index]))
        return self.suction / sqrt(square), abs(float(change[index] @ image)) / (2.0 * square)

    def glance(self, max_unknowns: int) -> Indentation:
        """Return the contact in the first space, whatever its errors are: they are 0."""
        used = self.part_spaces(within_budget(self.start(), max_unknowns))
        space = disk_space(self.parts, used)
        return self._contact(space, used, self._solve(space, used[-1][0]))

    def _contact(
        self, space: Space, used: tuple[DiscreteSpace, ...], solved: _TwoPressures
    ) -> Indentation:
        """Return the contact without its errors."""
        a, weights = self.radius, space.weights
        series, flat = (series_on_parts(used, one) for one in (solved.whole, solved.flat))
        unpulled = series[-1]
        if solved.pull > 0.0:
            unpulled = series_on_parts(used, solved.whole + solved.pull * solved.flat)[-1]
        return Indentation(
            a,
            a * (self._whole_height + solved.shift),
            4 * a**2 * float(weights @ solved.whole_half),
            a**3 * float(weights @ (solved.whole_half * solved.target)),
            4 * a * float(weights @ solved.flat_half),
            self._growth(unpulled, self.parts.ends[-1][2], solved.flat_edge),
            field_of(self.parts, series) if self.pointwise else None,
            field_of(self.parts, flat) if self.pointwise else None,
            pull=a * solved.pull,
        )

    @property
    def _whole_height(self) -> float:
        """The approach on a smooth surface, in units of the radius."""
        return float(self.profile._transform(np.asarray(self.radius))) / (2.0 * self.radius)

    def _judged(
        self, space: Space, used: tuple[DiscreteSpace, ...], solved: _TwoPressures
    ) -> SpaceSolution[Indentation]:
        """Return the contact with its errors."""
        a, found = self.radius, self._contact(space, used, solved)
        moment, flat_moment = found.load_size / (4 * a**2), found.stiffness / (4 * a)
        energy, whole_height = found.work / a**3, self._whole_height
        approach = found.approach_size / a
        change, mean = solved.factored.change(solved.whole), 4 / pi * moment
        indicators = pointwise_errors(self.parts, used, solved.whole, change, mean)
        own = change.energies
        flat_change = solved.factored.change(solved.flat)
        flat = _INTEGRATED * flat_change.energies
        load_lost = pi / 2.0 * float(np.sqrt(_INTEGRATED * own * flat).sum())
        work_lost = _INTEGRATED * pi * float(own.sum())
        # of what has no suction at the edge
        regular = change.coefficients + solved.pull * flat_change.coefficients
        lost = float(np.abs(regular[-used[-1].panels.tail_terms :]).sum())
        noise = _ROUNDINGS * ROUNDING * max(whole_height, abs(solved.shift))
        shifted = _EDGE * lost / solved.flat_edge + noise
        pressure_error = float(indicators.max()) + _ROUNDINGS * FIELD_ROUNDING
        place = ROUNDING * max((a / (a - b) for b in self.profile.breaks if b < a), default=0.0)
        shifted += _PLACE * place * approach
        if solved.pull > 0.0:
            from_moment = pi / 2.0 * float(flat.sum()) / flat_moment
            shifted += solved.pull * (solved.pull_error + from_moment + ROUNDING)
        pressure_error += _PLACE_POINTWISE * place
        if len(used) > 1:
            pressure_error += _LAYER_ROUNDING * whole_height / (self.compliance * mean)
        indentation = replace(
            found,
            approach_error=shifted / approach + ROUNDING,
            load_error=(shifted * flat_moment + load_lost) / moment + ROUNDING,
            work_error=(4 * shifted * moment + work_lost) / energy + ROUNDING,
            stiffness_error=pi / 2.0 * float(flat.sum()) / flat_moment + 2.0 * ROUNDING,
            pressure_error=pressure_error,
        )
        error = max(indentation.approach_error, indentation.load_error)
        if self.pointwise:
            error = max(error, pressure_error)
        else:
            indicators = indicators**2
        return SpaceSolution(indentation, error, indicators, space.unknowns)

    def _growth(self, edge: LogSeries, reach: float, flat_edge: float) -> float:
        """Return ``ddelta/da``, from how the pressure falls to the edge."""
        y = min(_SLOPE * min(self.compliance, 1.0), 0.5 * reach)
        return 2.0 * edge.value(y / reach) / y / flat_edge


def _smooth(profile: Profile, radius: float, *, pointwise: bool, adhesion: float) -> Indentation:
    """Return the contact on a smooth surface, where the half-integral is known.

    With adhesion that of a flat punch is taken away, by Johnson, Kendall and Roberts (1971).
    """
    parts, a = profile_parts(profile, radius), radius
    found = smooth_contact(profile, a, parts, pointwise=pointwise)
    pressure = found.pressure
    pull = sqrt(pi * a * adhesion / 2.0)
    less = 2.0 * pull / a
    weight = EdgeWeight(-2.0 / pi * less, 0.0) if adhesion else None
    last = max((b for b in profile.breaks if b < a), default=0.0)
    past = (a - last) * (a + last) if last else 0.0
    return Indentation(
        a,
        float(profile._transform(np.asarray(a))) / 2.0 - pull,
        4 * a**2 * (found.moment - less),
        a**3 * (found.energy - less * (2.0 * found.moment - less)),
        8 * a,
        float(profile._rate(np.array([a]), np.array([past]))[0]) / 2.0,
        None if pressure is None else field_of(parts, pressure.series, weight),
        None,
        ROUNDING,
        2.0 * ROUNDING,
        2.0 * ROUNDING,
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
        Larger than the flat part of the profile, smaller than its reach; with adhesion it may be
        that of the flat part.
    compliance : float
        ``alpha*`` in the profile's unit of length.
    tolerance : float
        Bound on the relative error of approach and load, and of the pressure if that is wanted.
    max_unknowns : int
        Most unknowns of a space.
    pointwise : bool
        Whether the pressure is wanted.
    adhesion : float
        Work of adhesion, 0 without.

    Returns
    -------
    Indentation or Refinement
        On a smooth surface the half-integral is known, and there is nothing to refine.
    """
    if compliance == 0.0:
        return _smooth(profile, radius, pointwise=pointwise, adhesion=adhesion)
    problem = _IndentationProblem(
        profile, radius, compliance, tolerance, pointwise=pointwise, adhesion=adhesion
    )
    return refine(problem, tolerance, max_unknowns)


def glance(
    profile: Profile,
    radius: float,
    compliance: float,
    tolerance: float,
    max_unknowns: int,
    *,
    adhesion: float = 0.0,
) -> Indentation:
    """Return the integrals of such a contact in the first space, without estimates."""
    if compliance == 0.0:
        return _smooth(profile, radius, pointwise=False, adhesion=adhesion)
    problem = _IndentationProblem(
        profile, radius, compliance, tolerance, pointwise=False, adhesion=adhesion
    )
    return problem.glance(max_unknowns)
