"""A growing frictional contact against an incremental march that shares nothing with the library.

Run as ``python validation/physics/growing_contact.py`` (some minutes); writes
validation/results/growing_contact.md. The march (tests/oracles/growing_rings.py) knows neither the
superposition nor the Volterra equation: midpoint collocation on rings of equal width that enter one
by one, stick where they are and slip by the law. It is of first order: its differences from the
solution halve with the rings, and what is left when the first order is taken out goes on falling.
"""

from __future__ import annotations

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import math
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2] / "tests"))

from oracles.growing_rings import Marched, march

from spectral_contact import Scene, Solution, __version__, profiles, solve

RESULT = Path(__file__).parents[1] / "results" / "growing_contact.md"
COUNTS, RTOL = (50, 100, 200), 1e-3
NU = 0.2
PARABOLA, CONE = profiles.Parabola(1.0), profiles.Cone(math.pi / 4.0)
#: Profile, alpha*, beta*, friction, coupling.
CASES = [
    (PARABOLA, 0.2, 0.2, math.inf, False),
    (PARABOLA, 0.2, 0.2, math.inf, True),
    (PARABOLA, 0.2, 0.2, 0.1, False),
    (PARABOLA, 0.2, 0.2, 0.1, True),
    (PARABOLA, 0.5, 0.2, 0.1, True),
    (CONE, 0.5, 0.5, math.inf, True),
    (profiles.RoundedFlat(0.5, 1.0), 0.2, 0.2, 0.1, False),
    (profiles.TruncatedCone(0.5, math.pi / 4.0), 0.2, 0.2, math.inf, False),
    (profiles.RoundedFlat(0.5, 1.0), 0.2, 0.2, 0.1, True),
    (profiles.TruncatedCone(0.5, math.pi / 4.0), 0.2, 0.2, math.inf, True),
]
HEAD = """# A growing contact against a march in increments

Relative differences of the march with so many rings from the solution, at contact radius 1 and
Poisson's ratio {nu}; *rest* is what is left of the last two without the error of first order. The
stick radius of the march is that of a ring. Written by `validation/physics/growing_contact.py`,
version {version}.

| profile | alpha | beta | f | coupled | quantity | solution | {counts} | rest |
|---|---|---|---|---|---|---|{lines}|---|
"""


def rows(solution: Solution, steps: list[Marched]) -> list[str]:
    """Return the rows of a scene, without what the scene is."""
    pairs = {"load": "load", "total shear": "shear", "approach": "approach"}
    values = [solution.load, solution.total_shear, solution.approach]
    found = []
    for (name, its), truth in zip(pairs.items(), values, strict=True):
        off = [getattr(one, its) / truth - 1.0 for one in steps]
        told = " | ".join(f"{one:+.2e}" for one in off)
        found.append(f"{name} | {truth:.6f} | {told} | {2.0 * off[-1] - off[-2]:+.1e} |")
    told = " | ".join(f"{one.stick_radius:.3f}" for one in steps)
    found.append(f"stick radius | {solution.stick_radius:.6f} | {told} | |")
    return found


def main() -> None:
    """Write the table."""
    kappa = Scene(NU).kappa
    text = HEAD.format(
        nu=NU,
        version=__version__,
        counts=" | ".join(f"{n} rings" for n in COUNTS),
        lines="|".join(["---"] * len(COUNTS)),
    )
    for profile, alpha, beta, friction, coupling in CASES:
        scene = Scene(
            NU, alpha, beta, friction, profile=profile, coupling=coupling, contact_radius=1.0
        )
        solution = solve(scene, RTOL, strict=False)
        steps = [
            march(profile.height, alpha, beta, kappa, friction, n, coupled=coupling) for n in COUNTS
        ]
        kind = type(profile).__name__
        for row in rows(solution, steps):
            own = f"| {kind} | {alpha} | {beta} | {friction} | {'yes' if coupling else 'no'} | "
            text += own + row + "\n"
        print(text.splitlines()[-3], flush=True)
    RESULT.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
