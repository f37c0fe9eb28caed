"""The figure of the first unloading: tractions, and the zones over the load.

Run as ``python validation/physics/first_unloading.py`` (a minute); writes docs/first_unloading.png.
"""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from spectral_contact import Scene, solve
from spectral_contact.view.plotting import style

TARGET = Path(__file__).parents[2] / "docs" / "first_unloading.png"
SCENE = Scene(0.1, 0.5, 0.5, 0.1)
SHOWN = 1.0, 0.8, 0.5, 0.2205
RATIOS = (0.999, 0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3)
#: Around the turning ratio.
CLOSE = (0.25, 0.23, 0.2222, 0.2215, 0.221, 0.2205, 0.2201)
COLOURS = "#000000", "#0072B2", "#009E73", "#D55E00"


def main() -> None:
    """Solve, and draw."""
    with style():
        figure, (left, right) = plt.subplots(1, 2, figsize=(9.0, 3.6), layout="constrained")
        s = np.linspace(0.0, 1.0, 2001)
        for ratio, colour in zip(SHOWN, COLOURS, strict=True):
            asked = ["traction", "pressure"]
            found = solve(SCENE.replace(unloaded_to=ratio), 1e-8, asked)
            assert SCENE.friction is not None
            share = found.traction(s) / (SCENE.friction * found.pressure(s))
            left.plot(s, share, color=colour, label=rf"$\lambda = {ratio:g}$")
        left.set_xlabel(r"$s = r/a$")
        left.set_ylabel(r"$q/(f p)$")
        left.legend()
        boundaries: dict[int, list[tuple[float, float]]] = {0: [], 1: [], 2: []}
        for ratio in sorted((*RATIOS, *CLOSE)):
            found = solve(SCENE.replace(unloaded_to=ratio), 1e-8, ["zones"])
            for k, zone in enumerate(found.zones[:-1]):
                boundaries[k].append((ratio, zone.outer))
        names = "stick | slip", "slip | stick with memory", "memory | slip back"
        for (k, points), colour in zip(boundaries.items(), COLOURS[1:], strict=True):
            right.plot(*np.array(points).T, color=colour, marker=".", label=names[k])
        thresholds = ["reverse_ratio", "turning_ratio"]
        known = solve(SCENE.replace(unloaded_to=0.8), 1e-8, thresholds, strict=False)
        for name in thresholds:
            right.axvline(getattr(known, name), color="0.5", linestyle="--", linewidth=0.8)
        right.set_xlabel(r"load ratio $\lambda$")
        right.set_ylabel("$s$")
        right.legend(loc="center right")
        figure.savefig(TARGET, dpi=150)


if __name__ == "__main__":
    main()
