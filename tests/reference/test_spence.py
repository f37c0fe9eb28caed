"""The stick radius with coupling, against collocated Hilbert transforms that share no code."""

import functools
import math

import pytest
from oracles.spence import Collocation

from spectral_contact import Scene, solve

#: nu, and friction, approach and shear for the stick radius 1/2: nine digits of an earlier
#: calculation, and twelve of this library.
HALF = [
    (0.0, 0.298714616, 0.298714615962, 0.118797352821, 0.271089653547),
    (0.3, 0.152481687, 0.152481686782, 0.123096724912, 0.140747641392),
]


@functools.cache
def collocation(nu, radius):
    return Collocation(nu, radius)


@pytest.mark.parametrize(("nu", "nine", "friction", "approach", "shear"), HALF)
def test_flat_punch_of_the_stick_radius_one_half(nu, nine, friction, approach, shear):
    found = collocation(nu, 0.5).flat()
    assert abs(found.friction - nine) <= 6e-10
    assert found.friction == pytest.approx(friction, rel=1e-9)
    assert found.approach == pytest.approx(approach, rel=1e-9)
    assert found.shear == pytest.approx(shear, rel=1e-9)


def test_a_paraboloid_has_the_stick_radius_of_the_flat_punch():
    """Spence's self-similar problem: other loads, other conditions, the same friction."""
    spence = collocation(0.0, 0.5)
    assert spence.paraboloid() == pytest.approx(spence.flat().friction, rel=1e-5)


def test_the_solver_finds_the_radius():
    found = collocation(0.0, 0.7).flat()
    solution = solve(Scene(0.0, friction=found.friction, coupling=True), 1e-6)
    assert solution.stick_radius == pytest.approx(0.7, abs=2e-9 + solution.error.stick_radius)
    assert solution.approach == pytest.approx(found.approach, rel=1e-9 + solution.error.approach)
    assert solution.total_shear == pytest.approx(found.shear, rel=1e-9 + solution.error.total_shear)


def test_weak_coupling_is_the_closed_form_of_the_paper():
    """Errors fall like the square of kappa, and so does what coupling changes."""
    nu = 0.5 - 1e-4
    kappa = Scene(nu).kappa
    plain = solve(Scene(nu, friction=kappa), 1e-12)
    found = Collocation(nu, plain.stick_radius).flat()
    assert found.friction == pytest.approx(kappa, rel=10.0 * kappa**2 + 1e-9)
    assert math.isclose(found.shear, plain.total_shear, rel_tol=10.0 * kappa**2 + 1e-9)
