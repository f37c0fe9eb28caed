r"""Elastic coupling with one central stick disk and slip from its rim to the edge.

Pressure and traction are unknown together. For a given radius the system is linear in the value
``m`` at the rim of what the half-integral of the traction lacks. Continuity, (5.9), gives the m
that the disk needs, and the radius is the root of ``kappa R(c) - f P(c) - m``: as without coupling,
see `one_disk`, and with the same differences, in which nothing cancels.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf

import numpy as np
from numpy.typing import NDArray

from spectral_contact.adaptive import Attempt, Refinement, Resolution, refine
from spectral_contact.contact.coupled_outcome import Solved
from spectral_contact.contact.coupled_parts import LEADING, joined, parted, rounding_depth
from spectral_contact.contact.coupled_spaces import first_spaces
from spectral_contact.contact.coupled_trial import CoupledTrial
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
)
from spectral_contact.contact.slip_displacement import Stuck, largest_displacement
from spectral_contact.contact.stick_radius import (
    LARGEST_LOGIT,
    LEAST_LOGIT,
    NoStickDiskError,
    root_near,
)
from spectral_contact.fields import EDGE, Radius
from spectral_contact.spectral.annulus import Points
from spectral_contact.spectral.parameters import Parameters
from spectral_contact.spectral.sliding import SlidingDisk
from spectral_contact.spectral.sliding_factor import SlidingFactored

__all__ = ["CoupledDisk", "CoupledDiskProblem", "solve_coupled_disk"]

Array = NDArray[np.float64]

#: Tolerance of the spaces in which the radius is bracketed, and how well it is known then.
_ROUGH, _SETTLED = 1e-2, 1e-3
#: A first guess of how fast the mismatch rises with the logit.
_SLOPE = 0.3
#: Most corrections, the share of its step that one leaves at least, and from which share on it is
#: the factor or rounding that is not good enough.
_CORRECTIONS, _LEFT, _SLOW = 10, 1e-2, 0.2
#: Compliances from which on corrections with factors in single precision are not more.
_SINGLE = 5e-7
#: A correction that is smaller and does not fall any more is rounding; with the factors of another
#: radius it may be these.
_ROUNDED = 3e-12, 1e-9
#: Radii tried in a space; how far the fields are corrected, over how far a radius may be off; and
#: the least step between radii that tells of the slope.
_RADII, _SHARE, _MEANT = 12, 0.1, 1e-8
#: Radii, as logits, at which thin layers do not tell whose factors they are corrected with.
_ALIKE = 1e-7
#: A step of the radius, as a logit, that is left out: its fields are not solved for again.
_UNFELT = 1e-13


@dataclass(frozen=True, slots=True)
class CoupledDisk(Solved):
    """Coupled partial slip with one stick disk, for unit load.

    Attributes
    ----------
    disk : SlidingDisk
        The operators.
    parts : tuple of ndarray
        Coefficients of p on the disk, above its rim and below the edge, and of q/s on the disk.
    change : tuple of ndarray
        What the top two degrees of every panel contribute to them.
    """

    disk: SlidingDisk
    parts: tuple[Array, Array, Array, Array]
    change: tuple[Array, Array, Array, Array]


class CoupledDiskProblem:
    """Spaces for the disk and the annulus; the radius is found anew in each of them.

    Parameters
    ----------
    parameters : Parameters
    tolerance : float
        Bound on the relative errors of both fields, pointwise.
    """

    def __init__(self, parameters: Parameters, tolerance: float) -> None:
        self.parameters, self.tolerance = parameters, tolerance
        #: what rounding left of a correction, and how far the radius may be off
        self._floor, self._reach = 0.0, _SETTLED

    def look_near(self, guess: float) -> None:
        """Find the radius roughly; it is guessed as ``ln(c**2/(1 - c**2))``."""

        def mismatch(logit: float) -> float:
            return self.rough(logit).mismatch

        self.logit, self.slope = root_near(mismatch, guess, _SLOPE, _SETTLED, 1.0)

    def rough(self, logit: float) -> CoupledTrial:
        """Return the contact with a given radius in a small space."""
        spaces = self._spaces(logit, _ROUGH)
        return self._trial(spaces, logit, 1e-2 * _ROUGH)

    # spaces

    def _spaces(self, logit: float, tolerance: float) -> tuple[Resolution, Resolution, Resolution]:
        alpha, beta, _, _ = self.parameters
        return first_spaces(alpha, beta, Radius.from_logit(logit), tolerance)

    def start(self) -> Resolution:
        """Return the first space: the panels of the disk, then those of the annulus."""
        spaces = self._spaces(self.logit, self.tolerance)
        self._counts = [one.panels.panels for one in spaces]
        return joined(spaces)

    # solutions

    def _trial(
        self,
        spaces: Sequence[Resolution],
        logit: float,
        aim: float,
        like: CoupledTrial | None = None,
    ) -> CoupledTrial:
        """Solve at one radius to an error; the factors of a like one serve as long as they do."""
        disk = SlidingDisk(
            Radius.from_logit(logit),
            (spaces[0].panels, spaces[1].panels, spaces[2].panels),
            (spaces[0].degrees, spaces[1].degrees, spaces[2].degrees),
            (self.parameters.alpha == 0.0, self.parameters.beta == 0.0),
        )
        if like is not None:
            aim = max(aim, 2.0 * self._floor)
            trial, settled = self._corrected(disk, like.factored, like.values, aim)
            if settled:
                return trial
        alpha, beta, _, _ = self.parameters
        thick = alpha >= _SINGLE and (beta == 0.0 or beta >= _SINGLE)
        for exact in (False, True) if thick else (True,):
            factored = SlidingFactored(disk, self.parameters, exact=exact)
            trial, settled = self._corrected(disk, factored, factored.start(), aim, size=1.0)
            if settled:
                break
        return trial

    def _corrected(
        self,
        disk: SlidingDisk,
        factored: SlidingFactored,
        values: Array,
        aim: float,
        size: float = 0.0,
    ) -> tuple[CoupledTrial, bool]:
        """Correct solutions from errors of a size; return whether what is left is as aimed."""
        own, slow = factored.disk is disk, 0
        for k in range(_CORRECTIONS):
            change = factored.correction(values, disk)
            values = values + change
            trial = CoupledTrial(disk, factored, values, 0.0)
            shares = self._shares(trial, trial.combined(change, trial.lift), trial.solution)
            before, size = size, max(float(one.max()) for one in shares)
            left = size * min(max(_LEFT, size / before if before else 1.0), 1.0)
            slow = slow + 1 if size > _SLOW * before > 0.0 else 0
            settled = left < aim or size < _ROUNDED[own]
            # the first steps with factors in single precision do not tell
            told = settled and (factored.exact or k > 2)
            if left < aim or slow > (0 if told else 1):
                break
        if settled and left >= aim:
            self._floor = left
        return CoupledTrial(disk, factored, values, left), settled or (own and factored.exact)

    def _shares(self, trial: CoupledTrial, change: Array, size: Array) -> list[Array]:
        """Return a change of p and of q/s on every panel, relative to their sizes there."""
        disk, shares = trial.disk, []
        extents = disk.radius.square, disk.half
        pairs = zip(disk.split(change), disk.split(size), strict=True)
        for k, (moved, values) in zip((0, 1, 2, 0), pairs, strict=True):
            panels = disk.panels[k]
            ends = series_of(panels, values).at_ends()
            leading = LEADING if panels.power else inf
            known = rounding_depth(disk.radius, extents[k]) if k < 2 else inf
            shares.append(share_of_change(panels, moved, ends, leading=leading, known=known))
        return shares

    def _root(self, spaces: Sequence[Resolution]) -> CoupledTrial:
        """Find the radius in given spaces; return the contact there.

        The fields are corrected at every radius as far as its error is worth.
        """
        aim = max(0.1 * self.tolerance**2, 25.0 * ROUNDING)
        logit, like, before, self._floor = self.logit, None, None, 0.0
        for _ in range(_RADII):
            trial = self._trial(spaces, logit, max(aim, _SHARE * self._reach), like)
            value = trial.mismatch
            if before is not None and abs(logit - before[0]) > _MEANT:
                self.slope = (value - before[1]) / (logit - before[0])
            before, self.logit = (logit, value), logit
            if self.slope == 0.0:  # the annulus is so narrow that its width makes no difference
                raise NoStickDiskError(at_centre=logit < 0.0)
            step = max(min(-value / self.slope, 2.0), -2.0)
            self.off = abs(step)
            if self.off <= _UNFELT and self._reach <= _UNFELT:
                break
            # a secant step errs by a share of itself that the slope is off by
            self._reach = max(self.off * min(1e-3, self._reach), _UNFELT)
            logit, like = logit + step, trial
            off = abs(logit - trial.factored.disk.radius.logit)
            if trial.factored.exact and self._reach < _ALIKE < off:
                like = None  # thin layers feel where the factors are from
            if not LEAST_LOGIT < logit < LARGEST_LOGIT:
                raise NoStickDiskError(at_centre=logit < 0.0)
        return trial

    def attempt(self, resolution: Resolution) -> Attempt[CoupledDisk]:
        """Solve in a space."""
        spaces = parted(resolution, self._counts, self.parameters.alpha)
        return self._assess(spaces, self._root(spaces))

    def _assess(self, spaces: Sequence[Resolution], trial: CoupledTrial) -> Attempt[CoupledDisk]:
        """Turn the final trial into a solution with its errors."""
        disk = trial.disk
        radius = disk.radius
        whole = trial.solution * trial.approach
        parts = disk.split(whole)
        changes = trial.factored.change(trial.values, disk)
        effects = [trial.moved(one) for one in changes]
        moved = [trial.approach * one for one, _, _ in effects]
        spaces = [*spaces, spaces[0]]
        rates = [decay_rates(space, part) for space, part in zip(spaces, parts, strict=True)]
        shares = self._shares(trial, moved[0], whole)
        expected = [expected_error(*pair) for pair in zip(shares, rates, strict=True)]
        worst = [float(one.max()) for one in expected]
        pressure_error = max(worst[:3]) + trial.left + 20.0 * ROUNDING
        traction_error = max(worst[1:]) + trial.left + TRACTION_ROUNDING
        error = max(pressure_error, traction_error)
        # what superconverges may change little by accident, but hardly against the square
        squared = error**2
        shear = trial.shear(whole)
        sheared = max(abs(trial.shear(one)) for one in moved) / shear
        noise = 40.0 * ROUNDING + 0.1 * self.tolerance**2 + trial.left * 1e-2
        kept = 2.0 * SAFETY * LEAST_RATE
        shift = kept * max(abs(mismatch) for _, mismatch, _ in effects)
        shift += squared + noise + trial.left
        shift = shift / abs(self.slope) + float(np.finfo(float).eps) * abs(self.logit) + self.off
        points = Points(radius, -radius.square * disk.nodes.d)
        weights = radius.value**3 * disk.node_weights * disk.nodes.rest
        whole_misfit = trial.lacking(whole, trial.approach)
        stuck, lost = (
            Stuck(radius, ((points, weights * one),))
            for one in (whole_misfit, trial.lacking(moved[0], 0.0))
        )
        radius_error, edge_error = boundary_error(shift, radius)
        *pressure, traction = (
            series_of(space.panels, part) for space, part in zip(spaces, parts, strict=True)
        )
        value = CoupledDisk(
            (radius,),
            (0, 1),
            trial.approach,
            shear,
            pressure,
            [traction, None, None],
            [stuck],
            max(abs(raised) for _, _, raised in effects) + squared + noise,
            sheared + squared + noise + 2.0 * shift**2 * radius.rest,
            pressure_error,
            traction_error,
            radius_error,
            max(radius_error, edge_error),
            SAFETY * largest_displacement([lost], radius, EDGE),
            disk,
            parts,
            disk.split(moved[0]),
        )
        indicators = np.concatenate([np.maximum(expected[0], expected[3]), *expected[1:3]])
        rate = np.concatenate([np.maximum(rates[0], rates[3]), *rates[1:3]])
        return Attempt(value, error, indicators, rate, disk.unknowns)


def solve_coupled_disk(
    parameters: Parameters,
    tolerance: float,
    max_unknowns: int,
    guess: float,
) -> Refinement[CoupledDisk]:
    """Solve coupled partial slip under the assumption of one central stick disk.

    Parameters
    ----------
    parameters : Parameters
    tolerance : float
        Bound on the relative errors of both fields, pointwise.
    max_unknowns : int
        Most unknowns of a space.
    guess : float
        First guess of ``ln(c**2/(1 - c**2))``.

    Returns
    -------
    Refinement
        Whether the assumption holds is for the caller to check.

    Raises
    ------
    NoStickDiskError
        If no radius makes the traction continuous.
    """
    problem = CoupledDiskProblem(parameters, tolerance)
    problem.look_near(guess)
    return refine(problem, tolerance, max_unknowns // 2)
