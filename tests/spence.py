"""Partial slip of the smooth coupled punch by Hilbert transforms: an oracle for the stick radius.

With the Abel transforms F of the pressure, continued as an even function of t to [-1, 1], and H = t G
of the traction, continued as an odd one, and the Hilbert transform ``(1/pi) int f(u) du / (t - u)``,
the equations of the flat punch are (Spence 1975)

    F + 2 kappa Hilbert[H] = 2 delta               everywhere,
    H - 2 kappa Hilbert[F] = 0                     in stick, t < c,
    H(t) = f [F(t) - int_t^1 F(u) h'(t/u) t/u^2 du]    in slip, t > c,

where ``h(x) = (2/pi) x K(sqrt(1 - x^2))``: q = f p is local in the transforms, as a step of F at u
is the pressure ``(2/pi)/sqrt(u^2 - s^2)``. They are collocated with Legendre polynomials on elements
that are graded to c and to the edge. Nothing of the library is used: no kernel, no Galerkin matrix.

The punch whose profile is a parabola grows in contact; its solution is similar to itself, and its rate
is that of the flat punch, hence it has the same stick radius (Spence 1968). It is solved here, too: the
surface sinks by ``delta - s^2/2`` and was moved radially by ``C s^2`` when it came to stick.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import elliprd

_RATIO = 0.15


@dataclass(frozen=True)
class Punch:
    """Transforms on the elements for one friction, and what they miss at the boundary of slip.

    Attributes
    ----------
    friction, approach, shear : float
        f, delta* and Q* for unit load.
    jump : float
        Of H at c, relative to H there: zero for the friction that belongs to the stick radius.
    """

    friction: float
    approach: float
    shear: float
    jump: float


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
        degree: int = 9,
        levels: tuple[int, int] = (9, 14),
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
            (anchor, low, high)
            for anchor, ends in groups
            for low, high in zip(ends[:-1], ends[1:], strict=True)
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
        even, odd = self._hilbert(1.0), self._hilbert(-1.0)
        self.of_even, self.of_odd = even, odd
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
        for i, (own, offset) in enumerate(self.points):
            if self.t[i] < self.radius:
                continue
            for j, (anchor, low, high) in enumerate(self.elements):
                if j < i // terms:
                    continue
                start = offset if j == i // terms else low
                assert j != i // terms or own == anchor
                u = (start + high) / 2 + (high - start) / 2 * g
                local = np.clip((2 * u - low - high) / (high - low), -1, 1)
                x = self.t[i] / (anchor + u)
                slope = 2 / np.pi / 3 * elliprd(0.0, x * x, 1.0)
                weights = w * (high - start) / 2 * slope * x / (anchor + u)
                columns = slice(j * terms, (j + 1) * terms)
                matrix[i, columns] -= weights @ np.polynomial.legendre.legvander(
                    local, self.degree
                )
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

    def flat(self, friction: float) -> Punch:
        """Return the flat punch at some friction."""
        ones = np.ones(len(self.t))
        even, odd = self.solved(friction, (ones, 0 * ones))[..., 0]
        load = 4 * self.integral(even)
        inside, outside = self.at_rim(odd)
        shear = 2 * np.pi * self.integral(odd) / load
        return Punch(friction, 0.5 / load, shear, inside / outside - 1)


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
