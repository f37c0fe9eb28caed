"""Watch the memory of many random scenes: what is alive, what caches hold, what lies free.

Run as ``python validation/cost/memory.py``; writes validation/results/memory.json and .md. Linux
with glibc. The scenes are those of honesty.py, solved at `rtol` 1e-12 one after another in one
process, BLAS with one thread. Resident is what the system counts; alive what was allocated and not
freed, through the C library; cached what the caches count; blocks those of Python's own allocator.
What is resident and not alive lies free in the C library, or is code. At the end the collector of
cycles is run, which shows what waited for it, and caches are cleared, which shows what leaks.
"""

from __future__ import annotations

import os

os.environ["OPENBLAS_NUM_THREADS"] = "1"

import argparse
import ctypes
import gc
import json
import platform
import resource
import sys
from math import inf
from pathlib import Path
from time import perf_counter

sys.path.append(str(Path(__file__).parents[1] / "honesty"))

import numpy as np
import scipy
from honesty_scenes import random_scene

import spectral_contact
from spectral_contact import NotComputedError, clear_caches, solve
from spectral_contact.spectral import cache
from spectral_contact.spectral.tuning import MAX_CACHE_BYTES

RESULTS = Path(__file__).parents[1] / "results"
SEED, SCENES, STEP, RTOL = 7, 2000, 100, 1e-12
MEGA = 2**20


class MallInfo(ctypes.Structure):
    """What glibc's mallinfo2 returns."""

    _fields_ = [
        (name, ctypes.c_size_t)
        for name in (
            *("arena", "ordblks", "smblks", "hblks", "hblkhd"),
            *("usmblks", "fsmblks", "uordblks", "fordblks", "keepcost"),
        )
    ]


LIBC = ctypes.CDLL(None)
LIBC.mallinfo2.restype = MallInfo


def cached() -> int:
    """Return the bytes that caches count."""
    return cache._bytes([list(entries.values()) for _, entries in cache._CACHES], set())


def row(scenes: int, what: str = "") -> dict:
    """Return the figures of now, in megabytes."""
    info = LIBC.mallinfo2()
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    found = {
        "scenes": scenes,
        "what": what,
        "resident": pages * resource.getpagesize() / MEGA,
        "peak": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
        "alive": (info.uordblks + info.hblkhd) / MEGA,
        "cached": cached() / MEGA,
        "blocks": sys.getallocatedblocks(),
    }
    print(line(found), flush=True)
    return found


def line(one: dict) -> str:
    """Return a row of the table."""
    name = f"{one['scenes']:,}" + (f", {one['what']}" if one["what"] else "")
    sizes = " | ".join(f"{one[key]:.0f}" for key in ("resident", "peak", "alive", "cached"))
    return f"| {name} | {sizes} | {one['blocks'] / 1000:.0f} |"


def solved(number: int) -> None:
    """Solve a scene; some cannot be."""
    scene, _ = random_scene(SEED, number, False)
    try:
        solve(scene, RTOL, strict=False)
    except NotComputedError as error:
        print(number, error)


def main() -> None:
    """Measure, print and store."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scenes", type=int, default=SCENES)
    parser.add_argument("--minutes", type=float, default=inf, help="no hundred begins after these")
    options = parser.parse_args()
    rows, count, begin = [row(0)], 0, perf_counter()
    while count < options.scenes and perf_counter() - begin < 60.0 * options.minutes:
        for number in range(count, count + STEP):
            solved(number)
        count += STEP
        rows.append(row(count))
    gc.collect()
    rows.append(row(count, "cycles collected"))
    clear_caches()
    rows.append(row(count, "caches cleared"))
    record = {
        "schema": "spectral_contact.validation.memory",
        "version": 1,
        "library": spectral_contact.__version__,
        "python": platform.python_version(),
        "numpy": np.__version__,
        "scipy": scipy.__version__,
        "libc": " ".join(platform.libc_ver()),
        "seed": SEED,
        "rtol": RTOL,
        "allowed": MAX_CACHE_BYTES / MEGA,
        "rows": rows,
    }
    (RESULTS / "memory.json").write_text(json.dumps(record, indent=1) + "\n")
    (RESULTS / "memory.md").write_text(table(record))


def table(record: dict) -> str:
    """Return every fifth row and the last ones as a Markdown table."""
    rows = record["rows"]
    lines = [
        f"Python {record['python']}, numpy {record['numpy']}, {record['libc']}; "
        f"megabytes, of which caches may hold {record['allowed']:.0f}.",
        "",
        "| scenes | resident | peak | alive | cached | Python's blocks [1000] |",
        "|---|---|---|---|---|---|",
    ]
    shown = [one for k, one in enumerate(rows) if k % 5 == 0 or one["what"]]
    return "\n".join(lines + [line(one) for one in shown]) + "\n"


if __name__ == "__main__":
    main()
