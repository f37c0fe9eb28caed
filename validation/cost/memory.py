"""Watch the memory of many random scenes: what is alive, what caches hold, what lies free.

Run as ``python validation/cost/memory.py``; writes validation/results/memory.json and .md. Linux
with glibc. The scenes are those of honesty.py, solved at `rtol` 1e-12 one after another in one
process, BLAS with one thread. Resident is what the system counts; alive what was allocated and not
freed, through the C library; cached what the caches count; blocks those of Python's own allocator.
What is resident and not alive lies free in the C library, or is code. At the end the collector of
cycles is run, which shows what waited for it, and caches are cleared, which shows what leaks.
"""

from __future__ import annotations

import ctypes
import gc
import platform
import resource
import sys
from pathlib import Path

sys.path.append(str(Path(__file__).parents[1]))
sys.path.append(str(Path(__file__).parents[1] / "honesty"))

import numpy as np
from honesty_scenes import random_scene
from reporting import options, table, write

from spectral_contact import NotComputedError, clear_caches, solve
from spectral_contact.spectral import cache
from spectral_contact.spectral.tuning import MAX_CACHE_BYTES

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
    print(found, flush=True)
    return found


def cells(one: dict) -> list[str]:
    """Return a row of the table."""
    name = f"{one['scenes']:,}" + (f", {one['what']}" if one["what"] else "")
    sizes = (f"{one[key]:.0f}" for key in ("resident", "peak", "alive", "cached"))
    return [name, *sizes, f"{one['blocks'] / 1000:.0f}"]


def solved(number: int) -> None:
    """Solve a scene; some cannot be."""
    scene, _ = random_scene(SEED, number, False)
    try:
        solve(scene, RTOL, strict=False)
    except NotComputedError as error:
        print(number, error)


def main() -> None:
    """Measure, print and store."""
    rows, count = [row(0)], 0
    for count in range(STEP, options(__doc__, scenes=SCENES).scenes + 1, STEP):
        for number in range(count - STEP, count):
            solved(number)
        rows.append(row(count))
    gc.collect()
    rows.append(row(count, "cycles collected"))
    clear_caches()
    rows.append(row(count, "caches cleared"))
    allowed = MAX_CACHE_BYTES / MEGA
    about = (
        f"Python {platform.python_version()}, numpy {np.__version__}, "
        f"{' '.join(platform.libc_ver())}; megabytes, of which caches may hold {allowed:.0f}."
    )
    shown = [one for k, one in enumerate(rows) if k % 5 == 0 or one["what"]]
    heading = "scenes | resident | peak | alive | cached | Python's blocks [1000]"
    write(
        "memory",
        f"{about}\n\n{table(heading, map(cells, shown))}",
        {"allowed": allowed, "rows": rows},
    )


if __name__ == "__main__":
    main()
