r"""Elastic coupling with any zones of stick and slip: one unsymmetric system for p and q.

The equations and the half-integrals are those of `sliding`, with any number of zones: p is unknown
everywhere, ``u = q/s`` in stick, and in slip q is ``f p`` with the sign of the zone. Every zone has
panels to its ends, the central disk to its rim alone. Both misfits are taken as their value at the
nearest boundary and a difference to it, in which nothing cancels. An error of ``W(b)`` is like one
of delta. ``E(b)``, which is small, is an unknown of its own at every boundary between zones, a
`lift`: together they make the traction continuous. That each is what p and q make it is the
condition of its boundary.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from spectral_contact.fields import Radius
from spectral_contact.spectral.abel import TAIL_TERMS
from spectral_contact.spectral.around_rim import OverRadius, finer
from spectral_contact.spectral.coupled import moments
from spectral_contact.spectral.from_boundary import (
    Seen,
    half_integrals,
    inner_integrals,
    node_rule,
)
from spectral_contact.spectral.panels import LogPanels, top_functions
from spectral_contact.spectral.parameters import Parameters
from spectral_contact.spectral.zone_parts import Part, zone_parts
from spectral_contact.threads import cached_property

__all__ = ["SlidingZones"]

Array = NDArray[np.float64]
Degrees = tuple[int, ...]


class SlidingZones:
    """The operators of zones that stick or slip.

    Vectors hold the coefficients of the pressure, part by part outward, then those of ``u = q/s``
    on the parts that stick.

    Parameters
    ----------
    radii : tuple of Radius
        Boundaries between zones, outward.
    states : tuple of int
        0 for stick, +1 or -1 for slip with this sign; the first is 0.
    panels : list of LogPanels
        Of the disk, then toward the inner and the outer end of every zone.
    degrees : list of tuple of int
        Highest degrees on them.
    weighted : bool
        Whether the normal equation is without compliance, see `SlidingDisk`.
    """

    def __init__(
        self,
        radii: tuple[Radius, ...],
        states: tuple[int, ...],
        panels: list[LogPanels],
        degrees: list[Degrees],
        weighted: bool = False,
    ) -> None:
        self.radii, self.states, self._weighted = radii, states, weighted
        self.parts = zone_parts(radii, states, panels, degrees)
        self._index = [p.family.panels.functions(p.degrees) for p in self.parts]
        self._over = [
            OverRadius((p.family,), (p.degrees,)) if p.state else None for p in self.parts
        ]
        #: functions of q/s: in slip those of p/s
        self._columns = [
            p.family.panels.functions(finer(p.degrees, p.family.panels)) if p.state else index
            for p, index in zip(self.parts, self._index, strict=True)
        ]
        sizes = [len(index) for index in self._index]
        self._starts = np.concatenate([[0], np.cumsum(sizes)])
        #: number of unknowns of the pressure
        self.count = int(self._starts[-1])
        self.stick = [k for k, p in enumerate(self.parts) if p.state == 0]
        ends = np.cumsum([self.count, *(sizes[k] for k in self.stick)])
        self._shear = {
            k: slice(int(a), int(b))
            for k, a, b in zip(self.stick, ends[:-1], ends[1:], strict=True)
        }
        self.unknowns = int(ends[-1])
        self._assemble_nodes()
        self._assemble_transforms()

    # vectors

    def _pressure(self, k: int) -> slice:
        return slice(int(self._starts[k]), int(self._starts[k + 1]))

    def split(self, values: Array) -> tuple[list[Array], dict[int, Array]]:
        """Return the coefficients in the whole bases: of p on all parts, of u on those in stick."""

        def full(size: int, k: int, part: Array) -> Array:
            whole = np.zeros((size, *values.shape[1:]))
            whole[self._index[k]] = part
            return whole

        size = [p.family.panels.size for p in self.parts]
        pressure = [full(size[k], k, values[self._pressure(k)]) for k in range(len(self.parts))]
        return pressure, {k: full(size[k], k, values[s]) for k, s in self._shear.items()}

    def traction(self, values: Array, friction: float) -> list[Array]:
        """Return the coefficients of q/s of vectors on every part, of the functions in use."""
        parts = []
        for k, (part, over) in enumerate(zip(self.parts, self._over, strict=True)):
            if over is None:
                parts.append(values[self._shear[k]])
            else:
                parts.append(part.state * friction * over.of(values[self._pressure(k)]))
        return parts

    def whole_traction(self, values: Array, friction: float) -> list[Array]:
        """Return the same in the whole bases."""
        whole = []
        for k, own in enumerate(self.traction(values, friction)):
            whole.append(np.zeros((self.parts[k].family.panels.size, *values.shape[1:])))
            whole[-1][self._columns[k]] = own
        return whole

    @cached_property
    def shed(self) -> tuple[NDArray[np.int_], NDArray[np.int_]]:
        """Places in a vector of the top two degrees of every panel, and of the top one."""
        each = [*self.parts, *(self.parts[k] for k in self.stick)]
        parts = [(part.family.panels, part.degrees) for part in each]
        return top_functions(parts, 2), top_functions(parts, 1)

    # transforms

    def _assemble_nodes(self) -> None:
        self.offsets, self.t, self._beyond = [], [], []
        self._weights, self.shear_weights = [], []
        self.rules = []
        for part in self.parts:
            family, whole = part.family, part.zone == 0
            rule = node_rule(family.panels, part.degrees)
            offset = family.sign * family.reach * rule.d
            b = family.boundary
            root = b.value * np.sqrt(rule.nodes.rest)
            t = root if whole else np.sqrt(b.square + offset)
            weights = rule.nodes.weights * family.reach / (2.0 * np.pi * t)
            self.shear_weights.append(weights * t**2)
            if self._weighted and part.boundary >= 0:
                weights = weights * (1.0 + self._narrowest(part) / np.abs(offset))
            self._weights.append(weights)
            self.rules.append(rule)
            self.offsets.append(offset)
            self.t.append(t)
            #: t - b
            self._beyond.append(offset / (t + b.value))

    def _narrowest(self, part: Part) -> float:
        """Return the least extent of the two parts at a boundary."""
        return min(p.family.reach for p in self.parts if p.boundary == part.boundary)

    def _assemble_transforms(self) -> None:
        """Assemble the integrals of every part at the nodes of every other."""
        count = len(self.parts)
        self._half: list[dict[int, Array]] = [{} for _ in range(count)]
        self._shear_half: list[dict[int, Array]] = [{} for _ in range(count)]
        self._normal: list[tuple[Array, Array, Array, Array]] = []
        self._tangential: list[tuple[Array, Array, Array, Array]] = []
        for i, nodes in enumerate(self.parts):
            plain = nodes.boundary < 0
            # p outside and inside of the nodes, q/s likewise
            found: list[list[Seen]] = [[], [], [], []]
            for k, part in enumerate(self.parts):
                index, columns = self._index[k], self._columns[k]
                for which, integrals in enumerate((half_integrals, inner_integrals)):
                    seen = integrals(part.family, nodes.family, self.rules[i])
                    if seen is None:
                        continue
                    found[which].append(seen.of(index))
                    if part.shear is not part.family:
                        own, rule = nodes.family, self.rules[i]
                        if nodes is part:
                            own = part.shear
                            rule = node_rule(own.panels, part.degrees)
                        seen = integrals(part.shear, own, rule)
                        assert seen is not None
                    found[2 + which].append(seen.of(columns))
                    if which == 0:
                        self._half[i][k] = found[0][-1].whole
                        self._shear_half[i][k] = found[2][-1].whole
            f, j, g, sweep = (_together(one) for one in found)
            self._normal.append((*f, *self._swept(i, *sweep)))
            self._tangential.append((*g, *self._driven(i, *j, plain)))
        self._assemble_functionals()

    def _swept(self, i: int, at: Array, more: Array) -> tuple[Array, Array]:
        """Return ``t I(t)`` at the boundary, and by how much it is more at the nodes."""
        b = self.parts[i].family.boundary.value
        return b * at, self.t[i][:, None] * more + self._beyond[i][:, None] * at

    def _driven(self, i: int, at: Array, more: Array, plain: bool) -> tuple[Array, Array]:
        """Return ``R(t)`` likewise."""
        t, b = self.t[i][:, None], self.parts[i].family.boundary.value
        if plain:
            return at, (2.0 / t) * more
        at = (2.0 / b) * at
        return at, (2.0 / t) * more - (self._beyond[i][:, None] / t) * at

    def _assemble_functionals(self) -> None:
        """Assemble loads, pulls and shears: ``int p s ds``, ``int q ds``, ``2 pi int q s ds``."""
        reach = [0.5 * p.family.reach for p in self.parts]
        self.load = np.concatenate(
            [
                r * moments(p.family.panels)[index]
                for r, p, index in zip(reach, self.parts, self._index, strict=True)
            ]
        )
        self._pull = [
            r * moments(p.shear.panels)[columns]
            for r, p, columns in zip(reach, self.parts, self._columns, strict=True)
        ]
        self._shear_moments = {}
        for k in self.stick:
            if k == 0:
                weights = 2.0 * np.pi**2 * self.shear_weights[0] / self.t[0]
                self._shear_moments[k] = weights @ self._shear_half[0][0]
            else:
                points, matrix = self.parts[k].shear.sources()
                full = 2.0 * np.pi * np.sqrt(points.z) @ matrix
                self._shear_moments[k] = full[self._index[k]]

    def shear(self, values: Array, friction: float) -> float:
        """Return ``2 pi int q s ds`` of a vector."""
        total = 0.0
        for k, part in enumerate(self.parts):
            own = self._pressure(k)
            if part.state == 0:
                total += float(self._shear_moments[k] @ values[self._shear[k]])
            else:
                slip = 2.0 * np.pi * part.state * friction
                total += slip * float(self.load[own] @ values[own])
        return total

    @cached_property
    def masses(self) -> list[tuple[slice, Array, bool]]:
        """Masses of p and of q/s by their place; the last says of which."""
        blocks = []
        for k, part in enumerate(self.parts):
            panels, index = part.family.panels, self._index[k]
            if panels.power == 0.0:
                mass = 0.5 * part.family.reach * panels.mass(index, 1.0, 0.0)
                blocks.append((self._pressure(k), mass, False))
        for k, own in self._shear.items():
            blocks.append((own, self.parts[k].shear.mass(self._index[k]), True))
        return blocks

    @cached_property
    def jumps(self) -> tuple[Array, Array]:
        """Limits of q and of p at the boundaries, in stick, as functionals of vectors."""
        signs = 1.0 - 2.0 * (np.arange(TAIL_TERMS) % 2)
        rows = np.zeros((2, len(self.radii), self.unknowns))
        for k in self.stick:
            part = self.parts[k]
            if part.boundary >= 0:
                last, b = self._shear[k].stop, part.family.boundary.value
                rows[0, part.boundary, last - TAIL_TERMS : last] = b * signs
                last = self._pressure(k).stop
                rows[1, part.boundary, last - TAIL_TERMS : last] = signs
        return rows[0], rows[1]

    @cached_property
    def senses(self) -> Array:
        """The sign of the traction in slip at every boundary."""
        pairs = zip(self.states[:-1], self.states[1:], strict=True)
        return np.array([float(a + b) for a, b in pairs])

    def balances(self, parameters: Parameters) -> tuple[Array, Array]:
        """Return ``kappa R(b)`` and ``E(b)`` as functionals of vectors."""
        drive = np.zeros((len(self.radii), self.unknowns))
        balance = np.zeros_like(drive)
        for i, part in enumerate(self.parts):
            if part.boundary < 0 or part.family.sign > 0:
                continue
            g, _, r, _ = self._tangential[i]
            drive[part.boundary, : len(r)] = parameters.kappa * r
            row = balance[part.boundary : part.boundary + 1]
            self._add(row, -g[None], range(i, len(self.parts)), parameters.friction)
        return drive, balance + drive

    # matrices

    def _add(self, matrix: Array, block: Array, parts: range, friction: float) -> None:
        """Add to rows what q/s of some parts contributes."""
        start = 0
        for k in parts:
            columns = block[:, start : start + len(self._columns[k])]
            start += columns.shape[1]
            over = self._over[k]
            if over is None:
                matrix[:, self._shear[k]] += columns
            else:
                slip = self.parts[k].state * friction
                matrix[:, self._pressure(k)] += slip * over.after(columns)

    def _tests(self, i: int) -> tuple[Array, Array | None]:
        """Return the half-integrals at the nodes of a part: of p from it on, of u in stick."""
        last = len(self.parts)
        normal = np.hstack([self._half[i][k] for k in range(i, last)])
        stuck = [self._shear_half[i][k] for k in range(i, last) if k in self._shear]
        return normal, np.hstack(stuck) if stuck else None

    def _stuck_from(self, i: int) -> int:
        """Return the first unknown of u on the parts from i outward."""
        return next((s.start for k, s in self._shear.items() if k >= i), self.unknowns)

    def matrix(self, parameters: Parameters) -> Array:
        """Return the matrix of both equations; it is that of `residual` but for roundings."""
        alpha, beta, kappa, friction = parameters
        matrix = np.zeros((self.unknowns, self.unknowns))
        last = len(self.parts)
        for i in range(last):
            normal, stuck = self._tests(i)
            rows = slice(int(self._starts[i]), self.count)
            weighted = (normal * self._weights[i][:, None]).T
            matrix[rows, rows] += weighted @ normal
            _, _, at, more = self._normal[i]
            block = 2.0 * kappa * (weighted @ (at + more))
            self._add(matrix[rows], block, range(i + 1), friction)
            pull = -2.0 * kappa * np.concatenate(self._pull)
            self._add(matrix[rows], np.outer(weighted.sum(axis=1), pull), range(last), friction)
            if stuck is None:
                continue
            rows = slice(self._stuck_from(i), self.unknowns)
            weighted = (stuck * self.shear_weights[i][:, None]).T
            _, fewer, _, more = self._tangential[i]
            self._add(matrix[rows], weighted @ fewer, range(i, last), friction)
            matrix[rows, : more.shape[1]] -= kappa * (weighted @ more)
        for own, mass, shear in self.masses:
            matrix[own, own] += (beta if shear else alpha) * mass
        return matrix

    def misfit(
        self, values: Array, parameters: Parameters, approach: Array, lifts: Array
    ) -> tuple[list[Array], list[Array]]:
        """Return W and E at the nodes of every part.

        Parameters
        ----------
        values : ndarray, shape (unknowns, k)
        parameters : Parameters
        approach : ndarray, shape (k,)
            delta.
        lifts : ndarray, shape (boundaries, k)
            ``E(b)``.
        """
        kappa = parameters.kappa
        q = self.traction(values, parameters.friction)
        pull = np.concatenate(self._pull) @ np.concatenate(q)
        normal, tangential = [], []
        known: dict[int, Array] = {}
        for i, part in enumerate(self.parts):
            outside, inside = values[self._starts[i] : self.count], values[: self._starts[i + 1]]
            q_outside, q_inside = np.concatenate(q[i:]), np.concatenate(q[: i + 1])
            f, f_more, sweep, sweep_more = self._normal[i]
            at = 2.0 * approach + 2.0 * kappa * (pull - sweep @ q_inside) - f @ outside
            # the same on both sides to the last digit: a step would be felt like 1/sqrt(d)
            at = known.setdefault(part.boundary, at)
            normal.append(at - 2.0 * kappa * (sweep_more @ q_inside) - f_more @ outside)
            _, g_more, _, drive_more = self._tangential[i]
            tangential.append(kappa * (drive_more @ inside) - g_more @ q_outside)
            if part.boundary >= 0:
                tangential[-1] += lifts[part.boundary]
        return normal, tangential

    def residual(
        self, values: Array, parameters: Parameters, approach: Array, lifts: Array
    ) -> Array:
        """Return what both equations miss, tested with all functions; see `misfit`."""
        missed = np.zeros_like(values)
        misfits = self.misfit(values, parameters, approach, lifts)
        for i, (normal, tangential) in enumerate(zip(*misfits, strict=True)):
            w, e = self._weights[i][:, None] * normal, self.shear_weights[i][:, None] * tangential
            for k in range(i, len(self.parts)):
                missed[self._pressure(k)] += self._half[i][k].T @ w
                if k in self._shear:
                    missed[self._shear[k]] += self._shear_half[i][k].T @ e
        for own, mass, shear in self.masses:
            missed[own] -= (parameters.beta if shear else parameters.alpha) * (mass @ values[own])
        return missed


def _together(seen: list[Seen]) -> tuple[Array, Array]:
    """Return values at the boundary and differences to them of several, one after the other."""
    return np.concatenate([s.at for s in seen]), np.hstack([s.more for s in seen])
