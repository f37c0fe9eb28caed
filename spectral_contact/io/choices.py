"""Checks of what is no number: objects, lists, and names, as the library wants them.

Anything else is a `SceneError` with the name of the parameter; a wrong name gets a suggestion.
"""

import difflib
from collections.abc import Callable, Iterable, Mapping, Sized
from typing import Any, TypeVar

from spectral_contact.errors import SceneError

_T = TypeVar("_T")


def instance(parameter: str, value: object, kind: type[_T]) -> _T:
    """Return an object of a class."""
    if not isinstance(value, kind):
        article = "an" if kind.__name__[0] in "AEIOU" else "a"
        raise SceneError(parameter, value, f"{article} {kind.__name__}")
    return value


def function(parameter: str, value: object, of: str) -> Callable[..., Any]:
    """Return what can be called; ``of`` says with what, for the error."""
    if not callable(value):
        raise SceneError(parameter, value, f"a callable of {of}")
    return value


def listed(parameter: str, values: object, of: str) -> list[Any]:
    """Return what has several values as a list: no text and no mapping, nor what has no length.

    That may have no end. ``of`` says of what the list must be, for the error.
    """
    try:
        if isinstance(values, Sized) and not isinstance(values, (str, bytes, bytearray, Mapping)):
            return list(values)  # type: ignore[call-overload, no-any-return]
    except Exception as error:  # an array without dimensions, or whatever a broken one raises
        raise SceneError(parameter, values, f"a list of {of}") from error
    raise SceneError(parameter, values, f"a list of {of}")


def one_of(parameter: str, value: object, known: Iterable[str], allowed: str = "") -> str:
    """Return a name if it is known; the error suggests the one that may have been meant.

    It says what is ``allowed``; by default it lists what is known.
    """
    there = tuple(known)
    if not isinstance(value, str) or value not in there:
        allowed = allowed or f"out of {', '.join(there) or 'nothing: there is none'}"
        raise SceneError(parameter, value, allowed + suggestion(value, there))
    return value


def names(parameter: str, values: Any, known: Iterable[str]) -> tuple[str, ...]:
    """Return a list of known names as a tuple."""
    if isinstance(values, str):
        raise SceneError(parameter, values, "a list of names, not one string")
    try:
        several = iter(values)
    except Exception as error:  # not a list, or a broken one
        raise SceneError(parameter, values, "a list of names") from error
    there = tuple(known)
    # one by one, for an iterator may be endless
    return tuple(one_of(parameter, name, there) for name in several)


def suggestion(value: object, known: Iterable[str]) -> str:
    """Return "; did you mean ...?" if a text is like something that is known, else nothing."""
    meant = {_plain(one): one for one in known}
    text = _plain(value[:80]) if isinstance(value, str) else ""
    for near in difflib.get_close_matches(text, meant, 1):
        return f"; did you mean {meant[near]}?"
    return ""


def _plain(name: str) -> str:
    return name.strip().lower().replace("-", "_")
