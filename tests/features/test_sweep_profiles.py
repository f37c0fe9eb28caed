"""Sweeps of contacts under profiles: the same numbers as `solve`."""

import numpy as np
import pytest

from spectral_contact import Scene, SceneError, profiles, solve
from spectral_contact.solving.solver import Continuation
from spectral_contact.sweeps import plot_slice, sweep
from spectral_contact.sweeps.sweep_parameters import grid

xarray = pytest.importorskip("xarray", reason="part of the extra: sweep")

LOADS = np.geomspace(1e-2, 1e2, 9)
BALL = Scene(0.3, 0.5, profile=profiles.Parabola(1.0), load=1.0)
NUMBERS = ("contact_radius", "approach", "stiffness", "indentation_work")


def test_a_curve_has_the_numbers_of_solve_within_the_estimates():
    found = sweep(BALL, load=LOADS, normal_compliance=[0.0, 0.5])
    assert found.sizes == {"normal_compliance": 2, "load": 9}
    assert (found.ending == "converged").all()
    assert "load_error" not in found  # it is what was asked for
    for load in LOADS[::4]:
        for alpha in (0.0, 0.5):
            alone = solve(BALL.replace(load=load, normal_compliance=alpha), 1e-12)
            here = found.sel(load=load, normal_compliance=alpha)
            for name in NUMBERS:
                true, error = getattr(alone, name), float(here[f"{name}_error"])
                assert 0.0 < error <= 1e-8
                assert abs(float(here[name]) / true - 1.0) <= error + 1e-12
            assert float(here.stiffness) > 0.0


@pytest.fixture
def solved(monkeypatch):
    """Return a list that grows with every scene that is solved."""
    done, original = [], Continuation.solve

    def counted(self, scene, *arguments):
        done.append(scene)
        return original(self, scene, *arguments)

    monkeypatch.setattr(Continuation, "solve", counted)
    return done


@pytest.mark.parametrize(
    ("profile", "alpha", "given"),
    [
        (profiles.Parabola(1.0), 0.5, "load"),
        (profiles.Parabola(1.0), 0.0, "approach"),
        (profiles.Sphere(1.0), 1e-3, "load"),
        (profiles.Cone(1.0), 0.5, "approach"),
        (profiles.RoundedFlat(0.5, 1.0), 0.5, "load"),
    ],
    ids=["parabola", "smooth", "sphere", "cone", "rounded flat"],
)
def test_a_long_curve_takes_few_radii(solved, profile, alpha, given):
    scene, values = Scene(0.3, alpha, profile=profile, load=1.0), np.geomspace(0.02, 2.0, 80)
    found = sweep(scene, **{given: values}, rtol=1e-9)
    assert len(solved) < 25
    assert (found.ending == "converged").all()
    assert (found.total_shear == 0.0).all()
    for i in range(0, 80, 11):
        own = Scene(0.3, alpha, profile=profile, **{given: float(values[i])})
        truth = solve(own, 1e-12, [*NUMBERS, "load"])
        for name in {*NUMBERS, "load"} - {given}:
            estimate = float(found[f"{name}_error"][i])
            assert 0.0 < estimate <= 1e-9
            error = abs(float(found[name][i]) / getattr(truth, name) - 1.0)
            assert error <= estimate + getattr(truth.error, name) + 1e-15


def test_curves_of_several_layers_are_each_their_own(solved):
    values, alphas = np.linspace(0.1, 2.0, 30)[::-1], [0.5, 0.1]
    found = sweep(BALL, load=values, normal_compliance=alphas, poisson_ratio=[0.1, 0.3])
    assert len(solved) < 60
    own = found.sel(normal_compliance=0.1, poisson_ratio=0.3).isel(load=7)
    truth = solve(BALL.replace(normal_compliance=0.1, load=float(values[7])), 1e-12)
    assert float(own.approach) == pytest.approx(truth.approach, rel=1e-8)


@pytest.mark.parametrize(
    "arguments",
    [
        {"quantities": ["load", "pressure"], "s": [0.0]},  # a field
        {"quantities": ["approach"], "rtol": 1e-4, "max_unknowns": 1},
    ],
    ids=["pressure", "refused"],
)
def test_what_a_curve_does_not_know_is_solved(solved, arguments):
    found = sweep(BALL, load=np.linspace(0.9, 1.0, 24), **arguments)
    assert len(solved) >= 24
    assert np.isfinite(found.approach if "approach" in found else found.pressure).all()


def test_a_curve_across_a_break_is_solved_scene_by_scene(solved):
    radii = np.linspace(0.0, 2.0, 3)
    table = profiles.Sampled.from_points(radii, radii**2)
    scene = Scene(0.3, profile=table, contact_radius=0.9)
    ends = [solve(scene.replace(contact_radius=a)).load for a in (0.9, 1.1)]
    found = sweep(scene, load=np.linspace(*ends, 24), quantities=["contact_radius"], rtol=1e-4)
    assert len(solved) >= 24
    assert (np.diff(found.contact_radius) > 0.0).all()


def test_the_order_of_the_scenes_does_not_matter():
    there = sweep(BALL, load=LOADS)
    back = sweep(BALL, load=LOADS[::-1])
    for name in NUMBERS:
        off = np.abs(there[name].values / back[name].values[::-1] - 1.0)
        assert (off <= there[f"{name}_error"].values + back[f"{name}_error"].values[::-1]).all()


@pytest.mark.parametrize("other", ["contact_radius", "approach"])
def test_what_varies_takes_the_place_of_what_the_scene_has(other):
    found = sweep(BALL, **{other: [0.5, 1.0]}, quantities=["load"])
    true = [solve(BALL.replace(**{"load": None, other: one})).load for one in (0.5, 1.0)]
    assert found["load"].dims == (other,)
    assert found["load"].values == pytest.approx(true, rel=1e-8)
    at_once = sweep(BALL, **{other: 0.5}, quantities=["load"])
    assert at_once["load"].dims == ()
    assert float(at_once[other]) == 0.5


def test_a_list_may_have_several_profiles():
    scenes = [BALL, Scene(0.3, 0.1, profile=profiles.Cone(1.0), contact_radius=0.5)]
    found = sweep(scenes, quantities=["load", "contact_radius", "pressure"], s=[0.0, 0.5])
    assert found.profile.values.tolist() == ["Parabola(radius=1.0)", "Cone(half_angle=1.0)"]
    assert found["load"].values[0] == 1.0
    assert found.contact_radius.values[1] == 0.5
    for scene, pressures in zip(scenes, found.pressure.values, strict=True):
        assert pressures == pytest.approx(solve(scene).pressure([0.0, 0.5]), rel=1e-7)
    assert found.pressure.attrs["units"] == "E'"


def test_one_solution_is_a_dataset(tmp_path):
    solution = solve(BALL)
    dataset = solution.to_xarray(s=[0.0, 0.9])
    assert dataset.attrs["title"] == "scenes of a punch on a rough elastic half-space"
    assert float(dataset["load"]) == 1.0
    for name in NUMBERS:
        assert float(dataset[name]) == getattr(solution, name)
    assert dataset.pressure.values.tolist() == solution.pressure([0.0, 0.9]).tolist()
    for name in (*dataset.coords, *dataset.data_vars):
        assert dataset[name].attrs["long_name"]
    dataset.to_netcdf(tmp_path / "a.nc")
    again = xarray.load_dataset(tmp_path / "a.nc")
    assert str(again.profile.values) == "Parabola(radius=1.0)"


def test_a_store_knows_the_profile(tmp_path):
    one = sweep(BALL, load=LOADS[:3], store=tmp_path / "store", chunk=2)
    again = sweep(BALL, load=LOADS[:3], store=tmp_path / "store", chunk=2)
    xarray.testing.assert_identical(one, again)
    other = BALL.replace(profile=profiles.Parabola(1.5))
    prints = [grid(scene, {"load": LOADS}).fingerprint() for scene in (BALL, other)]
    assert prints[0] != prints[1]


def test_a_slice_is_drawn():
    pytest.importorskip("matplotlib", reason="part of the extra: plot")
    axes = plot_slice(sweep(BALL, load=LOADS), "stiffness").axes[0]
    assert axes.get_xlabel() == "load P [E'L²]"
    assert axes.lines[0].get_xdata().tolist() == LOADS.tolist()


@pytest.mark.parametrize(
    ("scenes", "arguments", "message"),
    [
        (BALL, {"load": [1.0, 2.0], "approach": [1.0]}, "load .* left out if approach is given"),
        (BALL, {"load": [1.0, -2.0]}, "load = -2.0"),
        (BALL, {"contact_radius": [np.nan]}, "contact_radius = nan"),
        (Scene(0.3), {"load": [1.0, 2.0]}, "load = .* None without a profile"),
        ([BALL, Scene(0.3)], {}, r"scenes\[1\] = .* with a profile, as the first"),
        ([Scene(0.3), BALL], {}, r"scenes\[1\] = .* without one, as the first"),
        (Scene(0.3), {"quantities": ["stiffness"]}, "quantities"),
    ],
)
def test_bad_input_is_named(scenes, arguments, message):
    with pytest.raises(SceneError, match=message):
        sweep(scenes, **arguments)
