"""Half-integrals on annuli in fixed point, against mpmath's quadrature of the definition."""

import functools

import numpy as np
import pytest
from oracles.kept import Kept

from spectral_contact.precise.annulus_mesh import AnnulusMesh, Blocks
from spectral_contact.precise.between import Between
from spectral_contact.precise.fixed import Fixed

DIGITS = 15
POINTS = 28
INNER, OUTER = (3, 5), (4, 2)
#: Cells (from the inner end) and nodes at which integrals are compared.
PLACES = [(0, 0), (0, POINTS - 1), (1, 9), (4, 20), (-3, 0), (-2, 15), (-1, 3), (-1, POINTS - 1)]
FIXED = Fixed(240)
MP = FIXED.mp
TRUTHS = Kept("precise_annulus", every=28)


@functools.cache
def mesh(*panels):
    return AnnulusMesh(blocks(), *panels)


@functools.cache
def blocks():
    return Blocks(FIXED, 2.0, POINTS, DIGITS)


def smooth(a, b):
    """A function of the distances from both ends of an annulus of width 1."""
    return 1 / (a + MP.mpf("0.3")) + b


def rooted(a, b):
    """With the powers that integrals have at the ends."""
    return MP.sqrt(a) + b * MP.sqrt(b) + b**2 * (MP.log(b) if b else 0)


@functools.cache
def sampled(function, m):
    pairs = zip(FIXED.numbers(m.above).flat, FIXED.numbers(m.below).flat, strict=True)
    values = np.array([FIXED.of(function(a, b)) for a, b in pairs], dtype=object)
    return values.reshape(m.above.shape)


def integral(function, start, end):
    """Integrate over a root, whose ends may be near singularities."""
    width = end - start
    steps = [MP.mpf(10) ** -k for k in (2, 4, 6, 8)]
    near = [start + width * h for h in steps[::-1]] + [end - width * h for h in steps]
    return MP.quad(function, [start, *sorted(near), end])


def error(value, truth):
    return abs(FIXED.numbers(value) / truth - 1)


def check(key, found, truth):
    """Compare integrals with the truth at every place."""
    truths = TRUTHS(key, lambda: [truth(place) for place in PLACES], MP.mpf)
    for place, exact in zip(PLACES, truths, strict=True):
        assert error(found[place], exact) <= 10.0**-DIGITS


@pytest.mark.parametrize("function", [smooth, rooted])
def test_half_integrals_of_an_annulus(function):
    m = mesh(*INNER)
    values = sampled(function, m)

    def outward(place):
        a, top = FIXED.numbers(m.above[place]), MP.sqrt(FIXED.numbers(m.below[place]))
        return integral(lambda r: function(a + r * r, top**2 - r * r), 0, top)

    def inward(place):
        b, top = FIXED.numbers(m.below[place]), MP.sqrt(FIXED.numbers(m.above[place]))
        return integral(lambda r: function(top**2 - r * r, b + r * r), 0, top)

    check(f"{function.__name__}, outward", m.half_integral(values), outward)
    check(f"{function.__name__}, inward", m.inner_integral(values), inward)


@pytest.mark.parametrize("gap", [0.0, 1e-2, 0.2])
@pytest.mark.parametrize("widths", [(0.25, 0.5), (0.5, 0.0625)])
def test_half_integrals_from_annulus_to_annulus(gap, widths):
    near, far = mesh(*INNER), mesh(*OUTER)
    between = Between(near, far, tuple(FIXED.of(w) for w in widths), FIXED.of(gap))

    def over(width, rest, function):
        """Integrate a function of the share of a width beyond a distance."""
        ends = MP.sqrt(rest), MP.sqrt(rest + width)
        return integral(lambda r: function((r * r - rest) / width), *ends)

    def outward(place):
        rest = widths[0] * FIXED.numbers(near.below[place]) + MP.mpf(gap)
        return over(MP.mpf(widths[1]), rest, lambda share: smooth(share, 1 - share))

    def inward(place):
        rest = widths[1] * FIXED.numbers(far.above[place]) + MP.mpf(gap)
        return over(MP.mpf(widths[0]), rest, lambda share: smooth(1 - share, share))

    check(f"{widths}, {gap}, outward", between.half_integral(sampled(smooth, far)), outward)
    check(f"{widths}, {gap}, inward", between.inner_integral(sampled(smooth, near)), inward)


def test_matrices_are_those_of_the_integrals():
    near, far = mesh(*INNER), mesh(*OUTER)
    between = Between(near, far, (FIXED.of(0.25), FIXED.of(0.5)), 0)
    for matrix, integrals, m in (
        (near.matrix(), near.half_integral, near),
        (near.inner_matrix(), near.inner_integral, near),
        (between.matrix(), between.half_integral, far),
        (between.inner_matrix(), between.inner_integral, near),
    ):
        values = sampled(smooth, m)
        exact = FIXED.floats(integrals(values)).ravel()
        assert np.abs(matrix @ FIXED.floats(values).ravel() / exact - 1.0).max() <= 1e-14


def test_weights_integrate_over_the_annulus():
    m = mesh(*INNER)
    exact = MP.log(MP.mpf(13) / 3) + MP.mpf(1) / 2
    assert error(FIXED.times(m.weights, sampled(smooth, m)).sum(), exact) <= 10.0**-DIGITS


def test_series_pass_through_their_values():
    m = mesh(*INNER)
    values = sampled(smooth, m)
    a = FIXED.of(np.array([0.0, 1e-30, 1e-3, 0.3, 0.6, 0.9999, 1.0]))
    found = m.series(values).at(a, FIXED.one - a)
    for value, above in zip(found, FIXED.numbers(a), strict=True):
        assert error(value, smooth(above, 1 - above)) <= 10.0**-DIGITS
    for value, above in zip(m.limits(values), (MP.zero, MP.one), strict=True):
        assert error(value, smooth(above, 1 - above)) <= 10.0**-DIGITS


def test_both_ends_are_kept_apart():
    m = mesh(*INNER)
    total = FIXED.floats(m.above + m.below)
    assert np.abs(total - 1.0).max() <= 1e-15
    assert np.all(np.diff(FIXED.floats(m.above).ravel()) >= 0.0)
    assert np.all(np.diff(FIXED.floats(m.below).ravel()) <= 0.0)
    assert FIXED.floats(m.below).min() < 1e-7
