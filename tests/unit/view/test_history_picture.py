"""The picture of a growing contact: all of the curves, in the units of the scene."""

import pytest

from spectral_contact import Scene, profiles, solve

plotting = pytest.importorskip("spectral_contact.plotting")
pytest.importorskip("matplotlib")
BALL = {"profile": profiles.Parabola(1e-3), "load": 1.0, "friction": 0.1}


def test_a_negative_shear_is_inside_the_axes():
    solution = solve(Scene.from_kappa(-0.1, **BALL), 1e-6)
    assert solution.total_shear < 0.0
    low, _ = plotting.plot_history(solution).axes[0].get_ylim()
    assert low < solution.total_shear


def test_a_scene_in_si_has_loads_in_newtons():
    scene = Scene.from_physical(youngs_modulus=1e9, poisson_ratio=0.3, **BALL)
    forces, sinking, zones = plotting.plot_history(solve(scene, 1e-6)).axes
    assert forces.get_lines()[0].get_ydata()[-1] == pytest.approx(1.0)
    assert forces.get_ylabel() == "load, total shear [N]"
    assert sinking.get_ylabel() == r"approach $\delta$ [m]"
    assert {one.get_xlabel() for one in (forces, sinking, zones)} == {"contact radius [m]"}
