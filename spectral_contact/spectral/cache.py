"""Caches of what is assembled: bounded, named, and emptied when they grow too large.

A cache is a dictionary. Its operations are atomic, so threads share it without a lock, and a
process may fork at any time. Threads that lack the same entry at once each make it.
"""

from __future__ import annotations

import ctypes
import sys
from collections.abc import Callable
from functools import wraps
from typing import Any, ParamSpec, TypeVar

import numpy as np

from spectral_contact.spectral.tuning import CACHE_ENTRIES, MAX_CACHE_BYTES

#: Objects of classes of this package may hold arrays, in their attributes.
_PACKAGE = __name__.partition(".")[0]

V = TypeVar("V")
P = ParamSpec("P")

#: The name of every cache, and its entries by the arguments that made them.
_CACHES: list[tuple[str, dict[Any, Any]]] = []
#: Stands for "no entry" in a lookup, because None may be an entry.
_ABSENT: Any = object()
#: Bytes of the entries that were made since the bytes of all entries were last counted.
_uncounted = 0


def bounded_cache(
    name: str, capacity: int = CACHE_ENTRIES
) -> Callable[[Callable[P, V]], Callable[P, V]]:
    """Return a decorator that keeps the results of a function; of too many the oldest one goes.

    If all caches together hold more than `MAX_CACHE_BYTES`, they are emptied.

    Parameters
    ----------
    name : str
        Shown by `cache_sizes`.
    capacity : int
        Most results it keeps: fewer of large objects, or of objects that grow in use.

    Returns
    -------
    callable
        The arguments of the function it decorates must be hashable. It may be a class, whose
        objects are kept.
    """

    def decorate(make: Callable[P, V]) -> Callable[P, V]:
        entries: dict[Any, V] = {}
        _CACHES.append((name, entries))

        @wraps(make, updated=())
        def cached(*args: P.args, **kwargs: P.kwargs) -> V:
            key = (args, *kwargs.items()) if kwargs else args
            value: V = entries.get(key, _ABSENT)
            if value is _ABSENT:
                value = entries[key] = make(*args, **kwargs)
                for oldest in list(entries)[:-capacity]:
                    entries.pop(oldest, None)
                _bound_memory(value)
            return value

        return cached

    return decorate


def _bound_memory(made: Any) -> None:
    """Empty all caches if they hold too much; they are counted now and then, as it takes 3 ms."""
    global _uncounted
    _uncounted += _bytes(made, set())
    if _uncounted >= MAX_CACHE_BYTES // 4:
        _uncounted = 0
        if _bytes([list(entries.values()) for _, entries in _CACHES], set()) > MAX_CACHE_BYTES:
            clear_caches()


def _bytes(value: Any, counted: set[int]) -> int:
    """Return the bytes of the arrays that a value holds.

    Objects whose ids are in `counted` do not count again; those that count are added to it.
    """
    if id(value) in counted:
        return 0
    counted.add(id(value))
    if isinstance(value, np.ndarray):
        return value.nbytes
    parts = value if isinstance(value, (list, tuple)) else []
    if type(value).__module__.startswith(_PACKAGE):
        names = getattr(value, "__slots__", ())
        parts = [*parts, *(getattr(value, name, None) for name in names)]
        parts += getattr(value, "__dict__", {}).values()
    return sum(_bytes(part, counted) for part in parts)


def cache_sizes() -> dict[str, int]:
    """Return the number of entries of every cache, summed by name."""
    sizes = dict.fromkeys((name for name, _ in _CACHES), 0)
    for name, entries in _CACHES:
        sizes[name] += len(entries)
    return sizes


def clear_caches() -> None:
    """Empty every cache of the library and free its memory; the next solve assembles anew."""
    for _, entries in _CACHES:
        entries.clear()
    # glibc would keep most of the memory, because arrays in use lie between
    if sys.platform == "linux" and hasattr(libc := ctypes.CDLL(None), "malloc_trim"):
        libc.malloc_trim(0)
