"""Half-integrals and quadrature on annuli, against mpmath with the distances taken exactly."""

import numpy as np
import pytest
from mpmath.ctx_mp import MPContext
from numpy.testing import assert_allclose, assert_array_equal
from oracles.mesh_integrals import half_integral, inner_integral
from scipy.special import eval_legendre

from spectral_contact.fields.series import Radius
from spectral_contact.spectral.abel import moments_on
from spectral_contact.spectral.annulus import Annulus
from spectral_contact.spectral.panels import LogPanels
from spectral_contact.spectral.parts import GradedMesh, OffsetRadii, z_difference
from spectral_contact.spectral.transforms import sampled_series, series_of

mp = MPContext()
mp.dps = 40

PANELS = LogPanels(12, 1.0, 14), LogPanels(9, 2.0, 20)

#: wide; a thousandth; a billionth; close to the edge; close to the centre; all but the whole disk
ANNULI = {
    "wide": (Radius(0.25, 0.75), Radius(0.75, 0.25)),
    "thin": (Radius(0.75, 0.25), Radius(0.75 + 2.0**-10, 0.25 - 2.0**-10)),
    "very thin": (Radius(0.75, 0.25), Radius(0.75 + 2.0**-30, 0.25 - 2.0**-30)),
    "edge": (Radius(1 - 1e-9, 1e-9), Radius(1.0, 1e-17)),
    "centre": (Radius(1e-7, 1 - 1e-7), Radius(3e-7, 1 - 3e-7)),
    "whole": (Radius(1e-12, 1 - 1e-12), Radius(1 - 1e-14, 1e-14)),
}


def square(radius):
    """Return ``b^2`` as the library means it: by the smaller of b and 1 - b."""
    b = 1 - mp.mpf(radius.from_edge) if radius.value >= 0.5 else mp.mpf(radius.value)
    return b**2


@pytest.fixture(params=ANNULI.values(), ids=ANNULI.keys())
def annulus(request):
    return Annulus(*request.param, *PANELS)


# --- distances ------------------------------------------------------------------------------------


def test_gap_has_no_cancellation():
    radii = [r for pair in ANNULI.values() for r in pair]
    for a in radii:
        for b in radii:
            assert_allclose(z_difference(a, b), float(square(b) - square(a)), rtol=5e-16)
    assert z_difference(Radius(0.3, 0.7), Radius(0.3, 0.7)) == 0.0


def test_the_gap_from_the_centre_is_the_square_to_the_bit():
    """Where they are an ulp apart, distances from the centre lose half their digits."""
    values = np.append(np.random.default_rng(3).random(2000), 0.9978117057773813)
    for value in values.tolist():
        b = Radius(value, 1.0 - value)
        assert z_difference(Radius(0.0, 1.0), b) == b.square


def test_points_keep_the_digits_of_their_offsets():
    anchor, boundary = Radius(0.75, 0.25), Radius(0.75 + 2.0**-40, 0.25 - 2.0**-40)
    offsets = np.array([-1e-3, 0.0, 1e-30, 2.0**-41])
    points = OffsetRadii(anchor, offsets)
    assert_array_equal(points.before(anchor), -offsets)
    exact = [float(square(boundary) - square(anchor) - mp.mpf(o)) for o in offsets]
    assert_allclose(points.before(boundary), exact, rtol=4e-16)
    assert_allclose(points.z, 0.75**2 + offsets, rtol=1e-15)
    assert_allclose(points.z + points.y, 1.0, rtol=3e-16)
    edge = OffsetRadii(Radius(1 - 1e-14, 1e-14), np.array([0.0, -1e-15]))
    assert_allclose(edge.y, [2e-14, 2.1e-14], rtol=1e-14)


def test_meshes_meet_in_the_middle(annulus):
    inner, outer = annulus.meshes
    assert (inner.sign, outer.sign) == (1, -1)
    assert inner.extent == outer.extent
    assert_allclose(2 * inner.extent, z_difference(annulus.inner, annulus.outer), rtol=1e-15)
    ends = inner.points(np.array([0.0, 1.0])), outer.points(np.array([0.0, 1.0]))
    assert_array_equal(ends[0].before(annulus.inner), [0.0, -inner.extent])
    assert_array_equal(ends[1].before(annulus.outer), [0.0, outer.extent])
    assert (inner.panels, outer.panels) == PANELS


# --- half-integrals -------------------------------------------------------------------------------


def function(u):
    """A function on the annulus; u goes from 0 to 1 with s^2."""
    return 1 + 3 * u - 2 * u * u


def expansion(annulus):
    return np.concatenate(
        [f.expand(one) for f, one in zip(annulus.meshes, sampled(annulus), strict=True)]
    )


def sampled(annulus):
    inner, outer = annulus.meshes
    return [
        function(inner.sampling().offset / (2 * inner.extent)),
        function(1 + outer.sampling().offset / (2 * outer.extent)),
    ]


OFFSETS = np.array([1e-200, 1e-30, 1e-12, 1e-5, 0.01, 0.2, 0.4999, 0.5, 0.5001, 0.6, 0.9])


def sample(annulus):
    """Return points inside, next to the ends from both sides, and outside."""
    width = z_difference(annulus.inner, annulus.outer)
    room = float(square(annulus.inner)) / width  # towards the centre
    beyond = np.array([1e-200, 1e-30, 1e-12, 1e-3, 0.5, 3.0, 1e4, 1e9])
    below = beyond[beyond < room]
    above = beyond[beyond < float(1 - square(annulus.outer)) / width]
    return [
        OffsetRadii(annulus.inner, width * np.concatenate([-below, [0.0], OFFSETS])),
        OffsetRadii(annulus.outer, width * np.concatenate([above, [0.0], -OFFSETS])),
    ]


def exact_integral(annulus, points, below):
    """Return ``1/2 int f dz / sqrt|z - t^2|`` over z > t^2, or with `below` over z < t^2."""
    low, high, anchor = (square(r) for r in (annulus.inner, annulus.outer, points.anchor))
    width = high - low
    values = []
    for offset in points.offset:
        past_low = (anchor - low + mp.mpf(offset)) / width
        to_high = (high - anchor - mp.mpf(offset)) / width
        if below:
            ends, sign = (max(-to_high, 0), past_low), -1
        else:
            ends, sign = (max(-past_low, 0), to_high), 1
        if ends[1] <= 0:
            values.append(0.0)
            continue
        # in w = sqrt|z - t^2|, and on the unit interval, for the ends may be close or tiny
        start = mp.sqrt(ends[0])
        span = (ends[1] - ends[0]) / (start + mp.sqrt(ends[1]))

        def integrand(v, start=start, span=span, past=past_low, sign=sign):
            return function(past + sign * (start + span * v) ** 2)

        values.append(float(mp.sqrt(width) * span * mp.quad(integrand, [0, 1])))
    return np.array(values)


@pytest.mark.parametrize("side", [0, 1], ids=["anchored inside", "anchored outside"])
def test_half_integral(annulus, side):
    points = sample(annulus)[side]
    matrix = np.hstack([half_integral(mesh, points) for mesh in annulus.meshes])
    assert len(matrix) == len(points.offset)
    exact = exact_integral(annulus, points, below=False)
    assert np.count_nonzero(exact) > 5
    assert_allclose(matrix @ expansion(annulus), exact, rtol=1e-14)


@pytest.mark.parametrize("side", [0, 1], ids=["anchored inside", "anchored outside"])
def test_inner_integral(annulus, side):
    points = sample(annulus)[side]
    matrix = np.hstack([inner_integral(mesh, points) for mesh in annulus.meshes])
    exact = exact_integral(annulus, points, below=True)
    assert np.count_nonzero(exact) > 5
    assert_allclose(matrix @ expansion(annulus), exact, rtol=1e-14)


def test_nothing_comes_from_the_far_side(annulus):
    width = z_difference(annulus.inner, annulus.outer)
    past = np.array([0.0, 1e-30, 0.1])
    for mesh in annulus.meshes:
        assert not np.any(half_integral(mesh, OffsetRadii(annulus.outer, width * past)))
        assert not np.any(inner_integral(mesh, OffsetRadii(annulus.inner, -width * past)))


def test_own_integrals_are_those_at_the_sampling_points(annulus):
    values, few = sampled(annulus), slice(None, None, 17)
    for side in (1, -1):
        found = annulus.integrals(values, side)
        for mesh, own in zip(annulus.meshes, found, strict=True):
            points = mesh.sampling()
            assert len(own) == len(points.offset)
            chosen = OffsetRadii(points.anchor, points.offset[few])
            exact = exact_integral(annulus, chosen, below=side < 0)
            assert_allclose(own[few], exact, rtol=1e-14)


# --- quadrature -----------------------------------------------------------------------------------


FAMILIES = pytest.mark.parametrize(
    "mesh",
    [
        GradedMesh(Radius(0.75, 0.25), 1, 0.25, LogPanels(5, 1.0, 10)),
        GradedMesh(Radius(0.75, 0.25), -1, 0.25, LogPanels(3, 2.0, 14)),
        GradedMesh(Radius(0.75, 0.25), -1, 0.25, LogPanels(4, 1.0, 6)),
        GradedMesh(Radius(1 - 1e-9, 1e-9), -1, 1e-7, LogPanels(3, 1.0, 20)),
    ],
    ids=["above", "below", "degree 6", "edge"],
)


def basis(mesh):
    """Return (column, function of the scaled distance, its interval) for some of the basis."""
    p = mesh.panels
    h, end = mp.mpf(p.width), mp.exp(-p.count * mp.mpf(p.width))
    chosen = []
    for j in {0, p.count - 1}:
        for k in {0, 1, p.degree}:
            chosen.append(
                (
                    j * (p.degree + 1) + k,
                    lambda d, j=j, k=k: mp.legendre(k, -2 * mp.log(d) / h - 2 * j - 1),
                    (mp.exp(-h * (j + 1)), mp.exp(-h * j)),
                )
            )
    for k in range(p.tail_terms):
        column = p.count * (p.degree + 1) + k
        chosen.append((column, lambda d, k=k: mp.legendre(k, 2 * d / end - 1), (mp.mpf(0), end)))
    return chosen


@FAMILIES
def test_moments_with_smooth_densities(mesh):
    moments = moments_on(mesh.panels, (mesh.panels.degree,) * mesh.panels.count)
    points = mesh.points(moments.d)
    base, reach = square(mesh.boundary), mp.mpf(mesh.extent)
    for column, polynomial, ends in basis(mesh):
        for m in (0, 2):

            def integrand(d, polynomial=polynomial, m=m):
                return reach / 2 * polynomial(d) * (base + mesh.sign * reach * d) ** m

            exact = float(mp.quad(integrand, mp.linspace(*ends, 4)))
            scale = mesh.extent / 2 * float(ends[1] - ends[0])
            found = mesh.extent * moments.with_densities(points.z[None] ** m)
            assert abs(found[0, column] - exact) < 4e-15 * scale


# --- series ---------------------------------------------------------------------------------------


def test_expansion_and_series_are_inverse():
    mesh = GradedMesh(Radius(0.75, 0.25), 1, 0.25, LogPanels(6, 1.0, 16))
    d = mesh.sampling().offset / mesh.extent
    coefficients = mesh.expand(function(d))
    assert coefficients.shape == (mesh.panels.size,)
    series = series_of(mesh.panels, coefficients)
    assert series.coefficients.shape == (6, 17)
    for d in (np.geomspace(1e-9, 1, 50), np.array([0.0]), np.exp(-np.arange(7.0))):
        assert_allclose(series(d), function(d), rtol=1e-14)


def test_unresolved_looks_at_the_last_coefficients():
    mesh = GradedMesh(Radius(0.75, 0.25), 1, 0.25, LogPanels(3, 1.0, 6))
    coefficients = np.zeros(mesh.panels.size)
    coefficients[[0, 7, 14, 15]] = 5.0  # low degrees of every panel
    coefficients[7 + 4] = -0.25
    assert mesh.unresolved(series_of(mesh.panels, coefficients)) == 0.25
    coefficients[-1] = -7.0  # the tail
    assert mesh.unresolved(series_of(mesh.panels, coefficients)) == 7.0


def test_truncated_is_what_expand_drops():
    mesh = GradedMesh(Radius(0.75, 0.25), 1, 0.25, LogPanels(3, 1.0, 6))
    d = mesh.sampling().offset / mesh.extent
    inside = -np.log(d) < 3.0
    # Legendre polynomials of the panel coordinate, one within the basis and one beyond it
    kept, dropped = (eval_legendre(n, 2.0 * (-np.log(d) % 1.0) - 1.0) * inside for n in (6, 7))
    second = (d < np.exp(-1.0)) & (d > np.exp(-2.0))
    assert mesh.truncated(kept, 0.0) < 1e-14
    assert_allclose(mesh.truncated(kept - 3.0 * dropped, 0.0), 3.0)
    assert_allclose(mesh.truncated(dropped * second, 0.5), np.exp(-0.5))


def test_sampled_series_takes_more_points_than_the_basis():
    panels = LogPanels(8, 1.0, 14)
    d = np.concatenate([np.exp(-panels.sampling()).ravel(), panels.tail_sampling()])
    series = sampled_series(panels, d**0.5 * np.cos(d))
    assert series.coefficients.shape == (8, panels.sampling().shape[1])
    inside = np.geomspace(1.1 * panels.end, 1, 40)
    assert_allclose(series(inside), inside**0.5 * np.cos(inside), rtol=1e-13)
    assert_allclose(
        sampled_series(panels, np.exp(-d))(np.array([0.0, panels.end / 3])),
        np.exp([0.0, -panels.end / 3]),
        rtol=1e-14,
    )
