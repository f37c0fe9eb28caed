"""How good is the linear layer? Tangent and secant at the mean pressure against the law itself.

Run as ``python validation/physics/linear_layer.py`` (a minute or two); writes
validation/results/linear_layer.md, docs/linear_layer.png and docs/stiffness_exponent.png.

A flat punch of radius 1 and a ball (a parabola of radius 1) are pressed on layers, E' being 1. Of
the layer a user would take the compliance at the mean pressure ``P/(pi a^2)``: that of the tangent,
``dw/dp``, or that of the secant, ``w/p`` with w from where the pressure begins. The abscissa is
what the user knows: the tangent's ``alpha* = alpha E'/a``.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi
from pathlib import Path

import matplotlib as mpl
import matplotlib.lines
import matplotlib.ticker

mpl.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
from numpy.typing import NDArray

from spectral_contact import Scene, Solution, __version__, layers, profiles, solve, sweep

REPOSITORY = Path(__file__).parents[2]
RESULT = REPOSITORY / "validation" / "results" / "linear_layer.md"
PICTURE = REPOSITORY / "docs" / "linear_layer.png"
EXPONENTS = REPOSITORY / "docs" / "stiffness_exponent.png"
RTOL = 1e-8
#: Pressures of the laws at overclosure 1, or beyond their clearance.
LAWS = {
    "power law, m = 1.5": layers.PowerLaw(1.0, 1.5),
    "power law, m = 2": layers.PowerLaw(1.0, 2.0),
    "power law, m = 3": layers.PowerLaw(1.0, 3.0),
    "exponential (Abaqus)": layers.Exponential(0.1, 0.1),
}
OPEN = {
    "Gaussian heights": layers.GreenwoodWilliamson(3.0, 0.1, 0.05),
    "CalculiX": layers.CalculixExponential(0.01, 0.2),
}
#: Loads for which the compliance is thick to thin.
LOADS = np.geomspace(1e-4, 1e4, 17)
CURVE = np.geomspace(1e-7, 1e2, 37)
FLAT, BALL = profiles.Flat(1.0), profiles.Parabola(1.0)
QUANTITIES = ("approach", "stiffness", "pressure")
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00")
HEAD = """# How good is the linear layer?

Relative errors of what a linear layer gives whose compliance is that of the law at the mean
pressure: its tangent `dw/dp`, or its secant `w/p`. `alpha*` is the tangent's. Written by
`validation/physics/linear_layer.py`, version {version}.

| punch | law | load | alpha* | approach, tangent | secant | stiffness, tangent | secant | {edge} |
|---|---|---|---|---|---|---|---|---|
"""


@dataclass(frozen=True)
class Row:
    """Errors at one load, of the tangent and of the secant."""

    load: float
    compliance: float
    approach: tuple[float, float]
    stiffness: tuple[float, float]
    pressure: tuple[float, float]


def pressed(layer: layers.Layer, profile: profiles.Profile, load: float) -> Solution:
    """Return the contact through a law."""
    return solve(Scene(0.3, layer=layer, profile=profile, load=load), RTOL, QUANTITIES)


def linear(compliance: float, profile: profiles.Profile, load: float) -> tuple[float, float, float]:
    """Return approach, stiffness and the pressure that is compared, through a linear layer."""
    if profile is FLAT:
        found = solve(Scene(0.3, compliance), RTOL, ("approach", "pressure"))
        edge = float(found.pressure(from_edge=0.0))
        return load * found.approach, 1.0 / found.approach, load * edge
    scene = Scene(0.3, compliance, profile=profile, load=load)
    found = solve(scene, RTOL, QUANTITIES)
    return found.approach, found.stiffness, float(found.pressure(0.0))


def row(layer: layers.Layer, profile: profiles.Profile, load: float) -> Row:
    """Return the errors at a load."""
    wanted = ("contact_radius", *QUANTITIES)
    found = solve(Scene(0.3, layer=layer, profile=profile, load=load), RTOL, wanted)
    a = found.contact_radius
    mean = load / (pi * a**2)
    w = layer.overclosure(mean)
    tangent, secant = 1.0 / layer.stiffness(w), (w - layer.start) / mean
    place = {"from_edge": 0.0} if profile is FLAT else {"s": 0.0}
    # the approach counts from where the pressure begins, as that of a linear layer does
    truth = found.approach - layer.start, found.stiffness, float(found.pressure(**place))
    both = [linear(one, profile, load) for one in (tangent, secant)]
    errors = [tuple(one[k] / truth[k] - 1.0 for one in both) for k in range(3)]
    return Row(load, tangent / a, *errors)


def exponent(curve: NDArray[np.float64], loads: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the local exponent of a curve over the load, between neighbours of a neighbour."""
    return np.gradient(np.log(curve), np.log(loads))


def draw(table: dict[str, dict[str, list[Row]]]) -> None:
    """Draw the errors over the tangent's compliance."""
    names = {"approach": "approach", "stiffness": "stiffness", "pressure": "pressure"}
    figure, panels = plt.subplots(2, 3, figsize=(10.0, 5.6), layout="constrained", sharex=True)
    for line, (punch, rows) in zip(panels, table.items(), strict=True):
        for axes, (name, label) in zip(line, names.items(), strict=True):
            for colour, (law, own) in zip(COLOURS, rows.items(), strict=False):
                at = [one.compliance for one in own]
                for k, style in enumerate(("-", "--")):
                    axes.semilogx(
                        at,
                        [getattr(one, name)[k] for one in own],
                        style,
                        color=colour,
                        lw=1.3,
                        label=law if k == 0 else None,
                    )
            where = {"flat punch": "at the edge", "ball": "at the centre"}[punch]
            told = f"{label} {where}" if name == "pressure" else label
            axes.set_title(f"{punch}: {told}", fontsize="medium")
            axes.xaxis.set_major_locator(mpl.ticker.LogLocator(numticks=6))
            axes.axhline(0.0, color="#888888", lw=0.6)
            axes.set_ylim(-1.0, 0.25)
    for axes in panels[-1]:
        axes.set_xlabel(r"compliance of the tangent $\alpha E'/a$")
    for axes in panels[:, 0]:
        axes.set_ylabel("relative error")
    panels[0, 0].legend(frameon=False, fontsize="small", loc="lower left")
    kinds = [
        mpl.lines.Line2D([], [], ls=style, color="black", lw=1.3, label=told)
        for style, told in (("-", "tangent"), ("--", "secant"))
    ]
    panels[1, 0].legend(handles=kinds, frameon=False, fontsize="small", loc="lower left")
    figure.savefig(PICTURE, dpi=130)


def draw_exponents() -> list[str]:
    """Draw stiffness over load with its local exponent; return rows of a table."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(10.0, 3.8), layout="constrained")
    told = []
    hertz = 2.0 * 4.0 * (3.0 * CURVE / 16.0) ** (1.0 / 3.0)
    left.loglog(CURVE, hertz, ":", color="black", label="Hertz")
    for colour, (name, layer) in zip(COLOURS, {**LAWS, **OPEN}.items(), strict=True):
        scene = Scene(0.3, layer=layer, profile=BALL, load=1.0)
        found = sweep(
            scene, load=CURVE, quantities=["stiffness"], rtol=1e-7, progress=False
        ).stiffness.values
        left.loglog(CURVE, found, color=colour, label=name)
        slopes = exponent(found, CURVE)
        right.semilogx(CURVE[1:-1], slopes[1:-1], color=colour)
        told.append(f"| {name} | {slopes[1]:.4f} | {slopes[1:-1].max():.4f} | {slopes[-2]:.4f} |")
        if isinstance(layer, layers.PowerLaw):
            limit = layer.exponent / (layer.exponent + 1.0)
            right.axhline(limit, color=colour, ls=":", lw=0.8)
    right.axhline(1.0 / 3.0, color="black", ls=":", lw=0.8)
    right.text(CURVE[0], 0.345, " 1/3, Hertz", fontsize="small")
    left.set(xlabel=r"load $P/(E' R^2)$", ylabel=r"stiffness $K/(E' R)$")
    right.set(xlabel=r"load $P/(E' R^2)$", ylabel=r"exponent $d\ln K/d\ln P$", ylim=(0.25, 1.05))
    left.legend(frameon=False, fontsize="small")
    figure.savefig(EXPONENTS, dpi=130)
    return told


def main() -> None:
    """Write table and figures."""
    text = HEAD.format(version=__version__, edge="pressure (edge, centre), tangent | secant")
    text = text.replace("|---|---|---|---|---|---|---|---|---|", "|" + "---|" * 10)
    table: dict[str, dict[str, list[Row]]] = {}
    for punch, profile in (("flat punch", FLAT), ("ball", BALL)):
        for name, layer in LAWS.items():
            rows = [row(layer, profile, float(load)) for load in LOADS]
            table.setdefault(punch, {})[name] = rows
            for one in rows[::4]:  # all are in the figure
                cells = [*one.approach, *one.stiffness, *one.pressure]
                numbers = " | ".join(f"{value:+.3f}" for value in cells)
                text += (
                    f"| {punch} | {name} | {one.load:.3g} | {one.compliance:.3g} | {numbers} |\n"
                )
            print(text.splitlines()[-1], flush=True)
    draw(table)
    text += "\nThe exponent of the stiffness of a ball, d ln K/d ln P, from loads of "
    text += f"{CURVE[1]:.1e} to {CURVE[-2]:.1e}; Hertz has 1/3, a power law m/(m + 1).\n\n"
    text += "| law | at the least load | largest | at the largest load |\n|---|---|---|---|\n"
    text += "\n".join(draw_exponents()) + "\n"
    RESULT.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
