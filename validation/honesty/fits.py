"""Pulls of fitted parameters: whether their standard deviations cover the truth.

Run as ``python validation/honesty/fits.py [--adhesion | --roughness] [--curves N] [--seed N]``;
writes validation/results/honesty_fits.md, with adhesion honesty_adhesive_fits.md, and with
roughness, whose experiments are in roughness_fits.py, honesty_roughness_fits.md. Noisy curves of
400 points, sigma estimated from the baseline; a pull is (fitted - true) / standard deviation, whose
root mean square is to be 1; that of N curves is known to 1/sqrt(2 N). With adhesion they are
retractions up to the largest tension, where a soft spring lets go. Loads of the smooth sphere are
by the formulas of Hertz, or of Johnson, Kendall and Roberts; those through a layer by `solve`, one
for each depth.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

sys.path.append(str(Path(__file__).parents[1]))

import numpy as np
import roughness_fits
from reporting import options, table, write

from spectral_contact import Scene, fit, profiles, pull_off, solve
from spectral_contact.calibration import IndentationData

POINTS = 400
MODULUS, TOUCH = 4e3, 3e-8
TIP = profiles.Parabola(2.5e-6)
DEPTH = np.linspace(-1e-6, 5e-7, POINTS)
APPROACH = DEPTH - TOUCH


@dataclass(frozen=True)
class Study:
    """What is fitted: the true parameters of the surface and of the measurement."""

    name: str
    surface: dict[str, float]
    measurement: dict[str, float]
    #: Where fits start.
    start: dict[str, float]
    #: Normal compliance of the layer.
    compliance: float
    #: Noise [N], on the smooth surface and on the layer.
    noise: tuple[float, float]
    curves: int


PLAIN = Study(
    "honesty_fits",
    {"reduced_modulus": MODULUS},
    {"zero_point": TOUCH, "load_offset": 1e-10, "tilt": 2e-5},
    {"reduced_modulus": 3e3},
    1e-10,
    (2e-11, 2e-11),
    1000,
)
#: With more noise modulus and layer, which are both free there, have deviations of a fifth, and are
#: not normally distributed.
ADHESIVE = Study(
    "honesty_adhesive_fits",
    {"reduced_modulus": MODULUS, "work_of_adhesion": 5e-5},
    {"zero_point": TOUCH, "load_offset": 1e-10},
    {"reduced_modulus": 3e3, "work_of_adhesion": 2e-5},
    5e-10,
    (2e-11, 5e-12),
    400,
)


def smooth_loads(study: Study) -> np.ndarray:
    """Return the loads on a smooth half-space, by closed forms."""
    adhesion = study.surface.get("work_of_adhesion", 0.0)
    a = np.linspace(0.0, 5e-6, 1_000_001)
    load = 4.0 / 3.0 * MODULUS * a**3 / TIP.radius - np.sqrt(
        8.0 * np.pi * adhesion * MODULUS * a**3
    )
    approach = a**2 / TIP.radius - np.sqrt(2.0 * np.pi * adhesion * a / MODULUS)
    last = int(np.argmin(load))
    found = np.interp(APPROACH, approach[last:], load[last:])
    return np.where(approach[last] <= APPROACH, found, 0.0)


def layered_loads(study: Study) -> np.ndarray:
    """Return the loads through the layer."""
    scene = scene_of(study.surface, study.compliance)
    last = 0.0
    if "work_of_adhesion" in study.surface:
        last = pull_off(scene, "load").physical.approach
    loads = np.zeros(POINTS)
    for k in np.flatnonzero(last <= APPROACH):
        one = scene.replace(load=None, approach=float(APPROACH[k]))
        loads[k] = solve(one, 1e-9, ("load",)).physical.load
    return loads


def scene_of(surface: dict[str, float], compliance: float) -> Scene:
    """Return the scene of a surface under some load."""
    load = 0.0 if "work_of_adhesion" in surface else 1e-9
    return Scene.from_physical(**surface, normal_compliance=compliance, profile=TIP, load=load)


def pulls(study: Study, layer: bool, curves: int, seed: int) -> dict[str, np.ndarray]:
    """Return the pulls of every parameter."""
    truth = study.surface | study.measurement
    if layer:
        truth |= {"normal_compliance": study.compliance}
    start = scene_of(study.start, 0.7 * study.compliance if layer else 0.0)
    loads = (layered_loads if layer else smooth_loads)(study)
    exact = loads + truth["load_offset"] + truth.get("tilt", 0.0) * APPROACH
    random = np.random.default_rng(seed)
    found = {name: np.empty(curves) for name in truth}
    for k in range(curves):
        load = exact + study.noise[layer] * random.standard_normal(POINTS)
        one = fit(start, IndentationData(DEPTH, load), tuple(truth), rtol=1e-8, progress=False)
        for name, value in truth.items():
            found[name][k] = (one[name] - value) / one.error(name)
    return found


def rows(samples: Iterable[tuple[str, dict[str, np.ndarray]]]) -> Iterator[tuple[str, ...]]:
    """Yield the rows of the table: of each contact those of its parameters."""
    for contact, found in samples:
        for parameter, some in found.items():
            size, beyond = np.sqrt(np.mean(some**2)), np.mean(np.abs(some) > 1.96)
            cells = f"{some.mean():+.3f}", f"{size:.3f}", f"{beyond:.1%}"
            yield contact, f"`{parameter}`", *cells, f"{np.abs(some).max():.2f}"


def main() -> None:
    """Fit all curves, and write the table."""
    asked = options(__doc__, adhesion=False, roughness=False, curves=0, seed=1)
    study = ADHESIVE if asked.adhesion else PLAIN
    name, curves = study.name, asked.curves or study.curves
    samples: Iterable[tuple[str, dict[str, np.ndarray]]] = (
        (contact, pulls(study, bool(layer), curves, asked.seed))
        for layer, contact in enumerate(("smooth sphere", "linear layer"))
    )
    what = f"{curves} noisy curves of {POINTS} points each, sigma estimated from the baseline"
    if asked.roughness:
        name, curves = "honesty_roughness_fits", asked.curves or roughness_fits.EXPERIMENTS
        samples = [("flat punches", roughness_fits.pulls(curves, asked.seed))]
        what = f"{curves} experiments of {roughness_fits.VALUES} noisy values each"
    known = 1.0 / math.sqrt(2.0 * curves)
    about = (
        f"{what}. A pull is (fitted - true) over the standard deviation. The root mean square of "
        f"correct deviations is 1; that of {curves} fits has a standard error of {known:.3f}."
    )
    heading = "contact | parameter | mean pull | root mean square | beyond 1.96 | largest"
    write(name, f"{about}\n\n{table(heading, rows(samples))}")


if __name__ == "__main__":
    main()
