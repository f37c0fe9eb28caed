"""A sample of the Galerkin matrices against double integrals of the elliptic kernels.

The oracle is mpmath with 30 digits and knows nothing of the library: complete elliptic integrals
by the arithmetic-geometric mean (no Abel factorisation), and two-dimensional quadrature that is
split wherever the kernel is not analytic. It is itself checked on exact entries below; doubling
its points moves no entry here by more than 2e-16 of its scale.

Every entry must agree to 1e-14 of ``sqrt(A_ii A_jj)``, the scale of the Cholesky factor.
"""

from functools import lru_cache

import numpy as np
import pytest
from mpmath.ctx_mp import MPContext
from numpy.testing import assert_array_equal

from spectral_contact.spectral.galerkin import disk_operators
from spectral_contact.spectral.panels import LogPanels

mp = MPContext()
mp.dps = 30


# --- the oracle: kernels --------------------------------------------------------------------------


def kernels(p, q):
    """Return K(rho)/hi and hi (K(rho) - E(rho)) at the points ``(d, 1 - d)`` with d = 1 - s^2.

    They are K1 and K2 without the factors of the measure: ``K1 s ds eta deta / eta`` and so on.
    """
    (d, z), (e, w) = p, q
    hi2 = max(z, w)
    gap = abs(d - e) if hi2 > 0.5 else abs(z - w)
    a, b = mp.mpf(1), mp.sqrt(gap / hi2)
    # 1 - E/K = sum 2^(n-1) c_n^2 with c_0 = rho, DLMF 19.8.6
    loss, power = min(z, w) / hi2 / 2, mp.mpf(1) / 2
    while True:
        c = (a - b) / 2
        power *= 2
        a, b = a - c, mp.sqrt(a * b)
        loss += power * c * c
        if power * c * c < 1e-15:  # convergence is quadratic: the next term is below 1e-30
            break
    first_kind = mp.pi / (a + b)
    hi = mp.sqrt(hi2)
    return first_kind / hi, hi * first_kind * loss


# --- the oracle: one-dimensional rules on [0, 1] --------------------------------------------------


@lru_cache
def gauss(points):
    rule = []
    for k in range(points):
        x = mp.cos(mp.pi * (k + 0.75) / (points + 0.5))
        for _ in range(6):
            before, value = mp.mpf(1), x
            for m in range(2, points + 1):
                before, value = value, ((2 * m - 1) * x * value - (m - 1) * before) / m
            slope = points * (before - x * value) / (1 - x * x)
            x -= value / slope
        rule.append(((1 + x) / 2, 1 / ((1 - x * x) * slope**2)))
    return rule


@lru_cache
def double_exponential(per_unit):
    """``v = (1 + tanh(sinh(t) / 2)) / 2``: dense in the middle, for high degrees with a log."""
    count = int(mp.ceil(mp.asinh(20 * mp.log(10)) * per_unit))
    rule = []
    for k in range(-count, count + 1):
        t = mp.mpf(k) / per_unit
        z = mp.exp(mp.sinh(t))
        rule.append((z / (1 + z), mp.cosh(t) * z / (1 + z) ** 2 / per_unit))
    return rule


# --- the oracle: panels and double integrals ------------------------------------------------------


class Piece:
    """Functions of ``d`` on ``[low, high]``, in a coordinate v of [0, 1] in which all is analytic.

    v is 0 at the centre of the disk on the piece that touches it (high = 1), 0 at the edge on the
    piece that touches that (low = 0), and 0 at the shallow end of any other.
    """

    def __init__(self, low, high, functions, density=(8, 8)):
        self.low, self.high, self.functions = mp.mpf(low), mp.mpf(high), functions
        self.density = density
        self.central, self.tail = self.high == 1, self.low == 0
        self.at = lru_cache(self._at)  # rules run over one coordinate while the other stays

    def _at(self, v):
        """Return ``(d, 1 - d)`` and the functions times dd/dv."""
        if self.tail:
            d, jacobian = self.high * v * v, 2 * self.high * v
            return (d, 1 - d), [jacobian * f(d) for f in self.functions]
        span = mp.log(self.high / self.low)
        rest = -mp.expm1(-span * (v * v if self.central else v))
        d = self.high * (1 - rest)
        jacobian = span * d * (2 * v if self.central else 1)
        return (d, 1 - self.high + self.high * rest), [jacobian * f(d) for f in self.functions]


def nodes(one, two):
    """Yield points and weights of the square; of the triangle alone if the pieces are the same."""
    if one is two and (one.central or one.tail):  # singular at v = 0 and where the ratio is 1
        radial, angular = one.density
        for v, weight in double_exponential(radial):
            for ratio, other in double_exponential(angular):
                yield v, v * ratio, weight * other * v
    elif one is two:  # singular on the diagonal
        for u, weight in double_exponential(12):
            for c, other in gauss(36):
                yield c * (1 - u) + u, c * (1 - u), weight * other * (1 - u)
    elif one.low == two.high:  # singular at the common corner
        for v, weight in double_exponential(10):
            for ratio, other in gauss(24):
                for a, b in ((v, v * ratio), (v * ratio, v)):
                    yield 1 - a, (1 - b if two.tail else b), weight * other * v
    else:
        for v, weight in gauss(28):
            for w, other in gauss(28):
                yield v, w, weight * other


def entries(one, two):
    """Return ``<phi, N psi>`` and ``<s phi, T s psi>`` for all phi of `one` and psi of `two`."""
    shape = len(one.functions), len(two.functions)
    normal, tangential = mp.zeros(*shape), mp.zeros(*shape)
    for v, w, weight in nodes(one, two):
        p, phi = one.at(v)
        q, psi = two.at(w)
        k1, k2 = kernels(p, q)
        k1, k2 = k1 * weight, k2 * weight
        for i, x in enumerate(phi):
            for j, y in enumerate(psi):
                normal[i, j] += x * y * k1
                tangential[i, j] += x * y * k2
    if one is two:
        normal, tangential = normal + normal.T, tangential + tangential.T
    return normal / (4 * mp.pi), tangential / (4 * mp.pi)


def legendre(degree):
    coefficients = [
        (-1) ** m * mp.binomial(degree, m) * mp.binomial(2 * degree - 2 * m, degree) / 2**degree
        for m in range(degree // 2 + 1)
    ]

    def polynomial(x):
        square, value = x * x, coefficients[0]
        for c in coefficients[1:]:
            value = value * square + c
        return value * x if degree % 2 else value

    return polynomial


def basis(panels, number, degrees):
    """Return panel `number` (-1: the tail) with the basis functions of these degrees."""
    width, power = mp.mpf(panels.width), mp.mpf(panels.power)

    def function(degree):
        polynomial = legendre(degree)

        def on_panel(d):
            return polynomial(-2 * mp.log(d) / width - 2 * number - 1)

        def on_tail(d):
            return polynomial(2 * (mp.sqrt(d / end) if panels.root_tail else d / end) - 1)

        plain = on_tail if number < 0 else on_panel
        return plain if power == 0 else lambda d: d**power * plain(d)

    end = mp.exp(-panels.panels * width)
    if number < 0:
        return Piece(0, end, [function(k) for k in degrees])
    ends = mp.exp(-width * (number + 1)), mp.exp(-width * number)
    density = (14, 10) if max(degrees) > 8 else (10, 8)
    return Piece(*ends, [function(k) for k in degrees], density)


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
    functions = [lambda d: 1 / mp.sqrt(d), lambda d: (3 * d - 1) / (2 * mp.sqrt(d))]
    centre, edge = Piece(mp.exp(-2), 1, functions), Piece(0, mp.exp(-2), functions)
    blocks = entries(centre, centre), entries(centre, edge), entries(edge, edge)
    normal, tangential = (a + b + b.T + c for a, b, c in zip(*blocks, strict=True))
    assert abs(normal[0, 0] - mp.pi / 4) < 1e-18
    assert abs(normal[0, 1]) < 1e-18
    assert abs(normal[1, 1] - mp.pi / 16 / 5) < 1e-18
    assert abs(tangential[0, 0] - mp.pi / 8 * 2 / 3) < 1e-18


# --- the library against the oracle ---------------------------------------------------------------

PLAIN = LogPanels(6, 2.0, 12)
FINE = LogPanels(4, 2.0, 20)
SINGULAR = LogPanels(3, 2.0, 8, power=-0.5)
ROOT = LogPanels(3, 2.0, 12, root_tail=True)
SINGULAR_ROOT = LogPanels(3, 2.0, 12, power=-0.5, root_tail=True)
TAIL = -1

#: panels; number of the panel and degrees of its functions, twice
SAMPLE = {
    "same panel": (PLAIN, 1, (0, 12), 1, (0, 12)),
    "same panel, degree 20": (FINE, 2, (20,), 2, (20,)),
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


def rows(panels, number, degrees):
    number = panels.panels if number < 0 else number
    return [number * (panels.degree + 1) + k for k in degrees]


@pytest.mark.parametrize("case", SAMPLE.values(), ids=SAMPLE.keys())
def test_gram_entries(case):
    panels, first, first_degrees, second, second_degrees = case
    one = basis(panels, first, first_degrees)
    two = one if first == second else basis(panels, second, second_degrees)
    disk = disk_operators(panels)
    index = rows(panels, first, first_degrees), rows(panels, second, second_degrees)
    for operator, exact in zip((disk.normal, disk.tangential), entries(one, two), strict=True):
        scale = np.sqrt(operator.gram.diagonal())
        difference = operator.gram[np.ix_(*index)] - np.array(exact.tolist(), dtype=float)
        relative = difference / np.outer(scale[index[0]], scale[index[1]])
        assert np.abs(relative).max() <= 1e-14


@pytest.mark.parametrize("panels", [PLAIN, ROOT], ids=["plain", "root tail"])
@pytest.mark.parametrize("number", [0, 2, TAIL])
def test_mass_entries(panels, number):
    last = panels.degree if number >= 0 else panels.tail_terms - 1
    degrees = (0, 1, last)
    piece = basis(panels, number, degrees)
    index = rows(panels, number, degrees)
    disk = disk_operators(panels)
    # s ds = dd/2; the traction is s psi, hence one more s^2 = 1 - d
    for mass, extra in ((disk.normal.mass, 0), (disk.tangential.mass, 1)):
        scale = np.sqrt(mass.diagonal())
        for i, f in zip(index, piece.functions, strict=True):
            for j, g in zip(index, piece.functions, strict=True):
                exact = mp.quad(
                    lambda d, f=f, g=g, extra=extra: f(d) * g(d) * (1 - d) ** extra / 2,
                    [piece.low, piece.high],
                )
                assert abs(mass[i, j] - float(exact)) <= 1e-14 * scale[i] * scale[j]


def test_mass_is_block_diagonal():
    owner = np.minimum(np.arange(PLAIN.size) // (PLAIN.degree + 1), PLAIN.panels)
    apart = owner[:, None] != owner
    disk = disk_operators(PLAIN)
    for mass in (disk.normal.mass, disk.tangential.mass):
        assert_array_equal(mass[apart], 0.0)
        assert np.all(mass.diagonal() > 0.0)
