"""Sweeps in SI units: grids, lists and tables have the numbers of `Solution.physical`."""

from pathlib import Path

import numpy as np
import pytest

from spectral_contact import Scene, SceneError, SolutionFileError, profiles, solve
from spectral_contact.sweeps import sweep

pytest.importorskip("xarray", reason="part of the extra: sweep")

TABLE = Path(__file__).parents[2] / "data" / "tables" / "scenes_german.csv"
TIP = Scene.from_physical(
    youngs_modulus=70e9,
    poisson_ratio=0.2,
    normal_compliance=2e-18,
    profile=profiles.Parabola(1e-5),
    load=5e-3,
)
CONE = TIP.replace(profile=profiles.Cone(1.0))
MANY = np.ones(2000)
PUNCH = Scene.from_physical(
    youngs_modulus=210e9,
    poisson_ratio=0.3,
    radius=5e-3,
    approach=1e-6,
    normal_compliance=5e-14,
    tangential_compliance=5e-14,
    friction=0.05,
)


def test_a_grid_under_a_profile():
    found = sweep(TIP, load=["1 mN", "5 mN"], youngs_modulus=[70e9, 140e9])
    assert found.approach.dims == ("load_si", "youngs_modulus")
    assert found.load_si.values.tolist() == [1e-3, 5e-3]
    assert found.load_si.attrs["units"] == "N"
    for load in (1e-3, 5e-3):
        for modulus in (70e9, 140e9):
            true = solve(TIP.replace(load=load, youngs_modulus=modulus), 1e-11).physical
            here = found.sel(load_si=load, youngs_modulus=modulus)
            for name in ("approach", "contact_radius", "stiffness", "indentation_work"):
                value, error = (float(here[f"{name}_si{end}"]) for end in ("", "_error"))
                off = abs(value / getattr(true, name) - 1.0)
                assert off <= error + 1e-11
                assert error < 1e-8
    assert float(found.normal_compliance_si) == 2e-18
    assert "load_si_error" not in found


def test_a_flat_punch_of_a_given_approach_has_its_load():
    found = sweep(
        PUNCH,
        approach=[1e-6, 2e-6],
        radius=[5e-3, 3e-3],
        quantities=["stick_radius", "total_shear", "pressure"],
        s=[0.0, 0.5],
    )
    assert found.pressure_si.dims == ("approach_si", "radius", "s")
    true = solve(PUNCH.replace(approach=2e-6, radius=3e-3), 1e-10).physical
    here = found.sel(approach_si=2e-6, radius=3e-3)
    assert float(here.load_si) == pytest.approx(true.load, rel=1e-8)
    assert float(here.stick_radius_si) == pytest.approx(true.stick_radius, rel=1e-8)
    assert float(here.total_shear_si) == pytest.approx(true.total_shear, rel=1e-8)
    assert float(here.pressure_si[1]) == pytest.approx(true.pressure(1.5e-3), rel=1e-8)
    assert float(here.total_shear_si_error) > float(here.total_shear_error)


def test_scenes_that_differ_in_units_alone_are_solved_once(monkeypatch):
    from spectral_contact.solving.solver import Continuation

    solved = []
    original = Continuation.solve

    def counted(self, scene, *more):
        solved.append(scene)
        return original(self, scene, *more)

    monkeypatch.setattr(Continuation, "solve", counted)
    base = PUNCH.replace(friction=None, load=1.0)
    found = sweep(base, load=[1.0, 2.0, 3.0], radius=[5e-3, 4e-3], quantities=["approach"])
    assert len(solved) == 2
    assert found.approach_si.values[2] == pytest.approx(3.0 * found.approach_si.values[0])


def test_a_single_number_makes_no_dimension():
    found = sweep(TIP, load="2 mN", radius=None, friction=[0.0, 0.1], quantities=["load"])
    assert found.ending.dims == ("friction",)
    assert float(found.load_si) == 2e-3


@pytest.mark.parametrize("kind", ["file", "DataFrame", "mapping"])
def test_a_table_has_a_scene_for_each_row(kind):
    base = Scene.from_physical(youngs_modulus=1e9, poisson_ratio=0.2, radius=1e-5, load=1.0)
    table = TABLE
    if kind == "DataFrame":
        pandas = pytest.importorskip("pandas")
        table = pandas.DataFrame(
            {"load [mN]": [1.5, 2.5, 2.5], "a [um]": [10, 10, 12.5], "E [GPa]": [70, 70, 72.5]}
        )
    elif kind == "mapping":
        table = {
            "load": ["1.5 mN", "2.5 mN", "2.5 mN"],
            "radius": [1e-5, 1e-5, 12.5e-6],
            "youngs_modulus": [70e9, 70e9, 72.5e9],
        }
    found = sweep(base, table=table, quantities=["approach"])
    assert found.radius.dims == ("scene",)
    load, radius, modulus = (
        np.array(one)
        for one in ([1.5e-3, 2.5e-3, 2.5e-3], [1e-5, 1e-5, 12.5e-6], [70e9, 70e9, 72.5e9])
    )
    smooth = load * (1 - 0.2**2) / (2 * radius * modulus)  # Boussinesq
    assert found.approach_si.values == pytest.approx(smooth, rel=1e-9)
    assert ("table" in found.attrs) == (kind != "mapping")


def test_a_dimensionless_table(tmp_path):
    path = tmp_path / "scenes.txt"
    path.write_text("# alpha beta\n0 0.5\n0.5 0.5\n")
    found = sweep(Scene(0.3), table=path, quantities=["approach"])
    assert found.approach.values[0] == pytest.approx(1 / 8, rel=1e-12)
    assert found.approach.values[1] == pytest.approx(solve(Scene(0.3, 0.5)).approach, rel=1e-8)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (
            lambda: sweep(Scene(0.3), youngs_modulus=[1e9]),
            r"modulus = .* Scene\.from_physical",
        ),
        (lambda: sweep(TIP, load=[1.0, -1.0]), r"load = -1\.0"),
        (lambda: sweep(TIP, load=[1.0], approach=[1e-9]), "vary one of load"),
        (lambda: sweep(TIP, load=["1 mm"]), "load = "),
        (lambda: sweep(TIP, kappa=[0.1]), "kappa"),
        (lambda: sweep(CONE, radius=[1.0, 2.0]), r"radius = 1\.0: .* unlike .*Sphere"),
        (lambda: sweep(TIP, radius=[1.0, -2.0]), r"radius = -2\.0"),
        (lambda: sweep(Scene(0.3, profile=TIP.profile, load=1.0), radius=[1.0]), "radius"),
        (lambda: sweep([TIP, TIP], load=[1.0, 2.0]), "one number, or None, with a list"),
        (lambda: sweep([TIP, TIP], kappa=0.1), "kappa"),
        (lambda: sweep([]), "at least one Scene"),
        (lambda: sweep(TIP, table={"load": [1.0, -1.0]}), r"> 0 \(row 2 of the table\)"),
        (lambda: sweep([TIP], table={"load": [1.0]}), "table"),
        (lambda: sweep(TIP, table={"load": [1.0], "friction": [0.1, 0.2]}), "all of one length"),
        (lambda: sweep(TIP, table={"lode": [1.0]}), "did you mean load"),
        (lambda: sweep(TIP, table=3), "table = 3"),
        (lambda: sweep(TIP, table={"load": [1.0]}, friction=[0.1, 0.2]), "one number, or None"),
        (lambda: sweep(TIP, load=MANY, normal_compliance=MANY), "at most 1000000"),
    ],
)
def test_bad_input_is_named(call, message):
    with pytest.raises(SceneError, match=message):
        call()


def test_a_table_without_a_parameter_is_refused(tmp_path):
    path = tmp_path / "scenes.csv"
    path.write_text("id,note\n1,2\n")
    with pytest.raises(SolutionFileError, match="no column of"):
        sweep(TIP, table=path)


def hertz(load, modulus, radius, nu=0.2):
    """Return the approach under a parabola on a smooth half-space."""
    return (3 * load * (1 - nu**2) / (4 * modulus * np.sqrt(radius))) ** (2 / 3)


def test_the_radius_of_a_profile_is_an_axis_of_a_grid():
    smooth = TIP.replace(normal_compliance=0.0)
    found = sweep(smooth, load=["1 mN", "5 mN"], radius=["10 um", "20 um", "0.1 mm"])
    assert found.approach_si.dims == ("load_si", "radius")
    assert found.radius.values == pytest.approx([1e-5, 2e-5, 1e-4], rel=1e-15)
    assert found.radius.attrs["units"] == "m"
    truth = hertz(found.load_si, 70e9, found.radius)
    assert found.approach_si.values == pytest.approx(truth.values, rel=1e-9)
    assert float(found.youngs_modulus) == 70e9
    # one number makes no dimension, and replaces the radius that the scene has
    alone = sweep(smooth, load=["1 mN", "5 mN"], radius="0.1 mm", quantities=["approach"])
    assert alone.approach_si.dims == ("load_si",)
    assert float(alone.radius) == pytest.approx(1e-4, rel=1e-15)
    assert alone.approach_si.values == pytest.approx(found.approach_si.values[:, 2], rel=1e-9)


def test_the_radius_of_a_profile_is_a_column_of_a_table(tmp_path):
    path = tmp_path / "beads.csv"
    path.write_text("bead;load [mN];radius [um]\n1;1,5;10\n2;2,5;12,5\n", encoding="utf-16")
    found = sweep(TIP.replace(normal_compliance=0.0), table=path, quantities=["approach"])
    assert found.radius.dims == ("scene",)
    truth = hertz(np.array([1.5e-3, 2.5e-3]), 70e9, np.array([10e-6, 12.5e-6]))
    assert found.approach_si.values == pytest.approx(truth, rel=1e-9)


def test_a_list_of_scenes_in_si_units_has_results_in_si_units():
    ball = TIP.replace(normal_compliance=0.0)
    several = (ball.replace(load=load, youngs_modulus=7e9) for load in (1e-3, 2e-3))
    found = sweep(several, quantities=["approach"])
    assert found.approach_si.dims == ("scene",)
    truth = hertz(np.array([1e-3, 2e-3]), 7e9, 1e-5)
    assert found.approach_si.values == pytest.approx(truth, rel=1e-9)
    assert found.load_si.values.tolist() == [1e-3, 2e-3]
    assert found.youngs_modulus.shape == ()
    assert float(found.radius) == 1e-5
    # one number replaces that of all of them
    at_one = sweep([ball, ball.replace(load=2e-3)], radius="20 um", quantities=["approach"])
    assert at_one.approach_si.values[1] == pytest.approx(hertz(2e-3, 70e9, 2e-5), rel=1e-9)


def test_a_list_may_give_loads_and_approaches():
    ball = TIP.replace(normal_compliance=0.0)
    found = sweep([ball, ball.replace(approach=2e-8)], quantities=["load", "approach"])
    assert found.load_si.values[0] == ball.physical.load
    assert found.approach_si.values[1] == 2e-8
    assert hertz(found.load_si.values, 70e9, 1e-5) == pytest.approx(found.approach_si.values)


def test_a_stick_radius_in_metres_has_the_error_of_the_contact_radius():
    tip = TIP.replace(friction=0.1, normal_compliance=1e-15, tangential_compliance=1e-15)
    found = sweep(tip, load=[2e-3, 5e-3], quantities=["stick_radius"], rtol=1e-3)
    true = solve(tip, 1e-8, ["stick_radius", "contact_radius"]).physical.stick_radius
    last = found.isel(load_si=1)
    off = abs(float(last.stick_radius_si) / true - 1.0)
    assert float(last.stick_radius_error) < off <= float(last.stick_radius_si_error)


def test_flat_punches_of_a_list_may_be_given_by_load_and_by_approach():
    loaded = PUNCH.replace(load=100.0)
    found = sweep([loaded, PUNCH], quantities=["total_shear"], rtol=1e-6)
    true = solve(PUNCH, 1e-8).physical
    assert float(found.load_si[0]) == 100.0
    assert float(found.load_si[1]) == pytest.approx(true.load, rel=1e-6)
    assert float(found.total_shear_si[1]) == pytest.approx(true.total_shear, rel=1e-6)
