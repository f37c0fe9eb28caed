"""Approach and edge pressure of the rough normal problem for very rough and for nearly smooth.

The normal problem (3.5) of the paper, α p + N p = δ under the load 1, has no closed solution for
0 < α < ∞. These are the leading terms at both ends; all quantities are dimensionless, lengths in
units of the punch radius. Each docstring gives the first term left out. Where it is small against
the last term kept, it is about the error.
"""

import math

import numpy as np
from scipy import special

from ._inputs import check_compliance, refusal


def approach_large_compliance(normal_compliance: float) -> float:
    """Return δ = α/π + 4/(3π²) + (37/36 − 7ζ(3)/8)/(π³α), for large α.

    Parameters
    ----------
    normal_compliance : float
        α of the roughness, dimensionless, finite and > 0.

    Returns
    -------
    float
        δ, dimensionless, under the load 1. The first neglected term is 7.9327e-5/α², so that the
        relative error is below 1e-4 for α = 1 already and reaches rounding at α ~ 1e4.

    Raises
    ------
    ValueError
        If α is not finite and positive, or so small that the series would not be positive.

    Notes
    -----
    The Neumann series in N/α, with N 1 = E(s)/π: the coefficients are moments such as
    ∫E² s ds. Rigid in the limit, where p = 1/π.
    """
    alpha = check_compliance(normal_compliance)
    third = (37.0 / 36.0 - 7.0 * float(special.zeta(3.0)) / 8.0) / (math.pi**3 * alpha)
    value = alpha / math.pi + 4.0 / (3.0 * math.pi**2) + third
    return _meaningful(value, alpha, "large")


def edge_pressure_large_compliance(normal_compliance: float) -> float:
    """Return p(1) = 1/π + 1/(3π²α) − 1/(18π³α²), for large α.

    Parameters
    ----------
    normal_compliance : float
        α of the roughness, dimensionless, finite and > 0.

    Returns
    -------
    float
        p(1), dimensionless. The first neglected term is 1.7028e-4/α³.

    Raises
    ------
    ValueError
        If α is not finite and positive, or so small that the series would not be positive.

    Notes
    -----
    It agrees with 2πα p(1)² = d(αδ)/dα and the series of δ, which loses its last term here.
    """
    alpha = check_compliance(normal_compliance)
    x = 1.0 / (math.pi * alpha)
    return _meaningful((1.0 + x / 3.0 - x * x / 18.0) / math.pi, alpha, "large")


def approach_small_compliance(normal_compliance: float) -> float:
    """Return δ = 1/8 + (α/4π)(L + 1), L = ln(1/α) + γ, for small α (γ Euler's constant).

    Parameters
    ----------
    normal_compliance : float
        α of the roughness, dimensionless, finite and > 0.

    Returns
    -------
    float
        δ, dimensionless, under the load 1. The first neglected term is of order α²L²; computed
        values agree with (α²/4π²)(2L² + 2L + 1), that is 2e-4 at α = 0.01.

    Raises
    ------
    ValueError
        If α is not finite and positive, or so large that the series would not be positive.
    """
    alpha = check_compliance(normal_compliance)
    value = 0.125 + alpha / (4.0 * math.pi) * (_logarithm(alpha) + 1.0)
    return _meaningful(value, alpha, "small")


def edge_pressure_small_compliance(normal_compliance: float) -> float:
    """Return p(1) = √(1 + (2α/π)(2L + 1)) / (4√(πα)), L = ln(1/α) + γ, for small α.

    Parameters
    ----------
    normal_compliance : float
        α of the roughness, dimensionless, finite and > 0.

    Returns
    -------
    float
        p(1), dimensionless. The first neglected term is of relative order α²L²; computed values
        agree with α²(6L² + 2L + 1)/π², that is 2e-3 at α = 0.01.

    Raises
    ------
    ValueError
        If α is not finite and positive, or so large that the series would not be positive.

    Notes
    -----
    From the exact 2πα p(1)² = d(αδ)/dα with the series of δ; its limit is 1/(4√(πα)).
    """
    alpha = check_compliance(normal_compliance)
    radicand = 1.0 + 2.0 * alpha / math.pi * (2.0 * _logarithm(alpha) + 1.0)
    return math.sqrt(_meaningful(radicand, alpha, "small")) / (4.0 * math.sqrt(math.pi * alpha))


def _logarithm(alpha: float) -> float:
    """Return L = ln(1/α) + γ."""
    return float(np.euler_gamma) - math.log(alpha)


def _meaningful(value: float, alpha: float, side: str) -> float:
    """Return a value that is positive, as the quantity it stands for."""
    if not value > 0.0:
        raise refusal("normal_compliance", alpha, f"{side} for this series")
    return value
