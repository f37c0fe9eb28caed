"""Two bodies exchanged: any scene and its mirror image, and its estimates against many digits."""

import math

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from oracles.property_settings import few

from spectral_contact import Scene, solve
from spectral_contact.precise import reference
from spectral_contact.testing.strategies import (
    coupled_stick_scenes,
    partial_slip_scenes,
    powers_of_ten,
)

RADII = np.linspace(0.0, 0.99, 12)


@few
@given(st.one_of(partial_slip_scenes(), coupled_stick_scenes()))
def test_every_scene_has_a_mirror_image(scene):
    own = solve(scene, 1e-6, strict=False)
    turned = solve(scene.replace(kappa=-scene.kappa), 1e-6, strict=False)
    assert turned.total_shear == -own.total_shear
    assert np.array_equal(turned.traction(RADII), -own.traction(RADII), equal_nan=True)
    assert np.array_equal(turned.pressure(RADII), own.pressure(RADII), equal_nan=True)
    assert (turned.approach, turned.zones, turned.error) == (own.approach, own.zones, own.error)


@settings(few, max_examples=4)
@given(st.floats(-0.37, -1e-3), powers_of_ten(-3, 1), powers_of_ten(-3, 1), st.booleans())
def test_estimates_are_honest_with_negative_kappa(kappa, alpha, beta, coupling):
    scene = Scene.from_kappa(kappa, alpha, beta, math.inf, coupling=coupling)
    found, true = solve(scene, 1e-6), reference(scene, 15)
    for name in ("approach", "total_shear"):
        exact = getattr(true, name)
        error = abs((getattr(found, name) - exact) / exact)
        assert error <= getattr(found.error, name) + 4e-15
