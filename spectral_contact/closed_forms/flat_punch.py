"""Below a smooth, frictionless flat punch: Sneddon's solution, elementary functions throughout.

With ``zeta = z + i`` and ``rho = sqrt(r**2 + zeta**2)`` every stress is the imaginary part of an
algebraic function of r, z and rho, and so are the displacements but for one angle (Sneddon 1946).
Their harmonic function 1/rho is the potential of a source at the imaginary depth -i, from which rho
is the distance.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._inputs import check_poisson_ratio, real_numbers, refusal

Array = NDArray[np.float64]
Complex = NDArray[np.complexfloating[Any, Any]]

#: At the edge z / rho is 0 / 0, and next to it powers of rho are 0.
_QUIET = np.errstate(divide="ignore", invalid="ignore", over="ignore")
#: Farther away cubes of the distance overflow.
_FAR = 1e100


class PunchStress(NamedTuple):
    """Stresses below the punch, tension positive, dimensionless: ``a**2 sigma / P``."""

    rr: Array
    tt: Array
    zz: Array
    rz: Array


class PunchDisplacement(NamedTuple):
    """Displacements outward and into the body: ``u a E / (4 (1 - nu**2) P)``."""

    r: Array
    z: Array


class _Place(NamedTuple):
    r: Array
    z: Array
    zeta: Complex
    rho: Complex


def _place(r: ArrayLike | None, z: ArrayLike, from_edge: ArrayLike | None) -> _Place:
    depth = _lengths("z", z)
    if (r is None) == (from_edge is None):
        raise refusal("r, from_edge", (r, from_edge), "one value and one None")
    if from_edge is None:
        radius = _lengths("r", r)
        edge = 1.0 - radius
    else:
        edge = _lengths("from_edge", from_edge, low=-_FAR, high=1.0)
        radius = 1.0 - edge
    try:
        np.broadcast_shapes(radius.shape, depth.shape)
    except ValueError:
        name = "r, z" if from_edge is None else "from_edge, z"
        raise refusal(name, (radius.shape, depth.shape), "of shapes that broadcast") from None
    # r**2 - 1 from the distance to the edge; the root is the one with a positive real part
    square = depth**2 - edge * (1.0 + radius) + 2j * depth
    return _Place(radius, depth, depth + 1j, np.sqrt(square))


def _lengths(name: str, values: Any, low: float = 0.0, high: float = _FAR) -> Array:
    allowed = f"in [{low:g}, {high:g}]"
    given = real_numbers(name, values, allowed)
    bad = ~(np.isfinite(given) & (given >= low) & (given <= high))
    if np.any(bad):
        raise refusal(name, float(given[bad].flat[0]), allowed)
    return given


def _source(values: Complex) -> Array:
    return np.asarray(-np.imag(values) / (2.0 * np.pi))


@_QUIET
def flat_punch_stress(
    poisson_ratio: float,
    r: ArrayLike | None = None,
    z: ArrayLike = 0.0,
    *,
    from_edge: ArrayLike | None = None,
) -> PunchStress:
    """Return the stress anywhere in the half-space; infinite or NaN at the edge.

    Errors are those of rounding the largest component at a point. A component that is far smaller
    than another one at the same point has fewer digits.

    Parameters
    ----------
    poisson_ratio : float
    r, z : array_like
        Distance from the axis and depth, in punch radii.
    from_edge : array_like, optional
        Instead of `r`: ``1 - r``, negative outside.

    Raises
    ------
    ValueError
        For a point outside the half-space or beyond 1e100 radii, both or neither of `r` and
        `from_edge`, or a Poisson's ratio outside (-1, 1/2].
    """
    nu = check_poisson_ratio(poisson_ratio)
    r_, z_, zeta, rho = _place(r, z, from_edge)
    # a harmonic function: the sum of the three normal stresses is -2 (1 + nu) times it
    harmonic = _source(1.0 / rho)
    zz = -harmonic - _source(z_ * zeta / rho**3)
    rz = -_source(z_ * r_ / rho**3)
    # 2 G u_r/r with the shear modulus G: the part of the hoop stress by the hoop strain
    hoop = -(1.0 - 2.0 * nu) * _source(1.0 / (rho + zeta)) + _source(z_ / (rho * (rho + zeta)))
    tt = hoop - 2.0 * nu * harmonic
    return PunchStress(-2.0 * harmonic - zz - hoop, tt, zz, rz)


@_QUIET
def flat_punch_displacement(
    poisson_ratio: float,
    r: ArrayLike | None = None,
    z: ArrayLike = 0.0,
    *,
    from_edge: ArrayLike | None = None,
) -> PunchDisplacement:
    """Return the displacement anywhere in the half-space.

    Parameters and errors are those of `flat_punch_stress`.
    """
    nu = check_poisson_ratio(poisson_ratio)
    r_, z_, zeta, rho = _place(r, z, from_edge)
    # terms with the factor z: they are 0 at the surface, also at the edge, where they are 0/0
    down_below = np.where(z_ > 0.0, _source(z_ / rho), 0.0)
    out_below = np.where(z_ > 0.0, _source(z_ / (rho * (rho + zeta))), 0.0)
    down = (1.0 - nu) / np.pi * np.angle(zeta + rho) + down_below
    out = r_ * (out_below - (1.0 - 2.0 * nu) * _source(1.0 / (rho + zeta)))
    factor = 4.0 * (1.0 - nu)
    return PunchDisplacement(out / factor, down / factor)
