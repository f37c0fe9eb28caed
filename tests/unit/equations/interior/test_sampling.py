"""What errors of the loads leave of the stresses on the surface."""

from dataclasses import replace
from fractions import Fraction

import mpmath
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


def test_radii_in_metres_keep_their_distance_from_the_edge():
    radius = 3e-3
    physical = solve(
        Scene.from_physical(radius=radius, load=1.0, youngs_modulus=1e6, poisson_ratio=0.3)
    ).physical
    for share in (1e-4, 1e-8, 1e-12):
        r = radius * (1.0 - share)
        from_edge = Fraction(radius) - Fraction(r)
        y = float(from_edge * (Fraction(radius) + Fraction(r)) / Fraction(radius) ** 2)
        pressure = 1.0 / (2.0 * np.pi * radius**2 * np.sqrt(y))
        stress = physical.inside.stress(r, 0.0)
        assert abs(stress.zz + pressure) <= stress.error * stress.norm
        assert physical.pressure(r) == pytest.approx(pressure, rel=1e-14)


def test_stress_at_a_place_in_metres_has_the_error_of_the_contact_radius():
    sphere = {"profile": profiles.Parabola(0.01), "work_of_adhesion": 0.5, "youngs_modulus": 1e6}
    pull_off = 1.5 * np.pi * 0.5 * 0.01
    scene = Scene.from_physical(poisson_ratio=0.3, load=-pull_off * (1.0 - 1e-10), **sphere)
    solution = solve(scene, 1e-7)
    physical = solution.physical
    # by Johnson, Kendall and Roberts, with the double that the load is
    with mpmath.workdps(30):
        modulus, w, curvature = mpmath.mpf(1e6) / (1 - mpmath.mpf(0.3) ** 2), mpmath.mpf(0.5), 0.01
        q = 3 * mpmath.pi * w * curvature
        load = mpmath.mpf(scene.physical.load)
        cube = load + q + mpmath.sqrt(2 * q * load + q**2)
        a = mpmath.cbrt(3 * curvature * cube / (4 * modulus))
        r = physical.contact_radius * (1.0 - 1e-6)
        root = mpmath.sqrt(1 - (r / a) ** 2)
        pressure = 2 * modulus * a / (mpmath.pi * curvature) * root
        pressure -= mpmath.sqrt(2 * modulus * w / (mpmath.pi * a)) / root
    stress = physical.inside.stress(r, 0.0)
    missed = abs(stress.zz + float(pressure)) / stress.norm
    assert 1e-7 < missed <= stress.error
    assert physical.inside.stress(from_edge=1e-6 * physical.contact_radius).error < 1e-7
