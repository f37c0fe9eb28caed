r"""The tangential equation on any zones of stick and slip, whatever pressure drives it.

    beta q + T q - kappa g = 0 in stick,

the unknown is ``u = q/s`` there, and in slip q is ``f p`` with the sign of the zone. With

    E(t) = kappa R(t) - G(t),    R(t) = (2/t) int_0^t s p ds / sqrt(t^2 - s^2)

and G the half-integral of q, the equation asks ``E``, tested with the half-integrals of all
functions, for what the compliance takes. It is taken as its value at the nearest boundary and a
difference to it, in which nothing cancels. ``E(b)`` may be off what p and q make it, by an
`imbalance` at every boundary between zones: together these make the traction continuous. That
there is none is the condition of each boundary. Without tangential compliance ``E(b)`` is zero.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from spectral_contact.fields.series import CENTRE, EDGE, LogSeries, Radius
from spectral_contact.spectral.abel import moments_on
from spectral_contact.spectral.blocks import disk_shear, kept_disk_gram
from spectral_contact.spectral.graded import GradedNodes, graded_nodes
from spectral_contact.spectral.jacobi import TAIL_TERMS
from spectral_contact.spectral.panels import LogPanels, Resolution
from spectral_contact.spectral.parameters import Parameters
from spectral_contact.spectral.parts import Family, Parts
from spectral_contact.spectral.seen import Fields, Seen
from spectral_contact.spectral.transforms import series_of
from spectral_contact.threads import cached_property

if TYPE_CHECKING:
    from spectral_contact.spectral.annulus import Annulus

Array = NDArray[np.float64]
Degrees = tuple[int, ...]


class Part(NamedTuple):
    """Half a zone, or the central disk: a family of panels, and how the surface moves on it.

    Attributes
    ----------
    zone : int
        From the centre outward.
    state : int
        0 for stick, +1 or -1 for slip with this sign of the traction.
    boundary : int
        Number of the boundary that the panels are graded to; -1 for the edge.
    family, shear : Family
        With the panels of the pressure, and with those of q/s: the same but for the power.
    degrees : tuple of int
        Highest degree on every panel.
    """

    zone: int
    state: int
    boundary: int
    family: Family
    shear: Family
    degrees: Degrees


#: Values of the functions of a tail at its end.
AT_END = 1.0 - 2.0 * (np.arange(TAIL_TERMS) % 2)


class Field(NamedTuple):
    """An unknown field on a part: panels, degrees, functions in use and its place in a vector."""

    part: int
    panels: LogPanels
    degrees: Degrees
    used: NDArray[np.int_]
    own: slice

    def of(self, values: Array) -> Array:
        """Return the coefficients in the whole basis."""
        whole = np.zeros((self.panels.size, *values.shape[1:]))
        whole[self.used] = values[self.own]
        return whole


class Misfit(NamedTuple):
    """W and E at the nodes of the parts; E is not felt farther out than the last that sticks."""

    normal: list[Array]
    tangential: list[Array]


class Tangential(ABC):
    """The tangential equation on zones that stick or slip.

    Vectors hold `count` coefficients of the pressure, then those of ``u = q/s`` on the parts that
    stick, outward.

    Parameters
    ----------
    radii : tuple of Radius
        Boundaries between zones, outward.
    states : tuple of int
        0 for stick, +1 or -1 for slip with this sign; the first is 0.
    spaces : sequence of Resolution
        On the disk, then toward the inner and the outer end of every zone.
    parameters : Parameters

    Attributes
    ----------
    fields : list of Field
        What is unknown, as vectors hold it.
    load : ndarray, shape (count,)
        ``int p s ds``.
    given : bool
        Whether the pressure is: a vector has the coefficient 1 of it, and 0 of its changes.
    """

    count: int
    fields: list[Field]
    load: Array
    #: half-integrals of q/s at the nodes of every part, and the weights with which E is tested
    _g: list[Seen]
    _shear_tests: list[Array]

    def __init__(
        self,
        radii: tuple[Radius, ...],
        states: tuple[int, ...],
        spaces: Sequence[Resolution],
        parameters: Parameters,
    ) -> None:
        self.radii, self.states, self.parameters = radii, states, parameters
        self.parts: list[Part] = []
        each = zip(Parts(radii, pointed=False).ends, spaces, strict=True)
        for k, (end, (own, used)) in enumerate(each):
            zone, boundary = (k + 1) // 2, k // 2 if k < 2 * len(radii) else -1
            state, family, power = states[zone], Family(*end, own), own.power
            if not state:  # without compliance the traction is singular at an edge that sticks
                power = -0.5 if parameters.beta == 0.0 and boundary < 0 else 0.0
            alike = power == own.power
            shear = family if alike else family._replace(panels=replace(own, power=power))
            self.parts.append(Part(zone, state, boundary, family, shear, used))
        self.stick = [k for k, part in enumerate(self.parts) if part.state == 0]
        #: whether the equations are tested without weights, so that their coupling is of moments
        self._plain = tuple(c > 0.0 or not radii for c in parameters[:2])

    @property
    def bounds(self) -> tuple[Radius, ...]:
        """Ends of the zones, from the centre to the edge."""
        return CENTRE, *self.radii, EDGE

    @property
    def symmetric(self) -> bool:
        """Whether the matrix is, and positive definite: nothing slips that is unknown."""
        return self.given or not self.radii

    def _place_shear(self) -> None:
        """Give u its places on the parts that stick."""
        self.given = not self.fields
        panels = {k: self.parts[k].shear.panels for k in self.stick}
        own, self.unknowns = self._placed(panels, self.count)
        #: places of u
        self.shear = {one.part: one.own for one in own}
        self.fields = [*self.fields, *own]

    def _placed(self, panels: dict[int, LogPanels], start: int) -> tuple[list[Field], int]:
        """Return fields on panels of parts, which follow each other, and where they end."""
        fields = []
        for k, own in panels.items():
            degrees = self.parts[k].degrees
            used = own.functions(degrees)
            fields.append(Field(k, own, degrees, used, slice(start, start + len(used))))
            start += len(used)
        return fields, start

    def _place_nodes(self, each: Sequence[Degrees]) -> None:
        """Find Galerkin nodes for functions of these degrees on the first parts."""
        self.nodes: list[GradedNodes] = []
        self.offsets, self._t = list[Array](), list[Array]()
        #: weights of ``t**2 dt / pi``
        self.shear_weights: list[Array] = []
        for part, degrees in zip(self.parts, each, strict=False):
            family, b = part.family, part.family.boundary
            nodes = graded_nodes(family.panels, degrees)
            offset = family.sign * family.reach * nodes.d
            t = b.value * np.sqrt(nodes.rest) if part.zone == 0 else np.sqrt(b.square + offset)
            self.nodes.append(nodes)
            self.offsets.append(offset)
            self._t.append(t)
            self.shear_weights.append(nodes.weights * family.reach / (2.0 * np.pi) * t)

    @cached_property
    def shed(self) -> tuple[NDArray[np.int_], NDArray[np.int_]]:
        """Places in a vector of the top two degrees of every panel, and of the top one."""
        first, last = (
            np.concatenate([one.own.start + one.panels.top(one.degrees, n) for one in self.fields])
            for n in (2, 1)
        )
        return first, last

    def series(self, values: Array) -> tuple[list[LogSeries], dict[int, LogSeries]]:
        """Return the functions that are unknown: p on all parts, q/s on those in stick."""
        each = [series_of(one.panels, one.of(values)) for one in self.fields]
        first = len(each) - len(self.stick)
        return each[:first], dict(zip(self.stick, each[first:], strict=True))

    # functionals

    @cached_property
    def shear_functional(self) -> Array:
        """``2 pi int q s ds`` as a functional of vectors."""
        row = np.zeros(self.unknowns)
        if self.radii:
            row[: self.count] = 2.0 * np.pi * self.parameters.friction * self._slipping_load()
        for k, own in self.shear.items():
            part = self.parts[k]
            if part.zone == 0:
                unit = disk_shear(part.shear.panels, part.degrees)
                row[own] = part.family.boundary.value**3 * unit
            else:
                moments = moments_on(part.shear.panels, part.degrees)
                roots = np.sqrt(part.shear.points(moments.d).z)
                row[own] = 2.0 * np.pi * part.shear.reach * moments.with_densities(roots[None])[0]
        return row

    @abstractmethod
    def _slipping_load(self) -> Array:
        """Return ``int p s ds`` over the slip zones, with their signs, as a functional."""

    def total_shear(self, values: Array) -> float:
        """Return ``2 pi int q s ds`` of a vector."""
        return float(self.shear_functional @ values)

    def _masses(self, values: Array | None = None) -> Iterator[tuple[slice, Array]]:
        """Yield masses of what is unknown times compliances, or these times values, by place."""
        for one in self.fields:
            part, shear = self.parts[one.part], one.own.start >= self.count
            compliance = self.parameters.beta if shear else self.parameters.alpha
            if compliance > 0.0:
                family, own = part.shear if shear else part.family, one.own
                of = None if values is None else values[own]
                yield own, compliance * family.mass(one.degrees, of, shear=shear)

    @cached_property
    def jumps(self) -> Array:
        """What q exceeds friction by in stick, at every boundary, as functionals of vectors."""
        rows = np.zeros((len(self.radii), self.unknowns))
        for k, own in self.shear.items():
            part, j = self.parts[k], self.parts[k].boundary
            if j >= 0:
                rows[j, own.stop - TAIL_TERMS : own.stop] = part.family.boundary.value * AT_END
                friction = float(self.states[j] + self.states[j + 1]) * self.parameters.friction
                rows[j, : self.count] -= friction * self._pressure_at(k)
        return rows

    @abstractmethod
    def _pressure_at(self, k: int) -> Array:
        """Return the pressure at the boundary of a part that sticks, as a functional."""

    @cached_property
    def balances(self) -> tuple[Array, Array]:
        """``kappa R(b)`` and ``E(b)`` at every boundary, as functionals of vectors."""
        drive, balance = np.zeros((2, len(self.radii), self.unknowns))
        for i, part in enumerate(self.parts[: len(self.nodes)]):
            if part.boundary >= 0 and part.family.sign < 0:
                j = slice(part.boundary, part.boundary + 1)
                drive[j, : self.count], balance[j, : self.count] = self._driven_at(i)
                for k, one in self._g[i].blocks.items():
                    self._add(balance[j], -one.scale * one.at[None], k)
        return drive, balance

    @abstractmethod
    def _driven_at(self, i: int) -> tuple[Array, Array]:
        """Return ``kappa R`` at the boundary of a part, and with it what is known of G there."""

    # equations

    @abstractmethod
    def _driven(self, i: int, values: Array) -> Array:
        """Return by how much more `_driven_at` is at the nodes of a part."""

    def matrix(self) -> Array:
        """Return the matrix of the equations; it is that of `residual` but for roundings."""
        matrix = self._assembled()
        for own, mass in self._masses():
            matrix[own, own] += mass
        return matrix

    @abstractmethod
    def misfit(self, values: Array, approach: Array, imbalance: Array) -> Misfit:
        """Return W and E of k vectors as columns, with k deltas and (boundaries, k) imbalances."""

    def _tangential(self, values: Array, traction: Fields, imbalance: Array) -> list[Array]:
        """Return E as `misfit` does."""
        missed = []
        rigid = self.parameters.beta == 0.0
        lifts = np.zeros_like(imbalance) if rigid else self.balances[1] @ values + imbalance
        for i, part in enumerate(self.parts[: self.stick[-1] + 1]):
            own = self._driven(i, values)
            if len(traction):
                own = own - self._g[i].more(traction)
            missed.append(own + lifts[part.boundary] if part.boundary >= 0 else own)
        return missed

    def residual(self, values: Array, approach: Array, imbalance: Array) -> Array:
        """Return what the equations miss, tested with all functions; see `misfit`."""
        missed = self.tested(self.misfit(values, approach, imbalance))
        for own, massed in self._masses(values):
            missed[own] -= massed
        return missed

    @abstractmethod
    def slip_zone(self, zone: int) -> Annulus:
        """Return the panels of the displacement in a slip zone."""

    @abstractmethod
    def slip_misfit(self, values: Array, zone: int, annulus: Annulus) -> list[Array]:
        """Return E at the sampling points of a slip zone, of vectors as columns."""

    def tested(self, misfit: Misfit) -> Array:
        """Return the sums over the nodes of a misfit times the half-integrals of functions."""
        tested = np.zeros((self.unknowns, misfit.tangential[0].shape[1]))
        for i, missed in enumerate(misfit.tangential):
            for k, sums in self._stuck(i).tested(self._shear_tests[i][:, None] * missed):
                tested[self.shear[k]] += sums
        return tested

    def _stuck(self, i: int) -> Seen:
        """Return half-integrals of the functions in stick at the nodes of a part."""
        own = self._g[i]
        return Seen(own.nodes, {k: one for k, one in own.blocks.items() if k in self.shear})

    def _add(self, rows: Array, columns: Array, k: int) -> None:
        """Add to rows of a matrix what q/s of a part contributes."""
        rows[:, self.shear[k]] += columns

    def _assembled(self) -> Array:
        """Return the matrix without masses: here what the traction does to its own equation."""
        matrix = np.zeros((self.unknowns, self.unknowns))
        for i, part in enumerate(self.parts[: self.stick[-1] + 1]):
            stuck, weights = self._stuck(i), self._shear_tests[i]
            kept = None
            if part.zone == 0 and self._plain[1]:
                gram = kept_disk_gram(part.shear.panels, part.degrees, shear=True)
                kept = part.family.boundary.value**3 * gram
            pairs = stuck.products(self._g[i], weights, whole=self._plain[1], own=kept)
            for k, j, product in pairs:
                self._add(matrix[self.shear[k]], product, j)
        return matrix
