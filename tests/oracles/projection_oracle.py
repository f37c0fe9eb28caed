"""Entries of the Galerkin matrices as double integrals of the elliptic kernels, in mpmath.

The oracle knows nothing of the library: complete elliptic integrals by the arithmetic-geometric
mean (no Abel factorisation), and two-dimensional quadrature that is split wherever the kernel is
not analytic. `entries` takes the density of its rules: 1 gives what double precision can tell,
`FINE` the 25 digits that validation/honesty/projections.py tabulates, where it is compared with
`FINER`.
"""

from functools import lru_cache
from itertools import product
from typing import NamedTuple

from mpmath.ctx_mp import MPContext

mp = MPContext()  # its own precision: mpmath's global context is the user's
mp.dps = 60  # distances on an annulus are differences of radii

#: Densities of rules that give more than 25 digits, the second to check the first.
FINE, FINER = 1.5, 1.6


# --- kernels --------------------------------------------------------------------------------------


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
        term = power * c * c
        loss += term
        if term < 1e-20:  # convergence is quadratic: the next term is below 1e-40
            break
    first_kind = mp.pi / (a + b)
    hi = mp.sqrt(hi2)
    return first_kind / hi, hi * first_kind * loss


# --- one-dimensional rules on [0, 1] --------------------------------------------------------------


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
def double_exponential(per_unit, digits):
    """``v = (1 + tanh(sinh(t) / 2)) / 2``: dense in the middle, for high degrees with a log."""
    count = int(mp.ceil(mp.asinh(digits * mp.log(10)) * per_unit))
    rule = []
    for k in range(-count, count + 1):
        t = mp.mpf(k) / per_unit
        z = mp.exp(mp.sinh(t))
        rule.append((z / (1 + z), mp.cosh(t) * z / (1 + z) ** 2 / per_unit))
    return rule


# --- panels and double integrals ------------------------------------------------------------------


class Place(NamedTuple):
    """Where ``d`` is measured from and how fast: ``s^2 = square + slope d``, ``rest = 1 - square``.

    On an annulus from an end, up to the middle; on a stick disk of radius c from its rim.
    """

    square: object
    rest: object
    slope: object


class Piece:
    """Functions of ``d`` on ``[low, high]``, in a coordinate v of [0, 1] in which all is analytic.

    v is 0 at the centre of the disk on the piece that touches it (high = 1), 0 at the edge on the
    piece that touches that (low = 0), and 0 at the shallow end of any other. `functions` returns
    the values of all of them. Without a place, ``d = 1 - s^2`` on the unit disk.
    """

    def __init__(self, low, high, functions, place=None):
        self.place = place
        self.low, self.high, self.functions = mp.mpf(low), mp.mpf(high), functions
        self.central, self.tail = self.high == 1 and place is None, self.low == 0
        self.span = None if self.tail else mp.log(self.high / self.low)
        self.at = lru_cache(self._at)  # rules run over one coordinate while the other stays

    def _at(self, v):
        """Return ``(d, 1 - d)`` and the functions times dd/dv."""
        if self.tail:
            d, jacobian = self.high * v * v, 2 * self.high * v
            return self._point(d, 1 - d), self._scaled(jacobian, d)
        rest = -mp.expm1(-self.span * (v * v if self.central else v))
        d = self.high * (1 - rest)
        jacobian = self.span * d * (2 * v if self.central else 1)
        return self._point(d, 1 - self.high + self.high * rest), self._scaled(jacobian, d)

    def _point(self, d, rest):
        """Return ``(1 - s^2, s^2)``."""
        if self.place is None:
            return d, rest
        square, edge, slope = self.place
        return edge - slope * d, square + slope * d

    def _scaled(self, jacobian, d):
        factor = jacobian * (1 if self.place is None else abs(self.place.slope))
        return [factor * f for f in self.functions(d)]

    def meets(self, other):
        """Return whether both are halves of one annulus, and meet in its middle."""
        if None in (self.place, other.place) or not self.high == other.high == 1:
            return False
        gap = self._point(1, 0)[1] - other._point(1, 0)[1]
        return self.place != other.place and abs(gap) < 1e-40


def nodes(one, two, density):
    """Yield points and weights of the square; of the triangle alone if the pieces are the same.

    Gauss rules where the integrand is analytic, also at the ends; double exponential ones where
    it has a logarithm.
    """

    def smooth(points):
        return gauss(round(points * density))

    def singular(per_unit):
        return double_exponential(round(per_unit * density), 20 * density)

    if one is two and (one.central or one.tail):  # singular on the diagonal, and at the edge
        radial = smooth(42) if one.central else singular(12)
        for (v, weight), (ratio, other) in product(radial, singular(12)):
            yield v, v * ratio, weight * other * v
    elif one is two:  # singular on the diagonal
        for (u, weight), (c, other) in product(singular(10), smooth(32)):
            yield c * (1 - u) + u, c * (1 - u), weight * other * (1 - u)
    elif one.place == two.place and one.low == two.high:  # singular at the common corner
        for (v, weight), (ratio, other) in product(singular(12), smooth(28)):
            for a, b in ((v, v * ratio), (v * ratio, v)):
                yield 1 - a, (1 - b if two.tail else b), weight * other * v
    elif one.meets(two):
        for (v, weight), (ratio, other) in product(singular(12), smooth(28)):
            yield v, v * ratio, weight * other * v
            yield v * ratio, v, weight * other * v
    else:
        for (v, weight), (w, other) in product(smooth(32), smooth(32)):
            yield v, w, weight * other


def entries(one, two, density=1):
    """Return ``<phi, N psi>`` and ``<s phi, T s psi>`` for all phi of `one` and psi of `two`."""
    points = list(nodes(one, two, density))
    left = [one.at(v) for v, _, _ in points]
    right = [two.at(w) for _, w, _ in points]
    both = [kernels(p, q) for (p, _), (q, _) in zip(left, right, strict=True)]
    columns = list(zip(*(psi for _, psi in right), strict=True))
    matrices = []
    for values in zip(*both, strict=True):
        weighted = [k * weight for k, (_, _, weight) in zip(values, points, strict=True)]
        products = ([k * f for f in phi] for k, (_, phi) in zip(weighted, left, strict=True))
        lines = zip(*products, strict=True)
        matrix = mp.matrix([[mp.fdot(line, column) for column in columns] for line in lines])
        matrices.append((matrix + matrix.T if one is two else matrix) / (4 * mp.pi))
    return matrices


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


def moments(piece, density=1, factor=None):
    """Return ``int phi factor s ds`` for all functions of a piece of the unit disk."""
    sums = [mp.mpf(0)] * len(piece.at(mp.mpf(1) / 2)[1])
    for v, weight in gauss(round(40 * density)):
        (d, _), values = piece.at(v)
        scale = weight / 2 * (1 if factor is None else factor(d))
        sums = [a + scale * b for a, b in zip(sums, values, strict=True)]
    return sums


def basis(panels, number, degrees, place=None, extra=None):
    """Return panel `number` (-1: the tail) with the basis functions of these degrees.

    With `extra` one more function of ``d`` joins them.
    """
    width, power = mp.mpf(panels.width), mp.mpf(panels.power)
    end = mp.exp(-panels.count * width)
    polynomials = [legendre(degree) for degree in degrees]

    def argument(d):
        if number < 0:
            return 2 * (mp.sqrt(d / end) if panels.root_tail else d / end) - 1
        return -2 * mp.log(d) / width - 2 * number - 1

    def functions(d):
        x, weight = argument(d), d**power
        values = [weight * polynomial(x) for polynomial in polynomials]
        return values if extra is None else [*values, extra(d)]

    if number < 0:
        return Piece(0, end, functions, place)
    return Piece(mp.exp(-width * (number + 1)), mp.exp(-width * number), functions, place)


def rows(panels, number, degrees):
    """Return the places of these basis functions in the matrices."""
    number = panels.count if number < 0 else number
    return [number * (panels.degree + 1) + k for k in degrees]
