"""Fixed-point arithmetic on arrays of whole numbers.

NumPy multiplies and adds arrays of Python integers some twenty times faster than mpmath multiplies
and adds its numbers. Fixed point has less range than floating point; more bits make up for it. The
integers are gmpy2's if mpmath uses gmpy2.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from mpmath import libmp
from mpmath.ctx_mp import MPContext
from numpy.typing import NDArray
from scipy.linalg import lu_factor, lu_solve

from spectral_contact.spectral.jacobi import gauss_rule

Ints = NDArray[np.object_]


class Fixed:
    """Arithmetic of numbers that are stored as integers, in units of ``2**-bits``.

    Parameters
    ----------
    bits : int
        Binary digits after the point.

    Attributes
    ----------
    mp : MPContext
        Floating-point context of at least the same precision, for numbers that are not arrays.
    one : int
        The number 1.
    """

    def __init__(self, bits: int) -> None:
        self.bits = bits
        self.one = libmp.MPZ(1) << bits
        self.mp = MPContext()
        self.mp.prec = bits + 16
        # gmpy2's integers, if mpmath has them, need the root of theirs
        isqrt = math.isqrt if libmp.MPZ is int else libmp.isqrt
        self._root = np.frompyfunc(lambda v: isqrt(v << bits), 1, 1)
        cube = self.one**3
        self._inverse_root = np.frompyfunc(lambda v: isqrt(cube // v), 1, 1)
        exp = libmp.libelefun.exp_fixed
        self._exp = np.frompyfunc(lambda v: exp(v << 16, bits + 16) >> 16, 1, 1)
        self._of = np.frompyfunc(self._convert, 1, 1)
        self._number = np.frompyfunc(self._floating, 1, 1)
        self._float = np.frompyfunc(lambda v: float(self._floating(v)), 1, 1)
        self.gauss = lru_cache(maxsize=None)(self._gauss)
        self._chebyshev = lru_cache(maxsize=None)(self._chebyshev_of)

    def _convert(self, value: Any) -> Any:
        """Return one number in fixed point."""
        return libmp.to_fixed(self.mp.mpf(value)._mpf_, self.bits)

    def _floating(self, value: Any) -> Any:
        """Return one number of mpmath's from fixed point."""
        return self.mp.make_mpf(libmp.from_man_exp(value, -self.bits, self.mp.prec, "n"))

    def of(self, values: Any) -> Any:
        """Convert numbers, of mpmath's or Python's, or arrays of them."""
        return self._of(values)

    def numbers(self, values: Any) -> Any:
        """Convert to mpmath's numbers."""
        return self._number(values)

    def floats(self, values: Ints) -> NDArray[np.float64]:
        """Convert to doubles."""
        return np.asarray(self._float(values), dtype=np.float64)

    def map(self, function: Callable[[Any], Any], values: Any) -> Any:
        """Apply a function of the context `mp` to every entry."""
        apply = np.frompyfunc(lambda v: self._convert(function(self._floating(v))), 1, 1)
        return apply(values)

    def times(self, *factors: Any) -> Any:
        """Return the product."""
        result = factors[0]
        for factor in factors[1:]:
            result = (result * factor) >> self.bits
        return result

    def over(self, a: Any, b: Any) -> Any:
        """Return the quotient."""
        return (a << self.bits) // b

    def sqrt(self, a: Any) -> Any:
        """Return the square root."""
        return self._root(a)

    def inverse_root(self, a: Any) -> Any:
        """Return the inverse of the square root."""
        return self._inverse_root(a)

    def dot(self, a: Ints, b: Ints) -> Any:
        """Return the matrix product."""
        return (a @ b) >> self.bits

    def exp(self, values: Any) -> Any:
        """Return the exponentials."""
        return self._exp(values)

    def legendre(self, x: Ints, degree: int) -> Ints:
        """Return the Legendre polynomials at `x`, shape ``x.shape + (degree + 1,)``."""
        values = np.empty((*np.shape(x), degree + 1), dtype=object)
        values[..., 0] = self.one
        if degree:
            values[..., 1] = x
        for k in range(1, degree):
            rise = (2 * k + 1) * self.times(x, values[..., k]) - k * values[..., k - 1]
            values[..., k + 1] = rise // (k + 1)
        return values

    def series(self, x: Ints, coefficients: Ints) -> Ints:
        """Return the values of a Legendre series at `x`, of any shape.

        This is Clenshaw's recurrence for the same polynomial as a Chebyshev series.
        """
        chebyshev = self.dot(self._chebyshev(len(coefficients)), coefficients)
        ahead = beyond = 0 * x
        for c in chebyshev[:0:-1]:
            ahead, beyond = ((x * ahead) >> (self.bits - 1)) - beyond + c, ahead
        return np.asarray(self.times(x, ahead) - beyond + chebyshev[0])

    def moments(self, weights: Ints, x: Ints, degree: int) -> Ints:
        """Return the sums over the last axis of weights and Legendre polynomials at `x`.

        Summed with the weights are Chebyshev polynomials, whose recurrence takes half the
        operations. As each Legendre polynomial is a sum of these, a matrix product then gives the
        sums of Legendre polynomials.
        """
        before = 0 * x + self.one
        last = x
        found = []
        for _ in range(degree + 1):
            found.append((weights * before).sum(axis=-1) >> self.bits)
            before, last = last, ((x * last) >> (self.bits - 1)) - before
        return np.asarray(self.dot(np.stack(found, axis=-1), self._chebyshev(degree + 1)))

    def _chebyshev_of(self, count: int) -> Ints:
        """Return a matrix whose columns have the Chebyshev coefficients of Legendre polynomials."""
        binomials = [self.one]  # the binomial of 2j over j, divided by 4**j
        for j in range(1, count):
            binomials.append(binomials[-1] * (2 * j - 1) // (2 * j))
        matrix = np.zeros((count, count), dtype=object)
        for n in range(count):
            for k in range(n % 2, n + 1, 2):
                both = self.times(binomials[(n - k) // 2], binomials[(n + k) // 2])
                matrix[k, n] = 2 * both if k else both
        return matrix

    def _gauss(self, points: int) -> tuple[Ints, Ints]:
        """Return nodes and weights of the Gauss-Legendre rule on [-1, 1]."""
        x = self.of(gauss_rule(points)[0])
        # the nodes begin with the 50 bits or so of doubles, and each of Newton's steps doubles them
        for _ in range(math.ceil(math.log2(self.bits / 50.0)) + 1):
            values = self.legendre(x, points)
            last = values[:, points]
            before = values[:, points - 1]
            slope = self.over(points * (before - self.times(x, last)), self.one - self.times(x, x))
            x = x - self.over(last, slope)
        return x, self.over(2 * self.one, self.times(self.one - self.times(x, x), slope, slope))

    def expansion(self, points: int) -> Ints:
        """Return the matrix from samples at Gauss points to Legendre coefficients, square."""
        x, w = self.gauss(points)
        factors = np.arange(1, 2 * points, 2, dtype=object)
        return np.asarray((self.times(self.legendre(x, points - 1), w[:, None]) * factors).T // 2)


class DoubleFactors:
    """A matrix in double precision, factored with scaled rows; the matrix is overwritten."""

    def __init__(self, matrix: NDArray[np.float64]) -> None:
        self._scale = 1.0 / np.abs(matrix).max(axis=1)
        matrix *= self._scale[:, None]
        self._factor = lu_factor(matrix, overwrite_a=True, check_finite=False)

    def solved(self, right: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the solution of one right-hand side, or of the columns of several."""
        scaled = (right.T * self._scale).T
        return np.asarray(lu_solve(self._factor, scaled, check_finite=False))

    def corrected(self, f: Fixed, misfit: Ints) -> Ints:
        """Return the correction of a residual in fixed point, however small the residual is."""
        size = int(np.abs(misfit).max()) or 1
        # scaled to about 1, as its own size may be below the range of doubles
        lift = max(f.bits - size.bit_length(), 0)
        step = self.solved(f.floats(np.asarray(misfit << lift, dtype=object)))
        return np.asarray(f.of(step) >> lift)


class FixedRule(NamedTuple):
    """Points, weights, and values of functions at the points, in integers of `Fixed`."""

    points: Ints
    weights: Ints
    values: Ints


def root_rule(f: Fixed, points: int, lower: Ints, upper: Ints) -> FixedRule:
    """Return points u, weights that sum f to ``int f du / (2 sqrt(1 - exp(-u)))``, ``exp(-u)``.

    The rule is Gauss's in the root of u, from each of `lower` to its `upper`: in the root the
    integrand is analytic.
    """
    g, w = f.gauss(points)
    a = f.sqrt(lower)[:, None]
    b = f.sqrt(upper)[:, None]
    u = a + f.times(b - a, f.one + g) // 2
    u = f.times(u, u)
    fall = f.exp(-u)
    return FixedRule(u, f.times(f.sqrt(f.over(u, f.one - fall)), w, b - a) // 2, fall)
