"""Frictionless contact under a profile: on a smooth surface, or on a layer over a rigid half-space.

Lengths are in any unit L, tractions in E' = E/(4(1 − ν²)), a quarter of E*, loads in E'L². A
contact is given by its radius.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy import special

from ._inputs import Array, Values, check_positive, real_numbers, refusal
from .coupled_punch import _bessel_ratio


@dataclass(frozen=True)
class SmoothContact:
    """A contact of a known radius.

    Attributes
    ----------
    approach : float
        δ, in L.
    load : float
        P, in E'L².
    """

    approach: float
    load: float


def _moderate(name: str, value: float) -> float:
    """Return a positive number whose powers are doubles."""
    number = check_positive(name, value)
    if not 1e-30 <= number <= 1e30:
        raise refusal(name, value, "in [1e-30, 1e30]")
    return number


def _angle(value: float) -> float:
    """Return an angle between axis and side."""
    number = check_positive("half_angle", value)
    if not 1e-30 <= number < math.pi / 2.0:
        raise refusal("half_angle", value, "in [1e-30, pi/2)")
    return number


def _exponent(value: float, contact_radius: float) -> float:
    """Return an exponent whose power of the radius is a double."""
    number = check_positive("exponent", value)
    if number > 100.0 or abs(number * math.log10(contact_radius)) > 150.0:
        raise refusal("exponent", value, "at most 100, and the power of the radius a double")
    return number


def _inside(r: ArrayLike, contact_radius: float) -> Array:
    """Return radii inside the contact."""
    at = real_numbers("r", r, "in [0, contact_radius]")
    if not ((at >= 0.0) & (at <= contact_radius)).all():
        raise refusal("r", r, "in [0, contact_radius]")
    return at


def _shaped(values: ArrayLike) -> Values:
    """Return a float for a scalar, an array for anything else."""
    found = np.asarray(values)
    return found if found.ndim else float(found)


def _checked_flat_part(contact_radius: float, flat_radius: float) -> tuple[float, float]:
    """Return the contact radius a and the angle arccos(b/a), where b is the radius of the flat."""
    contact_radius = _moderate("contact_radius", contact_radius)
    flat_radius = _moderate("flat_radius", flat_radius)
    if contact_radius < flat_radius:
        raise ValueError(f"contact_radius = {contact_radius!r}: must be at least {flat_radius!r}")
    # without the cancellation of acos next to 1
    apart = contact_radius - flat_radius
    together = contact_radius + flat_radius
    return contact_radius, 2.0 * math.atan2(math.sqrt(apart), math.sqrt(together))


def parabola_contact(contact_radius: float, radius: float) -> SmoothContact:
    """Return Hertz's contact of the paraboloid r²/(2R): δ = a²/R, P = 16a³/(3R).

    Parameters
    ----------
    contact_radius : float
        a, > 0.
    radius : float
        R of curvature, > 0.

    Raises
    ------
    ValueError
        If a parameter is out of range.

    References
    ----------
    Johnson, Contact Mechanics (1985), equations (4.22) to (4.24).
    """
    contact_radius = _moderate("contact_radius", contact_radius)
    radius = _moderate("radius", radius)
    return SmoothContact(contact_radius**2 / radius, 16.0 * contact_radius**3 / (3.0 * radius))


def parabola_pressure(contact_radius: float, radius: float, r: ArrayLike) -> Values:
    """Return Hertz's pressure 8√(a² − r²)/(πR).

    Parameters
    ----------
    contact_radius, radius : float
        As of `parabola_contact`.
    r : array_like
        Radii in [0, a].

    Returns
    -------
    float or ndarray
        In the shape of `r`.

    Raises
    ------
    ValueError
        If a parameter is out of range.
    """
    contact_radius = _moderate("contact_radius", contact_radius)
    radius = _moderate("radius", radius)
    at = _inside(r, contact_radius)
    root = np.sqrt((contact_radius - at) * (contact_radius + at))
    return _shaped(8.0 / (math.pi * radius) * root)


def sphere_contact(contact_radius: float, radius: float) -> SmoothContact:
    """Return the contact of the exact sphere, a < R.

    Parameters
    ----------
    contact_radius : float
        a, in (0, R).
    radius : float
        R of the sphere, > 0.

    Raises
    ------
    ValueError
        If a parameter is out of range.

    References
    ----------
    Segedin (1957); Popov, Heß and Willert, Handbook of Contact Mechanics (2019), §2.5.
    """
    contact_radius = _moderate("contact_radius", contact_radius)
    radius = _moderate("radius", radius)
    if contact_radius >= radius:
        raise ValueError(f"contact_radius = {contact_radius!r}: must be less than {radius!r}")
    a = contact_radius
    share = contact_radius / radius
    rest = (radius - a) / radius * (1.0 + share)  # 1 - share**2
    # artanh(x) = x R_C(1, 1 - x**2), and artanh(x) - x = x**3 R_D(1 - x**2, 1 - x**2, 1)/3
    growth = share * special.elliprc(1.0, rest)
    excess = share**2 * growth + share**3 / 3.0 * special.elliprd(rest, rest, 1.0)
    return SmoothContact(float(a * growth), float(4.0 * radius**2 * excess))


def cone_contact(contact_radius: float, half_angle: float) -> SmoothContact:
    """Return Sneddon's contact of the cone r cot θ: δ = (π/2) a cot θ, P = 2π a² cot θ.

    Parameters
    ----------
    contact_radius : float
        a, > 0.
    half_angle : float
        θ between axis and side, in radians.

    Raises
    ------
    ValueError
        If a parameter is out of range.

    References
    ----------
    Sneddon (1965).
    """
    contact_radius = _moderate("contact_radius", contact_radius)
    half_angle = _angle(half_angle)
    slope = 1.0 / math.tan(half_angle)
    a = contact_radius
    return SmoothContact(math.pi / 2.0 * slope * a, 2.0 * math.pi * slope * a**2)


def cone_pressure(contact_radius: float, half_angle: float, r: ArrayLike) -> Values:
    """Return the pressure 2 cot θ arcosh(a/r) under a cone, infinite at the tip.

    Parameters
    ----------
    contact_radius, half_angle : float
        As of `cone_contact`.
    r : array_like
        Radii in [0, a].

    Returns
    -------
    float or ndarray
        In the shape of `r`.

    Raises
    ------
    ValueError
        If a parameter is out of range.
    """
    contact_radius = _moderate("contact_radius", contact_radius)
    half_angle = _angle(half_angle)
    at = _inside(r, contact_radius)
    with np.errstate(divide="ignore"):
        # next to the tip the quotient of the radii may overflow, that of their roots does not
        root = np.sqrt(0.5 * (contact_radius - at)) / np.sqrt(at)
    # arcosh(a/r), without its cancellation next to the edge
    return _shaped(4.0 / math.tan(half_angle) * np.arcsinh(root))


def power_law_contact(contact_radius: float, coefficient: float, exponent: float) -> SmoothContact:
    """Return the contact of the profile C rⁿ.

    Parameters
    ----------
    contact_radius : float
        a, > 0.
    coefficient, exponent : float
        C and n, > 0.

    Raises
    ------
    ValueError
        If a parameter is out of range.

    References
    ----------
    Galin (1946); Sneddon (1965).
    """
    contact_radius = _moderate("contact_radius", contact_radius)
    coefficient = _moderate("coefficient", coefficient)
    exponent = _exponent(exponent, contact_radius)
    n = exponent
    ratio = math.gamma(n / 2.0 + 1.0) / math.gamma((n + 1.0) / 2.0)
    approach = coefficient * contact_radius**n * math.sqrt(math.pi) * ratio
    return SmoothContact(approach, 8.0 * contact_radius * approach * n / (n + 1.0))


def truncated_cone_contact(
    contact_radius: float, flat_radius: float, half_angle: float
) -> SmoothContact:
    """Return the contact of a cone that is cut off flat at the radius b.

    Parameters
    ----------
    contact_radius : float
        a, at least b.
    flat_radius : float
        b, > 0.
    half_angle : float
        θ between axis and side, in radians.

    Raises
    ------
    ValueError
        If a parameter is out of range.

    References
    ----------
    Ejike (1969); Popov, Heß and Willert, Handbook of Contact Mechanics (2019), §2.5.
    """
    contact_radius, angle = _checked_flat_part(contact_radius, flat_radius)
    half_angle = _angle(half_angle)
    slope = 1.0 / math.tan(half_angle)
    load = 4.0 * slope * contact_radius**2 * (angle + math.sin(angle) * math.cos(angle))
    return SmoothContact(slope * contact_radius * angle, load)


def rounded_flat_contact(contact_radius: float, flat_radius: float, radius: float) -> SmoothContact:
    """Return the contact of a flat of radius b with an edge rounded to the radius R.

    Parameters
    ----------
    contact_radius : float
        a, at least b.
    flat_radius : float
        b, > 0.
    radius : float
        R of curvature, > 0.

    Raises
    ------
    ValueError
        If a parameter is out of range.

    References
    ----------
    Ciavarella, Hills and Monno (1998), for the punch; Jäger (1995).
    """
    contact_radius, angle = _checked_flat_part(contact_radius, flat_radius)
    radius = _moderate("radius", radius)
    bent = angle**3 * float(_bessel_ratio(np.array(angle)))  # sin - angle cos
    return SmoothContact(
        contact_radius**2 / radius * bent,
        4.0 * contact_radius**3 / (3.0 * radius) * (3.0 * bent + math.sin(angle) ** 3),
    )


def winkler_contact(
    contact_radius: float, coefficient: float, exponent: float, normal_compliance: float
) -> SmoothContact:
    """Return the contact of the profile C rⁿ on a layer so soft that the half-space is rigid.

    Its pressure is (δ − h)/α: the limit of a contact radius that is small against α.

    Parameters
    ----------
    contact_radius : float
        a, > 0.
    coefficient, exponent : float
        C and n, > 0.
    normal_compliance : float
        α, in L/E', > 0.

    Raises
    ------
    ValueError
        If a parameter is out of range.
    """
    contact_radius = _moderate("contact_radius", contact_radius)
    coefficient = _moderate("coefficient", coefficient)
    exponent = _exponent(exponent, contact_radius)
    normal_compliance = _moderate("normal_compliance", normal_compliance)
    n = exponent
    approach = coefficient * contact_radius**exponent
    area = math.pi * contact_radius**2
    return SmoothContact(approach, area * approach * n / ((n + 2.0) * normal_compliance))
