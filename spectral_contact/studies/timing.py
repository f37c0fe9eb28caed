"""Times of solves: medians and quartiles, by timeit, with one BLAS thread."""

from __future__ import annotations

import os
import platform
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from timeit import Timer
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from threadpoolctl import threadpool_limits

from spectral_contact.errors import SceneError
from spectral_contact.io.checks import finite
from spectral_contact.processes import VERSION

#: Warm repeats of a short solve go on until their times add up to this [s],
_SECONDS = 0.2
#: or until there are at least this many.
_MOST = 1000


@dataclass(frozen=True, slots=True)
class Timing:
    """Several times of the same work, in seconds.

    Attributes
    ----------
    median, lower, upper : float
        Median and quartiles [s].
    repeats : int
    """

    median: float
    lower: float
    upper: float
    repeats: int

    @classmethod
    def of(cls, seconds: ArrayLike) -> Timing:
        """Return median and quartiles of times.

        Raises
        ------
        SceneError
            If there is none, or one is below 0 or not finite.
        """
        taken = finite("seconds", seconds)
        if not taken.size or taken.min() < 0.0:
            raise SceneError("seconds", seconds, "at least one time, and none below 0")
        lower, median, upper = (float(q) for q in np.percentile(taken, (25, 50, 75)))
        return cls(median, lower, upper, taken.size)


@dataclass(frozen=True, slots=True)
class Times:
    """The times of one solve.

    Attributes
    ----------
    warm : Timing
        Of repeats, with all caches filled.
    cold : Timing or None
        With empty caches; None if the solver does not say how to empty them.
    """

    warm: Timing
    cold: Timing | None


def times_of(
    solver: Callable[[Any, Any], Any], scene: Any, resolution: float, repeats: int
) -> Times:
    """Return the times of a solve that was done before, so that caches are filled.

    If the solver has a function ``clear_caches``, it is also timed with empty caches.
    """

    def solve() -> None:
        solver(scene, resolution)

    cold: Timing | None = None
    with threadpool_limits(1, "blas"):
        if (clear := getattr(solver, "clear_caches", None)) is not None:
            cold = Timing.of(Timer(solve, clear).repeat(repeats, 1))
        warm = Timer(solve).repeat(repeats, 1)
        while len(warm) < _MOST and sum(warm) < _SECONDS:
            warm += Timer(solve).repeat(len(warm), 1)
    return Times(Timing.of(warm), cold)


def this_machine() -> dict[str, Any]:
    """Return what times depend on: processor, cores, system, and versions."""
    import scipy

    build: Any = np.show_config(mode="dicts")
    blas = build.get("Build Dependencies", {}).get("blas", {})
    return {
        "processor": _processor(),
        "cores": os.cpu_count() or 1,
        "system": f"{platform.system()} {platform.machine()}",
        "python": platform.python_version(),
        "numpy": np.__version__,
        "scipy": scipy.__version__,
        "library": VERSION,
        "blas": f"{blas.get('name', 'unknown')} {blas.get('version', '')}".strip(),
    }


def _processor() -> str:
    """Return the model of the processor."""
    file = Path("/proc/cpuinfo")  # on Linux, where platform.processor() is empty
    lines = file.read_text(encoding="utf-8").splitlines() if file.exists() else []
    models = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return models[0] if models else platform.processor() or platform.machine()
