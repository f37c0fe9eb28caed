"""Scenes solved one after another: what they share changes no number."""

import math

import numpy as np
import pytest

from spectral_contact import QUANTITIES, Scene, SceneError, solve
from spectral_contact.contact import one_disk
from spectral_contact.sharing import DiskPath
from spectral_contact.solver import Continuation

SCALARS = ("approach", "stick_radius", "total_shear", "edge_ratio", "critical_friction")


def agree(scenes, rtol, quantities=SCALARS):
    continuation = Continuation(rtol, quantities, 20_000)
    for scene in scenes:
        found, expected = continuation.solve(scene), solve(scene, rtol, quantities, strict=False)
        assert found.ending is expected.ending
        for name in SCALARS:
            if name not in expected.plan.quantities:
                continue
            value, truth = getattr(found, name), getattr(expected, name)
            if truth is None or truth in (0.0, math.inf):
                assert value == truth
                continue
            both = getattr(found.error, name) + getattr(expected.error, name)
            assert abs(value / truth - 1.0) <= max(0.1 * both, 1e-13)


@pytest.mark.parametrize("rtol", [1e-5, 1e-12])
def test_a_walk_down_in_friction(rtol):
    for alpha, beta in ((0.5, 0.5), (0.3, 1e-6), (1e-6, 1e-6), (0.2, 0.0), (0.0, 0.0)):
        agree([Scene(0.3, alpha, beta, f) for f in (0.14, 0.1, 0.07, 1e-3, 9e-4, 1e-9)], rtol)


def test_a_walk_down_where_the_edge_sticks():
    agree([Scene(0.3, 0.0, 0.3, f) for f in (0.14, 0.1, 1e-3)], 1e-5)


def test_through_the_onset_of_interior_slip():
    agree([Scene(0.3, 0.05, 1.0, f / 7) for f in (0.3, 0.262, 0.25, 0.24, 0.23, 0.1)], 1e-8)


def test_in_any_order():
    rng = np.random.default_rng(1)
    scenes = [
        Scene(float(rng.choice([0.1, 0.3, 0.5])), *rng.choice([1e-3, 0.5], 2).tolist(), friction)
        for friction in (None, 0.0, math.inf, 0.01, 0.2, 0.05, 0.01, 0.3, None, 0.1)
    ]
    agree([*scenes, *reversed(scenes)], 1e-8)


def test_everything_that_can_be_asked():
    scenes = [Scene(0.3, 0.5, 0.5, f) for f in (0.05, 0.06, 0.05)]
    continuation = Continuation(1e-8, QUANTITIES, 20_000)
    for scene in scenes:
        found, expected = continuation.solve(scene), solve(scene, 1e-8)
        s = np.array([0.1, 0.5, 0.9, 1.0])
        for name in ("pressure", "traction", "slip"):
            values, truth = getattr(found, name)(s), getattr(expected, name)(s)
            assert np.allclose(values, truth, rtol=0.0, atol=1e-12)


def test_neighbours_find_the_disk_in_few_trials(monkeypatch):
    trials = []
    original = one_disk._OneDiskProblem._trial

    def counted(self, *arguments):
        trials.append(1)
        return original(self, *arguments)

    monkeypatch.setattr(one_disk._OneDiskProblem, "_trial", counted)
    scenes = [Scene(0.3, 0.5, 0.5, f) for f in np.linspace(0.02, 0.09, 15)]
    counts = []
    continuation = Continuation(1e-8, ("stick_radius",), 20_000)
    for walk in (continuation.solve, lambda scene: solve(scene, 1e-8, ["stick_radius"])):
        trials.clear()
        for scene in scenes:
            walk(scene)
        counts.append(len(trials))
    assert counts[0] < min(5.5 * len(scenes), 0.8 * counts[1])


def test_the_path_of_the_disk():
    path = DiskPath()
    assert path.near(0.1) is None
    path.add(0.1, (-1.0, 0.3))
    assert path.near(0.15) == (-1.0, 0.3)
    assert path.near(0.01) is None  # too far
    path.add(0.2, (-0.5, 0.2))
    logit, slope = path.near(0.4)
    assert logit == pytest.approx(0.0)
    assert slope == 0.2
    path.add(0.2, (-0.5, 0.2))  # twice the same gives no direction
    assert path.near(0.25) == (-0.5, 0.2)
    path.add(0.3, None)  # there was more than one disk
    assert path.near(0.3) is None


def test_what_cannot_be_asked_is_refused_before_any_scene():
    with pytest.raises(SceneError, match="at least 1e-12 unless"):
        Continuation(1e-13, ("pressure",), 100)
    with pytest.raises(SceneError, match="max_unknowns"):
        Continuation(1e-8, ("pressure",), 0)
