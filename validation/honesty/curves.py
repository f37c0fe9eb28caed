"""Whether a sweep's indentation curves are as good as they say: random curves against `solve`.

Run as ``python validation/honesty/curves.py [curves] [seed]``. Profiles are those of `profiles`;
each curve has some dozen loads or approaches, equidistant, in equal ratios or random, and a
compliance or none. Some scenes of each are solved at 1e-12; the table has the largest share of its
estimate that an error takes.
"""

import sys

import numpy as np
from honesty_table import largest_share, spread
from profiles import drawn

from spectral_contact import Scene, solve
from spectral_contact.sweeps import sweep

NUMBERS = ("contact_radius", "load", "approach", "stiffness", "indentation_work")
CHECKED = 8


def main(curves: int, seed: int) -> int:
    """Print the worst share of each curve; the status is 1 if an error is beyond its estimate."""
    rng, worst, values = np.random.default_rng(seed), 0.0, 0
    print("| profile | alpha* | rtol | scenes | error/estimate |\n|---|---|---|---|---|")
    for _ in range(curves):
        profile, radius = drawn(rng)
        alpha = radius * 10.0 ** rng.uniform(-6.0, 3.0) * (rng.random() > 0.15)
        rtol = 10.0 ** rng.uniform(-11.0, -4.0)
        given = str(rng.choice(["load", "approach"]))
        base = Scene(0.3, alpha, profile=profile, contact_radius=radius)
        highest = float(getattr(solve(base, 1e-6, [given], strict=False), given))
        line = spread(rng, highest, 4.0)
        found = sweep(base, **{given: line}, quantities=NUMBERS, rtol=rtol)
        share, names = 0.0, [one for one in NUMBERS if one != given]
        for i in rng.choice(len(line), CHECKED, replace=False):
            one = Scene(0.3, alpha, profile=profile, **{given: float(line[i])})
            truth = solve(one, 1e-12, NUMBERS, strict=False)
            share = max(share, largest_share(found, i, truth, names))
            values += len(names)
        label = f"{profile.brief} | {alpha:.1e} | {rtol:.0e} | {len(line)}"
        print(f"| {label} | {share:.2f} |", flush=True)
        worst = max(worst, share)
    print(f"\n{values} values of {curves} curves: at most {worst:.2f} of the estimate.")
    return int(worst > 1.0)


if __name__ == "__main__":
    sys.exit(main(*map(int, [*sys.argv[1:], *(80, 0)[len(sys.argv) - 1 :]])))
