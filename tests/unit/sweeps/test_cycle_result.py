"""A steady loop as it is asked: fields, bounds, branches, SI units, text and files."""

import functools
import math
import pickle
from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest

from spectral_contact import (
    NotComputedError,
    Scene,
    SceneError,
    Solution,
    SolutionFileError,
    SteadyCycle,
    steady_cycle,
)

SCENE = Scene(0.1, 0.5, 0.5, 0.1)
STEEL = Scene.from_physical(
    youngs_modulus=210e9,
    poisson_ratio=0.3,
    radius=5e-3,
    load=5e3,
    normal_compliance=5e-15,
    tangential_compliance=6e-15,
    friction=0.15,
)


@functools.cache
def loop(lowest=0.1, scene=SCENE):
    return steady_cycle(scene, lowest, rtol=1e-2)


def test_the_traction_is_known_where_the_surface_slips():
    found = loop()
    s = np.array([0.3, 0.79, 0.8, 0.95, 1.0])
    limit = 0.1 * found.solution.pressure(s)
    highest, lowest = (found.traction(s, at) for at in ("highest", "lowest"))
    assert np.isnan(highest[:2]).all()
    assert np.isnan(lowest[:2]).all()
    assert highest[2:] == pytest.approx(limit[2:], rel=1e-14)
    assert lowest[2:] == pytest.approx(-0.1 * limit[2:], rel=1e-14)
    change = found.traction_change(s)
    assert (highest - lowest)[2:] == pytest.approx(change[2:], rel=1e-4)


def test_in_stick_the_traction_has_bounds():
    found = loop()
    s = np.array([0.3, 0.79, 0.8, 0.95])
    for at, load in (("highest", 1.0), ("lowest", 0.1)):
        low, high = found.traction_bounds(s, at)
        assert (low[:2] < high[:2]).all()
        limit = load * 0.1 * found.solution.pressure(s)
        assert (np.maximum(-low, high) <= limit * (1.0 + 1e-4)).all()
        assert low[2:] == pytest.approx(found.traction(s[2:], at), rel=1e-3)
        assert high[2:] == pytest.approx(found.traction(s[2:], at), rel=1e-3)


def test_bounds_are_those_of_friction_where_nothing_pulls_on_the_surface():
    found = loop(scene=SCENE.replace(poisson_ratio=0.5))
    limit = 0.1 * 0.1 * found.solution.pressure(0.5)
    for at in ("highest", "lowest"):
        assert found.traction_bounds(0.5, at) == pytest.approx((-limit, limit), rel=1e-12)
    found = loop(scene=SCENE.replace(poisson_ratio=0.5, friction=math.inf))
    assert found.traction_bounds(0.5) == (-math.inf, math.inf)


@pytest.mark.filterwarnings("error")
def test_at_an_edge_of_infinite_pressure_bounds_are_infinite():
    slips, sticks = (
        loop(0.5, Scene(0.1, 0.0, beta, 0.1)).traction_bounds([0.5, 1.0], "lowest")
        for beta in (0.0, 0.3)
    )
    assert np.isfinite(slips[0][0])
    assert slips[0][1] == slips[1][1] == -math.inf
    assert (sticks[0][1], sticks[1][1]) == (-math.inf, math.inf)


def test_errors_in_si_units_include_that_of_a_load_which_follows_from_the_approach():
    by_load = loop(0.2, STEEL)
    by_approach = loop(0.2, STEEL.replace(approach=by_load.physical._solution.approach))
    assert by_load.physical._load_error == 0.0
    assert by_approach.physical._load_error == by_approach.solution.error.approach > 0.0
    load = next(one for one in str(by_approach.physical).splitlines() if "largest load" in one)
    assert "exact" not in load


def test_the_error_of_a_small_slip_at_the_edge_is_relative_to_it():
    # next to the second threshold: it slips 55 times as far inside
    scene = Scene(0.3, 0.2, 0.5, 0.5927 * Scene(0.3).kappa)
    found = steady_cycle(scene.replace(friction=scene.friction * 0.9 / 1.1), 0.1, rtol=1e-2)
    inside = max(found.slip_amplitude(np.linspace(0.95, 1.0, 400)))
    edge = found.slip_amplitude(1.0)
    assert 0.0 < edge < 0.1 * inside
    told = found._edge_slip_error
    assert told == pytest.approx(found.error.slip_amplitude * inside / edge, rel=0.05)


def test_the_branches_close_the_loop():
    found = loop()
    down, up = found.unloading, found.reloading
    assert (down.load[0], down.load[-1]) == (1.0, 0.1) == (up.load[-1], up.load[0])
    assert (np.diff(down.load) < 0.0).all()
    assert (np.diff(up.load) > 0.0).all()
    assert down.shear[0] == 0.0
    assert up.shear[-1] == pytest.approx(0.0, abs=1e-15)
    assert down.shear[-1] == up.shear[0] == -0.9 * found.solution.total_shear


def test_where_forward_slip_goes_on_there_is_no_way_down():
    found = loop(0.005)
    for ask in (lambda: found.unloading, lambda: found.traction_bounds(0.5)):
        with pytest.raises(NotComputedError, match="forward"):
            ask()
    assert len(found.reloading.load) > 2
    assert found.slip_amplitude(1.0) > 0.0


def test_si_units():
    found = loop(0.2, STEEL)
    physical = found.physical
    assert (physical.load, physical.lowest_load) == (5e3, 1e3)
    assert physical.stick_radius == found.stick_radius * 5e-3
    unit = 4.0 * (1.0 - 0.3**2) * 5e3 / (5e-3 * 210e9)
    for name in ("dissipation", "unloading_dissipation", "reloading_dissipation"):
        value = getattr(found, name) * 5e3 * unit
        assert getattr(physical, name) == pytest.approx(value, rel=1e-14)
    assert physical.slip_amplitude(4.9e-3) == pytest.approx(found.slip_amplitude(0.98) * unit)
    assert physical.traction_change(1e-3) == pytest.approx(
        found.traction_change(0.2) * 5e3 / 5e-3**2
    )
    assert " J " in str(physical)
    assert str(physical) in found.summary()
    with pytest.raises(NotComputedError, match=r"Scene\.from_physical"):
        _ = loop().physical


def test_a_given_approach_has_a_load():
    given = STEEL.physical
    scene = Scene.from_physical(
        youngs_modulus=given.youngs_modulus,
        poisson_ratio=0.3,
        radius=given.radius,
        approach=loop(0.2, STEEL).solution.physical.approach,
        normal_compliance=given.normal_compliance,
        tangential_compliance=given.tangential_compliance,
        friction=0.15,
    )
    found = loop(0.2, scene).physical
    assert found.load == pytest.approx(5e3, rel=1e-3)
    assert found.dissipation == pytest.approx(loop(0.2, STEEL).physical.dissipation, rel=1e-2)


def test_it_is_printed_stored_and_pickled(tmp_path):
    found = loop()
    assert repr(found).startswith("<SteadyCycle lowest=0.1 stick_radius=0.796")
    assert str(found) == found.summary()
    assert "converged: yes" in found.summary()
    path = tmp_path / "loop.csv"
    found.to_csv(path, points=11)
    lines = [one for one in path.read_text().splitlines() if not one.startswith("#")]
    table = np.genfromtxt(lines, delimiter=",", names=True)
    assert table.dtype.names == ("s", "slip_amplitude", "traction_change")
    assert (table["slip_amplitude"] == found.slip_amplitude(table["s"])).all()
    with pytest.raises(SolutionFileError):
        found.to_csv(tmp_path / "nowhere" / "loop.csv")
    again = pickle.loads(pickle.dumps(found))
    assert again.dissipation == found.dissipation


def test_a_file_has_all_of_it(tmp_path):
    for found, suffix in ((loop(0.2, STEEL), "npz"), (loop(0.5), "json")):
        path = tmp_path / f"loop.{suffix}"
        found.save(path)
        again = SteadyCycle.load(path)
        for one in fields(found):
            assert getattr(again, one.name) == getattr(found, one.name)
        assert str(again) == str(found)


def test_a_file_of_something_else_is_refused(tmp_path):
    path = tmp_path / "loop.json"
    loop(0.5).save(path)
    with pytest.raises(SolutionFileError, match="not a solution"):
        Solution.load(path)
    path.write_text(path.read_text().replace('"lowest": 0.5', '"lowest": 0.6'))
    with pytest.raises(SolutionFileError, match="changed"):
        SteadyCycle.load(path)
    loop(0.5).solution.save(path)
    with pytest.raises(SolutionFileError, match="not a cycle"):
        SteadyCycle.load(path)
    with pytest.raises(SolutionFileError, match="suffix"):
        loop(0.5).save(tmp_path / "loop.txt")


def test_files_of_the_first_version_load():
    path = Path(__file__).parents[2] / "data" / "cycles" / "shaken_down.json"
    found = SteadyCycle.load(path)
    assert found.scene == SCENE
    assert (found.lowest, found.rtol, found.dissipation) == (0.5, 1e-2, 0.0)
    assert found.shakedown_ratio == float.fromhex("0x1.c717402cc4ab1p-3")
    assert found.slack == float.fromhex("0x1.6db900e72ed32p-1")
    assert found.traction_change(0.5) == float.fromhex("0x1.6078fda3e512fp-7")


def test_bad_places_are_refused():
    found = loop()
    with pytest.raises(SceneError, match="at"):
        found.traction(0.5, "middle")
    with pytest.raises(SceneError):
        found.slip_amplitude(1.5)
    with pytest.raises(SceneError):
        found.traction_bounds(0.5, from_edge=0.5)
    with pytest.raises(AttributeError, match="did you mean dissipation"):
        _ = found.disipation
    assert math.isnan(found.traction(0.0))
