"""Whether another stick disk would do: with coupling it is not proved that there is one alone.

The condition of the radius is looked at in small spaces, over many radii.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import inf

import numpy as np

from spectral_contact.contact.coupled_disk import CoupledDiskProblem
from spectral_contact.contact.coupled_trial import CoupledTrial
from spectral_contact.contact.resolution import series_of

__all__ = ["StickRadius", "stick_radii"]

#: Half the width, as a logit, of what a radius is told apart by.
_NEAR = 0.02
#: Depths ``-ln d`` at which fields are looked at, on each side of a boundary.
_DEPTHS = np.linspace(1e-3, 36.0, 300)
#: A small space does not tell a smaller violation of the friction law.
_UNSEEN = 1e-2


@dataclass(frozen=True, slots=True)
class StickRadius:
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
        return self.positive and self.excess <= _UNSEEN


def stick_radii(problem: CoupledDiskProblem, logits: Sequence[float]) -> list[StickRadius]:
    """Return the radii at which the traction is continuous, between the first and the last of some.

    Parameters
    ----------
    problem : CoupledDiskProblem
    logits : sequence of float
        Increasing, so close to each other that the condition changes its sign once between two.
    """
    trials = [(one, problem.rough(one).mismatch) for one in logits]
    found = []
    for (low, at_low), (high, at_high) in pairwise(trials):
        if (at_low > 0.0) == (at_high > 0.0):
            continue
        while high - low > 2.0 * _NEAR:
            middle = (low + high) / 2.0
            at_middle = problem.rough(middle).mismatch
            if (at_middle > 0.0) == (at_low > 0.0):
                low = middle
            else:
                high = middle
        middle = (low + high) / 2.0
        found.append(_described(float(middle), problem.rough(middle)))
    return found


def _described(logit: float, trial: CoupledTrial) -> StickRadius:
    """Return what the fields at a radius are like."""
    disk = trial.disk
    own, above, below, shear = disk.split(trial.solution)
    inside, _, _ = panels = disk.panels
    d = np.exp(-_DEPTHS)
    pressures = [
        series_of(p, values)(d) for p, values in zip(panels, (own, above, below), strict=True)
    ]
    if not min(float(one.min()) for one in pressures) > 0.0:
        return StickRadius(logit, False, inf)
    q = disk.radius.value * np.sqrt(1.0 - d) * np.abs(series_of(inside, shear)(d))
    ratio = float((q / (trial.friction * pressures[0])).max())
    return StickRadius(logit, True, max(ratio - 1.0, 0.0))
