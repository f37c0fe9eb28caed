r"""Normal and tangential contact on any zones of stick and slip: one system for p and q.

    alpha p + N p - kappa int_s^1 q deta = delta,    beta q + T q - kappa g = 0 in stick,

the pressure is unknown everywhere, ``u = q/s`` in stick, and in slip q is ``f p`` with the sign of
the zone. Every zone has panels to its ends, the central disk to its rim alone. With ``F``, ``G``
the half-integrals of p and q and

    W(t) = 2 delta + 2 kappa (int_0^1 q ds - t I(t)) - F(t),    E(t) = kappa R(t) - G(t),
    I(t) = int_0^t q ds / sqrt(t^2 - s^2),    R(t) = (2/t) int_0^t s p ds / sqrt(t^2 - s^2),

the equations ask ``W`` and ``E``, tested with the half-integrals of all functions, for what the
compliances take. Both are taken as their value at the nearest boundary and a difference to it, in
which nothing cancels. An error of ``W(b)`` is like one of delta. ``E(b)``, which is small or zero,
is an unknown of its own at every boundary between zones, a `lift`: together they make the traction
continuous. That each is what p and q make it is the condition of its boundary.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from spectral_contact.fields.series import Radius
from spectral_contact.spectral.abel import TAIL_TERMS
from spectral_contact.spectral.annulus import Family
from spectral_contact.spectral.blocks import Block, Seen, block, disk_gram
from spectral_contact.spectral.graded import GradedNodes, graded_nodes
from spectral_contact.spectral.moments import moments, outer_moments, unit_masses
from spectral_contact.spectral.over_radius import OverRadius, finer
from spectral_contact.spectral.panels import LogPanels, top_functions
from spectral_contact.spectral.parameters import Parameters
from spectral_contact.spectral.zone_parts import zone_parts
from spectral_contact.threads import cached_property

__all__ = ["Misfit", "System"]

Array = NDArray[np.float64]
Degrees = tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Misfit:
    """W and E at the nodes of every part; E is None where no test function is felt."""

    normal: list[Array]
    tangential: list[Array | None]


class System:
    """The equations on zones that stick or slip.

    Vectors hold the coefficients of the pressure, part by part outward, then those of ``u = q/s``
    on the parts that stick.

    Parameters
    ----------
    radii : tuple of Radius
        Boundaries between zones, outward.
    states : tuple of int
        0 for stick, +1 or -1 for slip with this sign; the first is 0.
    panels : sequence of LogPanels
        Of the disk, then toward the inner and the outer end of every zone.
    degrees : sequence of tuple of int
        Highest degrees on them.
    parameters : Parameters
    """

    def __init__(
        self,
        radii: tuple[Radius, ...],
        states: tuple[int, ...],
        panels: Sequence[LogPanels],
        degrees: Sequence[Degrees],
        parameters: Parameters,
    ) -> None:
        self.radii, self.states, self.parameters = radii, states, parameters
        #: whether the coupling is that of moments, in either equation: where none is weighted
        self._plain = tuple(c > 0.0 or not radii for c in parameters[:2])
        self.parts = zone_parts(radii, states, list(panels), list(degrees), parameters.beta)
        self._index = [p.family.panels.functions(p.degrees) for p in self.parts]
        self._over = [
            OverRadius((p.family,), (p.degrees,)) if p.state else None for p in self.parts
        ]
        #: degrees and functions of q/s: in slip those of p/s
        self._finer = [
            finer(p.degrees, p.family.panels) if p.state else p.degrees for p in self.parts
        ]
        self._columns = [
            p.shear.panels.functions(n) for p, n in zip(self.parts, self._finer, strict=True)
        ]
        sizes = [len(index) for index in self._index]
        starts = np.concatenate([[0], np.cumsum(sizes)]).tolist()
        #: places of the pressure's parts, and of those of u
        self.pressure = [slice(a, b) for a, b in pairwise(starts)]
        #: number of unknowns of the pressure
        self.count: int = starts[-1]
        self.stick = [k for k, p in enumerate(self.parts) if p.state == 0]
        ends = np.cumsum([self.count, *(sizes[k] for k in self.stick)]).tolist()
        self.shear = dict(zip(self.stick, map(slice, ends[:-1], ends[1:]), strict=True))
        self.unknowns: int = ends[-1]
        self._assemble_nodes()
        self._assemble_blocks()
        self._assemble_functionals()

    # vectors

    def split(self, values: Array) -> tuple[list[Array], dict[int, Array]]:
        """Return the coefficients in the whole bases: of p on all parts, of u on those in stick."""

        def full(k: int, part: Array, size: int) -> Array:
            whole = np.zeros((size, *values.shape[1:]))
            whole[self._index[k]] = part
            return whole

        pressure = [
            full(k, values[s], self.parts[k].family.panels.size)
            for k, s in enumerate(self.pressure)
        ]
        shear = {
            k: full(k, values[s], self.parts[k].shear.panels.size) for k, s in self.shear.items()
        }
        return pressure, shear

    def traction(self, values: Array) -> list[Array]:
        """Return the coefficients of q/s of vectors on every part, of the functions in use."""
        return [
            values[self.shear[k]]
            if over is None
            else part.state * self.parameters.friction * over.of(values[self.pressure[k]])
            for k, (part, over) in enumerate(zip(self.parts, self._over, strict=True))
        ]

    @property
    def symmetric(self) -> bool:
        """Whether the matrix is, and positive definite: everything sticks."""
        return not self.radii

    @cached_property
    def shed(self) -> tuple[NDArray[np.int_], NDArray[np.int_]]:
        """Places in a vector of the top two degrees of every panel, and of the top one."""
        each = [*self.parts, *(self.parts[k] for k in self.stick)]
        parts = [(part.family.panels, part.degrees) for part in each]
        return top_functions(parts, 2), top_functions(parts, 1)

    # assembly

    def _assemble_nodes(self) -> None:
        alpha, beta, _, _ = self.parameters
        self.nodes, self.offsets = list[GradedNodes](), list[Array]()
        self._t, self._beyond = list[Array](), list[Array]()
        self._weights, self._shear_tests = list[Array](), list[Array]()
        #: weights of ``t**2 dt / pi``
        self.shear_weights: list[Array] = []
        for part in self.parts:
            family, b = part.family, part.family.boundary
            nodes = graded_nodes(family.panels, part.degrees)
            offset = family.sign * family.reach * nodes.d
            t = b.value * np.sqrt(nodes.rest) if part.zone == 0 else np.sqrt(b.square + offset)
            weights = nodes.weights * family.reach / (2.0 * np.pi * t)
            shear = weights * t**2
            self.shear_weights.append(shear)
            if part.boundary >= 0:
                # without compliance an equation is of the first kind, and what is missed far away
                # would spoil what is next to the boundary
                reach = min(p.family.reach for p in self.parts if p.boundary == part.boundary)
                closer = np.maximum(reach / np.abs(offset), 1.0)
                weights = weights * closer if alpha == 0.0 else weights
                shear = shear * closer if beta == 0.0 else shear
            self.nodes.append(nodes)
            self.offsets.append(offset)
            self._t.append(t)
            self._beyond.append(offset / (t + b.value))
            self._weights.append(weights)
            self._shear_tests.append(shear)

    def _assemble_blocks(self) -> None:
        """Find the integrals of every part at the nodes of every other."""
        count = len(self.parts)
        #: of p outside and inside of the nodes, and of q/s
        self._f, self._j, self._g, self._i = ([Seen(n, {}) for n in self.nodes] for _ in range(4))
        for i in range(count):
            for k in range(count):
                for side in (1, -1):
                    if side * (k - i) < 0:
                        continue
                    pressure, shear = self._pair(k, i, side)
                    outward = side > 0
                    (self._f if outward else self._j)[i].blocks[k] = pressure
                    (self._g if outward else self._i)[i].blocks[k] = shear

    def _pair(self, k: int, i: int, side: int) -> tuple[Block, Block]:
        """Return what is seen of p and of q/s of a part at the nodes of another."""
        part, place = self.parts[k], (self.parts[i].family, self.parts[i].degrees, side)
        shear = block(part.shear, self._finer[k], *place)
        assert shear is not None
        if part.shear is part.family and self._over[k] is None:
            return shear, shear
        if part.shear is not part.family or not shear.sampled:
            pressure = block(part.family, part.degrees, *place)
            assert pressure is not None
            return pressure, shear
        return shear.of(np.searchsorted(self._columns[k], self._index[k])), shear

    def _assemble_functionals(self) -> None:
        """Assemble loads, pulls and shears: ``int p s ds``, ``int q ds``, ``2 pi int q s ds``."""
        reach = [0.5 * p.family.reach for p in self.parts]
        parts = list(zip(reach, self.parts, self._index, self._columns, strict=True))
        self.load = np.concatenate([r * moments(p.family.panels)[own] for r, p, own, _ in parts])
        self._pull = [r * moments(p.shear.panels)[columns] for r, p, _, columns in parts]

    @cached_property
    def shear_functional(self) -> Array:
        """``2 pi int q s ds`` as a functional of vectors."""
        row = np.zeros(self.unknowns)
        for k, (part, own) in enumerate(zip(self.parts, self.pressure, strict=True)):
            if part.state:
                row[own] = 2.0 * np.pi * part.state * self.parameters.friction * self.load[own]
            elif part.zone == 0:  # int q s ds = int t G dt
                seen = self._g[k].blocks[k]
                weights = np.pi * self.nodes[k].weights * part.family.reach
                row[self.shear[k]] = seen.scale * (weights @ seen.whole)
            else:
                points, matrix = part.shear.sources()
                row[self.shear[k]] = (2.0 * np.pi * np.sqrt(points.z) @ matrix)[self._index[k]]
        return row

    def total_shear(self, values: Array) -> float:
        """Return ``2 pi int q s ds`` of a vector."""
        return float(self.shear_functional @ values)

    @cached_property
    def masses(self) -> list[tuple[slice, Array]]:
        """Masses of p and of q/s times their compliances, by their place."""
        alpha, beta, _, _ = self.parameters
        blocks = []
        if alpha > 0.0:
            for part, own in zip(self.parts, self.pressure, strict=True):
                mass, _ = unit_masses(part.family.panels, part.degrees)
                blocks.append((own, 0.5 * alpha * part.family.reach * mass))
        if beta > 0.0:
            for k, own in self.shear.items():
                family = self.parts[k].shear
                one, d = unit_masses(family.panels, self.parts[k].degrees)
                mass = family.boundary.square * one + family.sign * family.reach * d
                blocks.append((own, 0.5 * beta * family.reach * mass))
        return blocks

    @cached_property
    def jumps(self) -> Array:
        """What q exceeds friction by in stick, at every boundary, as functionals of vectors."""
        signs = 1.0 - 2.0 * (np.arange(TAIL_TERMS) % 2)
        rows = np.zeros((len(self.radii), self.unknowns))
        for k in self.stick:
            part = self.parts[k]
            if part.boundary >= 0:
                row, j = rows[part.boundary], part.boundary
                sense = float(self.states[j] + self.states[j + 1])
                last = self.shear[k].stop
                row[last - TAIL_TERMS : last] = part.family.boundary.value * signs
                last = self.pressure[k].stop
                row[last - TAIL_TERMS : last] = -sense * self.parameters.friction * signs
        return rows

    @cached_property
    def balances(self) -> tuple[Array, Array]:
        """``kappa R(b)`` and ``E(b)`` at every boundary, as functionals of vectors."""
        drive = np.zeros((len(self.radii), self.unknowns))
        balance = np.zeros_like(drive)
        for i, part in enumerate(self.parts):
            if part.boundary < 0 or part.family.sign > 0:
                continue
            row, b = drive[part.boundary], part.family.boundary.value
            for k, one in self._j[i].blocks.items():
                row[self.pressure[k]] += 2.0 * self.parameters.kappa / b * one.scale * one.at
            row = balance[part.boundary : part.boundary + 1]
            for k, one in self._g[i].blocks.items():
                self._add(row, -one.scale * one.at[None], k)
        return drive, balance + drive

    # equations

    def _add(self, rows: Array, columns: Array, k: int) -> None:
        """Add to rows of a matrix what q/s of a part contributes."""
        over = self._over[k]
        if over is None:
            rows[:, self.shear[k]] += columns
        else:
            slip = self.parts[k].state * self.parameters.friction
            rows[:, self.pressure[k]] += slip * over.after(columns)

    def misfit(self, values: Array, approach: Array, lifts: Array) -> Misfit:
        """Return W and E at the nodes of every part.

        Parameters
        ----------
        values : ndarray, shape (unknowns, k)
        approach : ndarray, shape (k,)
            delta.
        lifts : ndarray, shape (boundaries, k)
            ``E(b)``.
        """
        kappa = self.parameters.kappa
        p, q = [values[own] for own in self.pressure], self.traction(values)
        pull = sum(own @ one for own, one in zip(self._pull, q, strict=True))
        normal: list[Array] = []
        tangential: list[Array | None] = []
        known: dict[int, Array] = {}
        for i, part in enumerate(self.parts):
            f, j, g, swept = self._f[i], self._j[i], self._g[i], self._i[i]
            t, beyond = self._t[i][:, None], self._beyond[i][:, None]
            b = part.family.boundary.value
            at_boundary = swept.at(q)
            at = 2.0 * approach + 2.0 * kappa * (pull - b * at_boundary) - f.at(p)
            # the same on both sides to the last digit: a step would be felt like 1/sqrt(d)
            at = known.setdefault(part.boundary, at)
            normal.append(at - 2.0 * kappa * (t * swept.more(q) + beyond * at_boundary) - f.more(p))
            if i > self.stick[-1]:  # no function in stick feels E here
                tangential.append(None)
                continue
            drive = (2.0 / t) * j.more(p) - (beyond / t) * (2.0 / b * j.at(p))
            missed = kappa * drive - g.more(q)
            tangential.append(missed + lifts[part.boundary] if part.boundary >= 0 else missed)
        return Misfit(normal, tangential)

    def slip_misfit(self, values: Array, target: Family) -> Array:
        """Return E at the sampling points of a half of a slip zone, of vectors as columns."""
        pressure, traction = [values[own] for own in self.pressure], self.traction(values)
        inner = np.zeros((len(target.sampling().offset), values.shape[1]))
        total = np.zeros_like(inner)
        for k, part in enumerate(self.parts):
            seen = block(part.family, part.degrees, target, target.panels, -1)
            if seen is not None:
                inner += seen.whole @ seen.onto(pressure[k])
            seen = block(part.shear, self._finer[k], target, target.panels, 1)
            if seen is not None:
                total -= seen.whole @ seen.onto(traction[k])
        root = np.sqrt(target.sampling().z)[:, None]
        return np.asarray(total + (2.0 * self.parameters.kappa / root) * inner)

    def residual(self, values: Array, approach: Array, lifts: Array) -> Array:
        """Return what both equations miss, tested with all functions; see `misfit`."""
        missed = np.zeros_like(values)
        misfit = self.misfit(values, approach, lifts)
        for i, (normal, tangential) in enumerate(
            zip(misfit.normal, misfit.tangential, strict=True)
        ):
            for k, sums in self._f[i].tested(self._weights[i][:, None] * normal):
                missed[self.pressure[k]] += sums
            if tangential is not None:
                stuck = self._stuck(i)
                for k, sums in stuck.tested(self._shear_tests[i][:, None] * tangential):
                    missed[self.shear[k]] += sums
        for own, mass in self.masses:
            missed[own] -= mass @ values[own]
        return missed

    def _stuck(self, i: int) -> Seen:
        """Return half-integrals of the functions in stick at the nodes of a part."""
        own = self._g[i]
        return Seen(own.nodes, {k: one for k, one in own.blocks.items() if k in self.shear})

    def matrix(self) -> Array:
        """Return the matrix of both equations; it is that of `residual` but for roundings."""
        matrix = np.zeros((self.unknowns, self.unknowns))
        for i in range(len(self.parts)):
            f, weights = self._f[i], self._weights[i]
            for k, j, product in f.products(f, weights, whole=True, own=self._kept(i, False)):
                matrix[self.pressure[k], self.pressure[j]] += product
            if not self._plain[0]:
                self._add_driving(matrix, i)
            if i > self.stick[-1]:
                continue
            stuck, weights = self._stuck(i), self._shear_tests[i]
            kept = self._kept(i, True)
            for k, j, product in stuck.products(
                self._g[i], weights, whole=self._plain[1], own=kept
            ):
                self._add(matrix[self.shear[k]], product, j)
            if not self._plain[1]:
                self._add_driven(matrix, i)
            elif self.parts[i].boundary >= 0:
                at_boundary = self.balances[1][self.parts[i].boundary]
                for k, sums in stuck.tested(weights[:, None]):
                    matrix[self.shear[k]] += sums * at_boundary
        self._add_moments(matrix)
        for own, mass in self.masses:
            matrix[own, own] += mass
        return matrix

    def _kept(self, i: int, shear: bool) -> Array | None:
        """Return the sums over the nodes of the disk of its own integrals' products, if kept."""
        part = self.parts[i]
        if part.zone or not self._plain[shear]:
            return None
        b, family = part.family.boundary.value, part.shear if shear else part.family
        return b ** (3 if shear else 1) * disk_gram(family.panels, part.degrees, shear)

    def _add_moments(self, matrix: Array) -> None:
        """Add the coupling of equations that are not weighted: in it no kernel is left.

        ``<phi, int_s^1 q> = int phi s ds int q ds`` where q lies outside of phi, and
        ``<s psi, g[p]> = int psi s ds int p s ds`` where p lies inside of psi.
        """
        kappa = self.parameters.kappa
        for k, (part, own) in enumerate(zip(self.parts, self.pressure, strict=True)):
            if self._plain[0]:
                load = self.load[own][:, None]
                self._add(matrix[own], -kappa * self._within(k), k)
                for j in range(k + 1, len(self.parts)):
                    self._add(matrix[own], -kappa * load * self._pull[j], j)
            if self._plain[1] and part.state == 0:
                rows = matrix[self.shear[k]]
                rows[:, own] -= kappa * self._within(k).T
                rows[:, : own.start] -= kappa * self._pull[k][:, None] * self.load[: own.start]

    def _within(self, k: int) -> Array:
        """Return ``int phi s ds int psi s ds`` over what of psi lies outside of phi, on a part."""
        part = self.parts[k]
        matrix = outer_moments(part.family.panels, part.shear.panels, part.family.sign)
        return (0.5 * part.family.reach) ** 2 * matrix[np.ix_(self._index[k], self._columns[k])]

    def _add_driving(self, matrix: Array, i: int) -> None:
        """Add what the traction does to the normal equation at the nodes of a part."""
        f, swept, t, weights = self._f[i], self._i[i], self._t[i], self._weights[i]
        coupling = 2.0 * self.parameters.kappa
        for k, j, product in f.products(swept, weights * t):
            self._add(matrix[self.pressure[k]], coupling * product, j)
        # t I(t) is t/b times its value at the boundary, and more
        for k, sums in f.tested(coupling * np.column_stack([weights * t, weights])):
            rows = matrix[self.pressure[k]]
            for j, one in swept.blocks.items():
                self._add(rows, one.scale * sums[:, :1] * one.at, j)
            for j, own in enumerate(self._pull):
                self._add(rows, -sums[:, 1:] * own, j)

    def _add_driven(self, matrix: Array, i: int) -> None:
        """Add what the pressure does to the tangential equation at the nodes of a part."""
        stuck, inner = self._stuck(i), self._j[i]
        t, weights, kappa = self._t[i], self._shear_tests[i], self.parameters.kappa
        for k, j, product in stuck.products(inner, weights * (2.0 * kappa / t)):
            matrix[self.shear[k], self.pressure[j]] -= product
        falls = weights * self._beyond[i] * 2.0 * kappa / (t * self.parts[i].family.boundary.value)
        for k, sums in stuck.tested(falls[:, None]):
            for j, one in inner.blocks.items():
                matrix[self.shear[k], self.pressure[j]] += one.scale * sums * one.at
