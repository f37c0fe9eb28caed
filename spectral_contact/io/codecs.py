"""The kinds of values that a stored solution is made of, and the form of each in its JSON tree.

A value that JSON has no form for is written as an object with one key, its tag:
``{"float": "inf"}``, ``{"array": place}``, ``{"dict": {...}}``, a record ``{tag: {key: ...}}``, a
member of an enum ``{tag: name}``. All are declared in `spectral_contact.io.schema`; nothing is
taken from the names of classes or annotations.
"""

from __future__ import annotations

import math
from enum import Enum
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from spectral_contact.errors import shown
from spectral_contact.io.documents import Refused, check_keys

#: Arrays by their place in the tree, in the order in which the tree names them.
Arrays = dict[str, NDArray[np.float64]]


class Kind(Protocol):
    """A kind of value, that has a form in the tree."""

    @property
    def what(self) -> str:
        """Its name in a complaint, with an article."""

    def holds(self, value: Any) -> bool:
        """Whether a value is of this kind, as far as its own type tells."""

    def encode(self, value: Any, place: str, arrays: Arrays) -> Any:
        """Return the tree of a value at a place; its arrays are added to `arrays`."""

    def decode(self, tree: Any, place: str, arrays: Arrays, used: Arrays) -> Any:
        """Return the value of a tree; the arrays taken from `arrays` are added to `used`."""


def _wrong(place: str, value: Any, what: str) -> Refused:
    return Refused(f"{place or 'the solution'} is {shown(value)}, not {what}")


def _encoded(kind: Kind, value: Any, place: str, arrays: Arrays) -> Any:
    value = value.item() if isinstance(value, np.generic) else value
    if not kind.holds(value):
        raise _wrong(place, value, kind.what)
    return kind.encode(value, place, arrays)


def _tagged(tree: Any, place: str, what: str) -> tuple[str, Any]:
    """Return the one key of an object, and what it is over."""
    if not isinstance(tree, dict) or len(tree) != 1:
        raise _wrong(place, tree, what)
    [(tag, body)] = tree.items()
    return tag, body


class Plain:
    """What JSON has itself; one of `allowed`, if anything is."""

    def __init__(self, kind: type, what: str, *allowed: str) -> None:
        self.kind, self.what, self.allowed = kind, what, allowed

    def holds(self, value: Any) -> bool:
        return type(value) is self.kind and (not self.allowed or value in self.allowed)

    def encode(self, value: Any, place: str, arrays: Arrays) -> Any:
        return value

    def decode(self, tree: Any, place: str, arrays: Arrays, used: Arrays) -> Any:
        if not self.holds(tree):
            raise _wrong(place, tree, self.what)
        return tree


class Float:
    """A double, which no int stands for; infinities are ``{"float": "inf"}``."""

    what = "a float"

    def holds(self, value: Any) -> bool:
        return type(value) is float and not math.isnan(value)

    def encode(self, value: float, place: str, arrays: Arrays) -> Any:
        return value if math.isfinite(value) else {"float": repr(value)}

    def decode(self, tree: Any, place: str, arrays: Arrays, used: Arrays) -> float:
        if tree in ({"float": "inf"}, {"float": "-inf"}):
            return float(tree["float"])
        if type(tree) is not float or not math.isfinite(tree):
            raise _wrong(place, tree, self.what)
        return tree


class Array:
    """An array of doubles with so many dimensions, ``{"array": place}``; no NaN."""

    def __init__(self, dimensions: int) -> None:
        self.dimensions = dimensions
        self.what = f"an array of doubles with {dimensions} dimension(s) and without NaN"

    def holds(self, value: Any) -> bool:
        return (
            isinstance(value, np.ndarray)
            and value.dtype == np.float64
            and value.ndim == self.dimensions
            and not np.isnan(value).any()
        )

    def encode(self, value: NDArray[np.float64], place: str, arrays: Arrays) -> Any:
        arrays[place] = value
        return {"array": place}

    def decode(self, tree: Any, place: str, arrays: Arrays, used: Arrays) -> NDArray[np.float64]:
        if tree != {"array": place} or place not in arrays:
            raise _wrong(place, tree, "the name of the array of this place")
        given = arrays[place]
        array = given.astype(np.float64) if given.dtype.newbyteorder("=") == np.float64 else given
        if not self.holds(array):
            raise _wrong(place, f"{given.dtype} {given.shape}", self.what)
        array.flags.writeable = False
        used[place] = array
        return array


class Maybe:
    """A kind, or null."""

    def __init__(self, kind: Kind) -> None:
        self.kind, self.what = kind, f"{kind.what} or null"

    def holds(self, value: Any) -> bool:
        return value is None or self.kind.holds(value)

    def encode(self, value: Any, place: str, arrays: Arrays) -> Any:
        return None if value is None else self.kind.encode(value, place, arrays)

    def decode(self, tree: Any, place: str, arrays: Arrays, used: Arrays) -> Any:
        return None if tree is None else self.kind.decode(tree, place, arrays, used)


class Several:
    """A tuple of one kind, of a fixed length or of any; a list in the tree."""

    def __init__(self, kind: Kind, length: int | None = None) -> None:
        self.kind, self.length = kind, length
        self.what = f"a list of {'any' if length is None else length} items, each {kind.what}"

    def holds(self, value: Any) -> bool:
        return type(value) is tuple and self.length in (None, len(value))

    def encode(self, value: Any, place: str, arrays: Arrays) -> Any:
        return [_encoded(self.kind, v, f"{place}.{i}", arrays) for i, v in enumerate(value)]

    def decode(self, tree: Any, place: str, arrays: Arrays, used: Arrays) -> Any:
        if not isinstance(tree, list) or self.length not in (None, len(tree)):
            raise _wrong(place, tree, self.what)
        return tuple(
            self.kind.decode(item, f"{place}.{i}", arrays, used) for i, item in enumerate(tree)
        )


class Choice:
    """A member of an enum: ``{tag: name}``."""

    def __init__(self, tag: str, **members: Enum) -> None:
        self.tag, self.members = tag, members
        self.names = {member: name for name, member in members.items()}
        self.what = f"{tag}: {', '.join(members)}"

    def holds(self, value: Any) -> bool:
        return isinstance(value, Enum) and value in self.names

    def encode(self, value: Enum, place: str, arrays: Arrays) -> Any:
        return {self.tag: self.names[value]}

    def decode(self, tree: Any, place: str, arrays: Arrays, used: Arrays) -> Enum:
        tag, name = _tagged(tree, place, self.what)
        if tag != self.tag or not isinstance(name, str) or name not in self.members:
            raise _wrong(place, tree, self.what)
        return self.members[name]


class Record:
    """A class: ``{tag: {key: ...}}`` with all its fields, in this order.

    Fields that are younger than version 1 of the format are in `later`, each with the value that
    stands for its absence. A field with this value is not written. So old files can be read, and a
    result that uses no younger field is written as it was before.
    """

    def __init__(
        self, tag: str, cls: type, later: dict[str, object] | None = None, /, **kinds: Kind
    ) -> None:
        self.tag, self.cls, self.kinds, self.later = tag, cls, kinds, later or {}
        self.required = [key for key in kinds if key not in self.later]
        self.what = f"a {tag}"

    def holds(self, value: Any) -> bool:
        return type(value) is self.cls

    def encode(self, value: Any, place: str, arrays: Arrays) -> Any:
        prefix = f"{place}." if place else ""
        body = {}
        for key, kind in self.kinds.items():
            item = getattr(value, key)
            if key in self.required or item != self.later[key]:
                body[key] = _encoded(kind, item, prefix + key, arrays)
        return {self.tag: body}

    def decode(self, tree: Any, place: str, arrays: Arrays, used: Arrays) -> Any:
        tag, body = _tagged(tree, place, self.what)
        if tag != self.tag:
            raise _wrong(place, tree, self.what)
        check_keys(f"{place or 'the solution'}, {self.tag}", body, self.required, self.later)
        prefix = f"{place}." if place else ""
        values = {
            key: kind.decode(body[key], prefix + key, arrays, used)
            for key, kind in self.kinds.items()
            if key in body
        }
        return self.cls(**{**self.later, **values})


class Either:
    """One of several records, told apart by their tags."""

    def __init__(self, *records: Record) -> None:
        self.of_class = {record.cls: record for record in records}
        self.of_tag = {record.tag: record for record in records}
        self.what = " or ".join(record.what for record in records)

    def holds(self, value: Any) -> bool:
        return type(value) in self.of_class

    def encode(self, value: Any, place: str, arrays: Arrays) -> Any:
        return self.of_class[type(value)].encode(value, place, arrays)

    def decode(self, tree: Any, place: str, arrays: Arrays, used: Arrays) -> Any:
        tag, _ = _tagged(tree, place, self.what)
        if tag not in self.of_tag:
            raise _wrong(place, tree, self.what)
        return self.of_tag[tag].decode(tree, place, arrays, used)


class Values:
    """A dict with some of these keys: ``{"dict": {...}}``.

    The place of a value in it is its key alone: files have arrays and errors by this name.
    """

    def __init__(self, **kinds: Kind) -> None:
        self.kinds = kinds
        self.what = f"a dict of {', '.join(kinds)}"

    def holds(self, value: Any) -> bool:
        return type(value) is dict and value.keys() <= self.kinds.keys()

    def encode(self, value: Any, place: str, arrays: Arrays) -> Any:
        items = value.items()
        return {"dict": {key: _encoded(self.kinds[key], v, key, arrays) for key, v in items}}

    def decode(self, tree: Any, place: str, arrays: Arrays, used: Arrays) -> Any:
        tag, body = _tagged(tree, place, self.what)
        if tag != "dict" or not self.holds(body):
            raise _wrong(place, body, self.what)
        return {key: self.kinds[key].decode(v, key, arrays, used) for key, v in body.items()}
