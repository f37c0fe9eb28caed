r"""Partial slip with one central stick disk, equation (5.8) for the total traction.

On the stick disk of radius c, with ``s = c sigma``, homogeneity gives the unit-disk equation with
compliance ``beta / c`` and, in the half-integral, the target

    R(c tau) - (f/kappa) int_c^1 p ds / sqrt(s^2 - c^2 tau^2).

The total traction is the unknown, not the corrective one of (5.4), which is not smooth at the
centre. Everything is for kappa = 1, so friction is ``f / kappa``.

The radius makes the traction continuous, (5.9). Near the rim the target is small against its two
parts, so it is split into its value at the rim, ``m``, and a rise that is computed without the
subtraction. For a given radius the equation is linear in ``m``: continuity gives the ``m`` that
the disk needs, and the radius is the root of ``R(c) - (f/kappa) P(c) - m``, which is as well
conditioned as the smooth limit, where ``m = 0``.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import log, log1p, pi, sqrt

import numpy as np

from spectral_contact.contact.drive import Drive
from spectral_contact.contact.layout import SolvedZones
from spectral_contact.contact.refine import Attempt, Refinement, refine
from spectral_contact.contact.resolution import (
    CENTRE_ROUNDS,
    CLOSED_FORM_ROUNDING,
    FIELD_ROUNDING,
    LEAST_RATE,
    PROBE,
    ROUGH,
    ROUNDING,
    SAFETY,
    TRACTION_ROUNDING,
    TRIFLING,
    boundary_error,
    decay_rates,
    expected_error,
    functional_error,
    on_mesh,
    series_of,
    share_of_change,
    starting_resolution,
)
from spectral_contact.contact.rim import SlipSource, rim_target
from spectral_contact.contact.slip_displacement import Stuck, largest_displacement
from spectral_contact.contact.stick_radius import (
    LARGEST_LOGIT,
    LEAST_LOGIT,
    NoStickDiskError,
    root_near,
    slope_at,
)
from spectral_contact.fields.series import EDGE, Array, DiskSeries, Radius
from spectral_contact.spectral.graded import graded_nodes
from spectral_contact.spectral.panels import Resolution
from spectral_contact.spectral.regularised import HARMLESS, Regularised
from spectral_contact.spectral.spaces import unit_space

#: Error of the radius, as a logit, from which finer spaces start; 1e-3 and 1e-8 do not change them.
_NEAR = 1e-5
#: Panels cancel in both changes of the pressure at times: of 2000 errors of a radius one was 4.5
#: times what the rate makes of the changes, and another 3.5 times.
_CANCELLING = 6.0


@dataclass(frozen=True, slots=True, kw_only=True)
class OneDisk(SolvedZones):
    """Partial slip with one stick disk, for kappa = 1.

    Attributes
    ----------
    traction : DiskSeries
        ``q*/kappa`` on the stick disk.
    friction : float
        ``f / kappa``.
    shift : float
        Estimate of the error of ``ln(c**2/(1 - c**2))``.
    """

    traction: DiskSeries
    friction: float
    shift: float


@dataclass(frozen=True, slots=True)
class _Trial:
    """The disk solved at one radius."""

    radius: Radius
    mismatch: float
    coefficients: Array
    response: Array | None
    factored: Regularised
    target: Array
    unit: float
    unresolved: float
    slipping: float


class OneDiskProblem:
    """Spaces for the stick disk; the radius is found anew in each of them."""

    logit: float
    slope: float

    def __init__(self, drive: Drive, beta: float, friction: float, tolerance: float) -> None:
        self.drive, self.beta, self.friction = drive, beta, friction
        self.tolerance, self.alpha = tolerance, drive.contact.compliance

    def rough_root(
        self, guess: float | None, near: tuple[float, float] | None
    ) -> tuple[float, float]:
        """Return the radius, if there is no guess of it, and the slope there."""
        if guess is not None:  # in a space that sees a narrow annulus
            space, least = self._resolution(guess, self.tolerance), TRIFLING * self.tolerance
            return guess, slope_at(lambda x: self._trial(space, x, least).mismatch, guess)
        if near is None or not LEAST_LOGIT < near[0] < LARGEST_LOGIT:
            near = self._asymptotic_root()
            if self.beta > 0.0:
                near = root_near(self._pressure_mismatch, *near, PROBE)
        mismatch = self._rough_mismatch if self.beta > 0.0 else self._pressure_mismatch
        return root_near(mismatch, *near, _NEAR)

    def _asymptotic_root(self) -> tuple[float, float]:
        """Return a guess of the radius from limits, and of the slope there."""
        friction = self.friction
        # on a smooth surface 1 - c falls like exp(-pi f/2), and c ~ 4 exp(-2/f) as f -> 0
        at_centre = 2.0 * log(2.0) - log1p(friction) - 2.0 / friction
        start = 0.5 * pi * friction + 2.0 * at_centre
        slope = min(1.0, 0.5 * friction) / (2.0 * pi)
        if self.alpha > 0.0:  # closer to the edge than alpha the pressure does not grow any more
            start = min(start, 2.0 - log(self.alpha))
        if self.beta > 0.0:  # c grows like 2 beta f/kappa at first
            start = max(start, 2.0 * log(2.0 * self.beta * friction))
        start = min(max(start, LEAST_LOGIT), LARGEST_LOGIT)
        if self.beta > 0.0:  # what a disk of great compliance needs falls like 1/c
            radius = Radius.from_logit(start)
            at_rim = self.drive.pressure.value(radius.rest)
            slope += 2.0 * friction * at_rim * self.beta / radius.value * radius.rest
        return start, slope

    def _pressure_mismatch(self, logit: float) -> float:
        """Return ``R(c) - (f/kappa) P(c) - m`` with the m that a disk needs, roughly.

        Without tangential compliance that is 0. A disk of great compliance takes 4 times the jump
        of its displacement; what is added for less is fitted.
        """
        radius = Radius.from_logit(logit)
        source = SlipSource([self.drive.pressure], radius, self.alpha, ROUGH, radius.rest)
        mismatch = self.drive.value(radius.rest)
        mismatch -= self.friction * float(source.at_rim[0])
        if self.beta > 0.0:
            soft = self.beta / radius.value
            more = 0.5 * log(1.0 + radius.rest / soft) / sqrt(radius.rest)
            at_rim = self.drive.pressure.value(radius.rest)
            mismatch -= self.friction * at_rim * soft * (4 + more)
        return mismatch

    def _rough_mismatch(self, logit: float) -> float:
        """Return the mismatch in a small space."""
        return self._trial(self._resolution(logit, ROUGH), logit, ROUGH).mismatch

    def _resolution(self, logit: float, tolerance: float) -> Resolution:
        """Return the first space: the layers are those of alpha, beta and the rim."""
        radius, beta = Radius.from_logit(logit), self.beta
        rim = max(self.alpha, radius.rest) / radius.square
        # without compliance the traction beyond the slip annulus is singular down to its width
        layer = (beta / radius.value) or radius.rest / radius.square
        bends = (1.0 - log(min(rim, 1.0)),)
        depth = -log(min(1.0, rim, layer))
        return starting_resolution(depth, tolerance, root_tail=beta == 0.0, bends=bends)

    def start(self) -> Resolution:
        """Return the first space to try."""
        space = self._resolution(self.logit, self.tolerance)
        return on_mesh(space, self.drive.contact.panels)

    def factored(self, resolution: Resolution, radius: Radius) -> Regularised:
        """Return the equation of a disk in a space, factored."""
        space = unit_space(resolution.panels, resolution.degrees, shear=True)
        return space.factor(self.beta / radius.value)

    def _trial(self, resolution: Resolution, logit: float, tolerance: float) -> _Trial:
        """Solve the disk of the given radius; the mismatch of the rim value decides."""
        radius = Radius.from_logit(logit)
        factored = self.factored(resolution, radius)
        return self.at([self.drive], resolution, radius, factored, tolerance, self.friction)[0]

    def at(
        self,
        drives: list[Drive],
        resolution: Resolution,
        radius: Radius,
        factored: Regularised,
        tolerance: float,
        friction: float | Array,
    ) -> list[_Trial]:
        """Solve for drives, which may be changes of one: all is linear in the pressure.

        Each may have a friction of its own.
        """
        panels, correct = resolution.panels, tolerance < ROUGH
        pressures = [drive.pressure for drive in drives]
        nodes = graded_nodes(panels, resolution.degrees)
        nearest = radius.square * float(nodes.samples[-1])
        source = SlipSource(pressures, radius, self.alpha, tolerance, nearest, nodes=nodes)
        keep = self.beta > 0.0
        balance, sampled = rim_target(drives, radius, friction, source, nodes.samples, keep=keep)
        values, unresolved = nodes.spread(sampled), nodes.unresolved(sampled)
        rim, unit, slipping, response = -balance, 0.0, friction * source.at_rim, None
        solved = factored.solve(values, correct=correct)
        if self.beta > 0.0:
            response = factored.solve(1.0, correct=correct)
            unit = series_of(panels, response).limit
            at_end = [pressure.value(radius.rest) for pressure in pressures]
            limits = [series_of(panels, column).limit for column in solved.T]
            rim = (friction * np.array(at_end) - limits) / unit
            solved = solved + response[:, None] * rim
            values = values + rim
        # rows are contiguous: what follows works on each of them by itself
        columns = zip(np.ascontiguousarray(solved.T), np.ascontiguousarray(values.T), strict=True)
        return [
            _Trial(radius, -m, c, response, factored, v, unit, unresolved, p)
            for (c, v), m, p in zip(columns, rim.tolist(), slipping.tolist(), strict=True)
        ]

    def attempt(self, resolution: Resolution) -> Attempt[OneDisk]:
        """Solve in a space."""
        # to rounding at any tolerance: noise in the target looks like detail, and digits are cheap
        trials: list[tuple[float, _Trial]] = []

        def mismatch(logit: float) -> float:
            trials.append((logit, self._trial(resolution, logit, ROUNDING)))
            return trials[-1][1].mismatch

        self.logit, self.slope = root_near(mismatch, self.logit, self.slope, known=ROUGH)
        (before, first), (last, second) = trials[-2:] if len(trials) > 1 else trials * 2
        step, lag = self.logit - last, self.logit - before
        if before != last and abs(step * lag) <= ROUNDING:
            # what is linear in the last two trials is right to the product of the steps
            ratio = step / (last - before)
            final = replace(
                second,
                radius=Radius.from_logit(self.logit),
                coefficients=second.coefficients
                + ratio * (second.coefficients - first.coefficients),
                target=second.target + ratio * (second.target - first.target),
            )
        else:
            final = self._trial(resolution, self.logit, ROUNDING)
        return self.assess(resolution, final)

    def assess(self, resolution: Resolution, trial: _Trial) -> Attempt[OneDisk]:
        """Turn the final trial into a solution with its errors."""
        panels, radius, coefficients = resolution.panels, trial.radius, trial.coefficients
        space, normal = trial.factored.space, self.drive.contact
        series = series_of(panels, coefficients)
        rates = decay_rates(resolution, coefficients)
        last = trial.factored.change(coefficients)
        change = last.coefficients
        continuous = change
        if trial.response is not None:  # the rim value follows; that there is taken by the radius
            limit = series_of(panels, change).limit
            continuous = change - limit / trial.unit * trial.response
        indicators = expected_error(share_of_change(panels, continuous, series.at_ends()), rates)
        own, propagated = float(rates[indicators.argmax()]), SAFETY * normal.rate**2
        # with little friction the target is a small difference, but rounds less at the centre
        at_rim = self.drive.value(radius.rest)
        cancelled = at_rim / float(np.abs(trial.target).max())
        # under little compliance the noise of the target is amplified at the centre
        stiff = self.beta < HARMLESS * radius.value
        rounding = (CENTRE_ROUNDS if stiff else 1.0) * TRACTION_ROUNDING
        error = float(indicators.max()) + max(rounding, 2.0 * ROUNDING * cancelled)
        outside = 2.0 * pi * self.friction * float(self.drive.load_outside(np.array(radius.rest)))
        shear = radius.square * float(space.shear_moments @ coefficients) + outside
        moments = space.shear_moments
        lost = functional_error(trial.factored, moments, last, rates, resolution)
        # a constant target has pi times it as its shear, or less: the compliance takes its share
        softened = max(1.0, self.beta / radius.value)
        lost = radius.square * (lost + pi * trial.unresolved / softened)
        # what moves the rim value moves the radius: the disk's own change, then the pressure's
        shift = stray = 0.0
        if trial.unit > 0.0:
            kept = 2.0 * SAFETY * max(own, LEAST_RATE)
            lesser = trial.factored.change(coefficients, degrees=1).coefficients
            limits = [abs(series_of(panels, one).limit) for one in (change, lesser)]
            shift = kept * max(limits) / abs(trial.unit)
        changes = self.drive.changes
        if changes:
            trials = self.at(changes, resolution, radius, trial.factored, ROUGH, self.friction)
            moved = trials[0]
            share = float(share_of_change(panels, moved.coefficients, series.at_ends()).max())
            error += propagated * share
            # of signed parts any one may be small by accident, hardly of both changes
            swayed, swept = [], []
            for drive, one in zip(changes, trials, strict=True):
                swayed.append(abs(one.mismatch) + abs(one.slipping))
                part = radius.square * float(moments @ one.coefficients)
                outside = float(drive.load_outside(np.array(radius.rest)))
                swept.append(abs(part) + 2.0 * pi * self.friction * abs(outside))
            # in the pressure's tail the error was up to twice the change
            deep = normal.panels is not None and radius.rest < normal.panels.end
            # the rate is that of the panel whose change is largest; those that matter have others
            settling = SAFETY * max(normal.rate, LEAST_RATE) ** 2
            shift += max(_CANCELLING * settling, SAFETY if deep else 0.0) * max(swayed)
            if deep and trial.unit > 0.0:
                # the change may vanish at the rim itself, what the tail lacks does not
                lacking = changes[0].pressure.series
                assert lacking is not None
                largest = float(np.abs(lacking.tail).sum())
                shift += SAFETY * self.friction * largest / trial.unit
            lost += settling * max(swept)
            strays = moved.target - space.half_integral(moved.coefficients)
            stray = propagated * float(np.abs(strays).max())
        # rounding, and what the quadrature of the source and interpolation of the target leave out
        shift += 2.0 * CLOSED_FORM_ROUNDING * at_rim + trial.unresolved
        shift = float(shift / abs(self.slope) + np.finfo(float).eps * abs(radius.logit))
        misfit = trial.target - space.half_integral(coefficients)
        nodes = graded_nodes(panels, resolution.degrees)
        lost_misfit = Stuck.disk(radius, nodes, space.half_integral(change))
        stray += SAFETY * own * largest_displacement([lost_misfit], radius, EDGE)
        radius_error, edge_error = boundary_error(shift, radius)
        value = OneDisk(
            radii=(radius,),
            states=(0, 1),
            approach=normal.approach,
            total_shear=shear,
            stuck=[Stuck.disk(radius, nodes, misfit)],
            approach_error=normal.approach_error,
            shear_error=lost / shear + 2.0 * shift**2 * radius.rest + FIELD_ROUNDING,
            pressure_error=normal.pressure_error,
            traction_error=error,
            radius_error=radius_error,
            zones_error=max(radius_error, edge_error),
            loose=edge_error,
            stray=stray,
            slopes=np.array([[self.slope]]),
            traction=DiskSeries(radius, series),
            friction=self.friction,
            shift=shift,
        )
        return Attempt(value, error, indicators, rates, space.unknowns)


def solve_one_disk(
    drive: Drive,
    beta: float,
    friction: float,
    tolerance: float,
    max_unknowns: int,
    *,
    guess: float | None = None,
    near: tuple[float, float] | None = None,
) -> Refinement[OneDisk]:
    """Solve partial slip under the assumption of one central stick disk, for kappa = 1.

    Parameters
    ----------
    drive : Drive
        Right-hand side, from the normal problem.
    beta : float
        ``beta*``, 0 or positive.
    friction : float
        ``f / kappa``, positive and below the critical value.
    tolerance : float
        Bound on the relative error of q/s, pointwise.
    max_unknowns : int
        Most unknowns of a space.
    guess : float, optional
        First guess of ``ln(c**2/(1 - c**2))``; by default it is searched for.
    near : tuple of float, optional
        Where a rough search begins, and the slope there, as a like scene has them.

    Returns
    -------
    Refinement
        Whether the assumption holds is for the caller to check.
    """
    if beta == 0.0 and friction > LARGEST_LOGIT:  # 1 - c falls like exp(-pi f/(2 kappa))
        raise NoStickDiskError(at_centre=False)
    problem = OneDiskProblem(drive, beta, friction, tolerance)
    problem.logit, problem.slope = problem.rough_root(guess, near)
    return refine(problem, tolerance, max_unknowns)
