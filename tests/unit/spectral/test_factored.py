"""Solutions by the factors of a contact system, uncorrected."""

import numpy as np
import pytest

from spectral_contact.contact.layout import Layout
from spectral_contact.contact.normal import solve_normal
from spectral_contact.contact.zone_problem import FreeBoundaryProblem
from spectral_contact.spectral.contact_matrix import system_matrix
from spectral_contact.spectral.factored import factored
from spectral_contact.spectral.parameters import Parameters

TOLERANCE = 1e-6


def system_of(layout, *, known):
    """Return the system of zones with a known or an unknown pressure, in its first space."""
    contact = solve_normal(0.5, TOLERANCE, 3000).best.value if known else None
    parameters = Parameters(0.5, 0.2, 1.0 if known else 0.3, 0.1)
    problem = FreeBoundaryProblem(parameters, layout, TOLERANCE, known=contact)
    logits = np.array(layout.logits)
    return problem.system(problem.spaces(TOLERANCE, logits), logits)


@pytest.mark.parametrize("known", [True, False], ids=["known", "unknown"])
@pytest.mark.parametrize(
    "layout",
    [Layout((), (0,)), Layout((-1.0,), (0, 1)), Layout((-0.4, 3.5), (0, 1, 0))],
    ids=["full stick", "one disk", "slip inside"],
)
def test_a_step_is_the_solution_with_the_matrix(layout, known):
    """That of one disk under a known pressure is of the unit disk, scaled by its radius."""
    system = system_of(layout, known=known)
    solution = np.random.default_rng(0).standard_normal((system.unknowns, 2))
    # the factors of a known pressure have no equations
    first = system.pressure_terms if known else 0
    solution[:first] = 0.0
    matrix = system_matrix(system)
    step = factored(system).step(matrix @ solution)
    residual = matrix @ (step - solution)
    assert np.abs(residual).max() < 1e-10 * np.abs(matrix @ solution).max()
