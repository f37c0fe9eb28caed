"""Damping maps: the loops of `steady_cycle`, and where there are none."""

import math

import numpy as np
import pytest

from spectral_contact import Scene, SceneError, damping_map, steady_cycle
from spectral_contact.sweeps import plot_slice

SCENE = Scene(0.1, 0.5, 0.5, 0.1)


def test_a_map_has_the_loops_of_steady_cycle():
    found = damping_map(SCENE, [0.005, 0.1, 0.5], [0.09, 0.1], rtol=1e-2)
    assert found.dissipation.dims == ("friction", "lowest")
    assert found.converged.all()
    for friction, lowest in ((0.09, 0.1), (0.1, 0.005)):
        own = found.sel(friction=friction, lowest=lowest)
        truth = steady_cycle(SCENE.replace(friction=friction), lowest, rtol=1e-2)
        for name in ("reloading_dissipation", "unloading_dissipation", "stick_radius"):
            value, error = getattr(truth, name), getattr(truth.error, name)
            if value is None:
                assert math.isnan(own[name])
                continue
            assert abs(float(own[name]) / value - 1.0) <= float(own[f"{name}_error"]) + error
    assert found.dissipation.sel(friction=0.1, lowest=0.5) == 0.0
    assert np.isnan(found.dissipation.sel(friction=0.1, lowest=0.005))
    assert plot_slice(found, "reloading_dissipation").axes
    told = "relative error of energy dissipated while the load falls"
    assert found.unloading_dissipation_error.attrs["long_name"] == told


def test_the_friction_is_that_of_the_scene_if_none_is_given():
    found = damping_map(SCENE, 0.2, rtol=1e-2)
    assert found.friction.values.tolist() == [0.1]
    assert found.sizes == {"friction": 1, "lowest": 1}
    truth = steady_cycle(SCENE, 0.2, rtol=1e-2)
    allowed = float(found.dissipation_error.item()) + truth.error.dissipation
    assert abs(found.dissipation.item() / truth.dissipation - 1.0) <= allowed


def test_a_friction_between_the_ends_of_the_axis_has_its_digits():
    # the loops of the largest friction do not slip, nor do those of the largest load
    found = damping_map(SCENE, [0.5, 0.95], [0.005, 0.052, 0.3], rtol=1e-3)
    assert found.converged.all()
    assert 0.0 < found.reloading_dissipation_error.sel(friction=0.052, lowest=0.5) <= 1e-3


@pytest.mark.parametrize(
    ("name", "arguments"),
    [
        ("lowest", {"lowest": []}),
        ("lowest", {"lowest": [0.5, 1.0]}),
        ("lowest", {"lowest": [[0.5]]}),
        ("friction", {"lowest": 0.5, "friction": [0.1, 0.0]}),
        ("friction", {"lowest": 0.5, "friction": [math.inf]}),
        ("friction", {"lowest": 0.5, "friction": [0.1, 1e-200]}),
        ("friction", {"lowest": 0.5, "friction": [0.1, 1e200]}),
        ("rtol", {"lowest": 0.5, "rtol": 1.0}),
    ],
)
def test_bad_axes_are_refused(name, arguments):
    with pytest.raises(SceneError, match=name):
        damping_map(SCENE, **arguments)
    with pytest.raises(SceneError, match="friction"):
        damping_map(SCENE.replace(friction=None), 0.5)
