"""Checks of what is no number: objects, lists, and names, as the library wants them.

Anything else is a `SceneError` with the name of the parameter; a wrong name gets a suggestion.
"""

import difflib
import inspect
from collections.abc import Callable, Iterable, Mapping, Sized
from functools import wraps
from typing import TYPE_CHECKING, Any, Final, TypeVar, cast

from spectral_contact.errors import SceneError

_T = TypeVar("_T")
_F = TypeVar("_F", bound=Callable[..., Any])

#: What other programs and textbooks call a parameter or quantity of this library.
_SYNONYMS: Final[dict[str, tuple[str, ...]]] = {
    "friction": ("mu", "f", "cof", "friction_coefficient", "coefficient_of_friction"),
    "poisson_ratio": ("nu", "v", "poisson", "poissons_ratio"),
    "youngs_modulus": ("e", "young", "young_modulus", "modulus", "elastic_modulus"),
    "normal_compliance": ("alpha",),
    "tangential_compliance": ("beta",),
    "rtol": ("tol", "tolerance", "reltol", "rel_tol", "eps", "accuracy"),
    "digits": ("dps", "precision"),
    "approach": ("delta", "depth", "displacement", "indentation"),
    "load": ("force", "normal_force"),
    "radius": ("a", "punch_radius"),
    "contact_radius": ("a",),
    "stick_radius": ("c", "stick"),
    "total_shear": ("shear", "tangential_force"),
    "pressure": ("p", "normal_stress"),
    "traction": ("q", "tau", "shear_stress"),
    "zones": ("regions",),
}


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
    """Return what has several values as a list.

    Text and mappings are refused, and so is what has no length, as it may have no end. ``of`` says
    of what the list must be, for the error.
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
        allowed = allowed or (f"one of {', '.join(there)}" if there else "left out: there is none")
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
    """Return "; did you mean ...?" if a text resembles or stands for a known name, else nothing."""
    meant = {_plain(name): name for name in known}
    text = _plain(value[:80]) if isinstance(value, str) else ""
    synonyms = [name for name, others in _SYNONYMS.items() if text in others and name in meant]
    for name in synonyms or difflib.get_close_matches(text, meant, 1):
        return f"; did you mean {meant[name]}?"
    return ""


def _plain(name: str) -> str:
    return name.strip().lower().replace("-", "_").strip("_")


def suggesting(elsewhere: Mapping[str, str] | None = None) -> Callable[[_F], _F]:
    """Decorate a function so that an unknown keyword is a `TypeError` that says what was meant.

    doctest passes over decorated functions. So a module with examples in the docstring of one lists
    that function in ``__test__``.

    Parameters
    ----------
    elsewhere : mapping of str to str, optional
        For keywords of another function: which one, worded to follow a semicolon.
    """
    hints = elsewhere or {}

    def decorate(function: _F) -> _F:
        known = [
            name for name in inspect.signature(function).parameters if name not in ("self", "cls")
        ]
        # a constructor is called by the name of its class
        called = function.__qualname__.removesuffix(".__init__")

        @wraps(function)
        def checked(*arguments: Any, **named: Any) -> Any:
            for name in named:
                if name not in known:
                    hint = f"; {hints[name]}" if name in hints else suggestion(name, known)
                    raise TypeError(f"{called}() has no parameter {name!r}{hint}")
            return function(*arguments, **named)

        return cast(_F, checked)

    return decorate


class Suggesting:
    """Base of classes whose error for an unknown attribute says what was meant."""

    __slots__ = ()

    if not TYPE_CHECKING:  # with it a type checker would accept any attribute

        def __getattr__(self, name: str) -> Any:
            cls = type(self)
            if hasattr(cls, name):  # a property has failed: its error counts
                return object.__getattribute__(self, name)
            hint = ""
            if not name.startswith("_"):  # protocols of Python and NumPy ask for private names
                hint = suggestion(
                    name, [public for public in dir(cls) if not public.startswith("_")]
                )
            raise AttributeError(f"{cls.__name__!r} object has no attribute {name!r}{hint}")
