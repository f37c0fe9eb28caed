"""Check any solution of the contact problem, this library's or your own solver's.

`check_solution` puts fields into the equations with their elliptic kernels, by quadrature that
knows nothing of how they were found. `spectral_contact.testing.strategies` draws random scenes for
property-based tests (extra ``testing``).
"""

from spectral_contact.equations.residuals import load, normal_displacement, tangential_displacement
from spectral_contact.testing.solution_checks import Check, CheckReport, check_solution

__all__ = [
    "Check",
    "CheckReport",
    "check_solution",
    "load",
    "normal_displacement",
    "tangential_displacement",
]
