"""Scenes solved one after another: what they share changes no number."""

import math

import numpy as np
import pytest

from spectral_contact import QUANTITIES, Scene, SceneError, profiles, solve, sweep
from spectral_contact.contact import zone_problem
from spectral_contact.contact.layout import Layout
from spectral_contact.solving.sharing import StickPath, ZonePath
from spectral_contact.solving.solver import Continuation

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
            assert abs(value / truth - 1.0) <= max(both, 1e-13)


@pytest.mark.parametrize("rtol", [1e-5, 1e-12])
@pytest.mark.parametrize(
    ("alpha", "beta"), [(0.5, 0.5), (0.3, 1e-6), (1e-6, 1e-6), (0.2, 0.0), (0.0, 0.0)]
)
def test_a_walk_down_in_friction(alpha, beta, rtol):
    agree([Scene(0.3, alpha, beta, f) for f in (0.14, 0.1, 0.07, 1e-3, 9e-4, 1e-9)], rtol)


def test_a_walk_down_where_the_edge_sticks():
    agree([Scene(0.3, 0.0, 0.3, f) for f in (0.14, 0.1, 1e-3)], 1e-5)


@pytest.mark.parametrize("rtol", [1e-5, 1e-8])
def test_through_the_onset_of_interior_slip(rtol):
    agree([Scene(0.3, 0.05, 1.0, f / 7) for f in (0.3, 0.262, 0.25, 0.24, 0.23, 0.1)], rtol)


def test_in_any_order():
    rng = np.random.default_rng(1)
    scenes = [
        Scene(float(rng.choice([0.1, 0.3, 0.5])), *rng.choice([1e-3, 0.5], 2).tolist(), friction)
        for friction in (None, 0.0, math.inf, 0.01, 0.2, 0.05, 0.01, 0.3, None, 0.1)
    ]
    agree(scenes, 1e-8)


def test_everything_that_can_be_asked():
    scenes = [Scene(0.3, 0.5, 0.5, f) for f in (0.05, 0.06, 0.05)]
    continuation = Continuation(1e-8, QUANTITIES, 20_000)
    for scene in scenes:
        found, expected = continuation.solve(scene), solve(scene, 1e-8)
        s = np.array([0.1, 0.5, 0.9, 1.0])
        for name in ("pressure", "traction", "slip"):
            values, truth = getattr(found, name)(s), getattr(expected, name)(s)
            assert np.allclose(values, truth, rtol=0.0, atol=1e-12)


def test_neighbours_find_the_disk_in_few_systems(monkeypatch):
    systems = []
    original = zone_problem.FreeBoundaryProblem.system

    def counted(self, *arguments, **more):
        systems.append(1)
        return original(self, *arguments, **more)

    monkeypatch.setattr(zone_problem.FreeBoundaryProblem, "system", counted)
    scenes = [Scene(0.3, 0.5, 0.5, f) for f in np.linspace(0.02, 0.09, 8)]
    counts = []
    continuation = Continuation(1e-8, ("stick_radius",), 20_000)
    for walk in (continuation.solve, lambda scene: solve(scene, 1e-8, ["stick_radius"])):
        systems.clear()
        for scene in scenes:
            walk(scene)
        counts.append(len(systems))
    assert counts[0] < 0.9 * counts[1]


def test_a_wild_guess_is_no_guess():
    """Frictions next to each other, then one far off: a polynomial through them goes anywhere."""
    frictions = [*(0.0999 + 1e-5 * np.arange(7)), 0.03]
    continuation = Continuation(1e-8, ("stick_radius",), 20_000)
    found = [continuation.solve(Scene(0.3, 0.5, 0.5, f)).stick_radius for f in frictions]
    assert found[-1] == pytest.approx(solve(Scene(0.3, 0.5, 0.5, 0.03), 1e-8).stick_radius, 1e-9)


def walk_inside(rtol, frictions, quantities=("stick_radius", "total_shear")):
    """Return scenes that slip in an interior annulus."""
    return [Scene(0.3, 0.05, 1.0, f) for f in frictions], Continuation(rtol, quantities, 20_000)


def test_neighbours_find_interior_zones_in_few_systems(monkeypatch):
    systems = []
    solve_system = zone_problem.FreeBoundaryProblem.system

    def counted(problem, *form, **more):
        systems.extend([1] * (len(problem.states) > 2))  # those of one disk come before
        return solve_system(problem, *form, **more)

    monkeypatch.setattr(zone_problem.FreeBoundaryProblem, "system", counted)
    scenes, continuation = walk_inside(1e-8, np.linspace(0.0336, 0.035, 10))
    for scene in scenes[:-5]:
        continuation.solve(scene)
    systems.clear()
    for scene in scenes[-5:]:
        assert continuation.solve(scene).converged
    handed_on = len(systems)
    systems.clear()
    solve(scenes[-1], 1e-8, ["stick_radius", "total_shear"])
    assert handed_on <= 15  # three for a scene
    assert len(systems) <= 12  # those of a Jacobian by differences, and of two spaces


@pytest.mark.parametrize("rtol", [1e-4, 1e-8, 1e-12])
def test_a_walk_of_small_steps_inside(rtol):
    scenes, _ = walk_inside(rtol, np.linspace(0.032, 0.034, 12))
    agree(scenes, rtol)


def test_a_walk_along_the_compliance_inside():
    agree([Scene(0.3, 0.05, beta, 0.033) for beta in np.geomspace(0.9, 1.2, 6)], 1e-8)


@pytest.mark.parametrize("rtol", [1e-5, 1e-8])
def test_zones_that_do_not_fit_are_noticed(rtol):
    # slip reaches the edge on the way, and goes back inside
    frictions = [0.0300, 0.0298, 0.0290, 0.0285, 0.0298]
    continuation = Continuation(rtol, ("zones", "stick_radius"), 20_000)
    counts = []
    for friction in frictions:
        scene = Scene(0.3, 0.05, 1.0, friction)
        found, expected = continuation.solve(scene), solve(scene, rtol, ["zones", "stick_radius"])
        assert [z.kind for z in found.zones] == [z.kind for z in expected.zones]
        for one, other in zip(found.zones, expected.zones, strict=True):
            assert abs(one.outer - other.outer) <= found.error.zones + expected.error.zones
        counts.append(len(found.zones))
    assert set(counts) >= {2, 3}


def place(friction, beta=1.0):
    return -math.inf, math.log(beta), math.log(friction)


def test_the_path_of_the_zones():
    path = ZonePath()
    assert path.predict(place(0.1)) is None
    slopes = np.array([[0.3]])
    path.add(place(0.1), Layout((-1.0,), (0, 1), slopes))
    assert path.predict(place(0.15)).logits == (-1.0,)
    assert path.predict(place(0.01)) is None  # too far
    path.add(place(0.2), Layout((-0.5,), (0, 1), 2 * slopes))
    near = path.predict(place(0.4))
    assert near.logits[0] == pytest.approx(0.0)
    assert near.jacobian == pytest.approx(3 * slopes)
    assert path.predict(place(0.2)).logits == (-0.5,)  # the same scene again
    assert path.predict(place(0.2, 1.1)).logits == (-0.5,)  # other compliances, near by
    path.add(place(0.2), Layout((-0.5,), (0, 1), slopes))  # twice the same gives no direction
    assert path.predict(place(0.25)).logits == (-0.5,)
    path.add(place(0.3), None)
    assert path.predict(place(0.3)) is None


def test_the_path_is_a_polynomial_through_its_last_scenes():
    path, at = ZonePath(), np.log(0.1) + np.array([0.0, 0.1, 0.25, 0.3, 0.45])
    cubic = np.polynomial.Polynomial([0.3, -1.0, 2.0, 0.5])
    slopes = np.array([[1.0, 0.0], [0.0, 1.0], [0.5, 0.5]])
    for t in at:
        logits = (float(cubic(t)), float(cubic(t)) + 20.0)
        path.add((0.0, 0.0, t), Layout(logits, (0, 1, 0), t * slopes))
    near = path.predict((0.0, 0.0, at[-1] + 0.2))
    assert near.logits[0] == pytest.approx(cubic(at[-1] + 0.2), abs=1e-11)
    assert np.allclose(near.jacobian, (at[-1] + 0.2) * slopes, atol=1e-12)
    # boundaries in the wrong order are no guess
    path.add((0.0, 0.0, at[-1] + 0.1), Layout((0.0, 1e-6), (0, 1, 0), slopes))
    assert path.predict((0.0, 0.0, at[-1] + 0.9)).logits == (0.0, 1e-6)
    assert path.predict((0.5, 0.0, at[-1] + 0.1)).logits == (0.0, 1e-6)  # not on the line
    # zones of another kind begin anew
    path.add((0.0, 0.0, 0.0), Layout((0.0,), (0, 1), slopes[:1, :1]))
    assert path.predict((0.0, 0.0, 0.1)).logits == (0.0,)


def test_a_compliance_that_was_zero_is_on_no_line():
    """Its logarithm is infinite; scenes after it were said to have boundaries that are NaN."""
    path = ZonePath()
    for beta, logit in ((0.0, -1.0), (0.05, 0.3)):
        path.add((0.0, math.log(beta) if beta else -math.inf, 0.0), Layout((logit,), (0, 1)))
    assert path.predict((0.0, math.log(0.06), 0.0)).logits == (0.3,)
    # nor is one on the line of friction
    assert path.predict((0.0, math.log(0.05), 0.2)).logits == (0.3,)
    frictions = Scene(0.3, 0.3, friction=0.1)
    found = sweep(frictions, tangential_compliance=[0, 0.05, 0.06, 0.07], rtol=1e-6)
    assert (found.ending == "converged").all()


def test_scenes_next_to_each_other_do_not_lead_far_away():
    path = ZonePath()
    for k, friction in enumerate([0.1, 0.2, 0.2 * (1.0 + 1e-9)]):
        path.add(place(friction), Layout((math.log(friction) + (-1) ** k * 1e-6,), (0, 1)))
    assert path.predict(place(0.3)).logits[0] == pytest.approx(math.log(0.3), abs=1e-4)
    d = 1e-12
    loads = [1.0, 1.0 + d, 1.0 + 3 * d, 1.0 + 7 * d, 1.0 + 13 * d, 2.0]
    scene = Scene(0.3, 0.3, friction=0.0, profile=profiles.Parabola(1.0), load=1.0)
    found = sweep(scene, load=loads, quantities=["approach"], rtol=1e-5)
    assert (found.ending == "converged").all()


def test_radii_of_a_growing_contact_that_differ_by_their_errors_lead_nowhere():
    """Points next to the end of a flat part are 1e-12 apart, and their stick radii 1e-8 off."""
    path = StickPath(0.2, 0.2)

    def place_of(radius):
        return math.log(0.2 / radius), math.log(0.2 / radius), 0.0

    for k in range(6):
        layout = Layout((0.24 + (-1) ** k * 1e-8,), (0, 1), np.eye(1))
        path.add(place_of(0.5 * (1.0 + 1e-11 * (k + 1))), layout)
    assert path.predict(place_of(0.5 * (1.0 + 3e-6))).logits[0] == pytest.approx(0.24, abs=2e-8)
    # radii that are apart are interpolated
    apart = StickPath(0.2, 0.2)
    for radius in (0.5, 0.6, 0.75, 0.9, 1.0):
        apart.add(place_of(radius), Layout((math.log(radius) ** 2,), (0, 1), np.eye(1)))
    assert apart.predict(place_of(0.8)).logits[0] == pytest.approx(math.log(0.8) ** 2, abs=1e-12)


def test_what_cannot_be_asked_is_refused_before_any_scene():
    with pytest.raises(SceneError, match="at least 1e-12 unless"):
        Continuation(1e-13, ("pressure",), 100)
    with pytest.raises(SceneError, match="max_unknowns"):
        Continuation(1e-8, ("pressure",), 0)
