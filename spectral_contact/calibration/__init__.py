"""Roughness from experiments: compliances and friction fitted to what was measured.

`fit` takes a scene, which says what is known and where to start, and measured approaches
(`ApproachData`), pressures (`PressureData`) or stick radii (`StickRadiusData`), or a curve of
forces and depths under a profile (`IndentationData`), which tells the modulus, too, and the numbers
of a nonlinear layer's law. `compare_laws` says which of several laws such a curve speaks for.
`oliver_pharr` takes the modulus from stiffness and area at the start of unloading.
"""

from spectral_contact.calibration.estimate import LawComparison, compare_laws, fit
from spectral_contact.calibration.indentation_curve import (
    INDENTATION_PARAMETERS,
    IndentationFit,
)
from spectral_contact.calibration.indentation_data import IndentationData
from spectral_contact.calibration.measurements import ApproachData, PressureData, StickRadiusData
from spectral_contact.calibration.oliver_pharr import (
    AreaFunction,
    ModulusFromStiffness,
    contact_depth,
    oliver_pharr,
)
from spectral_contact.calibration.outcome import FittedParameter, RoughnessFit
from spectral_contact.calibration.setting import PARAMETERS

__all__ = [
    "INDENTATION_PARAMETERS",
    "PARAMETERS",
    "ApproachData",
    "AreaFunction",
    "FittedParameter",
    "IndentationData",
    "IndentationFit",
    "LawComparison",
    "ModulusFromStiffness",
    "PressureData",
    "RoughnessFit",
    "StickRadiusData",
    "compare_laws",
    "contact_depth",
    "fit",
    "oliver_pharr",
]
