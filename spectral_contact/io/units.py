"""Values with units: text such as ``"210 GPa"``, and quantities, as numbers in SI units.

Quantities are those of pint, astropy and unyt, single ones and arrays.

pint is an extra, and imported when a unit has to be understood, not before.
"""

from __future__ import annotations

import re
from fractions import Fraction
from functools import cache
from typing import Any, Final, Protocol

import numpy as np

from spectral_contact.errors import MissingDependencyError, SceneError, optional


class Quantity(Protocol):
    """What is used of a quantity of pint."""

    @property
    def magnitude(self) -> Any:
        """The number."""

    def to(self, other: Any, /) -> Any:
        """Return it in another unit."""


#: A number in SI units, text with a unit, or a quantity of pint.
Measured = float | str | Quantity

_LONGEST: Final = 80
_NUMBER: Final = r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?"
# Narrower than pint's grammar, in which an exponent may take for ever to compute. Both letters of
# micro, and both of the ångström, are in use.
_SYMBOL: Final = r"(?:[A-Za-zµμÅ\u212b]+|%|°)"
_TERM: Final = rf"{_SYMBOL}(?:(?:\*\*|\^)-?[0-9]|⁻?[⁰¹²³⁴⁵⁶⁷⁸⁹])?"
_PLAIN: Final = re.compile(rf"\s*{_NUMBER}\s*")
_TEXT: Final = re.compile(rf"\s*({_NUMBER})\s*({_TERM}(?:\s*[*/·⋅\s]\s*{_TERM})*)\s*")


def has_unit(value: object) -> bool:
    """Return whether this is text that has the form of a number and a unit."""
    return isinstance(value, str) and len(value) <= _LONGEST and bool(_TEXT.fullmatch(value))


def is_quantity(value: object) -> bool:
    """Return whether this is a number or an array with a unit, of pint, astropy or unyt."""
    if not hasattr(type(value), "to"):
        return False
    return hasattr(value, "units") or hasattr(value, "unit")


def in_si(parameter: str, value: Any, unit: str) -> Any:
    """Return a value with a unit as a number in SI units, and anything else as it is.

    Parameters
    ----------
    parameter : str
        The name of the parameter, for the error.
    value : object
        Text is converted exactly, if pint is installed; a quantity by its own registry. It may be
        an array.
    unit : str
        The SI unit.

    Raises
    ------
    SceneError
        If it has a unit of another dimension, or is text that is no number with a unit.
    MissingDependencyError
        If text has a unit and pint is not installed.
    """
    if isinstance(value, str) and not has_unit(value) and not _PLAIN.fullmatch(value):
        told = f"a number in {unit}, or text of a number and a unit, as '1 {unit}'"
        raise SceneError(parameter, value, told)
    if not has_unit(value) and not is_quantity(value):
        return value
    try:
        return _converted(value, unit)
    except MissingDependencyError:
        raise
    except Exception as error:  # pint raises errors of its own and of Python, too many to list
        told = f"a number in {unit}, or in a unit like it{_inverse_meant(value, unit)}"
        raise SceneError(parameter, value, told) from error


def plain_numbers(parameter: str, values: Any, unit: str = "") -> Any:
    """Return numbers without their units, and anything else as it is.

    Parameters
    ----------
    parameter : str
        The name that an error bears.
    values : object
        A quantity, or a list or an array with quantities in it; text, too, where there is a unit.
    unit : str
        The SI unit of the numbers. Where it is "" a quantity must be dimensionless, as a percentage
        is.

    Returns
    -------
    object
        Of the shape of the values.

    Raises
    ------
    SceneError
        If a value has a unit of another dimension, or is text without unit.
    """
    if isinstance(values, float) or (type(values) is np.ndarray and values.dtype.kind in "fiu"):
        return values
    if isinstance(values, (list, tuple)):
        return [plain_numbers(parameter, value, unit) for value in values]
    if type(values) is np.ndarray and values.dtype.kind in "OU" and values.ndim:
        return [plain_numbers(parameter, value, unit) for value in values]
    wrapped = _wrapped(values)
    if unit:
        return in_si(parameter, wrapped, unit)
    if not is_quantity(wrapped):
        return values
    try:
        return _converted(wrapped, unit)
    except Exception as error:  # as many as there are packages
        told = "without a unit, or dimensionless as a percentage is: pass the magnitude, in SI "
        told += "units for Scene.from_physical"
        raise SceneError(parameter, values, told) from error


def _wrapped(values: Any) -> Any:
    """Return the quantity in an array that has one for its data, as those of xarray may."""
    if not hasattr(type(values), "data") or isinstance(values, np.ndarray):
        return values
    try:
        return values.data if is_quantity(values.data) else values
    except Exception:  # whatever a broken object raises
        return values


def _converted(value: Any, unit: str) -> Any:
    """Return the number that text or a quantity is in a unit; of text it is exact."""
    if isinstance(value, str):
        return _exactly_converted(value, unit)
    converted = value.to(unit)
    number = converted.magnitude if hasattr(converted, "magnitude") else converted.value
    # a scalar of unyt is an array without dimensions
    return number[()] if isinstance(number, np.ndarray) and number.ndim == 0 else number


def _inverse_meant(value: Any, unit: str) -> str:
    """Return what to give instead of a value that is in the inverse of the unit, or nothing."""
    numerator, _, denominator = unit.partition("/")
    if not denominator:
        return ""
    try:
        number = float(_converted(value, f"{denominator}/{numerator}"))
        return f"; give its inverse: {1.0 / number:.6g} {unit}"
    except Exception:  # it is of another dimension, several, or zero
        return ""


def _exactly_converted(text: str, unit: str) -> Fraction:
    found = _TEXT.fullmatch(text)
    assert found is not None  # has_unit
    number, name = found.groups()
    registry = _registry()
    factor = registry.Quantity(Fraction(1), registry.parse_units(name)).to(unit).magnitude
    if abs(int(number.lower().partition("e")[2] or 0)) > 400:
        raise ValueError("beyond the doubles")
    return Fraction(number) * Fraction(factor)


@cache
def _registry() -> Any:
    """Return a registry whose arithmetic is exact, for one rounding to be the only one."""
    return optional("pint", "units").UnitRegistry(non_int_type=Fraction)
