"""The disk under a nonlinear layer and its division, and the search for the approach of a load."""

from types import SimpleNamespace

import numpy as np
import pytest

from spectral_contact import ConvergenceError, Scene, SceneError, layers, profiles, solve
from spectral_contact.contact import layered_contact as search
from spectral_contact.contact import layered_setting as division

THIN = layers.CalculixExponential(1e-3, 1e-3)
BALL = profiles.Parabola(1.0)


@pytest.mark.parametrize(
    ("profile", "given"),
    [
        (profiles.Cone(0.3), {"approach": 2.0}),
        (profiles.TruncatedCone(0.1, 0.8), {"approach": 2.0}),
        (profiles.TruncatedCone(0.1, 0.3), {"load": 10.0}),
    ],
)
def test_a_pointed_body_on_a_thin_layer_is_about_a_smooth_contact(profile, given):
    """The overclosure at the centre lies thousands of sizes of the law below the approach."""
    scene = Scene(0.3, profile=profile, **given)
    bare, layered = (solve(one, 1e-6) for one in (scene, scene.replace(layer=THIN)))
    assert layered.load == pytest.approx(bare.load, rel=2e-3)
    assert layered.approach == pytest.approx(bare.approach, rel=2e-3)


@pytest.mark.parametrize(("approach", "radius"), [(2.0, 8.0), (-0.1, 1e-3), (1e-4, 1e5)])
def test_the_central_pressure_is_that_of_two_springs_in_series(approach, radius):
    pressure = division._central_pressure(THIN, approach, radius)
    overclosure = THIN.overclosure(pressure)
    assert overclosure + 0.5 * radius * pressure == pytest.approx(approach, rel=1e-9)


def test_the_central_pressure_has_an_overclosure_even_if_it_underflows():
    steep = layers.CalculixExponential(1.0, 1e-3)
    assert np.isfinite(steep.overclosure(division._central_pressure(steep, -1.0, 1.0)))


@pytest.mark.parametrize("given", [{"approach": -1.0}, {"approach": -0.15}, {"separation": 0.15}])
@pytest.mark.parametrize("profile", [BALL, profiles.Cone(0.3)])
def test_a_gap_without_a_pressure_is_refused(profile, given):
    """At 0.15 the pressure is 1e-300, and the load lost digits."""
    with pytest.raises(SceneError, match="the layer has a pressure there"):
        solve(Scene(0.3, layer=layers.CalculixExponential(1.0, 1e-3), profile=profile, **given))


@pytest.mark.parametrize("exponent", [10.0, 20.0, 60.0])
def test_cells_are_small_at_a_turn_next_to_the_end_of_the_disk(exponent):
    profile, layer = profiles.PowerLaw(1.0, exponent), layers.CalculixExponential(1e-3, 1e-4)
    cells = division.setting_at_approach(profile, layer, 1.0).cells
    width = np.exp(-division._turn_depth(profile, layer, 1.0, division._turn(profile, layer, 1.0)))
    assert min(cells.lengths) < width
    assert solve(Scene(0.3, layer=layer, profile=profile, approach=1.0), 1e-10).converged


def test_cells_at_another_radius_than_the_turn_do_not_have_its_width():
    soft = layers.CalculixExponential(0.12, 0.053)
    setting = division.setting_at_approach(BALL, soft, 0.093)
    turn = division._turn(BALL, soft, 0.093)
    assert turn < setting.cells.pivot.value * setting.radius
    assert division._turn_depth(BALL, soft, 0.093, turn) > 1.0
    assert setting.cells == division._cells(setting.cells.pivot, 1.0)


def test_the_turn_is_where_the_mean_pressure_is_that_of_the_layer():
    turn = division._turn(BALL, THIN, 0.3)
    smooth = solve(Scene(0.3, profile=BALL, contact_radius=turn))
    mean = smooth.load / (np.pi * turn**2)
    assert THIN.pressure(0.3 - smooth.approach) == pytest.approx(mean, rel=1e-6)


@pytest.mark.parametrize(
    ("constant", "value", "quantity"), [("_MAX_STEPS", 1, "approach"), ("_DISK_MARGIN", -1, "disk")]
)
def test_a_search_that_does_not_end_is_an_error(monkeypatch, constant, value, quantity):
    monkeypatch.setattr(search, "_MAX_STEPS", 5)
    monkeypatch.setattr(search, constant, value)
    with pytest.raises(ConvergenceError, match=f"the {quantity}.* does not settle"):
        solve(Scene(0.3, layer=THIN, profile=BALL, load=1.0), 1e-4)


@pytest.mark.parametrize("value", [0.0, np.inf, np.nan])
def test_a_load_beyond_doubles_on_the_way_is_an_error(value):
    found = SimpleNamespace(best=SimpleNamespace(value=SimpleNamespace(approach=1.0)))
    with pytest.raises(ConvergenceError, match="does not settle"):
        search._rough_approach(lambda _: found, 1.0, 1.0, lambda _: (value, 1.0))
