"""Partial slip with elastic coupling: one stick disk, and slip from its rim to the edge.

Pressure and traction are unknown together, so at every trial radius the whole system is solved. To
a radius belongs the friction that makes the traction continuous, (5.9): with any other both fields
are singular at the rim, or jump. Approach, shear and radius come out of it to as many digits as
elsewhere. The fields do not: next to the rim they are small differences, which the uncoupled
problem takes without subtraction and this one does not. They serve to check the friction law.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import exp, log, sqrt

import numpy as np
from numpy.typing import NDArray

from spectral_contact.adaptive import Resolution
from spectral_contact.contact.resolution import (
    ROUNDING,
    boundary_error,
    series_of,
    share_of_change,
    starting_resolution,
)
from spectral_contact.fields import EDGE, Radius
from spectral_contact.spectral.annulus import gap
from spectral_contact.spectral.sliding import Sliding, SlidingDisk

__all__ = ["CoupledSlip", "NoCoupledDiskError", "solve_coupled_slip"]

Array = NDArray[np.float64]

#: Rims are looked for between 1e-3 and 1 - 4e-7 of the radius.
_LEAST_LOGIT, _LARGEST_LOGIT = -14.0, 14.0
#: Tolerance of the spaces in which the radius is bracketed.
_ROUGH = 1e-3
#: Spaces that are compared, each for a tenth of the tolerance; the first is no tighter than this.
_LEVELS, _TIGHTEST = 3, 1e-11
#: How much of the distance of the first to the last of them is left at least.
_FALL = 0.1
#: Least depth in ``-ln d`` of the panels inside a rim with compliance, past its layers.
_AT_RIM = 32.0
#: Most steps to the friction of a radius, and to a radius.
_STEPS, _TRIALS = 6, 8
#: Relative change of the friction of a radius at which it is settled.
_SETTLED = 1e-11
#: Rounding error of the logit of a radius, measured.
_LOGIT_ROUNDING = 1e-13
#: Depth in ``-ln d`` down to which the friction law is checked, and what may be missed there.
_CHECKED, _ALLOWED = 12.0, 1e-6


class NoCoupledDiskError(ArithmeticError):
    """No radius in the range searched obeys the friction law; the text says what is amiss."""


@dataclass(frozen=True, slots=True)
class CoupledSlip:
    """Coupled partial slip for unit load.

    Attributes
    ----------
    radius : Radius
        ``c*``.
    approach, total_shear : float
        ``delta*`` and ``Q*``.
    unknowns : int
        Of the larger space.
    approach_error, shear_error : float
        Estimates of relative errors.
    radius_error, edge_error : float
        Of ``c`` and of ``1 - c``.
    """

    radius: Radius
    approach: float
    total_shear: float
    unknowns: int
    approach_error: float
    shear_error: float
    radius_error: float
    edge_error: float


@dataclass(frozen=True, slots=True)
class _Trial:
    """The contact at one radius, with the friction that belongs to it and how unsettled that is."""

    disk: SlidingDisk
    solution: Sliding
    friction: float
    unsettled: float


@dataclass(frozen=True, slots=True)
class _Root:
    """The contact at the radius of the scene, as a logit, and by how much that may be off."""

    trial: _Trial
    logit: float
    off: float


class _Problem:
    """One scene; solves it at any radius and in any space."""

    def __init__(self, alpha: float, beta: float, kappa: float, friction: float) -> None:
        self.alpha, self.beta, self.kappa, self.friction = alpha, beta, kappa, friction

    def trial(self, logit: float, tolerance: float, start: float) -> _Trial:
        """Solve at one radius, with the friction that belongs to it; `start` is about that."""
        radius = Radius.from_logit(logit)
        spaces = self._spaces(radius, tolerance)
        disk = SlidingDisk(
            radius,
            (spaces[0].panels, spaces[1].panels, spaces[2].panels),
            (spaces[0].degrees, spaces[1].degrees, spaces[2].degrees),
        )
        # the friction of this radius makes the traction continuous, to all digits by the last step
        size = self._size(disk)

        def at(friction: float) -> tuple[Sliding, float]:
            compliances = self.alpha, self.beta, self.kappa
            solution = disk.solve(*compliances, friction, size, tolerance)
            return solution, self._jump(disk, solution, friction)

        near, far = start, start * (1.0 + 1e-3)
        first, second = at(near), at(far)
        for step in range(_STEPS + 1):
            if first[1] == second[1]:
                raise NoCoupledDiskError("no friction makes the traction continuous")
            share = first[1] / (first[1] - second[1])
            place = near + share * (far - near)
            unsettled = abs(place / far - 1.0)
            if unsettled <= _SETTLED or step == _STEPS:
                break
            near, first, far, second = far, second, place, at(place)
        # the last step of the secant method wins as many digits as the one before it
        left = unsettled if unsettled > _SETTLED else 0.0
        return _Trial(disk, first[0].toward(second[0], share), place, left)

    def _jump(self, disk: SlidingDisk, solution: Sliding, friction: float) -> float:
        """Return ``q/f - p`` at the deepest place inside the rim."""
        own = disk.panels[0]
        d = np.array([exp(-(own.panels - 0.5) * own.width)])
        p, u = (series_of(own, one) for one in (solution.disk, solution.traction))
        return disk.radius.value * float(u(d)[0]) / friction - float(p(d)[0])

    def _layer(self, extent: float) -> float:
        """Return ``-ln`` of the thinnest layer at the rim, in units of an extent in ``s**2``."""
        widths = [c / extent for c in (self.alpha, self.beta) if c > 0.0]
        return -log(min([1.0, *widths]))

    def _spaces(self, radius: Radius, tolerance: float) -> tuple[Resolution, ...]:
        """Return the spaces on the disk, above its rim, and below the edge."""
        half = gap(radius, EDGE) / 2.0
        rate = 0.5 if self.beta == 0.0 else 1.0
        layer = max(self._layer(radius.square), -log(min(half / radius.square, 1.0)))
        if self.beta > 0.0:  # where the traction is seen to be continuous, up to d ln d
            layer += max(_AT_RIM + log(tolerance), 0.0)
        near = starting_resolution(layer, tolerance, rate=rate)
        above = starting_resolution(
            max(self._layer(half), -log(min(radius.square / half, 1.0))), tolerance, rate=rate
        )
        edge = starting_resolution(
            self._layer(half), tolerance, power=-0.5 if self.alpha == 0.0 else 0.0
        )
        return near, above, edge

    def _size(self, disk: SlidingDisk) -> Callable[[Array, Array, Array, Array], float]:
        own = disk.panels[0]

        def size(p: Array, u: Array, p_moved: Array, u_moved: Array) -> float:
            pairs = (p, p_moved), (u, u_moved)
            shares = (
                share_of_change(own, moved, series_of(own, one).at_ends()) for one, moved in pairs
            )
            return max(float(share.max()) for share in shares)

        return size

    def check(self, trial: _Trial) -> None:
        """Refuse a solution that breaks the friction law."""
        disk, found = trial.disk, trial.solution
        own, inner, outer = disk.panels
        d = np.exp(-np.linspace(0.02, _CHECKED, 200))
        q = disk.radius.value * np.sqrt(1.0 - d) * series_of(own, found.traction)(d)
        most = self.friction * series_of(own, found.disk)(d)
        if not (np.abs(q) <= most + _ALLOWED * np.abs(most)).all():
            raise NoCoupledDiskError("the traction in stick exceeds friction")
        pressures = series_of(inner, found.inner)(d), series_of(outer, found.outer)(d)
        if not min(float(p.min()) for p in pressures) > 0.0:
            raise NoCoupledDiskError("the pressure is negative in slip")
        moved = disk.displacement(found, self.beta, self.kappa, self.friction)
        slips = np.concatenate([one(d) for one in moved])
        if not float(slips.max()) <= _ALLOWED * float(np.abs(slips).max()):
            raise NoCoupledDiskError("the surface slips with the traction")

    def roughly(self, guess: float) -> float:
        """Return the radius roughly, as a logit."""
        frictions: list[float] = []

        def excess(logit: float) -> float:
            """Return by how much the friction of a radius exceeds that of the scene."""
            start = frictions[-1] if frictions else self.friction
            frictions.append(self.trial(logit, _ROUGH, start).friction)
            return frictions[-1] / self.friction - 1.0

        (a, fa), step = (guess, excess(guess)), 0.3
        direction = -1.0 if fa > 0.0 else 1.0  # more friction, more stick
        while True:
            b = a + direction * step
            if not _LEAST_LOGIT < b < _LARGEST_LOGIT:
                raise NoCoupledDiskError("no stick disk in the range searched")
            fb = excess(b)
            if fa * fb <= 0.0:
                break
            a, fa, step = b, fb, 1.5 * step
        for _ in range(20):
            place = b - fb * (b - a) / (fb - fa)
            value = excess(place)
            a, fa = (b, fb) if value * fb <= 0.0 else (a, 0.5 * fa)  # Illinois
            b, fb = place, value
            if abs(fb) < 10.0 * _ROUGH or abs(b - a) < _ROUGH:
                break
        return b

    def root(self, logit: float, tolerance: float) -> _Root:
        """Return the solution at the radius."""
        trial = self.trial(logit, tolerance, self.friction)
        before, place = logit, logit + 1e-3
        excess = trial.friction / self.friction - 1.0
        for _ in range(_TRIALS):
            last, trial = excess, self.trial(place, tolerance, self.friction)
            excess = trial.friction / self.friction - 1.0
            if excess == last:
                raise NoCoupledDiskError("the friction does not depend on the radius")
            slope = (place - before) / (excess - last)
            off = abs(slope) * (abs(excess) + trial.unsettled)
            if off < _LOGIT_ROUNDING * (1.0 + abs(place)) / 5.0:
                break
            found, before, place = place, place, place - slope * excess
            if place == before:
                break
        else:
            place = found
        return _Root(trial, place, off)


def solve_coupled_slip(
    alpha: float, beta: float, kappa: float, friction: float, guess: float, tolerance: float
) -> CoupledSlip:
    """Solve coupled partial slip with one stick disk.

    Parameters
    ----------
    alpha, beta : float
        ``alpha*`` and ``beta*``, 0 or positive.
    kappa, friction : float
        The coupling, positive, and Coulomb's coefficient.
    guess : float
        Stick radius to begin with, as a logit.
    tolerance : float
        Bound on the relative errors of approach and shear that is aimed at.

    Returns
    -------
    CoupledSlip
        The last of three solutions in growing spaces, each with a radius of its own; how far the
        others are from it is the estimate of its error.

    Raises
    ------
    NoCoupledDiskError
        If no radius makes the traction continuous, or the friction law is broken at the one that
        does: there are other zones.
    """
    problem = _Problem(alpha, beta, kappa, friction)
    logit = problem.roughly(guess)
    best: CoupledSlip | None = None
    # continuity at a rim with compliance is pointwise; all else errs by the square of the fields
    aim = max(tolerance if beta > 0.0 else sqrt(tolerance), _TIGHTEST)
    while True:
        found = []
        for level in range(_LEVELS):
            found.append(problem.root(logit, aim * 0.1**level))
            logit = found[-1].logit
        solved = _compared(found)
        if best is None or _worst(solved) < _worst(best):
            best = solved
        if _worst(best) <= tolerance or aim <= _TIGHTEST:
            break
        aim = max(0.1 * aim, _TIGHTEST)
    problem.check(found[-1].trial)
    return best


def _worst(solved: CoupledSlip) -> float:
    return max(solved.approach_error, solved.shear_error)


def _compared(found: list[_Root]) -> CoupledSlip:
    """Return the last of solutions in growing spaces, with its distance to the others as error."""
    fine = found[-1].trial
    radius, new = fine.disk.radius, fine.solution
    values = np.array([[s.approach, s.total_shear] for s in (one.trial.solution for one in found)])
    approach, shear = (_left(column / column[-1]) for column in values.T)
    off = max(one.off for one in found)
    shift = off + _left(np.array([one.logit for one in found]))
    return CoupledSlip(
        radius,
        new.approach,
        new.total_shear,
        fine.disk.unknowns,
        approach + off + 4.0 * ROUNDING,
        shear + off + 20.0 * ROUNDING,
        *boundary_error(shift + _LOGIT_ROUNDING, radius),
    )


def _left(values: Array) -> float:
    """Estimate the error of the last value: two may agree by accident, hardly all three."""
    before, last = np.abs(values[:-1] - values[-1])
    return float(max(last, _FALL * before))
