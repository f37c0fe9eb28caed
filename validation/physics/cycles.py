"""Cycles of the load under a flat punch: loops, damping maps, the threshold, a bolted joint.

Run as ``python validation/physics/cycles.py``; writes docs/cycles_loop.png, docs/cycles_damping.png
and validation/results/cycles.md.
"""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.append(str(Path(__file__).parents[1]))

import numpy as np
from reporting import DOCS, table, write

from spectral_contact import Scene, damping_map, solve, steady_cycle
from spectral_contact.sweeps.cycle_pictures import draw_loop
from spectral_contact.view.figures import BLACK, BLUE, GREEN, VERMILION, new_figure, save, style

SCENE = Scene(0.1, 0.5, 0.5, 0.1)
#: Slip begins at the edge, and inside.
THRESHOLDS = {"edge": (SCENE, 2.0), "inside": (Scene(0.3, 0.05, 1.0, 0.03), 1.5)}
#: Lowest loads whose slip is drawn, and shares of the shakedown ratio that a loop is below it.
LOWEST = (0.03, 0.1, 0.15, 0.2)
BELOW = np.geomspace(3e-4, 0.8, 12)
#: The map: lowest loads and frictions.
MAP_LOADS = np.linspace(0.02, 0.98, 25)
MAP_FRICTIONS = np.geomspace(0.005, 0.15, 20)


def loops() -> None:
    """Draw a loop, and the slip of several."""
    with style():
        figure = new_figure(figsize=(8.4, 3.4), layout="constrained")
        loop, radius = figure.subplots(1, 2)
        s = np.linspace(0.0, 1.0, 500)
        for lowest, colour in zip(LOWEST, (BLACK, BLUE, GREEN, VERMILION), strict=True):
            cycle = steady_cycle(SCENE, lowest, rtol=1e-6)
            radius.plot(s, cycle.slip_amplitude(s), color=colour, label=rf"$\lambda = {lowest}$")
            if lowest == 0.1:
                draw_loop(loop, cycle)
        radius.set(xlim=(0.5, 1.0), ylim=(0.0, None), xlabel="radius $s = r/a$")
        radius.set_ylabel(r"slip on either way [$4(1-\nu^2)P/(aE)$]")
        radius.legend()
        save(figure, DOCS / "cycles_loop.png")


def damping() -> list[tuple[str, ...]]:
    """Draw the map and the threshold, and return the rows of a table of the latter."""
    found = damping_map(SCENE, MAP_LOADS, MAP_FRICTIONS, rtol=1e-4)
    rows = []
    with style():
        figure = new_figure(figsize=(8.4, 3.6), layout="constrained")
        plane, threshold = figure.subplots(1, 2)
        known = found.dissipation.where(found.dissipation > 0.0)
        mesh = plane.pcolormesh(MAP_LOADS, MAP_FRICTIONS, np.log10(known), shading="nearest")
        plane.plot(found.shakedown_ratio[:, 0], MAP_FRICTIONS, color=BLACK, label=r"$\lambda^*$")
        plane.set(yscale="log", xlabel=r"lowest load $\lambda$", ylabel="friction $f$")
        plane.set(xlim=(0.0, 1.0), ylim=(MAP_FRICTIONS[0], MAP_FRICTIONS[-1]))
        plane.legend(loc="upper right")
        figure.colorbar(mesh, ax=plane, label="lg of the dissipation")
        for (name, (scene, power)), colour in zip(THRESHOLDS.items(), (BLUE, GREEN), strict=True):
            ratio = solve(scene, 1e-12, ("shakedown_ratio",)).shakedown_ratio
            cycles = [steady_cycle(scene, (1.0 - one) * ratio, rtol=1e-4) for one in BELOW]
            lost = np.array([np.nan if c.dissipation is None else c.dissipation for c in cycles])
            threshold.loglog(BELOW, lost, "o-", color=colour, markersize=3, label=f"slip {name}")
            law = lost[0] * (BELOW / BELOW[0]) ** power
            threshold.loglog(BELOW, law, ":", color=BLACK, label=f"power {power:g}")
            for below, cycle in zip(BELOW, cycles, strict=True):
                if cycle.dissipation is not None:
                    values = f"{cycle.dissipation:.6e}", f"{cycle.error.dissipation:.0e}"
                    rows.append((name, f"{1.0 - below:.6f}", *values))
        threshold.set(xlabel=r"$1 - \lambda/\lambda^*$", ylabel="dissipation")
        threshold.legend()
        save(figure, DOCS / "cycles_damping.png")
    return rows


if __name__ == "__main__":
    loops()
    about = (
        "# Dissipation next to the shakedown ratio\n\n"
        "By validation/physics/cycles.py: slip at the edge with α = β = 0.5, ν = f = 0.1; inside "
        "with α = 0.05, β = 1, ν = 0.3, f = 0.03. In units of 4(1−ν²)P²/(aE)."
    )
    heading = "slip | λ/λ* | dissipation | error estimate"
    write("cycles", f"{about}\n\n{table(heading, damping())}")
