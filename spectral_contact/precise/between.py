"""Sums over ``1/sqrt(z - t^2)`` from one annulus to another in fixed point.

Both annuli are cut into cells, which are graded towards the gap between them. What one cell does to
another is computed with the kernel itself if the two are about equally far from the gap. If one is
much nearer to it than the other, the kernel is a power series. The cells next to the far end of an
annulus are summed together, by a power series about that end.
"""

from __future__ import annotations

from math import ceil, log
from typing import Any

import numpy as np
from numpy.typing import NDArray

from spectral_contact.precise.annulus_mesh import AnnulusMesh
from spectral_contact.precise.fixed import Ints

Array = NDArray[np.float64]

#: Largest ratio of distances from the gap for which the kernel is a power series; it was chosen.
_RATIO = 0.15


class Between:
    """Half-integrals of an outer annulus at the nodes of an inner one, and the other way round.

    Parameters
    ----------
    inner, outer : AnnulusMesh
    widths : tuple of int
        Those of the two annuli, in ``s**2``.
    gap : int
        The distance between them, in ``s**2``: 0 if they are neighbours, else more than the widths
        of their tails.
    """

    def __init__(
        self, inner: AnnulusMesh, outer: AnnulusMesh, widths: tuple[Any, Any], gap: Any
    ) -> None:
        # the cells of either annulus are counted away from the gap
        first = _Cells(inner.reflected, widths[0], 0)
        second = _Cells(outer, widths[1], gap)
        near = _near(first, second)
        ends = _EndExpansion(first, second), _EndExpansion(second, first)
        self._to_inner = _Sums(first, second, near, ends)
        turned = {(s, t): block.T for (t, s), block in near.items()}
        self._to_outer = _Sums(second, first, turned, ends[::-1])

    def half_integral(self, values: Ints) -> Ints:
        """Return ``1/2 int psi dz / sqrt(z - t^2)`` over the outer annulus, of values there."""
        return self._to_inner(values)[::-1, ::-1]

    def inner_integral(self, values: Ints) -> Ints:
        """Return ``1/2 int phi dt^2 / sqrt(s^2 - t^2)`` over the inner annulus."""
        return self._to_outer(values[::-1, ::-1])

    def matrix(self) -> Array:
        """Return the matrix of `half_integral` in double precision."""
        return self._to_inner.matrix()[::-1]

    def inner_matrix(self) -> Array:
        """Return the matrix of `inner_integral` in double precision."""
        return self._to_outer.matrix()[:, ::-1]


class _Cells:
    """An annulus seen from the gap: distances of nodes, and masses, half the weights of ``dz``.

    The first `count` cells are summed one by one; the others are next to the far end.
    """

    def __init__(self, mesh: AnnulusMesh, width: Any, gap: Any) -> None:
        f = self.fixed = mesh.fixed
        self.mesh = mesh
        self.width = width
        self.gap = gap
        self.end = gap + width
        self.distance = gap + f.times(width, mesh.above)
        rest = f.times(width, mesh.below)
        self.masses = f.times(width, mesh.weights) // 2
        limit = f.times(f.of(_RATIO), self.end)
        count = self.count = int(np.sum(rest.max(axis=1) > limit))
        graded = self.distance[:count]
        self.low = graded.min(axis=1)
        self.high = graded.max(axis=1)
        self.terms = ceil((mesh.blocks.digits + 6) / -log(_RATIO, 10.0)) + 1
        #: powers of the ratio of a node's distance to the largest one in its cell, and of the ratio
        #: of the least one in the cell to the node's
        self.rise = self.powers(f.over(graded, self.high[:, None]))
        self.fall = self.powers(f.over(self.low[:, None], graded))
        #: powers of the distances from the far end, for the cells next to it
        self.about_end = self.powers(f.over(rest[count:], self.end))
        #: inverse roots of the distances
        self.roots = f.inverse_root(graded)

    def powers(self, ratio: Ints) -> Ints:
        """Return the powers of ratios, shape ``ratio.shape + (terms,)``."""
        f = self.fixed
        powers = [0 * ratio + f.one]
        for _ in range(1, self.terms):
            powers.append(f.times(powers[-1], ratio))
        return np.stack(powers, axis=-1)


class _EndExpansion:
    """The kernel as a series about the far end of the sources, at the nodes of the targets.

    `roots` has the kernel for a source at that end, and `powers` those of the ratio of the distance
    of the end from the gap to that between end and target.
    """

    def __init__(self, targets: _Cells, sources: _Cells) -> None:
        f = targets.fixed
        distance = sources.end + targets.distance
        self.powers = targets.powers(f.over(sources.end, distance))
        self.roots = f.inverse_root(distance)


def _near(targets: _Cells, sources: _Cells) -> dict[tuple[int, int], Ints]:
    """Return the kernel between the cells, target and source, at like distances from the gap."""
    f = targets.fixed
    found = {}
    farthest = f.over(targets.high, f.of(_RATIO))
    for t, nearest in enumerate(f.times(f.of(_RATIO), targets.low)):
        for s in range(int(np.sum(sources.high <= nearest)), sources.count):
            if sources.low[s] >= farthest[t]:
                break
            found[t, s] = f.inverse_root(targets.distance[t][:, None] + sources.distance[s])
    return found


class _Sums:
    """Sums of masses and values over the root of the distance from source to target.

    That distance is the sum of the distances of the two from the gap.

    Parameters
    ----------
    targets, sources : _Cells
    near : dict
        The kernel between cells at like distances, see `_near`.
    ends : tuple of _EndExpansion
        The series about the far end of the sources, and that about the far end of the targets.
    """

    def __init__(
        self,
        targets: _Cells,
        sources: _Cells,
        near: dict[tuple[int, int], Ints],
        ends: tuple[_EndExpansion, _EndExpansion],
    ) -> None:
        f = self._fixed = targets.fixed
        self._targets = targets
        self._sources = sources
        self._near = near
        self._source_end, self._target_end = ends
        neighbours = targets.gap == sources.gap == 0
        self._tail = _tail(targets, sources) if neighbours else None
        binomials = [f.one]
        for j in range(1, sources.terms):
            binomials.append(binomials[-1] * (2 * j - 1) // (2 * j))
        self._binomials = np.array(binomials)
        self._alternating = self._binomials * (1 - 2 * (np.arange(sources.terms) % 2)).astype(
            object
        )
        high = sources.high
        low = sources.low
        # factors of sums over cells that are passed on to the next cell, away from the gap and back
        self._to_farther = sources.powers(f.over(high[:-1], high[1:]))
        self._to_nearer = sources.powers(f.over(low[:-1], low[1:]))
        self._masses_over_root = f.times(sources.masses[: sources.count], sources.roots)
        self._target_end_masses = f.times(
            sources.masses[: sources.count], self._target_end.roots[: sources.count]
        )

    def __call__(self, values: Ints) -> Ints:
        """Return the sums."""
        f = self._fixed
        sources = self._sources
        near = self._targets.count
        far = f.times(values, sources.masses)[sources.count :]
        ends = f.dot(far.ravel(), self._flat(sources.about_end))
        about = f.dot(self._source_end.powers, f.times(self._binomials, ends))
        result = f.times(self._source_end.roots, about)
        own = values[: sources.count]
        powers = self._target_end.powers[: sources.count]
        at_end = f.dot(f.times(own, self._target_end_masses).ravel(), self._flat(powers))
        result[near:] += f.dot(self._targets.about_end, f.times(self._binomials, at_end))
        result[:near] += self._graded(own)
        return np.asarray(result)

    @staticmethod
    def _flat(powers: Ints) -> Ints:
        """Return powers with the nodes of all cells along one axis."""
        return powers.reshape(-1, powers.shape[-1])

    def _graded(self, values: Ints) -> Ints:
        """Return the sums between the first `count` cells of sources and of targets."""
        f = self._fixed
        targets = self._targets
        sources = self._sources
        count = len(values)
        masses = f.times(values, sources.masses[:count])
        outer = f.times(values, self._masses_over_root)
        # cells are in the order of their distances from the gap
        below = []  # for each cell, the sums over it and all that are nearer
        above = []  # for each cell, the sums over it and all that are farther
        for s in range(count):
            below.append(f.dot(masses[s], sources.rise[s]))
            if s:
                below[s] = below[s] + f.times(self._to_farther[s - 1], below[s - 1])
        for s in reversed(range(count)):
            above.append(f.dot(outer[s], sources.fall[s]))
            if s < count - 1:
                above[-1] = above[-1] + f.times(self._to_nearer[s], above[-2])
        above.reverse()
        result = 0 * targets.roots
        for t in range(targets.count):
            own = [s for s in range(count) if (t, s) in self._near]
            first = own[0] if own else int(np.sum(sources.high <= targets.low[t]))
            last = own[-1] + 1 if own else first
            if first:
                apart = sources.powers(f.over(sources.high[first - 1], targets.low[t]))
                terms = f.times(self._alternating, apart, below[first - 1])
                result[t] += f.times(targets.roots[t], f.dot(targets.fall[t], terms))
            if last < count:
                apart = sources.powers(f.over(targets.high[t], sources.low[last]))
                terms = f.times(self._alternating, apart, above[last])
                result[t] += f.dot(targets.rise[t], terms)
            for s in own:
                if s == t == 0 and self._tail is not None:
                    result[t] += f.dot(self._tail, values[s])
                else:
                    result[t] += f.dot(self._near[t, s], masses[s])
        return np.asarray(result)

    def matrix(self) -> Array:
        """Return the matrix in double precision."""
        f = self._fixed
        m = self._targets.mesh.blocks.points
        near = f.floats(self._targets.distance).ravel()
        far = f.floats(self._sources.distance).ravel()
        matrix = f.floats(self._sources.masses).ravel() / np.sqrt(near[:, None] + far)
        if self._tail is not None:
            matrix[:m, :m] = f.floats(self._tail)
        return np.asarray(matrix)


def _tail(targets: _Cells, sources: _Cells) -> Ints:
    """Return the matrix of the half-integral over the tail of sources at the tail of targets.

    If the target is at the distance e from the gap, and the source at ``e sinh(theta)^2``, the
    integrand is entire in theta.
    """
    f = sources.mesh.fixed
    mesh = sources.mesh
    blocks = mesh.blocks
    width = sources.width
    end = mesh.inner_end
    root = f.sqrt(targets.distance[0])[:, None]
    limit = f.sqrt(f.over(f.times(width, end), f.one + end))
    g, w = f.gauss(2 * blocks.points + blocks.digits)
    top = f.map(f.mp.asinh, f.over(limit, root))
    v = f.times(root, f.map(f.mp.sinh, f.times(top, f.one + g) // 2))
    square = f.times(v, v)
    local = 2 * f.sqrt(f.over(f.over(square, width - square), end)) - f.one
    return blocks.interpolated(f.times(v, top, w) // 2, local)
