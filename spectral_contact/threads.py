"""How many threads BLAS has: one is best for systems of this size, and for many processes."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, Final

__all__ = ["THREADS", "keep_one_thread", "one_thread"]

#: The environment variables that BLAS libraries read when they are loaded.
THREADS: Final = (
    "OPENBLAS_NUM_THREADS",
    "OMP_NUM_THREADS",
    "MKL_NUM_THREADS",
    "VECLIB_MAXIMUM_THREADS",
    "BLIS_NUM_THREADS",
)


@contextmanager
def one_thread() -> Iterator[int | None]:
    """Hold BLAS to one thread if threadpoolctl is there; yield how many threads it has."""
    limit = keep_one_thread()
    if limit is None:
        said = [os.environ.get(name, "") for name in THREADS]
        yield next((int(text) for text in said if text.isdigit()), None)
        return
    with limit:
        yield 1


def keep_one_thread() -> Any:
    """Hold BLAS to one thread from now on, and return the limit; None without threadpoolctl."""
    try:
        from threadpoolctl import threadpool_limits
    except ImportError:
        return None
    return threadpool_limits(1, "blas")
