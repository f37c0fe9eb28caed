"""Values with units: text such as ``"210 GPa"`` and quantities of pint, as numbers in SI units.

pint is an extra, and imported when a unit has to be understood, not before.
"""

from __future__ import annotations

import re
import sys
from fractions import Fraction
from functools import cache
from typing import Any, Final, Protocol

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
# Narrower than pint's grammar, in which an exponent may take for ever to compute.
_TERM: Final = r"[A-Za-zµμ]+(?:(?:\*\*|\^)-?[0-9])?"
_TEXT: Final = re.compile(rf"\s*({_NUMBER})\s*({_TERM}(?:\s*[*/·\s]\s*{_TERM})*)\s*")


def has_unit(value: object) -> bool:
    """Return whether this is text that has the form of a number and a unit."""
    return isinstance(value, str) and len(value) <= _LONGEST and bool(_TEXT.fullmatch(value))


def in_si(parameter: str, value: Any, unit: str) -> Any:
    """Return a value with a unit as a number in SI units, and anything else as it is.

    Parameters
    ----------
    parameter : str
        The name that the `SceneError` of a unit bears that is none, or of another dimension.
    value : object
        Text is converted exactly, if pint is installed; a quantity by its own registry.
    unit : str
        The SI unit.
    """
    pint = sys.modules.get("pint")
    is_quantity = pint is not None and isinstance(value, pint.Quantity)
    if not is_quantity and not has_unit(value):
        return value
    try:
        return value.to(unit).magnitude if is_quantity else _converted(value, unit)
    except MissingDependencyError:
        raise
    except Exception as error:  # pint has many, and lets some of Python's through
        raise SceneError(parameter, value, f"a number in {unit}, or in a unit like it") from error


def _converted(text: str, unit: str) -> Fraction:
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
