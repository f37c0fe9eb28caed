"""Spaces for contact through a nonlinear layer: log panels to edges and tips, or cells."""

from __future__ import annotations

from dataclasses import replace
from math import ceil, log
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from spectral_contact.contact.normal import NormalContact
from spectral_contact.contact.on_parts import (
    edge_value,
    field_of,
    pointwise_errors,
    series_on_parts,
    split_parts,
)
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


#: Degree in which a pressure with bends is interpolated on the panels of one part.
_INTERPOLATION_DEGREE = 32


class PartSamples(NamedTuple):
    """The sampling points of a part.

    Attributes
    ----------
    samples : slice
        Their numbers among all sampling points.
    sign : int
        +1 if the part is outside its boundary, at larger radii, -1 if inside, as in
        `DiskPartition`.
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
        Extent in ``s**2`` of the tail at the edge.
    central : int
        Number of panels of the part at the centre, which are the first ones. Their errors are those
        of the pressure at the centre (`layered`).
    """

    def __init__(self, parts: DiskPartition, used: tuple[DiscreteSpace, ...]) -> None:
        self._parts = parts
        self._used = used
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
        """Return the sampling points of every part."""
        found, start = [], 0
        for (_, sign, extent), (panels, _) in zip(self._parts.ends, self._used, strict=True):
            distances = panels.sampling_distances
            ends = np.exp(-panels.width * np.arange(panels.count + 1))
            on_panels = np.repeat(-np.diff(ends), panels.samples)
            widths = np.concatenate([on_panels, np.full(panels.tail_points, panels.end)])
            samples = slice(start, start + len(distances))
            found.append(PartSamples(samples, sign, extent * distances, extent * widths))
            start = samples.stop
        return found

    def at_boundaries(self, coefficients: Array) -> list[float]:
        """Return the value of every part's series at the boundary of the part."""
        each = zip(self._used, split_parts(self._used, coefficients), strict=True)
        return [edge_value(panels, own) for (panels, _), own in each]

    def jumps(self, coefficients: Array) -> Array:
        """Return, at every sampling point, the jump of a function at the boundary of its part."""
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
        """Return the expected errors of the pressure on every panel."""
        return pointwise_errors(self._parts, self._used, pressure, change, mean)

    def converted(self, coefficients: Array, old: Form) -> Array:
        """Return the coefficients here of a function of another space."""
        assert isinstance(old, PanelForm)
        return self.sampling.coefficients(old.field(coefficients).evaluate(self.y))

    def known_pressure(self, pressure: Array, change: Change, layer_width: float) -> NormalContact:
        """Return the pressure as the known pressure that drives a traction, on one part.

        With it come its contributions of the top degrees, for errors (`NormalContact.changes`). If
        the law bends inside the contact, the pressure is on several parts. Then it is interpolated
        on panels of one part, and `pressure_error` of the result is the error of that.

        Parameters
        ----------
        pressure : ndarray
        change : Change
            Its change without the top two degrees.
        layer_width : float
            Width of its layer at the edge.
        """
        space = self.space
        # the space with one degree less lacks exactly the coefficients of the top degrees
        is_top = np.zeros_like(pressure)
        is_top[space.index[space.coarse_unknowns :]] = 1.0
        fields: tuple[Array, ...] = (pressure, change.coefficients, is_top * pressure)
        panels = self._used[0].panels
        if len(self._used) > 1:
            panels = self._panels_to_edge()
            fields = tuple(self._on_one_part(panels, coefficients) for coefficients in fields)
        contact, two_degrees, top_degree = (
            NormalContact(
                layer_width,
                0.0,
                PressureField(None, series_of(panels, coefficients)),
                panels,
                coefficients,
            )
            for coefficients in fields
        )
        error = 0.0
        if len(self._used) > 1:
            values = self.sampling.values(pressure)
            difference = contact.pressure.evaluate(self.y) - values
            error = float(np.abs(difference).max()) / float(values.min())
        return replace(contact, changes=(two_degrees, top_degree), pressure_error=error)

    def _panels_to_edge(self) -> LogPanels:
        """Return panels of one part that are as deep as those next to the edge."""
        panels = self._used[-1].panels
        added = ceil(-log(self._parts.ends[-1][2]) / panels.width)
        return replace(panels, count=panels.count + added, degree=_INTERPOLATION_DEGREE)

    def _on_one_part(self, panels: LogPanels, coefficients: Array) -> Array:
        """Return the coefficients of a function on panels of one part, through its values there."""
        mesh = GradedMesh(EDGE, -1, 1.0, panels)
        return mesh.expand(self.field(coefficients).evaluate(mesh.sampling().y))

    def at_edge(self, coefficients: Array) -> float:
        """Return the value at the edge."""
        return edge_value(self._used[-1][0], coefficients)

    def next_to_edge(self, coefficients: Array, y: float) -> float:
        """Return the value at the distance ``y = 1 - s**2`` from the edge."""
        series = series_on_parts(self._used, coefficients)[-1]
        return series.value(y / self._parts.ends[-1][2])

    def in_tail(self, rows: Array, u: Array) -> Array:
        """Return values of functions on the tail at the edge.

        Parameters
        ----------
        rows : ndarray, shape (functions, size)
            Their coefficients.
        u : ndarray
            Distances in ``s**2`` from the edge, over the extent of the tail.
        """
        terms = self._used[-1][0].tail_terms
        return rows[:, -terms:] @ legendre_values(2.0 * u - 1.0, terms - 1).T

    def edge_bound(self, change: Array) -> float:
        """Return a bound of the modulus of a change at the edge."""
        return float(np.abs(change[-self._used[-1][0].tail_terms :]).sum())


class CellForm:
    """Polynomials on cells; attributes and methods are those of `PanelForm`.

    Parameters
    ----------
    cells : DiskCells
    degrees : tuple of int
    """

    def __init__(self, cells: DiskCells, degrees: tuple[int, ...]) -> None:
        self._cells = cells
        self._degrees = degrees
        self.space: NodalSpace = cell_space(cells, degrees)
        self.sampling = Sampling(cell_degrees=degrees)
        self.z: Array = cells.squares_at(self.sampling.places_on_cells())
        self.tail_extent = cells.lengths[-1]
        self.central = 1

    def field(self, coefficients: Array) -> PressureField | ZonalField:
        """Return the function."""
        return self._cells.field(self._split(coefficients))

    def _split(self, coefficients: Array) -> list[Array]:
        return np.split(coefficients, np.cumsum(np.array(self._degrees) + 1)[:-1])

    def errors(self, pressure: Array, change: Change, mean: float) -> Array:
        """Return the expected errors of the pressure on every panel."""
        shares = []
        each = zip(self._split(pressure), self._split(change.coefficients), strict=True)
        for own, changed in each:
            ends = min(abs(float(own.sum())), abs(float(own[::2].sum() - own[1::2].sum())))
            shares.append(np.abs(changed).sum() / max(ends, mean))
        return np.array(shares)

    def converted(self, coefficients: Array, old: Form) -> Array:
        """Return the coefficients here of a function of another space."""
        assert isinstance(old, CellForm)
        rows = []
        for degree, on_cell in zip(self._degrees, old._split(coefficients), strict=True):
            row = np.zeros(degree + 1)
            terms = min(len(on_cell), degree + 1)
            row[:terms] = on_cell[:terms]
            rows.append(row)
        return np.concatenate(rows)

    def at_edge(self, coefficients: Array) -> float:
        """Return the value at the edge."""
        return float(self._split(coefficients)[-1].sum())

    def next_to_edge(self, coefficients: Array, y: float) -> float:
        """Return the value at the distance ``y = 1 - s**2`` from the edge, in the last cell."""
        return float(self.in_tail(coefficients[None, :], np.array([y / self.tail_extent]))[0, 0])

    def in_tail(self, rows: Array, u: Array) -> Array:
        """Return values of functions on the last cell, which is the tail of `PanelForm.in_tail`."""
        degree = self._degrees[-1]
        return rows[:, -degree - 1 :] @ legendre_values(1.0 - 2.0 * u, degree).T

    def edge_bound(self, change: Array) -> float:
        """Return a bound of the modulus of a change at the edge."""
        return float(np.abs(self._split(change)[-1]).sum())

    def known_pressure(self, pressure: Array, change: Change, layer_width: float) -> None:
        """Return None: a traction is driven under flat punches alone, which have panels."""


#: A space of Newton's method.
Form: TypeAlias = PanelForm | CellForm
