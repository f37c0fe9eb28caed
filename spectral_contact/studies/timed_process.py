"""What a fresh process runs to time a solver: the task comes on stdin, the times go to stdout."""

from __future__ import annotations

import importlib
import json
import os
import pickle
import sys
from contextlib import suppress
from time import perf_counter

from spectral_contact.studies.timing import repeated


def main() -> None:
    """Time the first solve of this process, and more of them if a stopwatch is given.

    The answer also names what the first solve imported.
    """
    # what the solver prints must not mix with the times
    answer = os.dup(1)
    os.dup2(2, 1)
    scene, solver, resolution, stopwatch, modules = pickle.load(sys.stdin.buffer)
    for name in modules:
        with suppress(Exception):  # what cannot be imported by its name, the solver makes itself
            importlib.import_module(name)
    before = set(sys.modules)
    begin = perf_counter()
    solver(scene, resolution)
    cold = perf_counter() - begin
    imported = [name for name in sys.modules if name not in before]
    warm = repeated(lambda: solver(scene, resolution), stopwatch) if stopwatch else []
    with os.fdopen(answer, "w", encoding="utf-8") as out:
        json.dump({"cold": cold, "warm": warm, "imported": imported}, out)
