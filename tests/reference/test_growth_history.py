"""The history of a growing contact: Hertz at every radius, contacts of their own, tables."""

import functools
import math

import numpy as np
import pytest

from spectral_contact import (
    NotComputedError,
    SceneError,
    Solution,
    SolutionFileError,
    plotting,
    profiles,
    solve,
)
from spectral_contact import Scene as FullScene
from spectral_contact.__main__ import main

PARABOLA = profiles.Parabola(1.0)
NAMES = ("load", "approach", "total_shear", "stick_radius")
Scene = functools.partial(FullScene, 0.3, profile=PARABOLA, contact_radius=1.0)


@functools.cache
def hertzian():
    return solve(Scene(friction=0.2), 1e-4)


def test_on_a_smooth_surface_it_is_hertz_at_every_radius():
    solution, history = hertzian(), hertzian().history
    b = history.radii
    assert b[-1] == 1.0
    assert (np.diff(b) > 0.0).all()
    assert history.load() == pytest.approx(16.0 / 3.0 * b**3, rel=1e-11)
    assert history.approach() == pytest.approx(b**2, rel=1e-11)
    assert history.stick_radius() == pytest.approx(solution.stick_radius, rel=1e-12)
    assert history.total_shear() / history.load() == pytest.approx(
        solution.total_shear / solution.load, rel=1e-11
    )
    assert history.load(0.5) == pytest.approx(2.0 / 3.0, rel=1e-12)
    assert history.load([[0.5], [1.0]]).shape == (2, 1)
    assert isinstance(history.error("load", 0.5), float)
    for name in NAMES:
        assert history.error(name)[-1] < 2e-9
    assert (np.abs(history.load() / (16.0 / 3.0 * b**3) - 1.0) <= history.error("load")).all()


@pytest.mark.parametrize(
    ("profile", "friction", "coupling"),
    [(PARABOLA, 0.1, False), (profiles.Cone(1.0), math.inf, True)],
)
def test_what_it_was_is_what_a_smaller_contact_is(profile, friction, coupling):
    scene = Scene(0.2, 0.1, friction, coupling=coupling).replace(profile=profile)
    history = solve(scene, 1e-8, NAMES).history
    for b in (0.03, 0.6):
        smaller = solve(scene.replace(contact_radius=b), 1e-6, NAMES)
        for name in NAMES:
            truth, found = getattr(smaller, name), getattr(history, name)(b)
            assert found == pytest.approx(truth, rel=1e-7), name
            known = history.error(name, b) + getattr(smaller.error, name)
            assert abs(found / truth - 1.0) <= known, name
    assert (history.error("total_shear", history.radii) == history.error("total_shear")).all()
    # where the history begins nothing is known of the shear, or little
    assert history.error("total_shear")[0] > 0.1
    assert history.error("total_shear")[-1] < 1e-4


@functools.cache
def layered():
    return solve(Scene(0.2, 0.1, 0.1), 1e-6, NAMES)


def test_it_begins_where_the_layer_alone_gives_way():
    """There pressures under flat punches are uniform, and Q/P = 4 kappa b/(15 beta)."""
    history = layered().history
    b = history.radii[0]
    truth = 4.0 * layered().scene.kappa * b / (15.0 * 0.1)
    found = history.total_shear(b) / history.load(b)
    assert abs(found / truth - 1.0) < 1.0
    assert abs(found / truth - 1.0) <= history.error("total_shear", b)


def test_it_ends_with_the_solution_and_follows_the_stick_radius():
    solution = layered()
    history = solution.history
    for name in NAMES:
        off = abs(getattr(history, name)(1.0) / getattr(solution, name) - 1.0)
        assert off <= history.error(name, 1.0) + getattr(solution.error, name), name
    share = history.stick_radius()
    assert share[0] == 1.0
    assert (np.diff(history.radii * share) > -1e-9).all()
    assert share[-1] == pytest.approx(solution.stick_radius, rel=1e-9)


def compare_with_normal_contact(history, scene, radii):
    """Assert that load and approach are those of normal contact within the estimates of both."""
    normal = scene.replace(friction=None, tangential_compliance=0.0)
    for b in radii:
        truth = solve(normal.replace(contact_radius=float(b)), 1e-12, NAMES[:2])
        for name in NAMES[:2]:
            off = abs(getattr(history, name)(b) / getattr(truth, name) - 1.0)
            assert off <= history.error(name, b) + getattr(truth.error, name), name


@pytest.mark.parametrize(
    "profile",
    [profiles.Sum(PARABOLA, profiles.Cone(1.4)), profiles.Sphere(1.0)],
    ids=["cone and parabola", "sphere"],
)
def test_its_first_loads_are_those_of_normal_contact(profile):
    """The power that load and approach begin with was that at the first radius, not that at 0."""
    scene = Scene(1.0, 1.0, 0.1).replace(profile=profile, contact_radius=0.3)
    history = solve(scene, 1e-5, NAMES).history
    compare_with_normal_contact(history, scene, np.exp(np.linspace(*history.ends[:2], 5)))


def test_estimates_hold_at_the_ends_of_pieces():
    """What the last terms of a piece and of its neighbours show is exceeded 2.3 times here."""
    profile = profiles.Sum(profiles.Parabola(1.0), profiles.Cone(1.55))
    scene = FullScene(0.2, 1.0, 1.0, 0.1, profile=profile, contact_radius=0.3)
    history = solve(scene, 1e-7, NAMES).history
    compare_with_normal_contact(history, scene, np.exp(history.ends[2:6]))


@pytest.mark.parametrize("given", ["load", "approach"])
def test_its_end_is_not_known_better_than_the_solution(given):
    """Whatever is given, the error of the other one is that of normal contact, at all radii.

    Under this cone it is 5 and 16 times the error of the flat punches that the history adds up.
    """
    scene = FullScene(0.3, 0.2, 0.1, 0.1, profile=profiles.Cone(1.0), **{given: 1.0})
    solution = solve(scene, 1e-5, NAMES)
    history = solution.history
    end = history.radii[-1]
    [other] = {"load", "approach"} - {given}
    assert getattr(solution.error, given) == 0.0
    assert 0.0 < getattr(solution.error, other) <= history.error(other, end)


def test_it_is_stored_with_the_solution_and_written_as_a_table(tmp_path):
    solution = hertzian()
    assert Solution.from_json(solution.to_json()) == solution
    solution.save(tmp_path / "one.npz")
    loaded = Solution.load(tmp_path / "one.npz")
    assert loaded == solution
    assert (loaded.history.load() == solution.history.load()).all()
    loaded.history.to_csv(tmp_path / "one.csv")
    lines = (tmp_path / "one.csv").read_text().splitlines()
    assert lines[0] == ",".join(
        ["contact_radius", *(f"{name}{what}" for name in NAMES for what in ("", "_error"))]
    )
    assert len(lines) == 1 + len(loaded.history.radii)
    last = [float(one) for one in lines[-1].split(",")]
    assert last[:2] == [1.0, loaded.history.load(1.0)]
    with pytest.raises(SolutionFileError, match="nowhere"):
        loaded.history.to_csv(tmp_path / "nowhere" / "one.csv")


def test_the_command_line_writes_it(tmp_path, capsys):
    path = tmp_path / "grown.csv"
    scene = ["--poisson-ratio", "0.3", "--profile", "parabola", "--radius", "1"]
    scene += ["--contact-radius", "1", "--rtol", "1e-4", "--history", str(path)]
    assert main(["solve", *scene, "--friction", "0.2", "--quantities", "total_shear"]) == 0
    assert path.read_text().startswith("contact_radius,load,load_error,approach")
    path.unlink()
    assert main(["solve", *scene]) == 2
    assert "needs a contact that grows" in capsys.readouterr().err
    assert not path.exists()


def test_it_can_be_drawn():
    pytest.importorskip("matplotlib")
    figure = plotting.plot_history(hertzian())
    forces, sinking, zones = figure.axes
    assert forces.lines[0].get_ydata()[-1] == pytest.approx(16.0 / 3.0)
    assert sinking.lines[0].get_ydata()[-1] == pytest.approx(1.0)
    assert zones.lines[0].get_ydata()[-1] == pytest.approx(hertzian().stick_radius)
    with pytest.raises(SceneError, match="solution"):
        plotting.plot_history(3)


def test_what_has_no_history_says_why():
    for scene in (FullScene(0.3, 0.5, 0.5, 0.1), Scene(0.5), Scene(0.5, friction=0.0)):
        with pytest.raises(NotComputedError, match="history not computed"):
            _ = solve(scene, 1e-3, ["approach"]).history
    for given in (0.0, 1.1, [0.5, math.nan], "b"):
        with pytest.raises(SceneError, match="contact_radius"):
            hertzian().history.load(given)
    with pytest.raises(SceneError, match="quantity"):
        hertzian().history.error("pressure")
