"""What the solver asks of a layer: pressure, slope and energy over the overclosure."""

from __future__ import annotations

from abc import ABC, abstractmethod
from math import inf
from typing import Any, Final, NamedTuple, Self

import numpy as np
from numpy.typing import ArrayLike

from spectral_contact.errors import SceneError
from spectral_contact.fields import Array
from spectral_contact.io.checks import real, reals
from spectral_contact.io.parameters import check_parameters

#: Most steps of a bisection: enough to come from any two doubles to neighbouring ones.
_STEPS = 2100
#: The range of parameters whose powers have to stay in that of doubles.
RANGE: Final = "in [1e-100, 1e+100]"


class LawErrors(NamedTuple):
    """Bounds on the errors of a law's values up to an overclosure.

    Those of pressure and energy are absolute, that of the stiffness is relative to its value there.
    """

    pressure: float
    stiffness: float
    energy: float


class Layer(ABC):
    """A law of a rough layer. Immutable, comparable, hashable and picklable."""

    __slots__ = ()

    def __post_init__(self) -> None:
        check_parameters(self)

    @property
    def start(self) -> float:
        """Overclosure at which the pressure begins; minus infinity for laws without an edge."""
        return 0.0

    @property
    def limit(self) -> float:
        """Largest overclosure for which the law is defined."""
        return inf

    @property
    def knots(self) -> tuple[float, ...]:
        """Overclosures, increasing, between start and limit where a derivative jumps."""
        return ()

    @property
    def brief(self) -> str:
        """Its kind and parameters, in one line."""
        return repr(self)

    def pressure(self, overclosure: ArrayLike) -> Any:
        """Return the pressure, in E'.

        Parameters
        ----------
        overclosure : array_like
            Finite, in L, at most `limit`; any shape. Below `start` the pressure is zero.

        Returns
        -------
        float or ndarray
            Infinite beyond the range of a double.

        Raises
        ------
        SceneError
            If an overclosure is another.
        """
        return self._evaluated(self._pressure, overclosure)

    def stiffness(self, overclosure: ArrayLike) -> Any:
        """Return the derivative of the pressure, in E'/L; arguments and errors as `pressure`."""
        return self._evaluated(self._slope, overclosure)

    def overclosure(self, pressure: float) -> float:
        """Return the overclosure of a pressure.

        Parameters
        ----------
        pressure : float
            Positive, in E', and at most that of the `limit`, or of the largest double.

        Raises
        ------
        SceneError
            If it is another.
        """
        most = float(self._pressure(np.array(self.limit))) if self.limit < inf else inf
        allowed = f"finite, and in (0, {most:.6g}]"
        value = real("pressure", pressure, allowed=allowed, low=0.0, high=most, low_open=True)
        return self._overclosure(value)

    def _evaluated(self, law: Any, overclosure: ArrayLike) -> Any:
        allowed = f"finite, and at most {self.limit:.6g}"
        given = np.asarray(reals("overclosure", overclosure, allowed), dtype=float)
        wrong = ~(np.isfinite(given) & (given <= self.limit))
        if wrong.any():
            raise SceneError("overclosure", float(given[wrong][0]), allowed)
        with np.errstate(over="ignore"):
            return law(given)[()]

    def _overclosure(self, pressure: float) -> float:
        """Return the overclosure of a pressure that the law reaches, by bisection."""

        def less(w: float) -> bool:
            with np.errstate(over="ignore"):
                return float(self._pressure(np.array(w))) < pressure

        size = self._size
        low = self.start if self.start > -inf else -size
        step = size
        while not less(low) and self.start == -inf:
            low = low - step
            step = 2.0 * step
        high = max(low, 0.0) + size
        step = size
        while less(high):
            if high == inf:
                raise SceneError("pressure", pressure, "one that the law reaches")
            low = high
            high = high + step
            step = 2.0 * step
        for _ in range(_STEPS):
            middle = 0.5 * (low + high)
            if not low < middle < high:
                break
            low, high = (middle, high) if less(middle) else (low, middle)
        return high

    # the members below are the solver's: arrays of doubles as they are

    @abstractmethod
    def _over(self, unit: float) -> Self:
        """Return the law with all its pressures divided by a unit of pressure.

        `SceneError` is raised if a parameter leaves its range.
        `GreenwoodWilliamson` has its pressure in E' of the half-space, and stays what it is.
        """

    @property
    @abstractmethod
    def _size(self) -> float:
        """An overclosure over which the law changes."""

    @abstractmethod
    def _pressure(self, w: Array) -> Array:
        """Return the pressure, along the tangent beyond the limit; it may be infinite."""

    @abstractmethod
    def _slope(self, w: Array) -> Array:
        """Return its derivative."""

    def _rates(self, w: Array) -> dict[str, Array]:
        """Return the derivatives of the pressure by the logarithms of the law's numbers, if any."""
        return {}

    @abstractmethod
    def _energy(self, w: Array) -> Array:
        """Return its integral from the start on."""

    def _errors(self, w: float) -> LawErrors:
        """Return bounds on the errors of the law up to an overclosure; a formula has none."""
        return LawErrors(0.0, 0.0, 0.0)
