"""A stretch of the history of a growing contact: flat punches, and what is between them."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from spectral_contact.fields.series import Radius
from spectral_contact.solution import Solution
from spectral_contact.solving.nodes import (
    COUNT,
    NODES,
    chebyshev_value,
    interpolation_weights,
    left_out,
    slope,
)
from spectral_contact.solving.weights import Weights
from spectral_contact.spectral.jacobi import gauss_rule
from spectral_contact.threads import cached_property

__all__ = ["Panel", "stage_logs"]

Array = NDArray[np.float64]

#: Where the convergence of the fields over the radius is looked at, in the stuck disk.
_LOOKS: Array = np.array([0.1, 0.5, 0.8, 0.95, 0.999])
#: The same where it slips, over ``1 - s**2`` from the edge to the stick radius.
_SLIPPING_LOOKS: Array = np.array([0.01, 0.2, 0.5, 0.8])
#: Below the range of doubles.
_TINY = 1e-300
#: Fields go with the rate of the load, which an interpolant has less well: 2.4 times so in one of
#: 50 random scenes, less in all others.
_OF_RATE = 4.0


@dataclass(frozen=True)
class Panel:
    """Stages at Chebyshev points between two radii.

    Attributes
    ----------
    low, high : float
        Logarithms of the radii.
    weights : Weights
        Loads and approaches.
    flats : tuple of Solution
    fields : tuple of str
        Those that are superposed.
    """

    low: float
    high: float
    weights: Weights
    flats: tuple[Solution, ...]
    fields: tuple[str, ...]

    def local(self, u: Array) -> Array:
        """Return the places in [-1, 1]."""
        share = (u - self.low) / (self.high - self.low)
        return np.asarray(np.clip(2.0 * share - 1.0, -1.0, 1.0), dtype=np.float64)

    @property
    def logs(self) -> Array:
        """``ln b`` of the stages."""
        return stage_logs(self.low, self.high)

    @cached_property
    def slips(self) -> bool:
        """Whether there is slip; next to its onset it may be too narrow to be found."""
        return any(len(one.zones) > 1 for one in self.flats)

    @cached_property
    def stick(self) -> Array:
        """``ln c*`` of the stages."""
        return np.array([math.log(_stick_radius(one).value) for one in self.flats])

    @cached_property
    def shears(self) -> Array:
        """``Q*`` of the stages."""
        return np.array([one.total_shear for one in self.flats])

    def load(self, t: Array) -> Array:
        """Return ``P``."""
        return np.asarray(np.exp(chebyshev_value(self.weights.loads, t)))

    def increment(self, t: Array) -> Array:
        """Return ``dP/du``."""
        return self.load(t) * self.rate(self.weights.loads, t)

    def rate(self, values: Array, t: Array) -> Array:
        """Return the derivative in ``u`` of what has these values in the stages."""
        return slope(values, t) * 2.0 / (self.high - self.low)

    def log_stick(self, t: Array) -> Array:
        """Return ``ln c*``."""
        return chebyshev_value(self.stick, t)

    def integral(self, rates: Callable[[Array], Array]) -> float:
        """Return an integral over ``u`` of what is given at places in [-1, 1]."""
        g, w = gauss_rule(2 * COUNT)
        return (self.high - self.low) / 2.0 * float(w @ rates(g))

    def where_stuck(self, name: str, t: Array, d: Array) -> Array:
        """Return a flat punch's field where it sticks, at ``1 - (s/c*)**2 = d``."""
        inside = np.sqrt(1.0 - d)

        def value(one: Solution) -> Array:
            c = _stick_radius(one)
            return _field(one, name, c.value * inside, c.from_edge + c.value * d / (1.0 + inside))

        return self._interpolated(value, t)

    def where_slipping(self, name: str, t: Array, y: Array) -> Array:
        """Return a flat punch's field where it slips, at ``1 - s**2 = y``."""
        width = -np.expm1(2.0 * self.log_stick(t))
        return self._at_share(name, t, y / np.maximum(width, np.maximum(y, _TINY)))

    def _at_share(self, name: str, t: Array, share: Array) -> Array:
        """Return a field at places between the edge and the stick radius, as ``1 - s**2`` goes.

        All stages are seen in their slip zones, in which fields are smooth.
        """

        def value(one: Solution) -> Array:
            y = share * _stick_radius(one).rest
            s = np.sqrt(1.0 - y)
            return _field(one, name, s, y / (1.0 + s))

        return self._interpolated(value, t)

    def _interpolated(self, value: Callable[[Solution], Array], t: Array) -> Array:
        first = self.flats[0]
        if all(one is first for one in self.flats):  # as on a smooth surface
            return value(first)
        found = np.zeros(len(t))
        for weight, one in zip(interpolation_weights(t).T, self.flats, strict=True):
            found += weight * value(one)
        return found

    @cached_property
    def shear_error(self) -> float:
        """How much the interpolants of load and shear leave out, relative to the largest shear."""
        size = max(float(np.abs(self.shears).max()), _TINY)
        of_loads = max(self.weights.error, left_out(self.weights.loads))
        return float(max(of_loads, left_out(self.shears) / size))

    @cached_property
    def error(self) -> float:
        """The same of everything, relative to the largest of what is interpolated."""
        of_stick = left_out(self.stick) if self.slips else 0.0
        of_rate = _OF_RATE * self.shear_error
        return max(of_rate, of_stick, *(self._field_error(one) for one in self.fields))

    @cached_property
    def slips_by(self) -> Array:
        """The slip of the stages at some places, (stages, places)."""
        looks = _SLIPPING_LOOKS
        every = [self._at_share("slip", np.full(len(looks), t), looks) for t in NODES.tolist()]
        return np.array(every)

    @cached_property
    def slip_error(self) -> float:
        """Estimate of the error of what the panel adds to the slip, in its own unit."""
        if not self.slips:
            return 0.0
        largest = np.abs(self.slips_by).max(axis=1)
        known = np.array([one.error.slip or 0.0 for one in self.flats])
        # just past the onset no digit is known of slip that is small on its panel
        of_flats = np.where(known <= 1.0, largest * np.minimum(known, 1.0), largest.max())
        # places move with the stick radius
        moved = left_out(self.stick) * 2.0 / np.maximum(np.expm1(-2.0 * self.stick), _TINY)
        left = max(left_out(column) for column in self.slips_by.T)
        gained = self.integral(
            lambda t: self.increment(t) * np.exp((self.low - self.high) * (1.0 + t) / 2.0)
        )
        # by parts: what the load lacks counts against all of it
        lacking = 2.0 * left_out(self.weights.loads) * float(self.load(np.ones(1))[0])
        of_fields = gained * (left + (of_flats + largest * moved).max())
        return float(of_fields + lacking * largest.max()) * math.exp(-self.low)

    def _field_error(self, name: str) -> float:
        d = 1.0 - _LOOKS**2
        values = np.array([self.where_stuck(name, np.full(len(d), t), d) for t in NODES.tolist()])
        size = max(float(np.abs(values).max()), _TINY)
        return max(left_out(column) for column in values.T) / size


def stage_logs(low: float, high: float) -> Array:
    """Return the logarithms of the radii of the stages between two."""
    return np.asarray(low + (high - low) * (1.0 + NODES) / 2.0)


def _stick_radius(flat: Solution) -> Radius:
    zone = flat.zones[0]
    return Radius(zone.outer, zone.outer_from_edge)


def _field(flat: Solution, name: str, s: Array, from_edge: Array) -> Array:
    field = getattr(flat, f"{name}_field")
    return np.zeros(len(s)) if field is None else np.asarray(field(s, from_edge))
