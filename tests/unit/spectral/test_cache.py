"""What a cache keeps, and what all of them together may hold."""

import gc
import weakref
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress

import numpy as np
import pytest

from spectral_contact import Scene, solve
from spectral_contact.spectral import cache
from spectral_contact.spectral.cache import bounded_cache, cache_sizes, clear_caches

KILOBYTE = np.zeros(128).nbytes


@pytest.fixture(autouse=True)
def caches_alone(monkeypatch):
    """Have the caches of a test alone, which together may hold four kilobytes."""
    monkeypatch.setattr(cache, "_CACHES", [])
    monkeypatch.setattr(cache, "_uncounted", 0)
    monkeypatch.setattr(cache, "MAX_CACHE_BYTES", 4 * KILOBYTE)


def kept(name, make, capacity=10):
    """Return a cached function, and the keys that it made."""
    made = []

    def make_once(key):
        made.append(key)
        return make(key)

    return bounded_cache(name, capacity)(make_once), made


def kilobytes(count):
    return [np.zeros(128) for _ in range(count)]


def test_the_oldest_entry_goes():
    upper, made = kept("test", str.upper, 2)
    assert [upper(key) for key in "abab"] == ["A", "B", "A", "B"]
    upper("c")  # a goes
    assert cache_sizes() == {"test": 2}
    assert [upper(key) for key in "bca"] == ["B", "C", "A"]
    assert made == ["a", "b", "c", "a"]


def test_keywords_and_classes():
    one = bounded_cache("pairs")(np.divmod)
    assert one(7, 2) is one(7, 2) is not one(7, 3)
    assert bounded_cache("lists")(dict)(a=1) == {"a": 1}
    made = bounded_cache("objects")(Held)
    assert made() is made()
    assert made.__name__ == "Held"


def test_what_fails_is_not_remembered():
    inverse, made = kept("failing", lambda key: 1 / key)
    for _ in range(2):
        with pytest.raises(ZeroDivisionError) as caught:
            inverse(0)
        assert caught.value.__context__ is None
    assert made == [0, 0]
    assert cache_sizes() == {"failing": 0}


def test_caches_of_one_name_are_counted_together():
    for _ in range(2):
        kept("twins", str)[0]("a")
    assert cache_sizes() == {"twins": 2}


def test_making_may_use_the_cache_itself():
    powers = bounded_cache("nested")(lambda n: 1 if n == 0 else 2 * powers(n - 1))
    assert powers(3) == 8
    assert cache_sizes() == {"nested": 4}


def test_all_caches_are_emptied_when_they_hold_too_much():
    first, _ = kept("first", kilobytes)
    second, _ = kept("second", kilobytes)
    first(1), second(3)
    assert cache_sizes() == {"first": 1, "second": 1}
    assert len(first(2)) == 2
    assert cache_sizes() == {"first": 0, "second": 0}


def test_an_array_that_entries_share_counts_once():
    shared = np.zeros(3 * 128)
    one, _ = kept("shared", lambda key: (shared, [np.zeros(1)]))
    for key in range(5):
        one(key)
    assert cache_sizes() == {"shared": 5}


class Held:
    __module__ = "spectral_contact.anything"
    __slots__ = ("array", "itself", "unset")

    def __init__(self):
        self.array = np.zeros(128)
        self.itself = self


def test_objects_of_the_library_count_with_all_they_hold():
    one, _ = kept("objects", lambda key: Held())
    for key in range(4):
        one(key)
    assert cache_sizes() == {"objects": 4}
    one(4)
    assert cache_sizes() == {"objects": 0}


def test_threads_share_entries():
    one, made = kept("threads", lambda key: object())
    with ThreadPoolExecutor(8) as pool:
        found = set(pool.map(lambda k: one(k % 2), range(200)))
    assert len(found) <= len(made) <= 16
    assert {one(0), one(1)} <= found
    assert cache_sizes() == {"threads": 2}


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
    for _, entries in cache._CACHES:
        for one in entries.values():
            if type(one).__module__.startswith("spectral_contact"):
                with suppress(TypeError):  # what has slots cannot be watched
                    found.append(weakref.ref(one))
    return found


@pytest.mark.usefixtures("_no_collector")
def test_what_is_forgotten_is_freed_at_once(monkeypatch):
    """Cycles of references would keep it until Python looks for them: hundreds of megabytes."""
    monkeypatch.undo()
    clear_caches()  # what earlier tests left could make them overflow between the two scenes
    for scene in SCENES:
        solve(scene, 1e-2, ("total_shear",), strict=False)
    watched = held()
    assert len(watched) > 20
    clear_caches()
    assert [type(one()).__name__ for one in watched if one() is not None] == []
