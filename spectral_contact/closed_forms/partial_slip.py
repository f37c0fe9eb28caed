"""Smooth surfaces (α = β = 0) that slip in an annulus c < s < 1, without coupling.

Units and coordinates are those of `smooth`. The traction is in closed form: the Abel transform of
q is κ artanh(t)/(πt) for t < c and (f/2π)K'(t) for t > c, and its inverse transform is a complete
elliptic integral of the third kind plus an elementary function. Written out they cancel at the
centre and at c; the stick condition turns the sum into two positive Carlson integrals.
"""

import math

import numpy as np
from numpy.typing import ArrayLike
from scipy import special

from ._inputs import Array, Position, Values, check_friction, kappa, position
from ._quadrature import panel_rule
from ._stick_radius import StickRadius, stick_radius
from .smooth import full_stick_shear, full_stick_traction, smooth_pressure

# Below this fraction of s, a radius is so small that what it adds is known to rounding.
_TINY = 1e-9
# Up to this m = 1 − c² `_elementary_part` is a difference of two R_C, which cancels for m near 1;
# beyond it is R_J(1, m, m, p), of which scipy's is unreliable for very small m.
_NEAR_EDGE = 0.1


def partial_slip_shear(poisson_ratio: float, friction: float) -> float:
    """Return the total shear Q = 2π∫q s ds = f E'(c) + κ ln(1 − c²) under a smooth punch.

    Parameters
    ----------
    poisson_ratio : float
        ν of the half-space, in (−1, 0.5].
    friction : float
        Coulomb's coefficient f ≥ 0; ``math.inf`` is full stick.

    Returns
    -------
    float
        Q, dimensionless (in units of the load), between 0 and min(f, 2κ ln 2).

    Raises
    ------
    ValueError
        If ν or f is out of range.

    References
    ----------
    Equation (5.8)₂ of the paper for α = β = 0.
    """
    f = check_friction(friction)
    stick = stick_radius(poisson_ratio, f)
    if stick.from_edge == 0.0:
        return full_stick_shear(poisson_ratio)
    # The stick condition removes ln(1 − c), against which f E' would cancel when f is large.
    return f * stick.shear_excess + 2.0 * kappa(poisson_ratio) * math.log1p(stick.radius)


def partial_slip_traction(
    poisson_ratio: float,
    friction: float,
    s: ArrayLike | None = None,
    *,
    from_edge: ArrayLike | None = None,
) -> Values:
    """Return the traction q under a smooth punch that slips outside the stick radius c.

    Parameters
    ----------
    poisson_ratio : float
        ν of the half-space, in (−1, 0.5].
    friction : float
        Coulomb's coefficient f ≥ 0; ``math.inf`` is full stick.
    s : array_like, optional
        Distance from the centre, dimensionless, in [0, 1]; any shape.
    from_edge : array_like, optional
        Distance 1 − s from the edge, in [0, 1]; give either this or `s`.

    Returns
    -------
    float or ndarray
        q, dimensionless, in the shape of the argument (a float for a scalar): f p for s ≥ c, with
        inf at the edge unless q vanishes everywhere (f = 0 or ν = 0.5).

    Raises
    ------
    ValueError
        If ν or f is out of range, not exactly one of the coordinates is given, or a value of it
        lies outside [0, 1].

    Notes
    -----
    It solves equation (5.8) of the paper for α = β = 0. In the stick disk, with y = 1 − s²,
    m = 1 − c², b² = (c² − s²)/y and Carlson's R_J,

        q = (b m s / (3π² y^{3/2})) [f R_J(0, c², 1, b²) + 2κ R_J(1, m, m, m/y)] > 0.

    Near s = c the traction has a vertical tangent from within: q − f p ~ −√(c − s), so that there
    the rounding of s and c alone costs half the digits of that difference.
    """
    shear = kappa(poisson_ratio)
    f = check_friction(friction)
    stick = stick_radius(poisson_ratio, f)
    at = position(s, from_edge)
    if shear == 0.0 or f == 0.0:
        return at.output(np.zeros_like(at.s))
    if stick.from_edge == 0.0:
        return full_stick_traction(poisson_ratio, s, from_edge=from_edge)
    inward = _inside_stick(at, stick)  # c − s
    inside = (inward > 0.0) | (at.s == 0.0)
    q = np.array(f * np.asarray(smooth_pressure(s, from_edge=from_edge)))
    radius = at.s[inside]
    y = at.y[inside]
    if stick.is_tiny:
        # The limit c → 0 for fixed s/c: corrections are of the order c² ln c.
        scale = stick.radius if stick.radius > 0.0 else 1.0
        q[inside] = f / math.pi**2 * np.arcsin(radius / scale)
    else:
        b2 = inward[inside] * (stick.radius + radius) / y
        q[inside] = _stick_traction(stick, f, shear, radius, y, b2)
    return at.output(q)


def _inside_stick(at: Position, stick: StickRadius) -> Array:
    """Return c − s, from the nearer end of the unit interval."""
    return np.asarray(np.where(at.s < 0.5, stick.radius - at.s, at.d - stick.from_edge))


def _stick_traction(
    stick: StickRadius, f: float, shear: float, s: Array, y: Array, b2: Array
) -> Array:
    """Return the traction at radii s < c, where b2 = (c² − s²)/y."""
    m = stick.edge_coordinate
    p = m / y
    b = np.sqrt(b2)
    third_kind = p * special.elliprj(0.0, stick.radius**2, 1.0, b2)
    elementary = _elementary_part(stick, p, b)
    return np.asarray(
        b * s / (3.0 * math.pi**2 * np.sqrt(y)) * (f * third_kind + 2.0 * shear * elementary)
    )


def _elementary_part(stick: StickRadius, p: Array, b: Array) -> Array:
    """Return p R_J(1, m, m, p), with p = 1 − b²: the divided difference of artanh(x)/x in x²."""
    m = stick.edge_coordinate
    c = stick.radius
    e = stick.from_edge
    if m > _NEAR_EDGE:
        return np.asarray(p * special.elliprj(1.0, m, m, p))
    # artanh c − artanh b is the artanh of (c − b)/(1 − cb). For a thin annulus this argument is
    # near 1, so 1 less its square is taken, the complement.
    product_gap = e + c * p / (1.0 + b)  # 1 − c b
    complement = (m / product_gap) * (p / product_gap)
    difference = special.elliprc(1.0, complement) - product_gap * special.elliprc(1.0, p)
    return np.asarray(3.0 * p / (c * (c + b) * product_gap) * difference)


def slip_displacement(
    poisson_ratio: float,
    friction: float,
    s: ArrayLike | None = None,
    *,
    from_edge: ArrayLike | None = None,
) -> Values:
    """Return the radial displacement u = T q − κ g of the half-space under the rigid punch.

    Parameters
    ----------
    poisson_ratio : float
        ν of the half-space, in (−1, 0.5].
    friction : float
        Coulomb's coefficient f ≥ 0; ``math.inf`` is full stick.
    s : array_like, optional
        Distance from the centre, dimensionless, in [0, 1]; any shape.
    from_edge : array_like, optional
        Distance 1 − s from the edge, in [0, 1]; give either this or `s`.

    Returns
    -------
    float or ndarray
        u, dimensionless, in the shape of the argument (a float for a scalar): 0 for s ≤ c and
        negative, that is towards the axis, in the slip annulus. Good to some 1e-15 away from c; as
        u ~ −(s − c)^{3/2} there, it shares the relative error of s − c.

    Raises
    ------
    ValueError
        If ν or f is out of range, not exactly one of the coordinates is given, or a value of it
        lies outside [0, 1].

    Notes
    -----
    With D(t) = κ artanh(t)/t − (f/2)K'(t), which is zero at c and increases,

        u = −(s/2π²) ∫_c^s D'(τ) [arccos(τ/s) + (τ/s)√(1 − τ²/s²)] dτ,

    a positive integrand, so nothing cancels; the paper prints the opposite sign in (5.2).
    For f = 0: u = −κ g = −(κ/2πs)(1 − √(1 − s²)).
    """
    shear = kappa(poisson_ratio)
    f = check_friction(friction)
    stick = stick_radius(poisson_ratio, f)
    at = position(s, from_edge)
    u = np.zeros_like(at.s)
    if shear == 0.0 or stick.from_edge == 0.0:
        return at.output(u)
    gaps = -_inside_stick(at, stick)
    for index in np.ndindex(u.shape):
        radius = float(at.s[index])
        y = float(at.y[index])
        gap = float(gaps[index])
        if gap > 0.0:
            u[index] = _slip_at(stick, f, shear, radius, y, gap)
    return at.output(u)


def _slip_at(stick: StickRadius, f: float, shear: float, s: float, y: float, gap: float) -> float:
    """Return u at one radius s = c + gap: the integral is split where its scale changes."""
    near_stick = stick.radius * math.sqrt(2.0) > s
    # 1 − τ²/s² at the lower end of the outer part
    extent = gap / s * (1.0 + stick.radius / s) if near_stick else 0.5
    total = _outer_integral(f, shear, s, y, extent)
    if not near_stick:
        total += _inner_integral(stick, f, shear, s)
    return -s / (2.0 * math.pi**2) * total


def _density(f: float, shear: float, tau: Array, m: Array) -> Array:
    """τ D'(τ), where m = 1 − τ²."""
    t2 = tau * tau
    # τ² R_D(0, 1, τ²) is 3 to rounding at τ = 1e-9, and 0 · ∞ far below.
    cut = np.maximum(t2, _TINY**2)
    smooth = 2.0 / 3.0 * shear * t2 * special.elliprd(1.0, m, m)
    return np.asarray(smooth + f / 6.0 * cut * special.elliprd(0.0, 1.0, cut))


def _outer_integral(f: float, shear: float, s: float, y: float, extent: float) -> float:
    """Return the part with 0 < ω² < extent ≤ 1/2, where ω² = 1 − τ²/s²."""
    # D' grows like 1/(1 − τ²) = 1/(y + s²ω²): ω = √y/s sinh θ resolves that. The floor on y changes
    # the result by less than rounding and keeps the interval finite at the edge itself.
    floor = max(y, 1e-36 * extent, 1e-305)
    scale = math.sqrt(floor) / s if s > 0.5 else 1.0
    theta, weights = panel_rule(0.0, math.asinh(math.sqrt(extent) / scale))
    omega = scale * np.sinh(theta)
    cosine = np.sqrt(1.0 - omega * omega)  # τ/s
    bracket = np.arctan2(omega, cosine) + cosine * omega
    density = _density(f, shear, s * cosine, floor + (s * omega) ** 2) / cosine**2
    return float(np.sum(weights * scale * np.cosh(theta) * omega * density * bracket))


def _inner_integral(stick: StickRadius, f: float, shear: float, s: float) -> float:
    """Return the part with c < τ < s/√2, in the variable ln(τ/s)."""
    start = max(stick.radius / s, _TINY)
    x, weights = panel_rule(math.log(start), -0.5 * math.log(2.0))
    ratio = np.exp(x)
    tau = s * ratio
    bracket = np.arccos(ratio) + ratio * np.sqrt(1.0 - ratio * ratio)
    total = float(np.sum(weights * _density(f, shear, tau, 1.0 - tau * tau) * bracket))
    if stick.radius < _TINY * s:
        # Between c and the start τ D' is f/2 and the bracket π/2, so that part is (π/4) f times the
        # logarithm of start s/c; and for such c it is f ln c = f ln 4 − 2κ.
        total += 0.25 * math.pi * (f * (math.log(start * s) - math.log(4.0)) + 2.0 * shear)
    return total
