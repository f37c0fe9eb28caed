"""Fit synthetic measurements, many times: python validation/physics/roughness_fit.py.

Writes validation/results/roughness_fit.json, .md and .png. The truth is known, the noise random,
and the fit starts at what Greenwood and Williamson's model says of a surface. If its errors are
honest, the deviations from the truth have the distribution that its covariance says.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
from common import RESULTS, picture, table, write
from scipy.stats import chi2

from spectral_contact import Scene, solve
from spectral_contact.asperities import greenwood_williamson
from spectral_contact.calibration import (
    PARAMETERS,
    ApproachData,
    PressureData,
    RoughnessFit,
    StickRadiusData,
    fit,
)
from spectral_contact.view.figures import BLUE, VERMILION

FITS = 40
TRUTH = {"normal_compliance": 3e-15, "tangential_compliance": 4e-15, "friction": 0.05}
MATERIAL = {"youngs_modulus": 200e9, "poisson_ratio": 0.3}
LABELS = {"normal_compliance": "α [m/Pa]", "tangential_compliance": "β [m/Pa]", "friction": "f"}
RADIUS, LOAD = 1e-3, 500.0
RADII = np.geomspace(0.25e-3, 4e-3, 8)
PLACES = np.linspace(0.0, 0.95e-3, 8)
#: Relative standard deviations of approaches, pressures and stick radii.
NOISE = 0.01, 0.02, 0.02


def scene(radius: float = RADIUS, **changes: float) -> Scene:
    """Return the true scene, or another; all punches have the same load."""
    return Scene.from_physical(**MATERIAL, radius=radius, load=LOAD, **{**TRUTH, **changes})


def theory() -> list[np.ndarray]:
    """Return approaches and stick radii of the punches, and pressures under that of the scene."""
    solved = [solve(scene(a), quantities=["approach", "stick_radius"]) for a in RADII]
    pressure = solve(scene(), quantities=["pressure"]).physical.pressure(PLACES)
    approaches = np.array([one.physical.approach for one in solved])
    return [approaches, pressure, np.array([one.physical.stick_radius for one in solved])]


def start() -> Scene:
    """Return the scene that the asperities of a surface suggest."""
    layer = greenwood_williamson(
        density=1e10,
        tip_radius=5e-6,
        height_deviation=0.4e-6,
        **MATERIAL,
        pressure=LOAD / (np.pi * RADIUS**2),
    )
    return scene(
        normal_compliance=layer.normal_compliance,
        tangential_compliance=layer.tangential_compliance,
        friction=0.03,
    )


def measured(exact: list[np.ndarray], seed: int) -> tuple:
    """Return data with noise."""
    random = np.random.default_rng(seed)
    approaches, pressures, stick_radii = (
        (values * (1 + noise * random.standard_normal(len(values))), values * noise)
        for values, noise in zip(exact, NOISE, strict=True)
    )
    return (
        ApproachData(*approaches, radius=RADII),
        PressureData(PLACES, *pressures),
        StickRadiusData(*stick_radii, radius=RADII),
    )


def offsets(found: RoughnessFit) -> np.ndarray:
    """Return the logarithms of the parameters over their truth."""
    return np.log([one.value / TRUTH[one.name] for one in found.parameters])


def page(fits: list[RoughnessFit]) -> str:
    """Return the summary as Markdown."""
    cells = []
    for i, name in enumerate(PARAMETERS):
        ones = [one.parameters[i] for one in fits]
        values = np.array([one.value for one in ones])
        error = np.mean([one.relative_error for one in ones])
        intervals = (one.interval() for one in ones)
        covered = sum(low <= TRUTH[name] <= high for low, high in intervals)
        scatter = f"{100 * np.log(values).std(ddof=1):.2f} %"
        sizes = f"{TRUTH[name]:g}", f"{values.mean():.4g}", scatter, f"{100 * error:.2f} %"
        cells.append((LABELS[name], *sizes, f"{covered} of {len(fits)}"))
    freedom = fits[0].degrees_of_freedom
    heading = "parameter | truth | mean of the estimates | their scatter | mean of the standard "
    heading += "errors | truth within the 95 % interval"
    parts = [f"{len(fits)} fits of {freedom + 3} noisy values each:", table(heading, cells)]
    distances = [offsets(one) @ np.linalg.solve(one.covariance, offsets(one)) for one in fits]
    chi_squares = [one.chi_square for one in fits]
    for what, values, free in (
        ("squared distances of the estimates from the truth, in the covariance,", distances, 3),
        ("chi squares of the data", chi_squares, freedom),
    ):
        low, high = chi2.interval(0.95, free * len(fits))
        parts.append(
            f"The {what} add up to {sum(values):.0f}; {low:.0f} to {high:.0f} is to be expected "
            "(95 %)."
        )
    return "\n\n".join(parts)


def draw(fits: list[RoughnessFit], path: Path) -> None:
    """Draw β and f of all fits, and the ellipses of 68 and 95 per cent around the truth."""
    angle = np.linspace(0.0, 2.0 * np.pi, 200)
    root = np.linalg.cholesky(np.array(fits[0].covariance)[1:, 1:])
    with picture(path, (5.0, 4.0)) as axes:
        for share, line in ((0.68, "-"), (0.95, "--")):
            ring = np.sqrt(chi2.ppf(share, 2)) * root @ np.array([np.cos(angle), np.sin(angle)])
            label = f"{100 * share:.0f} % by the covariance"
            axes.plot(100 * ring[0], 100 * ring[1], color=BLUE, ls=line, label=label)
        points = 100 * np.array([offsets(found)[1:] for found in fits])
        axes.plot(*points.T, "o", ms=3.0, color=VERMILION, label=f"{len(fits)} fits")
        axes.plot([0.0], [0.0], "k+", ms=10.0, label="truth")
        axes.set(xlabel=r"error of $\beta$ [%]", ylabel="error of $f$ [%]")
        axes.legend()


def main() -> None:
    """Run and write the results."""
    exact = theory()
    fits = []
    for seed in range(FITS):
        fits.append(fit(start(), measured(exact, seed), PARAMETERS, progress=False))
        print(f"\r{seed + 1} of {FITS}", end="", flush=True)
    record = {
        "count": len(fits),
        "truth": TRUTH,
        "radii": RADII.tolist(),
        "exact": dict(zip(("approach", "pressure", "stick_radius"), map(list, exact), strict=True)),
        "rows": [{"seed": k, "fit": json.loads(one.to_json())} for k, one in enumerate(fits)],
    }
    write("roughness_fit", page(fits), record)
    draw(fits, RESULTS / "roughness_fit.png")


if __name__ == "__main__":
    main()
