"""Checks of arguments, and the coordinates of a point given from the centre or from the edge."""

import math
import numbers
from typing import Any, NamedTuple

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
        allowed = "one value and one None: give either the distance from the centre or the edge"
        raise refusal("s, from_edge", (s, from_edge), allowed)
    name, values = ("from_edge", from_edge) if s is None else ("s", s)
    given = real_numbers(name, values, "in [0, 1]")
    outside = ~((given >= 0.0) & (given <= 1.0))
    if np.any(outside):
        raise ValueError(f"{name} = {given[outside][0]}: must be in [0, 1]")
    # 1 − x is exact for x ≥ 1/2, so only a small given coordinate has a rounded complement,
    # and that complement, near 1, is still right to relative accuracy.
    radius, edge = (1.0 - given, given) if s is None else (given, 1.0 - given)
    y = np.asarray(edge * (2.0 - edge))
    with np.errstate(divide="ignore"):  # ln 0 = −inf at the edge is meant
        # Where y is near 1, rounding of y would spoil its small logarithm, which is ln(1 − s²).
        log_y = np.where(radius < 0.5, np.log1p(-radius * radius), np.log(y))
    return Position(np.asarray(radius), np.asarray(edge), y, log_y, given.ndim == 0)


def real_numbers(name: str, values: ArrayLike | None, allowed: str) -> Array:
    """Return real numbers as an array of doubles; those with a unit must be dimensionless.

    Raises
    ------
    ValueError
        If they are not numbers, masked, boolean, not of one shape, or have a dimension.
    """
    plain = _without_unit(name, values)
    try:
        given = np.asarray("" if _becomes_a_number(plain) else plain)
    except Exception as error:  # ragged lists, or whatever an object's own __array__ raises
        raise refusal(name, values, f"real numbers {allowed}, of one shape") from error
    if given.dtype.kind not in "fiu":
        raise refusal(name, values, f"real numbers {allowed}, neither masked nor boolean")
    return np.asarray(given, dtype=np.float64)


def check_poisson_ratio(value: float) -> float:
    """Return Poisson's ratio as a float.

    Raises
    ------
    ValueError
        Unless −1 < ν ≤ 1/2, the thermodynamically admissible range.
    """
    number = _real("poisson_ratio", value, "in (-1, 0.5]")
    if not -1.0 < number <= 0.5:
        raise refusal("poisson_ratio", value, "in (-1, 0.5]")
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
        raise refusal("friction", value, allowed)
    return number


def check_positive(name: str, value: float) -> float:
    """Return a number as a float.

    Raises
    ------
    ValueError
        Unless it is finite and positive.
    """
    number = _real(name, value, "finite and > 0")
    if not (math.isfinite(number) and number > 0.0):
        raise refusal(name, value, "finite and > 0")
    return number


def check_compliance(value: float) -> float:
    """Return the normal compliance α of the roughness as a float.

    Raises
    ------
    ValueError
        Unless α is finite and positive.
    """
    return check_positive("normal_compliance", value)


def kappa(poisson_ratio: float) -> float:
    """Return κ = (1 − 2ν) / (4 (1 − ν)), to which all shear of the uncoupled problem scales.

    Raises
    ------
    ValueError
        Unless −1 < ν ≤ 1/2.
    """
    nu = check_poisson_ratio(poisson_ratio)
    return (1.0 - 2.0 * nu) / (4.0 * (1.0 - nu))


def refusal(name: str, value: object, allowed: str) -> ValueError:
    """Return the error that names a parameter, its value on one line, and what is allowed."""
    try:
        text = " ".join(repr(value).split())
    except Exception:  # an int beyond the interpreter's digit limit, or a broken __repr__
        text = f"<{type(value).__name__}>"
    return ValueError(f"{name} = {text:.80}: must be {allowed}")


#: Deepest list that is looked into; NumPy's arrays have at most 64 dimensions.
_DEEPEST = 64


def _without_unit(name: str, values: Any, depth: int = 0) -> Any:
    """Return quantities, of pint for example, as plain numbers, and anything else as it is."""
    if isinstance(values, list | tuple):
        if depth > _DEEPEST:
            raise refusal(name, "a list that is nested too deeply", "numbers")
        return [_without_unit(name, value, depth + 1) for value in values]
    if not (hasattr(type(values), "to") and (hasattr(values, "units") or hasattr(values, "unit"))):
        return values
    try:
        number = values.to("")
        return number.magnitude if hasattr(number, "magnitude") else number.value
    except Exception as error:  # as many as there are packages
        raise refusal(name, values, "without a unit, or dimensionless") from error


def _real(name: str, value: object, allowed: str) -> float:
    value = _without_unit(name, value)
    # timedelta64 is a signed integer to NumPy
    if isinstance(value, bool | np.timedelta64) or not isinstance(value, numbers.Real):
        raise refusal(name, value, f"a real number, {allowed}")
    try:
        return float(value)
    except OverflowError as error:
        raise refusal(name, value, allowed) from error


def _becomes_a_number(values: object) -> bool:
    """Whether NumPy would silently make numbers of masked values, or of booleans among numbers."""
    if isinstance(values, list | tuple):
        return any(map(_becomes_a_number, values))
    return isinstance(values, bool | np.bool_) or np.ma.is_masked(values)
