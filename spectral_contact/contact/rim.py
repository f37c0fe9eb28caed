"""What every solution with a central stick disk needs: its space and its target.

Near the rim the target is small against its parts, so it is built from differences that do not
cancel.
"""

from __future__ import annotations

from collections.abc import Callable
from math import ceil, log

import numpy as np
from numpy.typing import NDArray

from spectral_contact.adaptive import Resolution
from spectral_contact.contact.drive import Drive
from spectral_contact.contact.resolution import starting_resolution
from spectral_contact.fields import PressureField, Radius
from spectral_contact.spectral.abel import root_sums
from spectral_contact.spectral.annulus import gap
from spectral_contact.spectral.jacobi import gauss_rule

__all__ = ["SlipSource", "disk_resolution", "rim_target"]

Array = NDArray[np.float64]


class SlipSource:
    """Quadrature of a pressure over an annulus, graded to both ends.

    Parameters
    ----------
    pressure : PressureField
        ``p*``.
    inner, outer : Radius
        Ends of the annulus.
    alpha : float
        ``alpha*``, the width of the layer at the edge.
    tolerance : float
        Relative accuracy of the integrals.
    rim : Radius, optional
        Rim of the stick disk; by default the inner end.
    """

    def __init__(
        self,
        pressure: PressureField,
        inner: Radius,
        outer: Radius,
        alpha: float,
        tolerance: float,
        rim: Radius | None = None,
    ) -> None:
        width = gap(inner, outer)
        half = width / 2.0
        # square roots at the inner end; at the outer end a singular pressure is one, too
        points = 3 + ceil(-0.3 * log(tolerance))  # each of them wins a digit
        finest = max(1e-3 * tolerance, 1e-17) ** 2 * half
        offsets, weights = _graded(half, min(half, inner.square) / half * finest, points)
        depth, outer_weights = _graded(
            half, min(half, alpha) * max(1e-3 * tolerance, 1e-17) if alpha else finest, points
        )
        #: distance of the nodes from the rim in s**2
        self.above = np.concatenate([offsets, width - depth])
        if rim is not None:
            self.above += gap(rim, inner)
        y = np.concatenate([inner.rest - offsets, outer.rest + depth])
        z = np.concatenate([inner.square + offsets, outer.square - depth])
        #: weights of ``p ds``; with s ds = dz/2
        self._root = np.sqrt(self.above)
        self.values = np.concatenate([weights, outer_weights]) * pressure.at(y) / (2.0 * np.sqrt(z))

    @property
    def at_rim(self) -> float:
        """``int p ds / sqrt(s^2 - inner^2)``."""
        return float((1.0 / self._root) @ self.values)

    def half_integral(self, below: Array) -> Array:
        """Return ``int p ds / sqrt(s^2 - t^2)`` where ``rim**2 - t**2 = below``."""
        return root_sums(below, self.above, self.values)

    def fall(self, below: Array) -> Array:
        """Return by how much the half-integral at ``inner**2 - below`` is less than at the rim."""
        sums = root_sums(below, self.above, self.values / self._root, self._root)
        return np.asarray(below * sums)


def _graded(reach: float, finest: float, points: int) -> tuple[Array, Array]:
    """Return nodes and weights on (0, reach), graded to 0 down to `finest`."""
    # the far end of the annulus is a singularity ln 2 before the first panel: make that one short
    panels = int(np.ceil((log(reach / finest) - 1.0) / 3.0))
    start = np.concatenate([[0.0], 1.0 + 3.0 * np.arange(panels)])
    width = np.concatenate([[1.0], np.full(panels, 3.0)])
    g, w = gauss_rule(points)
    nodes = reach * np.exp(-start[:, None] - width[:, None] * (1.0 + g) / 2.0)
    return nodes.ravel(), (nodes * (w * width[:, None] / 2.0)).ravel()


def disk_resolution(
    radius: Radius, alpha: float, beta: float, tolerance: float, *, slipping: float = 1.0
) -> Resolution:
    """Return the first space for a stick disk: its layers are those of alpha, beta and the rim.

    `slipping` is the width in ``s**2`` of a slip annulus that ends in stick: what E does next to a
    narrow one is as large as its displacement.
    """
    rim = max(alpha, radius.rest) / radius.square
    # without compliance the traction beyond the slip annulus is singular down to its width
    layer = (beta / radius.value) or radius.rest / radius.square
    scales = [1.0, rim, layer, slipping / radius.square]
    return starting_resolution(
        -log(min(scales)), tolerance, root_tail=beta == 0.0, bends=(1.0 - log(min(rim, 1.0)),)
    )


def rim_target(
    drive: Drive, radius: Radius, sources: list[tuple[float, SlipSource]], *, keep: bool
) -> tuple[float, Callable[[Array], Array]]:
    """Return the target of a stick disk at its rim, and on the disk.

    Parameters
    ----------
    drive : Drive
    radius : Radius
        The rim.
    sources : list of (float, SlipSource)
        Slip zones outside, each with its sign times ``f / kappa``.
    keep : bool
        Whether the function includes the balance. It does not where the target must vanish at
        the rim, at zero compliance.

    Returns
    -------
    balance : float
        ``R(c) - (f/kappa) P(c)``.
    function : callable
        The target as a function of ``d = 1 - s**2/c**2``. Near the rim it is built from differences
        that do not cancel; beyond, from the parts, whose noise falls with their size.
    """
    at_rim = float(drive.target(np.array(radius.rest)))
    balance = at_rim - sum(factor * source.at_rim for factor, source in sources)
    reach, rise = drive.rise(radius)
    at_start, at_end = (balance, 0.0) if keep else (0.0, balance)

    def function(d: Array) -> Array:
        near = d <= reach
        value = np.empty_like(d)
        below = radius.square * d
        value[near] = rise(d[near]) + at_start
        value[~near] = drive.target(radius.rest + below[~near]) - at_end
        for factor, source in sources:
            value[near] += factor * source.fall(below[near])
            value[~near] -= factor * source.half_integral(below[~near])
        return value

    return balance, function
