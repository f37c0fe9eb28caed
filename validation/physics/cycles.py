"""Cycles of the load under a flat punch: loops, a damping map, and the threshold of shakedown.

Run as ``python validation/physics/cycles.py``; writes docs/cycles_loop.png and
docs/cycles_damping.png.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from common import DOCS, picture

from spectral_contact import Scene, damping_map, solve, steady_cycle
from spectral_contact.sweeps.cycle_pictures import draw_loop
from spectral_contact.view.figures import BLACK, BLUE, GREEN, VERMILION

SCENE = Scene(0.1, 0.5, 0.5, 0.1)
#: Slip begins at the edge, and inside: the scene, and the power of the dissipation.
THRESHOLDS = {"edge": (SCENE, 2.0, BLUE), "inside": (Scene(0.3, 0.05, 1.0, 0.03), 1.5, GREEN)}
#: Lowest loads whose slip is drawn, and shares of the shakedown ratio that a loop is below it.
LOWEST = (0.03, 0.1, 0.15, 0.2)
BELOW = np.geomspace(3e-4, 0.8, 12)
#: The map: lowest loads and frictions.
MAP_LOADS = np.linspace(0.02, 0.98, 25)
MAP_FRICTIONS = np.geomspace(0.005, 0.15, 20)


def loops() -> None:
    """Draw a loop, and the slip of several."""
    with picture(DOCS / "cycles_loop.png", (8.4, 3.4), columns=2) as (loop, radius):
        s = np.linspace(0.0, 1.0, 500)
        for lowest, colour in zip(LOWEST, (BLACK, BLUE, GREEN, VERMILION), strict=True):
            cycle = steady_cycle(SCENE, lowest, rtol=1e-6)
            radius.plot(s, cycle.slip_amplitude(s), color=colour, label=rf"$\lambda = {lowest}$")
            if lowest == 0.1:
                draw_loop(loop, cycle)
        radius.set(xlim=(0.5, 1.0), ylim=(0.0, None), xlabel="radius $s = r/a$")
        radius.set_ylabel(r"slip on either way [$4(1-\nu^2)P/(aE)$]")
        radius.legend()


def damping() -> None:
    """Draw the map, and the dissipation next to the shakedown ratio."""
    found = damping_map(SCENE, MAP_LOADS, MAP_FRICTIONS, rtol=1e-4)
    with picture(DOCS / "cycles_damping.png", (8.4, 3.6), columns=2) as (plane, threshold):
        known = found.dissipation.where(found.dissipation > 0.0)
        mesh = plane.pcolormesh(MAP_LOADS, MAP_FRICTIONS, np.log10(known), shading="nearest")
        plane.plot(found.shakedown_ratio[:, 0], MAP_FRICTIONS, color=BLACK, label=r"$\lambda^*$")
        plane.set(yscale="log", xlabel=r"lowest load $\lambda$", ylabel="friction $f$")
        plane.set(xlim=(0.0, 1.0), ylim=(MAP_FRICTIONS[0], MAP_FRICTIONS[-1]))
        plane.legend(loc="upper right")
        plane.figure.colorbar(mesh, ax=plane, label="lg of the dissipation")
        for name, case in THRESHOLDS.items():
            draw_threshold(threshold, name, *case)
        threshold.set(xlabel=r"$1 - \lambda/\lambda^*$", ylabel="dissipation")
        threshold.legend()


def draw_threshold(axes: Any, name: str, scene: Scene, power: float, colour: str) -> None:
    """Draw the dissipation of loops below the shakedown ratio, and a power law."""
    ratio = solve(scene, 1e-12, ("shakedown_ratio",)).shakedown_ratio
    cycles = [steady_cycle(scene, (1.0 - one) * ratio, rtol=1e-4) for one in BELOW]
    lost = np.array([one.dissipation for one in cycles], dtype=float)  # None becomes NaN
    axes.loglog(BELOW, lost, "o-", color=colour, markersize=3, label=f"slip {name}")
    law = lost[0] * (BELOW / BELOW[0]) ** power
    axes.loglog(BELOW, law, ":", color=BLACK, label=f"power {power:g}")


if __name__ == "__main__":
    loops()
    damping()
