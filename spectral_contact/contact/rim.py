"""What every solution with a central stick disk needs: its target.

Near the rim the target is small against its parts, so it is built from differences that do not
cancel.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import asinh, ceil, exp, log, pi
from typing import NamedTuple

import numpy as np
from numpy.polynomial import chebyshev

from spectral_contact.contact.drive import Drive
from spectral_contact.contact.resolution import TRIFLING
from spectral_contact.fields.series import Array, PressureField, Radius
from spectral_contact.spectral.cache import BoundedCache
from spectral_contact.spectral.graded import FAR_FIT, FAR_NODES, GradedNodes, root_sums
from spectral_contact.spectral.jacobi import gauss_rule
from spectral_contact.spectral.panels import LogPanels

_RULES: BoundedCache[tuple[int, int], RimRule] = BoundedCache("slip rules", 64)
_GRIDS: BoundedCache[tuple[LogPanels, int, int], _Grid] = BoundedCache("slip at a rim", 24)
#: Width in ``-ln`` of the panels that are graded to an end: a unit takes 4.7 points, and 6 with 2.
_WIDTH = 3.0


class SlipSource:
    """Quadrature of pressures over an annulus, for half-integrals at its inner end and inside.

    Parameters
    ----------
    pressures : sequence of PressureField
        ``p*``, or changes of it: k functions, which are the columns of all results.
    inner : Radius
        Where the annulus begins; it ends at the edge.
    alpha : float
        ``alpha*``, the width of the layer at the edge.
    tolerance : float
        Relative accuracy of the integrals.
    nearest : float
        The least ``inner**2 - t**2`` > 0 for which they are asked.
    nodes : GradedNodes, optional
        Of the stick disk inside: what is near the rim is then summed with a
        matrix that is kept.
    """

    def __init__(
        self,
        pressures: Sequence[PressureField],
        inner: Radius,
        alpha: float,
        tolerance: float,
        nearest: float,
        nodes: GradedNodes | None = None,
    ) -> None:
        width = inner.rest
        half = width / 2.0
        # by Gauss, as integrands are analytic in ``ln`` up to an imaginary part of pi
        points = 2 + ceil(-log(tolerance) / (2.0 * asinh(2.0 * pi / _WIDTH)))
        least = TRIFLING * tolerance
        self._kernel: Array | None = None
        self._scale = inner.value
        grid = None
        if nodes is not None:
            d = nodes.samples
            # on the same panels as many samples are the same
            grid = _GRIDS.get((nodes.panels, len(d), points), lambda: _Grid(d, points))
        if grid is not None and grid.reach < half / inner.square:
            near, near_weights, self._kernel = grid.from_rim(half / inner.square)
            offset, near_weights = inner.square * near, inner.square * near_weights
        else:
            near, near_weights, _ = _graded(min(nearest, inner.square, half) / half, points)
            offset, near_weights = half * near, half * near_weights
        # a pressure that is singular at the edge is a square root there
        finest = min(1.0, alpha / half) * least if alpha else least**2
        far, far_weights, gather = _graded(finest, points)
        depth = half * far
        y = np.concatenate([inner.rest - offset, depth])
        z = np.concatenate([inner.square + offset, 1.0 - depth])
        densities = PressureField.several(pressures, y)
        # with s ds = dz/2
        densities *= np.concatenate([near_weights, half * far_weights]) / (2.0 * np.sqrt(z))
        # seen from inside, what varies over the outer half is a polynomial: a few points do
        from_inner, from_outer = densities[:, : len(near)].T, gather @ densities[:, len(near) :].T
        #: distance of the points from the inner end in s**2
        self.above = np.concatenate([offset, width - half * (1.0 + FAR_NODES) / 2.0])
        self._root = np.sqrt(self.above)
        #: weights of ``p ds``
        self.values = np.concatenate([from_inner, from_outer])

    @property
    def at_rim(self) -> Array:
        """``int p ds / sqrt(s^2 - inner^2)``, shape (k,)."""
        return np.asarray((1.0 / self._root) @ self.values)

    def half_integral(self, below: Array) -> Array:
        """Return ``int p ds / sqrt(s^2 - t^2)`` where ``rim**2 - t**2 = below``, (n, k)."""
        return root_sums(below, self.above, self.values)

    def fall(self, below: Array) -> Array:
        """Return by how much the half-integral at ``rim**2 - below`` is less than at the rim.

        With samples these are as many of them as there are places, the nearest ones.
        """
        weights = self.values / self._root[:, None]
        if self._kernel is None:
            return np.asarray(below[:, None] * root_sums(below, self.above, weights, self._root))
        # those of the kernel stand between the others
        start, stop = len(self.above) - len(FAR_NODES) - self._kernel.shape[1], -len(FAR_NODES)
        above, root, weights = (
            np.concatenate([one[:start], one[stop:]]) for one in (self.above, self._root, weights)
        )
        sums = below[:, None] * root_sums(below, above, weights, root)
        sums += self._kernel[len(self._kernel) - len(below) :] @ (
            self.values[start:stop] / self._scale
        )
        return sums


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
    return _RULES.get((panels, points), lambda: _rule(panels, points))


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


def rim_target(
    drives: Sequence[Drive],
    radius: Radius,
    friction: float | Array,
    source: SlipSource,
    d: Array,
    *,
    keep: bool,
) -> tuple[Array, Array]:
    """Return the target of a stick disk at its rim, and at the samples of the disk.

    Parameters
    ----------
    drives : sequence of Drive
        One, or several that are solved for together: k columns.
    radius : Radius
        The rim.
    friction : float or ndarray
        ``f / kappa``, one for all columns or one for each.
    source : SlipSource
        The slip zone outside, under the pressures of the drives.
    d : ndarray
        Distances of the samples of the disk, falling.
    keep : bool
        Whether the target includes the balance. It does not where the target must vanish at
        the rim, at zero compliance.

    Returns
    -------
    balance : ndarray, shape (k,)
        ``R(c) - (f/kappa) P(c)``.
    values : ndarray, shape (samples, k)
        The targets. Near the rim they are built from differences that do not cancel; beyond, from
        the parts, whose noise falls with their size.
    """
    demanded = Drive.targets_from(drives, radius, -radius.square, d)
    at_rim, far, near = (one.T for one in demanded)
    balance = at_rim - friction * source.at_rim
    at_start, at_end = (balance, 0.0) if keep else (0.0, balance)
    values, below = np.vstack([far - at_end, near + at_start]), radius.square * d
    split = len(far)
    values[:split] -= friction * source.half_integral(below[:split])
    values[split:] += friction * source.fall(below[split:])
    return balance, values


class RimRule(NamedTuple):
    """Nodes, weights, and a matrix of these: a kernel, or what gathers them at far nodes."""

    nodes: Array
    weights: Array
    matrix: Array
