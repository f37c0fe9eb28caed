"""Adhesion with a layer: cycles, pressures, and pull-off beside Maugis' transition.

Run as ``python validation/physics/adhesion.py``; writes docs/adhesion_cycle.png and
docs/adhesion_pull_off.png.
"""

from __future__ import annotations

from math import atan, exp, pi, sqrt

import numpy as np
from common import DOCS, picture
from scipy.optimize import minimize_scalar

from spectral_contact import Scene, adhesion_cycle, profiles, pull_off, solve
from spectral_contact.view.figures import BLACK, BLUE, GREEN, VERMILION

BALL = profiles.Parabola(1.0)
#: Works of adhesion and radii are 1, as E' is; the compliances of the cycles.
COMPLIANCES = (0.0, 0.1, 1.0)
#: Of the ball's pull-off.
PARAMETERS = 10.0 ** np.linspace(-4.0, 4.0, 33)
#: Maugis' K is 4/3 of E*, which is 4 E'.
K = 16.0 / 3.0


def scene(compliance: float, load: float = 0.0) -> Scene:
    """Return a ball on a layer."""
    return Scene(None, compliance, profile=BALL, load=load, work_of_adhesion=1.0)


def maugis_parameter(tension: float) -> float:
    """Return Maugis' lambda of a largest tension."""
    return 2.0 * tension / (pi * K**2) ** (1.0 / 3.0)


def maugis_load(parameter: float) -> float:
    """Return the load of pull-off over pi w R, Maugis (1992), equations (6.14) and (6.15).

    With m, the outer radius of the zone of tension over the contact radius a, the first equation is
    quadratic in a.
    """

    def load(logarithm: float) -> float:
        m = 1.0 + exp(logarithm)
        root = sqrt((m - 1.0) * (m + 1.0))
        angle = atan(root)
        square = parameter / 2.0 * (root + (m**2 - 2.0) * angle)
        linear = 4.0 * parameter**2 / 3.0 * (root * angle - m + 1.0)
        radius = 2.0 / (linear + sqrt(linear**2 + 4.0 * square))
        return radius**3 - parameter * radius**2 * (root + m**2 * angle)

    grid = np.linspace(-20.0, 20.0, 400)
    best = grid[np.argmin([load(one) for one in grid])]
    return float(minimize_scalar(load, bounds=(best - 0.2, best + 0.2), method="bounded").fun)


def cycles() -> None:
    """Draw cycles, and pressures at the load 0."""
    with picture(DOCS / "adhesion_cycle.png", (8.4, 3.4), columns=2) as (left, right):
        for alpha, colour in zip(COMPLIANCES, (BLUE, VERMILION, GREEN), strict=True):
            cycle = adhesion_cycle(scene(alpha, 2.0), points=120)
            name = "smooth" if alpha == 0.0 else rf"$\alpha^* = {alpha:g}$"
            stable = np.where(cycle.stable, cycle.load, np.nan)
            unstable = np.where(cycle.stable, np.nan, cycle.load)
            left.plot(cycle.approach, stable, color=colour, label=name)
            left.plot(cycle.approach, unstable, "--", color=colour)
            for jump in (cycle.jump_in, cycle.jump_out):
                places = [one.approach for one in jump], [one.load for one in jump]
                left.plot(*places, ":", color=colour)
            s = np.linspace(0.0, 0.999, 400)
            right.plot(s, solve(scene(alpha)).pressure(s), color=colour)
        left.set(xlabel=r"approach $\delta$ [$L$]", ylabel=r"load $P$ [$E' L^2$]")
        left.legend()
        right.axhline(0.0, color=BLACK, linewidth=0.6)
        right.set(xlabel=r"radius $r/a$ at $P = 0$", ylabel=r"pressure $p$ [$E'$]")
        right.set_ylim(-3.0, 3.0)


def pull_offs() -> None:
    """Draw pull-off over the largest tension, with a layer and by Maugis."""
    tensions = [maugis_parameter(sqrt(2.0 / one)) for one in PARAMETERS]
    with picture(DOCS / "adhesion_pull_off.png", (5.6, 3.4)) as axes:
        layer = [pull_off(scene(one)).load / pi for one in PARAMETERS]
        axes.semilogx(tensions, layer, "o-", markersize=3, label="layer of roughness")
        maugis = [maugis_load(one) for one in tensions]
        axes.semilogx(tensions, maugis, "--", label="Maugis: a force that reaches far")
        for limit in (-1.5, -2.0):
            axes.axhline(limit, color=BLACK, linewidth=0.6)
        axes.set_xlabel(r"largest tension, as Maugis' $\lambda$")
        axes.set_ylabel(r"pull-off load $P_c/(\pi w R)$")
        axes.set_ylim(top=-1.35)  # room for the legend above the curves
        axes.legend(loc="upper left")


if __name__ == "__main__":
    cycles()
    pull_offs()
