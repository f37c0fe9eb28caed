"""Pulls of parameters fitted to curves with adhesion: whether their deviations cover the truth.

Run as ``python validation/honesty/adhesive_fits.py [curves] [seed]``; writes
validation/results/honesty_adhesive_fits.md. Noisy retractions of 400 points up to the largest
tension, where a soft spring lets go, sigma estimated from the baseline; a pull is (fitted - true) /
standard deviation, whose root mean square is to be 1. Loads of the smooth sphere are by the
formulas of Johnson, Kendall and Roberts; those on a layer by `solve`, one for each depth.
"""

from __future__ import annotations

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import sys
from pathlib import Path

import numpy as np
from fits import PULLS_HEADER, about_pulls, pulls_row

from spectral_contact import Scene, fit, profiles, pull_off, solve
from spectral_contact.calibration import IndentationData

RESULTS = Path(__file__).parents[1] / "results"
#: Noise [N], on the smooth surface and on the layer: with more of it modulus and layer, which are
#: both free there, have deviations of a fifth, and are not normally distributed.
POINTS, NOISE = 400, {False: 2e-11, True: 5e-12}
TRUTH = {
    "reduced_modulus": 4e3,
    "work_of_adhesion": 5e-5,
    "zero_point": 3e-8,
    "load_offset": 1e-10,
}
TIP = profiles.Parabola(2.5e-6)
COMPLIANCE = 5e-10
DEPTH = np.linspace(-1e-6, 5e-7, POINTS)


def smooth_loads() -> np.ndarray:
    """Return the loads on a smooth half-space."""
    modulus, adhesion = TRUTH["reduced_modulus"], TRUTH["work_of_adhesion"]
    a = np.linspace(1e-9, 5e-6, 1_000_001)
    load = 4.0 / 3.0 * modulus * a**3 / TIP.radius - np.sqrt(
        8.0 * np.pi * adhesion * modulus * a**3
    )
    approach = a**2 / TIP.radius - np.sqrt(2.0 * np.pi * adhesion * a / modulus)
    last = int(np.argmin(load))
    wanted = DEPTH - TRUTH["zero_point"]
    found = np.interp(wanted, approach[last:], load[last:])
    return np.where(wanted >= approach[last], found, 0.0)


def layered_loads() -> np.ndarray:
    """Return the loads on a layer."""
    last = pull_off(scene_of(TRUTH, COMPLIANCE), "load").physical.approach
    loads = np.zeros(POINTS)
    for k in np.flatnonzero(DEPTH - TRUTH["zero_point"] >= last):
        approach = float(DEPTH[k] - TRUTH["zero_point"])
        scene = scene_of(TRUTH, COMPLIANCE).replace(load=None, approach=approach)
        loads[k] = solve(scene, 1e-9, ("load",)).physical.load
    return loads


def scene_of(values: dict[str, float], compliance: float) -> Scene:
    """Return the scene of some values, without load."""
    known = {name: values[name] for name in ("reduced_modulus", "work_of_adhesion")}
    return Scene.from_physical(**known, normal_compliance=compliance, profile=TIP, load=0.0)


def pulls(loads: np.ndarray, layer: bool, curves: int, seed: int) -> dict[str, np.ndarray]:
    """Return the pulls of every parameter."""
    truth = {**TRUTH, **({"normal_compliance": COMPLIANCE} if layer else {})}
    first = {"reduced_modulus": 3e3, "work_of_adhesion": 2e-5}
    start = scene_of(first, 0.7 * COMPLIANCE if layer else 0.0)
    random = np.random.default_rng(seed)
    found = {name: np.empty(curves) for name in truth}
    for k in range(curves):
        load = loads + truth["load_offset"] + NOISE[layer] * random.standard_normal(POINTS)
        one = fit(start, IndentationData(DEPTH, load), tuple(truth), rtol=1e-8, progress=False)
        for name, value in truth.items():
            found[name][k] = (one[name] - value) / one.error(name)
    return found


def main(curves: int = 400, seed: int = 1) -> None:
    """Fit all curves, and write the table."""
    lines = [
        f"{curves} noisy curves of {POINTS} points each, sigma estimated from the baseline. "
        f"{about_pulls(curves)}",
        "",
        *PULLS_HEADER,
    ]
    for name, loads, layer in (
        ("smooth sphere", smooth_loads(), False),
        ("linear layer", layered_loads(), True),
    ):
        for parameter, some in pulls(loads, layer, curves, seed).items():
            lines.append(pulls_row(name, parameter, some))
    (RESULTS / "honesty_adhesive_fits.md").write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
