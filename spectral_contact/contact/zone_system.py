"""The linear problem of partial slip at given zone boundaries.

At given boundaries the disk's traction is linear in the rim value ``m`` of its target and in the
coefficients of the stick annuli outside, and is eliminated exactly. What remains is one dense
system for the annuli, with continuity at the rim for ``m``.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np
from numpy.typing import NDArray

from spectral_contact.contact.drive import Drive
from spectral_contact.contact.refine import Resolution
from spectral_contact.contact.resolution import PANEL_WIDTH, series_of
from spectral_contact.contact.rim import SlipSource, rim_target
from spectral_contact.contact.slip_displacement import (
    annulus_between,
    pressure_expansion,
    smooth_between,
)
from spectral_contact.contact.stick_annuli import StickAnnuli
from spectral_contact.fields.series import EDGE, Radius
from spectral_contact.spectral.annulus import Annulus, Points
from spectral_contact.spectral.galerkin import Factored, disk_operators
from spectral_contact.spectral.panels import LogPanels

__all__ = ["Part", "ZoneSystem", "ZoneTractions", "scaled_solve"]

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Part:
    """Galerkin nodes on a slip zone or half a stick zone outside the disk.

    Attributes
    ----------
    zone : int
    points : Points
    weights : ndarray
        Of ``t^2 dt / pi``.
    target : ndarray
    half_integral : ndarray, shape (points, columns)
        Of the last functions on the stick annuli, in units of their `extents`; of those before
        they are zero.
    """

    zone: int
    points: Points
    weights: Array
    target: Array
    half_integral: Array

    def half_integral_of(self, values: Array) -> Array:
        """Return the half-integral of a function with these coefficients."""
        return np.asarray(self.half_integral @ values[len(values) - self.half_integral.shape[1] :])


@dataclass(slots=True)
class ZoneTractions:
    """Everything at one set of boundaries.

    Attributes
    ----------
    radii : tuple of Radius
    mismatch : ndarray
        Rim balance, then q/(f p) less its sign at every other end of a stick zone.
    factored : Factored
        The disk's system.
    target, disk : ndarray
        Target and coefficients on the disk.
    sticks : StickAnnuli
    matrix, outer : ndarray
        System and coefficients of the stick annuli, the rim value last.
    grid : list of Part
        What the zones outside the disk are integrated with, up to the last stick zone.
    unresolved : float
        What the disk's target leaves out, relative to its value at the rim.
    """

    radii: tuple[Radius, ...]
    mismatch: Array
    factored: Factored
    target: Array
    disk: Array
    sticks: StickAnnuli
    matrix: Array
    outer: Array
    grid: list[Part]
    unresolved: float


@dataclass(frozen=True, slots=True)
class ZoneSystem:
    """The problem for given states of the zones, for kappa = 1.

    Attributes
    ----------
    drive : Drive
    beta, friction : float
        ``beta*`` > 0 and ``f / kappa``.
    states : tuple of int
        0 for stick, +1 or -1 for slip with that sign, from the centre outward.
    """

    drive: Drive
    beta: float
    friction: float
    states: tuple[int, ...]

    @property
    def alpha(self) -> float:
        """``alpha*``."""
        return self.drive.contact.compliance

    def stick_annuli(self) -> list[int]:
        """Return the numbers of the stick zones outside the central disk."""
        return [k for k, state in enumerate(self.states) if state == 0 and k > 0]

    @staticmethod
    def outer(radii: tuple[Radius, ...], k: int) -> Radius:
        """Return the outer radius of zone k."""
        return radii[k] if k < len(radii) else EDGE

    def annulus(self, inner: Radius, outer: Radius, state: int, tolerance: float) -> Annulus:
        """Return the panels of a zone: graded to its layers at both ends."""
        last = outer.from_edge == 0.0
        smooth_edge = last and self.alpha == 0.0
        free = self.beta if state == 0 else min(self.beta, 1.0)
        # short of the edge the pressure has its layer beyond the end
        layer = self.alpha or free if last else min(free, max(self.alpha, outer.rest))
        return annulus_between(
            inner, outer, (free, layer), tolerance, 0.5 if smooth_edge and state == 0 else 1.0
        )

    def solve(
        self,
        radii: tuple[Radius, ...],
        space: Resolution,
        degrees: list[list[tuple[int, ...]]],
        quadrature: float,
    ) -> ZoneTractions:
        """Solve for all tractions with the boundaries given.

        Parameters
        ----------
        radii : tuple of Radius
            The boundaries, outward.
        space : Resolution
            Of the disk.
        degrees : list of list of tuple of int
            Of the stick annuli, see `StickAnnuli`.
        quadrature : float
            Accuracy of the integrals over slip.
        """
        panels, rim = space.panels, radii[0]
        disk = disk_operators(panels)
        factored = disk.tangential.space(space.degrees).factor(self.beta / rim.value)
        sticks = self._sticks(radii, degrees, panels.degree)
        # disk targets: what does not depend on the annuli, the rim value, every annulus function
        sources = self._sources(radii, quadrature, rim.square * float(disk.nodes.d.min()))
        _, values = rim_target([self.drive], rim, sources, disk.samples, keep=True)
        fixed, unresolved = disk.samples.interpolate(values), disk.samples.unresolved(values)
        falls, shares, at_rim = sticks.falls(panels, rim)
        targets = np.hstack([fixed, np.ones_like(fixed), falls])
        responses = factored.solve(targets)
        misfits = targets - factored.space.half_integral(responses)
        grid = self._outer_grid(radii, sticks, quadrature)
        weights = rim.value**3 * disk.tangential.weights
        matrix, right = self._annulus_system(sticks, grid)
        # The functions' half-integrals on the disk, at_rim - falls, against the misfits. By
        # Galerkin orthogonality that is a product of misfits and one of responses: the first
        # form loses eps/sqrt(beta), as the misfits are rounded at the size of the targets.
        products = misfits[:, 1:].T @ (weights[:, None] * misfits)
        products += rim.value**3 * factored.compliance_energy(responses[:, 1:], responses)
        coupling = np.vstack([at_rim, -shares]).T @ products
        limits = np.array(
            [series_of(panels, responses[:, i]).limit for i in range(responses.shape[1])]
        )
        size = len(sticks.columns)
        system = np.zeros((size + 1, size + 1))
        system[:size, :size] = matrix - coupling[:, 2:] @ shares
        system[:size, size] = -coupling[:, 1]
        system[size, :size], system[size, size] = limits[2:] @ shares, limits[1]
        slipping = self.states[1] * self.friction * self.drive.pressure.value(rim.rest)
        vector = np.concatenate([right + coupling[:, 0], [slipping - limits[0]]])
        unknown = scaled_solve(system, vector)
        outer, m = unknown[:size], unknown[size]
        combination = np.concatenate([[1.0, m], shares @ outer])
        balance = -float(at_rim @ outer) - m
        mismatch = self._mismatch(radii, sticks, sticks.full(outer), balance)
        return ZoneTractions(
            radii,
            mismatch,
            factored,
            targets @ combination,
            responses @ combination,
            sticks,
            system,
            outer,
            grid,
            unresolved / self.drive.value(rim.rest),
        )

    def _sticks(
        self, radii: tuple[Radius, ...], degrees: list[list[tuple[int, ...]]], capacity: int
    ) -> StickAnnuli:
        """Return the basis on the stick annuli."""
        annuli = []
        for k, pair in zip(self.stick_annuli(), degrees, strict=True):
            first, second = (LogPanels(len(d), PANEL_WIDTH, capacity) for d in pair)
            annuli.append(Annulus(radii[k - 1], self.outer(radii, k), first, second))
        return StickAnnuli(annuli, degrees)

    def slip_annuli(self, radii: tuple[Radius, ...], tolerance: float) -> dict[int, Annulus]:
        """Return the panels of the slip zones, by their numbers."""
        return {
            k: self.annulus(radii[k - 1], self.outer(radii, k), state, max(tolerance, 1e-14))
            for k, state in enumerate(self.states)
            if state != 0
        }

    def _sources(
        self, radii: tuple[Radius, ...], tolerance: float, nearest: float
    ) -> list[tuple[float, SlipSource]]:
        return [
            (
                state * self.friction,
                SlipSource(
                    [self.drive.pressure],
                    radii[k - 1],
                    self.outer(radii, k),
                    self.alpha,
                    tolerance,
                    nearest,
                    rim=radii[0],
                ),
            )
            for k, state in enumerate(self.states)
            if state != 0
        ]

    def _outer_grid(
        self, radii: tuple[Radius, ...], sticks: StickAnnuli, quadrature: float
    ) -> list[Part]:
        """Return nodes and targets, up to the last stick zone."""
        pressure, grid = self.drive.pressure, []
        slips = self.slip_annuli(radii, quadrature)
        for own, stick in enumerate(self.stick_annuli()):
            pieces = [(stick - 1, sticks.inside(own, radii[stick - 2]))]
            pieces += [(stick, sticks.at_own_nodes(own, half)) for half in (0, 1)]
            targets = self.drive.target(np.concatenate([p.y for _, (p, _, _) in pieces]))
            cuts = np.cumsum([len(w) for _, (_, w, _) in pieces])[:-1]
            for (zone, (points, weights, block)), target in zip(
                pieces, np.split(targets, cuts), strict=True
            ):
                for number, annulus in slips.items():
                    if number == zone:
                        smooth = smooth_between(annulus.inner, annulus.outer, quadrature)
                        expansion = pressure_expansion(smooth, pressure)
                        load = smooth.half_integral_inside(expansion, points)
                    elif number > zone:
                        load = annulus.half_integral(points) @ pressure_expansion(annulus, pressure)
                    else:
                        continue
                    target = target - self.states[number] * self.friction * load
                weights = np.sqrt(points.z) * weights / (2.0 * pi)
                grid.append(Part(zone, points, weights, target, block))
        return grid

    def _annulus_system(self, sticks: StickAnnuli, grid: list[Part]) -> tuple[Array, Array]:
        """Return Gram plus compliance times mass of the annuli outside the disk, and targets."""
        size = len(sticks.columns)
        matrix, right = np.zeros((size, size)), np.zeros(size)
        for part in grid:
            root = np.sqrt(part.weights)
            h = part.half_integral * root[:, None]
            seen = slice(size - h.shape[1], size)
            # of a matrix and its own transpose NumPy computes one triangle, in half the time
            matrix[seen, seen] += h.T @ h
            right[seen] += h.T @ (root * part.target)
        matrix *= sticks.extents
        matrix *= sticks.extents[:, None]
        matrix += self.beta * sticks.mass()
        return matrix, sticks.extents * right

    def _mismatch(
        self, radii: tuple[Radius, ...], sticks: StickAnnuli, full: Array, balance: float
    ) -> Array:
        """Return the rim balance, then q/(f p) less the sign at the ends of the stick annuli."""
        values = [balance / self.drive.value(radii[0].rest)]
        states = (*self.states, 0)
        beside = [states[j] for k in self.stick_annuli() for j in (k - 1, k + 1)]
        for (family, part), state in zip(sticks.parts(), beside, strict=True):
            b = family.boundary
            if b.from_edge > 0.0:
                slipping = self.friction * self.drive.pressure.value(b.rest)
                values.append(b.value * family.series(full[part]).limit / slipping - state)
        return np.array(values)


def scaled_solve(matrix: Array, vector: Array) -> Array:
    """Solve with rows and columns scaled by the diagonal, whose entries span many decades."""
    scale = 1.0 / np.sqrt(np.abs(matrix.diagonal()))
    return np.asarray(scale * np.linalg.solve(matrix * scale * scale[:, None], vector * scale))
