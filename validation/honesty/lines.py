"""Whether a sweep's lines of frictions are as good as they say: random lines against `solve`.

Run as ``python validation/honesty/lines.py [lines] [seed]``. Each line has one or no compliance
that is zero, and frictions that are equidistant, in equal ratios or random, up to some beyond the
critical one. Some scenes of each are solved at 1e-12; the table has the largest share of its
estimate that an error takes, of scenes that were solved and of those between.
"""

import math
import sys

import numpy as np
from honesty_table import largest_share, spread

from spectral_contact import Scene, solve
from spectral_contact.sweeps import sweep

NUMBERS = ("stick_radius", "total_shear")
CHECKED = 8


def main(lines: int, seed: int) -> int:
    """Print the worst share of each line; the status is 1 if an error is beyond its estimate."""
    rng, worst, values = np.random.default_rng(seed), 0.0, 0
    print("| alpha* | beta* | scenes | error/estimate |\n|---|---|---|---|")
    for _ in range(lines):
        alpha, beta = 10.0 ** rng.uniform(-5.0, 2.0, 2) * (rng.random(2) > 0.1)
        base = Scene(rng.uniform(-0.3, 0.45), float(alpha), float(beta), math.inf)
        critical = solve(base, 1e-8, ["critical_friction"]).critical_friction
        line = spread(rng, min(critical, 3.0) * 10.0 ** rng.uniform(-0.7, 0.2), 2.5)
        found = sweep(base, friction=line, quantities=NUMBERS)
        share = 0.0
        for i in rng.choice(len(line), CHECKED, replace=False):
            scene = base.replace(friction=float(line[i]))
            truth = solve(scene, 1e-12, NUMBERS, strict=False)
            share = max(share, largest_share(found, i, truth, NUMBERS))
            values += len(NUMBERS)
        print(f"| {alpha:.1e} | {beta:.1e} | {len(line)} | {share:.2f} |", flush=True)
        worst = max(worst, share)
    print(f"\n{values} values of {lines} lines: at most {worst:.2f} of the estimate.")
    return int(worst > 1.0)


if __name__ == "__main__":
    sys.exit(main(*map(int, [*sys.argv[1:], *(80, 0)[len(sys.argv) - 1 :]])))
