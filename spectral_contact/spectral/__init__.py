"""The discretised operators of axisymmetric contact: a public subpackage, usable on its own.

It knows panels, half-order integrals and the two kernels. It knows no scene, and decides nothing
about friction: the states of zones, the friction and the coupling are given to its contact system.
The modules have more than what is exported here.
"""

from spectral_contact.spectral.annulus import Annulus
from spectral_contact.spectral.cache import cache_sizes, clear_caches
from spectral_contact.spectral.jacobi import gauss_rule, legendre_values
from spectral_contact.spectral.panels import LogPanels
from spectral_contact.spectral.parts import GradedMesh, OffsetRadii
from spectral_contact.spectral.regularised import RegularisedProblem
from spectral_contact.spectral.spaces import Space, unit_space

__all__ = [
    "Annulus",
    "GradedMesh",
    "LogPanels",
    "OffsetRadii",
    "RegularisedProblem",
    "Space",
    "cache_sizes",
    "clear_caches",
    "gauss_rule",
    "legendre_values",
    "unit_space",
]
