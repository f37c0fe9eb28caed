"""Are true errors below their estimates? Random scenes of one stratum against a better truth.

Run as ``python validation/honesty/honesty.py [STRATUM] [options]``; ``--help`` after a stratum
lists its options, and strata.toml says what there is. Without a stratum it is ``flat``. Results go
to validation/results/honesty_STRATUM.md, or to the files that the stratum's module names. Exits
with 1 where an error is above its estimate.
"""

from __future__ import annotations

import sys
from importlib import import_module

from strata import command, strata


def main(arguments: list[str]) -> int:
    """Run the stratum that is asked for, and return the exit status."""
    name = "flat"
    if arguments and not arguments[0].startswith("-"):
        name, *arguments = arguments
    known = strata()
    if name not in known:
        print("\n".join(f"{one:20}{stratum.title}" for one, stratum in known.items()))
        return 2
    stratum = known[name]
    if not stratum.scenes:  # with another record
        return int(import_module(stratum.module).main(name, arguments))
    return int(command(stratum, arguments))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
