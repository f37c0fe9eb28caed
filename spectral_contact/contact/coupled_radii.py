"""Stick radii of a coupled contact at which the traction is continuous: there may be several.

With elastic coupling it is not proved that one stick radius alone satisfies all conditions. Here
the boundary residual of one stick disk is scanned over many radii, in small spaces. A logit is
``ln(c**2/(1 - c**2))`` of the stick radius c.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import pairwise, takewhile
from math import inf, log
from typing import TYPE_CHECKING

import numpy as np

from spectral_contact.contact.friction_law import DISTANCES, stick_violation
from spectral_contact.contact.resolution import (
    CUBIC_TAIL_DEPTH,
    EPSILON_DEPTH,
)
from spectral_contact.contact.tuning import COARSE_TOL
from spectral_contact.contact.zone_fields import all_positive

if TYPE_CHECKING:
    from spectral_contact.contact.free_boundary import FieldSolution
    from spectral_contact.contact.zone_problem import FreeBoundaryProblem


@dataclass(frozen=True, slots=True)
class PossibleRadius:
    """A radius at which the traction is continuous, to the accuracy of a small space.

    Attributes
    ----------
    logit : float
    positive : bool
        Whether the pressure is positive everywhere.
    excess : float
        The largest ``|q|/(f p) - 1`` in stick, or 0.
    """

    logit: float
    positive: bool
    excess: float

    @property
    def possible(self) -> bool:
        """Whether it may be a contact: the law holds in stick to what the small space resolves.

        The sense of the slip is not verified.
        """
        return self.positive and self.excess <= COARSE_TOL


def stick_radii(
    problem: FreeBoundaryProblem, logits: Iterable[float], *, contacts: bool = False
) -> Iterator[PossibleRadius]:
    """Yield the radii at which the traction is continuous, between the first and the last of some.

    Parameters
    ----------
    problem : FreeBoundaryProblem
        One stick disk.
    logits : iterable of float
        So close to each other that the boundary residual changes its sign at most once between two.
    contacts : bool
        Whether the scan ends at the first logit at which the pressure is not positive.
    """
    from scipy.optimize import brentq

    def residual(logit: float) -> float:
        return float(problem.coarse_solution(logit).boundary_residual[0])

    def continues(trial: tuple[float, FieldSolution]) -> bool:
        solution = trial[1]
        return not contacts or all_positive(solution.system.series(solution.values)[0])

    trials = takewhile(continues, ((logit, problem.coarse_solution(logit)) for logit in logits))
    for (low, low_solution), (high, high_solution) in pairwise(trials):
        low_residual = low_solution.boundary_residual[0]
        high_residual = high_solution.boundary_residual[0]
        if (low_residual > 0.0) != (high_residual > 0.0):
            root = float(brentq(residual, low, high, xtol=COARSE_TOL))
            yield _assessed(root, problem.coarse_solution(root))


def scan_logits(problem: FreeBoundaryProblem, first: float, step: float) -> list[float]:
    """Return the logits of a scan: from a first one to where all slip is deep within the layers."""
    layers = min(problem.parameters.alpha, problem.parameters.beta)
    last = EPSILON_DEPTH
    if layers > 0.0:
        last = min(last, CUBIC_TAIL_DEPTH - log(layers))
    return list(np.arange(first, max(last, first + step) + step, step).tolist())


def _assessed(logit: float, solution: FieldSolution) -> PossibleRadius:
    """Return whether the fields at a stick radius obey the law in stick."""
    system = solution.system
    pressures, shears = system.series(solution.values)
    if not all_positive(pressures):
        return PossibleRadius(logit, False, inf)
    radii = system.radii[0].value * np.sqrt(1.0 - DISTANCES)
    q = radii * shears[0](DISTANCES)
    excess = stick_violation(system.parameters.friction, [(q, pressures[0](DISTANCES))])
    return PossibleRadius(logit, True, excess)
