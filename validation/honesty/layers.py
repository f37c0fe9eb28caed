"""True errors of contact through random nonlinear layers against their estimates.

Run as ``python validation/honesty/layers.py [scenes] [seed]``; writes
validation/results/honesty_layers.md. Scenes have random laws, shapes, sizes and tolerances. The
truth is the same method with eight degrees more, and two panels more at every end or halved cells:
that the method converges to the truth is tested by collocation, which shares no code with it.
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

from spectral_contact import SceneError, layers, profiles
from spectral_contact.contact.layered_contact import CellProblem, LayeredProblem, solve_layered
from spectral_contact.contact.layered_newton import LayeredSetting
from spectral_contact.contact.layered_setting import (
    has_edge,
    setting_at_approach,
    setting_at_radius,
)
from spectral_contact.contact.on_parts import Indentation
from spectral_contact.contact.refine import refine
from spectral_contact.fields.series import Radius
from spectral_contact.spectral.panels import DiscreteSpace

RESULTS = Path(__file__).parents[1] / "results"
FROM_EDGE = np.concatenate([10.0 ** -np.linspace(0.3, 14.0, 40), np.linspace(0.0, 1.0, 60)])
#: So many scenes from table to table.
EVERY = 50
NAMES = ("approach", "load", "work", "stiffness", "pressure")


class BetterPanels(LayeredProblem):
    """The problem with eight degrees and two panels more."""

    def _first(self, boundary: Radius, sign: int, extent: float) -> DiscreteSpace:
        found = super()._first(boundary, sign, extent)
        return DiscreteSpace(found.panels, (*found.degrees, 2, 2))

    def start(self) -> DiscreteSpace:
        """Return the space."""
        found = super().start()
        degrees = tuple(min(n + 8, 38) for n in found.degrees)
        return DiscreteSpace(replace(found.panels, degree=40), degrees)


class BetterCells(CellProblem):
    """The problem with eight degrees more, and every cell in two."""

    def __init__(self, setting: LayeredSetting, tolerance: float, *, pointwise: bool) -> None:
        assert setting.cells is not None
        ends = np.array(setting.cells.offsets)
        halved = np.sort(np.concatenate([ends, (ends[1:] + ends[:-1]) / 2.0]))
        cells = replace(setting.cells, offsets=tuple(halved.tolist()))
        super().__init__(replace(setting, cells=cells), tolerance, pointwise=pointwise)
        self._degree += 8


def drawn(rng: np.random.Generator) -> LayeredSetting:
    """Return what is to be solved, in units of some radius of curvature."""
    profile = [
        profiles.Parabola(1.0),
        profiles.Parabola(1.0),
        profiles.Cone(float(rng.uniform(0.5, 1.4))),
        profiles.PowerLaw(1.0, float(rng.choice([1.5, 3.0, 4.0]))),
        profiles.RoundedFlat(0.5, 1.0),
        profiles.Flat(1.0),
    ][rng.integers(6)]
    size, strength = decade(rng, -2.0, 0.5), decade(rng, -2.0, 3.0)
    law = [
        layers.PowerLaw(strength / size ** (m := float(rng.uniform(1.0, 5.0))), m),
        layers.Exponential(strength, size),
        layers.CalculixExponential(strength, size),
        layers.GreenwoodWilliamson(strength / size**2, size, size),
        layers.Linear(size / strength),
    ][rng.integers(5)]
    if has_edge(profile, law):
        return setting_at_radius(profile, law, 0.5 + decade(rng, -2.0, 0.5))
    return setting_at_approach(profile, law, max(law.start, -size) + decade(rng, -1.5, 0.3))


def ratios(rng: np.random.Generator) -> tuple[dict[str, float], str, bool]:
    """Return true errors over estimates for one scene, what it is, and whether it converged."""
    setting = drawn(rng)
    if setting.approach is not None and rng.integers(2):  # under a load
        load = solve_layered(setting, 1e-2, 4_000, pointwise=False).best.value.load
        setting = replace(setting, load=load)
    tolerance, pointwise = 10.0 ** rng.uniform(-11.0, -4.0), bool(rng.integers(2))
    solved = solve_layered(setting, tolerance, 4_000, pointwise=pointwise)
    kind = BetterPanels if setting.cells is None else BetterCells
    better = kind(setting, 1e-13, pointwise=True)
    truth = refine(better, 1e-11, 20_000).best.value
    label = f"{setting.profile.brief}, {setting.layer.brief}, radius {setting.radius:.6g}, "
    label += f"approach {truth.approach:.6g}{' under a load' * (setting.load is not None)}, "
    label += f"rtol {tolerance:.1e}{', pressure' * pointwise}"
    converged = solved.best.error <= tolerance
    return _compared(solved.best.value, truth, pointwise), label, converged


def _compared(found: Indentation, truth: Indentation, pointwise: bool) -> dict[str, float]:
    names = NAMES[1:-1]
    errors = {name: abs(getattr(found, name) / getattr(truth, name) - 1.0) for name in names}
    errors["approach"] = abs(found.approach - truth.approach) / truth.approach_size
    errors["pressure"] = 0.0
    if pointwise:
        assert found.pressure is not None
        assert truth.pressure is not None
        s = 1.0 - FROM_EDGE
        exact = truth.pressure(s, FROM_EDGE)
        size = np.maximum(np.abs(exact), truth.load / (pi * truth.radius**2))
        errors["pressure"] = float((np.abs(found.pressure(s, FROM_EDGE) - exact) / size).max())
    # the truth is not exact
    room = {n: getattr(found, f"{n}_error") + getattr(truth, f"{n}_error") for n in NAMES}
    # what is given has no error
    tiny = float(np.finfo(float).tiny)
    return {name: errors[name] / max(room[name], tiny) for name in NAMES}


def main() -> int:
    """Run the study, and write its table from time to time."""
    scenes = int(sys.argv[1]) if len(sys.argv) > 1 else 1000
    seed = int(sys.argv[2]) if len(sys.argv) > 2 else 1
    rng, found, violations, unmet, refused = np.random.default_rng(seed), [], [], [], 0
    while (done := len(found) + refused) < scenes:
        if done and done % EVERY == 0:
            written(done, seed, refused, found, violations, unmet)
        try:
            one, label, converged = ratios(rng)
        except SceneError:  # the profile ends before the pressure does
            refused += 1
            continue
        label = f"scene {done}: {label}"
        found.append(one)
        unmet += [] if converged else [label]
        violations += [f"{name} {ratio:.2f}, {label}" for name, ratio in one.items() if ratio > 1.0]
    print(written(scenes, seed, refused, found, violations, unmet))
    return bool(violations)


def written(
    scenes: int,
    seed: int,
    refused: int,
    found: list[dict[str, float]],
    violations: list[str],
    unmet: list[str],
) -> str:
    """Write the table, and return it."""
    about = (
        f"{scenes} random scenes, seed {seed}, by validation/honesty/layers.py: true error over "
        f"its estimate; {len(unmet)} scenes did not meet their tolerance and said so, {refused} "
        "were refused."
    )
    notes = [*violations, *(f"not met: {one}" for one in unmet)]
    text = table("Honesty of contacts through nonlinear layers", about, found, NAMES, notes)
    (RESULTS / "honesty_layers.md").write_text(f"{text}\n", encoding="utf-8")
    return text


if __name__ == "__main__":
    raise SystemExit(main())
