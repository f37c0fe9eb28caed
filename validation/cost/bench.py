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
from importlib import import_module

#: By name: the module that has the cases, and what they are.
GROUPS = {
    "solve": ("bench_solve", "whole solves, cold and warm"),
    "coupled": ("bench_solve", "whole solves with elastic coupling, likewise"),
    "profiles": ("bench_contacts", "contact under profiles"),
    "growing": ("bench_contacts", "friction as a contact grows, and curves of loads"),
    "adhesion": ("bench_contacts", "adhesive contact, pull-off and cycles"),
    "fit": ("bench_fit", "fits of measured curves"),
    "sweep": ("bench_sweep", "scenes a second of sweeps"),
    "inside": ("bench_inside", "stresses in the body"),
    "reference": ("bench_reference", "many digits"),
    "threads": ("bench_threads", "BLAS held to one thread, and not"),
}


def main(arguments: list[str]) -> int:
    """Time the group that is asked for, and return the exit status."""
    if len(arguments) != 1 or arguments[0] not in GROUPS:
        print("\n".join(f"{name:12}{about}" for name, (_, about) in GROUPS.items()))
        return 2
    module, _ = GROUPS[arguments[0]]
    import_module(module).main(f"bench_{arguments[0]}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
