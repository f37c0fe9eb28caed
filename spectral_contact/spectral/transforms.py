"""Abel integrals of a function at the sampling points of its own panels.

d is the distance from the boundary, in extents of the part, and ``x = -ln d``. The *right* integral
of a function psi is one over smaller distances, hence larger x, and the *left* one over larger
distances (`abel`):

    1/2 int_0^d psi(d') dd' / sqrt(d - d'),    1/2 int_d^1 psi(d') dd' / sqrt(d' - d).
"""

from __future__ import annotations

import numpy as np

from spectral_contact.fields.series import Array, LogSeries
from spectral_contact.spectral.abel import (
    abel_left,
    abel_left_blocks,
    abel_right_blocks,
    abel_right_tail,
)
from spectral_contact.spectral.cache import bounded_cache
from spectral_contact.spectral.panels import LogPanels
from spectral_contact.spectral.parts import sampled_coefficients
from spectral_contact.threads import cached_property


def sampled_series(panels: LogPanels, values: Array) -> LogSeries:
    """Return the series through samples at the sampling points of the panels and the tail."""
    return LogSeries(*sampled_coefficients(panels, values), panels.width)


def series_of(panels: LogPanels, coefficients: Array) -> LogSeries:
    """Return the function with these coefficients on the panels and the tail, (size,)."""
    tail = coefficients[-panels.tail_terms :]
    return LogSeries(panels.table(coefficients), tail, panels.width, panels.power, panels.root_tail)


class AbelTransforms:
    """Abel integrals of a function at the sampling points of its own panels, without a matrix.

    But for a factor ``exp(-x/2)`` they are convolutions in x: the block from panel j to the points
    of panel i depends on ``i - j`` alone. So one row of blocks serves every panel, shifted by whole
    panels, and it is kept. The sampling points are those of the panels, farthest from the boundary
    first, and then those of the tail.

    Parameters
    ----------
    panels : LogPanels
        Without endpoint weight, and with a tail that is polynomial in d.
    """

    def __init__(self, panels: LogPanels) -> None:
        self.panels = panels
        self._x = panels.sampling()

    def abel_right(self, coefficients: Array) -> Array:
        """Return the right integral, (..., sampling points), of functions (..., size)."""
        panels = self.panels
        terms = panels.degree + 1
        blocks, tail_matrix = self._right_blocks
        count = panels.count
        shape = coefficients.shape[:-1]
        values = coefficients[..., count * terms :] @ tail_matrix.T
        # The row of blocks leads from the last panel to the points of all panels. The j-th panel
        # before the last one reaches the same points as far before its end, and the row leads
        # there without its first j blocks.
        from_panels = coefficients[..., : count * terms].reshape(*shape, count, terms) @ blocks
        sums = from_panels[..., -1, :].copy()
        points = sums.shape[-1]
        for j in range(1, count):
            stop = points - j * panels.samples
            sums[..., :stop] += from_panels[..., -1 - j, points - stop :]
        values[..., :points] += np.exp(-0.5 * self._x).ravel() * sums
        return np.asarray(values)

    def abel_left(self, coefficients: Array) -> Array:
        """Return the left integral, (..., sampling points), of functions (..., size)."""
        panels = self.panels
        terms = panels.degree + 1
        blocks, tail_matrix = self._left_blocks
        count = panels.count
        shape = coefficients.shape[:-1]
        panel_coefficients = coefficients[..., : count * terms].reshape(*shape, count, terms)
        # the factor exp(-x/2) at the start of each panel; the rest of it is in the blocks
        scaled = panel_coefficients * np.exp(-0.5 * panels.width * np.arange(count))[:, None]
        # The row of blocks leads from the first panel to the points of all panels. Panel j reaches
        # the points from its own on, and the row leads there without its last j blocks.
        from_panels = scaled @ blocks
        values = from_panels[..., 0, :].copy()
        points = values.shape[-1]
        for j in range(1, count):
            start = j * panels.samples
            values[..., start:] += from_panels[..., j, : points - start]
        return np.concatenate([values, coefficients @ tail_matrix.T], axis=-1)

    @cached_property
    def _right_blocks(self) -> tuple[Array, Array]:
        """The row of blocks, and the matrix from the tail's coefficients to all points."""
        panels = self.panels
        to_end = panels.width - self._x[0]
        blocks = abel_right_blocks(to_end, panels.count, panels.width, panels.degree)
        return _in_a_row(blocks[:, ::-1]), abel_right_tail(panels.sampling_distances, panels.end)

    @cached_property
    def _left_blocks(self) -> tuple[Array, Array]:
        """The row of blocks, and the matrix from all coefficients to the points of the tail."""
        panels = self.panels
        arguments = panels.count, panels.width, panels.degree
        blocks = abel_left_blocks(self._x[0], *arguments)
        return _in_a_row(blocks), abel_left(panels.tail_sampling(), *arguments)


#: `AbelTransforms`, cached.
transforms = bounded_cache("Abel transforms", 12)(AbelTransforms)


def _in_a_row(blocks: Array) -> Array:
    """Return blocks (points, panels, terms) side by side, (terms, panels * points)."""
    return blocks.transpose(2, 1, 0).reshape(blocks.shape[2], -1)
