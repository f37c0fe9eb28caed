"""The contact radius of a given load: searches that end early, and those out of range."""

import math

import numpy as np
import pytest

from spectral_contact import Scene, SceneError, profiles, solve
from spectral_contact.contact import contact_radius
from spectral_contact.contact.contact_radius import find_radius, indenter, value_of

BALL = profiles.Parabola(1.0)
#: Load and radius of a smooth contact, ``P = 16/3 a**3`` in units of E'.
LOAD, RADIUS = 16.0 / 3.0 * 0.3**3, 0.3


def found(profile=BALL, load=LOAD, approach=None, near=None):
    """Return the contact and the relative error of its radius."""
    given = {"load": load, "approach": approach, "pointwise": False, "near": near}
    return find_radius(profile, indenter(profile, 0.0, 1000), 1e-10, **given)


def test_a_search_that_settles_has_the_radius_to_its_error():
    contact, error = found()
    assert abs(contact.radius / RADIUS - 1.0) <= error
    assert error < 1e-10


@pytest.mark.parametrize("near", [0.2, 0.6, 0.9])
def test_of_a_search_that_does_not_settle_no_digit_is_known(near, monkeypatch):
    """Twice the residual, made linear, was too little for a start at three times the radius."""
    monkeypatch.setattr(contact_radius, "_MAX_STEPS", 1)
    contact, error = found(profiles.Sphere(1.0), near=near)
    assert error == contact.approach_error == math.inf
    assert contact.load_error == 0.0


@pytest.mark.parametrize("load", [1e-3, 0.5])
def test_a_flat_part_may_be_wider_than_what_is_beyond_it(load):
    """The first radius was half of the flat part beyond it, where this profile has ended."""
    r = np.linspace(0.0, 1.2, 25)
    wide = profiles.Sampled.from_points(r, np.where(r > 1.0, (r - 1.0) ** 2, 0.0))
    contact, error = found(wide, load=load)
    assert wide.flat_part < contact.radius < wide.reach
    again, _ = found(wide, load=None, approach=contact.approach)
    assert again.load == pytest.approx(load, rel=1e-9)
    assert abs(again.radius / contact.radius - 1.0) <= 2.0 * error + 1e-10


def test_a_load_beyond_the_profile_is_refused():
    with pytest.raises(SceneError, match="the range of the profile") as refused:
        found(profiles.Sphere(1.0), load=1e9)
    assert refused.value.parameter == "load"


@pytest.mark.parametrize("compliance", [0.0, 1.0])
@pytest.mark.parametrize("size", [1e-305, 1e305])
@pytest.mark.parametrize("name", ["load", "approach"])
def test_what_floating_point_numbers_cannot_hold_is_refused_by_its_name(name, size, compliance):
    """Divisions by a work of 0, powers that overflow and logarithms of 0 raised other errors."""
    given = {"load": None, "approach": None, name: size}
    solve = indenter(profiles.Parabola(10.0), compliance, 1000)
    with pytest.raises(SceneError, match=f"^{name} = "):
        find_radius(profiles.Parabola(10.0), solve, 1e-10, **given, pointwise=False)


def test_the_error_of_the_radius_is_positive_under_the_thinnest_layer():
    """It was negative: the rate of the load was lost in rounding, and had the wrong sign."""
    cone = profiles.Cone(0.1)
    smooth = value_of(indenter(cone, 0.0, 1000)(1.0, 1e-10, False))
    solve = indenter(cone, 1e-14, 1000)
    solved, error = find_radius(
        cone, solve, 1e-10, load=smooth.load, approach=None, pointwise=False
    )
    assert 0.0 < error < 1e-10
    # the load of a thin layer is smaller by about the compliance over the radius
    assert abs(value_of(solved).radius - 1.0) <= error + 1e-13


def test_a_load_whose_radius_is_rounded_to_the_flat_part_is_said_to_be_too_small():
    """The error said that the radius was not enough, as of loads that are too large."""
    with pytest.raises(SceneError, match="load = 1e-12: must be larger"):
        found(profiles.TruncatedCone(0.5, 1.2), load=1e-12)


@pytest.mark.parametrize("given", [{"contact_radius": 1e-16}, {"load": 1e-60}])
def test_a_slope_below_its_error_is_said_to_be_too_small(given):
    """The load of this contact is negative by rounding, not out of the range of doubles."""
    steep = profiles.Sampled((0.0, 2.0), ((0.5 - 1e-16, 0.5),))
    with pytest.raises(SceneError, match="slope of the profile is too small there") as refused:
        solve(Scene(0.0, profile=steep, **given))
    assert refused.value.parameter in given


@pytest.mark.parametrize("given", ["load", "approach"])
def test_next_to_a_corner_on_a_smooth_surface_the_radius_is_as_exact_as_the_pressure(given):
    """The radius was found to a hundredth of the tolerance, which moved the corner in r/a."""
    cone = profiles.TruncatedCone(flat_radius=6.0, half_angle=0.2)
    truth = solve(Scene(0.3, profile=cone, contact_radius=8.25), 1e-12)
    scene = Scene(0.3, profile=cone, **{given: getattr(truth, given)})
    solution = solve(scene, 1e-4)
    assert abs(solution.contact_radius / 8.25 - 1.0) <= solution.error.contact_radius < 1e-14
    s = np.array([-0.1, -0.01, -1e-3, 1e-3, 0.01, 0.1]) + 6.0 / 8.25
    mean = truth.load / (math.pi * 8.25**2)
    size = np.maximum(truth.pressure(s), mean)
    assert np.all(np.abs(solution.pressure(s) - truth.pressure(s)) <= 1e-12 * size)
    # the stress next to the corner has the error of the radius
    stress, true = (one.inside.stress(s, 0.0) for one in (solution, truth))
    assert np.all(np.abs(stress.zz - true.zz) <= stress.error * true.norm)


@pytest.mark.parametrize("given", ["load", "approach"])
def test_next_to_the_equator_on_a_smooth_surface_the_error_of_the_radius_is_one_of_the_pressure(
    given,
):
    """It counted as much as in the load, which changes five to eight times less there."""
    ball = profiles.Sphere(1.0)
    truth = solve(Scene(0.3, profile=ball, contact_radius=1.0 - 1e-7), 1e-12, strict=False)
    solution = solve(Scene(0.3, profile=ball, **{given: getattr(truth, given)}), 5e-3)
    from_edge = np.array([1e-9, 1e-8, 1e-7, 1e-6])
    exact, estimate = (one.pressure(from_edge=from_edge) for one in (truth, solution))
    room = solution.error.pressure + truth.error.pressure
    assert np.all(np.abs(estimate - exact) <= room * np.maximum(exact, truth.load / math.pi))
