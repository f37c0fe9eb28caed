"""What the paper neglects: full stick and partial slip with and without elastic coupling.

Run as ``python validation/physics/coupling.py`` (some minutes); writes
validation/results/coupling.md and .png. Every number is a relative change, coupled over
uncoupled. Full stick is solved to 1e-10, partial slip to 1e-8.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
from common import RESULTS, picture, table, write
from matplotlib import colormaps

from spectral_contact import Scene, solve, sweep

RTOL, SLIP_RTOL = 1e-10, 1e-8
NUS = (0.0, 0.1, 0.2, 0.3, 0.4)
#: Compliances of the curves, and the ratios beta/alpha at the middle nu.
CURVE = [float(f"{value:.3g}") for value in np.geomspace(1e-6, 100.0, 49)]
RATIOS = ((0.1, 0.3), (10.0, 0.3))
#: Compliances of the table, both ways.
GRID = (0.0, 1e-4, 1e-2, 0.1, 0.5, 1.0, 10.0)
#: Compliances and friction over kappa of partial slip.
SLIPPING = [
    (a, ratio)
    for a, ratios in ((0.0, (1.0, 2.0)), (0.01, (0.5, 1.0)), (0.1, (0.2, 0.5)), (0.5, (0.2, 0.5)))
    for ratio in ratios
]
INTEGRALS = ("stick_radius", "total_shear", "approach")
#: Of full stick, with their titles.
TITLES = {
    "approach": r"approach $\delta^*$",
    "total_shear": "total shear $Q^*$",
    "pressure": "pressure at the edge $p^*(1)$",
    "critical_friction": "critical friction",
}


def changes(scenes: Scene | list[Scene], **axes: Any) -> dict[str, np.ndarray]:
    """Return the relative changes that coupling makes; NaN where one of two is infinite or 0."""
    asked = {"quantities": list(TITLES), "from_edge": [0.0], "rtol": RTOL, "progress": False}
    plain, coupled = (sweep(scenes, **axes, coupling=one, **asked) for one in (False, True))
    found = {}
    for name in TITLES:
        before, after = (one[name].values.squeeze() for one in (plain, coupled))
        known = np.isfinite(before) & np.isfinite(after) & (before != 0.0)
        with np.errstate(invalid="ignore", divide="ignore"):
            found[name] = np.where(known, after / before - 1.0, np.nan)
    return found


def slip_cells(nu: float, compliance: float, ratio: float) -> tuple[str, ...]:
    """Return stick radii of partial slip without and with coupling, and the relative changes."""
    friction = ratio * Scene(nu).kappa
    plain, coupled = (
        solve(Scene(nu, compliance, compliance, friction, coupling=coupling), SLIP_RTOL, INTEGRALS)
        for coupling in (False, True)
    )
    return (
        *(f"{value:g}" for value in (nu, compliance, ratio)),
        *(f"{one.stick_radius:.6f}" for one in (plain, coupled)),
        *(_signed(100.0 * (getattr(coupled, n) / getattr(plain, n) - 1.0)) for n in INTEGRALS),
    )


def page(pairs: int) -> str:
    """Return the tables as Markdown; so many pairs of solves are in the picture."""
    axes = {"normal_compliance": GRID, "tangential_compliance": GRID}
    grids = {nu: changes(Scene(nu, friction=math.inf), **axes) for nu in (0.0, 0.3)}
    slip = [slip_cells(nu, *case) for nu in grids for case in SLIPPING]
    pairs += len(grids) * len(GRID) ** 2 + len(slip)
    parts = [f"{pairs} pairs of solves. At ν = 0 and, behind the stroke, ν = 0.3, in per cent:"]
    for name, title in (("approach", "δ*"), ("total_shear", "Q*")):
        cells = [
            (f"{a:g}", *(" / ".join(map(_signed, pair)) for pair in 100.0 * np.transpose(both)))
            for a, *both in zip(GRID, *(grid[name] for grid in grids.values()), strict=True)
        ]
        heading = [f"change of {title}: α* \\ β*", *(f"{b:g}" for b in GRID)]
        parts.append(table(" | ".join(heading), cells))
    equal = [
        [
            " / ".join(
                _signed(grid[name][i, i] / Scene(nu).kappa ** 2) for nu, grid in grids.items()
            )
            for name in TITLES
        ]
        for i in range(len(GRID))
    ]
    parts.append("With α* = β* the same over κ², at ν = 0 and 0.3:")
    rows = ((f"{a:g}", *cells) for a, cells in zip(GRID, equal, strict=True))
    parts.append(table("α* = β* | δ* | Q* | p*(1) | critical friction", rows))
    parts.append("Partial slip at α* = β*, in per cent:")
    heading = "ν | α* = β* | f/κ | c* without | c* with | change of c* | of Q* | of δ*"
    parts.append(table(heading, slip))
    return "\n\n".join(parts)


def _signed(number: float) -> str:
    return "–" if math.isnan(number) else f"{number:+.2g}"


def draw(path: Path) -> int:
    """Draw the changes over the compliance, in per cent; return the number of pairs of solves."""
    lines = [(nu, 1.0) for nu in NUS] + [(nu, ratio) for ratio, nu in RATIOS]
    with picture(path, (9.4, 6.6), 2, 2, sharex=True) as axes:
        for nu, ratio in lines:
            found = changes([Scene(nu, alpha, ratio * alpha, math.inf) for alpha in CURVE])
            text = rf"$\nu = {nu:g}$"
            if ratio != 1.0:
                text += rf", $\beta^* = {ratio:g}\,\alpha^*$"
            look = {
                "ls": {1.0: "-", 10.0: "--", 0.1: ":"}[ratio],
                "color": colormaps["viridis"](NUS.index(nu) / len(NUS)),
                "label": text,
            }
            for one, name in zip(axes.flat, TITLES, strict=True):
                one.plot(CURVE, 100.0 * found[name], **look)
        for one, title in zip(axes.flat, TITLES.values(), strict=True):
            one.set(xscale="log", title=title, ylabel="change by coupling [%]")
        for one in axes[1]:
            one.set_xlabel(r"$\alpha^*$ ($\beta^* = \alpha^*$ where nothing is said)")
        axes[1, 1].set_ylim(0.0, 150.0)
        axes[0, 0].legend(fontsize=7.5)
    return len(lines) * len(CURVE)


if __name__ == "__main__":
    write("coupling", page(draw(RESULTS / "coupling.png")))
