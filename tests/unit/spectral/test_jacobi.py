import math
from functools import lru_cache

import numpy as np
import pytest
from mpmath.ctx_mp import MPContext
from numpy.testing import assert_allclose, assert_array_equal
from scipy import special

from spectral_contact import Scene, cache_sizes, clear_caches, solve
from spectral_contact.fields.legendre import legendre_sums_between
from spectral_contact.spectral.jacobi import (
    gauss_rule,
    legendre_expansion_matrix,
    legendre_interpolation_matrix,
    legendre_projection_matrix,
    legendre_values,
)

mp = MPContext()
mp.dps = 40

X = np.linspace(-1.0, 1.0, 41)


# --- values ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("degree", [0, 1, 24])
def test_legendre_values(degree):
    exact = [[float(mp.legendre(n, mp.mpf(float(x)))) for n in range(degree + 1)] for x in X]
    assert_allclose(legendre_values(X, degree), exact, atol=2e-15)


@pytest.mark.parametrize("shape", [(), (3,), (2, 3), (0,)])
def test_values_take_any_shape(shape):
    values = legendre_values(np.full(shape, 0.25), 4)
    assert values.shape == (*shape, 5)
    assert_array_equal(values, np.broadcast_to(legendre_values(0.25, 4), values.shape))


# --- Gauss rules ----------------------------------------------------------------------------------


@lru_cache
def exact_legendre_rule(points):
    """Nodes by Newton's method on the recurrence, 40 digits; increasing."""
    nodes, weights = [], []
    for k in range(points):
        x = -mp.cos(mp.pi * (k + 0.75) / (points + 0.5))
        step = 1
        while abs(step) > 1e-20:  # the error is squared in each
            before, value = mp.mpf(1), x
            for m in range(2, points + 1):
                before, value = value, ((2 * m - 1) * x * value - (m - 1) * before) / m
            slope = points * (before - x * value) / (1 - x * x)
            step = value / slope
            x -= step
        nodes.append(x)
        weights.append(2 / ((1 - x * x) * slope**2))
    return nodes, weights


@pytest.mark.parametrize("points", [1, 2, 3, 8, 20, 33, 46, 64, 101])
def test_gauss_legendre_is_right_to_the_last_digit(points):
    nodes, weights = gauss_rule(points)
    exact_nodes, exact_weights = exact_legendre_rule(points)
    pairs = zip(nodes, exact_nodes, strict=True)
    assert max(abs(float(mp.mpf(float(x)) - y)) for x, y in pairs) < 1.2e-16
    pairs = zip(weights, exact_weights, strict=True)
    assert max(abs(float(mp.mpf(float(w)) / v - 1)) for w, v in pairs) < 4e-16


def test_numpys_weights_are_why_the_library_has_its_own():
    # once this fails, `_gauss_legendre` can go
    weights = np.polynomial.legendre.leggauss(64)[1]
    assert (np.abs(weights / gauss_rule(64)[1] - 1)).max() > 1e-13


@pytest.mark.parametrize("points", [1, 5, 20, 46])
def test_gauss_legendre_is_symmetric_and_sums_to_two(points):
    nodes, weights = gauss_rule(points)
    assert np.all(np.diff(nodes) > 0)
    assert_array_equal(nodes, -nodes[::-1])
    assert_array_equal(weights, weights[::-1])
    assert_allclose(weights.sum(), 2.0, rtol=5e-16)


@pytest.mark.parametrize("points", [1, 2, 7, 20])
def test_gauss_legendre_is_exact_to_its_degree_and_no_further(points):
    nodes, weights = gauss_rule(points)
    degrees = np.arange(1, 2 * points)
    assert_allclose(legendre_values(nodes, 2 * points - 1)[:, degrees].T @ weights, 0, atol=3e-16)
    assert abs(special.eval_legendre(2 * points, nodes) @ weights) > 0.1 / points


def test_rules_are_shared_and_read_only():
    for array in gauss_rule(11):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0.0
    assert gauss_rule(11) is gauss_rule(11)
    with pytest.raises(ValueError, match="read-only"):
        legendre_expansion_matrix(11, 4)[0, 0] = 0.0


@pytest.mark.parametrize("points", [0, -3])
def test_a_rule_has_points(points):
    with pytest.raises(ValueError, match=r"."):
        gauss_rule(points)


# --- expansion ------------------------------------------------------------------------------------


@pytest.mark.parametrize(("points", "degree"), [(5, 4), (20, 19), (20, 6), (1, 0)])
def test_expansion_recovers_coefficients(points, degree):
    coefficients = np.cos(np.arange(degree + 1))
    nodes, _ = gauss_rule(points)
    values = legendre_values(nodes, degree) @ coefficients
    assert_allclose(legendre_expansion_matrix(points, degree) @ values, coefficients, atol=3e-15)


def test_expansion_projects():
    # P_6 is orthogonal to all lower degrees also in the discrete sense
    nodes, _ = gauss_rule(8)
    matrix = legendre_expansion_matrix(8, 5)
    assert matrix.shape == (6, 8)
    assert_allclose(matrix @ legendre_values(nodes, 6)[:, 6], 0, atol=3e-15)


@pytest.mark.parametrize("points", [20, 28, 36])
def test_a_constant_is_interpolated_to_a_few_roundings_at_the_ends_too(points):
    # what is off at the end of the first panel is felt 100 times by q at the centre
    at = np.array([-1.0, -0.999, 0.3, 1.0])
    values = legendre_interpolation_matrix(at, points) @ np.ones(points)
    assert_allclose(values, 1.0, atol=2e-15)


def test_projection_is_orthogonal_to_the_last_digit():
    nodes, _ = gauss_rule(36)
    matrix = legendre_projection_matrix(36, 24)
    exact = np.diag(1 / (np.arange(25) + 0.5))
    assert_allclose(matrix.T @ legendre_values(nodes, 24), exact, atol=4e-16)
    # what is constant has no part of a high degree: the rule alone leaves 1e-16
    assert np.abs([math.fsum(column) for column in matrix.T[20:]]).max() < 4e-17


def test_legendre_between_the_ends_keeps_both_distances():
    near = np.array([1e-30, 1e-12, 0.3])
    low, high = near[:, None], 2 - near[:, None]
    from_start = legendre_sums_between(np.ones((3, 1)), low, high, 24)
    to_end = legendre_sums_between(np.ones((3, 1)), high, low, 24)
    for n in (1, 6, 24):
        slope = n * (n + 1) / 2
        at_end = to_end[:, n]
        assert_allclose(1 - at_end[1], slope * 1e-12, atol=3e-16)
        assert_allclose(from_start[:, n], (-1) ** n * at_end)
        assert_allclose(at_end, legendre_values(1 - near, 24)[:, n], atol=3e-14)


def test_rules_and_matrices_are_kept_until_caches_are_cleared():
    solve(Scene(0.1, 0.5))
    assert {"Gauss rules", "Legendre matrices"} <= {name for name, n in cache_sizes().items() if n}
    clear_caches()
    assert not any(cache_sizes().values())
