"""Are true errors below their estimates? Random scenes of one stratum against a better truth.

Run as ``python validation/honesty/honesty.py [STRATUM] [options]``; ``--help`` after a stratum
lists its options, and `STRATA` says what there is. Without a stratum it is ``flat``. Results go to
validation/results/honesty_STRATUM.md, or to the files that the stratum's module names. Exits with 1
where an error is above its estimate.
"""

from __future__ import annotations

import sys
from functools import partial
from importlib import import_module

from honesty_table import command

#: By name: the module that draws the scenes and knows their truth, and what they are.
STRATA = {
    "flat": ("flat_punches", "flat punches at all compliances and frictions, without coupling"),
    "coupled": ("flat_punches", "flat punches in full stick with elastic coupling"),
    "coupled_slip": ("coupled_slip", "coupled partial slip"),
    "coupled_annuli": ("coupled_slip", "coupled slip in an interior annulus"),
    "thresholds": ("thresholds", "frictions next to where slip begins, by the friction law"),
    "thresholds_precise": ("thresholds", "the same, nearer than doubles can judge"),
    "profiles": ("profiles", "frictionless contact under profiles"),
    "adhesion": ("adhesion", "adhesive contact under profiles, and its pull-off"),
    "cycles": ("cycles", "steady loops of a load that cycles"),
    "unloading": ("unloading", "the first unloading of flat punches"),
    "unloaded_too_far": ("unloading", "loads below the turning ratio, which are refused"),
    "growing": ("growing", "friction under growing contacts"),
    "growing_together": ("growing_together", "the same with elastic coupling"),
    "growing_to_value": ("growing_together", "the same where a load or an approach is given"),
    "layers": ("layers", "nonlinear layers"),
    "user_layers": ("layers", "layers whose law a user wrote"),
    "bent_layers": ("bent_layers", "layers whose law bends"),
    "lines": ("sweeps", "sweeps over frictions"),
    "curves": ("sweeps", "sweeps over loads or approaches of profiles"),
    "maps": ("sweeps", "maps of full stick over both compliances"),
}


def main(arguments: list[str]) -> int:
    """Run the stratum that is asked for, and return the exit status."""
    name = "flat"
    if arguments and not arguments[0].startswith("-"):
        name, *arguments = arguments
    if name not in STRATA:
        print("\n".join(f"{one:20}{about}" for one, (_, about) in STRATA.items()))
        return 2
    module = import_module(STRATA[name][0])
    # scenes with a store, and those at thresholds, are run by their modules
    run = getattr(module, "main", partial(command, module))
    return int(run(name, arguments))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
