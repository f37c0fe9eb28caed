r"""Partial slip on any set of annuli: the boundaries are solved for, panels graded to each.

The central stick disk is treated as in `one_disk`: at given boundaries its traction is linear in
the rim value ``m`` of the target and in the coefficients of the stick annuli outside it, and is
eliminated exactly. What remains is one dense system for the annuli, with continuity at the rim for
``m``. The boundaries are the roots of the rim balance and of ``q = f p`` at every other end.
"""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass, replace
from math import ceil, pi

import numpy as np
from numpy.typing import NDArray

from spectral_contact.adaptive import Attempt, Refinement, Resolution, refine
from spectral_contact.contact.drive import EDGE, Drive
from spectral_contact.contact.one_disk import (
    SlipSource,
    disk_resolution,
    interpolate,
    rim_target,
)
from spectral_contact.contact.resolution import (
    ROUNDING,
    SAFETY,
    decay_rates,
    expected_error,
    series_of,
    share_of_change,
    table_rates,
)
from spectral_contact.contact.slip_displacement import (
    Slipping,
    Stuck,
    annulus_between,
    slip_misfit,
)
from spectral_contact.contact.zone_search import Layout
from spectral_contact.fields import AnnulusSeries, DiskSeries, Radius
from spectral_contact.spectral.annulus import Annulus, Points
from spectral_contact.spectral.galerkin import Factored, disk_operators
from spectral_contact.spectral.panels import LogPanels

__all__ = ["ZonesSolution", "solve_zones"]

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class ZonesSolution:
    """Tractions of the stick zones for kappa = 1, and what the displacement needs.

    Attributes
    ----------
    radii : tuple of Radius
        Boundaries, outward.
    states : tuple of int
        As in `Layout`.
    disk : DiskSeries
    annuli : tuple of AnnulusSeries
        Tractions on the stick annuli, outward.
    total_shear : float
    stuck : list of Stuck
    slipping : list of Slipping
    depth : float
        ``-ln`` of the smallest scaled distance from the rim that was resolved.
    traction_error, shear_error : float
    boundary_errors : tuple of (float, float)
        Relative errors of every boundary from the centre and from the edge.
    stray : float
        Estimate of the largest error of E.
    """

    radii: tuple[Radius, ...]
    states: tuple[int, ...]
    disk: DiskSeries
    annuli: tuple[AnnulusSeries, ...]
    total_shear: float
    stuck: list[Stuck]
    slipping: list[Slipping]
    depth: float
    traction_error: float
    shear_error: float
    boundary_errors: tuple[tuple[float, float], ...]
    stray: float


@dataclass(slots=True)
class _Trial:
    """Everything at one set of boundaries."""

    radii: tuple[Radius, ...]
    mismatch: Array
    factored: Factored
    target: Array
    disk: Array
    annuli: list[Annulus]
    indices: list[Array]
    matrix: Array
    outer: Array
    grid: list[tuple[int, Points, Array, Array]]
    slips: list[Annulus]


#: Accuracy of the space in which the boundaries are found first, and their sensitivity.
_COARSE = 1e-4


class _ZonesProblem:
    """Spaces for given states of the zones; the boundaries are found anew in each of them."""

    def __init__(
        self, drive: Drive, beta: float, friction: float, layout: Layout, tolerance: float
    ) -> None:
        self.drive = drive
        self.beta = beta
        self.friction = friction
        self.states = layout.states
        self.tolerance = tolerance
        self.alpha = drive.contact.compliance
        self.logits = np.array(layout.logits)
        self.coarse = self._resolution(_COARSE)
        self._coarse_counts = self._panel_counts
        self.jacobian: Array | None = None
        self._find(self.coarse, _COARSE, 1e-7)

    # spaces

    def _annulus(self, inner: Radius, outer: Radius, state: int, tolerance: float) -> Annulus:
        """Return the panels of a zone: graded to its layers at both ends."""
        last = outer.from_edge == 0.0
        smooth_edge = last and self.alpha == 0.0
        free = self.beta if state == 0 else min(self.beta, 1.0)
        if last:
            layer = self.alpha or free
        else:  # the pressure has its layer beyond the end
            layer = min(free, max(self.alpha, outer.rest))
        return annulus_between(
            inner, outer, (free, layer), tolerance, 0.5 if smooth_edge and state == 0 else 1.0
        )

    def _resolution(self, tolerance: float) -> Resolution:
        """Return the first space: the disk's panels, then those of the stick annuli."""
        radii = self._radii(self.logits)
        disk = disk_resolution(radii[0], self.alpha, self.beta, tolerance)
        degrees = list(disk.degrees)
        zones = [
            self._annulus(radii[k - 1], self._outer(radii, k), 0, tolerance)
            for k in self._stick_annuli()
        ]
        for zone in zones:
            for panels in (zone.toward_inner, zone.toward_outer):
                # what varies at depth x falls like exp(-x) at the least
                missing = np.linspace(1.5, 0.0, panels.panels)
                rest = [ceil(3.0 + 0.55 * panels.degree * min(m, 1.0)) for m in missing[1:]]
                degrees += [panels.degree, *rest]
        self._panel_counts = [(z.toward_inner.panels, z.toward_outer.panels) for z in zones]
        panels = replace(disk.panels, degree=max(disk.panels.degree, *degrees))
        return Resolution(panels, tuple(degrees))

    def start(self) -> Resolution:
        return self._resolution(self.tolerance)

    def _stick_annuli(self) -> list[int]:
        return [k for k, state in enumerate(self.states) if state == 0 and k > 0]

    @staticmethod
    def _radii(logits: Array) -> tuple[Radius, ...]:
        return tuple(Radius.from_logit(float(x)) for x in logits)

    @staticmethod
    def _outer(radii: tuple[Radius, ...], k: int) -> Radius:
        return radii[k] if k < len(radii) else EDGE

    def _split(self, resolution: Resolution) -> tuple[Resolution, list[list[tuple[int, ...]]]]:
        """Separate the degrees of the disk from those of the annuli."""
        count = resolution.panels.panels
        disk = Resolution(resolution.panels, resolution.degrees[:count])
        rest = list(resolution.degrees[count:])
        annuli = []
        for first, second in self._panel_counts:
            annuli.append([tuple(rest[:first]), tuple(rest[first : first + second])])
            rest = rest[first + second :]
        return disk, annuli

    # one set of boundaries

    def _trial(self, resolution: Resolution, logits: Array, quadrature: float) -> _Trial:
        """Solve for all tractions with the boundaries given."""
        radii = self._radii(logits)
        disk_space, degrees = self._split(resolution)
        panels = disk_space.panels
        rim = radii[0]
        disk = disk_operators(panels)
        factored = disk.tangential.space(disk_space.degrees).factor(self.beta / rim.value)
        annuli, indices = self._stick_spaces(radii, degrees, panels.degree)
        columns = np.concatenate(indices) if indices else np.zeros(0, dtype=int)
        # disk targets: what does not depend on the annuli, the rim value, every annulus function
        sources = self._sources(radii, quadrature)
        _, function = rim_target(self.drive, rim, sources, keep=True)
        fixed = interpolate(panels, function)
        falls, at_rim = self._annulus_falls(panels, rim, annuli, columns)
        targets = np.column_stack([fixed, np.ones_like(fixed), falls])
        responses = factored.solve(targets)
        misfits = targets - disk.half_integral @ responses
        slips = self._slip_annuli(radii, quadrature)
        grid = self._outer_grid(radii, annuli, slips)
        weights = rim.value**3 * disk.tangential.weights
        functions = at_rim - falls  # half-integrals of the annulus functions on the disk
        matrix, right = self._annulus_system(annuli, columns, grid)
        coupling = functions.T @ (weights[:, None] * misfits)
        limits = np.array(
            [series_of(panels, responses[:, i]).limit for i in range(responses.shape[1])]
        )
        size = len(columns)
        system = np.zeros((size + 1, size + 1))
        system[:size, :size] = matrix - coupling[:, 2:]
        system[:size, size] = -coupling[:, 1]
        system[size, :size], system[size, size] = limits[2:], limits[1]
        slipping = (
            self.states[1] * self.friction * float(self.drive.pressure.at(np.array(rim.rest)))
        )
        vector = np.concatenate([right + coupling[:, 0], [slipping - limits[0]]])
        unknown = _scaled_solve(system, vector)
        outer, m = unknown[:size], unknown[size]
        combination = np.concatenate([[1.0, m], outer])
        balance = -float(at_rim @ outer) - m
        mismatch = self._mismatch(radii, annuli, indices, outer, balance)
        return _Trial(
            radii,
            mismatch,
            factored,
            targets @ combination,
            responses @ combination,
            annuli,
            indices,
            system,
            outer,
            grid,
            slips,
        )

    def _stick_spaces(
        self, radii: tuple[Radius, ...], degrees: list[list[tuple[int, ...]]], capacity: int
    ) -> tuple[list[Annulus], list[Array]]:
        """Return the stick annuli and, for each, the columns of the full basis in use."""
        annuli, indices, start = [], [], 0
        for k, pair in zip(self._stick_annuli(), degrees, strict=True):
            panels = [LogPanels(len(d), 2.0, capacity) for d in pair]
            annulus = Annulus(radii[k - 1], self._outer(radii, k), panels[0], panels[1])
            used = []
            for p, d in zip(panels, pair, strict=True):
                terms = p.degree + 1
                for j, n in enumerate(d):
                    used.append(np.arange(start + j * terms, start + j * terms + n + 1))
                used.append(np.arange(start + p.panels * terms, start + p.size))
                start += p.size
            annuli.append(annulus)
            indices.append(np.concatenate(used))
        return annuli, indices

    def _slip_annuli(self, radii: tuple[Radius, ...], tolerance: float) -> list[Annulus]:
        return [
            self._annulus(radii[k - 1], self._outer(radii, k), state, max(tolerance, 1e-14))
            for k, state in enumerate(self.states)
            if state != 0
        ]

    def _sources(
        self, radii: tuple[Radius, ...], tolerance: float
    ) -> list[tuple[float, SlipSource]]:
        return [
            (
                state * self.friction,
                SlipSource(
                    self.drive.pressure,
                    radii[k - 1],
                    self._outer(radii, k),
                    self.alpha,
                    tolerance,
                    rim=radii[0],
                ),
            )
            for k, state in enumerate(self.states)
            if state != 0
        ]

    def _annulus_falls(
        self, panels: LogPanels, rim: Radius, annuli: list[Annulus], columns: Array
    ) -> tuple[Array, Array]:
        """Return by how much the annulus half-integrals fall from the rim inward, and at it."""
        sources = [f.sources() for a in annuli for f in a.families]

        def function(d: Array) -> Array:
            below = rim.square * d[:, None]
            parts = []
            for points, matrix in sources:
                above = -points.before(rim)
                root = np.sqrt(below + above)
                parts.append(
                    (below / (root * (root + np.sqrt(above)))) @ (matrix / np.sqrt(above)[:, None])
                )
            return np.hstack(parts)[:, columns]

        at_rim = [(1.0 / np.sqrt(-points.before(rim))) @ matrix for points, matrix in sources]
        if not sources:
            return np.zeros((len(disk_operators(panels).nodes.d), 0)), np.zeros(0)
        return interpolate(panels, function), np.concatenate(at_rim)[columns]

    def _outer_grid(
        self, radii: tuple[Radius, ...], annuli: list[Annulus], slips: list[Annulus]
    ) -> list[tuple[int, Points, Array, Array]]:
        """Return zone, nodes, weights of ``t^2 dt/pi`` and target between the rim and the last stick."""
        last = self._stick_annuli()[-1]
        sticks, others = iter(annuli), iter(slips)
        expansions = [self._slip_expansion(a) for a in slips]
        signs = [s for s in self.states if s != 0]
        grid = []
        for k, state in enumerate(self.states[1:], start=1):
            zone = next(sticks) if state == 0 else next(others)
            if k > last:
                break
            for family in zone.families:
                points, weights = family.nodes()
                target = self.drive.target(points.y)
                for a, sign, c in zip(slips, signs, expansions, strict=True):
                    target = target - sign * self.friction * (a.half_integral(points) @ c)
                grid.append((k, points, np.sqrt(points.z) * weights / (2.0 * pi), target))
        return grid

    def _slip_expansion(self, annulus: Annulus) -> Array:
        """Return the coefficients of p/s on a slip zone."""
        values = [
            self.drive.pressure.at(f.sampling().y) / np.sqrt(f.sampling().z)
            for f in annulus.families
        ]
        return annulus.expand((values[0], values[1]))

    def _annulus_system(
        self, annuli: list[Annulus], columns: Array, grid: list[tuple[int, Points, Array, Array]]
    ) -> tuple[Array, Array]:
        """Return Gram plus compliance times mass of the annuli outside the disk, and targets."""
        total = sum(a.size for a in annuli)
        matrix = np.zeros((total, total))
        start = 0
        for annulus in annuli:
            for family in annulus.families:
                block = slice(start, start + family.panels.size)
                matrix[block, block] = self.beta * family.mass()
                start += family.panels.size
        matrix = matrix[np.ix_(columns, columns)]
        right = np.zeros(len(columns))
        for _, points, weights, target in grid:
            h = np.hstack([a.half_integral(points) for a in annuli])[:, columns]
            weighted = h * weights[:, None]
            matrix += weighted.T @ h
            right += weighted.T @ target
        return matrix, right

    def _mismatch(
        self,
        radii: tuple[Radius, ...],
        annuli: list[Annulus],
        indices: list[Array],
        outer: Array,
        balance: float,
    ) -> Array:
        """Return the rim balance, then q/(f p) -+ 1 at the ends of the stick annuli."""
        values = [balance / float(self.drive.target(np.array(radii[0].rest)))]
        full = self._full(annuli, indices, outer)
        start = 0
        for k, annulus in zip(self._stick_annuli(), annuli, strict=True):
            for family, state, b in zip(
                annulus.families,
                (self.states[k - 1], self.states[k + 1] if k + 1 < len(self.states) else 0),
                (annulus.inner, annulus.outer),
                strict=True,
            ):
                limit = family.series(full[start : start + family.panels.size]).limit
                start += family.panels.size
                if b.from_edge > 0.0:
                    slipping = self.friction * float(self.drive.pressure.at(np.array(b.rest)))
                    values.append(b.value * limit / slipping - state)
        return np.array(values)

    def _full(self, annuli: list[Annulus], indices: list[Array], outer: Array) -> Array:
        """Return the coefficients on the full bases of the annuli."""
        full = np.zeros(sum(a.size for a in annuli))
        full[np.concatenate(indices)] = outer
        return full

    # the boundaries

    def _find(self, resolution: Resolution, quadrature: float, settle: float) -> _Trial:
        """Newton with a difference Jacobian, kept up by Broyden's update."""
        x = self.logits
        trial = self._trial(resolution, x, quadrature)
        if self.jacobian is None:
            self.jacobian = self._differences(resolution, x, trial.mismatch, quadrature)
        for _ in range(25):
            step = -np.linalg.solve(self.jacobian, trial.mismatch)
            size = float(np.abs(step).max())
            step *= min(1.0, self._longest(x, step))
            x = x + step
            fresh = self._trial(resolution, x, quadrature)
            change = fresh.mismatch - trial.mismatch - self.jacobian @ step
            if size > 0.0:
                self.jacobian = self.jacobian + np.outer(change, step) / float(step @ step)
            previous, trial = size, fresh
            if size <= settle or (size <= 1e-7 and np.abs(trial.mismatch).max() <= 1e-14):
                break
            if previous < 1e-12:
                break
        self.logits = x
        return trial

    def _differences(
        self, resolution: Resolution, x: Array, base: Array, quadrature: float
    ) -> Array:
        """Return the Jacobian by differences, a small share of the narrowest zone apart."""
        jacobian = np.zeros((len(x), len(x)))
        spacing = np.diff(x)
        for i in range(len(x)):
            near = min([1.0, *(abs(spacing[j]) for j in (i - 1, i) if 0 <= j < len(spacing))])
            h = 1e-4 * near
            moved = x.copy()
            moved[i] += h
            jacobian[:, i] = (self._trial(resolution, moved, quadrature).mismatch - base) / h
        return jacobian

    @staticmethod
    def _longest(x: Array, step: Array) -> float:
        """Return the factor that keeps the boundaries in order and the step moderate."""
        factor = 1.5 / max(float(np.abs(step).max()), 1e-300)
        for width, change in zip(np.diff(x), np.diff(step), strict=True):
            if change < 0.0:
                factor = min(factor, 0.6 * width / -change)
        return factor

    # outcome

    def attempt(self, resolution: Resolution) -> Attempt[ZonesSolution]:
        trial = self._find(resolution, 0.01 * self.tolerance, 1e-11)
        return self._assess(resolution, trial)

    def _assess(self, resolution: Resolution, trial: _Trial) -> Attempt[ZonesSolution]:
        """Turn the final trial into a solution; the next coarser one shows its errors."""
        disk_space, degrees = self._split(resolution)
        panels, rim = disk_space.panels, trial.radii[0]
        series = series_of(panels, trial.disk)
        full, full_coarse, coarse = self._coarser(resolution, trial)
        rates = [decay_rates(disk_space, trial.disk)]
        shares = [share_of_change(panels, trial.disk - coarse.disk, series)]
        fields, start = [], 0
        for annulus, pair in zip(trial.annuli, degrees, strict=True):
            halves = []
            for family, degree in zip(annulus.families, pair, strict=True):
                part = slice(start, start + family.panels.size)
                start += family.panels.size
                table = family.table(full[part])
                moved = np.abs(table - family.table(full_coarse[part])).sum(axis=1)
                shares.append(moved / np.abs(table[:, 0]))
                rates.append(table_rates(np.array(degree), table))
                halves.append(family.series(full[part]))
            fields.append(AnnulusSeries(annulus.inner, annulus.outer, halves[0], halves[1]))
        rate = np.concatenate(rates)
        indicators = expected_error(np.concatenate(shares), rate)
        worst = SAFETY * float(rate[np.argmax(indicators)]) ** 1.5
        error = float(indicators.max()) + 20.0 * ROUNDING
        misfit, misfit_coarse = self._misfit(trial, full), self._misfit(coarse, full_coarse)
        stray = max(float(np.abs(a - b).max()) for a, b in zip(misfit, misfit_coarse, strict=True))
        shear = self._shear(trial, full)
        lost = abs(shear - self._shear(coarse, full_coarse))
        value = ZonesSolution(
            trial.radii,
            self.states,
            DiskSeries(rim, series),
            tuple(fields),
            shear,
            self._stuck(trial, misfit),
            self._slipping(trial, full),
            panels.panels * panels.width,
            error,
            worst * lost / shear + 1e-6 * self.tolerance + 16.0 * ROUNDING,
            self._boundary_errors(trial, worst * np.abs(coarse.mismatch - trial.mismatch)),
            worst * stray,
        )
        unknowns = len(trial.outer) + len(trial.factored.scale)
        return Attempt(value, error, indicators, rate, unknowns)

    def _coarser(self, resolution: Resolution, trial: _Trial) -> tuple[Array, Array, _Trial]:
        """Solve at the same boundaries with two degrees less everywhere, the pressure's too."""
        problem = copy(self)
        problem.drive = Drive(self.drive.contact.coarser)
        degrees = tuple(n - 2 if n > 3 else max(n - 1, 1) for n in resolution.degrees)
        coarse = problem._trial(
            replace(resolution, degrees=degrees), self.logits, 0.01 * self.tolerance
        )
        return (
            self._full(trial.annuli, trial.indices, trial.outer),
            self._full(coarse.annuli, coarse.indices, coarse.outer),
            coarse,
        )

    def _misfit(self, trial: _Trial, full: Array) -> list[Array]:
        """Return E at the disk nodes, then on the outer grid."""
        disk = disk_operators(trial.factored.space.operator.panels)
        inner = trial.target - disk.half_integral @ trial.disk
        return [inner, *(t - self._others(trial, p, full) for _, p, _, t in trial.grid)]

    def _shear(self, trial: _Trial, full: Array) -> float:
        """Return ``2 pi int q s ds`` over all zones."""
        disk = disk_operators(trial.factored.space.operator.panels)
        moment = trial.radii[0].square * float(disk.shear_moments @ trial.disk) / (2.0 * pi)
        start = 0
        for annulus in trial.annuli:
            for family in annulus.families:
                points, matrix = family.sources()
                part = full[start : start + family.panels.size]
                moment += float(np.sqrt(points.z) @ (matrix @ part))
                start += family.panels.size
        for k, state in enumerate(self.states):
            if state != 0:
                ends = (trial.radii[k - 1], self._outer(trial.radii, k))
                load = [float(self.drive.load_outside(np.array(r.rest))) for r in ends]
                moment += state * self.friction * (load[0] - load[1])
        return 2.0 * pi * moment

    def _others(self, trial: _Trial, points: Points, full: Array) -> Array:
        return np.hstack([a.half_integral(points) for a in trial.annuli]) @ full

    def _stuck(self, trial: _Trial, misfit: list[Array]) -> list[Stuck]:
        rim = trial.radii[0]
        nodes = disk_operators(trial.factored.space.operator.panels).nodes
        weights = rim.value**3 * nodes.weights * nodes.rest
        stuck = [Stuck(rim, ((Points(rim, -rim.square * nodes.d), weights * misfit[0]),))]
        for k in self._stick_annuli():
            parts = tuple(
                (p, pi * w * e)
                for (zone, p, w, _), e in zip(trial.grid, misfit[1:], strict=True)
                if zone == k
            )
            stuck.append(Stuck(self._outer(trial.radii, k), parts))
        return stuck

    def _slipping(self, trial: _Trial, full: Array) -> list[Slipping]:
        signs = [s for s in self.states if s != 0]
        misfit = slip_misfit(
            self.drive,
            trial.slips,
            signs,
            self.friction,
            [lambda points: self._others(trial, points, full)],
        )
        return [Slipping(a, s, e) for a, s, e in zip(trial.slips, signs, misfit, strict=True)]

    def _boundary_errors(self, trial: _Trial, errors: Array) -> tuple[tuple[float, float], ...]:
        """Return what errors of the conditions move the boundaries by."""
        counts = self._panel_counts
        self._panel_counts = self._coarse_counts
        base = self._trial(self.coarse, self.logits, _COARSE).mismatch
        jacobian = self._differences(self.coarse, self.logits, base, _COARSE)
        self._panel_counts = counts
        # the conditions themselves hold to rounding and to the source quadrature
        errors = errors + 20.0 * ROUNDING + 1e-5 * self.tolerance
        shift = np.abs(np.linalg.inv(jacobian)) @ errors
        return tuple(
            (float(d * r.rest) / 2.0 + ROUNDING, float(d * r.square) + ROUNDING)
            for d, r in zip(shift, trial.radii, strict=True)
        )


def _scaled_solve(matrix: Array, vector: Array) -> Array:
    """Solve with rows and columns scaled by the diagonal, whose entries span many decades."""
    scale = 1.0 / np.sqrt(np.abs(matrix.diagonal()))
    return np.asarray(scale * np.linalg.solve(matrix * scale * scale[:, None], vector * scale))


def solve_zones(
    drive: Drive,
    beta: float,
    friction: float,
    layout: Layout,
    tolerance: float,
    max_unknowns: int,
) -> Refinement[ZonesSolution]:
    """Solve partial slip with the zones of a layout, for kappa = 1.

    Parameters
    ----------
    drive : Drive
    beta, friction : float
        ``beta*`` > 0 and ``f / kappa``.
    layout : Layout
        First guess of the boundaries, and the states.
    tolerance : float
        Bound on the relative error of q/s.
    max_unknowns : int
    """
    problem = _ZonesProblem(drive, beta, friction, layout, tolerance)
    return refine(problem, tolerance, max_unknowns)
