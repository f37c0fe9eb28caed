"""What accuracy coupled slip on smooth surfaces has, over tangential compliance and friction.

Run as ``python validation/physics/edge_stick.py``; writes validation/results/edge_stick.md. Every
scene is solved at 1e-12 with whatever it takes, and its estimates are recorded. Where stick at the
edge is wide enough for panels it is also matched in closed form, and compared.
"""

from __future__ import annotations

import math

from common import table, write

from spectral_contact import Scene, solve
from spectral_contact.contact.edge_stick import with_edge_stick
from spectral_contact.contact.layout import Layout
from spectral_contact.contact.zone_problem import FreeBoundaryProblem, solve_coupled_zones
from spectral_contact.spectral.parameters import Parameters

NU, RTOL = 0.1, 1e-12
BETAS = 0.0, 1e-14, 1e-10
#: f over kappa.
FRICTIONS = 0.5, 2.0, 5.0
#: Poisson's ratio, compliance and friction of scenes that panels resolve.
COMPARED = (0.17, 1e-6, 0.95), (0.0, 1e-7, 0.5)


def accuracy(beta: float, ratio: float) -> tuple[str, ...]:
    """Return the cells of a scene: where the edge sticks, estimates, and the ending."""
    friction = ratio * Scene(NU).kappa
    solution = solve(Scene(NU, 0.0, beta, friction, coupling=True), RTOL, strict=False)
    zone = solution.zones[-1]
    return (
        f"{beta:g}",
        f"{ratio:g}",
        f"{zone.inner_from_edge:.1e}" if zone.kind == "stick" else "",
        f"{solution.error.approach:.0e}",
        f"{solution.error.pressure:.0e}",
        solution.ending.name.lower(),
    )


def matched(nu: float, beta: float, friction: float) -> dict[str, float]:
    """Return the differences of a matched contact from the one of panels, over their laws."""
    scene = Scene(nu, 0.0, beta, friction, coupling=True)
    panels = solve(scene, 1e-11, strict=False)
    parameters = Parameters(0.0, beta, scene.kappa, friction)
    layout = FreeBoundaryProblem(parameters, Layout((2.0,), (0, 1)), 1e-11).current_layout()
    found = solve_coupled_zones(parameters, layout, 1e-11, 20_000)
    edge = with_edge_stick(found.best.value, parameters)
    widths = [2.0 * one.zones[-1].inner_from_edge for one in (edge, panels)]
    theta = math.atan(2.0 * scene.kappa * friction) / math.pi
    return {
        "estimate": max(panels.error.pressure, panels.error.traction),
        "shear": abs(edge.total_shear / panels.total_shear - 1.0) / widths[1] ** (0.5 + theta),
        "edge": (0.5 - theta)
        * abs(widths[0] / widths[1] - 1.0)
        / (-math.log(widths[1]) * widths[1] / beta),
    }


def main() -> None:
    """Measure, print and store."""
    rows = [accuracy(beta, ratio) for beta in BETAS for ratio in FRICTIONS]
    heading = (
        "$\\beta$ | $f/\\kappa$ | edge sticks within | approach | pressure, pointwise | ending"
    )
    ones = [matched(*one) for one in COMPARED]
    most = {key: max(one[key] for one in ones) for key in ("shear", "edge", "estimate")}
    text = (
        f"{len(rows)} scenes:\n\n{table(heading, rows)}\n\n"
        f"Matched against panels, in {len(ones)} scenes that panels solve to "
        f"{most['estimate']:.1e}: the shear differs by {most['shear']:.1g} $w^{{1/2+\\theta}}$ at "
        f"most, the traction that sticks by {most['edge']:.1g} $w\\ln(1/w)/\\beta$."
    )
    write("edge_stick", text)


if __name__ == "__main__":
    main()
