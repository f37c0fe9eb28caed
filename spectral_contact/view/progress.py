"""A line of progress on stderr, for work that takes longer than a breath."""

from __future__ import annotations

import sys
from time import perf_counter
from typing import Self

__all__ = ["ProgressLine"]


class ProgressLine:
    """A bar, the share that is done, the seconds so far and the present step, on one line.

    As a context manager it ends the line, however the work ends.

    Parameters
    ----------
    wanted : bool
        Whether to show anything.
    """

    def __init__(self, wanted: bool) -> None:
        self._wanted = wanted
        self._begin = perf_counter()
        self._open = False

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        if self._open:
            sys.stderr.write("\n")

    def __call__(self, step: str, share: float) -> None:
        """Show the step and the share in [0, 1] that is done; 1 ends the line."""
        if self._wanted:
            bar = "#" * round(20 * share)
            seconds = perf_counter() - self._begin
            self._open = share < 1.0
            end = "" if self._open else "\n"
            line = f"\r[{bar:<20}] {100 * share:3.0f} % {seconds:5.0f} s  {step:<32}"
            sys.stderr.write(line + end)
            sys.stderr.flush()
