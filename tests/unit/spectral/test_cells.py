"""Polynomials on cells: half-integrals against quadrature, and the field they stand for."""

from itertools import pairwise

import mpmath
import numpy as np
import pytest

from spectral_contact.fields.series import Radius
from spectral_contact.spectral.cells import DiskCells, cell_space

PIVOT = Radius(0.6, 0.4)
CELLS = DiskCells(PIVOT, (-0.36, -1e-4, 0.0, 2e-4, 0.64))
DEGREES = (4, 3, 6, 5)
ENDS = np.array(CELLS.offsets) + 0.36


def legendre(cell, degree, z):
    low, high = ENDS[cell : cell + 2]
    return mpmath.legendre(degree, 2 * (z - low) / (high - low) - 1)


@pytest.mark.parametrize("cell", range(4))
def test_half_integrals_at_the_nodes(cell):
    """``int p s ds / sqrt(s^2 - t^2)``, of the highest polynomial on a cell."""
    space = cell_space(CELLS, DEGREES)
    coefficients = np.zeros(space.size)
    last = int(np.cumsum(np.array(DEGREES) + 1)[cell]) - 1
    coefficients[last] = 1.0
    found = space.half_integral(coefficients)
    low, high = ENDS[cell : cell + 2]
    for k in range(0, len(space.t), 7):
        square = space.t[k] ** 2
        expected = 0.0
        if square < high:
            first = mpmath.sqrt(max(low - square, 0.0))
            ends = [first, mpmath.sqrt(high - square)]
            expected = float(
                mpmath.quad(lambda u, q=square: legendre(cell, DEGREES[cell], q + u**2), ends)
            )
        # the small cells are known by their distance from the pivot, which s**2 rounds away
        assert found[k] == pytest.approx(expected, abs=1e-11)


def test_integrals_over_nodes_and_matrices():
    space = cell_space(CELLS, DEGREES)
    assert space.weights.sum() == pytest.approx(1.0, rel=1e-14)
    assert space.t**2 + space.y == pytest.approx(1.0, rel=1e-14)
    one = np.zeros(space.size)
    one[np.cumsum([0, *(n + 1 for n in DEGREES[:-1])])] = 1.0
    assert space.half_integral(one) == pytest.approx(np.sqrt(space.y), rel=1e-13)
    own = one[space.index]
    # int (1 - t^2) dt / pi, and int s ds
    assert own @ space.gram @ own == pytest.approx(2.0 / 3.0 / np.pi, rel=1e-14)
    assert own @ space.mass @ own == pytest.approx(0.5, rel=1e-14)
    assert space.constant_moments @ own == pytest.approx(0.25, rel=1e-14)


def test_the_field_is_the_function():
    rows = []
    for low, high in pairwise(ENDS):
        local = np.linspace(-1.0, 1.0, 9)
        z = low + (high - low) * (1.0 + local) / 2.0
        rows.append(np.polynomial.legendre.legfit(local, z**3 - z, 3))
    field = CELLS.field(rows)
    s = np.append(np.linspace(0.0, 1.0, 50), 0.6 + 1e-5 * np.arange(-9, 10))
    assert field(s, 1.0 - s) == pytest.approx(s**6 - s**2, abs=1e-14)
