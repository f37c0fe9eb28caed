"""Checks of arguments, and the coordinates of a point given from the centre or from the edge."""

import math
import numbers
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
Values = float | NDArray[np.float64]


class Position(NamedTuple):
    """Points of the contact disk, each coordinate to its own relative accuracy.

    Attributes
    ----------
    s, d : ndarray
        Distance from the centre and distance from the edge, d = 1 − s.
    y : ndarray
        Edge coordinate 1 − s² = d (2 − d).
    log_y : ndarray
        ln y; −inf at the edge.
    is_scalar : bool
        Whether the caller gave a scalar and expects a float.
    """

    s: Array
    d: Array
    y: Array
    log_y: Array
    is_scalar: bool

    def output(self, values: Array) -> Values:
        """Values in the shape the caller's argument had: a float for a scalar."""
        return float(values[()]) if self.is_scalar else values


def position(s: ArrayLike | None, from_edge: ArrayLike | None) -> Position:
    """Return all coordinates of the points given by exactly one of `s` and `from_edge`.

    Raises
    ------
    ValueError
        If both or none is given, or if a value lies outside [0, 1] or is not a number.
    """
    if (s is None) == (from_edge is None):
        raise ValueError(
            f"s, from_edge = {s!r}, {from_edge!r}: must be one value and one None: give either "
            "the distance from the centre or the distance from the edge"
        )
    name = "from_edge" if s is None else "s"
    given = np.asarray(from_edge if s is None else s)
    if given.dtype.kind not in "fiu":
        raise ValueError(f"{name} = {given!r}: must be real numbers in [0, 1]")
    given = np.asarray(given, dtype=np.float64)
    outside = ~((given >= 0.0) & (given <= 1.0))
    if np.any(outside):
        raise ValueError(f"{name} = {given[outside][0]}: must be in [0, 1]")
    # 1 − x is exact for x ≥ 1/2, so only a small given coordinate has a rounded complement,
    # and that complement, near 1, is still right to relative accuracy.
    radius, edge = (1.0 - given, given) if s is None else (given, 1.0 - given)
    y = np.asarray(edge * (2.0 - edge))
    with np.errstate(divide="ignore"):  # ln 0 = −inf at the edge is meant
        # Where y is near 1 its logarithm is small, and only −s² still knows its digits.
        log_y = np.where(radius < 0.5, np.log1p(-radius * radius), np.log(y))
    return Position(np.asarray(radius), np.asarray(edge), y, log_y, given.ndim == 0)


def check_poisson_ratio(value: float) -> float:
    """Return Poisson's ratio as a float.

    Raises
    ------
    ValueError
        Unless −1 < ν ≤ 1/2, the thermodynamically admissible range.
    """
    number = _real("poisson_ratio", value, "in (-1, 0.5]")
    if not -1.0 < number <= 0.5:
        raise ValueError(f"poisson_ratio = {value!r}: must be in (-1, 0.5]")
    return number


def check_friction(value: float) -> float:
    """Return Coulomb's coefficient f as a float; infinity is full stick.

    Raises
    ------
    ValueError
        Unless f ≥ 0.
    """
    allowed = ">= 0 (math.inf is full stick)"
    number = _real("friction", value, allowed)
    if not number >= 0.0:
        raise ValueError(f"friction = {value!r}: must be {allowed}")
    return number


def check_compliance(value: float) -> float:
    """Return the normal compliance α of the roughness as a float.

    Raises
    ------
    ValueError
        Unless α is finite and positive.
    """
    number = _real("normal_compliance", value, "finite and > 0")
    if not (math.isfinite(number) and number > 0.0):
        raise ValueError(f"normal_compliance = {value!r}: must be finite and > 0")
    return number


def kappa(poisson_ratio: float) -> float:
    """Return κ = (1 − 2ν) / (4 (1 − ν)), to which all shear of the uncoupled problem scales.

    Raises
    ------
    ValueError
        Unless −1 < ν ≤ 1/2.
    """
    nu = check_poisson_ratio(poisson_ratio)
    return (1.0 - 2.0 * nu) / (4.0 * (1.0 - nu))


def _real(name: str, value: object, allowed: str) -> float:
    if isinstance(value, bool) or not isinstance(value, numbers.Real):
        raise ValueError(f"{name} = {value!r}: must be a real number, {allowed}")
    return float(value)
