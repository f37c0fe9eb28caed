"""Zones of stick and slip on graded elements: loading, and the first unloading with its memory.

It shares nothing with the library: p and q/s are Legendre polynomials in ``z = s^2`` on elements
that shrink toward the edge and toward every radius where a field is not smooth. The half-integrals
of docs/theory are exact by Gauss's rule in ``w = sqrt(z - t^2)``, and the Gram matrices of the
kernels are sums over points t that are graded to the ends of every element. Everything tangential
is for ``kappa = 1``, so that friction is ``f / kappa``.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.polynomial.legendre import leggauss, legvander
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve
from scipy.linalg.blas import dsyrk
from scipy.optimize import root

Array = NDArray[np.float64]

#: Ratio of neighbouring elements.
RATIO = 0.25


class Fineness(NamedTuple):
    """Degree on an element, the narrowest one over its zone, and points t on an element."""

    degree: int = 12
    narrowest: float = 1e-6
    points: int = 36


USUAL = Fineness()


def graded_ends(radii: Sequence[float], narrowest: float) -> Array:
    """Return ends of elements in ``s^2``, graded to the given radii and to the edge."""
    marks = np.concatenate([[0.0], np.square(radii), [1.0]])
    levels = RATIO ** np.arange(np.ceil(np.log(narrowest) / np.log(RATIO)), -1, -1)
    ends = [0.0]
    for k, (lower, upper) in enumerate(pairwise(marks)):
        middle = lower if k == 0 else (lower + upper) / 2.0
        inner = lower + (middle - lower) * levels if k else []
        outer = upper - (upper - middle) * levels[::-1][1 - len(inner) > 0 :]
        ends.extend([*inner, *(z for z in outer if z > middle), upper])
    return np.array(ends)


class Elements:
    """Matrices of the functions of all elements; unknowns are coefficients, element by element."""

    def __init__(self, ends: Array, degree: int = USUAL.degree, points: int = USUAL.points) -> None:
        self.lower = ends[:-1]
        self.width = np.diff(ends)
        self.degree = degree
        self.functions = degree + 1
        x, weight = leggauss(degree + 3)
        self._x = x
        self._values = legvander(x, degree)
        #: points of every element, and the weights of ``s ds``, (elements, points)
        self.z = self.lower[:, None] + self.width[:, None] * (1.0 + x) / 2.0
        self._weight = self.width[:, None] / 4.0 * weight
        self._half_integrals(points)

    @property
    def count(self) -> int:
        """How many elements there are."""
        return len(self.width)

    def _half_integrals(self, points: int) -> None:
        """Find ``int_t^1 phi s ds / sqrt(s^2 - t^2)`` of all functions at the points t."""
        x, weight = leggauss(points)
        angle = np.pi / 4.0 * (1.0 + x)
        before = self.width[:, None] * np.cos(angle) ** 2  # upper end of the element less t^2
        square = self.lower[:, None] + self.width[:, None] * np.sin(angle) ** 2
        self.t = np.sqrt(square).ravel()
        # dt = d(t^2) / (2 t)
        step = self.width[:, None] * np.sin(2.0 * angle) * np.pi / 4.0 * weight
        self.t_weight = step.ravel() / (2.0 * self.t) / np.pi
        nodes, node_weight = leggauss(self.degree + 1)
        table = np.zeros((self.count, points, self.count, self.functions))
        upper = self.lower + self.width
        for k in range(self.count):
            rows = slice(0, k + 1)
            # the ends of neighbours are equal to the last digit
            to_lower = self.lower[k] - upper[rows, None] + before[rows]
            to_upper = to_lower + self.width[k]
            to_lower[k] = 0.0
            to_upper[k] = before[k]
            high = np.sqrt(to_upper)
            low = np.sqrt(to_lower)
            length = self.width[k] / (high + low)
            length[k] = high[k]
            beyond = length[..., None] * (1.0 + nodes) / 2.0
            # z less the lower end, or t^2 in the element of t, over the width
            local = beyond * (2.0 * low[..., None] + beyond) / self.width[k]
            local[k] = 1.0 - (to_upper[k, :, None] - beyond[k] ** 2) / self.width[k]
            values = legvander(2.0 * local - 1.0, self.degree)
            table[rows, :, k] = np.einsum("epnf,n->epf", values, node_weight) * (
                length[..., None] / 2.0
            )
        self.half = table.reshape(self.count * points, -1)

    def gram(self, power: int) -> Array:
        """Return ``(1/pi) int t^power H H dt`` with the half-integrals H: N for 0, T for 2."""
        weighted = self.half * np.sqrt(self.t_weight * self.t**power)[:, None]
        lower = np.tril(dsyrk(1.0, weighted.T, lower=1))
        return np.asarray(lower + np.tril(lower, -1).T)

    def mass(self, power: int) -> Array:
        """Return ``int phi psi s^power s ds``, power 0 for p and 2 for q."""
        result = np.zeros((self.count, self.functions, self.count, self.functions))
        density = self._weight * self.z ** (power // 2)
        for k in range(self.count):
            result[k, :, k] = self._values.T @ (self._values * density[k][:, None])
        return result.reshape(self.count * self.functions, -1)

    def tested(self, field: Array) -> Array:
        """Return ``int phi field s ds`` from values at the points, (elements, points)."""
        return np.asarray(((field * self._weight) @ self._values).ravel())

    def expanded(self, field: Array) -> Array:
        """Return coefficients of a field from values at the points."""
        norm = 1.0 / (self.width[:, None] / 2.0 / (2.0 * np.arange(self.functions) + 1.0))
        return np.asarray(((field * self._weight) @ self._values * norm).ravel())

    def values(self, coefficients: Array) -> Array:
        """Return values at the points, (elements, points)."""
        return np.asarray(coefficients.reshape(self.count, -1) @ self._values.T)

    def at(self, coefficients: Array, z: float, *, inside: bool) -> float:
        """Return a value at the end z of an element, from inside or from outside."""
        upper = self.lower + self.width
        places = np.isclose(upper, z, rtol=0.0, atol=1e-14) if inside else (self.lower == z)
        place = int(np.flatnonzero(places)[-1])
        ends = legvander(np.array([1.0 if inside else -1.0]), self.degree)[0]
        return float(ends @ coefficients.reshape(self.count, -1)[place])

    def anywhere(self, coefficients: Array, z: Array) -> Array:
        """Return values at any z."""
        place = np.clip(np.searchsorted(self.lower, z, side="right") - 1, 0, self.count - 1)
        local = 2.0 * (z - self.lower[place]) / self.width[place] - 1.0
        basis = legvander(np.clip(local, -1.0, 1.0), self.degree)
        return np.asarray((basis * coefficients.reshape(self.count, -1)[place]).sum(axis=1))

    def load_inside(self, pressure: Array) -> Array:
        """Return ``int_0^s eta p d eta`` at the points, of the coefficients of p."""
        c = pressure.reshape(self.count, -1)
        n = np.arange(1, self.functions)
        lower = legvander(self._x, self.degree + 1)
        integral = np.empty((self.functions, len(self._x)))
        integral[0] = 1.0 + self._x
        integral[1:] = (lower[:, 2:] - lower[:, :-2]).T / (2.0 * n + 1.0)[:, None]
        within = self.width[:, None] / 4.0 * (c @ integral)
        whole = self.width / 2.0 * c[:, 0]
        return np.asarray(np.cumsum(whole)[:, None] - whole[:, None] + within)


@dataclass(frozen=True)
class ZonesOnElements:
    """A state on zones: boundaries, the shear, and q/s and p as coefficients on the elements."""

    boundaries: tuple[float, ...]
    total_shear: float
    elements: Elements
    pressure: Array
    traction: Array
    frozen: Array

    def traction_at(self, z: float, *, inside: bool = True) -> float:
        """Return q at an end of an element."""
        return float(np.sqrt(z)) * self.elements.at(self.traction, z, inside=inside)

    def ratio_at_edge(self) -> float:
        """Return q/p at the edge."""
        return self.traction_at(1.0) / self.elements.at(self.pressure, 1.0, inside=True)


def _solution(matrix: Array, right: Array) -> Array:
    """Return the solution with a matrix that is scaled to a unit diagonal."""
    scale = 1.0 / np.sqrt(matrix.diagonal())
    scaled = cho_factor(matrix * np.outer(scale, scale))
    return np.asarray(scale * cho_solve(scaled, scale * right))


def _solved(
    alpha: float,
    beta: float,
    friction: float,
    boundaries: Sequence[float],
    states: Sequence[int],
    before: Callable[[Elements, Array, Array], Array] | None,
    marks: Sequence[float],
    scale: float,
    fineness: Fineness,
) -> ZonesOnElements:
    """Return the fields on zones with given boundaries, for the load `scale`."""
    ends = graded_ends(sorted([*boundaries, *marks]), fineness.narrowest)
    elements = Elements(ends, fineness.degree, fineness.points)
    unit = elements.tested(np.ones_like(elements.z))
    pressure = _solution(alpha * elements.mass(0) + elements.gram(0), unit)
    pressure /= 2.0 * np.pi * float(unit @ pressure)
    tangential = beta * elements.mass(2) + elements.gram(2)
    # <s phi, g> with s g = int_0^s eta p d eta
    drive = elements.tested(elements.load_inside(pressure))
    frozen = np.zeros_like(drive)
    if before is not None:
        frozen = tangential @ before(elements, tangential, pressure) - drive
    middle = elements.lower + elements.width / 2.0
    zone = np.searchsorted(np.square(boundaries), middle)
    state = np.array(states)[zone]
    sliding = elements.values(pressure) / np.sqrt(elements.z)
    traction = elements.expanded(scale * friction * state[:, None] * sliding)
    sticks = np.repeat(state == 0, elements.functions)
    right = scale * drive + frozen - tangential @ traction
    traction[sticks] += _solution(tangential[np.ix_(sticks, sticks)], right[sticks])
    # int q s ds = int t G dt
    total = 2.0 * np.pi**2 * float((elements.t_weight * elements.t) @ elements.half @ traction)
    return ZonesOnElements(tuple(boundaries), total, elements, pressure, traction, frozen)


def _with_free_boundaries(
    solve: Callable[[Sequence[float]], ZonesOnElements], guess: Sequence[float]
) -> ZonesOnElements:
    """Move the boundaries until the traction is continuous at each."""

    def jumps(logits: Array) -> Array:
        state = solve(_radii(logits))
        z = np.square(state.boundaries)
        return np.array(
            [
                state.traction_at(one, inside=True) - state.traction_at(one, inside=False)
                for one in z
            ]
        )

    start = np.log(np.square(guess) / (1.0 - np.square(guess)))
    found = root(jumps, start, tol=1e-9, options={"maxfev": 40})
    return solve(_radii(found.x))


def _radii(logits: Array) -> tuple[float, ...]:
    return tuple(np.sqrt(1.0 / (1.0 + np.exp(-logits))).tolist())


def loaded(
    alpha: float,
    beta: float,
    friction: float,
    guess: Sequence[float],
    states: Sequence[int],
    fineness: Fineness = USUAL,
) -> ZonesOnElements:
    """Return partial slip at the largest load, with the zones of these states."""
    return _with_free_boundaries(
        lambda b: _solved(alpha, beta, friction, b, states, None, (), 1.0, fineness), guess
    )


def unloaded(
    alpha: float,
    beta: float,
    friction: float,
    load: float,
    guess: Sequence[float],
    states: Sequence[int],
    before: ZonesOnElements,
    before_states: Sequence[int],
    fineness: Fineness = USUAL,
) -> ZonesOnElements:
    """Return the state at a load below the largest one, which the zones `before` belong to.

    What sticks has the radial displacement of before.
    """

    def traction_before(elements: Elements, tangential: Array, pressure: Array) -> Array:
        middle = elements.lower + elements.width / 2.0
        zone = np.searchsorted(np.square(before.boundaries), middle)
        state = np.array(before_states)[zone]
        sliding = elements.values(pressure) / np.sqrt(elements.z)
        traction = elements.expanded(friction * state[:, None] * sliding)
        sticks = np.repeat(state == 0, elements.functions)
        right = elements.tested(elements.load_inside(pressure)) - tangential @ traction
        traction[sticks] += _solution(tangential[np.ix_(sticks, sticks)], right[sticks])
        return traction

    return _with_free_boundaries(
        lambda b: _solved(
            alpha,
            beta,
            friction,
            b,
            states,
            traction_before,
            before.boundaries,
            load,
            fineness,
        ),
        guess,
    )
