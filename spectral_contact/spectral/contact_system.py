r"""The discrete equations of a contact whose zones stick or slip: one system for every case.

The disk is cut at the boundaries between zones. On each part p and ``u = q/s`` are expanded in the
functions of a mesh that is graded to a boundary, and each of the two fields is known or unknown
there:

===================================  =======================  =====================
case                                 p                        u
===================================  =======================  =====================
full stick, partial slip, coupled    unknown                  unknown where it sticks
the same without elastic coupling    known, with its changes  unknown where it sticks
===================================  =======================  =====================

In slip u follows from p, as ``q = f p`` times the sign of the zone. A known pressure is expanded on
the same parts, so that the same operators act on it. The equations are (docs/theory)

    alpha p + N p - kappa int_s^1 q = delta     where p is unknown,
    beta q + T q - kappa g[p] = 0               in stick.

**What Galerkin's method tests.** With the half-integrals F and G of p and q, and the drive
``R(t) = (2/t) int_0^t s p ds / sqrt(t^2 - s^2)`` of the pressure, the equations ask that

    W(t) = 2 delta - F(t) + 2 kappa int ... and E(t) = kappa R(t) - G(t),

tested with the half-integrals of all functions, are what the compliances take.

**Boundaries.** E is taken as its value E(b) at the boundary that the mesh of a part is graded to,
and an increment from there, in which nothing cancels. E(b) may differ from what p and q make it by
a *defect* at every boundary. At given boundaries the equations are linear in the defects, and these
are chosen to make the traction continuous. A boundary is where it should be when its defect is
zero. Without tangential compliance E(b) itself is zero.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from spectral_contact.fields.series import CENTRE, EDGE, LogSeries, PressureField, Radius
from spectral_contact.spectral.abel import moments_on
from spectral_contact.spectral.annulus import Annulus
from spectral_contact.spectral.blocks import Block, block, disk_shear, kept_disk_gram
from spectral_contact.spectral.blockwise import Blockwise
from spectral_contact.spectral.cache import kept
from spectral_contact.spectral.graded import GradedNodes, graded_nodes
from spectral_contact.spectral.jacobi import (
    gauss_rule,
    legendre_expansion_matrix,
    legendre_values,
)
from spectral_contact.spectral.moments import moments, outer_moments
from spectral_contact.spectral.panels import LogPanels, Resolution
from spectral_contact.spectral.parameters import Parameters
from spectral_contact.spectral.parts import Family, Parts
from spectral_contact.spectral.seen import Seen
from spectral_contact.spectral.transforms import series_of
from spectral_contact.threads import cached_property

Array = NDArray[np.float64]
Degrees = tuple[int, ...]

#: Degrees that ``p / s`` is given on a panel beyond those of p.
_EXTRA_DEGREES = 4
#: Degrees that the displacement in slip is given beyond those of the pressure: the far end of a
#: part is a singularity at a distance of ln 2 in ``x`` from the first panel.
_DISPLACEMENT_DEGREES = 8


class MeshPart(NamedTuple):
    """The central disk, or one half of a zone around it, with its mesh.

    Attributes
    ----------
    zone : int
        Number of the zone, from the centre outward.
    state : int
        0 for stick, +1 or -1 for slip with this sign of the traction.
    boundary : int
        Number of the boundary that the mesh is graded to; -1 for the edge of the contact.
    family, shear : Family
        The mesh with the functions of p, and with those of u. They differ in the endpoint weight.
    degrees : tuple of int
        Highest degree of an unknown on every panel.
    pressure_degrees, shear_degrees : tuple of int
        Highest degrees of the expansions of p and of u, whether they are known or not.
    """

    zone: int
    state: int
    boundary: int
    family: Family
    shear: Family
    degrees: Degrees
    pressure_degrees: Degrees
    shear_degrees: Degrees

    @property
    def sticks(self) -> bool:
        """Whether the zone sticks."""
        return self.state == 0


class UnknownField(NamedTuple):
    """An unknown field on a part.

    Attributes
    ----------
    part : int
        Number of the part.
    panels : LogPanels
    degrees : tuple of int
    functions : ndarray of int
        The functions of the panels that are in use.
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

    def coefficients(self, values: Array) -> Array:
        """Return the coefficients of all functions of the panels, from those in a vector."""
        whole = np.zeros((self.panels.size, *values.shape[1:]))
        whole[self.functions] = values[self.place]
        return whole


class PointwiseResidual(NamedTuple):
    """W and E at the nodes of every part; E of the parts up to the last one that sticks."""

    normal: list[Array]
    tangential: list[Array]


class BoundaryRows(NamedTuple):
    """``kappa R(b)`` and ``E(b)`` at every boundary, as rows that act on vectors."""

    drive: Array
    shortfall: Array


class ContactSystem:
    """The equations on zones with given boundaries.

    A *vector* holds `pressure_terms` coefficients of the pressure, then those of u on the parts
    that stick, outward. If the pressure is unknown the first are its coefficients on the parts; if
    it is known they are the factors of the known pressures: 1 for the pressure itself, and 0 or 1
    for its changes.

    Parameters
    ----------
    radii : tuple of Radius
        Boundaries between zones, outward.
    states : tuple of int
        0 for stick, +1 or -1 for slip with this sign of the traction; the first is 0.
    spaces : sequence of Resolution
        Meshes and degrees: of the central disk, then toward the inner and the outer end of every
        zone around it.
    parameters : Parameters
    pressures : sequence of PressureField
        The known pressure of unit load and its changes, whose load is zero, on the same panels. If
        there is none the pressure is unknown.
    truncated : bool
        Whether two changes of a known pressure, by two degrees less in its own space and by one,
        are to lose as many degrees on the parts of this mesh, too.

    Attributes
    ----------
    parts : list of MeshPart
    stick_parts : list of int
        Numbers of the parts that stick.
    fields : list of UnknownField
        What is unknown, in the order of a vector.
    pressure_terms, unknowns : int
        How many coefficients of a vector belong to the pressure, and how many there are in all.
    load_row : ndarray, shape (pressure_terms,)
        ``int p s ds``.
    """

    def __init__(
        self,
        radii: tuple[Radius, ...],
        states: tuple[int, ...],
        spaces: Sequence[Resolution],
        parameters: Parameters,
        pressures: Sequence[PressureField] = (),
        *,
        truncated: bool = False,
    ) -> None:
        self.radii = radii
        self.states = states
        self.parameters = parameters
        self.pressure_known = bool(pressures)
        self.parts = self._cut(spaces)
        self.stick_parts = [k for k, part in enumerate(self.parts) if part.sticks]
        # an equation is tested without weights if it has a compliance, or no boundary: then its
        # coupling is one of moments
        unweighted = [compliance > 0.0 or not radii for compliance in parameters[:2]]
        self._unweighted_normal = unweighted[0]
        self._unweighted_shear = unweighted[1] or self.pressure_known
        self._place_fields(pressures, truncated=truncated)
        self._place_nodes()
        self._assemble_operators()
        self._assemble_loads()

    def _cut(self, spaces: Sequence[Resolution]) -> list[MeshPart]:
        """Return the parts of the disk."""
        boundaries = len(self.radii)
        parts = []
        ends = Parts(self.radii, pointed=False).ends
        for k, (end, (panels, degrees)) in enumerate(zip(ends, spaces, strict=True)):
            zone = (k + 1) // 2
            state = self.states[zone]
            boundary = k // 2 if k < 2 * boundaries else -1
            power = panels.power
            if state == 0:
                # without compliance the traction is singular at an edge that sticks
                singular = self.parameters.beta == 0.0 and boundary < 0
                power = -0.5 if singular else 0.0
            # a tail of roots is that of a traction at the rim of a disk
            family = Family(*end, replace(panels, root_tail=False))
            shear = family
            if power != panels.power or panels.root_tail:
                shear = family._replace(panels=replace(panels, power=power))
            pressure_degrees = degrees
            if self.pressure_known:
                # it costs nothing to hold a known pressure in all functions of the panels
                pressure_degrees = (panels.degree,) * panels.panels
            shear_degrees = degrees if state == 0 else _quotient_degrees(pressure_degrees, panels)
            parts.append(
                MeshPart(
                    zone, state, boundary, family, shear, degrees, pressure_degrees, shear_degrees
                )
            )
        return parts

    # the two fields in a vector

    def _place_fields(self, pressures: Sequence[PressureField], *, truncated: bool) -> None:
        """Give the unknown fields their places, and expand the known ones."""
        self.fields: list[UnknownField] = []
        #: where the pressure of a part is in a vector, if it is unknown
        self._pressure_places: list[slice] = []
        #: coefficients of the known pressures on the parts, and of ``u = state f p/s`` in slip
        self._known_pressure: list[Array] = []
        self._known_slip: dict[int, Array] = {}
        #: maps from p to ``p/s`` on the parts that slip under an unknown pressure
        self._over_radius: dict[int, Blockwise] = {}
        place = 0
        if self.pressure_known:
            place = len(pressures)
            self._expand(pressures, truncated=truncated)
        else:
            for k, part in enumerate(self.parts):
                field = self._unknown(k, part.family.panels, place, is_shear=False)
                self.fields.append(field)
                self._pressure_places.append(field.place)
                place = field.place.stop
                if not part.sticks:
                    self._over_radius[k] = _over_radius(part.family, part.pressure_degrees)
        self.pressure_terms = place
        #: where u of a part that sticks is in a vector
        self.shear_places: dict[int, slice] = {}
        for k in self.stick_parts:
            field = self._unknown(k, self.parts[k].shear.panels, place, is_shear=True)
            self.fields.append(field)
            self.shear_places[k] = field.place
            place = field.place.stop
        self.unknowns = place

    def _unknown(self, k: int, panels: LogPanels, start: int, *, is_shear: bool) -> UnknownField:
        degrees = self.parts[k].degrees
        functions = panels.functions(degrees)
        place = slice(start, start + len(functions))
        return UnknownField(k, panels, degrees, functions, place, is_shear)

    def _expand(self, pressures: Sequence[PressureField], *, truncated: bool) -> None:
        """Expand known pressures on every part, and the traction that they bear in slip."""
        for k, part in enumerate(self.parts):
            panels = part.family.panels
            points = part.family.sampling()
            values = PressureField.several(pressures, points.y)
            if panels.power != 0.0:
                values = values / panels.distances**panels.power
            self._known_pressure.append(_expansion(part, values, truncated=truncated))
            if not part.sticks:
                slip = part.state * self.parameters.friction * values / np.sqrt(points.z)
                self._known_slip[k] = _expansion(part, slip, truncated=truncated)

    def _pressure_on(self, k: int, values: Array) -> Array:
        """Return the coefficients of p on a part, of vectors as columns."""
        if self.pressure_known:
            return np.asarray(self._known_pressure[k] @ values[: self.pressure_terms])
        return values[self._pressure_places[k]]

    def _shear_on(self, k: int, values: Array) -> Array:
        """Return the coefficients of u on a part, of vectors as columns."""
        part = self.parts[k]
        if part.sticks:
            return values[self.shear_places[k]]
        if self.pressure_known:
            return np.asarray(self._known_slip[k] @ values[: self.pressure_terms])
        friction = part.state * self.parameters.friction
        return friction * self._over_radius[k].of(values[self._pressure_places[k]])

    def _add_pressure(self, rows: Array, columns: Array, k: int) -> None:
        """Add to rows that act on vectors what acts on the coefficients of p on a part."""
        if self.pressure_known:
            rows[:, : self.pressure_terms] += columns @ self._known_pressure[k]
        else:
            rows[:, self._pressure_places[k]] += columns

    def _add_shear(self, rows: Array, columns: Array, k: int) -> None:
        """Add to rows that act on vectors what acts on the coefficients of u on a part."""
        part = self.parts[k]
        if part.sticks:
            rows[:, self.shear_places[k]] += columns
        elif self.pressure_known:
            rows[:, : self.pressure_terms] += columns @ self._known_slip[k]
        else:
            friction = part.state * self.parameters.friction
            rows[:, self._pressure_places[k]] += friction * self._over_radius[k].after(columns)

    def series(self, values: Array) -> tuple[list[LogSeries], dict[int, LogSeries]]:
        """Return p on all parts, and ``q/s`` on those that stick, of one vector."""
        pressures = []
        for k, part in enumerate(self.parts):
            panels = part.family.panels
            whole = np.zeros(panels.size)
            whole[panels.functions(part.pressure_degrees)] = self._pressure_on(k, values)
            pressures.append(series_of(panels, whole))
        shears = {
            field.part: series_of(field.panels, field.coefficients(values))
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
        """Whether the matrix is symmetric and positive definite: no unknown p is in slip."""
        return self.pressure_known or not self.radii

    @cached_property
    def top_degree_indices(self) -> tuple[NDArray[np.int_], NDArray[np.int_]]:
        """Places in a vector of the top two degrees of every panel, and of the top one."""
        top_two, top_one = (
            np.concatenate(
                [field.place.start + field.panels.top(field.degrees, n) for field in self.fields]
            )
            for n in (2, 1)
        )
        return top_two, top_one

    def _place_nodes(self) -> None:
        """Find the Galerkin nodes of the parts, and the weights with which E and W are tested.

        Where the pressure is known nothing is tested beyond the last part that sticks.
        """
        parts = self.parts
        if self.pressure_known:
            parts = parts[: self.stick_parts[-1] + 1]
        self.nodes: list[GradedNodes] = []
        #: ``t**2 - b**2`` and t at the nodes, and ``(t**2 - b**2) / (t + b)``
        self.offsets: list[Array] = []
        self._t: list[Array] = []
        self._from_boundary: list[Array] = []
        #: weights of ``t**2 dt / pi``, and those with which W and E are tested
        self.shear_weights: list[Array] = []
        self._normal_tests: list[Array] = []
        self._shear_tests: list[Array] = []
        for part in parts:
            family = part.family
            b = family.boundary
            nodes = graded_nodes(family.panels, part.degrees)
            offset = family.sign * family.reach * nodes.d
            if part.zone == 0:
                t = b.value * np.sqrt(nodes.rest)
            else:
                t = np.sqrt(b.square + offset)
            weights = nodes.weights * family.reach / (2.0 * np.pi) * t
            emphasis = self._emphasis(part, offset)
            self.nodes.append(nodes)
            self.offsets.append(offset)
            self._t.append(t)
            self._from_boundary.append(offset / (t + b.value))
            self.shear_weights.append(weights)
            self._normal_tests.append(
                weights / t**2 * (1.0 if self._unweighted_normal else emphasis)
            )
            self._shear_tests.append(weights * (1.0 if self._unweighted_shear else emphasis))

    def _emphasis(self, part: MeshPart, offset: Array) -> Array | float:
        """Return the weight that an equation of the first kind takes next to a boundary.

        Without it what the equation lacks far away would spoil what is next to the boundary.
        """
        if part.boundary < 0:
            return 1.0
        beside = [p.family.reach for p in self.parts if p.boundary == part.boundary]
        return np.maximum(min(beside) / np.abs(offset), 1.0)

    # operators between parts

    def _assemble_operators(self) -> None:
        """Find the integrals of the fields of every part at the nodes of every other."""
        nodes = self.nodes
        #: half-integrals of p and of u over what lies outside of the nodes
        self._outer_pressure = [Seen(one, {}) for one in nodes]
        self._outer_shear = [Seen(one, {}) for one in nodes]
        #: the same over what lies inside
        self._inner_pressure = [Seen(one, {}) for one in nodes]
        self._inner_shear = [Seen(one, {}) for one in nodes]
        for i in range(len(nodes)):
            for k in range(len(self.parts)):
                if k >= i:
                    self._add_operators(i, k, 1, self._outer_pressure[i], self._outer_shear[i])
                if k <= i:
                    self._add_operators(i, k, -1, self._inner_pressure[i], self._inner_shear[i])
        #: of the outer half-integrals of u those of the parts that stick, which E is tested with
        self._outer_stick = [
            Seen(one.nodes, {k: b for k, b in one.blocks.items() if self.parts[k].sticks})
            for one in self._outer_shear
        ]

    def _add_operators(self, i: int, k: int, side: int, pressure: Seen, shear: Seen) -> None:
        """Add the integrals of the fields of part k at the nodes of part i."""
        part, target = self.parts[k], self.parts[i]
        place = (target.family, target.degrees, side)
        wants_shear = side > 0 or not self.pressure_known
        wants_pressure = side < 0 or not self.pressure_known
        of_shear: Block | None = None
        if wants_shear:
            of_shear = block(part.shear, part.shear_degrees, *place)
            assert of_shear is not None
            shear.blocks[k] = of_shear
        if wants_pressure:
            pressure.blocks[k] = self._pressure_block(part, place, of_shear)

    def _pressure_block(
        self, part: MeshPart, place: tuple[Family, Degrees, int], of_shear: Block | None
    ) -> Block:
        """Return the integrals of p, which are those of u where the functions are the same."""
        if of_shear is not None and part.shear is part.family:
            if part.shear_degrees == part.pressure_degrees:
                return of_shear
            if of_shear.sampled:
                panels = part.family.panels
                columns = panels.functions(part.shear_degrees)
                functions = panels.functions(part.pressure_degrees)
                return of_shear.of(np.searchsorted(columns, functions))
        found = block(part.family, part.pressure_degrees, *place)
        assert found is not None
        return found

    def _assemble_loads(self) -> None:
        """Assemble ``int p s ds`` and ``int q ds`` of the parts, and the load of a vector."""
        #: of p and of u on every part
        self._loads: list[Array] = []
        self._pulls: list[Array] = []
        for part in self.parts:
            half = 0.5 * part.family.reach
            of_pressure = moments(part.family.panels)
            of_shear = moments(part.shear.panels)
            self._loads.append(
                half * of_pressure[part.family.panels.functions(part.pressure_degrees)]
            )
            self._pulls.append(half * of_shear[part.shear.panels.functions(part.shear_degrees)])
        self.load_row = np.zeros(self.pressure_terms)
        if self.pressure_known:
            self.load_row[0] = 1.0 / (2.0 * np.pi)
        else:
            self.load_row[:] = np.concatenate(self._loads)

    # rows that act on vectors

    @cached_property
    def shear_row(self) -> Array:
        """``2 pi int q s ds``."""
        row = np.zeros((1, self.unknowns))
        friction = self.parameters.friction
        for k, part in enumerate(self.parts):
            if not part.sticks:
                load = 2.0 * np.pi * friction * part.state * self._loads[k]
                self._add_pressure(row, load[None], k)
            elif part.zone == 0:
                unit = disk_shear(part.shear.panels, part.degrees)
                self._add_shear(row, part.family.boundary.value**3 * unit[None], k)
            else:
                on_panels = moments_on(part.shear.panels, part.degrees)
                s = np.sqrt(part.shear.points(on_panels.d).z)
                moment = 2.0 * np.pi * part.shear.reach * on_panels.with_densities(s[None])
                self._add_shear(row, moment, k)
        return np.asarray(row[0])

    def total_shear(self, values: Array) -> float:
        """Return ``2 pi int q s ds`` of a vector."""
        return float(self.shear_row @ values)

    @cached_property
    def jump_rows(self) -> Array:
        """The jump of ``q - f p`` from slip to stick at every boundary."""
        rows = np.zeros((len(self.radii), self.unknowns))
        for k in self.stick_parts:
            part = self.parts[k]
            j = part.boundary
            if j < 0:
                continue
            row = rows[j : j + 1]
            at_tail = _tail_at_boundary(part.shear.panels)
            row[:, self._tail_of(k)] = part.family.boundary.value * at_tail
            friction = (self.states[j] + self.states[j + 1]) * self.parameters.friction
            at_boundary = np.zeros((1, len(self._loads[k])))
            at_tail = _tail_at_boundary(part.family.panels)
            at_boundary[:, -len(at_tail) :] = -friction * at_tail
            self._add_pressure(row, at_boundary, k)
        return rows

    def _tail_of(self, k: int) -> slice:
        """Return where the tail of u on a part is in a vector."""
        stop = self.shear_places[k].stop
        return slice(stop - self.parts[k].shear.panels.tail_terms, stop)

    @cached_property
    def boundary_rows(self) -> BoundaryRows:
        """``kappa R(b)`` and ``E(b)`` at every boundary."""
        drive = np.zeros((len(self.radii), self.unknowns))
        shortfall = np.zeros_like(drive)
        for i, part in enumerate(self.parts[: len(self.nodes)]):
            if part.boundary < 0 or part.family.sign > 0:
                continue
            j = slice(part.boundary, part.boundary + 1)
            factor = 2.0 * self.parameters.kappa / part.family.boundary.value
            for k, inner in self._inner_pressure[i].blocks.items():
                self._add_pressure(drive[j], factor * inner.scale * inner.at[None], k)
            shortfall[j] = drive[j]
            for k, outer in self._outer_shear[i].blocks.items():
                self._add_shear(shortfall[j], -outer.scale * outer.at[None], k)
        return BoundaryRows(drive, shortfall)

    # residuals

    def pointwise_residual(
        self, values: Array, approach: Array, defects: Array
    ) -> PointwiseResidual:
        """Return W and E at the nodes.

        Parameters
        ----------
        values : ndarray, shape (unknowns, k)
            Vectors as columns.
        approach : ndarray, shape (k,)
            ``delta``.
        defects : ndarray, shape (boundaries, k)
            By how much E(b) differs from what p and q make it.
        """
        normal: list[Array] = []
        if not self.pressure_known:
            normal = self._normal_residual(values, approach)
        return PointwiseResidual(normal, self._shear_residual(values, defects))

    def _normal_residual(self, values: Array, approach: Array) -> list[Array]:
        """Return W at the nodes of every part."""
        kappa = self.parameters.kappa
        parts = range(len(self.parts))
        p = [self._pressure_on(k, values) for k in parts]
        u = [self._shear_on(k, values) for k in parts]
        pull = sum(self._pulls[k] @ u[k] for k in parts)
        residual: list[Array] = []
        at_boundaries: dict[int, Array] = {}
        for i, part in enumerate(self.parts):
            t = self._t[i][:, None]
            from_boundary = self._from_boundary[i][:, None]
            outer, inner = self._outer_pressure[i], self._inner_shear[i]
            swept = inner.at(u)
            at_boundary = 2.0 * approach - outer.at(p)
            at_boundary += 2.0 * kappa * (pull - part.family.boundary.value * swept)
            # both sides take the same value to the last digit: a step there would act on the fields
            # like 1/sqrt(d)
            at_boundary = at_boundaries.setdefault(part.boundary, at_boundary)
            swept_more = t * inner.more(u) + from_boundary * swept
            residual.append(at_boundary - 2.0 * kappa * swept_more - outer.more(p))
        return residual

    def _shear_residual(self, values: Array, defects: Array) -> list[Array]:
        """Return E at the nodes of the parts up to the last one that sticks."""
        at_boundaries = np.zeros_like(defects)
        if self.parameters.beta > 0.0:
            at_boundaries = self.boundary_rows.shortfall @ values + defects
        residual = []
        for i, part in enumerate(self.parts[: self.stick_parts[-1] + 1]):
            increment = self._shear_increment(i, values)
            if part.boundary >= 0:
                increment = increment + at_boundaries[part.boundary]
            residual.append(increment)
        return residual

    def _shear_increment(self, i: int, values: Array) -> Array:
        """Return ``E(t) - E(b)`` at the nodes of a part."""
        if not self.pressure_known:
            traction = {k: self._shear_on(k, values) for k in self._outer_shear[i].blocks}
            pressure = {k: self._pressure_on(k, values) for k in self._inner_pressure[i].blocks}
            drive = self._drive_increment(i, pressure)
            return np.asarray(drive - self._outer_shear[i].more(traction))
        known = self._known_increments[i] @ values[: self.pressure_terms]
        if not values[self.pressure_terms :].any():
            return np.asarray(known)
        traction = {k: self._shear_on(k, values) for k in self._outer_stick[i].blocks}
        return np.asarray(known - self._outer_stick[i].more(traction))

    @cached_property
    def _known_increments(self) -> list[Array]:
        """``E(t) - E(b)`` at the nodes of the parts by the known pressures, without stick."""
        found = []
        for i, outer in enumerate(self._outer_shear):
            increment = self._drive_increment(i, self._known_pressure)
            slips = {k: one for k, one in outer.blocks.items() if not self.parts[k].sticks}
            if slips:
                increment = increment - Seen(outer.nodes, slips).more(self._known_slip)
            found.append(increment)
        return found

    def _drive_increment(self, i: int, pressure: list[Array] | dict[int, Array]) -> Array:
        """Return ``kappa (R(t) - R(b))`` at the nodes of a part."""
        inner = self._inner_pressure[i]
        boundary = self.parts[i].family.boundary.value
        falls = self._from_boundary[i][:, None] / boundary * inner.at(pressure)
        factor = 2.0 * self.parameters.kappa / self._t[i][:, None]
        return np.asarray(factor * (inner.more(pressure) - falls))

    def residual(self, values: Array, approach: Array, defects: Array) -> Array:
        """Return the residual of the equations; parameters are those of `pointwise_residual`."""
        projected = self.project(self.pointwise_residual(values, approach, defects))
        for place, product in self._masses(values):
            projected[place] -= product
        return projected

    def project(self, residual: PointwiseResidual) -> Array:
        """Return the sums over the nodes of W and E times the half-integrals of all functions."""
        projected = np.zeros((self.unknowns, residual.tangential[0].shape[1]))
        for i, values in enumerate(residual.tangential):
            weighted = self._shear_tests[i][:, None] * values
            for k, sums in self._outer_stick[i].tested(weighted):
                projected[self.shear_places[k]] += sums
        for i, values in enumerate(residual.normal):
            weighted = self._normal_tests[i][:, None] * values
            for k, sums in self._outer_pressure[i].tested(weighted):
                projected[self._pressure_places[k]] += sums
        return projected

    def _masses(self, values: Array | None = None) -> Iterator[tuple[slice, Array]]:
        """Yield masses of the unknown fields times their compliances, or the products with values.

        With each comes its place in a vector.
        """
        for field in self.fields:
            part = self.parts[field.part]
            family = part.shear if field.is_shear else part.family
            compliance = self.parameters.beta if field.is_shear else self.parameters.alpha
            if compliance > 0.0:
                coefficients = None if values is None else values[field.place]
                mass = family.mass(field.degrees, coefficients, shear=field.is_shear)
                yield field.place, compliance * mass

    # displacement in slip

    def slip_annulus(self, zone: int) -> Annulus:
        """Return the meshes of the displacement in a slip zone: those of p, with more degrees."""
        toward_inner, toward_outer = (
            replace(
                part.family.panels,
                power=0.0,
                degree=part.family.panels.degree + _DISPLACEMENT_DEGREES,
            )
            for part in self.parts[2 * zone - 1 : 2 * zone + 1]
        )
        inner, outer = self.bounds[zone : zone + 2]
        return Annulus(inner, outer, toward_inner, toward_outer)

    def residual_in_slip(self, values: Array, annulus: Annulus) -> list[Array]:
        """Return E at the sampling points of both halves of an annulus, of vectors as columns."""
        return [self._residual_at_samples(values, half) for half in annulus.families]

    def _residual_at_samples(self, values: Array, target: Family) -> Array:
        """Return E at the sampling points of a mesh."""
        inner = np.zeros((len(target.panels.distances), values.shape[1]))
        outer = np.zeros_like(inner)
        for k, part in enumerate(self.parts):
            place = (target, target.panels)
            inside = block(part.family, part.pressure_degrees, *place, -1, differences=False)
            if inside is not None:
                inner += inside.sums(self._pressure_on(k, values))
            outside = block(part.shear, part.shear_degrees, *place, 1, differences=False)
            if outside is not None:
                outer += outside.sums(self._shear_on(k, values))
        t = np.sqrt(target.sampling().z)[:, None]
        return np.asarray(2.0 * self.parameters.kappa / t * inner - outer)

    # the matrix

    def matrix(self) -> Array:
        """Return the matrix of the equations, whose rows are those of `residual`."""
        matrix = self._without_masses()
        for place, mass in self._masses():
            matrix[place, place] += mass
        return matrix

    def _without_masses(self) -> Array:
        """Return the matrix without masses; that of coupled full stick is kept for kappa = 1."""
        if self.radii or self.pressure_known:
            return self.assembled()
        [part] = self.parts
        space = Resolution(part.family.panels, part.degrees)
        matrix = _full_stick_matrix(space, self.parameters.beta == 0.0).copy()
        matrix[: self.pressure_terms, self.pressure_terms :] *= self.parameters.kappa
        matrix[self.pressure_terms :, : self.pressure_terms] *= self.parameters.kappa
        return matrix

    def assembled(self) -> Array:
        """Return the matrix without masses, assembled part by part."""
        matrix = np.zeros((self.unknowns, self.unknowns))
        for i in range(self.stick_parts[-1] + 1):
            self._add_shear_equation(matrix, i)
        if self.pressure_known:
            return matrix
        for i in range(len(self.parts)):
            self._add_normal_equation(matrix, i)
            if not self._unweighted_normal:
                self._add_traction_to_normal(matrix, i)
            if not self._unweighted_shear and i <= self.stick_parts[-1]:
                self._add_pressure_to_shear(matrix, i)
        self._add_moments(matrix)
        return matrix

    def _add_shear_equation(self, matrix: Array, i: int) -> None:
        """Add ``T q``, tested at the nodes of a part."""
        part, rows = self.parts[i], self._outer_stick[i]
        columns = rows if self.pressure_known else self._outer_shear[i]
        gram = None
        if part.zone == 0 and self._unweighted_shear:
            gram = kept_disk_gram(part.shear.panels, part.degrees, shear=True)
            gram = part.family.boundary.value**3 * gram
        products = rows.products(
            columns, self._shear_tests[i], whole=self._unweighted_shear, own=gram
        )
        for k, j, product in products:
            self._add_shear(matrix[self.shear_places[k]], product, j)

    def _add_normal_equation(self, matrix: Array, i: int) -> None:
        """Add ``N p``, tested at the nodes of a part."""
        part, outer = self.parts[i], self._outer_pressure[i]
        gram = None
        if part.zone == 0 and self._unweighted_normal:
            gram = kept_disk_gram(part.family.panels, part.degrees, shear=False)
            gram = part.family.boundary.value * gram
        for k, j, product in outer.products(outer, self._normal_tests[i], whole=True, own=gram):
            matrix[self._pressure_places[k], self._pressure_places[j]] += product

    def _add_traction_to_normal(self, matrix: Array, i: int) -> None:
        """Add what the traction does to a weighted normal equation at the nodes of a part."""
        outer, inner = self._outer_pressure[i], self._inner_shear[i]
        t, weights = self._t[i], self._normal_tests[i]
        coupling = 2.0 * self.parameters.kappa
        for k, j, product in outer.products(inner, weights * t):
            self._add_shear(matrix[self._pressure_places[k]], coupling * product, j)
        # t I(t) is t/b times its value at the boundary, and an increment
        both = coupling * np.column_stack([weights * t, weights])
        for k, sums in outer.tested(both):
            rows = matrix[self._pressure_places[k]]
            for j, one in inner.blocks.items():
                self._add_shear(rows, one.scale * sums[:, :1] * one.at, j)
            for j, pull in enumerate(self._pulls):
                self._add_shear(rows, -sums[:, 1:] * pull, j)

    def _add_pressure_to_shear(self, matrix: Array, i: int) -> None:
        """Add what the pressure does to a weighted tangential equation at the nodes of a part."""
        outer, inner = self._outer_stick[i], self._inner_pressure[i]
        factor = self._shear_tests[i] * 2.0 * self.parameters.kappa / self._t[i]
        for k, j, product in outer.products(inner, factor):
            matrix[self.shear_places[k], self._pressure_places[j]] -= product
        falls = factor * self._from_boundary[i] / self.parts[i].family.boundary.value
        for k, sums in outer.tested(falls[:, None]):
            for j, one in inner.blocks.items():
                rows = matrix[self.shear_places[k], self._pressure_places[j]]
                rows += one.scale * sums * one.at

    def _add_moments(self, matrix: Array) -> None:
        """Add the coupling of equations without weights, in which no kernel is left.

        ``<phi, int_s^1 q> = int phi s ds int q ds`` where q lies outside of phi, and
        ``<s psi, g[p]> = int psi s ds int p s ds`` where p lies inside of psi.
        """
        kappa = self.parameters.kappa
        for k, (part, place) in enumerate(zip(self.parts, self._pressure_places, strict=True)):
            within = self._moments_within(k)
            if self._unweighted_normal:
                rows = matrix[place]
                self._add_shear(rows, -kappa * within, k)
                for j in range(k + 1, len(self.parts)):
                    self._add_shear(rows, -kappa * self._loads[k][:, None] * self._pulls[j], j)
            if self._unweighted_shear and part.sticks:
                rows = matrix[self.shear_places[k]]
                rows[:, place] -= kappa * within.T
                inside = self.load_row[: place.start]
                rows[:, : place.start] -= kappa * self._pulls[k][:, None] * inside

    def _moments_within(self, k: int) -> Array:
        """Return ``int phi s ds int psi s ds`` over what of psi lies outside of phi, on a part."""
        part = self.parts[k]
        pressure, shear = part.family.panels, part.shear.panels
        whole = outer_moments(pressure, shear, part.family.sign)
        rows = pressure.functions(part.pressure_degrees)
        columns = shear.functions(part.shear_degrees)
        return np.asarray((0.5 * part.family.reach) ** 2 * whole[np.ix_(rows, columns)])


def _expansion(part: MeshPart, values: Array, *, truncated: bool) -> Array:
    """Return coefficients on a part, as columns, through values at its sampling points, as rows.

    If it is truncated, the second and third column lose the top two degrees and the top one of
    every panel of the first.
    """
    panels, degrees = part.family.panels, part.pressure_degrees
    coefficients = part.family.expand(values)[:, panels.functions(degrees)].T
    if truncated:
        for column, count in ((1, 2), (2, 1)):
            top = panels.top(degrees, count)[:-1]  # without the tail's
            coefficients[top, column] -= coefficients[top, 0]
    return coefficients


def _tail_at_boundary(panels: LogPanels) -> Array:
    """Return the values of the functions of the tail at the boundary: Legendre's at -1."""
    return np.asarray(1.0 - 2.0 * (np.arange(panels.tail_terms) % 2))


def _quotient_degrees(degrees: Degrees, panels: LogPanels) -> Degrees:
    """Return the degrees of ``p/s``, for those of p."""
    return tuple(min(n + _EXTRA_DEGREES, panels.degree) for n in degrees)


def _over_radius(family: Family, degrees: Degrees) -> Blockwise:
    """Return the map from the coefficients of p on a part to those of ``p/s``, panel by panel."""
    panels = family.panels
    points = panels.degree + 11
    expand = legendre_expansion_matrix(points, panels.degree)
    values = legendre_values(gauss_rule(points)[0], panels.degree)
    radii = np.sqrt(family.points(np.exp(-panels.sampling(points))).z)
    blocks = [
        expand[: more + 1] @ (values[:, : n + 1] / s[:, None])
        for s, n, more in zip(radii, degrees, _quotient_degrees(degrees, panels), strict=True)
    ]
    # on the tail s is constant to rounding
    at_tail = float(np.sqrt(family.points(np.array([panels.end / 2.0])).z[0]))
    return Blockwise([*blocks, np.eye(panels.tail_terms) / at_tail])


@kept("full-stick matrices", 8)
def _full_stick_matrix(space: Resolution, rigid: bool) -> Array:
    """Return the matrix of coupled full stick without masses, for kappa = 1."""
    parameters = Parameters(0.0, 0.0 if rigid else 1.0, 1.0, 0.0)
    return ContactSystem((), (0,), [space], parameters).assembled()
