"""The maps of docs/maps.md: stick radius and critical friction over both compliances.

Run as ``python validation/physics/maps.py``; writes validation/results/map_stick_radius.png and
map_critical_friction.png.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from spectral_contact import Scene
from spectral_contact.sweeps import sweep
from spectral_contact.view.plotting import save, style

RESULTS = Path(__file__).parents[1] / "results"
#: Both maps are of kappa = 1/7, nu = 0.3.
NU, FRICTION = 0.3, 0.2
COARSE, FINE = np.geomspace(1e-3, 10.0, 61), np.geomspace(1e-3, 10.0, 201)


def stick_radius():
    """Solve the map of the stick radius."""
    return sweep(
        Scene(NU, friction=FRICTION),
        normal_compliance=COARSE,
        tangential_compliance=COARSE,
        quantities=["stick_radius", "zones"],
        rtol=1e-6,
    )


def critical_friction():
    """Solve the map of the critical friction and of the edge ratio."""
    return sweep(
        Scene(NU, friction=np.inf),
        normal_compliance=FINE,
        tangential_compliance=FINE,
        quantities=["critical_friction", "edge_ratio"],
        rtol=1e-8,
    )


def draw_stick_radius(found, critical) -> Figure:
    """Return c* cell by cell, the boundary of full stick, and where the edge sticks.

    Where slip starts inside, c* jumps to 1 at that boundary: cells show it.
    """
    with style():
        figure, axes = _axes(rf"$\nu = {NU}$, $f = {FRICTION}$")
        values = found.stick_radius.transpose("tangential_compliance", "normal_compliance")
        slips = values.where(values < 1.0)
        low = np.floor(20.0 * float(slips.min())) / 20.0
        cells = axes.pcolormesh(COARSE, COARSE, slips, cmap="viridis", vmin=low, vmax=1.0)
        axes.set_facecolor("#DDDDDD")
        axes.grid(visible=False)
        levels = np.arange(low + 0.05, 1.0, 0.05)
        lines = axes.contour(COARSE, COARSE, slips, levels, colors="white", linewidths=0.7)
        axes.clabel(lines, lines.levels[1::2], fmt="%.3g")
        figure.colorbar(cells, ax=axes, label="stick radius $c^*$")
        inside = (found.zone_kind == 1).sum("zone") > 1
        if inside.any():  # a stick disk, a slip annulus, and the edge sticks
            x, y = np.meshgrid(COARSE, COARSE)
            inner = inside.transpose(*values.dims).values
            axes.plot(x[inner], y[inner], "o", color="#D55E00", ms=2.2, mew=0.0)
            axes.text(
                *(0.012, 0.0065, "slip inside,\nthe edge sticks"),
                **{"color": "white", "fontweight": "bold"},
            )
            axes.plot([0.0105, 0.0045], [0.011, 0.026], color="white", lw=1.0)
        whole = critical.critical_friction.transpose(*values.dims)
        axes.contour(FINE, FINE, whole, [FRICTION], colors="black", linewidths=1.4)
        axes.text(0.05, 1.0, "full stick, $c^* = 1$")
    return figure


def draw_critical_friction(found) -> Figure:
    """Return contours of the critical friction, and where slip starts inside."""
    from matplotlib.colors import LogNorm

    with style():
        figure, axes = _axes(rf"$\nu = {NU}$")
        order = "tangential_compliance", "normal_compliance"
        values = found.critical_friction.transpose(*order).values
        # one list of levels for fills, lines and the bar
        series = np.array([a * 10.0**k for k in range(-4, 3) for a in (1.0, 2.0, 5.0)])
        first = np.searchsorted(series, values.min()) - 1
        levels = series[first : np.searchsorted(series, values.max()) + 1]
        norm = LogNorm(levels[0], levels[-1])
        filled = axes.contourf(FINE, FINE, values, levels, norm=norm, cmap="viridis")
        bar = figure.colorbar(filled, ax=axes, label="critical friction $f_c$")
        bar.set_ticks(levels, labels=[f"{level:g}" for level in levels])
        lines = axes.contour(FINE, FINE, values, levels[1:-1], colors="white", linewidths=0.8)
        axes.clabel(lines, lines.levels[lines.levels < 0.9 * values.max()], fmt="%g")
        axes.plot(FINE, FINE, "--", color="#D55E00", lw=1.2)
        axes.text(0.0013, 0.013, "slip starts inside", color="white")
        axes.text(0.25, 0.035, "slip starts at the edge", color="white")
    return figure


def _axes(title: str) -> tuple[Figure, Axes]:
    """Return a plane of compliances; its scales are there before labels are fitted to it."""
    figure = Figure(figsize=(5.8, 4.6), layout="constrained")
    axes = figure.add_subplot()
    axes.set(
        xscale="log",
        yscale="log",
        xlabel=r"normal compliance $\alpha^*$",
        ylabel=r"tangential compliance $\beta^*$",
        title=title,
        xlim=(FINE[0], FINE[-1]),
        ylim=(FINE[0], FINE[-1]),
    )
    return figure, axes


def main() -> None:
    """Solve and draw both maps."""
    stick = stick_radius()
    critical = critical_friction()
    for name, found, figure in (
        ("map_stick_radius", stick, draw_stick_radius(stick, critical)),
        ("map_critical_friction", critical, draw_critical_friction(critical)),
    ):
        assert (found.ending == "converged").all()
        save(figure, str(RESULTS / f"{name}.png"))
        print(name, found.ending.size, "scenes")


if __name__ == "__main__":
    main()
