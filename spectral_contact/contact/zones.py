r"""Partial slip on any set of annuli: the boundaries are solved for, panels graded to each.

The boundaries are the roots of the rim balance and of ``q = f p`` at every other end of a stick
zone; `zone_system` solves for the tractions between them.
"""

from __future__ import annotations

from collections.abc import Callable
from copy import copy
from dataclasses import dataclass, replace
from math import ceil, inf, pi, sqrt

import numpy as np
from numpy.typing import NDArray

from spectral_contact.contact.boundaries import (
    Boundaries,
    differences,
    find_boundaries,
    zones_error,
)
from spectral_contact.contact.drive import Drive
from spectral_contact.contact.layout import Layout, ZonesSpace
from spectral_contact.contact.refine import Attempt, Refinement, Resolution, refine
from spectral_contact.contact.resolution import (
    LEAST_RATE,
    ROUNDING,
    SAFETY,
    TRACTION_ROUNDING,
    boundary_error,
    decay_rates,
    expected_error,
    series_of,
    share_of_change,
    table_rates,
)
from spectral_contact.contact.rim import disk_resolution
from spectral_contact.contact.slip_displacement import (
    Slipping,
    Stuck,
    largest_displacement,
    slip_misfit,
)
from spectral_contact.contact.zone_system import ZoneSystem, ZoneTractions
from spectral_contact.fields.series import CENTRE, EDGE, AnnulusSeries, DiskSeries, Radius
from spectral_contact.spectral.annulus import gap

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
    layout : Layout
        The zones, for a like scene.
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
    layout: Layout

    @property
    def bounds(self) -> tuple[Radius, ...]:
        """Ends of the zones, from the centre to the edge."""
        return CENTRE, *self.radii, EDGE

    @property
    def zones_error(self) -> float:
        """The largest of the boundaries' errors; infinite if a zone may not be there."""
        return zones_error(self.radii, self.boundary_errors)

    @property
    def loose_ends(self) -> float:
        """What the errors of its ends make of slip in a narrow zone, relative to the largest.

        Next to an end slip goes like the distance to the power 3/2.
        """
        ends = zip(self.radii, self.boundary_errors, strict=True)
        shifts = [0.0, *(2.0 * r.square * e[0] for r, e in ends), 0.0]
        loosest = 0.0
        for i in np.flatnonzero(self.states).tolist():
            width = gap(*self.bounds[i : i + 2])
            loosest = max(loosest, (shifts[i] + shifts[i + 1]) / width if width > 0.0 else inf)
        return 10.0 * loosest * sqrt(loosest)


#: What the estimates of one disk are multiplied by, and what functionals have of the square of the
#: error at least: over 10,000 random scenes that is 1.3 and 1.4 times what is needed.
_ANNULI, _SQUARED = 1.5, 50.0
#: Accuracy of the space in which the boundaries are found first, and their sensitivity.
_COARSE = 1e-4
#: Indicators may be so much of the tolerance in a space that is handed on, where they say enough.
_SPARE, _LOOSEST = 0.02, 1e-5
#: How near boundaries get to the root of their conditions, and how near those of a like scene
#: must, of the tolerance: what is left is taken from the slopes.
_SETTLED, _ENOUGH = 1e-13, 0.1
#: How far boundaries may move, of the narrowest zone, before their sensitivity is found anew.
_STALE = 0.3


class _ZonesProblem:
    """Spaces for given states of the zones; the boundaries are found anew in each of them."""

    def __init__(
        self,
        drive: Drive,
        beta: float,
        friction: float,
        layout: Layout,
        tolerance: float,
        goal: float | None,
    ) -> None:
        self.system = ZoneSystem(drive, beta, friction, layout.states)
        self.tolerance = tolerance
        # what bounds q/s is calibrated in spaces that are larger than they need be
        self.kept = None if goal is None else layout.space
        self.quadrature = min(0.01 * tolerance, 1e-11)
        self.logits = np.array(layout.logits)
        self.displacement = self.quadrature if goal is None else 0.01 * tolerance
        self.near, self.enough = layout.slopes is not None, _SETTLED
        if layout.slopes is None:
            self.slopes = self._differences()
            self._find(self._resolution(_COARSE), _COARSE, 1e-7, 1e-9)
        else:
            self.enough = max(_ENOUGH * (goal or 0.0), _SETTLED)
            self.slopes, self.slopes_at = layout.slopes, np.array(layout.slopes_at)
            moved = float(np.abs(self.logits - self.slopes_at).max())
            if moved <= _STALE * min(1.0, *np.diff(self.logits)):
                return
        self.slopes, self.slopes_at = self._differences(), self.logits

    # spaces

    def _resolution(self, tolerance: float) -> Resolution:
        """Return the first space: the disk's panels, then those of the stick annuli."""
        radii = self._radii(self.logits)
        alpha, beta = self.system.alpha, self.system.beta
        slipping = gap(*radii[:2])
        disk = disk_resolution(radii[0], alpha, beta, tolerance, slipping=slipping)
        degrees = list(disk.degrees)
        zones = [
            self.system.annulus(radii[k - 1], self.system.outer(radii, k), 0, tolerance)
            for k in self.system.stick_annuli()
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
        own, kept = self._resolution(self.tolerance), self.kept
        if kept is not None:
            panels = replace(kept.resolution.panels, degree=own.panels.degree)
            known = kept.tolerance, kept.counts, panels
            if known == (self.tolerance, tuple(self._panel_counts), own.panels):
                return kept.resolution
            self.kept = None
        return own

    def _leaner(self, resolution: Resolution, indicators: Array, rates: Array) -> ZonesSpace:
        """Return the space without the degrees that a first one has too many."""
        if self.kept is None:
            aim = _SPARE * min(self.tolerance, _LOOSEST)
            spare = np.log(np.maximum(aim / indicators, 1.0)) / -np.log(rates)
            degrees = np.array(resolution.degrees)
            least = np.minimum(degrees, np.maximum(3, (degrees + 1) // 2))
            degrees = np.maximum(degrees - np.floor(spare).astype(int), least)
            capacity = 4 * ceil((int(degrees.max()) + 1) / 4)
            panels = replace(resolution.panels, degree=min(capacity, resolution.panels.degree))
            resolution = Resolution(panels, tuple(degrees.tolist()))
        return ZonesSpace(self.tolerance, tuple(self._panel_counts), resolution)

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

    @staticmethod
    def _radii(logits: Array) -> tuple[Radius, ...]:
        return tuple(Radius.from_logit(float(x)) for x in logits)

    def _at(self, resolution: Resolution, quadrature: float) -> Callable[[Array], ZoneTractions]:
        """Return what solves with given boundaries."""
        disk, degrees = self._split(resolution)

        def trial_at(logits: Array) -> ZoneTractions:
            return self.system.solve(self._radii(logits), disk, degrees, quadrature)

        return trial_at

    def _conditions(self, trial: ZoneTractions) -> Array:
        """Return what should vanish, and the shear."""
        return np.append(trial.mismatch, self._shear(trial).sum())

    def _differences(self) -> Array:
        """Return the slopes of the conditions in the space in which they are found first."""
        trial_at = self._at(self._resolution(_COARSE), _COARSE)
        return differences(lambda logits: self._conditions(trial_at(logits)), self.logits)

    def _find(
        self, resolution: Resolution, quadrature: float, settle: float, enough: float
    ) -> Boundaries[ZoneTractions]:
        """Find the boundaries in a space."""
        found = find_boundaries(
            self._at(resolution, quadrature),
            self._conditions,
            self.logits,
            self.slopes,
            settle,
            enough,
            near=self.near,
        )
        self.logits = found.logits
        return found

    # outcome

    def attempt(self, resolution: Resolution) -> Attempt[ZonesSolution]:
        found = self._find(resolution, self.quadrature, 1e-11, self.enough)
        if self.near:  # else they are those of differences, here
            self.slopes = found.slopes
            if found.known:
                self.slopes_at = found.logits + found.left
        return self._assess(resolution, found)

    def _assess(
        self, resolution: Resolution, found: Boundaries[ZoneTractions]
    ) -> Attempt[ZonesSolution]:
        """Turn the final trial into a solution; the next coarser one shows its errors."""
        trial = found.trial
        disk_space, degrees = self._split(resolution)
        panels, rim = disk_space.panels, trial.radii[0]
        series = series_of(panels, trial.disk)
        problem = self._of_coarser_pressure()
        coarse = problem._coarser(resolution)
        full, full_coarse = (t.sticks.full(t.outer) for t in (trial, coarse))
        rates = [decay_rates(disk_space, trial.disk)]
        shares = [share_of_change(panels, trial.disk - coarse.disk, series.at_ends())]
        flat = [d for pair in degrees for d in pair]
        halves, beyond = [], 0.0
        for (family, part), degree in zip(trial.sticks.parts(), flat, strict=True):
            table = family.table(full[part])
            moved = np.abs(table - family.table(full_coarse[part])).sum(axis=1)
            shares.append(moved / np.abs(table[:, 0]))
            # the tail has no degree to shed: of d ln d it leaves 1.5 times its last coefficient
            beyond = max(beyond, 3.0 * abs(float(full[part][-1] / table[-1, 0])))
            rates.append(table_rates(degree, table))
            halves.append(family.series(full[part]))
        fields = [
            AnnulusSeries(a.inner, a.outer, halves[2 * i], halves[2 * i + 1])
            for i, a in enumerate(trial.sticks.annuli)
        ]
        rate = np.concatenate(rates)
        indicators = _ANNULI * expected_error(np.concatenate(shares), rate)
        worst = 2.0 * SAFETY * max(float(rate[np.argmax(indicators)]), LEAST_RATE)
        error = max(float(indicators.max()), beyond) + TRACTION_ROUNDING
        error += float(np.abs(trial.mismatch).max())
        misfit, misfit_coarse = self._misfit(trial, full), self._misfit(coarse, full_coarse)
        lost = [a - b for a, b in zip(misfit, misfit_coarse, strict=True)]
        stray = self._largest_displacement(trial, self._stuck(trial, lost))
        parts = self._shear(trial)
        # the traction depends on what is left of the boundaries less than they do themselves
        logits = found.logits + found.left
        moved = float(found.slopes[-1] @ found.left)
        shear = float(parts.sum()) + moved
        # the changes of the zones may cancel by accident; in slip there is that of the load alone
        lost_parts = np.abs(parts - problem._shear(coarse))
        sticking = 1 + len(halves)
        propagated = SAFETY * self.system.drive.contact.rate**2
        shear_lost = worst * float(lost_parts[:sticking].sum())
        shear_lost += propagated * float(lost_parts[sticking:].sum()) + abs(moved)
        # what is lost may be small by accident, but hardly against the square of the error
        squared = _SQUARED * (float(indicators @ indicators) + beyond**2)
        value = ZonesSolution(
            self._radii(logits),
            self.system.states,
            DiskSeries(rim, series),
            tuple(fields),
            shear,
            self._stuck(trial, misfit),
            self._slipping(trial, full),
            panels.panels * panels.width,
            error,
            shear_lost / shear + squared + 0.1 * self.quadrature + 16.0 * ROUNDING,
            self._boundary_errors(
                trial, worst * np.abs(coarse.mismatch - trial.mismatch) + squared
            ),
            worst * stray,
            Layout(
                tuple(logits.tolist()),
                self.system.states,
                self.slopes,
                tuple(self.slopes_at.tolist()),
                found.good,
                self._leaner(resolution, indicators, rate),
            ),
        )
        unknowns = len(trial.outer) + len(trial.factored.scale)
        return Attempt(value, error, indicators, rate, unknowns)

    def _of_coarser_pressure(self) -> _ZonesProblem:
        """Return the problem that the pressure without its last change poses."""
        problem = copy(self)
        problem.system = replace(self.system, drive=self.system.drive.coarser)
        return problem

    def _coarser(self, resolution: Resolution) -> ZoneTractions:
        """Solve at the same boundaries with two degrees less everywhere."""
        degrees = tuple(n - 2 if n > 3 else max(n - 1, 1) for n in resolution.degrees)
        return self._at(replace(resolution, degrees=degrees), self.quadrature)(self.logits)

    def _misfit(self, trial: ZoneTractions, full: Array) -> list[Array]:
        """Return E at the disk nodes, then on the outer grid."""
        inner = trial.target - trial.factored.space.half_integral(trial.disk)
        outer = trial.sticks.extents * full[trial.sticks.columns]
        return [inner, *(p.target - p.half_integral_of(outer) for p in trial.grid)]

    def _shear(self, trial: ZoneTractions) -> Array:
        """Return ``2 pi int q s ds`` over every zone; a stick annulus has two halves."""
        shear = float(trial.factored.space.shear_moments @ trial.disk)
        moments = [trial.radii[0].square * shear / (2.0 * pi)]
        moments += (trial.sticks.moments() @ trial.outer).tolist()
        for k, state in enumerate(self.system.states):
            if state != 0:
                ends = (trial.radii[k - 1], self.system.outer(trial.radii, k))
                load = [float(self.system.drive.load_outside(np.array(r.rest))) for r in ends]
                moments.append(state * self.system.friction * (load[0] - load[1]))
        return np.array(moments) * (2.0 * pi)

    def _stuck(self, trial: ZoneTractions, misfit: list[Array]) -> list[Stuck]:
        disk = trial.factored.space.operator.disk
        stuck = [Stuck.disk(trial.radii[0], disk, misfit[0])]
        for k in self.system.stick_annuli():
            parts = tuple(
                (p.points, pi * p.weights * e)
                for p, e in zip(trial.grid, misfit[1:], strict=True)
                if p.zone == k
            )
            stuck.append(Stuck(self.system.outer(trial.radii, k), parts))
        return stuck

    def _largest_displacement(self, trial: ZoneTractions, stuck: list[Stuck]) -> float:
        """Return the largest displacement in the slip zones that E in the stick zones makes."""
        return max(
            largest_displacement(stuck, trial.radii[k - 1], self.system.outer(trial.radii, k))
            for k, state in enumerate(self.system.states)
            if state != 0
        )

    def _slipping(self, trial: ZoneTractions, full: Array) -> list[Slipping]:
        signs = [s for s in self.system.states if s != 0]
        slips = list(self.system.slip_annuli(trial.radii, self.displacement).values())
        misfit = slip_misfit(
            self.system.drive,
            slips,
            signs,
            self.system.friction,
            [trial.sticks.field_inside(full[trial.sticks.columns])],
        )
        return [Slipping(a, s, e) for a, s, e in zip(slips, signs, misfit, strict=True)]

    def _boundary_errors(
        self, trial: ZoneTractions, errors: Array
    ) -> tuple[tuple[float, float], ...]:
        """Return what errors of the conditions move the boundaries by."""
        # the conditions themselves hold to rounding and to the source quadrature
        errors = errors + 20.0 * ROUNDING + 1e-3 * self.quadrature + trial.unresolved
        shift = np.abs(np.linalg.inv(self.slopes[:-1])) @ (errors + 2.0 * np.abs(trial.mismatch))
        # slopes change within the width of a zone, that of a narrow one next to the onset of slip
        gaps = np.concatenate([[np.inf], np.diff(self.logits), [np.inf]])
        shift *= 1.0 + 8.0 * shift / np.minimum(gaps[1:], gaps[:-1])
        return tuple(boundary_error(float(d), r) for d, r in zip(shift, trial.radii, strict=True))


def solve_zones(
    drive: Drive,
    beta: float,
    friction: float,
    layout: Layout,
    tolerance: float,
    max_unknowns: int,
    goal: float | None = None,
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
    goal : float, optional
        What the relative error of the shear should be, where that of q/s need not be less than
        the tolerance.

    Raises
    ------
    NoBoundariesError
        If zones of a like scene do not fit.
    """
    problem = _ZonesProblem(drive, beta, friction, layout, tolerance, goal)
    return refine(problem, tolerance, max_unknowns)
