"""Sweeps of scenes with nonlinear layers: over loads, approaches and parameters of the law."""

import numpy as np
import pytest

from spectral_contact import Scene, SceneError, SolutionFileError, layers, profiles, solve

xarray = pytest.importorskip("xarray", reason="part of the extra: sweep")

from spectral_contact.sweeps import plot_slice, sweep  # noqa: E402
from spectral_contact.sweeps.sweep_parameters import grid  # noqa: E402

BALL = profiles.Parabola(1.0)
POWER = Scene(0.3, layer=layers.PowerLaw(5.0, 2.0), profile=BALL, load=1.0)
OPEN = Scene(0.3, layer=layers.CalculixExponential(0.1, 0.2), profile=BALL, approach=0.1)
LOADS, EXPONENTS = [0.1, 1.0], [1.5, 2.0, 3.0]


def test_a_grid_has_the_numbers_of_solve_within_the_estimates():
    found = sweep(POWER, load=LOADS, layer={"exponent": EXPONENTS}, rtol=1e-6)
    assert found.sizes == {"load": 2, "layer_exponent": 3}
    assert (found.ending == "converged").all()
    assert str(found.layer.values) == "PowerLaw(coefficient=5.0, exponent=…)"
    for load, exponent in ((0.1, 1.5), (1.0, 3.0)):
        own = POWER.replace(load=load, layer=layers.PowerLaw(5.0, exponent))
        alone, here = solve(own, 1e-11), found.sel(load=load, layer_exponent=exponent)
        for name in ("contact_radius", "approach", "stiffness", "indentation_work"):
            error = float(here[f"{name}_error"])
            assert 0.0 < error <= 1e-4
            assert abs(float(here[name]) / getattr(alone, name) - 1.0) <= error + 1e-10


def test_where_there_is_no_edge_the_radius_is_not_there():
    found = sweep(OPEN, approach=[-0.1, 0.0, 0.1], rtol=1e-5)
    assert np.isnan(found.contact_radius.values).all()
    assert (np.diff(found["load"].values) > 0.0).all()


def test_a_list_may_have_several_laws():
    linear = Scene(0.3, 0.5, profile=BALL, load=1.0)
    found = sweep([POWER, OPEN, linear], rtol=1e-5, quantities=["approach"])
    briefs = found.layer.values.tolist()
    assert briefs == [POWER.layer.brief, OPEN.layer.brief, ""]
    for scene, approach in zip((POWER, OPEN, linear), found.approach.values, strict=True):
        assert approach == pytest.approx(solve(scene, 1e-9).approach, rel=1e-5)


def test_a_sweep_takes_separations():
    found = sweep(OPEN, separation=[-0.1, 0.0, 0.2], quantities=["load"], rtol=1e-5)
    assert found["load"].dims == ("separation",)
    for d, load in zip(found["separation"].values, found["load"].values, strict=True):
        own = OPEN.replace(approach=None, separation=d)
        assert load == pytest.approx(solve(own, 1e-9).load, rel=1e-5)


def test_a_store_knows_the_law(tmp_path):
    asked = {"load": LOADS, "layer": {"exponent": EXPONENTS}, "rtol": 1e-3}
    one = sweep(POWER, **asked, store=tmp_path / "store", chunk=4)
    again = sweep(POWER, **asked, store=tmp_path / "store", chunk=4)
    xarray.testing.assert_identical(one, again)
    one.to_netcdf(tmp_path / "a.nc")
    assert xarray.load_dataset(tmp_path / "a.nc").equals(one)
    with pytest.raises(SolutionFileError, match="other scenes"):
        sweep(
            POWER.replace(layer=layers.PowerLaw(4.0, 2.0)),
            **asked,
            store=tmp_path / "store",
            chunk=4,
        )
    prints = {grid(scene, {"load": LOADS}).fingerprint() for scene in (POWER, OPEN)}
    assert len(prints) == 2


def test_a_slice_is_drawn():
    pytest.importorskip("matplotlib", reason="part of the extra: plot")
    found = sweep(POWER, layer={"exponent": EXPONENTS, "coefficient": 5.0 * np.ones(1)}, rtol=1e-3)
    axes = plot_slice(found, "stiffness").axes[0]
    assert axes.get_xlabel() == "exponent of the layer's law"


@pytest.mark.parametrize(
    ("scenes", "law", "message"),
    [
        (POWER, {"exponant": [1.0]}, r"layer = 'exponant': .* did you mean exponent"),
        (POWER, {"exponent": [0.5, 2.0]}, "exponent = 0.5"),
        (POWER, {"exponent": []}, "layer_exponent = .* at least one number"),
        (POWER, {"exponent": ["a"]}, "layer_exponent"),
        (POWER, [1.0], "layer = .* a mapping"),
        (Scene(0.3), {"exponent": [1.0]}, "layer = .* None for a scene without a layer"),
        ([POWER], {"exponent": [2.0]}, "layer = .* None with a list"),
        (
            POWER.replace(layer=layers.Table((0, 1, 2, 3), (0, 1, 2, 4))),
            {"pressures": [1.0]},
            "a number of the law: none",
        ),
    ],
)
def test_bad_input_is_named(scenes, law, message):
    with pytest.raises(SceneError, match=message):
        sweep(scenes, layer=law)
