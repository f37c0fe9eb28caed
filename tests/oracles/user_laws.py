"""Laws that a user might write: with a start and none, with a knot, with a limit."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import inf

import numpy as np

from spectral_contact.layers import Layer


@dataclass(frozen=True)
class TwoScales(Layer):
    """What the laws share: a pressure and an overclosure, which scale them."""

    strength: float
    length: float

    @property
    def _size(self):
        return self.length

    def _over(self, unit):
        return replace(self, strength=self.strength / unit)


@dataclass(frozen=True)
class Hardening(TwoScales):
    """``c (x + x³)`` of ``x = (w - begin)/length``."""

    begin: float = 0.0

    @property
    def start(self):
        return self.begin

    def _x(self, w):
        return np.maximum(w - self.begin, 0.0) / self.length

    def _pressure(self, w):
        x = self._x(w)
        return self.strength * (x + x**3)

    def _slope(self, w):
        return np.where(
            w >= self.begin, self.strength / self.length * (1.0 + 3.0 * self._x(w) ** 2), 0.0
        )

    def _energy(self, w):
        x = self._x(w)
        return self.strength * self.length * (x**2 / 2.0 + x**4 / 4.0)


@dataclass(frozen=True)
class TwoStages(TwoScales):
    """``c x`` up to ``x = w/length = 1``, then steeper: ``c (x + ratio (x - 1))``."""

    ratio: float

    @property
    def knots(self):
        return (self.length,)

    def _beyond(self, w):
        return np.maximum(w / self.length - 1.0, 0.0)

    def _pressure(self, w):
        return self.strength * (np.maximum(w, 0.0) / self.length + self.ratio * self._beyond(w))

    def _slope(self, w):
        slope = np.where(w >= self.length, 1.0 + self.ratio, 1.0)
        return np.where(w >= 0.0, self.strength / self.length * slope, 0.0)

    def _energy(self, w):
        x = np.maximum(w, 0.0) / self.length
        return self.strength * self.length * (x**2 + self.ratio * self._beyond(w) ** 2) / 2.0


@dataclass(frozen=True)
class Ending(TwoScales):
    """``c exp(w/length)``: some pressure at every gap, and a limit."""

    end: float

    @property
    def start(self):
        return -inf

    @property
    def limit(self):
        return self.end

    def _pressure(self, w):
        return self.strength * np.exp(w / self.length)

    def _slope(self, w):
        return self._pressure(w) / self.length

    def _energy(self, w):
        return self._pressure(w) * self.length


@dataclass(frozen=True)
class Softplus(TwoScales):
    """``c ln(1 + exp(w/length))``: some pressure at every gap."""

    @property
    def start(self):
        return -inf

    def _pressure(self, w):
        return self.strength * np.logaddexp(0.0, w / self.length)

    def _slope(self, w):
        return self.strength / self.length / (1.0 + np.exp(-w / self.length))

    def _energy(self, w):
        from scipy.special import spence

        # the dilogarithm: the integral of ln(1 + exp t) up to x is -Li2(-exp x)
        x = w / self.length
        e = np.exp(np.minimum(x, 0.0))
        near = np.where(e < 1e-3, e - e**2 / 4.0 + e**3 / 9.0 - e**4 / 16.0, -spence(1.0 + e))
        far = x**2 / 2.0 + np.pi**2 / 6.0 + spence(1.0 + np.exp(-np.maximum(x, 0.0)))
        return self.strength * self.length * np.where(x < 0.0, near, far)
