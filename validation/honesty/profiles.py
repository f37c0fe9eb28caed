"""True errors of contact under random profiles against their estimates.

Run as ``python validation/honesty/profiles.py [scenes] [seed]``; writes
validation/results/honesty_profiles.md. Scenes have random shapes, radii, compliances and
tolerances; each is solved for its radius, then for its load and its approach. The truth is the same
method with eight degrees more on every panel and two panels more at every end: that the method
converges to the truth is tested against closed forms and by quadrature.
"""

from __future__ import annotations

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("OMP_NUM_THREADS", "1")

import sys
from dataclasses import replace
from math import pi
from pathlib import Path

import numpy as np
from honesty_table import decade, table

from spectral_contact import profiles
from spectral_contact.contact import indented
from spectral_contact.contact.contact_radius import find_radius
from spectral_contact.contact.indented import Indentation, solve_indentation
from spectral_contact.contact.refine import Refinement, Resolution, refine
from spectral_contact.fields.series import Radius

RESULTS = Path(__file__).parents[1] / "results"
LEAST, MOST = -7.0, 4.0  # of the compliance in contact radii, decades
FROM_EDGE = np.concatenate([10.0 ** -np.linspace(0.3, 14.0, 40), np.linspace(0.0, 1.0, 60)])
#: Of a radius that was given, and of a load or approach found from it.
ROUNDING = 1e-15
NAMES = ("radius", "approach", "load", "work", "stiffness", "pressure")


class Better(indented._IndentationProblem):  # the problem itself, in a larger space
    """The problem with eight degrees more, and two panels more at every end."""

    def _first(self, boundary: Radius, sign: int, extent: float) -> Resolution:
        found = super()._first(boundary, sign, extent)
        return Resolution(found.panels, (*found.degrees, 2, 2))

    def start(self) -> Resolution:
        """Return the space."""
        found = super().start()
        degrees = tuple(min(n + 8, 38) for n in found.degrees)
        return Resolution(replace(found.panels, degree=40), degrees)


def drawn(rng: np.random.Generator) -> tuple[profiles.Profile, float]:
    """Return a profile and a contact radius."""
    kind, angle = rng.integers(7), float(rng.uniform(0.1, 1.5))
    size, other = decade(rng, -1.0, 1.0), decade(rng, -1.0, 1.0)
    if kind == 0:
        return profiles.Parabola(size), decade(rng, -2.0, 2.0)
    if kind == 1:
        return profiles.Sphere(size), size * (1.0 - decade(rng, -3.0, -0.02))
    if kind == 2:
        return profiles.Cone(angle), decade(rng, -2.0, 2.0)
    if kind == 3:
        power = float(rng.choice([1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 6.0, 10.0]))
        return profiles.PowerLaw(size, power), decade(rng, -1.0, 1.0)
    if kind == 4:
        return profiles.RoundedFlat(size, other), size * (1.0 + decade(rng, -4.0, 1.5))
    if kind == 5:
        return profiles.TruncatedCone(size, angle), size * (1.0 + decade(rng, -4.0, 1.5))
    c, d = rng.uniform(0.2, 2.0, 2)
    bowl = profiles.Sampled.from_functions(
        lambda r: c * (np.cosh(d * r) - 1.0), lambda r: c * d * np.sinh(d * r), reach=3.0
    )
    return replace(bowl, rounded=True), decade(rng, -1.0, 0.47)


def ratios(rng: np.random.Generator) -> tuple[dict[str, float], str, bool]:
    """Return true errors over estimates for one scene, what it is, and whether it converged.

    The largest of those for its radius, its load and its approach.
    """
    profile, radius = drawn(rng)
    compliance = 10.0 ** rng.uniform(LEAST, MOST) * radius
    tolerance = 10.0 ** rng.uniform(-12.0, -4.0)
    solved = solve_indentation(profile, radius, compliance, tolerance, 20_000)
    assert isinstance(solved, Refinement)
    better = Better(profile, radius, compliance, 1e-13, pointwise=True)
    found, truth = solved.best.value, refine(better, 1e-11, 20_000).best.value
    label = f"{profile.brief}, a = {radius:.6g}, alpha = {compliance:.3g}, rtol = {tolerance:.1e}"
    compared = [_compared(found, truth, 0.0)]

    def at(radius: float, rtol: float, pointwise: bool) -> Indentation | Refinement[Indentation]:
        return solve_indentation(profile, radius, compliance, rtol, 20_000, pointwise=pointwise)

    for load, approach in ((truth.load, None), (None, truth.approach)):
        searched, off = find_radius(
            profile, at, tolerance, load=load, approach=approach, pointwise=True
        )
        value = searched.best.value if isinstance(searched, Refinement) else searched
        compared.append(_compared(value, truth, off))
    largest = {name: max(one[name] for one in compared) for name in NAMES}
    return largest, label, solved.best.error <= tolerance


def _compared(found: Indentation, truth: Indentation, off: float) -> dict[str, float]:
    errors = {name: abs(getattr(found, name) / getattr(truth, name) - 1.0) for name in NAMES[:-1]}
    assert found.pressure is not None
    assert truth.pressure is not None
    s = 1.0 - FROM_EDGE
    exact = truth.pressure(s, FROM_EDGE)
    size = np.maximum(np.abs(exact), truth.load / (pi * truth.radius**2))
    errors["pressure"] = float((np.abs(found.pressure(s, FROM_EDGE) - exact) / size).max())
    # the truth is not exact, and what was asked for has no error but a rounding
    room = {n: getattr(found, f"{n}_error") + getattr(truth, f"{n}_error") for n in NAMES[1:]}
    room["radius"] = off + ROUNDING
    return {name: error / room[name] for name, error in errors.items()}


def main() -> int:
    """Run the study, and write its table."""
    scenes = int(sys.argv[1]) if len(sys.argv) > 1 else 300
    seed = int(sys.argv[2]) if len(sys.argv) > 2 else 1
    rng, found, violations, missed = np.random.default_rng(seed), [], [], 0
    for _ in range(scenes):
        one, label, converged = ratios(rng)
        found.append(one)
        missed += not converged
        beyond = [f"{name} {ratio:.2f}: {label}" for name, ratio in one.items() if ratio > 1.0]
        violations += beyond
        print(*(f"{len(found)}: {told}\n" for told in beyond), end="", flush=True)
    about = (
        f"{scenes} random scenes, seed {seed}, by validation/honesty/profiles.py: true error over "
        f"its estimate; {missed} scenes did not meet their tolerance and said so."
    )
    text = table("Honesty of contacts under profiles", about, found, NAMES, violations)
    (RESULTS / "honesty_profiles.md").write_text(f"{text}\n", encoding="utf-8")
    print(text)
    return 1 if violations else 0


if __name__ == "__main__":
    sys.exit(main())
