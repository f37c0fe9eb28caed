"""Checks of the numbers that a user passes in: as the library wants them, or a `SceneError`.

A *real number* here is a Python ``float`` or ``int``, a NumPy floating or integer scalar, or any
other `numbers.Real` (`fractions.Fraction`, ``mpmath.mpf``), rounded to the nearest double.
Booleans, complex numbers, strings, `decimal.Decimal`, and arrays or lists, 0-d arrays included, are
refused: an array where a number belongs is a mistake more often than a wish.

A number with a unit (`io.units`) is converted where the check has a unit, and so is text such as
"5 mm". Where it has none the number must be dimensionless: a percentage is divided by 100.
"""

import math
import numbers
import re
from collections.abc import Callable
from fractions import Fraction
from functools import cache
from typing import Any, Final, NoReturn

import numpy as np
from numpy.typing import ArrayLike, NDArray

from spectral_contact.errors import MissingDependencyError, SceneError
from spectral_contact.io.units import is_quantity, plain_numbers

# bool is an Integral to Python, and timedelta64 a signed integer to NumPy.
_NOT_NUMBERS = (bool, np.timedelta64)
# Narrower than float(), which takes 1_000 and the digits of every script.
_DECIMAL: Final = re.compile(r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)(e[+-]?[0-9]+)?", re.IGNORECASE)
_NO_DECIMAL: Final = re.compile(r"[+-]?(inf|infinity|nan)", re.IGNORECASE)
# The ranges that `within` reads.
_INTERVAL: Final = re.compile(r"in ([\[(])([^][(),]+), ([^][(),]+)([\])])")
_LEAST: Final = re.compile(r"(>=|>) (\S+)")
_INFINITE: Final = re.compile(r"\binf\b")


def real(
    parameter: str,
    value: object,
    *,
    allowed: str,
    low: float = -math.inf,
    high: float = math.inf,
    low_open: bool = False,
    high_open: bool = False,
    infinite_ok: bool = False,
    unit: str = "",
) -> float:
    """Return a real number of an interval as a Python float, −0.0 as 0.0.

    Parameters
    ----------
    parameter : str
        The name that an error bears.
    value : object
        What the user passed.
    allowed : str
        The interval in words, to follow "must be" in an error.
    low, high : float
        The ends of the interval.
    low_open, high_open : bool
        Whether that end itself is refused.
    infinite_ok : bool
        Whether an infinite value is accepted (where it is inside the interval).
    unit : str
        The SI unit of the number, to which a value with a unit is converted.

    Raises
    ------
    SceneError
        If the value is no real number, is NaN, or lies outside; also if rounding makes a finite
        value infinite or a nonzero one zero, because both mean something else.
    """
    number = value if type(value) is float else _nearest_double(parameter, value, allowed, unit)
    if low < number < high:
        return number + 0.0
    inside = (low < number or (number == low and not low_open)) and (
        number < high or (number == high and not high_open)
    )
    if not inside or (math.isinf(number) and not infinite_ok):
        raise SceneError(parameter, value, allowed)
    return number + 0.0


def within(parameter: str, value: object, allowed: str, unit: str = "") -> float:
    """Return a real number of a range that is written as an error has it.

    Parameters
    ----------
    parameter : str
        The name that an error bears.
    value : object
        What the user passed.
    allowed : str
        The range: ``"in (0, 0.5]"``, ``"0 or in [1, 2]"``, ``"finite and > 0"`` or ``">= 0"``.
        Other words may follow. Ends may be fractions, of pi as well. An infinite number is allowed
        if the words name ``inf``.
    unit : str
        The SI unit of the number, to which a value with a unit is converted.

    Raises
    ------
    SceneError
        As `real`.
    """
    bounds = _bounds(allowed)
    low = bounds["low"]
    if not (allowed.startswith("0 or") and low > 0.0):
        return real(parameter, value, allowed=allowed, unit=unit, **bounds)
    number = real(parameter, value, allowed=allowed, unit=unit, **{**bounds, "low": 0.0})
    if 0.0 < number < low:
        raise SceneError(parameter, value, allowed)
    return number


@cache
def _bounds(allowed: str) -> dict[str, Any]:
    """Return the limits that `real` takes for a range in words."""
    found = _INTERVAL.search(allowed)
    bounds: dict[str, Any] = {"infinite_ok": bool(_INFINITE.search(allowed))}
    if found:
        first, low, high, last = found.groups()
        ends = {"low": _end(low), "high": _end(high)}
        return {**bounds, **ends, "low_open": first == "(", "high_open": last == ")"}
    least = _LEAST.search(allowed)
    if least:
        return {**bounds, "low": _end(least[2]), "low_open": least[1] == ">"}
    return {**bounds, "low": -math.inf}


def _end(text: str) -> float:
    """Return the end of an interval: a decimal, a fraction, or one of pi."""
    factor = math.pi if text.startswith("pi") else 1.0
    return factor * float(Fraction(text.replace("pi", "1")))


def decimal_number(text: str) -> float:
    """Return the number that a text writes in decimals; it may be infinite or NaN by name.

    Raises
    ------
    ValueError
        If it is no number, or a double would be infinite or zero instead; its text is to follow
        that of the number.
    """
    if _NO_DECIMAL.fullmatch(text):
        return float(text)
    if not _DECIMAL.fullmatch(text):
        raise ValueError("is not a number")
    value = float(text)
    # whatever the exponent is, a decimal is zero if all digits before the exponent are
    is_zero = not set("123456789") & set(text.lower().partition("e")[0])
    if math.isinf(value) or (value == 0.0) != is_zero:
        raise ValueError("is not within the range of a double")
    return value


def positive(parameter: str, value: object, unit: str = "") -> float:
    """Return a finite real number above 0, in the SI unit."""
    allowed = f"finite and > 0 [{unit}]" if unit else "finite and > 0"
    return within(parameter, value, allowed, unit)


def whole(parameter: str, value: object, low: int, high: float = math.inf) -> int:
    """Return a whole number of a range as a Python int; 20.0 and True are none by type."""
    if isinstance(value, numbers.Integral) and not isinstance(value, _NOT_NUMBERS):
        number = int(value)
        if low <= number <= high:
            return number
    allowed = f">= {low}" if high == math.inf else f"in [{low}, {high:g}]"
    raise SceneError(parameter, value, f"a whole number {allowed}")


def tolerance(rtol: object) -> float:
    """Return the relative tolerance, in [1e-13, 1e-2], as a Python float."""
    return within("rtol", rtol, "in [1e-13, 1e-2]")


def flag(parameter: str, value: object) -> bool:
    """Return a truth value as a Python bool; nothing else will do, as "no" is true, too."""
    if not isinstance(value, (bool, np.bool_)):
        raise SceneError(parameter, value, "True or False")
    return bool(value)


def exactly_one(first: str, first_value: object, second: str, second_value: object) -> None:
    """Check that one of two parameters is given and the other is None; an error names both."""
    if (first_value is None) == (second_value is None):
        raise SceneError(
            f"{first}, {second}",
            (first_value, second_value),
            f"one value and one None: give either {first} or {second}",
        )


def radii(
    s: ArrayLike | None, from_edge: ArrayLike | None
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return radii both from the centre and from the edge, whichever of them was given.

    Parameters
    ----------
    s : array_like or None
        Radii r/a, dimensionless, in [0, 1]; any shape, scalars and empty arrays included.
    from_edge : array_like or None
        Distances from the edge 1 − r/a, dimensionless, in [0, 1]. Near the edge this is the
        accurate way: the values are kept exactly, down to the smallest double.

    Returns
    -------
    s, from_edge : ndarray of float64
        New arrays of the shape given (0-d for a scalar). What was given is unchanged, save that
        −0.0 becomes 0.0; the other is 1 minus it, correctly rounded.
    """
    exactly_one("s", s, "from_edge", from_edge)
    if from_edge is None:
        given = lengths("s", s, 1.0)
        return _as_doubles(given), _as_doubles(1 - given)
    given = lengths("from_edge", from_edge, 1.0)
    return _as_doubles(1 - given), _as_doubles(given)


def lengths(parameter: str, values: Any, high: float, unit: str = "") -> NDArray[np.floating[Any]]:
    """Return values of [0, high] as an array of doubles, or of long doubles if such were given.

    Parameters
    ----------
    parameter : str
        The name that an error bears; it has the first value that lies outside.
    values : array_like
        Any shape.
    high : float
        The largest value allowed.
    unit : str
        Their SI unit.
    """
    allowed = f"in [0, {repr(high).removesuffix('.0')}] {unit}".rstrip()
    array = reals(parameter, values, allowed, low=0.0, high=high, unit=unit)
    with np.errstate(invalid="ignore"):  # NaN compares False, which is what we want of it
        inside = (array >= 0) & (array <= high)
    if not inside.all():
        raise SceneError(parameter, array[~inside][0].item(), allowed)
    return array


def reals(
    parameter: str,
    values: Any,
    allowed: str,
    *,
    low: float = -math.inf,
    high: float = math.inf,
    anything: bool = False,
    unit: str = "",
) -> NDArray[np.floating[Any]]:
    """Return real numbers as an array of doubles, or of long doubles if such were given.

    Parameters
    ----------
    parameter : str
        The name that an error bears.
    values : array_like
        Any shape, not masked.
    allowed : str
        The interval in words, to follow "must be" in an error.
    low, high : float
        The ends of the interval. Only numbers that NumPy does not know (`fractions.Fraction`,
        mpmath's) are compared with them here; the caller does it with all others.
    anything : bool
        Whether numbers that NumPy does not know may be infinite, NaN or out of the interval, as all
        others may.
    unit : str
        Their SI unit, to which values with a unit are converted.
    """
    try:
        plain = plain_numbers(parameter, values, unit)
        array = None if _becomes_a_number(plain) else np.asarray(plain)
    except (SceneError, MissingDependencyError):  # of a unit
        raise
    except Exception as error:  # ragged lists, or whatever an object's own __array__ raises
        raise SceneError(parameter, values, f"real numbers {allowed}, of one shape") from error
    if array is None:
        _refuse_type(parameter, values, f"{allowed}, neither masked nor boolean")
    if array.dtype.kind == "O":
        # Fractions, mpf and integers beyond 64 bits; anything else is refused by name.
        limits: dict[str, Any] = {"allowed": allowed, "low": low, "high": high}
        doubles = [
            _nearest_double(parameter, value, allowed, unit)
            if anything
            else real(parameter, value, unit=unit, **limits)
            for value in array.flat
        ]
        return np.array(doubles, dtype=np.float64).reshape(array.shape)
    if array.dtype.kind not in "fiu":
        _refuse_type(parameter, values, allowed)
    return array.astype(np.promote_types(array.dtype, np.float64), copy=False)


def finite(
    parameter: str, values: Any, *, one_will_do: bool = False, unit: str = ""
) -> NDArray[np.float64]:
    """Return a list of finite numbers as an array of doubles.

    Parameters
    ----------
    parameter : str
        The name that an error bears.
    values : array_like
        With one dimension, not masked.
    one_will_do : bool
        Whether a number stands for a list of one.
    unit : str
        Their SI unit, to which values with a unit are converted.
    """
    given = reals(parameter, values, "finite", unit=unit)
    if one_will_do and given.ndim == 0:
        given = given[None]
    if given.ndim != 1:
        raise SceneError(parameter, values, "a list of numbers")
    with np.errstate(over="ignore"):  # a long double may be beyond the doubles
        array = _as_doubles(given)
    if not np.isfinite(array).all():
        raise SceneError(parameter, given[~np.isfinite(array)][0], "finite")
    return array


def scalar(parameter: str, value: object) -> float:
    """Return one real number that something else has computed; it may be infinite or NaN."""
    number = reals(parameter, value, "one", anything=True)
    if number.ndim:
        raise SceneError(parameter, value, "one real number")
    with np.errstate(over="ignore"):  # a long double may be beyond the doubles
        return float(number)


def values_at(parameter: str, field: Callable[..., Any], places: NDArray[Any]) -> NDArray[Any]:
    """Return what a user's function says at many places, as doubles; they may be infinite or NaN.

    It is one real number for each place, or one for all.
    """
    values = reals(parameter, field(places), "for each place", anything=True)
    if values.shape not in ((), places.shape):
        raise SceneError(parameter, values, f"{places.size} values, one for each place")
    with np.errstate(over="ignore"):  # a long double may be beyond the doubles
        return _as_doubles(np.broadcast_to(values, places.shape))


def _becomes_a_number(values: Any) -> bool:
    """Whether NumPy would silently make numbers of masked values, or of booleans among numbers."""
    if isinstance(values, (list, tuple)):
        return any(map(_becomes_a_number, values))
    return isinstance(values, (bool, np.bool_)) or np.ma.is_masked(values)


def _as_doubles(array: NDArray[np.floating[Any]]) -> NDArray[np.float64]:
    # Adding 0.0 turns −0.0 into 0.0 and makes the copy that keeps the user's array out of ours;
    # asarray undoes NumPy's habit of returning scalars for 0-d arrays.
    return np.asarray(array + 0.0, dtype=np.float64)


def _nearest_double(parameter: str, value: object, allowed: str, unit: str) -> float:
    given = value
    if is_quantity(value) or (unit and isinstance(value, str)):
        value = plain_numbers(parameter, value, unit)
    if not isinstance(value, numbers.Real) or isinstance(value, _NOT_NUMBERS):
        _refuse_type(parameter, given, allowed)
    try:
        number = float(value)
    except (OverflowError, TypeError, ValueError) as error:
        raise SceneError(parameter, given, allowed) from error
    if (number == 0 or math.isinf(number)) and value != number:
        raise SceneError(parameter, given, f"{allowed}, and within the range of a double")
    return number


def _refuse_type(parameter: str, value: object, allowed: str) -> NoReturn:
    raise SceneError(parameter, value, f"a real number, {allowed}")
