r"""The layer of Greenwood and Williamson: spherical asperities of one radius and random heights.

With the separation ``d = -w`` from the mean of their heights they carry

    p = (4/3) density E* sqrt(tip_radius) int_d^inf (z - d)^(3/2) phi(z) dz,   E* = 4 E'

(Proc. R. Soc. Lond. A 295 (1966) 300-319). Under a parabola this is the contact of Greenwood and
Tripp (J. Appl. Mech. 34 (1967) 153-159).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cache
from math import gamma, inf, pi, sqrt
from typing import Self

import numpy as np
from numpy.polynomial import chebyshev

from spectral_contact.fields import Array
from spectral_contact.io.parameters import declared
from spectral_contact.layers.layer_base import RANGE, Layer

#: ``4/3 E*`` in E'.
_FACTOR = 16.0 / 3.0
#: Number of points of the trapezoidal rule for a moment, good down to a separation of -30
#: deviations.
_POINTS = 128
#: Twice the exponent at which the rule ends: there the integrand has fallen by ``exp(-40)``.
_END = 80.0
#: Terms of the Chebyshev series that stands for a moment on an interval of one deviation.
_TERMS = 18
#: Moments are series between this separation and `_FARTHEST`, whole numbers of deviations.
_NEAREST = -30.0
_FARTHEST = 45.0


@dataclass(frozen=True, slots=True)
class GreenwoodWilliamson(Layer):
    """Asperities with spherical tips, as Greenwood and Williamson have them.

    The overclosure is ``w = -d``. The separation d is counted from the mean of Gaussian heights,
    and from the lowest asperity if heights are exponential, as Greenwood and Williamson have it.

    Parameters
    ----------
    density : float
        Asperities per area, in 1/L².
    tip_radius : float
        Radius of the tips, in L.
    height_deviation : float
        Standard deviation of the heights, in L.
    heights : str
        Their distribution: ``"gaussian"`` or ``"exponential"``.

    Raises
    ------
    SceneError
        If a number is not in [1e-100, 1e100], or the distribution is another.
    """

    density: float = field(metadata=declared("asperities per area", RANGE, "1/m^2"))
    tip_radius: float = field(metadata=declared("radius of their tips", RANGE, "m"))
    height_deviation: float = field(
        metadata=declared("standard deviation of their heights", RANGE, "m")
    )
    heights: str = field(
        default="gaussian",
        metadata=declared("distribution of their heights", choices=("gaussian", "exponential")),
    )

    def _over(self, unit: float) -> Self:
        """Return the law itself: its pressure is in E' of the half-space."""
        return self

    @property
    def start(self) -> float:
        """Minus infinity, as there is pressure at every gap."""
        return -inf

    @property
    def knots(self) -> tuple[float, ...]:
        """Zero for exponential heights, beyond which all asperities touch."""
        return () if self.heights == "gaussian" else (0.0,)

    @property
    def _size(self) -> float:
        return self.height_deviation

    @property
    def _unit(self) -> float:
        return float(_FACTOR * self.density * sqrt(self.tip_radius) * self.height_deviation**1.5)

    def _height_moment(self, w: Array, order: int) -> Array:
        """Return ``int (z - h)^(order/2) phi(z) dz`` at ``h = -w`` over the deviation."""
        h = -np.asarray(w, dtype=float) / self.height_deviation
        if self.heights == "exponential":
            return _exponential(order, h)
        return _gaussian(order, h)

    def _pressure(self, w: Array) -> Array:
        return self._unit * self._height_moment(w, 3)

    def _slope(self, w: Array) -> Array:
        return 1.5 * self._unit / self.height_deviation * self._height_moment(w, 1)

    def _rates(self, w: Array) -> dict[str, Array]:
        p = self._pressure(w)
        return {
            "density": p,
            "tip_radius": 0.5 * p,
            "height_deviation": 1.5 * p - w * self._slope(w),
        }

    def _energy(self, w: Array) -> Array:
        return 0.4 * self._unit * self.height_deviation * self._height_moment(w, 5)


def _gaussian(order: int, h: Array) -> Array:
    """Return the moment of Gaussian heights of unit deviation, for an odd order."""
    within = np.clip(np.where(np.isnan(h), _FARTHEST, h), _NEAREST, _FARTHEST)
    interval = np.minimum((within - _NEAREST).astype(int), int(_FARTHEST - _NEAREST) - 1)
    local = 2.0 * (within - _NEAREST - interval) - 1.0
    rows = _series(order)[:, interval]
    twice = 2.0 * local
    total = rows[-1]
    before = np.zeros(np.shape(h))
    for row in rows[-2:0:-1]:
        total, before = row + twice * total - before, total
    total = rows[0] + local * total - before
    with np.errstate(under="ignore"):
        total = total * np.exp(-0.5 * np.maximum(within, 0.0) ** 2)
    total = np.where(h > _FARTHEST, 0.0, np.where(np.isnan(h), h, total))
    deep = h < _NEAREST
    if deep.any():
        total = np.where(deep, _deep(order / 2.0, np.maximum(-h, 1.0)), total)
    return np.asarray(total)


@cache
def _series(order: int) -> Array:
    """Return Chebyshev series of the moment on intervals of unit length, (terms, intervals).

    Beyond 0 the moment is divided by ``exp(-h**2/2)``, with which `_gaussian` multiplies it again.
    """
    nodes = chebyshev.chebpts1(_TERMS)
    starts = np.arange(_NEAREST, _FARTHEST)
    h = starts[:, None] + (1.0 + nodes) / 2.0
    return np.asarray(chebyshev.chebfit(nodes, _moment(order, h).T, _TERMS - 1))


def _moment(order: int, h: Array) -> Array:
    """Return the moment; beyond 0 it is divided by ``exp(-h**2/2)``.

    With ``z = h + v**2`` the integrand is entire and dies out: the trapezoidal rule converges
    geometrically, and cancels nothing.
    """
    reach = np.sqrt(np.sqrt(h**2 + _END) - h)
    v = reach[..., None] * (np.arange(1.0, _POINTS + 1.0) / _POINTS)
    exponent = h[..., None] * v**2 + v**4 / 2.0 + np.minimum(h, 0.0)[..., None] ** 2 / 2.0
    values = v ** (order + 1) * np.exp(-exponent)
    return np.asarray(2.0 * reach / _POINTS / sqrt(2.0 * pi) * values.sum(axis=-1))


def _deep(power: float, x: Array) -> Array:
    """Return ``int (z + x)^power phi(z) dz`` for large x: by the even moments of phi."""
    term = np.ones(np.shape(x))
    total = np.zeros(np.shape(x))
    for k in range(1, 13):
        total = total + term
        n = power - 2.0 * (k - 1)
        term = term * n * (n - 1.0) / (2.0 * k) / x / x
    return np.asarray(x**power * total)


def _exponential(order: int, h: Array) -> Array:
    """Return the moment of exponential heights of unit deviation, 1, 3 or 5 its order."""
    from scipy.special import erfcx  # takes long to import

    x = np.maximum(-h, 0.0)
    root = np.sqrt(x)
    total = root + 0.5 * sqrt(pi) * erfcx(root)
    for k in range(3, order + 1, 2):
        total = x ** (k / 2.0) + k / 2.0 * total
    with np.errstate(under="ignore"):
        outside = gamma(order / 2.0 + 1.0) * np.exp(-np.maximum(h, 0.0))
    return np.asarray(np.where(h > 0.0, outside, total))
