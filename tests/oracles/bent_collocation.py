"""Normal contact through a layer whose law bends, by collocation; shares no code with the library.

As in `layered_collocation` the overclosure at Gauss points on panels in r is ``w_i = delta - h(r_i)
- sum_j N_ij F(w_j)`` with the elliptic kernel, here for all points at once. Panels are graded to
the edge, to breaks of the profile, and to the radii at which w meets a knot of the law. These are
roots of w between Gauss points, where it is what the equation makes it; they are found, the panels
are made anew, and so on until they stay. The difference of two meshes says how good it is.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.polynomial.legendre import leggauss, legvander
from scipy.optimize import brentq, minimize_scalar
from scipy.special import ellipkm1

Array = np.ndarray[Any, np.dtype[np.float64]]
Function = Callable[[Array], Array]

#: Ratio of neighbouring panels.
RATIO = 0.25
#: Points on a panel, and panels to a singular radius: first, and then. To the edge there are more.
MESHES, EDGE_LEVELS = ((11, 7), (15, 10)), 4
#: Meshes of a closer truth, for a scene whose solution and truth differ.
FINER_MESHES = ((15, 10), (19, 13))
#: The rule for a logarithmic singularity: Gauss points in a root of the distance, and which root.
FINE, ROOT = 64, 6
#: Panels closer than this in their lengths get that rule; pairs of points and panels at once.
NEAR, CHUNK = 0.5, 2000
#: Least width of a panel, over the radius: a radius has no more digits.
THINNEST = 1e-13
#: How far w at bends may be off a knot, over the largest, and how often they are looked for.
STILL, ROUNDS = 1e-13, 12
#: More bends are noise of an overclosure that stays at a knot over some width.
MOST_BENDS = 50


@dataclass(frozen=True)
class Law:
    """Pressure, its slope and its integral over the overclosure, and where they bend."""

    pressure: Function
    slope: Function
    energy: Function
    knots: tuple[float, ...]


@dataclass(frozen=True)
class BentContact:
    """The contact: pressures are those at radii r, and `error` holds the difference of two meshes.

    It is relative to each number; of the pressure to the largest.
    """

    approach: float
    load: float
    work: float
    stiffness: float
    bends: tuple[float, ...]
    r: Array
    pressure: Array
    error: dict[str, float]


def solved(
    law: Law,
    height: Function,
    radius: float,
    *,
    approach: float | None = None,
    start: float | None = None,
    breaks: Sequence[float] = (),
    pointed: bool = False,
    meshes: Sequence[tuple[int, int]] = MESHES,
) -> BentContact:
    """Solve on a disk, of a given approach, or with the start of the law at the edge.

    Raises
    ------
    AssertionError
        If the bends do not come to rest, as where w only just touches a knot or stays at it.
    """
    problem = _Problem(law, height, radius, approach, start, tuple(breaks), pointed)
    bends: tuple[float, ...] = ()
    contacts = []
    for order, levels in meshes:
        for _ in range(ROUNDS):
            state = problem.state(bends, order, levels)
            found = state.bends()
            if len(found) > MOST_BENDS:
                raise AssertionError("the overclosure stays at a knot")
            if len(found) == len(bends) and state.misfit(bends) <= STILL:
                break
            bends = found
        else:
            raise AssertionError("the bends did not come to rest")
        contacts.append(state)
    rough, fine = (contact.numbers() for contact in contacts)
    error = {name: abs(rough[name] / fine[name] - 1.0) for name in fine}
    p = contacts[1].pressure
    other = law.pressure(contacts[0].overclosure_at(contacts[1].r))
    error["pressure"] = float(np.abs(other - p).max() / p.max())
    return BentContact(**fine, bends=bends, r=contacts[1].r, pressure=p, error=error)


@dataclass(frozen=True)
class _Problem:
    law: Law
    height: Function
    radius: float
    approach: float | None
    start: float | None
    breaks: tuple[float, ...]
    pointed: bool

    def state(self, bends: tuple[float, ...], order: int, levels: int) -> _State:
        """Solve on panels to these bends."""
        inner = sorted({*self.breaks, *bends})
        singular = [*([0.0] if self.pointed else []), *inner, self.radius]
        edges = _panels(self.radius, singular, levels)
        g, weights = leggauss(order)
        nodes = edges[:-1, None] + np.diff(edges)[:, None] * (1.0 + g) / 2.0
        r = nodes.ravel()
        matrix, last = operator(r, edges, order), operator(np.array([self.radius]), edges, order)[0]
        h, top = self.height(r), float(self.height(np.array([self.radius]))[0])
        w = np.full(len(r), 0.0)
        if self.start is not None:
            w = self.start + (top - h) * 0.5
        elif self.approach is not None:
            w = self.approach - h
            w = np.minimum(w, float(w.max()))
        for _ in range(300):
            p, slope = self.law.pressure(w), self.law.slope(w)
            delta = self._approach(last, p, top)
            residual = w + matrix @ p + h - delta
            jacobian = np.eye(len(r)) + matrix * slope
            if self.start is not None:
                jacobian -= last * slope
            step = np.linalg.solve(jacobian, -residual)
            size = float(np.abs(step).max())
            w = w + step * min(1.0, 0.5 * max(float(np.ptp(w)), 0.1) / size if size > 0.0 else 1.0)
            if size < 2e-14 * (1.0 + float(np.abs(w).max())):
                break
        else:
            raise AssertionError("Newton's method did not converge")
        p = self.law.pressure(w)
        delta = self._approach(last, p, top)
        areas = 2.0 * np.pi * r * (np.diff(edges)[:, None] * weights / 2.0).ravel()
        rate = np.linalg.solve(np.eye(len(r)) + matrix * self.law.slope(w), np.ones(len(r)))
        return _State(self, edges, order, r, areas, w, p, rate, delta)

    def _approach(self, last: Array, p: Array, top: float) -> float:
        if self.approach is not None:
            return self.approach
        assert self.start is not None
        return float(self.start + top + last @ p)


@dataclass(frozen=True)
class _State:
    problem: _Problem
    edges: Array
    order: int
    r: Array
    areas: Array
    w: Array
    pressure: Array
    rate: Array
    approach: float

    def overclosure_at(self, r: Array) -> Array:
        """Return what the equation makes of w anywhere."""
        moved = operator(r, self.edges, self.order) @ self.pressure
        return np.asarray(self.approach - self.problem.height(r) - moved)

    def bends(self) -> tuple[float, ...]:
        """Return the radii at which w meets a knot."""
        r = np.concatenate([[0.0], self.r, [self.problem.radius]])
        w = np.concatenate([self.overclosure_at(r[:1]), self.w, self.overclosure_at(r[-1:])])
        # between Gauss points it may be larger or less than at any of them
        turning = 1 + np.flatnonzero(np.diff(w[1:]) * np.diff(w[:-1]) < 0.0)
        for k in turning[np.abs(w[turning + 1] - w[turning - 1]) > 0.0].tolist():
            extreme = self._extreme(float(r[k - 1]), float(r[k + 1]), sign=np.sign(w[k] - w[k - 1]))
            r, w = np.append(r, extreme), np.append(w, self.overclosure_at(np.array([extreme])))
        order = np.argsort(r)
        r, w = r[order], w[order]
        found = []
        for knot in self.problem.law.knots:
            above = w > knot
            for k in np.flatnonzero(above[1:] != above[:-1]):

                def excess(r: float, knot: float = knot) -> float:
                    return float(self.overclosure_at(np.array([r]))[0]) - knot

                low, high = excess(float(r[k])), excess(float(r[k + 1]))
                if low * high < 0.0:
                    found.append(brentq(excess, r[k], r[k + 1], xtol=1e-16, rtol=1e-15))
                else:  # w at a Gauss point is off by its rounding
                    found.append(float(r[k] if abs(low) < abs(high) else r[k + 1]))
        return tuple(sorted(found))

    def misfit(self, bends: tuple[float, ...]) -> float:
        """Return by how much w at these radii is off any knot, over the largest."""
        if not bends:
            return 0.0
        w, knots = self.overclosure_at(np.array(bends)), np.array(self.problem.law.knots)
        return float(np.abs(w[:, None] - knots).min(axis=1).max() / np.abs(self.w).max())

    def _extreme(self, low: float, high: float, sign: float) -> float:
        """Return where w is largest, or least with the sign -1."""
        found = minimize_scalar(
            lambda r: -sign * float(self.overclosure_at(np.array([r]))[0]),
            bounds=(low, high),
            method="bounded",
            options={"xatol": 1e-9 * (high - low)},
        )
        return float(found.x)

    def numbers(self) -> dict[str, float]:
        """Return approach, load, work and stiffness."""
        law = self.problem.law
        moved = self.approach - self.problem.height(self.r) - self.w
        stored = law.energy(self.w) + 0.5 * self.pressure * moved
        return {
            "approach": self.approach,
            "load": float(self.areas @ self.pressure),
            "work": float(self.areas @ stored),
            "stiffness": float(self.areas @ (law.slope(self.w) * self.rate)),
        }


def _panels(radius: float, singular: Sequence[float], levels: int) -> Array:
    """Return the ends of panels that are graded to singular radii, of which the edge is one."""
    ends = [0.0]
    stops = sorted({0.0, *singular})
    for low, high in pairwise(stops):
        middle = low + (high - low) / 2.0 if low in singular else low
        inner = RATIO ** np.arange(1, levels)
        outer = RATIO ** np.arange(1, levels + EDGE_LEVELS * (high == radius))
        if low in singular:
            ends.extend((low + (middle - low) * inner).tolist())
        ends.extend((high - (high - middle) * outer).tolist())
        ends.extend([middle, high])
    found = np.unique(ends)
    inner = found[1:-1]
    apart = np.diff(found)[:-1] > THINNEST * radius
    forced = np.isin(inner, stops)
    return np.concatenate([[0.0], inner[apart | forced], [radius]])


def operator(s: Array, edges: Array, order: int) -> Array:
    """Return N at radii as weights of the values at the Gauss points of all panels."""
    g, plain = leggauss(order)
    lengths = np.diff(edges)
    nodes = edges[:-1, None] + lengths[:, None] * (1.0 + g) / 2.0
    apart = np.abs(nodes[None] - s[:, None, None])
    outside = np.maximum(edges[:-1] - s[:, None], s[:, None] - edges[1:])
    near = outside <= NEAR * lengths
    with np.errstate(divide="ignore"):  # a point on its own panel, which is done below
        weights = (lengths[:, None] * plain / 2.0) * _kernel(s[:, None, None], nodes[None], apart)
    # from values at Gauss points to Legendre coefficients
    expand = (legvander(g, order - 1) * plain[:, None] * (np.arange(order) + 0.5)).T
    offsets, rule = _graded()
    points, panels = np.nonzero(near)
    for first in range(0, len(points), CHUNK):
        i, j = points[first : first + CHUNK], panels[first : first + CHUNK]
        at, low, high = s[i, None], edges[j, None], edges[j + 1, None]
        inside = np.clip(at, low, high)
        inward, outward = (inside - low) * offsets, (high - inside) * offsets
        # rules of no length get a place where the kernel is finite
        eta = np.maximum(np.concatenate([inside - inward, inside + outward], axis=1), 1e-30)
        far = np.concatenate([inward, outward], axis=1) + np.abs(inside - at)
        w = np.concatenate([(inside - low) * rule, (high - inside) * rule], axis=1)
        values = w * _kernel(at, eta, np.maximum(far, 1e-30))
        local = 2.0 * (eta - low) / (high - low) - 1.0
        moments = np.einsum("pq,pqn->pn", values, legvander(local, order - 1))
        weights[i, j] = moments @ expand
    return weights.reshape(len(s), -1)


def _kernel(s: Array, eta: Array, apart: Array) -> Array:
    """Return ``K1/pi`` with the distance of the two radii known to relative accuracy."""
    high = np.maximum(s, eta)
    return np.asarray(eta / high * ellipkm1(apart * (s + eta) / high**2) / np.pi)


def _graded() -> tuple[Array, Array]:
    """Return offsets in (0, 1) and weights of a rule for a logarithm at 0."""
    g, w = leggauss(FINE)
    root = (1.0 + g) / 2.0
    return root**ROOT, ROOT * root ** (ROOT - 1) * w / 2.0
