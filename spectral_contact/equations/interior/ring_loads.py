"""A ring of normal or radial load on the half-space: its stresses and displacements in the body.

Each is made of Lipschitz-Hankel integrals ``I(m, n; l) = int J_m(k s) J_n(k r) exp(-k z) k**l dk``.
A term that vanishes at the surface is computed as the depth ``z``, or a power of it, times a finite
factor, and nothing is divided by a small radius (docs/inside, docs/stress). All are to be
integrated with ``p s ds`` or ``q s ds``; ``G = 2 (1 - nu)`` in the units of the paper. The sum of
the normal stresses is ``-2 (1 + nu)`` times the *harmonic sum*, which docs/stress calls e; in this
module e is the elliptic integral E.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.special import ellipe

from spectral_contact.equations.interior.elliptic import Elliptic, elliptic, solid_angle
from spectral_contact.fields import Array

_TWO_OVER_PI = 2.0 / np.pi
#: Gauss's rule for means over a disk next to the axis.
_DISK_NODES, _DISK_WEIGHTS = np.polynomial.legendre.leggauss(4)
#: A disk around the axis is small if its radius squared is below this fraction of the squared
#: distance of its centre from the ring: then four nodes are enough.
_NEAR_AXIS = 0.04


class Geometry(NamedTuple):
    """Distances between points and rings.

    Attributes
    ----------
    r, z, s : ndarray
        Radius and depth of the points, radius of the rings.
    ahead : ndarray
        ``r - s``, to relative accuracy.
    a2, b2 : ndarray
        Squares of the largest and the smallest distance.
    a : ndarray
        Root of `a2`.
    own : Elliptic
        The elliptic integrals of ``4 r s / a2``.
    """

    r: Array
    z: Array
    s: Array
    ahead: Array
    a2: Array
    b2: Array
    a: Array
    own: Elliptic


def geometry(r: Array, z: Array, s: Array, ahead: Array) -> Geometry:
    """Return the distances; all arguments have one shape, and no ring touches its point."""
    a2 = (r + s) ** 2 + z**2
    b2 = ahead**2 + z**2
    return Geometry(r, z, s, ahead, a2, b2, np.sqrt(a2), elliptic(4.0 * r * s / a2, b2 / a2))


def _slope(g: Geometry) -> tuple[Array, Array]:
    """Return the derivatives of ``h = (2/pi) E / (a b2)`` with respect to r and to s.

    ``z h`` is ``I(0, 0; 1)``.
    """
    own = g.own
    cube = g.a * g.a2
    difference_of_squares = g.ahead * (g.r + g.s)
    # by the factors 1/a, 1/b2 and E, of which dE/dm is -D/2
    by_a = -own.e * (g.r + g.s) / (cube * g.b2)
    by_b2 = 2.0 * own.e * g.ahead / (g.a * g.b2**2)
    e_by_r = -2.0 * own.d * g.s * (g.z**2 - difference_of_squares) / (cube * g.a2 * g.b2)
    e_by_s = -2.0 * own.d * g.r * (g.z**2 + difference_of_squares) / (cube * g.a2 * g.b2)
    return _TWO_OVER_PI * (e_by_r + by_a - by_b2), _TWO_OVER_PI * (e_by_s + by_a + by_b2)


def _mean_flux(g: Geometry) -> Array:
    """Return ``I(0, 1; 0) / r``: half of the mean of ``I(0, 0; 1)`` over the disk of radius r.

    It follows from the solid angle of the disk, but not next to the axis, where the quotient of two
    small numbers would lose digits.
    """
    near_axis = g.r**2 < _NEAR_AXIS * (g.s**2 + g.z**2)
    result = np.empty(g.s.shape)
    if near_axis.any():
        result[near_axis] = _flux_near_axis(g.r[near_axis], g.z[near_axis], g.s[near_axis])
    far = ~near_axis
    if far.any():
        integrals = Elliptic(*(part[far] for part in g.own))
        r = g.r[far]
        angle = solid_angle(integrals, g.z[far], g.a[far], g.ahead[far], r + g.s[far])
        result[far] = angle / r**2
    return result


def _flux_near_axis(r: Array, z: Array, s: Array) -> Array:
    """Return half of the mean of ``I(0, 0; 1)`` over disks, by Gauss's rule in the area."""
    radius = r[:, None] * np.sqrt(0.5 + _DISK_NODES / 2.0)
    s = s[:, None]
    z = z[:, None]
    a2 = (radius + s) ** 2 + z**2
    b2 = (radius - s) ** 2 + z**2
    flux = z * ellipe(4.0 * radius * s / a2) / (np.sqrt(a2) * b2)
    return np.asarray(_TWO_OVER_PI * (flux @ (_DISK_WEIGHTS / 4.0)))


def normal_stress(g: Geometry, nu: float) -> tuple[Array, ...]:
    """Return zz, rz, ``2 G u_r / r`` and the harmonic sum, for a ring of pressure."""
    own = g.own
    cube = g.a * g.a2
    harmonic = _TWO_OVER_PI * g.z * own.e / (g.a * g.b2)
    # I(0, 0; 1) + z I(0, 0; 2) over (2/pi) z**3
    axial = 2.0 * own.e / (g.a * g.b2**2) + (2.0 * own.e - own.k) / (cube * g.b2)
    zz = -_TWO_OVER_PI * g.z**3 * axial
    rz = g.z**2 * _slope(g)[0]
    # I(0, 1; 1) / r, over 2/(pi a**3)
    radial = own.k + 4.0 * g.s**2 / g.a2 * own.c + 4.0 * g.s * own.b * g.ahead / g.b2
    hoop = _TWO_OVER_PI * g.z / cube * radial
    if nu < 0.5:
        hoop = hoop - (1.0 - 2.0 * nu) * _mean_flux(g)
    return zz, rz, hoop, harmonic


def radial_stress(g: Geometry, nu: float) -> tuple[Array, ...]:
    """Return zz, rz, ``2 G u_r / r`` and the harmonic sum, for a ring of traction."""
    own = g.own
    cube = g.a * g.a2
    zz = -(g.z**2) * _slope(g)[1]
    squares = g.ahead * (g.r + g.s) + g.z**2  # r**2 - s**2 + z**2
    harmonic = -_TWO_OVER_PI / cube * (own.k * (g.r + g.s) - 2.0 * g.r * own.b * squares / g.b2)
    scaled_slope = 2.0 * own.d_less_c - own.b
    # 2 (1 - nu) I(1, 1; 0) / r and z I(1, 1; 1) / r, over 8 s/(pi a**3)
    at_surface = 2.0 * (1.0 - nu) * own.c
    with_depth = g.z**2 * (scaled_slope / g.b2 + own.c / g.a2)
    hoop = _TWO_OVER_PI * 4.0 * g.s / cube * (at_surface - with_depth)
    return zz, -_shear(g, scaled_slope), hoop, harmonic


def _shear(g: Geometry, scaled_slope: Array) -> Array:
    """Return ``I(1, 1; 1) - z I(1, 1; 2)``.

    A derivative by z, with the sign changed, raises the last index by 1, so that both follow from
    ``I(1, 1; 0) = (2/pi) m C/a``. The name of a derivative by ln m, which is m times that by m,
    ends with ``by_log_m``.

    Parameters
    ----------
    g : Geometry
    scaled_slope : ndarray
        ``2 (1 - m) d(m C)/dm``, which is ``2 D - 2 C - B``.
    """
    own = g.own
    cube = g.a * g.a2
    m = own.m
    d_by_m = own.d_less_c / (2.0 * own.rest)
    b_by_m = own.b / (2.0 * own.rest) - d_by_m
    c_by_log_m = scaled_slope / (2.0 * own.rest) - own.c
    slope_by_log_m = m * (2.0 * d_by_m - b_by_m) - 2.0 * c_by_log_m
    # I(1, 1; 1) is (2/pi) m z value, and change is d(m value)/dz over m z
    value = scaled_slope / (g.a * g.b2) + own.c / cube
    change = -2.0 * (value + slope_by_log_m / (g.a * g.b2) + c_by_log_m / cube) / g.a2
    change -= (
        scaled_slope / (cube * g.b2)
        + 2.0 * scaled_slope / (g.a * g.b2**2)
        + 3.0 * own.c / (cube * g.a2)
    )
    return np.asarray(_TWO_OVER_PI * m * g.z * (2.0 * value + g.z**2 * change))


def normal_displacement(g: Geometry, nu: float) -> tuple[Array, Array]:
    """Return ``2 G u_z`` and ``2 G u_r / r`` for a ring of pressure."""
    _, _, hoop, harmonic = normal_stress(g, nu)
    return 2.0 * (1.0 - nu) * _TWO_OVER_PI * g.own.k / g.a + g.z * harmonic, hoop


def radial_displacement(g: Geometry, nu: float) -> tuple[Array, Array]:
    """Return ``2 G u_z`` and ``2 G u_r / r`` for a ring of traction."""
    _, _, hoop, harmonic = radial_stress(g, nu)
    downward = g.z * harmonic
    if nu < 0.5:
        # I(1, 0; 0): of the disk within the ring, seen from the point
        angle = solid_angle(g.own, g.z, g.a, -g.ahead, g.r + g.s)
        downward = downward - (1.0 - 2.0 * nu) * angle / g.s
    return downward, hoop
