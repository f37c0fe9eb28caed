"""What many solves show: how good any solver or number is, and sensitivities.

`convergence` measures how the errors of one solver fall with the number of unknowns, and what they
cost; `work_precision` what it takes several solvers to reach an accuracy. A solver is any callable
of a scene and a resolution: your own boundary or finite elements, or this library (`OwnSolver`).
`compare` says how good some numbers are, without a solver.
"""

from spectral_contact.studies.comparison import Agreement, Comparison, compare
from spectral_contact.studies.derivatives import Derivative, Sensitivity, sensitivity
from spectral_contact.studies.fitting import Line, Rate, fit_line, fit_rate
from spectral_contact.studies.machine import Machine, this_machine
from spectral_contact.studies.named_solvers import named_solver
from spectral_contact.studies.study import OwnSolver, convergence, truth_of, work_precision
from spectral_contact.studies.study_files import load
from spectral_contact.studies.study_results import (
    QUANTITIES,
    Convergence,
    Point,
    Study,
    WorkPrecision,
)
from spectral_contact.studies.timing import Stopwatch, Times, Timing
from spectral_contact.studies.truth import Truth

__all__ = [
    "QUANTITIES",
    "Agreement",
    "Comparison",
    "Convergence",
    "Derivative",
    "Line",
    "Machine",
    "OwnSolver",
    "Point",
    "Rate",
    "Sensitivity",
    "Stopwatch",
    "Study",
    "Times",
    "Timing",
    "Truth",
    "WorkPrecision",
    "compare",
    "convergence",
    "fit_line",
    "fit_rate",
    "load",
    "named_solver",
    "sensitivity",
    "this_machine",
    "truth_of",
    "work_precision",
]
