"""How good is the linear layer? Tangent and secant at the mean pressure against the law itself.

Run as ``python validation/physics/linear_layer.py`` (a minute or two); writes
validation/results/linear_layer.md, docs/linear_layer.png and docs/stiffness_exponent.png.

A flat punch of radius 1 and a ball (a parabola of radius 1) are pressed on layers, E' being 1. Of
the layer a user would take the compliance at the mean pressure ``P/(pi a^2)``: that of the tangent,
``dw/dp``, or that of the secant, ``w/p`` with w from where the pressure begins. The abscissa is
what the user knows: the tangent's ``alpha* = alpha E'/a``.
"""

from __future__ import annotations

from math import pi

import numpy as np
from common import DOCS, picture, table, write

from spectral_contact import Scene, __version__, layers, profiles, sweep
from spectral_contact.view.figures import BLACK

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
FLAT = profiles.Flat(1.0)
PUNCHES = {"flat punch": FLAT, "ball": profiles.Parabola(1.0)}
#: Of the pressure that is compared.
WHERE = {"flat punch": "at the edge", "ball": "at the centre"}
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


def values(scenes: list[Scene]) -> np.ndarray:
    """Return approach, stiffness, and the pressure at the edge of the flat punch or at the centre.

    A row for each scene; the approach counts from where the pressure begins.
    """
    place = {"from_edge": [0.0]} if scenes[0].profile is FLAT else {"s": [0.0]}
    found = sweep(scenes, quantities=QUANTITIES, rtol=RTOL, progress=False, **place)
    rows = np.column_stack([found[name].values for name in QUANTITIES])
    rows[:, 0] -= [0.0 if one.layer is None else one.layer.start for one in scenes]
    return rows


def errors(layer: layers.Layer, profile: profiles.Profile) -> tuple[np.ndarray, np.ndarray]:
    """Return the tangent's alpha*, and errors by load, quantity, and tangent or secant."""
    scenes = [Scene(0.3, layer=layer, profile=profile, load=load) for load in LOADS]
    radii = sweep(scenes, quantities=["contact_radius"], rtol=RTOL, progress=False).contact_radius
    mean = LOADS / (pi * radii.values**2)
    w = np.array([layer.overclosure(one) for one in mean])
    tangent = np.array([1.0 / layer.stiffness(one) for one in w])
    secant = (w - layer.start) / mean
    truth, found = values(scenes), []
    for compliances in (tangent, secant):
        pairs = zip(scenes, compliances, strict=True)
        linear = [one.replace(layer=None, normal_compliance=alpha) for one, alpha in pairs]
        found.append(values(linear) / truth - 1.0)
    return tangent / radii.values, np.stack(found, axis=-1)


def draw(found: dict[tuple[str, str], tuple[np.ndarray, np.ndarray]]) -> None:
    """Draw the errors over the tangent's compliance."""
    shape = len(PUNCHES), len(QUANTITIES)
    path = DOCS / "linear_layer.png"
    with picture(path, (10.0, 5.6), *shape, sharex=True, sharey=True) as panels:
        for line, punch in zip(panels, PUNCHES, strict=True):
            for k, axes in enumerate(line):
                for colour, law in zip(COLOURS, LAWS, strict=False):
                    at, off = found[punch, law]
                    axes.semilogx(at, off[:, k, 0], "-", color=colour, label=law)
                    axes.semilogx(at, off[:, k, 1], "--", color=colour)
                where = f" {WHERE[punch]}" * (QUANTITIES[k] == "pressure")
                axes.set_title(f"{punch}: {QUANTITIES[k]}{where}")
        panels[0, 0].set(ylim=(-1.0, 0.25))
        for axes in panels[-1]:
            axes.set_xlabel(r"compliance of the tangent $\alpha E'/a$")
        for axes in panels[:, 0]:
            axes.set_ylabel("relative error: – tangent, - - secant")
        panels[0, 0].legend(loc="lower left")


def draw_exponents() -> list[tuple[str, ...]]:
    """Draw stiffness over load with its local exponent; return rows of a table."""
    told = []
    with picture(DOCS / "stiffness_exponent.png", (10.0, 3.8), columns=2) as (left, right):
        hertz = 2.0 * 4.0 * (3.0 * CURVE / 16.0) ** (1.0 / 3.0)
        left.loglog(CURVE, hertz, ":", color=BLACK, label="Hertz")
        for colour, (name, layer) in zip(COLOURS, {**LAWS, **OPEN}.items(), strict=True):
            scene = Scene(0.3, layer=layer, profile=PUNCHES["ball"], load=1.0)
            asked = {"load": CURVE, "quantities": ["stiffness"], "rtol": 1e-7}
            found = sweep(scene, **asked, progress=False).stiffness.values
            left.loglog(CURVE, found, color=colour, label=name)
            slopes = np.gradient(np.log(found), np.log(CURVE))
            right.semilogx(CURVE[1:-1], slopes[1:-1], color=colour)
            shown = slopes[1], slopes[1:-1].max(), slopes[-2]
            told.append((name, *(f"{one:.4f}" for one in shown)))
            if isinstance(layer, layers.PowerLaw):
                limit = layer.exponent / (layer.exponent + 1.0)
                right.axhline(limit, color=colour, ls=":", lw=0.8)
        right.axhline(1.0 / 3.0, color=BLACK, ls=":", lw=0.8)
        right.text(CURVE[0], 0.345, " 1/3, Hertz")
        left.set(xlabel=r"load $P/(E' R^2)$", ylabel=r"stiffness $K/(E' R)$")
        right.set(xlabel=r"load $P/(E' R^2)$", ylabel=r"exponent $d\ln K/d\ln P$")
        right.set_ylim(0.25, 1.05)
        left.legend()
    return told


def main() -> None:
    """Write table and figures."""
    found = {
        (punch, law): errors(layer, profile)
        for punch, profile in PUNCHES.items()
        for law, layer in LAWS.items()
    }
    draw(found)
    cells = [
        (*names, f"{load:.3g}", f"{alpha:.3g}", *(f"{one:+.3f}" for one in off.ravel()))
        for names, (alphas, every) in found.items()
        for load, alpha, off in list(zip(LOADS, alphas, every, strict=True))[::4]
    ]  # all are in the figure
    exponents = table("law | at the least load | largest | at the largest load", draw_exponents())
    write("linear_layer", f"{ABOUT}\n\n{table(HEADING, cells)}\n\n{EXPONENTS}\n\n{exponents}")


if __name__ == "__main__":
    main()
