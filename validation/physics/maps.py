"""The maps of docs/maps.md: stick radius and critical friction over both compliances.

Run as ``python validation/physics/maps.py``; writes validation/results/map_stick_radius.png and
map_critical_friction.png.
"""

from __future__ import annotations

import numpy as np
from common import RESULTS, picture
from matplotlib.ticker import LogLocator

from spectral_contact import Scene
from spectral_contact.sweeps import plot_slice, sweep
from spectral_contact.view.figures import BLACK, STICK_WHITE, VERMILION, save, style

#: Both maps are of kappa = 1/7, nu = 0.3.
NU, FRICTION = 0.3, 0.2
PLANE = ("tangential_compliance", "normal_compliance")
COARSE, FINE = np.geomspace(1e-3, 10.0, 61), np.geomspace(1e-3, 10.0, 201)


def solved(friction, compliances, quantities, rtol):
    """Solve a map over both compliances; every scene converges."""
    found = sweep(
        Scene(NU, friction=friction),
        normal_compliance=compliances,
        tangential_compliance=compliances,
        quantities=quantities,
        rtol=rtol,
    )
    assert (found.ending == "converged").all()
    return found


def draw_stick_radius(found, critical) -> None:
    """Draw c* cell by cell, the boundary of full stick, and where the edge sticks.

    Where slip starts inside, c* jumps to 1 at that boundary: cells show it.
    """
    slips = found.stick_radius.where(found.stick_radius < 1.0).transpose(*PLANE)
    figure = plot_slice(found.assign(stick_radius=slips), "stick_radius")
    with style():
        axes = figure.axes[0]
        axes.set_facecolor(STICK_WHITE)
        axes.grid(visible=False)
        levels = np.arange(np.floor(20.0 * slips.min()) / 20.0, 1.0, 0.05)
        lines = axes.contour(COARSE, COARSE, slips, levels, colors="white", linewidths=0.7)
        axes.clabel(lines, lines.levels[::2], fmt="%.3g")
        # a stick disk, a slip annulus, and the edge sticks
        inside = ((found.zone_kind == 1).sum("zone") > 1).transpose(*PLANE).values
        x, y = np.meshgrid(COARSE, COARSE)
        axes.plot(x[inside], y[inside], "o", color=VERMILION, ms=2.2, mew=0.0)
        axes.text(0.0025, 0.009, "dots: slip inside, the edge sticks", color="white")
        whole = critical.critical_friction.transpose(*PLANE)
        axes.contour(FINE, FINE, whole, [FRICTION], colors=BLACK, linewidths=1.4)
        axes.text(0.05, 1.0, "full stick, $c^* = 1$")
    save(figure, RESULTS / "map_stick_radius.png")


def draw_critical_friction(found) -> None:
    """Draw contours of the critical friction, and where slip starts inside."""
    values = found.critical_friction.transpose(*PLANE).values
    with picture(RESULTS / "map_critical_friction.png", (5.6, 4.2)) as axes:
        axes.set(xscale="log", yscale="log", title=rf"$\nu = {NU}$")
        axes.set(xlabel=r"normal compliance $\alpha^*$", ylabel=r"tangential compliance $\beta^*$")
        filled = axes.contourf(FINE, FINE, values, locator=LogLocator(subs=(1.0, 2.0, 5.0)))
        levels = filled.levels
        label = "critical friction $f_c$"
        axes.figure.colorbar(filled, ax=axes, ticks=levels, format="%g", label=label)
        lines = axes.contour(FINE, FINE, values, levels[1:-1], colors="white", linewidths=0.8)
        axes.clabel(lines, fmt="%g")
        axes.plot(FINE, FINE, "--", color=VERMILION, lw=1.2)
        axes.text(0.0013, 0.013, "slip starts inside", color="white")
        axes.text(0.25, 0.035, "slip starts at the edge", color="white")


def main() -> None:
    """Solve and draw both maps."""
    stick = solved(FRICTION, COARSE, ["stick_radius", "zones"], 1e-6)
    critical = solved(np.inf, FINE, ["critical_friction"], 1e-8)
    draw_stick_radius(stick, critical)
    draw_critical_friction(critical)


if __name__ == "__main__":
    main()
