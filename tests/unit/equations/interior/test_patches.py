"""Polynomials for many points: what their nodes do not see is not interpolated."""

import numpy as np
import pytest

from spectral_contact import Scene, solve


@pytest.mark.parametrize("share", [0.26185, 0.26189])
def test_slip_in_an_annulus_that_is_narrower_than_the_nodes_are_apart(share):
    """The friction is just below the critical one, 0.261898 kappa."""
    solution = solve(Scene(0.3, 0.05, 1.0, share / 7.0), 1e-10)
    slip = solution.zones[1]
    width = slip.inner_from_edge - slip.outer_from_edge
    middle = slip.outer_from_edge + width / 2.0
    random = np.random.default_rng(8)
    from_edge = middle + np.append(random.uniform(-1, 1, 1000) * width, np.linspace(-0.04, 0.04))
    z = width * 10.0 ** random.uniform(-5.0, 0.0, len(from_edge))
    some, body = slice(0, 1000, 10), solution.inside
    exact = body.stress(from_edge=from_edge[some], z=z[some])
    for rtol in (1e-2, 1e-6):
        found = body.stress(from_edge=from_edge, z=z, rtol=rtol)
        for part in ("rr", "tt", "zz", "rz"):
            apart = np.abs(getattr(found, part)[some] - getattr(exact, part)) / exact.norm
            assert np.all(apart <= found.error[some])


@pytest.mark.parametrize(
    ("scene", "rtol"),
    [(Scene(0.1, 1e-4, 1e-4, 0.05), 1e-6), (Scene(-0.28, 1.3e-4, 8e-6, 0.096), 1e-4)],
)
def test_a_stick_disk_that_is_narrower_than_the_nodes_are_apart(scene, rtol):
    solution = solve(scene, 1e-10)
    assert solution.stick_radius < 0.01
    random = np.random.default_rng(1)
    r, z = 10.0 ** random.uniform(-6.0, -0.5, 1500), 10.0 ** random.uniform(-12.0, -2.0, 1500)
    some, body = slice(0, 1500, 20), solution.inside
    found = body.displacement(r, z, rtol=rtol)
    exact = body.displacement(r[some], z[some])
    for part in ("r", "z"):
        apart = np.abs(getattr(found, part)[some] - getattr(exact, part)) / exact.modulus
        assert np.all(apart <= found.error[some])
