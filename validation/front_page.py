"""The result picture of README.md and of the site: a punch that slips in an interior annulus.

Run as ``python validation/front_page.py``; writes docs/front_page.png in a second.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from spectral_contact import Scene, Solution, solve
from spectral_contact.view.figures import SLIP_GREY, STICK_WHITE, VERMILION
from spectral_contact.view.plotting import save, scene_title, style

PICTURE = Path(__file__).parents[1] / "docs" / "front_page.png"
SCENES = Scene(0.1, 0.5, 0.5, friction=0.1), Scene(0.3, 0.05, 1.0, friction=0.0328)
COLOURS = {"stick": STICK_WHITE, "slip": SLIP_GREY}


def draw(solutions: list[Solution]) -> Figure:
    """Return traction and its limit over the radius, a panel for each solution."""
    s = np.linspace(0.0, 1.0, 801)
    with style():
        figure = Figure(figsize=(8.6, 3.4), layout="constrained")
        for axes, solution in zip(figure.subplots(1, len(solutions)), solutions, strict=True):
            limit = solution.scene.friction * solution.pressure(s)
            axes.plot(s, limit, "--", color="black", label="limit of friction, $f p^*$")
            axes.plot(s, solution.traction(s), color=VERMILION, lw=2.0, label="traction $q^*$")
            top = 1.25 * float(limit.max())
            for zone in solution.zones:
                axes.axvspan(zone.inner, zone.outer, color=COLOURS[zone.kind], lw=0.0, zorder=0.5)
                middle = (zone.inner + zone.outer) / 2.0
                place = {"ha": "center", "va": "top"}
                narrow = zone.outer - zone.inner < 0.1
                axes.text(middle, 0.98 * top, zone.kind, rotation=90.0 * narrow, **place)
            axes.set(xlim=(0.0, 1.0), ylim=(0.0, top), xlabel="radius $s = r / a$")
            axes.set_title(scene_title(solution.scene))
        figure.axes[0].set_ylabel("$a^2 q / P$")
        handles, labels = figure.axes[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=2)
    return figure


def main() -> None:
    """Solve both scenes and draw them."""
    save(draw([solve(scene) for scene in SCENES]), PICTURE)


if __name__ == "__main__":
    main()
