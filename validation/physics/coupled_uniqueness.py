"""At how many stick radii coupled partial slip satisfies its condition, over random scenes.

With elastic coupling it is not proved that one stick radius alone satisfies all conditions. So the
boundary residual of one stick disk is scanned over many stick radii. It is the number that has to
be added to the tangential equation at the boundary for the traction to be continuous there: where
it is zero, the traction is continuous without it. The scan solves in spaces of low degree, at the
tolerance `COARSE_TOL`.

Radii are over the radius of the contact. The logit of a stick radius c is ``ln(c**2/(1 - c**2))``.

Run as ``python validation/physics/coupled_uniqueness.py [--scenes N]``; writes
validation/results/coupled_uniqueness.json and .md.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from common import options, table, write
from scipy.optimize import brentq

from spectral_contact import Scene, solve
from spectral_contact.contact.free_boundary import FieldSolution
from spectral_contact.contact.friction_law import stick_violation
from spectral_contact.contact.layout import Layout
from spectral_contact.contact.resolution import CUBIC_TAIL_DEPTH, EPSILON_DEPTH
from spectral_contact.contact.tuning import COARSE_TOL
from spectral_contact.contact.zone_fields import all_positive, fields_in_stick
from spectral_contact.contact.zone_problem import FreeBoundaryProblem
from spectral_contact.spectral.parameters import Parameters

SEED, COUNT = 30, 600
#: The first radius that is looked at, and how far the others are apart, as logits.
FIRST, STEP = -24.0, 1.0


@dataclass(frozen=True)
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


def draw(number: int) -> Scene:
    """Return a scene that slips somewhere; one of its three kinds is smooth or half so."""
    rng = np.random.default_rng([SEED, number])
    alpha, beta = (10.0 ** rng.uniform(-8.0, 1.0) for _ in range(2))
    kind = number % 5
    if kind == 0:
        alpha, beta = 0.0, 0.0
    elif kind == 1:
        beta = 0.0
    elif kind == 2:
        beta = alpha
    ratio = rng.uniform(-0.99, 0.45)
    full = Scene(ratio, alpha, beta, math.inf, coupling=True)
    critical = solve(full, 1e-3, ("critical_friction",)).critical_friction
    most = min(critical, 100.0)
    least = min(0.2 * full.kappa, 0.2 * most)
    friction = math.exp(rng.uniform(math.log(least), math.log(most)))
    return Scene(ratio, alpha, beta, friction, coupling=True)


def stick_radii(problem: FreeBoundaryProblem, logits: Iterable[float]) -> Iterator[CandidateRadius]:
    """Yield the stick radii at which the traction is continuous, within the range of the scan.

    Parameters
    ----------
    problem : FreeBoundaryProblem
        The problem of one stick disk.
    logits : iterable of float
        Where the scan evaluates the boundary residual, so close to each other that it changes its
        sign at most once between two.
    """
    residuals = ((logit, problem.coarse_residual(logit)) for logit in logits)
    for (left, left_residual), (right, right_residual) in pairwise(residuals):
        if (left_residual > 0.0) != (right_residual > 0.0):
            root = float(brentq(problem.coarse_residual, left, right, xtol=COARSE_TOL))
            yield CandidateRadius(root, _stick_excess(problem.coarse_solution(root)))


def scan_logits(problem: FreeBoundaryProblem, first: float, step: float) -> list[float]:
    """Return the logits of a scan, `step` apart.

    Next to the edge fields change over distances like the compliances alpha and beta (boundary
    layers). The scan ends where slip is narrower than both, or is lost in rounding.
    """
    layer_width = min(problem.parameters.alpha, problem.parameters.beta)
    last = EPSILON_DEPTH
    if layer_width > 0.0:
        last = min(last, CUBIC_TAIL_DEPTH - math.log(layer_width))
    return list(np.arange(first, max(last, first + step) + step, step).tolist())


def _stick_excess(solution: FieldSolution) -> float:
    """Return how far fields break the friction law in stick, see `CandidateRadius`."""
    system = solution.system
    pressures, shears = system.series(solution.values)
    if not all_positive(pressures):
        return math.inf
    fields = fields_in_stick(system, pressures, shears)
    return stick_violation(system.parameters.friction, fields)


def radii(scene: Scene) -> list[CandidateRadius]:
    """Return all stick radii of a scene."""
    compliances = scene.normal_compliance, scene.tangential_compliance
    assert scene.friction is not None
    parameters = Parameters(*compliances, scene.kappa, scene.friction)
    problem = FreeBoundaryProblem(parameters, Layout((0.0,), (0, 1)), 1e-3)
    return list(stick_radii(problem, scan_logits(problem, FIRST, STEP)))


def shares(counts: list[int]) -> tuple[int, ...]:
    """Return how many of these numbers are 0, 1 and more."""
    seen = Counter(min(one, 2) for one in counts)
    return tuple(seen[k] for k in range(3))


def main(count: int) -> None:
    """Look at all scenes, print and store."""
    every = []
    for number in range(count):
        every.append(radii(draw(number)))
        print(number, *every[-1], flush=True)
    cells = []
    for size in sorted({len(one) for one in every}):
        own = [one for one in every if len(one) == size]
        positive = shares([sum(radius.excess < math.inf for radius in one) for one in own])
        possible = shares([sum(radius.admissible for radius in one) for one in own])
        cells.append((size, len(own), *positive, *possible))
    heading = "radii | scenes | with positive pressure: none | one | more | "
    heading += "within friction, too: none | one | more"
    about = f"{count} scenes; radii at which the traction is continuous:\n\n"
    several = [number for number, one in enumerate(every) if sum(r.admissible for r in one) > 1]
    record = {"seed": SEED, "scenes": count, "several": several}
    write("coupled_uniqueness", about + table(heading, cells), record, version=2)


if __name__ == "__main__":
    main(options(__doc__, scenes=COUNT).scenes)
