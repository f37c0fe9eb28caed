"""Scenes below their largest load in everything that takes scenes: files, sweeps, SI, commands."""

import math
from dataclasses import replace

import numpy as np
import pytest

import spectral_contact as sc
from spectral_contact import NotComputedError, Scene, SceneError, Solution, profiles, solve
from spectral_contact.__main__ import main
from spectral_contact.fields.series import Radius
from spectral_contact.layers import Exponential
from spectral_contact.records import Zone
from spectral_contact.scene import same_problem
from spectral_contact.sweeps import sweep
from spectral_contact.sweeps.lines import lines
from spectral_contact.sweeps.request import requested
from spectral_contact.sweeps.shortcuts import eligible
from spectral_contact.sweeps.sweep_parameters import grid
from spectral_contact.testing import check_solution

SCENE = Scene(0.1, 0.5, 0.5, 0.1, unloaded_to=0.8)
ASKED = "total_shear", "zones", "slip", "traction", "approach", "pressure"


@pytest.fixture(scope="module")
def solution():
    return solve(SCENE, 1e-8, ASKED)


@pytest.mark.parametrize("value", [0.0, -0.1, 1.1, math.nan, "half", True])
def test_a_load_ratio_is_in_its_range(value):
    with pytest.raises(SceneError, match="unloaded_to"):
        SCENE.replace(unloaded_to=value)


@pytest.mark.parametrize(
    ("changes", "parameter"),
    [
        ({"coupling": True}, "coupling"),
        ({"tangential_compliance": 0.0}, "tangential_compliance"),
        ({"profile": profiles.Parabola(1.0), "load": 1.0}, "unloaded_to"),
        ({"profile": profiles.Flat(1.0), "load": 1.0, "friction": math.inf}, "unloaded_to"),
    ],
)
def test_what_is_not_unloaded_is_refused(changes, parameter):
    with pytest.raises(SceneError) as refused:
        SCENE.replace(**changes)
    assert refused.value.parameter == parameter
    assert "unloaded_to" in str(refused.value)
    assert Exponential  # a nonlinear layer takes a profile


def test_the_largest_load_is_the_default():
    loaded = Scene(0.1, 0.5, 0.5, 0.1)
    assert SCENE.replace(unloaded_to=1.0) == loaded
    assert repr(loaded) == repr(SCENE).replace(", unloaded_to=0.8", "")
    assert "unloaded_to" not in loaded.to_dict()
    assert Scene.from_json(SCENE.to_json()) == SCENE
    assert not same_problem(SCENE, loaded)
    frictionless = Scene(0.1, 0.5)
    assert not same_problem(frictionless, frictionless.replace(unloaded_to=0.5))


@pytest.mark.parametrize("name", ["solution.npz", "solution.json"])
def test_files_know_the_zones(solution, tmp_path, name):
    solution.save(tmp_path / name)
    found = Solution.load(tmp_path / name)
    assert found == solution
    assert [(zone.sense, zone.memory) for zone in found.zones] == [
        (1, False),
        (1, False),
        (1, True),
    ]


def test_reports_tell_of_memory(solution):
    text = solution.summary()
    assert "unloaded to 0.8" in text
    assert "stick, memory" in text
    assert "unloading" in str(solution.plan)
    assert "load over the largest load" in SCENE._repr_html_()


def test_a_sweep_over_the_load(solution):
    found = sweep(SCENE, unloaded_to=[1.0, 0.8], quantities=["total_shear", "approach"])
    assert found.ending.values.tolist() == ["converged", "converged"]
    loaded = solve(SCENE.replace(unloaded_to=1.0), 1e-8, ["total_shear"])
    np.testing.assert_allclose(
        found.total_shear.values[:2], [loaded.total_shear, solution.total_shear], rtol=1e-8
    )
    assert found.approach.values[1] == pytest.approx(0.8 * found.approach.values[0], rel=1e-14)


def test_datasets_say_which_zones_have_memory_and_which_slip_back(solution):
    assert solution.to_xarray().zone_kind.values.tolist() == [1, 2, 3]
    *inner, last = solution.zones
    edge = replace(last, kind="slip", memory=False, sense=-1)
    turned = replace(solution, values={**solution.values, "zones": (*inner, edge)})
    assert turned.to_xarray().zone_kind.values.tolist() == [1, 2, 4]


def test_sweeps_of_unloaded_scenes_take_no_shortcut():
    several = np.linspace(0.05, 0.09, 30)
    columns = grid(SCENE, {"friction": several}).columns(np.arange(30))
    request = requested(["total_shear"], 1e-5, 1000, None, None, unloaded=True)
    assert not columns.at_largest_load.any()
    assert not list(lines(columns, np.arange(30), request))
    assert not eligible(columns, request).any()
    stick = sweep(SCENE, friction=[math.inf], quantities=["total_shear", "approach"])
    assert stick.total_shear.values[0] == pytest.approx(0.8 * 0.464971875312765 * SCENE.kappa)


def test_a_sweep_from_the_largest_load_on_takes_thresholds_of_the_load():
    """At the largest load there are none, but the other quantities are there."""
    names = ["reverse_ratio", "total_shear"]
    found = sweep(SCENE.replace(friction=math.inf), unloaded_to=[1.0, 0.8], quantities=names)
    assert found.ending.values.tolist() == ["converged", "converged"]
    full, unloaded = found.total_shear.values
    assert unloaded == pytest.approx(0.8 * full, rel=1e-14)
    assert np.isnan(found.reverse_ratio.values).all()


def test_datasets_of_loaded_scenes_stay_as_they_were():
    found = sweep(Scene(0.1, 0.5, 0.5, 0.1), friction=[0.1], quantities=["approach"])
    assert "unloaded_to" not in found.coords
    assert "unloaded_to" in solve(SCENE, 1e-6, ["approach"]).to_xarray().coords


def test_si_values_are_those_of_the_state():
    steel = {"youngs_modulus": 2e11, "poisson_ratio": 0.1, "radius": 0.01, "friction": 0.1}
    layer = {"normal_compliance": 2.5e-14, "tangential_compliance": 2.5e-14}
    by_load = Scene.from_physical(**steel, **layer, load=1000.0, unloaded_to=0.8)
    found = solve(by_load, 1e-8, ASKED).physical
    assert found.load == 800.0
    largest = found.approach / 0.8
    by_approach = by_load.replace(approach=largest)
    again = solve(by_approach, 1e-8, ASKED).physical
    assert again.load == pytest.approx(800.0, rel=1e-13)
    assert again.approach == pytest.approx(found.approach, rel=1e-15)
    assert again.total_shear == pytest.approx(found.total_shear, rel=1e-13)
    assert again.zones[2].memory
    table = sweep(by_approach, unloaded_to=[1.0, 0.8], quantities=["total_shear", "approach"])
    np.testing.assert_allclose(table.load_si.values, [1000.0, 800.0], rtol=1e-13)
    assert float(table.approach_si) == pytest.approx(largest, rel=1e-15)  # as it is given
    assert table.total_shear_si.values[1] == pytest.approx(found.total_shear, rel=1e-8)


def test_two_bodies_of_negative_kappa_are_the_mirror(solution):
    mirror = Scene.from_kappa(-SCENE.kappa, 0.5, 0.5, 0.1, unloaded_to=0.8)
    found = solve(mirror, 1e-8, ASKED)
    assert found.total_shear == pytest.approx(-solution.total_shear, rel=1e-14)
    assert found.slip(0.9) == pytest.approx(-solution.slip(0.9), rel=1e-12)
    assert [zone.sense for zone in found.zones] == [1, 1, 1]


def test_bounds_of_the_approach_are_those_of_the_load(solution):
    low, high = solution.approach_bounds
    assert low <= solution.approach * (1.0 + 1e-14)
    assert high >= solution.approach * (1.0 - 1e-14)
    assert high / low - 1.0 < 1e-6


def test_stress_inside_is_finite(solution):
    assert math.isfinite(solution.inside.stress(0.5, 0.3).von_mises)
    with pytest.raises(NotComputedError, match="largest load"):
        solution.inside.energies()


@pytest.mark.parametrize(
    "use",
    [
        lambda one: check_solution(one, one.scene, 1e-6),
        lambda one: sc.explore(one.scene),
        lambda one: sc.reference(one.scene, 15),
        lambda one: sc.steady_cycle(one.scene, 0.1),
    ],
    ids=["check_solution", "explore", "reference", "steady_cycle"],
)
def test_what_takes_the_largest_load_alone_says_so(solution, use):
    with pytest.raises(SceneError, match="largest load"):
        use(solution)


def test_quantities_of_unloading_are_not_those_of_other_scenes():
    loaded = solve(Scene(0.1, 0.5, 0.5, 0.1), 1e-6, ["total_shear"])
    with pytest.raises(NotComputedError, match="unloaded_to is 1"):
        _ = loaded.turning_ratio
    with pytest.raises(SceneError, match="turning_ratio"):
        solve(Scene(0.1, 0.5, 0.5, 0.1), 1e-6, ["turning_ratio"])


def test_the_command_line_unloads(capsys):
    options = ["--rtol", "1e-6", "--quantities", "total_shear,zones"]
    assert main(["solve", "--unload-to", "0.8", *options]) == 0
    assert "stick, memory" in capsys.readouterr().out
    assert main(["solve", "--unload-to", "1.5"]) == 2
    assert "--unload-to = 1.5: must be in (0, 1]" in capsys.readouterr().err
    assert main(["sweep", "--unload-to", "0.8,1", "--quantities", "approach"]) == 0
    assert "2 converged" in capsys.readouterr().out


def test_a_sense_of_slip_is_a_number():
    with pytest.raises(SceneError, match="sense = True: must be 1 or -1"):
        Zone.from_radii("slip", Radius(0.5, 0.5), Radius(1.0, 0.0), sense=True)
