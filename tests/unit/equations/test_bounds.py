"""Bounds of the approach: what they take."""

import math

import pytest

from spectral_contact import NotComputedError, Scene, solve

ROUGH = Scene(0.1, 0.5, 0.5, math.inf)


@pytest.mark.parametrize("scene", [ROUGH, ROUGH.replace(coupling=True)])
def test_bounds_take_the_approach(scene):
    solution = solve(scene, 1e-4, ["pressure", "traction"])
    with pytest.raises(NotComputedError, match="approach not computed: it was not asked for"):
        _ = solution.approach_bounds
