"""The mean slip over friction: quadrature, thresholds, and where it ends."""

import math

import numpy as np
import pytest
from oracles.cycling_rings import monotonic, rings

from spectral_contact import Scene, solve
from spectral_contact.solving.solver import Continuation
from spectral_contact.sweeps.mean_slip import ASKED, MeanSlipCurve, annulus_nodes, mean_slip

SCENE = Scene(0.1, 0.5, 0.5, 0.1)


def curve(scene, critical, rtol=1e-4, scale=1.0):
    path = Continuation(0.1 * rtol, ASKED, 20_000)
    return MeanSlipCurve(
        lambda f: path.solve(scene.replace(friction=f)),
        scene.friction,
        scene.friction,
        critical,
        scale,
        rtol,
    )


def test_nodes_integrate_with_a_root_at_either_end():
    from_edge, area = annulus_nodes(0.4, 0.0, 16)
    assert area.sum() == pytest.approx((1.0 - 0.6**2) / 2.0, rel=1e-14)
    length = area / (1.0 - from_edge)
    assert length @ (0.4 - from_edge) ** 1.5 == pytest.approx(0.4**2.5 / 2.5, rel=1e-13)
    assert length @ from_edge**-0.5 == pytest.approx(2.0 * 0.4**0.5, rel=1e-13)


def test_the_mean_slip_is_that_of_rings():
    solution = solve(SCENE, 1e-10)
    found = mean_slip(solution)
    own = rings(np.sqrt(1.0 - np.linspace(1.0, 0.0, 121) ** 2), 0.5, 0.5, SCENE.kappa)
    slip = monotonic(own, 0.1)[1]
    assert -2.0 * np.pi * (own.areas * own.pressure) @ slip == pytest.approx(found.value, rel=2e-4)
    assert found.error < 1e-9


def test_the_mean_slip_is_in_the_energy_of_the_body():
    solution = solve(SCENE, 1e-10)
    energies = solution.inside.energies()
    # the load grows in proportion: friction does half of what it would at once
    assert 2.0 * energies.friction / 0.1 == pytest.approx(mean_slip(solution).value, rel=1e-9)


def test_nothing_slips_in_full_stick():
    assert mean_slip(solve(SCENE.replace(friction=0.2), 1e-4)) == (0.0, 0.0)


def test_an_integral_over_friction_has_its_error():
    critical = solve(SCENE, 1e-12, ("critical_friction",)).critical_friction
    # Gauss points in the cube root of the distance from R, each solved on its own
    x, w = np.polynomial.legendre.leggauss(8)
    v = (x + 1.0) / 2.0
    width = critical - 0.1
    means = [
        mean_slip(solve(SCENE.replace(friction=critical - width * one**3), 1e-8)).value for one in v
    ]
    truth = width * (3.0 * v**2 * w / 2.0) @ means
    for rtol in (1e-2, 1e-4):
        found = curve(SCENE, critical, rtol).integrate(np.ones_like, 0.1, 0.1)
        assert abs(found.value - truth) <= found.error + 1e-5 * truth
        assert found.error < rtol * truth


def test_a_threshold_of_zones_is_an_end_of_panels():
    scene = Scene(0.3, 0.05, 1.0, 0.012)
    critical = solve(scene, 1e-10, ("critical_friction",)).critical_friction
    found = curve(scene, critical, 1e-2)
    [low] = found._thresholds
    kinds = [
        [zone.kind for zone in found._solved[tau][0].zones] for tau in (low, found._thresholds[low])
    ]
    assert kinds[0] != kinds[1]


def test_without_tangential_compliance_the_curve_has_no_end():
    scene = SCENE.replace(tangential_compliance=0.0, friction=0.5)
    found = curve(scene, math.inf, 1e-3, 0.7).integrate(
        lambda beyond: (0.5 + beyond) ** -3.0, 0.5, 0.5
    )
    assert 0.0 < found.error < 1e-2 * found.value
