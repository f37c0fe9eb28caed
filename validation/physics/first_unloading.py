"""The figure of the first unloading: tractions, and the zones over the load.

Run as ``python validation/physics/first_unloading.py`` (a minute); writes docs/first_unloading.png.
"""

from __future__ import annotations

import numpy as np
from common import DOCS, picture

from spectral_contact import Scene, solve, sweep
from spectral_contact.view.figures import BLACK, BLUE, GREEN, VERMILION

SCENE = Scene(0.1, 0.5, 0.5, 0.1)
SHOWN = {1.0: BLACK, 0.8: BLUE, 0.5: GREEN, 0.2205: VERMILION}
#: The first are around the turning ratio.
RATIOS = [0.2201, 0.2205, 0.221, 0.2215, 0.2222, 0.23, 0.25, *np.arange(3, 10) / 10.0, 0.999]
BOUNDARIES = {
    "stick | slip": BLUE,
    "slip | stick with memory": GREEN,
    "memory | slip back": VERMILION,
}


def main() -> None:
    """Solve, and draw."""
    s = np.linspace(0.0, 1.0, 2001)
    asked = ["traction", "pressure"]
    fields = sweep(SCENE, unloaded_to=list(SHOWN), s=s, quantities=asked, progress=False)
    zones = sweep(SCENE, unloaded_to=RATIOS, quantities=["zones"], progress=False)
    thresholds = ["reverse_ratio", "turning_ratio"]
    known = solve(SCENE.replace(unloaded_to=0.8), 1e-8, thresholds, strict=False)
    with picture(DOCS / "first_unloading.png", (9.0, 3.6), columns=2) as (left, right):
        share = fields.traction / (SCENE.friction * fields.pressure)
        for ratio, colour in SHOWN.items():
            label = rf"$\lambda = {ratio:g}$"
            left.plot(s, share.sel(unloaded_to=ratio), color=colour, label=label)
        left.set(xlabel=r"$s = r/a$", ylabel=r"$q/(f p)$")
        left.legend()
        outer = zones.zone_outer.where(zones.zone_outer < 1.0)
        for k, (name, colour) in enumerate(BOUNDARIES.items()):
            right.plot(RATIOS, outer.isel(zone=k), color=colour, marker=".", label=name)
        for name in thresholds:
            right.axvline(getattr(known, name), color="0.5", linestyle="--", linewidth=0.8)
        right.set(xlabel=r"load ratio $\lambda$", ylabel="$s$")
        right.legend(loc="center right")


if __name__ == "__main__":
    main()
