"""The smooth punch stuck everywhere, with the shear acting back on the pressure.

Mossakovskij's and Spence's solution of the coupled equations for α = β = 0,

    N p − κ∫ₛ¹ q dη = δ,    T q − κ g = 0,    2π∫p s ds = 1,

with g(s) = (1/s)∫₀ˢ η p dη. Units and coordinates are those of `smooth`. With
ϑ(t) = θ ln((1 + t)/(1 − t)) and A = sinh(πθ)/(4πθ), the Abel transforms of the fields are
∫ₜ¹ p s ds/√(s² − t²) = A cos ϑ and t∫ₜ¹ q ds/√(s² − t²) = A sin ϑ. Near the edge both fields
oscillate, infinitely often and without a limit.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy import special

from ._inputs import Array, Position, Values, check_poisson_ratio, position
from ._quadrature import panel_rule
from .smooth import smooth_pressure


def oscillation_exponent(poisson_ratio: float) -> float:
    """Return Mossakovskij's and Spence's θ = ln(3 − 4ν)/(2π).

    Parameters
    ----------
    poisson_ratio : float
        ν of the half-space, in (−1, 0.5].

    Returns
    -------
    float
        θ, dimensionless, the exponent of (1 − s)^(−1/2 ± iθ) at the edge; 0 for ν = 0.5.

    Raises
    ------
    ValueError
        If ν is out of range.
    """
    nu = check_poisson_ratio(poisson_ratio)
    return math.log1p(2.0 * (1.0 - 2.0 * nu)) / (2.0 * math.pi)


def coupled_approach(poisson_ratio: float) -> float:
    """Return the approach δ = (1 − 2ν)/(8(1 − ν) ln(3 − 4ν)).

    Parameters
    ----------
    poisson_ratio : float
        ν of the half-space, in (−1, 0.5].

    Returns
    -------
    float
        δ, dimensionless, under the load 1; 1/8 for ν = 0.5.

    Raises
    ------
    ValueError
        If ν is out of range.

    Notes
    -----
    The stiffness P = 4Gaδ ln(3 − 4ν)/(1 − 2ν), with G the shear modulus, in the paper's units.
    """
    nu = check_poisson_ratio(poisson_ratio)
    x = 2.0 * (1.0 - 2.0 * nu)
    ratio = 1.0 if x == 0.0 else x / math.log1p(x)
    return ratio / (16.0 * (1.0 - nu))


def coupled_shear(poisson_ratio: float) -> float:
    """Return the total shear Q = 2π∫q s ds = sinh(πθ) Re β(1 + iθ).

    Here β(x) = ½[ψ((x + 1)/2) − ψ(x/2)], with ψ the digamma function.

    Parameters
    ----------
    poisson_ratio : float
        ν of the half-space, in (−1, 0.5].

    Returns
    -------
    float
        Q, dimensionless (in units of the load): a measure of shear, not a resultant.

    Raises
    ------
    ValueError
        If ν is out of range.
    """
    theta = oscillation_exponent(poisson_ratio)
    beta = 0.5 * (special.digamma(1.0 + 0.5j * theta) - special.digamma(0.5 + 0.5j * theta))
    return math.sinh(math.pi * theta) * float(beta.real)


def coupled_pressure(
    poisson_ratio: float, s: ArrayLike | None = None, *, from_edge: ArrayLike | None = None
) -> Values:
    """Return the pressure p of the coupled problem.

    With t² = s² + (1 − s²)v²,

        p = (2A/(π√(1 − s²))) ∫₀¹ [cos ϑ(t) + (2θ/t) sin ϑ(t)] dv.

    Parameters
    ----------
    poisson_ratio : float
        ν of the half-space, in (−1, 0.5].
    s : array_like, optional
        Distance from the centre, dimensionless, in [0, 1]; any shape.
    from_edge : array_like, optional
        Distance 1 − s from the edge, in [0, 1]; give either this or `s`.

    Returns
    -------
    float or ndarray
        p, dimensionless, in the shape of the argument (a float for a scalar), to a relative
        accuracy of 1e-13 of its amplitude. Negative in places close to the edge; nan at the edge
        itself, where it has no limit (inf for ν = 0.5).

    Raises
    ------
    ValueError
        If ν is out of range, not exactly one of the coordinates is given, or a value of it lies
        outside [0, 1].
    """
    theta = oscillation_exponent(poisson_ratio)
    if theta == 0.0:
        return smooth_pressure(s, from_edge=from_edge)
    at = position(s, from_edge)
    weights, t, artanh = _inverse_transform(at)
    angle = 2.0 * theta * artanh
    integral = _sum(weights, np.cos(angle) + 2.0 * theta * (np.sin(angle) / t))
    return at.output(_amplitude(theta) * integral / np.sqrt(_nan_at_edge(at)))


def coupled_traction(
    poisson_ratio: float, s: ArrayLike | None = None, *, from_edge: ArrayLike | None = None
) -> Values:
    """Return the traction q of the coupled problem.

    With t² = s² + (1 − s²)v²,

        q = (2A s/(π√(1 − s²))) ∫₀¹ [sin ϑ(t)/t³ − (2θ/t²) cos ϑ(t)] dv.

    Parameters
    ----------
    poisson_ratio : float
        ν of the half-space, in (−1, 0.5].
    s : array_like, optional
        Distance from the centre, dimensionless, in [0, 1]; any shape.
    from_edge : array_like, optional
        Distance 1 − s from the edge, in [0, 1]; give either this or `s`.

    Returns
    -------
    float or ndarray
        q, dimensionless, in the shape of the argument (a float for a scalar), to a relative
        accuracy of 1e-13 of its amplitude. Proportional to s at the centre; nan at the edge, where
        it has no limit (0 everywhere for ν = 0.5).

    Raises
    ------
    ValueError
        If ν is out of range, not exactly one of the coordinates is given, or a value of it lies
        outside [0, 1].
    """
    theta = oscillation_exponent(poisson_ratio)
    at = position(s, from_edge)
    if theta == 0.0:
        return at.output(np.zeros_like(at.s))
    weights, t, artanh = _inverse_transform(at)
    # The bracket in q is (sin ϑ − 2θ t cos ϑ)/t³, whose numerator cancels at the centre. It is
    # (sin ϑ − ϑ cos ϑ) + (ϑ − 2θt) cos ϑ, and both terms are of order t³ there: the first is
    # ϑ² j₁(ϑ), the second is 2θ (artanh t − t) cos ϑ, as ϑ = 2θ artanh t.
    angle = 2.0 * theta * artanh
    first = (angle / t) ** 3 * _bessel_ratio(angle)
    second = 2.0 / 3.0 * theta * _cubic_rest(t, artanh) * np.cos(angle)
    integral = _sum(weights, first + second)
    return at.output(_amplitude(theta) * at.s * integral / np.sqrt(_nan_at_edge(at)))


def _amplitude(theta: float) -> float:
    """Return 2A/π."""
    return math.sinh(math.pi * theta) / (2.0 * math.pi**2 * theta)


def _nan_at_edge(at: Position) -> Array:
    """Return y, but nan at the edge: neither field has a limit there."""
    return np.where(at.y > 0.0, at.y, np.nan)


def _sum(weights: Array, integrand: Array) -> Array:
    return np.asarray(np.sum(weights * integrand, axis=-1))


class _Transform(NamedTuple):
    """Weights, t and artanh t at the nodes (last axis) of an integral over v."""

    weights: Array
    t: Array
    artanh: Array


def _inverse_transform(at: Position) -> _Transform:
    """Return the nodes of the integral over v."""
    # v = tanh x spreads the logarithmic oscillation at v = 1; sech² x is below rounding at x = 20.
    x, weights = panel_rule(0.0, 20.0)
    inside = at.y > 0.0  # what the edge itself gets is thrown away
    y = np.where(inside, at.y, 1.0)[..., None]
    log_y = np.where(inside, at.log_y, 0.0)[..., None]
    t = np.sqrt(at.s[..., None] ** 2 + y * np.tanh(x) ** 2)
    # 1 − t² = y sech² x, of which the logarithm is known where t is near 1
    far = np.log1p(t) - 0.5 * log_y + np.log(np.cosh(x))
    artanh = np.where(t < 0.5, np.arctanh(np.minimum(t, 0.5)), far)
    return _Transform(weights * np.cosh(x) ** -2.0, t, artanh)


def _bessel_ratio(angle: Array) -> Array:
    """Return j₁(ϑ)/ϑ = (sin ϑ − ϑ cos ϑ)/ϑ³, 1/3 at ϑ = 0."""
    small = np.minimum(angle, 1.0)
    large = np.maximum(angle, 1.0)
    series = special.hyp0f1(2.5, -0.25 * small * small) / 3.0
    closed = (np.sin(large) - large * np.cos(large)) / large**3
    return np.asarray(np.where(angle < 1.0, series, closed))


def _cubic_rest(t: Array, artanh: Array) -> Array:
    """Return 3 (artanh t − t)/t³, which is R_J(1, 1 − t², 1 − t², 1)."""
    m = 1.0 - np.minimum(t, 0.7) ** 2
    direct = np.maximum(t, 0.7)
    return np.asarray(
        np.where(t < 0.7, special.elliprj(1.0, m, m, 1.0), 3.0 * (artanh - direct) / direct**3)
    )
