"""What does it cost? Times of one group of cases.

Run as ``python validation/cost/bench.py GROUP``; without a group, all are listed. Writes
validation/results/bench_GROUP.md, and .json where a test or a script reads it. U is the time of one
``numpy.linalg.solve`` of a dense 1000 x 1000 system in the same process, with one BLAS thread: on a
noisy machine ratios to it are what to read. *Warm* is another scene of the same kind with filled
operator caches; solutions are never cached. Figures are medians, of processor time unless a group
says otherwise.
"""

from __future__ import annotations

import sys
import tomllib
from importlib import import_module
from pathlib import Path

GROUPS = tomllib.loads(Path(__file__).with_name("bench.toml").read_text(encoding="utf-8"))["group"]


def main(arguments: list[str]) -> int:
    """Time the group that is asked for, and return the exit status."""
    if len(arguments) != 1 or arguments[0] not in GROUPS:
        print("\n".join(f"{name:12}{group['what']}" for name, group in GROUPS.items()))
        return 2
    import_module(GROUPS[arguments[0]]["module"]).main(arguments[0])
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
