"""BLAS held to one thread while the library works, and what threads and forks may not break.

One thread is best for systems of this size, and for many processes. The number of threads belongs
to the process, or to each of its threads, as the BLAS library has it; what is held is given back.
"""

from __future__ import annotations

import ctypes
import functools
import itertools
import os
import threading
from collections.abc import Callable
from contextlib import ContextDecorator, nullcontext
from importlib import import_module
from typing import Any, Final, NamedTuple, TypeVar

__all__ = ["cached_property", "look_for_blas", "one_thread"]

T = TypeVar("T")

#: Modules of NumPy and SciPy that call BLAS, what OpenBLAS may call its number of threads, and what
#: there is if each thread has one.
_CALLERS: Final = "numpy.linalg._umath_linalg", "scipy.linalg._fblas"
_ASKED: Final = tuple(
    f"{first}openblas_get_num_threads{last}"
    for first in ("scipy_", "")
    for last in ("64_", "", "_64")
)
_OPENMP: Final = "omp_get_max_threads"


class cached_property(functools.cached_property[T]):
    """As of functools, without the lock that it has before Python 3.12.

    A process that is forked while another thread holds the lock could never take it.
    """

    def __init__(self, func: Callable[[Any], T]) -> None:
        super().__init__(func)
        self.lock = nullcontext()


class _Library(NamedTuple):
    """A BLAS library: how to ask for its number of threads, and how to set it.

    And whether each thread has a number of its own.
    """

    number: Callable[[], int | None]
    set: Callable[[int], object]
    by_thread: bool = False


def _openblas(library: ctypes.CDLL) -> list[_Library]:
    """Return the OpenBLAS that a library is, or needs, if there is one."""
    asked = [name for name in _ASKED if hasattr(library, name)]
    return [_Library(library[one], library[one.replace("get_num", "set_num")]) for one in asked[:1]]


def _brought() -> list[_Library]:
    """Return the OpenBLAS of NumPy and that of SciPy; nothing, if one of them has another BLAS.

    To look through all libraries of a process takes 2 ms, half of what a first solve does.
    """
    try:
        callers = [ctypes.CDLL(import_module(name).__file__) for name in _CALLERS]
    except (ImportError, OSError):
        return []
    found = [[] if hasattr(one, _OPENMP) else _openblas(one) for one in callers]
    return [*itertools.chain(*found)] if all(found) else []


def _present() -> list[_Library]:
    """Return all BLAS libraries of this process."""
    from threadpoolctl import ThreadpoolController

    found = []
    for one in ThreadpoolController().select(user_api="blas").lib_controllers:
        openblas = one.internal_api == "openblas"
        openmp = openblas and one.threading_layer == "openmp"
        # newer threadpoolctl lets one thread alone set it, and ignores others silently
        own = _openblas(one.dynlib) if openblas and not openmp else []
        by_thread = openmp or one.internal_api == "mkl"
        found += own or [_Library(one.get_num_threads, one.set_num_threads, by_thread)]
    return found


class _Mine(threading.local):
    """What one thread holds: how many times over, and what its own numbers were."""

    depth = 0

    def __init__(self) -> None:
        self.before: list[tuple[_Library, int]] = []


class _Hold(ContextDecorator):
    """BLAS at one thread from the first thread that comes to the last one that goes."""

    def __init__(self) -> None:
        self._lock = threading.RLock()
        self._libraries: list[_Library] | None = None
        self._mine = _Mine()
        self._inside = 0
        self._before: list[tuple[_Library, int]] = []

    def look(self, *, first: bool = False) -> list[_Library]:
        """Find all BLAS libraries of this process, or at first, if possible, what is called."""
        with self._lock:
            if self._libraries is None or not first:
                self._libraries = (_brought() if first else []) or _present()
            return self._libraries

    def __enter__(self) -> None:
        """Put BLAS to one thread, if it is not."""
        libraries, mine = self._libraries, self._mine
        if libraries is None:
            libraries = self.look(first=True)
        if mine.depth == 0:
            with self._lock:
                for library in libraries:
                    number = library.number()
                    if number is not None and number > 1:
                        (mine.before if library.by_thread else self._before).append(
                            (library, number)
                        )
                        library.set(1)
                self._inside += 1
        mine.depth += 1

    def __exit__(self, *_: object) -> None:
        """Give back the numbers of this thread, and those of the process with the last thread."""
        mine = self._mine
        mine.depth -= 1
        if mine.depth:
            return
        with self._lock:
            self._inside -= 1
            if mine.before:
                _give_back(mine.before)
            if self._before and self._inside == 0:
                _give_back(self._before)

    def renew_after_forks(self) -> None:
        """Let forks wait until no thread is about to change anything here."""
        if hasattr(os, "register_at_fork"):
            os.register_at_fork(
                before=self._lock.acquire,
                after_in_parent=self._lock.release,
                after_in_child=self._alone,
            )

    def _alone(self) -> None:
        """Go on in a forked process, which has no other thread."""
        self._inside = 1 if self._mine.depth else 0
        if self._inside == 0:
            _give_back(self._before)
        self._lock.release()


def _give_back(numbers: list[tuple[_Library, int]]) -> None:
    while numbers:
        library, number = numbers.pop(0)
        library.set(number)


_HOLD: Final = _Hold()
_HOLD.renew_after_forks()

#: Look for all BLAS libraries of the process: at first those of NumPy and SciPy are held.
look_for_blas: Final = _HOLD.look


def one_thread() -> _Hold:
    """Hold BLAS to one thread, and give back what was: for ``with``, or to decorate a function.

    It may be entered again, and by several threads: the last one to leave gives back.
    """
    return _HOLD
