"""Smooth surfaces stuck everywhere (α = β = 0), the shear without effect on the pressure.

All quantities are dimensionless as in the paper, stars dropped: lengths in units of the punch
radius a, tractions of P/a², displacements of 4(1 − ν²)P/(aE), with E Young's modulus and P the
load. A point of the contact disk is given by ``s``, its distance from the centre, or, where digits
near the edge matter, by ``from_edge`` = 1 − s.
"""

import math

import numpy as np
from numpy.typing import ArrayLike

from ._inputs import Values, kappa, position


def smooth_approach() -> float:
    """Return the approach δ = 1/8 of a smooth punch without coupling.

    Returns
    -------
    float
        δ, dimensionless, under the load 1.

    References
    ----------
    Johnson, Contact Mechanics (1985), §3.4; constant in equation (3.5) of the paper for α = 0.
    """
    return 0.125


def smooth_pressure(s: ArrayLike | None = None, *, from_edge: ArrayLike | None = None) -> Values:
    """Return the pressure p = 1/(2π√(1 − s²)) under a smooth punch.

    Parameters
    ----------
    s : array_like, optional
        Distance from the centre, dimensionless, in [0, 1]; any shape.
    from_edge : array_like, optional
        Distance 1 − s from the edge, in [0, 1]; give either this or `s`.

    Returns
    -------
    float or ndarray
        p, dimensionless, in the shape of the argument (a float for a scalar); inf at the edge.

    Raises
    ------
    ValueError
        If not exactly one of the coordinates is given, or a value lies outside [0, 1].

    References
    ----------
    Equation (3.6) of the paper.
    """
    at = position(s, from_edge)
    with np.errstate(divide="ignore"):  # p = ∞ at the edge is the solution
        return at.output(np.asarray(0.5 / (math.pi * np.sqrt(at.y))))


def full_stick_traction(
    poisson_ratio: float, s: ArrayLike | None = None, *, from_edge: ArrayLike | None = None
) -> Values:
    """Return the traction q = −(κ/π²) ln(1 − s²) / (s√(1 − s²)) under a punch stuck everywhere.

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
        q, dimensionless, in the shape of the argument (a float for a scalar): 0 at the centre,
        where q ~ κs/π², and inf at the edge, save for ν = 0.5, where it vanishes everywhere.

    Raises
    ------
    ValueError
        If ν is out of range, not exactly one of the coordinates is given, or a value of it lies
        outside [0, 1].

    Notes
    -----
    It solves equation (4.2) of the paper, (1/π)∫q K2 dη = κ g, for β = 0 and the pressure (3.6).
    By Abel inversion, ∫ₜ¹ q ds/√(s² − t²) = κ artanh(t)/(πt), and q is its inverse transform.
    """
    shear = kappa(poisson_ratio)
    at = position(s, from_edge)
    if shear == 0.0:
        return at.output(np.zeros_like(at.s))
    # s² vanishes in floating point long before s does, hence −ln(y)/s = s + O(s³) by hand.
    central = at.s < 1e-8
    profile = np.where(central, at.s, -at.log_y / np.where(central, 1.0, at.s))
    with np.errstate(divide="ignore"):  # q = ∞ at the edge is the solution
        return at.output(np.asarray(shear / math.pi**2 * profile / np.sqrt(at.y)))


def full_stick_shear(poisson_ratio: float) -> float:
    """Return the total shear Q = 2π∫q s ds = 2κ ln 2 under a smooth punch stuck everywhere.

    Parameters
    ----------
    poisson_ratio : float
        ν of the half-space, in (−1, 0.5].

    Returns
    -------
    float
        Q, dimensionless (in units of the load): a measure of shear, since radial traction has no
        resultant.

    Raises
    ------
    ValueError
        If ν is out of range.

    References
    ----------
    Equation (4.3) of the paper, with the traction of `full_stick_traction`.
    """
    return 2.0 * kappa(poisson_ratio) * math.log(2.0)
