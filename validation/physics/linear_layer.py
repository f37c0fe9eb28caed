"""How good is the linear layer? Tangent and secant at the mean pressure against the law itself.

Run as ``python validation/physics/linear_layer.py`` (a minute or two); writes
validation/results/linear_layer.md, docs/linear_layer.png and docs/stiffness_exponent.png.

A flat punch of radius 1 and a ball (a parabola of radius 1) are pressed on layers, E' being 1. Of
the layer a user would take the compliance at the mean pressure ``P/(pi a^2)``: that of the tangent,
``dw/dp``, or that of the secant, ``w/p`` with w from where the pressure begins. The abscissa is
what the user knows: the tangent's ``alpha* = alpha E'/a``.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from math import pi
from pathlib import Path

sys.path.append(str(Path(__file__).parents[1]))

import matplotlib as mpl
import matplotlib.lines
import matplotlib.ticker

mpl.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
from reporting import DOCS, table, write

from spectral_contact import Scene, __version__, layers, profiles, solve, sweep

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
ABOUT = f"""# How good is the linear layer?

Relative errors of what a linear layer gives whose compliance is that of the law at the mean
pressure: its tangent `dw/dp`, or its secant `w/p`. `alpha*` is the tangent's. Written by
`validation/physics/linear_layer.py`, version {__version__}."""
HEADING = (
    "punch | law | load | alpha* | approach, tangent | secant | stiffness, tangent | secant | "
    "pressure (edge, centre), tangent | secant"
)
EXPONENTS = (
    f"The exponent of the stiffness of a ball, d ln K/d ln P, from loads of {CURVE[1]:.1e} to "
    f"{CURVE[-2]:.1e}; Hertz has 1/3, a power law m/(m + 1)."
)


@dataclass(frozen=True)
class Row:
    """Errors at one load, of the tangent and of the secant."""

    load: float
    compliance: float
    approach: tuple[float, float]
    stiffness: tuple[float, float]
    pressure: tuple[float, float]


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


def draw(found: dict[str, dict[str, list[Row]]]) -> None:
    """Draw the errors over the tangent's compliance."""
    figure, panels = plt.subplots(2, 3, figsize=(10.0, 5.6), layout="constrained", sharex=True)
    for line, (punch, rows) in zip(panels, found.items(), strict=True):
        for axes, name in zip(line, QUANTITIES, strict=True):
            for colour, (law, own) in zip(COLOURS, rows.items(), strict=False):
                at = [one.compliance for one in own]
                tangent, secant = zip(*(getattr(one, name) for one in own), strict=True)
                axes.semilogx(at, tangent, "-", color=colour, lw=1.3, label=law)
                axes.semilogx(at, secant, "--", color=colour, lw=1.3)
            where = {"flat punch": "at the edge", "ball": "at the centre"}[punch]
            told = f"{name} {where}" if name == "pressure" else name
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
    figure.savefig(DOCS / "linear_layer.png", dpi=130)


def draw_exponents() -> list[tuple[str, ...]]:
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
        slopes = np.gradient(np.log(found), np.log(CURVE))
        right.semilogx(CURVE[1:-1], slopes[1:-1], color=colour)
        shown = slopes[1], slopes[1:-1].max(), slopes[-2]
        told.append((name, *(f"{one:.4f}" for one in shown)))
        if isinstance(layer, layers.PowerLaw):
            limit = layer.exponent / (layer.exponent + 1.0)
            right.axhline(limit, color=colour, ls=":", lw=0.8)
    right.axhline(1.0 / 3.0, color="black", ls=":", lw=0.8)
    right.text(CURVE[0], 0.345, " 1/3, Hertz", fontsize="small")
    left.set(xlabel=r"load $P/(E' R^2)$", ylabel=r"stiffness $K/(E' R)$")
    right.set(xlabel=r"load $P/(E' R^2)$", ylabel=r"exponent $d\ln K/d\ln P$", ylim=(0.25, 1.05))
    left.legend(frameon=False, fontsize="small")
    figure.savefig(DOCS / "stiffness_exponent.png", dpi=130)
    return told


def main() -> None:
    """Write table and figures."""
    cells = []
    found: dict[str, dict[str, list[Row]]] = {}
    for punch, profile in (("flat punch", FLAT), ("ball", BALL)):
        for name, layer in LAWS.items():
            rows = [row(layer, profile, float(load)) for load in LOADS]
            found.setdefault(punch, {})[name] = rows
            for one in rows[::4]:  # all are in the figure
                errors = (f"{e:+.3f}" for e in (*one.approach, *one.stiffness, *one.pressure))
                cells.append((punch, name, f"{one.load:.3g}", f"{one.compliance:.3g}", *errors))
    draw(found)
    exponents = table("law | at the least load | largest | at the largest load", draw_exponents())
    write("linear_layer", f"{ABOUT}\n\n{table(HEADING, cells)}\n\n{EXPONENTS}\n\n{exponents}")


if __name__ == "__main__":
    main()
