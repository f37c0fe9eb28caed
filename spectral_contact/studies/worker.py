"""What a fresh process runs to time a solver: the task comes on stdin, the times go to stdout."""

from __future__ import annotations

import json
import os
import pickle
import sys
from time import perf_counter

from spectral_contact.studies.timing import repeated

__all__ = ["main"]


def main() -> None:
    """Time the first solve of this process, and more of them if a stopwatch is given."""
    # what the solver prints must not mix with the times
    answer = os.dup(1)
    os.dup2(2, 1)
    scene, solver, resolution, stopwatch = pickle.load(sys.stdin.buffer)
    begin = perf_counter()
    solver(scene, resolution)
    cold = perf_counter() - begin
    warm = repeated(lambda: solver(scene, resolution), stopwatch) if stopwatch else []
    with os.fdopen(answer, "w", encoding="utf-8") as out:
        json.dump({"cold": cold, "warm": warm}, out)
