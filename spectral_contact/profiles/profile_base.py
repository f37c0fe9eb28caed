r"""What the solver asks of a profile.

With the height ``h`` above the lowest point, a rigid punch asks for the half-integral
``2 delta - H(t)`` of the pressure, with ``H(t) = 2 t int_0^t h'(r) dr / sqrt(t^2 - r^2)``
(docs/theory, profiles).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from math import inf, pi
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from spectral_contact.fields import Array
from spectral_contact.io.checks import lengths
from spectral_contact.io.parameters import check_parameters

#: Radii beyond have squares that overflow.
_FAR = 1e100
#: Distances from the edge, in contact radii, between which the growth of ``H'`` is taken: graded to
#: the edge, and inside as dense as the steepest rise that a `Sampled` resolves asks for (chosen).
_DISTANCES = np.concatenate([np.geomspace(1e-15, 0.009, 53), np.linspace(0.01, 0.99, 197)])
#: The growth of ``H'`` is not taken where it is below this share of its mean (chosen).
_LEAST_RATE = 1e-3


class Profile(ABC):
    """A convex axisymmetric punch. Immutable, comparable, hashable and picklable."""

    __slots__ = ()

    def __post_init__(self) -> None:
        check_parameters(self)

    @property
    def flat_part(self) -> float:
        """Radius of the flat part; the contact is always larger."""
        return 0.0

    @property
    def reach(self) -> float:
        """Radius at which the profile ends; the contact is always smaller."""
        return inf

    @property
    def _pole(self) -> float:
        """Contact radius at which ``H`` is infinite, as that of a sphere is at its equator."""
        return inf

    def _to_pole(self, radius: float) -> float:
        """Return how far `_pole` is beyond a contact radius, relative to this radius."""
        return (self._pole - radius) / radius

    @property
    def pointed(self) -> bool:
        """Whether panels are graded to the centre.

        They have to be where the height is no smooth function of the radius squared there, and
        where the tip is round but may be small beside the contact. It is right for every profile,
        and takes more time.
        """
        return False

    @property
    def breaks(self) -> tuple[float, ...]:
        """Radii, increasing and positive, at which a derivative of the height jumps."""
        return (self.flat_part,) if self.flat_part > 0.0 else ()

    @property
    def brief(self) -> str:
        """Its kind and parameters, in one line."""
        return repr(self)

    def height(self, r: ArrayLike) -> Any:
        """Return the height above the lowest point.

        Parameters
        ----------
        r : array_like
            Radii from 0 to the reach, and to 1e100 at most, any shape.

        Returns
        -------
        float or ndarray
            Infinite beyond the range of a double.

        Raises
        ------
        SceneError
            If a radius is another.
        """
        radii = lengths("r", r, min(self.reach, _FAR)).astype(float)
        with np.errstate(over="ignore"):
            return self._height(radii)[()]

    # the methods below are the solver's: arrays of doubles as they are

    @abstractmethod
    def _height(self, r: Array) -> Array:
        """Return the height at radii of any shape, 0 at the centre."""

    @abstractmethod
    def _transform(self, t: Array) -> Array:
        """Return ``H`` at radii of any shape."""

    @abstractmethod
    def _fall(self, radius: float, t: Array, y: Array, past: Array) -> Array:
        """Return ``H(radius) - H(radius t)`` to relative accuracy.

        Parameters
        ----------
        radius : float
        t, y : ndarray
            Numbers in [0, 1], and ``1 - t**2`` without cancellation.
        past : ndarray
            As in `_rate`, for the radii ``radius t``.
        """

    def _bracket(self, radius: float, t: Array, y: Array, past: Array) -> Array:
        """Return `_fall` over the radius, with all arguments but the radius in units of it."""
        return np.asarray(self._fall(radius, t, y, radius**2 * past) / radius)

    @abstractmethod
    def _rate(self, t: Array, past: Array) -> Array:
        """Return the derivative of ``H``.

        Parameters
        ----------
        t : ndarray
            Radii.
        past : ndarray
            ``t**2 - b**2`` without cancellation, where b is the largest of the breaks below t; 0 if
            there is none.
        """

    def _smooth_pressure_rate(self, radius: float) -> float:
        """Return a bound of ``(dp/dln a)/p`` at constant ``s = r/a``, of a smooth surface.

        The pressure is ``c int_s^1 H'(a t) dt / sqrt(t**2 - s**2)`` with a constant c. So the bound
        is the largest ``(dH'/dt) t/H'``, by which ``H'`` grows in logarithms. It is large next to
        the equator of a sphere, and where the slope rises over a short distance. Where ``H'`` is
        far below its mean, it adds little to a pressure that is compared with its mean. With breaks
        0 is returned: next to a corner there is no bound.
        """
        if self.breaks:
            return 0.0
        t = 1.0 - _DISTANCES
        rates = self._rate(radius * t, np.zeros(len(t)))
        least = _LEAST_RATE * self._transform(np.array(radius)) / radius
        growth = np.diff(np.log(np.maximum(rates, least))) / np.diff(np.log(t))
        return float(np.abs(growth).max())

    def _relative_error(self, radius: float) -> float:
        """Return a bound on the relative error of ``H`` at a radius by that of the slope.

        It is infinite where the error may be as large as ``H`` itself.
        """
        error = pi * radius * self._slope_error(radius)
        if error == 0.0:
            return 0.0
        least = abs(float(self._transform(np.array([radius]))[0])) - error
        return error / least if least > 0.0 else inf

    def _slope_error(self, radius: float) -> float:
        """Return a bound on the error of the slope up to a radius; a formula has none."""
        return 0.0
