"""Transforms of a stick disk and of the annulus around it, at their own nodes, in scaled units.

They depend on the panels and degrees alone, for which they are kept. Next to the rim an integral is
its value there and a difference, in which nothing cancels.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from spectral_contact.spectral.abel import (
    beyond,
    deeper,
    deeper_blocks,
    deeper_tail,
    far_fall,
    outer,
    rise,
)
from spectral_contact.spectral.annulus import FAR_NODES, Family
from spectral_contact.spectral.cache import BoundedCache
from spectral_contact.spectral.coupled import inner_moments, moments
from spectral_contact.spectral.graded import GradedNodes
from spectral_contact.spectral.jacobi import (
    chebyshev_values,
    gauss_rule,
    legendre_expansion_matrix,
    legendre_values,
)
from spectral_contact.spectral.panels import LogPanels

__all__ = ["Around", "Inside", "OverRadius", "around", "finer", "inside"]

Array = NDArray[np.float64]
Degrees = tuple[int, ...]

#: Degrees that ``p / s`` has more than p.
_SPARE = 4

_INSIDE: BoundedCache[tuple[LogPanels, Degrees], Inside] = BoundedCache("sliding disks", 12)
_AROUND: BoundedCache[tuple[LogPanels, LogPanels, Degrees, Degrees], Around] = BoundedCache(
    "sliding annuli", 8
)
#: Distances, in units of the extent of the panels, up to which a difference is taken as such.
_NEAR = 0.5


def inside(panels: LogPanels, degrees: Degrees) -> Inside:
    """Return the transforms of a disk (cached)."""
    return _INSIDE.get((panels, degrees), lambda: Inside(panels, degrees))


def around(above: LogPanels, below: LogPanels, first: Degrees, second: Degrees) -> Around:
    """Return the transforms of an annulus (cached), from its inner end and below the edge."""
    key = above, below, first, second
    return _AROUND.get(key, lambda: Around(above, below, (first, second)))


class Inside:
    """Transforms of a disk at its own nodes, in units of its radius, of the functions in use."""

    def __init__(self, panels: LogPanels, degrees: Degrees) -> None:
        form = panels.panels, panels.width, panels.degree
        self.index = panels.functions(degrees)
        self.nodes = GradedNodes(panels, degrees, centred=True)
        self.form = panels.panels, panels.width, degrees
        self.root = np.sqrt(self.nodes.rest)
        #: weights of ``dt``
        self.weights = self.nodes.weights / (2.0 * self.root)
        self.half = _half_integral(panels, self.nodes)[:, self.index]
        #: outer integrals at the rim, and by how much they are more at the nodes
        self.start = beyond(np.zeros(1), *form)[0][self.index]
        self.rise = rise(self.nodes.d, *form)[:, self.index]
        self.moments = moments(panels)[self.index]
        #: ``int phi psi dd`` and half of ``int phi psi (1 - d) dd``
        self.masses = panels.mass(self.index, 1.0, 0.0), panels.mass(self.index, 0.5, -0.5)
        #: ``int phi int_0^d psi``: the coupling
        self.inner = inner_moments(panels, panels)[np.ix_(self.index, self.index)]


def _half_integral(panels: LogPanels, nodes: GradedNodes) -> Array:
    """Return half-integrals of all functions at nodes that know their distances to panel ends."""
    terms, rows = panels.degree + 1, 0
    matrix = np.zeros((len(nodes.d), panels.size))
    for j, (start, end) in enumerate(zip(nodes.start, nodes.end, strict=True)):
        blocks = deeper_blocks(end, panels.panels - j, panels.width, panels.degree, 0.0, start)
        matrix[rows : rows + len(end), j * terms : -panels.tail_terms] = blocks.reshape(
            len(end), -1
        )
        rows += len(end)
    matrix *= np.sqrt(nodes.d)[:, None]
    matrix[:, -panels.tail_terms :] = deeper_tail(nodes.d, panels.end)
    return matrix


class Around:
    """Transforms of an annulus at its own nodes, in units of half its extent.

    Those of tractions have the functions in which ``p / s`` is expanded, see `OverRadius`.
    """

    def __init__(
        self, inner: LogPanels, outside: LogPanels, degrees: tuple[Degrees, Degrees]
    ) -> None:
        first = inner.panels, inner.width, inner.degree
        second = outside.panels, outside.width, outside.degree
        singular = (*second, outside.power)
        self.split = len(inner.functions(degrees[0]))
        self.index = np.concatenate(
            [inner.functions(degrees[0]), outside.functions(degrees[1]) + inner.size]
        )
        used, last = self.index, self.index[self.split :] - inner.size
        more = finer(degrees[0], inner), finer(degrees[1], outside)
        first_over = inner.functions(more[0])
        self.over = np.concatenate([first_over, outside.functions(more[1]) + inner.size])
        #: places among them of the functions in use, and of those of the outer half
        self.within = np.searchsorted(self.over, self.index)
        self.over_split = len(first_over)
        #: panels and degrees of both halves, as `abel.fall` takes them
        self.forms = (
            (inner.panels, inner.width, more[0]),
            (outside.panels, outside.width, more[1], outside.power),
        )
        self.above = GradedNodes(inner, degrees[0])
        self.below = GradedNodes(outside, degrees[1])
        e, d = self.above.d, self.below.d
        #: half-integrals at the rim, at the nodes above it, and by how much they are more there
        at_rim = [beyond(np.zeros(1), *first)[0], deeper(np.array([2.0]), *singular)[0]]
        self.at_rim = np.concatenate(at_rim)
        half = np.hstack([outer(e, *first), deeper(2.0 - e, *singular)])[:, used]
        higher, near = half - self.at_rim[used], e <= _NEAR
        higher[near, : self.split] = rise(e[near], *first)[:, used[: self.split]]
        higher[near, self.split :] = -far_fall(-e[near], *second[:2], degrees[1], outside.power)
        self.half, self.rise = half, higher
        #: ``int_c^t . ds / sqrt(t^2 - s^2)`` above the rim
        self.inner = deeper(e, *first)[:, first_over]
        #: both integrals below the edge, one of the outer half alone, the other of both
        self.edge_half = deeper(d, *singular)[:, last]
        inner_integrals = deeper(2.0 - d, *first), outer(d, *singular)
        self.edge_inner = np.hstack(inner_integrals)[:, self.over]
        self.masses = tuple(
            p.mass(k, 1.0, 0.0) if p.power == 0.0 else np.zeros((len(k), len(k)))
            for p, k in ((inner, used[: self.split]), (outside, last))
        )
        both = np.concatenate([moments(inner), moments(outside)])
        self.moments = both[self.over]
        #: ``int phi int psi`` over what lies outside of phi
        outside_moments = np.outer(moments(inner), both)
        outside_moments[:, : inner.size] -= inner_moments(inner, inner)
        nothing = np.zeros((outside.size, inner.size))
        within = np.hstack([nothing, inner_moments(outside, outside)])
        self.outside = np.vstack([outside_moments, within])[np.ix_(used, self.over)]
        #: what lies inside the rim is smooth below the edge: Chebyshev polynomials there
        self.smooth_below = chebyshev_values(2.0 * d - 1.0, len(FAR_NODES) - 1)


def finer(degrees: Degrees, panels: LogPanels) -> Degrees:
    """Return the degrees of a function over s."""
    return tuple(min(n + _SPARE, panels.degree) for n in degrees)


class OverRadius:
    """The map from the coefficients of a pressure on an annulus to those of it over s.

    It takes the functions in use to those of some degrees more, panel by panel.
    """

    def __init__(self, families: Sequence[Family], degrees: Sequence[Degrees]) -> None:
        self._blocks: list[tuple[slice, slice, Array]] = []
        row = column = 0
        for family, used in zip(families, degrees, strict=True):
            panels = family.panels
            points = panels.degree + 11
            expand = legendre_expansion_matrix(points, panels.degree)
            values = legendre_values(gauss_rule(points)[0], panels.degree)
            s = np.sqrt(family.points(np.exp(-panels.sampling(points))).z)
            blocks = [
                expand[: more + 1] @ (values[:, : n + 1] / one[:, None])
                for one, n, more in zip(s, used, finer(used, panels), strict=True)
            ]
            # on the tail s is the same to rounding
            at_end = float(np.sqrt(family.points(np.array([panels.end / 2.0])).z[0]))
            blocks.append(np.eye(panels.tail_terms) / at_end)
            for block in blocks:
                rows, columns = block.shape
                self._blocks.append(
                    (slice(row, row + rows), slice(column, column + columns), block)
                )
                row, column = row + rows, column + columns
        self.shape = row, column

    def of(self, values: Array) -> Array:
        """Return the coefficients of functions over s."""
        result = np.empty((self.shape[0], *values.shape[1:]))
        for rows, columns, block in self._blocks:
            result[rows] = block @ values[columns]
        return result

    def after(self, matrix: Array) -> Array:
        """Return the product of a matrix with this map, of which it may have the first rows."""
        result = np.zeros((len(matrix), self.shape[1]))
        for rows, columns, block in self._blocks:
            if rows.stop <= matrix.shape[1]:
                result[:, columns] = matrix[:, rows] @ block
        return result
