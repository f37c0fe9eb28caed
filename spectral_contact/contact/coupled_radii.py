"""Stick radii of a coupled contact at which the traction is continuous: there may be several.

With elastic coupling it is not proved that one stick radius alone satisfies all conditions. So the
boundary residual of one stick disk is scanned over many stick radii. It is the number that has to
be added to the tangential equation at the boundary for the traction to be continuous there: where
it is zero, the traction is continuous without it. The scan solves in spaces of low degree, at the
tolerance `COARSE_TOL`.

Radii are over the radius of the contact. The logit of a stick radius c is ``ln(c**2/(1 - c**2))``.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import pairwise, takewhile
from math import inf, log
from typing import TYPE_CHECKING

import numpy as np

from spectral_contact.contact.friction_law import stick_violation
from spectral_contact.contact.resolution import (
    CUBIC_TAIL_DEPTH,
    EPSILON_DEPTH,
)
from spectral_contact.contact.tuning import COARSE_TOL
from spectral_contact.contact.zone_fields import all_positive, fields_in_stick

if TYPE_CHECKING:
    from spectral_contact.contact.free_boundary import FieldSolution
    from spectral_contact.contact.zone_problem import FreeBoundaryProblem


@dataclass(frozen=True, slots=True)
class CandidateRadius:
    """A stick radius at which the traction is continuous, to `COARSE_TOL`.

    Attributes
    ----------
    logit : float
    excess : float
        The largest ``|q|/(f p) - 1`` in stick, or 0; infinite if the pressure is not positive
        everywhere.
    """

    logit: float
    excess: float

    @property
    def admissible(self) -> bool:
        """Whether pressure and traction obey the friction law in stick, to `COARSE_TOL`.

        Whether slip opposes the traction is not verified.
        """
        return self.excess <= COARSE_TOL


def stick_radii(
    problem: FreeBoundaryProblem, logits: Iterable[float], *, positive_only: bool = False
) -> Iterator[CandidateRadius]:
    """Yield the stick radii at which the traction is continuous, within the range of the scan.

    Parameters
    ----------
    problem : FreeBoundaryProblem
        The problem of one stick disk.
    logits : iterable of float
        Where the scan evaluates the boundary residual, so close to each other that it changes its
        sign at most once between two.
    positive_only : bool
        Whether the scan ends at the first logit at which the pressure is not positive.
    """
    from scipy.optimize import brentq

    def residual(logit: float) -> float:
        return float(problem.coarse_solution(logit).boundary_residual[0])

    def continues(trial: tuple[float, FieldSolution]) -> bool:
        solution = trial[1]
        return not positive_only or all_positive(solution.system.series(solution.values)[0])

    trials = takewhile(continues, ((logit, problem.coarse_solution(logit)) for logit in logits))
    for (left, left_solution), (right, right_solution) in pairwise(trials):
        left_residual = left_solution.boundary_residual[0]
        right_residual = right_solution.boundary_residual[0]
        if (left_residual > 0.0) != (right_residual > 0.0):
            root = float(brentq(residual, left, right, xtol=COARSE_TOL))
            yield CandidateRadius(root, _stick_excess(problem.coarse_solution(root)))


def scan_logits(problem: FreeBoundaryProblem, first: float, step: float) -> list[float]:
    """Return the logits of a scan, `step` apart.

    Next to the edge fields change over distances like the compliances alpha and beta (boundary
    layers). The scan ends where slip is narrower than both, or is lost in rounding.
    """
    layer_width = min(problem.parameters.alpha, problem.parameters.beta)
    last = EPSILON_DEPTH
    if layer_width > 0.0:
        last = min(last, CUBIC_TAIL_DEPTH - log(layer_width))
    return list(np.arange(first, max(last, first + step) + step, step).tolist())


def _stick_excess(solution: FieldSolution) -> float:
    """Return how far fields break the friction law in stick, see `CandidateRadius`."""
    system = solution.system
    pressures, shears = system.series(solution.values)
    if not all_positive(pressures):
        return inf
    fields = fields_in_stick(system, pressures, shears)
    return stick_violation(system.parameters.friction, fields)
