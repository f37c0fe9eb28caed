"""What errors of the loads leave of the stresses on the surface."""

from dataclasses import replace

import numpy as np
import pytest

from spectral_contact import Scene, profiles, solve


@pytest.mark.parametrize("nu", [0.3, 0.5])
def test_an_error_of_a_suction_is_one_of_the_axial_stress(nu):
    scene = Scene(nu, 1e-6, profile=profiles.Parabola(1.0), load=0.05, work_of_adhesion=0.05)
    exact = solve(scene, 1e-9)
    body = replace(exact, error=replace(exact.error, pressure=1e-3)).inside
    stress = body.stress(from_edge=[0.3, 1e-3, 1e-9])
    assert stress.zz[-1] > 100.0
    assert np.all(stress.error * stress.norm >= 1e-3 * np.abs(stress.zz))
