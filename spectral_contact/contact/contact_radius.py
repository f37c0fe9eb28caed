r"""The contact radius that a load, or an approach, asks for.

Both grow with the radius without bound, and ``dP/da = (dP/ddelta) (ddelta/da)`` is known with
either, so Newton's method takes few steps. The unknown is the logarithm of how far the radius is
beyond the flat part of the profile, over how far it is from its reach. First steps are taken in
poor spaces.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import exp, inf, isfinite, isinf, log, pi

import numpy as np

from spectral_contact.contact.indented import solve_indentation
from spectral_contact.contact.on_parts import Indentation
from spectral_contact.contact.refine import Refinement
from spectral_contact.contact.tuning import ROUNDING
from spectral_contact.errors import SceneError
from spectral_contact.profiles.profile_base import Profile
from spectral_contact.records import Ending

Contact = Indentation | Refinement[Indentation]
#: The contact of a radius, to a tolerance, and whether the pressure is wanted.
Solver = Callable[[float, float, bool], Contact]

#: Steps in all; the longest.
_STEPS, _LONGEST = 60, 3.0
#: Steps from which on a secant is taken for the slope.
_CLOSE = 0.5
#: The misfit of a secant over the product of the last two, measured 0.001 ... 0.06.
_SECANT = 0.1
#: Share of the tolerance that what was asked for, and what follows from the radius, may be off.
_SHARE = 0.02
#: Distances from edge and breaks between which the slope of the pressure is taken.
_PLACES = np.geomspace(ROUNDING, 1.0, 61)


@dataclass(frozen=True, slots=True)
class RadiusScale:
    """The unknown and the radius that it stands for."""

    profile: Profile

    def radius(self, v: float) -> float:
        """Return the radius."""
        low, high = self.profile.flat_part, self.profile.reach
        if isinf(high):
            return low + exp(v)
        return (
            low + (high - low) / (1.0 + exp(-v))
            if v < 0.0
            else high - (high - low) / (1.0 + exp(v))
        )

    def place(self, radius: float) -> float:
        """Return the unknown of a radius."""
        low, high = self.profile.flat_part, self.profile.reach
        return log(radius - low) - (0.0 if isinf(high) else log(high - radius))

    def slope(self, radius: float) -> float:
        """Return the derivative of the radius in the unknown."""
        low, high = self.profile.flat_part, self.profile.reach
        room = 1.0 if isinf(high) else (high - radius) / (high - low)
        return (radius - low) * room


def indenter(profile: Profile, compliance: float, max_unknowns: int) -> Solver:
    """Return what solves normal contact with a linear layer at a radius, to a tolerance."""

    def solve(radius: float, tolerance: float, pointwise: bool) -> Contact:
        given = profile, radius, compliance, tolerance, max_unknowns
        return solve_indentation(*given, pointwise=pointwise)

    return solve


def find_radius(
    profile: Profile,
    solve: Solver,
    tolerance: float,
    *,
    load: float | None,
    approach: float | None,
    pointwise: bool,
    near: float | None = None,
    origin: float = 0.0,
    first: Callable[[float], Contact] | None = None,
) -> tuple[Contact, float]:
    """Return the contact under a load or approach, and the relative error of its radius.

    Parameters
    ----------
    profile : Profile
    solve : callable
        Solves at a radius.
    tolerance : float
    pointwise : bool
        Whether the pressure is wanted.
    load, approach : float or None
        One of them.
    near : float or None
        Where the radius may be.
    origin : float
        Approach at which the contact begins.
    first : callable, optional
        Solves at a radius for the first steps, without estimates.

    Raises
    ------
    SceneError
        If no contact smaller than the profile carries it.
    """
    search = _RadiusSearch(profile, load, approach, near, origin)

    def solved(tolerance: float, pointwise: bool) -> Callable[[float], Contact]:
        return lambda radius: solve(radius, tolerance, pointwise)

    off = max(_SHARE * tolerance, ROUNDING)
    # a poor space knows what is integrated as well as a rich one knows the pressure
    if pointwise or first is not None:
        search.run(first or solved(tolerance, False), off, rough=True)
    search.run(solved(tolerance, pointwise), off)
    found, error = search.found()
    if search.rate * error > _SHARE * tolerance:  # next to a corner the pressure hangs on it
        search.run(solved(tolerance, pointwise), max(off / search.rate, ROUNDING))
        found, error = search.found()
    space_converged = isinstance(found, Refinement) and found.ending is Ending.CONVERGED
    if space_converged and _largest_error(value_of(found), pointwise) > tolerance:
        # what the radius adds takes the errors of the space above the tolerance
        search.run(solved(tolerance / 4, pointwise), off)
        found, error = search.found()
    return found, error


def _largest_error(contact: Indentation, pointwise: bool) -> float:
    """Return the largest relative error that the tolerance bounds."""
    errors = (
        contact.approach_error,
        contact.load_error,
        contact.work_error,
        contact.stiffness_error,
    )
    return max(*errors, contact.pressure_error if pointwise else 0.0)


class _RadiusSearch:
    """Newton's method, bracketed."""

    def __init__(
        self,
        profile: Profile,
        load: float | None,
        approach: float | None,
        near: float | None,
        origin: float,
    ) -> None:
        self.profile, self.load, self.approach, self.origin = profile, load, approach, origin
        self.at = RadiusScale(profile)
        size = profile.flat_part or (1.0 if isinf(profile.reach) else profile.reach)
        if near is None or not profile.flat_part < near < profile.reach:
            near = profile.flat_part + 0.5 * size
        self.v = self.at.place(near)
        self.low, self.high = -inf, inf
        self.last: Contact | None = None
        self.misfit = inf
        self.known = 0.0
        self.slope = 1.0
        #: by how much the pressure found hangs on the radius
        self.rate = 0.0
        self.before: float | None = None

    def run(self, solve: Callable[[float], Contact], near: float, *, rough: bool = False) -> None:
        """Step until the logarithm of the value is as near to that of what is asked for.

        Or, if rough, as near as the value is known, or as the next secant leads.
        """
        # those of a poorer space may be wrong
        self.low, self.high, self.before = -inf, inf, None
        least = inf
        for _ in range(_STEPS):
            self._look(solve)
            off = abs(self.misfit)
            enough = max(near, self.known if rough else self.least)
            if off <= enough or (off >= least and least < 1e3 * near):
                return
            self._step()
            if rough and _SECANT * off * least <= near:
                return
            least = min(least, off)
        self._refuse()

    def _look(self, solve: Callable[[float], Contact]) -> None:
        radius = self.at.radius(self.v)
        if not self.profile.flat_part < radius < self.profile.reach:
            self._refuse()
        self.last = solve(radius)
        one = value_of(self.last)
        if self.approach is None:
            assert self.load is not None
            value, asked, rate = one.load, self.load, one.growth * one.stiffness
        else:
            value, asked, rate = one.approach - self.origin, self.approach - self.origin, one.growth
        misfit = log(value / asked)
        self.known = self._known(one)
        self.slope = rate * self.at.slope(radius) / value
        # between places that are close a secant knows better: next to the rim of a sphere the
        # pressure bends closer to the edge than where its slope is taken
        if self.before is not None and 0.0 < abs(self.v - self.before) < _CLOSE:
            secant = (misfit - self.misfit) / (self.v - self.before)
            self.slope = secant if secant > 0.0 else self.slope
        self.misfit, self.before = misfit, self.v

    @property
    def least(self) -> float:
        """The misfit that a rounding of the radius makes: next to a corner much more than that."""
        radius = self.at.radius(self.v)
        return float(np.finfo(float).eps) * radius * self.slope / self.at.slope(radius)

    def _known(self, one: Indentation) -> float:
        """Return the relative error of what is asked for."""
        if self.approach is None:
            return one.load_error
        return one.approach_error * one.approach_size / (self.approach - self.origin)

    def _step(self) -> None:
        if self.misfit > 0.0:
            self.high = min(self.high, self.v)
        else:
            self.low = max(self.low, self.v)
        step = -self.misfit / self.slope if self.slope > 0.0 else -self.misfit
        v = self.v + max(min(step, _LONGEST), -_LONGEST)
        inside = self.low < v < self.high
        self.v = v if inside or not isfinite(self.low + self.high) else (self.low + self.high) / 2.0

    def _refuse(self) -> None:
        name, value = ("load", self.load) if self.approach is None else ("approach", self.approach)
        radius = self.at.radius(self.v)
        told = (
            f"that of a contact radius in ({self.profile.flat_part:.6g}, "
            f"{self.profile.reach:.6g}), the range of the profile; {radius:.6g} is not enough"
        )
        raise SceneError(name, value, told)

    def found(self) -> tuple[Contact, float]:
        """Return the contact, what was asked exactly, and the relative error of its radius."""
        assert self.last is not None
        one = value_of(self.last)
        of_value = self._known(one)
        # errors of load and approach at this radius are those of a radius that is a little off
        off = of_value + 2.0 * abs(self.misfit)  # the slope is not known to all digits
        error = off / self.slope * self.at.slope(one.radius) / one.radius
        # by how much the approach moves with the radius, and with it P = dW/ddelta
        moved = one.growth * one.radius * error
        of_load = one.stiffness * moved / one.load
        self.rate = _pressure_rate(one, self.profile)
        best = replace(
            one,
            work_error=one.work_error + one.load * moved / one.work,
            # grows like the radius on a smooth surface, like its square in a linear layer, and as
            # fast as the load under an exponential law
            stiffness_error=one.stiffness_error + max(2.0 * error, of_load),
            pressure_error=one.pressure_error + max(of_load, self.rate * error),
        )
        if self.approach is None:
            assert self.load is not None
            of_approach = one.approach_error + moved / one.approach_size
            best = replace(best, load=self.load, load_error=0.0, approach_error=of_approach)
        else:
            of_load += one.load_error
            best = replace(best, approach=self.approach, approach_error=0.0, load_error=of_load)
        if isinstance(self.last, Refinement):
            return replace(self.last, best=replace(self.last.best, value=best)), error
        return best, error


def _pressure_rate(one: Indentation, profile: Profile) -> float:
    """Return the largest ``dp/dln a`` at a given ``s``, of the pressure or its mean.

    It is ``flat ddelta/da + s dp/ds``, taken between places graded to the edge and to breaks.
    """
    if one.pressure is None or one.flat is None:
        return 0.0
    a, mean = one.radius, one.load / (pi * one.radius**2)
    inside = [b / a for b in profile.breaks if b < a]
    around = [1.0 - b + sign * _PLACES for b in inside for sign in (-1.0, 1.0)]
    from_edge = np.concatenate([[1.0], _PLACES, *around])
    from_edge = np.unique(from_edge[(from_edge >= 0.0) & (from_edge <= 1.0)])
    s = 1.0 - from_edge
    p, flat = one.pressure(s, from_edge), one.flat(s, from_edge)
    slope = -np.diff(p) / np.diff(from_edge)
    moved = (one.growth * (flat[1:] + flat[:-1]) + (s[1:] + s[:-1]) * slope) / 2.0
    return float((np.abs(moved) / np.maximum(np.minimum(p[1:], p[:-1]), mean)).max())


def value_of(solved: Contact) -> Indentation:
    """Return the contact."""
    return solved.best.value if isinstance(solved, Refinement) else solved
