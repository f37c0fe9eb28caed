"""The discretised operators of axisymmetric contact: a public subpackage, usable on its own.

It knows panels, half-order integrals and the two kernels; it knows no scene, friction or Poisson's
ratio. The modules have more than what is exported here.
"""

from spectral_contact.spectral.annulus import Annulus
from spectral_contact.spectral.cache import cache_sizes, clear_caches
from spectral_contact.spectral.galerkin import (
    DiskOperators,
    Factored,
    GalerkinOperator,
    Space,
    disk_operators,
)
from spectral_contact.spectral.jacobi import gauss_rule, legendre_values
from spectral_contact.spectral.panels import LogPanels, Nodes
from spectral_contact.spectral.parts import Family, Points

__all__ = [
    "Annulus",
    "DiskOperators",
    "Factored",
    "Family",
    "GalerkinOperator",
    "LogPanels",
    "Nodes",
    "Points",
    "Space",
    "cache_sizes",
    "clear_caches",
    "disk_operators",
    "gauss_rule",
    "legendre_values",
]
