"""What many solves show: how good any solver or number is, and sensitivities.

`convergence` measures how the errors of one solver fall with the number of unknowns, and what they
cost; `work_precision` what it takes several solvers to reach an accuracy. A solver is any callable
of a scene and a resolution: your own boundary or finite elements, or this library (`OwnSolver`).
`compare` says how good some numbers are, without a solver.
"""

from spectral_contact.studies.comparison import Agreement, Comparison, compare
from spectral_contact.studies.derivatives import Derivative, Sensitivity, sensitivity
from spectral_contact.studies.fitting import Rate, fit_rate
from spectral_contact.studies.study import (
    OwnSolver,
    convergence,
    named_solver,
    truth_of,
    work_precision,
)
from spectral_contact.studies.study_files import load
from spectral_contact.studies.study_results import (
    QUANTITIES,
    Convergence,
    Point,
    Study,
    WorkPrecision,
)
from spectral_contact.studies.timing import Times, Timing, this_machine
from spectral_contact.studies.truth import Truth

__all__ = [
    "QUANTITIES",
    "Agreement",
    "Comparison",
    "Convergence",
    "Derivative",
    "OwnSolver",
    "Point",
    "Rate",
    "Sensitivity",
    "Study",
    "Times",
    "Timing",
    "Truth",
    "WorkPrecision",
    "compare",
    "convergence",
    "fit_rate",
    "load",
    "named_solver",
    "sensitivity",
    "this_machine",
    "truth_of",
    "work_precision",
]
