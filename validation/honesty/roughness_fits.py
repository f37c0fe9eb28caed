"""Pulls of compliances and friction that are fitted to flat punches, for fits.py --roughness.

Measured are the approaches and stick radii of eight punches under the same load, and pressures
under one of them, all with noise. Fits start at what Greenwood and Williamson's model says of a
surface. A pull is the logarithm of a fitted parameter over the true one, over its relative
standard deviation.
"""

from __future__ import annotations

import numpy as np

from spectral_contact import Scene, calibration, solve
from spectral_contact.asperities import greenwood_williamson

TRUTH = {"normal_compliance": 3e-15, "tangential_compliance": 4e-15, "friction": 0.05}
MATERIAL = {"youngs_modulus": 200e9, "poisson_ratio": 0.3}
RADIUS, LOAD = 1e-3, 500.0
RADII = np.geomspace(0.25e-3, 4e-3, 8)
PLACES = np.linspace(0.0, 0.95e-3, 8)
#: Relative standard deviations of approaches, pressures and stick radii.
NOISE = 0.01, 0.02, 0.02
#: The number of experiments, and of the values that are measured in each.
EXPERIMENTS, VALUES = 40, 24


def scene(**changes: float) -> Scene:
    """Return the scene of a punch, the true one unless something is changed."""
    return Scene.from_physical(**MATERIAL, **{"radius": RADIUS, "load": LOAD, **TRUTH, **changes})


def exact() -> list[np.ndarray]:
    """Return the approaches of the punches, the pressures, and the stick radii of the punches."""
    solved = [solve(scene(radius=a), 1e-10, ["approach", "stick_radius"]).physical for a in RADII]
    pressures = solve(scene(), 1e-10, ["pressure"]).physical.pressure(PLACES)
    approaches, radii = ([getattr(one, n) for one in solved] for n in ("approach", "stick_radius"))
    return [np.array(approaches), pressures, np.array(radii)]


def start() -> Scene:
    """Return the scene that the asperities of a surface suggest."""
    surface = {"density": 1e10, "tip_radius": 5e-6, "height_deviation": 0.4e-6}
    layer = greenwood_williamson(**surface, **MATERIAL, pressure=LOAD / (np.pi * RADIUS**2))
    compliances = layer.normal_compliance, layer.tangential_compliance
    return scene(**dict(zip(TRUTH, (*compliances, 0.03), strict=True)))


def pulls(experiments: int, seed: int) -> dict[str, np.ndarray]:
    """Return the pulls of every parameter."""
    known, begin, random = exact(), start(), np.random.default_rng(seed)
    found = {name: np.empty(experiments) for name in TRUTH}
    for k in range(experiments):
        approaches, pressures, radii = (
            (values * (1.0 + noise * random.standard_normal(len(values))), values * noise)
            for values, noise in zip(known, NOISE, strict=True)
        )
        data = (
            calibration.ApproachData(*approaches, radius=RADII),
            calibration.PressureData(PLACES, *pressures),
            calibration.StickRadiusData(*radii, radius=RADII),
        )
        for one in calibration.fit(begin, data, tuple(TRUTH), progress=False).parameters:
            found[one.name][k] = np.log(one.value / TRUTH[one.name]) / one.relative_error
    return found
