"""Bounded, named, clearable and thread-safe caches of all but a few small tables."""

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

#: What holds no arrays, and whose objects may.
_PLAIN, _PACKAGE = {bool, float, int, str, type(None)}, __name__.partition(".")[0]

K = TypeVar("K", bound=Hashable)
V = TypeVar("V")
P = ParamSpec("P")

_ALL: WeakSet[BoundedCache] = WeakSet()  # type: ignore[type-arg]
_OTHERS: list[Callable[[], None]] = []
_CLOCK = count()
#: Most bytes that all caches together keep; they are counted when entries of `_LARGE` or more were
#: made that are one part in `_SHARE` of it: counting takes 3 ms.
_MOST, _LARGE, _SHARE = 256 * 2**20, 2**20, 8

# glibc gives arrays back to the system, to touch them anew, until one as large has been freed
np.empty(_LARGE)


@dataclass(slots=True)
class _Entry(Generic[V]):
    """A value and the time of its last use."""

    value: V
    used: int


class BoundedCache(Generic[K, V]):
    """Least-recently-used cache with a name and a lock.

    If all caches together grow too large, what has not been used for longest goes, of any of them.

    Parameters
    ----------
    name : str
        Shown by `cache_sizes`.
    capacity : int
        Most entries it keeps.
    """

    _uncounted = 0

    def __init__(self, name: str, capacity: int) -> None:
        self.name = name
        self.capacity = capacity
        self._entries: dict[K, _Entry[V]] = {}
        self._lock = threading.RLock()
        _ALL.add(self)

    def get(self, key: K, make: Callable[P, V], *own: P.args, **named: P.kwargs) -> V:
        """Return the entry of `key`, made by `make` the first time; threads wait for it."""
        entry = self._entries.get(key)
        if entry is not None:  # most of the time, and then no lock is needed
            entry.used = next(_CLOCK)
            return entry.value
        with self._lock:
            entry = self._entries.get(key)
            if entry is not None:  # another thread was faster
                return entry.value
            value = make(*own, **named)
            self._entries[key] = _Entry(value, next(_CLOCK))
            if len(self._entries) > self.capacity:
                del self._entries[min(self._entries, key=lambda one: self._entries[one].used)]
        if (made := _bytes(value, set())) >= _LARGE:
            BoundedCache._uncounted += made
            if BoundedCache._uncounted >= _MOST // _SHARE:
                BoundedCache._uncounted = 0
                _shrink()
        return value

    def entries(self) -> list[tuple[K, _Entry[V]]]:
        """Return keys and entries; none while a thread works here.

        To wait for it might be to wait for each other.
        """
        if not self._lock.acquire(blocking=False):
            return []
        try:
            return list(self._entries.items())
        finally:
            self._lock.release()

    def forget(self, key: K) -> None:
        """Forget an entry, if no other thread works here."""
        if self._lock.acquire(blocking=False):
            self._entries.pop(key, None)
            self._lock.release()

    def clear(self) -> None:
        """Forget every entry."""
        with self._lock:
            self._entries.clear()

    def renew_lock(self) -> None:
        """Forget who works here; for a process that was forked, where nobody else does."""
        self._lock = threading.RLock()

    def __len__(self) -> int:
        return len(self._entries)


def _bytes(value: Any, seen: set[int]) -> int:
    """Return the bytes of the arrays that a value holds, but for those seen before; add these."""
    todo, total = [value], 0
    while todo:
        one = todo.pop()
        kind = type(one)
        if kind in _PLAIN or id(one) in seen:
            continue
        seen.add(id(one))
        if isinstance(one, np.ndarray):
            total += one.nbytes
        elif isinstance(one, (list, tuple)):
            todo += one
        elif kind.__module__.startswith(_PACKAGE) and kind is not BoundedCache:
            # entries of caches count by themselves
            todo += [getattr(one, name, None) for name in getattr(one, "__slots__", ())]
            todo += getattr(one, "__dict__", {}).values()
    return total


def _shrink() -> None:
    """Forget what has not been used for longest, beyond what all caches may hold."""
    entries = [(cache, *own) for cache in list(_ALL) for own in cache.entries()]
    seen: set[int] = set()
    total = 0
    for cache, key, entry in sorted(entries, key=lambda one: -one[-1].used):
        total += _bytes(entry.value, seen)
        if total > _MOST:
            cache.forget(key)


def cleared_too(*others: Callable[[], None]) -> None:
    """Have other caches emptied with these."""
    _OTHERS.extend(others)


def bounded_cache(name: str, capacity: int) -> Callable[[Callable[P, V]], Callable[P, V]]:
    """Return a decorator of functions of hashable arguments, or classes: what they made is kept."""

    def decorated(make: Callable[P, V]) -> Callable[P, V]:
        cache: BoundedCache[Any, V] = BoundedCache(name, capacity)

        @wraps(make, updated=())
        def found(*own: P.args, **named: P.kwargs) -> V:
            key = (own, *named.items()) if named else own
            return cache.get(key, make, *own, **named)

        return found

    return decorated


def cache_sizes() -> dict[str, int]:
    """Return the number of entries of every cache, summed by name."""
    sizes: dict[str, int] = {}
    for cache in list(_ALL):
        sizes[cache.name] = sizes.get(cache.name, 0) + len(cache)
    return sizes


def clear_caches() -> None:
    """Empty every cache of the library and free its memory; the next solve assembles anew."""
    for clear in [*_OTHERS, *(cache.clear for cache in list(_ALL))]:
        clear()
    # glibc would keep most of it, as what is in use lies between
    if sys.platform == "linux" and hasattr(libc := ctypes.CDLL(None), "malloc_trim"):
        libc.malloc_trim(0)


def _renew_locks() -> None:
    """Let a forked process work, though a thread of its parent held locks."""
    for cache in list(_ALL):
        cache.renew_lock()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_renew_locks)
