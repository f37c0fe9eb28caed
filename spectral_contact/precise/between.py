"""Sums over ``1/sqrt(z - t^2)`` from one annulus to another in fixed point.

Both are cut into cells that are graded in the distance from the gap between them. A cell that is
much nearer to the gap than another, or much farther, interacts with it by a power series.
"""

from __future__ import annotations

from math import ceil, log
from typing import Any

import numpy as np
from numpy.typing import NDArray

from spectral_contact.precise.annulus import AnnulusMesh
from spectral_contact.precise.fixed import Fixed, Ints

__all__ = ["Between"]

Array = NDArray[np.float64]

#: Ratio of distances up to which the kernel is a power series.
_RATIO = 0.15


class Between:
    """Half-integrals of an outer annulus at the nodes of an inner one, and the other way round.

    Parameters
    ----------
    inner, outer : AnnulusMesh
    widths : tuple of int
        Theirs, in ``s**2``.
    gap : int
        Between them; 0 if they are neighbours.
    """

    def __init__(
        self, inner: AnnulusMesh, outer: AnnulusMesh, widths: tuple[Any, Any], gap: Any
    ) -> None:
        f = self._fixed = inner.fixed
        # each in cells from the gap outward; t^2 and z to either side of it
        self._first = _Cells(inner.reflected, widths[0], 0)
        self._second = _Cells(outer, widths[1], gap)
        tails = [None, None]
        if gap == 0:
            tails = [_tail(self._first, self._second), _tail(self._second, self._first)]
        self._down = _Sums(f, self._first, self._second, tails[0], None)
        self._up = _Sums(f, self._second, self._first, tails[1], self._down)

    def half_integral(self, values: Ints) -> Ints:
        """Return ``1/2 int psi dz / sqrt(z - t^2)`` over the outer annulus, of values there."""
        return self._down(values)[::-1, ::-1]

    def inner_integral(self, values: Ints) -> Ints:
        """Return ``1/2 int phi dt^2 / sqrt(s^2 - t^2)`` over the inner annulus."""
        return self._up(values[::-1, ::-1])

    def matrix(self) -> Array:
        """Return the matrix of `half_integral` in double precision."""
        return self._down.matrix()[::-1]

    def inner_matrix(self) -> Array:
        """Return the matrix of `inner_integral` in double precision."""
        return self._up.matrix()[:, ::-1]


class _Cells:
    """An annulus seen from the gap: distances of its nodes, and half the weights of ``dz``."""

    def __init__(self, mesh: AnnulusMesh, width: Any, gap: Any) -> None:
        f = mesh.fixed
        self.mesh, self.width = mesh, width
        self.distance = gap + f.times(width, mesh.above)
        self.masses = f.times(width, mesh.weights) // 2
        self.low, self.high = self.distance.min(axis=1), self.distance.max(axis=1)


class _Sums:
    """``sum of masses * values / sqrt(distance + distance)`` over sources at targets."""

    def __init__(
        self, f: Fixed, targets: _Cells, sources: _Cells, tail: Ints | None, back: _Sums | None
    ) -> None:
        self._fixed, self._targets, self._sources = f, targets, sources
        self._tail = tail
        ratio = f.of(_RATIO)
        nearer = f.times(ratio, targets.low)
        self._begin = np.array([int(np.sum(sources.high <= v)) for v in nearer])
        farther = f.over(targets.high, ratio)
        self._end = np.array([int(np.sum(sources.low < v)) for v in farther])
        self._end = np.maximum(self._end, self._begin)
        self._near = {}
        for t in range(len(targets.low)):
            for s in range(self._begin[t], self._end[t]):
                if back is not None and (s, t) in back._near:
                    self._near[t, s] = back._near[s, t].T
                else:
                    total = targets.distance[t][:, None] + sources.distance[s]
                    self._near[t, s] = f.over(f.one, f.sqrt(total))
        terms = ceil((targets.mesh.blocks.digits + 6) / -log(_RATIO, 10.0)) + 1
        binomials = [f.one]
        for j in range(1, terms):
            binomials.append(-binomials[-1] * (2 * j - 1) // (2 * j))
        self._binomials = np.array(binomials)
        root = f.sqrt(sources.distance)
        self._far_masses = f.over(sources.masses, root)
        self._source_powers = [
            self._powers(f.over(sources.distance, sources.high[:, None])),
            self._powers(f.over(sources.low[:, None], sources.distance)),
        ]
        # from cell to cell
        self._rise = self._powers(f.over(sources.high[:-1], sources.high[1:]))
        self._fall = self._powers(f.over(sources.low[:-1], sources.low[1:]))
        self._root = f.sqrt(targets.distance)
        self._target_powers = []
        for t, (first, last) in enumerate(zip(self._begin, self._end, strict=True)):
            pair = [None, None]
            if first:
                pair[0] = self._powers(f.over(sources.high[first - 1], targets.distance[t]))
            if last < len(sources.low):
                pair[1] = self._powers(f.over(targets.distance[t], sources.low[last]))
            self._target_powers.append(pair)

    def _powers(self, ratio: Ints) -> Ints:
        """Return the powers of ratios, shape ``ratio.shape + (terms,)``."""
        f, powers = self._fixed, [0 * ratio + self._fixed.one]
        for _ in self._binomials[1:]:
            powers.append(f.times(powers[-1], ratio))
        return np.stack(powers, axis=-1)

    def __call__(self, values: Ints) -> Ints:
        f, cells = self._fixed, len(values)
        masses, far = f.times(values, self._sources.masses), f.times(values, self._far_masses)
        below = [f.dot(masses[0], self._source_powers[0][0])]
        for s in range(1, cells):
            own = f.dot(masses[s], self._source_powers[0][s])
            below.append(own + f.times(self._rise[s - 1], below[-1]))
        above = [f.dot(far[-1], self._source_powers[1][-1])]
        for s in reversed(range(cells - 1)):
            own = f.dot(far[s], self._source_powers[1][s])
            above.append(own + f.times(self._fall[s], above[-1]))
        above.reverse()
        result = 0 * self._targets.distance
        for t, (first, last) in enumerate(zip(self._begin, self._end, strict=True)):
            nearer, farther = self._target_powers[t]
            if nearer is not None:
                terms = f.times(self._binomials, below[first - 1])
                result[t] += f.over(f.dot(nearer, terms), self._root[t])
            if farther is not None:
                result[t] += f.dot(farther, f.times(self._binomials, above[last]))
            for s in range(first, last):
                if s == t == 0 and self._tail is not None:
                    result[t] += f.dot(self._tail, values[s])
                else:
                    result[t] += f.dot(self._near[t, s], masses[s])
        return np.asarray(result)

    def matrix(self) -> Array:
        """Return the matrix in double precision."""
        f, m = self._fixed, self._targets.mesh.blocks.points
        near = f.floats(self._targets.distance).ravel()
        far = f.floats(self._sources.distance).ravel()
        matrix = f.floats(self._sources.masses).ravel() / np.sqrt(near[:, None] + far)
        if self._tail is not None:
            matrix[:m, :m] = f.floats(self._tail)
        return np.asarray(matrix)


def _tail(targets: _Cells, sources: _Cells) -> Ints:
    """Return the half-integral over the tail of sources at the tail of targets, a matrix.

    With the distance ``d = e sinh(theta)^2`` of the source, that of the target being e, the
    integrand is entire.
    """
    f, mesh = sources.mesh.fixed, sources.mesh
    blocks, width = mesh.blocks, sources.width
    end = mesh.tail_end
    root = f.sqrt(targets.distance[0])[:, None]
    limit = f.sqrt(f.over(f.times(width, end), f.one + end))
    g, w = f.gauss(2 * blocks.points + blocks.digits)
    top = f.map(f.mp.asinh, f.over(limit, root))
    v = f.times(root, f.map(f.mp.sinh, f.times(top, f.one + g) // 2))
    square = f.times(v, v)
    local = 2 * f.sqrt(f.over(f.over(square, width - square), end)) - f.one
    return blocks.interpolated(f.times(v, top, w) // 2, local)
