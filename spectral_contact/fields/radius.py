"""A radius in the contact, with its distance from the edge."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Radius:
    """A radius over that of the contact, and its distance from the edge.

    Both are accurate to rounding. Next to the edge 1 - b, taken from a rounded b, would not be.

    Attributes
    ----------
    value, from_edge : float
        ``b`` and ``1 - b``.
    """

    value: float
    from_edge: float

    @classmethod
    def from_logit(cls, logit: float) -> Radius:
        """Return the radius with ``ln(b**2 / (1 - b**2)) = logit``."""
        # numbers in the ratio of b**2 to 1 - b**2, the larger of them 1
        inside = float(np.exp(min(logit, 0.0)))
        outside = float(np.exp(min(-logit, 0.0)))
        total = inside + outside
        value = float(np.sqrt(inside / total))
        return cls(value, outside / total / (1.0 + value))

    @property
    def square(self) -> float:
        """Return ``b**2`` as the product b b, which is what `below` returns at the centre.

        The quotient of the two must be 1 at the centre, so they must be equal to the last bit, and
        ``self.value**2`` is one ulp off now and then.
        """
        return self.value * self.value

    @property
    def rest(self) -> float:
        """Return ``1 - b**2`` without cancellation."""
        return self.from_edge * (1.0 + self.value)

    @property
    def log(self) -> float:
        """Return ``ln b``, accurate to rounding also where b is close to 1."""
        return float(np.log(self.value) if self.value < 0.5 else np.log1p(-self.from_edge))

    @property
    def logit(self) -> float:
        """Return ``ln(b**2 / (1 - b**2))``."""
        return 2.0 * float(np.log(self.value)) - float(np.log(self.rest))

    def below(self, s: Array, from_edge: Array) -> Array:
        """Return ``b**2 - s**2``, as accurate as the arguments are.

        Parameters
        ----------
        s, from_edge : ndarray
            Radii, and their distances from the edge.
        """
        gap = np.where(s >= 0.5, from_edge - self.from_edge, self.value - s)
        return np.asarray(gap * (self.value + s))


CENTRE = Radius(0.0, 1.0)
EDGE = Radius(1.0, 0.0)
