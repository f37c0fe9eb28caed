"""Galerkin nodes that follow the degrees: as many on a panel as its own functions need.

Degrees differ by a factor of ten between panels. Functions that are smooth on the panels, as the
integrals over parts farther off are, take fewer points still: the *samples*. They are interpolated
from the samples to the nodes.
"""

from __future__ import annotations

from math import ceil
from typing import TYPE_CHECKING

import numpy as np
from numpy.polynomial.chebyshev import chebvander
from numpy.typing import NDArray

from spectral_contact.spectral.blockwise import Blockwise
from spectral_contact.spectral.cache import bounded_cache
from spectral_contact.spectral.jacobi import (
    PANEL_SAMPLES,
    chebyshev_interpolation,
    gauss_rule,
    interpolation_points,
    legendre_interpolation_matrix,
)
from spectral_contact.spectral.tuning import (
    NODE_STEP,
    TAIL_TERMS,
)
from spectral_contact.threads import cached_property

if TYPE_CHECKING:
    from spectral_contact.spectral.panels import LogPanels

Array = NDArray[np.float64]

#: Chebyshev points in [-1, 1] on an interval whose functions have their nearest singularity as far
#: off as the interval is wide, and the matrix from values there to Chebyshev coefficients.
FAR_NODES, FAR_EXPANSION = chebyshev_interpolation(interpolation_points(3.0))


class GradedNodes:
    """Galerkin nodes on panels of these degrees, then on the tail, clustered at both ends of each.

    The far end of a part may be the centre of the disk, and is treated like it.

    Parameters
    ----------
    panels : LogPanels
    degrees : tuple of int
        Highest degrees on the panels.

    Attributes
    ----------
    d, rest : ndarray
        Distances of the nodes from the boundary in (0, 1], in extents of the part, and ``1 - d`` to
        full relative accuracy.
    weights : ndarray
        Weights of ``int_0^1 . dd``.
    from_start : list of ndarray
        For every panel the distances in ``x`` of its nodes from the start of the panel, which is
        the end far from the boundary.
    tail : ndarray
        Distances of the nodes on the tail.
    """

    def __init__(self, panels: LogPanels, degrees: tuple[int, ...]) -> None:
        self.panels = panels
        self.degrees = degrees
        h = panels.width
        # the integrals of the functions of both neighbours have square roots at the ends of a
        # panel; at the centre the measure dt has one, too, which counts like one degree more
        around = [degrees[0] + 1, *degrees, TAIL_TERMS]
        counts = [_node_count(max(around[j : j + 3])) for j in range(panels.count)]
        rules = [clustered_rule(count, h) for count in counts]
        self.from_start: list[Array] = [from_start for from_start, _ in rules]
        weights = np.concatenate([panel_weights for _, panel_weights in rules])
        x = np.concatenate(
            [np.minimum(j * h + v, (j + 1) * h) for j, v in enumerate(self.from_start)]
        )
        self.tail, tail_weights = _tail_rule(panels)
        d = np.exp(-x)
        self.d: Array = np.concatenate([d, self.tail])
        self.rest: Array = np.concatenate([-np.expm1(-x), 1.0 - self.tail])
        self.weights: Array = np.concatenate([d * weights, tail_weights])

    @cached_property
    def samples(self) -> Array:
        """Distances of the samples, decreasing.

        They are the nodes of the first panel, `PANEL_SAMPLES` Gauss points on every other one, and
        the nodes of the tail. They represent functions that are analytic in ``x`` up to an
        imaginary part of pi, as functions of ``d + e`` are. The errors of an interpolation on the
        first panel would be the same for all functions of the panel, and would not average out.
        """
        on_panels = np.exp(-self.panels.sampling(PANEL_SAMPLES)[1:]).ravel()
        return np.concatenate([self.d[: len(self.from_start[0])], on_panels, self.tail])

    @cached_property
    def from_far_nodes(self) -> Array:
        """The matrix from values at distances ``(1 + FAR_NODES) / 2`` to values at the samples."""
        return far_values(self.samples)

    @cached_property
    def _from_samples(self) -> Blockwise:
        """The matrix from values at the samples to values at the nodes."""
        counts = [len(from_start) for from_start in self.from_start]
        on_panels = [np.eye(counts[0]), *map(from_samples, counts[1:])]
        return Blockwise([*on_panels, np.eye(len(self.tail))])

    def interpolate(self, values: Array) -> Array:
        """Return values at the nodes of functions with values at the samples, as columns."""
        return self._from_samples.times(values)

    def interpolate_transpose(self, values: Array) -> Array:
        """Apply the transpose of `interpolate`: from nodes to samples, as columns.

        A sum over the nodes of weights times an interpolated function is the sum over the samples
        of these transposed weights times its samples.
        """
        return self._from_samples.left_times(values.T).T


#: `GradedNodes`, cached.
graded_nodes = bounded_cache("graded nodes")(GradedNodes)


class PlainNodes:
    """Points that are their own samples, such as the sampling points of a mesh.

    They have no weights and no `interpolate`, which Galerkin's method alone needs.

    Parameters
    ----------
    d : ndarray
        Distances from the boundary, in extents of the part.
    """

    def __init__(self, d: Array) -> None:
        self.d = d
        self.samples = d

    @property
    def from_far_nodes(self) -> Array:
        """The matrix from values at distances ``(1 + FAR_NODES) / 2`` to values at the points."""
        return far_values(self.d)


@bounded_cache("clustered rules")
def clustered_rule(count: int, width: float) -> tuple[Array, Array]:
    """Return a rule on (0, width) for functions with square roots at both ends (cached)."""
    g, w = gauss_rule(count)
    phi = np.pi / 4 * (1.0 + g)
    sine = np.sin(phi)
    cosine = np.cos(phi)
    return width * sine**2, width * (w * np.pi / 2.0 * sine * cosine)


@bounded_cache("from samples")
def from_samples(count: int) -> Array:
    """Return the matrix from the samples of a panel to its nodes, of which there are `count`."""
    local = 2.0 * clustered_rule(count, 1.0)[0] - 1.0
    return legendre_interpolation_matrix(local, PANEL_SAMPLES)


def _tail_rule(panels: LogPanels) -> tuple[Array, Array]:
    """Return nodes on the tail, decreasing, and weights of ``dd``.

    ``d = end sin(phi)**4`` makes them dense next to the boundary, because integrals over sources
    past the boundary vary there on any small scale. They are as many as on a panel of degree 16.
    """
    g, w = gauss_rule(_node_count(NODE_STEP))
    phi = np.pi / 4 * (1.0 - g)
    sine = np.sin(phi)
    end = panels.end
    return end * sine**4, w * np.pi * end * sine**3 * np.cos(phi)


def far_values(d: Array) -> Array:
    """Return the matrix from values at the distances ``(1 + FAR_NODES) / 2`` to those at d."""
    return np.asarray(chebvander(2.0 * d - 1.0, len(FAR_NODES) - 1) @ FAR_EXPANSION)


def _node_count(degree: int) -> int:
    """Return how many nodes integrate products of Abel integrals of a degree to rounding."""
    return NODE_STEP * ceil(2 * degree / NODE_STEP + 1)
