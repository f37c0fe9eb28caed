"""Abel integrals as their value at a boundary and a difference to it."""

from itertools import product

import numpy as np
import pytest

from spectral_contact.fields import EDGE, Radius
from spectral_contact.spectral.annulus import Family, Points, gap
from spectral_contact.spectral.from_boundary import half_integrals, inner_integrals, node_rule
from spectral_contact.spectral.panels import LogPanels

FIRST, SECOND = Radius.from_logit(-1.0), Radius.from_logit(8.0)
COUNT, DEGREE = 14, 16


def families(power=0.0):
    """Return the halves of a disk and two annuli to the edge, the last with an endpoint weight."""
    panels = LogPanels(COUNT, 2.0, DEGREE)
    wide, narrow = gap(FIRST, SECOND) / 2.0, gap(SECOND, EDGE) / 2.0
    return [
        Family(FIRST, -1, FIRST.square, panels),
        Family(FIRST, 1, wide, panels),
        Family(SECOND, -1, wide, panels),
        Family(SECOND, 1, narrow, panels),
        Family(EDGE, -1, narrow, LogPanels(COUNT, 2.0, DEGREE, power)),
    ]


def scale(matrix):
    """Return the largest entry of every panel, for each of its functions."""
    largest = np.abs(matrix).max(axis=0)
    panels = largest[: COUNT * (DEGREE + 1)].reshape(COUNT, -1).max(axis=1)
    rest = largest[COUNT * (DEGREE + 1) :]
    return np.concatenate([np.repeat(panels, DEGREE + 1), np.full(len(rest), rest.max())])


@pytest.mark.parametrize("power", [0.0, -0.5])
@pytest.mark.parametrize(("i", "k"), list(product(range(5), range(5))))
def test_they_are_the_integrals_of_the_families(i, k, power):
    nodes, family = families(power)[i], families(power)[k]
    rule = node_rule(nodes.panels, (12,) * COUNT)
    points = nodes.points(rule.d)
    # next to the far end all is as near to it as the last digit of d says
    allowed = (1e-13 + 2e-16 / np.sqrt(rule.nodes.rest))[:, None]
    for integrals, reference in (
        (half_integrals, family.half_integral),
        (inner_integrals, family.inner_integral),
    ):
        seen = integrals(family, nodes, rule)
        if seen is None:
            assert not reference(points).any()
            continue
        known = reference(points)
        assert (np.abs(seen.whole - known) <= allowed * scale(known)).all()
        assert (np.abs(seen.at + seen.more - known) <= allowed * scale(known)).all()


@pytest.mark.parametrize(("i", "k"), [(0, 2), (1, 4), (2, 0), (3, 1), (1, 2), (2, 1), (2, 4)])
def test_differences_keep_their_digits_next_to_the_boundary(i, k):
    nodes, family = families()[i], families()[k]
    rule = node_rule(nodes.panels, (12,) * COUNT)
    outside = k > i
    seen = (half_integrals if outside else inner_integrals)(family, nodes, rule)
    # of a point source, from the sum and not from the difference
    d = rule.d[rule.d < 1e-6]
    z = nodes.sign * nodes.reach * d
    sources, matrix = family.sources()
    apart = np.abs(sources.before(nodes.boundary))[None]
    moved = apart - z[:, None] if outside else apart + z[:, None]
    closer = z[:, None] if outside else -z[:, None]
    kernel = closer / (np.sqrt(apart * moved) * (np.sqrt(apart) + np.sqrt(moved)))
    known = kernel @ matrix
    assert (np.abs(seen.more[rule.d < 1e-6] - known) <= 1e-12 * scale(known)).all()
    assert isinstance(sources, Points)
