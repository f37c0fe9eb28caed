"""What the paper neglects: full stick and partial slip with and without elastic coupling.

Run as ``python validation/physics/coupling.py`` (some minutes); writes
validation/results/coupling.md and .png. Every number is a relative change, coupled over
uncoupled. Full stick is solved to 1e-10, partial slip to 1e-8.
"""

from __future__ import annotations

import itertools
import math
import sys
from pathlib import Path

sys.path.append(str(Path(__file__).parents[1]))

import numpy as np
from matplotlib import colormaps
from matplotlib.figure import Figure
from reporting import RESULTS, table, write

from spectral_contact import Scene, Solution, solve
from spectral_contact.view.plotting import save, style

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
QUANTITIES = ("approach", "total_shear", "edge_pressure", "critical_friction")
TITLES = {
    "approach": r"approach $\delta^*$",
    "total_shear": "total shear $Q^*$",
    "edge_pressure": "pressure at the edge $p^*(1)$",
    "critical_friction": "critical friction",
}

#: Relative changes by quantity; None where one of the two is infinite or zero.
Changes = dict[str, float | None]


def change(nu: float, alpha: float, beta: float) -> Changes:
    """Return the relative changes that coupling makes to full stick."""
    plain, coupled = (
        solve(Scene(nu, alpha, beta, math.inf, coupling=coupling), RTOL)
        for coupling in (False, True)
    )
    found: Changes = {}
    for name in QUANTITIES:
        before, after = _value(plain, name), _value(coupled, name)
        known = math.isfinite(before) and math.isfinite(after) and before != 0.0
        found[name] = after / before - 1.0 if known else None
    return found


def slip_cells(nu: float, compliance: float, ratio: float) -> tuple[str, ...]:
    """Return stick radii of partial slip without and with coupling, and the relative changes."""
    friction = ratio * kappa(nu)
    plain, coupled = (
        solve(Scene(nu, compliance, compliance, friction, coupling=coupling), SLIP_RTOL, INTEGRALS)
        for coupling in (False, True)
    )
    changes = (getattr(coupled, name) / getattr(plain, name) - 1.0 for name in INTEGRALS)
    return (
        *(f"{value:g}" for value in (nu, compliance, ratio)),
        *(f"{one.stick_radius:.6f}" for one in (plain, coupled)),
        *map(_percent, changes),
    )


def _value(solution: Solution, name: str) -> float:
    if name == "edge_pressure":
        return float(solution.pressure(1.0))
    return float(getattr(solution, name))


def kappa(nu: float) -> float:
    """Return the coupling of a Poisson's ratio."""
    return Scene(nu).kappa


def page(pairs: int) -> str:
    """Return the tables as Markdown; so many pairs of solves are in the picture."""
    grid = {(nu, a, b): change(nu, a, b) for nu, a, b in itertools.product((0.0, 0.3), GRID, GRID)}
    slip = [slip_cells(nu, *case) for nu in (0.0, 0.3) for case in SLIPPING]
    pairs += len(grid) + len(slip)
    parts = [f"{pairs} pairs of solves. At ν = 0 and, behind the stroke, ν = 0.3, in per cent:"]
    for name, title in (("approach", "δ*"), ("total_shear", "Q*")):
        cells = []
        for a in GRID:
            both = ((grid[0.0, a, b][name], grid[0.3, a, b][name]) for b in GRID)
            cells.append((f"{a:g}", *(" / ".join(map(_percent, pair)) for pair in both)))
        heading = [f"change of {title}: α* \\ β*", *(f"{b:g}" for b in GRID)]
        parts.append(table(" | ".join(heading), cells))
    cells = []
    for a in GRID:
        both = (
            " / ".join(_over(grid[nu, a, a][name], kappa(nu) ** 2) for nu in (0.0, 0.3))
            for name in QUANTITIES
        )
        cells.append((f"{a:g}", *both))
    parts.append("With α* = β* the same over κ², at ν = 0 and 0.3:")
    parts.append(table("α* = β* | δ* | Q* | p*(1) | critical friction", cells))
    parts.append("Partial slip at α* = β*, in per cent:")
    heading = "ν | α* = β* | f/κ | c* without | c* with | change of c* | of Q* | of δ*"
    parts.append(table(heading, slip))
    return "\n\n".join(parts)


def _percents(share: float | None) -> float:
    return math.nan if share is None else 100.0 * share


def _percent(share: float | None) -> str:
    return "–" if share is None else f"{_percents(share):+.2g}"


def _over(share: float | None, square: float) -> str:
    return "–" if share is None else f"{share / square:+.2g}"


def draw(path: Path) -> int:
    """Draw the changes over the compliance, in per cent; return the number of pairs of solves."""
    lines = [(nu, 1.0) for nu in NUS] + [(nu, ratio) for ratio, nu in RATIOS]
    with style():
        figure = Figure(figsize=(9.4, 6.6), layout="constrained")
        axes = figure.subplots(2, 2, sharex=True)
        for nu, ratio in lines:
            points = [change(nu, alpha, ratio * alpha) for alpha in CURVE]
            text = rf"$\nu = {nu:g}$"
            if ratio != 1.0:
                text += rf", $\beta^* = {ratio:g}\,\alpha^*$"
            look = {
                "ls": {1.0: "-", 10.0: "--", 0.1: ":"}[ratio],
                "color": colormaps["viridis"](NUS.index(nu) / len(NUS)),
                "label": text,
            }
            for one, name in zip(axes.flat, QUANTITIES, strict=True):
                one.plot(CURVE, [_percents(point[name]) for point in points], **look)
        for one, name in zip(axes.flat, QUANTITIES, strict=True):
            one.set_xscale("log")
            one.set_title(TITLES[name])
            one.set_ylabel("change by coupling [%]")
        for one in axes[1]:
            one.set_xlabel(r"$\alpha^*$ ($\beta^* = \alpha^*$ where nothing is said)")
        axes[1, 1].set_ylim(0.0, 150.0)
        axes[0, 0].legend(fontsize=7.5)
        save(figure, str(path))
    return len(lines) * len(CURVE)


if __name__ == "__main__":
    write("coupling", page(draw(RESULTS / "coupling.png")))
