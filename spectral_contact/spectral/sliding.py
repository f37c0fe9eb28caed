r"""Elastic coupling with a stick disk and a slip annulus: one unsymmetric system for p and q.

The pressure is unknown everywhere, the traction on the disk, ``q = s u``; on the annulus it is
``f p``. The pressure has panels to the rim from both sides and to the edge. The equations are those
of `coupled`, the normal one on the whole contact and the tangential one on the disk:

    alpha p + N p - kappa int_s^1 q deta = delta,    beta q + T q - kappa g = 0,

with what the slipping traction adds to both. It enters as ``f p / s`` times s, so the factor 1/s is
expanded panel by panel. As there, a correction with the residual in the half-integral restores what
the first-kind parts lose.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lu_factor, lu_solve

from spectral_contact.fields import EDGE, LogSeries, Radius
from spectral_contact.spectral.abel import beyond
from spectral_contact.spectral.annulus import Annulus, Family, Points, gap, sampled_series
from spectral_contact.spectral.coupled import inner_moments, moments
from spectral_contact.spectral.galerkin import disk_operators
from spectral_contact.spectral.jacobi import gauss_rule, legendre_expansion_matrix, legendre_values
from spectral_contact.spectral.panels import LogPanels
from spectral_contact.spectral.transforms import transforms

__all__ = ["Sliding", "SlidingDisk"]

Array = NDArray[np.float64]

#: Degrees that the panels have beyond those used, for the factor 1/s.
_SPARE = 4
_CORRECTIONS = 6


@dataclass(frozen=True, slots=True)
class Sliding:
    """A solution for unit load; coefficients are of the whole bases, zero where not used.

    Attributes
    ----------
    approach, total_shear : float
    disk, inner, outer : ndarray
        Coefficients of the pressure on the disk, above its rim, and below the edge.
    traction : ndarray
        Of ``u = q/s`` on the disk.
    left : float
        Estimate of what rounding leaves of the error of the disk's fields, relative.
    """

    approach: float
    total_shear: float
    disk: Array
    inner: Array
    outer: Array
    traction: Array
    left: float

    def toward(self, other: Sliding, share: float) -> Sliding:
        """Return the combination ``(1 - share) self + share other``."""
        values: dict[str, Any] = {
            one.name: (1.0 - share) * getattr(self, one.name) + share * getattr(other, one.name)
            for one in fields(self)
        }
        return Sliding(**values)


class SlidingDisk:
    """The operators of a disk that sticks and of the annulus around it, to the edge.

    Parameters
    ----------
    radius : Radius
        Rim of the disk.
    disk, inner, outer : LogPanels
        Of both fields on the disk, and of the pressure above the rim and below the edge.
    degrees : tuple of tuple of int
        Highest degrees on the panels of each.
    """

    def __init__(
        self,
        radius: Radius,
        panels: tuple[LogPanels, LogPanels, LogPanels],
        degrees: tuple[tuple[int, ...], tuple[int, ...], tuple[int, ...]],
    ) -> None:
        self.radius = radius
        own, *rest = (
            replace(one, degree=max(used) + _SPARE)
            for one, used in zip(panels, degrees, strict=True)
        )
        self.panels = own, *rest
        self.half = gap(radius, EDGE) / 2.0
        self.families = (
            Family(radius, 1, self.half, rest[0]),
            Family(EDGE, -1, self.half, rest[1]),
        )
        self._index = [_index(one, used) for one, used in zip(self.panels, degrees, strict=True)]
        self.count, self._inside = sum(map(len, self._index)), len(self._index[0])
        self._disk = disk_operators(own)
        self._own = self._disk.half_integral[:, self._index[0]]
        self._over_s = [
            _over_radius(one)[:, used]
            for one, used in zip(self.families, self._index[1:], strict=True)
        ]
        self._assemble_disk()
        self._outside = [self._at_nodes(one) for one in self.families]
        self._assemble()

    @property
    def unknowns(self) -> int:
        """Number of unknowns."""
        return self.count + self._inside

    def _halves(self, points: Points) -> tuple[Array, Array]:
        """Return half-integrals of the annulus's pressure, and of it over s."""
        whole = [one.half_integral(points) for one in self.families]
        used = zip(whole, self._index[1:], strict=True)
        over = zip(whole, self._over_s, strict=True)
        return np.hstack([one[:, k] for one, k in used]), np.hstack([one @ m for one, m in over])

    def _assemble_disk(self) -> None:
        c, nodes = self.radius.value, self._disk.nodes
        points = Points(self.radius, -self.radius.square * nodes.d)
        plain, over = self._halves(points)
        self._root = np.sqrt(nodes.rest)
        self._normal = np.hstack([c * self._own, plain])
        self._tangential = over
        self._weights = nodes.weights * c / np.pi

    def _at_nodes(self, family: Family) -> tuple[Array, ...]:
        """Return t, weights, and half- and inner integrals at the nodes of half the annulus."""
        points, weights = family.nodes()
        t, own = np.sqrt(points.z), self.panels[0]
        depth = -points.before(self.radius) / self.radius.square
        inner = beyond(depth, own.panels, own.width, own.degree)[:, self._index[0]]
        pairs = zip(self.families, self._over_s, strict=True)
        over = np.hstack([one.inner_integral(points) @ m for one, m in pairs])
        plain, _ = self._halves(points)
        return t, weights / (2.0 * np.pi * t), plain, self.radius.value * inner, over

    def _assemble(self) -> None:
        """Assemble what depends on neither compliances, kappa nor friction."""
        n, c = self._inside, self.radius.value
        gram = (self._normal * self._weights[:, None]).T @ self._normal
        for _, weights, plain, *_ in self._outside:
            gram[n:, n:] += (plain * weights[:, None]).T @ plain
        self._gram = gram
        weights = self._weights * self.radius.square * self._root**2
        weighted = c * (self._own * weights[:, None]).T
        self._shear_gram, self._shear_by = c * weighted @ self._own, weighted @ self._tangential
        pairs = list(zip(self.panels, self._index, strict=True))
        extents = 0.5 * self.radius.square, 0.5 * self.half, 0.5 * self.half
        #: ``int p s ds``, ``int q ds`` of the disk, and ``int p ds`` of the annulus
        parts = [e * moments(p)[k] for e, (p, k) in zip(extents, pairs, strict=True)]
        self._load, self._pull = np.concatenate(parts), parts[0]
        over = [
            0.5 * self.half * moments(one.panels) @ m
            for one, m in zip(self.families, self._over_s, strict=True)
        ]
        self._drag = np.concatenate(over)
        self._lifted = self._slip_lift(parts, over)
        index = self._index[0]
        inner = inner_moments(self.panels[0], self.panels[0])[np.ix_(index, index)]
        self._coupling = inner * (0.25 * c**4)
        self._shear = 2.0 * np.pi * c**3 * (self._disk.nodes.weights * self._root) @ self._own
        self._masses = [
            e * one.mass(k, 1.0, 0.0) if one.power == 0.0 else np.zeros((len(k), len(k)))
            for e, (one, k) in zip(extents, pairs, strict=True)
        ]
        self._shear_mass = c**4 * self.panels[0].mass(index, 0.5, -0.5)

    def _slip_lift(self, loads: list[Array], drags: list[Array]) -> Array:
        """Return ``int_annulus p(eta) int_0^eta phi s ds deta`` for all phi and p."""
        n = self._inside
        lift = np.zeros((self.count, self.count))
        middle = n + len(self._index[1])
        lift[:n, n:] = np.outer(loads[0], self._drag)
        lift[n:middle, middle:] = np.outer(loads[1], drags[1])
        lift[middle:, middle:] = np.outer(loads[2], drags[1])
        # in the half above the rim what lies deeper comes first, in the other half last
        for k, (sign, block) in enumerate(((1.0, slice(n, middle)), (-1.0, slice(middle, None)))):
            own = inner_moments(self.families[k].panels, self.families[k].panels)
            inner = own[:, self._index[k + 1]].T @ self._over_s[k]
            lift[block, block] += sign * 0.25 * self.half**2 * inner
        return lift

    def solve(
        self,
        alpha: float,
        beta: float,
        kappa: float,
        friction: float,
        size: Callable[[Array, Array, Array, Array], float],
        tolerance: float,
    ) -> Sliding:
        """Solve for unit load.

        Parameters
        ----------
        alpha, beta : float
            Compliances, at least 0.
        kappa : float
            The coupling.
        friction : float
            ``q/p`` on the annulus.
        size : callable
            How large a change on the disk is: of the coefficients of p, u, and their changes.
        tolerance : float
            Corrections end where less than a share of this is left.
        """
        n, count = self._inside, self.count
        ends = np.cumsum([0, *map(len, self._index)])
        matrix = np.empty((count + n, count + n))
        matrix[:count, :count] = self._gram - kappa * friction * self._lifted
        for mass, a, b in zip(self._masses, ends[:-1], ends[1:], strict=True):
            matrix[a:b, a:b] += alpha * mass
        matrix[:count, count:] = matrix[count:, :count] = 0.0
        matrix[:n, count:] = -kappa * self._coupling
        matrix[count:, :n] = -kappa * self._coupling.T
        matrix[count:, n:count] = friction * self._shear_by
        matrix[count:, count:] = self._shear_gram + beta * self._shear_mass
        scale = 1.0 / np.sqrt(np.abs(matrix.diagonal()))
        factor = lu_factor(matrix * scale * scale[:, None], overwrite_a=True, check_finite=False)

        def step(right: Array) -> Array:
            return np.asarray(lu_solve(factor, right * scale, check_finite=False) * scale)

        values = step(np.concatenate([self._load, np.zeros(n)]))
        before, left, parts = np.inf, np.inf, (slice(0, n), slice(count, None))
        for _ in range(_CORRECTIONS):
            change = step(self._residual(values, alpha, beta, kappa, friction))
            values += change
            disk = [self._full(one[part], 0) for one in (values, change) for part in parts]
            moved = size(*disk)
            left = moved * max(0.01, min(moved / before, 1.0))
            before = moved
            if left < 0.02 * tolerance:
                break
        approach = 1.0 / (2.0 * np.pi * float(self._load @ values[:count]))
        values *= approach
        slip = 2.0 * np.pi * friction * float(self._load[n:] @ values[n:count])
        held, inner, outer = (self._full(values[a:b], k) for k, (a, b) in enumerate(pairwise(ends)))
        shear = float(self._shear @ values[count:]) + slip
        return Sliding(approach, shear, held, inner, outer, self._full(values[count:], 0), left)

    def _residual(
        self, values: Array, alpha: float, beta: float, kappa: float, friction: float
    ) -> Array:
        """Return what both equations miss, for unit approach, tested with all functions."""
        n, count, c = self._inside, self.count, self.radius.value
        p, u = values[:count], values[count:]
        pull = 2.0 * float(self._pull @ u + friction * (self._drag @ p[n:]))
        inner = 2.0 * c**2 * self._root * self._disk.outer(self._full(u, 0))
        missed = 2.0 + kappa * (pull - inner) - self._normal @ p
        normal = (self._weights * missed) @ self._normal
        for t, weights, plain, disk, over in self._outside:
            inner = 2.0 * t * (disk @ u + friction * (over @ p[n:]))
            missed = 2.0 + kappa * (pull - inner) - plain @ p[n:]
            normal[n:] += (weights * missed) @ plain
        ends = np.cumsum([0, *map(len, self._index)])
        for mass, a, b in zip(self._masses, ends[:-1], ends[1:], strict=True):
            normal[a:b] -= alpha * (mass @ p[a:b])
        drive = 2.0 / self._root * self._disk.outer(self._full(p[:n], 0))
        missed = kappa * drive - c * (self._own @ u) - friction * (self._tangential @ p[n:])
        weights = self._weights * self.radius.square * self._root**2
        tangential = c * ((weights * missed) @ self._own) - beta * (self._shear_mass @ u)
        return np.concatenate([normal, tangential])

    def displacement(
        self, solution: Sliding, beta: float, kappa: float, friction: float
    ) -> tuple[LogSeries, LogSeries]:
        """Return s times the radial displacement of the annulus, as series to both its ends.

        With ``E = kappa R - G`` it is ``beta s q - (1/pi) int_0^s t^2 E dt / sqrt(s^2 - t^2)``.
        """
        plain = Annulus(self.radius, EDGE, *(replace(one, power=0.0) for one in self.panels[1:]))
        own, lacking, slipping = self.panels[0], [], []
        for family in plain.families:
            points = family.sampling()
            depth = -points.before(self.radius) / self.radius.square
            disk = self.radius.value * beyond(depth, own.panels, own.width, own.degree)
            inner, halves = disk @ solution.disk, np.zeros(len(depth))
            pieces = zip(self.families, (solution.inner, solution.outer), strict=True)
            for k, (source, values) in enumerate(pieces):
                used = values[self._index[k + 1]]
                inner = inner + source.inner_integral(points) @ values
                halves += source.half_integral(points) @ (self._over_s[k] @ used)
            t = np.sqrt(points.z)
            # t E; the displacement has it in the measure dz / 2 = t dt
            lacking.append(2.0 * kappa * inner - friction * t * halves)
            slipping.append(t)
        moved = plain.own_inner_integral(plain.expand(lacking))
        stuck = self._lacking_in_stick(solution, kappa, friction)
        for part, family in zip(
            np.split(moved, [plain.sampling_split]), plain.families, strict=True
        ):
            depth = -family.sampling().before(self.radius) / self.radius.square
            disk = beyond(depth, own.panels, own.width, own.degree)
            part += self.radius.value * (disk @ stuck)
        moved /= -np.pi
        parts = np.split(moved, [plain.sampling_split])
        if beta > 0.0:
            own_parts = zip(self.panels[1:], (solution.inner, solution.outer), strict=True)
            for part, t, (panels, values) in zip(parts, slipping, own_parts, strict=True):
                d = np.concatenate([np.exp(-panels.sampling()).ravel(), panels.tail_sampling()])
                part += beta * friction * t * _series(panels, values)(d)
        first, second = (
            family.series(family.expand(part))
            for family, part in zip(plain.families, parts, strict=True)
        )
        return first, second

    def _lacking_in_stick(self, solution: Sliding, kappa: float, friction: float) -> Array:
        """Return coefficients of ``t E`` on the disk, where it balances ``beta q``."""
        own, c = self.panels[0], self.radius.value
        at = transforms(own)
        root = np.sqrt(1.0 - at.distances)
        _, over = self._halves(Points(self.radius, -self.radius.square * at.distances))
        slipping = (solution.inner, solution.outer)
        used = np.concatenate([v[k] for v, k in zip(slipping, self._index[1:], strict=True)])
        drive = 2.0 / root * at.outer(solution.disk)
        half = c * at.deeper(solution.traction) + friction * (over @ used)
        series = sampled_series(own, c * root * (kappa * drive - half))
        table = series.coefficients[:, : own.degree + 1]
        return np.concatenate([table.ravel(), series.tail[: own.tail_terms]])

    def _full(self, values: Array, part: int) -> Array:
        """Return coefficients in the whole basis of one of the panels."""
        full = np.zeros(self.panels[part].size)
        full[self._index[part]] = values
        return full


def _series(panels: LogPanels, values: Array) -> LogSeries:
    table = values[: -panels.tail_terms].reshape(panels.panels, -1)
    return LogSeries(table, values[-panels.tail_terms :], panels.width, panels.power)


def _index(panels: LogPanels, degrees: tuple[int, ...]) -> NDArray[np.int_]:
    """Return the functions up to these degrees, and the tail."""
    terms = panels.degree + 1
    used = [j * terms + np.arange(n + 1) for j, n in enumerate(degrees)]
    return np.concatenate([*used, np.arange(panels.panels * terms, panels.size)])


def _over_radius(family: Family) -> Array:
    """Return the matrix from the coefficients of a function to those of it over s."""
    panels = family.panels
    terms, points = panels.degree + 1, panels.degree + 11
    expand = legendre_expansion_matrix(points, panels.degree)
    g, _ = gauss_rule(points)
    values = legendre_values(g, panels.degree)
    matrix = np.zeros((panels.size, panels.size))
    x = panels.sampling(points)
    for j in range(panels.panels):
        rows = slice(j * terms, (j + 1) * terms)
        s = np.sqrt(family.points(np.exp(-x[j])).z)
        matrix[rows, rows] = expand @ (values / s[:, None])
    tail = slice(panels.panels * terms, None)
    s = np.sqrt(family.points(np.array([panels.end / 2.0])).z)  # the same to rounding
    matrix[tail, tail] = np.eye(panels.tail_terms) / s
    return matrix
