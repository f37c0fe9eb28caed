r"""Half-integrals on one annulus in fixed point.

Let the annulus have the width w in ``s**2``, and let ``a`` and ``b = 1 - a`` be the distances of a
point from its inner and outer end in ``s**2``, over w. Panels are equal in ``X = ln(a/b)``, and so
graded to both ends. With X of z, and Y and b_t of t^2,

    1/2 int_{t^2} psi dz / sqrt(z - t^2) = sqrt(w / b_t) / 2 int_Y F psi dX / sqrt(1 - exp(Y - X)),

both integrals up to the outer end, with the weight ``F = sqrt(a) b``: a convolution with one kernel
for both ends, and for the integral from the other side. The quotient ``a/b``, next to the outer end
``b/a``, is called the odds; in the tail at either end functions are polynomials in its root.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, log
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from spectral_contact.precise.fixed import Fixed, Ints, root_rule
from spectral_contact.threads import cached_property

Array = NDArray[np.float64]


class Near(NamedTuple):
    """Integrals at the nodes of a cell over itself and over the next one.

    Attributes
    ----------
    inner, panel, outer : ndarray
        Of the inner tail, a panel and the outer tail over themselves.
    first, next, last : ndarray
        Of the inner tail over the first panel, of a panel over the next one, and of the last panel
        over the outer tail.
    """

    inner: Any
    first: Any
    panel: Any
    next: Any
    last: Any
    outer: Any

    def at(self, cell: int, panels: int) -> list[Any]:
        """Return the integrals at the nodes of a cell over itself and over any next one."""
        if cell == 0:
            return [self.inner, self.first]
        if cell < panels:
            return [self.panel, self.next]
        if cell == panels:
            return [self.panel, self.last]
        return [self.outer]


class Blocks:
    """What meshes with panels of one width share: integrals over a cell itself and the next one.

    A cell is a panel or a tail; each has the same number of Gauss points.

    Parameters
    ----------
    fixed : Fixed
    width : float
        Of the panels in X.
    points : int
        Nodes of a cell.
    digits : int
        Relative accuracy aimed at.

    Attributes
    ----------
    offset, root : ndarray of int, shape (points,)
        The nodes: in a panel, distances in X from its start; in a tail, the root of the odds over
        the root of the odds at which the tail begins.
    weights : ndarray of int, shape (points,)
        Gauss weights on [-1, 1].
    expand : ndarray of int, shape (points, points)
        From values at the nodes to Legendre coefficients.
    limit : ndarray of int, shape (points,)
        From values at the nodes of the inner tail to the value at the inner end.
    near : Near
        Each of them a matrix of shape (points, points).
    """

    def __init__(self, fixed: Fixed, width: float, points: int, digits: int) -> None:
        f = self.fixed = fixed
        self.width = width
        self.points = points
        self.digits = digits
        h = self._h = f.of(width)
        g, self.weights = f.gauss(points)
        self.offset = f.times(h, f.one + g) // 2
        self.root = (f.one + g) // 2
        self.expand = f.expansion(points)
        self.limit = (1 - 2 * (np.arange(points) % 2)).astype(object) @ self.expand
        self._rule = points + ceil(0.75 * digits) + 8
        to_end = h - self.offset
        depth = -2 * f.map(f.mp.log, self.root)
        one = 0 * g + f.one
        shallow = f.exp(to_end // 2)
        full = f.map(f.mp.acosh, f.over(one, self.root))
        quarter = f.map(f.mp.asin, f.over(one, shallow))
        right = f.times(one, f.of(f.mp.pi)) // 2
        # the nodes of an outer tail are in the order of X, too: against that of the root
        self.near = Near(
            inner=self._rooted(self.root, full, f.mp.cosh),
            first=self._convolved(depth, depth + h, -depth),
            panel=self._convolved(0 * to_end, to_end, self.offset),
            next=self._convolved(to_end, to_end + h, -to_end),
            last=self._rooted(shallow, quarter, f.mp.sin, shallow)[:, ::-1],
            outer=self._rooted(self.root, right, f.mp.sin, self.root)[::-1, ::-1],
        )
        # two cells on and farther the kernel is a power series
        terms = ceil((digits + 6) * log(10.0) / width) + 1
        exponents = np.arange(terms, dtype=object)[:, None]
        binomials = [f.one // 2]
        for j in range(1, terms):
            binomials.append(binomials[-1] * (2 * j - 1) // (2 * j))
        self.decay = f.exp(-h * exponents[:, 0])
        self.sources = f.exp(-exponents * self.offset)
        self.tail_sources = f.exp(-exponents * depth)
        factors = np.array(binomials)[:, None]
        self.targets = f.times(factors, f.exp(-exponents * (2 * h - self.offset)))
        self.tail_targets = f.times(factors, f.exp(-exponents * (h + depth)))

    @cached_property
    def poled(self) -> Near:
        """`near` for functions that in the outer tail are polynomials over the root of the odds."""
        f = self.fixed
        to_end = self._h - self.offset
        shallow = f.exp(to_end // 2)
        quarter = f.map(f.mp.asin, f.over(0 * to_end + f.one, shallow))
        right = f.of(f.mp.pi) // 2 + 0 * to_end
        return self.near._replace(
            last=self._rooted(shallow, quarter, f.mp.sin, shallow, 0)[:, ::-1],
            outer=self._rooted(self.root, right, f.mp.sin, self.root, 0)[::-1, ::-1],
        )

    def doubles(self, *, pole: bool) -> Near:
        """Return `poled` or `near` in double precision."""
        return Near(*map(self.fixed.floats, self.poled if pole else self.near))

    def _convolved(self, lower: Ints, upper: Ints, shift: Ints) -> Ints:
        """Return integrals over ``lower < X - Y < upper``; the panel starts at ``Y - shift``."""
        f = self.fixed
        u, weights, _ = root_rule(f, self._rule, lower, upper)
        local = 2 * f.over(u + shift[:, None], self._h) - f.one
        return self.interpolated(weights, local)

    def _rooted(self, root: Ints, top: Ints, of: Any, factor: Any = None, power: int = 1) -> Ints:
        """Return ``int_0^top psi v**power factor dtheta`` in a tail.

        There v, the root of the odds over that where the tail begins, is `root` times the function
        `of` of theta. It is a matrix: psi is given at the nodes of the tail, and `root`, `top` and
        `factor` at points.
        """
        f = self.fixed
        g, w = f.gauss(2 * self._rule)
        theta = f.times(top[:, None], f.one + g) // 2
        v = f.times(root[:, None], f.map(of, theta))
        weights = f.times(v if power else 0 * v + f.one, top[:, None], w) // 2
        if factor is not None:
            weights = f.times(weights, factor[:, None])
        return self.interpolated(weights, 2 * v - f.one)

    def interpolated(self, weights: Ints, local: Ints) -> Ints:
        """Return the matrix from nodes of a cell to integrals, by a rule for each of them."""
        f = self.fixed
        return np.asarray(f.dot(f.moments(weights, local, self.points - 1), self.expand))


class AnnulusMesh:
    """Cells on an annulus of width 1 in ``s**2``, from the inner end to the outer.

    Parameters
    ----------
    blocks : Blocks
    before, after : int
        Numbers of panels inside and outside the middle, ``a = b``.
    pole : bool
        Whether `half_integral` is of functions that have a pole at the outer end, in the root of
        the odds. In a mesh that is reflected the centre is the outer end, where ``1/t`` has one.

    Attributes
    ----------
    inner_end, outer_end : int
        Odds ``a/b`` and ``b/a`` at which the tails begin.
    above, below : ndarray of int, shape (cells, points)
        Distances ``a`` and ``b`` of the nodes from the ends.
    weights : ndarray of int, shape (cells, points)
        Weights of ``ds**2``.
    """

    def __init__(self, blocks: Blocks, before: int, after: int, *, pole: bool = False) -> None:
        f = self.fixed = blocks.fixed
        self.blocks = blocks
        self.before = before
        self.after = after
        self._pole = pole
        h = f.of(blocks.width)
        self.panels = before + after
        self.inner_end = f.exp(-h * before)
        self.outer_end = f.exp(-h * after)
        root = blocks.root
        x = h * np.arange(-before, after, dtype=object)[:, None] + blocks.offset
        odds = np.empty((self.panels + 2, blocks.points), dtype=object)
        odds[0] = f.times(self.inner_end, root, root)
        odds[1:-1] = f.exp(-abs(x))
        odds[-1] = f.times(self.outer_end, root, root)[::-1]
        small = f.over(odds, f.one + odds)
        large = f.over(f.one, f.one + odds)
        inside = np.arange(len(odds))[:, None] <= before
        self.above = np.where(inside, small, large)
        self.below = np.where(inside, large, small)
        dx = np.empty_like(self.above)
        dx[1:-1] = f.times(blocks.weights, h) // 2
        dx[0] = f.over(blocks.weights, root)
        dx[-1] = dx[0][::-1]
        self._dx = dx
        self.weights = f.times(self.above, self.below, dx)

    @cached_property
    def reflected(self) -> AnnulusMesh:
        """The same mesh with its ends exchanged."""
        return AnnulusMesh(self.blocks, self.after, self.before)

    @cached_property
    def _near_weight(self) -> Ints:
        """What psi is multiplied by to become the function that `Blocks.near` integrates."""
        f = self.fixed
        weight = f.times(f.sqrt(self.above), self.below)
        for k, part, end in (
            (0, self.below, f.sqrt(self.inner_end)),
            (-1, self.above, self.outer_end),
        ):
            weight[k] = f.times(part[k], f.sqrt(part[k]), end)
        if self._pole:
            weight[-1] = f.times(self.above[-1], f.sqrt(self.outer_end), f.sqrt(self.below[-1]))
        return np.asarray(weight)

    @cached_property
    def _far_weight(self) -> Ints:
        """Weights of ``F dX``, for the power series between cells that are not neighbours."""
        f = self.fixed
        return np.asarray(f.times(f.sqrt(self.above), self.below, self._dx))

    def half_integral(self, values: Ints) -> Ints:
        """Return ``1/2 int_{z > t^2} psi dz / sqrt(z - t^2)`` at the nodes, of values there."""
        f = self.fixed
        b = self.blocks
        cells = len(values)
        blocks = b.poled if self._pole else b.near
        weighted = f.times(values, self._near_weight)
        masses = f.times(values, self._far_weight)
        result = np.empty_like(values)
        far = 0 * b.decay
        for c in reversed(range(cells)):
            total = 0 * b.offset
            for block, source in zip(blocks.at(c, self.panels), weighted[c : c + 2], strict=True):
                total = total + block @ source
            if c + 2 < cells:
                sources = b.sources if c + 3 < cells else b.tail_sources[:, ::-1]
                far = f.times(b.decay, far) + f.dot(sources, masses[c + 2])
                total = total + far @ (b.targets if c else b.tail_targets)
            result[c] = total >> f.bits
        return np.asarray(f.over(result, f.sqrt(self.below)))

    @cached_property
    def central(self) -> AnnulusMesh:
        """The reflected mesh for functions that have a pole in s at the centre."""
        return AnnulusMesh(self.blocks, self.after, self.before, pole=True)

    def inner_integral(self, values: Ints, *, pole: bool = False) -> Ints:
        """Return ``1/2 int_{z < s^2} phi dz / sqrt(s^2 - z)`` at the nodes, of values there.

        With `pole`, phi has a pole in s at the centre, where the mesh begins.
        """
        mesh = self.central if pole else self.reflected
        return mesh.half_integral(values[::-1, ::-1])[::-1, ::-1]

    def limits(self, values: Ints) -> tuple[Any, Any]:
        """Return the values at the inner and the outer end, from those at the nodes."""
        f = self.fixed
        limit = self.blocks.limit
        return f.dot(limit, values[0]), f.dot(limit[::-1], values[-1])

    def matrix(self) -> Array:
        """Return the matrix of `half_integral` in double precision, (nodes, nodes)."""
        f = self.fixed
        m = self.blocks.points
        x = -np.log(f.floats(self.below) / f.floats(self.above)).ravel()
        cell = np.arange(len(x)) // m
        far = cell[None, :] - cell[:, None] >= 2
        matrix = np.zeros(far.shape)
        rows, columns = np.nonzero(far)
        matrix[rows, columns] = 0.5 / np.sqrt(-np.expm1(x[rows] - x[columns]))
        matrix *= f.floats(self._far_weight).ravel()
        weight = f.floats(self._near_weight).ravel()
        blocks = self.blocks.doubles(pole=self._pole)
        for c in range(self.panels + 2):
            for k, block in enumerate(blocks.at(c, self.panels)):
                own = slice(c * m, (c + 1) * m)
                part = slice((c + k) * m, (c + k + 1) * m)
                matrix[own, part] = block * weight[part]
        return np.asarray(matrix / np.sqrt(f.floats(self.below)).reshape(-1, 1))

    def inner_matrix(self, *, pole: bool = False) -> Array:
        """Return the matrix of `inner_integral` in double precision, (nodes, nodes)."""
        return (self.central if pole else self.reflected).matrix()[::-1, ::-1]

    def series(self, values: Ints) -> PreciseAnnulusSeries:
        """Return the function through values at the nodes."""
        f = self.fixed
        ordered = values.copy()
        ordered[-1] = values[-1, ::-1]
        return PreciseAnnulusSeries(self, f.dot(ordered, self.blocks.expand.T))


@dataclass(frozen=True)
class PreciseAnnulusSeries:
    """A Legendre series on the cells of an annulus.

    Attributes
    ----------
    mesh : AnnulusMesh
    table : ndarray of int, shape (cells, points)
        In the tails, of the root of the odds.
    """

    mesh: AnnulusMesh
    table: Ints

    def at(self, above: Any, below: Any) -> Ints:
        """Evaluate where the distances in ``s**2`` from the two ends are these, 1-d arrays."""
        f = self.mesh.fixed
        mesh = self.mesh
        h = f.of(mesh.blocks.width)
        last = mesh.panels + 1
        inside = (above < below).astype(bool)
        odds = f.over(np.minimum(above, below), np.maximum(above, below))
        x = np.empty(len(odds), dtype=object)
        for rows, end, beyond in (
            (inside, mesh.inner_end, -mesh.before * h - 1),
            (~inside, mesh.outer_end, mesh.after * h),
        ):
            on_panels = rows & (odds >= end).astype(bool)
            x[rows] = beyond
            x[on_panels] = f.map(f.mp.log, odds[on_panels]) * (1 if beyond < 0 else -1)
        own = np.clip([int(v // h) + mesh.before + 1 for v in x], 0, last)
        values = np.empty(len(x), dtype=object)
        for c in np.unique(own):
            rows = own == c
            if 0 < c < last:
                local = 2 * f.over(x[rows] - (int(c) - 1 - mesh.before) * h, h) - f.one
            else:
                end = mesh.inner_end if c == 0 else mesh.outer_end
                local = 2 * f.sqrt(f.over(odds[rows], end)) - f.one
            values[rows] = f.series(local, self.table[c])
        return values
