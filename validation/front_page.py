"""The result picture of README.md and of the site: a punch that slips in an interior annulus.

Run as ``python validation/front_page.py``; writes docs/front_page.png in a second.
"""

from __future__ import annotations

import numpy as np
from reporting import DOCS, picture

from spectral_contact import Scene, solve
from spectral_contact.view.figures import SLIP_GREY, STICK_WHITE, VERMILION
from spectral_contact.view.plotting import scene_title

SCENES = Scene(0.1, 0.5, 0.5, friction=0.1), Scene(0.3, 0.05, 1.0, friction=0.0328)
COLOURS = {"stick": STICK_WHITE, "slip": SLIP_GREY}


def main() -> None:
    """Draw traction and its limit over the radius, a panel for each scene."""
    s = np.linspace(0.0, 1.0, 801)
    with picture(DOCS / "front_page.png", (8.6, 3.4), columns=2) as panels:
        for axes, scene in zip(panels, SCENES, strict=True):
            solution = solve(scene)
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
        panels[0].set_ylabel("$a^2 q / P$")
        lines, labels = panels[0].get_legend_handles_labels()
        axes.figure.legend(lines, labels, loc="outside lower center", ncols=2)


if __name__ == "__main__":
    main()
