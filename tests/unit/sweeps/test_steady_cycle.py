"""Steady loops of the load: numbers, limits, thresholds, and a march of rings that knows no law."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracles.cycling_rings import cycle as marched
from oracles.cycling_rings import monotonic, rings
from oracles.property_settings import few

from spectral_contact import ConvergenceError, Scene, SceneError, solve, steady_cycle
from spectral_contact.profiles import Parabola

SCENE = Scene(0.1, 0.5, 0.5, 0.1)
#: A scene, the lowest load, and whether nothing slips forward while the load falls.
MARCHED = {
    "slip at the edge": (SCENE, 0.1, True),
    "slip inside": (Scene(0.3, 0.05, 1.0, 0.03), 0.03, True),
    "forward slip goes on": (SCENE, 0.005, False),
}


def ends(count):
    """Return ends of rings that are graded to the edge."""
    return np.sqrt(1.0 - np.linspace(1.0, 0.0, count + 1) ** 2)


def test_the_numbers_of_the_theory_come_out():
    found = steady_cycle(SCENE, 0.1, rtol=1e-8)
    error = found.error
    assert found.converged
    assert max(error.dissipation, error.stick_radius, error.shakedown_ratio) < 1e-8
    for value, truth, estimate in (
        (found.shakedown_ratio, 0.2222123728874, error.shakedown_ratio),
        (found.stick_radius, 0.796332359460, error.stick_radius),
        (found.unloading_dissipation, 1.8465335411e-5, error.unloading_dissipation),
        (found.reloading_dissipation, 1.01208848946e-4, error.reloading_dissipation),
    ):
        assert abs(value / truth - 1.0) <= estimate + 3e-12  # digits that are shown
    assert found.dissipation == found.unloading_dissipation + found.reloading_dissipation


@pytest.mark.parametrize("name", MARCHED)
def test_a_march_of_rings_has_the_loop(name):
    scene, lowest, known = MARCHED[name]
    found = steady_cycle(scene, lowest, rtol=1e-3)
    own = rings(ends(60), scene.normal_compliance, scene.tangential_compliance, scene.kappa)
    down, up = marched(own, scene.friction, lowest, 80, 2)
    assert up.dissipated.sum() == pytest.approx(found.reloading_dissipation, rel=4e-3)
    assert (found.unloading_dissipation is not None) == known == (found.slack > -1e-9)
    if known:
        assert down.dissipated.sum() == pytest.approx(
            found.unloading_dissipation, rel=1e-2
        )  # steps
    middles = np.sqrt((own.ends[1:] ** 2 + own.ends[:-1] ** 2) / 2.0)
    moved = np.abs(down.moved[-1] - down.moved[0])
    slipped = found.slip_amplitude(middles)
    assert np.abs(moved - slipped).max() < 2e-3 * slipped.max()
    # the disk at the centre is no ring, and the last one has the edge in it
    change = (down.traction[0] - down.traction[-1])[5:-1]
    assert np.abs(change / found.traction_change(middles[5:-1]) - 1.0).max() < 1e-3
    shear = 2.0 * np.pi * (down.traction @ own.areas)
    assert shear[0] - shear[-1] == pytest.approx(-found.reloading.shear[0], rel=1e-3)


def test_where_forward_slip_goes_on_more_is_dissipated_than_the_formula_has():
    scene, lowest, _ = MARCHED["forward slip goes on"]
    found = steady_cycle(scene, lowest, rtol=1e-4)
    assert found.slack < -1e-3
    assert found.dissipation is found.unloading_dissipation is found.error.dissipation is None
    assert "forward" in repr(found)
    assert "unloading is not known" in found.summary()
    own = rings(ends(60), 0.5, 0.5, scene.kappa)
    down, _ = marched(own, 0.1, lowest, 100, 3)
    # the rings, which have the same law, dissipate more on the way down than it says
    assert down.dissipated.sum() > 1.01 * _by_law(own, 0.1, lowest)


def _by_law(own, friction, lowest):
    """Return what rings dissipate while the load falls, by the formula of the steady loop."""

    def mean(other):
        return -2.0 * np.pi * (own.areas * own.pressure) @ monotonic(own, other)[1]

    x, w = np.polynomial.legendre.leggauss(40)
    loads = lowest + (1.0 - lowest) * (x + 1.0) / 2.0
    means = [mean(friction * (1.0 + one) / (1.0 - one)) for one in loads]
    whole = (1.0 - lowest) / 2.0 * w @ ((1.0 - loads) * means)
    at_end = mean(friction * (1.0 + lowest) / (1.0 - lowest))
    return friction * (lowest * (1.0 - lowest) * at_end + whole)


def test_nothing_is_dissipated_from_the_shakedown_ratio_on():
    ratio = solve(SCENE, 1e-12).shakedown_ratio
    for lowest in (ratio, 1.0005 * ratio, 0.9):
        found = steady_cycle(SCENE, lowest)
        assert found.converged
        assert found.dissipation == found.reloading_dissipation == 0.0
        assert found.stick_radius == 1.0
        assert (found.slip_amplitude(np.linspace(0.0, 1.0, 5)) == 0.0).all()
        assert "shaken down" in found.summary()


def test_next_to_the_shakedown_ratio_little_is_dissipated():
    ratio = solve(SCENE, 1e-12).shakedown_ratio
    found = steady_cycle(SCENE, 0.9995 * ratio, rtol=1e-4)
    assert found.dissipation == pytest.approx(1.4547526e-10, rel=1e-4)
    assert found.unloading_dissipation > 0.0 < found.reloading_dissipation


@pytest.mark.parametrize(
    ("scene", "power", "within"),
    [(SCENE, 2.0, 0.03), (Scene(0.3, 0.05, 1.0, 0.03), 1.5, 0.03)],
    ids=["slip at the edge", "slip inside"],
)
def test_next_to_the_shakedown_ratio_a_power_of_the_distance_is_dissipated(scene, power, within):
    ratio = solve(scene, 1e-12).shakedown_ratio
    near, far = (steady_cycle(scene, (1.0 - one) * ratio, rtol=1e-3) for one in (1e-3, 4e-3))
    found = math.log(far.dissipation / near.dissipation) / math.log(4.0)
    assert found == pytest.approx(power, abs=within)


def test_the_mirror_has_the_same_loop():
    mirror = Scene.from_kappa(-SCENE.kappa, 0.5, 0.5, friction=0.1)
    own, other = (steady_cycle(one, 0.15, rtol=1e-2) for one in (SCENE, mirror))
    assert other.dissipation == own.dissipation
    assert other.slip_amplitude(0.95) == own.slip_amplitude(0.95) > 0.0
    for at in ("highest", "lowest"):
        assert other.traction(0.95, at) == -own.traction(0.95, at)
        low, high = own.traction_bounds(0.5, at)
        assert other.traction_bounds(0.5, at) == (-high, -low)
    assert (other.unloading.shear == -own.unloading.shear).all()


@pytest.mark.parametrize(
    ("changes", "stick"),
    [({"friction": 0.0}, 0.0), ({"friction": math.inf}, 1.0), ({"poisson_ratio": 0.5}, 1.0)],
)
def test_limits_dissipate_nothing(changes, stick):
    found = steady_cycle(SCENE.replace(**changes), 0.3)
    assert found.converged
    assert found.dissipation == found.error.dissipation == 0.0
    assert found.stick_radius == stick


def test_without_tangential_compliance_every_cycle_dissipates():
    scene = SCENE.replace(tangential_compliance=0.0)
    found = steady_cycle(scene, 0.95, rtol=1e-2)
    assert found.shakedown_ratio == 1.0
    assert found.converged
    assert 0.0 < found.dissipation < steady_cycle(scene, 0.9, rtol=1e-2).dissipation


def test_forward_slip_is_not_overlooked_at_loose_tolerances():
    # the slack is -1.4e-5, less than what errors of the first solves make of it
    loose = steady_cycle(SCENE, 0.0192968, rtol=1e-2)
    assert loose.slack == pytest.approx(-1.45810262e-5, rel=1e-2)  # at rtol 1e-6
    assert loose.unloading_dissipation is None


def test_a_load_that_nearly_vanishes_has_the_limit_of_what_is_dissipated():
    limit, tiny, tiniest = (
        steady_cycle(SCENE, one, rtol=1e-4).reloading_dissipation for one in (1e-7, 1e-16, 1e-300)
    )
    # lambda is lost in the friction of the loop, and must not be in what is integrated
    assert tiny == pytest.approx(limit, rel=1e-6)
    assert tiniest == pytest.approx(tiny, rel=1e-13)


def test_next_to_shakedown_loose_solves_are_not_the_last_word():
    ratio = solve(SCENE, 1e-12).shakedown_ratio
    near, nearer = (steady_cycle(SCENE, (1.0 - one) * ratio, rtol=1e-2) for one in (1e-7, 1e-8))
    assert 0.0 < nearer.error.dissipation <= 1e-2
    # as the square of the distance
    assert near.dissipation / nearer.dissipation == pytest.approx(100.0, rel=1e-2)
    undecided = steady_cycle(SCENE, ratio, rtol=1e-2)
    assert undecided.dissipation == 0.0
    assert undecided.error.dissipation == 1.0
    # the bounds are those of a loop that does slip a little
    bounds = undecided.traction_bounds([0.5, 0.99]), nearer.traction_bounds([0.5, 0.99])
    assert np.allclose(*bounds, rtol=1e-6)


def test_friction_so_large_that_slip_has_no_digits_has_no_digits_of_the_dissipation():
    scene = SCENE.replace(tangential_compliance=0.0, friction=1e70)
    found = steady_cycle(scene, 0.5, rtol=1e-2, strict=False)
    assert not found.converged
    assert found.error.reloading_dissipation >= 1.0
    with pytest.raises(SceneError, match=r"^friction = 1e\+120"):
        steady_cycle(scene.replace(friction=1e120), 0.5)


@pytest.mark.parametrize("lowest", [0.0, 1.0, -0.1, 1.5, math.nan, "half", None])
def test_a_lowest_load_out_of_range_is_refused(lowest):
    with pytest.raises(SceneError, match="lowest"):
        steady_cycle(SCENE, lowest)


@pytest.mark.parametrize(
    ("scene", "name"),
    [
        (SCENE.replace(coupling=True), "coupling"),
        (SCENE.replace(friction=None), "friction"),
        (Scene(0.1, friction=0.1, profile=Parabola(1.0), load=0.1), "profile"),
        ("punch", "scene"),
    ],
)
def test_scenes_for_which_the_law_does_not_hold_are_refused(scene, name):
    with pytest.raises(SceneError, match=f"^{name}"):
        steady_cycle(scene, 0.5)


def test_a_tolerance_that_is_not_met_carries_the_best_loop():
    options = {"rtol": 1e-8, "max_unknowns": 40}
    with pytest.raises(ConvergenceError) as caught:
        steady_cycle(SCENE, 0.2, **options)
    assert not caught.value.solution.converged
    assert not steady_cycle(SCENE, 0.2, **options, strict=False).converged


@few
@given(
    logs=st.tuples(st.floats(-2.0, 1.0), st.floats(-2.0, 1.0)),
    share=st.floats(0.2, 0.9),
    down=st.floats(0.1, 0.95),
)
def test_what_must_hold_for_every_loop(logs, share, down):
    alpha, beta = (10.0**one for one in logs)
    critical = solve(Scene(0.2, alpha, beta, math.inf), 1e-6).critical_friction
    scene = Scene(0.2, alpha, beta, share * critical)
    lowest = down * (1.0 - share) / (1.0 + share)
    found, closer = (steady_cycle(scene, lowest, rtol=one) for one in (1e-2, 1e-4))
    assert found.converged
    off = abs(found.reloading_dissipation / closer.reloading_dissipation - 1.0)
    assert off <= found.error.reloading_dissipation + closer.error.reloading_dissipation
    s = np.linspace(0.01, 0.999, 60)
    limit = scene.friction * (1.0 + lowest) * found.solution.pressure(s)
    change, slipped = found.traction_change(s), found.slip_amplitude(s)
    assert (np.abs(change) <= limit * (1.0 + 1e-3)).all()
    assert np.allclose(change[slipped > 0.0], limit[slipped > 0.0], rtol=1e-3)
    # no more than all of the slip at the largest load
    whole = 2.0 * np.pi * np.trapezoid(limit * slipped * s, s) / (1.0 + lowest)
    assert found.reloading_dissipation <= 1.1 * whole
    if found.dissipation is not None:
        assert found.unloading_dissipation <= found.reloading_dissipation
        assert found.unloading.shear[-1] == pytest.approx(found.reloading.shear[0])
