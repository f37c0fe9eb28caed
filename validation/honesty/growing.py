"""True errors of friction under growing contacts against their estimates.

Run as ``python validation/honesty/growing.py [scenes] [seed]`` (some 20 seconds each); writes
validation/results/honesty_growing.md. Scenes have random profiles, compliances, frictions and
tolerances, without elastic coupling. The truth of load and approach in the history is normal
contact of each radius, which knows no superposition; that of the rest is the same method to a
hundredth of the tolerance, whose convergence to the truth is tested by a march in the load and by
the friction law with elliptic kernels.
"""

from __future__ import annotations

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("OMP_NUM_THREADS", "1")

import math
import sys
from pathlib import Path

import numpy as np
from honesty_table import decade, table

from spectral_contact import NotComputedError, Scene, Solution, profiles, solve

RESULTS = Path(__file__).parents[1] / "results"
#: So many scenes from table to table.
EVERY = 10
FRACTIONS = np.array([0.07, 0.2, 0.5, 0.8, 0.97])
SCALARS, FIELDS = ("total_shear", "stick_radius"), ("traction", "slip")
TINY = float(np.finfo(float).tiny)
PLACES = np.concatenate([[1e-6, 1e-3], np.linspace(0.02, 0.98, 49), 1.0 - 10.0 ** -np.arange(2, 7)])


def drawn(rng: np.random.Generator) -> tuple[Scene, float]:
    """Return a scene and a tolerance."""
    profile = [
        profiles.Parabola(1.0),
        profiles.Sphere(2.0),
        profiles.Cone(float(rng.uniform(0.5, 1.4))),
        profiles.PowerLaw(1.0, float(rng.choice([1.5, 3.0, 4.0]))),
        profiles.RoundedFlat(0.3, 1.0),
    ][rng.integers(5)]
    alpha = 0.0 if rng.random() < 0.2 else decade(rng, -2.0, 0.5)
    beta = alpha * float(rng.uniform(0.0, 1.0))
    friction = math.inf if rng.random() < 0.25 else decade(rng, -2.0, 0.0)
    radius = 0.35 + decade(rng, -1.5, 0.0)
    scene = Scene(
        float(rng.uniform(0.0, 0.45)), alpha, beta, friction, profile=profile, contact_radius=radius
    )
    return scene, decade(rng, -7.0, -3.0)


def ratios(scene: Scene, rtol: float) -> dict[str, float]:
    """Return true errors over estimates."""
    found, truth = solve(scene, rtol, strict=False), solve(scene, rtol / 100.0, strict=False)
    worst = {}
    for name in SCALARS:
        size = max(abs(getattr(truth, name)), TINY)
        off = abs(getattr(found, name) - getattr(truth, name)) / size
        worst[name] = off / (getattr(found.error, name) + getattr(truth.error, name) + 1e-15)
    for name in FIELDS:
        if getattr(found.error, name) is not None:
            mine, exact = (getattr(one, name)(PLACES) for one in (found, truth))
            off = np.abs(mine - exact).max() / max(np.abs(exact).max(), TINY)
            worst[name] = off / (getattr(found.error, name) + getattr(truth.error, name) + 1e-15)
    return worst | history_ratios(found, truth)


def history_ratios(found: Solution, truth: Solution) -> dict[str, float]:
    """Return the same of the history."""
    scene, worst = found.scene, dict.fromkeys(("load", "approach", *SCALARS), 0.0)
    assert scene.profile is not None
    assert scene.contact_radius is not None
    flat = scene.profile.flat_part
    for b in (flat + FRACTIONS * (scene.contact_radius - flat)).tolist():
        normal = solve(scene.replace(contact_radius=b, friction=None), 1e-11, ("load", "approach"))
        for name in worst:
            one = getattr(found.history, name)(b)
            if name in SCALARS:
                other, left = getattr(truth.history, name)(b), truth.history.error(name, b)
            else:
                other, left = getattr(normal, name), 1e-11
            room = (found.history.error(name, b) + left) * abs(other)
            off = abs(one - other)
            worst[name] = max(worst[name], float(off / room) if off else 0.0)
    return {f"history, {name.replace('_', ' ')}": value for name, value in worst.items()}


def main() -> int:
    """Run the study, and write its table from time to time."""
    scenes = int(sys.argv[1]) if len(sys.argv) > 1 else 100
    seed = int(sys.argv[2]) if len(sys.argv) > 2 else 1
    rng = np.random.default_rng(seed)
    found: list[dict[str, float]] = []
    violations: list[str] = []
    refused = 0
    while (done := len(found) + refused) < scenes:
        scene, rtol = drawn(rng)
        try:
            found.append(ratios(scene, rtol))
        except NotComputedError:  # slip does not reach the edge
            refused += 1
            continue
        told = f"scene {done}: {scene!r}, rtol {rtol:.1e}"
        new = [f"{name} {one:.2f}, {told}" for name, one in found[-1].items() if one > 1.0]
        print(*new, sep="\n", end="\n" * bool(new), flush=True)
        violations += new
        if len(found) % EVERY == 0:
            written(done + 1, seed, refused, found, violations)
    print(written(scenes, seed, refused, found, violations))
    return bool(violations)


def written(
    scenes: int, seed: int, refused: int, found: list[dict[str, float]], violations: list[str]
) -> str:
    """Write the table, and return it."""
    about = (
        f"{scenes} random scenes, seed {seed}, by validation/honesty/growing.py: true error over "
        f"its estimate; {refused} were refused, as slip does not simply reach the edge."
    )
    names = dict.fromkeys(name for one in found for name in one)
    text = table("Honesty of friction under growing contacts", about, found, names, violations)
    (RESULTS / "honesty_growing.md").write_text(f"{text}\n", encoding="utf-8")
    return text


if __name__ == "__main__":
    sys.exit(main())
