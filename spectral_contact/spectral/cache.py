"""Bounded, named, clearable and thread-safe caches.

All tables of the library are in such caches, but for a few small ones.
"""

from __future__ import annotations

import ctypes
import os
import sys
import threading
from collections.abc import Callable, Hashable
from dataclasses import dataclass
from functools import wraps
from itertools import count
from typing import Any, Generic, ParamSpec, TypeVar
from weakref import WeakSet

import numpy as np

from spectral_contact.spectral.tuning import (
    CACHE_ENTRIES,
    LARGE_BYTES,
    MAX_CACHE_BYTES,
)

#: Types whose values hold no arrays.
_WITHOUT_ARRAYS = {bool, float, int, str, type(None)}
#: Objects of classes of this package may hold arrays, in their attributes.
_PACKAGE = __name__.partition(".")[0]

K = TypeVar("K", bound=Hashable)
V = TypeVar("V")
P = ParamSpec("P")

#: All caches that exist.
_CACHES: WeakSet[BoundedCache] = WeakSet()  # type: ignore[type-arg]
#: Functions that empty caches of another kind.
_FURTHER_CLEARS: list[Callable[[], None]] = []
#: The time of a use is its number.
_CLOCK = count()

# glibc gives arrays back to the system, and takes and zeroes their pages again, until one as large
# has been freed
np.empty(LARGE_BYTES)


@dataclass(slots=True)
class _Entry(Generic[V]):
    """A value and the time of its last use."""

    value: V
    last_use: int


class BoundedCache(Generic[K, V]):
    """Least-recently-used cache with a name and a lock.

    If all caches together grow too large, they forget the entries that were not used for longest.

    Parameters
    ----------
    name : str
        Shown by `cache_sizes`.
    capacity : int
        Most entries it keeps.
    """

    #: bytes of large entries of all caches since these were counted
    _uncounted_bytes = 0

    def __init__(self, name: str, capacity: int) -> None:
        self.name = name
        self.capacity = capacity
        self._entries: dict[K, _Entry[V]] = {}
        self._lock = threading.RLock()
        _CACHES.add(self)

    def get(self, key: K, make: Callable[P, V], *args: P.args, **kwargs: P.kwargs) -> V:
        """Return the entry of `key`; the first time ``make(*args, **kwargs)`` makes it.

        Other threads wait for it.
        """
        entry = self._entries.get(key)
        if entry is not None:  # most of the time, and then no lock is needed
            entry.last_use = next(_CLOCK)
            return entry.value
        with self._lock:
            entry = self._entries.get(key)
            if entry is not None:  # another thread was faster
                return entry.value
            value = make(*args, **kwargs)
            self._entries[key] = _Entry(value, next(_CLOCK))
            if len(self._entries) > self.capacity:
                oldest = min(self._entries, key=lambda k: self._entries[k].last_use)
                del self._entries[oldest]
        made_bytes = _bytes(value, set())
        if made_bytes >= LARGE_BYTES:
            BoundedCache._uncounted_bytes += made_bytes
            if BoundedCache._uncounted_bytes >= MAX_CACHE_BYTES // 4:
                BoundedCache._uncounted_bytes = 0
                _shrink()
        return value

    def entries(self) -> list[tuple[K, _Entry[V]]]:
        """Return keys and entries, or none while another thread holds the lock.

        Two caches that wait for each other's locks would wait for ever.
        """
        if not self._lock.acquire(blocking=False):
            return []
        try:
            return list(self._entries.items())
        finally:
            self._lock.release()

    def forget(self, key: K) -> None:
        """Forget an entry, unless another thread holds the lock."""
        if self._lock.acquire(blocking=False):
            self._entries.pop(key, None)
            self._lock.release()

    def clear(self) -> None:
        """Forget every entry."""
        with self._lock:
            self._entries.clear()

    def renew_lock(self) -> None:
        """Take a new lock: in a forked process no thread releases the old one."""
        self._lock = threading.RLock()

    def __len__(self) -> int:
        return len(self._entries)


def _bytes(value: Any, counted: set[int]) -> int:
    """Return the bytes of the arrays that a value holds.

    Objects whose ids are in `counted` do not count again; those that count are added to it.
    """
    stack = [value]
    total = 0
    while stack:
        item = stack.pop()
        kind = type(item)
        if kind in _WITHOUT_ARRAYS or id(item) in counted:
            continue
        counted.add(id(item))
        if isinstance(item, np.ndarray):
            total += item.nbytes
        elif isinstance(item, (list, tuple)):
            stack += item
        elif kind.__module__.startswith(_PACKAGE) and kind is not BoundedCache:
            # entries of caches count by themselves
            stack += [getattr(item, name, None) for name in getattr(item, "__slots__", ())]
            stack += getattr(item, "__dict__", {}).values()
    return total


def _shrink() -> None:
    """Forget the entries that were not used for longest, until all caches hold few enough bytes."""
    entries = [
        (entry.last_use, cache, key, entry)
        for cache in list(_CACHES)
        for key, entry in cache.entries()
    ]
    counted: set[int] = set()
    total = 0
    for _, cache, key, entry in sorted(entries, key=lambda item: -item[0]):
        total += _bytes(entry.value, counted)
        if total > MAX_CACHE_BYTES:
            cache.forget(key)


def clear_with_caches(*clears: Callable[[], None]) -> None:
    """Have `clear_caches` call these functions, which empty caches of another kind."""
    _FURTHER_CLEARS.extend(clears)


def bounded_cache(
    name: str, capacity: int = CACHE_ENTRIES
) -> Callable[[Callable[P, V]], Callable[P, V]]:
    """Return a decorator that keeps the results of a function in a `BoundedCache`.

    The arguments of the function must be hashable. It may be a class, whose objects are kept. A
    cache of large objects, or of objects that grow in use, has a smaller capacity.
    """

    def decorate(make: Callable[P, V]) -> Callable[P, V]:
        cache: BoundedCache[Any, V] = BoundedCache(name, capacity)

        @wraps(make, updated=())
        def cached(*args: P.args, **kwargs: P.kwargs) -> V:
            key = (args, *kwargs.items()) if kwargs else args
            return cache.get(key, make, *args, **kwargs)

        return cached

    return decorate


def cache_sizes() -> dict[str, int]:
    """Return the number of entries of every cache, summed by name."""
    sizes: dict[str, int] = {}
    for cache in list(_CACHES):
        sizes[cache.name] = sizes.get(cache.name, 0) + len(cache)
    return sizes


def clear_caches() -> None:
    """Empty every cache of the library and free its memory; the next solve assembles anew."""
    for clear in [*_FURTHER_CLEARS, *(cache.clear for cache in list(_CACHES))]:
        clear()
    # glibc would keep most of the memory, because arrays in use lie between
    if sys.platform == "linux" and hasattr(libc := ctypes.CDLL(None), "malloc_trim"):
        libc.malloc_trim(0)


def _renew_locks() -> None:
    """Let a forked process work, though a thread of its parent held locks."""
    for cache in list(_CACHES):
        cache.renew_lock()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_renew_locks)
