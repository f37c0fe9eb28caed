"""What scenes that are solved one after another have in common."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, TypeVar

__all__ = ["DiskPath", "Shared"]

_T = TypeVar("_T")


class Shared:
    """The latest outcome of steps that several scenes have in common."""

    def __init__(self) -> None:
        self._steps: dict[str, tuple[tuple[object, ...], Any]] = {}

    def get(self, step: str, key: tuple[object, ...], make: Callable[[], _T]) -> _T:
        """Return the outcome of a step, made anew if the latest one has another key."""
        known = self._steps.get(step)
        if known is None or known[0] != key:
            known = self._steps[step] = key, make()
        outcome: _T = known[1]
        return outcome


class DiskPath:
    """How the stick disk moves with friction, from the last two scenes with the same compliances.

    Between neighbours the logarithm of the friction moves the logit of the radius linearly.
    """

    def __init__(self) -> None:
        self._known: list[tuple[float, float, float]] = []

    def near(self, ratio: float) -> tuple[float, float] | None:
        """Return where to look for the disk at another friction, and the slope there."""
        if not self._known:
            return None
        *before, (last, logit, slope) = self._known
        if abs(math.log(ratio / last)) > 1.0:
            return None
        if before and before[0][0] != last:
            other, start, _ = before[0]
            logit += (logit - start) * math.log(ratio / last) / math.log(last / other)
        return logit, slope

    def add(self, ratio: float, disk: tuple[float, float] | None) -> None:
        """Keep what a scene has found."""
        self._known = [] if disk is None else [*self._known[-1:], (ratio, *disk)]
