"""Inside the body: stress and displacement anywhere in the half-space, from the loads on it.

A solution imports this when `Solution.inside` is asked for; it knows no solver, only the fields.
"""

from spectral_contact.equations.interior.body import Inside, Material
from spectral_contact.equations.interior.grids import Units
from spectral_contact.equations.interior.results import (
    Displacement,
    Energies,
    Extreme,
    Stress,
    Surface,
)

__all__ = [
    "Displacement",
    "Energies",
    "Extreme",
    "Inside",
    "Material",
    "Stress",
    "Surface",
    "Units",
]
