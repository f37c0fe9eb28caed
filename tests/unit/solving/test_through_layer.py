"""Contacts through a nonlinear layer: how many corrections, and how small they become."""

from itertools import pairwise

import numpy as np
import pytest

from spectral_contact import Scene, layers, profiles, solve
from spectral_contact.contact.layered_newton import LayeredNewton

#: A law that is steep at first, with two bends inside the contact.
OVERCLOSURES = (-0.122, -0.12, -0.1108, 0.488)
PRESSURES = (0.0, 0.714, 1.048, 28.29)


def test_newton_begins_at_the_contact_of_the_radius_before(corrections):
    """Each radius by itself, from the pressure of every point alone, took 60 corrections."""
    scene = Scene(
        0.3,
        layer=layers.Table(OVERCLOSURES, PRESSURES),
        profile=profiles.Parabola(1.0),
        load=3.54,
    )
    solution = solve(scene, 1e-6, ("approach",))
    assert solution.converged
    assert len(corrections) < 50


BALL = profiles.Parabola(1.0)
THROUGH_LAYERS = {
    "Abaqus' exponential": (layers.Exponential(0.1, 0.2), {"profile": BALL, "load": 1.0}),
    "CalculiX' exponential": (
        layers.CalculixExponential(0.1, 0.2),
        {"profile": BALL, "approach": 0.5},
    ),
    "power 2, of a radius": (layers.PowerLaw(5.0, 2.0), {"profile": BALL, "contact_radius": 1.0}),
    "power 3, cone": (layers.PowerLaw(5.0, 3.0), {"profile": profiles.Cone(1.2), "load": 1.0}),
    "power 2, flat": (layers.PowerLaw(5.0, 2.0), {"profile": profiles.Flat(1.0), "load": 1.0}),
    "rough spheres": (
        layers.GreenwoodWilliamson(10.0, 1.0, 0.5),
        {"profile": BALL, "approach": 3.0},
    ),
    "stiff rough spheres": (
        layers.GreenwoodWilliamson(1e6, 1e-3, 1e-3),
        {"profile": BALL, "load": 1.0},
    ),
}


@pytest.fixture
def changes(monkeypatch):
    """Return a list of runs, each of them what its corrections change of the largest pressure."""
    runs = []
    whole, correction = LayeredNewton.solve, LayeredNewton._correction

    def run(self, w, shift):
        runs.append([])
        return whole(self, w, shift)

    def correct(self, w, at, shift):
        step = correction(self, w, at, shift)
        with np.errstate(over="ignore", invalid="ignore"):
            here = self.setting.pressure(at)
            there = self.setting.pressure(at + self.sampling.values(step.overclosure))
        runs[-1].append(np.abs(there - here).max() / max(here.max(), there.max()))
        return step

    monkeypatch.setattr(LayeredNewton, "solve", run)
    monkeypatch.setattr(LayeredNewton, "_correction", correct)
    return runs


@pytest.mark.parametrize("name", THROUGH_LAYERS)
def test_the_last_corrections_are_quadratic(changes, name):
    layer, given = THROUGH_LAYERS[name]
    assert solve(Scene(0.3, layer=layer, **given), 1e-12).converged
    longest = max(changes, key=len)
    assert len(longest) <= 8
    # above they are not yet the last ones, below they are rounding
    pairs = [(a, b) for a, b in pairwise(longest) if a < 0.1 and b > 1e-12]
    assert pairs
    assert all(after <= 10.0 * before**2 for before, after in pairs)
