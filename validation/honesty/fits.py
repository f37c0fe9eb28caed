"""Pulls of fitted parameters: whether their standard deviations cover the truth.

Run as ``python validation/honesty/fits.py [curves] [seed]``; writes
validation/results/honesty_fits.md. Noisy curves of 400 points, sigma estimated from the baseline;
a pull is (fitted - true) / standard deviation, whose root mean square is to be 1; that of N curves
is known to 1/sqrt(2 N). Loads of the smooth sphere are by Hertz' formula; those through a layer by
`solve`, one for each depth.
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

import numpy as np

from spectral_contact import Scene, fit, profiles, solve
from spectral_contact.calibration import IndentationData

RESULTS = Path(__file__).parents[1] / "results"
POINTS, TOUCH, NOISE = 400, 3e-8, 2e-11
TRUTH = {"reduced_modulus": 4e3, "zero_point": TOUCH, "load_offset": 1e-10, "tilt": 2e-5}
TIP = profiles.Parabola(2.5e-6)
COMPLIANCE = 1e-10
DEPTH = np.linspace(-1e-6, 5e-7, POINTS)
PULLS_HEADER = (
    "| contact | parameter | mean pull | root mean square | beyond 1.96 | largest |",
    "|---|---|---|---|---|---|",
)


def smooth_loads() -> np.ndarray:
    """Return the loads on a smooth half-space."""
    approach = np.maximum(DEPTH - TOUCH, 0.0)
    return 4.0 / 3.0 * TRUTH["reduced_modulus"] * np.sqrt(TIP.radius) * approach**1.5


def layered_loads() -> np.ndarray:
    """Return the loads through a layer."""
    loads = np.zeros(POINTS)
    for k in np.flatnonzero(DEPTH > TOUCH):
        scene = scene_of(TRUTH["reduced_modulus"], COMPLIANCE, float(DEPTH[k] - TOUCH))
        loads[k] = solve(scene, 1e-9, ("load",)).physical.load
    return loads


def scene_of(modulus: float, compliance: float, approach: float) -> Scene:
    """Return the scene of an approach."""
    known = {"reduced_modulus": modulus, "normal_compliance": compliance, "profile": TIP}
    return Scene.from_physical(**known, approach=approach)


def pulls(loads: np.ndarray, layer: bool, curves: int, seed: int) -> dict[str, np.ndarray]:
    """Return the pulls of every parameter."""
    truth = {**TRUTH, **({"normal_compliance": COMPLIANCE} if layer else {})}
    start = scene_of(3e3, 0.7 * COMPLIANCE if layer else 0.0, 1e-7)
    exact = loads + truth["load_offset"] + truth["tilt"] * (DEPTH - TOUCH)
    random = np.random.default_rng(seed)
    found = {name: np.empty(curves) for name in truth}
    for k in range(curves):
        data = IndentationData(DEPTH, exact + NOISE * random.standard_normal(POINTS))
        one = fit(start, data, tuple(truth), rtol=1e-8, progress=False)
        for name, value in truth.items():
            found[name][k] = (one[name] - value) / one.error(name)
    return found


def about_pulls(curves: int) -> str:
    """Return what a table of pulls shows, and the statistical error of its root mean squares."""
    error = 1.0 / math.sqrt(2.0 * curves)
    return (
        "A pull is (fitted - true) over the standard deviation. The root mean square of correct "
        f"deviations is 1; that of {curves} curves has a standard error of {error:.3f}."
    )


def pulls_row(contact: str, parameter: str, some: np.ndarray) -> str:
    """Return the row of a table of pulls, with the columns of `PULLS_HEADER`."""
    beyond = np.mean(np.abs(some) > 1.96)
    size = np.sqrt(np.mean(some**2))
    cells = f"{some.mean():+.3f} | {size:.3f} | {beyond:.1%} | {np.abs(some).max():.2f}"
    return f"| {contact} | `{parameter}` | {cells} |"


def main(curves: int = 1000, seed: int = 1) -> None:
    """Fit all curves, and write the table."""
    lines = [
        "# Standard deviations of fitted parameters",
        "",
        f"By `python validation/honesty/fits.py {curves} {seed}`: {curves} noisy curves each, of",
        f"{POINTS} points, sigma estimated from the baseline. {about_pulls(curves)}",
        "",
        *PULLS_HEADER,
    ]
    for name, loads, layer in (
        ("smooth sphere", smooth_loads(), False),
        ("linear layer", layered_loads(), True),
    ):
        for parameter, some in pulls(loads, layer, curves, seed).items():
            lines.append(pulls_row(name, parameter, some))
            print(lines[-1], flush=True)
    (RESULTS / "honesty_fits.md").write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
