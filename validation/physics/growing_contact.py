"""A growing frictional contact against an incremental march that shares nothing with the library.

Run as ``python validation/physics/growing_contact.py`` (some minutes); writes
validation/results/growing_contact.md. The march (tests/oracles/growing_rings.py) knows neither the
superposition nor the Volterra equation: midpoint collocation on rings of equal width that enter one
by one, stick where they are and slip by the law. It is of first order: its differences from the
solution halve with the rings, and what is left when the first order is taken out goes on falling.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator
from pathlib import Path

sys.path.append(str(Path(__file__).parents[1]))
sys.path.append(str(Path(__file__).parents[2] / "tests"))

from oracles.growing_rings import Marched, march
from reporting import table, write

from spectral_contact import Scene, Solution, __version__, profiles, solve

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
ABOUT = f"""# A growing contact against a march in increments

Relative differences of the march with so many rings from the solution, at contact radius 1 and
Poisson's ratio {NU}; *rest* is what is left of the last two without the error of first order. The
stick radius of the march is that of a ring. Written by `validation/physics/growing_contact.py`,
version {__version__}.

"""


def rows(solution: Solution, steps: list[Marched]) -> Iterator[tuple[str, ...]]:
    """Yield the cells of a scene, without what the scene is."""
    for name, its in (("load", "load"), ("total_shear", "shear"), ("approach", "approach")):
        truth = getattr(solution, name)
        off = [getattr(one, its) / truth - 1.0 for one in steps]
        rest = f"{2.0 * off[-1] - off[-2]:+.1e}"
        yield name.replace("_", " "), f"{truth:.6f}", *(f"{one:+.2e}" for one in off), rest
    radii = (f"{one.stick_radius:.3f}" for one in steps)
    yield "stick radius", f"{solution.stick_radius:.6f}", *radii, ""


def main() -> None:
    """Write the table."""
    kappa, cells = Scene(NU).kappa, []
    for profile, *layers, friction, coupling in CASES:
        given = {"profile": profile, "coupling": coupling, "contact_radius": 1.0}
        solution = solve(Scene(NU, *layers, friction, **given), RTOL, strict=False)
        steps = [
            march(profile.height, *layers, kappa, friction, n, coupled=coupling) for n in COUNTS
        ]
        own = type(profile).__name__, *layers, friction, "yes" if coupling else "no"
        cells += [(*own, *row) for row in rows(solution, steps)]
        print(*cells[-1], flush=True)
    counts = " | ".join(f"{n} rings" for n in COUNTS)
    heading = f"profile | alpha | beta | f | coupled | quantity | solution | {counts} | rest"
    write("growing_contact", ABOUT + table(heading, cells))


if __name__ == "__main__":
    main()
