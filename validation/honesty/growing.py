"""True errors of friction under growing contacts against their estimates.

A stratum of honesty.py, of some 20 seconds a scene. Scenes have random profiles, compliances,
frictions and tolerances, without elastic coupling. The truth of load and approach in the history is
normal contact of each radius, which knows no superposition; that of the rest is the same method to
a hundredth of the tolerance, whose convergence to the truth is tested by a march in the load and by
the friction law with elliptic kernels.
"""

from __future__ import annotations

import math

import numpy as np
from strata import Outcome, decade, fields_over_estimates, over_estimates

from spectral_contact import Scene, Solution, profiles, solve

FRACTIONS = np.array([0.07, 0.2, 0.5, 0.8, 0.97])
SCALARS, FIELDS = ("total_shear", "stick_radius"), ("traction", "slip")
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


def solved_twice(scene: Scene, rtol: float) -> tuple[Solution, Solution]:
    """Return the solution, and one to a hundredth of its tolerance, which counts as the truth."""
    found, truth = (solve(scene, one, strict=False) for one in (rtol, rtol / 100.0))
    return found, truth


def history_ratios(found: Solution, truth: Solution) -> dict[str, float]:
    """Return the same of the history."""
    scene = found.scene
    worst = dict.fromkeys(("load", "approach", *SCALARS), 0.0)
    flat = scene.profile.flat_part
    for b in (flat + FRACTIONS * (scene.contact_radius - flat)).tolist():
        normal = solve(scene.replace(contact_radius=b, friction=None), 1e-11, ("load", "approach"))
        for name in worst:
            if name in SCALARS:
                exact, left = getattr(truth.history, name)(b), truth.history.error(name, b)
            else:
                exact, left = getattr(normal, name), 1e-11
            room = (found.history.error(name, b) + left) * abs(exact)
            off = abs(getattr(found.history, name)(b) - exact)
            worst[name] = max(worst[name], float(off / room) if off else 0.0)
    return {f"history, {name.replace('_', ' ')}": value for name, value in worst.items()}


def growing(rng: np.random.Generator, _: int) -> Outcome:
    """Return what becomes of a random scene."""
    scene, rtol = drawn(rng)
    found, truth = solved_twice(scene, rtol)
    ratios = over_estimates(found, truth, SCALARS)
    ratios |= fields_over_estimates(found, truth, FIELDS, 1.0 - PLACES)
    return Outcome(ratios | history_ratios(found, truth), f"{scene!r}, rtol {rtol:.1e}")
