"""Whether the corrections of Newton's method through nonlinear layers are quadratic.

Run as ``python validation/physics/newton_layers.py``; writes validation/results/newton_layers.md:
by how much of the largest pressure every correction in the last space moves it. Quadratic is that
a correction is at most a number, the same for all of them, times the square of the one before.
"""

from __future__ import annotations

import sys
from itertools import pairwise
from pathlib import Path

sys.path.append(str(Path(__file__).parents[1]))

import numpy as np
from reporting import table, write

from spectral_contact import Scene, layers, profiles, solve
from spectral_contact.contact.layered_newton import LayeredNewton

BALL = profiles.Parabola(1.0)


def scene(layer: layers.Layer, profile: profiles.Profile = BALL, **given: float) -> Scene:
    """Return a scene through a layer, under a ball if nothing else is said."""
    return Scene(0.3, layer=layer, profile=profile, **given)


SCENES = {
    "Abaqus' exponential, load 1": scene(layers.Exponential(0.1, 0.2), load=1.0),
    "CalculiX' exponential, approach 0.5": scene(
        layers.CalculixExponential(0.1, 0.2), approach=0.5
    ),
    "power 2, contact radius 1": scene(layers.PowerLaw(5.0, 2.0), contact_radius=1.0),
    "power 3 under a cone, load 1": scene(layers.PowerLaw(5.0, 3.0), profiles.Cone(1.2), load=1.0),
    "power 2 under a flat punch, load 1": scene(
        layers.PowerLaw(5.0, 2.0), profiles.Flat(1.0), load=1.0
    ),
    "rough spheres, approach 3": scene(layers.GreenwoodWilliamson(10.0, 1.0, 0.5), approach=3.0),
    "rough spheres, stiff, load 1": scene(layers.GreenwoodWilliamson(1e6, 1e-3, 1e-3), load=1.0),
}
#: Above it corrections are not yet Newton's last ones, below it they are rounding.
LARGE, ROUNDING = 0.1, 1e-12


class Recorded:
    """Newton's method as it is, with what every correction moves."""

    def __init__(self) -> None:
        self.sizes: list[list[float]] = []
        solve, correction = LayeredNewton.solve, LayeredNewton._correction

        def run(newton, w, shift):
            self.sizes.append([])
            return solve(newton, w, shift)

        def correct(newton, w, at, shift):
            step = correction(newton, w, at, shift)
            with np.errstate(over="ignore", invalid="ignore"):
                here = newton.setting.pressure(at)
                there = newton.setting.pressure(at + newton.sampling.values(step.overclosure))
            most = max(float(here.max()), float(there.max()))
            self.sizes[-1].append(float(np.abs(there - here).max()) / most)
            return step

        LayeredNewton.solve, LayeredNewton._correction = run, correct


def main() -> None:
    """Write the table."""
    recorded, rows = Recorded(), []
    for name, one in SCENES.items():
        recorded.sizes.clear()
        solve(one, 1e-12)
        sizes = max(recorded.sizes, key=len)
        ratios = [
            after / before**2
            for before, after in pairwise(sizes)
            if before < LARGE and after > ROUNDING
        ]
        most = f"{max(ratios):.2g}" if ratios else "none"
        rows.append((name, " ".join(f"{size:.0e}" for size in sizes), most))
    about = (
        "# Newton's method through nonlinear layers\n\n"
        "Every correction of the longest run of a scene at `rtol=1e-12`, as a part of the largest "
        "pressure, by validation/physics/newton_layers.py. The last column is the largest ratio of "
        f"a correction to the square of the one before, of those below {LARGE:g} and above "
        f"{ROUNDING:g}."
    )
    write("newton_layers", f"{about}\n\n{table('scene | corrections | ratio', rows)}")


if __name__ == "__main__":
    main()
