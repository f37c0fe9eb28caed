"""Full stick, equation (4.2): ``beta q + T q = kappa g`` on the whole contact.

Everything is computed for kappa = 1; the traction is proportional to it.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, log, nan, pi

import numpy as np
from numpy.typing import NDArray

from spectral_contact.contact.drive import Drive
from spectral_contact.contact.ratio import AT_ONE_PLACE, largest_ratio
from spectral_contact.contact.refine import Attempt, Refinement, Resolution, refine
from spectral_contact.contact.resolution import (
    ROUNDING,
    SAFETY,
    TRACTION_ROUNDING,
    decay_rates,
    expected_error,
    functional_error,
    interpolate,
    on_mesh,
    panel_of,
    panel_table,
    series_of,
    share_of_change,
    starting_resolution,
)
from spectral_contact.fields.series import EDGE, DiskSeries, EdgeWeight
from spectral_contact.spectral.galerkin import disk_operators
from spectral_contact.spectral.panels import LogPanels

__all__ = ["FullStick", "solve_full_stick"]

Array = NDArray[np.float64]

_ROUNDING = 20.0 * ROUNDING
#: What the ratios of traction to pressure are called in `FullStick`.
_RATIOS = ("edge_ratio", "critical", "critical_at", "edge_error", "critical_error")


@dataclass(frozen=True, slots=True)
class FullStick:
    """Solution of the full-stick problem for kappa = 1.

    Attributes
    ----------
    compliance : float
        ``beta*``.
    traction : DiskSeries
        ``q*/kappa``.
    total_shear : float
        ``Q*/kappa``.
    edge_ratio : float
        ``q/(kappa p)`` at the edge.
    critical : float
        The largest ``|q|/(kappa p)`` on the contact.
    critical_at : float
        ``y = 1 - s**2`` where it is reached.
    traction_error, shear_error : float
        Estimates of relative errors; of the traction, of q/s pointwise.
    edge_error, critical_error : float
        Estimates of the relative errors of the two ratios.
    """

    compliance: float
    traction: DiskSeries
    total_shear: float
    edge_ratio: float
    critical: float
    critical_at: float
    traction_error: float
    shear_error: float
    edge_error: float
    critical_error: float


class _StickProblem:
    """Spaces for the full-stick problem; see `solve_full_stick`."""

    def __init__(
        self, drive: Drive, compliance: float, tolerance: float, goal: str, ratios: bool
    ) -> None:
        self.drive, self.ratios = drive, ratios
        self.compliance = compliance
        self.tolerance = tolerance
        self.pointwise = goal == "traction"
        alpha = drive.contact.compliance
        # without tangential compliance the edge singularity y**(-1/2) is in the basis
        self.power = -0.5 if compliance == 0.0 else 0.0
        self.layer = -log(min([1.0] + [c for c in (alpha, compliance) if c > 0.0]))
        # on a smooth surface in normal contact g has a square root at the edge
        self.rate = 0.5 if alpha == 0.0 else 1.0

    def start(self) -> Resolution:
        space = starting_resolution(self.layer, self.tolerance, rate=self.rate, power=self.power)
        return on_mesh(space, self.drive.contact.panels)

    def attempt(self, resolution: Resolution) -> Attempt[FullStick]:
        panels, compliance = resolution.panels, self.compliance
        disk = disk_operators(panels)
        space = disk.tangential.space(resolution.degrees)
        # not interpolated: its rounding, the same over a panel, would show in q/s at the centre
        target = self.drive.target(disk.nodes.d)
        factored = space.factor(compliance)
        solution = factored.solve(target)
        change = factored.change(solution)
        series = series_of(panels, solution)
        traction = DiskSeries(EDGE, series)
        shear = float(space.shear_moments @ solution)
        rates = decay_rates(resolution, solution)
        normal = self.drive.contact
        # the change that the pressure's last degrees make
        moved, swayed = np.zeros_like(solution), np.zeros(1)
        moments = space.shear_moments
        if self.drive.changes:

            def lost_targets(d: Array) -> Array:
                return Drive.targets(self.drive.changes, d).T

            both = factored.solve(interpolate(panels, lost_targets)[0], correct=False)
            moved, swayed = np.ascontiguousarray(both[:, 0]), moments @ both
        size = series.at_ends()
        shares = expected_error(share_of_change(panels, change.coefficients, size), rates)
        propagated = SAFETY * normal.rate**2
        # under a pressure that is infinite at the edge q/s at the centre is off by up to 2.5e-13
        centre = 5.0 if normal.compliance == 0.0 else 1.0
        traction_error = float(shares.max()) + centre * TRACTION_ROUNDING
        traction_error += propagated * float(share_of_change(panels, moved, size).max())
        shear_error = functional_error(factored, moments, change, rates, resolution) / shear
        shear_error += propagated * float(np.abs(swayed).max()) / shear + 4.0 * ROUNDING
        if self.pointwise:
            indicators, error = shares, traction_error
        else:
            moved_by = np.abs(panel_table(panels, moments * change.coefficients)).sum(axis=1)
            indicators, error = expected_error(moved_by / shear, rates), shear_error
        ratios = dict.fromkeys(_RATIOS, nan)
        if self.ratios:
            at_edge = 0.0
            if self.power == 0.0:
                lesser = factored.change(solution, degrees=1)
                limits = [series_of(panels, one.coefficients).limit for one in (change, lesser)]
                at_edge = max(map(abs, limits)) / abs(series.limit)
            parts = [(panels, shares), (panels, propagated * share_of_change(panels, moved, size))]
            ratios = self._ratios(panels, traction, at_edge, parts)
        stick = FullStick(
            compliance,
            traction,
            shear,
            traction_error=traction_error,
            shear_error=shear_error,
            **ratios,
        )
        return Attempt(stick, error, indicators, rates, space.unknowns)

    def _ratios(
        self,
        panels: LogPanels,
        traction: DiskSeries,
        at_edge: float,
        parts: list[tuple[LogPanels, Array]],
    ) -> dict[str, float]:
        """Return q/p at the edge, its largest modulus, and their errors.

        `at_edge` is the share of the traction's change there, `parts` are those on the panels.
        """
        pressure, normal = self.drive.pressure, self.drive.contact
        edge, critical, where = largest_ratio(pressure, traction, panels.panels * panels.width)
        if normal.panels is not None and normal.change is not None:
            lost = normal.change.coefficients
            share = share_of_change(normal.panels, lost, pressure.at_ends())
            parts = [*parts, (normal.panels, SAFETY * normal.rate**2 * share)]
            at_edge += abs(series_of(normal.panels, lost).limit / pressure.value(0.0))

        def error(y: float) -> float:
            """Estimate the error of q/p at one place: what its panels contribute."""
            places = AT_ONE_PLACE * sum(float(s[panel_of(p, y)]) for p, s in parts)
            # the tail sheds one function of few: at the edge the change is as large as the error
            return _ROUNDING + places + (at_edge if y == 0.0 else 0.0)

        edge_error = error(0.0) if 0.0 < edge < inf else _ROUNDING
        critical_error = error(where) if critical < inf else _ROUNDING
        return dict(zip(_RATIOS, (edge, critical, where, edge_error, critical_error), strict=True))


def solve_full_stick(
    drive: Drive,
    compliance: float,
    tolerance: float,
    max_unknowns: int,
    *,
    goal: str = "traction",
    ratios: bool = True,
) -> FullStick | Refinement[FullStick]:
    """Solve the full-stick problem for kappa = 1.

    Parameters
    ----------
    drive : Drive
        Right-hand side, from the normal problem.
    compliance : float
        ``beta*``, 0 or positive.
    tolerance : float
        Bound on the relative error of the goal.
    max_unknowns : int
        Most unknowns of a space.
    goal : {"traction", "shear"}
        The pointwise traction, or the total shear alone.
    ratios : bool
        Whether the ratios of traction to pressure are wanted; else they and their errors are nan.

    Returns
    -------
    FullStick or Refinement
        On a surface smooth in both directions the weight ``-ln(y) / (s^2 sqrt y)`` is the exact
        solution and there is nothing to refine.
    """
    if compliance == 0.0 and drive.contact.compliance == 0.0:
        traction = DiskSeries(EDGE, None, EdgeWeight(1.0 / pi**2, 0.0, logarithmic=True))
        shear = _smooth_shear(drive)
        error = 4.0 * ROUNDING
        return FullStick(0.0, traction, shear, inf, inf, 0.0, error, error, error, error)
    return refine(
        _StickProblem(drive, compliance, tolerance, goal, ratios), tolerance, max_unknowns
    )


def _smooth_shear(drive: Drive) -> float:
    """Return ``2 pi int t R dt``: at zero tangential compliance the half-integral is R itself."""
    disk = disk_operators(starting_resolution(0.0, 1e-16).panels)
    t = np.sqrt(disk.nodes.rest)
    return 2.0 * pi * float((disk.nodes.weights * t) @ drive.target(disk.nodes.d))
