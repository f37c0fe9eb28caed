"""Values of options: what the text of the command line stands for.

Options that do not make a request are a `UsageError` throughout `cli`; values out of range are
errors of the library.
"""

from __future__ import annotations

import argparse
import math
import re
from collections.abc import Callable, Sequence
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
#: Numbers with one unit behind them, as "1,2 mm" and "0:1:5 N m"; "0.1, inf" has none.
_WITH_UNIT: Final = re.compile(r"(.*?[^,:\s])\s+([^\W\d][^,:]*|[%°][^,:]*)")
#: LOW:HIGH:COUNT, and how the values are spaced.
_RANGE: Final = re.compile(r"([^:]*):([^:]*):([^:]*)(?::(linear|log))?")
#: The most values that a range stands for.
_MOST_VALUES: Final = 10**7
#: Names of options that differ from those of their parameters.
_IMPERATIVES: Final = {"unloaded_to": "unload_to"}


class UsageError(SpectralContactError):
    """The options do not make a request."""


class NotSolved(SpectralContactError):
    """The request was carried out, but something was not solved, or not to the tolerance."""


def flag(name: str) -> str:
    """Return the option of a parameter."""
    return "--" + _IMPERATIVES.get(name, name).replace("_", "-")


def number(text: str) -> float:
    """Return a number; decimals beyond the doubles are refused, as in Python's interface."""
    try:
        return decimal_number(text.strip(" "))
    except ValueError as error:
        raise ValueError(f"{text!r} {error}") from None


def value(text: str) -> float | str | None:
    """Return a number, text with a unit as it is, and None for ``none``."""
    if text.strip().lower() == "none":
        return None
    try:
        return text if has_unit(text) else number(text)
    except ValueError as error:
        raise ValueError(f"{error} (which may have a unit, as '5 mm' or '50 nm/MPa')") from error


def whole(text: str) -> int:
    """Return a whole number."""
    with suppress(ValueError):  # more digits than Python converts
        if _WHOLE.fullmatch(stripped := text.strip(" ")):
            return int(stripped)
    raise ValueError(f"{text!r} is not a whole number")


def resolutions(text: str) -> list[float]:
    """Return the numbers that a solver is called with; whole ones are ints."""
    parts = [part.strip(" ") for part in text.split(",")]
    return [int(part) if _WHOLE.fullmatch(part) else number(part) for part in parts]


def values(text: str) -> list[Any]:
    """Return the values that a text stands for, each with the unit that follows them, if any."""
    if text.strip().lower() == "none" or has_unit(text):
        return [value(text)]
    if found := _WITH_UNIT.fullmatch(text.strip()):
        return [f"{one!r} {found[2]}" for one in values(found[1])]
    if ":" not in text:
        return [number(part) for part in text.split(",")]
    refusal = ValueError(f"{text!r} is not LOW:HIGH:COUNT[:log]")
    if not (found := _RANGE.fullmatch(text)):
        raise refusal
    low, high = map(number, found.group(1, 2))
    count = whole(found[3])
    if count < 1 or not math.isfinite(high - low):
        raise refusal
    if count > _MOST_VALUES:
        raise ValueError(f"{text!r}: COUNT must be at most {_MOST_VALUES}")
    if found[4] == "log" and min(low, high) <= 0.0:
        raise ValueError(f"{text!r}: equal ratios need positive ends")
    spaced = np.geomspace if found[4] == "log" else np.linspace
    return list(map(float, spaced(low, high, count)))


def names(text: str) -> list[str]:
    """Return the names of a list with commas."""
    return [name.strip().replace("-", "_") for name in text.split(",")]


def named_number(text: str) -> tuple[str, float]:
    """Return the two sides of ``NAME=X``."""
    name, equals, value = text.partition("=")
    if not equals:
        raise ValueError(f"{text!r} is not NAME=X")
    return name.strip().replace("-", "_"), number(value)


def joined(argv: Sequence[str]) -> list[str]:
    """Write ``--profile points FILE`` as two options."""
    words = list(argv)
    for place, word in enumerate(words):
        if words[:place][-2:] == ["--profile", "points"] and not word.startswith("--"):
            words[place] = f"--profile-file={word}"
    return words


def picture(text: str) -> str:
    """Return the path of a picture that can be drawn; nothing for ``none``."""
    if text.strip().lower() == "none":
        return ""
    plotting.require()
    return checked_path(text, plotting.FORMATS)


class Listed(argparse.Action):
    """An option whose value is several texts, each a list; the lists are joined to one."""

    def __call__(self, _: Any, namespace: Any, lists: Any, __: str | None = None) -> None:
        """Store the list."""
        setattr(namespace, self.dest, [one for several in lists for one in several])


class Option:
    """How an option is read.

    Attributes
    ----------
    names : tuple of str
        Names that are listed at the end of the help, as the values to choose from.
    also : str or None
        Another name of the option.
    keywords : dict
        Arguments of argparse.
    """

    def __init__(
        self, *names: str, read: Any = None, also: str | None = None, **keywords: Any
    ) -> None:
        self.names = names
        self.also = also
        self.keywords = {"type": read, **keywords}


def chosen(*names: str, **keywords: Any) -> Option:
    """Return an option whose value is one of these names."""
    return Option(*names, choices=names, **keywords)


def several(read: Callable[[str], list[Any]], *names: str, **keywords: Any) -> Option:
    """Return an option whose value is a list, with commas or blanks between its items."""
    return Option(*names, read=read, nargs="+", action=Listed, **keywords)


def written(*suffixes: str) -> Option:
    """Return an option whose value is a file to be written, with one of these suffixes."""
    return Option(*suffixes, read=lambda text: checked_path(text, suffixes))


Number = Annotated[float, Option(read=number)]
Whole = Annotated[int, Option(read=whole)]
Values = Annotated[list[float], Option(read=values)]
Picture = Annotated[str, Option(*plotting.FORMATS, read=picture)]
NamedNumbers = Annotated[list[tuple[str, float]], Option(read=named_number, action="append")]
