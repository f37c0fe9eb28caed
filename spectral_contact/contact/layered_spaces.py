"""Spaces for contact through a nonlinear layer: log panels to edges and tips, or cells."""

from __future__ import annotations

from dataclasses import replace
from math import ceil, log
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from spectral_contact.contact.on_parts import (
    edge_value,
    field_of,
    pointwise_errors,
    series_on_parts,
    split_parts,
)
from spectral_contact.contact.resolution import NormalContact
from spectral_contact.fields.series import EDGE, PressureField, Radius, ZonalField
from spectral_contact.spectral.cells import DiskCells, cell_space
from spectral_contact.spectral.jacobi import legendre_values
from spectral_contact.spectral.panels import DiscreteSpace, LogPanels
from spectral_contact.spectral.parts import DiskPartition, GradedMesh
from spectral_contact.spectral.pointwise import Sampling
from spectral_contact.spectral.regularised import Change, NodalSpace
from spectral_contact.spectral.spaces import disk_space
from spectral_contact.spectral.transforms import series_of
from spectral_contact.threads import cached_property

Array = NDArray[np.float64]


#: Degree in which a pressure with bends drives a traction.
_DRIVING_DEGREE = 32


class PartSamples(NamedTuple):
    """The sampling points of a part.

    Attributes
    ----------
    samples : slice
        Which they are, of all.
    sign : int
        +1 if the part lies above its boundary, -1 if below, as in `DiskPartition`.
    distances : ndarray
        Their distances in ``s**2`` to the boundary, falling.
    widths : ndarray
        Extents in ``s**2`` of the panels on which they are.
    """

    samples: slice
    sign: int
    distances: Array
    widths: Array


class PanelForm:
    """Log panels on the parts of a disk.

    Parameters
    ----------
    parts : DiskPartition
    used : tuple of (LogPanels, tuple of int)
        Panels of every part, and the degrees on them.

    Attributes
    ----------
    space : NodalSpace
    sampling : Sampling
    z : ndarray
        ``s**2`` at the sampling points.
    tail_extent : float
        Width in ``s**2`` of the last piece, next to the edge.
    central : int
        How many panels are of the piece at the centre.
    """

    def __init__(self, parts: DiskPartition, used: tuple[DiscreteSpace, ...]) -> None:
        self._parts, self._used = parts, used
        self.space: NodalSpace = disk_space(parts, used)
        self.sampling = Sampling(used)
        ends = zip(parts.ends, used, strict=True)
        self._points = [GradedMesh(*end, panels).sampling() for end, (panels, _) in ends]
        self.z: Array = np.concatenate([part.z for part in self._points])
        self.tail_extent = parts.ends[-1][2] * used[-1][0].end
        self.central = len(used[0][1])

    @cached_property
    def y(self) -> Array:
        """``1 - s**2`` at the sampling points."""
        return np.concatenate([part.y for part in self._points])

    def part_samples(self) -> list[PartSamples]:
        """Return where the sampling points of every part are."""
        found, start = [], 0
        for (_, sign, extent), (panels, _) in zip(self._parts.ends, self._used, strict=True):
            distances = panels.sampling_distances
            ends = np.exp(-panels.width * np.arange(panels.panels + 1))
            on_panels = np.repeat(-np.diff(ends), panels.samples)
            widths = np.concatenate([on_panels, np.full(panels.tail_points, panels.end)])
            samples = slice(start, start + len(distances))
            found.append(PartSamples(samples, sign, extent * distances, extent * widths))
            start = samples.stop
        return found

    def at_boundaries(self, coefficients: Array) -> list[float]:
        """Return the value at the boundary of every part, as the part has it."""
        each = zip(self._used, split_parts(self._used, coefficients), strict=True)
        return [edge_value(panels, own) for (panels, _), own in each]

    def jumps(self, coefficients: Array) -> Array:
        """Return at the sampling points by how much a function jumps at the boundary of a part."""
        values: dict[Radius, list[float]] = {}
        each = list(zip(self._parts.ends, self.at_boundaries(coefficients), strict=True))
        for (boundary, _, _), value in each:
            values.setdefault(boundary, []).append(value)
        jumps = [max(values[boundary]) - min(values[boundary]) for (boundary, _, _), _ in each]
        counts = [len(panels.sampling_distances) for panels, _ in self._used]
        return np.repeat(jumps, counts)

    def field(self, coefficients: Array) -> PressureField | ZonalField:
        """Return the function."""
        return field_of(self._parts, series_on_parts(self._used, coefficients))

    def errors(self, pressure: Array, change: Change, mean: float) -> Array:
        """Return the expected errors of the pressure, and by what a degree lowers them."""
        return pointwise_errors(self._parts, self._used, pressure, change, mean)

    def carried(self, before: Array, old: Form) -> Array:
        """Return the coefficients of a function of another space."""
        assert isinstance(old, PanelForm)
        counts = [[panels.panels for panels, _ in form._used] for form in (old, self)]
        if old._parts != self._parts or counts[0] != counts[1]:
            return self.sampling.coefficients(old.field(before).evaluate(self.y))
        rows, parts = [], split_parts(old._used, before)
        for (was, _), (new, degrees), own in zip(old._used, self._used, parts, strict=True):
            table = np.zeros((new.panels, new.degree + 1))
            terms = min(was.degree, new.degree) + 1
            table[:, :terms] = was.table(own)[:, :terms]
            table *= np.arange(new.degree + 1) <= np.array(degrees)[:, None]
            rows += [table.ravel(), own[-was.tail_terms :]]
        return np.concatenate(rows)

    def driving(self, pressure: Array, change: Change, thin: float) -> NormalContact:
        """Return the pressure as it drives a traction, which takes panels to the edge alone.

        Where the law bends it is what these make of it, and what that lacks is its error.

        Parameters
        ----------
        pressure : ndarray
        change : Change
            What two degrees less make of it.
        thin : float
            Width of its layer at the edge.
        """
        functions = self.space
        last = np.zeros_like(pressure)
        last[functions.index[functions.coarse_unknowns :]] = 1.0
        driving: tuple[Array, ...] = (pressure, change.coefficients, last * pressure)
        panels = self._used[0][0]
        if len(self._used) > 1:
            panels = self._panels_to_edge()
            driving = tuple(self._to_edge(panels, coefficients) for coefficients in driving)
        whole, moved, lesser = (
            NormalContact(thin, 0.0, PressureField(None, series_of(panels, one)), panels, one)
            for one in driving
        )
        lost = 0.0
        if len(self._used) > 1:
            exact = self.sampling.values(pressure)
            off = whole.pressure.evaluate(self.y) - exact
            lost = float(np.abs(off).max()) / float(exact.min())
        return replace(whole, changes=(moved, lesser), pressure_error=lost)

    def _panels_to_edge(self) -> LogPanels:
        """Return panels of one part that are as deep as those next to the edge."""
        panels, extent = self._used[-1][0], self._parts.ends[-1][2]
        more = ceil(-log(extent) / panels.width)
        return replace(panels, panels=panels.panels + more, degree=_DRIVING_DEGREE)

    def _to_edge(self, panels: LogPanels, coefficients: Array) -> Array:
        """Return a function on panels of one part, through its values there."""
        mesh = GradedMesh(EDGE, -1, 1.0, panels)
        return mesh.expand(self.field(coefficients).evaluate(mesh.sampling().y))

    def at_edge(self, coefficients: Array) -> float:
        """Return the value at the edge."""
        return edge_value(self._used[-1][0], coefficients)

    def next_to_edge(self, coefficients: Array, y: float) -> float:
        """Return the value at a ``1 - s**2``."""
        series = series_on_parts(self._used, coefficients)[-1]
        return series.value(y / self._parts.ends[-1][2])

    def in_tail(self, rows: Array, u: Array) -> Array:
        """Return values of functions, (k, size), on the last piece, from the edge at ``u = 0``."""
        terms = self._used[-1][0].tail_terms
        return rows[:, -terms:] @ legendre_values(2.0 * u - 1.0, terms - 1).T

    def lost_at_edge(self, change: Array) -> float:
        """Return a bound of what a change is at the edge."""
        return float(np.abs(change[-self._used[-1][0].tail_terms :]).sum())


class CellForm:
    """Polynomials on cells; attributes and methods are those of `PanelForm`.

    Parameters
    ----------
    cells : DiskCells
    degrees : tuple of int
    """

    def __init__(self, cells: DiskCells, degrees: tuple[int, ...]) -> None:
        self._cells, self._degrees = cells, degrees
        self.space: NodalSpace = cell_space(cells, degrees)
        self.sampling = Sampling(polynomials=degrees)
        self.z: Array = cells.squares_at(self.sampling.places())
        self.tail_extent, self.central = cells.lengths[-1], 1

    def field(self, coefficients: Array) -> PressureField | ZonalField:
        """Return the function."""
        return self._cells.field(self._split(coefficients))

    def _split(self, coefficients: Array) -> list[Array]:
        return np.split(coefficients, np.cumsum(np.array(self._degrees) + 1)[:-1])

    def errors(self, pressure: Array, change: Change, mean: float) -> Array:
        """Return the expected errors of the pressure, and by what a degree lowers them."""
        shares = []
        each = zip(self._split(pressure), self._split(change.coefficients), strict=True)
        for own, changed in each:
            ends = min(abs(float(own.sum())), abs(float(own[::2].sum() - own[1::2].sum())))
            shares.append(np.abs(changed).sum() / max(ends, mean))
        return np.array(shares)

    def carried(self, before: Array, old: Form) -> Array:
        """Return the coefficients of a function of another space."""
        assert isinstance(old, CellForm)
        rows = []
        for degree, own in zip(self._degrees, old._split(before), strict=True):
            row = np.zeros(degree + 1)
            terms = min(len(own), degree + 1)
            row[:terms] = own[:terms]
            rows.append(row)
        return np.concatenate(rows)

    def at_edge(self, coefficients: Array) -> float:
        """Return the value at the edge."""
        return float(self._split(coefficients)[-1].sum())

    def next_to_edge(self, coefficients: Array, y: float) -> float:
        """Return the value at a ``1 - s**2``."""
        return float(self.in_tail(coefficients[None, :], np.array([y / self.tail_extent]))[0, 0])

    def in_tail(self, rows: Array, u: Array) -> Array:
        """Return values of functions, (k, size), on the last piece, from the edge at ``u = 0``."""
        degree = self._degrees[-1]
        return rows[:, -degree - 1 :] @ legendre_values(1.0 - 2.0 * u, degree).T

    def lost_at_edge(self, change: Array) -> float:
        """Return a bound of what a change is at the edge."""
        return float(np.abs(self._split(change)[-1]).sum())

    def driving(self, pressure: Array, change: Change, thin: float) -> None:
        """Return nothing: under a flat punch, which alone drives a traction, there are panels."""


#: What Newton's method may work in.
Form: TypeAlias = PanelForm | CellForm
