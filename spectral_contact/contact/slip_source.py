"""What slip zones under a known pressure add to half-integrals inside of them.

Near a rim these are small against their parts, so it is built from differences that do not cancel.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import asinh, ceil, exp, log, pi
from typing import NamedTuple

import numpy as np
from numpy.polynomial import chebyshev

from spectral_contact.contact.resolution import TRIFLING
from spectral_contact.fields.series import Array, PressureField, Radius
from spectral_contact.spectral.cache import BoundedCache, kept
from spectral_contact.spectral.graded import FAR_FIT, FAR_NODES, GradedNodes, root_sums
from spectral_contact.spectral.jacobi import gauss_rule
from spectral_contact.spectral.panels import LogPanels
from spectral_contact.spectral.parts import Points, gap

_GRIDS: BoundedCache[tuple[LogPanels, int, int], _Grid] = BoundedCache("slip at a rim", 24)
#: Width in ``-ln`` of the panels that are graded to an end: a unit takes 4.7 points, and 6 with 2.
_WIDTH = 3.0


class SlipSource:
    """Quadrature of pressures over a slip zone, for half-integrals inside of it.

    Parameters
    ----------
    pressures : sequence of PressureField
        ``p*``, or changes of it: k functions, which are the columns of all results.
    inner, outer : Radius
        Where the zone begins and ends.
    alpha : float
        ``alpha*``, the width of the layer at the edge.
    tolerance : float
        Relative accuracy of the integrals.
    nodes : GradedNodes, optional
        Of the part that ends at the inner end: what is near there is summed with a matrix that is
        kept. Without them the zone is seen from the inner end alone.
    reach : float
        Extent in ``s**2`` of this part.
    """

    def __init__(
        self,
        pressures: Sequence[PressureField],
        inner: Radius,
        outer: Radius,
        alpha: float,
        tolerance: float,
        nodes: GradedNodes | None = None,
        reach: float = 1.0,
    ) -> None:
        self._inner, self._reach = inner, reach
        width = gap(inner, outer)
        half = width / 2.0
        # by Gauss, as integrands are analytic in ``ln`` up to an imaginary part of pi
        points = 2 + ceil(-log(tolerance) / (2.0 * asinh(2.0 * pi / _WIDTH)))
        least = TRIFLING * tolerance
        self._kernel: Array | None = None
        finest, grid = min(1.0, inner.square / half), None
        if nodes is not None:
            d = nodes.samples
            # on the same panels as many samples are the same
            grid = _GRIDS.get((nodes.panels, len(d), points), lambda: _Grid(d, points))
            finest = min(reach * float(d[-1]), reach, half) / half
        if grid is not None and grid.reach < half / reach:
            near, near_weights, self._kernel = grid.from_rim(half / reach)
            offset, near_weights = reach * near, reach * near_weights
        else:
            near, near_weights, _ = _graded(finest, points)
            offset, near_weights = half * near, half * near_weights
        if outer.from_edge > 0.0:
            finest = min(1.0, outer.rest / half)
        else:  # a pressure that is singular at the edge is a square root there
            finest = min(1.0, alpha / half) * least if alpha else least**2
        far, far_weights, gather = _graded(finest, points)
        depth = half * far
        y = np.concatenate([inner.rest - offset, outer.rest + depth])
        z = np.concatenate([inner.square + offset, outer.square - depth])
        densities = PressureField.several(pressures, y)
        # with s ds = dz/2
        densities *= np.concatenate([near_weights, half * far_weights]) / (2.0 * np.sqrt(z))
        # seen from inside, what varies over the outer half is a polynomial: a few points do
        from_inner, from_outer = densities[:, : len(near)].T, gather @ densities[:, len(near) :].T
        #: distance of the points from the inner end in s**2
        self._above = np.concatenate([offset, width - half * (1.0 + FAR_NODES) / 2.0])
        #: weights of ``p ds``
        self._values = np.concatenate([from_inner, from_outer])

    def half_integral(self, points: Points) -> Array:
        """Return ``int p ds / sqrt(s^2 - t^2)`` at points inside, (n, k)."""
        return root_sums(points.before(self._inner), self._above, self._values)

    def at(self, boundary: Radius) -> Array:
        """Return the half-integral at a boundary inside, or at the inner end, (k,)."""
        return np.asarray((1.0 / np.sqrt(self._apart(boundary))) @ self._values)

    def fall(self, boundary: Radius, below: Array) -> Array:
        """Return by how much it is less at ``boundary**2 - below`` than at a boundary, (n, k).

        Next to the inner end these are the last samples of the nodes.
        """
        above, values, kept = self._apart(boundary), self._values, self._kernel
        if boundary != self._inner or kept is None:
            return _falls(below, above, values)
        # those of the kernel stand between the others
        stop = len(above) - len(FAR_NODES)
        start = stop - kept.shape[1]
        near = np.concatenate([above[:start], above[stop:]])
        sums = _falls(below, near, np.concatenate([values[:start], values[stop:]]))
        own = values[start:stop] / np.sqrt(self._reach)
        return np.asarray(sums + kept[len(kept) - len(below) :] @ own)

    def _apart(self, boundary: Radius) -> Array:
        """Return the distances of the points from a boundary in ``s**2``."""
        if boundary == self._inner:
            return self._above
        return np.asarray(self._above + gap(boundary, self._inner))


def _falls(below: Array, above: Array, values: Array) -> Array:
    """Return the sum of ``values (1/sqrt(above) - 1/sqrt(above + below))``."""
    root = np.sqrt(above)
    sums = root_sums(below, above, values / root[:, None], root)
    return np.asarray(below[:, None] * sums)


class _Grid:
    """Quadrature outside a rim that does not depend on its radius, with the kernel of `fall`.

    In ``e = (s**2 - c**2) / c**2`` the panels next to the rim are those of any radius.

    Parameters
    ----------
    d : ndarray
        Where the half-integrals are wanted: distances, falling.
    points : int
        On a panel.
    """

    def __init__(self, d: Array, points: int) -> None:
        self._points = points
        self._panels = max(ceil(-log(float(d[-1])) / _WIDTH), 0)
        #: least extent of an annulus whose panels these are
        self.reach = exp(1.0 - _WIDTH * self._panels)
        widths: Array = np.full(self._panels, _WIDTH)
        starts = widths * np.arange(self._panels)
        self._nodes, self._weights = _to_an_end(starts, widths, points)
        root = np.sqrt(self._nodes)
        longer = d[:, None] + self._nodes
        np.sqrt(longer, out=longer)
        self._kernel = longer + root
        self._kernel *= longer
        self._kernel *= root
        np.divide(d[:, None], self._kernel, out=self._kernel)

    def from_rim(self, reach: float) -> RimRule:
        """Return nodes and weights on ``0 < e <= reach``, and the kernel of the last of them."""
        # the far end of the annulus is a singularity ln 2 before the first panel: that one is short
        start = 1.0 - log(reach)
        first = max(ceil(start / _WIDTH), 0)
        count = max(ceil((_WIDTH * first - start) / _WIDTH), 0)
        width = (_WIDTH * first - start) / max(count, 1)
        starts = np.concatenate([[start - 1.0], start + width * np.arange(count)])
        widths = np.concatenate([[1.0], np.full(count, width)])
        nodes, weights = _on_panels(starts, widths, self._points)
        own = slice(first * self._points, None)
        return RimRule(
            np.concatenate([nodes, self._nodes[own]]),
            np.concatenate([weights, self._weights[own]]),
            self._kernel[:, own],
        )


def _graded(finest: float, points: int) -> RimRule:
    """Return `_rule` graded to `finest`."""
    # the far end of the annulus is a singularity ln 2 before the first panel: that one is short
    panels = max(ceil((-log(finest) - 1.0) / _WIDTH), 0)
    return _rule(panels, points)


@kept("slip rules", 64)
def _rule(panels: int, points: int) -> RimRule:
    """Return nodes and weights on (0, 1), graded to 0, and what gathers the weights.

    Panels are equal in ``-ln``, and the last one is for functions of the square root. A polynomial
    has the same sum with the gathered weights at the far nodes.
    """
    starts = np.concatenate([[0.0], 1.0 + _WIDTH * np.arange(panels)])
    nodes, weights = _to_an_end(starts, np.concatenate([[1.0], np.full(panels, _WIDTH)]), points)
    vander = chebyshev.chebvander(2.0 * nodes - 1.0, len(FAR_NODES) - 1)
    return RimRule(nodes, weights, FAR_FIT.T @ vander.T)


def _to_an_end(starts: Array, widths: Array, points: int) -> tuple[Array, Array]:
    """Return nodes and weights on panels in ``-ln``, and on one for functions of the root below."""
    nodes, weights = _on_panels(starts, widths, points)
    g, w = gauss_rule(points)
    root, rest = (1.0 + g) / 2.0, exp(-sum(widths))
    return np.concatenate([nodes, rest * root**2]), np.concatenate([weights, rest * root * w])


def _on_panels(starts: Array, widths: Array, points: int) -> tuple[Array, Array]:
    """Return nodes and weights on panels in ``-ln`` of the distance."""
    g, w = gauss_rule(points)
    nodes = np.exp(-starts[:, None] - widths[:, None] * (1.0 + g) / 2.0)
    return nodes.ravel(), (nodes * (w * widths[:, None] / 2.0)).ravel()


class RimRule(NamedTuple):
    """Nodes, weights, and a matrix of these: a kernel, or what gathers them at far nodes."""

    nodes: Array
    weights: Array
    matrix: Array
