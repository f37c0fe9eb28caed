"""Exact solutions and asymptotic series, which share no code with the solver.

This subpackage imports nothing else of the library, so that agreement with the solver is evidence.
All quantities are dimensionless as in the paper, stars dropped: the punch has radius 1 and bears
the load 1.

===================  ===============================================================================
``smooth``           no roughness, no coupling, stuck everywhere: elementary
``flat_punch``       no roughness, no friction: stress and displacement in the body, elementary
``partial_slip``     no roughness, no coupling, slip outside the stick radius: elliptic integrals
``coupled``          no roughness, coupled, stuck everywhere: Mossakovskij and Spence
``eigenpairs``       eigenvalues and eigenfunctions of the half-space operators
``indentation``      frictionless contact under profiles, in units of E'
``adhesion``         the same with adhesion
``series``           rough normal problem, very rough or nearly smooth
===================  ===============================================================================
"""

from ._stick_radius import StickRadius, stick_radius
from .adhesive_contacts import (
    PullOff,
    adhesive_contact,
    adhesive_winkler_contact,
    flat_pull_off,
    power_law_pull_off,
)
from .compliance_limits import (
    approach_large_compliance,
    approach_small_compliance,
    edge_pressure_large_compliance,
    edge_pressure_small_compliance,
)
from .coupled_punch import (
    coupled_approach,
    coupled_pressure,
    coupled_shear,
    coupled_traction,
    oscillation_exponent,
)
from .eigenpairs import eigenfunction, eigenfunction_image, eigenvalue
from .flat_punch import flat_punch_displacement, flat_punch_stress
from .indentation import (
    SmoothContact,
    cone_contact,
    cone_pressure,
    parabola_contact,
    parabola_pressure,
    power_law_contact,
    rounded_flat_contact,
    sphere_contact,
    truncated_cone_contact,
    winkler_contact,
)
from .partial_slip import partial_slip_shear, partial_slip_traction, slip_displacement
from .smooth import full_stick_shear, full_stick_traction, smooth_approach, smooth_pressure

__all__ = [
    "PullOff",
    "SmoothContact",
    "StickRadius",
    "adhesive_contact",
    "adhesive_winkler_contact",
    "approach_large_compliance",
    "approach_small_compliance",
    "cone_contact",
    "cone_pressure",
    "coupled_approach",
    "coupled_pressure",
    "coupled_shear",
    "coupled_traction",
    "edge_pressure_large_compliance",
    "edge_pressure_small_compliance",
    "eigenfunction",
    "eigenfunction_image",
    "eigenvalue",
    "flat_pull_off",
    "flat_punch_displacement",
    "flat_punch_stress",
    "full_stick_shear",
    "full_stick_traction",
    "oscillation_exponent",
    "parabola_contact",
    "parabola_pressure",
    "partial_slip_shear",
    "partial_slip_traction",
    "power_law_contact",
    "power_law_pull_off",
    "rounded_flat_contact",
    "slip_displacement",
    "smooth_approach",
    "smooth_pressure",
    "sphere_contact",
    "stick_radius",
    "truncated_cone_contact",
    "winkler_contact",
]
