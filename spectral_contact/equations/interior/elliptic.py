"""Complete elliptic integrals in the combinations that ring loads need, without cancellation."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.polynomial import polynomial
from scipy.special import ellipe, ellipkm1

from spectral_contact.fields import Array

#: Up to this parameter the series serves; beyond, the definitions lose little.
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
        ``D - C``, whose logarithms at ``m = 1`` cancel.
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
    k, e = ellipkm1(rest), ellipe(1.0 - rest)
    small = m < _SMALL
    large = np.where(small, 1.0, m)
    c = ((2.0 - large) * k - 2.0 * e) / large**2
    b = (e - rest * k) / large
    d = (k - e) / large
    less = ((2.0 - large) * e - 2.0 * rest * k) / large**2
    if small.any():
        few, known = m[small], k[small]
        series = polynomial.polyval(few, _SERIES)
        c[small] = series
        d[small] = (known + few * series) / 2.0
        b[small] = (known - few * series) / 2.0
        less[small] = d[small] - series
    return Elliptic(m, rest, k, e, b, d, c, less)


def solid_angle(own: Elliptic, z: Array, a: Array, ahead: Array, total: Array) -> Array:
    """Return the solid angle of a disk over ``2 pi``, seen from a point at height `z`.

    Parameters
    ----------
    own : Elliptic
        Of ``m = 4 r s / a**2``.
    z, a : ndarray
        Height, and the largest distance to the rim.
    ahead, total : ndarray
        Radius of the disk minus the distance from its axis, and their sum (Paxton 1959).
    """
    ratio, step = ahead / total, np.heaviside(ahead, 0.5)
    if not z.any():  # of a disk in the plane
        return step
    # K + ratio Pi(n | m) with 1 - n = ratio**2
    both = _bulirsch(np.sqrt(own.rest), np.maximum(np.abs(ratio), 1e-150), 1.0 + ratio, ratio)
    return np.asarray(step - z / (np.pi * a) * both)


def _bulirsch(kc: Array, p: Array, sum_: Array, ratio: Array) -> Array:
    """Return Bulirsch's ``cel(kc, p**2, sum_, ratio * sum_)``, by his doubling (1969)."""
    a, b = sum_, ratio * sum_ / p
    e, mean = kc, np.ones_like(kc)
    while True:
        a, b = a + b / p, 2.0 * (b + a * e / p)
        p = p + e / p
        last, mean = mean, mean + kc
        if np.all(np.abs(last - kc) <= 1e-8 * last):
            return np.asarray(np.pi / 2.0 * (a * mean + b) / (mean * (mean + p)))
        kc = 2.0 * np.sqrt(e)
        e = kc * mean
