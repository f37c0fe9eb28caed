"""Laws of layers in mpmath, with their derivatives and integrals.

They are written anew from the definitions: no digit comes from `layers`, which is in double
precision. An overclosure `w` is counted from that at which the pressure begins; from 0 if there is
pressure at every gap. Pressures are over E' = E/(4 (1 - nu**2)), which is E*/4.
"""

from __future__ import annotations

from math import inf
from typing import Any

from spectral_contact import layers
from spectral_contact.errors import NotComputedError
from spectral_contact.layers import Layer
from spectral_contact.layers.scene_layer import is_user_law


class Law:
    """A law to many digits.

    Parameters
    ----------
    mp : MPContext
    layer : Layer

    Attributes
    ----------
    origin : mpf
        Overclosure from which `w` is counted.
    gapless : bool
        Whether there is pressure at every gap.
    """

    def __init__(self, mp: Any, layer: Layer) -> None:
        self.mp = mp
        self.gapless = layer.start == -inf
        self.origin = mp.zero if self.gapless else mp.mpf(layer.start)

    def pressure(self, w: Any) -> Any:
        """Return the pressure."""
        raise NotImplementedError

    def slope(self, w: Any) -> Any:
        """Return the derivative of the pressure."""
        raise NotImplementedError

    def energy(self, w: Any) -> Any:
        """Return the integral of the pressure over all overclosures up to w."""
        raise NotImplementedError


class _Power(Law):
    """``C w^m``."""

    def __init__(self, mp: Any, layer: Layer, coefficient: Any, exponent: Any) -> None:
        super().__init__(mp, layer)
        self._factor = coefficient
        self._power = mp.mpf(exponent)

    def pressure(self, w: Any) -> Any:
        return self._factor * max(w, 0) ** self._power

    def slope(self, w: Any) -> Any:
        if w < 0:
            return self.mp.zero
        return self._factor * self._power * w ** (self._power - 1)

    def energy(self, w: Any) -> Any:
        more = self._power + 1
        return self._factor / more * max(w, 0) ** more


class _Abaqus(Law):
    """``p0 x (e^x - 1)/(e - 1)`` with ``x = w/c0``."""

    def __init__(self, mp: Any, layer: layers.Exponential) -> None:
        super().__init__(mp, layer)
        self._unit = mp.mpf(layer.zero_pressure) / (mp.e - 1)
        self._size = mp.mpf(layer.clearance)

    def pressure(self, w: Any) -> Any:
        x = max(w, 0) / self._size
        return self._unit * x * self.mp.expm1(x)

    def slope(self, w: Any) -> Any:
        x = max(w, 0) / self._size
        return self._unit / self._size * (self.mp.expm1(x) + x * self.mp.exp(x))

    def energy(self, w: Any) -> Any:
        mp = self.mp
        x = max(w, 0) / self._size
        # it is about x^3/3 for small x, which is little of its terms
        with mp.extraprec(3 * max(-mp.mag(x), 0) + 10 if x else 0):
            integral = (x - 1) * mp.exp(x) + 1 - x**2 / 2
        return self._unit * self._size * integral


class _Calculix(Law):
    """``p0 exp(ln(100) w/c0)``."""

    def __init__(self, mp: Any, layer: layers.CalculixExponential) -> None:
        super().__init__(mp, layer)
        self._unit = mp.mpf(layer.zero_pressure)
        self._rate = mp.log(100) / mp.mpf(layer.clearance)

    def pressure(self, w: Any) -> Any:
        return self._unit * self.mp.exp(self._rate * w)

    def slope(self, w: Any) -> Any:
        return self._rate * self.pressure(w)

    def energy(self, w: Any) -> Any:
        return self.pressure(w) / self._rate


class _Asperities(Law):
    """Greenwood and Williamson's law: moments of the asperities above the separation ``-w``."""

    def __init__(self, mp: Any, layer: layers.GreenwoodWilliamson) -> None:
        super().__init__(mp, layer)
        self._size = mp.mpf(layer.height_deviation)
        self._gaussian = layer.heights == "gaussian"
        density = mp.mpf(layer.density)
        tip = mp.mpf(layer.tip_radius)
        # Hertz's 4/3 E* sqrt(tip) of one asperity, in E': E* is 4 E'
        self._unit = density * mp.sqrt(tip) * 16 / 3 * self._size ** (mp.mpf(3) / 2)

    def _moment(self, w: Any, order: int) -> Any:
        """Return ``int_h^inf (z - h)^(order/2) phi(z) dz``, with ``h = -w/deviation``."""
        mp = self.mp
        h = -w / self._size
        power = self.mp.mpf(order) / 2
        if self._gaussian:  # a parabolic cylinder function
            scale = mp.gamma(power + 1) / mp.sqrt(2 * mp.pi)
            return scale * mp.exp(-h * h / 4) * mp.pcfd(-power - 1, h)
        if h >= 0:
            return mp.gamma(power + 1) * mp.exp(-h)
        return mp.exp(-h) * mp.gammainc(power + 1, -h)

    def pressure(self, w: Any) -> Any:
        return self._unit * self._moment(w, 3)

    def slope(self, w: Any) -> Any:
        return self._unit * 3 / (2 * self._size) * self._moment(w, 1)

    def energy(self, w: Any) -> Any:
        return self._unit * 2 * self._size / 5 * self._moment(w, 5)


class _SeriesLaw(Law):
    """A Chebyshev series between two overclosures."""

    def __init__(self, mp: Any, layer: layers.Sampled) -> None:
        super().__init__(mp, layer)
        self._half = (mp.mpf(layer.edges[1]) - self.origin) / 2
        self._terms = [mp.mpf(one) for one in layer.series[0]]

    def _sum(self, w: Any, function: Any) -> Any:
        """Return the sum of the terms times functions of the order and of w, scaled to [-1, 1]."""
        local = w / self._half - 1
        return sum(term * function(n, local) for n, term in enumerate(self._terms))

    def pressure(self, w: Any) -> Any:
        return self._sum(w, self.mp.chebyt)

    def slope(self, w: Any) -> Any:
        mp = self.mp
        return self._sum(w, lambda n, x: n * mp.chebyu(n - 1, x) if n else mp.zero) / self._half

    def energy(self, w: Any) -> Any:
        mp = self.mp

        def integral(n: int, x: Any) -> Any:
            if n < 2:
                return x ** (n + 1) / (n + 1)
            return (mp.chebyt(n + 1, x) / (n + 1) - mp.chebyt(n - 1, x) / (n - 1)) / 2

        return self._half * self._sum(w, lambda n, x: integral(n, x) - integral(n, -mp.one))


def law_of(mp: Any, layer: Layer) -> Law:
    """Return a law to many digits.

    Raises
    ------
    NotComputedError
        If the law has bends, is written by a user, or has no form to many digits here.
    """
    if is_user_law(layer):
        told = "laws that users write are not solved to so many digits"
        raise NotComputedError("the reference", told)
    if isinstance(layer, layers.Linear):
        return _Power(mp, layer, 1 / mp.mpf(layer.compliance), 1)
    if isinstance(layer, layers.PowerLaw):
        return _Power(mp, layer, mp.mpf(layer.coefficient), layer.exponent)
    if isinstance(layer, layers.Exponential):
        return _Abaqus(mp, layer)
    if isinstance(layer, layers.CalculixExponential):
        return _Calculix(mp, layer)
    if isinstance(layer, layers.GreenwoodWilliamson):
        return _Asperities(mp, layer)
    if layer.knots:
        raise NotComputedError("the reference", "laws with bends are not solved to so many digits")
    if isinstance(layer, layers.Sampled):
        return _SeriesLaw(mp, layer)
    told = f"{type(layer).__name__} has no form to so many digits"
    raise NotComputedError("the reference", told)
