"""Fits of measured curves: group ``fit`` of bench.py. Loads are the library's, with noise."""

from __future__ import annotations

from functools import partial

import numpy as np
from timed import Case, run

from spectral_contact import Scene, fit, layers, profiles, pull_off
from spectral_contact.calibration import IndentationData
from spectral_contact.calibration.adhesive_fits import BranchLoads
from spectral_contact.calibration.indentation_curve import curve_loads
from spectral_contact.calibration.layered_fits import layered_loads
from spectral_contact.layers.scene_layer import in_own_units

ROUNDS, GOAL = 3, 170.0
MODULUS, RADIUS, COMPLIANCE = 4e3, 2.5e-6, 1e-10
NOISE, ADHESION = 2e-11, 5e-5
LAW = layers.Exponential(100.0, 2e-8)
FREE = ("reduced_modulus", "zero_point")
LAYERED = ("normal_compliance", *FREE)
#: Points, layer, free parameters, tolerance, goal in U.
CASES: tuple[tuple[int, str, tuple[str, ...], float, float], ...] = (
    (400, "linear", LAYERED, 1e-10, GOAL),
    (10_000, "none", FREE, 1e-10, GOAL),
    (10_000, "linear", LAYERED, 1e-10, GOAL),
    (10_000, "linear", (*LAYERED, "load_offset", "tilt"), 1e-10, GOAL),
    (10_000, "exponential", FREE, 1e-6, GOAL),
    (10_000, "none, adhesion", (*FREE, "work_of_adhesion"), 1e-10, GOAL),
    (10_000, "linear, adhesion", (*LAYERED, "work_of_adhesion"), 1e-10, GOAL),
)


def curve(points: int, layer: str, seed: int) -> IndentationData:
    """Return a noisy curve, a third of it in contact."""
    depth, quarter = np.linspace(-1e-6, 5e-7, points), MODULUS / 4.0
    tip = profiles.Sphere(RADIUS)
    compliance = COMPLIANCE if "linear" in layer else 0.0
    if "adhesion" in layer:
        last = pull_off(start(layer)).physical.approach
        load = np.zeros(points)
        found = BranchLoads(tip, 1e-10).loads(
            depth[depth >= last], compliance * quarter, ADHESION / quarter
        )
        load[depth >= last] = found.value
    elif layer == "exponential":
        load = layered_loads(tip, in_own_units(LAW, quarter), depth, 1e-7).value
    else:
        load = curve_loads(tip, depth, compliance * quarter, 1e-10)[:, 0]
    noise = NOISE * np.random.default_rng(seed).standard_normal(points)
    return IndentationData(depth, quarter * load + noise)


def start(layer: str) -> Scene:
    """Return where a fit starts."""
    known = {"reduced_modulus": 2e3, "profile": profiles.Sphere(RADIUS), "load": 1e-9}
    if "adhesion" in layer:
        known |= {"work_of_adhesion": ADHESION}
    if layer == "exponential":
        return Scene.from_physical(**known, layer=LAW)
    return Scene.from_physical(**known, normal_compliance=5e-11 * ("linear" in layer))


def main(name: str) -> None:
    """Time all fits, and write the table."""

    def work(
        place: float, points: int, layer: str, free: tuple[str, ...], rtol: float
    ) -> partial[object]:
        data = curve(points, layer, int(place))
        return partial(fit, start(layer), data, free, rtol=rtol, progress=False)

    cases = (
        Case(
            (points, layer, len(free), f"{rtol:g}"),
            partial(work, points=points, layer=layer, free=free, rtol=rtol),
            goal,
            ROUNDS,
            fill=False,
        )
        for points, layer, free, rtol, goal in CASES
    )
    about = "# What fits of measured curves cost\n\nBy `python validation/cost/bench.py fit`; a "
    about += f"sphere, rounds: {ROUNDS}. U is one dense solve of 1000 unknowns."
    run(name, about, "points | layer | free parameters | tolerance", cases)
