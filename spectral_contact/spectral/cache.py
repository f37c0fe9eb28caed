"""Bounded, named, clearable and thread-safe caches: the only module-level state of the library."""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Callable, Hashable
from typing import Generic, TypeVar
from weakref import WeakSet

__all__ = ["BoundedCache", "cache_sizes", "clear_caches"]

K = TypeVar("K", bound=Hashable)
V = TypeVar("V")

_ALL: WeakSet[BoundedCache] = WeakSet()  # type: ignore[type-arg]


class BoundedCache(Generic[K, V]):
    """Least-recently-used cache with a name and a lock.

    Parameters
    ----------
    name : str
        Shown by `cache_sizes`.
    capacity : int
        Most entries it keeps.
    """

    def __init__(self, name: str, capacity: int) -> None:
        self.name = name
        self.capacity = capacity
        self._entries: OrderedDict[K, V] = OrderedDict()
        self._lock = threading.RLock()
        _ALL.add(self)

    def get(self, key: K, make: Callable[[], V]) -> V:
        """Return the entry of `key`, made by `make()` the first time; threads wait for it."""
        with self._lock:
            if key in self._entries:
                self._entries.move_to_end(key)
                return self._entries[key]
            value = make()
            self._entries[key] = value
            if len(self._entries) > self.capacity:
                self._entries.popitem(last=False)
            return value

    def clear(self) -> None:
        """Forget every entry."""
        with self._lock:
            self._entries.clear()

    def __len__(self) -> int:
        return len(self._entries)


def cache_sizes() -> dict[str, int]:
    """Return the number of entries of every cache, summed by name."""
    sizes: dict[str, int] = {}
    for cache in list(_ALL):
        sizes[cache.name] = sizes.get(cache.name, 0) + len(cache)
    return sizes


def clear_caches() -> None:
    """Empty every cache of the library; the next solve assembles anew."""
    for cache in list(_ALL):
        cache.clear()
