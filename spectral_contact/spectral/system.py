r"""Normal and tangential contact on any zones of stick and slip: one system for p and q.

    alpha p + N p - kappa int_s^1 q deta = delta,

and the tangential equation (`Tangential`): the pressure is unknown everywhere. Every zone has
panels to its ends, the central disk to its rim alone. With ``F``, ``G`` the half-integrals of p and
q and

    W(t) = 2 delta + 2 kappa (int_0^1 q ds - t I(t)) - F(t),
    I(t) = int_0^t q ds / sqrt(t^2 - s^2),

the equation asks ``W``, tested with the half-integrals of all functions, for what the compliance
takes. It is taken as its value at the nearest boundary and a difference to it, in which nothing
cancels. An error of ``W(b)`` is like one of delta.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from spectral_contact.fields.series import Radius
from spectral_contact.spectral.annulus import Annulus
from spectral_contact.spectral.blocks import Block, block, kept_disk_gram
from spectral_contact.spectral.blockwise import Blockwise
from spectral_contact.spectral.cache import kept
from spectral_contact.spectral.jacobi import gauss_rule, legendre_expansion_matrix, legendre_values
from spectral_contact.spectral.moments import moments, outer_moments
from spectral_contact.spectral.panels import LogPanels, Resolution
from spectral_contact.spectral.parameters import Parameters
from spectral_contact.spectral.parts import Family
from spectral_contact.spectral.seen import Seen
from spectral_contact.spectral.tangential import AT_END, Misfit, Tangential

Array = NDArray[np.float64]
Degrees = tuple[int, ...]

#: Degrees that ``p / s`` has more than p, and panels of the displacement more than those of the
#: pressure: the far end of an annulus is a singularity ln 2 before the first panel.
_SPARE, _FINER = 4, 8


def finer(degrees: Degrees, panels: LogPanels) -> Degrees:
    """Return the degrees of a function over s."""
    return tuple(min(n + _SPARE, panels.degree) for n in degrees)


def _over_radius(family: Family, used: Degrees) -> Blockwise:
    """Return the map from the coefficients of a pressure on a part to those of it over s.

    That is what the traction of a slip zone, ``q = f p``, is as ``q/s``. It takes the functions in
    use to those of some degrees more, panel by panel.
    """
    panels = family.panels
    points = panels.degree + 11
    expand = legendre_expansion_matrix(points, panels.degree)
    values = legendre_values(gauss_rule(points)[0], panels.degree)
    s = np.sqrt(family.points(np.exp(-panels.sampling(points))).z)
    blocks = [
        expand[: more + 1] @ (values[:, : n + 1] / one[:, None])
        for one, n, more in zip(s, used, finer(used, panels), strict=True)
    ]
    # on the tail s is the same to rounding
    at_end = float(np.sqrt(family.points(np.array([panels.end / 2.0])).z[0]))
    return Blockwise([*blocks, np.eye(panels.tail_terms) / at_end])


class System(Tangential):
    """The equations on zones that stick or slip.

    Vectors hold the coefficients of the pressure, part by part outward, then those of ``u = q/s``
    on the parts that stick. Parameters are those of `Tangential`.
    """

    def __init__(
        self,
        radii: tuple[Radius, ...],
        states: tuple[int, ...],
        spaces: Sequence[Resolution],
        parameters: Parameters,
    ) -> None:
        super().__init__(radii, states, spaces, parameters)
        self._over = [_over_radius(p.family, p.degrees) if p.state else None for p in self.parts]
        #: degrees and functions of q/s: in slip those of p/s
        self._finer = [
            finer(p.degrees, p.family.panels) if p.state else p.degrees for p in self.parts
        ]
        self._columns = [
            p.shear.panels.functions(n) for p, n in zip(self.parts, self._finer, strict=True)
        ]
        panels = {k: part.family.panels for k, part in enumerate(self.parts)}
        self.fields, self.count = self._placed(panels, 0)
        #: places of the pressure's parts
        self.pressure = [one.own for one in self.fields]
        self._place_shear()
        self._place_nodes([part.degrees for part in self.parts])
        self._assemble_tests()
        self._assemble_blocks()
        self._assemble_functionals()

    # vectors

    def traction(self, values: Array) -> list[Array]:
        """Return the coefficients of q/s of vectors on every part, of the functions in use."""
        return [
            values[self.shear[k]]
            if over is None
            else part.state * self.parameters.friction * over.of(values[self.pressure[k]])
            for k, (part, over) in enumerate(zip(self.parts, self._over, strict=True))
        ]

    # assembly

    def _assemble_tests(self) -> None:
        """Find the weights with which equations are tested."""
        self._beyond, self._weights, self._shear_tests = list[Array](), list[Array](), list[Array]()
        each = zip(self.parts, self.offsets, self._t, self.shear_weights, strict=True)
        for part, offset, t, shear in each:
            weights = shear / t**2
            self._beyond.append(offset / (t + part.family.boundary.value))
            if part.boundary >= 0:
                # without compliance an equation is of the first kind, and what is missed far away
                # would spoil what is next to the boundary
                reach = min(p.family.reach for p in self.parts if p.boundary == part.boundary)
                closer = np.maximum(reach / np.abs(offset), 1.0)
                weights = weights if self._plain[0] else weights * closer
                shear = shear if self._plain[1] else shear * closer
            self._weights.append(weights)
            self._shear_tests.append(shear)

    def _assemble_blocks(self) -> None:
        """Find the integrals of every part at the nodes of every other."""
        #: of p outside and inside of the nodes, and of q/s
        self._f, self._j, self._g, self._i = ([Seen(n, {}) for n in self.nodes] for _ in range(4))
        for i in range(len(self.parts)):
            for k in range(i, len(self.parts)):
                self._f[i].blocks[k], self._g[i].blocks[k] = self._pair(k, i, 1)
                self._j[k].blocks[i], self._i[k].blocks[i] = self._pair(i, k, -1)

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
        return shear.of(np.searchsorted(self._columns[k], self.fields[k].used)), shear

    def _assemble_functionals(self) -> None:
        """Assemble loads, pulls and shears: ``int p s ds``, ``int q ds``, ``2 pi int q s ds``."""
        reach = [0.5 * p.family.reach for p in self.parts]
        self.load = np.concatenate(
            [r * moments(f.panels)[f.used] for r, f in zip(reach, self.fields, strict=False)]
        )
        self._pull = [
            r * moments(p.shear.panels)[columns]
            for r, p, columns in zip(reach, self.parts, self._columns, strict=True)
        ]

    def _slipping_load(self) -> Array:
        each = zip(self.parts, self.pressure, strict=True)
        return np.concatenate([part.state * self.load[own] for part, own in each])

    def _pressure_at(self, k: int) -> Array:
        row, last = np.zeros(self.count), self.pressure[k].stop
        row[last - len(AT_END) : last] = AT_END
        return row

    def _driven_at(self, i: int) -> tuple[Array, Array]:
        row, b = np.zeros(self.count), self.parts[i].family.boundary.value
        for k, one in self._j[i].blocks.items():
            row[self.pressure[k]] = 2.0 * self.parameters.kappa / b * one.scale * one.at
        return row, row

    # equations

    def _add(self, rows: Array, columns: Array, k: int) -> None:
        """Add to rows of a matrix what q/s of a part contributes."""
        over = self._over[k]
        if over is None:
            super()._add(rows, columns, k)
        else:
            slip = self.parts[k].state * self.parameters.friction
            rows[:, self.pressure[k]] += slip * over.after(columns)

    def misfit(self, values: Array, approach: Array, imbalance: Array) -> Misfit:
        """Return W and E at the nodes of every part."""
        kappa = self.parameters.kappa
        p, q = [values[own] for own in self.pressure], self.traction(values)
        pull = sum(own @ one for own, one in zip(self._pull, q, strict=True))
        normal: list[Array] = []
        known: dict[int, Array] = {}
        for i, part in enumerate(self.parts):
            f, swept = self._f[i], self._i[i]
            t, beyond = self._t[i][:, None], self._beyond[i][:, None]
            at_boundary = swept.at(q)
            at = 2.0 * approach - f.at(p)
            at += 2.0 * kappa * (pull - part.family.boundary.value * at_boundary)
            # the same on both sides to the last digit: a step would be felt like 1/sqrt(d)
            at = known.setdefault(part.boundary, at)
            normal.append(at - 2.0 * kappa * (t * swept.more(q) + beyond * at_boundary) - f.more(p))
        return Misfit(normal, self._tangential(values, q, imbalance))

    def _driven(self, i: int, values: Array) -> Array:
        p, j, t = [values[own] for own in self.pressure], self._j[i], self._t[i][:, None]
        falls = self._beyond[i][:, None] / self.parts[i].family.boundary.value * j.at(p)
        return np.asarray((2.0 * self.parameters.kappa / t) * (j.more(p) - falls))

    def slip_zone(self, zone: int) -> Annulus:
        """Return the panels of the displacement in a slip zone: those of p, finer."""
        first, second = (
            replace(one.family.panels, power=0.0, degree=one.family.panels.degree + _FINER)
            for one in self.parts[2 * zone - 1 : 2 * zone + 1]
        )
        inner, outer = self.bounds[zone : zone + 2]
        return Annulus(inner, outer, first, second)

    def slip_misfit(self, values: Array, zone: int, annulus: Annulus) -> list[Array]:
        """Return E at the sampling points of a slip zone, of vectors as columns."""
        return [self._misfit_at(values, target) for target in annulus.families]

    def _misfit_at(self, values: Array, target: Family) -> Array:
        pressure, traction = [values[own] for own in self.pressure], self.traction(values)
        inner = np.zeros((len(target.panels.distances), values.shape[1]))
        total = np.zeros_like(inner)
        for k, part in enumerate(self.parts):
            seen = block(part.family, part.degrees, target, target.panels, -1, differences=False)
            if seen is not None:
                inner += seen.sums(pressure[k])
            seen = block(part.shear, self._finer[k], target, target.panels, 1, differences=False)
            if seen is not None:
                total -= seen.sums(traction[k])
        root = np.sqrt(target.sampling().z)[:, None]
        return np.asarray(total + (2.0 * self.parameters.kappa / root) * inner)

    def tested(self, misfit: Misfit) -> Array:
        """Return the sums over the nodes of a misfit times the half-integrals of functions."""
        tested = super().tested(misfit)
        for i, missed in enumerate(misfit.normal):
            for k, sums in self._f[i].tested(self._weights[i][:, None] * missed):
                tested[self.pressure[k]] += sums
        return tested

    def _assembled(self) -> Array:
        """Return the matrix without masses: of full stick only kappa is not its form's."""
        if self.radii:
            return self.on_zones()
        [part], both = self.parts, (slice(self.count), slice(self.count, self.unknowns))
        space, beta = Resolution(part.family.panels, part.degrees), self.parameters.beta
        matrix = _unit_stick(space, beta == 0.0).copy()
        matrix[both[0], both[1]] *= self.parameters.kappa
        matrix[both[1], both[0]] *= self.parameters.kappa
        return matrix

    def on_zones(self) -> Array:
        """Return the matrix without masses, of any zones."""
        matrix = super()._assembled()
        for i, part in enumerate(self.parts):
            f, kept = self._f[i], None
            if part.zone == 0 and self._plain[0]:
                gram = kept_disk_gram(part.family.panels, part.degrees, shear=False)
                kept = part.family.boundary.value * gram
            for k, j, product in f.products(f, self._weights[i], whole=True, own=kept):
                matrix[self.pressure[k], self.pressure[j]] += product
            if not self._plain[0]:
                self._add_driving(matrix, i)
            if not self._plain[1] and i <= self.stick[-1]:
                self._add_driven(matrix, i)
        self._add_moments(matrix)
        return matrix

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
        return (0.5 * part.family.reach) ** 2 * matrix[
            np.ix_(self.fields[k].used, self._columns[k])
        ]

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


@kept("full-stick matrices", 8)
def _unit_stick(space: Resolution, rigid: bool) -> Array:
    """Return the matrix of full stick without masses, for kappa = 1."""
    parameters = Parameters(0.0, 0.0 if rigid else 1.0, 1.0, 0.0)
    return System((), (0,), [space], parameters).on_zones()
