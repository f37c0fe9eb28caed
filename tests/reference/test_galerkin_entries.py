"""A sample of the Galerkin matrices against double integrals of the elliptic kernels.

The oracle, `projection_oracle`, is itself checked on exact entries below. Some hundred entries of
meshes that the solver uses, with 25 digits, are in validation/results/projections.md.

Every entry must agree to 1e-14 of ``sqrt(A_ii A_jj)``, the scale of the Cholesky factor.
"""

from itertools import product

import numpy as np
import pytest
from numpy.testing import assert_array_equal
from oracles.kept import Kept
from oracles.projection_cases import TAIL, interior_slip, lift_case
from oracles.projection_oracle import Piece, basis, entries, kernels, mp, rows
from oracles.whole_spaces import ordered, whole_space

from spectral_contact.spectral.panels import DiscreteSpace, LogPanels

TRUTHS = Kept("galerkin_entries", every=16)


def said(key, matrices):
    """Return the matrices that the oracle says, as doubles."""
    return [np.array(one) for one in TRUTHS(key, lambda: [m.tolist() for m in matrices()])]


# --- the oracle against exact values --------------------------------------------------------------


@pytest.mark.parametrize("s", ["1e-6", "0.3", "0.9", "0.999999"])
@pytest.mark.parametrize("eta", ["0.2", "0.95"])
def test_kernels_are_the_complete_elliptic_integrals(s, eta):
    s, eta = mp.mpf(s), mp.mpf(eta)
    lo, hi = min(s, eta), max(s, eta)
    k1, k2 = kernels((1 - s**2, s**2), (1 - eta**2, eta**2))
    m = (lo / hi) ** 2
    assert abs(k1 * hi / mp.ellipk(m) - 1) < 1e-22
    assert abs(k2 / hi - (mp.ellipk(m) - mp.ellipe(m))) < 1e-22


def test_oracle_has_the_exact_eigenvalues():
    # P_l(sqrt y)/sqrt y: eigenvalues pi/4 and pi/16 of N for l = 0, 2; s/sqrt y: pi/8 of T
    def functions(d):
        return [1 / mp.sqrt(d), (3 * d - 1) / (2 * mp.sqrt(d))]

    centre, edge = Piece(mp.exp(-2), 1, functions), Piece(0, mp.exp(-2), functions)
    pairs = (centre, centre), (centre, edge), (edge, edge)
    blocks = TRUTHS(
        "eigenvalues", lambda: [[m.tolist() for m in entries(*pair)] for pair in pairs], mp.mpf
    )
    blocks = ([mp.matrix(matrix) for matrix in block] for block in blocks)
    normal, tangential = (a + b + b.T + c for a, b, c in zip(*blocks, strict=True))
    assert abs(normal[0, 0] - mp.pi / 4) < 1e-18
    assert abs(normal[0, 1]) < 1e-18
    assert abs(normal[1, 1] - mp.pi / 16 / 5) < 1e-18
    assert abs(tangential[0, 0] - mp.pi / 8 * 2 / 3) < 1e-18


# --- the library against the oracle ---------------------------------------------------------------

KINDS = "normal", "tangential"
PLAIN = LogPanels(6, 2.0, 12)
FINE = LogPanels(4, 2.0, 20)
COARSE = LogPanels(3, 2.0, 7)
SINGULAR = LogPanels(3, 2.0, 8, power=-0.5)
ROOT = LogPanels(3, 2.0, 12, root_tail=True)
SINGULAR_ROOT = LogPanels(3, 2.0, 12, power=-0.5, root_tail=True)

#: panels; number of the panel and degrees of its functions, twice
SAMPLE = {
    "same panel": (PLAIN, 1, (0, 12), 1, (0, 12)),
    "same panel, degree 20": (FINE, 2, (20,), 2, (20,)),
    "same panel, degree 7": (COARSE, 1, (7,), 1, (7,)),
    "central, degree 7": (COARSE, 0, (7,), 0, (7,)),
    "neighbours": (PLAIN, 1, (0, 12), 2, (0, 12)),
    "far": (PLAIN, 1, (0, 12), 4, (0, 12)),
    "central": (PLAIN, 0, (0, 12), 0, (0, 12)),
    "central and its neighbour": (PLAIN, 0, (0, 12), 1, (0, 12)),
    "central and tail": (PLAIN, 0, (0, 12), TAIL, (0, 2)),
    "last and tail": (PLAIN, 5, (0, 12), TAIL, (0, 2)),
    "tail": (PLAIN, TAIL, (0, 2), TAIL, (0, 2)),
    "weight, central": (SINGULAR, 0, (0, 8), 0, (0, 8)),
    "weight, last and tail": (SINGULAR, 2, (0, 8), TAIL, (0, 2)),
    "weight, tail": (SINGULAR, TAIL, (0, 2), TAIL, (0, 2)),
    "root tail": (ROOT, TAIL, (0, 8), TAIL, (0, 8)),
    "last and root tail": (ROOT, 2, (0, 12), TAIL, (0, 8)),
    "weight and root tail": (SINGULAR_ROOT, TAIL, (0, 8), TAIL, (0, 8)),
    "last and root tail, weight": (SINGULAR_ROOT, 2, (0, 12), TAIL, (0, 8)),
}


@pytest.mark.parametrize("name", SAMPLE)
def test_gram_entries(name):
    panels, first, first_degrees, second, second_degrees = SAMPLE[name]
    one = basis(panels, first, first_degrees)
    two = one if first == second else basis(panels, second, second_degrees)
    index = rows(panels, first, first_degrees), rows(panels, second, second_degrees)
    truths = said(name, lambda: entries(one, two))
    for kind, exact in zip(KINDS, truths, strict=True):
        space = whole_space(panels, kind)
        gram = ordered(space, space.gram)
        scale = np.sqrt(gram.diagonal())
        difference = gram[np.ix_(*index)] - exact
        relative = difference / np.outer(scale[index[0]], scale[index[1]])
        assert np.abs(relative).max() <= 1e-14


@pytest.mark.parametrize("kind", ["plain", "root tail"])
@pytest.mark.parametrize("number", [0, 2, TAIL])
def test_mass_entries(kind, number):
    panels = PLAIN if kind == "plain" else ROOT
    last = panels.degree if number >= 0 else panels.tail_terms - 1
    degrees = (0, 1, last)
    piece = basis(panels, number, degrees)
    index = rows(panels, number, degrees)
    # s ds = dd/2; the traction is s psi, hence one more s^2 = 1 - d
    for extra, one in enumerate(KINDS):
        space = whole_space(panels, one)
        mass = ordered(space, space.mass)

        def entry(k, m, extra=extra):
            def integrand(d):
                values = piece.functions(d)
                return values[k] * values[m] * (1 - d) ** extra / 2

            return mp.quad(integrand, [piece.low, piece.high])

        truths = TRUTHS(
            f"mass, {kind}, {number}, {extra}",
            lambda e=entry: [e(*pair) for pair in product(range(3), repeat=2)],
        )
        exact, scale = np.reshape(truths, (3, 3)), np.sqrt(mass.diagonal()[index])
        assert np.all(abs(mass[np.ix_(index, index)] - exact) <= 1e-14 * np.outer(scale, scale))


def test_mass_is_block_diagonal():
    owner = np.minimum(np.arange(PLAIN.size) // (PLAIN.degree + 1), PLAIN.count)
    apart = owner[:, None] != owner
    for kind in KINDS:
        space = whole_space(PLAIN, kind)
        mass = ordered(space, space.mass)
        assert_array_equal(mass[apart], 0.0)
        assert np.all(mass.diagonal() > 0.0)


# --- what the solver builds from them -------------------------------------------------------------

COARSE = DiscreteSpace(LogPanels(4, 2.0, 8), (8, 8, 6, 4))


def largest_difference(name, case):
    truths = said(name, lambda: [case.exact(1)[kernel] for kernel in case.doubles])
    return max(
        np.abs((block - exact) / np.outer(*scales)).max()
        for exact, (block, *scales) in zip(truths, case.doubles.values(), strict=True)
    )


def test_right_hand_side_of_the_lift():
    assert largest_difference("lift", lift_case(COARSE, 5e-3, 2)) <= 1e-14


ANNULUS = {
    "same": ((0, 1), (0, 1)),
    "halves": ((0, 1), (1, 2)),
    "both tails": ((0, TAIL), (1, TAIL)),
}


@pytest.mark.parametrize("name", ANNULUS)
def test_annulus_entries(name):
    case = interior_slip().annulus_case(*ANNULUS[name])
    assert largest_difference(f"annulus, {name}", case) <= 1e-14


@pytest.mark.parametrize(("number", "other"), [(0, (0, 0)), (TAIL, (0, TAIL))])
def test_disk_and_annulus_entries(number, other):
    case = interior_slip().cross_case(number, other)
    assert largest_difference(f"disk and annulus, {number}", case) <= 1e-14
