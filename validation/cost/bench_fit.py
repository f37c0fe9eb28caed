"""Fits of measured curves: group ``fit`` of bench.py. Loads are the library's, with noise."""

from __future__ import annotations

from functools import partial

import numpy as np
from timed import TABLE, Case, Row, report, timed_rows

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


def work(place: float, row: Row) -> partial[object]:
    """Return the fit of a curve, whose noise is another at each place."""
    data = curve(row["points"], row["layer"], int(place))
    begin = start(row["layer"])
    return partial(fit, begin, data, row["free"], rtol=row["rtol"], progress=False)


def main(group: str) -> None:
    """Time all fits, and write the table."""
    cases = [
        Case(row | {"count": len(row["free"])}, partial(work, row=row), GOAL, ROUNDS, fill=False)
        for row in TABLE["fit"]
    ]
    report(group, timed_rows(cases))
