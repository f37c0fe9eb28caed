"""A line of progress on stderr, for work that takes longer than a breath."""

from __future__ import annotations

import sys
from time import perf_counter

__all__ = ["ProgressLine"]


class ProgressLine:
    """A bar, the share that is done, the seconds so far and the present step, on one line.

    Parameters
    ----------
    wanted : bool
        Whether to show anything.
    """

    def __init__(self, wanted: bool) -> None:
        self._wanted = wanted
        self._begin = perf_counter()

    def __call__(self, step: str, share: float) -> None:
        """Show the step and the share in [0, 1] that is done; 1 ends the line."""
        if self._wanted:
            bar = "#" * round(20 * share)
            seconds = perf_counter() - self._begin
            end = "\n" if share >= 1.0 else ""
            line = f"\r[{bar:<20}] {100 * share:3.0f} % {seconds:5.0f} s  {step:<32}"
            sys.stderr.write(line + end)
            sys.stderr.flush()
