"""BLAS held to one thread while the library works, and a cached property that no fork can lock.

One thread is best for systems of this size, and for many processes. Some BLAS libraries have one
number of threads for the whole process, others one for each of its threads. Afterwards that number
is again what it was.
"""

from __future__ import annotations

import functools
import os
import threading
from collections import defaultdict
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from typing import Any, Final, TypeVar

__all__ = ["cached_property", "one_thread"]

T = TypeVar("T")


class cached_property(functools.cached_property[T]):
    """As of functools, without the lock that it has before Python 3.12.

    A process that is forked while another thread holds the lock could never take it.
    """

    def __init__(self, func: Callable[[Any], T]) -> None:
        super().__init__(func)
        self.lock = nullcontext()


@functools.cache
def _libraries() -> list[Any]:
    """Return threadpoolctl's controllers of the BLAS libraries that this process has loaded."""
    from threadpoolctl import ThreadpoolController  # after NumPy and SciPy have loaded theirs

    return list(ThreadpoolController().select(user_api="blas").lib_controllers)


def _scope(library: Any) -> tuple[Any, int]:
    """Return what a number of threads holds for: the library, and a thread or 0 for all."""
    kind = library.internal_api
    by_thread = kind == "mkl" or (kind == "openblas" and library.threading_layer == "openmp")
    return library, threading.get_ident() if by_thread else 0


def _set(library: Any, number: int) -> None:
    """Set the number of threads, from whichever thread.

    In newer versions of threadpoolctl only the thread that has set it first may set it again, until
    that thread is cleared.
    """
    if number != library.num_threads:
        clear = getattr(library, "clear_controlling_thread", lambda **_: None)
        clear(force=True)
        library.set_num_threads(number)
        clear(force=True)


_LOCK: Final = threading.Lock()
#: By `_scope`, the numbers before each entry of `one_thread` that still lasts, the oldest first.
_BEFORE: Final[defaultdict[tuple[Any, int], list[int]]] = defaultdict(list)
if hasattr(os, "register_at_fork"):
    _unlock = _LOCK.release
    os.register_at_fork(before=_LOCK.acquire, after_in_parent=_unlock, after_in_child=_unlock)


@contextmanager
def one_thread() -> Iterator[None]:
    """Hold BLAS to one thread, and then restore its number of threads.

    It is for ``with``, or to decorate a function. It may be entered again, and by several threads:
    the last one to leave restores the number. By threadpoolctl alone, threads that overlap would
    leave BLAS with one thread.
    """
    with _LOCK:
        for scope in map(_scope, _libraries()):
            _BEFORE[scope].append(scope[0].num_threads)
            _set(scope[0], 1)
    try:
        yield
    finally:
        with _LOCK:
            for scope in map(_scope, _libraries()):
                # Entries of threads that overlap may end in any order: all but the oldest number
                # are 1, unless a number was set in between.
                _set(scope[0], _BEFORE[scope].pop())
                if not _BEFORE[scope]:  # threads come and go
                    del _BEFORE[scope]
