r"""The contact radius a under a given load P or approach delta.

Both grow with the radius, and each solution comes with ``ddelta/da`` (the *growth*) and ``dP/da =
(dP/ddelta) (ddelta/da)``. So Newton's method takes few steps. Its unknown is ``v = ln(a - b)``,
with b the radius of the flat part of the profile, or 0; under a profile that ends at a radius r,
its *reach*, it is ``ln((a - b)/(r - a))``. The residual is the logarithm of the load, or approach,
over the given one. First steps are taken in small spaces.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import copysign, exp, inf, isfinite, isinf, log, pi

import numpy as np

from spectral_contact.contact.indented import (
    POSITIVE,
    REPRESENTABLE,
    UnrepresentableError,
    solve_indentation,
)
from spectral_contact.contact.on_parts import Indentation
from spectral_contact.contact.refine import Refinement
from spectral_contact.contact.tuning import ROUNDING
from spectral_contact.errors import SceneError
from spectral_contact.profiles.profile_base import Profile
from spectral_contact.records import Ending

Contact = Indentation | Refinement[Indentation]
#: A function of a radius, of a tolerance and of whether the pressure is wanted.
Solver = Callable[[float, float, bool], Contact]

#: Largest number of steps; largest step of v.
_MAX_STEPS, _MAX_STEP = 60, 3.0
#: Approaches with which a search may begin: their squares are doubles.
_APPROACH_RANGE = 1e-100, 1e100
#: Two values of v closer than this give the slope of the residual by a secant.
_SECANT_DISTANCE = 0.5
#: After a step by a secant the residual is less than this times the product of the last residual
#: and the least one before it; the factor was measured to be 0.001 ... 0.06.
_SECANT_ERROR = 0.1
#: Share of the tolerance that the error of the radius may add to errors.
_RADIUS_FRACTION = 0.02
#: Distances from edge and breaks, in contact radii, between which the slope of the pressure is
#: taken.
_DISTANCES = np.geomspace(ROUNDING, 1.0, 61)


@dataclass(frozen=True, slots=True)
class RadiusScale:
    """The map between the contact radius and the unknown v of Newton's method."""

    profile: Profile

    def radius(self, v: float) -> float:
        """Return the radius of a v."""
        flat_part, reach = self.profile.flat_part, self.profile.reach
        if isinf(reach):
            return flat_part + exp(v)
        return (
            flat_part + (reach - flat_part) / (1.0 + exp(-v))
            if v < 0.0
            else reach - (reach - flat_part) / (1.0 + exp(v))
        )

    def place(self, radius: float) -> float:
        """Return the v of a radius."""
        flat_part, reach = self.profile.flat_part, self.profile.reach
        return log(radius - flat_part) - (0.0 if isinf(reach) else log(reach - radius))

    def derivative(self, radius: float) -> float:
        """Return the derivative of the radius by v."""
        flat_part, reach = self.profile.flat_part, self.profile.reach
        to_reach = 1.0 if isinf(reach) else (reach - radius) / (reach - flat_part)
        return (radius - flat_part) * to_reach


def indenter(profile: Profile, compliance: float, max_unknowns: int) -> Solver:
    """Return the solver for normal contact with a linear layer."""

    def solve(radius: float, tolerance: float, pointwise: bool) -> Contact:
        arguments = profile, radius, compliance, tolerance, max_unknowns
        return solve_indentation(*arguments, pointwise=pointwise)

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
        The solver at a radius.
    tolerance : float
    pointwise : bool
        Whether the pressure is wanted.
    load, approach : float or None
        The given one of them; the other is None.
    near : float or None
        A guess of the radius.
    origin : float
        Approach at which the contact begins: the overclosure from which on a nonlinear layer has
        pressure, and 0 with a linear one.
    first : callable, optional
        Returns the contact at a radius without error estimates, for the first steps.

    Raises
    ------
    SceneError
        If the load or the approach is larger than that of any contact within the profile, or load
        and work are too small or too large for floating-point numbers.
    """
    search = _RadiusSearch(profile, load, approach, near, origin)

    def at_tolerance(tolerance: float, pointwise: bool) -> Callable[[float], Contact]:
        return lambda radius: solve(radius, tolerance, pointwise)

    residual_tolerance = max(_RADIUS_FRACTION * tolerance, ROUNDING)
    # load and approach need a smaller space than the pressure: the first steps are for them alone
    if pointwise or first is not None:
        search.run(first or at_tolerance(tolerance, False), residual_tolerance, rough=True)
    search.run(at_tolerance(tolerance, pointwise), residual_tolerance)
    contact, error = search.outcome()
    rate = search.pressure_rate
    if pointwise and profile.breaks and value_of(contact).flat is None:
        rate = inf  # at a corner of a smooth surface, where the pressure is infinite
    if rate * error > _RADIUS_FRACTION * tolerance:
        # where the pressure depends strongly on the radius, the radius has to be more exact
        search.run(at_tolerance(tolerance, pointwise), max(residual_tolerance / rate, ROUNDING))
        contact, error = search.outcome()
    if (
        isinstance(contact, Refinement)
        and contact.ending is Ending.CONVERGED
        and contact.best.value.largest_error(pointwise=pointwise) > tolerance
    ):
        # errors at a fixed radius meet the tolerance, but not with those that the radius adds
        search.run(at_tolerance(tolerance / 4, pointwise), residual_tolerance)
        contact, error = search.outcome()
    return contact, error


def _first_radius(profile: Profile) -> float:
    """Return 1, or a radius near it at which the square of the approach is a double.

    It is for a profile without a length of its own, which does not say where to begin. High powers
    in small units of length, such as 1e171 times the 20th of the radius, leave the range of doubles
    at a radius of 1.
    """
    radius = 1.0
    for _ in range(_MAX_STEPS):
        with np.errstate(over="ignore"):
            approach = float(profile._transform(np.array(radius)))
        if _APPROACH_RANGE[0] <= approach <= _APPROACH_RANGE[1]:
            break
        radius *= exp(copysign(_MAX_STEP, _APPROACH_RANGE[1] - approach))
    return radius


class _RadiusSearch:
    """Newton's method for the radius, bracketed; parameters are those of `find_radius`."""

    def __init__(
        self,
        profile: Profile,
        load: float | None,
        approach: float | None,
        near: float | None,
        origin: float,
    ) -> None:
        self.profile = profile
        self.load = load
        self.approach = approach
        self.origin = origin
        self.scale = RadiusScale(profile)
        if near is None or not profile.flat_part < near < profile.reach:
            length = min(profile.flat_part or inf, profile.reach - profile.flat_part)
            near = profile.flat_part + 0.5 * (_first_radius(profile) if isinf(length) else length)
        self.v = self.scale.place(near)
        self.low = -inf
        self.high = inf
        self.last: Contact | None = None
        #: logarithm of load or approach over the given one, its error, and its derivative by v
        self.residual = inf
        self.residual_error = 0.0
        self.slope = 1.0
        #: relative change of the pressure over that of the radius
        self.pressure_rate = 0.0
        self.last_v: float | None = None

    def run(
        self, solve: Callable[[float], Contact], tolerance: float, *, rough: bool = False
    ) -> None:
        """Step until the modulus of the residual is below a tolerance or its own rounding.

        If rough, the search also ends where the residual is below its error, or where one more step
        by a secant is expected to bring it below the tolerance; that step is taken, without a solve
        after it. In any case the search ends where a small residual does not fall any more; what is
        left of it counts in the error of the radius (`outcome`). After `_MAX_STEPS` the residual is
        infinite, and so are all errors that follow from it.
        """
        # the bracket of a smaller space may be wrong
        self.low = -inf
        self.high = inf
        self.last_v = None
        least = inf
        for _ in range(_MAX_STEPS):
            self._evaluate(solve)
            modulus = abs(self.residual)
            enough = max(tolerance, self.residual_error if rough else self.rounding)
            if modulus <= enough or (modulus >= least and least < 1e3 * tolerance):
                return
            self._step()
            if rough and _SECANT_ERROR * modulus * least <= tolerance:
                return
            least = min(least, modulus)
        self.residual = inf

    def _evaluate(self, solve: Callable[[float], Contact]) -> None:
        """Solve at the radius at hand; set residual, slope and error."""
        radius = self.scale.radius(self.v)
        if not self.profile.flat_part < radius < self.profile.reach:
            self._refuse()
        try:
            self.last = solve(radius)
        except UnrepresentableError as refused:
            raise SceneError(*self._given_value, refused.allowed) from None
        contact = value_of(self.last)
        if self.approach is None:
            assert self.load is not None
            value = contact.load
            given = self.load
            derivative = contact.growth * contact.stiffness
        else:
            value = contact.approach - self.origin
            given = self.approach - self.origin
            derivative = contact.growth
        if value < 0.0:
            raise SceneError(*self._given_value, POSITIVE)
        if value == 0.0:
            raise SceneError(*self._given_value, REPRESENTABLE)
        residual = log(value / given)
        self.residual_error = self._value_error(contact)
        self.slope = derivative * self.scale.derivative(radius) / value
        # Over a short step the secant is more exact: the growth follows from the pressure at a
        # small distance from the edge, and next to the rim of a sphere the pressure bends closer to
        # the edge than that.
        if self.last_v is not None and 0.0 < abs(self.v - self.last_v) < _SECANT_DISTANCE:
            secant = (residual - self.residual) / (self.v - self.last_v)
            self.slope = secant if secant > 0.0 else self.slope
        self.residual = residual
        self.last_v = self.v

    @property
    def rounding(self) -> float:
        """The change of the residual by a rounding of the radius: large next to a corner."""
        radius = self.scale.radius(self.v)
        return float(np.finfo(float).eps) * radius * self.slope / self.scale.derivative(radius)

    def _value_error(self, contact: Indentation) -> float:
        """Return the relative error of the load or approach at the radius."""
        if self.approach is None:
            return contact.load_error
        return contact.approach_error * contact.approach_size / (self.approach - self.origin)

    def _step(self) -> None:
        """Move v by a step of Newton's method, or to the middle of the bracket."""
        if self.residual > 0.0:
            self.high = min(self.high, self.v)
        else:
            self.low = max(self.low, self.v)
        step = -self.residual / (self.slope if self.slope > 0.0 else 1.0)
        v = self.v + max(min(step, _MAX_STEP), -_MAX_STEP)
        middle = (self.low + self.high) / 2.0
        self.v = v if self.low < v < self.high or not isfinite(middle) else middle

    @property
    def _given_value(self) -> tuple[str, float | None]:
        """Name and value of the load or approach that is given."""
        return ("load", self.load) if self.approach is None else ("approach", self.approach)

    def _refuse(self) -> None:
        """Raise that the profile has no such radius."""
        radius = self.scale.radius(self.v)
        if radius <= self.profile.flat_part:
            allowed = (
                "larger: the contact radius is rounded to that of the flat part of the profile"
            )
            raise SceneError(*self._given_value, f"{allowed}, {radius:.6g}")
        allowed = (
            f"that of a contact radius in ({self.profile.flat_part:.6g}, "
            f"{self.profile.reach:.6g}), the range of the profile; {radius:.6g} is not enough"
        )
        raise SceneError(*self._given_value, allowed)

    def outcome(self) -> tuple[Contact, float]:
        """Return the contact, with the given load or approach exact, and the error of its radius.

        The error is relative, and counts in the errors of the other results.
        """
        assert self.last is not None
        contact = value_of(self.last)
        # The error of load or approach at a radius, and twice the residual (the slope has an error,
        # too), are an error of the radius at the given load or approach.
        value_error = self._value_error(contact) + 2.0 * abs(self.residual)
        per_residual = self.scale.derivative(contact.radius) / contact.radius / self.slope
        error = value_error * per_residual if self.slope > 0.0 else inf
        # The error of the radius times the growth is a change of the approach. The load changes by
        # the stiffness times this change, and the work by the load times it.
        approach_change = contact.growth * contact.radius * error
        load_error = contact.stiffness * approach_change / contact.load
        self.pressure_rate = _pressure_rate(contact, self.profile)
        best = replace(
            contact,
            work_error=contact.work_error + contact.load * approach_change / contact.work,
            # the stiffness grows like the radius on a smooth surface, like its square in a linear
            # layer, and as fast as the load under an exponential law
            stiffness_error=contact.stiffness_error + max(2.0 * error, load_error),
            pressure_error=contact.pressure_error + max(load_error, self.pressure_rate * error),
        )
        if self.approach is None:
            assert self.load is not None
            best = replace(
                best,
                load=self.load,
                load_error=0.0,
                approach_error=contact.approach_error + approach_change / contact.approach_size,
            )
        else:
            best = replace(
                best,
                approach=self.approach,
                approach_error=0.0,
                load_error=load_error + contact.load_error,
            )
        if isinstance(self.last, Refinement):
            return replace(self.last, best=replace(self.last.best, value=best)), error
        return best, error


def _pressure_rate(contact: Indentation, profile: Profile) -> float:
    """Return the largest ``dp/dln a`` at constant ``s = r/a``, relative to the pressure.

    Where the pressure is below its mean, the rate is relative to the mean. The derivative is
    ``flat ddelta/da + s dp/ds``, where ``flat`` is the pressure under a flat punch for the approach
    a. The slope ``dp/ds`` is from differences between places graded to the edge and to breaks. On a
    smooth surface it follows from the profile alone, and is returned as 0 where there are breaks,
    as it has no bound next to a corner.
    """
    if contact.pressure is None:
        return 0.0
    a = contact.radius
    if contact.flat is None:
        return profile._smooth_pressure_rate(a)
    mean = contact.load / pi / a**2
    near_breaks = [
        1.0 - b / a + sign * _DISTANCES for b in profile.breaks if b < a for sign in (-1.0, 1.0)
    ]
    from_edge = np.concatenate([_DISTANCES, *near_breaks])
    from_edge = np.unique(from_edge[(from_edge >= 0.0) & (from_edge <= 1.0)])
    s = 1.0 - from_edge
    p = contact.pressure(s, from_edge)
    flat_pressure = contact.flat(s, from_edge)
    dp_ds = -np.diff(p) / np.diff(from_edge)
    rate = (
        contact.growth * (flat_pressure[1:] + flat_pressure[:-1]) + (s[1:] + s[:-1]) * dp_ds
    ) / 2.0
    return float((np.abs(rate) / np.maximum(np.minimum(p[1:], p[:-1]), mean)).max())


def value_of(solved: Contact) -> Indentation:
    """Return the contact itself, which a `Refinement` has as its best solution."""
    return solved.best.value if isinstance(solved, Refinement) else solved
