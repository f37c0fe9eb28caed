"""What all caches together may hold."""

import gc
import threading
import weakref
from contextlib import suppress

import numpy as np
import pytest

from spectral_contact import Scene, solve
from spectral_contact.spectral import cache as caches
from spectral_contact.spectral.cache import BoundedCache, clear_caches

KILOBYTE = np.zeros(128).nbytes


@pytest.fixture(autouse=True)
def small(monkeypatch):
    """Let all caches together hold four kilobytes."""
    clear_caches()
    monkeypatch.setattr(caches, "MAX_CACHE_BYTES", 4 * KILOBYTE)
    monkeypatch.setattr(caches, "LARGE_BYTES", KILOBYTE)


def kilobytes(cache, key, count=1):
    return cache.get(key, lambda: [np.zeros(128) for _ in range(count)])


def test_what_was_not_used_for_longest_goes_from_any_cache():
    first, second = BoundedCache("first", 10), BoundedCache("second", 10)
    a, b = kilobytes(first, "a"), kilobytes(second, "b")
    kilobytes(first, "c", 2)
    assert kilobytes(first, "a") is a  # a hit
    kilobytes(second, "d")  # one too many: b goes
    assert (len(first), len(second)) == (2, 1)
    assert kilobytes(first, "a") is a
    assert kilobytes(second, "b") is not b  # and c goes
    assert (len(first), len(second)) == (1, 2)


def test_the_latest_entry_may_go_at_once_and_is_returned():
    cache = BoundedCache("too large", 10)
    assert len(kilobytes(cache, "a", 5)) == 5
    assert len(cache) == 0


def test_small_entries_are_not_looked_at(monkeypatch):
    monkeypatch.setattr(caches, "_shrink", lambda: pytest.fail("looked at"))
    cache = BoundedCache("small", 100)
    for key in range(99):
        cache.get(key, lambda: np.zeros(127))
    assert len(cache) == 99


def test_an_array_that_entries_share_counts_once():
    shared, cache = np.zeros(3 * 128), BoundedCache("shared", 10)
    for key in range(5):
        cache.get(key, lambda: (shared, [np.zeros(1)]))
    assert len(cache) == 5


def test_objects_of_the_library_count_with_all_they_hold():
    class Held:
        __module__ = "spectral_contact.anything"
        __slots__ = ("array", "itself", "kept", "unset")

    def make():
        one = Held()
        one.array, one.itself, one.kept = np.zeros(128), one, BoundedCache("kept", 3)
        one.kept.get(0, lambda: np.zeros(12))
        return one

    cache = BoundedCache("objects", 10)
    for key in range(6):
        cache.get(key, make)
    assert len(cache) == 3  # and what the caches in them hold


def test_a_cache_at_work_in_another_thread_is_left_alone():
    busy, other = BoundedCache("busy", 10), BoundedCache("other", 10)
    old = kilobytes(busy, "old", 3)
    inside, done = threading.Event(), threading.Event()

    def make():
        inside.set()
        done.wait(5.0)
        return 1

    thread = threading.Thread(target=lambda: busy.get("slow", make))
    thread.start()
    inside.wait(5.0)
    kilobytes(other, "a", 3)  # would have to wait for the thread
    done.set()
    thread.join()
    assert kilobytes(busy, "old", 3) is old


# slip in an annulus, and elastic coupling
SCENES = [Scene(0.3, 0.05, 1.0, 0.23 / 7), Scene(0.3, 0.5, 0.5, 0.05, coupling=True)]


@pytest.fixture
def _no_collector():
    gc.collect()
    gc.disable()
    yield
    gc.enable()


def held():
    """Return weak references to the objects of the library that caches hold."""
    found = []
    for cache in list(caches._CACHES):
        for one in (entry.value for _, entry in cache.entries()):
            if type(one).__module__.startswith("spectral_contact"):
                with suppress(TypeError):  # what has slots cannot be watched
                    found.append(weakref.ref(one))
    return found


@pytest.mark.usefixtures("_no_collector")
def test_what_is_forgotten_is_freed_at_once(monkeypatch):
    """Cycles of references would keep it until Python looks for them: hundreds of megabytes."""
    monkeypatch.undo()  # small caches
    for scene in SCENES:
        solve(scene, 1e-2, ("total_shear",), strict=False)
    watched = held()
    assert len(watched) > 20
    clear_caches()
    assert [type(one()).__name__ for one in watched if one() is not None] == []
