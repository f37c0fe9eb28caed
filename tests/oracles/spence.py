"""Partial slip of the smooth coupled punch by Hilbert transforms: an oracle for the stick radius.

Continue the Abel transforms F of the pressure as an even function of t to [-1, 1], and H = t G of
the traction as an odd one. With the Hilbert transform ``(1/pi) int f(u) du / (t - u)`` the
equations of the flat punch are

    F + 2 kappa Hilbert[H] = 2 delta               everywhere,
    H - 2 kappa Hilbert[F] = 0                     in stick, t < c,
    H(t) = f [F(t) - int_t^1 F(u) h'(t/u) t/u^2 du]    in slip, t > c,

where ``h(x) = (2/pi) x K(sqrt(1 - x^2))``: slip is local in the transforms, as a step of F at u is
the pressure ``(2/pi)/sqrt(u^2 - s^2)``. They are collocated with Legendre polynomials on elements
that are graded to c and to the edge. Nothing of the library is used: no kernel, no Galerkin matrix.

Under a paraboloid the contact grows and stays similar to itself. The rate of its fields is that of
a flat punch, so it has the same stick radius (Spence, The Hertz contact problem with finite
friction, J. Elasticity 5, 1975). It is solved here, too: the surface sinks by ``delta - s^2/2``,
and what sticks was moved by ``C s^2`` before it did.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.optimize import brentq
from scipy.special import ellipkm1, elliprd

#: From one element to the next nearer to c, or to the edge.
_RATIO = 0.2


@dataclass(frozen=True)
class Slipping:
    """A flat punch for unit load.

    Attributes
    ----------
    friction, approach, shear : float
        f, delta* and Q*.
    """

    friction: float
    approach: float
    shear: float


class Collocation:
    """The equations for one Poisson's ratio and one stick radius.

    Parameters
    ----------
    poisson_ratio, radius : float
    degree : int
        Of the polynomials.
    levels : tuple of int
        Elements toward c from either side, and toward the edge.
    """

    def __init__(
        self,
        poisson_ratio: float,
        radius: float,
        degree: int = 10,
        levels: tuple[int, int] = (10, 14),
    ) -> None:
        self.kappa = (1 - 2 * poisson_ratio) / (4 * (1 - poisson_ratio))
        self.radius, self.degree = radius, degree
        # ends of elements as offsets from the point that they are graded to
        half = (1 - radius) / 2
        near, edge = (_RATIO ** np.arange(n) for n in levels)
        groups = [
            (0.0, np.array([0.0, radius / 4, radius / 2])),
            (radius, np.append(-radius / 2 * near, 0.0)),
            (radius, np.append(0.0, half * near[::-1])),
            (1.0, np.append(-half * edge, 0.0)),
        ]
        self.elements = [
            (anchor, low, high) for anchor, ends in groups for low, high in pairwise(ends)
        ]
        self.g, self.w = np.polynomial.legendre.leggauss(degree + 1)
        self.points = [
            (anchor, (low + high) / 2 + (high - low) / 2 * x)
            for anchor, low, high in self.elements
            for x in self.g
        ]
        self.t = np.array([anchor + offset for anchor, offset in self.points])
        self.values = np.kron(
            np.eye(len(self.elements)), np.polynomial.legendre.legvander(self.g, degree)
        )
        self.of_even, self.of_odd = self._hilbert(1.0), self._hilbert(-1.0)
        self.slip = self._slip()

    def _hilbert(self, sign: float) -> np.ndarray:
        """Return the transform of functions continued with this sign, at the points."""
        columns = []
        anchors, offsets = np.array(self.points).T
        for anchor, low, high in self.elements:
            middle, half = (low + high) / 2, (high - low) / 2
            own = ((anchors - anchor) + (offsets - middle)) / half
            mirrored = ((anchors + anchor) + (offsets + middle)) / half
            other = _cauchy(mirrored, self.degree) * (-1.0) ** np.arange(self.degree + 1)
            columns.append(_cauchy(own, self.degree) + sign * other)
        return np.hstack(columns) / np.pi

    def _slip(self) -> np.ndarray:
        """Return H/f from F in slip, at the points; only those beyond c mean anything."""
        g, w = np.polynomial.legendre.leggauss(self.degree + 12)
        terms, matrix = self.degree + 1, self.values.copy()
        for i, (_, offset) in enumerate(self.points):
            if self.t[i] < self.radius:
                continue
            for j, (anchor, low, high) in enumerate(self.elements):
                if j < i // terms:
                    continue
                start = offset if j == i // terms else low
                u = (start + high) / 2 + (high - start) / 2 * g
                local = np.clip((2 * u - low - high) / (high - low), -1, 1)
                x = self.t[i] / (anchor + u)
                slope = 2 / np.pi / 3 * elliprd(0.0, x * x, 1.0)
                weights = w * (high - start) / 2 * slope * x / (anchor + u)
                columns = slice(j * terms, (j + 1) * terms)
                matrix[i, columns] -= weights @ np.polynomial.legendre.legvander(local, self.degree)
        return matrix

    def solved(self, friction: float, *loads: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
        """Return F and H as coefficients for right-hand sides at the points, (2, size, loads)."""
        stick = self.t < self.radius
        below = np.where(stick[:, None], -2 * self.kappa * self.of_even, -friction * self.slip)
        matrix = np.block([[self.values, 2 * self.kappa * self.of_odd], [below, self.values]])
        right = np.column_stack([np.concatenate([a, np.where(stick, b, 0.0)]) for a, b in loads])
        return np.stack(np.split(np.linalg.solve(matrix, right), 2))

    def at_rim(self, field: np.ndarray, derivative: int = 0) -> tuple[float, float]:
        """Return a field, or its slope, at c from inside and from outside."""
        k = next(i for i, e in enumerate(self.elements) if e[0] == self.radius and e[1] == 0.0)
        rows = field.reshape(len(self.elements), -1)
        both = []
        for j, x in ((k - 1, 1.0), (k, -1.0)):
            _, low, high = self.elements[j]
            series = np.polynomial.legendre.legder(rows[j], derivative)
            scale = (2 / (high - low)) ** derivative
            both.append(scale * float(np.polynomial.legendre.legval(x, series)))
        return both[0], both[1]

    def integral(self, field: np.ndarray) -> float:
        """Return ``int_0^1 . dt``."""
        sizes = np.array([high - low for _, low, high in self.elements])
        return float(field.reshape(len(self.elements), -1)[:, 0] @ sizes)

    def _fields(self, friction: float) -> tuple[np.ndarray, float]:
        """Return F and H of a flat punch under ``2 delta = 1``, and the jump of H at c."""
        one = np.ones_like(self.t)
        fields = self.solved(friction, (one, 0.0 * one))[..., 0]
        return fields, float(np.subtract(*self.at_rim(fields[1])))

    def _bend(self, friction: float) -> float:
        """Return the jump of the slope of H at c under a paraboloid.

        Its sinking makes the pressure bounded at the edge, and C makes H continuous.
        """
        one, square = np.ones_like(self.t), self.t**2
        even, odd = self.solved(
            friction,
            (one, 0.0 * one),
            (-2.0 * square, 0.0 * one),
            (0.0 * one, 1.5 * np.pi * square),
        )
        edges = even.reshape(len(self.elements), -1, 3)[-1].sum(axis=0)
        jumps = [np.subtract(*self.at_rim(one)) for one in odd.T]
        conditions = np.array([edges, jumps])
        sinking, moved = np.linalg.solve(conditions[:, [0, 2]], -conditions[:, 1])
        field = odd @ [sinking, 1.0, moved]
        return float(np.subtract(*self.at_rim(field, 1)))

    def _root(self, function: Callable[[float], float]) -> float:
        """Return the friction at which a jump vanishes, near that without coupling."""
        c = self.radius
        guess = self.kappa * np.log((1 + c) / (1 - c)) / (c * ellipkm1(c * c))
        return float(brentq(function, 0.8 * guess, 3.0 * guess, xtol=1e-13))

    def flat(self) -> Slipping:
        """Return the flat punch whose stick radius is c."""
        friction = self._root(lambda f: self._fields(f)[1])
        even, odd = self._fields(friction)[0]
        load = 4 * self.integral(even)
        return Slipping(friction, 0.5 / load, 2 * np.pi * self.integral(odd) / load)

    def paraboloid(self) -> float:
        """Return the friction at which a paraboloid has the stick radius c."""
        return self._root(self._bend)


def _cauchy(x: np.ndarray, degree: int) -> np.ndarray:
    """Return ``int_-1^1 P_n(u) du / (x - u)``, twice the Legendre function of the second kind."""
    values = np.empty((len(x), degree + 1))
    far = np.abs(x) > 1.1
    g, w = np.polynomial.legendre.leggauss(60)
    values[far] = (w / (x[far, None] - g)) @ np.polynomial.legendre.legvander(g, degree)
    near = x[~far]
    rows = [np.log(np.abs((1 + near) / (1 - near)))]
    rows.append(near * rows[0] - 2)
    for n in range(1, degree):
        rows.append(((2 * n + 1) * near * rows[n] - n * rows[n - 1]) / (n + 1))
    values[~far] = np.array(rows).T
    return values
