"""What the paper neglects: full stick and partial slip with and without elastic coupling.

Run as ``python validation/physics/coupling.py`` (some minutes); writes
validation/results/coupling.md and .png. Every number is a relative change, coupled over
uncoupled. Full stick is solved to 1e-10, partial slip to 1e-8.
"""

from __future__ import annotations

import math
import sys
from pathlib import Path
from typing import Any

sys.path.append(str(Path(__file__).parents[1]))

import numpy as np
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
INTEGRALS = ("approach", "total_shear", "stick_radius")
QUANTITIES = ("approach", "total_shear", "edge_pressure", "critical_friction")
TITLES = {
    "approach": r"approach $\delta^*$",
    "total_shear": "total shear $Q^*$",
    "edge_pressure": "pressure at the edge $p^*(1)$",
    "critical_friction": "critical friction",
}

Record = dict[str, Any]


def change(nu: float, alpha: float, beta: float) -> Record:
    """Return a scene, the relative changes that coupling makes, and where it would open."""
    pair = [
        solve(Scene(nu, alpha, beta, math.inf, coupling=coupling), RTOL)
        for coupling in (False, True)
    ]
    row: Record = {"nu": nu, "alpha": alpha, "beta": beta, "opening": pair[1].opening}
    for name in QUANTITIES:
        plain, coupled = (_value(solution, name) for solution in pair)
        known = math.isfinite(plain) and math.isfinite(coupled) and plain != 0.0
        row[name] = coupled / plain - 1.0 if known else None
    return row


def slip_change(nu: float, compliance: float, ratio: float) -> Record:
    """Return the relative changes that coupling makes to partial slip."""
    friction = ratio * kappa(nu)
    row: Record = {"nu": nu, "compliance": compliance, "friction": friction, "ratio": ratio}
    plain, coupled = (
        solve(Scene(nu, compliance, compliance, friction, coupling=coupling), SLIP_RTOL, INTEGRALS)
        for coupling in (False, True)
    )
    for name in INTEGRALS:
        row[name] = getattr(coupled, name) / getattr(plain, name) - 1.0
    row["plain_radius"], row["radius"] = plain.stick_radius, coupled.stick_radius
    return row


def _value(solution: Solution, name: str) -> float:
    if name == "edge_pressure":
        return float(solution.pressure(1.0))
    return float(getattr(solution, name))


def kappa(nu: float) -> float:
    """Return the coupling of a Poisson's ratio."""
    return Scene(nu).kappa


def study() -> Record:
    """Return everything that is measured."""
    curves = [(nu, 1.0) for nu in NUS] + [(nu, ratio) for ratio, nu in RATIOS]
    lines = [
        {"nu": nu, "ratio": r, "points": [change(nu, a, r * a) for a in CURVE]} for nu, r in curves
    ]
    grid = [change(nu, a, b) for nu in (0.0, 0.3) for a in GRID for b in GRID]
    slip = [slip_change(nu, *case) for nu in (0.0, 0.3) for case in SLIPPING]
    rows = [*grid, *slip, *(point for line in lines for point in line["points"])]
    return {
        "count": len(rows),
        "rtol": RTOL,
        "lines": lines,
        "grid": grid,
        "slip": slip,
    }


def page(record: Record) -> str:
    """Return the results as Markdown."""
    parts = [
        f"{record['count']} pairs of solves. At ν = 0 and, behind the stroke, ν = 0.3, in per cent:"
    ]
    for name, title in (("approach", "δ*"), ("total_shear", "Q*")):
        cells = [
            (
                f"{a:g}",
                *(
                    " / ".join(_percent(_found(record, nu, a, b)[name]) for nu in (0.0, 0.3))
                    for b in GRID
                ),
            )
            for a in GRID
        ]
        heading = [f"change of {title}: α* \\ β*", *(f"{b:g}" for b in GRID)]
        parts.append(table(" | ".join(heading), cells))
    cells = []
    for a in GRID:
        pair = [_found(record, nu, a, a) for nu in (0.0, 0.3)]
        both = (
            " / ".join(_over(row[name], kappa(row["nu"]) ** 2) for row in pair)
            for name in QUANTITIES
        )
        cells.append((f"{a:g}", *both))
    parts.append("With α* = β* the same over κ², at ν = 0 and 0.3:")
    parts.append(table("α* = β* | δ* | Q* | p*(1) | critical friction", cells))
    cells = [
        (
            *(f"{row[key]:g}" for key in ("nu", "compliance", "ratio")),
            *(f"{row[key]:.6f}" for key in ("plain_radius", "radius")),
            *(_percent(row[key]) for key in ("stick_radius", "total_shear", "approach")),
        )
        for row in record["slip"]
    ]
    parts.append("Partial slip at α* = β*, in per cent:")
    heading = "ν | α* = β* | f/κ | c* without | c* with | change of c* | of Q* | of δ*"
    parts.append(table(heading, cells))
    return "\n\n".join(parts)


def _found(record: Record, nu: float, alpha: float, beta: float) -> Record:
    """Return the row of the grid."""
    [row] = [
        row for row in record["grid"] if (row["nu"], row["alpha"], row["beta"]) == (nu, alpha, beta)
    ]
    return dict(row)


def _percent(share: float | None) -> str:
    return "–" if share is None else f"{100.0 * share:+.2g}"


def _over(share: float | None, square: float) -> str:
    return "–" if share is None else f"{share / square:+.2g}"


def draw(record: Record, path: Path) -> None:
    """Draw the changes over the compliance, in per cent."""
    with style():
        from matplotlib import colormaps
        from matplotlib.figure import Figure

        figure = Figure(figsize=(9.4, 6.6), layout="constrained")
        axes = figure.subplots(2, 2, sharex=True)
        for one, name in zip(axes.flat, QUANTITIES, strict=True):
            for line in record["lines"]:
                points = [p for p in line["points"] if p[name] is not None]
                number = NUS.index(line["nu"])
                dash = {1.0: "-", 10.0: "--", 0.1: ":"}[line["ratio"]]
                text = rf"$\nu = {line['nu']:g}$"
                if line["ratio"] != 1.0:
                    text += rf", $\beta^* = {line['ratio']:g}\,\alpha^*$"
                one.plot(
                    [p["alpha"] for p in points],
                    [100.0 * p[name] for p in points],
                    dash,
                    color=colormaps["viridis"](number / len(NUS)),
                    label=text,
                )
            one.set_xscale("log")
            one.set_title(TITLES[name])
            one.set_ylabel("change by coupling [%]")
        for one in axes[1]:
            one.set_xlabel(r"$\alpha^*$ ($\beta^* = \alpha^*$ where nothing is said)")
        axes[1, 1].set_ylim(0.0, 150.0)
        axes[0, 0].legend(fontsize=7.5)
        save(figure, str(path))


def main() -> None:
    """Measure, draw and print."""
    record = study()
    write("coupling", page(record))
    draw(record, RESULTS / "coupling.png")


if __name__ == "__main__":
    main()
