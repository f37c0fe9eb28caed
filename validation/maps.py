"""The maps of docs/maps.md: stick radius and critical friction over both compliances.

Run as ``python validation/maps.py``; writes validation/results/map_stick_radius.png and
map_critical_friction.png, and the numbers as map_stick_radius.csv and map_critical_friction.csv.
"""

from __future__ import annotations

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("OMP_NUM_THREADS", "1")

import sys
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from spectral_contact import Scene
from spectral_contact.plotting import save, style
from spectral_contact.sweep import sweep

RESULTS = Path(__file__).parent / "results"
#: Both maps are of kappa = 1/7, nu = 0.3.
NU, FRICTION = 0.3, 0.2
COARSE, FINE = np.geomspace(1e-3, 10.0, 31), np.geomspace(1e-3, 10.0, 201)


def stick_radius():
    """Solve the map of the stick radius."""
    return sweep(
        Scene(NU, friction=FRICTION),
        normal_compliance=COARSE,
        tangential_compliance=COARSE,
        quantities=["stick_radius", "zones"],
        rtol=1e-6,
        progress=sys.stderr.isatty(),
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
    """Return filled contours of c*, the boundary of full stick, and where the edge sticks."""
    with style():
        figure, axes = _axes(rf"$\nu = {NU}$, $f = {FRICTION}$")
        values = found.stick_radius.transpose("tangential_compliance", "normal_compliance")
        filled = axes.contourf(COARSE, COARSE, values, np.linspace(0.0, 1.0, 11), cmap="viridis")
        lines = axes.contour(
            COARSE, COARSE, values, [0.1, 0.3, 0.5, 0.7, 0.9], colors="white", linewidths=0.8
        )
        axes.clabel(lines, fmt="%g")
        figure.colorbar(filled, ax=axes, label="stick radius $c^*$")
        inside = (found.zone_kind == 1).sum("zone") > 1
        if inside.any():  # a stick disk, a slip annulus, and the edge sticks
            where = np.argwhere(inside.transpose(*values.dims).values)
            axes.plot(
                COARSE[where[:, 1]], COARSE[where[:, 0]], "o", color="#D55E00", ms=3.5, mew=0.0
            )
            axes.text(0.0012, 0.007, "slip inside,\nthe edge sticks", color="#D55E00")
        whole = critical.critical_friction.transpose(*values.dims)
        axes.contour(FINE, FINE, whole, [FRICTION], colors="black", linewidths=1.4)
        axes.text(0.05, 1.0, "full stick")
    return figure


def draw_critical_friction(found) -> Figure:
    """Return contours of the critical friction, and where slip starts inside."""
    with style():
        figure, axes = _axes(rf"$\nu = {NU}$")
        order = "tangential_compliance", "normal_compliance"
        values = found.critical_friction.transpose(*order).values
        levels = [1e-3, 3e-3, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0]
        filled = axes.contourf(
            FINE, FINE, np.log10(values), np.linspace(-3.0, 0.5, 15), cmap="viridis", extend="both"
        )
        bar = figure.colorbar(filled, ax=axes, label="critical friction $f_c$")
        bar.set_ticks([-3.0, -2.0, -1.0, 0.0], labels=["0.001", "0.01", "0.1", "1"])
        lines = axes.contour(FINE, FINE, values, levels, colors="white", linewidths=0.8)
        axes.clabel(lines, fmt="%g")
        axes.plot(FINE, FINE, "--", color="#D55E00", lw=1.2)
        axes.text(0.0015, 0.016, "slip starts inside", color="white")
        axes.text(0.25, 0.04, "slip starts at the edge", color="white")
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
    """Solve, store and draw both maps."""
    stick = stick_radius()
    critical = critical_friction()
    for name, found, figure in (
        ("map_stick_radius", stick, draw_stick_radius(stick, critical)),
        ("map_critical_friction", critical, draw_critical_friction(critical)),
    ):
        assert (found.ending == "converged").all()
        save(figure, str(RESULTS / f"{name}.png"))
        print(name, found.ending.size, "scenes")
    numbers = stick[["stick_radius", "stick_radius_error"]].to_dataframe().reset_index()
    numbers.to_csv(RESULTS / "map_stick_radius.csv", index=False)
    some = critical.isel(
        normal_compliance=slice(0, None, 10), tangential_compliance=slice(0, None, 10)
    )
    numbers = some.drop_vars(["ending", "message"]).to_dataframe().reset_index()
    numbers.to_csv(RESULTS / "map_critical_friction.csv", index=False)


if __name__ == "__main__":
    main()
