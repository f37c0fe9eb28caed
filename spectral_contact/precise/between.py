"""Sums over ``1/sqrt(z - t^2)`` from one annulus to another in fixed point.

Both are cut into cells that are graded in the distance from the gap between them. With a cell that
is much nearer to the gap, or much farther, a cell interacts by a power series; with all that are
near the far end, by one about that end.
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
        Between them: 0 if they are neighbours, or wider than their tails.
    """

    def __init__(
        self, inner: AnnulusMesh, outer: AnnulusMesh, widths: tuple[Any, Any], gap: Any
    ) -> None:
        f = self._fixed = inner.fixed
        # each in cells from the gap outward; t^2 and z to either side of it
        self._first = _Cells(inner.reflected, widths[0], 0)
        self._second = _Cells(outer, widths[1], gap)
        self._down = _Sums(f, self._first, self._second, None)
        self._up = _Sums(f, self._second, self._first, self._down)

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
    """An annulus seen from the gap: distances of its nodes, and half the weights of ``dz``.

    The first `count` cells are taken one by one; the others are all near the far end.
    """

    def __init__(self, mesh: AnnulusMesh, width: Any, gap: Any) -> None:
        f = mesh.fixed
        self.mesh, self.width, self.gap, self.end = mesh, width, gap, gap + width
        self.distance = gap + f.times(width, mesh.above)
        self.rest = f.times(width, mesh.below)
        self.masses = f.times(width, mesh.weights) // 2
        self.low, self.high = self.distance.min(axis=1), self.distance.max(axis=1)
        limit = f.times(f.of(_RATIO), self.end)
        self.count = int(np.sum(self.rest.max(axis=1) > limit))


class _Sums:
    """``sum of masses * values / sqrt(distance + distance)`` over sources at targets."""

    def __init__(self, f: Fixed, targets: _Cells, sources: _Cells, back: _Sums | None) -> None:
        self._fixed, self._targets, self._sources = f, targets, sources
        neighbours = targets.gap == sources.gap == 0
        self._tail = _tail(targets, sources) if neighbours else None
        low, high = sources.low[: sources.count], sources.high[: sources.count]
        self._range = [
            (int(np.sum(high <= nearer)), int(np.sum(low < farther)))
            for nearer, farther in zip(
                f.times(f.of(_RATIO), targets.low[: targets.count]),
                f.over(targets.high[: targets.count], f.of(_RATIO)),
                strict=True,
            )
        ]
        self._near: dict[tuple[int, int], Ints] = {}
        for t, (first, last) in enumerate(self._range):
            for s in range(first, last):
                self._near[t, s] = (
                    back._near[s, t].T
                    if back is not None
                    else self._inverse_root(targets.distance[t][:, None] + sources.distance[s])
                )
        terms = ceil((targets.mesh.blocks.digits + 6) / -log(_RATIO, 10.0)) + 1
        binomials = [f.one]
        for j in range(1, terms):
            binomials.append(binomials[-1] * (2 * j - 1) // (2 * j))
        self._binomials = np.array(binomials)
        self._alternating = self._binomials * (1 - 2 * (np.arange(terms) % 2)).astype(object)
        self._expand_near()
        self._expand_ends()

    def _inverse_root(self, values: Ints) -> Ints:
        f = self._fixed
        return np.asarray(f.over(f.one, f.sqrt(values)))

    def _powers(self, ratio: Ints) -> Ints:
        """Return the powers of ratios, shape ``ratio.shape + (terms,)``."""
        f, powers = self._fixed, [0 * ratio + self._fixed.one]
        for _ in self._binomials[1:]:
            powers.append(f.times(powers[-1], ratio))
        return np.stack(powers, axis=-1)

    def _expand_near(self) -> None:
        """Prepare the series between cells of different distance from the gap."""
        f, targets, sources, count = self._fixed, self._targets, self._sources, self._sources.count
        distance, low, high = sources.distance[:count], sources.low[:count], sources.high[:count]
        self._inner_sources = self._powers(f.over(distance, high[:, None]))
        self._outer_sources = self._powers(f.over(low[:, None], distance))
        self._outer_masses = f.times(sources.masses[:count], self._inverse_root(distance))
        self._rise = self._powers(f.over(high[:-1], high[1:]))
        self._fall = self._powers(f.over(low[:-1], low[1:]))
        self._roots = self._inverse_root(targets.distance[: targets.count])
        self._inner_targets, self._outer_targets = {}, {}
        for t, (first, last) in enumerate(self._range):
            at = targets.distance[t]
            if first:
                self._inner_targets[t] = self._powers(f.over(high[first - 1], at))
            if last < count:
                self._outer_targets[t] = self._powers(f.over(at, low[last]))

    def _expand_ends(self) -> None:
        """Prepare the series about the far ends."""
        f, targets, sources = self._fixed, self._targets, self._sources
        end = sources.end + targets.distance
        self._end_sources = self._powers(f.over(sources.rest[sources.count :], sources.end))
        self._end_targets = self._powers(f.over(sources.end, end))
        self._end_roots = self._inverse_root(end)
        near = sources.distance[: sources.count] + targets.end
        self._seen = self._powers(f.over(targets.end, near))
        self._seen_masses = f.times(sources.masses[: sources.count], self._inverse_root(near))
        self._seeing = self._powers(f.over(targets.rest[targets.count :], targets.end))

    def __call__(self, values: Ints) -> Ints:
        """Return the sums."""
        f, sources, near = self._fixed, self._sources, self._targets.count
        masses = f.times(values, sources.masses)
        ends = f.dot(masses[sources.count :].ravel(), self._flat(self._end_sources))
        result = f.times(self._end_roots, f.dot(self._end_targets, f.times(self._binomials, ends)))
        own = values[: sources.count]
        seen = f.dot(f.times(own, self._seen_masses).ravel(), self._flat(self._seen))
        result[near:] += f.dot(self._seeing, f.times(self._binomials, seen))
        result[:near] += self._graded(own)
        return np.asarray(result)

    @staticmethod
    def _flat(powers: Ints) -> Ints:
        return powers.reshape(-1, powers.shape[-1])

    def _graded(self, values: Ints) -> Ints:
        """Return the sums over cells that are taken one by one, at cells that are."""
        f, count = self._fixed, len(values)
        masses = f.times(values, self._sources.masses[:count])
        outer = f.times(values, self._outer_masses)
        below, above = [], []  # sums over cells up to each, and from each on
        for s in range(count):
            below.append(f.dot(masses[s], self._inner_sources[s]))
            if s:
                below[s] = below[s] + f.times(self._rise[s - 1], below[s - 1])
        for s in reversed(range(count)):
            above.append(f.dot(outer[s], self._outer_sources[s]))
            if s < count - 1:
                above[-1] = above[-1] + f.times(self._fall[s], above[-2])
        above.reverse()
        result = 0 * self._roots
        for t, (first, last) in enumerate(self._range):
            if t in self._inner_targets:
                terms = f.times(self._alternating, below[first - 1])
                result[t] += f.times(self._roots[t], f.dot(self._inner_targets[t], terms))
            if t in self._outer_targets:
                terms = f.times(self._alternating, above[last])
                result[t] += f.dot(self._outer_targets[t], terms)
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
    end = mesh.inner_end
    root = f.sqrt(targets.distance[0])[:, None]
    limit = f.sqrt(f.over(f.times(width, end), f.one + end))
    g, w = f.gauss(2 * blocks.points + blocks.digits)
    top = f.map(f.mp.asinh, f.over(limit, root))
    v = f.times(root, f.map(f.mp.sinh, f.times(top, f.one + g) // 2))
    square = f.times(v, v)
    local = 2 * f.sqrt(f.over(f.over(square, width - square), end)) - f.one
    return blocks.interpolated(f.times(v, top, w) // 2, local)
