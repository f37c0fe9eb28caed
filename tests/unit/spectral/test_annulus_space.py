"""What is kept of an annulus and reused at any scale, against the same computed there directly."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from spectral_contact.contact.stick_annuli import StickAnnuli
from spectral_contact.fields.series import Radius
from spectral_contact.spectral.annulus import Annulus, Points, gap
from spectral_contact.spectral.annulus_space import annulus_space
from spectral_contact.spectral.galerkin import disk_operators
from spectral_contact.spectral.panels import LogPanels

INNER, OUTER = LogPanels(3, 2.0, 8), LogPanels(5, 2.0, 8)
DEGREES = ((8, 6, 3), (8, 7, 5, 4, 2))
ENDS = {
    "wide": (Radius(0.3, 0.7), Radius(0.8, 0.2)),
    "central": (Radius(1e-9, 1 - 1e-9), Radius(1e-8, 1 - 1e-8)),
    "to the edge": (Radius(1 - 1e-6, 1e-6), Radius(1.0, 0.0)),
}


@pytest.fixture(params=ENDS.values(), ids=ENDS)
def annulus(request):
    return Annulus(*request.param, INNER, OUTER)


@pytest.fixture(scope="module")
def space():
    return annulus_space(INNER, OUTER, DEGREES)


def half_integral(annulus, space, points):
    """Return the half-integrals as the annulus computes them, in the unit of the space."""
    scale = np.sqrt(gap(annulus.inner, annulus.outer) / 2.0)
    return annulus.half_integral(points)[:, space.columns] / scale


def test_the_functions_in_use(space):
    terms = [*DEGREES[0], *DEGREES[1]]
    assert len(space.columns) == sum(terms) + len(terms) + INNER.tail_terms + OUTER.tail_terms
    assert (np.diff(space.columns) > 0).all()
    assert space is annulus_space(INNER, OUTER, DEGREES)


@pytest.mark.parametrize("half", [0, 1])
def test_half_integrals_at_own_nodes(annulus, space, half):
    points, weights = annulus.families[half].nodes()
    d, unit_weights, matrix = space.nodes[half]
    assert_allclose(annulus.families[half].reach * unit_weights, weights, rtol=1e-15)
    assert_allclose(annulus.families[half].points(d).offset, points.offset, rtol=1e-15)
    direct = half_integral(annulus, space, points)
    unseen = direct.shape[1] - matrix.shape[1]
    assert (unseen > 0) == (half == 1)
    assert not direct[:, :unseen].any()
    assert_allclose(matrix, direct[:, unseen:], rtol=0, atol=1e-13 * np.abs(direct).max())


def test_half_integrals_past_the_inner_end(annulus, space):
    half = gap(annulus.inner, annulus.outer) / 2.0
    reach = annulus.inner.square / half
    for share in (1.0, 0.3, 1e-3, 1e-9):
        e, weights, matrix = space.outside_rule(share * reach)
        assert e.max() < share * reach
        direct = half_integral(annulus, space, Points(annulus.inner, -half * e))
        assert_allclose(matrix, direct, rtol=0, atol=1e-14 * np.abs(direct).max())
        # 1/(1 + e) and its root are as singular as half-integrals
        assert weights @ (1.0 / (1.0 + e)) == pytest.approx(np.log1p(share * reach), rel=1e-14)
        assert weights @ np.sqrt(e) == pytest.approx((share * reach) ** 1.5 / 1.5, rel=1e-13)


def test_the_half_integral_of_a_function_past_the_inner_end(annulus, space):
    half = gap(annulus.inner, annulus.outer) / 2.0
    reach = annulus.inner.square / half
    values = np.random.default_rng(2).normal(size=len(space.columns))
    e = reach * np.geomspace(1e-12, 1.0, 50)
    direct = half_integral(annulus, space, Points(annulus.inner, -half * e)) @ values
    found = space.outside_function(values, reach)(e)
    assert_allclose(found, direct, rtol=0, atol=1e-13 * np.abs(direct).max())


def test_mass_and_moments(annulus, space):
    mass, moments = space.mass(annulus), space.moments(annulus)
    split = int(np.searchsorted(space.columns, INNER.size))
    parts = slice(0, split), slice(split, None)
    assert not mass[parts[0], parts[1]].any()
    for family, part, row, start in zip(
        annulus.families, parts, moments, (0, INNER.size), strict=True
    ):
        columns = space.columns[part] - start
        direct = family.mass(columns)
        scale = np.sqrt(np.outer(direct.diagonal(), direct.diagonal()))
        assert (np.abs(mass[part, part] - direct) <= 1e-14 * scale).all()
        points, matrix = family.sources()
        exact = (np.sqrt(points.z) @ matrix)[columns]
        assert_allclose(row[part], exact, rtol=0, atol=1e-14 * np.abs(exact).max())
        row[part] = 0.0
    assert not moments.any()  # no half has what is the other's


@pytest.mark.parametrize("gap_to_disk", [0.2, 1e-2, 1e-3])
def test_few_places_stand_for_all_sources(gap_to_disk):
    inner, rim = Radius(0.7, 0.3), Radius(0.7 - gap_to_disk, 0.3 + gap_to_disk)
    sticks = StickAnnuli(
        [
            Annulus(inner, Radius(0.8, 0.2), INNER, OUTER),
            Annulus(Radius(0.9, 0.1), Radius(1.0, 0.0), INNER, OUTER),
        ],
        [list(DEGREES), list(DEGREES)],
    )
    disk = LogPanels(6, 2.0, 8)
    falls, shares, at_rim = sticks.falls(disk, rim)
    d = disk_operators(disk).nodes.d
    points = [Points(rim, -rim.square * x) for x in (d, np.zeros(1))]
    inside, end = (
        np.hstack([a.half_integral(p) for a in sticks.annuli])[:, sticks.columns] for p in points
    )
    assert falls.shape[1] < len(sticks.columns) * 3
    assert_allclose(at_rim, end[0], rtol=0, atol=2e-14 * np.abs(end).max())
    assert_allclose(falls @ shares, end - inside, rtol=0, atol=2e-14 * np.abs(end).max())
    # and the fall next to the rim has its own digits
    near = np.argmin(d)
    a = -Points(Radius(0.9, 0.1), np.zeros(1)).before(rim)[0]
    assert np.abs((falls @ shares)[near, -3:]).max() <= d[near] * rim.square / a


def test_two_stick_annuli_see_each_other():
    inner = Annulus(Radius(0.5, 0.5), Radius(0.6, 0.4), INNER, OUTER)
    outer = Annulus(Radius(0.7, 0.3), Radius(1.0, 0.0), INNER, OUTER)
    sticks = StickAnnuli([inner, outer], [list(DEGREES), list(DEGREES)])
    rim = Radius(0.1, 0.9)  # so that the zone inside has points near the centre
    for points, weights, matrix in (
        sticks.at_own_nodes(0, 0),
        sticks.at_own_nodes(1, 1),
        sticks.inside(0, rim),
        sticks.inside(1, inner.outer),
    ):
        assert (weights > 0.0).all()
        direct = np.hstack([a.half_integral(points) for a in sticks.annuli])[:, sticks.columns]
        # where an annulus lies inside a point it has no part in the half-integral there
        unseen = direct.shape[1] - matrix.shape[1]
        assert not direct[:, :unseen].any()
        found, expected = matrix * sticks.extents[unseen:], direct[:, unseen:]
        assert_allclose(found, expected, rtol=0, atol=1e-13 * np.abs(direct).max())
    for own, low, high in ((0, rim, inner.inner), (1, inner.outer, outer.inner)):
        _, weights, _ = sticks.inside(own, low)
        assert weights.sum() == pytest.approx(gap(low, high), rel=1e-14)
