"""True errors of contact through random nonlinear layers against their estimates.

A stratum of honesty.py. Scenes have random laws, shapes, sizes and tolerances. The truth is the
same method with eight degrees more, and two panels more at every end or halved cells: that the
method converges to the truth is tested by collocation, which shares no code with it.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from oracles.user_laws import Hardening, Softplus
from profiles import InLargerSpace, as_solution, compared
from strata import Outcome, decade

from spectral_contact import layers as laws
from spectral_contact import profiles as shapes
from spectral_contact.contact.layered_contact import CellProblem, LayeredProblem, solve_layered
from spectral_contact.contact.layered_newton import LayeredSetting
from spectral_contact.contact.layered_setting import (
    has_edge,
    setting_at_approach,
    setting_at_radius,
)
from spectral_contact.contact.refine import refine


class BetterPanels(InLargerSpace, LayeredProblem):
    """The problem with eight degrees and two panels more."""


class BetterCells(CellProblem):
    """The problem with eight degrees more, and every cell in two."""

    def __init__(self, setting: LayeredSetting, tolerance: float, *, pointwise: bool) -> None:
        ends = np.array(setting.cells.offsets)
        halved = np.sort(np.concatenate([ends, (ends[1:] + ends[:-1]) / 2.0]))
        cells = replace(setting.cells, offsets=tuple(halved.tolist()))
        super().__init__(replace(setting, cells=cells), tolerance, pointwise=pointwise)
        self._degree += 8


def user_law(rng: np.random.Generator, size: float, strength: float) -> laws.Layer:
    """Return one of the laws that a user might write.

    None has a knot, at which the truth would have to end panels, too: see bent_layers.py.
    """
    begin = float(rng.uniform(-1.0, 1.0)) * size
    return [Hardening(strength, size, begin), Softplus(strength, size)][rng.integers(2)]


def drawn(rng: np.random.Generator, *, of_user: bool) -> LayeredSetting:
    """Return what is to be solved, in units of some radius of curvature."""
    profile = [
        shapes.Parabola(1.0),
        shapes.Parabola(1.0),
        shapes.Cone(float(rng.uniform(0.5, 1.4))),
        shapes.PowerLaw(1.0, float(rng.choice([1.5, 3.0, 4.0]))),
        shapes.RoundedFlat(0.5, 1.0),
        shapes.Flat(1.0),
    ][rng.integers(6)]
    size, strength = decade(rng, -2.0, 0.5), decade(rng, -2.0, 3.0)
    law = [
        laws.PowerLaw(strength / size ** (m := float(rng.uniform(1.0, 5.0))), m),
        laws.Exponential(strength, size),
        laws.CalculixExponential(strength, size),
        laws.GreenwoodWilliamson(strength / size**2, size, size),
        laws.Linear(size / strength),
    ][rng.integers(5)]
    if of_user:
        law = user_law(rng, size, strength)
    if has_edge(profile, law):
        return setting_at_radius(profile, law, 0.5 + decade(rng, -2.0, 0.5))
    return setting_at_approach(profile, law, max(law.start, -size) + decade(rng, -1.5, 0.3))


def measured(rng: np.random.Generator, *, of_user: bool) -> Outcome:
    """Return what becomes of a contact through a law of the library, or of a user."""
    setting = drawn(rng, of_user=of_user)
    if setting.approach is not None and rng.integers(2):  # under a load
        load = solve_layered(setting, 1e-2, 4_000, pointwise=False).best.value.load
        setting = replace(setting, load=load)
    tolerance = 10.0 ** rng.uniform(-11.0, -4.0)
    pointwise = bool(rng.integers(2))
    solved = solve_layered(setting, tolerance, 4_000, pointwise=pointwise)
    kind = BetterPanels if setting.cells is None else BetterCells
    truth = refine(kind(setting, 1e-13, pointwise=True), 1e-11, 20_000).best.value
    label = f"{setting.profile.brief}, {setting.layer.brief}, radius {setting.radius:.6g}, "
    label += f"approach {truth.approach:.6g}{' under a load' * (setting.load is not None)}, "
    label += f"rtol {tolerance:.1e}{', pressure' * pointwise}"
    found = solved.best.value if pointwise else replace(solved.best.value, pressure=None)
    ratios = compared(as_solution(found), as_solution(truth))
    return Outcome(ratios, label, solved.best.error <= tolerance)


def layers(rng: np.random.Generator, _: int) -> Outcome:
    """Return what becomes of a contact through a law of the library."""
    return measured(rng, of_user=False)


def user_layers(rng: np.random.Generator, _: int) -> Outcome:
    """Return what becomes of a contact through a law that a user wrote."""
    return measured(rng, of_user=True)
