"""Whether another stick disk would do: with coupling it is not proved that there is one alone.

The condition of the radius is looked at in small spaces, over many radii.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import pairwise, takewhile
from math import inf, log
from typing import TYPE_CHECKING

import numpy as np

from spectral_contact.contact.friction_law import DISTANCES, stick_excess
from spectral_contact.contact.resolution import EPSILON_DEPTH
from spectral_contact.contact.tuning import PROBE_TOL
from spectral_contact.contact.zone_fields import positive

if TYPE_CHECKING:
    from spectral_contact.contact.free_boundary import FieldSolution
    from spectral_contact.contact.zone_problem import FreeBoundaryProblem

#: How far past the layers radii are looked at, as logits.
_PAST = 8.0
#: What a radius is told apart by, as a logit.
_NEAR = 0.02


@dataclass(frozen=True, slots=True)
class PossibleRadius:
    """A radius at which the traction is continuous, roughly.

    Attributes
    ----------
    logit : float
        ``ln(c**2/(1 - c**2))``.
    positive : bool
        Whether the pressure is, everywhere.
    excess : float
        The largest ``|q|/(f p) - 1`` in stick, or 0.
    """

    logit: float
    positive: bool
    excess: float

    @property
    def possible(self) -> bool:
        """Whether it may be a contact; the sense of its slip is not looked at."""
        return self.positive and self.excess <= PROBE_TOL  # no smaller one is told


def stick_radii(
    problem: FreeBoundaryProblem, logits: Iterable[float], *, contacts: bool = False
) -> Iterator[PossibleRadius]:
    """Yield the radii at which the traction is continuous, between the first and the last of some.

    These are so close to each other that the condition changes its sign once between two. If only
    contacts are wanted it stops where the pressure is no longer positive.
    """
    from scipy.optimize import brentq

    def condition(logit: float) -> float:
        return float(problem.coarse_solution(logit).boundary_residual[0])

    solved = ((one, problem.coarse_solution(one)) for one in logits)
    trials = takewhile(
        lambda pair: not contacts or positive(pair[1].system.series(pair[1].values)[0]), solved
    )
    for (low, first), (high, second) in pairwise(trials):
        if (first.boundary_residual[0] > 0.0) != (second.boundary_residual[0] > 0.0):
            root = float(brentq(condition, low, high, xtol=_NEAR))
            yield _described(root, problem.coarse_solution(root))


def scanned(problem: FreeBoundaryProblem, first: float, step: float) -> Iterator[float]:
    """Yield the logits of radii to look at: from a first one to where slip is in the layers."""
    layers = min(problem.parameters.alpha, problem.parameters.beta)
    last = min(EPSILON_DEPTH, _PAST - log(layers)) if layers > 0.0 else EPSILON_DEPTH
    yield from np.arange(first, max(last, first + step) + step, step).tolist()


def _described(logit: float, state: FieldSolution) -> PossibleRadius:
    """Return what the fields at a radius are like."""
    pressures, shears = state.system.series(state.values)
    if not positive(pressures):
        return PossibleRadius(logit, False, inf)
    q = state.system.radii[0].value * np.sqrt(1.0 - DISTANCES) * shears[0](DISTANCES)
    excess = stick_excess(state.system.parameters.friction, [(q, pressures[0](DISTANCES))])
    return PossibleRadius(logit, True, excess)
