"""Whether maps of full stick are as good as they say: random pairs of compliances against `solve`.

Run as ``python validation/honesty/maps.py [maps] [seed]``. Each map has random compliances from
1e-8 to 1e8 on both axes; some of its scenes are solved at 1e-12. The table has the largest share of
its estimate that an error takes, quantity by quantity.
"""

import math
import sys

import numpy as np
from honesty_table import largest_share

from spectral_contact import Scene, solve
from spectral_contact.sweeps import sweep

NUMBERS = ("approach", "total_shear", "edge_ratio", "critical_friction")
SIZE, CHECKED = 100, 200


def main(maps: int, seed: int) -> int:
    """Print the worst shares of each map; the status is 1 if an error is beyond its estimate."""
    rng, worst = np.random.default_rng(seed), 0.0
    print("| " + " | ".join(["rtol", *NUMBERS]) + " |\n" + "|---" * (1 + len(NUMBERS)) + "|")
    for _ in range(maps):
        alpha, beta = 10.0 ** rng.uniform(-8.0, 8.0, (2, SIZE))
        base, rtol = Scene(0.3, 1.0, 1.0, math.inf), 10.0 ** rng.uniform(-12.0, -4.0)
        axes = {"normal_compliance": alpha, "tangential_compliance": beta}
        found = sweep(base, **axes, quantities=NUMBERS, rtol=rtol)
        shares = np.zeros(len(NUMBERS))
        for i, j in rng.integers(SIZE, size=(CHECKED, 2)):
            here = found.isel(normal_compliance=[i], tangential_compliance=j)
            scene = base.replace(
                normal_compliance=float(alpha[i]), tangential_compliance=float(beta[j])
            )
            truth = solve(scene, 1e-12, NUMBERS, strict=False)
            own = [largest_share(here, 0, truth, (name,)) for name in NUMBERS]
            shares = np.maximum(shares, own)
        print(f"| {rtol:.0e} |" + "".join(f" {share:.2f} |" for share in shares), flush=True)
        worst = max(worst, float(shares.max()))
    print(f"\n{maps * CHECKED} scenes of {maps} maps: at most {worst:.2f} of the estimate.")
    return int(worst > 1.0)


if __name__ == "__main__":
    sys.exit(main(*map(int, [*sys.argv[1:], *(20, 0)[len(sys.argv) - 1 :]])))
