"""Two elastic bodies against the operators of both, and against Spence's problem."""

import math

import numpy as np
import pytest
from oracles.spence import Collocation
from oracles.two_bodies import Body, stuck

from spectral_contact import Scene, profiles, solve

#: Pairs of (E, nu), and kappa, approach and total shear for alpha = 0.2, beta = 0.5 with coupling
#: where an earlier calculation has them.
PAIRS = [
    (Body(1.0, 0.3), Body(2.0, 0.0)),
    (Body(2.0, 0.0), Body(1.0, 0.3)),
    (Body(1.0, -0.5), Body(1.0, 0.5)),
    (Body(1.0, 0.1), Body(50.0, 0.45)),
    (Body(70.0, 0.2), Body(0.01, 0.4)),
]


def scene_of(first, second, alpha, beta, friction, *, coupled):
    """Return the scene of two bodies, whose kappa is taken from their SI data."""
    made = Scene.from_physical(
        youngs_modulus=first.youngs_modulus,
        poisson_ratio=first.poisson_ratio,
        punch_youngs_modulus=second.youngs_modulus,
        punch_poisson_ratio=second.poisson_ratio,
        profile=profiles.Parabola(1.0),
        load=1.0,
    )
    return Scene.from_kappa(made.kappa, alpha, beta, friction, coupling=coupled)


@pytest.mark.parametrize("coupled", [False, True])
@pytest.mark.parametrize(("alpha", "beta"), [(0.2, 0.5), (1.0, 0.3)])
@pytest.mark.parametrize("pair", PAIRS)
def test_both_operators_added_up(pair, alpha, beta, coupled):
    first, second = pair
    unit = first.compliance + second.compliance
    found = solve(scene_of(*pair, alpha, beta, math.inf, coupled=coupled), 1e-12)
    expected = stuck(first, second, alpha * unit, beta * unit, coupled=coupled)
    assert found.approach == pytest.approx(expected.approach / unit, rel=1e-13)
    assert found.total_shear == pytest.approx(expected.total_shear, rel=1e-11)
    s = np.linspace(0.1, 0.9, 5)
    pressure, traction = expected.at(s)
    assert found.pressure(s) == pytest.approx(pressure, rel=1e-7)
    assert found.traction(s) == pytest.approx(traction, rel=1e-7)
    assert np.sign(found.total_shear) == np.sign(first.cross - second.cross)


def test_the_earlier_calculation():
    """Bonded, coupled: 11 digits of closed-form matrices of two bodies."""
    found = solve(scene_of(*PAIRS[0], 0.2, 0.5, math.inf, coupled=True), 1e-12)
    assert found.scene.kappa == pytest.approx(0.00354610, abs=5e-9)
    assert found.approach == pytest.approx(0.19615995457, abs=5e-12)
    assert found.total_shear == pytest.approx(0.00155698685, abs=5e-12)
    turned = solve(scene_of(*PAIRS[1], 0.2, 0.5, math.inf, coupled=True), 1e-12)
    assert turned.total_shear == -found.total_shear


def test_equal_bodies_have_no_traction():
    body = Body(3.0, 0.2)
    assert stuck(body, body, 1.0, 1.0, coupled=True, count=40).total_shear == 0.0
    assert solve(scene_of(body, body, 0.2, 0.5, math.inf, coupled=True)).total_shear == 0.0


def test_spence_between_dissimilar_bodies():
    """Partial slip with coupling, flat and growing: the oracle knows one body of the same kappa."""
    soft, stiff = Body(1.0, 0.3), Body(40.0, 0.25)
    scene = scene_of(stiff, soft, 0.0, 0.0, None, coupled=True)
    assert scene.kappa < 0.0
    nu = (1.0 - 4.0 * abs(scene.kappa)) / (2.0 - 4.0 * abs(scene.kappa))
    expected = Collocation(nu, 0.6).flat()
    flat = solve(scene.replace(friction=expected.friction), 1e-8)
    assert flat.stick_radius == pytest.approx(0.6, rel=1e-8)
    assert flat.approach == pytest.approx(expected.approach, rel=1e-8)
    assert flat.total_shear == pytest.approx(-expected.shear, rel=1e-8)
    ball = scene.replace(
        friction=expected.friction, profile=profiles.Parabola(1.0), contact_radius=0.5
    )
    grown = solve(ball, 1e-5, ("stick_radius", "total_shear"))
    assert grown.stick_radius == pytest.approx(0.6, rel=1e-5)
    assert grown.total_shear < 0.0
