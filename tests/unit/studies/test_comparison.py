"""How good some numbers are: `compare` against errors that are known."""

import math

import numpy as np
import pytest

import spectral_contact as sc
from spectral_contact import NotComputedError, Scene, SceneError, solve

SLIPPING = Scene(0.1, 0.5, 0.5, 0.1)
STEEL = Scene.from_physical(
    youngs_modulus=210e9,
    poisson_ratio=0.3,
    radius=5e-3,
    approach=1e-6,
    normal_compliance=5e-14,
    tangential_compliance=5e-14,
    friction=0.05,
)


@pytest.fixture(scope="module")
def true():
    return solve(SLIPPING, 1e-12)


def test_errors_are_those_that_were_put_in(true):
    bumped = {"s": [], "from_edge": []}

    def pressure(s):
        bumped["s"].append(s)
        return true.pressure(s) * np.where(np.abs(s - 0.3) < 1e-9, 1.02, 1.01)

    found = sc.compare(
        SLIPPING,
        approach=1.001 * true.approach,
        stick_radius=true.stick_radius,
        total_shear=0.99 * true.total_shear,
        pressure=pressure,
        traction=lambda *, from_edge: 0.995 * true.traction(from_edge=from_edge),
        slip=lambda s: true.slip(s) + 0.1 * true.slip(1.0),
        truth=true,
    )
    errors = {one.quantity: one.error for one in found.agreements}
    assert errors == pytest.approx(
        {
            **{"approach": 1e-3, "stick_radius": 0.0, "total_shear": 1e-2},
            **{"pressure": 0.02, "traction": 5e-3, "slip": 0.1},
        },
        abs=1e-12,
    )
    worst = found["pressure"]
    assert worst.from_edge == pytest.approx(0.7)
    assert worst.value == pytest.approx(1.02 * worst.truth)
    assert worst.truth == pytest.approx(true.pressure(0.3))
    assert worst.median == pytest.approx(0.01)
    assert found.error == found["slip"].error
    assert len(bumped["s"][0]) > 150


def test_an_error_below_that_of_the_truth_says_nothing(true):
    coarse = solve(SLIPPING, 1e-4)
    found = sc.compare(SLIPPING, pressure=true.pressure, approach=1.0, truth=coarse)
    assert not found["pressure"].told_apart
    assert 0.0 < found["pressure"].error <= found["pressure"].known_to == coarse.error.pressure
    assert found["approach"].told_apart


def test_the_default_truth_is_a_solve(true):
    found = sc.compare(SLIPPING, pressure=true.pressure, traction=true.traction, slip=true.slip)
    assert found.source == "solve, rtol = 1e-12"
    assert found.error < 1e-11


def test_arrays_come_with_their_radii(true):
    s = np.array([[0.0, 0.2], [0.9, 1.0]])
    found = sc.compare(SLIPPING, s=s, traction=1.001 * true.traction(s), truth=true)
    assert found["traction"].error == pytest.approx(1e-3)
    d = [0.5, 1e-9, 0.0]
    p = true.pressure(from_edge=d) * [1.0, 1.0, 1.1]
    found = sc.compare(SLIPPING, from_edge=d, pressure=p, truth=true)
    assert (found["pressure"].from_edge, found["pressure"].error) == (0.0, pytest.approx(0.1))


def test_si_scenes_take_si_numbers():
    true = solve(STEEL, 1e-11).physical
    r = np.linspace(0.0, 5e-3, 7)
    found = sc.compare(
        STEEL,
        s=r,
        pressure=true.pressure(r),
        traction=lambda r: 1.001 * true.traction(r),
        slip=true.slip(r),
        approach=1e-6,
        stick_radius=true.stick_radius,
        total_shear=true.total_shear,
    )
    assert found["traction"].error == pytest.approx(1e-3)
    assert max(one.error for one in found.agreements if one.quantity != "traction") < 1e-10
    assert found["pressure"].truth > 1e6
    by_distance = sc.compare(
        STEEL, pressure=lambda *, from_edge: true.pressure(from_edge=from_edge)
    )
    assert by_distance.error < 1e-10
    assert sc.compare(STEEL.replace(load=1.0), approach=1.0)["approach"].truth < 1e-6


def test_outside_the_contact_the_truth_is_zero(true):
    s = np.array([1.5, 0.2, 1.01, 0.9])  # in any order
    p, q, u = (np.array([0.0, *field([0.2]), 0.0, *field([0.9])]) for field in fields(true))
    found = sc.compare(SLIPPING, s=s, pressure=p, traction=q, slip=u, truth=true)
    assert found.error < 1e-12
    told = "2 of 4 radii outside the contact, the nearest at 1 - s = -0.01: pressure and traction "
    assert found.remarks == (told + "compared with 0, slip not compared",)
    assert str(found).endswith(found.remarks[0])
    assert found.remarks[0] in found._repr_html_()
    # what is not zero there is an error, relative to the mean
    p[0], q[2], u[0] = 0.1 / np.pi, -0.1, 7.0
    found = sc.compare(SLIPPING, s=s, pressure=p, traction=q, slip=u, truth=true)
    assert found["pressure"].error == pytest.approx(0.1, rel=0.01)
    assert (found["pressure"].truth, found["pressure"].from_edge) == (0.0, -0.5)
    rings = np.sqrt((np.arange(400) + 0.5) / 400)
    assert found["traction"].error == pytest.approx(0.1 / true.traction(rings).mean(), rel=0.01)
    assert found["slip"].error < 1e-12
    # distances below zero are the same, functions may be given, and all may be outside
    found = sc.compare(
        SLIPPING, from_edge=[-0.5, 0.5], pressure=lambda s: 0.0 * s + 1.0, truth=true
    )
    assert found["pressure"].value == 1.0
    assert sc.compare(SLIPPING, s=[2.0], pressure=[0.0], truth=true).error == 0.0


def fields(solution):
    """Return the three fields of a solution."""
    return solution.pressure, solution.traction, solution.slip


def test_the_rim_may_be_a_few_roundings_outside(true):
    s = [1.0 + 2.0**-52, 1.0 + 2.0**-50, 0.5]
    found = sc.compare(SLIPPING, s=s, pressure=true.pressure([1.0, 1.0, 0.5]), truth=true)
    assert found.error < 1e-12
    assert found.remarks == ("2 of 3 radii outside the contact by rounding: compared as the edge",)
    assert sc.compare(SLIPPING, s=[1.0, 0.5], pressure=[0.3, 0.3], truth=true).remarks == ()
    assert sc.compare(SLIPPING, approach=0.3, s=[1.5], truth=true).remarks == ()
    # nodes in SI units: 5 mm as the sum of sixty elements
    rim = np.cumsum(np.full(60, 5e-3 / 60))[-1]  # `sum` is compensated from Python 3.12 on
    assert rim > 5e-3
    steel = solve(STEEL, 1e-11)
    p = steel.physical.pressure(5e-3)
    for radius in (rim, np.nextafter(5e-3, 1.0)):
        assert sc.compare(STEEL, s=[radius], pressure=[p], truth=steel).error < 1e-9
    beyond = sc.compare(STEEL, s=[5e-3 * (1.0 + 1e-9)], pressure=[p], truth=steel)
    assert beyond.error > 0.1
    assert "the nearest at 1 - s = -1e-09" in beyond.remarks[0]


def test_a_truth_may_have_what_is_compared_alone():
    scene = Scene(0.3, 0.5, friction=None)
    pressure = solve(scene, 1e-11, ["pressure"])
    found = sc.compare(scene, pressure=pressure.pressure, truth=pressure)
    assert found.error == 0.0
    ball = Scene(0.3, profile=sc.profiles.Parabola(1.0), load=1.0, friction=None)
    pressure = solve(ball, 1e-11, ["pressure"])
    found = sc.compare(ball, s=[0.2, 1.5], pressure=[pressure.pressure(0.2), 0.0], truth=pressure)
    assert found.error == 0.0
    loaded = STEEL.replace(friction=None, load=10.0)
    pressure = solve(loaded, 1e-11, ["pressure"])
    p = pressure.pressure(0.5) * 10.0 / 5e-3**2
    assert sc.compare(loaded, s=[2.5e-3], pressure=[p], truth=pressure).error < 1e-14


def test_where_the_truth_is_infinite_nothing_is_compared():
    smooth = Scene(0.3)
    p = [solve(smooth).pressure(0.0), 1.0]
    assert sc.compare(smooth, s=[0.0, 1.0], pressure=p).error < 1e-15
    with pytest.raises(SceneError, match="finite"):
        sc.compare(smooth, s=[1.0], pressure=[1.0])


def test_with_coupling_errors_are_relative_to_pressure_and_traction_together():
    scene = Scene(0.0, 1e-6, 1e-6, math.inf, coupling=True)
    true, good = solve(scene, 1e-10), solve(scene, 1e-6)
    assert true.opening is not None
    found = sc.compare(scene, pressure=good.pressure, traction=good.traction, truth=true)
    # the estimates are in this sense; alone they are larger near where the sign changes
    assert found["pressure"].error <= good.error.pressure
    assert found["traction"].error <= good.error.traction


def test_what_is_no_number_is_as_wrong_as_can_be(true):
    found = sc.compare(SLIPPING, s=[0.1, 0.2], pressure=lambda s: np.nan * s, truth=true)
    assert found.error == math.inf
    assert sc.compare(SLIPPING, pressure=lambda s: 1e308, truth=true).error == math.inf
    with pytest.raises(SceneError, match="pressure = nan"):
        sc.compare(SLIPPING, s=[0.1, 0.2], pressure=[math.nan, 0.28], truth=true)


def test_it_is_a_table(true):
    found = sc.compare(SLIPPING, approach=0.3, pressure=[0.28], s=[0.0], truth=true)
    assert [line.split()[:2] for line in str(found).splitlines()] == [
        ["quantity", "error"],
        ["approach", "2.4e-02"],
        ["pressure", "3.3e-03"],
        ["truth:", "given"],
    ]
    assert "<table>" in found._repr_html_()
    with pytest.raises(KeyError):
        found["slip"]


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({}, "at least one"),
        ({"pressure": [0.3]}, r"pressure = .* its radii \(r=, s= or from_edge=\)"),
        ({"pressure": [0.3, 0.3], "s": [0.1, 0.2, 0.3]}, "pressure"),
        ({"pressure": [0.3], "s": [0.1], "from_edge": [0.9]}, "s, from_edge"),
        ({"pressure": [0.3], "s": [-0.1]}, "s = -0.1"),
        ({"pressure": [0.3], "s": [math.inf]}, "s = inf"),
        ({"pressure": [0.3], "from_edge": [1.1]}, "from_edge = 1.1"),
        ({"slip": [0.0], "s": [1.1]}, "inside the contact"),
        ({"pressure": [], "s": []}, "at least one radius"),
        ({"approach": "0.3"}, "approach"),
        ({"approach": 0.3, "truth": 7}, "truth"),
    ],
)
def test_bad_arguments_are_refused(given, message):
    with pytest.raises(SceneError, match=message):
        sc.compare(SLIPPING, **given)
    with pytest.raises(SceneError, match="scene"):
        sc.compare("a scene", approach=1.0)


def test_a_truth_of_another_scene_is_refused(true):
    with pytest.raises(SceneError, match="truth"):
        sc.compare(SLIPPING.replace(friction=0.05), approach=0.3, truth=true)
    with pytest.raises(SceneError, match="stick_radius"):
        sc.compare(Scene(0.1, 0.5), stick_radius=0.5)
    with pytest.raises(NotComputedError):
        sc.compare(SLIPPING, pressure=[0.3], s=[0.0], truth=solve(SLIPPING, 1e-3, ["approach"]))


def test_displacements_are_compared_inside_and_outside(true):
    """Against Boussinesq's closed form of a smooth punch, and with the layer's compression."""
    r = np.array([2.0, 0.3, 1.2, 1.0, 0.0])
    smooth = np.where(r <= 1.0, 1 / 8, np.arcsin(1.0 / np.maximum(r, 1.0)) / (4.0 * np.pi))
    found = sc.compare(Scene(0.3), r=r, displacement=smooth)
    assert found["displacement"].error < 1e-9
    assert found["displacement"].error <= found["displacement"].known_to
    assert "displacement compared as inside" in found.remarks[0]
    ball = Scene(0.3, profile=sc.profiles.Parabola(2.0), contact_radius=1.0)
    hertz = (2.0 - r[1::3] ** 2) / 4.0  # inside, where there is no layer to be named
    assert not sc.compare(ball, r=r[1::3], displacement=hertz).remarks
    scene = Scene(0.3, 0.5)
    solved = solve(scene, 1e-12)
    own = np.where(r <= 1.0, solved.approach, solved.inside.surface(r).z)
    remark = sc.compare(scene, r=r, displacement=own).remarks[-1]
    assert remark.startswith("displacement: these seem to be of the top of the rough layer")


def test_radii_of_a_profile_are_in_its_unit_of_length():
    scene = Scene(0.3, 0.1, profile=sc.profiles.Parabola(2.0), load=1.0)
    true = solve(scene, 1e-12)
    a = true.contact_radius
    r = np.array([0.0, 0.5, 0.99, 1.3]) * a
    inside = r <= a
    pressure = np.where(inside, true.pressure(np.minimum(r / a, 1.0)), 0.0)
    assert sc.compare(scene, r=r, pressure=pressure).error < 1e-11
    assert sc.compare(scene, s=r / a, pressure=pressure).error < 1e-11


@pytest.mark.parametrize(
    ("factor", "told"),
    [
        (1e6, "pressure: all values are too large by 1e+06: units?"),
        (1e-3, "pressure: all values are too small by 1000: units?"),
        (2 * math.pi, "pressure: all values are too large by 6.283: per radian, or of the whole?"),
        (-1.0, "pressure: the sign is the other one"),
        (-2.0, "pressure: all values are too large by 2 and of the other sign"),
        (1.05, None),
    ],
)
def test_a_common_factor_is_named(true, factor, told):
    s = np.linspace(0.0, 1.0, 7)
    found = sc.compare(SLIPPING, s=s, pressure=factor * true.pressure(s), truth=true)
    assert found.remarks == (() if told is None else (told,))


def test_values_without_a_common_factor_have_no_remark(true):
    s = np.linspace(0.0, 1.0, 7)
    wrong = true.pressure(s) * np.linspace(1.0, 3.0, 7)
    assert sc.compare(SLIPPING, s=s, pressure=wrong, approach=0.4, truth=true).remarks == ()


def test_what_cannot_be_compared_with_a_displacement_is_named(true):
    with pytest.raises(SceneError, match=r"r, s = .*one of them"):
        sc.compare(SLIPPING, r=[0.1], s=[0.1], pressure=[0.1])
    with pytest.raises(SceneError, match="an array with its radii"):
        sc.compare(SLIPPING, displacement=[0.1], truth=true)
    with pytest.raises(SceneError, match="a Solution, to compare displacements"):
        sc.compare(Scene(0.1), r=[0.1], displacement=[0.1], truth=sc.reference(Scene(0.1), 15))


def test_errors_of_the_slip_are_relative_to_its_largest_value_in_the_contact(true):
    place = true.stick_radius * (1.0 + 1e-5)
    largest = abs(true.slip(1.0))
    slip = true.slip([place]) + 1e-3 * largest
    found = sc.compare(true.scene, slip=slip, s=[place], truth=true)
    assert found["slip"].error == pytest.approx(1e-3, rel=0.1)


def test_radii_in_metres_next_to_the_edge_are_told_from_each_other():
    smooth = Scene.from_physical(
        youngs_modulus=210e9, poisson_ratio=0.3, radius=3e-3, approach=1e-6
    )
    r = 3e-3 * (1.0 - 1e-12)
    pressure = solve(smooth).physical.pressure(from_edge=3e-3 - r)
    assert sc.compare(smooth, pressure=[pressure], r=[r]).error < 1e-14


def test_numbers_next_to_zero_are_compared_as_any():
    found = sc.compare(Scene(0.1, 0.5), approach=5e-324)
    assert found.error == pytest.approx(1.0)


def test_a_traction_that_changes_sign_is_compared_relative_to_friction():
    """Below the largest load it vanishes at a radius inside, where no relative error means much."""
    scene = Scene(0.1, 0.5, 0.5, 0.05, unloaded_to=0.6)
    truth = solve(scene, 1e-9)
    s = np.linspace(0.8, 0.85, 2001)
    of_friction = 0.05 * truth.pressure(s)
    assert np.ptp(np.sign(truth.traction(s))) == 2.0
    found = sc.compare(scene, traction=truth.traction(s) + 1e-5 * of_friction, s=s, truth=truth)
    assert found.error == pytest.approx(1e-5, rel=1e-9)


def test_a_traction_that_keeps_its_sign_below_the_largest_load_is_compared_relative_to_itself():
    """Where nothing has slipped back friction may be far more than the traction."""
    scene = Scene(0.1, 0.5, 0.5, 100.0, unloaded_to=0.6)
    assert sc.compare(scene, traction=[0.0], s=[0.5]).error == pytest.approx(1.0)
    truth = solve(scene.replace(friction=0.05), 1e-4, ["pressure", "traction", "zones"])
    inner = truth.zones[0].outer / 2.0
    found = sc.compare(truth.scene, traction=[0.0], s=[inner], truth=truth)
    assert found.error == pytest.approx(1.0)


def test_what_a_flat_punch_does_not_have_is_called_by_its_name():
    with pytest.raises(NotComputedError, match="load not computed: the punch is flat"):
        sc.compare(STEEL, load=5.0)


def test_a_wrong_traction_is_seen_where_the_pressure_is_infinite():
    scene = Scene(0.3, 0.0, 0.5, 0.05, coupling=True)  # the smooth edge sticks
    assert sc.compare(scene, from_edge=[0.0], traction=[0.3]).agreements[0].error > 1.0


def test_the_unit_has_an_error_where_the_load_is_computed_from_the_approach():
    quantities = "approach", "pressure"
    loose, close = (solve(STEEL, rtol, quantities) for rtol in (1e-3, 1e-12))
    found = sc.compare(STEEL, pressure=close.physical.pressure, truth=loose)["pressure"]
    assert found.known_to == loose.error.pressure + loose.error.approach
    assert found.error <= found.known_to
