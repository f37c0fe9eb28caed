"""Galerkin operators of a disk in fixed point, on the panels of `spectral.panels`.

The half-integral of a panel is that of `spectral.abel`, with rules that converge to any number of
digits. The coefficients are found by iterative refinement: a factorisation in double precision, and
residuals in fixed point, gain some twelve digits a sweep. *Deeper* is nearer to the rim.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from math import ceil, log
from typing import Any

import numpy as np

from spectral_contact.errors import ConvergenceError
from spectral_contact.precise.fixed import Fixed, FixedRule, Ints, root_rule
from spectral_contact.spectral.panels import LogPanels
from spectral_contact.spectral.spaces import unit_space
from spectral_contact.spectral.tuning import TAIL_TERMS

_LN10 = log(10.0)
#: Refinement that takes more sweeps than this has stalled.
MOST_SWEEPS = 30


@dataclass(frozen=True)
class PreciseMesh:
    """Panels, degrees and precision for a number of digits.

    Attributes
    ----------
    panels : LogPanels
    degrees : tuple of int
        Highest degree on each panel.
    digits : int
        Relative accuracy aimed at.
    """

    panels: LogPanels
    degrees: tuple[int, ...]
    digits: int

    @classmethod
    def graded(
        cls,
        digits: int,
        layer: float,
        *,
        rate: float = 1.0,
        width: float = 2.0,
        power: float = 0.0,
        lowest: int = 4,
    ) -> PreciseMesh:
        """Return the mesh of a solution that settles like ``exp(-rate x)`` beyond `layer`.

        `layer` is the x at which the layer next to the rim begins. `power` is that of d in the
        endpoint weight. No degree is below `lowest`. Beyond the layer degrees fall in proportion to
        the part of the digits that is still missing there; the formula was found by trial.
        """
        top = ceil((1.3 * digits + 8.0) * np.sqrt(width / 2.0))
        settle = (digits * _LN10 + 4.0) / rate
        panels = ceil((layer + settle) / width)
        x = width * np.arange(panels)
        missing = np.clip(1.0 - (x - layer - 4.0) / settle, 0.0, 1.0)
        degrees = np.maximum(np.ceil(top * missing) + 2, lowest).astype(int)
        mesh = LogPanels(panels, width, int(degrees.max()), power)
        return cls(mesh, tuple(degrees.tolist()), digits)

    @property
    def depth(self) -> float:
        """The ``x`` at which the tail begins."""
        return self.panels.count * self.panels.width


@dataclass(frozen=True)
class PreciseSeries:
    """A Legendre series on panels in ``x = -ln d``, with a tail polynomial in ``d``.

    Attributes
    ----------
    fixed : Fixed
    width : float
    table : ndarray of int, shape (panels, terms)
    tail : ndarray of int
    """

    fixed: Fixed
    width: float
    table: Ints
    tail: Ints

    def at(self, d: Ints, x: Ints | None = None) -> Ints:
        """Evaluate at distances d of any shape. If `x`, their ``-ln d``, is given, it is used."""
        f = self.fixed
        shape = np.shape(d)
        d = np.ravel(d)
        deep = f.floats(d) < np.exp(-len(self.table) * self.width) * (1.0 - 1e-9)
        if x is None:
            x = d.copy()
            x[~deep] = -f.map(f.mp.log, d[~deep])
        else:
            x = np.ravel(x)
        values = np.empty(len(d), dtype=object)
        h = f.of(self.width)
        panel_of_point = np.where(deep, -1, 0)
        panel_of_point[~deep] = [min(int(v // h), len(self.table) - 1) for v in x[~deep]]
        for j in np.unique(panel_of_point):
            rows = panel_of_point == j
            if j < 0:
                end = f.exp(-len(self.table) * h)
                local = 2 * f.over(d[rows], end) - f.one
                series = self.tail
            else:
                local = 2 * f.over(x[rows] - int(j) * h, h) - f.one
                series = self.table[j]
            values[rows] = f.series(local, series)
        return values.reshape(shape)

    @property
    def limit(self) -> Any:
        """Value at ``d = 0``."""
        return sum(c if k % 2 == 0 else -c for k, c in enumerate(self.tail))


class FarField:
    """Integrals over panels two places away and more, in time linear in the number of panels.

    There the kernel ``1/sqrt(1 - e)``, ``e = exp(-u)``, is a power series in e, and e is a product
    of three factors: one for the point, one for the source, and one for the panels between them.

    Parameters
    ----------
    disk : Disk
    weight, near : ndarray of int, shape (rule_points,)
        The factors of the integrand and of e for the places of the source in its panel.
    lead : int
        The integrand is ``exp(-lead u)`` times the series.
    offsets : list of ndarray of int
        Sets of points, as distances in x of each from the end of the panel that it is on.

    Attributes
    ----------
    points : list of ndarray of int, shape (points, terms)
    sources : ndarray of int, shape (terms, degree + 1)
    decay : ndarray of int, shape (terms,)
        Factors of the terms for one panel between.
    """

    def __init__(
        self, disk: Disk, weight: Ints, near: Ints, lead: Any, offsets: list[Ints]
    ) -> None:
        f = disk.fixed
        h = disk.fixed.of(disk.panels.width)
        self._fixed = f
        terms = ceil((disk.mesh.digits + 6) * _LN10 / float(disk.panels.width)) + 1
        g, w = f.gauss(disk.rule_points)
        basis = f.legendre(g, disk.panels.degree)
        weight = f.times(w, h, weight) // 4
        sources = []
        binomial = f.one  # of 2j over j, divided by 4**j: the coefficients of the kernel
        for j in range(terms):
            sources.append(f.times(binomial, f.dot(weight, basis)))
            weight = f.times(weight, near)
            binomial = binomial * (2 * j + 1) // (2 * j + 2)
        exponents = lead + f.one * np.arange(terms, dtype=object)
        self.sources = np.array(sources)
        self.points = [f.exp(-f.times(x[:, None], exponents)) for x in offsets]
        self.decay = f.exp(-f.times(h, exponents))
        self.zero_sums = 0 * self.decay

    def at_next_panel(self, far: Ints, coefficients: Ints) -> Ints:
        """Return the sums at the points of a panel.

        They follow from `far`, those of its neighbour, and from the coefficients of the panel
        beyond the neighbour, which the neighbour's sums do not have yet.
        """
        f = self._fixed
        added = f.dot(self.sources[:, : len(coefficients)], coefficients)
        return np.asarray(f.times(self.decay, far + added))


class Disk:
    """Half-integrals on a mesh, and the solution of the equations that have them.

    Parameters
    ----------
    mesh : PreciseMesh
    fixed : Fixed

    Attributes
    ----------
    x, d, rest : ndarray of int
        The nodes: ``d = 1 - t**2`` and ``rest = 1 - d`` of all, ``x`` of those on panels.
    weights : ndarray of int
        Weights of ``dt``.
    end : int
        Distance at which the tail begins.
    """

    def __init__(self, mesh: PreciseMesh, fixed: Fixed) -> None:
        self.mesh = mesh
        self.fixed = fixed
        self.panels = mesh.panels
        self._h = fixed.of(mesh.panels.width)
        self.end = fixed.exp(-mesh.panels.count * self._h)
        self._place_nodes()
        self._blocks = [self._near_blocks(one) for one in (self._first_end, self._other_end)]
        self._far = self._far_field()
        self._tails = self._tail_half_integrals()
        self._masses = [self._panel_mass(decay) for decay in (1, 2)]

    # nodes

    def _place_nodes(self) -> None:
        """Set nodes and weights.

        Half-integrals have a root at the deep end of every panel, and dt is an inverse root at the
        centre: substitutions remove them.
        """
        f = self.fixed
        p = self.panels.count
        h = self._h
        count = 2 * self.panels.degree + ceil(0.7 * self.mesh.digits) + 8
        g, w = f.gauss(count + 10)
        phi = f.times(f.of(f.mp.pi) // 4, f.one + g)
        sine = f.map(f.mp.sin, phi)
        cosine = f.map(f.mp.cos, phi)
        first_x = f.times(h, sine, sine)
        first_dx = f.times(w, f.of(f.mp.pi) // 2, h, sine, cosine)
        g, w = f.gauss(count)
        v = (f.one + g) // 2
        self._first_end = f.times(h, cosine, cosine)
        self._other_end = f.times(h, v, v)
        last = h * np.arange(2, p + 1, dtype=object)[:, None]
        self.x = np.concatenate([first_x, (last - self._other_end).ravel()])
        dx = np.concatenate([first_dx, np.tile(f.times(w, h, v), p - 1)])
        d = f.exp(-self.x)
        rest = -f.map(f.mp.expm1, -self.x)
        tail = f.times(self.end, v, v)
        weights = f.over(f.times(dx, d), 2 * f.sqrt(rest))
        tail_weights = f.over(f.times(w, v, self.end), 2 * f.sqrt(f.one - tail))
        self.d = np.concatenate([d, tail])
        self.rest = np.concatenate([rest, f.one - tail])
        self.weights = np.concatenate([weights, tail_weights])
        root = f.sqrt(self.d)
        self._root = root if self.panels.power == 0.0 else np.full(len(root), f.one, dtype=object)
        bounds = [0, len(first_x)]
        bounds += [len(first_x) + k * count for k in range(1, p)]
        self._rows = [slice(a, b) for a, b in pairwise(bounds)]

    # half-integrals

    @property
    def rule_points(self) -> int:
        """Gauss points that integrate over a panel to rounding."""
        return self.panels.degree + ceil(0.75 * self.mesh.digits) + 8

    def root_rule(self, lower: Ints, upper: Ints) -> FixedRule:
        """Return the `root_rule` for functions on a panel."""
        return root_rule(self.fixed, self.rule_points, lower, upper)

    def _near_blocks(self, to_end: Ints) -> list[Ints]:
        """Return the half-integrals of a panel, and of the next deeper one, at points of the first.

        `to_end` has the distances of the points in x from the end of their panel.
        """
        f = self.fixed
        h = self._h
        blocks = []
        lower = 0 * to_end
        upper = to_end
        for k in range(2):
            u, weights, fall = self.root_rule(lower, upper)
            values = f.times(fall if self.panels.power == 0.0 else f.sqrt(fall), weights)
            local = f.one - 2 * f.over(to_end[:, None] + k * h - u, h)
            blocks.append(f.moments(values, local, self.panels.degree))
            lower = upper
            upper = upper + h
        return blocks

    def _far_field(self) -> FarField:
        """Return the half-integrals over the panels two places deeper and more."""
        f = self.fixed
        lead = f.of(1.0 + self.panels.power)
        from_start = f.times(self._h, f.one + f.gauss(self.rule_points)[0]) // 2
        weight = f.exp(-f.times(lead, from_start))
        ends = [self._first_end, self._other_end]
        return FarField(self, weight, f.exp(-from_start), lead, ends)

    def _tail_half_integrals(self) -> Ints:
        """Return the half-integrals of the tail polynomials at all nodes."""
        f = self.fixed
        d = self.d
        end = self.end
        if self.panels.power == 0.0:
            # with d' = d - w^2 the integrand is a polynomial in w
            g, w = f.gauss(TAIL_TERMS + 1)
            far = f.sqrt(np.maximum(d - end, 0))
            root = f.sqrt(d)
            span = np.where(d > end, f.over(end, root + far), root)[:, None]
            inner = f.times(span, f.one - g) // 2
            source = f.times(inner, 2 * root[:, None] - inner)
            values = f.times(span, w) // 2
        else:
            g, w = f.gauss(ceil(0.7 * self.mesh.digits) + 12)
            ratio = np.minimum(f.over(end, d), f.one)
            phi = f.map(f.mp.asin, f.sqrt(ratio))[:, None]
            sine = f.map(f.mp.sin, f.times(phi, f.one + g) // 2)
            source = f.times(d[:, None], sine, sine)
            values = f.times(phi, w) // 2
        return f.moments(values, 2 * f.over(source, end) - f.one, TAIL_TERMS - 1)

    def half_integral(self, coefficients: Ints) -> Ints:
        """Return the half-integral at the nodes."""
        f = self.fixed
        (table, tail) = self.split(coefficients)
        values = f.dot(self._tails, tail)
        far = self._far.zero_sums
        terms = self._terms
        for i, rows in reversed(list(enumerate(self._rows))):
            if i + 2 < len(table):
                far = self._far.at_next_panel(far, table[i + 2, : terms[i + 2]])
            total = self._far.points[min(i, 1)] @ far
            for block, j in zip(self._blocks[min(i, 1)], range(i, len(table)), strict=False):
                total = total + block[:, : terms[j]] @ table[j, : terms[j]]
            values[rows] += f.times(total >> f.bits, self._root[rows])
        return np.asarray(values)

    def moments(self, density: Ints) -> Ints:
        """Return the integrals ``dt`` of a density at the nodes times all half-integrals.

        It is the transpose of `half_integral`.
        """
        f = self.fixed
        far = self._far.zero_sums
        terms = self._terms
        result = np.zeros(self.panels.size, dtype=object)
        table, tail = self.split(result)
        tail += f.dot(density, self._tails)
        # sums over the nodes of the last two panels, which are not yet two panels away
        waiting = [far, far]
        for i, rows in enumerate(self._rows):
            scaled = f.times(density[rows], self._root[rows])
            far = f.times(self._far.decay, far + waiting[0])
            waiting = [waiting[1], f.dot(scaled, self._far.points[min(i, 1)])]
            table[i, : terms[i]] += f.dot(far, self._far.sources[:, : terms[i]])
            for block, j in zip(self._blocks[min(i, 1)], range(i, len(table)), strict=False):
                table[j, : terms[j]] += f.dot(scaled, block[:, : terms[j]])
        return result

    @property
    def _terms(self) -> list[int]:
        """Numbers of functions on the panels."""
        return [n + 1 for n in self.mesh.degrees]

    def split(self, coefficients: Ints) -> tuple[Ints, Ints]:
        """Return views of the coefficients: panels as (panels, degree + 1), and the tail."""
        table = coefficients[:-TAIL_TERMS].reshape(self.panels.count, -1)
        return table, coefficients[-TAIL_TERMS:]

    # mass

    def _panel_mass(self, decay: int) -> Ints:
        """Return ``int psi_i psi_j exp(-decay x) dx`` on the first panel."""
        f = self.fixed
        g, w = f.gauss(self.rule_points)
        basis = f.legendre(g, self.panels.degree)
        weight = f.times(w, self._h, f.exp(-decay * f.times(self._h, f.one + g) // 2)) // 2
        return np.asarray(f.dot(f.times(basis, weight[:, None]).T, basis))

    def mass(self, coefficients: Ints, tangential: bool) -> Ints:
        """Return the products with all functions in ``s ds``, if `tangential` in ``s^3 ds``."""
        f = self.fixed
        (table, tail) = self.split(coefficients)
        result = np.zeros(self.panels.size, dtype=object)
        one, two = self._masses
        out, out_tail = self.split(result)
        for j, terms in enumerate(self._terms):
            d = f.exp(-j * self._h)
            value = f.dot(one[:terms, :terms], table[j, :terms])
            if tangential:
                value = value - f.times(d, f.dot(two[:terms, :terms], table[j, :terms]))
            out[j, :terms] = f.times(d, value) // 2
        g, w = f.gauss(TAIL_TERMS + 2)
        basis = f.legendre(g, TAIL_TERMS - 1)
        d = f.times(self.end, f.one + g) // 2
        weight = f.times(w, self.end) // 4
        if tangential:
            weight = f.times(weight, f.one - d)
        out_tail[:] = f.dot(f.times(weight, f.dot(basis, tail)), basis)
        return result

    # solving

    def solve(self, compliance: Any, target: Any, *, tangential: bool) -> Ints:
        """Return the coefficients that minimise ``int (F - target)^2 W / pi + compliance |u|^2``.

        F is the half-integral of the function u, W is ``dt``, or ``t^2 dt`` if `tangential`, and
        the norm is that of `mass`.

        Parameters
        ----------
        compliance : int
            In fixed point.
        tangential : bool
            Whether the kernel is K2, for ``q = s u``, and not K1.
        target : int or ndarray of int
            What the half-integral should be at the nodes.

        Raises
        ------
        ConvergenceError
            If refinement stalls before the digits of the mesh are reached.
        """
        f = self.fixed
        weights = f.over(self.weights, f.of(f.mp.pi))
        if tangential:
            weights = f.times(weights, self.rest)
        space = unit_space(self.panels, self.mesh.degrees, shear=tangential)
        factored = space.factor(float(f.numbers(compliance)))
        coefficients = np.zeros(self.panels.size, dtype=object)
        difference = np.zeros(len(self.d), dtype=object) + target
        mass_term = 0
        goal = 10.0 ** -(self.mesh.digits + 2)
        for _ in range(MOST_SWEEPS):
            residual = self.moments(f.times(weights, difference)) - mass_term
            double_step = np.zeros(len(coefficients))
            double_step[space.index] = factored.cholesky.solve(f.floats(residual)[space.index])
            step = f.of(double_step)
            coefficients = np.asarray(coefficients + step)
            if self.relative_step(step, coefficients) <= goal:
                return coefficients
            difference = target - self.half_integral(coefficients)
            if compliance:
                mass_term = f.times(compliance, self.mass(coefficients, tangential))
        raise ConvergenceError(
            f"refinement stalls before {self.mesh.digits} digits", "ask for fewer digits"
        )

    def relative_step(self, step: Ints, coefficients: Ints) -> float:
        """Return the largest step on a panel over the largest coefficient, of the worst panel."""
        shares = [
            float(self.fixed.numbers(self.fixed.over(np.abs(a).max(), np.abs(b).max() + 1)))
            for part in zip(self.split(step), self.split(coefficients), strict=True)
            for a, b in zip(np.atleast_2d(part[0]), np.atleast_2d(part[1]), strict=True)
        ]
        return max(shares)

    def shear(self, coefficients: Ints) -> Any:
        """Return ``2 pi int q s ds = 2 pi int t F dt`` of the function ``q = s u``."""
        f = self.fixed
        density = f.times(2 * f.of(f.mp.pi), self.weights, f.sqrt(self.rest))
        return f.dot(density, self.half_integral(coefficients))

    def series(self, coefficients: Ints) -> PreciseSeries:
        """Return the function that the coefficients stand for, without the endpoint weight."""
        return PreciseSeries(self.fixed, self.panels.width, *self.split(coefficients))
