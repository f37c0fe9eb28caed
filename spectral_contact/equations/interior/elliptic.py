"""Complete elliptic integrals in the combinations that ring loads need, without cancellation."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.polynomial import polynomial
from scipy.special import ellipe, ellipkm1

from spectral_contact.fields import Array

#: Below this parameter C is summed from its series, whose 31 terms are right to rounding, and B, D
#: and D - C follow from K and C. Above it all follow from their definitions: that of C loses two
#: digits at most.
_SMALL = 0.3


def _series() -> Array:
    """Return the coefficients of ``C = (pi/16) 2F1(3/2, 3/2; 3; m)``."""
    n = np.arange(30.0)
    ratios = (n + 1.5) ** 2 / ((n + 3.0) * (n + 1.0))
    return np.asarray(np.pi / 16.0 * np.concatenate([[1.0], np.cumprod(ratios)]))


_SERIES = _series()


class Elliptic(NamedTuple):
    """The integrals at one parameter ``m``; all are positive.

    Attributes
    ----------
    m, rest : ndarray
        The parameter and ``1 - m``.
    k, e, b, d, c : ndarray
        ``K``, ``E``, ``B = (E - (1 - m) K)/m``, ``D = (K - E)/m`` and
        ``C = ((2 - m) K - 2 E)/m**2 = (D - B)/m``.
    d_less_c : ndarray
        ``D - C``, which is finite at ``m = 1``, where D and C are infinite as logarithms.
    """

    m: Array
    rest: Array
    k: Array
    e: Array
    b: Array
    d: Array
    c: Array
    d_less_c: Array


def elliptic(m: Array, rest: Array) -> Elliptic:
    """Return the integrals at parameters `m` whose complements are `rest`, any shape."""
    k = ellipkm1(rest)
    e = ellipe(1.0 - rest)
    small = m < _SMALL
    divisor = np.where(small, 1.0, m)  # values at small parameters are replaced below
    c = ((2.0 - divisor) * k - 2.0 * e) / divisor**2
    b = (e - rest * k) / divisor
    d = (k - e) / divisor
    d_less_c = ((2.0 - divisor) * e - 2.0 * rest * k) / divisor**2
    if small.any():
        # K = B + D, and m C = D - B
        small_m = m[small]
        small_k = k[small]
        small_c = polynomial.polyval(small_m, _SERIES)
        c[small] = small_c
        d[small] = (small_k + small_m * small_c) / 2.0
        b[small] = (small_k - small_m * small_c) / 2.0
        d_less_c[small] = d[small] - small_c
    return Elliptic(m, rest, k, e, b, d, c, d_less_c)


def solid_angle(integrals: Elliptic, z: Array, a: Array, difference: Array, total: Array) -> Array:
    """Return the solid angle of a disk over ``2 pi``, seen from a point (Paxton 1959).

    Parameters
    ----------
    integrals : Elliptic
        Of ``m = 4 r s / a**2``, with the radius of the disk and the distance of the point from its
        axis.
    z, a : ndarray
        Height of the point above the disk, and its largest distance from the rim.
    difference, total : ndarray
        The radius of the disk minus the distance of the point from its axis, and the radius plus
        that distance.
    """
    ratio = difference / total
    in_plane = np.heaviside(difference, 0.5)
    if not z.any():
        return in_plane
    # K + ratio Pi(n | m) with 1 - n = ratio**2
    p = np.maximum(np.abs(ratio), 1e-150)
    k_and_pi = _bulirsch(np.sqrt(integrals.rest), p, 1.0 + ratio, ratio)
    return np.asarray(in_plane - z / (np.pi * a) * k_and_pi)


def _bulirsch(kc: Array, p: Array, sum_: Array, ratio: Array) -> Array:
    """Return Bulirsch's ``cel(kc, p**2, sum_, ratio * sum_)``, by his doubling (1969).

    `a`, `b`, `e`, `kc` and `p` are the variables of his procedure, not integrals of `Elliptic`; `p`
    is the root of the argument that cel has. Each step doubles the digits, so that the iteration
    ends when half of them agree.
    """
    a = sum_
    b = ratio * sum_ / p
    e = kc
    mean = np.ones_like(kc)
    while True:
        last_a = a
        a = a + b / p
        b = 2.0 * (b + last_a * e / p)
        p = p + e / p
        last_mean = mean
        mean = mean + kc
        if np.all(np.abs(last_mean - kc) <= 1e-8 * last_mean):
            return np.asarray(np.pi / 2.0 * (a * mean + b) / (mean * (mean + p)))
        kc = 2.0 * np.sqrt(e)
        e = kc * mean
