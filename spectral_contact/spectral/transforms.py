"""Abel integrals of a function at the sampling points of its own panels."""

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
    """Return the function that the coefficients stand for."""
    tail = coefficients[-panels.tail_terms :]
    form = panels.width, panels.power, panels.root_tail
    return LogSeries(panels.table(coefficients), tail, *form)


class Transforms:
    """Abel integrals of a function at the sampling points of its own panels, without a matrix.

    In ``x`` they are convolutions: one row of blocks, kept for a set of panels, serves every panel
    by a shift. Points are the panels', then the tail's.

    Parameters
    ----------
    panels : LogPanels
        Without endpoint weight or root tail.
    """

    def __init__(self, panels: LogPanels) -> None:
        self.panels = panels
        self._x = panels.sampling()

    def abel_right(self, coefficients: Array) -> Array:
        """Return the `abel_right` integral, (..., sampling points), of functions (..., size)."""
        panels = self.panels
        terms = self.panels.degree + 1
        blocks, tail = self._right_blocks
        count = panels.panels
        shape = coefficients.shape[:-1]
        values = coefficients[..., count * terms :] @ tail.T
        from_panels = coefficients[..., : count * terms].reshape(*shape, count, terms) @ blocks
        sums = from_panels[..., -1, :].copy()
        size = sums.shape[-1]
        for j in range(1, count):
            stop = size - j * panels.samples
            sums[..., :stop] += from_panels[..., -1 - j, size - stop :]
        values[..., :size] += np.exp(-0.5 * self._x).ravel() * sums
        return np.asarray(values)

    def abel_left(self, coefficients: Array) -> Array:
        """Return the `abel_left` integral, (..., sampling points), of functions (..., size)."""
        panels = self.panels
        terms = self.panels.degree + 1
        blocks, tail = self._left_blocks
        count = panels.panels
        shape = coefficients.shape[:-1]
        series = coefficients[..., : count * terms].reshape(*shape, count, terms)
        scaled = series * np.exp(-0.5 * panels.width * np.arange(count))[:, None]
        from_panels = scaled @ blocks
        values = from_panels[..., 0, :].copy()
        size = values.shape[-1]
        for j in range(1, count):
            start = j * panels.samples
            values[..., start:] += from_panels[..., j, : size - start]
        return np.concatenate([values, coefficients @ tail.T], axis=-1)

    @cached_property
    def _right_blocks(self) -> tuple[Array, Array]:
        panels = self.panels
        to_end = panels.width - self._x[0]
        blocks = abel_right_blocks(to_end, panels.panels, panels.width, panels.degree)
        return _in_a_row(blocks[:, ::-1]), abel_right_tail(panels.sampling_distances, panels.end)

    @cached_property
    def _left_blocks(self) -> tuple[Array, Array]:
        panels = self.panels
        mesh = panels.panels, panels.width, panels.degree
        blocks = abel_left_blocks(self._x[0], *mesh)
        return _in_a_row(blocks), abel_left(panels.tail_sampling(), *mesh)


transforms = bounded_cache("Abel transforms", 12)(Transforms)


def _in_a_row(blocks: Array) -> Array:
    """Return blocks (points, panels, terms) side by side, (terms, panels * points)."""
    return blocks.transpose(2, 1, 0).reshape(blocks.shape[2], -1)
