"""The Abel integrals against mpmath: single basis functions, and smooth functions at panel ends."""

import math

import numpy as np
import pytest
from mpmath.ctx_mp import MPContext
from numpy.testing import assert_allclose, assert_array_equal
from oracles.kept import Kept

from spectral_contact.spectral.abel import (
    abel_left,
    abel_left_at_boundary,
    abel_left_blocks,
    abel_right,
    abel_right_blocks,
    abel_right_tail,
    exterior_with_decrement,
    left_increment,
    opposite_end_decrement,
)
from spectral_contact.spectral.jacobi import (
    gauss_rule,
    legendre_expansion_matrix,
    tail_values,
)
from spectral_contact.spectral.tuning import TAIL_TERMS

mp = MPContext()
mp.dps = 30
TRUTHS = Kept("abel", every=40)


def abel_exterior(e, panels, width, degree):
    return exterior_with_decrement(e, width, (degree,) * panels)[0]


MATRICES = {"deeper": abel_right, "outer": abel_left, "beyond": abel_exterior}
#: panels, width, degree
MESHES = [(4, 2.0, 12), (3, 1.0, 20), (1, 2.0, 4)]


# --- the definitions, by mpmath -------------------------------------------------------------------


def integral(function, a, b, pieces=3):
    """Integrate on the unit interval, for the tolerance of mpmath is absolute."""
    values = mp.quad(lambda v: function(a + (b - a) * v), mp.linspace(0, 1, pieces + 1))
    return (b - a) * values


def half_integral(kind, function, low, high, d, pieces=3):
    """Integrate over ``w = sqrt(|d' - d|)``, which removes the root and the factor 1/2."""
    d = mp.mpf(float(d))
    sign = -1 if kind == "deeper" else 1
    if kind == "deeper":
        ends = d - min(high, d), d - min(low, d)
    elif kind == "outer":
        ends = max(low, d) - d, max(high, d) - d
    else:
        d = -d
        ends = low - d, high - d
    roots = [mp.sqrt(e) for e in ends]
    if roots[0] == roots[1]:
        return mp.mpf(0)
    return integral(lambda w: function(d + sign * w * w), *roots, pieces)


def basis(number, k, panels, width):
    """Return a basis function and its interval; number = panels is the tail."""
    width = mp.mpf(width)
    if number == panels:
        end = mp.exp(-panels * width)
        return lambda d: mp.legendre(k, 2 * d / end - 1), mp.mpf(0), end
    ends = mp.exp(-width * (number + 1)), mp.exp(-width * number)
    return lambda d: mp.legendre(k, -2 * mp.log(d) / width - 2 * number - 1), *ends


# points inside every panel, in the tail, far above the first panel; nowhere near an end
POINTS = {
    "deeper": [0.8, 0.45, 0.2, 1e-2, 1e-3, 1e-6, 1e-30, 1e-300, 1.3, 5.0, 9.0, 1e8],
    "outer": [0.8, 0.45, 0.2, 1e-2, 1e-3, 1e-6, 1e-30, 1e-300, 0.0],
    "beyond": [0.0, 1e-300, 1e-30, 1e-6, 1e-2, 0.5, 1.0, 40.0, 1e8],
}


@pytest.mark.parametrize(("panels", "width", "degree"), MESHES)
@pytest.mark.parametrize("kind", MATRICES)
def test_matrix_of_every_panel(kind, panels, width, degree):
    points = np.array(POINTS[kind])
    matrix = MATRICES[kind](points, panels, width, degree)
    assert matrix.shape == (len(points), panels * (degree + 1) + TAIL_TERMS)
    for number in range(panels + 1):
        start = number * (degree + 1)
        for k in (0, degree) if number < panels else range(TAIL_TERMS):
            arguments = basis(number, k, panels, width)
            truths = TRUTHS(
                f"{kind}, {panels} panels of {width}, {number}, {k}",
                lambda a=arguments: [half_integral(kind, *a, d) for d in points],
            )
            for row, exact in zip(matrix, truths, strict=True):
                # the constant bounds every Legendre polynomial of the panel
                scale = row[start]
                assert abs(row[start + k] - exact) <= 4e-15 * scale
                assert (exact == 0.0) or scale > 0.0


@pytest.mark.parametrize("kind", MATRICES)
def test_no_points(kind):
    assert MATRICES[kind](np.zeros(0), 3, 2.0, 4).shape == (0, 15 + TAIL_TERMS)


# --- at the ends of panels ------------------------------------------------------------------------
#
# A single basis function has a square root there, which turns the rounding of x into its root. The
# half-integral of a smooth function must not feel the panels at all.

MESH = (4, 2.0, 20)
OFFSETS = np.array([3e-16, 2e-15, 1e-14, 1e-12, 1e-9, 1e-5])


def smooth(d):
    return 1 + 2 * d - d * d


def coefficients(panels, width, degree):
    """Expand `smooth`: entire in x, and in the span of the tail."""
    g, _ = gauss_rule(degree + 1)
    d = np.exp(-width * (np.arange(panels)[:, None] + (1 + g) / 2))
    table = smooth(d) @ legendre_expansion_matrix(degree + 1, degree).T
    g, _ = gauss_rule(TAIL_TERMS)
    end = np.exp(-panels * width)
    tail = legendre_expansion_matrix(TAIL_TERMS, TAIL_TERMS - 1) @ smooth(end * (1 + g) / 2)
    return np.concatenate([table.ravel(), tail])


def relative_errors(kind, points):
    values = MATRICES[kind](points, *MESH) @ coefficients(*MESH)
    exact = [float(half_integral(kind, smooth, mp.mpf(0), mp.mpf(1), d, 1)) for d in points]
    return np.abs(values / exact - 1)


@pytest.mark.parametrize("kind", MATRICES)
def test_smooth_functions_do_not_feel_the_ends_of_panels(kind):
    panels, width, _ = MESH
    ends = np.exp(-width * np.arange(1, panels))
    points = np.concatenate([ends * (1 + e) for e in (0.0, *OFFSETS, *-OFFSETS)])
    assert relative_errors(kind, points).max() < 1e-14


@pytest.mark.parametrize("kind", MATRICES)
def test_smooth_functions_at_the_end_of_the_first_panel(kind):
    outside = OFFSETS[:0] if kind == "outer" else OFFSETS
    assert relative_errors(kind, np.array([*(1 - OFFSETS), *(1 + outside)])).max() < 2e-14


@pytest.mark.parametrize("kind", MATRICES)
def test_smooth_functions_where_the_tail_begins(kind):
    # panels see the rounding of x and the tail that of d, each under a root
    panels, width, _ = MESH
    gaps = np.concatenate([OFFSETS, -OFFSETS])
    errors = relative_errors(kind, np.exp(-panels * width) * (1 + gaps))
    assert np.all(errors < 1e-14 + 2e-15 / np.sqrt(np.abs(gaps)))


def test_constants():
    # 1/2 int dd' / sqrt(d - d') = sqrt(d), sqrt(1 - d), and sqrt(1 + e) - sqrt(e)
    d = np.geomspace(1e-12, 0.9, 60)
    one = np.zeros(4 * 13 + TAIL_TERMS)
    one[:: 12 + 1] = 1.0
    mesh = (4, 2.0, 12)
    assert_allclose(abel_right(d, *mesh) @ one, np.sqrt(d), rtol=2e-15)
    assert_allclose(abel_left(d, *mesh) @ one, np.sqrt(1 - d), rtol=2e-15)
    assert_allclose(abel_exterior(d, *mesh) @ one, 1 / (np.sqrt(1 + d) + np.sqrt(d)), rtol=2e-15)
    past = 1 + d
    over = past - 1  # what rounding left of d
    assert_allclose(abel_right(past, *mesh) @ one, 1 / (np.sqrt(past) + np.sqrt(over)), rtol=2e-15)


def test_where_there_is_nothing_to_integrate():
    matrix = abel_right(np.array([0.05]), 3, 1.0, 2)  # inside the last panel, [e^-3, e^-2]
    assert_array_equal(matrix[0, :6], 0.0)
    assert np.all(matrix[0, 6::3] != 0.0)
    matrix = abel_left(np.array([0.5, 1.0]), 3, 1.0, 2)  # inside the first; at its start
    assert_array_equal(matrix[0, 3:], 0.0)
    assert_array_equal(matrix[1], 0.0)


# --- blocks, tails and weights --------------------------------------------------------------------


@pytest.mark.parametrize("power", [0.0, -0.5])
@pytest.mark.parametrize("width", [1.0, 2.0])
def test_deeper_blocks_depend_on_the_difference_alone(width, power):
    panels, degree, own = 5, 9, 2
    to_end = width * np.array([1e-3, 0.3, 0.99])
    blocks = abel_right_blocks(to_end, panels - own, width, degree, power)
    assert blocks.shape == (3, panels - own, degree + 1)
    for k in (0, 3, degree):
        for number in range(own, panels):
            plain, low, high = basis(number, k, panels, width)

            def weighted(d, plain=plain):
                return plain(d) * d ** mp.mpf(power)

            for i in range(3):
                d = mp.exp(mp.mpf(to_end[i]) - (own + 1) * mp.mpf(width))
                value = blocks[i, number - own, k] * float(d) ** (0.5 + power)
                # d' = d - w^2 by hand: d is not a double here
                ends = [mp.sqrt(d - min(high, d)), mp.sqrt(d - low)]
                exact = TRUTHS(
                    f"deeper block, {width}, {power}, {k}, {number}, {i}",
                    lambda d=d, ends=ends: integral(lambda w: weighted(d - w * w), *ends),
                )
                scale = blocks[i, number - own, 0] * float(d) ** (0.5 + power)
                assert abs(value - exact) <= 4e-15 * scale


def test_outer_blocks_depend_on_the_difference_alone():
    panels, width, degree = 4, 2.0, 8
    d = np.exp(-width * (3 + np.array([0.1, 0.7])))
    blocks = abel_left_blocks(width * np.array([0.1, 0.7]), panels, width, degree)
    matrix = abel_left(d, panels, width, degree)
    for k in range(panels):
        number = 3 - k
        start = number * (degree + 1)
        expected = matrix[:, start : start + degree + 1]
        values = blocks[:, k] * np.exp(-number * width / 2)
        assert (np.abs(values - expected) / expected[:, :1]).max() < 4e-15


@pytest.mark.parametrize("d", [1e-9, 4e-4, 1e-3, 0.5, 1.0])
@pytest.mark.parametrize("power", [0.0, -0.5])
@pytest.mark.parametrize("root", [False, True])
def test_deeper_tail(root, power, d):
    end = 1e-3
    terms = 2 * TAIL_TERMS if root else TAIL_TERMS
    row = abel_right_tail(np.array([d]), end, terms, power, root)[0]
    e, point, p = mp.mpf(end), mp.mpf(d), mp.mpf(power)
    # d' = d sin(phi)^2
    top = mp.asin(mp.sqrt(min(e / point, mp.mpf(1))))
    for k in range(terms):

        def integrand(phi, k=k):
            ratio = point * mp.sin(phi) ** 2 / e
            value = mp.legendre(k, 2 * (mp.sqrt(ratio) if root else ratio) - 1)
            return value * mp.sin(phi) ** (1 + 2 * p) * point ** (mp.mpf(0.5) + p)

        assert abs(row[k] - float(integral(integrand, mp.mpf(0), top, 1))) <= 2e-15 * row[0]


def test_tail_values():
    end = 0.01
    d = end * np.array([0.0, 0.25, 1.0])
    assert_allclose(tail_values(d, end, 3, False), [[1, -1, 1], [1, -0.5, -0.125], [1, 1, 1]])
    assert_allclose(tail_values(d, end, 3, True), [[1, -1, 1], [1, 0, -0.5], [1, 1, 1]], atol=1e-16)
    assert tail_values(np.zeros((2, 3)), end, 5, True).shape == (2, 3, 5)


# --- differences to the boundary, in which nothing cancels ----------------------------------------


def against(function, low, high, kernel, cut=None):
    """Return half the integral of a function times a kernel that is singular at the cut at most."""
    cuts = [low, *([cut] if cut is not None and low < cut < high else []), high]
    return mp.quad(lambda d: function(d) * kernel(d), cuts) / 2


def risen(d, panels, width, degree, power=0.0):
    """Return by how much the outer integral is more than at the boundary, of all functions."""
    every = np.arange(panels * (degree + 1) + TAIL_TERMS)
    mesh = panels, width, degree, power
    return left_increment(abel_left(d, *mesh), abel_left_at_boundary(*mesh), every, d, *mesh)


@pytest.mark.parametrize("place", [0.3, 2e-5, 1e-9])
@pytest.mark.parametrize("column", [0, 7, 12, 21, 24, 25])
def test_differences_to_the_boundary_are_right_to_the_root_of_the_distance(column, place):
    mesh, every = (4, 2.0, 5), (5,) * 4
    function, low, high = basis(*divmod(column, 6), 4, 2.0)
    e, d = mp.mpf(place), np.array([place])
    _, less = exterior_with_decrement(d, 2.0, every)
    found = {
        "fall": less[0, column],
        "rise": risen(d, *mesh)[0, column],
    }
    if column < 24:
        found["far"] = opposite_end_decrement(d, 2.0, every)[0, column]
        found["nearer"] = opposite_end_decrement(-d, 2.0, every)[0, column]
        found["singular"] = opposite_end_decrement(d, 2.0, every, -0.5)[0, column]
    kernels = {
        "fall": lambda s: 1 / mp.sqrt(s) - 1 / mp.sqrt(s + e),
        "rise": lambda s: (1 / mp.sqrt(s - e) if s > e else 0) - 1 / mp.sqrt(s),
        "far": lambda s: 1 / mp.sqrt(2 - s) - 1 / mp.sqrt(2 + e - s),
        "nearer": lambda s: 1 / mp.sqrt(2 - s) - 1 / mp.sqrt(2 - e - s),
        "singular": lambda s: (1 / mp.sqrt(2 - s) - 1 / mp.sqrt(2 + e - s)) / mp.sqrt(s),
    }
    truths = TRUTHS(
        f"differences, {column}, {place}",
        lambda: [against(function, low, high, kernel, e) for kernel in kernels.values()],
    )
    for name, wanted in zip(kernels, truths, strict=True):
        if name not in found:
            continue
        # points are not asked for far inside the tail, which is not resolved there
        scale = max(place, math.exp(-8.0)) if name == "rise" else place
        assert abs(found[name] - wanted) < 4e-15 * math.sqrt(scale), name


@pytest.mark.parametrize("column", [0, 12, 21])
def test_differences_with_an_endpoint_weight_are_right_to_the_root_of_the_distance(column):
    place, power = 2e-5, -0.3
    function, low, high = basis(*divmod(column, 6), 4, 2.0)

    def kernel(s):
        return s ** mp.mpf(power) * ((1 / mp.sqrt(s - place) if s > place else 0) - 1 / mp.sqrt(s))

    wanted = against(function, low, high, kernel, mp.mpf(place))
    found = risen(np.array([place]), 4, 2.0, 5, power)[0, column]
    assert abs(found - wanted) < 4e-15 * place ** (0.5 + power)


def test_tail_integrals_with_an_endpoint_weight_are_right_to_rounding():
    power, end = -0.3, math.exp(-8.0)

    def integral(kernel, n):
        """Return half the integral of a weighted function, in the fifth root of the distance."""

        def integrand(v):
            s = end * v**5
            return 5 * end * v**4 * s ** mp.mpf(power) * mp.legendre(n, 2 * v**5 - 1) * kernel(s)

        return float(mp.quad(integrand, [0, 1]) / 2)

    for n in range(TAIL_TERMS):
        at_end = abel_left_at_boundary(4, 2.0, 5, power)[24 + n]
        assert integral(lambda s: 1 / mp.sqrt(s), n) == pytest.approx(at_end, rel=1e-13)
        deep = abel_right_tail(np.array([2.0 * end]), end, power=power)[0, n]
        wanted = integral(lambda s: 1 / mp.sqrt(2.0 * end - s), n)
        assert wanted == pytest.approx(deep, rel=1e-12, abs=1e-16)
