"""A ring of normal or radial load on the half-space: its stresses and displacements in the body.

Each is a Lipschitz-Hankel integral ``int J_m(k s) J_n(k r) exp(-k z) k**l dk``, written so that
what vanishes at the surface has its factor ``z`` in front, and nothing is divided by a small
radius. All are for unit load per length of the radius, that is, to be integrated with
``p s ds`` or ``q s ds``; ``G = 2 (1 - nu)`` in the units of the paper.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.special import ellipe

from spectral_contact.equations.interior.elliptic import Elliptic, elliptic, solid_angle
from spectral_contact.fields import Array

_TWO_OVER_PI = 2.0 / np.pi
_FEW_NODES, _FEW_WEIGHTS = np.polynomial.legendre.leggauss(4)


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
    """Return the derivatives of ``h = (2/pi) E / (a b2)`` with respect to r and to s."""
    own, cube = g.own, g.a * g.a2
    common = -own.e * (g.r + g.s) / (cube * g.b2)
    apart = 2.0 * own.e * g.ahead / (g.a * g.b2**2)
    across = g.ahead * (g.r + g.s)
    inward = -2.0 * own.d * g.s * (g.z**2 - across) / (cube * g.a2 * g.b2)
    outward = -2.0 * own.d * g.r * (g.z**2 + across) / (cube * g.a2 * g.b2)
    return _TWO_OVER_PI * (inward + common - apart), _TWO_OVER_PI * (outward + common + apart)


def _mean_flux(g: Geometry) -> Array:
    """Return ``I(0, 1; 0) / r``: the part of a ring's load that flows through a disk below it."""
    near_axis = g.r**2 < 0.04 * (g.s**2 + g.z**2)
    result = np.empty(g.s.shape)
    if near_axis.any():
        result[near_axis] = _flux_near_axis(g.r[near_axis], g.z[near_axis], g.s[near_axis])
    far = ~near_axis
    if far.any():
        own, r = Elliptic(*(part[far] for part in g.own)), g.r[far]
        result[far] = solid_angle(own, g.z[far], g.a[far], g.ahead[far], r + g.s[far]) / r**2
    return result


def _flux_near_axis(r: Array, z: Array, s: Array) -> Array:
    """Return the mean over the disk of half the stress, which is smooth there."""
    radius = r[:, None] * np.sqrt(0.5 + _FEW_NODES / 2.0)
    s, z = s[:, None], z[:, None]
    a2, b2 = (radius + s) ** 2 + z**2, (radius - s) ** 2 + z**2
    flux = z * ellipe(4.0 * radius * s / a2) / (np.sqrt(a2) * b2)
    return np.asarray(_TWO_OVER_PI * (flux @ (_FEW_WEIGHTS / 4.0)))


def normal_stress(g: Geometry, nu: float) -> tuple[Array, ...]:
    """Return zz, rz, ``2 G u_r / r`` and the harmonic sum ``e``, for a ring of pressure."""
    own, cube = g.own, g.a * g.a2
    harmonic = _TWO_OVER_PI * g.z * own.e / (g.a * g.b2)
    push = 2.0 * own.e / (g.a * g.b2**2) + (2.0 * own.e - own.k) / (cube * g.b2)
    zz = -_TWO_OVER_PI * g.z**3 * push
    rz = g.z**2 * _slope(g)[0]
    bulge = own.k + 4.0 * g.s**2 / g.a2 * own.c + 4.0 * g.s * own.b * g.ahead / g.b2
    hoop = _TWO_OVER_PI * g.z / cube * bulge
    if nu < 0.5:
        hoop = hoop - (1.0 - 2.0 * nu) * _mean_flux(g)
    return zz, rz, hoop, harmonic


def radial_stress(g: Geometry, nu: float) -> tuple[Array, ...]:
    """Return zz, rz, ``2 G u_r / r`` and the harmonic sum ``e``, for a ring of traction."""
    own, cube = g.own, g.a * g.a2
    zz = -(g.z**2) * _slope(g)[1]
    across = g.ahead * (g.r + g.s)
    harmonic = (
        -_TWO_OVER_PI / cube * (own.k * (g.r + g.s) - 2.0 * g.r * own.b * (across + g.z**2) / g.b2)
    )
    near = 2.0 * own.d_less_c - own.b
    hoop = (
        _TWO_OVER_PI
        * 4.0
        * g.s
        / cube
        * (2.0 * (1.0 - nu) * own.c - g.z**2 * (near / g.b2 + own.c / g.a2))
    )
    return zz, -_shear(g, near), hoop, harmonic


def _shear(g: Geometry, near: Array) -> Array:
    """Return ``I(1,1;1) - z I(1,1;2)``."""
    own, cube = g.own, g.a * g.a2
    m = own.m
    d_slope = own.d_less_c / (2.0 * own.rest)
    b_slope = own.b / (2.0 * own.rest) - d_slope
    c_slope = near / (2.0 * own.rest) - own.c  # this and the next are m times the derivatives
    near_slope = m * (2.0 * d_slope - b_slope) - 2.0 * c_slope
    value = near / (g.a * g.b2) + own.c / cube
    change = -2.0 * (value + near_slope / (g.a * g.b2) + c_slope / cube) / g.a2
    change -= near / (cube * g.b2) + 2.0 * near / (g.a * g.b2**2) + 3.0 * own.c / (cube * g.a2)
    return np.asarray(_TWO_OVER_PI * m * g.z * (2.0 * value + g.z**2 * change))


def normal_displacement(g: Geometry, nu: float) -> tuple[Array, Array]:
    """Return ``2 G u_z`` and ``2 G u_r / r`` for a ring of pressure."""
    _, _, hoop, harmonic = normal_stress(g, nu)
    return 2.0 * (1.0 - nu) * _TWO_OVER_PI * g.own.k / g.a + g.z * harmonic, hoop


def radial_displacement(g: Geometry, nu: float) -> tuple[Array, Array]:
    """Return ``2 G u_z`` and ``2 G u_r / r`` for a ring of traction."""
    _, _, hoop, harmonic = radial_stress(g, nu)
    sink = g.z * harmonic
    if nu < 0.5:
        seen = solid_angle(g.own, g.z, g.a, -g.ahead, g.r + g.s)
        sink = sink - (1.0 - 2.0 * nu) * seen / g.s
    return sink, hoop
