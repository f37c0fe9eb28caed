"""The modulus from stiffness and area, with and without a layer, and its deviations."""

import math

import numpy as np
import pytest

from spectral_contact import Scene, SceneError, profiles, solve
from spectral_contact.calibration import AreaFunction, contact_depth, oliver_pharr


@pytest.mark.parametrize("profile", [profiles.Cone(1.2), profiles.Parabola(1e-5)])
def test_the_modulus_comes_back_through_a_layer(profile):
    """Of solved contacts: the stiffness theorem holds for any profile."""
    known = {"reduced_modulus": 72e9, "profile": profile, "load": 5e-3}
    solved = [solve(Scene.from_physical(**known, normal_compliance=c)) for c in (3e-19, 2e-17)]
    for one, compliance in zip(solved, (3e-19, 2e-17), strict=True):
        here = one.physical
        found = oliver_pharr(
            here.stiffness, math.pi * here.contact_radius**2, normal_compliance=compliance
        )
        assert found.reduced_modulus[0] == pytest.approx(72e9, rel=1e-8)
        assert abs(found.reduced_modulus[0] - 72e9) < found.error[0] + 1e-8 * 72e9
        assert found.without_layer[0] < 71e9


def test_without_a_layer_it_is_the_formula():
    found = oliver_pharr([1e5, 2e5], 1e-12, shape_factor=1.05, stiffness_sigma=1e3)
    modulus = np.sqrt(np.pi) / 2.0 / 1.05 * np.array([1e5, 2e5]) / 1e-6
    assert found.reduced_modulus == pytest.approx(modulus, rel=1e-14)
    assert found.reduced_modulus == found.without_layer
    assert found.error == pytest.approx(modulus * [0.01, 0.005])
    assert "E* [Pa]" in str(found)


def test_deviations_are_those_of_moved_input():
    """Half the difference of results a deviation up and down."""
    at = {"stiffness": 2e5, "area": 1e-12}
    for name in at:
        given = {f"{name}_sigma": 1e-3 * at[name]}
        found = oliver_pharr(*at.values(), normal_compliance=1e-18, **given)
        ends = []
        for factor in (1.001, 0.999):
            moved = {**at, name: factor * at[name]}
            ends += oliver_pharr(*moved.values(), normal_compliance=1e-18).reduced_modulus
        assert found.error[0] == pytest.approx(abs(ends[0] - ends[1]) / 2.0, rel=1e-4)


def test_area_functions():
    polynomial = AreaFunction([24.5, 1e-7, 1e-10])
    h = np.array([1e-7, 4e-7])
    assert polynomial.area(h) == pytest.approx(24.5 * h**2 + 1e-7 * h + 1e-10 * h**0.5)
    table = AreaFunction(table=([0.0, 2e-7, 5e-7], 24.5 * np.array([0.0, 2e-7, 5e-7]) ** 2))
    assert table.area(h) == pytest.approx(24.5 * h**2, rel=1e-12)
    depth = contact_depth("120 nm", "1 mN", "0.1 mN/nm")
    assert depth[0] == pytest.approx(112.5e-9)
    found = oliver_pharr([1e5], AreaFunction([24.5]), depth=depth)
    expected = oliver_pharr([1e5], 24.5 * depth**2)
    assert found.reduced_modulus == pytest.approx(expected.reduced_modulus)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: oliver_pharr([-1.0], 1.0), r"stiffness = -1\.0"),
        (lambda: oliver_pharr([1.0, 2.0], [1.0, 2.0, 3.0]), "area"),
        (lambda: oliver_pharr(1.0, AreaFunction([1.0])), "depth = None"),
        (lambda: oliver_pharr(1.0, 1.0, depth=1.0), "None where areas are given"),
        (lambda: oliver_pharr(2e5, 1e-12, normal_compliance=1e-16), "below 5e-18 m/Pa"),
        (lambda: oliver_pharr(1.0, 1.0, area_sigma=-1.0), "area_sigma"),
        (lambda: AreaFunction(), "coefficients, table"),
        (lambda: AreaFunction(table=([1.0, 0.5], [1.0, 2.0])), "that rise"),
        (lambda: AreaFunction(table=([1.0, 2.0], [1.0, 2.0])).area(3.0), r"in \[1, 2\] m"),
        (lambda: AreaFunction([-1.0]).area(1.0), "polynomial of the area is > 0"),
        (lambda: contact_depth(1.0, 1.0, 0.0), r"stiffness = 0\.0"),
    ],
)
def test_bad_input_is_named(call, message):
    with pytest.raises(SceneError, match=message):
        call()


@pytest.mark.parametrize("rest", [1e-2, 1e-5, 1e-8])
def test_behind_a_layer_that_is_most_of_what_gives_way_the_error_grows(rest):
    """With x the compliance of the layer S is 1 - 4/(3 pi x) + ... times that of the layer."""
    area, compliance = 1e-12, 1e-18
    found = oliver_pharr([area / compliance * (1.0 - rest)], [area], normal_compliance=compliance)
    radius = math.sqrt(area / math.pi)
    x = compliance * found.reduced_modulus[0] / (4.0 * radius)
    error = found.error[0] / found.reduced_modulus[0]
    assert error >= 1e-15 / rest
    assert x * rest == pytest.approx(4.0 / (3.0 * math.pi), rel=error + 2.0 * rest)


@pytest.mark.parametrize("rest", [1e-12, 1e-14])
def test_a_layer_that_is_all_that_gives_way_is_refused(rest):
    """Differences of rounded numbers were 0, and a division by it failed."""
    with pytest.raises(SceneError, match=r"normal_compliance = 1e-18: must be below 1e-18 m/Pa"):
        oliver_pharr([1e6 * (1.0 - rest)], [1e-12], normal_compliance=1e-18)


def test_a_layer_at_the_least_compliance_of_a_scene_changes_nothing():
    found = oliver_pharr([2.0], [math.pi], normal_compliance=4.00001e-14)
    assert found.reduced_modulus[0] == pytest.approx(1.0, rel=1e-11)
