"""Laws in closed form."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from math import e, inf, log
from typing import Self

import numpy as np

from spectral_contact.fields import Array
from spectral_contact.io.parameters import declared
from spectral_contact.layers.layer_base import RANGE, Layer

#: Exponentials of more leave the range of doubles.
_HIGHEST = 700.0
#: Pressure at the gap that is CalculiX' parameter, over that at overclosure 0.
_SHARE = 0.01
#: Below this x the energy of `Exponential` is summed as a series, as its closed form cancels; and
#: the power of x before which the sum ends.
_SMALL = 0.5
_TERMS = 18
_ZERO_PRESSURE = declared("pressure at overclosure 0", RANGE, "Pa")


@dataclass(frozen=True, slots=True)
class Linear(Layer):
    """The linear layer ``p = w / compliance``, the same as ``normal_compliance`` of a scene.

    Parameters
    ----------
    compliance : float
        ``α* = αE'/L``, in [1e-100, 1e100].

    Raises
    ------
    SceneError
        If it is not.
    """

    compliance: float = field(metadata=declared("overclosure over pressure", RANGE, "m/Pa"))

    def _over(self, unit: float) -> Self:
        return replace(self, compliance=self.compliance * unit)

    @property
    def _size(self) -> float:
        return self.compliance

    def _pressure(self, w: Array) -> Array:
        return np.maximum(w, 0.0) / self.compliance

    def _slope(self, w: Array) -> Array:
        return np.where(w >= 0.0, 1.0 / self.compliance, 0.0)

    def _rates(self, w: Array) -> dict[str, Array]:
        return {"compliance": -self._pressure(w)}

    def _energy(self, w: Array) -> Array:
        return np.maximum(w, 0.0) ** 2 / (2.0 * self.compliance)


@dataclass(frozen=True, slots=True)
class PowerLaw(Layer):
    """The power law ``p = coefficient w**exponent``.

    Parameters
    ----------
    coefficient : float
        In E'/L**exponent, in [1e-100, 1e100].
    exponent : float
        In [1, 10].

    Raises
    ------
    SceneError
        If a parameter is out of its range.
    """

    coefficient: float = field(
        metadata=declared("pressure at overclosure 1", RANGE, "Pa/m^exponent")
    )
    # below 1 the layer softens under pressure; beyond 10 it is as good as rigid at one overclosure
    exponent: float = field(metadata=declared("exponent", "in [1, 10]"))

    def _over(self, unit: float) -> Self:
        return replace(self, coefficient=self.coefficient / unit)

    @property
    def _size(self) -> float:
        return float(self.coefficient ** (-1.0 / self.exponent))

    def _pressure(self, w: Array) -> Array:
        return np.asarray(self.coefficient * np.maximum(w, 0.0) ** self.exponent)

    def _slope(self, w: Array) -> Array:
        grown = np.maximum(w, 0.0) ** (self.exponent - 1.0)
        return np.where(w >= 0.0, self.coefficient * self.exponent * grown, 0.0)

    def _rates(self, w: Array) -> dict[str, Array]:
        p = self._pressure(w)
        grown = self.exponent * np.log(np.where(p > 0.0, w, 1.0))
        return {"coefficient": p, "exponent": p * grown}

    def _energy(self, w: Array) -> Array:
        more = self.exponent + 1.0
        return np.asarray(self.coefficient / more * np.maximum(w, 0.0) ** more)


@dataclass(frozen=True, slots=True)
class Exponential(Layer):
    """Abaqus' exponential law, without pressure where the gap is more than `clearance`.

    With ``x = 1 + w/clearance`` it is ``p = zero_pressure x (exp(x) - 1)/(e - 1)`` where x > 0.

    Parameters
    ----------
    zero_pressure : float
        p₀, that at zero overclosure, in E'; in [1e-100, 1e100].
    clearance : float
        c₀, that at which the pressure begins, in L; in [1e-100, 1e100].

    Raises
    ------
    SceneError
        If a parameter is out of its range.
    """

    zero_pressure: float = field(metadata=_ZERO_PRESSURE)
    clearance: float = field(metadata=declared("gap at which the pressure begins", RANGE, "m"))

    def _over(self, unit: float) -> Self:
        return replace(self, zero_pressure=self.zero_pressure / unit)

    @property
    def start(self) -> float:
        """Overclosure at which the pressure begins."""
        return -self.clearance

    @property
    def _size(self) -> float:
        return self.clearance

    @property
    def _unit(self) -> float:
        return self.zero_pressure / (e - 1.0)

    def _place(self, w: Array) -> Array:
        return np.clip(1.0 + w / self.clearance, 0.0, _HIGHEST)

    def _pressure(self, w: Array) -> Array:
        x = self._place(w)
        return np.asarray(self._unit * x * np.expm1(x))

    def _slope(self, w: Array) -> Array:
        x = self._place(w)
        return np.asarray(self._unit / self.clearance * (np.expm1(x) + x * np.exp(x)))

    def _rates(self, w: Array) -> dict[str, Array]:
        return {"zero_pressure": self._pressure(w), "clearance": -w * self._slope(w)}

    def _energy(self, w: Array) -> Array:
        x = self._place(w)
        small = x < _SMALL
        # (x - 1) e^x + 1 - x^2/2 = sum over n > 2 of x^n/n! (n - 1)
        near = np.where(small, x, 0.0)
        term = near**2 / 2.0
        series = np.zeros(np.shape(x))
        for n in range(3, _TERMS):
            term = term * near / n
            series = series + (n - 1.0) * term
        whole = (x - 1.0) * np.exp(x) + 1.0 - x**2 / 2.0
        return np.asarray(self._unit * self.clearance * np.where(small, series, whole))


@dataclass(frozen=True, slots=True)
class CalculixExponential(Layer):
    """CalculiX' exponential law ``p = zero_pressure exp(ln(100) w/clearance)``, at any gap.

    Parameters
    ----------
    zero_pressure : float
        p₀, that at zero overclosure, in E'; in [1e-100, 1e100].
    clearance : float
        c₀, that at which one hundredth of it is left, in L; in [1e-100, 1e100].

    Raises
    ------
    SceneError
        If a parameter is out of its range.
    """

    zero_pressure: float = field(metadata=_ZERO_PRESSURE)
    clearance: float = field(
        metadata=declared("gap at which a hundredth of that is left", RANGE, "m")
    )

    def _over(self, unit: float) -> Self:
        return replace(self, zero_pressure=self.zero_pressure / unit)

    @property
    def start(self) -> float:
        """Minus infinity, as there is pressure at every gap."""
        return -inf

    @property
    def _size(self) -> float:
        return self.clearance / -log(_SHARE)

    def _pressure(self, w: Array) -> Array:
        return np.asarray(self.zero_pressure * np.exp(np.minimum(w / self._size, _HIGHEST)))

    def _slope(self, w: Array) -> Array:
        return self._pressure(w) / self._size

    def _rates(self, w: Array) -> dict[str, Array]:
        return {"zero_pressure": self._pressure(w), "clearance": -w * self._slope(w)}

    def _energy(self, w: Array) -> Array:
        return self._pressure(w) * self._size
