"""Pressure and traction on the parts of a contact, known or unknown, and their places in a vector.

The disk is cut at the boundaries between zones. On each part the pressure p and the *shear* ``u =
q/s`` are expanded in the functions of a mesh that is graded to a boundary; q is the traction, and s
the radius over that of the contact. (The displacement is not u, but u_r.) A *vector* holds the
unknowns. This module maps vectors to the coefficients of both fields on every part, and linear
functionals of these coefficients to rows, which are functionals of vectors.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from spectral_contact.fields.series import (
    CENTRE,
    EDGE,
    LogSeries,
    PressureField,
    Radius,
    ZonalField,
    ZonePiece,
)
from spectral_contact.spectral.abel import moments_on
from spectral_contact.spectral.blocks import disk_shear
from spectral_contact.spectral.blockwise import Blockwise
from spectral_contact.spectral.jacobi import (
    gauss_rule,
    legendre_expansion_matrix,
    legendre_values,
)
from spectral_contact.spectral.moments import moments
from spectral_contact.spectral.panels import DiscreteSpace, LogPanels
from spectral_contact.spectral.parameters import Parameters
from spectral_contact.spectral.parts import DiskPartition, GradedMesh
from spectral_contact.spectral.transforms import series_of
from spectral_contact.spectral.tuning import EXTRA
from spectral_contact.threads import cached_property

Array = NDArray[np.float64]
Degrees = tuple[int, ...]


class MeshPart(NamedTuple):
    """The central disk, or one half of a zone around it, with its mesh.

    Attributes
    ----------
    zone : int
        Number of the zone, from the centre outward: the disk is one part, other zones are two.
    state : int
        0 for stick, +1 or -1 for slip with this sign of the traction.
    boundary_number : int
        Number of the boundary that the mesh is graded to; -1 for the edge of the contact.
    mesh, shear_mesh : GradedMesh
        Panels graded to the boundary, with the functions of p, and with those of u. They differ in
        the endpoint weight.
    degrees : tuple of int
        Highest degree of an unknown on every panel.
    pressure_degrees : tuple of int
        Highest degree of the expansion of p on every panel. A known pressure has that of the
        panels.
    """

    zone: int
    state: int
    boundary_number: int
    mesh: GradedMesh
    shear_mesh: GradedMesh
    degrees: Degrees
    pressure_degrees: Degrees

    @property
    def sticks(self) -> bool:
        """Whether the zone sticks."""
        return self.state == 0

    @property
    def shear_degrees(self) -> Degrees:
        """Highest degree of the expansion of u on every panel.

        In slip u is ``f p/s``, and has more degrees than p: where p hardly varies, s does. Toward
        the boundary s varies less and less, so that from panel to panel there are 3 fewer of them.
        """
        if self.sticks:
            return self.degrees
        highest = self.mesh.panels.degree
        added = [max(EXTRA - 3 * j, 0) for j in range(len(self.degrees))]
        return tuple(min(n + m, highest) for n, m in zip(self.pressure_degrees, added, strict=True))


class KnownDisplacement(NamedTuple):
    """The radial displacement that slip has left, and that is kept where the surface sticks now.

    Attributes
    ----------
    field : ZonalField
        ``u_r / kappa`` at the radii that have slipped, to a factor; zero at others.
    factor : float
        What the field is multiplied by.
    error : float
        Bound of the error of the field times the factor.
    """

    field: ZonalField
    factor: float
    error: float

    def evaluate(self, y: Array) -> Array:
        """Return ``u_r / kappa`` at ``y = 1 - s**2``."""
        return self.factor * self.field.evaluate(y)

    def on_zone(self, outer: Radius) -> ZonePiece:
        """Return the displacement on a zone with this outer end, inside one piece of the field."""
        piece = next(piece for piece in self.field.pieces if piece.outer.rest <= outer.rest)
        return replace(piece, outer=outer, factor=piece.factor * self.factor)


class UnknownField(NamedTuple):
    """An unknown field on a part.

    Attributes
    ----------
    part : int
        Number of the part.
    panels : LogPanels
        In the logarithm of the distance to the boundary, with a polynomial tail.
    degrees : tuple of int
        Highest degree on every panel.
    functions : ndarray of int
        The numbers of the functions of the panels that are in use.
    place : slice
        Where the coefficients are in a vector.
    is_shear : bool
        Whether the field is u, else it is p.
    """

    part: int
    panels: LogPanels
    degrees: Degrees
    functions: NDArray[np.int_]
    place: slice
    is_shear: bool

    def coefficients(self, vector: Array) -> Array:
        """Return the coefficients of all functions of the panels, from those in a vector.

        Several vectors are columns.
        """
        coefficients = np.zeros((self.panels.size, *vector.shape[1:]))
        coefficients[self.functions] = vector[self.place]
        return coefficients


class FieldMap(NamedTuple):
    """The coefficients of p or u on a part, as a linear map of a vector.

    Attributes
    ----------
    place : slice
        The entries of a vector on which the coefficients depend.
    matrix : Blockwise, optional
        The matrix from these entries to the coefficients. Without one they are the coefficients.
    """

    place: slice
    matrix: Blockwise | None = None

    def apply(self, vectors: Array) -> Array:
        """Return the coefficients for vectors as columns."""
        entries = vectors[self.place]
        return entries if self.matrix is None else self.matrix.times(entries)

    def add(self, rows: Array, functionals: Array) -> None:
        """Add functionals of the coefficients, as rows, to rows that act on vectors."""
        matrix = self.matrix
        rows[:, self.place] += functionals if matrix is None else matrix.left_times(functionals)


class ContactFields:
    """The two fields on zones with given boundaries.

    A *vector* holds `pressure_terms` coefficients of the pressure, then those of u on the parts
    that stick, outward. If the pressure is unknown the first are its coefficients on the parts; if
    it is known they are the multipliers of the known pressures: 1 for the pressure itself, and 0 or
    1 for its contributions.

    Parameters
    ----------
    radii : tuple of Radius
        Boundaries between zones, outward.
    states : tuple of int
        0 for stick, +1 or -1 for slip with this sign of the traction; the first is 0.
    spaces : sequence of DiscreteSpace
        Meshes and degrees: of the central disk, then toward the inner and the outer end of every
        zone around it.
    parameters : Parameters
    pressures : sequence of PressureField
        The known pressure, of unit load; then, optionally, two contributions to it with zero load:
        that of the top two degrees of the space in which it was solved for, and that of the top
        degree. The same degrees of its expansion on the parts of this mesh, which the coarser
        spaces do not represent, are added to them. If the sequence is empty the pressure is
        unknown.
    displacement : KnownDisplacement, optional
        That of what sticks, under a known pressure: on those zones around the central disk where it
        is not zero everywhere. The disk itself has never slipped.

    Attributes
    ----------
    parts : list of MeshPart
    stick_parts : list of int
        Numbers of the parts that stick.
    fields : list of UnknownField
        The unknown fields, in the order of a vector.
    pressure_terms, unknowns : int
        How many coefficients of a vector belong to the pressure, and how many there are in all.
    load_row : ndarray, shape (pressure_terms,)
        ``int p s ds`` as a row: it acts on the first coefficients of a vector.
    """

    def __init__(
        self,
        radii: tuple[Radius, ...],
        states: tuple[int, ...],
        spaces: Sequence[DiscreteSpace],
        parameters: Parameters,
        pressures: Sequence[PressureField] = (),
        *,
        displacement: KnownDisplacement | None = None,
    ) -> None:
        self.radii = radii
        self.states = states
        self.parameters = parameters
        self.pressure_known = bool(pressures)
        self.parts = self._cut(spaces)
        self.stick_parts = [k for k, part in enumerate(self.parts) if part.sticks]
        self._place_fields(pressures)
        #: coefficients of ``u_r / (kappa s)`` on the parts that stick and are displaced
        self.displacement_coefficients: dict[int, Array] = {}
        self.displacement = displacement
        if displacement is not None:
            self._expand_displacement(displacement, len(pressures))
        self._assemble_loads()

    def _cut(self, spaces: Sequence[DiscreteSpace]) -> list[MeshPart]:
        """Return the parts of the disk."""
        boundaries = len(self.radii)
        parts = []
        ends = DiskPartition(self.radii, pointed=False).ends
        for k, (end, (panels, degrees)) in enumerate(zip(ends, spaces, strict=True)):
            zone = (k + 1) // 2
            state = self.states[zone]
            if state != 0 and not self.pressure_known:
                # room for the degrees that u = f p/s has and p has not (`MeshPart.shear_degrees`)
                panels = replace(panels, degree=panels.degree + EXTRA)
            boundary_number = k // 2 if k < 2 * boundaries else -1
            power = panels.power
            if state == 0:
                # without compliance the traction is singular at an edge that sticks
                singular = self.parameters.beta == 0.0 and boundary_number < 0
                power = -0.5 if singular else 0.0
            # only the traction at the rim of a disk has a tail of roots
            mesh = GradedMesh(*end, replace(panels, root_tail=False))
            shear_mesh = mesh._replace(panels=replace(panels, power=power))
            pressure_degrees = degrees
            if self.pressure_known:
                # it costs nothing to hold a known pressure in all functions of the panels
                pressure_degrees = (panels.degree,) * panels.count
            parts.append(
                MeshPart(
                    zone,
                    state,
                    boundary_number,
                    mesh,
                    shear_mesh,
                    degrees,
                    pressure_degrees,
                )
            )
        return parts

    # the two fields in a vector

    def _place_fields(self, pressures: Sequence[PressureField]) -> None:
        """Give the unknown fields their places, and expand the known ones."""
        self.fields: list[UnknownField] = []
        #: the pressure on every part
        self.pressure_maps: list[FieldMap] = []
        #: u on every part, by its number
        self.shear_maps: dict[int, FieldMap] = {}
        #: coefficients of the known pressures less the value of the pressure at the centre, a
        #: column for each, on the parts graded to a boundary between zones: all but the last
        self.known_variation: list[Array] = []
        self.unknowns = len(pressures)
        if self.pressure_known:
            self._expand(pressures)
        else:
            for k, part in enumerate(self.parts):
                self.pressure_maps.append(self._add_unknown(k, part.mesh.panels, is_shear=False))
                if not part.sticks:
                    ratio = part.state * self.parameters.friction
                    slip_shear = _over_radius(part, ratio)
                    self.shear_maps[k] = FieldMap(self.pressure_maps[k].place, slip_shear)
        self.pressure_terms = self.unknowns
        for k in self.stick_parts:
            panels = self.parts[k].shear_mesh.panels
            self.shear_maps[k] = self._add_unknown(k, panels, is_shear=True)

    def _add_unknown(self, k: int, panels: LogPanels, *, is_shear: bool) -> FieldMap:
        """Add the unknown field on a part at the end of a vector, and return its map."""
        degrees = self.parts[k].degrees
        functions = panels.functions(degrees)
        place = slice(self.unknowns, self.unknowns + len(functions))
        self.fields.append(UnknownField(k, panels, degrees, functions, place, is_shear))
        self.unknowns = place.stop
        return FieldMap(place)

    def _expand(self, pressures: Sequence[PressureField]) -> None:
        """Expand known pressures on every part, and the traction in slip under them.

        The stick condition prescribes kappa R for the half-integral of q, and a constant pressure
        has a constant R (docs/theory). So the increments of R from a boundary are taken from the
        pressure less its value at the centre. The rounding of that value would be as large as the
        traction of a small stick disk under little friction.
        """
        place = slice(0, len(pressures))
        central = PressureField.values_of(pressures, np.ones(1))
        for k, part in enumerate(self.parts):
            panels = part.mesh.panels
            points = part.mesh.sampling()
            values = PressureField.values_of(pressures, points.y)
            variation = values - central
            if panels.power != 0.0:
                values = values / panels.sampling_distances**panels.power
            self.pressure_maps.append(FieldMap(place, Blockwise([_expansion(part, values)])))
            if part.boundary_number >= 0:
                self.known_variation.append(_expansion(part, variation))
            if not part.sticks:
                slip_shear = part.state * self.parameters.friction * values / np.sqrt(points.z)
                self.shear_maps[k] = FieldMap(place, Blockwise([_expansion(part, slip_shear)]))

    def _expand_displacement(self, displacement: KnownDisplacement, pressures: int) -> None:
        """Expand the displacement of what sticks around the central disk, which has not slipped.

        There is a column for each known pressure: for the pressure itself the displacement, for its
        contributions the error of the displacement.
        """
        for k in self.stick_parts:
            part = self.parts[k]
            points = part.shear_mesh.sampling()
            values = displacement.evaluate(points.y)
            if part.zone > 0 and values.any():
                errors = np.full((pressures - 1, len(values)), displacement.error)
                functions = part.shear_mesh.panels.functions(part.degrees)
                columns = np.vstack([values, errors]) / np.sqrt(points.z)
                self.displacement_coefficients[k] = part.shear_mesh.expand(columns)[:, functions].T

    def series(self, vector: Array) -> tuple[list[LogSeries], dict[int, LogSeries]]:
        """Return the series of p on all parts, and those of u on parts that stick, for a vector."""
        pressures = []
        for k, part in enumerate(self.parts):
            panels = part.mesh.panels
            coefficients = np.zeros(panels.size)
            used = panels.functions(part.pressure_degrees)
            coefficients[used] = self.pressure_maps[k].apply(vector)
            pressures.append(series_of(panels, coefficients))
        shears = {
            field.part: series_of(field.panels, field.coefficients(vector))
            for field in self.fields
            if field.is_shear
        }
        return pressures, shears

    # the mesh

    @property
    def bounds(self) -> tuple[Radius, ...]:
        """Ends of the zones, from the centre to the edge."""
        return CENTRE, *self.radii, EDGE

    @property
    def symmetric(self) -> bool:
        """Whether the matrix is symmetric and positive definite: no p in slip is unknown."""
        return self.pressure_known or not self.radii

    @cached_property
    def top_degree_indices(self) -> tuple[NDArray[np.int_], NDArray[np.int_]]:
        """Indices in a vector of the top two degrees of every panel, and those of the top one.

        Both include the last function of every tail. A known pressure has none.
        """
        two_degrees, top_degree = (
            np.concatenate(
                [field.place.start + field.panels.top(field.degrees, n) for field in self.fields]
            )
            for n in (2, 1)
        )
        return two_degrees, top_degree

    def _assemble_loads(self) -> None:
        """Assemble ``int p s ds`` and ``int q ds`` of the parts, and the load of a vector."""
        #: ``int p s ds``, and ``int u s ds = int q ds``, of the functions on every part; the second
        #: is no part of the total shear, which is `shear_row`
        self.loads: list[Array] = []
        self.shear_loads: list[Array] = []
        for part in self.parts:
            half = 0.5 * part.mesh.extent
            of_pressure = moments(part.mesh.panels)
            of_shear = moments(part.shear_mesh.panels)
            self.loads.append(half * of_pressure[part.mesh.panels.functions(part.pressure_degrees)])
            self.shear_loads.append(
                half * of_shear[part.shear_mesh.panels.functions(part.shear_degrees)]
            )
        self.load_row = np.zeros(self.pressure_terms)
        if self.pressure_known:
            self.load_row[0] = 1.0 / (2.0 * np.pi)
        else:
            self.load_row[:] = np.concatenate(self.loads)

    @property
    def slip_shear_error(self) -> float:
        """Estimate of the error of the shear in slip by that of the load of a known pressure.

        The load of all parts has to be 1, and each is taken to have the same relative error.
        """
        vector = np.eye(1, self.unknowns)[0]  # the known pressure alone
        pairs = zip(self.loads, self.pressure_maps, strict=True)
        loads = 2.0 * np.pi * np.array([load @ on_part.apply(vector) for load, on_part in pairs])
        slips = [not part.sticks for part in self.parts]
        in_slip = (self.parameters.friction * loads)[slips].sum()
        return float(in_slip * abs(loads.sum() - 1.0))

    # rows that act on vectors

    @cached_property
    def shear_row(self) -> Array:
        """``2 pi int q s ds``."""
        row = np.zeros((1, self.unknowns))
        for k, part in enumerate(self.parts):
            if part.zone == 0:
                unit = disk_shear(part.shear_mesh.panels, part.degrees)
                self.shear_maps[k].add(row, part.mesh.boundary.value**3 * unit[None])
            else:
                on_panels = moments_on(part.shear_mesh.panels, part.shear_degrees)
                s = np.sqrt(part.shear_mesh.points(on_panels.d).z)
                moment = 2.0 * np.pi * part.shear_mesh.extent * on_panels.with_densities(s[None])
                self.shear_maps[k].add(row, moment)
        return np.asarray(row[0])

    def total_shear(self, vector: Array) -> float:
        """Return ``2 pi int q s ds`` of a vector."""
        return float(self.shear_row @ vector)

    @cached_property
    def jump_rows(self) -> Array:
        """Jumps of the traction at the boundaries, q in stick less ``+-f p`` in slip, as rows."""
        rows = np.zeros((len(self.radii), self.unknowns))
        for k in self.stick_parts:
            part = self.parts[k]
            j = part.boundary_number
            if j < 0:
                continue
            row = rows[j : j + 1]
            shear = _values_at_boundary(part.shear_mesh.panels, len(self.shear_loads[k]))
            self.shear_maps[k].add(row, part.mesh.boundary.value * shear)
            # one of the two zones sticks, and its state is 0
            signed_friction = (self.states[j] + self.states[j + 1]) * self.parameters.friction
            pressure = _values_at_boundary(part.mesh.panels, len(self.loads[k]))
            self.pressure_maps[k].add(row, -signed_friction * pressure)
        return rows


def _expansion(part: MeshPart, values: Array) -> Array:
    """Return coefficients on a part, as columns, through values at its sampling points, as rows.

    The first column is the known pressure, or what follows from it. If there are contributions to
    it, its top two degrees on every panel join the second column, and its top one the third.
    """
    panels = part.mesh.panels
    degrees = part.pressure_degrees
    coefficients = part.mesh.expand(values)[:, panels.functions(degrees)].T
    for column in range(1, len(values)):
        top = panels.top(degrees, 3 - column)[:-1]  # without the tail's
        coefficients[top, column] += coefficients[top, 0]
    return coefficients


def _values_at_boundary(panels: LogPanels, count: int) -> Array:
    """Return the values of so many functions at the boundary, as a row.

    The last are those of the tail: Legendre's at -1.
    """
    row = np.zeros((1, count))
    row[0, -panels.tail_terms :] = 1.0 - 2.0 * (np.arange(panels.tail_terms) % 2)
    return row


def _over_radius(part: MeshPart, factor: float) -> Blockwise:
    """Return the map from the coefficients of p on a part to those of ``factor p/s``."""
    mesh = part.mesh
    panels = mesh.panels
    points = panels.degree + EXTRA
    expansion = legendre_expansion_matrix(points, panels.degree)
    values = legendre_values(gauss_rule(points)[0], panels.degree)
    ratios = factor / np.sqrt(mesh.points(np.exp(-panels.sampling(points))).z)
    blocks = [
        expansion[: m + 1] @ (values[:, : n + 1] * ratio[:, None])
        for ratio, m, n in zip(ratios, part.shear_degrees, part.pressure_degrees, strict=True)
    ]
    # on the tail s is constant to rounding
    at_tail = float(np.sqrt(mesh.points(np.array([panels.end / 2.0])).z[0]))
    return Blockwise([*blocks, factor / at_tail * np.eye(panels.tail_terms)])
