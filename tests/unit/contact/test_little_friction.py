"""The regularising disk that stands for a stick disk too small to change a field."""

import numpy as np
import pytest

from spectral_contact.contact.little_friction import full_slip_problem
from spectral_contact.contact.relative_changes import relative_changes
from spectral_contact.contact.zone_problem import FreeBoundaryProblem
from spectral_contact.spectral.factored import factored
from spectral_contact.spectral.parameters import Parameters


@pytest.mark.parametrize("alpha", [0.0, 0.1])
def test_no_error_of_the_traction_in_a_regularising_disk_counts(alpha):
    """It is rounding, which on some processors was more than a tolerance of 1e-12."""
    parameters, layout = full_slip_problem(Parameters(alpha, 0.1, 0.3, 1e-80))
    problem = FreeBoundaryProblem(parameters, layout, 1e-6)
    logits = np.array(layout.logits)
    system = problem.system(problem.spaces(1e-6, logits), logits)
    values = factored(system).unit_solutions[:, 0]
    changes = relative_changes(system, values, 1e-3 * values)
    for field, relative in zip(system.fields, changes, strict=True):
        if field.is_shear:
            assert (relative == 0.0).all()
        else:
            assert (relative >= 1e-4).any()
