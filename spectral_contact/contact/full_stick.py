"""Full stick, equation (4.2): ``beta q + T q = kappa g`` on the whole contact.

Everything is computed for kappa = 1; the traction is proportional to it.
"""

from __future__ import annotations

from math import inf, log, pi

import numpy as np

from spectral_contact.contact.drive import Drive
from spectral_contact.contact.ratio import FullStick
from spectral_contact.contact.refine import Attempt, Refinement, refine
from spectral_contact.contact.resolution import (
    CENTRE_ROUNDS,
    CLOSED_FORM_ROUNDING,
    SAFETY,
    TRACTION_ROUNDING,
    decay_rates,
    expected_error,
    functional_error,
    on_mesh,
    panel_table,
    series_of,
    share_of_change,
    starting_resolution,
)
from spectral_contact.fields.series import EDGE, DiskSeries, EdgeWeight
from spectral_contact.spectral.graded import graded_nodes
from spectral_contact.spectral.panels import Resolution
from spectral_contact.spectral.spaces import unit_space


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
        space = unit_space(panels, resolution.degrees, shear=True)
        # not interpolated: its rounding, the same over a panel, would show in q/s at the centre
        target = self.drive.target(space.y)
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
            nodes = graded_nodes(panels, resolution.degrees)
            lacking = Drive.targets(self.drive.changes, nodes.samples).T
            both = factored.solve(nodes.spread(lacking), correct=False)
            moved, swayed = np.ascontiguousarray(both[:, 0]), moments @ both
        size = series.at_ends()
        shares = expected_error(share_of_change(panels, change.coefficients, size), rates)
        propagated = SAFETY * normal.rate**2
        centre = CENTRE_ROUNDS if normal.compliance == 0.0 else 1.0
        traction_error = float(shares.max()) + centre * TRACTION_ROUNDING
        traction_error += propagated * float(share_of_change(panels, moved, size).max())
        shear_error = functional_error(factored, moments, change, rates, resolution) / shear
        shear_error += propagated * float(np.abs(swayed).max()) / shear + CLOSED_FORM_ROUNDING
        if self.pointwise:
            indicators, error = shares, traction_error
        else:
            moved_by = np.abs(panel_table(panels, moments * change.coefficients)).sum(axis=1)
            indicators, error = expected_error(moved_by / shear, rates), shear_error
        stick = FullStick(
            approach=normal.approach,
            total_shear=shear,
            approach_error=normal.approach_error,
            shear_error=shear_error,
            pressure=self.drive.pressure,
            traction=traction,
            pressure_error=normal.pressure_error,
            traction_error=traction_error,
        )
        if self.ratios:
            moving = propagated * share_of_change(panels, moved, size)
            changed = [(panels, shares), (panels, moving)]
            at_edge = 0.0
            if self.power == 0.0:
                lesser = factored.change(solution, degrees=1)
                limits = [series_of(panels, one.coefficients).limit for one in (change, lesser)]
                at_edge = max(map(abs, limits)) / abs(series.limit)
            if normal.panels is not None and normal.changes:
                lost, pressure = normal.changes[0].coefficients, self.drive.pressure
                share = share_of_change(normal.panels, lost, pressure.at_ends())
                changed.append((normal.panels, propagated * share))
                at_edge += abs(series_of(normal.panels, lost).limit / pressure.value(0.0))
            stick = stick.with_ratios(panels.panels * panels.width, changed, at_edge)
        return Attempt(stick, error, indicators, rates, space.unknowns)


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
        Whether the ratios of traction to pressure are wanted.

    Returns
    -------
    FullStick or Refinement
        On a surface smooth in both directions the weight ``-ln(y) / (s^2 sqrt y)`` is the exact
        solution and there is nothing to refine.
    """
    if compliance == 0.0 and drive.contact.compliance == 0.0:
        # at zero tangential compliance the half-integral is R itself: Q = 2 pi int t R dt
        space = starting_resolution(0.0, float(np.finfo(float).eps))
        nodes, contact = graded_nodes(space.panels, space.degrees), drive.contact
        return FullStick(
            approach=contact.approach,
            total_shear=pi * float(nodes.weights @ drive.target(nodes.d)),
            approach_error=contact.approach_error,
            shear_error=CLOSED_FORM_ROUNDING,
            pressure=drive.pressure,
            traction=DiskSeries(EDGE, None, EdgeWeight(1.0 / pi**2, 0.0, logarithmic=True)),
            edge_ratio=inf,
            pressure_error=contact.pressure_error,
            traction_error=CLOSED_FORM_ROUNDING,
        )
    return refine(
        _StickProblem(drive, compliance, tolerance, goal, ratios), tolerance, max_unknowns
    )
