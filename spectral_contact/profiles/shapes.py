"""Shapes of everyday use, everything about them in closed form."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import atan, gamma, log1p, pi, sqrt, tan
from typing import Final

import numpy as np

from spectral_contact.fields import Array
from spectral_contact.io.parameters import declared
from spectral_contact.profiles.profile_base import Profile

_POSITIVE: Final = "finite and > 0"
_HALF_ANGLE: Final = declared(
    "angle", "in (0, pi/2), in radians, between the axis and the side", "rad"
)
_FLAT_RADIUS: Final = declared("radius of the flat part", _POSITIVE, "m")


def _inward(t: Array, y: Array) -> Array:
    """Return ``1 - t`` without cancellation."""
    return y / (1.0 + t)


@dataclass(frozen=True, slots=True)
class Flat(Profile):
    """The flat punch, whose contact ends where it does; under a layer that is given by its law.

    Parameters
    ----------
    radius : float
        Finite and > 0.

    Raises
    ------
    SceneError
        If it is not.
    """

    radius: float = field(metadata=declared("radius", _POSITIVE, "m"))

    @property
    def reach(self) -> float:
        """Its radius."""
        return self.radius

    def _height(self, r: Array) -> Array:
        return np.zeros(np.shape(r))

    def _transform(self, t: Array) -> Array:
        return np.zeros(np.shape(t))

    def _fall(self, radius: float, t: Array, y: Array, past: Array) -> Array:
        return np.zeros(np.shape(t))

    def _rate(self, t: Array, past: Array) -> Array:
        return np.zeros(np.shape(t))


@dataclass(frozen=True, slots=True)
class Parabola(Profile):
    """The paraboloid ``h = r**2 / (2 radius)``: the tip of a sphere.

    Parameters
    ----------
    radius : float
        Radius of curvature, finite and > 0.

    Raises
    ------
    SceneError
        If it is not.
    """

    radius: float = field(metadata=declared("radius of curvature", _POSITIVE, "m"))

    def _height(self, r: Array) -> Array:
        return np.asarray(r**2 / (2.0 * self.radius))

    def _transform(self, t: Array) -> Array:
        return np.asarray(2.0 * t**2 / self.radius)

    def _rate(self, t: Array, past: Array) -> Array:
        return np.asarray(4.0 * t / self.radius)

    def _fall(self, radius: float, t: Array, y: Array, past: Array) -> Array:
        return np.asarray(2.0 * radius**2 / self.radius * y)


@dataclass(frozen=True, slots=True)
class Sphere(Profile):
    """The exact sphere ``h = radius - sqrt(radius**2 - r**2)``, up to its equator.

    Parameters
    ----------
    radius : float
        Finite and > 0.

    Raises
    ------
    SceneError
        If it is not.
    """

    radius: float = field(metadata=declared("radius", _POSITIVE, "m"))

    @property
    def reach(self) -> float:
        """Radius of the equator."""
        return self.radius

    @property
    def _pole(self) -> float:
        return self.radius

    def _height(self, r: Array) -> Array:
        """Return the height at radii; NaN beyond the equator."""
        inside = r <= self.radius
        root = np.sqrt(np.where(inside, (self.radius - r) * (self.radius + r), np.nan))
        return np.asarray(r**2 / (self.radius + root))

    def _transform(self, t: Array) -> Array:
        return np.asarray(t * self._slope_of(t))

    def _slope_of(self, t: Array) -> Array:
        """Return ``H/t = 2 artanh(t/radius)``, accurate also next to the equator.

        There artanh of a rounded quotient would lose digits.
        """
        return np.asarray(np.log1p(2.0 * t / (self.radius - t)))

    def _rate(self, t: Array, past: Array) -> Array:
        whole = self.radius
        return np.asarray(self._slope_of(t) + 2.0 * t * whole / ((whole - t) * (whole + t)))

    def _fall(self, radius: float, t: Array, y: Array, past: Array) -> Array:
        a = radius
        whole = self.radius
        inward = radius * _inward(t, y)
        slope = log1p(2.0 * a / (whole - a))  # of radii far below the whole without cancellation
        steeper = np.log1p(2.0 * whole * inward / ((whole - a) * (whole + a * t)))
        return np.asarray(inward * slope + a * t * steeper)


@dataclass(frozen=True, slots=True)
class PowerLaw(Profile):
    """The profile ``h = coefficient * r**exponent``.

    Parameters
    ----------
    coefficient : float
        Finite and > 0.
    exponent : float
        In [1, 100].

    Raises
    ------
    SceneError
        If a parameter is out of range.
    """

    coefficient: float = field(metadata=declared("coefficient", _POSITIVE, "m^(1-exponent)"))
    # beyond 100 powers of ordinary lengths leave the range of doubles
    exponent: float = field(
        metadata=declared("exponent", "in [1, 100]: below 1 the profile is not convex")
    )

    @property
    def pointed(self) -> bool:
        """Whether the exponent is no even number."""
        return self.exponent % 2.0 != 0.0

    def _height(self, r: Array) -> Array:
        return np.asarray(self.coefficient * r**self.exponent)

    def _transform(self, t: Array) -> Array:
        return np.asarray(self._factor * t**self.exponent)

    def _rate(self, t: Array, past: Array) -> Array:
        return np.asarray(self._factor * self.exponent * t ** (self.exponent - 1.0))

    def _fall(self, radius: float, t: Array, y: Array, past: Array) -> Array:
        # farther in, at t < 1/2, y is near 1 and has lost the digits of t, which is taken itself
        outer = np.minimum(y, 0.75)
        near = -np.expm1(self.exponent / 2.0 * np.log1p(-outer))
        left = np.where(t < 0.5, 1.0 - t**self.exponent, near)
        return np.asarray(self._factor * radius**self.exponent * left)

    @property
    def _factor(self) -> float:
        n = self.exponent
        beta = gamma(n / 2.0) * sqrt(pi) / gamma((n + 1.0) / 2.0)  # B(n/2, 1/2)
        return self.coefficient * n * beta


@dataclass(frozen=True, slots=True)
class Cone(Profile):
    """The cone ``h = r / tan(half_angle)``.

    Parameters
    ----------
    half_angle : float
        Between the axis and the side, in radians, in (0, pi/2).

    Raises
    ------
    SceneError
        If it is not.
    """

    half_angle: float = field(metadata=_HALF_ANGLE)

    @property
    def pointed(self) -> bool:
        """True."""
        return True

    def _height(self, r: Array) -> Array:
        return np.asarray(r / tan(self.half_angle))

    def _transform(self, t: Array) -> Array:
        return np.asarray(pi / tan(self.half_angle) * t)

    def _rate(self, t: Array, past: Array) -> Array:
        return np.full(np.shape(t), pi / tan(self.half_angle))

    def _fall(self, radius: float, t: Array, y: Array, past: Array) -> Array:
        return np.asarray(pi / tan(self.half_angle) * radius * _inward(t, y))


class _FlatEnded(Profile):
    """A flat part and what rises around it."""

    __slots__ = ()
    flat_radius: float

    @property
    def flat_part(self) -> float:
        """Radius of the flat part."""
        return self.flat_radius

    def _outside(self, t: Array) -> Array:
        """Return ``sqrt(t**2 - flat_radius**2)``, 0 on the flat part."""
        b = self.flat_radius
        return np.sqrt(np.maximum(t - b, 0.0) * (t + b))

    def _roots(self, radius: float, y: Array, past: Array) -> tuple[float, Array]:
        """Return the `_outside` of the radius, and by how much that of ``radius t`` is less."""
        whole = float(self._outside(np.asarray(radius)))
        inner = np.sqrt(past)
        beyond = inner > 0.0
        return whole, np.where(beyond, radius**2 * y / np.where(beyond, whole + inner, 1.0), whole)


@dataclass(frozen=True, slots=True)
class TruncatedCone(_FlatEnded):
    """A cone whose tip is cut off: ``h = (r - flat_radius) / tan(half_angle)`` outside of it.

    Parameters
    ----------
    flat_radius : float
        Of the flat part, finite and > 0.
    half_angle : float
        Between the axis and the side, in radians, in (0, pi/2).

    Raises
    ------
    SceneError
        If a parameter is out of range.
    """

    flat_radius: float = field(metadata=_FLAT_RADIUS)
    half_angle: float = field(metadata=_HALF_ANGLE)

    def _height(self, r: Array) -> Array:
        return np.asarray(np.maximum(r - self.flat_radius, 0.0) / tan(self.half_angle))

    def _transform(self, t: Array) -> Array:
        angle = np.arctan2(self._outside(t), self.flat_radius)
        return np.asarray(2.0 / tan(self.half_angle) * t * angle)

    def _rate(self, t: Array, past: Array) -> Array:
        root = np.sqrt(past)
        b = self.flat_radius
        outside = root > 0.0
        steep = np.arctan2(root, b) + b / np.where(outside, root, 1.0)
        return np.where(outside, 2.0 / tan(self.half_angle) * steep, 0.0)

    def _fall(self, radius: float, t: Array, y: Array, past: Array) -> Array:
        b = self.flat_radius
        whole, less = self._roots(radius, y, past)
        angle = np.arctan(less * b / (b**2 + whole * (whole - less)))
        fallen = radius * (_inward(t, y) * atan(whole / b) + t * angle)
        return np.asarray(2.0 / tan(self.half_angle) * fallen)


@dataclass(frozen=True, slots=True)
class RoundedFlat(_FlatEnded):
    """A flat with a rounded edge: ``h = (r - flat_radius)**2 / (2 radius)`` outside of it.

    Parameters
    ----------
    flat_radius : float
        Of the flat part, finite and > 0.
    radius : float
        Radius of curvature of the edge, finite and > 0.

    Raises
    ------
    SceneError
        If a parameter is out of range.
    """

    flat_radius: float = field(metadata=_FLAT_RADIUS)
    radius: float = field(metadata=declared("radius of curvature of the edge", _POSITIVE, "m"))

    def _height(self, r: Array) -> Array:
        return np.asarray(np.maximum(r - self.flat_radius, 0.0) ** 2 / (2.0 * self.radius))

    def _transform(self, t: Array) -> Array:
        root = self._outside(t)
        return np.asarray(2.0 / self.radius * t * _risen(root, self.flat_radius))

    def _rate(self, t: Array, past: Array) -> Array:
        root = np.sqrt(past)
        b = self.flat_radius
        return np.asarray(2.0 / self.radius * (2.0 * root - b * np.arctan2(root, b)))

    def _fall(self, radius: float, t: Array, y: Array, past: Array) -> Array:
        b = self.flat_radius
        whole, less = self._roots(radius, y, past)
        # But for a factor, H is t times (root - b arctan(root/b)) with the root of `_outside`.
        # `rise` is this bracket at the radius, and `step` by how much it is less at radius t.
        rise = _risen(np.asarray(whole), b)
        inner = whole - less
        product = b**2 + whole * inner
        angle = less * b / product
        # step = less - b arctan(angle) = (less - b angle) + b (angle - arctan(angle)), of which the
        # first bracket is less whole inner / product
        step = less * (whole * inner / product) + b * _past(angle)
        fallen = radius * (_inward(t, y) * rise + t * step)
        return np.asarray(2.0 / self.radius * fallen)


def _risen(root: Array, b: float) -> Array:
    """Return ``root - b arctan(root / b)`` without cancellation."""
    return np.asarray(b * _past(root / b))


def _past(x: Array) -> Array:
    """Return ``x - arctan(x)`` without cancellation."""
    small = np.abs(x) < 1.0
    square = np.where(small, x, 0.0) ** 2
    rest = np.zeros(np.shape(x))
    for n in range(22, 0, -1):  # arctan(x) = x/(1 + rest), Gauss's continued fraction
        rest = n**2 * square / (2 * n + 1 + rest)
    return np.where(small, x * rest / (1.0 + rest), x - np.arctan(x))
