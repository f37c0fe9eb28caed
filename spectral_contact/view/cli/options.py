"""Values of options: what the text of the command line stands for.

Options that do not make a request are a `UsageError` throughout `cli`; values out of range are
errors of the library.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from contextlib import suppress
from typing import Annotated, Any, Final

import numpy as np

from spectral_contact.errors import SpectralContactError
from spectral_contact.io.checks import decimal_number
from spectral_contact.io.documents import checked_path
from spectral_contact.io.units import has_unit
from spectral_contact.view import plotting

# Narrower than int(), which takes 1_000 and the digits of every script.
_WHOLE: Final = re.compile(r"[+-]?[0-9]+")
#: How a negative number begins, alone or in a list, a range or before a unit.
_NEGATIVE: Final = re.compile(r"-(?:[0-9.]|inf|nan)", re.IGNORECASE)
#: The most values that a range stands for.
_MOST_VALUES: Final = 10**7
#: What an option is called that has another name than its parameter.
_IMPERATIVES: Final = {"unloaded_to": "unload_to"}


class UsageError(SpectralContactError):
    """The options do not make a request."""


class NotSolved(SpectralContactError):
    """The request was done, and not everything was solved, or is as exact as was asked for."""


def flag(name: str) -> str:
    """Return the option of a parameter."""
    return "--" + _IMPERATIVES.get(name, name).replace("_", "-")


def measured(text: str) -> float | str:
    """Return a number, or text with a unit as it is."""
    if has_unit(text):
        return text
    try:
        return number(text)
    except ValueError as error:
        raise ValueError(f"{error}, nor a number and a unit, as '5 mm' or '50 nm/MPa'") from error


def number(text: str) -> float:
    """Return a number; decimals beyond the doubles are refused, as in Python's interface."""
    try:
        return decimal_number(text.strip(" "))
    except ValueError as error:
        raise ValueError(f"{text!r} {error}") from None


def whole(text: str) -> int:
    """Return a whole number."""
    with suppress(ValueError):  # more digits than Python converts
        if _WHOLE.fullmatch(stripped := text.strip(" ")):
            return int(stripped)
    raise ValueError(f"{text!r} is not a whole number")


def resolution(text: str) -> float:
    """Return a number, a whole one as an int: that is how a solver is called."""
    return int(text) if _WHOLE.fullmatch(text.strip(" ")) else number(text)


def values(text: str) -> list[float]:
    """Return the numbers that a text stands for."""
    low, *rest = text.split(":")
    if not rest:
        return [number(part) for part in text.split(",")]
    refusal = ValueError(f"{text!r} is not LOW:HIGH:COUNT[:log]")
    if len(rest) == 1 or rest[2:] not in ([], ["linear"], ["log"]):
        raise refusal
    start, high, count = number(low), number(rest[0]), whole(rest[1])
    if count < 1 or not math.isfinite(high - start):
        raise refusal
    if count > _MOST_VALUES:
        raise ValueError(f"{text!r}: COUNT must be at most {_MOST_VALUES}")
    in_ratios = rest[2:] == ["log"]
    if in_ratios and min(start, high) <= 0.0:
        raise ValueError(f"{text!r}: equal ratios need positive ends")
    spaced = np.geomspace if in_ratios else np.linspace
    return list(map(float, spaced(start, high, count)))


def si_values(text: str) -> list[float | str]:
    """Return the numbers that a text stands for, with the unit behind them, if there is one."""
    numbers, blank, unit = text.strip().rpartition(" ")
    if (blank and unit[:1].isalpha()) or unit[:1] in "µμÅ%°":
        return [f"{value!r} {unit}" for value in values(numbers)]
    return [*values(text)]


def friction(text: str) -> float | None:
    """Return a coefficient of friction, None for ``none``."""
    return None if text.strip().lower() == "none" else number(text)


def frictions(text: str) -> list[float | None]:
    """Return coefficients of friction; ``none`` is alone."""
    return [None] if text.strip().lower() == "none" else [*values(text)]


def named_number(text: str) -> tuple[str, float]:
    """Return the two sides of ``NAME=X``."""
    name, equals, value = text.partition("=")
    if not equals:
        raise ValueError(f"{text!r} is not NAME=X")
    return name.strip().replace("-", "_"), number(value)


def joined(argv: Sequence[str]) -> list[str]:
    """Write ``--option -1e-3`` as ``--option=-1e-3``; argparse takes the former for two options.

    And ``--profile points FILE`` as two options.
    """
    found: list[str] = []
    for text in argv:
        if found[-2:] == ["--profile", "points"] and not text.startswith("--"):
            found.append(f"--profile-file={text}")
            continue
        is_value = _NEGATIVE.match(text) and found and found[-1].startswith("--")
        if is_value and "=" not in found[-1]:
            found[-1] = f"{found[-1]}={text}"
        else:
            found.append(text)
    return found


def picture(text: str) -> str:
    """Return the path of a picture that can be drawn."""
    plotting.require()
    return checked_path(text, plotting.FORMATS)


class Option:
    """How an option is read: what argparse needs, names that end the help, and other names of it.

    Attributes
    ----------
    keywords : dict
        Arguments of argparse.
    names, also : tuple of str
    """

    def __init__(
        self, *names: str, read: Any = None, also: tuple[str, ...] = (), **keywords: Any
    ) -> None:
        self.names = names
        self.also = also
        self.keywords = keywords if read is None else {"type": read, **keywords}


def written(*suffixes: str) -> Option:
    """Return the kind of a file that is written, with one of these suffixes."""
    return Option(*suffixes, read=lambda text: checked_path(text, suffixes))


Number = Annotated[float, Option(read=number)]
Whole = Annotated[int, Option(read=whole)]
Values = Annotated[list[float], Option(read=values)]
Picture = Annotated[str, Option(*plotting.FORMATS, read=picture)]
NamedNumbers = Annotated[list[tuple[str, float]], Option(read=named_number, action="append")]
